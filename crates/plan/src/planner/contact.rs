//! The tool against the stock: what would break it, before anything moves.
//!
//! ```text
//!                   tip below the top, over the stock
//!     air ──────────────────────────────────────────► in the work at `entered`
//!      ▲      rapid: no deeper than what is open       │  deeper: only fed, turning, a chip that the drill bears
//!      │      tap: only in its cycle                   │  sideways: only a mill
//!      └───────────────────────────────────────────────┘
//! ```
//!
//! Each motion is swept with the mounted tool's real length, so a length offset that is missing or
//! another tool's shows as what it does. An error is what surely breaks; what likely does is a
//! warning: a mill's rapid (the work may be smaller than the machine file says), a pocket that was
//! milled (the simulator mills none), axes that have turned the work. Tools of no known length
//! (stand-ins) and of no known form are not looked at.
use super::{Job, Planner};
use crate::bar::Outline;
use crate::bodies::Bodies;
use crate::chip::Drill;
use crate::stock::{Removed, Stock};
use alloc::vec::Vec;
use canon::{Axis, Feed, Hole, Tap, Tool, ToolKind};
use motion::{Instant, Path};
use units::{Angle, Length, Spin};

mod bar;
mod body;
mod form;
mod hobbing;
mod say;
mod set_up;
mod solid;
mod turned;
mod turret;

use form::{Form, form};

/// A rapid may be so much deeper than what is open, mm: scraping, rounding.
const SCRAPES: f64 = 0.2;
/// Depth below which a tip only slides over the surface, mm.
const SLIDES: f64 = 0.05;
/// Share of its diameter by which a drill, or a tap, may be moved sideways in the work.
const DRILL_SIDEWAYS: f64 = 0.25;
const TAP_SIDEWAYS: f64 = 0.1;
/// Load of a drill's core, over its strength, from which on it surely breaks, and may.
const BREAKS: f64 = 1.25;
const MAY_BREAK: f64 = 0.9;
/// A tip may stand so far from where the program has it, mm: wear offsets.
const WEAR: f64 = 0.1;
/// Places of a mill's rapid that are looked at.
const LOOKS: u32 = 64;
/// The program's zero may stand so far from the workpiece's along Z: as far as depths of holes may
/// be off (ISO 2768-1 f).
const MISPLACED: Length = Length::mm(0.05);
/// Rounding of a program's numbers, mm.
const ROUNDING: f64 = 1e-6;

/// The tool's tip, mm: X, Y, Z of the machine less the tool's length.
type Point = [f64; 3];

/// How a path is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sweep {
    /// As fast as the axes can.
    Rapid,
    /// At a feed; as a length per turn of the spindle, if it turns forwards.
    Feed(Feed),
    /// Tied to the spindle, in a thread that is turned.
    Thread(Feed),
}

/// Which mills are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mills {
    OfTable,
    /// Those that are only described, too: the program states its stock.
    All,
}

/// The tool in the spindle and the stock.
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools)] // each on its own: any of them may hold with any other
pub(super) struct Contact {
    stock: Stock,
    bodies: Bodies,
    removed: Removed,
    /// What is left of a bar that is turned; `None`: it is none, or not known.
    outline: Option<Outline>,
    /// Of the thread that is being turned, and how far off the bar the pass under way keeps.
    passes: Option<turned::Passes>,
    gap: Option<f64>,
    hobbed: Option<hobbing::Hobbed>,
    /// Where the tip went into the work.
    entered: Option<[f64; 2]>,
    /// Counts the tools that were put into the spindle: findings of one of them are of one cause.
    mounted: u32,
    /// Where the rotary axes stood when the program began: the stock lies as it was clamped.
    rotary: [Angle; 3],
    /// The tools are not known to be the shop's: nothing is sure to break.
    doubtful: bool,
    mills: Mills,
    /// A probing move was made: where it touches, and all that follows from it, is known when the
    /// program runs.
    probed: bool,
    /// It was said that the length offset is not the tool's.
    offset_said: bool,
    /// Code of what the length offset was blamed for: whatever else it causes is no finding of its
    /// own.
    blamed: Option<&'static str>,
    /// It has crashed into solid stock and not come out since: what follows from that is no finding
    /// of its own.
    crashed: bool,
}

