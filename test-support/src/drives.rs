//! What every kind of machine behind the control's door ([`control::drives`]) must do, whatever carries its commands.
//!
//! ```text
//!   obeys             axes go where they are told, and are where the control says, after the delay that the bench states
//!   one control       another one is refused while the first leads the machine, and taken when it has gone
//!   identity          a control with another machine's file is refused
//!   silence           a control that is gone in the middle of a motion: everything comes to rest within the stated way
//!   engaged tool      a control that is gone in a thread: the next one knows the tool, lets nothing else move, and takes it out
//!   loss              a machine that is gone: the control says so once, and nothing waits for it in vain
//! ```
//!
//! A machine that ends with its control keeps nothing: the suite holds that the next control then believes nothing, either.
use canon::Axis;
use control::operation::{Event, Execution, Jog, Request};
use control::{Control, ControlOptions};
use units::{Coordinate, Length, Time};

/// A machine of the kind that is tested, on which no work is clamped at Z-100 to Z-110.
pub trait DrivesBench {
    /// What a control of this machine is switched on with, its state folder among them.
    fn options(&self) -> ControlOptions;

    /// The same with the file of another machine; `None`: this kind is what its file says.
    fn of_another_machine(&self) -> Option<ControlOptions>;

    /// Where Z is by the plant, mm in machine coordinates once it is homed.
    fn z_mm(&self) -> f64;

    /// The machine goes on when its control ends.
    fn outlives_control(&self) -> bool;

    /// Lets the machine be for a while, and waits until it takes another control.
    fn without_control(&mut self);

    /// Ends the machine under its control; false: it cannot be.
    fn vanish(&mut self) -> bool;

    /// Longest time from a command to the place that it orders.
    fn delay(&self) -> Time;
}

/// Longest that is waited for anything, machine time.
const LONGEST: Time = Time::s(60.0);
/// Speed at which Z is jogged at most, mm/s.
const FASTEST: f64 = 200.0;
/// Periods from one look to the next.
const LOOK: usize = 4;
const TAP: &str = "T3 M6\nG91 G0 Z-100\nS1000 M3\nG33.1 Z-10 K1";

/// Runs the whole suite. The machine is gone afterwards, where it can be.
///
/// # Panics
/// What does not hold, in a sentence.
pub fn conforms(bench: &mut dyn DrivesBench) {
    obeys(bench);
    one_control_at_a_time(bench);
    another_machine_is_refused(bench);
    silence_brings_it_to_rest(bench);
    engaged_tool_is_known_to_the_next_control(bench);
    a_loss_is_said(bench);
}

fn switched_on(bench: &dyn DrivesBench) -> Control {
    Control::new(bench.options()).unwrap_or_else(|why| panic!("a control is refused: {why}"))
}

fn homed(bench: &dyn DrivesBench) -> Control {
    let mut control = switched_on(bench);
    ask(&mut control, &Request::Power(true));
    until(&mut control, "drives are ready", |control| control.status().is_ready);
    ask(&mut control, &Request::Home(None));
    until(&mut control, "all axes are homed", |control| {
        control.is_homed_all() && !control.is_referencing() && control.is_at_standstill()
    });
    control
}

fn ask(control: &mut Control, request: &Request) {
    if let Err(refused) = control.request(request) {
        panic!("{request:?} is refused: {refused}; alarms: {:?}", control.status().alarms);
    }
}

fn until(control: &mut Control, what: &str, mut is_so: impl FnMut(&Control) -> bool) {
    let end = control.now() + LONGEST;
    while !is_so(control) {
        assert!(control.now() < end, "waited in vain until {what}: {:#?}", control.status());
        for _ in 0..LOOK {
            control.period();
        }
    }
}

/// Setpoint of Z and what its encoder lacks of it, mm, in the same period.
fn z_by_control(control: &Control) -> (f64, f64) {
    let status = control.status();
    let z = status.axes.iter().find(|axis| axis.letter == 'Z');
    z.map_or((f64::NAN, f64::NAN), |axis| (axis.machine, axis.following_error))
}

fn z_setpoint(control: &Control) -> f64 {
    z_by_control(control).0
}

fn jog(control: &mut Control, to_mm: f64) {
    ask(control, &Request::Jog(Axis::Z, Jog::To(Coordinate::linear(Length::mm(to_mm)))));
}

