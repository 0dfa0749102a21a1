//! What a client of the API may rely on: a real server, a real client, a machine that is simulated.

use crate::common::{Served, machine};
use serde_json::json;
use std::time::Duration;

const DAY: Duration = Duration::from_hours(24);

#[test]
fn a_morning_in_the_shop_is_led_by_requests() {
    let served = Served::at_pace(40.0);
    let (status, answer) = served.request(&json!({ "request": "start" }));
    assert_eq!(status, 409, "{answer}");
    assert_eq!(answer["reason"], "no program is loaded");
    assert_eq!(answer["remedy"], "load one first");
    let (status, answer) = served.request(&json!({ "request": "home" }));
    assert_eq!((status, &answer["reason"]), (409, &json!("the drives are not on")), "{answer}");
    served.power_on();
    served.home();
    served.accepted(json!({ "request": "jog_increment", "axis": "x", "by_mm": -10 }));
    served.until("X at -10", |status| (machine(status, "X") + 10.0).abs() < 1e-6);

    let loaded = served.accepted(json!({ "request": "load", "program": "plate.ngc" }));
    assert!(loaded["notes"][0].as_str().unwrap().starts_with("plate.ngc: "), "{loaded}");
    let (_, program) = served.get("/program");
    assert_eq!(program["name"], "plate.ngc");
    let taps = program["holes"].as_array().unwrap().iter().filter(|hole| hole["kind"] == "tap");
    let first = taps.clone().next().unwrap();
    assert_eq!(taps.count(), 12);
    // G99 G84 X12 Y12 Z-20 R5 of the program
    assert_eq!((&first["at"], &first["bottom"]), (&json!([12.0, 12.0, 5.0]), &json!(-20.0)));

    served.accepted(json!({ "request": "start" }));
    served.until("a line", |status| status["program"]["line"].as_u64() > Some(10));
    let turns = served.until("it turns", |status| {
        let spindle = &status["spindles"][0];
        let (ordered, measured) = (&spindle["ordered_rpm"], &spindle["measured_rpm"]);
        let (ordered, measured) = (ordered.as_f64().unwrap(), measured.as_f64().unwrap());
        ordered > 1000.0 && (measured / ordered - 1.0).abs() < 0.02
    });
    assert!(turns["spindles"][0]["load_percent"].as_f64().unwrap() > 0.0, "{turns}");
    assert!(turns["axes"][0]["to_go"].is_number() || turns["axes"][0]["to_go"].is_null());
    served.accepted(json!({ "request": "feed_hold" }));
    let held = served.until("a hold", |status| status["execution"] == "FEED_HOLD");
    assert_eq!(held["program"]["name"], "plate.ngc");
    assert!(held["codes"].as_array().unwrap().contains(&json!("G21")), "{held}");
    let left = held["program"]["left_s"].as_f64().unwrap();
    assert!(left > 1.0 && left < held["program"]["planned_s"].as_f64().unwrap(), "{held}");
    // what stands in the way of a second start is what a client is told
    let unmet = held["unmet"].as_array().unwrap();
    let under_way = unmet.iter().find(|unmet| unmet["need"] == "no_program_under_way").unwrap();
    assert_eq!(served.request(&json!({ "request": "start" })).1["reason"], under_way["reason"]);
    served.accepted(json!({ "request": "resume" }));
    served.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");

    let (_, features) = served.get("/features");
    let features = features.as_array().unwrap();
    assert_eq!(features.len(), 36, "12 spots, 12 holes, 12 threads");
    assert!(features.iter().all(|feature| feature["verdict"] == "good"), "{features:?}");
    let thread = features.iter().find(|feature| feature["kind"] == "thread").unwrap();
    assert_eq!(thread["size"], "M6x1");
    assert!(thread["sync_error_max_um"].as_f64().unwrap() > 0.0, "{thread}");
    let (_, events) = served.get("/events?after=0");
    let happened = events["events"].as_array().unwrap();
    let is_held = |event: &&serde_json::Value| event["execution"] == "FEED_HOLD";
    assert_eq!(happened.iter().filter(is_held).count(), 1, "{events}");
    assert_eq!(happened.iter().filter(|event| event["event"] == "feature").count(), 36);
    let (_, none) = served.get(&format!("/events?after={}", events["last"]));
    assert_eq!(none["events"], json!([]));
}