/// What is wrong with a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    /// A rapid ends so much deeper than what is open, and this is open.
    RapidIn { over: f64, open: f64, milled: bool },
    /// So far sideways in the work, and this deep.
    Sideways { off: f64, depth: f64, milled: bool },
    /// Fed so deep beyond what is open with a spindle that does not turn forwards.
    Still { over: f64, load: f64 },
    /// More per turn than the drill bears.
    TooFast { per_turn: f64, load: f64, by_turn: bool },
    /// Without its cycle: fed, or led by a turning spindle that goes on turning at the end.
    TapFed { over: f64, is_led: bool },
}

impl Contact {
    fn new(stock: Stock, rotary: [Angle; 3]) -> Self {
        Self {
            stock,
            bodies: Bodies::default(),
            removed: Removed::default(),
            outline: stock.bar.map(|bar| Outline::new(&stock, bar)),
            passes: None,
            gap: None,
            hobbed: None,
            entered: None,
            mounted: 0,
            rotary,
            doubtful: false,
            mills: Mills::OfTable,
            probed: false,
            offset_said: false,
            blamed: None,
            crashed: false,
        }
    }

    fn depth(&self, at: Point) -> f64 {
        self.stock.top() - at[2]
    }

    /// A straight piece of a path.
    fn segment(
        &mut self,
        ends: [Point; 2],
        form: &Form,
        run: Sweep,
        per_turn: Option<f64>,
        found: &mut Vec<(Wrong, Point)>,
    ) {
        let depths = ends.map(|at| self.depth(at));
        if depths[0] <= 0.0 {
            self.entered = None;
        }
        if depths[0] <= ROUNDING && depths[1] <= ROUNDING {
            return;
        }
        let crossing = depths[0] / (depths[0] - depths[1]);
        let below = match (depths[0] <= 0.0, depths[1] <= 0.0) {
            (true, _) => (crossing, 1.0),
            (false, true) => (0.0, crossing),
            (false, false) => (0.0, 1.0),
        };
        if let Some((from, to)) = self.stock.over(ends, below) {
            let [a, b] = ends;
            let at = |share: f64| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share);
            let part = [at(from), at(to)];
            match *form {
                Form::Mill { radius } => self.mill(part, radius, run, found),
                Form::Drill(drill) => self.bore(part, &drill, run, per_turn, found),
                Form::Tap { diameter } => self.tapped(part, diameter, run, found),
            }
        }
        if depths[1] <= 0.0 {
            self.entered = None;
        }
    }

    /// A mill: what it feeds through is open; where it goes with a rapid nothing may be left.
    fn mill(&mut self, part: [Point; 2], radius: f64, run: Sweep, found: &mut Vec<(Wrong, Point)>) {
        if let Sweep::Feed(_) | Sweep::Thread(_) = run {
            return self.removed.mill(&self.stock, part, radius);
        }
        let [a, b] = part;
        let over = |k: u32| {
            let share = f64::from(k) / f64::from(LOOKS);
            let at = [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share);
            let place = [at[0], at[1]];
            let open = self.removed.free_depth(place, 2.0 * radius, 0.0);
            let open = open.max(self.removed.milled_depth(place));
            (self.depth(at) - open, open, at)
        };
        let worst = (0..=LOOKS).map(over).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((over, open, at)) = worst.filter(|worst| worst.0 > SCRAPES) {
            found.push((Wrong::RapidIn { over, open, milled: false }, at));
        }
    }

    /// How far a tool that cuts along its axis alone is moved sideways in the work, if that is too
    /// far.
    fn sideways(&mut self, part: [Point; 2], most: f64) -> Option<(Wrong, Point)> {
        let entered = *self.entered.get_or_insert([part[0][0], part[0][1]]);
        let off = |at: Point| libm::hypot(at[0] - entered[0], at[1] - entered[1]);
        let depth = self.depth(part[0]).max(self.depth(part[1]));
        let off = off(part[0]).max(off(part[1]));
        let is_milled =
            |at: Point| self.removed.milled_depth([at[0], at[1]]) >= self.depth(at) - SLIDES;
        let milled = part.into_iter().all(is_milled);
        (off > most && depth > ROUNDING)
            .then_some((Wrong::Sideways { off, depth, milled }, part[1]))
    }

    fn bore(
        &mut self,
        part: [Point; 2],
        drill: &Drill,
        run: Sweep,
        per_turn: Option<f64>,
        found: &mut Vec<(Wrong, Point)>,
    ) {
        let aside = self.sideways(part, drill.diameter * DRILL_SIDEWAYS);
        let Some(place) = self.entered else { return };
        let open = self.open_under(place, drill.diameter, drill.cone);
        let (from, depth) = (self.depth(part[0]), self.depth(part[1]));
        let over = depth - open;
        let milled = self.removed.milled_depth(place) >= depth - SLIDES;
        if depth > from && over > ROUNDING {
            match run {
                Sweep::Rapid if over > SCRAPES => {
                    return found.push((Wrong::RapidIn { over, open, milled }, part[1]));
                }
                Sweep::Rapid => {}
                Sweep::Feed(_) | Sweep::Thread(_) => {
                    let inner = self.removed.open_diameter(place, depth, drill.diameter);
                    // two lips: a drill that does not turn piles up twice what it is fed
                    let chip = per_turn.unwrap_or(2.0 * over);
                    let load = drill.load(chip, depth, inner);
                    let wrong = match per_turn {
                        None => Wrong::Still { over, load },
                        Some(per_turn) => {
                            Wrong::TooFast { per_turn, load, by_turn: run.is_by_turn() }
                        }
                    };
                    let is_wrong = per_turn.is_none() && over > SLIDES || load > MAY_BREAK;
                    if is_wrong && !milled {
                        found.push((wrong, part[1]));
                    }
                    self.removed.bore(place, drill.diameter, drill.cone, depth);
                }
            }
        }
        found.extend(aside);
    }

    fn tapped(
        &mut self,
        part: [Point; 2],
        diameter: f64,
        run: Sweep,
        found: &mut Vec<(Wrong, Point)>,
    ) {
        let aside = self.sideways(part, diameter * TAP_SIDEWAYS);
        let Some(place) = self.entered else { return };
        let (from, depth) = (self.depth(part[0]), self.depth(part[1]));
        let open = self.open_under(place, diameter, 0.0);
        let over = depth - open;
        let milled = self.removed.milled_depth(place) >= depth - SLIDES;
        if depth > from && over > SCRAPES {
            return found.push(match run {
                Sweep::Rapid => (Wrong::RapidIn { over, open, milled }, part[1]),
                Sweep::Feed(_) => (Wrong::TapFed { over, is_led: false }, part[1]),
                Sweep::Thread(_) => (Wrong::TapFed { over, is_led: true }, part[1]),
            });
        }
        found.extend(aside);
    }
}

