//! The codes that mean something: one table each for G and M.
//!
//! A row says the code's modal group (two codes of one group exclude each other in a block), the
//! letters it takes, and what people call it. From the same table come the check that every word of
//! a block belongs to a code, the sentence when one does not, and the guess when a code is unknown.
//!
//! ```text
//!   spelling   codes and letters as people write them
//!   number     numbers of words as whole numbers and as codes
//! ```
//!
//! Source: NISTIR 6556 table 5 (modal groups); LinuxCNC 2.9 manual, "G codes" and "M codes".
pub(crate) mod number;
pub(crate) mod spelling;

/// Letters as a set: bit 0 is A, bit 25 is Z; then `@`, `^`, `$`.
pub(crate) type Letters = u32;

/// Place of a letter in a set and in [`Words`](crate::words::Words).
pub(crate) const fn index(letter: u8) -> usize {
    match letter {
        b'A'..=b'Z' => (letter - b'A') as usize,
        b'@' => 26,
        b'^' => 27,
        _ => 28, // `$`: the parser gives no others
    }
}

/// The letter at a place.
pub(crate) const fn letter(index: usize) -> char {
    match index {
        0..=25 => (b'A' + index as u8) as char,
        26 => '@',
        27 => '^',
        _ => '$',
    }
}

/// A set from text.
pub(crate) const fn set(letters: &str) -> Letters {
    let bytes = letters.as_bytes();
    let (mut mask, mut i) = (0, 0);
    while i < bytes.len() {
        mask |= 1 << index(bytes[i]);
        i += 1;
    }
    mask
}

/// The letters of the nine axes.
pub(crate) const AXES: Letters = set("XYZABCUVW");
/// A distance and an angle in the place of X and Y.
pub(crate) const POLAR: Letters = set("@^");
/// The centre of an arc.
pub(crate) const CENTRE: Letters = set("IJK");
/// Letters that need no code.
pub(crate) const FREE: Letters = set("GMTSF");

/// Modal groups of G codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GGroup {
    NonModal,
    Motion,
    Plane,
    Distance,
    ArcDistance,
    FeedMode,
    Units,
    Compensation,
    ToolLength,
    Retract,
    WorkOffset,
    PathControl,
    SpindleMode,
    Diameter,
    Cam,
}

/// Modal groups of M codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MGroup {
    Stop,
    Outputs,
    Tool,
    Spindle,
    Coolant,
    Overrides,
    State,
    Rigid,
    User,
}

/// Numbers of groups, for arrays.
pub(crate) const G_GROUPS: usize = GGroup::Cam as usize + 1;
/// Numbers of groups, for arrays.
pub(crate) const M_GROUPS: usize = MGroup::User as usize + 1;

/// One code.
pub(crate) struct Code<Group> {
    /// Tenths: 331 is G33.1.
    pub(crate) tenths: u16,
    pub(crate) group: Group,
    /// What it takes besides F, S, T.
    pub(crate) letters: Letters,
    /// For people.
    pub(crate) name: &'static str,
    /// Whether Leadscrew executes it.
    pub(crate) supported: bool,
}

const fn g(tenths: u16, group: GGroup, letters: &str, name: &'static str) -> Code<GGroup> {
    Code { tenths, group, letters: set(letters), name, supported: true }
}

const fn no_g(tenths: u16, group: GGroup, name: &'static str) -> Code<GGroup> {
    Code { tenths, group, letters: !0, name, supported: false }
}

const fn m(number: u16, group: MGroup, letters: &str, name: &'static str) -> Code<MGroup> {
    Code { tenths: number * 10, group, letters: set(letters), name, supported: true }
}

use GGroup::{
    ArcDistance, Cam, Compensation, Diameter, Distance, FeedMode, Motion, NonModal, PathControl,
    Plane, Retract, SpindleMode, ToolLength, Units, WorkOffset,
};
use MGroup::{Coolant, Outputs, Overrides, Rigid, Spindle, State, Stop, Tool, User};

