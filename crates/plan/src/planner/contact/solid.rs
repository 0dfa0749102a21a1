//! Whatever is in the spindle against the stock, where it is no drill, tap, mill or insert of a
//! bar: probes, polygon cutters, hobs, wheels, and the spindle's own nose where no tool is in it.
//!
//! ```text
//!     │  │ axis        a round body of radius R about the tool's axis, from its tip upwards
//!   ┌─┴──┴─┐
//!   └──────┘           rapid: nothing within R may be left; feed: what cuts takes it away, and turns;
//!   ◄─ R ─►            what cuts nothing has no feed into the stock
//! ```
//!
//! Behind a probing move neither probe nor nose is looked at: where they are then, and what was set
//! by the contact, is known when the program runs.
//!
//! A grinder's wheel stands beside its work: its axis is parallel to the work's, and no Z takes it
//! clear. Chuck and tailstock are never cut: any tool in them, by rapid or feed, is said.
use super::{Job, Planner, Point, SCRAPES, Sweep, places};
use crate::bodies::Cylinder;
use crate::findings::Cause;
use crate::words::{Rounding, advice, length, place, word};
use alloc::{format, string::String};
use canon::{Axis, ToolKind};
use diag::{Diagnostic, Severity};
use motion::Path;
use units::{Length, Spin};

/// How far above the stock, or beside it, a body is clear of it, mm.
const CLEAR: f64 = 2.0;

/// What a body is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodyKind {
    /// The spindle's nose: no tool is in it.
    Nose,
    /// A grinder's wheel.
    Wheel,
    /// It touches, and cuts nothing.
    Probe,
    /// It takes away what it is fed through.
    Cutter,
}

/// A round body about the tool's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SolidBody {
    kind: BodyKind,
    /// mm.
    radius: f64,
    /// From the gauge line to its lower end, mm.
    long: f64,
}

/// Where a body is deepest in what is not open.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DeepestPlace {
    over: f64,
    open: f64,
    at: Point,
}

impl super::Contact {
    /// How deep a round body of this radius, mm, gets over a place without cutting.
    fn open_about(&self, at: [f64; 2], radius: f64) -> f64 {
        let bored = self.removed.open_round(at, radius);
        if let Some(outline) = &self.outline {
            return bored.max(self.stock.top() - outline.front_beside(at, radius));
        }
        bored.max(
            self.solid_places(at, radius).map(|p| self.depth_open(p)).fold(f64::INFINITY, f64::min),
        )
    }

    /// Places under a round body that may be solid: its middle, its rim, half way to it, and the
    /// nearest place of the stock.
    fn solid_places(&self, at: [f64; 2], radius: f64) -> impl Iterator<Item = [f64; 2]> + use<> {
        const AROUND: u32 = 16;
        let near = self.stock.nearest(at);
        let is_under = libm::hypot(near[0] - at[0], near[1] - at[1]) <= radius;
        let rings = [0.5, 1.0].into_iter().flat_map(move |share| {
            (0..AROUND).map(move |k| {
                let angle = f64::from(k) * core::f64::consts::TAU / f64::from(AROUND);
                let r = share * radius;
                [at[0] + r * libm::cos(angle), at[1] + r * libm::sin(angle)]
            })
        });
        let rings = rings.filter(move |_| radius > 0.0);
        rings.chain([at]).chain(is_under.then_some(near))
    }
}

impl Planner {
    /// What is in the spindle, where it is a body of its own.
    fn solid(&self) -> Option<SolidBody> {
        let bodies = self.contact.as_ref()?.bodies;
        if self.tool == 0 {
            let solid = |kind, radius: Option<Length>| {
                let radius = radius.map_or(0.0, Length::value);
                Some(SolidBody { kind, radius, long: 0.0 })
            };
            return match bodies.wheel {
                Some(radius) => solid(BodyKind::Wheel, Some(radius)),
                None if bodies.tools_by_hand || self.turns_work => None,
                None => solid(BodyKind::Nose, bodies.nose.map(|nose| nose / 2.0)),
            };
        }
        let tool = self.tools.get(self.tool).filter(|tool| !tool.stand_in)?;
        let (kind, radius) = match &tool.kind {
            ToolKind::Probe(_) => (BodyKind::Probe, tool.diameter / 2.0),
            ToolKind::PolygonCutter(cutter) => (BodyKind::Cutter, cutter.radius),
            ToolKind::Hob(_) | ToolKind::Other => (BodyKind::Cutter, tool.diameter / 2.0),
            ToolKind::Drill { .. }
            | ToolKind::SpotDrill { .. }
            | ToolKind::EndMill(_)
            | ToolKind::Tap(_)
            | ToolKind::Insert(_) => return None,
        };
        Some(SolidBody { kind, radius: radius.value(), long: tool.worn_length().value() })
    }