/// Places along a path between which it hardly bends.
fn places(path: &Path, length: f64, mut each: impl FnMut(Point)) {
    const PIECE_MM: f64 = 0.5;
    const MOST: f64 = 1024.0;
    let tip = |at: [f64; 3]| [at[0], at[1], at[2] - length];
    let linear = |at: &canon::Position| at.linear.map(Length::value);
    each(tip(linear(path.from())));
    if !matches!(path, Path::Line { .. }) {
        let whole = path.length();
        let pieces = libm::ceil(whole / PIECE_MM).clamp(1.0, MOST);
        for k in 1..pieces as u32 {
            let s = whole * f64::from(k) / pieces;
            let at = path.motion(Instant { s, v: 0.0, a: 0.0 }).position;
            each(tip([0, 1, 2].map(|i| at[i].value())));
        }
    }
    each(tip(linear(path.to())));
}

impl Planner {
    /// Tool and stock along a path that the axes can go.
    pub(super) fn sweep(&mut self, job: &Job, path: &Path, run: Sweep) {
        self.sweep_clamping(job, path, run);
        self.sweep_turret(job, path, run);
        if self.sweep_bar(job, path, run) {
            return;
        }
        self.sweep_body(job, path);
        self.sweep_solid(job, path, run);
        let Some(tool) = self.tools.get(self.tool) else { return };
        let stated = self.contact.as_ref().is_some_and(|contact| contact.mills == Mills::All);
        let pressure = self.options.cutting_pressure_n_per_mm2;
        let Some(form) = form(tool, pressure, stated) else { return };
        if self.limits.tapping.axis != Axis::Z {
            return;
        }
        let per_turn = self.per_turn(path, run);
        let Some(contact) = &mut self.contact else { return };
        let length = tool.worn_length().value();
        let lowest = path.from().linear[2].min(path.to().linear[2]).value() - length;
        let is_flat = !matches!(path, Path::Arc { arc, .. } if arc.plane != canon::Plane::XY);
        if is_flat && lowest >= contact.stock.top() {
            contact.entered = None;
            contact.crashed = false;
            return;
        }
        let mut found = Vec::new();
        let mut before = None;
        places(path, length, |at| {
            if let Some(before) = before.replace(at) {
                contact.segment([before, at], &form, run, per_turn, &mut found);
            }
        });
        let is_tilted = [path.from(), path.to()].into_iter().any(|at| at.rotary != contact.rotary)
            || contact.doubtful;
        for (wrong, at) in found {
            let Some(contact) = &mut self.contact else { return };
            match wrong {
                Wrong::Sideways { .. } if contact.crashed => continue,
                Wrong::RapidIn { milled, .. } => contact.crashed |= !milled,
                Wrong::Still { .. } | Wrong::TapFed { .. } => contact.crashed = true,
                Wrong::Sideways { .. } | Wrong::TooFast { .. } => {}
            }
            self.say_wrong(job.span, wrong, at, is_tilted);
        }
        if let (Sweep::Feed(_) | Sweep::Thread(_), Some(contact)) = (run, &self.contact)
            && contact.entered.is_some()
        {
            self.judge_offset(job.span);
        }
    }