/// All G codes, by rising number.
pub(crate) static G_CODES: [Code<GGroup>; 100] = [
    g(0, Motion, "XYZABCUVW@^", "rapid move"),
    g(10, Motion, "XYZABCUVW@^", "straight feed"),
    g(20, Motion, "XYZABCUVWIJKRP@^", "clockwise arc"),
    g(30, Motion, "XYZABCUVWIJKRP@^", "counter-clockwise arc"),
    g(40, NonModal, "P", "dwell"),
    g(50, Motion, "XYZABCUVWIJPQ", "cubic spline"),
    g(51, Motion, "XYZABCUVWIJ", "quadratic spline"),
    g(52, Motion, "XYZABCUVWPL", "NURBS"),
    g(53, Motion, "", "NURBS end"),
    g(70, Diameter, "", "X words are diameters"),
    g(80, Diameter, "", "X words are radii"),
    g(100, NonModal, "XYZABCUVWLPRIJQ", "set offsets"),
    g(170, Plane, "", "XY plane"),
    no_g(171, Plane, "UV plane"),
    g(180, Plane, "", "ZX plane"),
    no_g(181, Plane, "WU plane"),
    g(190, Plane, "", "YZ plane"),
    no_g(191, Plane, "VW plane"),
    g(200, Units, "", "inches"),
    g(210, Units, "", "millimetres"),
    g(280, NonModal, "XYZABCUVW", "go to the first reference point"),
    g(281, NonModal, "", "set the first reference point"),
    g(300, NonModal, "XYZABCUVW", "go to the second reference point"),
    g(301, NonModal, "", "set the second reference point"),
    g(330, Motion, "XYZABCUVWK$", "spindle-synchronised feed"),
    g(331, Motion, "XYZABCUVWKI$", "rigid tapping"),
    g(382, Motion, "XYZABCUVW@^", "probing"),
    g(383, Motion, "XYZABCUVW@^", "probing"),
    g(384, Motion, "XYZABCUVW@^", "probing"),
    g(385, Motion, "XYZABCUVW@^", "probing"),
    g(400, Compensation, "", "cutter radius compensation off"),
    g(410, Compensation, "D", "cutter radius compensation left"),
    g(411, Compensation, "DL", "cutter radius compensation left"),
    g(420, Compensation, "D", "cutter radius compensation right"),
    g(421, Compensation, "DL", "cutter radius compensation right"),
    g(430, ToolLength, "H", "tool length offset"),
    g(431, ToolLength, "XYZABCUVW", "tool length offset by words"),
    g(432, ToolLength, "XYZABCUVWH", "additional tool length offset"),
    g(490, ToolLength, "", "tool length offset off"),
    g(502, NonModal, "", "end of polygon turning"),
    g(512, NonModal, "PQRIJKDE", "polygon turning"),
    g(513, NonModal, "XYABIJL", "harmonic of a polygon's oscillation"),
    g(514, NonModal, "P", "measure a polygon's oscillation in the air and compensate it"),
    g(520, NonModal, "XYZABCUVW", "local offset"),
    g(530, NonModal, "", "machine coordinates"),
    g(540, WorkOffset, "", "work offset 1"),
    g(550, WorkOffset, "", "work offset 2"),
    g(560, WorkOffset, "", "work offset 3"),
    g(570, WorkOffset, "", "work offset 4"),
    g(580, WorkOffset, "", "work offset 5"),
    g(590, WorkOffset, "", "work offset 6"),
    g(591, WorkOffset, "", "work offset 7"),
    g(592, WorkOffset, "", "work offset 8"),
    g(593, WorkOffset, "", "work offset 9"),
    g(610, PathControl, "", "exact path"),
    g(611, PathControl, "", "exact stop"),
    g(640, PathControl, "PQ", "blended path"),
    g(700, Motion, "QXZDEP", "lathe finishing"),
    g(710, Motion, "QXZDIR", "lathe roughing along Z"),
    g(711, Motion, "QXZDIR", "lathe roughing along Z, no pockets"),
    g(712, Motion, "QXZDIR", "lathe roughing along Z, pockets only"),
    g(720, Motion, "QXZDIR", "lathe roughing along X"),
    g(721, Motion, "QXZDIR", "lathe roughing along X, no pockets"),
    g(722, Motion, "QXZDIR", "lathe roughing along X, pockets only"),
    g(730, Motion, "XYZ@^RLQ", "chip-breaking drilling"),
    g(740, Motion, "XYZ@^RLPQAIJ$", "left-hand tapping"),
    g(760, Motion, "ZPIJKRQHEL$", "threading cycle"),
    g(800, Motion, "", "no cycle"),
    g(810, Motion, "XYZ@^RL", "drilling"),
    g(820, Motion, "XYZ@^RLP", "drilling with dwell"),
    g(830, Motion, "XYZ@^RLQ", "deep-hole drilling"),
    g(840, Motion, "XYZ@^RLPQAIJ$", "right-hand tapping"),
    g(842, Motion, "XYZ@^RLPQAIJ$", "right-hand rigid tapping"),
    g(843, Motion, "XYZ@^RLPQAIJ$", "left-hand rigid tapping"),
    g(850, Motion, "XYZ@^RL", "boring, feed out"),
    g(860, Motion, "XYZ@^RLP$", "boring, spindle stop, rapid out"),
    g(870, Motion, "XYZ@^RLIJK", "back boring"),
    g(880, Motion, "XYZ@^RLP", "boring, manual out"),
    g(890, Motion, "XYZ@^RLP", "boring with dwell, feed out"),
    g(900, Distance, "", "absolute"),
    g(901, ArcDistance, "", "absolute arc centres"),
    g(910, Distance, "", "incremental"),
    g(911, ArcDistance, "", "incremental arc centres"),
    g(920, NonModal, "XYZABCUVW", "set the offset that makes this point the words'"),
    g(921, NonModal, "", "clear the G92 offset"),
    g(922, NonModal, "", "suspend the G92 offset"),
    g(923, NonModal, "", "restore the G92 offset"),
    g(930, FeedMode, "", "inverse time feed"),
    g(940, FeedMode, "", "feed per minute"),
    g(950, FeedMode, "", "feed per revolution"),
    g(960, SpindleMode, "D$", "constant surface speed"),
    g(970, SpindleMode, "$", "revolutions per minute"),
    g(980, Retract, "", "retract to the initial level"),
    g(990, Retract, "", "retract to R"),
    g(1500, Cam, "", "cam grinding: compensate what is sent"),
    g(1510, Cam, "PR", "cam grinding: follow a profile"),
    g(1520, Cam, "", "cam grinding: forget the samples"),
    g(1530, Cam, "", "cam grinding: take samples"),
    g(1540, Cam, "XRP", "cam grinding: infeed (X) or spark-out (P)"),
    g(1550, Cam, "", "cam grinding: compute and keep the phase error"),
];

