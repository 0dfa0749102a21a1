//! `leadscrew trace`: the same values in other formats, and one sentence for what is no recording.
use crate::common::{complained, leadscrew, said};
use std::fs;
use std::path::{Path, PathBuf};
use store::trace::Reader;

/// A run of a short program with a tap, in a folder.
fn run(folder: &Path) -> PathBuf {
    let program = folder.join("one.ngc");
    let text = "G21 G54 G90 T3 M6\nG0 X12 Y12 G43 H3 Z5\nM3 S1000\nG99 G84 X12 Y12 Z-5 R5 F1000\nG80 M30\n";
    fs::write(&program, text).unwrap();
    let out = folder.join("run");
    leadscrew(&["run", program.to_str().unwrap(), "-q", "--out", out.to_str().unwrap()]);
    assert!(out.join("trace.parquet").is_file());
    out
}

fn convert(run: &Path, format: &str, out: &Path) {
    let (run, out) = (run.to_str().unwrap(), out.to_str().unwrap());
    let output = leadscrew(&["trace", "convert", run, "--to", format, "--out", out]);
    assert!(output.status.success(), "{}", complained(&output));
}

#[test]
fn each_format_has_the_same_values_and_the_units() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path());
    let trace = run.join("trace.parquet");
    let whole = Reader::open(&trace).unwrap();
    let rows = whole.rows() as usize;
    let first: Vec<_> = whole.map(Result::unwrap).collect();

    let plain = folder.path().join("plain.parquet");
    convert(&run, "parquet", &plain);
    let reader = Reader::open(&plain).unwrap();
    assert_eq!(reader.about("unit:z_drive_force_n"), Some("N"));
    assert_eq!(reader.about("unit:control_sync_error_um"), Some("µm"));
    assert_eq!(reader.about("machine"), Some("tapping-center"));
    let again: Vec<_> = reader.map(Result::unwrap).collect();
    assert_eq!(
        format!("{first:?}"),
        format!("{again:?}"),
        "NaN is no value, and equals itself here"
    );

    let csv = folder.path().join("trace.csv");
    convert(&run, "csv", &csv);
    let text = fs::read_to_string(&csv).unwrap();
    assert!(
        text.contains("# unit:z_truth_mm: mm\n") && text.contains("# machine: tapping-center\n")
    );
    let lines: Vec<_> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines.len(), rows + 1);
    let heads: Vec<_> = lines[0].split(',').collect();
    let at = |name: &str| heads.iter().position(|head| *head == name).unwrap();
    let group = &first[0];
    for row in [0, rows / 2, rows - 1] {
        let cells: Vec<_> = lines[row + 1].split(',').collect();
        assert_eq!(cells.len(), heads.len());
        assert_eq!(cells[at("z_truth_mm")].parse(), Ok(group.column("z_truth_mm").unwrap()[row]));
        assert_eq!(cells[at("state")], group.state[row]);
        assert_eq!(cells[at("line")].parse(), Ok(group.line[row]));
        let error = group.column("control_sync_error_um").unwrap()[row];
        assert_eq!(cells[at("control_sync_error_um")].is_empty(), error.is_nan());
    }

    // beside the recording, if nothing else is said
    let output = leadscrew(&["trace", "convert", run.to_str().unwrap(), "--to", "mcap"]);
    assert!(said(&output).contains(&format!("{rows} periods")), "{}", said(&output));
    let mcap = fs::read(run.join("trace.mcap")).unwrap();
    assert!(mcap.starts_with(b"\x89MCAP0\r\n") && mcap.ends_with(b"\x89MCAP0\r\n"));
}

#[test]
fn a_summary_says_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path());
    let output = leadscrew(&["trace", "show", run.to_str().unwrap()]);
    let text = said(&output);
    for part in ["machine: tapping-center", "one each 250.0 µs", "z_truth_mm", "tap-in", "N·m"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn what_is_no_recording_is_one_sentence_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path());
    let whole = fs::read(run.join("trace.parquet")).unwrap();
    let bad = folder.path().join("bad");
    fs::create_dir(&bad).unwrap();
    let at = |name: &str| bad.join(name);
    fs::write(at("text.parquet"), "no recording").unwrap();
    fs::write(at("empty.parquet"), "").unwrap();
    fs::write(at("half.parquet"), &whole[..whole.len() / 2]).unwrap();
    let mut damaged = whole.clone();
    let middle = damaged.len() / 3;
    damaged[middle..middle + 4000].fill(0xA5);
    fs::write(at("damaged.parquet"), damaged).unwrap();
    let before = names(&bad);
    let itself = run.join("trace.parquet");
    for (run, to) in [
        (at("text.parquet"), "mcap"),
        (at("empty.parquet"), "csv"),
        (at("half.parquet"), "mcap"),
        (at("damaged.parquet"), "csv"),
        (at("damaged.parquet"), "mcap"),
        (at("none.parquet"), "csv"),
        (bad.clone(), "mcap"),
        (itself, "parquet"),
    ] {
        let output = leadscrew(&["trace", "convert", run.to_str().unwrap(), "--to", to]);
        let complaint = complained(&output);
        assert_eq!(output.status.code(), Some(2), "{}: {complaint}", run.display());
        assert!(!complaint.contains("panicked"), "{complaint}");
        assert_eq!(complaint.trim_end().lines().count(), 1, "{complaint}");
        assert_eq!(names(&bad), before, "{}", run.display());
    }
    let output = leadscrew(&[
        "trace",
        "convert",
        run.to_str().unwrap(),
        "--to",
        "csv",
        "--out",
        "/none/here.csv",
    ]);
    assert!(complained(&output).contains("/none/here.csv"), "{}", complained(&output));
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    names
}