    /// A body of its own along a path.
    pub(in crate::planner) fn sweep_solid(&mut self, job: &Job, path: &Path, run: Sweep) {
        let Some(solid) = self.solid() else { return };
        let is_mounted = self.limits.tapping.axis == Axis::Z;
        let Some(contact) = self.contact.as_mut().filter(|_| is_mounted) else { return };
        if contact.probed && matches!(solid.kind, BodyKind::Probe | BodyKind::Nose) {
            return;
        }
        if solid.kind == BodyKind::Wheel {
            return self.sweep_wheel(job, path, run, solid.radius);
        }
        let top = contact.stock.top();
        let is_flat = !matches!(path, Path::Arc { arc, .. } if arc.plane != canon::Plane::XY);
        let low = |at: &canon::Position| at.linear[2].value() - solid.long;
        if is_flat && low(path.from()).min(low(path.to())) >= top - SCRAPES {
            contact.crashed = false;
            return;
        }
        let across = contact.stock.bar.map_or(0.0, |_| self.frame.tool.linear[0].value());
        let cuts = matches!(run, Sweep::Feed(_) | Sweep::Thread(_));
        let mut deepest: Option<DeepestPlace> = None;
        let mut before: Option<Point> = None;
        places(path, solid.long, |[x, y, z]| {
            let to = [x - across, y, z];
            let Some(from) = before.replace(to) else { return };
            for at in between(from, to) {
                let depth = top - at[2];
                if depth <= SCRAPES || deepest.is_some_and(|d| depth <= d.over) {
                    continue;
                }
                let open = contact.open_about([at[0], at[1]], solid.radius);
                let over = depth - open;
                if over > SCRAPES && deepest.is_none_or(|d| over > d.over) {
                    deepest = Some(DeepestPlace { over, open, at });
                }
            }
            if cuts || deepest.is_some() {
                contact.removed.mill(&contact.stock, [from, to], solid.radius);
            }
        });
        let is_tilted = [path.from(), path.to()].into_iter().any(|at| at.rotary != contact.rotary);
        let sure = Self::sure(is_tilted || contact.doubtful);
        let Some(deepest) = deepest.filter(|_| !contact.crashed) else { return };
        self.say_solid(job, solid, deepest, run, sure);
    }

    fn say_solid(
        &mut self,
        job: &Job,
        solid: SolidBody,
        worst: DeepestPlace,
        run: Sweep,
        sure: Severity,
    ) {
        let is_rapid = run == Sweep::Rapid;
        match solid.kind {
            BodyKind::Cutter if !is_rapid => {
                if !self.is_at_rest() {
                    return;
                }
                return self.say_still(job, worst, sure);
            }
            BodyKind::Nose if !is_rapid => {
                if !self.is_at_rest() && self.selected.is_none() {
                    self.say_no_tool(job, worst);
                }
                return;
            }
            BodyKind::Cutter | BodyKind::Nose | BodyKind::Probe | BodyKind::Wheel => {}
        }
        let Some(contact) = &mut self.contact else { return };
        contact.crashed = true;
        let (stock, mounted) = (contact.stock, contact.mounted);
        let frame = &self.frame;
        let name = self.body_name(solid.kind);
        let axis = |tip: f64| tip + solid.long;
        let at = frame.place([worst.at[0], worst.at[1], axis(worst.at[2])].map(Length::mm));
        let over = length(frame, worst.over);
        let clear = CLEAR.max(0.1 * frame.unit.in_mm());
        let level = if worst.open > 0.0 && worst.open.is_finite() {
            let deepest = axis(stock.top() - worst.open);
            format!("{} is the deepest that works", advice(frame, Axis::Z, deepest, Rounding::Up))
        } else {
            let clear = axis(stock.top() + clear);
            format!("{} or higher works", advice(frame, Axis::Z, clear, Rounding::Up))
        };
        let beside = match solid.kind {
            BodyKind::Probe => ", or a probing move (G38.2, G31)",
            BodyKind::Cutter => ", or a feed (G1)",
            BodyKind::Nose | BodyKind::Wheel => "",
        };
        let how = if is_rapid { "rapid" } else { "feed" };
        let touches = word(frame, Axis::Z, axis(stock.top()));
        let said = [
            format!(
                "the {how} takes {name} {over} into the stock at {at}, whose top it touches at {touches}"
            ),
            format!(": {level}{beside}"),
        ];
        let help = self.offset_cause().unwrap_or_else(|| self.help_of(solid.kind));
        let cause = Cause { code: "M0360", which: [mounted, sure as u32, 2] };
        self.findings.merge(cause, worst.over, || {
            let mut finding = Diagnostic::error("M0360", job.span, "");
            (finding.severity, finding.help) = (sure, Some(help));
            (finding, said)
        });
    }

