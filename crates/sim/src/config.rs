//! What a simulated machine is made from: plain data, checked as a whole.
//!
//! The physics step divides the servo period. It must resolve the fastest vibration of every axis:
//! with position Verlet h·ω = 0.5 errs by 1 % in frequency, and h·ω = 2 explodes.
//! [`Config::problems`] refuses what is coarser than 0.5 and says which step would do.
use crate::cutting::ForceScatter;
use crate::oracle::free_mode;
use crate::rng::Rng;
use crate::scatter::{Draws, drawn, of_part};
use crate::{AxisEncoder, AxisModel, CarouselModel, PowerOn, SpindleModel, Stock, Tool, ToolKind};
use core::f64::consts::TAU;
use units::{Length, Per, Spread, Time};

/// Coarsest step, in radians of the fastest mode.
const COARSEST_STEP_RAD: f64 = 0.5;
/// Most physics steps in one servo period: a bound on the time one exchange takes.
const MOST_SUBSTEPS: usize = 1000;
/// Longest command delay, in periods.
const MOST_DELAY: usize = 16;

/// A machine to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Servo period.
    pub period: Time,
    /// Physics step; 10–25 µs as a rule. The period must be a whole number of them.
    pub substep: Time,
    /// Periods that a command is on its way: with 0 it is obeyed from the moment of the feedback
    /// that it answers, which no real control can; 1 is usual on a field bus.
    pub command_delay: usize,
    /// Axes, each with its index on the bus (X is 0).
    pub axes: Vec<(usize, AxisModel)>,
    /// Spindles, in their order on the bus. The tool is in the first.
    pub spindles: Vec<SpindleModel>,
    /// Tools that the changer can reach.
    pub magazine: Vec<Tool>,
    /// Tool in the spindle at the start; 0 is none.
    pub tool: u32,
    /// From the order to the new tool.
    pub tool_change_time: Time,
    /// The hardware of a changer that a control works step by step by its outputs; the changer that
    /// takes a number then only repeats it.
    pub carousel: Option<CarouselModel>,
    /// The workpiece, if there is one.
    pub stock: Option<Stock>,
    /// How the cutting force differs from its nominal value, as a share, and from what to what.
    /// What axes and spindles scatter by stands in their models.
    pub scatter: Spread,
    /// How the strength of the material does, as a share.
    pub material: Spread,
    /// Number of the workpiece on this machine, from 1.
    pub part: u32,
    /// Seed of all chance.
    pub seed: u64,
    /// What is so when it is switched on.
    pub power_on: PowerOn,
}

impl Config {
    /// Physics steps in one period.
    pub(crate) fn substeps(&self) -> usize {
        (self.period / self.substep).round() as usize
    }

    /// Of this workpiece: factor on what it costs to cut it.
    pub fn strength(&self) -> f64 {
        /// The stream of the material.
        const MATERIAL: u64 = 0x4D41_5445_5249_414C;
        1.0 + drawn(&self.material, self.seed, MATERIAL, self.part)
    }

    /// How the force of the cut scatters from hole to hole of this workpiece.
    pub(crate) fn cut(&self, stream: Rng) -> ForceScatter {
        /// The stream of what all holes have in common.
        const COMMON: u64 = 0x4355_5454_494E_4721;
        let scatter = self.scatter;
        let common =
            (scatter.per != Per::Hole).then(|| 1.0 + drawn(&scatter, self.seed, COMMON, self.part));
        ForceScatter { scatter, common, holes: Draws::new(of_part(stream, self.part), 1) }
    }

