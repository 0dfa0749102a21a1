//! The tool in the work: what touches what, and what comes of it.
//!
//! ```text
//!            tip below the surface
//!     Air ─┬───────────────────────► Drilling ─┐
//!      ▲   ├───────────────────────► Tapping  ─┤  breaks, or moved sideways
//!      │   └─ from the side, too wide ► Clear  ├──────────────────────────► Broken (until another tool comes)
//!      └── tip above the surface ──────────────┘
//! ```
//!
//! The tool is in spindle 0 and cuts along Z. A tool enters the work from above; one that gets
//! below the surface in another way (beside the work, or changed down there) meets nothing that is
//! simulated. A hole is known by its place: what comes down within [`SAME_HOLE`] of it is in it.
mod milled;

use crate::drilling::{self, Drilling};
use crate::mishaps::{Draw, Mishap, Mishaps};
use crate::rng::Rng;
use crate::scatter::Draws;
use crate::tapping::{self, Load, Pose, Tapping, is_too_wide};
use crate::wear::{TapWear, Worn};
use crate::work::{Bore, ENTERED_MM, Hole, SAME_HOLE, Stock};
use crate::{Tap, Tool, ToolKind};
use bus::ToolBreak;
use milled::Milled;
use units::{Angle, Length, Spread};

/// A tip that is deeper than this when it is first seen below the surface has not come from above:
/// at 100 m/min a step of 25 µs brings it 0.04 mm down.
const ENTRY_DEPTH_MM: f64 = 0.5;

/// Depth of an assumed hole in work without a lower side: more than any tap is long.
const ASSUMED_DEPTH: Length = Length::mm(1000.0);

/// What the tool is at.
#[derive(Clone, Copy, Debug)]
enum Engagement {
    /// Above the surface.
    Air,
    /// Below it, and touching nothing.
    Clear,
    /// Making or deepening a hole.
    Drilling(Drilling),
    /// In a thread.
    Tapping(Tapping),
    /// In pieces.
    Broken,
}

/// How the force of the cut scatters on a workpiece.
#[derive(Clone, Debug)]
pub(crate) struct ForceScatter {
    pub(crate) scatter: Spread,
    /// Where all holes have it in common.
    pub(crate) common: Option<f64>,
    /// What each hole's own is drawn from.
    pub(crate) holes: Draws,
}

impl ForceScatter {
    /// The same for all holes.
    #[cfg(test)]
    pub(crate) fn even() -> Self {
        let holes = Draws::new(Rng::new(1), 1);
        Self { scatter: Spread::NONE, common: None, holes }
    }

    /// On the force of the next hole.
    fn factor(&mut self) -> f64 {
        self.common.unwrap_or_else(|| self.holes.factor(&self.scatter))
    }
}

/// The work, the tools, and the one in the spindle.
#[derive(Clone, Debug)]
pub(crate) struct Cutting {
    stock: Stock,
    milled: Milled,
    magazine: Vec<Tool>,
    broken: Vec<u32>,
    /// What broke the tool in the spindle.
    broken_by: Option<ToolBreak>,
    cut: ForceScatter,
    mounted: Option<Tool>,
    engagement: Engagement,
    at: [Length; 2],
    entered: [Length; 2],
    load: Load,
    /// From this depth on a tool enters the work: 0, or a little more for one that rests at the
    /// surface, mm.
    enters_mm: f64,
    /// How far a clutch has left the tap ahead of the spindle, rev.
    slip: f64,
    /// Taps wear, if they do.
    worn: Option<Worn>,
    /// What they meet by chance, if anything.
    mishaps: Option<Draw>,
}

impl Cutting {
    /// No tool yet, in the air.
    pub(crate) fn new(stock: Stock, magazine: Vec<Tool>, cut: ForceScatter) -> Self {
        Self {
            stock,
            milled: Milled::default(),
            magazine,
            broken: Vec::new(),
            broken_by: None,
            cut,
            mounted: None,
            engagement: Engagement::Air,
            at: [Length::ZERO; 2],
            entered: [Length::ZERO; 2],
            load: Load::default(),
            enters_mm: 0.0,
            slip: 0.0,
            worn: None,
            mishaps: None,
        }
    }