    /// No tool is in the spindle, which turns and is fed into the stock.
    fn say_no_tool(&mut self, job: &Job, worst: DeepestPlace) {
        let Some(contact) = &mut self.contact else { return };
        contact.crashed = true;
        let text = format!(
            "this cuts with no tool: the program has called none, and the spindle's nose goes {} into the stock",
            length(&self.frame, worst.over)
        );
        let finding = Diagnostic::warning("M0373", job.span, text).with_help(NO_TOOL);
        self.findings.add_once(finding);
    }

    fn say_still(&mut self, job: &Job, worst: DeepestPlace, sure: Severity) {
        let Some(contact) = &mut self.contact else { return };
        contact.crashed = true;
        let mounted = contact.mounted;
        let said = [
            format!(
                "{} is fed {} into the stock with the spindle at rest",
                self.body_name(BodyKind::Cutter),
                length(&self.frame, worst.over)
            ),
            ": M3 with an S above zero works".into(),
        ];
        let cause = Cause { code: "M0362", which: [mounted, sure as u32, 2] };
        self.findings.merge(cause, worst.over, || {
            let mut finding = Diagnostic::error("M0362", job.span, "");
            finding.severity = sure;
            (finding, said)
        });
    }

    fn body_name(&self, kind: BodyKind) -> String {
        match kind {
            BodyKind::Nose => "the nose of the spindle, in which no tool is,".into(),
            BodyKind::Wheel => "the grinding wheel".into(),
            BodyKind::Probe | BodyKind::Cutter => {
                self.tools.get(self.tool).map_or_else(String::new, canon::Tool::name)
            }
        }
    }

    fn help_of(&self, kind: BodyKind) -> String {
        match (kind, &self.selected) {
            (BodyKind::Nose, Some(selected)) => {
                let (line, number) = (selected.line(), selected.number());
                format!(
                    "line {line} selects T{number}, and no M6 brings it into the spindle: write T{number} M6"
                )
            }
            (BodyKind::Nose, None) => NO_TOOL.into(),
            (BodyKind::Probe, _) => HOLES.into(),
            (BodyKind::Cutter | BodyKind::Wheel, _) => SMALLER.into(),
        }
    }

    fn is_at_rest(&self) -> bool {
        self.spindles.iter().all(|state| state.ordered == Spin::ZERO)
    }

    /// A grinder's wheel beside its work: a rapid within the distance at which they touch.
    fn sweep_wheel(&mut self, job: &Job, path: &Path, run: Sweep, radius: f64) {
        let Some(contact) = self.contact.as_ref().filter(|_| run == Sweep::Rapid) else { return };
        if self.cam.is_some() {
            return; // the profile says how near it may come
        }
        let stock = contact.stock;
        let [x, y] = [0, 1].map(|i| f64::midpoint(stock.from[i].value(), stock.to[i].value()));
        let touch = radius + (stock.to[0] - stock.from[0]).value() / 2.0;
        let off = |at: Point| libm::hypot(at[0] - x, at[1] - y);
        let mut nearest: Option<Point> = None;
        places(path, 0.0, |at| {
            nearest = nearest.filter(|near| off(*near) <= off(at)).or(Some(at));
        });
        let (start, mounted) = (path.from().linear.map(Length::value), contact.mounted);
        let Some(at) = nearest.filter(|at| off(*at) < touch - SCRAPES && off(*at) < off(start))
        else {
            return;
        };
        let frame = &self.frame;
        let outward = if at[0] < x { -1.0 } else { 1.0 };
        let clear = x + outward * (touch + CLEAR);
        let rounding = if outward < 0.0 { Rounding::Down } else { Rounding::Up };
        let over = touch - off(at);
        let said = [
            format!(
                "the rapid takes the grinding wheel {} into the stock at {}, which it touches at {}",
                length(frame, over),
                place(frame, Axis::X, at[0]),
                word(frame, Axis::X, x + outward * touch),
            ),
            format!(": {} is clear of it", advice(frame, Axis::X, clear, rounding)),
        ];
        let sure = Self::sure(contact.doubtful);
        let cause = Cause { code: "M0360", which: [mounted, sure as u32, 3] };
        self.findings.merge(cause, over, || {
            let mut finding = Diagnostic::error("M0360", job.span, "").with_help(SMALLER);
            finding.severity = sure;
            (finding, said)
        });
    }