/// All M codes, by rising number; 100 stands for all the user's.
pub(crate) static M_CODES: [Code<MGroup>; 35] = [
    m(0, Stop, "", "program stop"),
    m(1, Stop, "", "optional stop"),
    m(2, Stop, "", "program end"),
    m(3, Spindle, "$", "spindle clockwise"),
    m(4, Spindle, "$", "spindle counter-clockwise"),
    m(5, Spindle, "$", "spindle stop"),
    m(6, Tool, "", "tool change"),
    m(7, Coolant, "", "mist coolant on"),
    m(8, Coolant, "", "flood coolant on"),
    m(9, Coolant, "", "coolant off"),
    m(19, Spindle, "RPQ$", "orient the spindle"),
    m(29, Rigid, "", "rigid tapping follows"),
    m(30, Stop, "", "program end and rewind"),
    m(48, Overrides, "", "overrides on"),
    m(49, Overrides, "", "overrides off"),
    m(50, Overrides, "P", "feed override"),
    m(51, Overrides, "P$", "spindle override"),
    m(52, Overrides, "P", "adaptive feed"),
    m(53, Overrides, "P", "feed hold"),
    m(60, Stop, "", "pallet change and stop"),
    m(61, Tool, "Q", "set the tool number"),
    m(62, Outputs, "P", "digital output on with the next move"),
    m(63, Outputs, "P", "digital output off with the next move"),
    m(64, Outputs, "P", "digital output on at once"),
    m(65, Outputs, "P", "digital output off at once"),
    m(66, Outputs, "PELQ", "read an input or wait for it"),
    m(67, Outputs, "EQ", "analogue output with the next move"),
    m(68, Outputs, "EQ", "analogue output at once"),
    m(70, State, "", "save modal state"),
    m(71, State, "", "invalidate saved state"),
    m(72, State, "", "restore modal state"),
    m(73, State, "", "save and auto-restore modal state"),
    m(98, Stop, "PL", "call a subprogram"),
    m(99, Stop, "", "return from a subprogram"),
    m(100, User, "PQ", "the machine's own code"),
];

