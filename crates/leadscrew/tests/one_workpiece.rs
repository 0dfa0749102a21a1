//! One workpiece, cut by several tools: what must not pass, and its neighbour that must.
//!
//! Each row is a small program in words of its own (see [`Program`]), with what is expected of it:
//! `good`, or what the reasons of the features that are not good say. Millimetres in G54; the block
//! is 400 × 300 × 40 mm with its top at Z0.
use control::job::ProgramOptions;
use leadscrew::{Ending, Program, RunOptions};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The shipped tools, and mills whose limits are stated.
fn tools() -> (PathBuf, tempfile::TempDir) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs/tools.toml");
    let mut text = std::fs::read_to_string(shipped).unwrap();
    let mills = [(51, 5.0, "flat"), (52, 12.0, "flat"), (53, 20.0, "flat"), (54, 12.0, "conical")];
    for (number, diameter, form) in mills {
        let angle = if form == "conical" { "point_angle_deg = 90.0\n" } else { "" };
        write!(
            text,
            "\n[[tool]]\nnumber = {number}\nkind = \"end-mill\"\ndescription = \"mill\"\ndiameter_mm = {diameter}\n\
             length_mm = 110.0\nform = \"{form}\"\n{angle}teeth = 3\nstick_out_mm = 50\nmax_chip_mm = 1.0\n\
             max_depth_mm = 40\n"
        )
        .unwrap();
    }
    for (number, diameter, kind) in
        [(61, 6.85, "drill"), (62, 7.5, "drill"), (63, 12.0, "drill"), (64, 16.0, "spot-drill")]
    {
        let angle = if kind == "drill" { 118.0 } else { 90.0 };
        write!(
            text,
            "\n[[tool]]\nnumber = {number}\nkind = \"{kind}\"\ndescription = \"drill\"\ndiameter_mm = {diameter}\n\
             point_angle_deg = {angle:.1}\nlength_mm = 120.0\n"
        )
        .unwrap();
    }
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("tools.toml");
    std::fs::write(&path, text).unwrap();
    (path, home)
}

const HEAD: &str = "G21 G17 G40 G49 G80 G90 G94 G54\n";

/// A number of a step.
fn number(words: &[&str], at: usize) -> f64 {
    words[at].parse().unwrap_or_else(|_| panic!("{words:?}"))
}

