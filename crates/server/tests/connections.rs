//! Many connections at once, in a process of its own, so that its memory is that of this server and
//! its clients.
#![cfg(target_os = "linux")]

use crate::common::Served;
use serde_json::json;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;

/// Memory that this process has in use, bytes.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<u64>().unwrap() << 10
}

/// The client's ends are in this process, too; none of them costs it more than a few kB.
#[test]
fn a_thousand_connections_at_once_leave_the_operator_his_status_and_take_little_memory() {
    const MOST_GROWTH: u64 = 64 << 20;
    let served = Served::at_pace(1.0);
    let mut operator = served.socket("");
    operator.next("status");
    let before = resident();
    let mut seq = operator.next("delta")["seq"].as_u64().unwrap();
    let mut next = || {
        let next = operator.next("delta")["seq"].as_u64().unwrap();
        assert_eq!(next, seq + 1, "none is missing");
        seq = next;
    };
    let open: Vec<TcpStream> = std::thread::scope(|scope| {
        let opens = scope.spawn(|| {
            let open = (0..1000).filter_map(|_| {
                let mut stream = TcpStream::connect(served.server.address()).ok()?;
                // one that has given way may be closed already
                let _ = stream.write_all(b"GET /api/v1/status HTTP/1.1\r\nHost: ");
                Some(stream)
            });
            open.collect()
        });
        while !opens.is_finished() {
            next();
        }
        opens.join().unwrap()
    });
    assert!(open.len() > 500, "{} were opened", open.len());
    (0..100).for_each(|_| next());
    operator.send(
        &json!({ "type": "request", "id": 7, "request": { "request": "power", "on": true } }),
    );
    assert_eq!(operator.next("answer")["accepted"], true);
    let grown = resident().saturating_sub(before);
    assert!(grown < MOST_GROWTH, "{} connections took {grown} bytes", open.len());
    drop(open);
}

/// On all connections a request is under way whose body does not come: a stop is answered.
#[test]
fn where_all_connections_are_taken_a_stop_finds_one_and_nothing_else_does() {
    let served = Served::at_pace(1.0);
    let address = served.server.address();
    let stuck = || {
        let mut stream = TcpStream::connect(address).ok()?;
        let _ = write!(
            stream,
            "POST /api/v1/request HTTP/1.1\r\nHost: {address}\r\nContent-Length: 30\r\n\r\n{{"
        ); // it may be closed already
        Some(stream)
    };
    let mut open: Vec<TcpStream> = (0..400).filter_map(|_| stuck()).collect();
    assert!(open.len() > 300, "{} were opened", open.len());
    // one that was not read yet has given way, and left a place
    while served.get("/status").0 != 503 && open.len() < 2000 {
        open.extend((0..20).filter_map(|_| stuck()));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let (status, answer) = served.request(&json!({ "request": "power", "on": true }));
    assert_eq!(status, 503, "{answer}");
    for stop in
        [json!({ "request": "jog_stop" }), json!({ "request": "emergency_stop", "on": true })]
    {
        served.accepted(stop);
    }
    let (status, answer) = served.request(&json!({ "request": "feed_hold" }));
    assert_eq!(status, 409, "{answer}");
    drop(open);
}

#[test]
fn what_is_answered_before_its_body_has_come_ends_the_connection_and_says_so() {
    let served = Served::at_pace(1.0);
    let address = served.server.address();
    for (path, status) in [("/api/v1/nothing", "404"), ("/api/v1/status", "405")] {
        let mut stream = TcpStream::connect(address).unwrap();
        let head = format!("POST {path} HTTP/1.1\r\nHost: {address}\r\nContent-Length: 2\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap(); // it ends
        assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{answer}");
        assert!(answer.to_ascii_lowercase().contains("connection: close"), "{answer}");
    }
}
