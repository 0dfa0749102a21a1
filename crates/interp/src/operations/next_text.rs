//! From one text to the next one on a control that stays on: blocks that are typed, programs that
//! follow one another.
//!
//! ```text
//!   G91 G0 X10 ─► Ops ─► OpsRest ──for_next_text──► G1 X5 F200 ─► Ops ─► …
//!                            ▲
//!        where the axes stand by now, the tool, parameters and tool table as they were edited
//! ```
//!
//! Modes stay in force. What a planner must know of them before its first move is ordered anew:
//! path mode, spindle, coolant.
use crate::{
    coordinates::offsets,
    fault::unknown::Unknown,
    front_end::FrontEnd,
    geometry::frame::{machine_point, scale},
    interpreter::snapshot::{Snapshot, Standing},
    operations::pieces::OpsRest,
    resolve::Resolver,
    setup::Setup,
    state::executor::Executor,
};
use canon::{Op, OpKind};
use diag::Span;

impl OpsRest {
    /// What is in force when another text begins: its lines count from 1, the axes stand where the
    /// set-up says, this tool is in the spindle; parameters and tools are those of the set-up.
    #[must_use]
    pub fn for_next_text(mut self, setup: &Setup, tool: u32) -> Self {
        snapshot_begins(&mut self.rest.snapshot, setup, tool);
        self.rest.line = 1;
        resolver_begins(&mut self.resolver, setup, tool);
        self
    }

    /// Spindle and coolant were switched off without a word of a program: by an alarm, a reset, the
    /// end of the power.
    #[must_use]
    pub fn stopped(mut self) -> Self {
        let modes = &mut self.rest.snapshot.executor.modes;
        modes.spindle.turning = None;
        (modes.mist, modes.flood) = (false, false);
        self.resolver.spindle.sense = None;
        self.resolver.spindle.said = None;
        self.resolver.coolant = (false, false);
        self
    }

    /// What is in force, and where the program stands.
    pub fn standing(&self) -> Standing {
        Standing::of(&self.rest.snapshot.executor)
    }

    /// The number of the work offset in force, 1 for G54.
    pub fn work_offset(&self) -> u8 {
        self.rest.snapshot.executor.modes.system
    }

    /// The numbered parameters.
    pub const fn parameters(&self) -> &crate::Parameters {
        &self.rest.snapshot.executor.store.numbered
    }
}

fn snapshot_begins(snapshot: &mut Snapshot, setup: &Setup, tool: u32) {
    snapshot.front_end = FrontEnd::new(setup, 1 + setup.subprograms.len());
    snapshot.file = 0;
    snapshot.positions.clear();
    snapshot.place = Span::default();
    (snapshot.ended, snapshot.begun) = (false, false);
    (snapshot.percent, snapshot.spoke) = (false, false);
    snapshot.executed = 0;
    snapshot.forget_findings(setup);
    begin_anew(&mut snapshot.executor, setup, tool);
}

fn begin_anew(executor: &mut Executor, setup: &Setup, tool: u32) {
    executor.store.numbered = setup.parameters.clone();
    executor.tools.library = setup.tools.clone();
    executor.tools.missing = setup.missing_tools;
    executor.tools.follow_library();
    executor.remarks.clear();
    (executor.held, executor.recording) = (crate::call::out::Held::default(), None);
    let modes = &mut executor.modes;
    modes.unknown = Unknown::default();
    modes.current_tool = tool;
    modes.line = 0;
    offsets::load_offsets(modes, &mut executor.store, &executor.settings);
    let mut own = machine_point(&setup.start);
    scale(&mut own, 1.0 / modes.units.in_mm());
    modes.at = modes.frame.to_program(&own);
}

