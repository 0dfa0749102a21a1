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
//! Surface and depth are those of the stock as it is clamped, by the length of the tool that is in
//! the spindle. The ordered depth counts from the program's zero, with the offsets that the program
//! had in force:
//!
//! ```text
//!   real     stock's top − (axis − length of the tool)
//!   ordered  (program's zero − bottom) + (stock's top − work's zero)
//! ```
//!
//! So a wrong H, a forgotten G43 and a zero that was shifted are errors of depth. Without a stock
//! the op's own surface counts, and nothing can be said of contact.
use crate::workpiece::Surface;
use crate::{Contact, Stock};
use bus::Sample;
use canon::{Axis, Hole, Position, Tap, Tool, ToolLibrary};
use units::{Force, Length, Torque};

/// Below this the tip counts as in the material: less is the axis' own noise at the R plane.
const TOUCH_MM: f64 = 0.02;
/// A tool is left in the material from this share of the touch on: nearer to the surface its axis
/// stands at the R plane.
const LEFT_TOUCHES: f64 = 5.0;
/// Lengths nearer than this are one and the same, written twice.
const SAME_MM: f64 = 2e-3;

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
    along: Axis,
    zero_mm: f64,
    own_zero: Option<Length>,
    bottom_mm: f64,
    in_stock: Option<InStock>,
}

/// How a stroke lies to the stock.
#[derive(Clone, Debug)]
struct InStock {
    /// Its top is where the material begins here.
    stock: Stock,
    /// Where that is, if it is below the stock's own top.
    surface: Option<Surface>,
    /// Of the tool's circle.
    radius_mm: f64,
    /// By how much the program's zero stood above the work's for the tool that was in the spindle.
    zero_off_mm: f64,
    /// What that comes from, as far as it can be told; `None` without a tool.
    cause: Option<String>,
}

impl Stroke {
    /// Of a hole, from what the op says.
    pub(crate) fn of_hole(hole: &Hole) -> Self {
        Self::new(hole.axis, &hole.at, [hole.surface, hole.bottom, hole.zero], hole.own_zero)
    }

    /// Likewise of a tap.
    pub(crate) fn of_tap(tap: &Tap) -> Self {
        Self::new(tap.axis, &tap.start, [tap.surface, tap.bottom, tap.zero], tap.own_zero)
    }