/// Where a code stands in a table whose numbers are below `N` tenths; 255 means nowhere.
const fn places<const N: usize, const LEN: usize>(tenths: &[u16; LEN]) -> [u8; N] {
    let mut table = [u8::MAX; N];
    let mut i = 0;
    while i < LEN {
        if (tenths[i] as usize) < N {
            table[tenths[i] as usize] = i as u8;
        }
        i += 1;
    }
    table
}

macro_rules! tenths {
    ($table:ident, $len:literal) => {{
        let (mut all, mut i) = ([0; $len], 0);
        while i < $len {
            all[i] = $table[i].tenths;
            i += 1;
        }
        all
    }};
}

static G_PLACES: [u8; 1600] = places(&tenths!(G_CODES, 100));
static M_PLACES: [u8; 1000] = places(&tenths!(M_CODES, 35));

/// Fanuc's cycles G76 and G87, whose numbers belong to other cycles in the table.
pub(crate) const FINE_BORE: u16 = OWN + 760;
pub(crate) const BORE_UPWARDS: u16 = OWN + 870;
/// Fanuc's G44: the tool's length is taken away.
pub(crate) const LENGTH_BACK: u16 = OWN + 440;
/// Brother's G77 and G78: synchronised tapping by its pitch; G100: the non-stop tool change.
pub(crate) const SYNCHRO_RIGHT: u16 = OWN + 770;
pub(crate) const SYNCHRO_LEFT: u16 = OWN + 780;
pub(crate) const NON_STOP_CHANGE: u16 = OWN + 1000;
/// Added to a code that no program can write so.
pub(crate) const OWN: u16 = 10_000;

static OWN_CODES: [Code<GGroup>; 6] = [
    g(LENGTH_BACK, ToolLength, "H", "tool length offset, negative"),
    g(FINE_BORE, Motion, "XYZRLPQ", "fine boring, spindle stop, aside, rapid out"),
    g(BORE_UPWARDS, Motion, "XYZRLPQ", "back boring, from below"),
    g(SYNCHRO_RIGHT, Motion, "XYZRLPQIJ", "right-hand synchronised tapping"),
    g(SYNCHRO_LEFT, Motion, "XYZRLPQIJ", "left-hand synchronised tapping"),
    g(NON_STOP_CHANGE, NonModal, "XYZABCHDL", "tool change, move and spindle in one block"),
];

/// The G code with this number.
#[inline]
pub(crate) fn g_code(tenths: u16) -> Option<&'static Code<GGroup>> {
    match G_PLACES.get(usize::from(tenths)) {
        Some(place) => G_CODES.get(usize::from(*place)),
        None => OWN_CODES.iter().find(|code| code.tenths == tenths),
    }
}

/// The M code with this number.
#[inline]
pub(crate) fn m_code(tenths: u16) -> Option<&'static Code<MGroup>> {
    if (1000..2000).contains(&tenths) && tenths.is_multiple_of(10) {
        return M_CODES.iter().find(|c| c.tenths == 1000);
    }
    M_CODES.get(usize::from(*M_PLACES.get(usize::from(tenths))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_found_by_its_number() {
        for code in G_CODES.iter().filter(|c| c.tenths < 1600) {
            assert_eq!(g_code(code.tenths).map(|c| c.tenths), Some(code.tenths));
        }
        for code in M_CODES.iter().filter(|c| c.tenths < 1000) {
            assert_eq!(m_code(code.tenths).map(|c| c.tenths), Some(code.tenths));
        }
        assert!(g_code(123).is_none());
        assert!(m_code(999).is_none());
    }
}
