//! What an `MTConnect` client may rely on: a real server, a machine that is simulated.

use crate::common::{How, Served};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;
use test_support::size;

/// An answer of the agent.
fn get(served: &Served, path: &str) -> (u16, String) {
    served.raw("GET", &format!("/mtconnect/{path}"), &[])
}

/// Elements of a document by a test, as their text.
fn texts(document: &str, is_it: impl Fn(&roxmltree::Node<'_, '_>) -> bool) -> Vec<String> {
    let document = roxmltree::Document::parse(document).unwrap();
    let found = document.descendants().filter(|node| node.is_element() && is_it(node));
    found.map(|node| node.text().unwrap_or_default().to_owned()).collect()
}

fn of_item(document: &str, id: &str) -> Vec<String> {
    texts(document, |node| node.attribute("dataItemId") == Some(id))
}

fn header(document: &str, name: &str) -> u64 {
    let document = roxmltree::Document::parse(document).unwrap();
    let header = document.descendants().find(|node| node.has_tag_name("Header")).unwrap();
    header.attribute(name).unwrap().parse().unwrap()
}

fn code(document: &str) -> String {
    let document = roxmltree::Document::parse(document).unwrap();
    let error = document.descendants().find(|node| node.has_tag_name("Error")).unwrap();
    error.attribute("errorCode").unwrap().to_owned()
}

/// Everything that is kept, observation after observation: sequence numbers and ids of data items
/// with their values.
fn all(served: &Served) -> Vec<(u64, String, String)> {
    let (mut found, mut from) = (Vec::new(), 1);
    loop {
        let (status, text) = get(served, &format!("sample?count=1000&from={from}"));
        assert_eq!(status, 200, "{text}");
        let document = roxmltree::Document::parse(&text).unwrap();
        let before = found.len();
        for node in document.descendants() {
            if let (Some(id), Some(sequence)) =
                (node.attribute("dataItemId"), node.attribute("sequence"))
            {
                let value = match node.tag_name().name() {
                    name @ ("Normal" | "Fault") => name,
                    _ => node.text().unwrap_or_default(),
                };
                found.push((sequence.parse().unwrap(), id.to_owned(), value.to_owned()));
            }
        }
        from = header(&text, "nextSequence");
        if found.len() == before {
            found.sort();
            return found;
        }
    }
}

fn values<'a>(all: &'a [(u64, String, String)], id: &str) -> Vec<&'a str> {
    all.iter().filter(|(_, item, _)| item == id).map(|(_, _, value)| value.as_str()).collect()
}

