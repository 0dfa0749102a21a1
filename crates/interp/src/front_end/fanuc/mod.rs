//! Fanuc's dialect: a front end that ends in the words, motions and cycles that all dialects share.
//!
//! ```text
//!   block ──► skip /n ──► O, %, GOTO, IF, WHILE, G65 … ──► variables ──► words ──► Executor
//!                          (tape, calls)                   (values)      (words)
//!
//!   X10       10 of the least input increment, 0.001 mm; X10. is 10 mm       G4 P500    half a second
//!   G84 K3    three repetitions: L of the shared cycles                      G99, G98   lathe A: feed modes
//! ```
//!
//! The front end decides which block comes next, what its variables are worth, and what its words mean
//! in the shared language (millimetres or inches, seconds, the shared codes); everything that moves is
//! the [`Executor`](crate::state::executor::Executor)'s. A variable without a value makes its word vanish.
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i for machining centres and lathes.
#![allow(clippy::unused_self)] // steps of the front end, called alike
#![allow(clippy::match_same_arms)] // a row of a table each
#![allow(clippy::large_types_passed_by_value)] // a macro's variables move into its call
#![allow(clippy::single_match_else)] // both outcomes are worth a line
pub(crate) mod calls;
pub(crate) mod corner;
pub(crate) mod cycles;
pub(crate) mod mapping;
pub(crate) mod moves;
pub(crate) mod offsets;
pub(crate) mod reference;
pub(crate) mod state;
pub(crate) mod stroke;
pub(crate) mod tape;
pub(crate) mod variables;
pub(crate) mod words;

pub(crate) use calls::{programs, programs_by_word};
pub(crate) use state::Fanuc;
pub(crate) use tape::Tape;

use crate::{
    call::{Call, Corners, Sink, out::Out},
    coordinates::target,
    cycles::record,
    dialect::fanuc::kind::Kind,
    execute::{self, After, refused},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        cycles::lathe::drills,
        state::{Once, Then, Variables},
    },
    modes::Motion,
    program::Program,
    setup::Setup,
    state::executor::Executor,
};
use diag::Span;
use gcode::Control;

impl Fanuc {
    /// At the beginning of a program.
    pub(crate) fn new(kind: Kind, setup: &Setup) -> Self {
        Self {
            kind,
            calculator: setup.whole_units_without_point,
            skip_levels: setup.block_delete_levels | u16::from(setup.block_delete) << 1,
            tape: None,
            round_before: Variables::kept(&setup.parameters),
            variables: Variables::kept(&setup.parameters),
            levels: Vec::new(),
            modals: Vec::new(),
            rounds: 0,
            called: None,
            kept: state::Kept::default(),
            wear: state::Wear::new(),
            increments: setup.increments,
            c_is_a_chamfer: setup.c_is_a_chamfer,
            surface: None,
            zone: state::Zone::new(setup.stroke_check_outside),
            inch: false,
            length_mode: 49.0,
            taken: 0.0,
            once: Once::default(),
            by: None,
            program: None,
            top_speed: None,
            lathe_cycle: None,
            corner: None,
            before_cycle: Motion::Rapid,
            lead: None,
            growing: false,
            thread_angle: None,
            warned_of_point: false,
            said: Vec::new(),
            mapping: mapping::figure::Mapping::default(),
            first_lines: state::FirstLines::default(),
            shape: None,
        }
    }

    /// The same, which reads its tape again when it needs it.
    pub(crate) fn without_tape(&mut self) -> Self {
        let tape = self.tape.take();
        let mut copy = self.clone();
        copy.said.clear(); // the last block's
        copy.inch = false;
        self.tape = tape;
        copy
    }

    /// Whether a profile is being taken down, up to a numbered block that was looked for.
    pub(crate) const fn takes_down_profile(&self) -> bool {
        self.shape.is_some()
    }

    const fn is_lathe(&self) -> bool {
        self.kind.is_lathe()
    }

