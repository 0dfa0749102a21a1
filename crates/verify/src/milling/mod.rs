//! Milling, from recorded motion: what each mill has removed of the stock, how it was engaged, and
//! where it went in a rapid through what was left.
//!
//! ```text
//!   sample ─► tip = axis − tool length ─┬─ fed ───► Field: removed ─► Window ─► largest depth, width, chip, force …
//!                                       └─ rapid ─► Field: what is in the way? ─► finding, with its line and place
//!   another tool, or the end ─► one feature for the use of the mill
//! ```
//!
//! No grid is made before a mill comes to the stock. Only X, Y and Z are looked at: once a rotary
//! axis has moved, what is cut is not judged.
mod empty;
mod engagement;
mod field;
mod found;
mod milled;
mod stock;
mod verdict;

#[cfg(test)]
mod tests;

pub use milled::{HeightMap, Largest, Milled, MillingPlace, RapidCut};
pub use stock::{MillStock, StockSource};

use crate::judged::Judged;
use crate::workpiece::Workpiece;
use crate::{Config, Stock};
use bus::{Sample, State};
use canon::{Op, ProgramFrame, Tool, ToolKind};
use empty::EmptySpindle;
use engagement::Window;
pub(crate) use field::Cutter;
use field::Field;
use found::Found;
use std::collections::VecDeque;
use units::{Length, Time};

/// A rapid scrapes so deep without a finding, mm.
const SCRAPES: f64 = 0.2;
/// Of a mill's radius so many cells are left out for rapids: whether a wall stands there is within
/// the error of the grid.
const RAPID_RIM: f64 = 1.5;
/// A rotary axis has moved, °.
const TURNED: f64 = 0.01;
/// Places of one rapid within the stock that are kept.
const MOST_PLACES: usize = 20_000;

/// How the tool moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Fed,
    Rapid,
}

#[derive(Clone, Copy, Debug)]
struct MillPose {
    tip: [f64; 3],
    rotary: [f64; 3],
    time: Time,
    turns: f64,
    op: u32,
    line: u32,
    mode: Mode,
}

/// The use of one mill, until another tool comes.
#[derive(Clone, Debug)]
struct Use {
    number: u32,
    cutter: Option<Cutter>,
    window: Option<Window>,
    found: Found,
    /// Where the rotary axes stood.
    rotary: Option<[f64; 3]>,
    /// The rapid under way: how deep it was in the stock at most, and its places there.
    rapid: Option<(f64, MillingPlace)>,
    passed: Vec<[f64; 3]>,
    /// How the program writes places now, and how far the axis stands above the tip.
    frame: ProgramFrame,
    length: f64,
}

/// Follows all mills.
#[derive(Clone, Debug, Default)]
pub(crate) struct Milling {
    field: Option<Field>,
    at: Option<Use>,
    /// Up to where the stock was looked at, and the last sample.
    last: Option<MillPose>,
    seen: Option<MillPose>,
    empty: EmptySpindle,
    frames: Frames,
}

/// How the program writes places, from one op to the next.
#[derive(Clone, Debug, Default)]
struct Frames {
    now: ProgramFrame,
    /// Of ops to come, where they change it.
    to_come: VecDeque<(u32, ProgramFrame)>,
}

impl Frames {
    fn put(&mut self, op: u32, frame: ProgramFrame) {
        let before = self.to_come.back().map_or(&self.now, |(_, frame)| frame);
        if *before != frame {
            self.to_come.push_back((op, frame));
        }
    }

    fn reached(&mut self, op: u32) {
        while let Some((_, frame)) = self.to_come.pop_front_if(|(from, _)| *from <= op) {
            self.now = frame;
        }
    }
}

impl Milling {
    /// The same stock, before another tool comes near.
    pub(crate) fn at_rest(self) -> Self {
        Self { field: self.field, empty: self.empty.at_rest(), ..Self::default() }
    }

    /// A mill has been fed, or the empty spindle, and is not judged yet.
    pub(crate) fn is_under_way(&self) -> bool {
        self.at.as_ref().is_some_and(|at| at.found.is_begun()) || self.empty.is_under_way()
    }

