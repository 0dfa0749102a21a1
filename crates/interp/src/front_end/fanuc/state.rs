//! What the front end keeps between two blocks, and of the block at hand.
use crate::{
    dialect::fanuc::kind::Kind,
    front_end::fanuc::tape::{Tape, TapePosition},
    geometry::{frame::Point, offset_curve::Flat},
    modes::Motion,
    program::outline::At,
    setup::{Increments, Setup},
};
use core::sync::atomic::{AtomicU64, Ordering};
use diag::Span;
use std::collections::BTreeMap;

/// Variables of a macro of its own.
pub(crate) const LOCALS: usize = 33;

/// Wear of X, Y, Z and radius, mm, by the number of the offset.
pub(crate) type Wear = BTreeMap<u32, [f64; 4]>;

/// The front end's own state.
#[derive(Clone, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // facts of their own about machine and block
pub(crate) struct Fanuc {
    pub(crate) kind: Kind,
    pub(crate) calculator: bool,
    pub(crate) skip_levels: u16,
    pub(crate) tape: Option<Tape>,
    pub(crate) variables: Variables,
    pub(crate) levels: Vec<Level>,
    /// G66: the macros called after each block that moves, the last first.
    pub(crate) modals: Vec<Macro>,
    /// M99 of the main program: variables when the round at hand began, and how many there were.
    pub(crate) round_before: Variables,
    pub(crate) rounds: u32,
    /// The program that the block names by `<NAME>`.
    pub(crate) called: Option<u32>,
    pub(crate) kept: Kept,
    pub(crate) wear: Wear,
    pub(crate) increments: Increments,
    pub(crate) c_is_a_chamfer: bool,
    /// G7.1, G12.1.
    pub(crate) surface: Option<Surface>,
    /// G22.
    pub(crate) zone: Zone,
    /// The block at hand counts inches.
    pub(crate) inch: bool,
    /// G43, G44, G49.
    pub(crate) length_mode: f64,
    /// How much of the way that follows the corner before has taken.
    pub(crate) taken: f64,
    /// What the block at hand asks for besides its words.
    pub(crate) once: Once,
    /// Where G28 or G30 came by, in machine coordinates of program units: where G29 goes from.
    pub(crate) by: Option<crate::Point>,
    /// O of the program whose blocks are executed; none before the first.
    pub(crate) program: Option<u32>,
    /// G92 S, G50 S: no faster with G96.
    pub(crate) top_speed: Option<f64>,
    pub(crate) lathe_cycle: Option<u16>,
    /// Where the cycle's last pass led, and its taper.
    pub(crate) corner: Option<(crate::Point, f64)>,
    /// The motion that G80 goes back to.
    pub(crate) before_cycle: Motion,
    /// F of a thread.
    pub(crate) lead: Option<f64>,
    /// G34 is in force.
    pub(crate) growing: bool,
    /// Q of the thread of the block at hand.
    pub(crate) thread_angle: Option<f64>,
    pub(crate) warned_of_point: bool,
    /// Letters and values of the block at hand, if it has a code.
    pub(crate) letters: Vec<(u8, f64)>,
    pub(crate) said: Vec<Said>,
    /// G16, G51, G51.1, G68.
    pub(crate) mapping: crate::front_end::fanuc::mapping::figure::Mapping,
    /// G71 to G76: what their first lines have set.
    pub(crate) first_lines: FirstLines,
    /// G70 to G73: the profile being taken down.
    pub(crate) shape: Option<Shape>,
}

/// What one block asks for that the shared language does not have.
#[allow(clippy::struct_excessive_bools)] // orders that exclude nothing
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Once {
    /// G9.
    pub(crate) exact: bool,
    /// G29.
    pub(crate) back: bool,
    /// G27.
    pub(crate) check: bool,
    /// G31.
    pub(crate) skip: bool,
    /// G22, G23.
    pub(crate) stroke_check: bool,
    /// G45 to G48.
    pub(crate) longer: i8,
    /// The arc in force has no centre, and the block goes straight.
    pub(crate) straight: Option<Motion>,
    /// G91 was left out for this block, and is in force again after it.
    pub(crate) back_to_increments: bool,
    /// W stands for Z.
    pub(crate) by_w: bool,
    /// G54.1: the work offset.
    pub(crate) system: Option<u8>,
    /// `,C` or `,R`.
    pub(crate) corner: Option<Corner>,
    /// G10: the work offset that has other values now.
    pub(crate) changed: Option<usize>,
}

/// M98, M198.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Callee {
    /// None for the program at hand.
    pub(crate) program: Option<u32>,
    /// M198: one in a file of its own.
    pub(crate) in_file: bool,
    pub(crate) times: u32,
    /// Q: the block with which it begins.
    pub(crate) start: Option<u32>,
}

/// What follows a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Then {
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
pub(crate) struct Level {
    pub(crate) back: TapePosition,
    /// The calling block: where GOTO of the caller searches from.
    pub(crate) caller: u32,
    pub(crate) program: Option<u32>,
    pub(crate) start: TapePosition,
    /// Executions still to come after this one.
    pub(crate) left: u32,
    /// The caller's #1 to #33, if the callee has its own.
    pub(crate) locals: Option<Box<Locals>>,
    /// A word of the machine's own has called it: in it and below, such words are the plain ones.
    pub(crate) by_word: bool,
    /// The caller's modal macros, if this is one of them.
    pub(crate) modals: Option<Vec<Macro>>,
}

