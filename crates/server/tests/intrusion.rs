//! Who tries to get out of the folders, to keep the server busy, or to pass for a page of ours:
//! refused, and nothing moves.

use crate::common::{How, Served};
use serde_json::json;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

const SECRET: &str = "what lies beside the folder of programs";

/// Ways out of a folder, as a request's line has them.
const WAYS_OUT: [&str; 22] = [
    "../aside.ngc",
    "../../aside.ngc",
    "..%2faside.ngc",
    "..%2Faside.ngc",
    "%2e%2e/aside.ngc",
    "%2e%2e%2faside.ngc",
    "%252e%252e%252faside.ngc",
    "a/../../aside.ngc",
    "a%2f..%2f..%2faside.ngc",
    "..%5caside.ngc",
    "..\\aside.ngc",
    "....//aside.ngc",
    "..;/aside.ngc",
    "..%00/aside.ngc",
    "aside.ngc%00.ngc",
    "%c0%ae%c0%ae/aside.ngc",
    "%ef%bc%8e%ef%bc%8e/aside.ngc",
    "%2fetc%2fpasswd",
    "/etc/passwd",
    "file:%2f%2f%2fetc%2fpasswd",
    "out/aside.ngc",
    "link.ngc",
];

/// A server with something beside its folder, and links in the folder that lead there.
fn with_a_secret(state: &Path) -> Served {
    let served = Served::of(How { state: Some(state.to_owned()), ..How::default() });
    let beside = state.join("beside");
    std::fs::create_dir(&beside).unwrap();
    std::fs::write(beside.join("aside.ngc"), SECRET).unwrap();
    std::os::unix::fs::symlink(&beside, served.folder.path().join("out")).unwrap();
    let link = served.folder.path().join("link.ngc");
    std::os::unix::fs::symlink(beside.join("aside.ngc"), link).unwrap();
    served
}

#[test]
fn no_path_leads_out_of_the_folders() {
    let state = tempfile::tempdir().unwrap();
    let served = with_a_secret(state.path());
    let roots = ["/api/v1/programs/", "/api/v1/runs/", "/assets/", "/", "/api/v1/../"];
    for way in WAYS_OUT {
        for root in roots {
            for method in ["GET", "PUT", "POST", "DELETE"] {
                let (status, answer) = served.raw(method, &format!("{root}{way}"), &[]);
                let is_refused = (400..500).contains(&status);
                let is_page = status == 200 && answer.contains("<!doctype html>");
                // an unusual name is a name: its file lies in the folder
                let is_name = status < 400 && way.contains('%') && root.ends_with("programs/");
                let is_so = is_refused || is_page || is_name;
                assert!(is_so, "{method} {root}{way}: {status} {answer}");
                assert!(!answer.contains(SECRET) && !answer.contains("root:"), "{root}{way}");
            }
        }
        for part in ["report", "certificate", "trace"] {
            let (status, answer) = served.raw("GET", &format!("/api/v1/runs/{way}/{part}"), &[]);
            assert!((400..500).contains(&status), "{way}/{part}: {status} {answer}");
        }
        let load = json!({ "request": "load", "program": way });
        let (status, answer) = served.request(&load);
        assert!(matches!(status, 404 | 422), "load {way}: {status} {answer}");
        assert!(!answer.to_string().contains(SECRET), "{answer}");
    }
    let secret = state.path().join("beside/aside.ngc");
    assert_eq!(std::fs::read_to_string(secret).unwrap(), SECRET);
    assert_eq!(std::fs::read_dir(state.path().join("beside")).unwrap().count(), 1);
    assert!(!served.folder.path().join("../aside.ngc").exists());
    let listed = served.get("/programs").1["programs"].as_array().unwrap().len();
    assert!(listed <= 3, "{listed} files");
}

#[test]
fn who_passes_for_a_page_of_ours_is_told_that_it_is_none() {
    let served = Served::at_pace(1.0);
    let own = served.server.address();
    let port = own.port();
    let foreign = [
        "null".to_owned(),
        String::new(),
        "http://".to_owned(),
        format!("http://localhost.evil.example:{port}"),
        format!("http://evil.example:{port}/{own}"),
        format!("http://{own}.evil.example"),
        format!("http://{own}@evil.example"),
        format!("http://evil.example#{own}"),
        format!("http://127.0.0.1:{}", port.wrapping_add(1)),
        format!("//{own}"),
        "http://127.0.0.1".to_owned(),
        format!("http://\u{e4}{own}"),
    ];
    let before = served.status();
    for origin in &foreign {
        for (method, path) in [
            ("POST", "/api/v1/request"),
            ("POST", "/api/v1/session"),
            ("POST", "/api/v1/operator"),
            ("PUT", "/api/v1/programs/a.ngc"),
            ("GET", "/api/v1/ws"),
            ("GET", "/api/v1/lsp"),
        ] {
            let (status, answer) = served.raw(method, path, &[("Origin", origin)]);
            assert_eq!(status, 403, "{origin} {method} {path}: {answer}");
        }
    }
    // one of ours does not vouch for another one
    let ours = format!("http://{own}");
    let two = [("Origin", ours.as_str()), ("Origin", "http://evil.example")];
    assert_eq!(served.raw("POST", "/api/v1/request", &two).0, 403);
    // a name of another site that was made to lead here
    for host in ["evil.example", "127.0.0.1", "localhost:1", "", "127.0.0.1:8383, evil.example"] {
        for path in ["/", "/api/v1/status", "/api/v1/session", "/mtconnect/current"] {
            let (status, answer) = served.raw("GET", path, &[("host", host)]);
            assert_eq!(status, 403, "{host} {path}: {answer}");
        }
    }
    assert_eq!(served.status()["power"], before["power"]);
    assert!(!served.folder.path().join("a.ngc").exists());
}