/// The G-code of steps between semicolons:
///
/// | step | |
/// |---|---|
/// | `drill D X Y Z`, `spot X Y Z`, `sink X Y Z`, `counter X Y Z` | G81 to Z below the top; with a spot drill of 10 or 16 mm, with the end mill of 12 mm |
/// | `deep D X Y Z`, `chip D X Y Z` | G83, G73 |
/// | `within D X Y Z R` | G81 from this R |
/// | `plunge D X Y Z` | drilled by G1, without a cycle |
/// | `tap M X Y Z [R]`, `peck M X Y Z` | G84; in pecks |
/// | `slot D X1 Y1 X2 Y2 Z` | milled straight |
/// | `ring R X Y Z` | the mill of 5 mm in a circle; `pocket R …`: of 12 mm, all of it |
/// | `bevel R X Y Z` | the conical mill in a circle |
/// | `raw …` | as it is |
fn gcode(steps: &str) -> String {
    let mut text = HEAD.to_owned();
    for step in steps.split(';').map(str::trim).filter(|step| !step.is_empty()) {
        let words: Vec<&str> = step.split_whitespace().collect();
        let n = |at| number(&words, at);
        let drill = |d: &str| match d {
            "2.5" => 4,
            "5" => 2,
            "6.8" => 10,
            "6.85" => 61,
            "7.5" => 62,
            "8.5" => 5,
            "12" => 63,
            "20" => 53,
            other => panic!("no drill of {other}"),
        };
        let call = |tool: u32, speed: f64| format!("T{tool} M6\nG43 H{tool}\nS{speed} M3\n");
        let cycle = |tool: u32, code: &str, x: f64, y: f64, z: f64, r: f64| {
            let to = format!("G0 X{x} Y{y} Z10\nG98 {code} X{x} Y{y} Z-{z} R{r} F900\nG80\n");
            call(tool, 3000.0) + &to
        };
        text += &match words[0] {
            "drill" => cycle(drill(words[1]), "G81", n(2), n(3), n(4), 2.0),
            "within" => cycle(drill(words[1]), "G81", n(2), n(3), n(4), n(5)),
            "deep" => cycle(drill(words[1]), "G83 Q5", n(2), n(3), n(4), 2.0),
            "chip" => cycle(drill(words[1]), "G73 Q5", n(2), n(3), n(4), 2.0),
            "spot" => cycle(1, "G81", n(1), n(2), n(3), 2.0),
            "sink" => cycle(64, "G81", n(1), n(2), n(3), 2.0),
            "counter" => cycle(52, "G81", n(1), n(2), n(3), 2.0),
            "plunge" => {
                let (x, y, z) = (n(2), n(3), n(4));
                let to = format!("G0 X{x} Y{y} Z10\nG0 Z2\nG1 Z-{z} F900\nG0 Z10\n");
                call(drill(words[1]), 3000.0) + &to
            }
            "tap" | "peck" => {
                let (tool, pitch) = match words[1] {
                    "3" => (6, 0.5),
                    "6" => (3, 1.0),
                    "8" => (11, 1.25),
                    "10" => (7, 1.5),
                    other => panic!("no tap M{other}"),
                };
                let (x, y, z) = (n(2), n(3), n(4));
                let r = words.get(5).map_or(5.0, |r| r.parse().unwrap());
                let pecks = if words[0] == "peck" { " Q6" } else { "" };
                let feed = 900.0 * pitch;
                let to =
                    format!("G0 X{x} Y{y} Z10\nG98 G84 X{x} Y{y} Z-{z} R{r}{pecks} F{feed}\nG80\n");
                call(tool, 900.0) + &to
            }
            "slot" => {
                let tool = match words[1] {
                    "5" => 51,
                    "12" => 52,
                    "20" => 53,
                    other => panic!("no mill of {other}"),
                };
                let [x1, y1, x2, y2, z] = [2, 3, 4, 5, 6].map(n);
                let down = format!("G0 X{x1} Y{y1} Z10\nG0 Z2\nG1 Z{} F1500\n", -z);
                call(tool, 3000.0) + &down + &format!("G1 X{x2} Y{y2}\nG0 Z10\n")
            }
            "ring" | "bevel" | "pocket" => {
                let [r, x, y, z] = [1, 2, 3, 4].map(n);
                let (tool, own) = match words[0] {
                    "ring" => (51, 2.5),
                    "bevel" => (54, 0.0),
                    _ => (52, 6.0),
                };
                let mut to = call(tool, 4000.0) + &format!("G0 X{x} Y{y} Z10\n");
                let rings =
                    if words[0] == "bevel" { 1 } else { ((r - own) / 5.0).ceil().max(1.0) as u32 };
                for k in 1..=rings {
                    let off = (r - own) * f64::from(k) / f64::from(rings);
                    let at = x + off;
                    to += &format!("G0 X{at} Y{y} Z2\nG1 Z-{z} F1500\nG3 X{at} Y{y} I-{off} J0\n");
                    to += "G0 Z10\n";
                }
                to
            }
            "raw" => step[3..].trim().replace('|', "\n") + "\n",
            other => panic!("no step {other}"),
        };
    }
    text + "G0 Z30\nM5\nM2\n"
}

struct Attack {
    steps: &'static str,
    /// What is said of what is not good; nothing: it is good.
    says: &'static [&'static str],
}

const fn bad(steps: &'static str, says: &'static [&'static str]) -> Attack {
    Attack { steps, says }
}

const fn good(steps: &'static str) -> Attack {
    Attack { steps, says: &[] }
}

/// Runs all of them, on the cores that there are.
fn check(attacks: &[Attack]) {
    let (table, _home) = tools();
    let next = AtomicUsize::new(0);
    let wrong = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(attack) = attacks.get(next.fetch_add(1, Relaxed)) {
                    if let Err(why) = held(attack, &table) {
                        wrong.lock().unwrap().push(format!("{}\n    {why}", attack.steps));
                    }
                }
            });
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), attacks.len(), wrong.join("\n"));
}

