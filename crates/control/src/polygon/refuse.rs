//! What forbids a polygon that a program orders, before anything moves: its gearing and cutter, and
//! what is written to swing against the axes' travel, speed, acceleration and jerk.
use super::{drives, kept};
use crate::services::polygon as measuring;
use canon::{Oscillating, Oscillation, Polygon};
use forms::polygon::Form;
use plan::sampled;
use std::f64::consts::TAU;
use store::machine::MachineFile;
use units::{Length, Spin};

/// A little over a limit is within it: programs round.
const ROUNDED: f64 = 1.002;

/// From the bar to the tips of a cutter that is clear of it.
const CLEARANCE: Length = Length::mm(2.0);

/// Everything that is wrong with what is written to swing, each with what would work.
pub fn swings(
    machine: &MachineFile,
    polygon: &Polygon,
    work: Spin,
    cut: [Length; 2],
) -> Vec<String> {
    let mut all = Vec::new();
    for oscillation in &polygon.oscillations {
        travel(machine, oscillation, cut, &mut all);
        rates(machine, polygon, oscillation, work, &mut all);
    }
    all
}

/// Everything that is wrong with the form when it is finished, and with the cutter in its place.
pub fn form(machine: &MachineFile, form: &Form, zero: Length) -> Vec<String> {
    match form.check() {
        Err(refusals) => refusals.into_iter().map(|refusal| refusal.0).collect(),
        Ok(()) => cutter(machine, form, zero),
    }
}

/// Distance of the axes with the cutter clear of the bar.
pub fn clear(form: &Form) -> Length {
    form.tip_radius + form.stock_radius + CLEARANCE
}

/// Whether X comes near enough for the cut, and far enough to take the cutter off the bar; `zero`
/// is machine X of the work's axis.
pub fn cutter(machine: &MachineFile, form: &Form, zero: Length) -> Vec<String> {
    let axis = machine.axes.iter().flatten().find(|axis| axis.letter == canon::Axis::X);
    let Some(axis) = axis else { return Vec::new() };
    let (least, most) = (axis.travel.from.of_linear() - zero, axis.travel.to.of_linear() - zero);
    let (cut, clear) = (form.centres(), clear(form));
    let works = |radius: Length| {
        format!("Ø{:.3} works, a tip radius of {:.3} mm", 2.0 * radius.value(), radius.value())
    };
    let mut all = Vec::new();
    if cut < least {
        all.push(format!(
            "the cutter is too small: at the cut the axes would be {:.3} mm apart, X comes to {:.3} mm from the work's axis: {}",
            cut.value(),
            least.value(),
            works(least - form.across_flats / 2.0)
        ));
    }
    if clear > most {
        all.push(format!(
            "the cutter is too big: clear of the bar the axes are {:.3} mm apart, X goes to {:.3} mm from the work's axis: {}",
            clear.value(),
            most.value(),
            works(most - (clear - form.tip_radius))
        ));
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
    let (least, most) = (
        (axis.travel.from.of_linear() - *middle).value(),
        (axis.travel.to.of_linear() - *middle).value(),
    );
    if low < least || high > most {
        let room = most.min(-least).max(0.0);
        all.push(format!(
            "{} swings from {low:.3} to {high:.3} mm about the cut, and its travel ends {least:.3} and {most:.3} mm from there: an amplitude of {room:.3} mm works",
            letter.letter()
        ));
    }
}

/// Whether what swings can be that fast; the speed of the work that works follows from the power of
/// each rate.
fn rates(
    machine: &MachineFile,
    polygon: &Polygon,
    oscillation: &Oscillation,
    work: Spin,
    all: &mut Vec<String>,
) {
    let repeats = work / polygon.period();
    let peaks = measuring::peaks(&sampled(&oscillation.harmonics), repeats);
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