#[test]
fn what_is_out_of_range_is_refused_with_the_range_that_works() {
    let served = Served::at_pace(1.0);
    let range = |body, expected: &str| {
        let (status, answer) = served.request(&body);
        assert_eq!(status, 422, "{body}: {answer}");
        let reason = answer["reason"].as_str().unwrap();
        assert!(reason.contains(expected), "{body}: {reason}");
    };
    range(json!({ "request": "feed_override", "percent": 900 }), "from 0 to ");
    range(json!({ "request": "spindle_override", "percent": 1 }), "from 50 to ");
    range(
        json!({ "request": "set_work_offset", "work_offset": "G60", "axis": "X", "at_mm": 0 }),
        "G59.3",
    );
}

#[test]
fn a_jog_ends_with_its_lease_when_its_client_is_gone() {
    let served = Served::at_pace(1.0);
    served.power_on();
    let mut socket = served.socket("");
    let start = machine(&socket.next("status")["status"], "X");
    let jog = json!({ "request": "jog_continuous", "axis": "X", "mm_per_min": -300 });
    for id in 0..5 {
        socket.send(&json!({ "type": "request", "id": id, "request": jog }));
        let answer = socket.next("answer");
        assert_eq!((&answer["id"], &answer["accepted"]), (&json!(id), &json!(true)), "{answer}");
        std::thread::sleep(Duration::from_millis(80));
    }
    drop(socket);
    let gone = machine(&served.status(), "X");
    assert!(gone < start - 0.5, "it moves: from {start} to {gone}");
    std::thread::sleep(Duration::from_millis(600));
    let rests = machine(&served.status(), "X");
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(machine(&served.status(), "X"), rests, "it moves on without a client");
    // 5 mm/s for the 200 ms of the lease, the pictures' 20 ms twice, and what it brakes
    assert!(gone - rests < 1.6, "from {gone} to {rests}");
}

#[test]
fn the_socket_tells_all_once_and_then_what_changes() {
    let served = Served::at_pace(1.0);
    let mut socket = served.socket("");
    let first = socket.next("status");
    assert_eq!(first["seq"], 1);
    let names = first["status"].as_object().unwrap().len();
    for seq in 2..6 {
        let delta = socket.next("delta");
        assert_eq!(delta["seq"], seq);
        let changed = delta["status"].as_object().unwrap();
        assert!(changed.contains_key("time_s") && changed.len() < names, "{delta}");
    }
    served.accepted(json!({ "request": "power", "on": true }));
    let event = socket.next("event");
    assert!(event["id"].as_u64() > Some(0), "{event}");
}

#[test]
fn a_scope_has_every_period_of_its_signals() {
    let served = Served::at_pace(1.0);
    served.power_on();
    let mut socket = served.socket("");
    socket.send(&json!({ "type": "scope", "signals": ["X.setpoint_mm", "spindle0.angle_deg"] }));
    socket.next_frame(); // the scope is under way
    served.accepted(json!({ "request": "jog_increment", "axis": "X", "by_mm": -1 }));
    let (mut seen, mut next): (Vec<f32>, Option<f64>) = (Vec::new(), None);
    while seen.len() < 4000 {
        let (header, columns) = socket.next_frame();
        assert_eq!(columns.len(), 2);
        assert_eq!(header["lost_rows"], 0);
        let start = header["start_s"].as_f64().unwrap();
        let period = header["period_s"].as_f64().unwrap();
        assert!(next.is_none_or(|next| (next - start).abs() < period / 2.0), "{next:?}, {start}");
        next = Some(start + period * columns[0].len() as f64);
        seen.extend(&columns[0]);
    }
    let most = seen.iter().fold(f32::MIN, |most, x| most.max(*x));
    let least = seen.iter().fold(f32::MAX, |least, x| least.min(*x));
    assert!((most - least - 1.0).abs() < 1e-3, "it goes 1 mm: from {most} to {least}");
    socket.send(&json!({ "type": "scope", "signals": ["no such"] }));
    assert!(socket.next("answer")["reason"].as_str().unwrap().contains("no such"));
}

