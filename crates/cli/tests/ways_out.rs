//! Tools that are tied to a spindle and not screwed to the work: threads, cams and polygons that
//! are stopped in the middle, and the way off the work. Over processes, as a user has it.
use crate::common::{complained, leadscrew, root, said};
use crate::simulator;
use crate::simulator::{Simulator, Stop, number};
use serde_json::Value;
use test_support::size;

fn program(name: &str) -> String {
    std::fs::read_to_string(root().join("programs").join(name)).unwrap()
}

/// Stopped, then held to what is promised; the answer of the recovery.
fn stopped(text: &str, machine: &[&str], stop: Stop, cut: &str) -> (Simulator, Value) {
    let simulator = Simulator::stopping(stop, &["--machine", machine[1]]);
    let output = simulator.run(text, machine);
    assert_ne!(output.status.code(), Some(0), "nothing stopped it: {stop:?}");
    let again = simulator.run(text, machine);
    let why = complained(&again);
    assert_eq!(again.status.code(), Some(2), "{why}");
    assert!(why.contains(cut) && why.contains("nothing but recovery may move"), "{why}");
    assert!(why.contains(&format!("--machine {}", machine[1])), "{why}");
    let before = simulator.status();
    let rehearsed = simulator.recover(&["--machine", machine[1], "--dry-run"]);
    assert_eq!(rehearsed["outcome"], "recovered", "{rehearsed:#}");
    assert!((number(&before, "z_mm") - number(&simulator.status(), "z_mm")).abs() < 0.01);
    let answer = simulator.recover(&["--machine", machine[1]]);
    assert_eq!(answer["outcome"], "recovered", "{answer:#}");
    assert_eq!(answer["cut"], cut, "{answer:#}");
    let twice = simulator.recover(&["--machine", machine[1]]);
    assert_eq!(twice["outcome"], "nothing-to-do", "{twice:#}");
    (simulator, answer)
}

#[test]
fn a_threading_pass_is_left_along_x_and_turned_again_after_a_kill_or_a_power_cut() {
    let (text, machine) = (program("thread-m20x1.5.ngc"), ["--machine", "lathe"]);
    let stops = [Stop::Kill(3.3), Stop::PowerCut(3.8), Stop::Kill(3.8), Stop::PowerCut(3.3)];
    for (which, &stop) in size::first_of(2, &stops).iter().enumerate() {
        let (simulator, answer) = stopped(&text, &machine, stop, "threading pass");
        // a pass stood 1 mm and the thread's depth off its cut before
        assert!((number(&answer, "retreat_mm") - 1.985).abs() < 0.05, "{answer:#}");
        // drives that stop on the thread leave the tool on it
        assert!(number(&answer, "phase_error_before_um").abs() < 30.0, "{stop:?}: {answer:#}");
        // X first, then spindle and Z together along the thread
        assert!(number(&answer, "helix_error_max_um") < 5.0, "{answer:#}");
        assert!(answer["note"].is_null(), "{answer:#}");
        if which > 0 && !size::is_full() {
            continue; // the sixteen passes were turned again behind the first stop
        }
        let line = answer["line"].to_string();
        let again = simulator.run(&text, &["--machine", "lathe", "--from", &line]);
        let certificate = said(&again);
        assert_eq!(again.status.code(), Some(0), "{certificate}{}", complained(&again));
    }
}

#[test]
fn a_thread_whose_lead_grows_is_left_along_x_and_its_axis_goes_back_by_itself() {
    let text = program("feed-screw.nc");
    let machine = ["--machine", "lathe", "--dialect", "fanuc-lathe-a"];
    for stop in [Stop::Kill(3.0), Stop::PowerCut(3.0)] {
        let (simulator, answer) = stopped(&text, &machine, stop, "threading pass");
        // from X9.7, by a diameter of 0.6 less each pass, to X13
        assert!((number(&answer, "retreat_mm") - 3.3).abs() < 0.05, "{stop:?}: {answer:#}");
        // a drive that brakes along the tangent for part of a turn is off by 0.1·n²
        assert!(number(&answer, "phase_error_before_um").abs() < 50.0, "{stop:?}: {answer:#}");
        assert!(answer["moved_first"].as_str().unwrap().contains("Z back by itself"), "{answer:#}");
        assert!(
            (number(&simulator.status(), "z_mm") - -281.0).abs() < 0.05,
            "{:#}",
            simulator.status()
        );
        assert!(answer["note"].is_null(), "{answer:#}");
    }
}

