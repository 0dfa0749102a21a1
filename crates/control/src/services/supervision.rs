//! What supervision by torque saw, in words: a line for each hole that is not as the others, and
//! one for each kind of stroke.
use kernel::{Supervised, TorqueBound};
use std::fmt::Write as _;
use store::machine::MachineFile;
use sync::supervision::band::FEWEST_HOLES;
use sync::supervision::diagnosis::Diagnosis;

/// Most holes that are listed one by one.
const MOST_LISTED: usize = 20;

/// One stroke of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupervisedStroke {
    /// Index of its operation.
    pub op: u32,
    /// Its program line.
    pub line: u32,
    /// What was seen.
    pub seen: Supervised,
}

/// What was diagnosed, with what else it may be.
pub fn sentence(seen: &Supervised) -> String {
    let percent = |factor: f64| (factor - 1.0).abs() * 100.0;
    let depth = |share: f64| seen.depth.value() * share;
    let mut said = match seen.diagnosed.what {
        Diagnosis::WithinBand => "within the band".to_owned(),
        Diagnosis::Learning(holes) => {
            format!("not judged: hole {holes} of {FEWEST_HOLES} that a band needs")
        }
        Diagnosis::UnlikeOthers(factor) => format!(
            "not judged, as there is no band yet, and not learnt from: torque {factor:.2} times that of the holes before"
        ),
        Diagnosis::HoleTooSmall(factor) => format!(
            "torque {:.0} % above the band from the first thread on: pre-drilled hole too small or missing, or harder material",
            percent(factor)
        ),
        Diagnosis::HoleTooLarge(factor) => format!(
            "torque {:.0} % below the band from the first thread on: pre-drilled hole too large, or softer material",
            percent(factor)
        ),
        Diagnosis::CutsNothing => {
            "next to no torque from the first thread on: no material, a hole much too wide, a thread that is there already, a tap that was broken before, or less than the drive can read".to_owned()
        }
        Diagnosis::ChipsPacked(factor) => format!(
            "torque {:.0} % above the band towards the bottom or on the way out: chips packed in the flutes",
            percent(factor)
        ),
        Diagnosis::Worn(factor) => format!(
            "within the band, which has risen by {:.0} % since the first holes: tap worn",
            percent(factor)
        ),
        Diagnosis::Broken(share) => {
            format!("torque gone from {:.1} mm on: tap broken", depth(share))
        }
        Diagnosis::AboveBand(factor) => {
            format!("torque {:.0} % too high, cause not known", percent(factor))
        }
        Diagnosis::Interrupted => "not judged: the stroke was stopped on its way".to_owned(),
    };
    let is_doubtful = !seen.diagnosed.is_sure
        && !matches!(
            seen.diagnosed.what,
            Diagnosis::Learning(_) | Diagnosis::UnlikeOthers(_) | Diagnosis::AboveBand(_)
        );
    if is_doubtful {
        said += " (not sure)";
    }
    if let Some(crossing) = seen.crossing {
        let bound = match crossing.bound {
            TorqueBound::Limit => "the limit of the tap",
            TorqueBound::Upper => "the upper bound",
            TorqueBound::Lower => "the lower bound",
        };
        let _ = write!(
            said,
            "; {:.2} N·m against {bound} of {:.2} N·m at {:.1} mm, alarm {:.2} ms after the first reading beyond it",
            crossing.torque.value(),
            crossing.limit.value(),
            crossing.depth.value(),
            crossing.took.value() * 1e3
        );
    }
    said
}

/// It is worth a line of its own.
pub const fn is_remarkable(seen: &Supervised) -> bool {
    !matches!(
        seen.diagnosed.what,
        Diagnosis::WithinBand | Diagnosis::Learning(_) | Diagnosis::Interrupted
    )
}

/// What was seen of a whole run; nothing where nothing was to be supervised.
pub fn text(strokes: &[SupervisedStroke], machine: &MachineFile, taps: bool) -> String {
    if strokes.is_empty() {
        return not_supervised(machine).filter(|_| taps).unwrap_or_default();
    }
    let mut said = String::new();
    let remarkable = strokes.iter().enumerate().filter(|(_, s)| is_remarkable(&s.seen));
    for (number, stroke) in remarkable.clone().take(MOST_LISTED) {
        let (hole, line, tool) = (number + 1, stroke.line, stroke.seen.tool);
        let _ = writeln!(
            said,
            "supervision: line {line}, hole {hole}, T{tool}: {}",
            sentence(&stroke.seen)
        );
    }
    let more = remarkable.count().saturating_sub(MOST_LISTED);
    if more > 0 {
        let _ = writeln!(said, "supervision: and {more} more");
    }
    let mut tools: Vec<u32> = strokes.iter().map(|stroke| stroke.seen.tool).collect();
    tools.sort_unstable();
    tools.dedup();
    for tool in tools {
        let of: Vec<_> = strokes.iter().map(|s| &s.seen).filter(|s| s.tool == tool).collect();
        said += &of_tool(tool, &of);
    }
    said
}

/// One line of a tool.
fn of_tool(tool: u32, seen: &[&Supervised]) -> String {
    let count = |is: fn(&Diagnosis) -> bool| {
        seen.iter().filter(|supervised| is(&supervised.diagnosed.what)).count()
    };
    let holes = seen.len();
    let within = count(|what| matches!(what, Diagnosis::WithinBand | Diagnosis::Worn(_)));
    let learnt = count(|what| matches!(what, Diagnosis::Learning(_)));
    let mut said = format!("supervision: T{tool}: of {holes} holes {within} within the band");
    if learnt > 0 {
        let _ = write!(said, ", {learnt} before there was one");
    }
    let off = holes - within - learnt;
    if off > 0 {
        let _ = write!(said, ", {off} not");
    }
    if let Some(last) = seen.last().filter(|_| within > 0) {
        let _ = write!(said, "; torque {:.0} % of that of the first holes", last.level * 100.0);
        if let Some((slope, error)) = last.slope {
            said += &trend(slope, error, last.level);
        }
    }
    said.push('\n');
    said
}

/// How the torque changes from hole to hole.
fn trend(slope: f64, error: f64, level: f64) -> String {
    let sure = sync::supervision::band::Slope { per_hole: slope, error, now: level };
    match sure.holes_left() {
        Some(left) => format!(
            ", rising by {:.2} ± {:.2} % a hole: worn in about {left:.0} holes",
            slope * 100.0,
            error * 100.0
        ),
        None => ", no significant trend".to_owned(),
    }
}

/// Why taps are not supervised though the machine's file asks for it; `None`: they are, or it does
/// not ask.
pub fn not_supervised(machine: &MachineFile) -> Option<String> {
    machine.tapping.supervision?;
    let spindle = machine.spindles.first()?;
    let why = match (&spindle.measured_torque, machine.measures_torque(0)) {
        (Some(_), _) => return None,
        (None, false) => "does not measure its torque",
        (None, true) => {
            "measures its torque, and measured_torque does not say with which noise and delay"
        }
    };
    Some(format!("supervision: not supervised: the drive of {} {why}\n", spindle.name))
}
