//! What stands behind a tool's edges against the stock: shank and holder, as far as the tool table
//! states them.
//!
//! ```text
//!     ┌────────┐ holder             a part is clear where the stock is open as wide as it is:
//!  ───┼──┐  ┌──┼─── top                a hole of its diameter, or milled all around it
//!     │  │  │  │ ▲ too deep
//!     └──┼──┼──┘ ▼                  bar of a lathe: a boring bar needs a bore as wide as itself, a turning tool's
//!        │  │                       shank a surface that is no higher than its point stands over it
//!        └──┘ tip
//! ```
//!
//! What is not stated is not judged; a holder of unknown diameter is at least as thick as its tool.
use super::{Job, Planner, Point, ROUNDING, SCRAPES, places};
use crate::bar::Behind;
use crate::findings::Cause;
use crate::words::{Rounding, advice, length, place};
use alloc::{format, string::String};
use canon::{Axis, Tool, ToolKind};
use diag::{Diagnostic, Span};
use motion::Path;

/// Places around a part that are looked at.
const AROUND: u32 = 8;

/// A part of a round tool.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BodyPart {
    name: &'static str,
    /// Above the tip, mm.
    from: f64,
    diameter: f64,
}

/// The parts of a tool that are thicker than what it cuts, or never cut, and the spindle's nose of
/// this diameter behind it.
fn parts(tool: &Tool, nose: Option<units::Length>) -> impl Iterator<Item = BodyPart> + use<> {
    let (body, cuts) = (tool.body, tool.diameter.value());
    let flutes = match &tool.kind {
        ToolKind::Tap(tap) => Some(tap.thread_length),
        _ => body.flutes,
    };
    let mm = units::Length::value;
    let shank = flutes.map(mm).zip(body.shank.map(mm)).filter(|(_, wide)| *wide > cuts);
    let shank = shank.map(|(from, diameter)| BodyPart { name: "shank", from, diameter });
    let holder = body.stick_out.map(mm).map(|from| BodyPart {
        name: "holder",
        from,
        diameter: body.holder.map_or(cuts, mm).max(cuts),
    });
    let nose = nose.map(mm).filter(|_| !tool.stand_in);
    let nose = nose.map(|diameter| BodyPart {
        name: "nose",
        from: tool.worn_length().value(),
        diameter: diameter.max(cuts),
    });
    shank.into_iter().chain(holder).chain(nose)
}

impl super::Contact {
    /// How deep a round part of this diameter gets over a place.
    fn open_for(&self, at: [f64; 2], diameter: f64) -> f64 {
        if let Some(outline) = &self.outline {
            let bored = self.removed.free_depth(at, diameter, 0.0);
            return bored.max(self.stock.top() - outline.front(diameter / 2.0));
        }
        self.open_under(at, diameter, 0.0)
    }

    /// How deep the work is open for a tool that comes down: bored, or milled over all its width.
    pub(super) fn open_under(&self, at: [f64; 2], diameter: f64, cone: f64) -> f64 {
        let bored = self.removed.free_depth(at, diameter, cone);
        if self.outline.is_some() {
            return bored;
        }
        let milled = (0..AROUND).fold(self.depth_open(at), |open, k| {
            let (sin, cos) = (
                libm::sin(f64::from(k) * core::f64::consts::TAU / f64::from(AROUND)),
                libm::cos(f64::from(k) * core::f64::consts::TAU / f64::from(AROUND)),
            );
            let [x, y] = [at[0] + cos * diameter / 2.0, at[1] + sin * diameter / 2.0];
            open.min(self.depth_open([x, y]))
        });
        bored.max(milled)
    }

    /// How deep the stock is open at a point.
    pub(super) fn depth_open(&self, at: [f64; 2]) -> f64 {
        if self.stock.holds(at) { self.removed.milled_depth(at) } else { f64::INFINITY }
    }
}

