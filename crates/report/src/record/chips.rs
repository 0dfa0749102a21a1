//! Chip removal as it happened between two holes: when the spindle turned round, and what the
//! travel hid of it.
//!
//! ```text
//!   Z tip  ╲   ╱──────────╲        left R │← hop ───────────────────────►│ cut
//!           ╲_╱            ╲              │
//!   spindle ───╲        ╱────             1 −U told   2 −U reached   3 forward again   4 as it shall be   5 cut
//!                ╲____╱
//! ```
//!
//! All of it is seen from real positions and speeds; the order says only which speeds were meant. A
//! hop is the way from leaving one hole's R plane to the beginning of the next hole's cut. What the
//! manoeuvre would cost without overlap is the time from 1 to 4; a hop without removal is measured
//! where the program has one, else it is the hop less its waits.
use bus::{Sample, State};
use canon::{Axis, ChipRemoval, Op, OpKind, SpindleOrder};
use std::collections::{BTreeMap, VecDeque};
use units::{Angle, Length, Spin, Time};

/// Of an ordered speed, what counts as reached.
const REACHED: f64 = 0.98;
/// A spindle that shall stand does below this.
const STANDS: Spin = Spin::rpm(30.0);
/// The axis has left the R plane when it is this near to it from below, or above: mm.
const AT_LEVEL: f64 = 0.02;
/// Rows of the picture are this far apart, s.
const ROW_EVERY: f64 = 1e-3;
/// Rows kept at most.
const ROWS: usize = 40_000;
/// Holes that the picture shows.
const SHOWN: usize = 3;
/// Hops kept at most.
const HOPS: usize = 20_000;

/// One row of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChipRow {
    pub(crate) time: f64,
    pub(crate) rpm: f64,
    /// X, Y and the tip's Z, machine coordinates, mm.
    pub(crate) at: [f64; 3],
}

/// When the spindle did what, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Manoeuvre {
    /// The R plane was passed, and the spindle told to turn back.
    pub(crate) told: f64,
    /// It had the speed that throws chips off.
    pub(crate) reached: Option<f64>,
    /// It passed zero on its way back.
    pub(crate) forward: Option<f64>,
    /// It had the speed for the next cut, or stood for a tap.
    pub(crate) ready: Option<f64>,
}

/// From one hole to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hop {
    /// When the R plane was left, and when the next cut began, s.
    pub(crate) from: f64,
    pub(crate) cut: f64,
    /// Of that, waiting at the R plane, s.
    pub(crate) waited: f64,
    /// The chip removal on the way, if there was one.
    pub(crate) removal: Option<Manoeuvre>,
    /// Which hole it left, counted from 1 in the program's order.
    pub(crate) hole: usize,
}

/// Where the tool is between its holes.
#[derive(Clone, Copy, Debug, Default)]
enum ChipStage {
    /// Not in a hole yet.
    #[default]
    Before,
    /// Cutting.
    Cutting,
    /// On the way to the next one.
    Hopping(Hop),
}

/// Follows a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chips {
    /// R planes by op.
    levels: BTreeMap<u32, (Axis, Length)>,
    orders: VecDeque<(u32, ChipRemoval)>,
    stage: ChipStage,
    hole: usize,
    hole_op: u32,
    throw: Option<ChipRemoval>,
    rows: VecDeque<ChipRow>,
    /// When each hole's cut began, of those that the rows show.
    cuts: VecDeque<(usize, f64)>,
    frozen: bool,
    last_row: f64,
    before: Option<(Time, Angle)>,
    pub(crate) hops: Vec<Hop>,
}

impl Chips {
    /// Announce an operation.
    pub(crate) fn op(&mut self, index: u32, op: &Op) {
        match &op.kind {
            OpKind::Hole(hole) => {
                self.levels.insert(index, (hole.axis, hole.at.along(hole.axis).of_linear()));
            }
            OpKind::Tap(tap) => {
                self.levels.insert(index, (tap.axis, tap.start.along(tap.axis).of_linear()));
            }
            OpKind::Spindle { order: SpindleOrder::ThrowChips(chips), .. } => {
                self.orders.push_back((index, *chips));
            }
            _ => {}
        }
    }

