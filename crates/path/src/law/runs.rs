//! Runs of lines that go on as one: chopped however finely, they need no more knots than the line
//! that they are.
//!
//! A run's first cell stands for it in the grid; its fines may lie in any of its cells, and reach
//! over their ends. What is handed out is cut at these again.
use super::cell::{Cell, Demand, Start};
use super::fine::Fine;
use super::phase::{Timed, time_at};
use crate::{Instant, Phase};
use alloc::collections::VecDeque;
use alloc::vec::Vec;

/// A run of so many cells, and as long as a step at the feed, ends: motion can be handed out
/// between two runs.
const MOST: usize = 16;

/// What differs by such a share is the same: directions are rounded.
const SAME: f64 = 1e-9;

/// Cells that are seen as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellRun {
    /// The first of them, and the one after the last.
    pub(super) cells: [usize; 2],
    /// Their length.
    pub(super) h: f64,
}

/// Cells as runs; `tau` is the time of a step.
pub(super) fn runs(cells: &[&Cell], tau: f64, runs: &mut Vec<CellRun>) {
    runs.clear();
    for (i, cell) in cells.iter().enumerate() {
        match runs.last_mut() {
            Some(run)
                if (i - run.cells[0] < MOST || run.h < tau * libm::sqrt(cell.cap))
                    && goes_on(cells[i - 1], cell) =>
            {
                run.cells[1] = i + 1;
                run.h += cell.h;
            }
            _ => runs.push(CellRun { cells: [i, i + 1], h: cell.h }),
        }
    }
}

/// Pieces that join smoothly have one direction where they meet, and lines have it everywhere.
fn goes_on(before: &Cell, cell: &Cell) -> bool {
    let (Demand::Line { accel: a0, jerk: j0 }, Demand::Line { accel: a1, jerk: j1 }) =
        (&before.demand, &cell.demand)
    else {
        return false;
    };
    let same = |x: f64, y: f64| x == y || (x - y).abs() <= SAME * x.abs();
    cell.start == Start::On(f64::INFINITY)
        && same(*a0, *a1)
        && same(*j0, *j1)
        && same(before.cap, cell.cap)
}

/// Whether all cells are one line.
pub(super) fn one_line<'a>(cells: impl Iterator<Item = &'a Cell> + Clone) -> bool {
    cells.clone().zip(cells.skip(1)).all(|(before, cell)| goes_on(before, cell))
}

/// Hand out the motion of a fine, cut where a cell ends; the last cell that it lies in.
pub(super) fn hand_out(cells: &VecDeque<Cell>, fine: &Fine, ready: &mut VecDeque<Timed>) -> usize {
    let mut cut = PhaseCut::new(cells, fine.cell, fine.from, fine.from + fine.h, ready);
    fine.phases(|phase| cut.give(phase));
    cut.k
}

/// Cuts motion along a run where its cells end.
pub(super) struct PhaseCut<'a> {
    cells: &'a VecDeque<Cell>,
    ready: &'a mut VecDeque<Timed>,
    /// The cell it is in, and where that begins, from the run's beginning on.
    k: usize,
    begin: f64,
    /// Where the motion ends.
    end: f64,
}

impl<'a> PhaseCut<'a> {
    /// For motion `from` a place of the run that begins with a cell, to an `end`.
    pub(super) fn new(
        cells: &'a VecDeque<Cell>,
        cell: usize,
        from: f64,
        end: f64,
        ready: &'a mut VecDeque<Timed>,
    ) -> Self {
        let mut cut = Self { cells, ready, k: cell, begin: 0.0, end };
        while from >= cut.border(1.0 - SAME) {
            cut.go_on();
        }
        cut
    }

    /// So far through the cell.
    fn border(&self, share: f64) -> f64 {
        self.begin + self.cells[self.k].h * share
    }

    fn go_on(&mut self) {
        self.begin = self.border(1.0);
        self.k += 1;
    }

    /// The next of its phases.
    pub(super) fn give(&mut self, mut phase: Phase) {
        while self.border(1.0 + SAME) < self.end {
            let border = self.border(1.0);
            if phase.end().s <= border {
                break;
            }
            let t = time_at(&phase, border);
            self.push(Phase { duration: t, ..phase });
            let Instant { v, a, .. } = phase.at(t);
            phase = Phase { duration: phase.duration - t, s: border, v, a, j: phase.j };
            self.go_on();
        }
        self.push(phase);
    }

    fn push(&mut self, phase: Phase) {
        let Cell { piece, from, .. } = self.cells[self.k];
        let phase = Phase { s: phase.s - self.begin + from, ..phase };
        if phase.duration > 0.0 {
            self.ready.push_back(Timed { piece, phase });
        }
    }
}