#[test]
fn a_run_with_a_hold_an_alarm_and_a_recovery_is_observed_event_by_event() {
    // slowly enough that a loaded computer sees the holds and taps that it waits for
    let served = Served::at_pace(8.0);
    served.power_on();
    served.home();
    served.accepted(json!({ "request": "load", "program": "plate.ngc" }));
    served.accepted(json!({ "request": "start" }));
    served.until("it runs", |status| status["program"]["line"].as_u64() > Some(10));
    served.accepted(json!({ "request": "feed_hold" }));
    served.until("a hold", |status| status["execution"] == "FEED_HOLD");
    served.accepted(json!({ "request": "resume" }));
    served.until("a tap", |status| status["activity"] == "tap-in");
    served.accepted(json!({ "request": "emergency_stop", "on": true }));
    served.until("an alarm", |status| status["alarms"] != json!([]));
    let (_, current) = get(&served, "current");
    assert_eq!(of_item(&current, "cont_estop"), ["TRIGGERED"]);
    let fault = texts(&current, |node| node.has_tag_name("Fault"));
    assert!(!fault.is_empty() && fault[0].contains(": "), "what and what to do: {fault:?}");
    served.accepted(json!({ "request": "emergency_stop", "on": false }));
    let stopped = served.until("all stands", |status| status["execution"] == "STOPPED");
    if stopped["is_tool_in_work"] == true {
        assert_eq!(of_item(&get(&served, "current").1, "path_recovery"), ["TOOL_IN_WORK"]);
        served.accepted(json!({ "request": "recover" }));
        served.until("out", |status| status["is_tool_in_work"] == false);
    }
    // a recovery is under way for a moment after the tool is out
    served.until("nothing is under way", |status| {
        let unmet = status["unmet"].as_array().unwrap();
        !unmet.iter().any(|unmet| unmet["need"] == "no_program_under_way")
    });
    // what stood half cut is judged when its tool is out, and is an event like any other
    let cut = served.get("/features").1.as_array().unwrap().len();
    assert!(cut > 0);
    let named = || {
        let (_, events) = served.get("/events?after=0");
        let events = events["events"].as_array().unwrap().iter();
        events.filter(|event| event["event"] == "feature").count()
    };
    assert_eq!(named(), cut);
    served.accepted(json!({ "request": "reset" }));
    served.until_accepted(json!({ "request": "power", "on": true }));
    served.until_accepted(json!({ "request": "start" }));
    served.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");
    served.until("the agent has seen it", |_| {
        of_item(&get(&served, "current").1, "path_execution") == ["PROGRAM_COMPLETED"]
    });

    let all = all(&served);
    let sequences: Vec<u64> = all.iter().map(|(sequence, ..)| *sequence).collect();
    assert_eq!(sequences, (1..=sequences.len() as u64).collect::<Vec<_>>(), "without gaps");
    let (_, events) = served.get("/events?after=0");
    assert_eq!(events["lost"], 0);
    let of = |kind: &str, field: &str| -> Vec<String> {
        let events = events["events"].as_array().unwrap().iter();
        let events = events.filter(|event| event["event"] == kind);
        events.map(|event| event[field].as_str().unwrap_or_default().to_owned()).collect()
    };
    let begun = |first: &[&str], then: Vec<String>| -> Vec<String> {
        first.iter().map(|text| (*text).to_owned()).chain(then).collect()
    };
    assert_eq!(
        values(&all, "path_execution"),
        begun(&["UNAVAILABLE", "READY"], of("execution", "execution"))
    );
    assert_eq!(values(&all, "path_mode"), begun(&["UNAVAILABLE", "MANUAL"], of("mode", "mode")));
    assert_eq!(values(&all, "cont_message"), begun(&["UNAVAILABLE"], of("notice", "text")));
    assert_eq!(values(&all, "path_feature"), begun(&["UNAVAILABLE"], of("feature", "text")));
    let faults = values(&all, "cont_alarms").iter().filter(|value| **value == "Fault").count();
    assert_eq!(faults, of("alarm", "event").len());
    assert_eq!(values(&all, "cont_alarms").last(), Some(&"Normal"), "the reset has cleared it");
    assert_eq!(values(&all, "path_part_count").last(), Some(&"1"));
    let verdicts = values(&all, "path_verdict");
    assert_eq!(verdicts.len() - 1, of("feature", "text").len());
    let judged = served.get("/features").1;
    assert_eq!(judged.as_array().unwrap().len(), verdicts.len() - 1);
    let judged: Vec<_> = judged.as_array().unwrap().iter().map(|f| &f["class"]).collect();
    let classes = values(&all, "path_class").into_iter().filter(|class| *class != "UNAVAILABLE");
    let classes: Vec<_> = classes.collect();
    assert!(classes.len() >= 12, "a thread each: {classes:?}");
    assert!(classes.iter().all(|class| judged.contains(&&json!(class))), "{classes:?} {judged:?}");
}

#[test]
fn a_turned_thread_that_is_good_has_the_class_that_is_asked_of_it() {
    let served = Served::of(How { machine: "lathe", pace: 40.0, ..How::default() });
    served.power_on();
    served.home();
    let program =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs/thread-m20x1.5.ngc");
    let program = std::fs::read(program).unwrap();
    assert_eq!(served.put("/programs/thread.ngc", &program).0, 200);
    served.execute("thread.ngc");
    served
        .until("its verdict", |_| of_item(&get(&served, "current").1, "path_verdict") == ["GOOD"]);
    assert_eq!(of_item(&get(&served, "current").1, "path_class"), ["6g"]);
}

#[test]
fn a_tap_that_was_stopped_before_the_material_is_not_said_to_be_of_no_class() {
    let served = Served::at_pace(1.0);
    served.power_on();
    served.home();
    let program =
        "G21 G54 G90 T3 M6\nG0 X12 Y12 G43 H3 Z5\nM3 S60\nG99 G84 X12 Y12 Z-5 R5 F60\nG80 M30\n";
    assert_eq!(served.put("/programs/slow.ngc", program.as_bytes()).0, 200);
    served.accepted(json!({ "request": "load", "program": "slow.ngc" }));
    served.accepted(json!({ "request": "start" }));
    served.until("it taps", |status| status["activity"] == "tap-in");
    served.accepted(json!({ "request": "emergency_stop", "on": true }));
    served.until("standstill", |status| status["execution"] == "STOPPED");
    served.accepted(json!({ "request": "emergency_stop", "on": false }));
    served.until("it may leave", |status| status["emergency_stop"] == "ARMED");
    if served.status()["is_tool_in_work"] == true {
        served.until_accepted(json!({ "request": "recover" }));
        served.until("it is out", |status| status["is_tool_in_work"] == false);
    }
    served.until_accepted(json!({ "request": "reset" }));
    served.until("its verdict", |_| {
        of_item(&get(&served, "current").1, "path_verdict") == ["FAILED"]
    });
    assert_eq!(of_item(&get(&served, "current").1, "path_class"), ["not gauged"]);
    assert_eq!(served.get("/features").1[0]["class"], "not gauged");
}

