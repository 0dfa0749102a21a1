//! Controls that are killed in a tap, simulators whose power fails, and the way out: over
//! processes, as a user has it.
use crate::common;
use crate::common::{complained, said};
use crate::simulator::{Simulator, number, one_tap};
use serde_json::Value;
use std::sync::OnceLock;
use test_support::size;

/// Machine time at which the tap of [`one_tap`] begins to go in, and at which it is out, s: of each
/// hand it is measured once.
fn stroke(hand: &str, tool: u32) -> (f64, f64) {
    static OF_HANDS: [OnceLock<(f64, f64)>; 2] = [OnceLock::new(), OnceLock::new()];
    *OF_HANDS[usize::from(hand == "G74")].get_or_init(|| measured(hand, tool))
}

fn measured(hand: &str, tool: u32) -> (f64, f64) {
    let simulator = Simulator::start(&[]);
    let output = simulator.run(&one_tap(hand, tool), &["--log"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    let log = said(&output) + &complained(&output);
    let time = |word: &str| -> f64 {
        let line =
            log.lines().find(|l| l.contains(word)).unwrap_or_else(|| panic!("{word}: {log}"));
        line.split_whitespace().find_map(|w| w.parse().ok()).unwrap()
    };
    (time("tap-in"), time("tap-out") + 1.0)
}

/// Kill the control at this machine time, recover, and hold it to what is promised; the answer.
fn killed(hand: &str, tool: u32, at: f64, options: &[&str]) -> Value {
    recovered(&Simulator::killing_at(&[at], options), hand, tool, &format!("{at:.6}"))
}

/// What is promised of whatever stopped the control.
fn recovered(simulator: &Simulator, hand: &str, tool: u32, at: &str) -> Value {
    let output = simulator.run(&one_tap(hand, tool), &[]);
    assert_ne!(output.status.code(), Some(0), "nothing stopped it at {at}");
    let stopped = simulator.status();
    let answer = simulator.recover(&[]);
    let after = simulator.status();
    assert_eq!(after["tool_broken"], false, "{at} s: {stopped:#} {answer:#} {after:#}");
    assert_eq!(after["tap_in_thread"], false, "{at} s: {stopped:#} {answer:#} {after:#}");
    match answer["outcome"].as_str().unwrap() {
        "recovered" => {
            let by_encoders = number(&answer, "helix_error_max_um");
            let by_truth = number(&after, "off_helix_while_coupled_max_um");
            assert!(by_encoders <= 20.0 && by_truth <= 20.0, "{at} s: {answer:#} {after:#}");
        }
        "nothing-to-do" => assert_eq!(stopped["tap_in_thread"], false, "{at} s: {answer:#}"),
        other => panic!("{other} at {at} s: {stopped:#} {answer:#}"),
    }
    answer
}

/// So many instants within the tap, from a seed: one in each of as many equal parts.
fn instants(count: u32, (from, to): (f64, f64), mut seed: u64) -> Vec<f64> {
    let part = (to - from) / f64::from(count);
    let mut draw = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % 1000) as f64 / 1000.0
    };
    (0..count).map(|at| from + part * (f64::from(at) + draw())).collect()
}

#[test]
fn a_control_that_is_killed_in_a_right_hand_tap_is_recovered_at_any_instant() {
    let span = stroke("G84", 11);
    let (count, mut recovered) = (size::of(3, 50), 0);
    for at in instants(count, span, 0x5eed) {
        let answer = killed("G84", 11, at, &[]);
        recovered += u32::from(answer["outcome"] == "recovered");
    }
    assert!(5 * recovered >= 3 * count, "only {recovered} of {count} were in the work");
}

#[test]
fn a_control_that_is_killed_in_a_left_hand_tap_is_recovered_at_any_instant() {
    let span = stroke("G74", 41);
    for at in instants(size::of(2, 30), span, 0xbeef) {
        let answer = killed("G74", 41, at, &[]);
        assert!(answer["hand"] == "left", "{answer:#}");
    }
}