    /// Everything that is wrong with it, each in one sentence; empty if it can be built.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        self.check_steps(&mut found);
        for (at, (index, axis)) in self.axes.iter().enumerate() {
            if *index >= bus::AXES {
                found.push(format!("axis index {index}: the bus has axes 0 to {}", bus::AXES - 1));
            }
            if self.axes[..at].iter().any(|(other, _)| other == index) {
                found.push(format!("axis index {index} is given twice"));
            }
            check_axis(*index, axis, self.substep, &mut found);
        }
        if self.spindles.len() > bus::SPINDLES {
            let (have, most) = (self.spindles.len(), bus::SPINDLES);
            found.push(format!("{have} spindles: the bus has {most}"));
        }
        for (index, spindle) in self.spindles.iter().enumerate() {
            check_spindle(index, spindle, self.substep, &mut found);
        }
        self.check_tools(&mut found);
        self.check_stock(&mut found);
        for (what, scatter) in [("scatter", self.scatter), ("material", self.material)] {
            let most = scatter.most();
            if !(0.0..0.5).contains(&most) {
                found.push(format!("{what} {most}: a share from 0 to below 0.5 is needed"));
            }
        }
        found
    }

    fn check_steps(&self, found: &mut Vec<String>) {
        let mut need = Needs { of: "machine", found };
        need.positive("servo period", self.period.value(), "s");
        need.positive("physics step", self.substep.value(), "s");
        need.not_negative("tool change time", self.tool_change_time.value(), "s");
        let ratio = self.period / self.substep;
        if ratio.is_finite() && (ratio.round() < 1.0 || (ratio - ratio.round()).abs() > 1e-6) {
            let (period, step) = (self.period, self.substep);
            let works = self.period / ratio.ceil().max(1.0);
            found.push(format!(
                "a period of {period} is no whole number of steps of {step}: {works} would do"
            ));
        }
        if self.command_delay > MOST_DELAY {
            found.push(format!(
                "a command delay of {} periods: {MOST_DELAY} is the most",
                self.command_delay
            ));
        }
        if ratio > MOST_SUBSTEPS as f64 {
            let works = self.period / MOST_SUBSTEPS as f64;
            found.push(format!("a step of {} is too fine: {works} is the finest", self.substep));
        }
    }

    fn check_tools(&self, found: &mut Vec<String>) {
        for (at, tool) in self.magazine.iter().enumerate() {
            if tool.number == 0 {
                found.push("tool 0 means no tool: number the tools from 1".into());
            }
            if self.magazine[..at].iter().any(|other| other.number == tool.number) {
                found.push(format!("tool {} is in the magazine twice", tool.number));
            }
            check_tool(tool, found);
        }
        if self.tool != 0 && self.magazine.iter().all(|tool| tool.number != self.tool) {
            found.push(format!(
                "tool {} shall be in the spindle, but is not in the magazine",
                self.tool
            ));
        }
    }

    fn check_stock(&self, found: &mut Vec<String>) {
        let Some(stock) = &self.stock else { return };
        let mut need = Needs { of: "stock", found };
        need.finite("top", stock.top.value(), "mm");
        need.positive("specific cutting force", stock.cutting_n_per_mm2, "N/mm²");
        if let Some(thickness) = stock.thickness {
            need.positive("thickness", thickness.value(), "mm");
        }
        if let Some(s) = stock.sides {
            let (x, y) = (s.x_to - s.x_from, s.y_to - s.y_from);
            need.positive("extent in X", x.value(), "mm");
            need.positive("extent in Y", y.value(), "mm");
        }
        for hole in &stock.holes {
            need.finite("hole's x", hole.x.value(), "mm");
            need.finite("hole's y", hole.y.value(), "mm");
            for bore in &hole.bores {
                need.positive("bore's diameter", bore.diameter.value(), "mm");
                need.positive("bore's depth", bore.tip_depth.value(), "mm");
                need.not_negative("bore's cone", bore.cone.value(), "mm");
            }
        }
    }
}

/// Says what a number must be, when it is not.
struct Needs<'a> {
    of: &'a str,
    found: &'a mut Vec<String>,
}

impl Needs<'_> {
    fn hold(&mut self, holds: bool, what: &str, value: f64, unit: &str, needed: &str) {
        if !holds {
            self.found.push(format!("{}: {what} is {value} {unit}, needed is {needed}", self.of));
        }
    }
    fn positive(&mut self, what: &str, value: f64, unit: &str) {
        self.hold(value > 0.0 && value.is_finite(), what, value, unit, "a number above 0");
    }
    fn not_negative(&mut self, what: &str, value: f64, unit: &str) {
        self.hold(value >= 0.0 && value.is_finite(), what, value, unit, "0 or more");
    }
    fn finite(&mut self, what: &str, value: f64, unit: &str) {
        self.hold(value.is_finite(), what, value, unit, "a number");
    }
}