#[test]
fn what_was_true_at_an_observation_is_answered_as_long_as_it_is_kept() {
    let served = Served::at_pace(1.0);
    let before = header(&get(&served, "current").1, "lastSequence");
    served.accepted(json!({ "request": "single_block", "on": true }));
    served.until("it is observed", |_| {
        of_item(&get(&served, "current").1, "path_single_block") == ["ON"]
    });
    let (_, then) = get(&served, &format!("current?at={before}"));
    assert_eq!(of_item(&then, "path_single_block"), ["OFF"]);
    let path = "path=//Axes//Linear[@name=%22X%22]";
    let (_, x) = get(&served, &format!("current?{path}"));
    let ids = texts(&x, |node| node.attribute("dataItemId").is_some());
    assert_eq!(ids.len(), 4, "place by machine and work, homed, load: {x}");
    let (_, last) = get(&served, "sample?count=-2");
    assert_eq!(texts(&last, |node| node.attribute("dataItemId").is_some()).len(), 2);
    let (_, device) = get(&served, "tapping-center/probe");
    assert!(device.contains("MTConnectDevices"), "{device}");
}

#[test]
fn each_mistake_has_its_code_and_nothing_can_be_asked_for_this_way() {
    let served = Served::at_pace(1.0);
    for (path, status, expected) in [
        ("sample?from=999999", 404, "OUT_OF_RANGE"),
        ("sample?from=0", 404, "OUT_OF_RANGE"),
        ("current?at=999999", 404, "OUT_OF_RANGE"),
        ("sample?count=0", 404, "OUT_OF_RANGE"),
        ("sample?count=10001", 400, "TOO_MANY"),
        ("sample?from=1&from=1", 400, "INVALID_REQUEST"),
        ("current?path=//Nothing", 400, "INVALID_PATH"),
        ("current?path=//DataItem[", 400, "INVALID_PATH"),
        ("current?path=//text()", 405, "UNSUPPORTED"),
        ("asset/none", 404, "ASSET_NOT_FOUND"),
        ("mill/current", 404, "NO_DEVICE"),
        ("nothing", 404, "INVALID_URI"),
        ("schemas/../probe", 404, "INVALID_URI"),
        ("%ff/probe", 404, "INVALID_URI"),
        ("probe?x=1", 400, "INVALID_REQUEST"),
    ] {
        let (answered, text) = get(&served, path);
        assert_eq!((answered, code(&text).as_str()), (status, expected), "{path}");
    }
    for method in ["POST", "PUT", "DELETE", "PATCH"] {
        let (status, text) = served.raw(method, "/mtconnect/probe", &[]);
        assert_eq!((status, code(&text).as_str()), (405, "UNSUPPORTED"));
    }
    assert_eq!(served.status()["power"], "OFF");
}

#[test]
fn mutated_requests_are_answered_by_documents_of_the_standard() {
    let served = Served::at_pace(1.0);
    let whole = [
        "probe",
        "current?path=//Axes//Linear[@name=%22X%22]&at=5",
        "sample?path=//DataItem[@type=%22POSITION%22]&from=1&count=50&to=40",
        "asset/tapping-center.CuttingTool.T3?type=CuttingTool&count=2&removed=true",
        "tapping-center/sample?from=2&count=-7",
    ];
    let pieces = [
        "%00",
        "%2F",
        "..",
        "&",
        "=",
        "[",
        "]",
        "//",
        "9999999999999999999999",
        "-1",
        "%",
        "@",
        "|",
    ];
    let mut seed = 1_u64;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let mut codes = std::collections::BTreeMap::<String, u32>::new();
    for _ in 0..size::of(400, 20_000) {
        let mut text = whole[random(whole.len())].to_owned();
        for _ in 0..=random(3) {
            let at = random(text.len() + 1);
            match random(3) {
                0 => text.insert_str(at, pieces[random(pieces.len())]),
                1 if at < text.len() => drop(text.remove(at)),
                _ => text.insert(at, char::from(b'!' + random(90) as u8)),
            }
        }
        // what no URI has is refused before the agent sees it
        let is_of_uri = |c: &char| !"\"#<>\\^`{|}".contains(*c);
        let text: String = text.chars().filter(is_of_uri).collect();
        if text.contains("interval") {
            continue;
        }
        let (status, answer) = get(&served, &text);
        let document = roxmltree::Document::parse(&answer);
        let document = document.unwrap_or_else(|e| panic!("{text}: {status} {e}: {answer}"));
        let root = document.root_element().tag_name().name().to_owned();
        let is_error = root == "MTConnectError";
        assert_eq!(is_error, status != 200, "{text}: {status} {answer}");
        *codes.entry(if is_error { code(&answer) } else { root }).or_default() += 1;
    }
    assert!(codes.len() >= 8, "{codes:?}");
}

