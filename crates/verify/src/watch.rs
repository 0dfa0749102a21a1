//! What may never happen while a tool is in the work, looked for in every servo period.
//!
//! ```text
//!   ops     ─► speed in force, hole or thread in work ─┐
//!                                                      ├─► breaches: what, where, when
//!   samples ─► state, real places, real speeds ────────┘
//! ```
//!
//! | invariant | looked for while |
//! |---|---|
//! | the spindle turns in the sense in force, within a quarter of its speed | a drill is fed into the material |
//! | the tap and its helix do not go opposite ways by more than [`AGAINST_MM`] | a tap tied to the spindle is in the material |
//! | nothing moves across the tool by more than [`ACROSS_MM`] | a tap is in the material, also while it is stopped or taken out |
//! | the tip is not more than [`BEYOND_MM`] beyond the programmed bottom | a drill or tap is in the material |
//! | the tool is whole | always |
//!
//! The judge grades what was cut; this one says whether it was ever cut in a way that no program
//! may ask for. It believes real positions and speeds only, and knows neither plan nor kernel.
use crate::config::Config;
use crate::stroke::Stroke;
use bus::{Sample, State};
use canon::{Axis, Holder, Op, OpKind, SpindleOrder, ToolKind};
use core::f64::consts::TAU;
use std::collections::{BTreeMap, VecDeque};
use units::{Angle, Length, Speed, Spin, Time};

mod breakage;

/// Most that a tap in its thread is moved sideways, mm: encoders and feeds that stand still do
/// less.
pub const ACROSS_MM: f64 = 0.05;
/// Most that a tip goes beyond the bottom, mm: what a hole's point leaves, and twice what a thread
/// may overrun.
pub const BEYOND_MM: f64 = 0.1;
/// By how much of the ordered speed a drill may be pulled down.
const SPEED_SHARE: f64 = 0.25;
/// Most by which a tap and its helix pass each other while they go opposite ways, mm. At the
/// turning point one of them turns back a moment before the other; that costs micrometres.
pub const AGAINST_MM: f64 = 0.005;
/// The tip is in the material from here on, mm.
const TOUCH_MM: f64 = 0.05;
/// Nearer to the axis of the work than this, mm, a surface speed without a limit asks for whatever
/// the spindle has.
const NEAR_AXIS_MM: f64 = 5.0;
const SIDEWAYS: &str = "a tap is moved sideways in its thread";
/// Breaches that are kept.
const MOST: usize = 100;

/// Something that may never happen did.
#[derive(Clone, Debug, PartialEq)]
pub struct Breach {
    /// What.
    pub what: String,
    /// Program line.
    pub line: u32,
    /// When it began.
    pub time: Time,
}

impl core::fmt::Display for Breach {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "line {}, {:.3} s: {}", self.line, self.time.value(), self.what)
    }
}

/// What is in work.
#[derive(Clone, Debug)]
struct Work {
    axis: Axis,
    at: [Length; 3],
    stroke: Stroke,
    /// Program line: what another line does is none of this one's work.
    line: u32,
    /// Lead of a tap that is tied to the spindle, as travel by positive turn, mm/rev.
    lead: Option<f64>,
}

/// What the program has ordered of the spindle.
#[derive(Clone, Copy, Debug)]
enum OrderedSpeed {
    /// Turn so fast.
    Turn(Spin),
    /// G96: by the place of X, never above the limit.
    Surface(Speed, Option<Spin>),
}

impl OrderedSpeed {
    /// The speed with the tip so far from the axis of the work; `None`: at its highest, which the
    /// program does not say.
    fn at(self, radius: Length) -> Option<Spin> {
        match self {
            Self::Turn(spin) => Some(spin),
            Self::Surface(speed, limit) => {
                let around = TAU * radius.abs().value();
                let free = (around > 0.0).then(|| speed.abs().value() / around);
                let most = limit.map(|limit| limit.abs().value());
                let spin = match (free, most) {
                    (Some(free), Some(most)) => free.min(most),
                    (Some(free), None) if radius.abs().value() > NEAR_AXIS_MM => free,
                    (_, most) => most?,
                };
                Some(Spin::rev_per_s(if speed.value() < 0.0 { -spin } else { spin }))
            }
        }
    }
}

/// Looks on.
#[derive(Clone, Debug)]
pub struct Watch {
    config: Config,
    works: BTreeMap<u32, Work>,
    speeds: VecDeque<(u32, OrderedSpeed)>,
    in_force: OrderedSpeed,
    /// Least and largest share of it that the operator has asked for in this run.
    shares: (f64, f64),
    tool: Option<u32>,
    before: Option<(Time, Angle, Length)>,
    /// By how much tap and helix have passed each other since they last went the same way, mm.
    against_mm: f64,
    /// What was said of the tool that is broken.
    broken: Option<String>,
    /// Numbers of all that were in the spindle broken.
    all_broken: std::collections::BTreeSet<u32>,
    /// The breach that goes on.
    open: Option<String>,
    periods: u64,
    breaches: Vec<Breach>,
    count: u64,
    /// Periods, periods in which something was wrong, and breaches before the program that is under
    /// way.
    before_program: (u64, u64, usize),
}

