//! The one memory of a block that is drilled, tapped and milled: what is where, and what a later
//! cut has done to it.
//!
//! ```text
//!   samples of drills ──► plunge ──► bore ──┐         ┌─► what a tap finds below it
//!   a tap, measured ───────► tapped place ──┼─ places ┼─► where the material begins under a tool
//!   samples of mills ──► cut into a ring ───┘         └─► a verdict is taken back: destroyed in line N
//! ```
//!
//! Bores are what drills have *really* made, by cycle or by G1, not what was ordered. A thread is a
//! ring between its largest bore and its nominal diameter: what is cut inside of it (its own hole
//! once more, a deeper one) changes nothing, what is cut into it takes it away from its top down to
//! there. A chamfer of [`MOUTH_PITCHES`] at its mouth belongs to it.
//!
//! Places are known in X and Y of the machine, for each position of the rotary axes apart.
mod cut;
mod places;
mod surface;

pub(crate) use places::{Bore, TappedPlace};
pub(crate) use surface::{Surface, Under};

use crate::milling::{Cutter, is_of_unknown_form};
use crate::stroke::{axis_mm, edge_of};
use crate::undone::{Undone, of_before};
use crate::{Config, Stock};
use bus::Sample;
use canon::{Tool, ToolKind};
pub(crate) use cut::ToolCut;
use cut::apart;
use places::{NOISE_MM, same_side};
use units::Length;

/// Pitches of a thread's mouth that a countersink or a chamfer may take.
const MOUTH_PITCHES: f64 = 2.0;
/// A flat tool may take so much of a thread, mm: the tolerance of its depth.
const SCRAPE_MM: f64 = 0.1;
/// A tool that has not gone down by more than this at one place has drilled nothing, mm.
const LEAST_PLUNGE_MM: f64 = 0.05;
/// It is at another place from this distance on, mm.
const ELSEWHERE_MM: f64 = 0.1;
/// Threads are compared with a mill's place this often, mm.
const MILL_STEP_MM: f64 = 0.05;
/// Features that one thread keeps: tapped and tapped again.
const MOST_OPS: usize = 4;

/// What tools have made of the work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workpiece {
    bores: Vec<Bore>,
    threads: Vec<TappedPlace>,
    /// Something of it was drilled, or is going to be.
    is_drilled: bool,
    tool: Option<InSpindle>,
    number: Option<u32>,
    plunge: Option<Plunge>,
    /// Where mills were compared with threads last.
    looked_at: Option<[f64; 3]>,
    rotary: [f64; 3],
    undone: Vec<Undone>,
}

/// A drill or mill in the spindle.
#[derive(Clone, Copy, Debug)]
struct InSpindle {
    cutter: Cutter,
    length_mm: f64,
    is_spot: bool,
    is_mill: bool,
    /// It is known what its edges leave.
    is_known: bool,
}

/// A tool on its way down at one place.
#[derive(Clone, Copy, Debug)]
struct Plunge {
    at: [f64; 2],
    from_mm: f64,
    deepest_mm: f64,
    feature: Option<u32>,
    line: u32,
}

impl Workpiece {
    /// The same work, before another tool comes near.
    pub(crate) fn at_rest(mut self) -> Self {
        self.settle();
        self.undone.clear();
        self.bores.iter_mut().for_each(|bore| bore.op = bore.op.map(of_before));
        let ops = self.threads.iter_mut().flat_map(|thread| &mut thread.ops);
        ops.for_each(|op| *op = of_before(*op));
        Self { tool: None, number: None, looked_at: None, ..self }
    }

    /// A program drills, or is going to.
    pub(crate) const fn will_be_drilled(&mut self) {
        self.is_drilled = true;
    }

    /// Something of it was drilled, or is going to be.
    pub(crate) const fn is_drilled(&self) -> bool {
        self.is_drilled
    }

    /// Bores at the present position of the rotary axes.
    pub(crate) fn bores(&self) -> impl Iterator<Item = &Bore> + Clone {
        let rotary = self.rotary;
        self.bores.iter().filter(move |bore| same_side(bore.rotary, rotary))
    }

    /// Bores that a tap could go into.
    pub(crate) fn holes(&self) -> impl Iterator<Item = &Bore> + Clone {
        self.bores().filter(|bore| !bore.is_spot)
    }

    /// The bore of a feature was there before its drill came.
    pub(crate) fn was_there(&self, op: u32) -> bool {
        let own = self.bores.iter().rfind(|bore| bore.op == Some(op));
        own.is_some_and(|bore| bore.is_found_made)
    }