    /// Feed per turn, mm; `None` where the spindle does not turn forwards.
    fn per_turn(&self, path: &Path, run: Sweep) -> Option<f64> {
        let (Sweep::Feed(feed) | Sweep::Thread(feed)) = run else { return None };
        let spin = self.spindles.first().map_or(Spin::ZERO, |state| state.ordered).value();
        if spin <= 0.0 {
            return None;
        }
        let fastest = self.limits.axes[2].map_or(f64::INFINITY, |axis| axis.feed_speed.value());
        Some(match feed {
            Feed::PerTime(speed) => speed.value().min(fastest) / spin,
            Feed::PerRevolution(lead) => lead.value(),
            Feed::Duration(time) => (path.length() / time.value()).min(fastest) / spin,
        })
    }

    /// A hole that is about to be made.
    pub(super) fn judge_hole(&mut self, job: &Job, hole: &Hole) {
        if hole.axis != Axis::Z {
            return;
        }
        let at = hole.at.linear;
        if self.meets_air(job.span, [at[0], at[1]], hole.bottom) {
            return;
        }
        self.judge_zero(job.span, hole.zero, hole.own_zero);
        let flutes = self.tools.get(self.tool).and_then(|tool| tool.body.flutes);
        self.judge_reach(job.span, hole.bottom, flutes);
    }

