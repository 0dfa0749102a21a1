//! Inputs are waited for, outputs are switched, a probe ends a move, a person confirms.
use crate::common::*;
use bus::{Feedback, Machine, State};
use canon::Position;
use kernel::{Answer, Answered, FaultKind, Kernel, Order, Pause, WaitFor};
use motion::{Await, InputWait, Output, ProbeEnd, Signal};
use plan::{Step, StepKind};
use sim::SimulatedMachine;
use units::Time;

const ZERO: Position = Position::xyz(0.0, 0.0, 0.0);

/// A machine with these steps, whose inputs a test says.
struct Bench {
    kernel: Kernel,
    machine: SimulatedMachine,
    feedback: Feedback,
    answers: Vec<Answered>,
}

impl Bench {
    fn of(pause: Pause, steps: Vec<StepKind>) -> Self {
        let config = machine(0);
        let mut kernel = Kernel::new(kernel::Config { pause, ..control(&config) });
        for (op, kind) in (0..).zip(steps) {
            kernel.push(&Step { op, line: op + 1, kind }).expect("there is room");
        }
        let machine = SimulatedMachine::new(config).expect("it can be built");
        let feedback = *machine.feedback();
        Self { kernel, machine, feedback, answers: Vec::new() }
    }

    /// For so long; `say` puts what is there onto the inputs.
    fn run(&mut self, seconds: f64, say: impl Fn(&mut Feedback)) -> bus::Command {
        self.run_over(seconds, |feedback, _| say(feedback))
    }

    /// The same, with the place where Z really is, mm.
    fn run_over(&mut self, seconds: f64, say: impl Fn(&mut Feedback, f64)) -> bus::Command {
        let mut command = bus::Command::default();
        for _ in 0..(seconds / PERIOD.value()) as usize {
            let z = self.true_z();
            say(&mut self.feedback, z);
            command = self.kernel.tick(&self.feedback);
            self.answers.extend(self.kernel.take_answer());
            self.feedback = *self.machine.exchange(&command);
        }
        command
    }

    fn true_z(&self) -> f64 {
        self.machine.truth().expect("it is simulated").axes[2].value()
    }

    fn waits_for(&self) -> Option<WaitFor> {
        self.kernel.waiting().map(|waiting| waiting.what)
    }
}

fn input(until: Await, longest: f64) -> InputWait {
    InputWait { number: 3, digital: true, until, longest: Time::s(longest) }
}

fn digital(number: u8, on: bool) -> StepKind {
    StepKind::Output(Output { number, signal: Signal::Digital { on } })
}

#[test]
fn a_wait_for_an_input_ends_when_the_input_comes_and_says_what_it_waits_for() {
    let wait = input(Await::On, 10.0);
    let mut bench = Bench::of(Pause::Wait, vec![StepKind::Input(wait), StepKind::End]);
    bench.run(2.1, |_| ());
    let waiting = bench.kernel.waiting().expect("it waits");
    assert_eq!(waiting.to_string(), "input 3 high, 2.1 s of 10 s");
    assert!(bench.answers.is_empty());
    bench.run(0.01, |feedback| feedback.inputs.switch(3, true));
    assert_eq!(bench.answers, [Answered { op: 0, answer: Answer::Input(Some(1.0)) }]);
    assert_eq!((bench.waits_for(), bench.kernel.report().state), (None, State::Ended));
}

