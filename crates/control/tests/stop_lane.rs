//! Stops act at once: however full the queue is, however long the disk takes.
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::hosted::{Client, HostOptions, Hosted, Picture, RefusalKind};
use control::operation::{Jog, Request};
use control::{Control, ControlOptions, RealTimeOptions};
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;
use test_support::size;
use units::Coordinate;

/// Machine time passes so much faster than on the wall.
const PACE: f64 = 8.0;

/// Until it is so; machine time passes meanwhile.
fn until(client: &Client, what: &str, is_so: impl Fn(&Picture) -> bool) {
    for _ in 0..60_000 {
        if is_so(&client.latest()) {
            return;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("{what}: {:?}", client.latest().status);
}

fn x(picture: &Picture) -> f64 {
    picture.status.axes[0].machine
}

/// A disk that takes nothing before it is let go.
#[derive(Clone, Default)]
struct SlowDisk(Arc<(Mutex<bool>, Condvar)>);

impl SlowDisk {
    fn before_write(&self) -> Box<dyn FnMut() + Send> {
        let held = Arc::clone(&self.0);
        Box::new(move || {
            let (is_slow, goes_on) = &*held;
            let mut slow = is_slow.lock().unwrap();
            while *slow {
                slow = goes_on.wait(slow).unwrap();
            }
        })
    }

    fn is_slow(&self, slow: bool) {
        *self.0.0.lock().unwrap() = slow;
        self.0.1.notify_all();
    }
}

/// A disk that is let go when a test ends, however it does.
struct LetGo(SlowDisk);

impl Drop for LetGo {
    fn drop(&mut self) {
        self.0.is_slow(false);
    }
}

/// A hosted control with a state folder, homed: dropped from the last to the first.
fn homed(real_time: bool) -> (tempfile::TempDir, Hosted, Client, SlowDisk) {
    let (state, disk) = (tempfile::tempdir().unwrap(), SlowDisk::default());
    let before_write = disk.before_write();
    let host = HostOptions { pace: PACE, before_write, ..HostOptions::default() };
    let options = ControlOptions {
        state: Some(state.path().to_owned()),
        real_time: real_time.then(RealTimeOptions::default),
        ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
    };
    let hosted = Hosted::start(options, host).unwrap();
    let client = hosted.client();
    client.request(Request::Power(true)).unwrap();
    until(&client, "the drives come up", |picture| picture.status.is_ready);
    client.request(Request::Home(None)).unwrap();
    until(&client, "homed", |_| client.with(|control| control.is_homed_all()).unwrap());
    (state, hosted, client, disk)
}

/// Many who ask for an override again and again, until the answer is dropped.
struct Flood {
    is_over: Arc<AtomicBool>,
    threads: Vec<std::thread::JoinHandle<()>>,
    refused: Arc<AtomicU64>,
}

impl Flood {
    fn of(client: &Client, count: usize) -> Self {
        let (is_over, refused) = (Arc::<AtomicBool>::default(), Arc::<AtomicU64>::default());
        let threads = (0..count).map(|number| {
            let (client, is_over, refused) = (client.clone(), is_over.clone(), refused.clone());
            let thread = std::thread::Builder::new().name("flood".into());
            let flood = move || {
                let mut share = 0.9 + 0.001 * number as f64;
                while !is_over.load(Ordering::Relaxed) {
                    share = 1.9 - share;
                    if client.ask(Request::FeedOverride(share), |_| ()).is_err() {
                        refused.fetch_add(1, Ordering::Relaxed);
                        std::thread::yield_now();
                    }
                }
            };
            thread.spawn(flood).unwrap()
        });
        Self { threads: threads.collect(), is_over, refused }
    }

    fn end(self) -> u64 {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads {
            thread.join().unwrap();
        }
        self.refused.load(Ordering::Relaxed)
    }
}

#[test]
fn an_answer_that_depends_on_the_disk_waits_for_it_and_the_control_does_not() {
    let (_state, _hosted, client, disk) = homed(false);
    let _let_go = LetGo(disk.clone());
    disk.is_slow(true);
    let (answered, is_answered) = channel();
    client
        .ask(Request::FeedOverride(0.5), move |answer| answered.send(answer.is_ok()).unwrap())
        .unwrap();
    // what keeps nothing is answered meanwhile, and time goes on
    let before = client.latest().status.time_s;
    client.request(Request::Jog(Axis::X, Jog::Increment(Coordinate::new(-1.0)))).unwrap();
    until(&client, "time goes on", |picture| picture.status.time_s > before + 1.0);
    assert!(is_answered.try_recv().is_err(), "the disk has not taken it");
    disk.is_slow(false);
    assert!(is_answered.recv().unwrap());
}

#[test]
fn with_a_hundred_who_flood_the_queue_and_a_disk_that_hangs_every_stop_is_answered() {
    let (_state, _hosted, client, disk) = homed(false);
    let _let_go = LetGo(disk.clone());
    disk.is_slow(true);
    let flood = Flood::of(&client, 100);
    for _ in 0..20 {
        // in order: the hold needs a program, and there is none
        let refused = client.request(Request::FeedHold).unwrap_err();
        assert_eq!(refused.kind, RefusalKind::State, "{refused:?}");
        assert!(client.request(Request::JogStop).is_ok());
    }
    disk.is_slow(false);
    assert!(flood.end() > 0, "the queue was full");
}

#[test]
fn an_emergency_stop_opens_the_chain_before_anything_that_waits_in_the_queue() {
    let (_state, _hosted, client, disk) = homed(false);
    let _let_go = LetGo(disk.clone());
    disk.is_slow(true);
    let flood = Flood::of(&client, 100);
    client.request(Request::EmergencyStop(true)).unwrap();
    until(&client, "an alarm", |picture| picture.alarms.iter().any(|alarm| alarm.number == 101));
    let status = client.latest();
    assert!(!status.status.is_ready && status.status.emergency_stop == "TRIGGERED");
    disk.is_slow(false);
    flood.end();
}

/// Periods between a request and the first setpoint of X that shows it: the control's thread looks
/// at periods, and at nothing that was asked of it.
fn periods_until_it_acts(
    client: &Client,
    disk: &SlowDisk,
    stop: Request,
    real_time: bool,
    clients: usize,
) -> usize {
    let begins = x(&client.latest());
    let way = if begins > -250.0 { -60.0 } else { 60.0 };
    let moves = match stop {
        Request::JogStop => Request::Jog(Axis::X, Jog::Increment(Coordinate::new(way))),
        _ => Request::ManualDataInput(format!("G21 G91 G1 F1200 X{way}")),
    };
    // what was stopped before has to stand
    until(client, "a move is accepted", |_| client.request(moves.clone()).is_ok());
    until(client, "it moves", |picture| (x(picture) - begins).abs() > 3.0);
    disk.is_slow(true);
    let flood = Flood::of(client, clients);
    let asks = client.clone();
    let count = client.with(move |control| {
        // what its encoder reads, period by period: setpoints of the servo thread may be newer
        let read = |control: &Control| {
            let x = &control.status().axes[0];
            x.machine - x.following_error
        };
        let set = |control: &Control| control.setpoints().next().unwrap().1.value();
        let at = move |control: &Control| if real_time { read(control) } else { set(control) };
        while control.periods_waiting() > 0 {
            control.period();
        }
        let begins = at(control);
        (0..100).for_each(|_| control.period());
        let step = (at(control) - begins) / 100.0;
        let mut expected = at(control);
        asks.ask(stop, |_| ()).unwrap();
        let waiting = control.periods_waiting();
        let mut lags = |control: &mut Control| {
            control.period();
            expected += step;
            (at(control) - expected).abs() > if real_time { 5e-3 } else { 1e-6 }
                || control.has_alarm()
        };
        let count = (1..4000).find(|_| lags(control)).expect("it stops");
        usize::saturating_sub(count, waiting)
    });
    disk.is_slow(false);
    flood.end();
    let _ = client.request(Request::Stop); // where a hold is to go on, or nothing is under way
    count.unwrap()
}

/// The last of them is an alarm.
const STOPS: [Request; 4] =
    [Request::FeedHold, Request::Stop, Request::JogStop, Request::EmergencyStop(true)];

#[test]
fn a_stop_acts_within_three_periods_while_the_queue_is_full_and_the_disk_hangs() {
    let (_state, _hosted, client, disk) = homed(false);
    let _let_go = LetGo(disk.clone());
    for stop in STOPS {
        // an axis that is jogged lets go of its speed with the jerk of its feed: a micrometre later
        let most = if stop == Request::JogStop { 15 } else { 3 };
        let count = periods_until_it_acts(&client, &disk, stop.clone(), false, 20);
        assert!(count <= most, "{stop:?}: {count} periods");
    }
}

/// A thread that writes logs of 64 MB, and puts each on the disk, until the answer is dropped.
struct Logs(Arc<AtomicBool>, Option<std::thread::JoinHandle<u64>>);

impl Logs {
    fn begin() -> Self {
        let is_over = Arc::<AtomicBool>::default();
        let ends = Arc::clone(&is_over);
        let write = move || {
            let (folder, part) = (tempfile::tempdir().unwrap(), vec![b'.'; 1 << 20]);
            let mut mb = 0;
            while !ends.load(Ordering::Relaxed) {
                let mut file = std::fs::File::create(folder.path().join("log")).unwrap();
                for _ in 0..64 {
                    file.write_all(&part).unwrap();
                    mb += 1;
                }
                file.sync_all().unwrap();
            }
            mb
        };
        let thread = std::thread::Builder::new().name("logs".into());
        Self(is_over, Some(thread.spawn(write).unwrap()))
    }

    /// MB that were written.
    fn end(mut self) -> u64 {
        self.0.store(true, Ordering::Relaxed);
        self.1.take().unwrap().join().unwrap()
    }
}

/// 3 periods and 5 ms, as the encoder shows it: 5 µm behind where the axis would have been.
#[test]
fn in_real_time_a_stop_acts_within_milliseconds_whatever_the_control_and_others_do() {
    let (_state, _hosted, client, disk) = homed(true);
    let _let_go = LetGo(disk.clone());
    let (rounds, logs): (usize, _) = (size::of(1, 50), Logs::begin());
    for stop in STOPS {
        let once = || periods_until_it_acts(&client, &disk, stop.clone(), true, 100);
        // a chain that is open is closed by a person: once
        let count = if stop == Request::EmergencyStop(true) { 1 } else { rounds };
        let mut counts: Vec<_> = (0..count).map(|_| once()).collect();
        counts.sort_unstable();
        let late = counts[(count * 99).div_ceil(100) - 1];
        println!("{stop:?}: {late} periods of {count} ({} at most)", counts[count - 1]);
        assert!(late <= 23, "{stop:?}: {counts:?} periods");
    }
    println!("{} MB of logs were written meanwhile", logs.end());
}
