//! What `leadscrew polygon` claims of a block, and what the block cuts when it is run as it was
//! printed.
use crate::common::{complained, leadscrew, said};
use serde_json::Value;
use std::path::Path;
use test_support::size;

/// What is designed: arguments of `leadscrew polygon`, and where the inserts stand.
struct Design {
    words: Vec<String>,
    radius: f64,
    inserts: Vec<f64>,
}

/// What came of it, µm.
struct Came {
    claimed: f64,
    servo_error: f64,
    size_error: f64,
    flatness: f64,
    size: f64,
    verdict: String,
}

impl Design {
    /// A form by its inserts (degrees), ratio, size and tip radius (mm), what swings and how fast.
    /// Where each turn of the work is like the one before, three turns a millimetre show at a
    /// change's size what ten do.
    fn of(inserts: &[f64], ratio: &str, size: f64, radius: f64, actuator: &str, rpm: f64) -> Self {
        let angles: Vec<String> = inserts.iter().map(ToString::to_string).collect();
        let coarse = if ratio.starts_with("1:") { "0.3" } else { FINE };
        let pairs = [
            ("--insert-angles", angles.join(",")),
            ("--ratio", ratio.to_owned()),
            ("--across-flats", size.to_string()),
            ("--tip-radius", radius.to_string()),
            ("--actuator", actuator.to_owned()),
            ("--speed", rpm.to_string()),
            ("--tool", "21".to_owned()),
            ("--length", "1".to_owned()),
            ("--feed", size::of(coarse, FINE).to_owned()),
        ];
        let words = pairs.into_iter().flat_map(|(name, value)| [name.to_owned(), value]);
        Self { words: words.collect(), radius, inserts: inserts.to_vec() }
    }

    /// The block that the command prints.
    fn block(&self) -> String {
        let words: Vec<&str> = self.words.iter().map(String::as_str).collect();
        let output = leadscrew(&[&["polygon", "--format", "json"], &words[..]].concat());
        let told: Value = serde_json::from_str(&said(&output)).unwrap();
        told["gcode"].as_str().unwrap().to_owned()
    }

    /// Design it, put the printed block into a program, run that; `None`: it cannot be cut at that
    /// speed, and the command says so.
    fn came(&self, machine: &str) -> Option<Came> {
        let folder = tempfile::tempdir().unwrap();
        let words: Vec<&str> = self.words.iter().map(String::as_str).collect();
        let output = leadscrew(&[&["polygon", "--format", "json"], &words[..]].concat());
        let told: Value = serde_json::from_str(&said(&output))
            .unwrap_or_else(|e| panic!("{words:?}: {e}: {}", complained(&output)));
        let run = self.run(folder.path(), told["gcode"].as_str().unwrap(), machine);
        let Value::Object(claim) = &told["claim"] else {
            assert!(run.is_none(), "{words:?}: refused by the command, {}", told["refused"]);
            return None;
        };
        let part = run.unwrap_or_else(|| panic!("{words:?}: claimed and refused"));
        let claim = |key: &str| claim[key].as_f64().unwrap();
        let cut = |key: &str| part[key].as_f64().unwrap();
        Some(Came {
            claimed: claim("flatness_um"),
            servo_error: claim("servo_error_um"),
            size_error: claim("across_flats_error_um"),
            flatness: cut("flatness_um"),
            size: cut("across_flats_error_um"),
            verdict: part["verdict"].as_str().unwrap().to_owned(),
        })
    }

    /// The part that a block cuts; `None`: it is refused.
    fn run(&self, folder: &Path, block: &str, machine: &str) -> Option<Value> {
        let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
        let tool = format!(
            "[[tool]]\nnumber = 21\nkind = \"polygon-cutter\"\ntip_radius_mm = {:.4}\ninsert_angles_deg = {:.4?}\nnose_radius_mm = 0.8\nlength_mm = 60.0\n",
            self.radius, self.inserts
        );
        std::fs::write(at("tools.toml"), tool).unwrap();
        std::fs::write(at("part.nc"), format!("{block}M2\n")).unwrap();
        let (part, tools, out) = (at("part.nc"), at("tools.toml"), at("out"));
        let words = ["run", &part, "--machine", machine, "--tools", &tools, "-q", "--out", &out];
        let _ = leadscrew(&words);
        let found = std::fs::read_to_string(folder.join("out/certificate.json")).ok()?;
        let certificate: Value = serde_json::from_str(&found).unwrap();
        Some(certificate["features"][0].clone())
    }

