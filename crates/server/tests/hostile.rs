//! What a client sends that means harm, or is broken: refused or harmless; nothing moves, and
//! others are served on.

use crate::common::{How, Served, Socket, machine};
use serde_json::json;
use server::{Clock, Role, Tokens};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;
use test_support::size;
use tungstenite::stream::MaybeTlsStream;

/// Numbers that look random, the same in each run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, most: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % most
    }
}

const REQUESTS: [&str; 15] = [
    r#"{"request":"jog_increment","axis":"X","by_mm":10}"#,
    r#"{"request":"jog_increment","axis":"X","by_deg":10}"#,
    r#"{"request":"jog_continuous","axis":"Z","mm_per_min":-300}"#,
    r#"{"request":"home","axis":"Z"}"#,
    r#"{"request":"turn_spindle","spindle":0,"rpm":500}"#,
    r#"{"request":"load","program":"plate.ngc"}"#,
    r#"{"request":"search","line":12}"#,
    r#"{"request":"start"}"#,
    r#"{"request":"manual_data_input","blocks":"G0 X10\nG1 Z-5 F100"}"#,
    r#"{"request":"edit_tool","tool":3,"field":"length","value_mm":100.5}"#,
    r#"{"request":"limit_tool","tool":3,"uses":500}"#,
    r#"{"request":"renew_tool","tool":3}"#,
    r#"{"request":"set_work_offset","work_offset":"G54","axis":"X","at_mm":-250}"#,
    r#"{"request":"feed_override","percent":80}"#,
    r#"{"request":"touch_off","axis":"Y","at_mm":0}"#,
];

#[test]
fn mutated_requests_move_nothing() {
    let count = size::of(400, 20_000);
    let served = Served::at_pace(1.0);
    let before = served.status();
    let mut numbers = Numbers(22);
    let mut refused = 0;
    for _ in 0..count {
        let mut body = REQUESTS[numbers.below(REQUESTS.len())].as_bytes().to_vec();
        for _ in 0..=numbers.below(4) {
            if body.is_empty() {
                body.push(b'{');
            }
            let at = numbers.below(body.len());
            match numbers.below(5) {
                0 => body[at] = numbers.below(256) as u8,
                1 => drop(body.remove(at)),
                2 => body.insert(at, b"0\"{}[],:e-"[numbers.below(10)]),
                3 => body.truncate(at.max(1)),
                _ => body.extend_from_within(at..),
            }
        }
        let (status, answer) = served.post_with("/request", &body, &[]);
        let shown = String::from_utf8_lossy(&body);
        assert!(matches!(status, 200 | 400 | 409 | 422), "{shown}: {status} {answer}");
        assert_eq!(answer["accepted"], status == 200, "{shown}: {answer}");
        refused += usize::from(status != 200);
        if status != 200 {
            assert!(!answer["reason"].as_str().unwrap().is_empty(), "{shown}");
        }
    }
    assert!(refused > count / 2, "{refused} of {count} were refused");
    let after = served.status();
    for axis in ["X", "Y", "Z"] {
        assert_eq!(machine(&after, axis), machine(&before, axis), "{axis} has moved");
    }
    assert_eq!((&after["power"], &after["execution"]), (&before["power"], &before["execution"]));
    // and it is led as before
    served.power_on();
}

#[test]
fn a_body_that_is_too_large_is_refused_before_it_is_read() {
    let served = Served::at_pace(1.0);
    let (status, answer) = served.post_with("/request", &vec![b' '; 65 << 10], &[]);
    assert_eq!(status, 413, "{answer}");
    assert!(answer["reason"].as_str().unwrap().contains("65536"), "{answer}");
}

#[test]
fn a_browser_is_told_to_take_no_script_and_no_style_that_is_not_a_file_of_ours() {
    let served = Served::at_pace(1.0);
    let mut stream = TcpStream::connect(served.server.address()).unwrap();
    let host = served.server.address();
    write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (headers, page) = answer.split_once("\r\n\r\n").unwrap();
    let policy = headers
        .lines()
        .find_map(|line| line.strip_prefix("content-security-policy: "))
        .unwrap_or_else(|| panic!("{headers}"));
    for rule in ["default-src 'self'", "script-src 'self'", "style-src 'self'"] {
        assert!(policy.split("; ").any(|has| has == rule), "{rule}: {policy}");
    }
    assert!(!policy.contains("unsafe"), "{policy}");
    assert!(!page.contains("<style") && !page.contains("style=\""), "{page}");
}

