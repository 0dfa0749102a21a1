//! What the front end keeps between two blocks, and of the block at hand.
use crate::{
    dialect::fanuc::kind::Kind,
    dialect::fanuc::tape::{Tape, TapePosition},
    frame::Point,
    modes::Motion,
    offset_curve::Flat,
    outline::At,
    setup::Increments,
};
use core::sync::atomic::{AtomicU64, Ordering};
use diag::Span;
use std::collections::BTreeMap;

/// Variables of a macro of its own.
pub(super) const LOCALS: usize = 33;

/// Wear of X, Y, Z and radius, mm, by the number of the offset.
pub(super) type Wear = BTreeMap<u32, [f64; 4]>;

/// The front end's own state.
#[derive(Clone, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // facts of their own about machine and block
pub(crate) struct Fanuc {
    pub(super) kind: Kind,
    pub(super) calculator: bool,
    pub(super) skip_levels: u16,
    pub(crate) tape: Option<Tape>,
    pub(super) variables: Variables,
    pub(super) levels: Vec<Level>,
    /// G66: the macros called after each block that moves, the last first.
    pub(super) modals: Vec<Macro>,
    /// M99 of the main program: variables when the round at hand began, and how many there were.
    pub(super) round_before: Variables,
    pub(super) rounds: u32,
    /// The program that the block names by `<NAME>`.
    pub(super) called: Option<u32>,
    pub(super) kept: Kept,
    pub(super) wear: Wear,
    pub(super) increments: Increments,
    pub(super) c_is_a_chamfer: bool,
    /// G7.1, G12.1.
    pub(super) surface: Option<Surface>,
    /// G22.
    pub(super) zone: Zone,
    /// The block at hand counts inches.
    pub(super) inch: bool,
    /// G43, G44, G49.
    pub(super) length_mode: f64,
    /// How much of the way that follows the corner before has taken.
    pub(super) taken: f64,
    /// What the block at hand asks for besides its words.
    pub(super) once: Once,
    /// Where G28 or G30 came by, in machine coordinates of program units: where G29 goes from.
    pub(super) by: Option<crate::Point>,
    /// O of the program whose blocks are executed; none before the first.
    pub(super) program: Option<u32>,
    /// G92 S, G50 S: no faster with G96.
    pub(super) top_speed: Option<f64>,
    pub(super) lathe_cycle: Option<u16>,
    /// Where the cycle's last pass led, and its taper.
    pub(super) corner: Option<(crate::Point, f64)>,
    /// The motion that G80 goes back to.
    pub(super) before_cycle: Motion,
    /// F of a thread.
    pub(super) lead: Option<f64>,
    /// G34 is in force.
    pub(super) growing: bool,
    /// Q of the thread of the block at hand.
    pub(super) thread_angle: Option<f64>,
    pub(super) warned_of_point: bool,
    pub(super) said: Vec<Said>,
    /// G16, G51, G51.1, G68.
    pub(super) mapping: super::figure::Mapping,
    /// G71 to G76: what their first lines have set.
    pub(super) first_lines: FirstLines,
    /// G70 to G73: the profile being taken down.
    pub(super) shape: Option<Shape>,
}

/// What one block asks for that the shared language does not have.
#[allow(clippy::struct_excessive_bools)] // orders that exclude nothing
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Once {
    /// G9.
    pub(super) exact: bool,
    /// G29.
    pub(super) back: bool,
    /// G27.
    pub(super) check: bool,
    /// G31.
    pub(super) skip: bool,
    /// G22, G23.
    pub(super) stroke_check: bool,
    /// G45 to G48.
    pub(super) longer: i8,
    /// The arc in force has no centre, and the block goes straight.
    pub(super) straight: Option<Motion>,
    /// G91 was left out for this block, and is in force again after it.
    pub(super) back_to_increments: bool,
    /// W stands for Z.
    pub(super) by_w: bool,
    /// G54.1: the work offset.
    pub(super) system: Option<u8>,
    /// `,C` or `,R`.
    pub(super) corner: Option<Corner>,
    /// G10: the work offset that has other values now.
    pub(super) changed: Option<usize>,
}