    /// A tool of a lathe against chuck and tailstock, by whatever it moves there.
    pub(in crate::planner) fn sweep_clamping(&mut self, job: &Job, path: &Path, run: Sweep) {
        let Some(contact) = self.contact.as_ref().filter(|_| self.turns_work) else { return };
        let bodies = contact.bodies;
        if bodies.chuck.is_none() && bodies.tailstock.is_none() {
            return;
        }
        let (long, radius) = match self.tools.get(self.tool) {
            Some(tool) if tool.stand_in => return,
            Some(tool) if matches!(tool.kind, ToolKind::Insert(_)) => {
                (tool.worn_length().value(), 0.0)
            }
            Some(tool) => (tool.worn_length().value(), tool.diameter.value() / 2.0),
            None => (0.0, 0.0),
        };
        let stock = contact.stock;
        let [cx, cy] = [0, 1].map(|i| f64::midpoint(stock.from[i].value(), stock.to[i].value()));
        let across = self.frame.tool.linear[0].value();
        let mut met: Option<(f64, Point, &str, Cylinder)> = None;
        let mut before: Option<Point> = None;
        let known = [("chuck", bodies.chuck), ("tailstock", bodies.tailstock)];
        places(path, long, |[x, y, z]| {
            let to = [x - across, y, z];
            let Some(from) = before.replace(to) else { return };
            for at in between(from, to) {
                let r = (libm::hypot(at[0] - cx, at[1] - cy) - radius).max(0.0);
                for (name, cylinder) in known {
                    let Some(cylinder) = cylinder else { continue };
                    let depth = cylinder.depth(r, at[2]);
                    if depth > SCRAPES && met.is_none_or(|(worst, ..)| depth > worst) {
                        met = Some((depth, at, name, cylinder));
                    }
                }
            }
        });
        if let Some((depth, at, name, cylinder)) = met {
            self.say_clamping(job, run, (depth, at, name, cylinder), [cx + across, long]);
        }
    }

    fn say_clamping(
        &mut self,
        job: &Job,
        run: Sweep,
        (depth, at, name, cylinder): (f64, Point, &str, Cylinder),
        [axis, long]: [f64; 2],
    ) {
        let Some(contact) = &self.contact else { return };
        let frame = &self.frame;
        let how = if run == Sweep::Rapid { "rapid" } else { "feed" };
        let tool = self.tools.get(self.tool);
        let tool = tool.map_or_else(|| "the turret, with no tool in it,".into(), canon::Tool::name);
        let is_chuck = name == "chuck";
        let (end, side, rounding) = if is_chuck {
            (cylinder.to.value() + CLEAR, "or more", Rounding::Up)
        } else {
            (cylinder.from.value() - CLEAR, "or less", Rounding::Down)
        };
        let outward = if at[0] < axis - frame.tool.linear[0].value() { -1.0 } else { 1.0 };
        let said = [
            format!(
                "the {how} takes {tool} {} into the {name} at {} and {}: it is there up to {} and {} {}",
                length(frame, depth),
                place(frame, Axis::X, at[0] + frame.tool.linear[0].value()),
                place(frame, Axis::Z, at[2] + long),
                word(frame, Axis::X, axis + outward * cylinder.radius.value()),
                if is_chuck { "up to" } else { "from" },
                word(
                    frame,
                    Axis::Z,
                    if is_chuck { cylinder.to } else { cylinder.from }.value() + long
                ),
            ),
            format!(": {} {side} is clear of it", advice(frame, Axis::Z, end + long, rounding)),
        ];
        let sure = Self::sure(contact.doubtful);
        let which = [contact.mounted, sure as u32, 4 + u32::from(is_chuck)];
        self.findings.merge(Cause { code: "M0360", which }, depth, || {
            let help = "[setup.chuck] and [setup.tailstock] in the machine's file say how large they are and where they stand";
            let mut finding = Diagnostic::error("M0360", job.span, "").with_help(help);
            finding.severity = sure;
            (finding, said)
        });
    }
}

/// Places of a straight piece, a millimetre apart.
pub(super) fn between(from: Point, to: Point) -> impl Iterator<Item = Point> {
    const STEP_MM: f64 = 1.0;
    const MOST: f64 = 256.0;
    let way = (0..3).map(|i| (to[i] - from[i]) * (to[i] - from[i])).sum::<f64>();
    let count = libm::ceil(libm::sqrt(way) / STEP_MM).clamp(1.0, MOST);
    (0..=count as u32).map(move |k| {
        let share = f64::from(k) / count;
        [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * share)
    })
}

/// Advice for a probe that meets the stock.
const HOLES: &str = "a hole that the work has before the program begins is stated under [[setup.holes]] in the machine's file";
/// Advice for an empty spindle that does.
const NO_TOOL: &str = "write T and M6 before it, such as T1 M6; a program whose tools are clamped by hand names the one that is";
/// Advice where the machine's file may state a larger stock than there is.
const SMALLER: &str = "[setup.stock] in the machine's file says how large the work is: if the real one is smaller, write its size there";
