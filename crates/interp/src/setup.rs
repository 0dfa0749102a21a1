//! What the interpreter is told before it begins: plain data, no files.
use crate::dialect::{DepthFrom, Dialect};
use canon::{Position, ToolLibrary};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

/// What a machine has set for its drilling and tapping cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycles {
    /// Where Z counts from under G91.
    pub depth_from: DepthFrom,
    /// Chip removal in G81, G82, G84 and G74 of programs that do not say U and E. Where it is set,
    /// every dialect knows those words.
    pub chip_removal: Option<Chips>,
    /// Where the tool moves aside in Fanuc's G76 and G87.
    pub aside: Aside,
}

/// A way along one axis of the plane: where the bit comes off the bore when the spindle stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Aside {
    /// Along the plane's second axis (Y of G17), not its first.
    pub second: bool,
    /// Towards smaller coordinates.
    pub back: bool,
}

/// Chips are thrown off by turning the spindle backwards between two holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chips {
    /// U: how fast, rev/min.
    pub rpm: f64,
    /// E: after each repetition whose number is a multiple of this; 0 is never.
    pub every: u32,
}

/// What a program may leave to the machine, as it is set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leaves {
    /// M codes that neither the dialect nor the machine's file knows have no effect.
    pub unknown_codes: bool,
    /// The program ends where its text does.
    pub end: bool,
    /// What moves and cycles without F go with.
    pub feed: Option<units::Speed>,
}

/// What becomes of a tool number that the library does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingTools {
    /// The program is refused.
    #[default]
    Refuse,
    /// A tool of no length takes its place, marked as a stand-in.
    StandIn,
}

/// Everything a program meets that is not in its text.
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools)] // switches of the machine, each of its own
pub struct Setup {
    /// Whose words.
    pub dialect: Dialect,
    /// What the machine has set for its cycles.
    pub cycles: Cycles,
    /// Tools that T, M6 and G43 may name.
    pub tools: ToolLibrary,
    /// What becomes of a tool that is not among them.
    pub missing_tools: MissingTools,
    /// The tools are an example, and not the shop's: what a tool is led by of them is said.
    pub has_example_tools: bool,
    /// Offsets of tools that hold wear alone, as the program states.
    pub wear_offsets: WearOffsets,
    /// Values of the numbered parameters.
    pub parameters: Parameters,
    /// Files that `o<name> call` may open.
    pub subprograms: Vec<Subprogram>,
    /// What the machine's own M codes do.
    pub user_codes: Vec<MachineCode>,
    /// Words of the machine's own that call programs.
    pub macro_calls: Vec<MacroCall>,
    /// What a program may leave out.
    pub leaves: Leaves,
    /// Where the axes stand when the program begins.
    pub start: Position,
    /// No machine is there to be asked: tool changes, inputs and positions are answered as
    /// LinuxCNC's stand-alone interpreter answers itself. For comparisons with its listings.
    pub stand_alone: bool,
    /// Whether blocks that begin with `/` are left out.
    pub block_delete: bool,
    /// Fanuc: levels of block skip that are on besides, bit 2 for `/2` up to bit 9.
    pub block_delete_levels: u16,
    /// Fanuc: a number without a point counts whole millimetres, inches or degrees (calculator
    /// type), not least input increments.
    pub whole_units_without_point: bool,
    /// Fanuc: the least input increment, which a number without a point counts.
    pub increments: Increments,
    /// Fanuc: the stored stroke check of G22 forbids what is outside of its box, not inside.
    pub stroke_check_outside: bool,
    /// Fanuc's lathes: the machine has no C axis, and C of a G1 is a chamfer.
    pub c_is_a_chamfer: bool,
    /// What the first spindle turns at most; `None`: it is not known.
    pub fastest_spindle: Option<units::Spin>,
    /// What stops a program that does not stop by itself.
    pub limits: Limits,
    /// Who is asked whether it is still wanted.
    pub break_off: BreakOff,
}

/// Offsets D that hold wear alone: the programmed way is that of the tool's centre already, and
/// G41 and G42 lead the tool on it. Each has the comment that states it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WearOffsets {
    /// The comment that states it of every offset.
    pub all: Option<String>,
    /// The comments that state it of single offsets, by number.
    pub of: BTreeMap<u32, String>,
}

impl WearOffsets {
    /// The comment that states it of this offset.
    pub fn stated(&self, number: u32) -> Option<&str> {
        self.of.get(&number).or(self.all.as_ref()).map(String::as_str)
    }
}

/// Asked now and then while a program is executed: whether to break off.
#[derive(Clone, Default)]
pub struct BreakOff(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl BreakOff {
    /// `came` is asked in the thread that executes.
    pub fn by(came: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(came)))
    }

    /// Whether to break off.
    pub fn came(&self) -> bool {
        self.0.as_ref().is_some_and(|came| came())
    }
}

impl fmt::Debug for BreakOff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("BreakOff").finish_non_exhaustive()
    }
}

/// Fanuc's increment systems: the smallest length, angle and time that a program can write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Increments {
    /// IS-A: 0.01 mm, 0.001 inch, 0.01°.
    A,
    /// IS-B: 0.001 mm, 0.0001 inch, 0.001°.
    #[default]
    B,
    /// IS-C: 0.0001 mm, 0.00001 inch, 0.0001°.
    C,
}

impl Increments {
    /// How many of them make a millimetre, a degree or a second.
    pub(crate) const fn per_unit(self) -> f64 {
        match self {
            Self::A => 100.0,
            Self::B => 1000.0,
            Self::C => 10_000.0,
        }
    }
}