#[test]
fn what_is_larger_than_it_may_be_is_refused_and_others_are_answered() {
    let served = Served::at_pace(1.0);
    let deep = format!("{{\"request\":{}", "[".repeat(60_000));
    assert_eq!(served.post_with("/request", deep.as_bytes(), &[]).0, 400);
    let long = json!({ "request": "load", "program": "a".repeat(60_000) });
    let (status, answer) = served.request(&long);
    assert_eq!(status, 422, "{answer}");
    assert!(answer["reason"].as_str().unwrap().len() < 400, "{answer}");
    let blocks = json!({ "request": "manual_data_input", "blocks": "G0 X1\n".repeat(9000) });
    assert!(matches!(served.request(&blocks).0, 409 | 422));
    // an address, a header, and so many of them that no client of ours sends
    let address = format!("/api/v1/{}", "a".repeat(100_000));
    let head = "a".repeat(100_000);
    let many: Vec<String> = (0..2000).map(|n| format!("x-{n}")).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|name| (name.as_str(), "0")).collect();
    for (path, headers) in [
        (address.as_str(), &[][..]),
        ("/api/v1/status", &[("x-long", head.as_str())][..]),
        ("/api/v1/status", &many[..]),
    ] {
        let answer = broken_off(&served, path, headers);
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 4"), "{answer}");
    }
    // a length that does not come, and one that no memory holds
    for length in ["18446744073709551615", "99999999999999999999999", "-1", "1e9"] {
        let headers = [("Content-Length", length)];
        let answer = broken_off(&served, "/api/v1/request", &headers);
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 4"), "{length}: {answer}");
    }
    assert_eq!(served.get("/status").0, 200);
}

/// What is answered to a POST, if anything is, before the connection is closed.
fn broken_off(served: &Served, path: &str, headers: &[(&str, &str)]) -> String {
    let address = served.server.address();
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut head = format!("POST {path} HTTP/1.1\r\nHost: {address}\r\n");
    for (name, value) in headers {
        head += &format!("{name}: {value}\r\n");
    }
    let _ = stream.write_all(format!("{head}\r\n").as_bytes()); // it may be closed meanwhile
    let _ = stream.shutdown(std::net::Shutdown::Write);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer); // a reset is an end too
    String::from_utf8_lossy(&answer).into_owned()
}

/// Headers, bodies and frames that come a byte now and then, and answers that are never read: each
/// is given up after its time, and all the while others are answered and a machine that is led is
/// led on.
#[test]
fn slow_clients_are_given_up_and_hold_up_no_other() {
    const LONGEST: Duration = Duration::from_secs(1);
    let served = Served::waiting_at_most(LONGEST);
    let address = served.server.address();
    let large = vec![b';'; 15 << 20];
    assert_eq!(served.put("/programs/large.ngc", &large).0, 200);
    let mut led = served.socket("");
    served.power_on();
    let opened = |text: &str| {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_nonblocking(true).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    };
    let post = format!("POST /api/v1/request HTTP/1.1\r\nHost: {address}\r\n");
    let chunked = format!("{post}Transfer-Encoding: chunked\r\n\r\n");
    let body = format!("{post}Content-Length: 60000\r\n\r\n");
    let read = format!("GET /api/v1/programs/large.ngc HTTP/1.1\r\nHost: {address}\r\n\r\n");
    let trickles = [post.as_str(), chunked.as_str(), body.as_str()];
    let mut trickling: Vec<TcpStream> =
        (0..120).map(|n| opened(trickles[n % trickles.len()])).collect();
    let mut deaf: Vec<TcpStream> = (0..40).map(|_| opened(&read)).collect();
    let start = control::clock::now();
    let mut answered = 0;
    let mut bytes = [0; 4096];
    // so long until the last of them is given up
    while !trickling.is_empty() {
        trickling.retain_mut(|stream| {
            let is_gone = matches!(stream.write(b"1"), Err(e) if e.kind() != ErrorKind::WouldBlock);
            let ended = match stream.read(&mut bytes) {
                Ok(0) => true,
                Err(e) => e.kind() != ErrorKind::WouldBlock,
                Ok(_) => false,
            };
            !is_gone && !ended
        });
        assert_eq!(served.get("/status").0, 200);
        led.next("delta");
        answered += 1;
        let waited = control::clock::now() - start;
        assert!(waited < Duration::from_secs(90), "{} are still open", trickling.len());
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(answered > 10, "{answered}");
    // what was not read is not kept for its reader: a client that takes nothing in time is gone
    for stream in &deaf {
        stream.set_nonblocking(false).unwrap();
        stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
        stream.peek(&mut [0]).expect("an answer begins");
    }
    std::thread::sleep(2 * LONGEST);
    for mut stream in deaf.drain(..) {
        let mut all = Vec::new();
        let ended = stream.read_to_end(&mut all);
        assert!(
            ended.is_err() || all.len() < large.len(),
            "{} bytes were kept for a client that did not read",
            all.len()
        );
    }
    served.home();
}