fn held(attack: &Attack, table: &Path) -> Result<(), String> {
    let options =
        ProgramOptions { tools: Some(table.to_owned()), ..ProgramOptions::from("tapping-center") };
    let job = Program::of("part", gcode(attack.steps)).on(options);
    let finished = match job.and_then(|job| job.run(&RunOptions::default())) {
        Ok(finished) => finished,
        // it is refused before anything moves
        Err(why) if attack.says.iter().any(|said| why.sentence().contains(said)) => return Ok(()),
        Err(why) => return Err(format!("it is refused: {}", why.sentence())),
    };
    let said: Vec<String> = finished
        .features()
        .iter()
        .filter_map(|f| {
            f.verdict.reason().map(|why| format!("{} line {}: {why}", f.kind_name(), f.line))
        })
        .collect();
    let is_good = finished.ending() == Ending::Good;
    let all = said.join("\n    ");
    if is_good != attack.says.is_empty() {
        return Err(format!("ended {:?}: {all}", finished.ending()));
    }
    match attack.says.iter().find(|part| !all.contains(**part)) {
        Some(part) => Err(format!("\"{part}\" is not said, but: {all}")),
        None => Ok(()),
    }
}

#[test]
fn a_finished_thread_that_a_drill_or_a_tap_comes_to_again_is_what_is_left_of_it() {
    check(&[
        good("drill 6.8 20 20 24; tap 8 20 20 18"),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; drill 8.5 20 20 24",
            &["thread", "destroyed in line 18: nothing is left"],
        ),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; drill 8.5 20 20 12",
            &["destroyed in line 18", "mm are left"],
        ),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; drill 7.5 20 20 24", &["destroyed in line 18"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; drill 12 20 20 30", &["nothing is left"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; counter 20 20 6", &["destroyed in line 18"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; sink 20 20 7.5", &["destroyed in line 18"]),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; drill 8.5 20 20 24; tap 10 20 20 18",
            &["thread line 12: good when cut, destroyed"],
        ),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; plunge 8.5 20 20 20", &["destroyed in line 19"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; deep 8.5 20 20 24", &["destroyed in line 18"]),
        // what changes nothing
        good("drill 6.8 20 20 24; tap 8 20 20 18; drill 6.8 20 20 24"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; drill 6.8 20 20 30"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; deep 6.8 20 20 30"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; drill 5 20 20 35"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; spot 20 20 4.5"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; sink 20 20 5"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; drill 6.85 20 20 24"),
    ]);
}