    /// The cut differs from the claim by no more than the servo error that stands beside it, and is
    /// judged as was to be expected.
    #[track_caller]
    fn is_cut_as_claimed(&self, machine: &str) -> bool {
        let Some(came) = self.came(machine) else { return false };
        println!(
            "{}: {:.3} µm claimed, {:.3} µm cut, servo error {:.3} µm; across flats {:+.1} µm of {:.1}",
            self.words.join(" "),
            came.claimed,
            came.flatness,
            came.servo_error,
            came.size,
            came.size_error
        );
        let off = (came.flatness - came.claimed).abs();
        assert!(off <= came.servo_error, "{off} of {} µm: {:?}", came.servo_error, self.words);
        assert!(came.size.abs() <= came.size_error, "{} of {} µm", came.size, came.size_error);
        // 20 µm of flatness are allowed
        if came.claimed + came.servo_error <= ALLOWED_UM {
            assert_eq!(came.verdict, "pass", "{:?}", self.words);
        }
        if came.claimed - came.servo_error > ALLOWED_UM {
            assert_eq!(came.verdict, "fail", "{:?}", self.words);
        }
        true
    }
}

const LATHE: &str = "polygon-lathe";
/// Feed as the documents have it, mm/rev.
const FINE: &str = "0.1";
/// Flatness of a facet, ISO 2768-2 H up to 30 mm.
const ALLOWED_UM: f64 = 20.0;

#[test]
fn a_square_of_30_mm_is_cut_as_claimed_whatever_swings() {
    for actuator in size::first_of(3, &["x", "y", "all", "phase", "xy", "x-phase"]) {
        let square = Design::of(&[0.0, 180.0], "1:2", 30.0, 50.0, actuator, 60.0);
        assert!(square.is_cut_as_claimed(LATHE), "{actuator} is refused");
    }
}

/// Both on the same plant: machine, seed, tool, bar and feed are the same, and of the program one
/// block differs.
#[test]
fn a_square_by_x_is_cut_flatter_than_with_the_block_that_is_written_by_hand() {
    const BY_HAND: &str = "G51.2 P1 Q2 I0.014852";
    let square = Design::of(&[0.0, 180.0], "1:2", 30.0, 50.0, "x", 60.0);
    let ours = square.block();
    assert_eq!(ours.lines().filter(|line| line.starts_with("G51.2")).count(), 1, "{ours}");
    // the tables of harmonics and the look in the air are ours
    let lines =
        ours.lines().filter(|line| !line.starts_with("G51.3") && !line.starts_with("G51.4"));
    let lines = lines.map(|line| if line.starts_with("G51.2") { BY_HAND } else { line });
    let by_hand: String = lines.flat_map(|line| [line, "\n"]).collect();
    for seed in [1, 5] {
        let folder = tempfile::tempdir().unwrap();
        let plant = machine(folder.path(), &format!("[simulation]\nseed = {seed}\n"));
        let flatness = |block: &str| {
            let part = square.run(folder.path(), block, &plant).unwrap();
            part["flatness_um"].as_f64().unwrap()
        };
        let (ours, by_hand) = (flatness(&ours), flatness(&by_hand));
        println!("seed {seed}: {ours:.3} µm designed, {by_hand:.3} µm by hand");
        assert!(ours < by_hand, "seed {seed}: {ours} µm designed, {by_hand} µm by hand");
    }
}