    /// Execute the block that the interpreter has read.
    pub(crate) fn block<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        let result = self.execute(it, out);
        if core::mem::take(&mut self.once.back_to_increments) {
            it.executor.modes.incremental = true;
        }
        if self.shape.is_none() {
            return result;
        }
        if let Err(fault) = result {
            it.report(*fault); // the profile is not whole, and will not be cut
        }
        self.end_of_shape(it, out)
    }

    fn execute<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        if it.block.delete.is_some_and(|level| self.skip_levels >> level & 1 == 1) {
            return Ok(());
        }
        it.executor.modes.line = it.block.span.line;
        it.ahead = 0;
        if let Some(word) = it.block.o {
            return self.program_begins(it, word.label, word.span);
        }
        if it.block.percent {
            return self.percent(it, out);
        }
        if let Some(number) = it.block.number {
            self.kept.word(b'N', number);
        }
        if let Some(control) = it.block.control {
            let Control::IfThen(condition) = control else { return self.control(it, control) };
            if self.condition(it, condition)? == 0.0 {
                return Ok(());
            }
        }
        self.assign(it, out).inspect_err(|_| refused::forget_parameters(&mut it.executor.modes))?;
        it.executor.words.begin(&it.block);
        out.place = it.executor.words.place;
        if let Some(comment) = it.block.comments.last().filter(|_| it.block.assignments.is_empty())
        {
            let text = it.block.text(comment.text).trim_start();
            out.say(&Call::Comment(text));
        }
        if it.block.output.is_some() {
            return self.output(it, out);
        }
        self.called = match it.block.called {
            Some(name) => Some(self.named(it, name)?),
            None => None,
        };
        if it.block.words.is_empty() && self.called.is_none() {
            return Ok(());
        }
        self.words(it, out)
    }

    /// `%`: the end of the tape, which a subprogram's file may not reach.
    fn percent<S: Sink>(&self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        if it.file == 0 {
            it.percent_sign(out);
            return Ok(());
        }
        it.ended = true;
        let fault = error("I0301", it.block.span, "this subprogram does not end: its tape is over");
        Err(fault.with_help("end it with M99").into())
    }

    /// A block with words.
    fn words<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        self.read(it)?;
        if let Some((word, call)) = self.calling_word(it) {
            return self.call_by_word(it, word, call, out);
        }
        self.words_read(it, out)
    }

    /// Those that have been read.
    fn words_read<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        if self.only_moves(&it.executor) {
            let moves = self.move_only(&mut it.executor, out)?;
            return if moves { self.modal_call(it) } else { Ok(()) };
        }
        if let Some(then) = self.only_calls(&it.executor) {
            self.once = Once::default();
            self.group_one(&mut it.executor.modes.motion);
            return self.follow(it, then, out);
        }
        if let Some(code) = self.macro_code() {
            return self.macro_call(it, code);
        }
        if let Some(clockwise) = self.circle_code() {
            return self.circle(it, clockwise, out);
        }
        self.check_surface(&it.executor)?;
        if let Some(code) = self.multiple_cycle() {
            return self.multiple(it, code, out);
        }
        let (then, after) = match self.surface {
            None => self.obey(it, out)?,
            Some(surface) => self.on_surface(it, surface, out)?,
        };
        if after == After::End {
            it.ended = true;
            return Ok(());
        }
        self.follow(it, then, out)
    }

    fn follow<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        then: Then,
        out: &mut Out<'_, S>,
    ) -> Outcome {
        match then {
            Then::Call(callee) => self.call_program(it, callee),
            Then::Return(to) => self.return_to(it, to, out),
            Then::Moved => self.modal_call(it),
            Then::Next => Ok(()),
        }
    }

    /// Do what the words say.
    fn obey<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        out: &mut Out<'_, S>,
    ) -> Outcome<(Then, After)> {
        self.once = Once::default();
        let then = self.translate(&mut it.executor)?;
        if self.called.is_some() && !matches!(then, Then::Call(_)) {
            let text = "a program's name goes with M98, G65 or G66: M98<NAME>";
            return refuse("I1049", it.block.span, text);
        }
        let moves = it.executor.words.any(crate::codes::AXES);
        if self.once.corner.is_none() && moves {
            self.taken = 0.0;
        }
        let after = match self.once.corner {
            Some(corner) => self.cornered(it, corner, out)?,
            None if it.executor.recording.is_some() => {
                record::record(&mut it.executor, out)?;
                if let (Some(arc), Some(recording)) =
                    (self.once.straight, it.executor.recording.as_mut())
                {
                    recording.go_on_with(arc);
                }
                return Ok((Then::Next, After::Next));
            }
            None => self.move_block(&mut it.executor, moves, out)?,
        };
        Ok((if moves && then == Then::Next { Then::Moved } else { then }, after))
    }

    /// What the block's words do.
    fn move_block<S: Sink>(
        &mut self,
        ex: &mut Executor,
        moves: bool,
        out: &mut Out<'_, S>,
    ) -> Outcome<After> {
        if let Some(system) = self.once.system {
            crate::coordinates::offsets::change_system(
                &mut ex.modes,
                &mut ex.store,
                &ex.settings,
                system,
                out,
            );
        }
        if let Some(system) = self.once.changed {
            crate::coordinates::offsets::offset_changed(
                &mut ex.modes,
                &mut ex.store,
                &ex.settings,
                system,
                out,
            );
        }
        if self.once.stroke_check {
            out.say(&Call::StrokeCheck(self.zone.in_force()));
        }
        let plain = !(self.once.check || self.once.skip);
        let cycle = self.lathe_cycle.filter(|_| moves && plain);
        if moves {
            cycles::threading::angle(self.thread_angle.take(), out);
        }
        if let Some(code) = ex.words.g(crate::codes::GGroup::ToolLength) {
            self.length_mode = f64::from(code % crate::codes::OWN) / 10.0;
        }
        let (motion, corners) = (ex.modes.motion, ex.modes.corners);
        let exact = self.once.exact && moves && corners != Corners::ExactStop;
        if exact {
            out.say(&Call::PathControl { corners: Corners::ExactStop, merge: None });
        }
        let checked = self.once.check.then(|| reference::named(ex));
        let reference = matches!(ex.words.g(crate::codes::GGroup::NonModal), Some(280 | 300));
        let by = reference.then(|| target::destination(&ex.words, &ex.modes, false)).transpose()?;
        let by = by.map(|by| ex.modes.frame.to_machine(&by));
        let after = match cycle {
            _ if self.once.back => self.back_from_reference(ex, out)?,
            Some(code) => self.lathe_move(ex, code, out)?,
            None if self.is_lathe() && drills(ex) => self.drill(ex, out)?,
            None => execute::execute(ex, out)?,
        };
        self.by = by.or(self.by);
        if exact {
            out.say(&Call::PathControl { corners, merge: Some(ex.modes.merge) });
        }
        if self.once.skip {
            let at = ex.modes.at;
            ex.store.numbered.set_point(5061, &at);
        }
        if !plain {
            ex.modes.motion = motion;
        }
        if let Some(arc) = self.once.straight {
            ex.modes.motion = arc;
        }
        if let Some(checked) = checked {
            self.at_reference(ex, checked)?;
        }
        self.group_one(&mut ex.modes.motion);
        Ok(after)
    }

    /// G80 ends a cycle, and the motion that was in force before it is in force again.
    fn group_one(&mut self, motion: &mut Motion) {
        match *motion {
            Motion::None if self.lathe_cycle.is_none() => *motion = self.before_cycle,
            Motion::None | Motion::Cycle(_) => {}
            other => self.before_cycle = other,
        }
    }

    /// O1234: the first one names the program; another one means that it was never ended.
    fn program_begins(&mut self, it: &mut Program<'_>, label: gcode::Label, span: Span) -> Outcome {
        let number = match label {
            gcode::Label::Number(number) => number,
            gcode::Label::Name(_) => u32::MAX, // only what is called is found by its name
            gcode::Label::Computed(_) => {
                return refuse("I1001", span, "O takes the number of a program, as in O1234");
            }
        };
        let Some(before) = self.program.replace(number) else { return Ok(()) };
        it.ended = true;
        let written = |number: u32| match number {
            number if number >= tape::NAMED => "this program".to_owned(),
            number => format!("O{number}"),
        };
        let text = format!("{} does not end: another program begins here", written(before));
        let help = "end a main program with M30, a subprogram or macro with M99";
        Err(error("I0301", span, text).with_help(help).into())
    }
}
