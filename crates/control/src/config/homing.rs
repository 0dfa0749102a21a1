//! How the axes of a machine are homed, and what the simulated machine has for it.
use kernel::{HomingMethod, HomingOrder};
use store::machine::{self, Axis, MachineFile};
use units::Coordinate;

/// A switch is let go of so much later than it is actuated, mm or ° (estimate: an inductive
/// switch).
const HYSTERESIS: Coordinate = Coordinate::new(0.05);

/// One axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisHoming {
    /// Which.
    pub axis: canon::Axis,
    /// Axes of lower numbers are homed first, those of equal numbers together.
    pub order: u32,
    /// How; what the operator says of an axis that is homed by his word takes the place of its
    /// reference.
    pub how: HomingOrder,
}

/// All axes of a machine, in the order in which they are homed.
pub fn homing(machine: &MachineFile) -> Vec<AxisHoming> {
    let axes = machine.axes.iter().flatten();
    let mut all: Vec<_> = axes
        .map(|file| AxisHoming { axis: file.letter, order: file.homing.order, how: how(file) })
        .collect();
    all.sort_by_key(|homing| homing.order);
    all
}

fn how(file: &Axis) -> HomingOrder {
    let homing = &file.homing;
    HomingOrder {
        method: match homing.method {
            machine::HomingMethod::SwitchAndIndex => HomingMethod::SwitchAndIndex,
            machine::HomingMethod::Switch => HomingMethod::Switch,
            machine::HomingMethod::Index => HomingMethod::Index,
            machine::HomingMethod::HardStop => HomingMethod::HardStop,
            machine::HomingMethod::Absolute => HomingMethod::Absolute,
            machine::HomingMethod::Given => HomingMethod::Given,
        },
        positive: homing.positive,
        off_switch: homing.off_switch,
        fast: homing.fast.value(),
        slow: homing.slow.value(),
        accel: file.approach.acceleration.value(),
        jerk: file.jerk_rapid.value(),
        reference: homing.reference.value(),
        search: homing.search(file.letter, &file.travel, file.ends.as_ref()).value(),
        index_spacing: homing.index_every.value(),
        pull_off: homing.pull_off.value(),
        force_share: homing.force_share,
    }
}

/// What stands along an axis of the simulated machine.
pub(super) fn along(file: &Axis) -> sim::Travel {
    let homing = &file.homing;
    let ends = |beyond: fn(&machine::Ends) -> Coordinate| {
        let beyond = beyond(file.ends.as_ref()?);
        Some((file.travel.from - beyond, file.travel.to + beyond))
    };
    let (from, to, every) = homing.cam(file.letter, &file.travel);
    let switched = matches!(
        homing.method,
        machine::HomingMethod::SwitchAndIndex | machine::HomingMethod::Switch
    );
    sim::Travel {
        // as stiff as the screw that pushes against them
        stops: ends(|ends| ends.hard_stops).map(|(from, to)| (from, to, file.structure.stiffness)),
        limit_switches: ends(|ends| ends.limit_switches),
        home_switch: switched.then_some(sim::HomeSwitch {
            from,
            to,
            every,
            hysteresis: HYSTERESIS,
        }),
        index: Some(sim::IndexMarks { at: homing.reference, every: homing.index_every }),
        absolute: homing.method == machine::HomingMethod::Absolute,
    }
}
