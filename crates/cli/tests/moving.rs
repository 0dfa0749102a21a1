//! Motion from the command line: rotary axes and their feeds, orders of the operator, programs at
//! the edge of sense.
use crate::common::{complained, leadscrew, root, said};
use serde_json::Value;
use std::{fs, path::Path};

const SCROLL: &str = "programs/scroll.ngc";
const ORDERS: &str = "override 40 at 6s; override 170 at 8s; hold at 10s; resume at 11s; override 90 at 12s; \
                      rapid-override 50 at 13s; single-block on at 14s; single-block off at 14.5s; resume at 15s";

fn run(program: &str, machine: &str, orders: &str, out: &Path) -> Value {
    let out = out.to_str().unwrap();
    let output = leadscrew(&[
        "run",
        program,
        "--machine",
        machine,
        "--operator",
        orders,
        "--out",
        out,
        "-q",
        "--format",
        "json",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    assert!(!complained(&output).contains("safety check"), "{}", complained(&output));
    serde_json::from_str(&said(&output)).unwrap()
}

fn columns(out: &Path, names: &[&str]) -> Vec<Vec<f64>> {
    let reader = store::trace::Reader::open(&out.join("trace.parquet")).unwrap();
    let mut all = vec![Vec::new(); names.len()];
    for group in reader {
        let group = group.unwrap();
        for (column, name) in all.iter_mut().zip(names) {
            column.extend_from_slice(group.column(name).unwrap());
        }
    }
    all
}

/// Largest speed, acceleration and jerk by differences.
fn largest(mut line: Vec<f64>, period: f64) -> [f64; 3] {
    [(); 3].map(|()| {
        line = line.windows(2).map(|pair| (pair[1] - pair[0]) / period).collect();
        line.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
    })
}

/// Each block of the spiral takes 60/F s; a rotary axis alone turns by F; where X goes too, F is
/// X's.
#[test]
fn rotary_axes_feed_by_inverse_time_by_degrees_and_with_others_as_linuxcnc_has_it() {
    let folder = tempfile::tempdir().unwrap();
    run(SCROLL, "mill-5-axis", "override 100 at 1ms", folder.path());
    let names =
        ["time_s", "c_control_setpoint_deg", "a_control_setpoint_deg", "x_control_setpoint_mm"];
    let [time, c, a, x] = columns(folder.path(), &names).try_into().unwrap();
    let first = |of: &[f64], place: f64| of.iter().position(|q| *q >= place).unwrap();
    // the spiral between two angles: 2π·r/360 a degree at 40 mm/s; a block has the radius at its
    // end, 5° on in the mean
    let (from, to) = (90.0, 630.0);
    let took = time[first(&c, to)] - time[first(&c, from)];
    let radius = 40.0 - 4.0 * (f64::midpoint(from, to) + 5.0) / 360.0;
    let expected = radius * f64::to_radians(to - from) / 40.0;
    assert!((took - expected).abs() < 0.005 * expected, "{took} s, {expected} s");
    // A alone at 60 °/s
    let (low, high) = (first(&a, 30.0), first(&a, 60.0));
    let took = time[high] - time[low];
    assert!((took - 0.5).abs() < 0.005 && x[low] == x[high], "{took} s for 30°");
    // back by 30° with 12 mm of X at 10 mm/s
    let top = a.iter().enumerate().max_by(|one, two| one.1.total_cmp(two.1)).unwrap().0;
    let falls = |place: f64| top + a[top..].iter().position(|q| *q <= place).unwrap();
    let (begin, end) = (falls(80.0), falls(70.0));
    let (way, took) = (x[end] - x[begin], time[end] - time[begin]);
    assert!((way - 4.0).abs() < 0.02 && (took - way / 10.0).abs() < 0.005, "{way} {took}");
}

/// The machine's file: A 150 °/s, 1000 °/s², 50 000 °/s³; C 250, 1500, 80 000; X 50 m/min, 10 m/s²,
/// 800 m/s³.
#[test]
fn rotary_axes_keep_their_limits_under_overrides_and_holds_and_the_same_orders_give_the_same_bytes()
{
    let folder = tempfile::tempdir().unwrap();
    let outs = ["one", "two"].map(|name| folder.path().join(name));
    for out in &outs {
        let certificate = run(SCROLL, "mill-5-axis", ORDERS, out);
        assert_eq!(certificate["ended"], true);
    }
    for file in ["trace.parquet", "certificate.json", "report.html"] {
        let [one, two] = [&outs[0], &outs[1]].map(|out| fs::read(out.join(file)).unwrap());
        assert!(one == two, "{file} differs");
    }
    let names = ["a_control_setpoint_deg", "c_control_setpoint_deg", "x_control_setpoint_mm"];
    let limits = [[150.0, 1000.0, 50e3], [250.0, 1500.0, 80e3], [50_000.0 / 60.0, 10e3, 800e3]];
    for ((name, line), limit) in names.iter().zip(columns(&outs[0], &names)).zip(limits) {
        let seen = largest(line, PERIOD);
        // a trace has steps of 2⁻²⁰
        let step = 1.0 / f64::from(1 << 20);
        let room = [1.001, 1.01, 1.05];
        for (k, name_of) in ["speed", "acceleration", "jerk"].iter().enumerate() {
            let noise = step * [1.0, 2.0, 4.0][k] / [PERIOD, PERIOD.powi(2), PERIOD.powi(3)][k];
            assert!(seen[k] <= limit[k] * room[k] + noise, "{name}: {name_of} {}", seen[k]);
        }
    }
}

const PERIOD: f64 = 250e-6;

/// What a program may hold that makes no sense, or little: handled, whatever the operator does
/// meanwhile.
#[test]
fn programs_at_the_edge_of_sense_end_where_they_should() {
    let nanometre = |n| format!("G1 X{:.6} F600\n", f64::from(n) * 1e-6);
    let nanometres = (1..=500).map(nanometre).collect::<Vec<_>>().concat();
    for (what, text, x) in [
        ("moves without length", "G1 X10 F600\nX10\nX10 Y0\nG4 P0\nX20\n", 20.0),
        ("turning back", "G1 X20 F6000\nX0\nX20\nX0.001\nX20 Y0.0001\nX0 Y0\n", 0.0),
        ("segments of a nanometre", nanometres.as_str(), 5e-4),
        ("a step that is no number of this size", "G1 X0.0000000001 F600\nX10\n", 10.0),
    ] {
        for machine in ["bench-xyz", "bench-xyz-jerk20"] {
            let folder = tempfile::tempdir().unwrap();
            let program = folder.path().join("part.ngc");
            fs::write(&program, format!("G21 G90\n{text}M2\n")).unwrap();
            let program = program.to_str().unwrap();
            let orders =
                "override 37 at 1ms; override 200 at 300ms; hold at 500ms; resume at 700ms";
            let out = folder.path().join("out");
            let certificate = run(program, machine, orders, &out);
            assert_eq!(certificate["ended"], true, "{what} on {machine}");
            let seen = columns(&out, &["x_control_setpoint_mm"]);
            let end = seen[0].last().unwrap();
            assert!((end - x).abs() < 1e-6, "{what} on {machine}: X{end}");
        }
    }
}

#[test]
fn what_no_machine_can_do_is_refused_with_a_sentence() {
    let huge = format!("G1 X1{} F600", "0".repeat(300));
    let zero = fs::read_to_string(root().join("machines/bench-xyz.toml"))
        .unwrap()
        .replace("acceleration_m_per_s2 = 1 ", "acceleration_m_per_s2 = 0 ");
    let folder = tempfile::tempdir().unwrap();
    let machine = folder.path().join("zero.toml");
    fs::write(&machine, zero).unwrap();
    for (text, machine, expected) in [
        (huge.as_str(), "bench-xyz", "farther than any machine"),
        ("G1 X10 F6000\nG2 X10 Y0 I-10 J0 P1000000 Z-10", "bench-xyz", "expected at most 86400 s"),
        ("G1 X10 F0.0000001", "bench-xyz", "expected at most 86400 s"),
        ("G1 A200 F3600", "mill-5-axis", "travel of -110 to 110°: A110 is the nearest that works"),
        ("G1 A20 F3600", "bench-xyz", "the machine has no A axis"),
        ("G1 X10 F600", machine.to_str().unwrap(), "expected a number from 0.001 to 500"),
    ] {
        let program = folder.path().join("part.ngc");
        fs::write(&program, format!("G21 G90\n{text}\nM2\n")).unwrap();
        for command in ["check", "time", "run"] {
            let program = program.to_str().unwrap();
            let output = leadscrew(&[command, program, "--machine", machine]);
            let all = said(&output) + &complained(&output);
            assert_eq!(output.status.code(), Some(2), "{command} {text}: {all}");
            assert!(all.contains(expected), "{command} {text}: {all}");
        }
    }
}

/// 10 mm at 10 mm/s with 1000 mm/s² take 1.01 s, at one percent 101 s; nothing at all is given up,
/// and said.
#[test]
fn one_percent_is_waited_for_and_nothing_at_all_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("slow.ngc");
    fs::write(&program, "G21 G90 G94\nG1 X10 F600\nM2\n").unwrap();
    let program = program.to_str().unwrap();
    let ordered = |orders: &str| {
        let arguments = ["run", program, "--machine", "bench-xyz", "--operator", orders];
        leadscrew(&[&arguments[..], &["-q", "--format", "json"]].concat())
    };
    let slow = ordered("override 1 at 1ms");
    assert_eq!(slow.status.code(), Some(0), "{}", complained(&slow));
    let certificate: Value = serde_json::from_str(&said(&slow)).unwrap();
    assert!((certificate["cycle_time_s"].as_f64().unwrap() - 101.0).abs() < 0.1, "{certificate}");
    let held = ordered("override 0 at 0.5s");
    assert_eq!(held.status.code(), Some(3));
    assert!(complained(&held).contains("given up after 60 s"), "{}", complained(&held));
}

/// A machine with a B axis like the A axis of the embedded one: 90° at 1800 degrees a minute take 3
/// s; with G93 F10 a block takes 6 s.
#[test]
fn a_b_axis_feeds_as_a_and_c_do() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(root().join("machines/mill-5-axis.toml")).unwrap();
    let (from, to) = (text.find("[axes.a]").unwrap(), text.find("[axes.c]").unwrap());
    let b = text[from..to].replace("axes.a", "axes.b");
    let head = "extends = \"mill-5-axis\"\nname = \"with-b\"\ndescription = \"B too\"\n";
    let (machine, program) = (folder.path().join("with-b.toml"), folder.path().join("b.ngc"));
    fs::write(&machine, head.to_owned() + &b).unwrap();
    let blocks = "G21 G90 G54 G61.1 G94\nG1 B90 F1800\nG93 G1 X-100 A10 B0 C400 F10\nG91 G1 B30 C-400 F10\nG90 G28 B0\nM2\n";
    fs::write(&program, blocks).unwrap();
    let (machine, program) = (machine.to_str().unwrap(), program.to_str().unwrap());
    let estimate = leadscrew(&["time", program, "--machine", machine, "--format", "json"]);
    assert_eq!(estimate.status.code(), Some(0), "{}", complained(&estimate));
    let estimate: Value = serde_json::from_str(&said(&estimate)).unwrap();
    let feed = estimate["feed_time_s"].as_f64().unwrap();
    // each block has its ramps, and 5 ms at its end
    assert!((15.0..15.2).contains(&feed), "{feed} s");
    let run = run(program, machine, "override 100 at 1ms", &folder.path().join("out"));
    let took = run["cycle_time_s"].as_f64().unwrap();
    let planned = estimate["total_time_s"].as_f64().unwrap();
    assert!((took - planned).abs() < 5e-3, "{took} s of {planned} s");
    let [b] = columns(&folder.path().join("out"), &["b_control_setpoint_deg"]).try_into().unwrap();
    assert!(b.iter().fold(0.0_f64, |most, x| most.max(*x)) > 90.0 - 1e-6);
    assert!(b[b.len() - 1].abs() < 1e-6, "{}", b[b.len() - 1]);
    let [speed, accel, jerk] = largest(b, 250e-6);
    assert!(speed < 150.2 && accel < 1010.0 && jerk < 52_500.0, "{speed} {accel} {jerk}");
}