#[test]
fn holes_before_a_tap_that_belong_to_its_thread_leave_it_good() {
    check(&[
        good("spot 20 20 4.2; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 5 20 20 24; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 5 20 20 12; drill 5 20 20 24; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("sink 20 20 5; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 6.8 20 20 24; sink 20 20 5; tap 8 20 20 18"),
        good("deep 6.8 20 20 24; tap 8 20 20 18"),
        good("chip 6.8 20 20 24; tap 8 20 20 18"),
        good("plunge 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 6.8 20 20 24; peck 8 20 20 18"),
        good("drill 6.8 20 20 12; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("counter 20 20 2; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 6.8 20 20 32; counter 20 20 5; tap 8 20 20 22"),
        good("counter 20 20 10; within 6.8 20 20 34 -8; tap 8 20 20 28 -8"),
    ]);
}

#[test]
fn a_tap_in_what_was_bored_away_has_cut_nothing_there() {
    check(&[
        bad(
            "drill 6.8 20 20 24; drill 8.5 20 20 10; tap 8 20 20 18",
            &["in the air, where the material was bored in line 12 away"],
        ),
        bad("drill 8.5 20 20 10; drill 6.8 20 20 24; tap 8 20 20 18", &["in the air"]),
        bad("drill 6.8 20 20 24; counter 20 20 10; tap 8 20 20 18", &["in the air"]),
        bad("drill 8.5 20 20 30; tap 8 20 20 18", &["expected a hole of 6.647"]),
        bad(
            "drill 6.8 20 20 24; drill 8.5 20 20 24; tap 8 20 20 18",
            &["expected a hole of 6.647"],
        ),
        bad(
            "drill 6.8 20 20 24; drill 7.5 20 20 24; tap 8 20 20 18",
            &["outside the minor diameter"],
        ),
        bad("drill 6.8 20 20 24; drill 7.5 20 20 12; tap 8 20 20 18", &["in the air"]),
        bad("drill 6.8 20 20 24; sink 20 20 7.9; tap 8 20 20 12", &["thread"]),
    ]);
}

#[test]
fn holes_that_break_into_one_another_are_out() {
    check(&[
        bad(
            "drill 6.8 20 20 20; drill 6.8 23 20 20",
            &[
                "hole line 6: good when cut, destroyed in line 12",
                "it breaks into the hole of line 6",
            ],
        ),
        bad("drill 6.8 20 20 20; drill 6.8 20 25 12", &["it breaks into the hole of line 6"]),
        bad("drill 6.8 20 20 20; drill 12 26 20 20", &["it breaks into the hole of line 6"]),
        bad("drill 6.8 20 20 20; drill 6.8 20.5 20 20", &["it breaks into the hole of line 6"]),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; drill 6.8 21.5 20 12",
            &[
                "thread line 12: good when cut, destroyed in line 18",
                "it breaks into the thread of line 12",
            ],
        ),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; drill 6.8 26.9 20 12",
            &["thread line 12", "destroyed in line 18"],
        ),
        bad(
            "drill 6.8 20 20 24; drill 6.8 27.2 20 24; tap 8 20 20 18",
            &["it breaks into the hole of line 12"],
        ),
        bad(
            "drill 6.8 20 20 24; drill 6.8 27.2 20 24; tap 8 20 20 18; tap 8 27.2 20 18",
            &["thread"],
        ),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; plunge 5 25 20 12", &["destroyed"]),
        good("drill 6.8 20 20 20; drill 6.8 27 20 20"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; drill 6.8 27.6 20 12"),
        good("drill 6.8 20 20 24; drill 6.8 28.2 20 24; tap 8 20 20 18; tap 8 28.2 20 18"),
        good("drill 6.8 20 20 20; drill 8.5 20 20 10; drill 12 20 20 5"),
        good("drill 5 20 20 20; drill 12 21 20 6"),
        good("drill 5 18 20 20; drill 5 23.5 20 20; spot 28 20 1"),
    ]);
}

#[test]
fn what_a_mill_does_to_a_thread_is_done_to_it() {
    check(&[
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; slot 12 0 20 40 20 6",
            &["thread line 12: good when cut, destroyed in line"],
        ),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; slot 5 0 20 40 20 3", &["destroyed in line"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; slot 5 0 24 40 24 3", &["destroyed in line"]),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; slot 20 0 20 40 20 1",
            &["1.00 mm of its", "mm are left"],
        ),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; pocket 10 20 20 12", &["destroyed in line"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; ring 4.5 20 20 4", &["destroyed in line"]),
        bad("drill 6.8 20 20 24; tap 8 20 20 18; slot 12 0 20 40 20 25", &["nothing is left"]),
        good("drill 6.8 20 20 24; tap 8 20 20 18; slot 12 0 40 40 40 6"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; slot 5 0 27 40 27 6"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; slot 12 60 20 80 20 3; slot 12 0 20 40 20 -0.5"),
        good("drill 6.8 20 20 24; tap 8 20 20 18; bevel 3.9 20 20 0.5"),
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; ring 3 20 20 10",
            &["milling line 19: it met no stock"],
        ),
    ]);
}