    /// A feature was changed since it was asked last.
    pub(crate) const fn has_undone(&self) -> bool {
        !self.undone.is_empty()
    }

    /// What was destroyed since it was asked last.
    pub(crate) fn take_undone(&mut self) -> Vec<Undone> {
        std::mem::take(&mut self.undone)
    }

    /// Nothing is under way.
    pub(crate) fn settle(&mut self) {
        self.end_plunge();
        self.end_milling();
    }

    /// A servo period. `feature`: first op of the feature under way.
    pub(crate) fn sample(&mut self, sample: &Sample, config: &Config, feature: Option<u32>) {
        let number = sample.feedback.tool;
        if self.number != number {
            self.settle();
            self.number = number;
            self.looked_at = None;
            self.tool = number.and_then(|number| config.mill(number)).and_then(InSpindle::of);
            // what turns has a judge that knows inserts
            let is_block = config.mill_stock.is_some();
            self.tool = self.tool.filter(|tool| tool.is_known || is_block);
        }
        let Some(tool) = self.tool else {
            if feature.is_some() {
                self.rotary = [3, 4, 5].map(|axis| axis_mm(sample, axis));
            }
            return;
        };
        let tip_mm = edge_of(sample, 2) - tool.length_mm;
        let top_mm = config.stock.as_ref().map_or(f64::INFINITY, |stock| stock.top().value());
        if tip_mm >= top_mm || !tip_mm.is_finite() {
            self.end_plunge();
            return;
        }
        if sample.truth.as_ref().is_some_and(|truth| truth.tool_broken) {
            return;
        }
        let at = [0, 1].map(|axis| axis_mm(sample, axis));
        let rotary = [3, 4, 5].map(|axis| axis_mm(sample, axis));
        if !same_side(rotary, self.rotary) {
            self.settle();
            self.rotary = rotary;
        }
        if is_beside(config.stock.as_ref(), at, tool.cutter.radius) {
            self.end_plunge();
            return;
        }
        let line = sample.report.line;
        if !tool.is_mill || feature.is_some() && tool.is_known {
            self.plunges(at, tip_mm, (feature, line));
        }
        if tool.is_mill && !self.threads.is_empty() {
            self.mills(ToolCut { at, tip_mm, cutter: tool.cutter }, (line, tool.is_known));
        }
    }

    fn plunges(&mut self, at: [f64; 2], tip_mm: f64, (feature, line): (Option<u32>, u32)) {
        if self.plunge.as_ref().is_some_and(|plunge| {
            apart(plunge.at, at) > ELSEWHERE_MM
                || plunge.feature != feature && plunge.feature.is_some()
        }) {
            self.end_plunge();
        }
        let begun = Plunge { at, from_mm: tip_mm, deepest_mm: tip_mm, feature, line };
        let plunge = self.plunge.get_or_insert(begun);
        plunge.feature = plunge.feature.or(feature);
        if tip_mm < plunge.deepest_mm {
            plunge.deepest_mm = tip_mm;
            (plunge.at, plunge.line) = (at, line);
        }
        plunge.from_mm = plunge.from_mm.max(tip_mm);
    }

    /// The tool is out of its hole.
    pub(crate) fn end_plunge(&mut self) {
        let (Some(plunge), Some(tool)) = (self.plunge.take(), self.tool) else { return };
        if plunge.from_mm - plunge.deepest_mm < LEAST_PLUNGE_MM {
            return;
        }
        let cut = ToolCut { at: plunge.at, tip_mm: plunge.deepest_mm, cutter: tool.cutter };
        let radius = tool.cutter.radius;
        self.is_drilled = true;
        self.bored(Bore {
            at: plunge.at.map(Length::mm),
            diameter: Length::mm(2.0 * radius),
            bottom_mm: plunge.deepest_mm + tool.cutter.rise(radius),
            cut,
            is_spot: tool.is_spot,
            top_mm: plunge.from_mm,
            op: plunge.feature,
            is_ordered: plunge.feature.is_some(),
            line: plunge.line,
            rotary: self.rotary,
            is_broken_into: false,
            is_found_made: false,
        });
    }