#[test]
fn hexagons_pentagons_triangles_and_two_flats_are_cut_as_claimed() {
    let thirds = [0.0, 120.0, 240.0];
    let designs = [
        (&thirds[..], "1:2", 17.0, 50.0, "auto", 500.0),
        (&[0.0], "2:5", 17.0, 50.0, "phase", 400.0),
        (&[0.0], "1:3", 17.0, 50.0, "phase", 200.0),
        (&[0.0], "1:2", 20.0, 50.0, "x-phase", 300.0),
        (&[0.0, 90.0, 180.0, 270.0], "1:2", 27.0, 70.0, "phase", 700.0),
        // at night: what takes seconds to design
        (&[0.0], "2:5", 17.0, 50.0, "auto", 400.0),
        (&[0.0, 90.0, 180.0, 270.0], "1:2", 27.0, 70.0, "auto", 700.0),
        (&thirds[..], "1:2", 17.0, 50.0, "x", 250.0),
        (&thirds[..], "1:2", 17.0, 50.0, "all", 900.0),
    ];
    for &(inserts, ratio, size, radius, actuator, rpm) in size::first_of(5, &designs) {
        let design = Design::of(inserts, ratio, size, radius, actuator, rpm);
        assert!(design.is_cut_as_claimed(LATHE), "{:?} is refused", design.words);
    }
}

#[test]
fn a_rhombus_and_a_form_without_symmetry_are_cut_as_claimed() {
    for &(actuator, rpm) in size::first_of(1, &[("xy", 60.0), ("auto", 500.0), ("x", 60.0)]) {
        let rhombus = Design::of(&[0.0, 90.0], "1:2", 17.0, 50.0, actuator, rpm);
        assert!(rhombus.is_cut_as_claimed(LATHE), "{actuator} is refused");
    }
    for actuator in size::first_of(1, &["x-phase", "phase", "xy"]) {
        let uneven = Design::of(&[0.0, 100.0, 200.0], "1:2", 17.0, 50.0, actuator, 200.0);
        assert!(uneven.is_cut_as_claimed(LATHE), "{actuator} is refused");
    }
}

/// A machine beside the embedded one, from a few lines that differ.
fn machine(folder: &Path, differs: &str) -> String {
    let path = folder.join("machine.toml").to_str().unwrap().to_owned();
    std::fs::write(&path, format!("extends = \"polygon-lathe\"\nname = \"another\"\n{differs}"))
        .unwrap();
    path
}

#[test]
fn the_documents_small_square_is_cut_as_claimed_from_a_bar_that_its_tips_leave() {
    // 10 mm by a tip radius of 5 mm: it was cut to 25.6 µm
    let folder = tempfile::tempdir().unwrap();
    let bar = "[setup.stock]\nx_from_mm = -8\nx_to_mm = 8\ny_from_mm = -8\ny_to_mm = 8\n";
    let bar = machine(folder.path(), bar);
    for actuator in ["x", "phase"] {
        let mut square = Design::of(&[0.0, 180.0], "1:2", 10.0, 5.0, actuator, 30.0);
        square.words.extend(["--machine".to_owned(), bar.clone()]);
        assert!(square.is_cut_as_claimed(&bar), "{actuator} is refused");
    }
}

/// The plant is not what its file says: friction and play of another one, by seed.
#[test]
fn the_servo_error_covers_a_machine_whose_friction_and_play_are_not_as_stated() {
    for (seed, designs) in
        [(2, [("x", 100.0), ("phase", 500.0)]), (7, [("xy", 60.0), ("x-phase", 200.0)])]
    {
        let folder = tempfile::tempdir().unwrap();
        let other = format!("[simulation]\nseed = {seed}\nscatter_percent = 20\n");
        let other = machine(folder.path(), &other);
        for (actuator, rpm) in designs {
            let square = Design::of(&[0.0, 180.0], "1:2", 30.0, 50.0, actuator, rpm);
            assert!(square.is_cut_as_claimed(&other), "{actuator} is refused");
        }
    }
}

/// A number from 0 to 1, by a linear congruence (Knuth, MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        (low + (high - low) * self.next()).round()
    }

    fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[(self.next() * all.len() as f64) as usize].clone()
    }
}

/// Any polygon that the lathe and its bar of 50 mm allow.
fn any(random: &mut Random) -> Design {
    let actuator = random.of(&["x", "y", "xy", "phase", "x-phase", "all"]);
    let (inserts, ratio, most) = random.of(&[
        (vec![0.0, 180.0], "1:2", 34.0),
        (vec![0.0, 120.0, 240.0], "1:2", 42.0),
        (vec![0.0, 90.0, 180.0, 270.0], "1:2", 45.0),
        (vec![0.0], "2:5", 39.0),
        (vec![0.0], "1:3", 24.0),
        (vec![0.0, 180.0], "1:3", 42.0),
        (vec![0.0, 90.0], "1:2", 19.0),
        (vec![0.0, 70.0, 200.0], "1:2", 18.0),
    ]);
    let size = random.between(8.0, most);
    let radius = random.between(35.0, 90.0);
    Design::of(&inserts, ratio, size, radius, actuator, random.between(60.0, 700.0))
}

