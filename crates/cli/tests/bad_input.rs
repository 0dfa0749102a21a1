//! Whatever is thrown at it: one clear sentence, exit code 2, nothing half-written.
use crate::common::{complained, leadscrew, root, said};
use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Command, Output, Stdio},
};
use test_support::size;

/// Run a program text; what was said about it. It must be refused and leave nothing behind.
fn refused(text: &[u8], arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("part.ngc");
    fs::write(&program, text).unwrap();
    let out = folder.path().join("out");
    let mut all = vec!["run", program.to_str().unwrap(), "--out", out.to_str().unwrap()];
    all.extend(arguments);
    let output = leadscrew(&all);
    let complaint = complained(&output).replace(folder.path().to_str().unwrap(), "");
    assert_eq!(output.status.code(), Some(2), "{}{complaint}", said(&output));
    let left: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left, ["part.ngc"], "something was left behind");
    complaint
}

#[track_caller]
fn says(complaint: &str, words: &[&str]) {
    for word in words {
        assert!(complaint.contains(word), "expected \"{word}\" in:\n{complaint}");
    }
}

#[test]
fn a_truncated_program() {
    let text = fs::read(root().join("programs/plate-12xM6.ngc")).unwrap();
    let cut = text.windows(8).position(|w| w == b"G99 G84 ").unwrap() + 12;
    says(&refused(&text[..cut], &[]), &["error["]);
}

#[test]
fn a_binary_file() {
    let complaint = refused(&[0x7f, b'E', b'L', b'F', 0, 1, 2, 0, 0xff, 0xfe, b'\n', 0, 0], &[]);
    says(&complaint, &["error["]);
    assert!(complaint.lines().count() < 30, "{complaint}");
}

#[test]
fn one_line_of_a_hundred_megabytes() {
    let complaint = refused(&vec![b'X'; 100 << 20], &[]);
    says(&complaint, &["error[", "line"]);
    assert!(complaint.len() < 3000, "{}", complaint.len());
}

/// A loop in which something changes is stopped after fifty million blocks: at a change's size
/// `interp/tests/steering.rs` tries that with a limit of its own.
#[test]
fn a_loop_without_end_is_stopped_by_a_stated_limit() {
    says(&refused(b"o1 while [1]\nG0 X1\no1 endwhile\nM2\n", &[]), &["error[I0803]"]);
    if size::is_full() {
        says(&refused(b"o1 while [1]\n#1=[#1+1]\no1 endwhile\nM2\n", &[]), &["error[", "000"]);
    }
}

#[test]
fn a_call_without_end_is_stopped_by_a_stated_limit() {
    says(&refused(b"o1 sub\no1 call\no1 endsub\no1 call\nM2\n", &[]), &["error["]);
}

#[test]
fn an_empty_program() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("empty.ngc");
    fs::write(&program, "").unwrap();
    let output = leadscrew(&["run", program.to_str().unwrap()]);
    assert!(matches!(output.status.code(), Some(0 | 2)), "{}", complained(&output));
}

#[test]
fn a_missing_program_machine_or_tool_table() {
    for arguments in [
        ["run", "nowhere.ngc", "--machine", "tapping-center"],
        ["run", "programs/plate-12xM6.ngc", "--machine", "nowhere.toml"],
        ["run", "programs/plate-12xM6.ngc", "--tools", "nowhere.toml"],
        ["run", "programs/plate-12xM6.ngc", "--parameters", "nowhere.var"],
    ] {
        let output = leadscrew(&arguments);
        assert_eq!(output.status.code(), Some(2));
        let complaint = complained(&output);
        says(&complaint, &["error: cannot read nowhere"]);
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
    }
}

#[test]
fn an_unknown_machine_is_answered_with_those_there_are() {
    let output = leadscrew(&["run", "programs/plate-12xM6.ngc", "--machine", "tapping-centre"]);
    assert_eq!(output.status.code(), Some(2));
    says(
        &complained(&output),
        &["tapping-centre", "tapping-center, polygon-lathe, lathe, cam-grinder"],
    );
}