/// A macro with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Macro {
    pub(crate) number: u32,
    pub(crate) times: u32,
    pub(crate) locals: Locals,
}

/// A word with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Said {
    pub(crate) letter: u8,
    pub(crate) value: f64,
    /// Written as a number without a decimal point: it counts increments.
    pub(crate) counts: bool,
    pub(crate) span: Span,
}

/// A corner to come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub(crate) round: bool,
    pub(crate) size: f64,
    pub(crate) span: Span,
}

/// Which surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
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
pub(crate) struct Surface {
    pub(crate) form: Form,
    /// Where the program stands, and the tool, in the flat.
    pub(crate) at: Point,
    pub(crate) tool: Point,
    /// Where the axes stand that the flat takes the place of.
    pub(crate) axes: Point,
    pub(crate) rate: f64,
    pub(crate) per_revolution: bool,
    pub(crate) speed: f64,
    pub(crate) in_mm: f64,
}

/// A variable that goes on while it is read: so it is set behind a shared reference, from whatever
/// thread.
#[derive(Debug, Default)]
pub(crate) struct Timer(AtomicU64);

impl Timer {
    pub(crate) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    pub(crate) fn set(&self, value: f64) {
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
pub(crate) struct Kept {
    /// #3001, #3002, in milliseconds.
    pub(crate) timers: [Timer; 2],
    /// #3003 to #3005, #3901, #3902.
    pub(crate) set: [f64; 5],
    /// #1132: outputs 0 to 31.
    pub(crate) outputs: u32,
    /// #4102 …: the last B, D, E, H, M, N.
    pub(crate) words: [f64; 6],
}

/// What G22 has set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zone {
    pub(crate) outside: bool,
    pub(crate) on: bool,
    pub(crate) sides: Option<[[f64; 3]; 2]>,
}

/// What first lines have set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FirstLines {
    /// G71, G72: depth of a pass, and how far it comes away.
    pub(crate) depth: Option<f64>,
    pub(crate) retract: f64,
    /// G73: how far away it begins (Z, X), and how often.
    pub(crate) relief: Flat,
    pub(crate) times: Option<u32>,
    /// G74, G75: back after each peck.
    pub(crate) back: f64,
    /// G76: finishing passes, pull-off in tenths of the lead, angle of the tool, least depth, left
    /// for finishing.
    pub(crate) thread: Option<[f64; 5]>,
}

/// A profile being taken down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) last: u32,
    /// Where to go on; behind its last block if there is nothing here.
    pub(crate) back: Option<At>,
    /// The cycle's block.
    pub(crate) cycle: u32,
}

/// What programs set.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variables {
    pub(crate) local: Locals,
    /// #100 to #999, of which #200 to #499 do not exist.
    pub(crate) common: Vec<Option<f64>>,
    /// Those that other controls have beside them, by number.
    pub(crate) more: BTreeMap<usize, f64>,
}

/// #1 to #33.
pub(crate) type Locals = [Option<f64>; LOCALS];

impl Fanuc {
    /// At the beginning of a program.
    pub(crate) fn new(kind: Kind, setup: &Setup) -> Self {
        Self {
            kind,
            calculator: setup.whole_units_without_point,
            skip_levels: setup.block_delete_levels | u16::from(setup.block_delete) << 1,
            tape: None,
            round_before: Variables::kept(&setup.parameters),
            variables: Variables::kept(&setup.parameters),
            levels: Vec::new(),
            modals: Vec::new(),
            rounds: 0,
            called: None,
            kept: Kept::default(),
            wear: Wear::new(),
            increments: setup.increments,
            c_is_a_chamfer: setup.c_is_a_chamfer,
            surface: None,
            zone: Zone::new(setup.stroke_check_outside),
            inch: false,
            length_mode: 49.0,
            taken: 0.0,
            once: Once::default(),
            by: None,
            program: None,
            top_speed: None,
            lathe_cycle: None,
            corner: None,
            before_cycle: Motion::Rapid,
            lead: None,
            growing: false,
            thread_angle: None,
            warned_of_point: false,
            letters: Vec::new(),
            said: Vec::new(),
            mapping: crate::front_end::fanuc::mapping::figure::Mapping::default(),
            first_lines: FirstLines::default(),
            shape: None,
        }
    }

    /// Whether a macro is called after each move.
    pub(crate) const fn has_modal(&self) -> bool {
        !self.modals.is_empty()
    }

    pub(crate) const fn is_lathe(&self) -> bool {
        self.kind.is_lathe()
    }

    /// Whether a profile is being taken down, up to a numbered block that was looked for.
    pub(crate) const fn takes_down_profile(&self) -> bool {
        self.shape.is_some()
    }

    /// The same, which reads its tape again when it needs it.
    pub(crate) fn without_tape(&mut self) -> Self {
        let tape = self.tape.take();
        let mut copy = self.clone();
        copy.said.clear(); // the last block's
        copy.inch = false;
        self.tape = tape;
        copy
    }

    /// X of a lathe is a diameter.
    pub(crate) fn radius(&self, axis: usize, value: f64) -> f64 {
        if axis == 0 && self.is_lathe() { value / 2.0 } else { value }
    }

    /// A radius as programs of the machine write it.
    pub(crate) fn shown(&self, axis: usize, value: f64) -> f64 {
        if axis == 0 && self.is_lathe() { value * 2.0 } else { value }
    }
}