impl Watch {
    /// One who has seen nothing yet.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            works: BTreeMap::new(),
            speeds: VecDeque::new(),
            in_force: OrderedSpeed::Turn(Spin::ZERO),
            shares: (1.0, 1.0),
            tool: None,
            before: None,
            against_mm: 0.0,
            broken: None,
            all_broken: std::collections::BTreeSet::new(),
            open: None,
            periods: 0,
            breaches: Vec::new(),
            count: 0,
            before_program: (0, 0, 0),
        }
    }

    /// Another program begins on the same workpiece: what goes on from before is a breach of it,
    /// too. Of those before, as many of the last are kept as are of one program.
    pub fn begin_program(&mut self) {
        let surplus = self.breaches.len().saturating_sub(MOST);
        self.breaches.drain(..surplus);
        self.before_program = (self.periods, self.count, self.breaches.len());
        self.open = None;
    }

    /// What was seen since the last program began.
    #[must_use]
    pub fn of_program(mut self) -> Self {
        let (periods, count, breaches) = std::mem::take(&mut self.before_program);
        self.periods -= periods;
        self.count -= count;
        self.breaches.drain(..breaches);
        self
    }

    /// What the program orders: each op once, in order, before its samples arrive.
    pub fn op(&mut self, index: u32, op: &Op) {
        match &op.kind {
            OpKind::ChangeTool { number } => self.tool = (*number != 0).then_some(*number),
            OpKind::Spindle { spindle: 0, order } => match order {
                SpindleOrder::Turn(spin) => {
                    self.speeds.push_back((index, OrderedSpeed::Turn(*spin)));
                }
                SpindleOrder::Stop => {
                    self.speeds.push_back((index, OrderedSpeed::Turn(Spin::ZERO)));
                }
                SpindleOrder::ConstantSurfaceSpeed { speed, limit } => {
                    self.speeds.push_back((index, OrderedSpeed::Surface(*speed, *limit)));
                }
                _ => {}
            },
            OpKind::Hole(hole) => {
                let work = Work {
                    axis: hole.axis,
                    at: place(&hole.at),
                    stroke: self.clamped(Stroke::of_hole(hole)),
                    line: op.span.line,
                    lead: None,
                };
                self.works.insert(index, work);
            }
            OpKind::Tap(tap) => {
                let into =
                    if tap.bottom < tap.start.along(tap.axis).of_linear() { -1.0 } else { 1.0 };
                let lead = self.is_tied().then_some(tap.lead.value() * into);
                let work = Work {
                    axis: tap.axis,
                    at: place(&tap.start),
                    stroke: self.clamped(Stroke::of_tap(tap)),
                    line: op.span.line,
                    lead,
                };
                self.works.insert(index, work);
            }
            _ => {}
        }
    }

    /// The stroke in the stock, for the tool that is ordered.
    fn clamped(&self, stroke: Stroke) -> Stroke {
        let tool = self.tool.and_then(|number| self.config.tools.get(number));
        stroke.in_stock((self.config.stock.as_ref(), None), tool, &self.config.tools)
    }

    /// The tap is in a holder that ties it to the spindle.
    fn is_tied(&self) -> bool {
        let tool = self.tool.and_then(|number| self.config.tools.get(number));
        self.config.synchronised
            && tool.is_some_and(|tool| match &tool.kind {
                ToolKind::Tap(tap) => !matches!(tap.holder, Holder::Clutch { .. }),
                _ => false,
            })
    }

    /// The operator has turned the spindle override: any speed up to there is meant from then on.
    pub const fn spindle_override(&mut self, share: f64) {
        self.shares = (self.shares.0.min(share), self.shares.1.max(share));
    }

    /// What happened: every servo period, in order.
    pub fn sample(&mut self, sample: &Sample) {
        self.periods += 1;
        let op = sample.report.op;
        while self.speeds.front().is_some_and(|(at, _)| *at <= op) {
            self.in_force = self.speeds.pop_front().map_or(self.in_force, |(_, ordered)| ordered);
        }
        let found = self.look(sample, op);
        if found.is_some() {
            self.count += 1;
        }
        if let Some(what) = found.as_ref().filter(|what| self.open.as_ref() != Some(*what))
            && self.breaches.len() - self.before_program.2 < MOST
        {
            let (line, time) = (sample.report.line, sample.feedback.time);
            self.breaches.push(Breach { what: what.clone(), line, time });
        }
        self.open = found;
    }

    /// Servo periods looked at.
    pub const fn periods(&self) -> u64 {
        self.periods
    }

    /// Servo periods in which something was wrong.
    pub const fn violations(&self) -> u64 {
        self.count
    }

    /// What was wrong, each once when it began.
    pub fn breaches(&self) -> &[Breach] {
        &self.breaches
    }

    /// Numbers of the tools that were in the spindle broken.
    pub const fn broken_tools(&self) -> &std::collections::BTreeSet<u32> {
        &self.all_broken
    }

    fn look(&mut self, sample: &Sample, op: u32) -> Option<String> {
        if sample.truth.as_ref().is_some_and(|truth| !truth.tool_broken) {
            self.broken = None; // another tool
        }
        if sample.truth.as_ref().is_some_and(|truth| truth.tool_broken) {
            self.all_broken.extend(sample.feedback.tool.filter(|number| *number != 0));
            let said = self.broken.take().unwrap_or_else(|| breakage::text(sample, &self.config));
            return self.broken.insert(said).clone().into();
        }
        let (&first, _) = self.works.range(..=op).next_back()?;
        while self.works.first_key_value().is_some_and(|(&done, _)| done < first) {
            self.works.pop_first();
        }
        let work = self.works.get(&first)?;
        let now = sample.feedback.time;
        let (angle, z) = (sample.spindle(0), sample.axis(work.axis.index()).of_linear());
        let (then, was, z_was) = self.before.replace((now, angle, z))?;
        if now <= then || sample.report.line != work.line {
            self.against_mm = 0.0;
            return None;
        }
        let into = work.stroke.sense;
        let depth = work.stroke.depth_mm(z.value());
        if depth < TOUCH_MM {
            self.against_mm = 0.0;
            return None;
        }
        let spin = sample.truth.as_ref().map_or((angle - was) / (now - then), |t| t.spins[0]);
        let feed = (z - z_was).value() / (now - then).value();
        let beyond = depth - work.stroke.programmed_mm;
        if beyond > BEYOND_MM {
            return Some("the tip is beyond the programmed bottom".into());
        }
        let state = sample.report.state;
        let taps = matches!(state, State::TapIn | State::TapBottom | State::TapOut);
        let stopped = matches!(state, State::Faulted | State::Recovering);
        let radius = sample.axis(Axis::X.index()).of_linear() - self.config.work_axis[0];
        let in_force = self.in_force.at(radius).unwrap_or(Spin::ZERO);
        match work.lead {
            Some(_) if stopped => (across(sample, work) > ACROSS_MM).then(|| SIDEWAYS.into()),
            Some(lead) if taps => {
                let across = across(sample, work);
                self.part((z - z_was).value(), (angle - was).value() * lead);
                if self.against_mm > AGAINST_MM {
                    return Some("the spindle turns against the tap's way in the material".into());
                }
                (across > ACROSS_MM).then(|| SIDEWAYS.into())
            }
            None if state == State::Feed && in_force != Spin::ZERO && feed * into > 0.0 => {
                let meant = in_force.abs();
                let turns = if in_force < Spin::ZERO { -spin } else { spin };
                let (least, most) = (self.shares.0 - SPEED_SHARE, self.shares.1 + SPEED_SHARE);
                let wrong = turns < meant * least || turns > meant * most;
                (wrong && !self.is_tap(sample)).then(|| {
                    "a cut with the spindle at the wrong speed or in the wrong sense".into()
                })
            }
            Some(_) | None => None,
        }
    }

    /// Axis and helix have gone so far, mm: the same way, or past each other.
    fn part(&mut self, axis_mm: f64, helix_mm: f64) {
        if axis_mm * helix_mm < 0.0 {
            self.against_mm += (axis_mm - helix_mm).abs();
        } else if axis_mm * helix_mm > 0.0 {
            self.against_mm = 0.0;
        }
    }

    /// A tap in a holder of its own way: its spindle turns round on purpose.
    fn is_tap(&self, sample: &Sample) -> bool {
        let tool = sample.feedback.tool.and_then(|number| self.config.tools.get(number));
        tool.is_some_and(|tool| matches!(tool.kind, ToolKind::Tap(_)))
    }
}

/// How far the axes across the tool stand from the work's place, mm.
fn across(sample: &Sample, work: &Work) -> f64 {
    [Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .filter(|axis| *axis != work.axis)
        .map(|axis| (sample.axis(axis.index()).of_linear() - work.at[axis.index()]).value().abs())
        .fold(0.0, f64::max)
}

fn place(at: &canon::Position) -> [Length; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|axis| at.along(axis).of_linear())
}

#[cfg(test)]
mod tests;