/// Rows 0.5 mm apart in lines of 0.47 mm: each line's number, where it begins and where it ends.
fn rows(text: &mut String) -> Vec<(u32, [[f64; 3]; 2])> {
    text.push_str("G21 G90 G17 G94 G64 P0.01\nG0 X0 Y0 Z0\nF4718\n");
    let (mut lines, mut from) = (Vec::new(), [0.0; 3]);
    for (number, k) in (4..).zip(0..256) {
        let (row, k) = (k / 64, k % 64);
        let x = 0.4708 * f64::from(if row % 2 == 0 { k } else { 63 - k });
        let z = (x / 3.0).sin() + 0.3 * (2.1 * x + f64::from(row)).sin();
        let to = [x, 0.5 * f64::from(row), z];
        text.push_str(&format!("G1 X{x:.6} Y{:.6} Z{z:.6}\n", to[1]));
        lines.push((number, [from, to]));
        from = to;
    }
    text.push_str("M2\n");
    lines
}

/// How far a place is from a straight way.
fn off([from, to]: [[f64; 3]; 2], at: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let minus = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|i| a[i] - b[i]);
    let way: [f64; 3] = minus(to, from);
    let share = (dot(minus(at, from), way) / dot(way, way).max(1e-12)).clamp(0.0, 1.0);
    let away = minus(at, core::array::from_fn(|i| from[i] + share * way[i]));
    dot(away, away).sqrt()
}

