//! The history of runs: what is kept of a program that was executed, and how it is found again.

use crate::common::{How, Served};
use serde_json::{Value, json};
use server::{Role, Tokens};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

/// A spot of 3 mm: short, and judged.
const SPOT: &str = "G21 G90 G54\nT1 M6\nG43 H1\nS5000 M3\nG0 X12 Y12 Z30\nG99 G81 Z-3.3 R2 F600\nG80\nG0 Z50\nM5\nM30\n";

/// The list, when it has so many runs: they are written beside the control.
fn runs(served: &Served, query: &str, count: usize) -> Vec<Value> {
    for _ in 0..12_000 {
        let (status, list) = served.get(&format!("/runs{query}"));
        assert_eq!(status, 200, "{list}");
        let runs = list["runs"].as_array().unwrap();
        if runs.len() == count {
            return runs.clone();
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let list = served.get("/runs").1;
    let listed = list["runs"].as_array().unwrap().iter();
    let details = listed.map(|run| served.get(&format!("/runs/{}", run["id"].as_str().unwrap())).1);
    panic!("there are not {count} runs: {:?}", details.collect::<Vec<_>>());
}

#[test]
fn a_program_that_was_executed_is_found_with_report_certificate_and_trace() {
    let state = tempfile::tempdir().unwrap();
    let served = Served::keeping(40.0, state.path(), 9);
    served.power_on();
    served.home();
    served.execute("plate.ngc");
    let run = runs(&served, "", 1).remove(0);
    assert_eq!((&run["program"], &run["verdict"]), (&json!("plate.ngc"), &json!("good")), "{run}");
    assert_eq!((&run["good"], &run["has_ended"]), (&json!(36), &json!(true)), "{run}");
    let id = run["id"].as_str().unwrap();
    let (_, detail) = served.get(&format!("/runs/{id}"));
    assert_eq!(detail["run"], run);
    assert_eq!(detail["features"], served.get("/features").1);
    let (_, certificate) = served.get(&format!("/runs/{id}/certificate"));
    assert_eq!(certificate["count"]["passed"], 36, "{certificate}");
    assert_eq!(certificate["inputs"]["program_sha256"], run["program_sha256"]);
    let (_, report) = served.get(&format!("/runs/{id}/report"));
    let report = report.as_str().unwrap();
    assert!(report.starts_with("<!") && report.contains("plate.ngc"));
    let told = headers(&served, &format!("/runs/{id}/report"));
    assert!(told.contains("script-src 'unsafe-inline'") && told.contains("sandbox"), "{told}");
    assert!(!told.contains("script-src 'self'"), "{told}");

    let signals = "z_control_setpoint_mm,spindle_rpm";
    let (status, trace) = served.get(&format!("/runs/{id}/trace?signals={signals}&columns=50"));
    assert_eq!(status, 200, "{trace}");
    let lasts = trace["to_s"].as_f64().unwrap();
    assert!((lasts - run["cycle_time_s"].as_f64().unwrap()).abs() < 0.1, "{run}");
    let [least, most] = ["least", "most"].map(|end| {
        let values = trace["signals"][1][end].as_array().unwrap();
        assert_eq!(values.len(), 50);
        let values = values.iter().filter_map(Value::as_f64);
        values.fold(0.0, |peak: f64, value| if value.abs() > peak.abs() { value } else { peak })
    });
    // S6000 is the fastest of the program, and a tap turns back
    assert!((5900.0..6300.0).contains(&most), "{most}");
    assert!(least < most, "{least}");
    let (status, answer) = served.get(&format!("/runs/{id}/trace?signals=nothing"));
    assert_eq!(status, 422);
    assert!(answer["reason"].as_str().unwrap().contains("z_control_setpoint_mm"), "{answer}");
}

/// The header of an answer, and its status. A program's record is of this program alone, whatever
/// the one before it has left on the workpiece.
#[test]
fn each_program_that_is_kept_has_its_own_features_and_its_own_verdict() {
    let state = tempfile::tempdir().unwrap();
    let served = Served::keeping(10.0, state.path(), 9);
    served.power_on();
    served.home();
    let at = |x: u32, z: &str| SPOT.replace("X12", &format!("X{x}")).replace("Z-3.3 R2", z);
    let programs = [
        ("good", at(12, "Z-3.3 R2"), 1),
        ("air", at(44, "Z3 R8"), 0),
        ("next", at(76, "Z-3.3 R2"), 1),
    ];
    for (count, (name, text, _)) in (1..).zip(&programs) {
        assert_eq!(served.put(&format!("/programs/{name}.ngc"), text.as_bytes()).0, 200);
        served.execute(&format!("{name}.ngc"));
        runs(&served, "", count);
    }
    for (name, _, good) in programs {
        let run = runs(&served, &format!("?program={name}"), 1).remove(0);
        let verdict = if good == 1 { "good" } else { "failed" };
        assert_eq!((&run["verdict"], &run["good"]), (&json!(verdict), &json!(good)), "{run}");
        let id = run["id"].as_str().unwrap();
        let features = served.get(&format!("/runs/{id}")).1["features"].clone();
        assert_eq!(features.as_array().unwrap().len(), 1, "{features}");
        assert_eq!(features[0]["line"], 6, "{features}");
        let (_, certificate) = served.get(&format!("/runs/{id}/certificate"));
        assert_eq!(certificate["count"]["passed"], good, "{certificate}");
        assert_eq!(certificate["invariants"]["violations"], 0, "{certificate}");
        let (_, trace) = served.get(&format!("/runs/{id}/trace?signals=x_control_setpoint_mm"));
        let lasts = trace["to_s"].as_f64().unwrap();
        assert!((lasts - run["cycle_time_s"].as_f64().unwrap()).abs() < 0.1, "{lasts}: {run}");
    }
}

fn headers(served: &Served, path: &str) -> String {
    let host = served.server.address();
    let mut stream = TcpStream::connect(host).unwrap();
    let line = format!("GET /api/v1{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(line.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
    String::from_utf8(answer[..end].to_vec()).unwrap()
}

#[test]
fn a_report_is_opened_in_a_window_of_its_own_by_the_session_in_its_address() {
    let state = tempfile::tempdir().unwrap();
    let tokens = state.path().join("tokens.toml");
    let token =
        Tokens::add(&tokens, "desk", Role::Operator, Duration::from_hours(1)).unwrap().token;
    let served = Served::of(How {
        pace: 40.0,
        state: Some(state.path().join("state")),
        token_file: Some(tokens),
        ..How::default()
    });
    let opened = json!({ "name": "desk-1", "token": token });
    let (status, session) = served.post("/session", &opened);
    assert_eq!(status, 200, "{session}");
    let session = session["session"].as_str().unwrap();
    // a run that is not there: who asks is looked at before
    let (with, without) = (format!("/runs/17/report?session={session}"), "/runs/17/report");
    assert!(headers(&served, without).starts_with("HTTP/1.1 401"));
    assert!(headers(&served, &with).starts_with("HTTP/1.1 404"));
    let status = format!("/status?session={session}");
    assert!(headers(&served, &status).starts_with("HTTP/1.1 401"));
}

#[test]
fn runs_are_chosen_by_program_verdict_and_time_and_the_oldest_give_way() {
    let state = tempfile::tempdir().unwrap();
    {
        let served = Served::keeping(40.0, state.path(), 2);
        served.power_on();
        served.home();
        for name in ["a.ngc", "b.ngc", "c.ngc"] {
            assert_eq!(served.put(&format!("/programs/{name}"), SPOT.as_bytes()).0, 200);
            served.execute(name);
        }
    }
    // what was recorded is whole when the server has ended, and is there when it begins again
    let served = Served::keeping(1.0, state.path(), 2);
    let names = |runs: &[Value]| -> Vec<String> {
        runs.iter().map(|run| run["program"].as_str().unwrap().to_owned()).collect()
    };
    let all = runs(&served, "", 2);
    assert_eq!(names(&all), ["c.ngc", "b.ngc"], "the latest first");
    assert_eq!(all[0]["program_sha256"], all[1]["program_sha256"]);
    assert_eq!(names(&runs(&served, "?program=B.", 1)), ["b.ngc"]);
    // where a spot is cut again hardly anything resists the tool: its verdict is either of two
    for verdict in ["good", "failed", "not_judged"] {
        let so: Vec<_> = all.iter().filter(|run| run["verdict"] == verdict).cloned().collect();
        assert_eq!(runs(&served, &format!("?verdict={verdict}"), so.len()), so);
    }
    let ended = all[0]["ended_unix_ms"].as_u64().unwrap();
    assert_eq!(names(&runs(&served, &format!("?from_unix_ms={ended}"), 1)), ["c.ngc"]);
    assert_eq!(names(&runs(&served, &format!("?to_unix_ms={ended}"), 1)), ["b.ngc"]);
    for wrong in ["..", "%2e%2e", "..%2f..%2fetc", "1", "123456789012345678901234567890"] {
        let (status, _) = served.get(&format!("/runs/{wrong}/report"));
        assert_eq!(status, 404, "{wrong}");
    }
    assert_eq!(served.get("/runs?colour=red").0, 400);
}

/// Sentences that the control has said.
fn notices(served: &Served) -> Vec<String> {
    let events = served.get("/events").1;
    let notices = events["events"].as_array().unwrap().iter();
    let notices = notices.filter(|event| event["event"] == "notice");
    notices.map(|notice| notice["text"].as_str().unwrap().to_owned()).collect()
}

/// A notice with these words comes.
fn notice(served: &Served, words: [&str; 3]) {
    for _ in 0..2000 {
        let has_all = |text: &String| words.iter().all(|word| text.contains(word));
        if notices(served).iter().any(has_all) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("{words:?} is not among {:?}", notices(served));
}

/// A server whose control is ready and that has the spot as a program.
fn ready(state: &Path) -> Served {
    let served = Served::keeping(10.0, state, 9);
    served.power_on();
    served.home();
    assert_eq!(served.put("/programs/spot.ngc", SPOT.as_bytes()).0, 200);
    served
}

/// A device that takes nothing stands where the report is to be written: the same error as that of
/// a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_run_for_which_the_disk_has_no_space_is_said_and_the_next_one_is_kept() {
    let state = tempfile::tempdir().unwrap();
    let served = ready(state.path());
    served.accepted(json!({ "request": "load", "program": "spot.ngc" }));
    served.accepted(json!({ "request": "start" }));
    let folders = std::fs::read_dir(state.path().join("runs")).unwrap();
    let folders: Vec<_> = folders.map(|entry| entry.unwrap().path()).collect();
    let [folder] = &folders[..] else { panic!("one run is being written: {folders:?}") };
    std::os::unix::fs::symlink("/dev/full", folder.join("report.html")).unwrap();
    served.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");
    notice(&served, ["the run of spot.ngc is not kept", "report.html", "the disk is full"]);
    assert!(!folder.exists(), "what is not whole is gone");
    served.execute("spot.ngc");
    assert_eq!(runs(&served, "", 1)[0]["program"], "spot.ngc");
}

/// Each of these would wait for another program: for ever, and the one thread that writes with it.
#[cfg(unix)]
#[test]
fn named_pipes_among_programs_and_state_are_refused_or_said_and_hold_up_nothing() {
    let state = tempfile::tempdir().unwrap();
    let served = ready(state.path());
    let programs = served.folder.path();
    for pipe in [
        programs.join("pipe.ngc"),
        programs.join("sub.ngc"),
        state.path().join("messages.jsonl"),
        state.path().join("features.jsonl"),
    ] {
        assert!(std::process::Command::new("mkfifo").arg(pipe).status().unwrap().success());
    }
    for query in ["", "?replace=true"] {
        let (status, answer) = served.put(&format!("/programs/pipe.ngc{query}"), b"M2\n");
        assert_eq!(status, 422, "{answer}");
        assert!(answer["reason"].as_str().unwrap().contains("named pipe"), "{answer}");
    }
    assert_eq!(served.get("/programs/pipe.ngc").0, 404);
    assert_eq!(served.get("/programs/pipe.ngc?before=true").0, 404);
    assert_eq!(served.request(&json!({ "request": "load", "program": "pipe.ngc" })).0, 422);
    let said = format!("(MSG, clamp it)\n{SPOT}");
    assert_eq!(served.put("/programs/said.ngc", said.as_bytes()).0, 200);
    assert_eq!(served.put("/programs/calls.ngc", b"o<sub> call\nM2\n").0, 200);
    assert_eq!(served.request(&json!({ "request": "load", "program": "calls.ngc" })).0, 422);
    let listed = served.get("/programs").1;
    let listed = listed.to_string();
    assert!(listed.contains("calls.ngc") && !listed.contains("pipe.ngc"), "{listed}");
    served.execute("said.ngc");
    notice(&served, ["a message is not kept", "messages.jsonl", "named pipe"]);
    notice(&served, ["a feature is not in the log", "features.jsonl", "named pipe"]);
    served.accepted(json!({ "request": "feed_override", "percent": 50 }));
    let kept = std::fs::read_to_string(state.path().join("settings.toml")).unwrap();
    assert!(kept.contains("feed_override = 0.5"), "{kept}");
    runs(&served, "", 1);
}

#[test]
fn a_program_runs_where_the_folder_of_runs_cannot_be_written_and_that_is_said() {
    let state = tempfile::tempdir().unwrap();
    let served = ready(state.path());
    let folder = state.path().join("runs");
    std::fs::remove_dir(&folder).unwrap();
    std::fs::write(&folder, "a file in its place").unwrap();
    served.execute("spot.ngc");
    notice(&served, ["this run is not recorded", "cannot create the folder", "runs"]);
    assert_eq!(served.status()["alarms"], json!([]));
    runs(&served, "", 0);
    let said = notices(&served);
    let of_the_server = state.path().display().to_string();
    assert!(!said.iter().any(|text| text.contains(&of_the_server)), "{said:?}");
}