#[test]
fn another_session_is_refused_until_it_is_given_the_right_but_may_stop() {
    let served = Served::at_pace(1.0);
    let open = |name| served.post("/session", &json!({ "name": name })).1;
    let (desk, tablet) = (open("desk-1"), open("tablet"));
    let of = |session: &serde_json::Value| session["session"].as_str().unwrap().to_owned();
    let (desk_id, tablet_id) = (of(&desk), of(&tablet));
    let ask = |id: &str, path: &str, body: serde_json::Value| {
        let headers = [("x-leadscrew-session", id)];
        served.post_with(path, body.to_string().as_bytes(), &headers)
    };
    let single = json!({ "request": "single_block", "on": true });
    assert_eq!(ask(&desk_id, "/request", single.clone()).0, 200);
    let (status, answer) = ask(&tablet_id, "/request", single.clone());
    assert_eq!(status, 409);
    assert_eq!(answer["reason"], "desk-1 commands the machine");
    assert_eq!(ask(&tablet_id, "/request", json!({ "request": "jog_stop" })).0, 200);
    let press = json!({ "request": "emergency_stop", "on": true });
    assert_eq!(ask(&tablet_id, "/request", press).0, 200);
    let mut socket = served.socket(&format!("?session={desk_id}"));
    assert_eq!(socket.next("operator")["holder"], "desk-1");
    assert_eq!(ask(&tablet_id, "/operator", json!({ "do": "ask" })).1["asked_by"], "tablet");
    assert_eq!(socket.next("operator")["asked_by"], "tablet");
    assert_eq!(ask(&tablet_id, "/operator", json!({ "do": "grant" })).0, 409, "not its to grant");
    assert_eq!(ask(&desk_id, "/operator", json!({ "do": "grant" })).1["holder"], "tablet");
    assert_eq!(ask(&tablet_id, "/request", single).0, 200);
    assert_eq!(ask("0123", "/request", json!({ "request": "stop" })).0, 401, "an unknown session");
}

#[test]
fn programs_are_listed_read_and_written_in_their_folder_alone() {
    let served = Served::at_pace(1.0);
    assert_eq!(served.put("/programs/new.ngc", b"G0 X1\nM30\n").0, 200);
    assert_eq!(served.get("/programs/new.ngc").1, json!("G0 X1\nM30\n"));
    let (status, answer) = served.post_with("/programs/new.ngc", b"M30\n", &[]);
    assert_eq!(status, 409, "{answer}");
    let (_, list) = served.get("/programs");
    let paths: Vec<_> = list["programs"].as_array().unwrap().iter().map(|p| &p["path"]).collect();
    assert_eq!(paths, ["new.ngc", "plate.ngc"]);
    std::fs::write(served.folder.path().join("../secret.ngc"), "M30\n").ok();
    for path in
        ["..%2fsecret.ngc", "%2fetc%2fpasswd", "a%2f..%2f..%2fsecret.ngc", "%2e%2e%2fsecret.ngc"]
    {
        let (status, answer) = served.get(&format!("/programs/{path}"));
        assert_eq!(status, 422, "{path}: {answer}");
        assert_eq!(served.put(&format!("/programs/{path}"), b"M30\n").0, 422, "{path}");
    }
    let load = json!({ "request": "load", "program": "../secret.ngc" });
    assert_eq!(served.request(&load).0, 422);
    assert_eq!(served.get("/programs/none.ngc").0, 404);
    let (status, answer) = served.put("/programs/large.ngc", &vec![b' '; (16 << 20) + 1]);
    assert_eq!(status, 413, "{answer}");
}