    /// What is left of the block; `None`: no mill has come near.
    pub(crate) const fn field(&self) -> Option<&Field> {
        self.field.as_ref()
    }

    /// Side of a cell, mm; 0: there is no grid.
    pub(crate) fn cell(&self) -> f64 {
        self.field.as_ref().map_or(0.0, Field::cell)
    }

    /// What the program orders.
    pub(crate) fn op(&mut self, index: u32, op: &Op) {
        self.empty.op(index, op);
    }

    /// How the program has written an op.
    pub(crate) fn frame(&mut self, index: u32, frame: ProgramFrame) {
        self.frames.put(index, frame);
    }

    /// A servo period; the feature of a mill that was taken out.
    pub(crate) fn sample(
        &mut self,
        sample: &Sample,
        config: &Config,
        work: &Workpiece,
    ) -> Option<Judged<Milled>> {
        self.frames.reached(sample.report.op);
        let number = sample.feedback.tool;
        let taken = match &self.at {
            Some(at) if Some(at.number) != number => self.close(config),
            _ => None,
        };
        let tool = number.and_then(|number| config.mill(number));
        let without = match number {
            Some(0) if tool.is_none() => self.empty.sample(sample, config),
            Some(_) => self.empty.close(config),
            None => None, // the changer is at work
        };
        let taken = taken.or(without);
        let Some(tool) = tool else {
            (self.last, self.seen) = (None, None);
            return taken;
        };
        match &tool.kind {
            ToolKind::EndMill(_) => self.follow(sample, tool, config, work),
            // of a block that stands: what turns has a judge that knows inserts
            _ if is_of_unknown_form(tool) && config.mill_stock.is_some() => {
                self.follow(sample, tool, config, work);
            }
            ToolKind::Drill { .. } | ToolKind::SpotDrill { .. } if self.field.is_some() => {
                self.drill(sample, tool);
            }
            _ => (self.last, self.seen) = (None, None),
        }
        taken
    }

    /// What the tool in the spindle has cut so far is judged.
    pub(crate) fn close(&mut self, config: &Config) -> Option<Judged<Milled>> {
        let Some(mut at) = self.at.take() else { return self.empty.close(config) };
        let (last, seen) = (self.last.take(), self.seen.take());
        if let (Some(field), Some(cutter), Some(last), Some(seen)) =
            (&mut self.field, at.cutter, last, seen)
        {
            at.step(field, &cutter, last, MillPose { mode: last.mode, ..seen });
        }
        at.end_rapid(self.field.as_mut());
        at.end_window(None);
        let tool = config.mill(at.number)?;
        at.found.finish(tool, self.field.as_ref(), config)
    }

    fn pose(&self, sample: &Sample, tool: &Tool) -> Option<MillPose> {
        let mode = match (sample.report.state, self.last) {
            (State::Feed, _) => Mode::Fed,
            (State::Rapid, _) => Mode::Rapid,
            (State::Held, Some(last)) => last.mode,
            _ => return None,
        };
        let axis = |i: usize| sample.axis(i).value();
        let tip = [axis(0), axis(1), axis(2) - tool.worn_length().value()];
        let turns = sample.spindle(0).value();
        let finite = tip.iter().all(|value| value.is_finite()) && turns.is_finite();
        finite.then(|| MillPose {
            tip,
            rotary: [3, 4, 5].map(axis),
            time: sample.feedback.time,
            turns,
            op: sample.report.op,
            line: sample.report.line,
            mode,
        })
    }