    /// A tap in its cycle.
    pub(super) fn judge_tap(&mut self, job: &Job, tap: &Tap) {
        if tap.axis != Axis::Z {
            return;
        }
        let at = tap.start.linear;
        if self.meets_air(job.span, [at[0], at[1]], tap.bottom) {
            return;
        }
        self.judge_zero(job.span, tap.zero, tap.own_zero);
        let (flutes, chamfer) = match self.tools.get(self.tool).map(|tool| &tool.kind) {
            Some(ToolKind::Tap(tool)) => {
                let chamfer = tool.chamfer_pitches * tool.lead.abs().value();
                (Some(tool.thread_length), chamfer)
            }
            _ => (None, 0.0),
        };
        if let Some((depth, _, _)) = self.depth_at(tap.bottom).filter(|(d, ..)| *d <= chamfer) {
            self.say_chamfer(job.span, depth, chamfer);
        }
        self.judge_offset(job.span);
        // what the flutes cut by the program's own numbers is judged with the tap
        let programmed = (tap.surface - tap.bottom).abs();
        self.judge_reach(job.span, tap.bottom, flutes.filter(|flutes| programmed <= *flutes));
        let long = self.tools.get(self.tool).map_or(Length::ZERO, canon::Tool::worn_length);
        let [x, y, _] = at.map(Length::value);
        self.judge_body(job.span, [x, y, (tap.bottom - long).value()]);
    }

    /// Mounted tool of a form that is known, its tip's depth when the axis stands there, and the
    /// stock.
    fn depth_at(&self, z: Length) -> Option<(f64, &Tool, &Contact)> {
        let contact = self.contact.as_ref()?;
        let tool = self.tools.get(self.tool)?;
        form(tool, 1.0, false)?;
        let depth = contact.stock.top() - (z - tool.worn_length()).value();
        (self.limits.tapping.axis == Axis::Z).then_some((depth, tool, contact))
    }

    fn meets_air(&mut self, span: diag::Span, at: [Length; 2], bottom: Length) -> bool {
        let Some((depth, tool, contact)) = self.depth_at(bottom) else { return true };
        let place = at.map(Length::value);
        let is_over = contact.stock.is_below(place);
        if is_over && depth > ROUNDING {
            let over = contact.stock.over_side(place, tool.diameter.value() / 2.0);
            if over > ROUNDING {
                self.say_side(span, at, over);
            }
            return false;
        }
        self.say_air(span, at, bottom, is_over);
        true
    }

    /// Whether the program's zero, without the tool's length offset, is the workpiece's. A work
    /// offset other than the first states its own.
    fn judge_zero(&mut self, span: diag::Span, zero: Length, own: Option<Length>) {
        let Some(contact) = self.contact.as_ref().filter(|_| own.is_none()) else { return };
        let off = zero - self.frame.tool.linear[2] - contact.stock.zero;
        if off.abs() > MISPLACED {
            self.say_zero(span, off);
        }
    }

    /// Depth against what the tool reaches: its length to the spindle's nose, and a tap's flutes.
    fn judge_reach(&mut self, span: diag::Span, bottom: Length, flutes: Option<Length>) {
        let Some((depth, tool, _)) = self.depth_at(bottom) else { return };
        let whole = tool.worn_length().value();
        if let Some(flutes) = flutes.filter(|flutes| depth > flutes.value() + ROUNDING) {
            self.say_reach(span, depth, flutes.value(), "its flutes end");
        } else if depth > whole {
            self.say_reach(span, depth, whole, "the spindle's nose meets the stock");
        }
    }

    /// Whether the length offset in force is that of the tool in the spindle, once a tool.
    fn judge_offset(&mut self, span: diag::Span) {
        if self.contact.as_ref().is_some_and(|contact| !contact.offset_said)
            && let Some(cause) = self.offset_cause()
        {
            self.say_offset(span, &cause);
        }
    }
}
