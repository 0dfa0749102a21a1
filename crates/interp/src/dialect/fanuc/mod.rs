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
//! the [`Executor`](crate::executor::Executor)'s. A variable without a value makes its word vanish.
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i for machining centres and lathes.
#![allow(clippy::unused_self)] // steps of the front end, called alike
#![allow(clippy::match_same_arms)] // a row of a table each
#![allow(clippy::large_types_passed_by_value)] // a macro's variables move into its call
#![allow(clippy::single_match_else)] // both outcomes are worth a line
mod arguments;
mod calls;
mod catalogue;
mod codes;
mod corner;
mod figure;
mod grooving;
mod growing;
pub(crate) mod kind;
mod lathe;
mod longer;
mod loops;
mod mapping;
mod moves;
mod offsets;
mod output;
mod reference;
pub(crate) mod rules;
mod sense;
mod steering;
mod stroke;
mod surface;
mod system;
mod tape;
mod threading;
mod tool_offsets;
mod turning;
mod values;
mod words;

use crate::{
    call::{Call, Corners, Sink},
    execute::{self, After},
    executor::Executor,
    fault::{Outcome, error, refuse},
    modes::Motion,
    out::Out,
    profile::record,
    program::Program,
    refused,
    setup::{Increments, Setup},
    target,
};
use calls::Level;
pub(crate) use calls::programs;
use diag::Span;
use gcode::Control;
use kind::Kind;
use lathe::drills;
pub(crate) use tape::Tape;
use values::Variables;
use words::Said;

/// The front end's own state.
#[derive(Clone, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // facts of their own about machine and block
pub(crate) struct Fanuc {
    kind: Kind,
    calculator: bool,
    skip_levels: u16,
    pub(crate) tape: Option<Tape>,
    variables: Variables,
    levels: Vec<Level>,
    /// G66: the macros called after each block that moves, the last first.
    modals: Vec<calls::Macro>,
    /// M99 of the main program: variables when the round at hand began, and how many there were.
    round_before: Variables,
    rounds: u32,
    /// The program that the block names by `<NAME>`.
    called: Option<u32>,
    kept: system::Kept,
    wear: tool_offsets::Wear,
    increments: Increments,
    c_is_a_chamfer: bool,
    /// G7.1, G12.1.
    surface: Option<surface::Surface>,
    /// G22.
    zone: stroke::Zone,
    /// The block at hand counts inches.
    inch: bool,
    /// G43, G44, G49.
    length_mode: f64,
    /// How much of the way that follows the corner before has taken.
    taken: f64,
    /// What the block at hand asks for besides its words.
    once: Once,
    /// Where G28 or G30 came by, in machine coordinates of program units: where G29 goes from.
    by: Option<crate::Point>,
    /// O of the program whose blocks are executed; none before the first.
    program: Option<u32>,
    /// G92 S, G50 S: no faster with G96.
    top_speed: Option<f64>,
    lathe_cycle: Option<u16>,
    /// Where the cycle's last pass led, and its taper.
    corner: Option<(crate::Point, f64)>,
    /// The motion that G80 goes back to.
    before_cycle: Motion,
    /// F of a thread.
    lead: Option<f64>,
    /// G34 is in force.
    growing: bool,
    /// Q of the thread of the block at hand.
    thread_angle: Option<f64>,
    warned_of_point: bool,
    said: Vec<Said>,
    /// G16, G51, G51.1, G68.
    mapping: figure::Mapping,
    /// G71 to G76: what their first lines have set.
    first_lines: turning::FirstLines,
    /// G70 to G73: the profile being taken down.
    shape: Option<turning::Shape>,
}

/// What one block asks for that the shared language does not have.
#[allow(clippy::struct_excessive_bools)] // orders that exclude nothing
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Once {
    /// G9.
    exact: bool,
    /// G29.
    back: bool,
    /// G27.
    check: bool,
    /// G31.
    skip: bool,
    /// G22, G23.
    stroke_check: bool,
    /// G45 to G48.
    longer: i8,
    /// W stands for Z.
    by_w: bool,
    /// G54.1: the work offset.
    system: Option<u8>,
    /// `,C` or `,R`.
    corner: Option<corner::Corner>,
    /// G10: the work offset that has other values now.
    changed: Option<usize>,
}

/// M98, M198.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Callee {
    /// None for the program at hand.
    program: Option<u32>,
    /// M198: one in a file of its own.
    in_file: bool,
    times: u32,
    /// Q: the block with which it begins.
    start: Option<u32>,
}

/// What follows a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Then {
    Next,
    /// The macro of G66: the block has named an axis.
    Moved,
    /// M98, M198.
    Call(Callee),
    /// M99, M99 P.
    Return(Option<u32>),
}

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
            kept: system::Kept::default(),
            wear: tool_offsets::Wear::new(),
            increments: setup.increments,
            c_is_a_chamfer: setup.c_is_a_chamfer,
            surface: None,
            zone: stroke::Zone::new(setup.stroke_check_outside),
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
            mapping: figure::Mapping::default(),
            first_lines: turning::FirstLines::default(),
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
        self.assign(it, out).inspect_err(|_| refused::doubt_parameters(&mut it.executor.modes))?;
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
            crate::offsets::change_system(&mut ex.modes, &mut ex.store, &ex.settings, system, out);
        }
        if let Some(system) = self.once.changed {
            crate::offsets::offset_changed(&mut ex.modes, &mut ex.store, &ex.settings, system, out);
        }
        if self.once.stroke_check {
            out.say(&Call::StrokeCheck(self.zone.in_force()));
        }
        let plain = !(self.once.check || self.once.skip);
        let cycle = self.lathe_cycle.filter(|_| moves && plain);
        if moves {
            threading::angle(ex, self.thread_angle.take(), out);
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