/// An M code of the machine's own.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineCode {
    /// The number after M.
    pub number: u16,
    /// What it does, for people.
    pub name: String,
    /// What it does, for the machine.
    pub action: CodeAction,
}

/// A word that calls a program of the tape, on Fanuc's controls and their variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MacroCall {
    /// `G`, `M` or `T`.
    pub letter: char,
    /// The number after G or M; none for T, whatever its number.
    pub number: Option<u16>,
    /// O of the program.
    pub program: u32,
    /// The block's other words are arguments, as those of G65; else they do what they say, and then
    /// it is called as by M98.
    pub takes_arguments: bool,
}

/// What an M code of the machine's own moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CodeAction {
    /// Nothing that this control would know of.
    #[default]
    None,
    /// It switches a digital output.
    Output {
        /// Its number.
        number: u8,
        /// On or off.
        on: bool,
    },
    /// The program waits.
    Wait(units::Time),
}

/// A file with a subprogram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subprogram {
    /// Name in `o<name> call`: the file's name without its extension, in lower case.
    pub name: String,
    /// Its text.
    pub source: Vec<u8>,
}

/// Bounds on what one program may use; each is named in the diagnostic that it causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Subprograms called within each other.
    pub calls: usize,
    /// Blocks executed.
    pub blocks: u64,
    /// Blocks executed since the machine has last moved or waited, where the program jumps back;
    /// each 64 bytes of a block count as one more.
    pub idle_blocks: u64,
    /// Readings of inputs executed since the machine has last moved or waited, where the program
    /// jumps back.
    pub idle_reads: u64,
    /// Errors after which reading on is of no use.
    pub errors: usize,
    /// Blocks executed after the first error, to find more.
    pub blocks_after_error: u64,
    /// Findings kept: more of them tell nothing new.
    pub findings: usize,
    /// Named parameters.
    pub names: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            calls: 64,
            blocks: 50_000_000,
            idle_blocks: 2_000_000,
            idle_reads: 10_000,
            errors: 200,
            blocks_after_error: 1_000_000,
            findings: 400,
            names: 10_000,
        }
    }
}

/// Highest number of a parameter that a program of RS-274 can write.
pub const MAX_PARAMETER: usize = 5601;
/// Where the offsets of Fanuc's G54.1 P1 to P48 lie; Haas has 99.
const MORE_OFFSETS: usize = 7001;
const MOST: usize = MORE_OFFSETS + 20 * 99 - 1;
/// Parameters that have a value or none.
const OPTIONAL: core::ops::RangeInclusive<usize> = 500..=999;

/// The numbered parameters as the parameter file (`.var`) keeps them: lengths in mm, angles in
/// degrees.
///
/// Those that mean something: 5161–5169 where G28 goes, 5181–5189 where G30 goes (machine
/// coordinates of X Y Z A B C U V W), 5210 whether the G92 offset is on, 5211–5219 that offset,
/// 5220 the work offset in force (1 is G54), 5221–5230 the offsets of G54 and its rotation,
/// 5241–5250 those of G55, and so on by twenties; 5599 whether (DEBUG, …) is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    values: Vec<f64>,
    /// Of those that are kept over runs: set, and zero.
    zeros: BTreeSet<usize>,
}

impl Default for Parameters {
    fn default() -> Self {
        let mut values = vec![0.0; MOST + 1];
        values[5220] = 1.0;
        values[5599] = 1.0;
        Self { values, zeros: BTreeSet::new() }
    }
}

impl Parameters {
    /// Value of `#number`; `None` if there is no such parameter.
    pub fn get(&self, number: usize) -> Option<f64> {
        if number == 0 { None } else { self.values.get(number).copied() }
    }

    /// Set `#number`. Returns false, and changes nothing, if there is no such parameter or the
    /// value is not finite.
    pub fn set(&mut self, number: usize, value: f64) -> bool {
        match self.values.get_mut(number) {
            Some(slot) if number > 0 && value.is_finite() => {
                *slot = value;
                if OPTIONAL.contains(&number) {
                    if value == 0.0 {
                        self.zeros.insert(number);
                    } else {
                        self.zeros.remove(&number);
                    }
                }
                true
            }
            _ => false,
        }
    }

    /// Give a value, or take it away.
    pub(crate) fn keep(&mut self, number: usize, value: Option<f64>) {
        self.set(number, value.unwrap_or(0.0));
        if value.is_none() {
            self.zeros.remove(&number);
        }
    }

    /// All that are not zero, and those of #500 to #999 that were set to zero, by rising number.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> {
        let said = |(n, v): &(usize, f64)| *v != 0.0 || self.zeros.contains(n);
        self.values.iter().copied().enumerate().filter(said)
    }

    pub(crate) fn at(&self, number: usize) -> f64 {
        self.values.get(number).copied().unwrap_or(0.0)
    }

    /// First parameter of a work offset (1 is G54, 9 is G59.3, 10 and more are Fanuc's G54.1 P1 and
    /// more; 0 is Fanuc's external one, which is added to all).
    pub(crate) const fn work_offset(system: usize) -> usize {
        match system {
            0..10 => 5201 + 20 * system,
            _ => MORE_OFFSETS + 20 * (system - 10),
        }
    }

    /// Nine consecutive values.
    pub(crate) fn point(&self, first: usize) -> [f64; 9] {
        core::array::from_fn(|i| self.at(first + i))
    }

    /// #1 to #30: the arguments of a subprogram.
    pub(crate) fn arguments_mut(&mut self) -> &mut [f64] {
        self.values.get_mut(1..=30).unwrap_or_default()
    }

    pub(crate) fn set_point(&mut self, first: usize, point: &[f64; 9]) {
        for (i, value) in point.iter().enumerate() {
            self.set(first + i, *value);
        }
    }
}