fn check_axis(index: usize, axis: &AxisModel, step: Time, found: &mut Vec<String>) {
    let before = found.len();
    let of = format!("axis {index}");
    let mut need = Needs { of: &of, found };
    // an index that no axis has is refused beside this
    let kind = units::Axis::ALL.get(index).map_or(units::AxisKind::Linear, |axis| axis.kind());
    let (unit, speed_unit) = (kind.unit().trim_start(), kind.speed_unit().trim_start());
    need.positive("table mass", axis.table.value(), "kg");
    need.positive("inertia", axis.inertia.value(), "kg·m²");
    need.positive("screw lead", axis.screw_lead.value(), unit);
    need.positive("peak torque", axis.peak_torque.value(), "N·m");
    need.not_negative("force lag", axis.force_lag.value(), "s");
    need.positive("stiffness", axis.stiffness.value(), "N/mm");
    need.not_negative("damping ratio", axis.damping_ratio, "");
    need.not_negative("backlash", axis.backlash.value(), unit);
    need.finite("weight share", axis.weight_share, "");
    need.finite("start", axis.start.value(), unit);
    let friction = &axis.friction;
    need.positive("bristle stiffness", friction.bristle_stiffness.value(), "N/mm");
    need.not_negative("bristle damping", friction.bristle_damping_n_s_per_m, "N·s/m");
    need.not_negative("viscous friction", friction.viscous_n_s_per_m, "N·s/m");
    need.positive("Coulomb force", friction.coulomb.value(), "N");
    need.positive("Stribeck speed", friction.stribeck.value(), speed_unit);
    need.hold(
        friction.breakaway >= friction.coulomb && friction.breakaway.is_finite(),
        "breakaway force",
        friction.breakaway.value(),
        "N",
        "at least the Coulomb force",
    );
    match axis.encoder {
        AxisEncoder::Motor { counts_per_rev } => {
            need.positive("encoder", f64::from(counts_per_rev), "counts/rev");
        }
        AxisEncoder::Scale { resolution, motor_counts_per_rev } => {
            need.positive("scale", resolution.value(), unit);
            if let Some(counts) = motor_counts_per_rev {
                need.positive("encoder", f64::from(counts), "counts/rev");
            }
        }
    }
    axis.travel.problems(&of, found);
    found.extend(axis.scatter.problem().map(|needed| format!("{of}: scatter: {needed}")));
    if found.len() == before {
        let stiffest = axis.stiffness * (1.0 + axis.scatter.stiffness.most());
        check_stability(index, &AxisModel { stiffness: stiffest, ..*axis }, step, found);
    }
}

/// Springs and dashpots of an axis must change little within a step.
fn check_stability(index: usize, axis: &AxisModel, step: Time, found: &mut Vec<String>) {
    let table = axis.table.value();
    let mode = free_mode(axis).natural_hz * TAU;
    let bristles = (axis.friction.bristle_stiffness.value() * 1e3 / table).sqrt();
    let dashpots = (axis.friction.bristle_damping_n_s_per_m + axis.friction.viscous_n_s_per_m)
        / table
        + 2.0 * axis.damping_ratio * mode;
    let stops = axis.travel.stops.map_or(0.0, |(.., k)| (k.value() * 1e3 / table).sqrt());
    let fastest = mode.max(bristles).max(dashpots).max(stops);
    if step.value() * fastest > COARSEST_STEP_RAD {
        let works = Time::s(COARSEST_STEP_RAD / fastest);
        let hz = fastest / TAU;
        found.push(format!(
            "axis {index}: a physics step of {step} is too coarse for {hz:.0} Hz: {works} or less would do"
        ));
    }
}