    fn new(
        axis: Axis,
        start: &Position,
        [surface, bottom, zero]: [Length; 3],
        own_zero: Option<Length>,
    ) -> Self {
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
            along: axis,
            zero_mm: zero.value(),
            own_zero,
            bottom_mm: bottom.value(),
            in_stock: None,
        }
    }

    /// Count depth from the stock as it is clamped, for this tool. The stock is known along the
    /// spindle only.
    pub(crate) fn in_stock(
        mut self,
        (stock, surface): (Option<&Stock>, Option<Surface>),
        tool: Option<&Tool>,
        tools: &ToolLibrary,
    ) -> Self {
        let Some(stock) = stock.filter(|_| self.axis == Axis::Z.index() && self.sense < 0.0) else {
            return self;
        };
        let [length_mm, radius_mm] =
            tool.map_or([0.0; 2], |t| [t.worn_length().value(), t.diameter.value() / 2.0]);
        let zero = self.zero_in(stock);
        let surface = surface.filter(|surface| surface.lowered_mm > 0.0);
        let mut stock = *stock;
        if let Some(surface) = surface {
            stock.to[2] = Length::mm(surface.top_mm).max(stock.from[2]);
        }
        let above_zero_mm = (stock.top() - zero).value();
        let zero_off_mm = self.zero_mm - length_mm - zero.value();
        self.surface_mm = stock.top().value() + length_mm;
        self.programmed_mm = self.zero_mm - self.bottom_mm + above_zero_mm;
        self.touch_mm = TOUCH_MM.min(self.programmed_mm.abs() * 0.1);
        let cause = cause(zero_off_mm + length_mm, tool, tools);
        self.in_stock = Some(InStock { stock, surface, radius_mm, zero_off_mm, cause });
        self
    }

    /// Where the work's zero is that the program means. The set-up states that of G54. Of another
    /// work offset the program states it; where it lies in the stroke, the program says that the
    /// material begins there.
    fn zero_in(&self, stock: &Stock) -> Length {
        match self.own_zero {
            None => stock.zero[2],
            Some(_) if (self.surface_mm - self.zero_mm).abs() < SAME_MM => stock.top(),
            Some(own) => own,
        }
    }

    /// Why it is not known whether the tool was in the material.
    pub(crate) fn not_judged(&self) -> Option<String> {
        if self.in_stock.is_some() {
            return None;
        }
        let along = (self.along, self.sense < 0.0);
        Some(match along {
            (Axis::Z, true) => crate::contact::NO_STOCK.to_owned(),
            (axis, _) => format!(
                "cut along {}{}: the stock is known to the judge towards Z- only",
                axis.letter(),
                if self.sense < 0.0 { '-' } else { '+' }
            ),
        })
    }

    /// Where the material begins, if that is below the stock's top.
    pub(crate) fn surface(&self) -> Option<Surface> {
        self.in_stock.as_ref()?.surface
    }

    /// Zero of the work by the set-up, where the stock is known.
    pub(crate) fn work_zero_mm(&self) -> Option<f64> {
        let in_stock = self.in_stock.as_ref()?;
        Some(self.zero_in(&in_stock.stock).value())
    }

    /// The stroke is along the spindle, and the stock is known.
    pub(crate) const fn is_in_stock(&self) -> bool {
        self.in_stock.is_some()
    }

    /// Deepest that the record will go, as far as the op says.
    pub(crate) fn deepest_ordered_mm(&self) -> f64 {
        self.programmed_mm.max(self.depth_mm(self.bottom_mm)).max(0.0)
    }

    /// The part of a depth that lies within the stock.
    pub(crate) fn within_mm(&self, depth_mm: f64) -> f64 {
        let thickness =
            self.in_stock.as_ref().map_or(f64::INFINITY, |s| s.stock.thickness().value());
        depth_mm.clamp(0.0, thickness)
    }

    /// How far the tool's circle reaches over a side of the stock, and its diameter; `None` without
    /// a stock.
    fn over_side(&self, at_mm: [f64; 2]) -> Option<[f64; 2]> {
        let InStock { stock, radius_mm, .. } = self.in_stock.as_ref()?;
        Some([stock.over_side(at_mm, *radius_mm), 2.0 * radius_mm])
    }

    /// That the program's zero was not the work's.
    fn zero_finding(&self) -> Option<String> {
        let InStock { zero_off_mm, cause, .. } = self.in_stock.as_ref()?;
        let cause = cause.as_ref()?;
        let side = if *zero_off_mm > 0.0 { "above" } else { "below" };
        (zero_off_mm.abs() > SAME_MM).then(|| {
            format!(
                "the program's zero stood {:.3} mm {side} the work's: {cause}",
                zero_off_mm.abs()
            )
        })
    }

    /// Coordinate of the axis.
    pub(crate) fn axis_mm(&self, sample: &Sample) -> f64 {
        axis_mm(sample, self.axis)
    }

    /// Coordinate of the axis plus the tool's deflection.
    pub(crate) fn edge_mm(&self, sample: &Sample) -> f64 {
        edge_of(sample, self.axis)
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

/// Where an offset between the program's zero and the work's comes from. `in_force`: the length
/// that the program took the tool to have, if its work offset was right.
fn cause(in_force_mm: f64, tool: Option<&Tool>, tools: &ToolLibrary) -> Option<String> {
    let tool = tool?;
    let (number, length_mm) = (tool.number, tool.worn_length().value());
    let near = |mm: f64| (mm - in_force_mm).abs() < SAME_MM;
    if near(0.0) {
        return Some(format!(
            "no tool length offset was in force (G43), and T{number} is {length_mm:.3} mm long"
        ));
    }
    let other =
        tools.iter().find(|other| other.number != number && near(other.worn_length().value()));
    Some(other.map_or_else(
        || "look at the work offset (G54 to G59, G52, G92) and at the length offset (G43 H)".to_owned(),
        |other| {
            format!(
                "the length offset in force was that of T{}, {:.3} mm, and T{number} in the spindle is \
                 {length_mm:.3} mm long",
                other.number,
                other.length.value()
            )
        },
    ))
}

/// Coordinate of an axis plus the tool's deflection.
pub(crate) fn edge_of(sample: &Sample, axis: usize) -> f64 {
    let deflection = sample.truth.as_ref().map_or(0.0, |t| t.tool_deflection.value());
    axis_mm(sample, axis) + deflection
}

/// [`Sample::axis`] without copying the whole truth.
pub(crate) fn axis_mm(sample: &Sample, axis: usize) -> f64 {
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
    /// Farthest that the tool's circle reached over a side of the stock while in it.
    over_side_mm: f64,
    /// Least distance from the stock's side while below its top and beside it.
    beside_mm: Option<f64>,
    /// Largest torque and force in the material, where they can be known.
    pub(crate) torque_max: Option<Torque>,
    pub(crate) force_max: Option<Force>,
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
            over_side_mm: f64::NEG_INFINITY,
            beside_mm: None,
            torque_max: None,
            force_max: None,
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
        let over = stroke.over_side([x, y]);
        if let Some([over, diameter]) = over.filter(|[over, diameter]| over >= diameter) {
            if stroke.cuts(depth_mm) {
                let away = over - diameter;
                self.beside_mm = Some(self.beside_mm.map_or(away, |least| least.min(away)));
            }
            return false;
        }
        self.deepest_mm = self.deepest_mm.max(depth_mm);
        if !stroke.cuts(depth_mm) {
            return false;
        }
        if let Some([over, _]) = over {
            self.over_side_mm = self.over_side_mm.max(over);
        }
        if let Some(truth) = &sample.truth {
            let (torque, force) = (truth.cutting_torque.abs(), truth.cutting_force.abs());
            self.torque_max = Some(self.torque_max.map_or(torque, |most| most.max(torque)));
            self.force_max = Some(self.force_max.map_or(force, |most| most.max(force)));
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
            findings.push(self.not_cut(stroke));
        } else if self.last_mm > LEFT_TOUCHES * stroke.touch_mm {
            findings.push(format!("the tool was left {:.2} mm deep in the material", self.last_mm));
        }
        if self.over_side_mm > 0.0 {
            findings.push(format!(
                "it breaks through a side of the stock: {:.2} mm of it are in the air",
                self.over_side_mm
            ));
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

    /// Nothing was cut: how far from the stock the tool passed.
    fn not_cut(&self, stroke: &Stroke) -> String {
        if let Some(away) = self.beside_mm {
            return format!("not cut: the tool passed {away:.3} mm beside the stock");
        }
        let what = if stroke.in_stock.is_some() { "stock" } else { "surface" };
        if self.deepest_mm.is_finite() {
            let away = -self.deepest_mm;
            format!("not cut: the tip came no nearer than {away:.3} mm to the {what}")
        } else {
            "not cut: the program ended before it".into()
        }
    }

    /// What a failed feature's zero and offsets had to do with it.
    pub(crate) fn causes(stroke: &Stroke, mut findings: Vec<String>) -> Vec<String> {
        if !findings.is_empty()
            && let Some(finding) = stroke.zero_finding()
        {
            findings.push(finding);
        }
        findings
    }

    /// The evidence of contact.
    pub(crate) fn contact(&self, stroke: &Stroke) -> Contact {
        let reach = if self.times_s.is_some() { stroke.within_mm(self.deepest_mm) } else { 0.0 };
        Contact {
            reach: stroke.in_stock.is_some().then(|| Length::mm(reach)),
            torque: self.torque_max,
            force: self.force_max,
            torque_expected: None,
        }
    }
}
