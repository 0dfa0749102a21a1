//! Tool offsets as Fanuc keeps them: geometry and wear of length and radius, of X, Y, Z and nose on
//! a lathe.
//!
//! ```text
//!   offset in force = geometry + wear           G10 L10 P1 R100.   G10 L11 P1 R0.05
//! ```
//!
//! The control keeps both for numbers that need no tool of their own. The sum is what the tool
//! table's entry holds. A lathe's X and wear of X are diameters, as G10 and the variables of a
//! lathe count them.
//!
//! | variables | machining centre | | lathe |
//! |---|---|---|---|
//! | #2001, #10001 | wear of length | #2001, #10001 | wear of X |
//! | #2201, #11001 | length | #2101, #11001 | wear of Z |
//! | #12001 | wear of radius | #2201, #12001 | wear of the nose radius |
//! | #13001 | radius | #2301, #13001 | where the nose points |
//! | | | #2401, #14001 | wear of Y |
//! | | | #2701, #15001; #2801, #16001; #2901, #17001; #19001 | X; Z; nose radius; Y |
//!
//! Source: Fanuc, operator's manual of series 30i, "Tool compensation memory", "System variables".
use crate::{front_end::fanuc::state::Fanuc, state::executor::Executor};

/// What of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    X,
    Y,
    /// The length of a mill's tool.
    Z,
    Radius,
    /// 0 to 9.
    Nose,
}

/// One value of one tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ToolVariable {
    pub(crate) tool: u32,
    pub(crate) part: Part,
    pub(crate) wear: bool,
}

/// First variable, how many, what.
type OffsetRow = (usize, usize, Part, bool);
const MILL: [OffsetRow; 6] = [
    (2001, 200, Part::Z, true),
    (2201, 200, Part::Z, false),
    (10_001, 999, Part::Z, true),
    (11_001, 999, Part::Z, false),
    (12_001, 999, Part::Radius, true),
    (13_001, 999, Part::Radius, false),
];
const LATHE: [OffsetRow; 19] = [
    (2001, 64, Part::X, true),
    (2101, 64, Part::Z, true),
    (2201, 64, Part::Radius, true),
    (2301, 64, Part::Nose, false),
    (2401, 49, Part::Y, true),
    (2451, 49, Part::Y, false),
    (2701, 49, Part::X, false),
    (2801, 49, Part::Z, false),
    (2901, 64, Part::Radius, false),
    (10_001, 999, Part::X, true),
    (11_001, 999, Part::Z, true),
    (12_001, 999, Part::Radius, true),
    (13_001, 999, Part::Nose, false),
    (14_001, 999, Part::Y, true),
    (15_001, 999, Part::X, false),
    (16_001, 999, Part::Z, false),
    (17_001, 999, Part::Radius, false),
    (18_001, 999, Part::Nose, false),
    (19_001, 999, Part::Y, false),
];

impl ToolVariable {
    /// The one that a variable is.
    pub(crate) fn of(number: usize, lathe: bool) -> Option<Self> {
        let rows: &[OffsetRow] = if lathe { &LATHE } else { &MILL };
        let row = rows.iter().find(|(first, count, ..)| (*first..first + count).contains(&number));
        row.map(|(first, _, part, wear)| Self {
            tool: (number - first + 1) as u32,
            part: *part,
            wear: *wear,
        })
    }
}

/// Where wear keeps a part.
const fn place(part: Part) -> Option<usize> {
    match part {
        Part::X => Some(0),
        Part::Y => Some(1),
        Part::Z => Some(2),
        Part::Radius => Some(3),
        Part::Nose => None,
    }
}

/// Where the imaginary tool nose lies, seen from the nose's centre: Fanuc's number of the shared
/// language's, and the other way round.
///
/// ```text
///   X ↑  Z →      Fanuc  2 6 1      shared  3 8 4
///                        7 · 5              7 · 5
///                        3 8 4              2 6 1
/// ```
const fn nose(number: u32) -> u32 {
    match number {
        1 => 4,
        2 => 3,
        3 => 2,
        4 => 1,
        6 => 8,
        8 => 6,
        other => other,
    }
}

/// Its value in program units.
pub(crate) fn tool_value(fanuc: &Fanuc, ex: &Executor, which: ToolVariable) -> f64 {
    let entry = ex.tools.entry(which.tool);
    let Some(at) = place(which.part) else { return f64::from(nose(entry.orientation)) };
    let wear = wear_of(fanuc, ex, which.tool)[at];
    let sum = if at == 3 { entry.diameter / 2.0 } else { entry.offset[at] };
    let mm = if which.wear { wear } else { sum - wear };
    fanuc.shown(at, mm) / ex.modes.units.in_mm()
}

/// Wear of X, Y, Z and radius, mm: as the program has set it, else as the tool table has it.
fn wear_of(fanuc: &Fanuc, ex: &Executor, tool: u32) -> [f64; 4] {
    let of_table = || {
        let wear = ex.tools.library.get(tool).map(|tool| tool.wear).unwrap_or_default();
        [0.0, 0.0, wear.length.value(), wear.radius.value()]
    };
    fanuc.wear.get(&tool).copied().unwrap_or_else(of_table)
}

/// Set it, in program units.
pub(crate) fn set_tool(fanuc: &mut Fanuc, ex: &mut Executor, which: ToolVariable, value: f64) {
    let mut entry = ex.tools.entry(which.tool);
    match place(which.part) {
        None => entry.orientation = nose(value.clamp(0.0, 9.0) as u32),
        Some(at) => {
            let mm = fanuc.radius(at, value * ex.modes.units.in_mm());
            let known = wear_of(fanuc, ex, which.tool);
            let wear = fanuc.wear.entry(which.tool).or_insert(known);
            let sum = if at == 3 { entry.diameter / 2.0 } else { entry.offset[at] };
            let geometry = if which.wear { sum - wear[at] } else { mm };
            if which.wear {
                wear[at] = mm;
            }
            let sum = geometry + wear[at];
            if at == 3 {
                entry.diameter = 2.0 * sum;
            } else {
                entry.offset[at] = sum;
            }
        }
    }
    ex.tools.written.write(entry);
}
