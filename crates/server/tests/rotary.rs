//! Axes that turn: asked for in degrees, shown in degrees, refused in millimetres.

use crate::common::Served;
use serde_json::{Value, json};

fn axis<'a>(status: &'a Value, letter: &str) -> &'a Value {
    let axes = status["axes"].as_array().unwrap();
    axes.iter().find(|axis| axis["letter"] == letter).unwrap()
}

/// Until nothing moves by hand.
fn at_rest(served: &Served, letter: &str) -> Value {
    let mut before = f64::NAN;
    loop {
        std::thread::sleep(std::time::Duration::from_millis(150));
        let status = served.status();
        let now = axis(&status, letter)["machine"].as_f64().unwrap();
        if now == before {
            return axis(&status, letter).clone();
        }
        before = now;
    }
}

fn close(value: &Value, expected: f64) {
    assert!((value.as_f64().unwrap() - expected).abs() < 0.01, "{value}, expected {expected}");
}

#[test]
fn an_axis_that_turns_is_asked_for_in_degrees() {
    let served = Served::on("mill-5-axis", 8.0);
    served.power_on();
    served.home();
    let start = at_rest(&served, "A");
    assert_eq!(start["unit"], "deg");
    let start = start["machine"].as_f64().unwrap();
    served.accepted(json!({ "request": "jog_increment", "axis": "A", "by_deg": 7.5 }));
    close(&at_rest(&served, "A")["machine"], start + 7.5);
    served.accepted(json!({ "request": "jog_to", "axis": "A", "to_deg": start + 1.0 }));
    close(&at_rest(&served, "A")["machine"], start + 1.0);
    served.accepted(json!({ "request": "touch_off", "axis": "A", "at_deg": 30 }));
    close(&at_rest(&served, "A")["work"], 30.0);
    let zero =
        json!({ "request": "set_work_offset", "work_offset": "G54", "axis": "A", "at_deg": start });
    served.accepted(zero);
    close(&at_rest(&served, "A")["work"], 1.0);
}

#[test]
fn a_value_in_the_unit_of_the_other_kind_is_refused_and_moves_nothing() {
    let served = Served::on("mill-5-axis", 8.0);
    served.power_on();
    served.home();
    let (a, x) = (at_rest(&served, "A"), at_rest(&served, "X"));
    let wrong = [
        (
            json!({ "request": "jog_increment", "axis": "A", "by_mm": 5 }),
            "axis A is rotary: \"by_deg\", not \"by_mm\"",
        ),
        (
            json!({ "request": "jog_continuous", "axis": "X", "deg_per_min": 60 }),
            "axis X is linear: \"mm_per_min\", not \"deg_per_min\"",
        ),
        (
            json!({ "request": "handwheel", "axis": "A", "by_deg": 1, "by_mm": 1 }),
            "axis A is rotary: \"by_deg\", not \"by_mm\"",
        ),
        (json!({ "request": "touch_off", "axis": "X" }), "axis X is linear: \"at_mm\" is missing"),
    ];
    for (body, reason) in wrong {
        let (status, answer) = served.request(&body);
        assert_eq!((status, &answer["reason"]), (422, &json!(reason)), "{body}");
    }
    assert_eq!(at_rest(&served, "A")["machine"], a["machine"]);
    assert_eq!(at_rest(&served, "X")["machine"], x["machine"]);
}
