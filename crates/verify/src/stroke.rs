//! Where the tool's tip is in the hole, from a recorded sample.
//!
//! ```text
//!        axis ──┬── gauge line                       c = axis + tool_deflection
//!               │                                    tip = c − tool length
//!               │  tool length                       depth = sense · (c − surface)
//!   surface ─ ─ │─ ─ ─ ─ ─                           sense = −1 for a tool that cuts towards −Z
//!               ▼ tip        ↓ depth
//! ```
//!
//! Op and sample both speak of the axis, so the tool's length cancels out, unless the stock's real
//! top is known: then depth counts from there.
use bus::Sample;
use canon::{Axis, Position};
use units::Length;

/// Below this the tip counts as in the material: less is the axis' own noise at the R plane.
const TOUCH_MM: f64 = 0.02;
/// Coordinates nearer than this are one and the same, written twice.
const SAME_MM: f64 = 1e-4;

/// Straight in and out along one axis.
#[derive(Clone, Debug)]
pub(crate) struct Stroke {
    axis: usize,
    across: [usize; 2],
    /// −1: into the material is towards negative coordinates.
    pub(crate) sense: f64,
    start_mm: f64,
    surface_mm: f64,
    programmed_at_mm: [f64; 2],
    /// Programmed depth of the tip.
    pub(crate) programmed_mm: f64,
    touch_mm: f64,
    /// Length of the tool, if the program ran without its offset.
    offset_forgotten_mm: Option<f64>,
}

impl Stroke {
    /// From what the op says.
    pub(crate) fn new(axis: Axis, start: &Position, surface: Length, bottom: Length) -> Self {
        let start_mm = start.along(axis).value();
        let sense = if bottom.value() > start_mm { 1.0 } else { -1.0 };
        let programmed_mm = sense * (bottom - surface).value();
        let across = match axis {
            Axis::X => [Axis::Y, Axis::Z],
            Axis::Y => [Axis::X, Axis::Z],
            _ => [Axis::X, Axis::Y],
        };
        Self {
            axis: axis.index(),
            across: across.map(Axis::index),
            sense,
            start_mm,
            surface_mm: surface.value(),
            programmed_at_mm: across.map(|a| start.along(a).value()),
            programmed_mm,
            touch_mm: TOUCH_MM.min(programmed_mm.abs() * 0.1),
            offset_forgotten_mm: None,
        }
    }

    /// Count depth from the stock's real top where that lies in the stroke. Where the op takes its depth
    /// from the stock's top as if the tool had no length, none was in force: then the tip really is
    /// that much deeper than ordered.
    pub(crate) fn with_stock_top(mut self, top: Length, tool_length: Length) -> Self {
        if self.axis != Axis::Z.index() || self.sense > 0.0 {
            return self;
        }
        let bottom_mm = self.coordinate_mm(self.programmed_mm);
        let real_mm = (top + tool_length).value();
        let offset_mm = self.surface_mm - top.value();
        let forgotten = self.surface_mm != self.start_mm
            && offset_mm.abs() < SAME_MM
            && tool_length.value() > SAME_MM;
        if forgotten {
            self.offset_forgotten_mm = Some(tool_length.value());
            self.surface_mm = real_mm;
        } else if bottom_mm < real_mm && real_mm < self.start_mm {
            self.surface_mm = real_mm;
            self.programmed_mm = real_mm - bottom_mm;
        }
        self
    }

    /// Coordinate of the axis.
    pub(crate) fn axis_mm(&self, sample: &Sample) -> f64 {
        axis_mm(sample, self.axis)
    }

    /// Coordinate of the axis plus the tool's deflection.
    pub(crate) fn edge_mm(&self, sample: &Sample) -> f64 {
        let deflection = sample.truth.as_ref().map_or(0.0, |t| t.tool_deflection.value());
        axis_mm(sample, self.axis) + deflection
    }

    /// Depth below the surface of such a coordinate.
    pub(crate) fn depth_mm(&self, edge_mm: f64) -> f64 {
        self.sense * (edge_mm - self.surface_mm)
    }

    /// Coordinate of a depth, the inverse of [`Self::depth_mm`].
    pub(crate) fn coordinate_mm(&self, depth_mm: f64) -> f64 {
        self.surface_mm + self.sense * depth_mm
    }

    /// Depth of the start: negative, above the surface.
    pub(crate) fn start_depth_mm(&self) -> f64 {
        self.depth_mm(self.start_mm)
    }

    /// Whether the tip is in the material at this depth.
    pub(crate) fn cuts(&self, depth_mm: f64) -> bool {
        depth_mm > self.touch_mm
    }