/// M98, M198.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Callee {
    /// None for the program at hand.
    pub(super) program: Option<u32>,
    /// M198: one in a file of its own.
    pub(super) in_file: bool,
    pub(super) times: u32,
    /// Q: the block with which it begins.
    pub(super) start: Option<u32>,
}

/// What follows a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    Next,
    /// The macro of G66: the block has named an axis.
    Moved,
    /// M98, M198.
    Call(Callee),
    /// M99, M99 P.
    Return(Option<u32>),
}

/// A call that has not returned yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    pub(super) back: TapePosition,
    /// The calling block: where GOTO of the caller searches from.
    pub(super) caller: u32,
    pub(super) program: Option<u32>,
    pub(super) start: TapePosition,
    /// Executions still to come after this one.
    pub(super) left: u32,
    /// The caller's #1 to #33, if the callee has its own.
    pub(super) locals: Option<Box<Locals>>,
    /// A word of the machine's own has called it: in it and below, such words are the plain ones.
    pub(super) by_word: bool,
    /// The caller's modal macros, if this is one of them.
    pub(super) modals: Option<Vec<Macro>>,
}

/// A macro with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Macro {
    pub(super) number: u32,
    pub(super) times: u32,
    pub(super) locals: Locals,
}

/// A word with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Said {
    pub(super) letter: u8,
    pub(super) value: f64,
    /// Written as a number without a decimal point: it counts increments.
    pub(super) counts: bool,
    pub(super) span: Span,
}

/// A corner to come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) round: bool,
    pub(super) size: f64,
    pub(super) span: Span,
}

/// Which surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// The turning axis, its cylinder's radius, and the axis in whose place the unrolled length is.
    Cylinder {
        rotary: usize,
        radius: f64,
        place: usize,
    },
    Face,
}

/// G7.1 or G12.1 in force. Lengths are the program's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface {
    pub(super) form: Form,
    /// Where the program stands, and the tool, in the flat.
    pub(super) at: Point,
    pub(super) tool: Point,
    /// Where the axes stand that the flat takes the place of.
    pub(super) axes: Point,
    pub(super) rate: f64,
    pub(super) per_revolution: bool,
    pub(super) speed: f64,
    pub(super) in_mm: f64,
}

/// A variable that goes on while it is read: so it is set behind a shared reference, from whatever thread.
#[derive(Debug, Default)]
pub(super) struct Timer(AtomicU64);

impl Timer {
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    pub(super) fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Ordering::Relaxed);
    }
}

impl Clone for Timer {
    fn clone(&self) -> Self {
        Self(AtomicU64::new(self.0.load(Ordering::Relaxed)))
    }
}

impl PartialEq for Timer {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}

/// What system variables keep.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Kept {
    /// #3001, #3002, in milliseconds.
    pub(super) timers: [Timer; 2],
    /// #3003 to #3005, #3901, #3902.
    pub(super) set: [f64; 5],
    /// #1132: outputs 0 to 31.
    pub(super) outputs: u32,
    /// #4102 …: the last B, D, E, H, M, N.
    pub(super) words: [f64; 6],
}

/// What G22 has set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zone {
    pub(super) outside: bool,
    pub(super) on: bool,
    pub(super) sides: Option<[[f64; 3]; 2]>,
}

/// What first lines have set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FirstLines {
    /// G71, G72: depth of a pass, and how far it comes away.
    pub(super) depth: Option<f64>,
    pub(super) retract: f64,
    /// G73: how far away it begins (Z, X), and how often.
    pub(super) relief: Flat,
    pub(super) times: Option<u32>,
    /// G74, G75: back after each peck.
    pub(super) back: f64,
    /// G76: finishing passes, pull-off in tenths of the lead, angle of the tool, least depth, left for finishing.
    pub(super) thread: Option<[f64; 5]>,
}

/// A profile being taken down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) last: u32,
    /// Where to go on; behind its last block if there is nothing here.
    pub(super) back: Option<At>,
    /// The cycle's block.
    pub(super) cycle: u32,
}

/// What programs set.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variables {
    pub(super) local: Locals,
    /// #100 to #999, of which #200 to #499 do not exist.
    pub(super) common: Vec<Option<f64>>,
    /// Those that other controls have beside them, by number.
    pub(super) more: BTreeMap<usize, f64>,
}

/// #1 to #33.
pub(super) type Locals = [Option<f64>; LOCALS];