#[test]
fn drives_that_stop_apart_leave_an_error_that_recovery_mends() {
    let (from, to) = stroke("G84", 11);
    let at = from + 0.3 * (to - from);
    let off = killed("G84", 11, at, &["--on-link-loss", "off"]);
    let before = number(&off, "phase_error_before_um").abs();
    assert!((40.0..600.0).contains(&before), "{off:#}");
    for (reaction, most_um) in [("quick-stop", 60.0), ("coast", 40.0), ("coupled-stop", 40.0)] {
        let answer = killed("G84", 11, at, &["--on-link-loss", reaction]);
        assert!(number(&answer, "phase_error_before_um").abs() < most_um, "{answer:#}");
    }
}

#[test]
fn a_power_cut_is_recovered_and_without_turns_only_where_the_turn_can_be_shown() {
    let (from, to) = stroke("G84", 11);
    let at = format!("{:.6}", from + 0.3 * (to - from));
    let cut = ["--power-cut-at", &at];
    recovered(&Simulator::start(&cut), "G84", 11, &at);
    let shown =
        recovered(&Simulator::start(&[&cut[..], &["--single-turn"]].concat()), "G84", 11, &at);
    assert!(number(&shown, "phase_error_bound_um") < 40.0, "{shown:#}");
    let coasting = ["--single-turn", "--on-power-loss", "off"];
    let simulator = Simulator::start(&[&cut[..], &coasting].concat());
    simulator.run(&one_tap("G84", 11), &[]);
    let refused = simulator.recover(&[]);
    assert_eq!(refused["outcome"], "refused");
    let reason = refused["reason"].as_str().unwrap();
    assert!(reason.contains("half a lead, 0.625 mm") && reason.contains("coasted"), "{reason}");
    let still = simulator.status();
    assert!(still["tap_in_thread"] == true && still["tool_broken"] == false, "{still:#}");
}

#[test]
fn while_a_tap_is_in_its_hole_nothing_but_recovery_moves() {
    let (from, to) = stroke("G84", 11);
    let simulator = Simulator::killing_at(&[from + 0.4 * (to - from)], &[]);
    simulator.run(&one_tap("G84", 11), &[]);
    let before = simulator.status();
    let refused = simulator.run(&one_tap("G84", 11), &[]);
    let said = complained(&refused);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("tool 11 is in hole 1") && said.contains("leadscrew recover --simulator"),
        "{said}"
    );
    assert_eq!(simulator.recover(&["--dry-run"])["outcome"], "recovered");
    let after = simulator.status();
    let moved = number(&before, "spindle_rev") - number(&after, "spindle_rev");
    assert!(moved.abs() < 1e-6, "something has moved: {moved} rev"); // a drive lets go of its torque
    assert_eq!(simulator.recover(&[])["outcome"], "recovered");
    assert_eq!(simulator.recover(&[])["outcome"], "nothing-to-do");
    let again = simulator.run(&one_tap("G84", 11), &["--from", "hole 1"]);
    let said_again = common::said(&again);
    assert_eq!(again.status.code(), Some(0), "{}{}", said_again, complained(&again));
    let certificate: Value = serde_json::from_slice(&again.stdout).unwrap();
    let thread = &certificate["features"][0];
    assert!(thread["recovered"] == true && thread["class"] == "6H", "{thread:#}");
}

#[test]
fn a_thread_is_not_cut_again_by_a_called_file_that_was_edited_without_a_word() {
    let tap = "G99 G84 X0 Y0 Z-20 R5 F1250\n";
    let calls = one_tap("G84", 11).replace(tap, "o<taps> call\n");
    let taps = format!("o<taps> sub\n{tap}o<taps> endsub\n");
    let simulator = Simulator::killing_at(&[2.5], &[]);
    let file = simulator.folder.path().join("taps.ngc");
    std::fs::write(&file, &taps).unwrap();
    simulator.run(&calls, &[]);
    assert_eq!(simulator.status()["tool_in_work"], 11);
    assert_eq!(simulator.recover(&[])["outcome"], "recovered");
    std::fs::write(&file, taps.replace("Z-20", "Z-15")).unwrap();
    let refused = simulator.run(&calls, &["--from", "hole 1"]);
    let why = complained(&refused);
    assert_ne!(refused.status.code(), Some(0), "{why}");
    assert!(why.contains("a file that it calls was changed since it was left at line"), "{why}");
    assert!(why.contains("hole 1") && why.contains("--program-changed"), "{why}");
    std::fs::write(&file, &taps).unwrap();
    let again = simulator.run(&calls, &["--from", "hole 1"]);
    assert_eq!(again.status.code(), Some(0), "{}{}", said(&again), complained(&again));
    let certificate: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(certificate["features"][0]["recovered"], true, "{certificate:#}");
}