    /// Neither fed nor in a rapid: the time does not count. What has moved it meanwhile is not
    /// known.
    fn rests(&mut self, sample: &Sample, tool: &Tool) {
        if let (Some(at), Some(field), Some(last), Some(seen)) =
            (&mut self.at, &mut self.field, self.last, self.seen)
            && let Some(cutter) = at.cutter
            && distance(last.tip, seen.tip) > 0.0
        {
            at.step(field, &cutter, last, MillPose { mode: last.mode, ..seen });
            self.last = Some(seen);
        }
        let stands_within = self.field.as_ref().map_or(0.05, Field::cell).max(0.05);
        let at = [0, 1, 2].map(|i| sample.axis(i).value());
        let tip = [at[0], at[1], at[2] - tool.worn_length().value()];
        let stands = |pose: &mut Option<MillPose>| match pose {
            Some(pose) if distance(pose.tip, tip) < stands_within => {
                (pose.time, pose.turns) = (sample.feedback.time, sample.spindle(0).value());
            }
            _ => *pose = None,
        };
        stands(&mut self.last);
        stands(&mut self.seen);
    }

    fn drill(&mut self, sample: &Sample, tool: &Tool) {
        let pose = self.pose(sample, tool);
        let last = std::mem::replace(&mut self.last, pose);
        let (Some(field), Some(cutter), Some(now)) = (&mut self.field, Cutter::of(tool), pose)
        else {
            return;
        };
        let moved = last.is_none_or(|last| distance(last.tip, now.tip) > 0.0);
        if moved && now.mode == Mode::Fed {
            field.meet(&cutter, now.tip, (cutter.radius, true), |_| {});
        }
    }

    fn follow(&mut self, sample: &Sample, tool: &Tool, config: &Config, work: &Workpiece) {
        let Some(now) = self.pose(sample, tool) else {
            self.rests(sample, tool);
            return;
        };
        let at = self.at.get_or_insert_with(|| Use::new(tool));
        at.frame = self.frames.now;
        if now.mode == Mode::Fed {
            at.found.fed(now.op, now.line, now.time);
        }
        let rotary = *at.rotary.get_or_insert(now.rotary);
        let turned = rotary.iter().zip(now.rotary).any(|(a, b)| (a - b).abs() > TURNED);
        at.found.seen.turned |= turned;
        let (Some(stock), Some(cutter)) = (config.mill_stock, at.cutter) else { return };
        if turned {
            return;
        }
        let Some(last) = self.last else {
            (self.last, self.seen) = (Some(now), Some(now));
            return;
        };
        let is_near = |tip: [f64; 3]| near(&stock.block, tip, cutter.radius);
        let seen = self.seen.replace(now).unwrap_or(last);
        let same = (last.op, last.line, last.mode) == (now.op, now.line, now.mode);
        let cell = self.field.as_ref().map_or(cutter.radius / 20.0, Field::cell);
        let way = distance(last.tip, now.tip);
        if way < cell / 2.0 && same {
            return;
        }
        self.last = Some(now);
        if way > 0.0 && (is_near(last.tip) || is_near(now.tip)) {
            if self.field.is_none() {
                self.field = Field::new(stock.block, 2.0 * cutter.radius);
                if let Some(field) = &mut self.field {
                    for hole in work.bores() {
                        field.bore(hole);
                    }
                }
            } else if at.window.is_none() {
                self.field = self.field.take().map(|field| field.refined(2.0 * cutter.radius));
            }
            if let Some(field) = &mut self.field {
                // a move ends where it was seen last, not a part of a cell before
                if !same && distance(last.tip, seen.tip) > 0.0 {
                    at.step(field, &cutter, last, MillPose { mode: last.mode, ..seen });
                    at.step(field, &cutter, seen, now);
                } else {
                    at.step(field, &cutter, last, now);
                }
            }
        }
        if !same {
            if now.mode != last.mode || now.line != last.line {
                at.end_rapid(self.field.as_mut());
            }
            at.end_window(Some(2.0 * cell));
        }
    }
}

/// A tool that cuts a block with edges of which the tool table says no more than how far they
/// reach.
pub(crate) const fn is_of_unknown_form(tool: &Tool) -> bool {
    matches!(tool.kind, ToolKind::Other)
}

