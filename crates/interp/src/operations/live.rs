//! An interpretation that goes on while the machine executes: where the program asks the machine
//! something, what is written behind it is interpreted when the answer is there.
//!
//! ```text
//!   text ──►│ block │ block │ M66 or G38 ┊ block │ block │ …
//!                                 │      ┊ ▲
//!        operations ◄─────────────┘      ┊ └── answer: #5399, or #5061 to #5070 and where the axes stand
//! ```
//!
//! It owns its text. What is in force can be handed on from one text to the next ([`OpsRest`]): so
//! blocks that are typed one after another are one program.
//!
//! Source: LinuxCNC 2.9 manual, "M66 Wait on Input", "G38.n Straight Probe": its interpreter stops
//! reading ahead there.
use crate::{
    auxiliary::outputs,
    geometry::frame::{machine_point, scale},
    interpreter::{Interpreter, Progress, contents::Contents, snapshot::Snapshot},
    motion::probe,
    operations::{
        ops::Ops,
        pieces::{OpsRest, Rest},
    },
    resolve::Resolver,
    setup::{Parameters, Setup},
};
use canon::{Answer, Op, OpKind, Position, ProgramFrame, Tool};
use diag::Diagnostic;
use std::collections::VecDeque;

/// Operations that are read ahead at a time.
const AHEAD: usize = 256;

/// See the module's header.
pub struct Live {
    text: Vec<u8>,
    setup: Setup,
    /// The text is a few blocks and needs no end.
    is_open: bool,
    from: Option<OpsRest>,
    state: Option<State>,
    ops: VecDeque<(Op, ProgramFrame)>,
    /// Operations that have been read and not been answered.
    asked: usize,
    ended: bool,
}

/// What is known between two readings.
struct State {
    snapshot: Snapshot,
    resolver: Resolver,
    contents: Contents,
}

impl Live {
    /// Of a program; with what was in force before, if that is to stay.
    pub fn new(text: impl Into<Vec<u8>>, setup: Setup, from: Option<OpsRest>) -> Self {
        Self {
            text: text.into(),
            setup,
            is_open: false,
            from,
            state: None,
            ops: VecDeque::new(),
            asked: 0,
            ended: false,
        }
    }

    /// Of a few blocks that are no whole program: they need no M2.
    pub fn of_blocks(text: impl Into<Vec<u8>>, setup: Setup, from: Option<OpsRest>) -> Self {
        Self { is_open: true, ..Self::new(text, setup, from) }
    }

    /// It goes on when the machine has answered so many operations, in their order.
    pub const fn asked(&self) -> usize {
        self.asked
    }

    /// The next operation, and how the program writes places and lengths there. `None`: the program
    /// is over, or an answer is missing ([`Live::asked`]).
    pub fn next_op(&mut self) -> Option<(Op, ProgramFrame)> {
        while self.ops.is_empty() && self.asked == 0 && !self.ended {
            self.read();
        }
        self.ops.pop_front()
    }

    /// Nothing more is read: the text has ended, and nothing waits for an answer.
    pub fn is_over(&self) -> bool {
        self.ended && self.ops.is_empty() && self.asked == 0
    }

    /// What the machine says to the first operation that has asked.
    pub fn answer(&mut self, answer: &Answer) {
        let Some(State { snapshot, resolver, .. }) = &mut self.state else { return };
        self.asked = self.asked.saturating_sub(1);
        match answer {
            Answer::Input(value) => outputs::was_read(&mut snapshot.executor.store, *value),
            Answer::Probe { contact, stands, changed } => {
                let executor = &mut snapshot.executor;
                let point = |at: &Position| {
                    let mut point = machine_point(at);
                    scale(&mut point, 1.0 / executor.modes.units.in_mm());
                    executor.modes.frame.to_program(&point)
                };
                let (contact, at) = (point(contact), point(stands));
                probe::came_to(&mut executor.store, &contact, *changed);
                executor.modes.at = at;
                resolver.at = machine_point(stands);
            }
        }
    }

    /// Take the next blocks, up to one that asks the machine something.
    fn read(&mut self) {
        let (mut interpreter, mut resolver) = match self.state.take() {
            Some(State { snapshot, resolver, contents }) => {
                let on = Interpreter::resume(&self.text, &self.setup, &snapshot);
                (on.with_contents(contents), resolver)
            }
            None => Ops::of_piece(&self.text, &self.setup, self.from.take(), self.is_open).parts(),
        };
        interpreter.program.more_follows = self.is_open;
        while !self.ended && self.asked == 0 && self.ops.len() < AHEAD {
            self.ended = interpreter.step(&mut resolver) == Progress::Ended;
            let modes = &interpreter.program.executor.modes;
            let frame = resolver.program_frame(modes.system, modes.diameter);
            while let Some(op) = resolver.pop() {
                self.asked += usize::from(asks(&op.kind));
                self.ops.push_back((op, frame));
            }
        }
        let snapshot = interpreter.snapshot(); // before its outlines are taken from it
        self.state = Some(State { snapshot, resolver, contents: interpreter.take_contents() });
    }