    /// A bore was made: what it has changed, and it is remembered.
    fn bored(&mut self, mut new: Bore) {
        let Self { threads, bores, undone, rotary, .. } = self;
        new.is_found_made = bores.iter().any(|old| {
            let is_deep = old.bottom_mm <= new.bottom_mm + LEAST_PLUNGE_MM;
            (old.op != new.op || old.op.is_none())
                && !old.is_spot
                && is_deep
                && old.is_about(new.cut.at)
        });
        for thread in threads.iter_mut().filter(|thread| same_side(thread.rotary, *rotary)) {
            if let Some(level) = new.cut.ring_level(thread.at, thread.ring) {
                let allowed = if new.is_spot && !new.is_about(thread.at) {
                    thread.pitch_mm
                } else if new.is_about(thread.at) {
                    MOUTH_PITCHES * thread.pitch_mm
                } else {
                    SCRAPE_MM
                };
                thread.is_cut_away(new.line, level, allowed, undone);
            }
        }
        let span = [new.top_mm, new.bottom_mm];
        for old in bores.iter_mut().filter(|old| same_side(old.rotary, *rotary)) {
            let is_another = old.is_ordered && old.op != new.op && !new.is_spot;
            if is_another && old.breaks_into(new.cut.at, new.radius(), span).is_some() {
                old.is_broken_into_by(new.cut.at, new.line, "hole", undone);
            }
        }
        bores.retain(|old| !new.stands_for(old));
        bores.push(new);
    }

    /// What is wrong with the bore of a feature: it breaks into another, or into a thread.
    pub(crate) fn neighbours(&self, op: u32) -> Option<String> {
        let own = self.bores.iter().rfind(|bore| bore.op == Some(op) && !bore.is_spot)?;
        let span = [own.top_mm, own.bottom_mm];
        let here = self.bores().filter(|old| old.is_ordered && old.op != Some(op));
        let mut holes =
            here.filter(|old| old.breaks_into(own.cut.at, own.radius(), span).is_some());
        let thread = self.threads.iter().find(|thread| {
            same_side(thread.rotary, own.rotary)
                && !own.is_about(thread.at)
                && apart(thread.at, own.cut.at) + thread.ring[1] > own.radius()
                && own
                    .cut
                    .ring_level(thread.at, thread.ring)
                    .is_some_and(|level| level.max(thread.bottom_mm) < thread.top_mm - SCRAPE_MM)
        });
        let at = own.cut.at;
        thread
            .map(|thread| breaks("thread", thread.line, apart(thread.at, at)))
            .or_else(|| holes.next().map(|old| breaks("hole", old.line, apart(old.cut.at, at))))
    }

    /// A thread was tapped: what is wrong with it because of what is there, what it has changed,
    /// and it is remembered.
    pub(crate) fn tapped(&mut self, mut new: TappedPlace) -> Vec<String> {
        new.rotary = self.rotary;
        let Self { threads, bores, undone, .. } = self;
        let span = [new.top_mm, new.bottom_mm];
        let mut findings = Vec::new();
        for bore in bores.iter_mut().filter(|bore| same_side(bore.rotary, new.rotary)) {
            let beside = bore.breaks_into(new.at, new.ring[1], span);
            if beside.is_some_and(|beside| beside > new.pitch_mm) {
                findings.push(breaks("hole", bore.line, apart(bore.cut.at, new.at)));
                bore.is_broken_into_by(new.at, new.line, "thread", undone);
            }
        }
        let cutter = Cutter::flat(new.ring[1]);
        let cut = ToolCut { at: new.at, tip_mm: new.bottom_mm, cutter };
        let mut ops = Vec::new();
        for old in threads.iter_mut().filter(|old| same_side(old.rotary, new.rotary)) {
            let is_here = apart(old.at, new.at) <= ELSEWHERE_MM;
            match old.off_groove(&new).filter(|_| is_here) {
                Some(off) if off <= old.play_mm.max(NOISE_MM) => ops.append(&mut old.ops.clone()),
                Some(off) => {
                    let um = off * 1e3;
                    findings.push(format!(
                        "it is tapped {um:.0} µm beside the groove of the thread of line {}",
                        old.line
                    ));
                    let how = format!("tapped again, {um:.0} µm beside its groove");
                    old.is_destroyed_by(new.line, &how, undone);
                }
                None => {
                    if let Some(level) = cut.ring_level(old.at, old.ring) {
                        if !is_here && level < old.top_mm - SCRAPE_MM && !old.is_destroyed {
                            findings.push(breaks("thread", old.line, apart(old.at, new.at)));
                        }
                        old.is_cut_away(new.line, level, SCRAPE_MM, undone);
                    }
                }
            }
        }
        // the same thread, tapped again: one place, with the features of both
        threads.retain(|old| {
            old.is_destroyed || apart(old.at, new.at) > ELSEWHERE_MM || !old.is_same_groove(&new)
        });
        ops.extend(&new.ops);
        let first = ops.len().saturating_sub(MOST_OPS);
        new.ops = ops.split_off(first);
        threads.retain(|old| !old.is_destroyed);
        threads.push(new);
        findings.truncate(3);
        findings
    }

