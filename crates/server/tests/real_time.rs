//! A control that is served while a servo thread of its own keeps the time: led and seen as any
//! other.

use crate::common::{How, Served, machine};
use control::RealTimeOptions;
use serde_json::json;

#[test]
fn a_control_in_real_time_is_led_and_says_how_well_it_keeps_its_time() {
    let how = How { real_time: Some(RealTimeOptions::default()), ..How::default() };
    let served = Served::of(how);
    served.power_on();
    let before = machine(&served.status(), "X");
    let mut socket = served.socket("");
    socket.next("status");
    let (status, answer) =
        served.post("/request", &json!({ "request": "jog_increment", "axis": "X", "by_mm": -3.0 }));
    assert_eq!(status, 200, "{answer}");
    let moved =
        served.until("X has moved", |status| (machine(status, "X") - (before - 3.0)).abs() < 0.01);
    let figures = &moved["real_time"];
    let periods = figures["periods"].as_u64().unwrap();
    assert!(periods > 100, "{figures}");
    assert!(figures["tick_median_us"].as_f64().unwrap() > 0.0, "{figures}");
    // the clock of the machine is that on the wall: a period is 250 µs, whatever was late
    let seconds = moved["time_s"].as_f64().unwrap();
    assert!((seconds - periods as f64 * 250e-6).abs() < 1.0, "{seconds} s, {periods} periods");
    assert!(socket.next("delta")["seq"].as_u64().unwrap() > 0);
}