    /// From here on taps wear.
    pub(crate) fn wear(&mut self, wear: TapWear, rng: Rng) {
        self.worn = Some(Worn::new(wear, rng));
    }

    /// From here on taps meet mishaps.
    pub(crate) fn meet(&mut self, mishaps: Mishaps, rng: Rng) {
        self.mishaps = Some(Draw::new(mishaps, rng));
    }

    /// What the work looks like.
    pub(crate) fn holes(&self) -> &[Hole] {
        &self.stock.holes
    }

    /// The work as it was left elsewhere.
    pub(crate) fn take_holes_of(&mut self, other: &Self) {
        self.stock.holes.clone_from(&other.stock.holes);
        self.milled.clone_from(&other.milled);
    }

    /// A new tool of this number is in the magazine, or in the spindle.
    pub(crate) fn renew_tool(&mut self, number: u32) {
        self.broken.retain(|broken| *broken != number);
        let is_mounted = self.mounted.is_some_and(|tool| tool.number == number);
        if is_mounted && self.is_broken() {
            (self.engagement, self.broken_by) = (Engagement::Clear, None);
        }
    }

    /// A block of these dimensions is clamped.
    pub(crate) const fn clamp(&mut self, stock: &Stock) {
        (self.stock.top, self.stock.thickness) = (stock.top, stock.thickness);
        self.stock.sides = stock.sides;
    }

    /// Another workpiece is clamped, with the holes that it comes with.
    pub(crate) fn renew(&mut self, holes: &[Hole]) {
        self.leave();
        self.stock.holes = holes.to_vec();
        self.milled = Milled::default();
    }

    /// At the start of a period: the tool in the spindle and where it is over the work.
    pub(crate) fn begin_period(&mut self, tool: Option<u32>, at: [Length; 2]) {
        self.at = at;
        if self.mounted.map(|t| t.number) != tool {
            self.leave();
            self.slip = 0.0;
            self.broken_by = None;
            self.mounted = self.magazine.iter().find(|t| Some(t.number) == tool).copied();
            let is_broken = self.mounted.is_some_and(|t| self.broken.contains(&t.number));
            self.engagement = if is_broken { Engagement::Broken } else { Engagement::Clear };
        }
        self.record();
        let sideways = match self.engagement {
            Engagement::Tapping(_) => tapping::SIDEWAYS_SHARE,
            Engagement::Drilling(_) => drilling::SIDEWAYS_SHARE,
            Engagement::Air | Engagement::Clear | Engagement::Broken => return,
        };
        let diameter = self.mounted.map_or(Length::ZERO, |t| t.diameter());
        let (by, most) = (distance(at, self.entered), diameter * sideways);
        if by > most {
            self.break_tool(ToolBreak::Sideways { by, most });
        }
    }

    /// Nothing to do at this pose: no tool, or above the surface and not in a thread. From above it
    /// enters as deep as it is.
    #[inline]
    pub(crate) fn is_idle(&mut self, axis_mm: f64) -> bool {
        match (self.mounted, &self.engagement) {
            (None, _) | (Some(_), Engagement::Broken) => true,
            (Some(tool), Engagement::Air) => {
                let above = axis_mm - tool.length.value() >= self.stock.top.value();
                if above {
                    self.enters_mm = 0.0;
                }
                above
            }
            (Some(_), Engagement::Clear | Engagement::Drilling(_) | Engagement::Tapping(_)) => {
                false
            }
        }
    }