#[test]
fn a_gear_is_left_along_x_and_it_is_said_how_far_the_work_was_off_its_hob() {
    let (text, machine) = (program("gear-m2-z40.nc"), ["--machine", "gear-hobber"]);
    for &stop in size::first_of(1, &[Stop::PowerCut(60.0), Stop::Kill(60.0)]) {
        let (_, answer) = stopped(&text, &machine, stop, "hobbing");
        assert!((number(&answer, "retreat_mm") - (110.0 - 75.067)).abs() < 0.1, "{answer:#}");
        // the drives brake by themselves: the work is off by less than half a tooth's pitch, and by
        // something
        let off = number(&answer, "phase_error_before_um").abs();
        assert!(off > 0.01 && off < 1e3 * 2.0 * std::f64::consts::PI / 2.0, "{answer:#}");
        // 2·40/cos 20° of pitch diameter
        let radius_um = 40e3 / 20_f64.to_radians().cos();
        let degrees = number(&answer, "phase_error_before_deg").abs();
        assert!((degrees.to_radians() * radius_um - off).abs() < 1e-6 * off, "{answer:#}");
    }
}

#[test]
fn a_polygon_and_a_cam_are_left_along_x() {
    let hexagon = program("hexagon-af17.nc");
    let machine = ["--machine", "polygon-lathe"];
    let (_, answer) = stopped(&hexagon, &machine, Stop::PowerCut(12.0), "polygon turning");
    assert!((number(&answer, "retreat_mm") - 16.5).abs() < 1.0, "{answer:#}");
    // each brakes by itself, with 0.95 of its torque: J·ω²/2M is 0.72 rad of the work, twice that
    // on the gear, and 0.87 rad of the cutter, which stands 33° behind; friction and the loops add
    // to it
    let behind = number(&answer, "phase_error_before_deg");
    assert!((-50.0..-33.0).contains(&behind), "{answer:#}");
    let cams = root().join("programs/cams.toml");
    let machine =
        ["--machine", "cam-grinder", "--dialect", "toyoda", "--cams", cams.to_str().unwrap()];
    let (_, answer) = stopped(&program("cam-shaft.nc"), &machine, Stop::Kill(9.0), "cam grinding");
    assert!(number(&answer, "retreat_mm") > 5.0, "{answer:#}");
    assert!(answer["phase_error_before_um"].is_null(), "{answer:#}");
    assert!(answer["phase_error_unknown"].as_str().unwrap().contains("infeed"), "{answer:#}");
    let go_on = answer["continue_with"].as_str().unwrap();
    let words = ["--dialect toyoda", "--cams ", "--machine cam-grinder", "--tools ", "--from "];
    assert!(words.iter().all(|word| go_on.matches(word).count() == 1), "{go_on}");
}

#[test]
fn a_hold_in_a_thread_takes_the_tool_off_it_and_the_thread_is_good_in_the_end() {
    let file = root().join("programs/thread-m20x1.5.ngc");
    let hold = ["--operator", "hold at 3.6s; resume at 5s"];
    let run = ["run", file.to_str().unwrap(), "--machine", "lathe", "-q", "--format", "json"];
    let output = leadscrew(&[&run[..], &hold].concat());
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    let certificate: Value = serde_json::from_slice(&output.stdout).unwrap();
    let thread = &certificate["features"][0];
    assert!(number(thread, "sync_error_max_um") < 10.0, "{thread:#}");
}

#[test]
fn encoders_that_lie_and_spindles_that_fail_in_a_tap_are_recovered_within_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tap.ngc");
    std::fs::write(&file, simulator::one_tap("G84", 11)).unwrap();
    let tools = root().join("programs/tools.toml");
    for fault in [
        "encoder-slip 5deg at depth 3mm",
        "encoder-slip 1deg at depth 8mm",
        "torque-loss 50 at depth 2mm",
        "dropout 5ms at depth 12mm",
        "drive-fault spindle at depth 8mm",
    ] {
        let (file, tools) = (file.to_str().unwrap(), tools.to_str().unwrap());
        let run = ["run", file, "--tools", tools, "-q", "--fault", fault, "--recover"];
        let output = leadscrew(&run);
        let text = said(&output) + &complained(&output);
        assert!(text.contains("THE TAP IS OUT"), "{fault}: {text}");
        // a spindle with half its torque does not turn round at the bottom: that thread is spoilt
        // before anything stops
        let spoilt = fault.starts_with("torque-loss");
        assert!(spoilt || !text.contains("No-go gauge"), "{fault}: {text}");
    }
}

