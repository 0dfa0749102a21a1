//! A tool change by the machine's own sequence: its steps become steps of the kernel.
//!
//! ```text
//!   fresh     rest state ─► [ mark 1 ] step 1 ─► [ mark 2 ] step 2 ─► … ─► [ over ]
//!   go on     outputs as before step k ─► [ mark k ] step k ─► … ─► [ over ]
//!   undo      outputs as before step k ─► [ mark k ] undo k ─► [ mark j ] undo j ─► … ─► [ over ]
//! ```
//!
//! A mark is a consultation ([`StepKind::Consult`]): the kernel goes on once what runs it has
//! recorded the mark. So the record never lags behind the machine: the step that it names is the
//! one that was begun last, and a handover is in it only when its inputs have proved it.
//!
//! After a stop, outputs that the step itself does not switch are made what they were, in the order
//! of the steps that switched them last, each with the inputs that prove it, before anything moves.
use super::changer::{Changer, Changing, SequenceMark};
use super::tool_change::Away;
use super::{Job, Planner};
use crate::StepKind;
use alloc::sync::Arc;
use alloc::{format, vec::Vec};
use canon::{
    Axis, Carousel, Handover, Magazine, Pocket, Resume, Sequence, SequenceStage, SequenceStep,
    ToolChange,
};
use diag::Diagnostic;
use motion::{EdgeCount, InputsWait, Move, Output, Path, SEQUENCE_MARKS, Signal, SpindleStep};
use units::{Orientation, Spin, Time};

/// Time for which an input must keep its state to count.
const STEADY: Time = Time::s(0.01);
/// Longest time until what was proved before is seen again, before something moves.
const PROVED: Time = Time::s(1.0);
/// The same of an input that is counted: pockets pass quickly.
const STEADY_EDGE: Time = Time::s(0.005);

impl Planner {
    /// One whose tools are changed by a sequence.
    #[must_use]
    pub fn with_changer(mut self, changer: Option<Changer>) -> Self {
        if let Some(changer) = changer {
            self.tool = changer.magazine.spindle;
            let (marks, next) = (Vec::new(), SEQUENCE_MARKS);
            self.changing = Some(Changing { changer, marks, next, tool_said: false });
        }
        self
    }

    /// Marks of the steps that were handed out since the last time.
    pub fn take_marks(&mut self) -> Vec<SequenceMark> {
        self.changing
            .as_mut()
            .map_or_else(Vec::new, |changing| core::mem::take(&mut changing.marks))
    }

    /// What the record says of the tool in the spindle, the kernel hears before the first step.
    pub(super) fn say_tool(&mut self, job: &mut Job) {
        let Some(changing) = self.changing.as_mut().filter(|changing| !changing.tool_said) else {
            return;
        };
        changing.tool_said = true;
        let tool = changing.changer.magazine.spindle;
        self.hand_on(job, StepKind::ChangeTool { tool, by_hand: false });
    }

    /// Whether a sequence has changed the tool, or was refused; false: the machine has none.
    pub(super) fn change_by_sequence(&mut self, job: &mut Job, number: u32) -> bool {
        let Some(changing) = &mut self.changing else { return false };
        let sequence = Arc::clone(&changing.changer.sequence);
        let resume = changing.changer.resume.take();
        let magazine = &changing.changer.magazine;
        if resume.is_none() && number == magazine.spindle {
            return true;
        }
        let change = resume.map_or_else(|| magazine.change_to(number), |r| Some(r.stage.change));
        let Some(change) = change else {
            self.refuse_pocket(job, number);
            return true;
        };
        for state in &mut self.spindles {
            state.order(Spin::ZERO);
        }
        self.tell_spindles(job);
        if resume.is_none() {
            self.go_to_change_position(job);
        }
        self.outbox.release([], &self.limits, job.emit);
        self.await_spindles(job);
        let run = SequenceRun { sequence: &sequence, change };
        match resume {
            None => {
                self.reach_rest(job, &sequence);
                self.run_steps(&run, job, 0, false);
            }
            Some(Resume { stage, back, one_step }) => {
                let tool = self.magazine().spindle;
                self.hand_on(job, StepKind::ChangeTool { tool, by_hand: false });
                self.restore(&run, job, stage.step);
                if back {
                    self.undo_steps(&run, job, stage.step, one_step);
                } else {
                    self.run_steps(&run, job, stage.step, one_step);
                }
            }
        }
        self.judge_thread();
        self.tool = self.magazine().spindle;
        self.tool_mounted();
        true
    }