fn check_spindle(index: usize, spindle: &SpindleModel, step: Time, found: &mut Vec<String>) {
    let before = found.len();
    let of = format!("spindle {index}");
    let mut need = Needs { of: &of, found };
    need.positive("inertia", spindle.inertia.value(), "kg·m²");
    need.positive("peak torque", spindle.peak_torque.value(), "N·m");
    need.positive("peak power", spindle.peak_power.value(), "W");
    need.not_negative("torque lag", spindle.torque_lag.value(), "s");
    need.not_negative("constant friction", spindle.coulomb.value(), "N·m");
    need.not_negative("viscous friction", spindle.viscous_n_m_s_per_rad, "N·m·s/rad");
    need.positive("friction's rounding speed", spindle.rounding.value(), "rev/s");
    need.positive("encoder", f64::from(spindle.encoder.counts_per_rev), "counts/rev");
    need.finite("encoder's eccentricity", spindle.encoder.eccentricity.value(), "rev");
    need.not_negative("encoder's noise", spindle.encoder.noise_counts, "counts");
    need.finite("start", spindle.start.value(), "rev");
    if found.len() > before {
        return;
    }
    // friction brakes the spindle at this rate while it turns slower than the rounding speed
    let damping =
        spindle.coulomb.value() / spindle.rounding.in_rad_per_s() + spindle.viscous_n_m_s_per_rad;
    let fastest = damping / spindle.inertia.value();
    if step.value() * fastest > COARSEST_STEP_RAD {
        let works = Time::s(COARSEST_STEP_RAD / fastest);
        found.push(format!(
            "spindle {index}: a physics step of {step} is too coarse for its friction: {works} or less would do"
        ));
    }
}

fn check_tool(tool: &Tool, found: &mut Vec<String>) {
    let of = format!("tool {}", tool.number);
    let mut need = Needs { of: &of, found };
    need.not_negative("length", tool.length.value(), "mm");
    match &tool.kind {
        ToolKind::Drill { diameter, point_angle } => {
            need.positive("diameter", diameter.value(), "mm");
            let degrees = point_angle.in_deg();
            let holds = degrees > 0.0 && degrees <= 180.0;
            need.hold(holds, "point angle", degrees, "°", "more than 0 and at most 180");
        }
        ToolKind::Tap(tap) => {
            need.positive("diameter", tap.diameter.value(), "mm");
            let lead = tap.lead.value();
            let holds = lead != 0.0 && lead.abs() < tap.diameter.value();
            need.hold(holds, "lead", lead, "mm/rev", "not 0 and less than the diameter");
            need.positive("chamfer", tap.chamfer_pitches, "pitches");
            need.positive("flute factor", tap.flute_factor, "");
            need.positive("thread length", tap.thread_length.value(), "mm");
            need.not_negative("flank play", tap.flank_play.value(), "mm");
            need.positive("flank stiffness", tap.flank_stiffness.value(), "N/mm");
            need.positive("holder's stiffness", tap.holder.stiffness.value(), "N/mm");
            need.not_negative(
                "holder's travel",
                tap.holder.travel.unwrap_or(Length::ZERO).value(),
                "mm",
            );
            if let Some(clutch) = &tap.clutch {
                need.positive("splines' length", clutch.spline_length.value(), "mm");
                need.not_negative("pawl's backlash", clutch.pawl_backlash.value(), "rev");
                need.not_negative("compression", clutch.compression.value(), "mm");
            }
        }
        ToolKind::Insert(insert) => {
            let degrees = insert.half_angle.in_deg();
            let holds = (1.0..=89.0).contains(&degrees);
            need.hold(holds, "half of its angle", degrees, "°", "from 1 to 89");
            need.not_negative("nose radius", insert.nose.value(), "mm");
            need.not_negative("flat", insert.flat.value(), "mm");
        }
        ToolKind::Probe(probe) => {
            need.positive("ball", probe.diameter.value(), "mm");
            need.not_negative("pretravel", probe.pretravel.value(), "mm");
            let most = probe.pretravel.value();
            let lobing = probe.lobing.value();
            need.hold(
                (0.0..=most).contains(&lobing),
                "lobing",
                lobing,
                "mm",
                "from 0 to the pretravel",
            );
        }
        ToolKind::Mill { .. } | ToolKind::PolygonCutter(_) | ToolKind::Other => {}
    }
}
