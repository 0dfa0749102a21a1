//! What forbids a polygon that a program orders, before anything moves: its gearing and cutter, and what is written to
//! swing against the axes' travel, speed, acceleration and jerk.
use super::{drives, host, kept};
use canon::{Oscillating, Oscillation, Polygon};
use forms::polygon::Form;
use plan::sampled;
use std::f64::consts::TAU;
use store::machine::MachineFile;
use units::{Length, Spin};

/// A little over a limit is within it: programs round.
const ROUNDED: f64 = 1.002;

/// Everything that is wrong with it, each with what would work.
pub(super) fn wrong(
    machine: &MachineFile,
    polygon: &Polygon,
    form: Option<&Form>,
    work: Spin,
    cut: [Length; 2],
) -> Vec<String> {
    let refusals = form.and_then(|form| form.check_roughing().err()).unwrap_or_default();
    let mut all: Vec<String> = refusals.into_iter().map(|refusal| refusal.0).collect();
    for oscillation in &polygon.oscillations {
        travel(machine, oscillation, cut, &mut all);
        rates(machine, polygon, oscillation, work, &mut all);
    }
    all
}

/// Whether the swing about the place of the cut stays within the axis' travel.
fn travel(
    machine: &MachineFile,
    oscillation: &Oscillation,
    cut: [Length; 2],
    all: &mut Vec<String>,
) {
    let Oscillating::Axis(letter) = oscillation.on else { return };
    let Some(axis) = machine.axes.iter().flatten().find(|axis| axis.letter == letter) else {
        return all.push(format!("{} shall swing, and the machine lacks it", letter.letter()));
    };
    let Some(middle) = cut.get(letter.index()) else { return };
    let nodes = sampled(&oscillation.harmonics);
    let [low, high] = [f64::min, f64::max].map(|of| nodes.iter().copied().fold(0.0, of));
    let (least, most) = ((axis.travel.from - *middle).value(), (axis.travel.to - *middle).value());
    if low < least || high > most {
        let room = most.min(-least).max(0.0);
        all.push(format!(
            "{} swings from {low:.3} to {high:.3} mm about the cut, and its travel ends {least:.3} and {most:.3} mm from there: an amplitude of {room:.3} mm works",
            letter.letter()
        ));
    }
}

/// Whether what swings can be that fast; the speed of the work that works follows from the power of each rate.
fn rates(
    machine: &MachineFile,
    polygon: &Polygon,
    oscillation: &Oscillation,
    work: Spin,
    all: &mut Vec<String>,
) {
    let repeats = work / polygon.period();
    let peaks = host::peaks(&sampled(&oscillation.harmonics), repeats);
    let most = drives::most(machine, oscillation.on, polygon, work);
    let (names, units, scale) = match oscillation.on {
        Oscillating::Axis(_) => {
            (["speed", "acceleration", "jerk"], ["mm/s", "m/s²", "m/s³"], [1.0, 1e-3, 1e-3])
        }
        Oscillating::ToolPhase => {
            (["speed", "acceleration", "jerk"], ["rad/s", "rad/s²", "rad/s³"], [TAU; 3])
        }
    };
    // the rate that asks for the slowest work says it all
    let slowest = (0..3)
        .filter(|i| peaks[*i] > most[*i] * ROUNDED)
        .map(|i| (work.abs().in_rpm() * (most[i] / peaks[i]).powf(1.0 / (i + 1) as f64), i))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((rpm, i)) = slowest {
        all.push(format!(
            "the {} of {}, {:.1} {}, is more than the {:.1} {} that it may swing with: S{:.0} works, or a smaller swing",
            names[i],
            kept::name(oscillation.on),
            peaks[i] * scale[i],
            units[i],
            most[i] * scale[i],
            units[i],
            rpm.floor()
        ));
    }
}