    /// One servo period; `length` is that of the tool.
    pub(crate) fn sample(&mut self, sample: &Sample, length: Length) {
        let (now, angle) = (sample.feedback.time, sample.spindle(0));
        let Some((before, was)) = self.before.replace((now, angle)) else { return };
        if now <= before {
            return;
        }
        let spin = sample.truth.as_ref().map_or((angle - was) / (now - before), |t| t.spins[0]);
        let op = sample.report.op;
        let Some((&hole_op, &(axis, level))) = self.levels.range(..=op).next_back() else { return };
        self.row(sample, now.value(), spin, length);
        let cuts = matches!(sample.report.state, State::Feed | State::TapIn | State::TapBottom);
        let height = sample.axis(axis.index()).of_linear() - level;
        self.stage = match self.stage {
            ChipStage::Before if cuts => self.begin_cut(hole_op, now.value()),
            ChipStage::Before => ChipStage::Before,
            ChipStage::Cutting if height.value() > -AT_LEVEL && !cuts => {
                self.throw = None;
                ChipStage::Hopping(Hop {
                    from: now.value(),
                    cut: f64::NAN,
                    waited: 0.0,
                    removal: None,
                    hole: self.hole,
                })
            }
            ChipStage::Cutting => ChipStage::Cutting,
            ChipStage::Hopping(hop) if cuts => {
                if hole_op != self.hole_op {
                    self.end_hop(Hop { cut: now.value(), ..hop });
                }
                self.begin_cut(hole_op, now.value())
            }
            ChipStage::Hopping(hop) => {
                let waits = matches!(sample.report.state, State::SpindleWait);
                let waited = if waits { (now - before).value() } else { 0.0 };
                let hop = Hop { waited: hop.waited + waited, ..hop };
                ChipStage::Hopping(self.watch(hop, op, now.value(), spin))
            }
        };
    }

    /// Follow the spindle through its manoeuvre.
    fn watch(&mut self, mut hop: Hop, op: u32, now: f64, spin: Spin) -> Hop {
        let is_due = self.orders.front().is_some_and(|(ordered, _)| *ordered <= op);
        if self.throw.is_none()
            && is_due
            && let Some((_, order)) = self.orders.pop_front()
        {
            self.throw = Some(order);
            hop.removal = Some(Manoeuvre { told: hop.from, ..Manoeuvre::default() });
        }
        let (Some(order), Some(seen)) = (self.throw, &mut hop.removal) else { return hop };
        if seen.reached.is_none() {
            seen.reached = (spin / order.throw >= REACHED).then_some(now);
        } else if seen.forward.is_none() {
            seen.forward = (spin / order.throw <= 0.0 || spin.abs() < STANDS).then_some(now);
        }
        if seen.forward.is_some() && seen.ready.is_none() {
            let ready = if order.then == Spin::ZERO {
                spin.abs() < STANDS
            } else {
                spin / order.then >= REACHED
            };
            seen.ready = ready.then_some(now);
        }
        hop
    }

    fn begin_cut(&mut self, hole_op: u32, now: f64) -> ChipStage {
        if hole_op != self.hole_op || self.hole == 0 {
            self.hole += 1;
            self.hole_op = hole_op;
            if !self.frozen {
                self.cuts.push_back((self.hole, now));
            }
            if self.cuts.len() > SHOWN {
                // the oldest goes
                self.cuts.pop_front();
                let first = self.cuts.front().map_or(0.0, |cut| cut.1);
                self.rows.retain(|row| row.time >= first);
            }
        }
        ChipStage::Cutting
    }

    fn end_hop(&mut self, hop: Hop) {
        if self.hops.len() < HOPS {
            self.hops.push(hop);
        }
    }

    fn row(&mut self, sample: &Sample, now: f64, spin: Spin, length: Length) {
        let shown = self.hops.iter().any(|hop| hop.removal.is_some());
        let leaves = matches!(self.stage, ChipStage::Hopping(_));
        // the hole after the first removal is shown to its end
        self.frozen |= shown && leaves && self.cuts.len() == SHOWN;
        if self.frozen || now - self.last_row < ROW_EVERY {
            return;
        }
        self.last_row = now;
        if self.rows.len() == ROWS {
            self.rows.pop_front();
        }
        let at = [Axis::X, Axis::Y, Axis::Z].map(|axis| sample.axis(axis.index()).value());
        let at = [at[0], at[1], at[2] - length.value()];
        self.rows.push_back(ChipRow { time: now, rpm: spin.in_rpm(), at });
    }

    /// The first removal, and what there is to draw around it: rows, and which hole was cut when.
    #[allow(clippy::type_complexity)] // three things that are drawn together, once
    pub(crate) fn shown(&self) -> Option<(Hop, &VecDeque<ChipRow>, &VecDeque<(usize, f64)>)> {
        let hop = self.hops.iter().find(|hop| hop.removal.is_some())?;
        Some((*hop, &self.rows, &self.cuts))
    }
}