#[test]
fn encoders_that_lie_and_drives_that_are_gone_in_a_thread_leave_no_mark_in_it() {
    let file = root().join("programs/thread-m20x1.5.ngc");
    let run = ["run", file.to_str().unwrap(), "--machine", "lathe", "-q", "--format", "json"];
    for fault in [
        "dropout 5ms at 3.6s",
        "encoder-slip 3deg at 3.6s",
        "stuck Z at 3.6s",
        "feedback-jump Z 0.1mm at 3.6s",
        "feedback-jump X 0.1mm at 3.6s",
        "drive-fault spindle at 3.6s",
        "drive-fault X at 3.6s",
    ] {
        let output = leadscrew(&[&run[..], &["--fault", fault, "--recover"]].concat());
        let certificate: Value = serde_json::from_slice(&output.stdout).unwrap();
        let off = number(&certificate["features"][0], "sync_error_max_um");
        assert!(off < 10.0, "{fault}: {off} µm");
        assert!(number(&certificate["withdrawals"][0], "by_mm") > 1.5, "{fault}: {certificate:#}");
    }
}

#[test]
fn a_wheel_whose_axis_has_lost_its_encoder_is_not_said_to_be_off_the_cam_by_itself() {
    let [file, cams] = ["cam-shaft.nc", "cams.toml"].map(|name| root().join("programs").join(name));
    let (file, cams) = (file.to_str().unwrap(), cams.to_str().unwrap());
    let run =
        ["run", file, "--machine", "cam-grinder", "--dialect", "toyoda", "--cams", cams, "-q"];
    let output = leadscrew(&[&run[..], &["--fault", "stuck X at 9s"]].concat());
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("the tool was left in a cam; --recover"), "{text}");
    assert!(!text.contains("OFF THE WORK"), "{text}");
}

#[test]
fn what_is_wrong_with_faults_and_orders_is_said_at_once_and_what_was_not_triggered_in_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tap.ngc");
    std::fs::write(&file, simulator::one_tap("G84", 11)).unwrap();
    let tools = root().join("programs/tools.toml");
    let run = ["run", file.to_str().unwrap(), "--tools", tools.to_str().unwrap(), "-q"];
    let wrong = ["--fault", "stuck A at 1s; explode at 2s", "--operator", "hold at 9x"];
    let output = leadscrew(&[&run[..], &wrong].concat());
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(complained(&output).lines().count(), 3, "{}", complained(&output));
    let orders = ["--operator", "emergency-stop at angle 12rev; resume at 900s", "--recover"];
    let output = leadscrew(&[&run[..], &orders].concat());
    let text = said(&output);
    assert!(text.contains("emergency-stop at") && text.contains("THE TAP IS OUT"), "{text}");
    assert!(text.contains("order not reached: resume at 900s: the run ended before it"), "{text}");
}

#[test]
fn a_fault_in_a_thread_or_a_polygon_is_said_and_the_tool_taken_off_the_work() {
    for (name, machine, at) in
        [("thread-m20x1.5.ngc", "lathe", "3.6s"), ("hexagon-af17.nc", "polygon-lathe", "12s")]
    {
        let file = root().join("programs").join(name);
        let fault = format!("power-cut at {at}");
        let run = ["run", file.to_str().unwrap(), "--machine", machine, "-q"];
        let output = leadscrew(&[&run[..], &["--fault", &fault, "--recover"]].concat());
        let text = said(&output);
        assert!(text.contains(": X took the tool +"), "{text}{}", complained(&output));
        assert!(text.contains("THE TOOL IS OFF THE WORK"), "{text}");
        let output =
            leadscrew(&[&run[..], &["--fault", &fault, "--recover", "--format", "json"]].concat());
        let certificate: Value = serde_json::from_slice(&output.stdout).unwrap();
        let withdrawal = &certificate["withdrawals"][0];
        assert!(withdrawal["axis"] == "X" && number(withdrawal, "by_mm") > 1.5, "{withdrawal:#}");
        if machine == "lathe" {
            assert_eq!(certificate["features"][0]["hand"], "right", "{certificate:#}");
            // spindle and Z stop together on the thread
            let off = number(&certificate["features"][0], "sync_error_max_um");
            assert!(off > 0.0 && off < 10.0, "{off} µm");
        }
    }
}