#[test]
fn an_operators_hold_on_a_machine_simulator_is_resumed_backed_out_or_recovered() {
    for (orders, ended, inside) in [
        ("hold at depth 8mm; resume at 4s", true, false),
        ("hold at depth 8mm; retract at 4s", false, false),
        ("hold at depth 8mm", false, true),
    ] {
        let simulator = Simulator::start(&[]);
        let output = simulator.run(&one_tap("G84", 11), &["--operator", orders]);
        let certificate: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(certificate["ended"], ended, "{orders}: {certificate:#}");
        assert_eq!(simulator.status()["tap_in_thread"], inside, "{orders}: {certificate:#}");
        let answer = simulator.recover(&[]);
        assert_eq!(answer["outcome"] == "recovered", inside, "{orders}: {answer:#}");
        let go_on = answer["continue_with"].as_str().unwrap_or("");
        assert!(!go_on.contains("hold") && go_on.contains("--from") == inside, "{go_on}");
    }
}

#[test]
fn a_recovery_that_is_killed_is_begun_again() {
    let (from, to) = stroke("G84", 11);
    let first = from + 0.4 * (to - from);
    // the machine simulator runs down within a tenth of a second; the way out takes several
    let times = [first, first + 0.8, first + 1.6];
    let simulator = Simulator::killing_at(&times, &["--on-link-loss", "quick-stop"]);
    simulator.run(&one_tap("G84", 11), &[]);
    for _ in 0..2 {
        assert!(simulator.recover_killed(), "it was not killed");
        assert_eq!(simulator.status()["tap_in_thread"], true);
    }
    let answer = simulator.recover(&[]);
    let after = simulator.status();
    assert_eq!(answer["outcome"], "recovered", "{answer:#}");
    assert!(after["tool_broken"] == false && after["tap_in_thread"] == false, "{after:#}");
}