    fn refuse_pocket(&mut self, job: &Job, number: u32) {
        let magazine = self.magazine();
        let pockets = magazine.pockets.len();
        let (text, help) = if number == 0 || magazine.pocket_of(number).is_some() {
            let text = format!(
                "no pocket of the {pockets} is empty: T{} cannot leave the spindle",
                magazine.spindle
            );
            (text, "take a tool out of the magazine")
        } else {
            let text = format!("T{number} is in no pocket of the magazine, which has {pockets}");
            (
                text,
                "put it in one, and say so: `pocket` in the tool table, or `pocket P T` of a control",
            )
        };
        self.findings.add(Diagnostic::error("M0375", job.span, text).with_help(help));
    }

    /// The magazine as it is planned to be.
    fn magazine(&mut self) -> &mut Magazine {
        // a sequence runs only where there is one
        &mut self.changing.get_or_insert_with(Changing::none).changer.magazine
    }

    fn mark(&mut self, job: &mut Job, stage: Option<SequenceStage>, unknown: bool) {
        let changing = self.changing.get_or_insert_with(Changing::none);
        let mut magazine = changing.changer.magazine.clone();
        if unknown {
            magazine.at = None;
        }
        let number = changing.next;
        changing.next = number.checked_add(1).unwrap_or(SEQUENCE_MARKS);
        if !self.only_judges {
            changing.marks.push(SequenceMark { number, stage, magazine });
        }
        self.hand_on(job, StepKind::Consult(number));
    }

    /// The rest state, before the first step.
    fn reach_rest(&mut self, job: &mut Job, sequence: &Sequence) {
        self.set(job, &sequence.rest_outputs);
        self.await_inputs(job, &sequence.rest_inputs, sequence.rest_longest, Time::ZERO);
    }

    /// Outputs as before a step, but for its own, each group with the inputs that prove it.
    fn restore(&mut self, run: &SequenceRun, job: &mut Job, step: usize) {
        let SequenceRun { sequence, change } = run;
        let own = sequence.steps.get(step);
        let is_own = |number: u8, inputs: bool| {
            own.is_some_and(|own| {
                let signals = if inputs { &own.inputs } else { &own.outputs };
                signals.iter().any(|(known, _)| *known == number)
            })
        };
        let (_, inputs) = sequence.before(step, change);
        let done: Vec<usize> = sequence.steps_of(change).take_while(|i| *i < step).collect();
        let is_last = |position: usize, number: u8, inputs: bool| {
            !done[position..].iter().any(|index| {
                let step = &sequence.steps[*index];
                let signals = if inputs { &step.inputs } else { &step.outputs };
                signals.iter().any(|(known, _)| *known == number)
            })
        };
        let rest = (sequence.rest_outputs.iter(), sequence.rest_inputs.iter());
        let rest_set: Vec<_> =
            rest.0.filter(|(n, _)| is_last(0, *n, false) && !is_own(*n, false)).copied().collect();
        let rest_wait: Vec<_> =
            rest.1.filter(|(n, _)| is_last(0, *n, true) && !is_own(*n, true)).copied().collect();
        self.set(job, &rest_set);
        self.await_inputs(job, &rest_wait, sequence.rest_longest, Time::ZERO);
        for (position, index) in done.iter().enumerate() {
            let step = &sequence.steps[*index];
            let set = step
                .outputs
                .iter()
                .filter(|(n, _)| is_last(position + 1, *n, false) && !is_own(*n, false));
            let set: Vec<_> = set.copied().collect();
            self.set(job, &set);
            // what no output of this step moves is looked at where the step that it is of waits
            let wait = step.inputs.iter().filter(|(n, on)| {
                !set.is_empty()
                    && is_last(position + 1, *n, true)
                    && !is_own(*n, true)
                    && known(&inputs, *n).1 == *on
            });
            let wait: Vec<_> = wait.copied().collect();
            self.await_inputs(job, &wait, step.longest, Time::ZERO);
        }
    }

    /// From a step on to the end, or this step alone.
    fn run_steps(&mut self, run: &SequenceRun, job: &mut Job, from: usize, one_step: bool) {
        let SequenceRun { sequence, change } = run;
        let steps: Vec<usize> = sequence.steps_of(change).filter(|index| *index >= from).collect();
        for (position, index) in steps.iter().enumerate() {
            let stage = SequenceStage { step: *index, back: false, change: *change };
            let step = &sequence.steps[*index];
            self.mark(job, Some(stage), step.index.is_some());
            if one_step && position > 0 {
                return;
            }
            self.do_step(run, job, step);
        }
        self.mark(job, None, false);
    }