    /// The work's answer to a pose, for the coming physics step.
    pub(crate) fn step(&mut self, axis_mm: f64, angle: f64, omega: f64) -> Load {
        let Some(tool) = &self.mounted else { return Load::default() };
        let pose = Pose { tip: axis_mm - tool.length.value(), angle, omega };
        let depth = self.stock.top.value() - pose.tip;
        if let (ToolKind::Mill { diameter }, Engagement::Clear) = (&tool.kind, &self.engagement) {
            self.milled.cut(self.at, *diameter, depth);
        }
        match &self.engagement {
            Engagement::Air if depth > self.enters_mm => {
                let floor = self.milled.floor(self.at, tool.diameter());
                if depth > self.enters_mm + floor {
                    self.enter(*tool, &pose, [depth, floor]);
                }
            }
            Engagement::Clear if depth <= 0.0 => self.engagement = Engagement::Air,
            Engagement::Drilling(drill) if drill.is_out(&pose) => self.leave(),
            Engagement::Tapping(tap) if tap.is_out(&pose) => self.leave(),
            Engagement::Air
            | Engagement::Clear
            | Engagement::Drilling(_)
            | Engagement::Tapping(_)
            | Engagement::Broken => {}
        }
        let answer = match &mut self.engagement {
            Engagement::Drilling(drill) => drill.step(&pose, &mut self.stock.holes[drill.hole]),
            Engagement::Tapping(tap) => {
                let load = tap.step(&pose);
                self.slip = tap.slip();
                load
            }
            Engagement::Air | Engagement::Clear | Engagement::Broken => Some(Load::default()),
        };
        self.load = answer.unwrap_or_default();
        if answer.is_none() {
            let why = match &self.engagement {
                Engagement::Drilling(drill) => Some(drill.broken_by()),
                Engagement::Tapping(tap) => Some(tap.broken_by()),
                Engagement::Air | Engagement::Clear | Engagement::Broken => None,
            };
            if let Some(why) = why {
                self.break_tool(why);
            }
        }
        self.load
    }

    /// The tip goes through the surface, or the floor that mills have left of it, so deep below it.
    fn enter(&mut self, tool: Tool, pose: &Pose, [depth, floor]: [f64; 2]) {
        let scale = self.cut.factor();
        self.entered = self.at;
        let from_above = depth - floor <= ENTRY_DEPTH_MM && self.stock.is_below(self.at);
        self.engagement = match tool.kind {
            ToolKind::Drill { diameter, point_angle } if from_above => {
                let hole = self.hole_here();
                let stock = &mut self.stock;
                let drill =
                    Drilling::begin(diameter, point_angle, (stock, floor), hole, pose, scale);
                Engagement::Drilling(drill)
            }
            ToolKind::Tap(tap) if from_above => {
                let hole = self.hole_here();
                self.assume_bore(&tap, hole);
                if is_too_wide(&self.stock.holes[hole], &tap) {
                    Engagement::Clear
                } else {
                    let dull = self.worn.as_mut().map_or(1.0, |worn| worn.factor(tool.number));
                    let scale = scale * dull;
                    let mishap = self.mishaps.as_mut().map_or(Mishap::NONE, Draw::next);
                    let stock = (&self.stock, floor);
                    let tapping = Tapping::begin(&tap, stock, hole, pose, scale, self.slip);
                    Engagement::Tapping(tapping.meeting(mishap))
                }
            }
            ToolKind::Drill { .. }
            | ToolKind::Tap(_)
            | ToolKind::Insert(_)
            | ToolKind::Probe(_)
            | ToolKind::Mill { .. }
            | ToolKind::PolygonCutter(_)
            | ToolKind::Other => Engagement::Clear,
        };
    }

    /// The hole at this place; a new one if there is none.
    fn hole_here(&mut self) -> usize {
        let [x, y] = self.at;
        let holes = &mut self.stock.holes;
        holes.iter().position(|h| distance([h.x, h.y], [x, y]) <= SAME_HOLE).unwrap_or_else(|| {
            holes.push(Hole::at(x, y));
            holes.len() - 1
        })
    }

    /// Where nothing has been drilled, and the user said that it has: D − P, through. Beside a hole
    /// that was drilled off its place nothing is assumed: there the tap meets the wall.
    fn assume_bore(&mut self, tap: &Tap, index: usize) {
        let drilled = |hole: &Hole| hole.bores.iter().any(|bore| bore.full_depth() > Length::ZERO);
        let [x, y] = self.at;
        let near = |hole: &Hole| distance([hole.x, hole.y], [x, y]) < tap.diameter;
        let is_drilled = self.stock.holes.iter().any(|hole| near(hole) && drilled(hole));
        if self.stock.assume_predrilled && !is_drilled {
            let hole = &mut self.stock.holes[index];
            let diameter = tap.diameter - Length::mm(tap.lead.value().abs());
            let tip_depth = self.stock.thickness.unwrap_or(ASSUMED_DEPTH);
            hole.bores.push(Bore { diameter, tip_depth, cone: Length::ZERO });
            hole.assumed = true;
        }
    }