    /// What was found so far.
    pub fn findings(&self) -> Vec<Diagnostic> {
        let Some(State { snapshot, resolver, .. }) = &self.state else { return Vec::new() };
        snapshot.diagnostics().iter().chain(resolver.diagnostics()).cloned().collect()
    }

    /// What is in force now, for a text that comes after this one.
    pub fn rest(&self) -> Option<OpsRest> {
        let State { snapshot, resolver, .. } = self.state.as_ref()?;
        let snapshot = snapshot.clone().without_findings();
        Some(OpsRest { rest: Rest { snapshot, line: 1 }, resolver: resolver.clone() })
    }

    /// The numbered parameters as they are now.
    pub fn parameters(&self) -> Option<&Parameters> {
        Some(&self.state.as_ref()?.snapshot.executor.store.numbered)
    }

    /// The tools as they are now, each with what the control believes of it.
    pub fn tools(&self) -> Vec<(Tool, crate::ToolEntry)> {
        let Some(State { snapshot, .. }) = &self.state else { return Vec::new() };
        let tools = &snapshot.executor.tools;
        tools.library.iter().map(|tool| (tool.clone(), tools.entry(tool.number))).collect()
    }
}

/// Whether what is written behind an operation may depend on what the machine says to it.
pub const fn asks(kind: &OpKind) -> bool {
    matches!(kind, OpKind::Input(_) | OpKind::Probe(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(live: &mut Live) -> Vec<[f64; 3]> {
        let mut ends = Vec::new();
        while let Some((op, _)) = live.next_op() {
            if let OpKind::Rapid { to } | OpKind::Line { to, .. } = op.kind {
                ends.push(to.linear.map(units::Length::value));
            }
        }
        ends
    }

    fn errors(live: &Live) -> Vec<String> {
        let found = live.findings();
        found.iter().filter(|d| d.is_error()).map(|d| d.message.clone()).collect()
    }

    #[test]
    fn what_is_written_behind_an_input_goes_by_what_was_read() {
        let text = "G21 G90\nG0 X1\nM66 P3 L3 Q2\no1 if [#5399 LT 0]\nG0 X-5\no1 else\nG0 X5\no1 endif\nM2\n";
        for (value, end) in [(Some(1.0), 5.0), (None, -5.0)] {
            let mut live = Live::new(text, Setup::default(), None);
            assert_eq!(lines(&mut live), [[1.0, 0.0, 0.0]]);
            assert_eq!(live.asked(), 1);
            live.answer(&Answer::Input(value));
            assert_eq!(lines(&mut live), [[end, 0.0, 0.0]], "{value:?}");
            assert_eq!((live.asked(), errors(&live)), (0, Vec::new()));
        }
    }

    #[test]
    fn a_contact_is_told_in_the_programs_frame_and_units_and_the_axes_stand_where_they_stopped() {
        let text = "G20 G90 G10 L2 P1 Z-2\nG0 Z1\nG38.2 Z-1 F10\nG0 X[#5063]\nG91 G0 Z1\nM2\n";
        let mut live = Live::new(text, Setup::default(), None);
        lines(&mut live);
        let at = |z| Position::xyz(0.0, 0.0, z);
        // machine Z -63.5 mm is Z -0.5 inch of an offset of -2 inch
        live.answer(&Answer::Probe { contact: at(-63.5), stands: at(-63.6), changed: true });
        let ends = lines(&mut live);
        assert!((ends[0][0] + 0.5 * 25.4).abs() < 1e-9, "{ends:?}");
        assert!((ends[1][2] - (-63.6 + 25.4)).abs() < 1e-9, "{ends:?}");
        let parameters = live.parameters().unwrap();
        assert_eq!(parameters.get(5070), Some(1.0));
        assert_eq!(errors(&live), Vec::<String>::new());
    }

    #[test]
    fn blocks_one_after_another_keep_what_is_in_force() {
        let mut first = Live::of_blocks("G20 G91\nG0 X1\n#<_kept>=7\n", Setup::default(), None);
        assert_eq!(lines(&mut first), [[25.4, 0.0, 0.0]]);
        assert_eq!(errors(&first), Vec::<String>::new());
        let start = Position::xyz(50.8, 0.0, 0.0);
        let setup = Setup { start, ..Setup::default() };
        let rest = first.rest().map(|rest| rest.for_next_text(&setup, 0));
        let mut second = Live::of_blocks("G0 X#<_kept>", setup, rest);
        let [[x, ..]] = lines(&mut second)[..] else { panic!("one move") };
        assert!((x - (50.8 + 7.0 * 25.4)).abs() < 1e-9, "{x}");
        assert_eq!(errors(&second), Vec::<String>::new());
    }

    #[test]
    fn a_program_that_asks_nothing_means_what_it_means_read_at_once() {
        let text = "G21\no1 repeat [900]\nG91 G0 X1 Y0.5\no1 endrepeat\nG90 G41.1 D1 G1 X0 F100\nY9\nG40\nM2\n";
        let setup = Setup::default();
        let whole: Vec<Op> = crate::Ops::new(text.as_bytes(), &setup).collect();
        let mut live = Live::new(text, setup, None);
        let read: Vec<Op> = core::iter::from_fn(|| Some(live.next_op()?.0)).collect();
        assert_eq!(read, whole);
    }
}