    fn do_step(&mut self, run: &SequenceRun, job: &mut Job, step: &SequenceStep) {
        if step.operator.is_some() {
            self.hand_on(job, StepKind::Pause { optional: false });
        }
        if let Some((angle, longest)) = step.orient {
            let order =
                SpindleStep::Orient { to: Orientation::shortest(angle), longest: Some(longest) };
            self.hand_on(job, StepKind::Spindle { spindle: 0, order });
        }
        let is_guarded = self.guard(run, job, step);
        self.move_to(job, &step.to, step.speed);
        if let Some(pocket) = step.index {
            self.turn_carousel(run, job, run.pocket(pocket));
        }
        self.end_guard(job, is_guarded);
        self.set(job, &step.outputs);
        if step.dwell > Time::ZERO {
            self.hand_on(job, StepKind::Dwell(step.dwell));
        }
        self.await_inputs(job, &step.inputs, step.longest, step.usual);
        if let Some(handover) = step.handover {
            self.hand_over(run, job, handover, false);
        }
    }

    /// From a step back to the rest state, or this step alone. What only a person undoes is left.
    fn undo_steps(&mut self, run: &SequenceRun, job: &mut Job, from: usize, one_step: bool) {
        let SequenceRun { sequence, change } = run;
        let mut steps: Vec<usize> =
            sequence.steps_of(change).filter(|index| *index <= from).collect();
        steps.reverse();
        for (position, index) in steps.iter().enumerate() {
            let stage = SequenceStage { step: *index, back: true, change: *change };
            let step = &sequence.steps[*index];
            self.mark(job, Some(stage), step.index.is_some());
            if step.undone_by_hand || one_step && position > 0 {
                return;
            }
            self.undo_step(run, job, *index, step);
        }
        self.mark(job, None, false);
    }

    fn undo_step(&mut self, run: &SequenceRun, job: &mut Job, index: usize, step: &SequenceStep) {
        let SequenceRun { sequence, change } = run;
        let (outputs, inputs) = sequence.before(index, change);
        let prior = |signals: &[(u8, bool)], known: &[(u8, bool)]| {
            let own = signals
                .iter()
                .filter_map(|(number, _)| known.iter().find(|(other, _)| other == number).copied());
            own.collect::<Vec<_>>()
        };
        let wait = prior(&step.inputs, &inputs);
        self.set(job, &prior(&step.outputs, &outputs));
        if !step.outputs.is_empty() {
            self.await_inputs(job, &wait, step.longest, step.usual);
        }
        let is_guarded = self.guard(run, job, step);
        let earlier: Vec<usize> = sequence.steps_of(change).take_while(|i| *i < index).collect();
        if step.index.is_some() {
            let before = earlier.iter().rev().find_map(|i| sequence.steps[*i].index);
            if let Some(pocket) = before {
                self.turn_carousel(run, job, run.pocket(pocket));
            }
        }
        let mut back = Vec::new();
        for (axis, _) in &step.to {
            let places = earlier.iter().rev().flat_map(|i| &sequence.steps[*i].to);
            back.extend(places.clone().find(|(other, _)| other == axis).copied());
        }
        self.move_to(job, &back, step.speed);
        self.end_guard(job, is_guarded);
        if step.outputs.is_empty() {
            self.await_inputs(job, &wait, step.longest, step.usual);
        }
        if let Some(handover) = step.handover {
            self.hand_over(run, job, handover, true);
        }
    }

    /// Where something moves, all that the steps before have proved must be so, and stay so;
    /// whether anything is guarded.
    fn guard(&mut self, run: &SequenceRun, job: &mut Job, step: &SequenceStep) -> bool {
        if step.to.is_empty() && step.index.is_none() {
            return false;
        }
        let SequenceRun { sequence, change } = run;
        let index = sequence.steps.iter().position(|other| other.name == step.name).unwrap_or(0);
        let (_, mut inputs) = sequence.before(index, change);
        inputs.retain(|(number, _)| !step.inputs.iter().any(|(own, _)| own == number));
        self.await_inputs(job, &inputs, PROVED, Time::ZERO);
        let (on, off) = (bits(&inputs, true), bits(&inputs, false));
        self.hand_on(job, StepKind::Guard { on, off });
        true
    }

    fn end_guard(&mut self, job: &mut Job, is_guarded: bool) {
        if is_guarded {
            self.hand_on(job, StepKind::Guard { on: 0, off: 0 });
        }
    }

    fn hand_over(&mut self, run: &SequenceRun, job: &mut Job, handover: Handover, back: bool) {
        let magazine = self.magazine();
        magazine.hand_over(handover, &run.change, back);
        let tool = magazine.spindle;
        self.hand_on(job, StepKind::ChangeTool { tool, by_hand: false });
    }

    fn set(&mut self, job: &mut Job, outputs: &[(u8, bool)]) {
        for (number, on) in outputs {
            let output = Output { number: *number, signal: Signal::Digital { on: *on } };
            self.hand_on(job, StepKind::Output(output));
        }
    }