#[test]
fn a_wait_that_runs_out_of_its_time_goes_on_without_a_value() {
    let wait = input(Await::Rise, 0.5);
    let mut bench = Bench::of(Pause::Wait, vec![StepKind::Input(wait), StepKind::End]);
    bench.run(0.6, |feedback| feedback.inputs.switch(3, true));
    assert_eq!(bench.answers, [Answered { op: 0, answer: Answer::Input(None) }]);
    assert_eq!(bench.kernel.report().state, State::Ended);
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn an_analogue_input_is_read_as_it_is() {
    let read = InputWait { digital: false, ..input(Await::Nothing, 0.0) };
    let mut bench = Bench::of(Pause::Wait, vec![StepKind::Input(read), StepKind::End]);
    bench.run(0.01, |feedback| feedback.inputs.analogue[3] = -2.5);
    assert_eq!(bench.answers, [Answered { op: 0, answer: Answer::Input(Some(-2.5)) }]);
}

#[test]
fn a_held_wait_does_not_grow_old_and_can_be_given_up() {
    let wait = input(Await::On, 0.5);
    let mut bench = Bench::of(Pause::Wait, vec![StepKind::Input(wait), StepKind::End]);
    bench.run(0.1, |_| ());
    bench.kernel.order(Order::FeedHold);
    bench.run(1.0, |_| ());
    assert_eq!((bench.answers.len(), bench.kernel.report().state), (0, State::Held));
    bench.kernel.order(Order::Abort);
    bench.run(0.01, |_| ());
    assert!(bench.kernel.is_over() && bench.kernel.is_idle());
}

#[test]
fn outputs_stay_as_the_program_has_switched_them_and_go_off_with_the_machine() {
    let volts = StepKind::Output(Output { number: 2, signal: Signal::Analogue { value: 2.5 } });
    let steps = vec![digital(5, true), digital(1, true), digital(1, false), volts, StepKind::End];
    let mut bench = Bench::of(Pause::Wait, steps);
    let outputs = bench.run(0.1, |_| ()).outputs;
    assert!(outputs.is_on(5) && !outputs.is_on(1));
    assert_eq!(outputs.analogue[2], 2.5);
    let off = bench.run(0.01, |feedback| feedback.emergency_stop = true).outputs;
    assert_eq!(off, bus::Signals::default());
    bench.kernel.switch_on();
    let after = bench.run(0.5, |feedback| feedback.emergency_stop = false).outputs;
    assert_eq!(after, bus::Signals::default(), "they stay off");
}

/// Input 3 must be on while Z moves down by 20 mm; afterwards another program moves it up.
fn guarded() -> Bench {
    let down = line(ZERO, Position::xyz(0.0, 0.0, -20.0), 10.0, true);
    let steps = vec![StepKind::Guard { on: 1 << 3, off: 0 }, down, StepKind::End];
    Bench::of(Pause::Wait, steps)
}

#[test]
fn an_input_that_must_stay_on_stops_what_moves_when_it_goes() {
    let mut bench = guarded();
    bench.run(1.0, |feedback| feedback.inputs.switch(3, true));
    assert!(bench.kernel.faults().is_empty() && bench.true_z() < -1.0);
    bench.run(0.5, |feedback| feedback.inputs.switch(3, false));
    assert_eq!(bench.kernel.faults()[0].kind, FaultKind::InputLost);
}

#[test]
fn what_a_program_guarded_that_was_given_up_does_not_stop_the_next_one() {
    let mut bench = guarded();
    bench.run(1.0, |feedback| feedback.inputs.switch(3, true));
    bench.kernel.order(Order::Abort);
    bench.run(0.5, |_| ());
    assert!(bench.kernel.clear());
    let stood = bench.true_z();
    let up = line(Position::xyz(0.0, 0.0, stood), ZERO, 10.0, true);
    bench.kernel.push(&Step { op: 0, line: 1, kind: up }).expect("there is room");
    bench.run(0.5, |feedback| feedback.inputs.switch(3, false));
    assert_eq!(bench.kernel.faults(), []);
    assert!(bench.true_z() > stood + 1.0);
}

#[test]
fn a_reset_switches_outputs_off() {
    let mut bench = Bench::of(Pause::Wait, vec![digital(5, true), StepKind::End]);
    assert!(bench.run(0.1, |_| ()).outputs.is_on(5));
    assert!(bench.kernel.clear());
    assert!(bench.run(0.01, |_| ()).outputs.is_on(5), "a program that follows finds it on");
    bench.kernel.clear_outputs();
    assert!(!bench.run(0.01, |_| ()).outputs.is_on(5));
}

#[test]
fn a_tool_by_hand_comes_when_it_is_confirmed_and_a_resume_does_not_confirm_it() {
    let steps = vec![StepKind::ChangeTool { tool: 0, by_hand: true }, StepKind::End];
    let mut bench = Bench::of(Pause::Wait, steps);
    bench.run(1.0, |_| ());
    assert_eq!(bench.waits_for(), Some(WaitFor::ToolByHand(0)));
    bench.kernel.order(Order::Resume);
    bench.run(0.1, |_| ());
    assert_eq!(bench.waits_for(), Some(WaitFor::ToolByHand(0)));
    bench.kernel.order(Order::Confirm);
    bench.run(0.1, |_| ());
    assert_eq!(bench.kernel.report().state, State::Ended);
}

#[test]
fn a_programs_stop_waits_until_it_is_confirmed() {
    let steps = vec![StepKind::Pause { optional: false }, StepKind::End];
    let mut bench = Bench::of(Pause::Wait, steps);
    bench.run(3.0, |_| ());
    let waiting = bench.kernel.waiting().expect("it waits");
    assert_eq!(waiting.what, WaitFor::Operator { optional: false });
    assert!(waiting.what.is_for_operator() && waiting.limit.is_none());
    assert!((2.9..3.0).contains(&waiting.age.value()), "{}", waiting.age);
    bench.kernel.order(Order::Confirm);
    bench.run(0.01, |_| ());
    assert_eq!(bench.kernel.report().state, State::Ended);
}

/// Down to Z-60 at 20 mm/s, until the probe does this.
fn probing(until: ProbeEnd) -> StepKind {
    let StepKind::Move(mut order) = line(ZERO, Position::xyz(0.0, 0.0, -60.0), 20.0, true) else {
        unreachable!("a line is a move")
    };
    order.rapid = false;
    StepKind::Probe { order, until }
}

const CONTACT: ProbeEnd = ProbeEnd { contact: true, required: true };

/// Something stands at this height: the probe says when it passed it.
fn stands_at(z_mm: f64) -> impl Fn(&mut Feedback, f64) {
    let before = core::cell::Cell::new(0.0);
    move |feedback, z| {
        let passed = (z - z_mm) / (z - before.replace(z));
        feedback.probe = z <= z_mm;
        feedback.probe_age = (0.0..1.0).contains(&passed).then(|| PERIOD * passed);
    }
}

#[test]
fn a_probing_move_comes_to_rest_after_the_contact_and_knows_its_place_within_a_micrometre() {
    let mut bench = Bench::of(Pause::Wait, vec![probing(CONTACT), StepKind::End]);
    bench.run_over(4.0, stands_at(-23.456));
    let [Answered { op: 0, answer: Answer::Probe { contact, stands, changed: true } }] =
        bench.answers[..]
    else {
        panic!("{:?}", bench.answers)
    };
    let [_, _, z] = contact.linear;
    assert!((z.value() + 23.456).abs() < 0.001, "{z}"); // what the model of the screw leaves
    let over = (z - stands.linear[2]).value();
    assert!((-0.01..0.5).contains(&over), "{over} mm beyond the contact");
    assert_eq!((bench.kernel.faults(), bench.kernel.report().state), (&[][..], State::Ended));
    assert!((bench.true_z() - stands.linear[2].value()).abs() < 0.005);
}

#[test]
fn a_probing_move_without_contact_is_an_alarm_unless_the_program_asks_what_came_of_it() {
    let mut bench = Bench::of(Pause::Wait, vec![probing(CONTACT), StepKind::End]);
    bench.run(5.0, |_| ());
    let kinds: Vec<_> = bench.kernel.faults().iter().map(|fault| fault.kind).collect();
    assert_eq!(kinds, [FaultKind::ProbeNotReached]);
    let optional = ProbeEnd { required: false, ..CONTACT };
    let mut bench = Bench::of(Pause::Wait, vec![probing(optional), StepKind::End]);
    bench.run(5.0, |_| ());
    assert_eq!((bench.kernel.faults(), bench.kernel.report().state), (&[][..], State::Ended));
    assert!(matches!(bench.answers[0].answer, Answer::Probe { changed: false, .. }));
}

#[test]
fn a_probe_that_is_in_contact_already_does_not_begin() {
    let mut bench = Bench::of(Pause::Wait, vec![probing(CONTACT), StepKind::End]);
    bench.run(1.0, |feedback| feedback.probe = true);
    assert_eq!(bench.kernel.faults()[0].kind, FaultKind::ProbeNotReady);
    assert!(bench.true_z().abs() < 0.005, "it has moved");
}

#[test]
fn the_end_of_contact_ends_a_move_likewise() {
    let away = ProbeEnd { contact: false, required: true };
    let mut bench = Bench::of(Pause::Wait, vec![probing(away), StepKind::End]);
    bench.run_over(4.0, |feedback, z| feedback.probe = z > -10.0);
    let Answer::Probe { contact, changed: true, .. } = bench.answers[0].answer else {
        panic!("{:?}", bench.answers)
    };
    assert!((contact.linear[2].value() + 10.0).abs() < 0.01, "{:?}", contact.linear);
}

#[test]
fn contact_in_a_rapid_is_an_alarm() {
    let steps = vec![line(ZERO, Position::xyz(0.0, 0.0, -60.0), 100.0, true), StepKind::End];
    let mut bench = Bench::of(Pause::Wait, steps);
    bench.run_over(2.0, stands_at(-23.0));
    assert_eq!(bench.kernel.faults()[0].kind, FaultKind::ProbeContact);
    assert!(bench.true_z() > -30.0, "it goes on");
}

#[test]
fn a_hold_of_a_probing_move_goes_on_with_the_same_move() {
    let mut bench = Bench::of(Pause::Wait, vec![probing(CONTACT), StepKind::End]);
    let work = stands_at(-23.0);
    bench.run_over(0.8, &work);
    bench.kernel.order(Order::FeedHold);
    bench.run_over(0.5, &work);
    assert_eq!(bench.kernel.report().state, State::Held);
    bench.kernel.order(Order::Resume);
    bench.run_over(3.0, &work);
    assert_eq!(bench.kernel.report().state, State::Ended);
    assert!(matches!(bench.answers[0].answer, Answer::Probe { changed: true, .. }));
}
