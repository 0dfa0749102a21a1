//! A tool change: spindle at rest, Z to where tools are changed, then X and Y, then the changer.
//!
//! ```text
//!   z ▔▔▔▔▔╮───────────╮ change position       the program does not know that the axes have moved:
//!          │           │                       a rapid in X and Y stays up and goes there directly;
//!          ╵ programmed ▼ x, y                 anything else has X and Y back first, then Z
//! ```
use super::{Job, Planner};
use crate::StepKind;
use alloc::format;
use canon::{Axis, Position};
use diag::Diagnostic;
use motion::Path;
use units::{Coordinate, Length, Spin};

/// Where axes really are that a tool change has taken away; `None`: where the program has them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Away {
    across: [Option<Length>; 2],
    z: Option<Length>,
}

impl Away {
    /// The place where the axes really are.
    pub(super) fn instead_of(&self, programmed: Position) -> Position {
        let mut place = programmed;
        for (axis, at) in [Axis::X, Axis::Y].into_iter().zip(self.across) {
            place = at.map_or(place, |at| place.with(axis, Coordinate::linear(at)));
        }
        self.z.map_or(place, |z| place.with(Axis::Z, Coordinate::linear(z)))
    }

    /// An axis goes to this place, and the program does not know it.
    pub(super) fn send(&mut self, axis: Axis, to: Length) {
        match axis {
            Axis::X => self.across[0] = Some(to),
            Axis::Y => self.across[1] = Some(to),
            _ => self.z = Some(to),
        }
    }

    const fn is_across(&self) -> bool {
        self.across[0].is_some() || self.across[1].is_some()
    }

    fn is_away(&self) -> bool {
        *self != Self::default()
    }
}

impl Planner {
    pub(super) fn change_tool(&mut self, job: &mut Job, number: u32) {
        self.selected = None;
        if self.change_by_sequence(job, number) {
            return;
        }
        if number != 0 && self.tools.get(number).is_none() {
            let text = format!("T{number} is not in the tool table");
            let finding = Diagnostic::error("M0309", job.span, text);
            self.findings.add(
                finding.with_help("add it to the table, or let missing tools be stood in for"),
            );
        }
        let by_hand = !self.pocket_is_reached(job, number);
        for state in &mut self.spindles {
            state.order(Spin::ZERO);
        }
        if number == self.tool {
            return; // it is there already
        }
        self.tell_spindles(job);
        self.go_to_change_position(job);
        self.outbox.release([], &self.limits, job.emit);
        self.await_spindles(job);
        self.hand_on(job, StepKind::ChangeTool { tool: number, by_hand });
        self.judge_thread();
        self.tool = number;
        self.tool_mounted();
    }

    /// Z to where tools are changed, then X and Y.
    pub(super) fn go_to_change_position(&mut self, job: &mut Job) {
        let change = self.limits.tool_change;
        if change.z.is_some() {
            self.go_away(job, Away { z: change.z, ..self.away });
        }
        if change.x.is_some() || change.y.is_some() {
            self.go_away(job, Away { across: [change.x, change.y], ..self.away });
        }
    }

    /// Whether the changer has the tool: one that stands in a pocket that the magazine does not
    /// have is changed by hand.
    fn pocket_is_reached(&mut self, job: &Job, number: u32) -> bool {
        let most = self.limits.tool_change.pockets;
        let pocket = self.tools.get(number).filter(|tool| !tool.stand_in);
        let pocket = pocket.filter(|_| number != 0).map_or(0, |tool| tool.pocket);
        if most > 0 && pocket > most {
            let text = format!(
                "T{number} is in pocket {pocket} by the tool table, and the magazine has pockets 1 to {most}: it is changed by hand"
            );
            let help =
                format!("give it a pocket from 1 to {most} in the tool table, or 0, which is none");
            self.findings.add(Diagnostic::warning("M0317", job.span, text).with_help(help));
            return false;
        }
        true
    }

    /// In a straight line to where tools are changed, or back.
    pub(super) fn go_away(&mut self, job: &mut Job, away: Away) {
        let from = self.position();
        self.away = away;
        let path = Path::Line { from, to: self.position() };
        if !self.is_refused(job, &[path]) {
            self.sweep(job, &path, super::contact::Sweep::Rapid);
            self.rapid_along(job, path);
        }
    }

    /// A rapid of the program comes: in X and Y alone it stays up; any other begins where the
    /// program has it.
    pub(super) fn leave_change_position(&mut self, job: &mut Job, to: &Position) {
        let level = to.linear[2] == self.programmed.linear[2];
        if self.away.is_across() && !level {
            self.go_away(job, Away { across: [None; 2], ..self.away });
        }
    }

    /// The rapid has been told: what is left of the change position is Z, if the rapid was in X and
    /// Y alone.
    pub(super) fn arrive(&mut self, to: &Position) {
        let level = to.linear[2] == self.programmed.linear[2];
        self.away = Away { across: [None; 2], z: self.away.z.filter(|_| level) };
        self.programmed = *to;
    }

    /// A cut comes: X and Y go back, then Z.
    pub(super) fn come_down(&mut self, job: &mut Job) {
        if self.away.is_across() {
            self.go_away(job, Away { across: [None; 2], ..self.away });
        }
        if self.away.is_away() {
            self.go_away(job, Away::default());
        }
    }
}