    /// The tool is out of the work, or out of the spindle.
    fn leave(&mut self) {
        self.record();
        if let (Engagement::Tapping(tapping), Some(tool), Some(worn)) =
            (&self.engagement, &self.mounted, &mut self.worn)
        {
            worn.cut(tool.number, tapping.newly_cut());
        }
        self.engagement = Engagement::Air;
        self.enters_mm = ENTERED_MM;
        self.load = Load::default();
    }

    /// Write down how far a thread has got.
    fn record(&mut self) {
        if let (Engagement::Tapping(tapping), Some(Tool { kind: ToolKind::Tap(tap), .. })) =
            (&self.engagement, &self.mounted)
        {
            tapping.record(tap, &mut self.stock.holes[tapping.hole]);
        }
    }

    fn break_tool(&mut self, why: ToolBreak) {
        self.leave();
        self.broken_by = Some(why);
        self.broken.extend(self.mounted.map(|tool| tool.number));
        self.engagement = Engagement::Broken;
    }

    /// Axial offset of the edges from where the axis holds them.
    pub(crate) fn deflection(&self) -> Length {
        match &self.engagement {
            Engagement::Tapping(tap) => Length::mm(tap.deflection()),
            Engagement::Air | Engagement::Clear | Engagement::Drilling(_) | Engagement::Broken => {
                Length::ZERO
            }
        }
    }

    /// While a tap is in its thread: how far the axis holds its tip off the helix that was cut.
    pub(crate) fn off_helix(&self, axis_mm: f64, angle: f64) -> Option<Length> {
        let tip = axis_mm - self.mounted?.length.value();
        match &self.engagement {
            Engagement::Tapping(tap) => tap.off_helix(tip, angle).map(Length::mm),
            Engagement::Air | Engagement::Clear | Engagement::Drilling(_) | Engagement::Broken => {
                None
            }
        }
    }

    /// How far a clutch has left the tap ahead of the spindle.
    pub(crate) const fn slip(&self) -> Angle {
        Angle::rev(self.slip)
    }

    /// The insert in the spindle, and its length.
    pub(crate) fn insert(&self) -> Option<(u32, crate::Insert, Length)> {
        let tool = self.mounted?;
        match tool.kind {
            ToolKind::Insert(insert) => Some((tool.number, insert, tool.length)),
            ToolKind::Drill { .. }
            | ToolKind::Tap(_)
            | ToolKind::Probe(_)
            | ToolKind::Mill { .. }
            | ToolKind::PolygonCutter(_)
            | ToolKind::Other => None,
        }
    }

    /// The polygon cutter in the spindle, and its length.
    pub(crate) fn polygon_cutter(&self) -> Option<(u32, crate::PolygonCutter, Length)> {
        let tool = self.mounted?;
        match tool.kind {
            ToolKind::PolygonCutter(cutter) => Some((tool.number, cutter, tool.length)),
            _ => None,
        }
    }

    /// Machine Z of the surface.
    pub(crate) const fn top(&self) -> Length {
        self.stock.top
    }

    /// What the work does to the machine now.
    pub(crate) const fn load(&self) -> Load {
        self.load
    }

    /// What broke the tool in the spindle.
    pub(crate) const fn broken_by(&self) -> Option<ToolBreak> {
        self.broken_by
    }

    /// The tool in the spindle is in pieces.
    pub(crate) const fn is_broken(&self) -> bool {
        matches!(self.engagement, Engagement::Broken)
    }
}

fn distance(a: [Length; 2], b: [Length; 2]) -> Length {
    Length::mm((a[0] - b[0]).value().hypot((a[1] - b[1]).value()))
}

#[cfg(test)]
mod tests;
