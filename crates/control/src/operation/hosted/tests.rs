//! What clients of a hosted control may rely on.
use super::*;
use crate::job::ProgramOptions;
use crate::operation::{Event, Execution, Jog};
use canon::Axis;
use std::time::Duration;
use units::CoordinateSpeed;

/// Machine time passes so much faster than on the wall.
const PACE: f64 = 8.0;

fn hosted() -> Hosted {
    let options = ControlOptions::simulated(ProgramOptions::on("tapping-center"));
    Hosted::start(options, HostOptions { pace: PACE, ..HostOptions::default() })
        .expect("the built-in machine is good")
}

/// Until it is so; machine time passes meanwhile.
fn until(client: &Client, what: &str, is_so: impl Fn(&Picture) -> bool) {
    // planning runs last: on a busy computer it waits for everything else
    let patience = Duration::from_mins(10);
    let start = crate::clock::now();
    while !is_so(&client.latest()) {
        assert!(crate::clock::now() - start < patience, "{what}: {:?}", client.latest().status);
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn x(picture: &Picture) -> f64 {
    picture.status.axes[0].machine
}

fn ready(client: &Client) {
    client.request(Request::Power(true)).expect("nothing stands in the way");
    until(client, "the drives come up", |picture| picture.status.is_ready);
}

#[test]
fn a_client_leads_the_control_and_another_one_sees_what_has_happened() {
    let hosted = hosted();
    let (leads, watches) = (hosted.client(), hosted.client());
    let refused = leads.request(Request::Start).expect_err("nothing is loaded");
    assert_eq!(refused.kind, RefusalKind::State);
    assert_eq!(refused.reason, "no program is loaded");
    assert_eq!(refused.remedy.as_deref(), Some("load one first"));
    ready(&leads);
    let (events, lost, last) = watches.events_after(0);
    assert!(events.iter().any(|event| *event.event == Event::DrivesReady), "{events:?}");
    assert_eq!((lost, last), (0, events.len() as u64));
}

#[test]
fn a_jog_whose_client_is_gone_ends_with_its_lease() {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    client
        .request(Request::Jog(Axis::X, Jog::Continuous(CoordinateSpeed::new(5.0))))
        .expect("the drives are on");
    drop(client);
    let watches = hosted.client();
    let start = x(&watches.latest());
    until(&watches, "the axis moves", |picture| (x(picture) - start).abs() > 0.2);
    let mut before = f64::NAN;
    let mut at = x(&watches.latest());
    while before != at {
        std::thread::sleep(Duration::from_millis(60));
        before = at;
        at = x(&watches.latest());
    }
    // 0.2 s at 5 mm/s, and what it brakes
    assert!((at - start).abs() < 1.3, "it went {} mm", at - start);
}

#[test]
fn every_period_of_the_signals_is_recorded_while_a_client_takes_them() {
    let hosted = hosted();
    let client = hosted.client();
    let taken = client.record();
    let mut next = 0;
    let mut seen = 0;
    while seen < 4000 {
        for rows in taken.rows_from(next) {
            assert_eq!(rows.width, client.signals().names().len());
            assert!(next == 0 || rows.first == next, "{} follows {next}", rows.first);
            next = rows.first + rows.count() as u64;
            seen += rows.count();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn what_is_loaded_is_proved_again_while_nothing_is_asked_for_and_then_starts_at_once() {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, "G21 G90 G54 G94\nG1 F6000 X1\nM2\n").expect("a program");
    client.request(Request::Load(path)).expect("it is good");
    client.request(Request::Home(None)).expect("nothing stands in the way");
    let is_homed =
        |control: &mut Control| [Axis::X, Axis::Y, Axis::Z].map(|axis| control.is_homed(axis));
    until(&client, "homed", |_| client.with(is_homed) == Some([true; 3]));
    client.request(Request::TouchOff(Axis::X, units::Coordinate::new(3.0))).expect("it stands");
    let is_proved = || client.with(|control| control.renewal().is_none()).expect("it is on");
    assert!(!is_proved(), "the offset has changed");
    until(&client, "proved", |_| is_proved());
    client.request(Request::Start).expect("it is proved");
    until(&client, "ended", |picture| {
        picture.status.execution == Execution::ProgramCompleted.name()
    });
    // and the next part
    until(&client, "proved", |_| is_proved());
    client.request(Request::Start).expect("it is proved");
    // one that does not wait until then
    until(&client, "ended", |picture| {
        picture.status.execution == Execution::ProgramCompleted.name()
    });
    client.request(Request::Start).expect("it is proved for this start");
}

#[test]
fn the_time_of_a_long_program_is_planned_while_it_waits_for_its_start() {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("part.ngc");
    let moves = "X1\nX0\n".repeat(600);
    std::fs::write(&path, format!("G21 G90 G54 G94\nG1 F6000\n{moves}M2\n")).expect("a program");
    let answer = client.request(Request::Load(path)).expect("it is good");
    assert!(answer.notes[0].contains("its time is being planned"), "{answer:?}");
    until(&client, "its time is known", |picture| {
        picture.status.program.as_ref().is_some_and(|program| program.planned_s > Some(12.0))
    });
}

/// Reading it takes minutes.
const LONG: &str =
    "G21 G90 G54\no1 while [#1 LT 40000000]\n#1=[#1+1]\nG0 X[#1 MOD 10]\no1 endwhile\nM2\n";

/// Blocks that order nothing, each of them long: a minute's work before the loop is refused.
fn computing() -> String {
    let line = format!("#1=[#1+1{}]\n", "+abs[sin[#1]]".repeat(60));
    format!("G21 G90 G54\no1 do\n{}o1 while [1]\nM2\n", line.repeat(20))
}

/// A program is loaded that is broken off by something else: why the load was refused.
fn broken_off(
    text: &str,
    break_off: impl FnOnce(&Client, &std::path::Path, &dyn Fn()),
) -> Option<RefusalData> {
    let hosted = hosted();
    let client = hosted.client();
    let folder = tempfile::tempdir().expect("a folder");
    let long = folder.path().join("long.ngc");
    std::fs::write(&long, text).expect("a program");
    let (sender, receiver) = std::sync::mpsc::channel();
    let is_gone = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let gone = Arc::clone(&is_gone);
    let interruption = Interruption::by(move || gone.load(std::sync::atomic::Ordering::Relaxed));
    let answered = move |answer| sender.send(answer).expect("it is awaited");
    client.ask_unless(interruption, Request::Load(long), answered).expect("nothing waits");
    until(&client, "it is read", |picture| {
        picture.status.loading.as_ref().is_some_and(|loading| loading.name.ends_with("long.ngc"))
    });
    break_off(&client, folder.path(), &|| {
        is_gone.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    let answer = receiver.recv().expect("an answer");
    until(&client, "nothing is read", |picture| picture.status.loading.is_none());
    assert_eq!(client.latest().status.execution, Execution::Ready.name());
    answer.err()
}

#[test]
fn a_load_ends_by_a_reset_a_stop_a_newer_load_and_where_its_client_is_gone() {
    let reason = |refusal: Option<RefusalData>| refusal.expect("it is broken off").reason;
    for text in [LONG, &computing()] {
        let by_reset = broken_off(text, |client, _, _| {
            client.request(Request::Reset).expect("nothing is under way");
        });
        assert!(reason(by_reset).contains("broken off by a reset"));
        let by_stop = broken_off(text, |client, _, _| {
            client.request(Request::Stop).expect("there is something to stop");
        });
        assert!(reason(by_stop).contains("broken off by a stop"));
        let by_newer = broken_off(text, |client, folder, _| {
            let short = folder.join("short.ngc");
            std::fs::write(&short, "G21 G90 G54\nG0 X1\nM2\n").expect("a program");
            client.request(Request::Load(short)).expect("it is good");
        });
        assert!(reason(by_newer).contains("broken off by a newer load"));
        let by_nobody = broken_off(text, |_, _, go| go());
        assert!(reason(by_nobody).contains("the end of the connection"));
    }
}

#[test]
fn what_is_read_shows_how_far_it_is() {
    let hosted = hosted();
    let client = hosted.client();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lines.ngc");
    let lines = "G0 X1\nG0 X2\n".repeat(30_000);
    std::fs::write(&path, format!("G21 G90 G54\n{lines}M2\n")).expect("a program");
    let (sender, receiver) = std::sync::mpsc::channel();
    client
        .ask(Request::Load(path), move |answer| sender.send(answer).expect("it is awaited"))
        .expect("nothing waits");
    let mut shown = vec![0.0];
    while receiver.try_recv().is_err() {
        if let Some(loading) = &client.latest().status.loading {
            shown.push(loading.percent);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(shown.is_sorted() && shown.last() > Some(&50.0), "{shown:?}");
}

/// What a start is answered that waits until its program is judged anew, when this comes.
fn started_and_broken_off(request: Request) -> RequestAnswer {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    client.request(Request::Home(None)).expect("nothing stands in the way");
    let is_homed =
        |control: &mut Control| [Axis::X, Axis::Y, Axis::Z].map(|axis| control.is_homed(axis));
    until(&client, "homed", |_| client.with(is_homed) == Some([true; 3]));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("part.ngc");
    let lines = "G0 X-1\nG0 X-2\n".repeat(40_000);
    std::fs::write(&path, format!("G21 G90 G54\n{lines}M2\n")).expect("a program");
    client.request(Request::Load(path)).expect("it is good");
    client.request(Request::TouchOff(Axis::X, units::Coordinate::new(3.0))).expect("it stands");
    std::thread::sleep(renewal::AFTER + Duration::from_millis(40)); // the renewal has begun
    let (sender, receiver) = std::sync::mpsc::channel();
    client
        .ask(Request::Start, move |answer| sender.send(answer).expect("it is awaited"))
        .expect("nothing waits");
    client.with(|_| ()).expect("it is on"); // the start has been taken from the queue
    let _ = client.request(request); // a reset is refused where the program has begun already
    receiver.recv().expect("an answer")
}

#[test]
fn a_start_that_waits_for_a_renewal_is_broken_off_by_a_stop_and_a_reset() {
    for request in [Request::Stop, Request::Reset] {
        // on a busy computer the renewal may be over before the start is asked for
        let mut answers = (0..5).map(|_| started_and_broken_off(request.clone()));
        let refused = answers.find_map(Result::err).expect("one is broken off");
        assert!(refused.reason.contains("broken off"), "{refused:?}");
    }
}

/// What waits in the queue while the control's thread is busy, and then is overtaken.
fn overtaken(client: &Client, waiting: Request, stop: Request) -> RequestAnswer {
    let (entered, has_entered) = std::sync::mpsc::channel();
    let (go, may_go) = std::sync::mpsc::channel::<()>();
    let busy = client.clone();
    let busy = std::thread::Builder::new().spawn(move || {
        busy.with(move |_| {
            entered.send(()).expect("it is awaited");
            may_go.recv().expect("the test goes on");
        })
    });
    let busy = busy.expect("a thread");
    has_entered.recv().expect("the control's thread is busy");
    let (sender, receiver) = std::sync::mpsc::channel();
    client
        .ask(waiting, move |answer| sender.send(answer).expect("it is awaited"))
        .expect("the queue is empty");
    client.ask(stop, |_| ()).expect("there is room");
    go.send(()).expect("it waits");
    busy.join().expect("no panic").expect("it is on");
    receiver.recv().expect("an answer")
}

#[test]
fn nothing_that_waits_begins_after_a_stop_that_was_asked_for_later() {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    let by_hand = [
        Request::Home(None),
        Request::Jog(Axis::X, Jog::Increment(units::Coordinate::new(5.0))),
        Request::TurnSpindle(0, units::Spin::rpm(100.0)),
        Request::OrientSpindle(0, units::Angle::ZERO),
    ];
    let by_program = [
        Request::Start,
        Request::ManualDataInput("G0 X1".to_owned()),
        Request::Resume,
        Request::Confirm,
    ];
    let out = [Request::Retract, Request::Recover];
    let at = x(&client.latest());
    let check = |waiting: &[Request], stop: Request, why: &str| {
        for waiting in waiting {
            let refused = overtaken(&client, waiting.clone(), stop.clone());
            let refused = refused.expect_err("it is overtaken");
            let reason = format!("{why} was asked for after it, before it had begun");
            assert_eq!(refused.reason, reason, "{waiting:?}");
        }
    };
    check(&by_program, Request::FeedHold, "a feed hold");
    check(&by_hand, Request::JogStop, "a stop of what is moved by hand");
    for waiting in [&by_program[..], &by_hand, &out] {
        check(waiting, Request::Stop, "a stop");
    }
    for waiting in [&by_program[..], &by_hand, &out] {
        check(waiting, Request::EmergencyStop(true), "an emergency stop");
    }
    let on = [Request::EmergencyStop(false), Request::Power(true)];
    check(&on, Request::EmergencyStop(true), "an emergency stop");
    assert_eq!(x(&client.latest()), at);
    // and what is asked for after the stop begins
    client.request(Request::EmergencyStop(false)).expect("it was pressed");
    until(&client, "the chain is closed", |picture| picture.status.emergency_stop == "ARMED");
    client.request(Request::Reset).expect("nothing is under way");
    ready(&client);
    client.request(by_hand[1].clone()).expect("nothing stands in the way");
    until(&client, "it moves", |picture| (x(picture) - at).abs() > 1.0);
}

/// Between two periods everything is asked for; the flags of stops act in the next one.
#[test]
fn a_stop_does_not_act_on_what_was_asked_for_after_it_in_the_same_period() {
    let hosted = hosted();
    let client = hosted.client();
    ready(&client);
    let asked = client.with(|control| {
        let (lane, _) = control.stops();
        let ask = |control: &mut Control, request| control.request(&request).is_ok();
        ask(control, Request::EmergencyStop(true));
        control.period();
        control.period();
        // pressed again by another one, and dealt with
        lane.ask(servo::LaneStop::EmergencyStop);
        ask(control, Request::EmergencyStop(true));
        let begun = [Request::EmergencyStop(false), Request::Reset, Request::Power(true)]
            .map(|request| ask(control, request));
        (begun, control.now().value())
    });
    let (begun, asked_s) = asked.expect("it is on");
    assert_eq!(begun, [true; 3]);
    until(&client, "the drives come up again", |picture| {
        picture.status.is_ready && picture.status.time_s > asked_s
    });
    assert!(client.latest().status.alarms.is_empty(), "{:?}", client.latest().status.alarms);
    let at = x(&client.latest());
    let jogged = client.with({
        let stops = client.clone();
        move |_| {
            let (sender, receiver) = std::sync::mpsc::channel();
            stops.ask(Request::JogStop, |_| ()).expect("there is room");
            let jog = Request::Jog(Axis::X, Jog::Increment(units::Coordinate::new(5.0)));
            stops.ask(jog, move |answer| drop(sender.send(answer))).expect("there is room");
            receiver
        }
    });
    let jogged = jogged.expect("it is on").recv().expect("an answer");
    jogged.expect("nothing stands in the way");
    until(&client, "it has moved", |picture| (x(picture) - at - 5.0).abs() < 0.01);
}