#[test]
fn clients_that_send_nothing_keep_no_other_out() {
    let served = Served::waiting_at_most(Duration::from_secs(1));
    let mut silent: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut stream = TcpStream::connect(served.server.address()).unwrap();
            stream.write_all(b"GET /api/v1/status HTTP/1.1\r\nHost: ").unwrap();
            stream
        })
        .collect();
    assert_eq!(served.get("/status").0, 200);
    // they are closed when their header has not come in time
    let last = silent.last_mut().unwrap();
    last.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut answer = Vec::new();
    last.read_to_end(&mut answer).unwrap();
    assert!(!answer.starts_with(b"HTTP/1.1 200"), "{}", String::from_utf8_lossy(&answer));
}

#[test]
fn of_more_connections_than_there_may_be_those_give_way_that_say_nothing() {
    let served = Served::at_pace(1.0);
    let mut open: Vec<TcpStream> =
        (0..600).map(|_| TcpStream::connect(served.server.address()).unwrap()).collect();
    assert_eq!(served.get("/status").0, 200);
    let first = open.first_mut().unwrap();
    first.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut answer = Vec::new();
    let _ = first.read_to_end(&mut answer); // it is closed, or was cut off
    assert!(answer.is_empty(), "{}", String::from_utf8_lossy(&answer));
}

/// The systems between take megabytes for who reads nothing; that is no reading.
#[test]
fn panels_that_read_nothing_make_room_for_one_that_does() {
    let served = Served::at_pace(1.0);
    let deaf: Vec<_> = (0..64).map(|_| served.socket("")).collect();
    let begun = control::clock::now();
    let mut another = loop {
        let url = format!("ws://{}/api/v1/ws", served.server.address());
        let stream = TcpStream::connect(served.server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
        if let Ok((socket, _)) = tungstenite::client(url, MaybeTlsStream::Plain(stream)) {
            break Socket { socket };
        }
        assert!(control::clock::now() - begun < Duration::from_mins(1), "all are kept");
        std::thread::sleep(Duration::from_millis(50));
    };
    println!("a place after {:?}", control::clock::now() - begun);
    another.next("status");
    // one that reads stays, though it says nothing
    for _ in 0..200 {
        another.next("delta");
    }
    drop(deaf);
}

#[test]
fn viewers_leave_a_place_at_the_panel_for_who_commands() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tokens.toml");
    let hour = Duration::from_hours(1);
    let viewer = Tokens::add(&path, "wall", Role::Viewer, hour).unwrap().token;
    let operator = Tokens::add(&path, "desk", Role::Operator, hour).unwrap().token;
    let served = Served::with(1.0, Some(path));
    let open = |token: &str| {
        let body = json!({ "name": "panel", "token": token });
        served.post("/session", &body).1["session"].as_str().unwrap().to_owned()
    };
    let (viewer, operator) = (open(&viewer), open(&operator));
    let connect = |session: &str| {
        let url = format!("ws://{}/api/v1/ws?session={session}", served.server.address());
        let stream = TcpStream::connect(served.server.address()).unwrap();
        tungstenite::client(url, MaybeTlsStream::Plain(stream)).ok()
    };
    let panels: Vec<_> = (0..60).map(|_| connect(&viewer)).collect();
    assert!(panels.iter().flatten().count() < 60, "all are open");
    assert!(connect(&operator).is_some());
}

#[test]
fn a_socket_that_talks_nonsense_is_told_so_or_closed() {
    let served = Served::at_pace(1.0);
    let mut socket = served.socket("");
    socket.send(&json!({ "type": "request", "request": { "request": "power" } }));
    assert_eq!(socket.next("answer")["accepted"], false);
    socket.send(&json!([1, 2, 3]));
    assert_eq!(socket.next("answer")["accepted"], false);
    let large = tungstenite::Message::text(" ".repeat(1 << 20));
    let _ = socket.socket.send(large); // it may be closed while this is sent
    while socket.socket.read().is_ok() {}
    assert_eq!(served.get("/status").0, 200);
}

