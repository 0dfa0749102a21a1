//! Work offsets, touch off, and what the control believes of its tools.
use super::control::Control;
use super::ranges;
use super::request::{Accepted, Refusal, Request, ToolField};
use canon::{Axis, Tool};
use units::{Coordinate, Length};

/// Number of the parameter that holds X of the work offset G54; those of G55 follow 20 later.
const G54: usize = 5221;
/// Work offsets that there are: G54 to G59.3.
pub(super) const SYSTEMS: u8 = 9;
/// What a tool may measure, mm: more is no tool.
pub(super) const LONGEST: f64 = 2000.0;

/// What a tool may wear, mm: what is more is a slip of the pen.
const MOST_WEAR: f64 = 10.0;

/// Says what is wrong with a length or a diameter, mm, that a program has given a tool.
pub(super) fn check_measure(what: &str, tool: u32, value: f64, from: f64) -> Option<String> {
    (!(from..=LONGEST).contains(&value)).then(|| {
        format!("the {what} of T{tool} is from {from:.0} to {LONGEST:.0} mm, found {value}")
    })
}

impl Control {
    /// The number of the work offset in force, 1 for G54.
    pub(super) fn work_offset(&self) -> u8 {
        self.data.rest.as_ref().map_or(1, interp::OpsRest::work_offset)
    }

    /// Where a work offset has its zero along an axis, machine coordinates.
    pub fn zero_of(&self, system: u8, axis: Axis) -> Coordinate {
        Coordinate::new(self.data.parameters.get(parameter(system, axis)).unwrap_or(0.0))
    }

    /// How far the tool's tip stands from where the axis is.
    pub(super) fn tip(&self, axis: Axis) -> Coordinate {
        let tool = self.data.tools.get(self.mounted()).filter(|_| axis == Axis::Z);
        tool.map_or(Coordinate::ZERO, |tool| Coordinate::linear(tool.length + tool.wear.length))
    }

    pub(super) fn touch_off(&mut self, axis: Axis, at: Coordinate) -> Result<Accepted, Refusal> {
        self.axis_file(axis)?;
        let system = self.work_offset();
        let turned = self.data.parameters.get(parameter(system, Axis::X) + 9).unwrap_or(0.0);
        if turned != 0.0 && matches!(axis, Axis::X | Axis::Y) {
            return Err(Refusal::because(format!(
                "{} is turned by {turned} deg: touch off with its rotation at 0",
                name(system)
            )));
        }
        let Some(setpoint) = self.executor.kernel.setpoint(axis) else {
            return Err(Refusal::because("the axis has no position yet: power on first"));
        };
        self.set_work_offset(system, axis, setpoint - self.tip(axis) - at)
    }

    pub(super) fn set_work_offset(
        &mut self,
        system: u8,
        axis: Axis,
        at: Coordinate,
    ) -> Result<Accepted, Refusal> {
        self.axis_file(axis)?;
        if !(1..=SYSTEMS).contains(&system) {
            return Err(Refusal::because("work offsets are G54 to G59.3, numbered 1 to 9"));
        }
        // a touch off sets what no request has named
        ranges::check(&Request::SetWorkOffset(system, axis, at), &self.base.machine)?;
        let before = self.zero_of(system, axis);
        if !self.data.parameters.set(parameter(system, axis), at.value()) {
            return Err(Refusal::because("a work offset needs a number"));
        }
        if let Err(why) = self.keep_parameters() {
            self.data.parameters.set(parameter(system, axis), before.value());
            return Err(why);
        }
        let (letter, at) = (axis.letter(), axis.reading(at));
        Ok(Accepted {
            notes: vec![format!("{}: {letter} is at {at:.4} of the machine", name(system))],
        })
    }

    pub(super) fn edit_tool(
        &mut self,
        number: u32,
        field: ToolField,
        value: f64,
    ) -> Result<Accepted, Refusal> {
        let is_wear = matches!(field, ToolField::WearLength | ToolField::WearRadius);
        if is_wear && (!value.is_finite() || value.abs() > MOST_WEAR) {
            return Err(Refusal::because(format!(
                "wear is {MOST_WEAR:.0} mm at most, found {value}"
            )));
        }
        if !is_wear && !(0.0..=LONGEST).contains(&value) {
            return Err(Refusal::because(format!(
                "a tool measures from 0 to {LONGEST:.0} mm, found {value}"
            )));
        }
        self.change_tool(number, |tool| match field {
            ToolField::Length => tool.length = Length::mm(value),
            ToolField::Diameter => tool.diameter = Length::mm(value),
            ToolField::WearLength => tool.wear.length = Length::mm(value),
            ToolField::WearRadius => tool.wear.radius = Length::mm(value),
        })
    }

    /// Change a tool and keep it; what the disk does not take is not changed.
    pub(super) fn change_tool(
        &mut self,
        number: u32,
        change: impl FnOnce(&mut Tool),
    ) -> Result<Accepted, Refusal> {
        let Some(tool) = self.data.tools.get(number) else {
            let known: Vec<_> =
                self.data.tools.iter().map(|tool| tool.number.to_string()).collect();
            return Err(Refusal::because(format!(
                "there is no tool {number}: the table has {}",
                known.join(", ")
            )));
        };
        let before = tool.clone();
        let mut changed = tool.clone();
        change(&mut changed);
        self.data.tools.insert(changed);
        if let Err(why) = self.keep_tools() {
            self.data.tools.insert(before);
            return Err(why);
        }
        Ok(Accepted::default())
    }

    /// The tools, as the control believes them to be.
    pub fn tools(&self) -> impl Iterator<Item = &Tool> {
        self.data.tools.iter()
    }
}

pub(super) const fn parameter(system: u8, axis: Axis) -> usize {
    G54 + 20 * (system as usize - 1) + axis.index()
}

/// As a program writes it.
pub(super) fn name(system: u8) -> String {
    match system {
        1..=6 => format!("G{}", 53 + system),
        _ => format!("G59.{}", system - 6),
    }
}