    fn await_inputs(&mut self, job: &mut Job, inputs: &[(u8, bool)], longest: Time, usual: Time) {
        if inputs.is_empty() {
            return;
        }
        let (on, off) = (bits(inputs, true), bits(inputs, false));
        self.hand_on(job, StepKind::Inputs(InputsWait { on, off, steady: STEADY, longest, usual }));
    }

    /// By the shorter way to a pocket; from the reference, where the position is not known.
    fn turn_carousel(&mut self, run: &SequenceRun, job: &mut Job, pocket: u32) {
        let Some(carousel) = run.sequence.carousel else { return };
        if pocket == 0 {
            return;
        }
        let from = match (self.magazine().at, carousel.reference) {
            (Some(at), _) => at,
            (None, Some(reference)) => {
                let (pockets, usual) = (f64::from(carousel.pockets), carousel.usual);
                let count = EdgeCount {
                    output: carousel.forward,
                    input: reference,
                    edges: 1,
                    steady: STEADY_EDGE,
                    longest: carousel.longest * (pockets + 1.0),
                    usual: usual * (pockets / 2.0),
                };
                self.hand_on(job, StepKind::Count(count));
                1
            }
            (None, None) => {
                let text = "which pocket is at the spindle is not known, and the carousel has no reference";
                let help = "look, and say it: `sequence pocket N` of a control";
                let found = Diagnostic::error("M0376", job.span, text).with_help(help);
                return self.findings.add(found);
            }
        };
        if let Some(count) = edges(&carousel, from, pocket) {
            self.hand_on(job, StepKind::Count(count));
        }
        self.magazine().at = Some(pocket);
    }

    /// Axes in a straight line to machine coordinates.
    fn move_to(
        &mut self,
        job: &mut Job,
        to: &[(Axis, units::Length)],
        speed: Option<units::Speed>,
    ) {
        if to.is_empty() {
            return;
        }
        let mut away = self.away;
        for (axis, place) in to {
            away.send(*axis, *place);
        }
        match speed {
            None => self.go_away(job, away),
            Some(speed) => self.go_away_at(job, away, speed),
        }
    }

    fn go_away_at(&mut self, job: &mut Job, away: Away, speed: units::Speed) {
        let from = self.position();
        self.away = away;
        let path = Path::Line { from, to: self.position() };
        if self.is_refused(job, &[path]) {
            return;
        }
        let Some(bound) = self.bound(job, &path, true, f64::INFINITY) else { return };
        let profile = bound.profile(path.length(), bound.speed.min(speed.value()));
        if self.profile_is_refused(job, &profile, 1.0) {
            return;
        }
        let slow = Move {
            path,
            profile,
            rapid: true,
            per_revolution: false,
            exact_stop: true,
            floats: false,
            programmed: None,
        };
        self.hand_on(job, StepKind::Move(slow.into()));
    }
}

impl Changing {
    fn none() -> Self {
        let sequence = Arc::new(Sequence {
            name: alloc::string::String::new(),
            rest_outputs: Vec::new(),
            rest_inputs: Vec::new(),
            rest_longest: Time::ZERO,
            steps: Vec::new(),
            carousel: None,
        });
        let changer = Changer { sequence, magazine: Magazine::default(), resume: None };
        Self { changer, marks: Vec::new(), next: SEQUENCE_MARKS, tool_said: true }
    }
}

/// A sequence and the tools of its change.
struct SequenceRun<'a> {
    sequence: &'a Sequence,
    change: ToolChange,
}

impl SequenceRun<'_> {
    const fn pocket(&self, pocket: Pocket) -> u32 {
        match pocket {
            Pocket::Returned => self.change.returns_to,
            Pocket::Fetched => self.change.fetched_from,
        }
    }
}

/// A bit for each input that shall be in this state.
fn bits(inputs: &[(u8, bool)], state: bool) -> u64 {
    let of = inputs.iter().filter(|(number, on)| *on == state && *number < 64);
    of.fold(0_u64, |bits, (number, _)| bits | 1 << number)
}

/// A signal of this number among those that are known.
fn known(signals: &[(u8, bool)], number: u8) -> (u8, bool) {
    signals.iter().find(|(other, _)| *other == number).copied().unwrap_or((number, false))
}

/// The turn from one pocket to another; `None`: it is there.
fn edges(carousel: &Carousel, from: u32, to: u32) -> Option<EdgeCount> {
    let (edges, backwards) = carousel.way(from, to);
    let backward = carousel.backward.filter(|_| backwards);
    (edges > 0).then(|| EdgeCount {
        output: backward.unwrap_or(carousel.forward),
        input: carousel.count,
        edges: edges.min(255) as u8,
        steady: STEADY_EDGE,
        longest: carousel.longest,
        usual: carousel.usual * f64::from(edges),
    })
}