#[test]
fn whatever_an_operator_does_on_a_surface_the_line_that_is_named_is_the_one_that_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("rows.ngc");
    let mut text = String::new();
    let lines = rows(&mut text);
    fs::write(&program, text).unwrap();
    let orders = [
        (
            "bench-xyz",
            "single-block on at 1s; single-block off at 1.152s; resume at 2s; single-block on at 2.654s; \
             single-block off at 2.788s; resume at 3.654s; override 130 at 4.727s",
        ),
        (
            "bench-xyz-jerk20",
            "single-block on at 1s; single-block off at 1.287s; resume at 2s; override 61 at 2.294s; \
             single-block on at 2.868s; single-block off at 3.27s; resume at 3.868s; override 134 at 6s",
        ),
    ];
    for (machine, orders) in orders {
        let out = folder.path().join(machine);
        run(program.to_str().unwrap(), machine, orders, &out);
        let mut looked_at = 0;
        for group in store::trace::Reader::open(&out.join("trace.parquet")).unwrap() {
            let group = group.unwrap();
            let axis = |name| group.column(&format!("{name}_control_setpoint_mm")).unwrap();
            let [x, y, z] = ["x", "y", "z"].map(axis);
            for (at, line) in group.line.iter().enumerate() {
                let Some(named) = lines.iter().position(|(number, _)| number == line) else {
                    continue;
                };
                // a span of the curve that serves two lines has the name of the first
                let near = &lines[named..lines.len().min(named + 2)];
                let off = near.iter().map(|(_, ends)| off(*ends, [x[at], y[at], z[at]]));
                let off = off.fold(f64::INFINITY, f64::min);
                assert!(off < 0.05, "{machine}: line {line} is named {off:.3} mm away from it");
                looked_at += 1;
            }
        }
        assert!(looked_at > 5_000, "{looked_at}");
    }
}