#[test]
fn any_polygon_is_cut_as_claimed_or_refused_by_the_command_that_prints_it() {
    let mut random = Random(20_261_123);
    let count = size::of(3, 100);
    // a design in which everything swings takes seconds: a change's size has them elsewhere
    let designs = std::iter::repeat_with(|| any(&mut random))
        .filter(|design| size::is_full() || !design.words.contains(&"all".to_owned()));
    let cut = designs.take(count).filter(|design| design.is_cut_as_claimed(LATHE)).count();
    assert!(2 * cut >= count, "{cut} of {count} were cut at all");
}

/// One harmonic as the method's source writes it, geared far from the work and cut nearer.
#[test]
fn i_and_j_count_in_the_distance_at_which_it_is_cut() {
    let flatness = |begun: f64, by: &str| {
        let square = Design::of(&[0.0, 180.0], "1:2", 30.0, 50.0, "x", 60.0);
        let folder = tempfile::tempdir().unwrap();
        let block = format!(
            "G21 G90 G94 G17\nT21 M6\nG43 H21\nG0 X{begun} Y0 Z5\nM3 S60\nG51.2 P1 Q2 {by}\nG0 X65 Z2\nG1 Z-1.5 F18\nG0 X85\nG50.2\nM5\n"
        );
        let part = square.run(folder.path(), &block, LATHE).unwrap();
        part["flatness_um"].as_f64().unwrap()
    };
    for by in ["I0.014852", "J0.02915"] {
        let (near, far) = (flatness(77.0, by), flatness(95.0, by));
        println!("{by}: {near} µm, {far} µm");
        assert!((near - far).abs() < 0.1 && near < 7.0, "{near} {far}");
    }
}

#[test]
fn an_oscillation_that_is_measured_in_the_air_cuts_no_worse_than_one_that_is_not() {
    let square = Design::of(&[0.0, 180.0], "1:2", 30.0, 50.0, "phase", 500.0);
    for (by, rpm, gains) in [("D4", 500, 0.1), ("D2", 100, 0.0)] {
        let cut = |measured: &str| {
            let folder = tempfile::tempdir().unwrap();
            let block = format!(
                "G21 G90 G94 G17\nT21 M6\nG43 H21\nG0 X85 Y0 Z5\nM3 S{rpm}\nG51.2 P1 Q2 {by}\n{measured}\nG0 X65 Z2\nG1 Z-1.5 F{}\nG0 X85\nG50.2\nM5\n",
                rpm / 10
            );
            let part = square.run(folder.path(), &block, LATHE).unwrap();
            part["flatness_um"].as_f64().unwrap()
        };
        let (plain, measured) = (cut(""), cut("G51.4 P4"));
        assert!(measured <= plain - gains + 0.01, "{by}: {measured} µm, {plain} µm without");
    }
}

/// The block that is printed ends itself: it is checked and run as it stands.
#[test]
fn a_printed_block_is_a_program() {
    let sizes = ["17", "30"];
    for across in size::first_of(1, &sizes) {
        for sides in ["4", "6"] {
            let words = [
                "polygon",
                "--sides",
                sides,
                "--across-flats",
                across,
                "--length",
                "2",
                "--format",
                "json",
            ];
            let told: Value = serde_json::from_str(&said(&leadscrew(&words))).unwrap();
            let folder = tempfile::tempdir().unwrap();
            let program = folder.path().join("part.ngc");
            std::fs::write(&program, told["gcode"].as_str().unwrap()).unwrap();
            let program = program.to_str().unwrap();
            let checked = leadscrew(&["check", program, "--machine", "polygon-lathe"]);
            assert!(checked.status.success(), "{}", complained(&checked));
            let ran = leadscrew(&["run", program, "--machine", "polygon-lathe", "-q"]);
            assert!(matches!(ran.status.code(), Some(0 | 1)), "{}", complained(&ran));
        }
    }
}