fn resolver_begins(resolver: &mut Resolver, setup: &Setup, tool: u32) {
    resolver.ops.clear();
    resolver.tools = setup.tools.clone();
    resolver.tool = tool;
    resolver.at = machine_point(&setup.start);
    resolver.with_motion.clear();
    resolver.forget_findings();
    resolver.path_said = None;
    let in_force = [
        resolver
            .spindle
            .said
            .filter(|_| resolver.spindle.sense.is_some())
            .map(|order| OpKind::Spindle { spindle: 0, order }),
        (resolver.coolant != (false, false))
            .then_some(OpKind::Coolant { mist: resolver.coolant.0, flood: resolver.coolant.1 }),
        (resolver.overrides != (true, true)).then_some(OpKind::Overrides {
            feed: resolver.overrides.0,
            spindle: resolver.overrides.1,
        }),
    ];
    let ops = in_force.into_iter().flatten();
    resolver.ops.extend(ops.map(|kind| Op { span: Span::default(), kind }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ops;
    use canon::Position;

    /// The operations of a typed text, and what it leaves.
    fn typed(text: &[u8], setup: &Setup, rest: Option<OpsRest>) -> (Vec<OpKind>, OpsRest) {
        let mut ops = Ops::of_piece(text, setup, rest, true);
        let kinds: Vec<_> = ops.by_ref().map(|op| op.kind).collect();
        assert_eq!(ops.diagnostics(), [], "{}", String::from_utf8_lossy(text));
        (kinds, ops.rest())
    }

    fn standing_at(x: f64) -> Setup {
        Setup { start: Position::xyz(x, 0.0, 0.0), ..Setup::default() }
    }

    fn goes_to(kinds: &[OpKind], x: f64) -> bool {
        let is_there = |to: &Position| (to.linear[0] - units::Length::mm(x)).abs().value() < 1e-9;
        kinds.iter().any(|kind| match kind {
            OpKind::Rapid { to } | OpKind::Line { to, .. } => is_there(to),
            _ => false,
        })
    }

    #[test]
    fn modes_stay_and_the_next_text_begins_where_the_axes_stand_by_then() {
        let (first, rest) = typed(b"G91 G0 X10", &standing_at(0.0), None);
        assert!(goes_to(&first, 10.0));
        // jogged to 25 meanwhile
        let setup = standing_at(25.0);
        let (second, rest) = typed(b"X10", &setup, Some(rest.for_next_text(&setup, 0)));
        assert!(goes_to(&second, 35.0), "{second:?}");
        assert!(rest.standing().codes.contains(&"G91".to_owned()));
    }

    #[test]
    fn incremental_words_in_inches_count_from_where_the_axes_stand() {
        let (_, rest) = typed(b"G20 G91", &standing_at(0.0), None);
        let setup = standing_at(25.4);
        let (moves, _) = typed(b"G0 X1", &setup, Some(rest.for_next_text(&setup, 0)));
        assert!(goes_to(&moves, 50.8), "{moves:?}");
    }

    #[test]
    fn a_work_offset_that_was_set_meanwhile_counts() {
        let (_, rest) = typed(b"G90 G0 X1", &standing_at(0.0), None);
        let mut setup = standing_at(1.0);
        assert!(setup.parameters.set(5221, -100.0));
        let (moves, _) = typed(b"G0 X1", &setup, Some(rest.for_next_text(&setup, 0)));
        assert!(goes_to(&moves, -99.0), "{moves:?}");
    }

    #[test]
    fn a_spindle_that_turns_is_ordered_anew_unless_it_was_switched_off() {
        let setup = standing_at(0.0);
        let (_, rest) = typed(b"S500 M3", &setup, None);
        let turns =
            |kinds: &[OpKind]| kinds.iter().any(|kind| matches!(kind, OpKind::Spindle { .. }));
        let (goes_on, _) = typed(b"G0 X1", &setup, Some(rest.clone().for_next_text(&setup, 0)));
        assert!(turns(&goes_on));
        let stopped = rest.stopped().for_next_text(&setup, 0);
        let (stands, _) = typed(b"G0 X1", &setup, Some(stopped));
        assert!(!turns(&stands), "{stands:?}");
    }

    #[test]
    fn a_program_that_has_ended_leaves_its_modes_for_what_is_typed() {
        let setup = standing_at(0.0);
        let mut ops = Ops::of_piece(b"G20\nG0 X1\nM2\n", &setup, None, false);
        for _ in ops.by_ref() {}
        let rest = ops.rest().for_next_text(&setup, 0);
        let (moves, _) = typed(b"G0 X2", &setup, Some(rest));
        assert!(goes_to(&moves, 50.8), "{moves:?}");
    }
}