#[test]
fn a_program_is_replaced_by_who_says_which_and_never_by_nothing() {
    let served = Served::at_pace(1.0);
    let put = |path: &str, headers: &[(&str, &str)], body: &[u8]| {
        served.put_with(&format!("/programs/{path}"), body, headers)
    };
    let text = || served.get("/programs/plate.ngc").1;
    let whole = text();
    for method in ["PUT", "POST"] {
        for path in ["plate.ngc", "new.ngc"] {
            let path = format!("/api/v1/programs/{path}?replace=true");
            let (status, answer) = served.raw(method, &path, &[]);
            assert!(matches!(status, 400 | 422), "{method} {path}: {status} {answer}");
        }
    }
    for nothing in ["\u{feff}", "\u{feff}\r\n", " \t\n", "\u{a0}", "\u{1a}"] {
        for path in ["/programs/plate.ngc?replace=true", "/programs/new.ngc"] {
            let body = nothing.as_bytes();
            for (status, answer) in
                [served.put_with(path, body, &[]), served.post_with(path, body, &[])]
            {
                assert_eq!(status, 422, "{path} {nothing:?}: {answer}");
                let reason = answer["reason"].as_str().unwrap();
                assert!(reason.contains("it is empty"), "{path} {nothing:?}: {reason}");
            }
        }
    }
    assert_eq!(text(), whole, "it is as it was");
    assert_eq!(served.get("/programs/new.ngc").0, 404);
    let (status, answer) = put("plate.ngc", &[], b"M30\n");
    assert_eq!(status, 409, "{answer}");
    assert!(answer["remedy"].as_str().unwrap().contains("If-Match"), "{answer}");
    assert_eq!(put("plate.ngc", &[("if-match", "\"0123\"")], b"M30\n").0, 409);
    assert_eq!(put("none.ngc", &[("if-match", "\"0123\"")], b"M30\n").0, 409);
    assert_eq!(put("plate.ngc?replace=true", &[("content-range", "bytes 0-3/9")], b"M30\n").0, 400);
    assert_eq!(text(), whole, "it is as it was");
    let (status, first) = put("plate.ngc", &[("if-match", "*")], b"G0 X1\nM30\n");
    assert_eq!(status, 200, "{first}");
    assert_eq!(served.get("/programs/plate.ngc?before=true").1, whole);
    let known = format!("\"{}\"", first["version"].as_str().unwrap());
    assert_eq!(put("plate.ngc", &[("if-match", &known)], b"G0 X2\nM30\n").0, 200);
    assert_eq!(put("plate.ngc", &[("if-match", &known)], b"G0 X3\nM30\n").0, 409, "it is another");
    assert_eq!(text(), "G0 X2\nM30\n");
    assert_eq!(served.get("/programs").1["programs"].as_array().unwrap().len(), 1);
}

/// Of every address that is served and every method that it does not take.
#[test]
fn a_method_that_an_address_does_not_take_is_answered_with_those_that_it_takes() {
    let served = Served::at_pace(1.0);
    let mut refused = 0;
    for address in server::addresses() {
        let path = address.path.replace("{*path}", "plate.ngc").replace("{id}", "1");
        for method in ["GET", "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "LINK"] {
            let (status, answer) = served.raw(method, &path, &[]);
            if status != 405 || path.starts_with("/mtconnect") {
                continue;
            }
            refused += 1;
            let answer: serde_json::Value = serde_json::from_str(&answer)
                .unwrap_or_else(|why| panic!("{method} {path}: {why}: {answer:?}"));
            let reason = answer["reason"].as_str().unwrap();
            assert!(reason.contains(method), "{method} {path}: {reason}");
            let taken = address.method.to_uppercase();
            assert!(taken == "ANY" || reason.contains(&taken), "{method} {path}: {reason}");
            assert_eq!(answer["accepted"], false, "{method} {path}: {answer}");
        }
    }
    assert!(refused > 100, "{refused}");
    let (_, answer) = served.raw("PATCH", "/api/v1/programs/plate.ngc", &[]);
    let reason = "PATCH is no method of this address: it takes GET, HEAD, POST and PUT";
    assert!(answer.contains(reason), "{answer}");
}

#[test]
fn a_number_that_no_machine_has_is_refused_and_leaves_no_trace() {
    let state = tempfile::tempdir().unwrap();
    let served = Served::keeping(1.0, state.path(), 1);
    let before = served.get("/offsets").1;
    for request in [
        r#"{"request":"set_work_offset","work_offset":"G54","axis":"X","at_mm":1e300}"#,
        r#"{"request":"set_work_offset","work_offset":"G55","axis":"Z","at_mm":-1e9}"#,
        r#"{"request":"touch_off","axis":"Y","at_mm":1e9}"#,
        r#"{"request":"jog_increment","axis":"X","by_mm":1e6}"#,
        r#"{"request":"jog_to","axis":"X","to_mm":1e6}"#,
        r#"{"request":"jog_continuous","axis":"X","mm_per_min":1e9}"#,
        r#"{"request":"handwheel","axis":"X","by_mm":-1e6}"#,
        r#"{"request":"turn_spindle","spindle":0,"rpm":1e9}"#,
        r#"{"request":"orient_spindle","spindle":0,"angle_deg":1e9}"#,
        r#"{"request":"block_skip","level":200,"on":true}"#,
        r#"{"request":"search","line":0}"#,
        r#"{"request":"limit_tool","tool":1,"uses":0}"#,
        r#"{"request":"edit_tool","tool":1,"field":"length","value_mm":1e9}"#,
        r#"{"request":"feed_override","percent":-1}"#,
    ] {
        let (status, answer) = served.post_with("/request", request.as_bytes(), &[]);
        assert_eq!(status, 422, "{request}: {answer}");
        let reason = answer["reason"].as_str().unwrap();
        assert!(reason.contains("from") && reason.contains("found"), "{request}: {reason}");
    }
    assert_eq!(served.get("/offsets").1, before);
}