/// The default machine's file with one thing changed.
fn changed_machine(folder: &Path, from: &str, to: &str) -> String {
    let text = fs::read_to_string(root().join("machines/tapping-center.toml")).unwrap();
    assert!(text.contains(from), "the machine's file has no {from}");
    let path = folder.join("shop.toml");
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_number_that_is_none_and_an_unknown_key() {
    let folder = tempfile::tempdir().unwrap();
    for (to, words) in [
        ("inertia_kg_m2 = nan", ["S0405", "inertia_kg_m2"]),
        ("inertia_kg_m2 = 0.01\ninertai_kg_m2 = 0.01", ["S0402", "inertai_kg_m2"]),
    ] {
        let machine = changed_machine(folder.path(), "inertia_kg_m2 = 0.010", to);
        let output = leadscrew(&["machine", "check", &machine]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        says(&complained(&output), &words);
    }
}

#[test]
fn drives_that_switch_off_in_a_tap_are_warned_of_and_no_others_are() {
    let folder = tempfile::tempdir().unwrap();
    for (key, words) in [
        ("on_link_loss", ["if the control dies in a synchronised cut", "nothing is guaranteed"]),
        ("on_power_loss", ["if the mains fail in a synchronised cut", "with [drives.bus]"]),
    ] {
        let usual = format!("{key} = \"coupled-stop\"");
        let machine = changed_machine(folder.path(), &usual, &format!("{key} = \"off\""));
        let output = leadscrew(&["machine", "check", &machine]);
        assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
        let text = said(&output);
        says(&text, &[&format!("warning: [drives] {key} is \"off\""), words[0], words[1]]);
        // and up to which speed a tap survives that; of a spindle that coasts that alone: on a
        // power cut the DC bus pays for braking
        assert_eq!(text.matches("warning").count(), 2, "{text}");
        let coasts = u32::from(key == "on_link_loss");
        for (reaction, warnings) in [("quick-stop", 0), ("coast", coasts)] {
            let machine =
                changed_machine(folder.path(), &usual, &format!("{key} = \"{reaction}\""));
            let text = said(&leadscrew(&["machine", "check", &machine]));
            assert_eq!(text.matches("warning").count(), warnings as usize, "{reaction}: {text}");
            assert!(warnings == 0 || text.contains("M6 up to S"), "{reaction}: {text}");
        }
    }
}

#[test]
fn a_folder_where_nothing_can_be_written() {
    let output = leadscrew(&["run", "programs/inch-unc.ngc", "--out", "/proc/leadscrew/out"]);
    assert_eq!(output.status.code(), Some(2));
    says(&complained(&output), &["error: cannot create the folder"]);
}

/// G54 program head with a tool in the spindle, standing over a hole.
fn tapping(rest: &str) -> Vec<u8> {
    format!("G21 G17 G90 G94 G54\nT3 M6\nG43 H3\nS3000 M3\nG0 X0 Y0 Z5\n{rest}\nM2\n").into_bytes()
}

#[test]
fn a_lead_times_speed_that_the_axis_cannot_follow() {
    let text =
        b"G21 G17 G90 G94 G54\nT7 M6\nG43 H7\nS6000 M3\nG0 X0 Y0 Z5\nG95\nG84 Z-10 R2 F9\nM2\n";
    says(&refused(text, &[]), &["error[", "line"].map(|_| "error["));
}

#[test]
fn a_tap_that_moves_sideways() {
    says(&refused(&tapping("G33.1 X1 Z-10 K1"), &[]), &["error[", "G33.1 X1 Z-10 K1"]);
}

#[test]
fn a_tap_deeper_than_its_hole() {
    let text = "T2 M6\nG43 H2\nS6000 M3\nG0 X0 Y0 Z5\nG81 Z-12 R2 F900\nG80\nT3 M6\nG43 H3\nG84 Z-15 R2 F6000";
    says(&refused(&tapping(text), &[]), &["error[", "Z"]);
}

#[test]
fn a_tool_that_is_not_in_the_table() {
    let complaint = refused(b"T99 M6\nM2\n", &["--missing-tools", "refuse"]);
    says(&complaint, &["tool 99", "it has 1, 2, 3"]);
}

#[test]
fn a_place_out_of_reach_is_said_once_a_block() {
    let complaint = refused(
        b"G21 G90 T2 M6\nG43 H2\nS1000 M3\nG0 X0 Y0 Z20\nG81 X999 Z-5 R2 F100\nM2\n",
        &["--machine", "tapping-center"],
    );
    assert_eq!(complaint.matches("X would go to").count(), 1, "{complaint}");
}

#[test]
fn a_tool_that_is_not_in_the_table_has_a_stand_in_when_the_user_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("part.ngc");
    fs::write(&program, "T99 M6\nG43 H99\nG0 Z50\nM2\n").unwrap();
    let output = leadscrew(&["run", program.to_str().unwrap(), "--missing-tools", "stand-in"]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    says(&complained(&output), &["tool 99", "stand-in"]);
}

#[test]
fn a_hole_drilled_with_an_empty_spindle_is_refused_or_has_a_stand_in() {
    let text = "G21 G90 G94 G54\nG0 X0 Y0 Z5\nG81 Z-5 R1 F100\nM2\n";
    says(&refused(text.as_bytes(), &[]), &["no tool in the spindle", "stand-in"]);
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("part.ngc");
    fs::write(&program, text).unwrap();
    let output = leadscrew(&["run", program.to_str().unwrap(), "--missing-tools", "stand-in"]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    says(&said(&output), &["no holes or threads to judge"]);
}

#[cfg(unix)]
const PLATE: &str = "programs/plate-12xM6.ngc";

#[cfg(unix)]
/// Run it with a standard output that is not read.
fn cut_off(arguments: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(arguments)
        .current_dir(root())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    child.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_accident() {
    for arguments in [
        &["run", PLATE, "--log"][..],
        &["run", PLATE, "--format", "json"],
        &["check", PLATE, "--format", "sarif"],
        &["canon", PLATE],
        &["machine", "list"],
        &["completions", "bash"],
    ] {
        let output = cut_off(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", complained(&output));
        assert!(!complained(&output).contains("panicked"), "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(["run", PLATE, "--log", "--out"])
        .arg(folder.path().join("papers"))
        .current_dir(root())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // the first line of the log: the folder is begun and the simulation runs
    let mut log = BufReader::new(child.stdout.take().unwrap());
    log.read_line(&mut String::new()).unwrap();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    drop(log);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", complained(&output));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_long_program_with_subprograms_is_told_of_as_it_is_checked() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("long.ngc");
    let rest = "-".repeat(100);
    let lines = format!("X1 Y1 ({rest})\nX2 Y2 ({rest})\n").repeat(24_000);
    let wrong = "G1 X[1\n";
    let text =
        format!("G21 F100\no1 sub\nG0 Z5\no1 endsub\no1 call\n{wrong}G1\n{lines}o2 call\nM2\n");
    fs::write(&program, text).unwrap();
    let output = leadscrew(&["check", program.to_str().unwrap(), "--progress", "lines"]);
    assert_eq!(output.status.code(), Some(2));
    says(&said(&output), &["long.ngc:6:", "there is no subprogram o2", "2 errors"]);
    says(&complained(&output), &["checking: "]);
}

#[test]
fn a_folder_is_checked_with_those_below_it_and_each_finding_is_shown_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir_all(folder.path().join("below/deep")).unwrap();
    fs::create_dir(folder.path().join("folder.ngc")).unwrap();
    write("part.ngc", "G21\n(caller)\no<hole> call\nG0 Q1\nM2\n");
    write("hole.ngc", "o<hole> sub\nG0 X1 Q5\no<hole> endsub\n");
    write("below/deep/other.nc", "G0 X1\nM2\n");
    write("readme.txt", "hello");
    let output = leadscrew(&["check", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let said = said(&output);
    says(&said, &["hole.ngc:2:7", "G0 X1 Q5", "part.ngc:4:4", "part.ngc: 2 errors"]);
    // a file of subprograms does not end, and is no program for that
    says(&said, &["hole.ngc: 0 errors", "other.nc: 0 errors", "3 programs: 1 refused"]);
}

#[test]
fn a_program_that_cannot_be_read_does_not_hide_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("part.ngc");
    fs::write(&program, "G0 Q1\nM2\n").unwrap();
    let missing = folder.path().join("none.ngc");
    let output = leadscrew(&["check", missing.to_str().unwrap(), program.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    says(&said(&output), &["part.ngc:1:4", "2 programs: 2 refused"]);
    says(&complained(&output), &["none.ngc", "no such file"]);
}

#[test]
fn a_long_program_has_the_operations_of_its_pieces() {
    const LONG: usize = 24_000;
    let folder = tempfile::tempdir().unwrap();
    // a comment that fills a piece with fewer lines
    let rest = "-".repeat(100);
    let moves = |count: usize| format!("X1 Y1 ({rest})\nX2 Y2 ({rest})\n").repeat(count);
    let text = |count| format!("G21 G90\nS100 M3\nG1 F100\n{}G0 Z-1\nM2\n", moves(count));
    let canon = |name: &str, text: String| {
        let program = folder.path().join(name);
        fs::write(&program, text).unwrap();
        let output = leadscrew(&["canon", program.to_str().unwrap(), "--format", "json"]);
        assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
        said(&output)
    };
    // above 4 MiB a program is read in pieces: its beginning and its end are those of a short one
    let (short, long) = (canon("short.ngc", text(4)), canon("long.ngc", text(LONG)));
    let (short, long): (Vec<_>, Vec<_>) = (short.lines().collect(), long.lines().collect());
    assert_eq!(long.len(), short.len() + 2 * (LONG - 4));
    assert_eq!(long[..6], short[..6]);
    let last = short.last().unwrap().replace("\"line\":13", &format!("\"line\":{}", 2 * LONG + 5));
    assert_eq!(*long.last().unwrap(), last);
}

#[test]
fn a_line_longer_than_a_piece_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("long.ngc");
    let line = "X1 ".repeat(3 << 20);
    fs::write(&program, format!("G0 X1\n{line}\nG0 Q1\nM2\n")).unwrap();
    let output = leadscrew(&["check", program.to_str().unwrap()]);
    says(&said(&output), &["long.ngc:2:1", "long.ngc:3:4", "2 errors"]);
}

#[test]
fn after_two_hundred_errors_it_is_said_that_there_may_be_more() {
    let complaint = refused(("G0 Q1\n".repeat(300) + "M2\n").as_bytes(), &[]);
    says(&complaint, &["stopped after 200 errors", "part.ngc:200:"]);
    assert!(!complaint.contains("part.ngc:201:"));
}

#[test]
fn o_words_within_each_other_have_a_limit() {
    let lines = |all: Vec<String>| all.join("\n") + "\n";
    let begins = lines((1..=1001).map(|i| format!("o{i} if [1]")).collect());
    let ends = lines((1..=1001).rev().map(|i| format!("o{i} endif")).collect());
    says(&refused(format!("{begins}{ends}M2\n").as_bytes(), &[]), &["I0319", "1000 deep"]);
    let most = format!("G21\n{begins}{ends}M2\n")
        .replace("o1001 if [1]\n", "")
        .replace("o1001 endif\n", "");
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("part.ngc");
    fs::write(&program, most).unwrap();
    assert_eq!(leadscrew(&["check", program.to_str().unwrap()]).status.code(), Some(0));
}

#[test]
fn an_exponent_is_refused_with_what_to_write() {
    for text in ["G0 X1E2\nM2\n", "#1=2.5E3\nG0 X#1\nM2\n", "G0 X[2e3]\nM2\n"] {
        says(&refused(text.as_bytes(), &[]), &["exponent", "2500 for 2.5E3"]);
    }
    let text = "G91 G0 Z0.1\nS100 M3 F10\nG81 Z0.6 R-0.3\nM2\n";
    says(&refused(text.as_bytes(), &[]), &["R is 299.8, Z is 300.4\n"]);
}