    fn mills(&mut self, cut: ToolCut, (line, is_known): (u32, bool)) {
        let tip = [cut.at[0], cut.at[1], cut.tip_mm];
        let is_near = |last: &[f64; 3]| (0..3).all(|i| (last[i] - tip[i]).abs() < MILL_STEP_MM);
        if self.looked_at.as_ref().is_some_and(is_near) {
            return;
        }
        self.looked_at = Some(tip);
        let rotary = self.rotary;
        for thread in &mut self.threads {
            if let Some(level) = cut.ring_level(thread.at, thread.ring)
                && level < thread.top_mm
                && same_side(thread.rotary, rotary)
            {
                let allowed = if cut.cutter.is_pointed() {
                    MOUTH_PITCHES * thread.pitch_mm
                } else {
                    SCRAPE_MM
                };
                if level < thread.ordered_top_mm() - allowed {
                    let (_, lowest, known) = thread.hit.get_or_insert((line, level, is_known));
                    *lowest = lowest.min(level);
                    *known &= is_known;
                }
            }
        }
    }

    /// The mill is taken out: what it has left of the threads is said.
    pub(crate) fn end_milling(&mut self) {
        let Self { threads, undone, .. } = self;
        for thread in threads {
            match thread.hit.take() {
                Some((line, level, true)) => thread.is_cut_away(line, level, 0.0, undone),
                Some((line, level, false)) => thread.may_be_cut_away(line, level, undone),
                None => {}
            }
        }
    }
}

impl Bore {
    fn is_broken_into_by(&mut self, at: [f64; 2], line: u32, what: &str, undone: &mut Vec<Undone>) {
        let Some(op) = self.op.filter(|_| !self.is_broken_into) else { return };
        self.is_broken_into = true;
        let apart = apart(self.cut.at, at);
        let how = format!("the {what} made there, {apart:.2} mm beside its axis, breaks into it");
        undone.push(Undone { op, line, how, is_known: true });
    }
}

impl TappedPlace {
    /// It is cut away down to a coordinate by a line; so much at its mouth is allowed.
    fn is_cut_away(&mut self, line: u32, level: f64, allowed: f64, undone: &mut Vec<Undone>) {
        if level < self.ordered_top_mm() - allowed {
            let how = self.left_of(level);
            self.is_destroyed_by(line, &how, undone);
        }
    }

    fn is_destroyed_by(&mut self, line: u32, how: &str, undone: &mut Vec<Undone>) {
        if !std::mem::replace(&mut self.is_destroyed, true) {
            let how = how.to_owned();
            let of = |op: &u32| Undone { op: *op, line, how: how.clone(), is_known: true };
            undone.extend(self.ops.iter().map(of));
        }
    }

    /// A tool has gone through it of which no more is known than how far it reaches.
    fn may_be_cut_away(&self, line: u32, level: f64, undone: &mut Vec<Undone>) {
        let left = self.left_of(level);
        let how = format!(
            "a tool whose form is not known went through it: if it is as wide as its diameter there, {left}"
        );
        let of = |op: &u32| Undone { op: *op, line, how: how.clone(), is_known: false };
        undone.extend(self.ops.iter().map(of));
    }

    fn is_same_groove(&self, other: &Self) -> bool {
        self.off_groove(other).is_some_and(|off| off <= self.play_mm.max(NOISE_MM))
    }
}

fn breaks(what: &str, line: u32, apart: f64) -> String {
    format!("it breaks into the {what} of line {line}, whose axis is {apart:.2} mm beside its own")
}

/// All of the tool is beside the block.
fn is_beside(stock: Option<&Stock>, at: [f64; 2], radius: f64) -> bool {
    stock.is_some_and(|stock| stock.over_side(at, -radius) >= 0.0)
}

impl InSpindle {
    fn of(tool: &Tool) -> Option<Self> {
        let radius = tool.diameter.value() / 2.0;
        let cutter = match &tool.kind {
            ToolKind::EndMill(_) => Cutter::of(tool).or(Some(Cutter::flat(radius))),
            _ => Cutter::of(tool).or_else(|| Cutter::around(tool)),
        };
        let is_known = !is_of_unknown_form(tool);
        Some(Self {
            cutter: cutter.filter(|cutter| cutter.radius > 0.0)?,
            length_mm: tool.worn_length().value(),
            is_spot: matches!(tool.kind, ToolKind::SpotDrill { .. }),
            is_mill: matches!(tool.kind, ToolKind::EndMill(_)) || !is_known,
            is_known,
        })
    }
}