#[test]
fn a_record_that_is_damaged_stops_everything_until_somebody_has_looked() {
    let (from, to) = stroke("G84", 11);
    let simulator = Simulator::killing_at(&[from + 0.4 * (to - from)], &[]);
    simulator.run(&one_tap("G84", 11), &[]);
    for name in ["sync-record.a", "sync-record.b"] {
        let path = simulator.state().join(name);
        if let Ok(mut bytes) = std::fs::read(&path) {
            bytes[40] ^= 4;
            std::fs::write(&path, bytes).unwrap();
        }
    }
    let run = simulator.run(&one_tap("G84", 11), &[]);
    assert_eq!(run.status.code(), Some(2));
    assert!(complained(&run).contains("its checksum does not fit"), "{}", complained(&run));
    assert_eq!(simulator.recover(&[])["outcome"], "refused");
    assert_eq!(simulator.recover(&["--discard-record"])["outcome"], "nothing-to-do");
    assert_eq!(simulator.recover(&[])["outcome"], "nothing-to-do");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_keeps_the_tap_out_of_the_work() {
    let simulator = Simulator::start(&[]);
    std::fs::create_dir(simulator.state()).unwrap();
    std::os::unix::fs::symlink("/dev/full", simulator.state().join("sync-record.new")).unwrap();
    let output = simulator.run(&one_tap("G84", 11), &[]);
    assert_eq!(output.status.code(), Some(3), "{}", complained(&output));
    assert!(complained(&output).contains("No space left on device"), "{}", complained(&output));
    assert!(said(&output).contains("308"), "{}", said(&output));
    let after = simulator.status();
    assert!(after["threads"].as_array().unwrap().is_empty(), "{after:#}");
}

#[test]
fn what_the_machine_simulator_cuts_is_what_the_machine_within_the_process_cuts() {
    let features = |output: &std::process::Output| -> Value {
        let mut value: Value = serde_json::from_slice(&output.stdout).unwrap();
        value["features"].take()
    };
    let simulator = Simulator::start(&[]);
    let outside = simulator.run(&one_tap("G84", 11), &[]);
    let file = simulator.folder.path().join("part.ngc");
    let inside = common::leadscrew(&["run", file.to_str().unwrap(), "-q", "--format", "json"]);
    let depth = |features: &Value| number(&features[0], "depth_error_um");
    let (a, b) = (features(&outside), features(&inside));
    assert_eq!(a[0]["verdict"], "pass");
    assert!((depth(&a) - depth(&b)).abs() < 0.5, "{a:#} {b:#}");
}

/// A machine that differs from what its control knows of it, as a commissioning may leave it: more
/// play and friction, softer screws.
fn another_machine(folder: &std::path::Path) -> String {
    let file = folder.join("as-built.toml");
    let text = "extends = \"tapping-center\"\nname = \"tapping-center\"\n\n[axes.z.structure]\nstiffness_n_per_um = 68\nbacklash_um = 1.2\n\n\
                [axes.z.friction]\nviscous_n_s_per_m = 720\ncoulomb_n = 180\nstatic_n = 228\n\n[spindles.friction]\n";
    std::fs::write(&file, text.replace("[spindles.friction]\n", "")).unwrap();
    file.to_str().unwrap().to_owned()
}

/// A peck tap, M6 at 3000 rpm.
fn pecks() -> String {
    "G21 G90 G54 G17\nT3 M6\nS3000 M3\nG0 X0 Y0\nG43 H3 Z20\nG99 G84 X0 Y0 Z-12 R2 Q6 F3000\nG80\nG0 Z50\nM2\n".into()
}

#[test]
fn the_truth_lies_within_the_bound_that_recovery_states_on_a_machine_unlike_its_file() {
    let here = tempfile::tempdir().unwrap();
    let built = another_machine(here.path());
    let reactions = ["coupled-stop", "quick-stop", "off", "coast"];
    let programs = [(one_tap("G84", 11), (1.9, 3.9)), (pecks(), (1.75, 2.3))];
    let (mut compared, mut widest) = (0, 0.0_f64);
    let (count, mut reaction) = (size::of(3, 40), reactions.iter().cycle());
    for (program, span) in programs {
        for (at, reaction) in instants(count, span, 0xb0d).into_iter().zip(reaction.by_ref()) {
            let options = ["--machine", &built, "--on-link-loss", reaction];
            let simulator = Simulator::killing_at(&[at], &options);
            simulator.run(&program, &[]);
            let truth = simulator.status();
            let said = simulator.recover(&["--dry-run"]);
            let Some(truth) = truth["off_helix_um"]
                .as_f64()
                .filter(|_| said["phase_error_before_um"].is_number())
            else {
                continue;
            };
            let bound = number(&said, "phase_error_bound_um");
            let off = (number(&said, "phase_error_before_um") - truth).abs();
            assert!(off <= bound, "{reaction} at {at}: {off:.1} µm off: {truth:.1}, {said:#}");
            // no wider than what the largest distance itself explains
            let most = 25.0 + 0.5 * number(&said, "phase_error_before_um").abs();
            assert!(bound < most, "{reaction} at {at}: {said:#}");
            (compared, widest) = (compared + 1, widest.max(bound));
        }
    }
    assert!(compared >= count, "only {compared} of {} stood in their thread", 2 * count);
}

/// A tap in its hole whose control has been killed.
fn killed_in_its_tap(options: &[&str]) -> Simulator {
    let simulator = Simulator::killing_at(&[2.5], options);
    simulator.run(&one_tap("G84", 11), &[]);
    assert_eq!(simulator.status()["tool_in_work"], 11);
    simulator
}

#[test]
fn a_missing_an_old_and_a_foreign_record_are_no_proof_that_no_tool_is_in_the_work() {
    let simulator = killed_in_its_tap(&["--epoch", "1"]);
    let before = simulator.status();
    let here = simulator.folder.path().to_owned();
    // the state folder is lost, empty, or one that says that all is well
    let kept = here.join("kept");
    std::fs::rename(simulator.state(), &kept).unwrap();
    let ended = |options: &[&str]| {
        let other = Simulator::start(options);
        other.run(&one_tap("G84", 11), &[]);
        other
    };
    let old = ended(&["--epoch", "1"]); // of this machine, and restored from before
    let foreign = ended(&["--epoch", "1", "--serial", "2"]);
    for (name, prepare) in [
        ("missing", None),
        ("empty", Some(None)),
        ("old", Some(Some(old.state()))),
        ("of another machine", Some(Some(foreign.state()))),
    ] {
        let _ = std::fs::remove_dir_all(simulator.state());
        if let Some(from) = prepare {
            std::fs::create_dir(simulator.state()).unwrap();
            for file in from.iter().flat_map(|from| std::fs::read_dir(from).unwrap()) {
                let file = file.unwrap();
                std::fs::copy(file.path(), simulator.state().join(file.file_name())).unwrap();
            }
        }
        let refused = simulator.recover(&[]);
        assert_eq!(refused["outcome"], "refused", "{name}: {refused:#}");
        let run = simulator.run(&one_tap("G84", 11), &[]);
        let why = complained(&run);
        assert_eq!(run.status.code(), Some(2), "{name}: {why}");
        let kept = why.contains("tool 11 is in its work") && why.contains("state");
        let foreign = why.contains("belongs to another machine: to tapping-center number 2");
        assert!(kept || foreign && name == "of another machine", "{name}: {why}");
        let after = simulator.status();
        assert_eq!(
            (&after["tap_in_thread"], &after["z_mm"]),
            (&before["tap_in_thread"], &before["z_mm"])
        );
    }
    let _ = std::fs::remove_dir_all(simulator.state());
    std::fs::rename(&kept, simulator.state()).unwrap();
    assert_eq!(simulator.recover(&[])["outcome"], "recovered");
}

#[test]
fn somebody_who_has_looked_may_state_that_the_tool_is_free_and_a_new_machine_needs_no_record() {
    let simulator = Simulator::start(&[]);
    let answer = simulator.recover(&[]);
    assert_eq!(answer["outcome"], "refused", "{answer:#}");
    let reason = answer["reason"].as_str().unwrap();
    assert!(reason.contains("no sync record in") && reason.contains("a run may begin"), "{reason}");
    assert!(!simulator.state().exists(), "looking has made a folder");
    let simulator = killed_in_its_tap(&[]);
    std::fs::remove_dir_all(simulator.state()).unwrap();
    assert_eq!(simulator.recover(&["--tool-is-free"])["outcome"], "nothing-to-do");
    assert!(simulator.status()["tool_in_work"].is_null());
    assert_eq!(simulator.recover(&[])["outcome"], "nothing-to-do");
}

#[test]
fn looking_changes_nothing_for_the_recovery_that_follows() {
    // without turns only a coupled stop shows the turn: what the machine keeps of its stop has to
    // last
    let simulator = Simulator::start(&["--power-cut-at", "2.5", "--single-turn"]);
    simulator.run(&one_tap("G84", 11), &[]);
    assert_eq!(simulator.status()["stop"], "coupled-stop");
    for _ in 0..2 {
        assert_eq!(simulator.recover(&["--dry-run"])["outcome"], "recovered");
        assert_eq!(simulator.run(&one_tap("G84", 11), &[]).status.code(), Some(2));
        assert_eq!(simulator.status()["stop"], "coupled-stop");
    }
    assert_eq!(simulator.recover(&[])["outcome"], "recovered");
}

#[test]
fn a_tap_that_coasts_far_beyond_its_hole_is_not_said_to_be_recovered() {
    let fast = "G21 G90 G54 G17\nT3 M6\nS6000 M3\nG0 X0 Y0\nG43 H3 Z20\nG99 G84 X0 Y0 Z-12 R5 F6000\nG80\nG0 Z50\nM2\n";
    for at in [1.80, 1.84, 1.88] {
        let simulator = Simulator::killing_at(&[at], &["--on-link-loss", "coast"]);
        simulator.run(fast, &[]);
        let stopped = simulator.status();
        let answer = simulator.recover(&[]);
        let torn = stopped["tool_broken"] == true;
        assert!(!torn || answer["outcome"] != "recovered", "{at}: {stopped:#} {answer:#}");
        assert!(simulator.status()["tool_broken"] == stopped["tool_broken"], "{at}: {answer:#}");
    }
}

#[test]
fn a_clutch_tap_in_its_hole_is_kept_and_taken_out_by_hand_alone() {
    let text = "G21 G90 G54 G17\nT13 M6\nS1000 M3\nG0 X0 Y0\nG43 H13 Z20\nG99 G84 X0 Y0 Z-15 R8 F1000\nG80\nG0 Z50\nM2\n";
    let simulator = Simulator::killing_at(&[2.6], &[]);
    simulator.run(text, &[]);
    let before = simulator.status();
    assert!(before["tap_in_thread"] == true && before["tool_in_work"] == 13, "{before:#}");
    let run = simulator.run(text, &[]);
    assert_eq!(run.status.code(), Some(2), "{}", complained(&run));
    let answer = simulator.recover(&[]);
    assert_eq!(answer["outcome"], "refused", "{answer:#}");
    assert!(answer["reason"].as_str().unwrap().contains("by hand"), "{answer:#}");
    std::fs::remove_dir_all(simulator.state()).unwrap();
    assert_eq!(simulator.run(text, &[]).status.code(), Some(2));
    let after = simulator.status();
    assert!(after["tap_in_thread"] == true && after["tool_broken"] == false, "{after:#}");
}

#[test]
fn the_axis_ramps_as_long_as_a_spindle_that_makes_its_own_ramps() {
    let machine = ["--machine", "vfd-mill"];
    let reaction = ["--on-link-loss", "quick-stop"];
    let simulator = Simulator::killing_at(&[9.3], &[&machine[..], &reaction].concat());
    simulator.run(&one_tap("G84", 11), &machine);
    let stopped = simulator.status();
    assert!(stopped["tap_in_thread"] == true && stopped["tool_broken"] == false, "{stopped:#}");
    // v²/2a is 2.6 mm of M8, of which the drive's ramp is known to a quarter; an axis that stopped
    // as fast as it can tore the tap
    assert!(number(&stopped, "off_helix_um").abs() < 650.0, "{stopped:#}");
    assert_eq!(simulator.recover(&machine)["outcome"], "recovered");
}

/// M3 in a holder that gives 0.5 mm, and drives that are simply off: the axis is clamped and the
/// spindle turns on by ten turns.
#[test]
fn a_tap_that_its_holder_has_torn_is_taken_to_be_broken() {
    let program = "G21 G90 G54 G17\nT6 M6\nS2000 M3\nG0 X0 Y0\nG43 H6 Z20\nG99 G84 X0 Y0 Z-6 R5 F1000\nG80\nG0 Z50\nM2\n";
    let simulator = Simulator::killing_at(&[2.44], &["--on-link-loss", "off"]);
    assert!(simulator.run(program, &[]).status.code().is_none(), "it was killed");
    let stopped = simulator.status();
    assert_eq!(stopped["tool_broken"], true, "{stopped:#}");
    let answer = simulator.recover(&[]);
    assert!(answer["outcome"] == "refused" || answer["outcome"] == "not-known-whole", "{answer:#}");
}

/// An M8 whose spindle coasts is led 1.6 mm deeper than programmed; a recovery takes it halfway
/// out, and is killed.
#[test]
fn what_a_recovery_that_was_stopped_knew_of_a_tap_the_next_one_knows() {
    let simulator = Simulator::killing_at(&[2.85], &["--on-link-loss", "coast"]);
    assert!(simulator.run(&one_tap("G84", 11), &[]).status.code().is_none(), "it was killed");
    let first = simulator.recover(&["--dry-run"]);
    let why = first["not_known_whole"].as_str().expect("too deep").to_owned();
    assert!(why.contains("deeper than programmed"), "{first:#}");
    simulator.kill_after(3.0);
    assert!(simulator.recover_killed());
    assert_eq!(simulator.status()["tap_in_thread"], true);
    let again = simulator.recover(&[]);
    assert_eq!(again["overrun_mm"], 0.0, "where it stands shows nothing: {again:#}");
    assert_eq!(again["outcome"], "not-known-whole", "{again:#}");
    assert!(again["not_known_whole"].as_str().unwrap().contains("before this one"), "{again:#}");
    let out = simulator.status();
    assert!(out["tap_in_thread"] == false && out["tool_in_work"].is_null(), "{out:#}");
}

/// Its drive obeys no trajectory, and turns a little slower than it is told.
#[test]
fn a_tap_under_a_spindle_that_is_only_told_a_speed_comes_out_along_its_thread() {
    let machine = ["--machine", "vfd-mill"];
    let simulator = Simulator::killing_at(&[9.446], &machine);
    simulator.run(&one_tap("G84", 11), &machine);
    assert_eq!(simulator.recover(&machine)["outcome"], "recovered");
    let out = simulator.status();
    assert!(out["tap_in_thread"] == false && out["tool_broken"] == false, "{out:#}");
    assert!(number(&out, "off_helix_while_coupled_max_um") < 20.0, "{out:#}");
}