/// A stream that is read by hand: its documents.
struct Stream(BufReader<TcpStream>);

impl Stream {
    fn open(served: &Served, path: &str) -> Self {
        let mut stream = TcpStream::connect(served.server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
        let host = served.server.address();
        write!(stream, "GET /mtconnect/{path} HTTP/1.0\r\nHost: {host}\r\n\r\n").unwrap();
        let mut reader = BufReader::new(stream);
        let mut line = String::new();
        while line.trim() != "" || line.is_empty() {
            line.clear();
            reader.read_line(&mut line).unwrap();
        }
        Self(reader)
    }

    /// The next document; `None`: the stream has ended.
    fn next(&mut self) -> Option<String> {
        let mut length = None;
        loop {
            let mut line = String::new();
            if self.0.read_line(&mut line).unwrap() == 0 {
                return None;
            }
            if let Some(number) = line.strip_prefix("Content-length: ") {
                length = Some(number.trim().parse().unwrap());
            }
            if let (Some(length), "") = (length, line.trim()) {
                let mut document = vec![0; length];
                self.0.read_exact(&mut document).unwrap();
                return Some(String::from_utf8(document).unwrap());
            }
        }
    }
}

#[test]
fn a_stream_has_every_observation_once_and_beats_where_there_is_none() {
    let served = Served::at_pace(1.0);
    let mut stream = Stream::open(&served, "sample?interval=50&heartbeat=200&count=40");
    let (mut next, mut empty) = (1, 0);
    for number in 0..100 {
        if number == 10 {
            served.accepted(json!({ "request": "power", "on": true }));
        }
        let document = stream.next().unwrap();
        let read = roxmltree::Document::parse(&document).unwrap();
        let found = read.descendants().filter_map(|node| node.attribute("sequence"));
        let mut sequences: Vec<u64> = found.map(|number| number.parse().unwrap()).collect();
        sequences.sort_unstable();
        let count = sequences.len() as u64;
        assert_eq!(sequences, (next..next + count).collect::<Vec<_>>());
        next += count;
        assert_eq!(header(&document, "nextSequence"), next);
        empty += u64::from(count == 0);
        if empty > 2 && number > 12 {
            return;
        }
    }
    panic!("no document without observations in a hundred");
}

#[test]
fn who_reads_too_slowly_loses_its_place_with_the_standards_error() {
    let served = Served::of(How { mtconnect: Some(20), ..How::default() });
    served.power_on();
    let mut stream = Stream::open(&served, "sample?interval=2000");
    assert!(stream.next().unwrap().contains("MTConnectStreams"));
    served.accepted(json!({ "request": "home" }));
    let last = std::iter::from_fn(|| stream.next()).last().unwrap();
    assert_eq!(code(&last), "OUT_OF_RANGE", "{last}");
}

#[test]
fn so_many_streams_are_open_and_one_more_is_refused() {
    let served = Served::at_pace(1.0);
    let mut streams: Vec<_> =
        (0..64).map(|_| Stream::open(&served, "sample?interval=1000")).collect();
    assert!(streams.iter_mut().all(|stream| stream.next().is_some()));
    let (status, answer) = get(&served, "sample?interval=1000");
    assert_eq!((status, code(&answer).as_str()), (503, "INTERNAL_ERROR"), "{answer}");
    drop(streams);
    served.until("a place", |_| {
        let mut stream = Stream::open(&served, "sample?interval=1000");
        stream.next().is_some_and(|document| document.contains("MTConnectStreams"))
    });
}

#[test]
fn tokens_hold_here_too_and_without_an_agent_there_is_none() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tokens.toml");
    let day = Duration::from_hours(24);
    let wall = server::Tokens::add(&path, "wall", server::Role::Viewer, day).unwrap();
    let served = Served::with(1.0, Some(path));
    let (status, answer) = get(&served, "current");
    assert_eq!((status, code(&answer).as_str()), (401, "UNAUTHORIZED"));
    let bearer = format!("Bearer {}", wall.token);
    let with = |name: &str, value: &str| {
        let headers = [("authorization", bearer.as_str()), (name, value)];
        served.raw("GET", "/mtconnect/current", &headers)
    };
    assert_eq!(with("accept", "*/*").0, 200);
    assert_eq!(with("host", "evil.example").0, 403);
    let (_, read) = with("accept", "application/json");
    let read: Value = serde_json::from_str(&read).unwrap();
    let streams = &read["MTConnectStreams"]["Streams"][0]["DeviceStream"]["ComponentStreams"];
    assert_eq!(streams[0]["ComponentStream"]["component"], "Device", "{read}");

    let served = Served::of(How { mtconnect: None, ..How::default() });
    assert_eq!(get(&served, "probe").0, 404);
}
