//! What the control itself does of polygons: the oscillation that G51.2 leaves to it, the answers
//! of the drives that swing, and what forbids a polygon before anything moves.
//!
//! ```text
//!   G51.2 … D, E1 ─► oscillation: solve ─► refuse ─► planner
//!                        ▲        ▲
//!        kept: measured before    drives: slide, servo (describing functions)
//! ```
pub mod cuts;
pub mod drives;
pub mod kept;
pub mod oscillation;
pub mod refuse;
mod servo;
mod slide;

pub use servo::Servo;
pub use slide::Slide;

use forms::polygon::{Actuator, Detail, Form, Problem, Solution};
use store::machine::MachineFile;
use units::{Length, Spin};

/// Actuators within this of the flattest are as good; the first of the list is taken.
pub const AS_FLAT: Length = Length::um(0.2);
/// How much flatter a finer oscillation can be than one of a few harmonics, generously.
pub const NEAR: f64 = 1.5;
/// Slowest work spindle that is looked at.
pub const SLOWEST_RPM: f64 = 10.0;
/// Harmonics of each oscillation where nothing binds; where something does, as many as it takes.
pub const HARMONICS: usize = 4;
/// Harmonics of which the answer of a loop is asked.
pub const FINE_HARMONICS: usize = 96;

/// Who may swing, in the order of preference among equals: a spindle's phase costs a few newton
/// metres.
pub const CANDIDATES: [(&str, &[Actuator]); 6] = [
    ("tool phase", &[Actuator::ToolPhase]),
    ("Y", &[Actuator::Across]),
    ("X", &[Actuator::CentreLine]),
    ("X and Y", &[Actuator::CentreLine, Actuator::Across]),
    ("X and tool phase", &[Actuator::CentreLine, Actuator::ToolPhase]),
    ("X, Y, tool phase", &[Actuator::CentreLine, Actuator::Across, Actuator::ToolPhase]),
];

/// Whether these are what is ordered to swing.
pub fn may_swing(order: canon::Actuator, who: &[Actuator]) -> bool {
    use Actuator::{Across, CentreLine, ToolPhase};
    match order {
        canon::Actuator::Any => true,
        canon::Actuator::CentreLine => who == [CentreLine],
        canon::Actuator::Across => who == [Across],
        canon::Actuator::Both => who == [CentreLine, Across],
        canon::Actuator::ToolPhase => who == [ToolPhase],
        canon::Actuator::CentreLineAndPhase => who == [CentreLine, ToolPhase],
        canon::Actuator::All => who == [CentreLine, Across, ToolPhase],
    }
}

/// The first of these problems whose solution is as flat as the flattest, solved as finely as its
/// limits ask for.
pub fn flattest<'f, T>(problems: impl Iterator<Item = (T, Problem<'f>)>) -> Option<(T, Solution)> {
    let mut found = Vec::new();
    for (name, problem) in problems {
        let Some(few) = problem.solve() else { continue };
        let no_other_is_flatter = few.flatness <= AS_FLAT;
        found.push((name, problem, few));
        if no_other_is_flatter {
            break;
        }
    }
    let least = found.iter().map(|(.., few)| few.flatness.value()).fold(f64::INFINITY, f64::min);
    let mut best: Option<(T, Solution)> = None;
    // what is far behind with a few harmonics does not win with many
    for (name, problem, few) in found.into_iter().filter(|f| f.2.flatness.value() <= least * NEAR) {
        let solution = problem.refined(few, Detail::Full);
        if best.as_ref().is_none_or(|(_, b)| solution.flatness + AS_FLAT < b.flatness) {
            best = Some((name, solution));
        }
    }
    best
}

/// The fastest speed in rpm that passes, between one that may and one that does not; `None`: not
/// even the slowest does.
pub fn fastest([slow, fast]: [f64; 2], near: f64, passes: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut good, mut bad) = ((fast / 2.0).max(slow), fast);
    while !passes(good) {
        if good <= slow {
            return None;
        }
        (good, bad) = ((good / 2.0).max(slow), good);
    }
    while bad - good > near {
        let middle = f64::midpoint(good, bad);
        if passes(middle) { good = middle } else { bad = middle }
    }
    Some(good)
}

/// The problem of these actuators on this machine, as their loops answer.
pub fn problem<'f>(
    machine: &MachineFile,
    form: &'f Form,
    work: Spin,
    who: &[Actuator],
    answers: &[Vec<[f64; 2]>],
    harmonics: usize,
) -> Option<Problem<'f>> {
    let drive = |(a, answers): (&Actuator, &Vec<[f64; 2]>)| {
        drives::drive(machine, *a, form, work, FINE_HARMONICS.max(harmonics), answers)
    };
    let drives = who.iter().zip(answers).map(drive).collect::<Option<Vec<_>>>()?;
    Some(Problem { form, spin: work, drives, harmonics })
}