/// Over or beside the block within a radius, and below its top.
fn near(block: &Stock, tip: [f64; 3], radius: f64) -> bool {
    tip[2] < block.top().value() && block.over_side([tip[0], tip[1]], -radius) <= 0.0
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

impl Use {
    fn new(tool: &Tool) -> Self {
        Self {
            number: tool.number,
            cutter: Cutter::of(tool).or_else(|| Cutter::around(tool)),
            window: None,
            found: Found::default(),
            rotary: None,
            rapid: None,
            passed: Vec::new(),
            frame: ProgramFrame::default(),
            length: tool.worn_length().value(),
        }
    }

    /// From one pose to another, in places a cell apart.
    fn step(&mut self, field: &mut Field, cutter: &Cutter, last: MillPose, now: MillPose) {
        let way = distance(last.tip, now.tip);
        if way <= 0.0 {
            return;
        }
        let pieces = (way / field.cell()).ceil().clamp(1.0, 100_000.0);
        let each = [0, 1, 2].map(|i| (now.tip[i] - last.tip[i]) / pieces);
        let flat = each[0].hypot(each[1]);
        let direction = if flat > 0.0 { [each[0] / flat, each[1] / flat] } else { [0.0; 2] };
        let time = (now.time - last.time) / pieces;
        let turns = (now.turns - last.turns) / pieces;
        let (zero, frame, length) = (field.stock().zero, self.frame, self.length);
        for k in 1..=pieces as u32 {
            let tip = [0, 1, 2].map(|i| last.tip[i] + each[i] * f64::from(k));
            let place = || MillingPlace {
                line: last.line_of(&now),
                at: [0, 1, 2].map(|i| Length::mm(tip[i]) - zero[i]),
                written: frame.place([tip[0], tip[1], tip[2] + length].map(Length::mm)),
            };
            match now.mode {
                Mode::Rapid => self.rapid(field, cutter, tip, place),
                Mode::Fed => {
                    let cell = field.cell();
                    let window =
                        self.window.get_or_insert_with(|| Window::new(cutter.radius, cell));
                    let mut height = 0.0;
                    field.meet(cutter, tip, (cutter.radius, true), |cut| {
                        height += cut.removed;
                        window.cut(cut, direction);
                    });
                    if height > 0.0 {
                        self.found.removed(height * cell * cell, place());
                        window.went(each, time, turns);
                    }
                    if window.way() >= cutter.radius / 4.0 {
                        self.found.engaged(window.take());
                    }
                }
            }
        }
    }

    fn rapid(
        &mut self,
        field: &mut Field,
        cutter: &Cutter,
        tip: [f64; 3],
        place: impl Fn() -> MillingPlace,
    ) {
        let radius = cutter.radius - RAPID_RIM * field.cell();
        if radius <= 0.0 {
            return;
        }
        let mut deepest = 0.0_f64;
        field.meet(cutter, tip, (radius, false), |cell| deepest = deepest.max(cell.removed));
        if deepest <= 0.0 {
            return;
        }
        if self.passed.len() < MOST_PLACES {
            self.passed.push(tip);
        }
        if deepest > SCRAPES && self.rapid.is_none_or(|(most, _)| deepest > most) {
            self.rapid = Some((deepest, place()));
        }
    }

    /// The rapid is over: what it went through is gone.
    fn end_rapid(&mut self, field: Option<&mut Field>) {
        let passed = std::mem::take(&mut self.passed);
        let Some((depth, place)) = self.rapid.take() else { return };
        self.found.rapid(depth, place);
        if let (Some(field), Some(cutter)) = (field, self.cutter) {
            for tip in passed {
                field.meet(&cutter, tip, (cutter.radius, true), |_| {});
            }
        }
    }

    /// The way of a line is over; a shorter one than this goes on into the next.
    fn end_window(&mut self, least: Option<f64>) {
        let Some(window) = &mut self.window else { return };
        if least.is_none_or(|least| window.way() >= least) {
            self.found.engaged(window.take());
        }
    }
}

impl MillPose {
    /// The line of the way from here: its end's, unless that has only just begun.
    const fn line_of(&self, now: &Self) -> u32 {
        if self.op == now.op { now.line } else { self.line }
    }
}