fn obeys(bench: &mut dyn DrivesBench) {
    let mut control = homed(bench);
    let from = z_setpoint(&control);
    let most = FASTEST * (bench.delay() + control.period_time()).value() + 0.1;
    for to in [from - 20.0, from - 5.0] {
        jog(&mut control, to);
        control.period();
        let mut farthest = 0.0_f64;
        until(&mut control, "Z has been jogged", |control| {
            farthest = farthest.max(z_by_control(control).1.abs());
            !control.is_moving_manually() && control.is_at_standstill()
        });
        assert!(
            farthest <= most,
            "Z was {farthest:.3} mm behind its setpoint; {most:.3} are stated"
        );
        let off = (bench.z_mm() - to).abs();
        assert!(off < 0.02, "Z was told {to:.3} mm and is at {:.3}", bench.z_mm());
    }
    drop(control);
    bench.without_control();
}

fn one_control_at_a_time(bench: &mut dyn DrivesBench) {
    if !bench.outlives_control() {
        return; // each control has a machine of its own
    }
    let first = homed(bench);
    let second = Control::new(bench.options()).err().map(|why| why.to_string());
    assert!(second.is_some(), "two controls lead one machine");
    drop(first);
    bench.without_control();
    drop(switched_on(bench));
    bench.without_control();
}

fn another_machine_is_refused(bench: &mut dyn DrivesBench) {
    let Some(options) = bench.of_another_machine() else { return };
    assert!(Control::new(options).is_err(), "a control of another machine leads this one");
    bench.without_control();
}

fn silence_brings_it_to_rest(bench: &mut dyn DrivesBench) {
    let mut control = homed(bench);
    let from = z_setpoint(&control);
    jog(&mut control, from - 60.0);
    until(&mut control, "Z is on its way", |_| bench.z_mm() < from - 20.0);
    let before = bench.z_mm();
    drop(control);
    bench.without_control();
    if bench.outlives_control() {
        let stands = bench.z_mm();
        bench.without_control();
        assert!((bench.z_mm() - stands).abs() < 1e-3, "Z moves on without a control");
        assert!(before - stands < 30.0, "Z went on from {before:.1} mm to {stands:.1} mm");
    }
    // whatever it knows of the machine, the next control leads it
    drop(homed(bench));
    bench.without_control();
}

fn engaged_tool_is_known_to_the_next_control(bench: &mut dyn DrivesBench) {
    let mut control = homed(bench);
    let from = z_setpoint(&control);
    ask(&mut control, &Request::ManualDataInput(TAP.into()));
    until(&mut control, "the tap is in its thread", |_| bench.z_mm() < from - 105.0);
    drop(control);
    bench.without_control();
    let mut next = switched_on(bench);
    assert_eq!(next.is_tool_in_work(), bench.outlives_control(), "what the next control believes");
    if bench.outlives_control() {
        for moves in [Request::Home(None), Request::ManualDataInput("G91 G0 X1".into())] {
            assert!(next.request(&moves).is_err(), "{moves:?} with a tool in the work");
        }
        ask(&mut next, &Request::Recover);
        until(&mut next, "the tool is out", |control| !control.is_tool_in_work());
        assert!(bench.z_mm() > from - 100.2, "the tap was left at {:.2} mm", bench.z_mm());
    }
    drop(next);
    bench.without_control();
    let after = switched_on(bench);
    assert!(!after.is_tool_in_work(), "a tool that was taken out is believed in the work");
    drop(after);
    bench.without_control();
}

fn a_loss_is_said(bench: &mut dyn DrivesBench) {
    let mut control = homed(bench);
    ask(&mut control, &Request::ManualDataInput("G91 G1 F600 Z-20\nZ20\nZ-20\nZ20".into()));
    let from = z_setpoint(&control);
    until(&mut control, "Z is on its way", |control| z_setpoint(control) < from - 1.0);
    while control.next_event().is_some() {}
    if !bench.vanish() {
        return;
    }
    until(&mut control, "the program has stopped", |control| {
        control.execution() != Execution::Active || control.stopped_by().is_some()
    });
    for _ in 0..500 {
        control.period();
    }
    assert!(control.stopped_by().is_some(), "no reason is given");
    let mut said = Vec::new();
    while let Some(event) = control.next_event() {
        match event {
            Event::Alarm(alarm) => said.push(alarm.text),
            Event::Notice(text) => said.push(text),
            _ => {}
        }
    }
    let twice = said.iter().find(|text| said.iter().filter(|other| other == text).count() > 1);
    assert!(!said.is_empty() && twice.is_none(), "said of the loss: {said:#?}");
    assert!(control.request(&Request::ManualDataInput("G91 G0 Z1".into())).is_err());
}