#[test]
fn what_is_drilled_and_tapped_where_a_mill_was_begins_at_what_it_has_left() {
    check(&[
        bad("pocket 10 20 20 20; tap 8 20 20 18", &["not cut"]),
        bad(
            "drill 6.8 20 20 24; pocket 10 20 20 12; tap 8 20 20 18",
            &["in the air, where the material was milled away"],
        ),
        bad("pocket 10 20 20 12; drill 6.8 20 20 24; tap 8 20 20 18", &["in the air"]),
        bad("pocket 10 20 20 12; drill 6.8 20 20 10", &["not cut"]),
        bad("slot 5 0 20 40 20 12; drill 6.8 20 20 24; tap 8 20 20 18", &["in the air"]),
        good("pocket 10 20 20 3; drill 6.8 20 20 24; tap 8 20 20 18"),
        good("drill 6.8 20 20 24; pocket 10 20 20 3; tap 8 20 20 18"),
        good("pocket 12 20 20 10; within 6.8 20 20 34 -8; tap 8 20 20 28 -8"),
        good("pocket 10 20 20 5; drill 6.8 20 20 20"),
        good("drill 6.8 20 20 20; pocket 10 20 20 5"),
        good("drill 12 20 20 10; pocket 15 20 20 10"),
        good("ring 3.4 20 20 24; tap 8 20 20 18; drill 6.8 40 20 24"),
    ]);
}

#[test]
fn a_hole_that_no_one_saw_is_not_judged_where_the_program_drills() {
    const UNSEEN: &str = "no hole was drilled here before it was tapped";
    check(&[
        bad("spot 20 20 4; tap 8 20 20 18", &[UNSEEN]),
        bad("tap 8 20 20 18; drill 6.8 20 20 24", &[UNSEEN]),
        bad("tap 8 20 20 18; drill 6.8 40 20 24", &[UNSEEN]),
        bad(
            "drill 6.8 20 20 24; drill 6.8 40 20 24; tap 8 20 20 18; tap 8 40 20 18; tap 8 60 20 18",
            &[UNSEEN],
        ),
        bad("drill 6.8 20 20 24; raw G10 L2 P1 R30; tap 8 20 20 18", &[UNSEEN]),
        bad("drill 6.8 20 20 24; tap 8 -20 20 18", &[UNSEEN]),
        bad("drill 6.8 20 20 24; tap 8 20 -20 18", &[UNSEEN]),
        bad("drill 6.8 20 40 24; tap 8 40 20 18", &[UNSEEN]),
        bad("plunge 6.8 40 20 24; tap 8 20 20 18", &[UNSEEN]),
        bad("tap 8 20 20 18; plunge 6.8 40 20 24", &[UNSEEN]),
        good("tap 8 20 20 18"),
        good("raw (PRE-DRILLED); drill 6.8 40 20 24; tap 8 20 20 18"),
        good("raw (pre-drilled: a casting); tap 8 20 20 18; drill 6.8 40 20 24"),
        good("drill 6.8 20 20 24; raw G10 L2 P1 R30; drill 6.8 20 20 24; tap 8 20 20 18"),
    ]);
}

#[test]
fn a_thread_tapped_again_is_one_thread_in_its_own_groove_and_none_beside_it() {
    check(&[
        bad(
            "drill 6.8 20 20 24; tap 8 20 20 18; raw G0 X20.3 Y20 Z10|G98 G84 X20 Y20 Z-18 R4.4 F1125|G80",
            &["beside the groove of the thread"],
        ),
        bad("drill 8.5 20 20 24; tap 10 20 20 18; tap 8 20 20 18", &["expected a hole of 6.647"]),
    ]);
}

#[test]
fn the_stock_of_a_comment_is_that_of_holes_too() {
    check(&[
        good("raw (STOCK X-60 Y-60 Z-40 X60 Y60 Z2); drill 6.8 20 20 24; tap 8 20 20 18"),
        bad("raw (STOCK X-60 Y-60 Z-40 X60 Y60 Z-26); drill 6.8 20 20 24", &["not cut"]),
        bad("raw (STOCK X-60 Y-60 Z-40 X15 Y60 Z0); drill 6.8 20 20 24", &["not cut"]),
        bad(
            "raw (STOCK X-60 Y-60 Z-40 X22 Y60 Z0); drill 6.8 20 20 24",
            &["breaks through a side of the stock"],
        ),
        good("raw (STOCK X150 Y60 Z-40 X260 Y140 Z0); drill 6.8 230 100 24; tap 8 230 100 18"),
    ]);
}