    /// The two axes across the tool, where they are.
    pub(crate) fn across_mm(&self, sample: &Sample) -> [f64; 2] {
        self.across.map(|a| axis_mm(sample, a))
    }
}

/// [`Sample::axis`] without copying the whole truth.
fn axis_mm(sample: &Sample, axis: usize) -> f64 {
    sample.truth.as_ref().map_or(sample.feedback.axes[axis].position, |t| t.axes[axis]).value()
}

/// What every feature keeps of its samples in the material.
#[derive(Clone, Debug)]
pub(crate) struct Visit {
    /// Deepest tip; negative if it never reached the surface.
    pub(crate) deepest_mm: f64,
    /// Depth at the last sample.
    pub(crate) last_mm: f64,
    /// First and last time in the material.
    pub(crate) times_s: Option<[f64; 2]>,
    /// Depth at which the tool broke.
    pub(crate) broken_at_mm: Option<f64>,
    /// A recorded value was not a number: nothing measured here can be trusted.
    unreadable: bool,
    sum_mm: [f64; 2],
    count: f64,
    position_error_mm: f64,
}

impl Visit {
    pub(crate) const fn new() -> Self {
        Self {
            deepest_mm: f64::NEG_INFINITY,
            last_mm: f64::NEG_INFINITY,
            times_s: None,
            broken_at_mm: None,
            unreadable: false,
            sum_mm: [0.0; 2],
            count: 0.0,
            position_error_mm: 0.0,
        }
    }

    /// A sample with a value that is not a number.
    pub(crate) const fn spoil(&mut self) {
        self.unreadable = true;
    }

    /// Take one sample; answers whether the tip was in the material.
    pub(crate) fn sample(&mut self, stroke: &Stroke, sample: &Sample, depth_mm: f64) -> bool {
        let [x, y] = stroke.across_mm(sample);
        if !(depth_mm.is_finite() && x.is_finite() && y.is_finite()) {
            self.spoil();
            return false;
        }
        self.last_mm = depth_mm;
        if sample.truth.as_ref().is_some_and(|t| t.tool_broken) {
            self.broken_at_mm.get_or_insert(depth_mm);
            return false; // what is left of the tool cuts nothing that could be measured
        }
        self.deepest_mm = self.deepest_mm.max(depth_mm);
        if !stroke.cuts(depth_mm) {
            return false;
        }
        let now_s = sample.feedback.time.value();
        self.times_s = Some([self.times_s.map_or(now_s, |[first, _]| first), now_s]);
        let [px, py] = stroke.programmed_at_mm;
        self.sum_mm[0] += x - px;
        self.sum_mm[1] += y - py;
        self.count += 1.0;
        self.position_error_mm = self.position_error_mm.max((x - px).hypot(y - py));
        true
    }

    /// Mean position in the material; the programmed one if it never was there.
    pub(crate) fn position(&self, stroke: &Stroke) -> [Length; 2] {
        let n = self.count.max(1.0);
        let [px, py] = stroke.programmed_at_mm;
        [Length::mm(px + self.sum_mm[0] / n), Length::mm(py + self.sum_mm[1] / n)]
    }

    /// Largest distance from the programmed position while in the material.
    pub(crate) const fn position_error(&self) -> Length {
        Length::mm(self.position_error_mm)
    }

    /// What is wrong with any feature whatever it is; empty if nothing.
    pub(crate) fn findings(&self, stroke: &Stroke, position_tolerance: Length) -> Vec<String> {
        let mut findings = Vec::new();
        if let Some(length_mm) = stroke.offset_forgotten_mm {
            findings.push(format!(
                "no tool length offset was in force (G43): the tip of a tool {length_mm:.3} mm long went that much deeper than ordered"
            ));
        }
        if self.unreadable {
            findings.push("the record holds a position or angle that is not a number".into());
        }
        if let Some(depth) = self.broken_at_mm {
            findings.push(if depth > 0.0 {
                format!("the tool broke {depth:.2} mm deep")
            } else {
                "the tool was broken before it touched".into()
            });
        }
        if self.times_s.is_none() {
            findings.push(if self.deepest_mm.is_finite() {
                format!(
                    "never cut: the tip came no nearer than {:.3} mm to the surface",
                    -self.deepest_mm
                )
            } else {
                "never cut: the program ended before it".into()
            });
        } else if stroke.cuts(self.last_mm) {
            findings.push(format!("the tool was left {:.2} mm deep in the material", self.last_mm));
        }
        if self.position_error() > position_tolerance {
            findings.push(format!(
                "{:.0} µm off its position, {:.0} µm allowed",
                self.position_error().in_um(),
                position_tolerance.in_um()
            ));
        }
        findings
    }
}
