//! What the certificate says: the same as the report and the trace, and nothing of what was not
//! cut.
use crate::common::leadscrew;
use serde_json::Value;
use std::path::Path;

/// Run a program into a folder; its certificate.
fn run(program: &str, out: &Path, more: &[&str]) -> Value {
    let words = ["run", program, "-q", "--out", out.to_str().unwrap()];
    let _ = leadscrew(&[&words[..], more].concat());
    let text = std::fs::read_to_string(out.join("certificate.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// A program of a folder of its own.
fn written(folder: &Path, text: &str) -> String {
    let path = folder.join("part.ngc");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Figures of a thread.
const OF_THREADS: [&str; 14] = [
    "depth_mm",
    "depth_error_um",
    "rpm_max",
    "sync_error_max_um",
    "sync_error_rms_um",
    "lead_error_um",
    "groove_widening_um",
    "pitch_diameter_mm",
    "margin_um",
    "torque_max_n_m",
    "torque_in_n_m",
    "torque_out_n_m",
    "axial_force_max_n",
    "start_angle_deg",
];

#[test]
fn what_was_not_cut_has_no_figures() {
    let folder = tempfile::tempdir().unwrap();
    let tools = concat!(env!("CARGO_MANIFEST_DIR"), "/../../programs/tools.toml");
    // the control believes both tools to be 40 mm longer than they are: they stay above the work
    let program = written(
        folder.path(),
        "G21 G17 G40 G49 G80 G90 G94 G54\nG10 L1 P2 Z158.5\nG10 L1 P3 Z145.25\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\n\
         G98 G81 X0 Y0 Z-15 R5 F300\nG80\nT3 M6\nG43 H3\nS1000 M3\nG0 X0 Y0 Z20\nG98 G84 X0 Y0 Z-10 R5 F1000\nG80\nM30\n",
    );
    let certificate = run(&program, &folder.path().join("out"), &["--tools", tools]);
    let [hole, thread] = certificate["features"].as_array().unwrap().as_slice() else {
        panic!("two features: {certificate}")
    };
    for feature in [hole, thread] {
        assert_eq!(
            (&feature["verdict"], &feature["contact"]["cut"]),
            (&"fail".into(), &false.into())
        );
        assert!(feature["x_mm"].is_number(), "where it should be is known: {feature}");
    }
    for key in ["depth_mm", "diameter_mm"] {
        assert!(hole[key].is_null(), "{key}: {hole}");
    }
    for key in OF_THREADS {
        assert!(thread[key].is_null(), "{key}: {thread}");
    }
    assert!(thread["torque_expected"].is_null(), "{thread}");
}

#[test]
fn a_thread_that_was_never_reached_has_no_figures() {
    let folder = tempfile::tempdir().unwrap();
    let tools = concat!(env!("CARGO_MANIFEST_DIR"), "/../../programs/tools.toml");
    let program = written(
        folder.path(),
        "G21 G17 G40 G49 G80 G90 G94 G54\nT3 M6\nG43 H3\nS1000 M3\nG0 X0 Y160 Z20\n\
         G98 G84 X0 Y160 Z-10 R5 F1000\nX30 Y0\nG80\nM30\n",
    );
    let certificate = run(&program, &folder.path().join("out"), &["--tools", tools]);
    let features = certificate["features"].as_array().unwrap();
    let beside = &features[0];
    assert_eq!(beside["contact"]["cut"], false, "{beside}");
    for key in OF_THREADS {
        assert!(beside[key].is_null(), "{key}: {beside}");
        assert!(features[1][key].is_number(), "{key}: {}", features[1]);
    }
}

/// Rows of a trace that one line of the program was at work in.
#[derive(Default)]
struct OfLine {
    z: Vec<f64>,
    turns: Vec<f64>,
    rpm: Vec<f64>,
}

/// Of a thread, from the ground truth of the trace alone.
struct Derived {
    tip_depth_mm: f64,
    rpm_max: f64,
    sync_error_max_um: f64,
}

impl OfLine {
    /// Below `surface`, the place of the axis at which the tip touches the work.
    fn derived(&self, surface: f64, lead: f64) -> Derived {
        let inside = || (0..self.z.len()).filter(|k| self.z[*k] < surface);
        let error = |k: usize| surface - self.z[k] - lead * self.turns[k];
        let weight = |k: usize| (self.turns[k] - self.turns[k.saturating_sub(1)]).abs();
        let turned: f64 = inside().map(weight).sum();
        let helix = inside().map(|k| weight(k) * error(k)).sum::<f64>() / turned;
        let most = |of: &dyn Fn(usize) -> f64| inside().map(of).fold(0.0, f64::max);
        Derived {
            tip_depth_mm: most(&|k| surface - self.z[k]),
            rpm_max: most(&|k| self.rpm[k].abs()),
            sync_error_max_um: most(&|k| (error(k) - helix).abs() * 1e3),
        }
    }
}

/// Time from the first to the last row, and the rows of a line.
fn traced(out: &Path, line: u32) -> (f64, OfLine) {
    let (mut found, mut times) = (OfLine::default(), Vec::new());
    for group in store::trace::Reader::open(&out.join("trace.parquet")).unwrap() {
        let group = group.unwrap();
        let column = |name: &str| group.column(name).unwrap_or_else(|| panic!("no column {name}"));
        let (z, turns, rpm) =
            (column("z_truth_mm"), column("spindle_truth_rev"), column("spindle_rpm"));
        times.extend_from_slice(column("time_s"));
        for k in (0..z.len()).filter(|k| group.line[*k] == line) {
            found.z.push(z[k]);
            found.turns.push(turns[k]);
            found.rpm.push(rpm[k]);
        }
    }
    (times[times.len() - 1] - times[0], found)
}

/// Texts of the elements of a kind in a piece of HTML, in their order.
fn texts(html: &str, tag: &str) -> Vec<String> {
    let opening = format!("<{tag}");
    let pieces = html.split(opening.as_str()).skip(1);
    let inside = |piece: &str| {
        let from = piece.find('>').unwrap() + 1;
        let to = piece.find(&format!("</{tag}>")).unwrap();
        let mut text = String::new();
        let mut depth = 0;
        for letter in piece[from..to].chars() {
            match letter {
                '<' => depth += 1,
                '>' => depth -= 1,
                other if depth == 0 => text.push(other),
                _ => {}
            }
        }
        text
    };
    pieces.map(inside).collect()
}

/// The same thread in the trace, on the page and in the certificate.
#[test]
fn trace_report_and_certificate_give_the_same_figures() {
    let folder = tempfile::tempdir().unwrap();
    let certificate = run("programs/m3-and-m10.ngc", folder.path(), &[]);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let features = certificate["features"].as_array().unwrap();
    // zero of G54 lies at Z-300 of the machine
    let taps = [
        ("M3x0.5", TapOf { length: 98.4, programmed: 8.0, chamfer: 2.5 * 0.5 }),
        ("M10x1.5", TapOf { length: 120.0, programmed: 22.0, chamfer: 2.5 * 1.5 }),
    ];
    let mut seen = 0;
    for (index, feature) in features.iter().enumerate() {
        let size = feature["size"].as_str().unwrap_or_default();
        let Some((_, tap)) = taps.iter().find(|(name, _)| *name == size) else { continue };
        seen += 1;
        let number = |key: &str| feature[key].as_f64().unwrap();
        let line = u32::try_from(feature["line"].as_u64().unwrap()).unwrap();
        let (time, rows) = traced(folder.path(), line);
        let derived = rows.derived(-300.0 + tap.length, number("lead_mm"));
        let near = |what: &str, a: f64, b: f64, within: f64| {
            assert!((a - b).abs() <= within, "line {line}, {what}: {a} and {b}, {within} allowed");
        };
        near("cycle time", time, certificate["cycle_time_s"].as_f64().unwrap(), 1e-3);
        // the tip is the axis and what the holder gives: a micrometre or two
        let overrun = derived.tip_depth_mm - tap.programmed;
        near("depth error / µm", overrun * 1e3, number("depth_error_um"), 5.0);
        near("full thread", derived.tip_depth_mm - tap.chamfer, number("depth_mm"), 0.006);
        near("speed", derived.rpm_max, number("rpm_max"), 0.5);
        let sync = number("sync_error_max_um");
        near("sync error / µm", derived.sync_error_max_um, sync, 0.05 + 0.05 * sync);
        let row = page.split("<tr").find(|row| row.contains(&format!("id=\"F{}\"", index + 1)));
        let cells = texts(row.unwrap(), "td");
        for (key, decimals) in [
            ("depth_mm", 3),
            ("depth_error_um", 1),
            ("sync_error_max_um", 1),
            ("pitch_diameter_mm", 3),
            ("margin_um", 0),
            ("torque_max_n_m", 2),
            ("rpm_max", 0),
        ] {
            let text = format!("{:.decimals$}", number(key)).replace('-', "−");
            let plain = text.replace('−', "-");
            assert!(cells.contains(&text) || cells.contains(&plain), "{key} {text}: {cells:?}");
        }
    }
    assert_eq!(seen, 6);
    let cards = texts(&page, "dd");
    let seconds = certificate["cycle_time_s"].as_f64().unwrap();
    let shown = if seconds < 60.0 {
        format!("{seconds:.2} s")
    } else {
        let tenths = (seconds * 10.0).round();
        let minutes = (tenths / 600.0).floor();
        format!("{minutes:.0} min {:.1} s", (tenths - minutes * 600.0) / 10.0)
    };
    assert!(cards.contains(&shown), "{shown}: {cards:?}");
}

/// A tap of `programs/tools.toml` and what `programs/m3-and-m10.ngc` does with it, mm.
#[derive(Clone, Copy)]
struct TapOf {
    length: f64,
    programmed: f64,
    chamfer: f64,
}
