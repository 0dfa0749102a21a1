//! A stop that comes over the network, while others flood the server with requests.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::{ClientTimeouts, Clock, KeptRuns, Server, ServerOptions};
use canon::Axis;
use control::job::ProgramOptions;
use control::operation::hosted::{Client, Picture};
use control::operation::{Jog, Request};
use control::{Control, ControlOptions, RealTimeOptions};
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;
use test_support::size;
use units::Coordinate;

/// Requests that a client of the flood sends at once.
const AT_ONCE: usize = 32;
/// Periods from a request to the first slower setpoint: three, and 5 ms.
const MOST: usize = 23;

/// Clients that send requests, as fast as they are answered.
struct Flood {
    is_over: Arc<AtomicBool>,
    clients: Vec<std::thread::JoinHandle<u64>>,
}

impl Flood {
    fn begin(address: SocketAddr, clients: usize) -> Self {
        let is_over = Arc::<AtomicBool>::default();
        let client = |_| {
            let ends = Arc::clone(&is_over);
            let thread = std::thread::Builder::new().name("flood".into());
            thread.spawn(move || flood(address, &ends)).unwrap()
        };
        Self { clients: (0..clients).map(client).collect(), is_over }
    }

    /// Requests that were answered.
    fn end(self) -> u64 {
        self.is_over.store(true, Ordering::Relaxed);
        self.clients.into_iter().map(|client| client.join().unwrap()).sum()
    }
}

/// One client; the connection may be given up, and then there is another one.
fn flood(address: SocketAddr, ends: &AtomicBool) -> u64 {
    let batch = format!("GET /api/v1/nothing HTTP/1.1\r\nHost: {address}\r\n\r\n").repeat(AT_ONCE);
    let (mut answered, mut bytes) = (0, vec![0; 1 << 16]);
    while !ends.load(Ordering::Relaxed) {
        let Ok(mut stream) = TcpStream::connect(address) else { continue };
        stream.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
        while !ends.load(Ordering::Relaxed) && stream.write_all(batch.as_bytes()).is_ok() {
            let mut left = AT_ONCE;
            while left > 0 {
                let Ok(count @ 1..) = stream.read(&mut bytes) else { break };
                // a status line may lie across two reads: then it is not counted
                let heads = bytes[..count].windows(9).filter(|at| *at == b"HTTP/1.1 ").count();
                answered += heads as u64;
                left = left.saturating_sub(heads.max(1));
            }
            if left > 0 {
                break;
            }
        }
    }
    answered
}

fn until(client: &Client, what: &str, is_so: impl Fn(&Picture) -> bool) {
    for _ in 0..60_000 {
        if is_so(&client.latest()) {
            return;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("{what}: {:?}", client.latest().status);
}

fn served(folder: &std::path::Path) -> Server {
    let server = Server::start(ServerOptions {
        control: ControlOptions {
            real_time: Some(RealTimeOptions::default()),
            ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
        },
        pace: 1.0,
        address: "127.0.0.1:0".parse().unwrap(),
        programs: folder.to_owned(),
        token_file: None,
        certificate: None,
        names: Vec::new(),
        kept_runs: KeptRuns::default(),
        mtconnect: None,
        publish: None,
        metrics: false,
        timeouts: ClientTimeouts::default(),
        clock: Clock::default(),
    });
    server.unwrap_or_else(|refused| panic!("{}", refused.0))
}

/// Periods from the moment at which a request has been sent to the first reading of X that lags by
/// 5 µm.
fn periods_until_it_acts(server: &Server, stop: &'static str) -> usize {
    let client = server.hosted.client();
    let x = |picture: &Picture| picture.status.axes[0].machine;
    let begins = x(&client.latest());
    let way = if begins > -250.0 { -60.0 } else { 60.0 };
    let moves = match stop {
        "jog_stop" => Request::Jog(Axis::X, Jog::Increment(Coordinate::new(way))),
        _ => Request::ManualDataInput(format!("G21 G91 G1 F1200 X{way}")),
    };
    until(&client, "a move is accepted", |_| client.request(moves.clone()).is_ok());
    until(&client, "it moves", |picture| (x(picture) - begins).abs() > 3.0);
    let (begin, begun) = channel::<()>();
    let sent = Arc::<AtomicBool>::default();
    let (is_sent, address) = (Arc::clone(&sent), server.address());
    let thread = std::thread::Builder::new().name("operator".into());
    let asks = move || {
        let mut stream = TcpStream::connect(address).unwrap();
        let body = format!("{{\"request\":\"{stop}\"}}");
        let head = format!("POST /api/v1/request HTTP/1.1\r\nHost: {address}\r\n");
        let kind = "Content-Type: application/json\r\nConnection: close\r\n";
        let text = format!("{head}{kind}Content-Length: {}\r\n\r\n{body}", body.len());
        begun.recv().unwrap();
        is_sent.store(true, Ordering::SeqCst);
        stream.write_all(text.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let operator = thread.spawn(asks).unwrap();
    let count = client.with(move |control| {
        let at = |control: &Control| {
            let x = &control.status().axes[0];
            x.machine - x.following_error
        };
        while control.periods_waiting() > 0 {
            control.period();
        }
        let first = at(control);
        (0..100).for_each(|_| control.period());
        let step = (at(control) - first) / 100.0;
        let mut expected = at(control);
        begin.send(()).unwrap();
        // what had happened before it was sent does not count
        let mut since = None;
        for period in 0..40_000 {
            if since.is_none() && sent.load(Ordering::SeqCst) {
                since = Some(period + control.periods_waiting());
            }
            control.period();
            expected += step;
            if (at(control) - expected).abs() > 5e-3 {
                return usize::saturating_sub(period + 1, since.unwrap_or(period));
            }
        }
        panic!("it does not stop");
    });
    let answer = operator.join().unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    let _ = client.request(Request::Stop); // where a hold is to go on
    count.unwrap()
}

#[test]
fn a_stop_over_the_network_acts_in_milliseconds_while_others_flood_the_server() {
    let folder = tempfile::tempdir().unwrap();
    let server = served(folder.path());
    let client = server.hosted.client();
    until(&client, "power", |_| client.request(Request::Power(true)).is_ok());
    until(&client, "ready", |picture| picture.status.is_ready);
    until(&client, "homing", |_| client.request(Request::Home(None)).is_ok());
    until(&client, "homed", |picture| picture.status.axes.iter().all(|axis| axis.is_homed));
    let (clients, rounds): (usize, usize) = (size::of(8, 100), size::of(2, 50));
    for stop in ["feed_hold", "stop", "jog_stop"] {
        let (flood, began) = (Flood::begin(server.address(), clients), control::clock::now());
        let mut counts: Vec<_> =
            (0..rounds).map(|_| periods_until_it_acts(&server, stop)).collect();
        let seconds = (control::clock::now() - began).as_secs_f64();
        let rate = flood.end() as f64 / seconds;
        counts.sort_unstable();
        let (late, most) = (counts[(rounds * 99).div_ceil(100) - 1], counts[rounds - 1]);
        println!(
            "{stop}: {clients} clients, {rate:.0} requests/s: {late} periods ({most} at most)"
        );
        // two rounds beside other tests are no measure of a computer
        assert!(late <= size::of(40_000, MOST), "{stop}: {counts:?} periods");
    }
}