impl Planner {
    /// Shank and holder of a drill, a tap or a mill along a path of the tip.
    pub(in crate::planner) fn sweep_body(&mut self, job: &Job, path: &Path) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let long = tool.worn_length().value();
        let nose = contact.bodies.nose.filter(|_| !self.turns_work);
        let Some(lowest) = parts(tool, nose).map(|part| part.from).reduce(f64::min) else { return };
        let end = |at: &canon::Position| at.linear[2].value() - long;
        let bends = !matches!(path, Path::Line { .. });
        if !bends && end(path.from()).min(end(path.to())) + lowest >= contact.stock.top() {
            return;
        }
        let mut worst: Option<(f64, BodyPart, Point, f64)> = None;
        let mut look = |at: Point| {
            for part in parts(tool, nose) {
                let depth = contact.stock.top() - at[2] - part.from;
                if depth <= SCRAPES || worst.is_some_and(|(over, ..)| depth <= over) {
                    continue;
                }
                let open = contact.open_for([at[0], at[1]], part.diameter);
                let over = depth - open;
                if over > SCRAPES && worst.is_none_or(|(most, ..)| over > most) {
                    worst = Some((over, part, at, open));
                }
            }
        };
        let mut before: Option<Point> = None;
        places(path, long, |at| {
            if let Some(from) = before.replace(at) {
                pieces(from, at, &mut look);
            }
        });
        if let Some((_, part, at, open)) = worst {
            self.say_body(job.span, part, at, open);
        }
    }

    /// Where the tip is at one place, in a hole or a thread.
    pub(in crate::planner) fn judge_body(&mut self, span: Span, at: Point) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let nose = contact.bodies.nose.filter(|_| !self.turns_work);
        let worst = parts(tool, nose)
            .map(|part| {
                let depth = contact.stock.top() - at[2] - part.from;
                (depth, part, contact.open_for([at[0], at[1]], part.diameter))
            })
            .filter(|(depth, _, open)| depth - open > ROUNDING.max(SCRAPES))
            .max_by(|a, b| (a.0 - a.2).total_cmp(&(b.0 - b.2)));
        if let Some((_, part, open)) = worst {
            self.say_body(span, part, at, open);
        }
    }

    fn say_body(&mut self, span: Span, part: BodyPart, at: Point, open: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let top = contact.stock.top();
        let over = top - at[2] - part.from - open;
        let deepest = top - open - part.from + tool.worn_length().value();
        let whose = if part.name == "nose" { "the spindle's" } else { "its" };
        let said = [
            format!(
                "{} goes {} deep into the stock, and {whose} {} of {}, which begins {} above its tip, meets the stock",
                tool.name(),
                length(frame, top - at[2]),
                part.name,
                length(frame, part.diameter),
                length(frame, part.from),
            ),
            format!(
                ": {} is the deepest that works",
                advice(frame, Axis::Z, deepest, Rounding::Up)
            ),
        ];
        let which = [
            contact.mounted,
            1,
            u32::from(part.name == "holder") + 2 * u32::from(part.name == "nose"),
        ];
        self.say_part(span, which, over, said);
    }

    /// The shank of an insert along a path, before it cuts there: of a boring bar along Z, of a
    /// turning tool across.
    pub(in crate::planner) fn sweep_shank(&mut self, job: &Job, path: &Path) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let Some(outline) = &contact.outline else { return };
        let mm = units::Length::value;
        let (shank, out) = (tool.body.shank.map(mm), tool.body.stick_out.map(mm));
        if shank.is_none() && out.is_none() {
            return;
        }
        let across = self.frame.tool.linear[0].value();
        let mut worst: Option<(Behind, Point)> = None;
        let mut before = None;
        places(path, tool.worn_length().value(), |[x, y, z]| {
            let at = [x - across, y, z];
            let Some(from) = before.replace(at) else { return };
            outline.along([from, at], 0.0, |at| {
                let met = outline.behind(at, shank, out);
                let by = |behind: &Behind| behind.by();
                if let Some(met) = met.filter(|met| {
                    met.by() > SCRAPES && worst.as_ref().is_none_or(|(w, _)| by(met) > by(w))
                }) {
                    worst = Some((met, at));
                }
            });
        });
        if let Some((met, at)) = worst {
            self.say_shank(job.span, &met, at, across);
        }
    }

    fn say_shank(&mut self, span: Span, met: &Behind, at: Point, across: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let name = tool.name();
        let here = format!(
            "{} and {}",
            place(frame, Axis::X, at[0] + across),
            place(frame, Axis::Z, at[2] + tool.worn_length().value())
        );
        let (said, kind): ([String; 2], u32) = match *met {
            Behind::Bore { bar, bore, .. } => (
                [
                    format!(
                        "the bar of {name}, {} thick, does not fit into the bore of {} in which it stands at {here}",
                        length(frame, bar),
                        length(frame, bore),
                    ),
                    ": a thinner boring bar works, or a wider bore first".into(),
                ],
                2,
            ),
            Behind::Face { by, out } => {
                let deepest = at[2] + by + tool.worn_length().value();
                (
                    [
                        format!(
                            "{name} stands {} out of its holder, and at {here} the holder is {} in the face of the bar",
                            length(frame, out),
                            length(frame, by),
                        ),
                        format!(
                            ": {} is the deepest that works",
                            advice(frame, Axis::Z, deepest, Rounding::Up)
                        ),
                    ],
                    3,
                )
            }
            Behind::Shoulder { by, out, surface } => (
                [
                    format!(
                        "the point of {name} stands {} over its shank, and at {here} the shank is {} in the bar, which reaches {} from its axis there",
                        length(frame, out),
                        length(frame, by),
                        length(frame, surface),
                    ),
                    ": a tool that stands farther out works, or one with a narrower shank".into(),
                ],
                4,
            ),
        };
        let which = [contact.mounted, kind, 0];
        self.say_part(span, which, met.by(), said);
    }

    fn say_part(&mut self, span: Span, which: [u32; 3], by: f64, said: [String; 2]) {
        let severity = Self::sure(self.contact.as_ref().is_some_and(|contact| contact.doubtful));
        let offset = self.offset_cause();
        if offset.is_some() && self.contact.as_ref().is_some_and(|c| c.blamed.is_some()) {
            return; // what the length offset causes was said
        }
        self.findings.merge(Cause { code: "M0367", which }, by, || {
            let mut finding = Diagnostic::error("M0367", span, "");
            (finding.severity, finding.help) = (severity, offset);
            (finding, said)
        });
    }
}

/// A straight piece, looked at as often as a part's width asks for.
fn pieces(from: Point, to: Point, look: &mut impl FnMut(Point)) {
    const STEP_MM: f64 = 1.0;
    const MOST: f64 = 256.0;
    let way = libm::hypot(to[0] - from[0], to[1] - from[1]);
    let count = libm::ceil(way / STEP_MM).clamp(1.0, MOST);
    for k in 0..=count as u32 {
        let share = f64::from(k) / count;
        look([0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * share));
    }
}