#[test]
fn a_client_that_does_not_read_holds_up_no_other() {
    let served = Served::at_pace(1.0);
    let mut deaf = served.socket("");
    let names: Vec<_> = served.get("/machine").1["signals"].as_array().unwrap().clone();
    deaf.send(&json!({ "type": "scope", "signals": names[..12] }));
    std::thread::sleep(Duration::from_millis(500));
    let mut other = served.socket("");
    other.next("status");
    for _ in 0..50 {
        other.next("delta");
    }
}

/// What a token allows ends with it, in the middle of whatever its owner does.
#[test]
fn who_has_a_token_that_has_expired_is_told_so_and_moves_nothing() {
    const VALID: Duration = Duration::from_mins(10);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tokens.toml");
    let made = Tokens::add(&path, "desk", Role::Operator, VALID).unwrap();
    let stays = Tokens::add(&path, "wall", Role::Viewer, VALID * 1000).unwrap();
    let clock = Clock::default();
    let how = How { token_file: Some(path), clock: clock.clone(), ..How::default() };
    let served = Served::of(how);
    let (status, opened) = served.post("/session", &json!({ "name": "desk", "token": made.token }));
    assert_eq!(status, 200, "{opened}");
    let session = opened["session"].as_str().unwrap();
    let power = br#"{"request":"power","on":true}"#;
    let own = [("x-leadscrew-session", session)];
    assert_eq!(served.post_with("/request", power, &own).0, 200);
    let mut sockets =
        ["/ws", "/lsp"].map(|at| served.socket_at(at, &format!("?session={session}")));
    sockets[0].next("status");
    clock.advance(VALID);
    // both are closed when it is over, though nothing is asked
    for socket in &mut sockets {
        while socket.socket.read().is_ok() {}
    }
    let bearer = format!("Bearer {}", made.token);
    let jog = br#"{"request":"jog_continuous","axis":"X","mm_per_min":600}"#;
    let wall = format!("Bearer {}", stays.token);
    let seen = || served.get_with("/status", &[("authorization", &wall)]).1;
    let before = machine(&seen(), "X");
    for header in [own[0], ("authorization", bearer.as_str())] {
        let (status, answer) = served.post_with("/request", jog, &[header]);
        assert_eq!((status, &answer["reason"]), (401, &json!("the token has expired")), "{answer}");
        assert!(answer["remedy"].as_str().unwrap().contains("--new-token"), "{answer}");
    }
    let again = json!({ "name": "desk", "token": made.token });
    let (status, answer) = served.post("/session", &again);
    assert_eq!((status, &answer["reason"]), (401, &json!("the token has expired")), "{answer}");
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(machine(&seen(), "X"), before);
}

/// A jog is renewed by who holds its lease alone: what was sent before, and is sent again by
/// another one, moves nothing.
#[test]
fn a_jog_that_is_replayed_by_a_session_that_does_not_command_moves_nothing() {
    let served = Served::at_pace(1.0);
    let open = |name: &str| {
        let (status, opened) = served.post("/session", &json!({ "name": name }));
        assert_eq!(status, 200, "{opened}");
        opened["session"].as_str().unwrap().to_owned()
    };
    let (desk, other) = (open("desk"), open("other"));
    let _holds = served.socket(&format!("?session={desk}"));
    let post = |session: &str, body: &[u8]| {
        served.post_with("/request", body, &[("x-leadscrew-session", session)]).0
    };
    assert_eq!(post(&desk, br#"{"request":"power","on":true}"#), 200);
    served.until("ready", |status| status["is_ready"] == true);
    let jog = br#"{"request":"jog_continuous","axis":"X","mm_per_min":300}"#;
    let start = machine(&served.status(), "X");
    assert_eq!(post(&desk, jog), 200);
    served.until("it moves", |status| (machine(status, "X") - start).abs() > 0.1);
    // the lease is not renewed by its owner any more: the others' renewals are refused, and the
    // axis stops
    let stop = served.until("it rests", |status| {
        assert_eq!(post(&other, jog), 409);
        assert_eq!(post("0123456789abcdef0123456789abcdef", jog), 401);
        let at = machine(status, "X");
        std::thread::sleep(Duration::from_millis(100));
        machine(&served.status(), "X") == at && (at - start).abs() > 0.1
    });
    let rests = machine(&stop, "X");
    for _ in 0..20 {
        assert_eq!(post(&other, jog), 409);
    }
    assert_eq!(machine(&served.status(), "X"), rests);
}