#[test]
fn a_program_that_is_refused_says_where_and_why() {
    let served = Served::at_pace(1.0);
    assert_eq!(served.put("/programs/bad.ngc", b"G21 G90\nG1 X10\nM30\n").0, 200);
    let (status, answer) = served.request(&json!({ "request": "load", "program": "bad.ngc" }));
    assert_eq!(status, 422, "{answer}");
    let finding = &answer["findings"][0];
    assert_eq!((&finding["line"], &finding["severity"]), (&json!(2), &json!("error")), "{answer}");
    assert!(!answer["reason"].as_str().unwrap().contains("/tmp"), "{answer}");
}

#[test]
fn a_program_for_another_dialect_is_loaded_as_one_where_that_is_asked() {
    let served = Served::at_pace(1.0);
    let text = b"O1000\n#1=5.\nIF[#1GT4]GOTO20\nG0 X999.\nN20 M30\n";
    assert_eq!(served.put("/programs/macro.nc", text).0, 200);
    let load = |dialect: &str| {
        let request = json!({ "request": "load", "program": "macro.nc", "dialect": dialect });
        served.request(&request)
    };
    let (status, answer) = served.request(&json!({ "request": "load", "program": "macro.nc" }));
    assert_eq!(status, 422, "as the machine reads it: {answer}");
    let (status, answer) = load("fanuc");
    assert_eq!(status, 200, "{answer}");
    let (status, answer) = load("esperanto");
    assert_eq!(status, 422, "{answer}");
    assert!(answer["reason"].as_str().unwrap().contains("linuxcnc"), "{answer}");
}

#[test]
fn a_page_from_elsewhere_and_a_server_of_another_name_are_refused() {
    let served = Served::at_pace(1.0);
    let body = json!({ "request": "power", "on": true }).to_string();
    let post = |headers: &[(&str, &str)]| served.post_with("/request", body.as_bytes(), headers).0;
    assert_eq!(post(&[("origin", "http://evil.example")]), 403);
    assert_eq!(post(&[("origin", "null")]), 403);
    assert_eq!(post(&[("host", "evil.example:8383")]), 403);
    assert_eq!(served.get_with("/status", &[("host", "evil.example")]).0, 403);
    assert_eq!(served.status()["power"], "OFF");
    let own = format!("http://{}", served.server.address());
    assert_eq!(post(&[("origin", &own)]), 200);
    let forged =
        [("origin", "http://evil.example"), ("connection", "upgrade"), ("upgrade", "websocket")];
    assert_eq!(served.get_with("/ws", &forged).0, 403);
}

#[test]
fn with_a_file_of_tokens_only_who_has_one_is_answered_and_a_viewer_commands_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tokens.toml");
    let desk = server::Tokens::add(&path, "desk-1", server::Role::Operator, DAY).unwrap();
    let wall = server::Tokens::add(&path, "wall", server::Role::Viewer, DAY).unwrap();
    let served = Served::with(1.0, Some(path));
    assert_eq!(served.get("/status").0, 401);
    let bearer = |token: &str| format!("Bearer {token}");
    let (desk, wall) = (bearer(&desk.token), bearer(&wall.token));
    assert_eq!(served.get_with("/status", &[("authorization", "Bearer x")]).0, 401);
    assert_eq!(served.get_with("/status", &[("authorization", &wall)]).0, 200);
    let body = json!({ "request": "power", "on": true }).to_string();
    let post =
        |token: &str| served.post_with("/request", body.as_bytes(), &[("authorization", token)]).0;
    assert_eq!(post(&wall), 403);
    assert_eq!(post(&desk), 200);
    assert_eq!(served.post("/session", &json!({ "name": "desk-2" })).0, 401);
}
