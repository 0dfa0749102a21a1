//! Programs for which no machine is named, folders of them, and what they may leave to the machine.
use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

fn leadscrew(words: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leadscrew")).args(words).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// As a sender streams it: no tool table, no M2.
const HOBBY: &str = "$H\n(T1 D=3.175 - flat end mill)\nT1 M6\nG21 G90\nG0 Z5\nX10 Y10\nM3 S18000\nG1 Z-1 F300\nX40 F1200\nG0 Z5\nM5\n";
/// A cam grinder's, whose profile is in a library that is not named.
const CAM: &str = "(grind)\nG00 X240\nG51 P1234\nG50\nG01 X-0.1 F0.1 R0.1 S10\nG04 S10 P2\nM30\n";
/// As a shop's machining centre has it: 300 mm to either side, chips conveyed.
const SHOP: &str = "%\nO1001 (PLATE)\nG90 G54 G17 G40 G80\nT1 M6 (T1 1/2 FLAT ENDMILL)\nM31\nG43 H1 Z50.\nS3000 M3\nG0 X-300. Y0\nZ2.\nG1 Z-1. F200.\nX300.\nG0 G91 G28 Z0\nM30\n%\n";

#[test]
fn a_program_tells_how_it_is_read_and_where() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hobby.nc"), HOBBY).unwrap();
    let checked = leadscrew(&["check", "hobby.nc"], folder.path());
    let text = said(&checked);
    assert!(checked.status.success(), "{text}");
    assert!(text.contains("read with --dialect grbl on --machine router: $H in line 1"), "{text}");
    assert!(text.contains("\"T1 D=3.175 - flat end mill\" a mill of 3.1750 mm"), "{text}");
    // what it says works for a run as well, in which nothing of a stand-in is judged
    let run = leadscrew(&["run", "hobby.nc", "--machine", "router"], folder.path());
    assert!(said(&run).contains("the mill is assumed, by the program's comment"), "{}", said(&run));
    assert!(said(&run).contains("NOT JUDGED: of 1 feature, 1 not judged"), "{}", said(&run));
}

/// The block is 100 by 60 by 20 mm, the zero of G54 its rear left corner; the mill is fed to it
/// through the air.
#[test]
fn a_size_alone_is_laid_where_the_mill_cuts() {
    let folder = tempfile::tempdir().unwrap();
    let text = "%\nO1\n(STOCK 100X60X20)\n(T1 10. END MILL)\nT1 M6\nG21 G90 G54\nS3000 M3\n\
                G1 X-10. Y-30. F1000.\nG43 H1 Z5.\nG1 Z-2. F200.\nX110.\nG0 Z50.\nM30\n%\n";
    fs::write(folder.path().join("plate.nc"), text).unwrap();
    let words = ["check", "plate.nc", "--dialect", "fanuc", "--missing-tools", "stand-in"];
    let text = said(&leadscrew(&words, folder.path()));
    let block = "X 0.00 to 100.00, Y -60.00 to 0.00, Z -20.00 to 0.00 mm of G54";
    assert!(text.contains("A0110") && text.contains(block), "{text}");
}

/// The one choice: what `check` says alone and in a table, `time` and `run` do.
fn chosen(program: &str, folder: &Path) -> Vec<String> {
    let note = |words: &[&str]| {
        let text = said(&leadscrew(words, folder));
        let line = text.lines().find(|line| line.starts_with("note[A0106]: "));
        line.map_or_else(|| text.clone(), str::to_owned)
    };
    let alone = note(&["check", program]);
    let mut all = vec![alone];
    all.push(note(&["time", program]));
    all.push(note(&["run", program]));
    let table = said(&leadscrew(&["check", program, "--summary", "--format", "json"], folder));
    let table: serde_json::Value = serde_json::from_str(&table).unwrap();
    let program = &table["programs"][0];
    all.push(format!("{} on {}", program["dialect"], program["machine"]).replace('"', ""));
    all
}

#[test]
fn check_alone_and_in_a_table_time_and_run_choose_the_same_and_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let lathe = "G21 G18 G90 G7\nG95\nT1 M6\nG97 S800 M3\nG0 X22 Z2\nG1 X12 F0.2\nG1 Z-25 F0.15\nG0 X22\nG0 Z50\nM5\nM2\n";
    let hob = "G21 G90 G94 G17\nT1 M6\nG43 H1\nG0 X80 Y0 Z5\nM3 S350\nG81 T24 L1 Q1.5 P0\nG0 X48\nG1 Z-22 F12\nG0 X80\nG80\nM5\nM30\n";
    let long = "G21 G90 G54\nG0 Z50\nG0 X-300\nX300\nM2\n";
    for (name, text, reading, why) in [
        ("lathe.ngc", lathe, "linuxcnc on lathe", "no Y, and codes of a lathe"),
        ("hob.nc", hob, "linuxcnc on gear-hobber", "G81 with T and L turns a hob"),
        ("hobby.nc", HOBBY, "grbl on router", "$H in line 1"),
        (
            "cam.nc",
            CAM,
            "toyoda on cam-grinder",
            "G51 in line 3, G04 in line 6; the dialect is one of cam grinders",
        ),
        (
            "long.ngc",
            long,
            "linuxcnc on machining-center",
            "tapping-center is too small for this program (2 beyond its travel)",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let [alone, time, run, table] = &chosen(name, folder.path())[..] else { panic!() };
        let (dialect, machine) = reading.split_once(" on ").unwrap();
        let note =
            format!("note[A0106]: read with --dialect {dialect} on --machine {machine}: {why}");
        assert_eq!([alone, time, run], [&note; 3], "{name}");
        assert_eq!(table, reading, "{name}");
        // a machine that is named is the one that is meant
        let named = said(&leadscrew(&["check", name, "--machine", "bench-xyz"], folder.path()));
        assert!(!named.contains("A0106"), "{named}");
    }
}

#[test]
fn a_folder_is_summed_up() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("hobby.nc", HOBBY),
        ("O1001", SHOP),
        ("broken.ngc", "G0 XO\nM2\n"),
        ("print.gcode", "M140 S60\nM104 S200\nG1 X5 E1 F500\n"),
        ("notes.txt", "no program"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let words = ["check", ".", "--summary", "--accept", "unknown-m-codes"];
    let text = said(&leadscrew(&words, folder.path()));
    assert!(text.contains("2 of 4 programs can be executed"), "{text}");
    assert!(text.contains("fanuc on machining-center"), "{text}");
    let json = leadscrew(&[&words[..], &["--format", "json"]].concat(), folder.path());
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["causes"]["I0910"], 1, "{json}");
    let programs = json["programs"].as_array().unwrap();
    let broken = programs.iter().find(|p| p["program"] == "./broken.ngc").unwrap();
    assert_eq!((broken["errors"].as_u64(), broken["first"]["line"].as_u64()), (Some(1), Some(1)));
    // without a word for them the builder's codes refuse the second
    let text = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(text.contains("1 of 4 programs can be executed") && text.contains("I0105"), "{text}");
}

#[test]
fn a_machines_file_says_what_its_codes_do() {
    let folder = tempfile::tempdir().unwrap();
    let machine = "extends = \"tapping-center\"\nname = \"mine\"\ndescription = \"with codes\"\n[user_codes]\nM24 = \"blow: output 2 on\"\nM10 = \"clamp: wait 0.5 s\"\nM31 = \"chips out\"\n";
    fs::write(folder.path().join("mine.toml"), machine).unwrap();
    fs::write(folder.path().join("part.ngc"), "G21\nM31\nM24\nM10\nM2\n").unwrap();
    let run = leadscrew(&["run", "part.ngc", "--machine", "mine.toml", "--log"], folder.path());
    let text = said(&run);
    for part in ["M31 done", "M24 done", "output 2", "M10 done"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    fs::write(folder.path().join("mine.toml"), machine.replace("output 2 on", "output 99 on"))
        .unwrap();
    let text = said(&leadscrew(&["machine", "check", "mine.toml"], folder.path()));
    assert!(text.contains("expected M24 to end in \"output N on\""), "{text}");
}

#[test]
fn numbers_that_are_too_small_by_a_thousand_are_read_as_whole_units() {
    let folder = tempfile::tempdir().unwrap();
    let text = "%\nO1\nG90 G54 G21\nT1 M6 (T1 10 FLAT ENDMILL)\nS2000 M3\nG43 H1 Z50\nG0 X-10 Y0\nG1 Z-2 F200\nX60\nG0 Z50\nM30\n%\n";
    fs::write(folder.path().join("school.nc"), text).unwrap();
    let alone = said(&leadscrew(&["check", "school.nc"], folder.path()));
    assert!(alone.contains("A0107") && alone.contains("--decimal-point calculator"), "{alone}");
    let summed = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(summed.contains("whole units"), "{summed}");
    // as it is named, it is read
    let named = ["check", "school.nc", "--decimal-point", "increments"];
    assert!(said(&leadscrew(&named, folder.path())).contains("I1068"));
}

#[test]
fn codes_of_a_folder_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("O1001"), SHOP).unwrap();
    fs::write(folder.path().join("O1002"), "O1002\nG65 P9001 A1.\nG12 I5. D1\nM31\nM30\n").unwrap();
    let machine = "extends = \"tapping-center\"\nname = \"mine\"\ndescription = \"with codes\"\n[user_codes]\nM31 = \"chips out\"\n";
    fs::write(folder.path().join("mine.toml"), machine).unwrap();
    let words = ["codes", "--of", ".", "--dialect", "fanuc", "--format", "json"];
    let codes: serde_json::Value =
        serde_json::from_slice(&leadscrew(&words, folder.path()).stdout).unwrap();
    let of = |code: &str| codes.as_array().unwrap().iter().find(|row| row["code"] == code).unwrap();
    assert_eq!((of("M31")["times"].as_u64(), of("M31")["programs"].as_u64()), (Some(2), Some(2)));
    assert_eq!(
        (of("G0")["status"].as_str(), of("G0")["times"].as_u64()),
        (Some("executed"), Some(2))
    );
    assert_eq!(of("G12")["status"], "unknown", "no code of Fanuc's");
    assert_eq!(of("M31")["status"], "unknown");
    assert_eq!(
        (&of("M31")["first"]["program"], &of("M31")["first"]["line"]),
        (&"./O1001".into(), &5.into())
    );
    let named = ["codes", "--of", ".", "--dialect", "fanuc", "--machine", "mine.toml"];
    let text = said(&leadscrew(&named, folder.path()));
    assert!(text.contains("chips out") && text.contains("machine's"), "{text}");
    assert!(text.contains("2 programs:") && text.contains("1 unknown"), "{text}");
    let haas = said(&leadscrew(&["codes", "--of", "O1002", "--dialect", "haas"], folder.path()));
    assert!(haas.contains("a circle from its centre, clockwise"), "{haas}");
}

#[test]
fn a_word_that_linuxcnc_has_not_tells_the_dialect_that_has_it() {
    let folder = tempfile::tempdir().unwrap();
    // an end of the tape in its middle, as senders skip it: nothing else in it tells who reads it
    fs::write(folder.path().join("plain.nc"), "G21 G90\nG0 X5\n%X\nG0 X10\nM2\n").unwrap();
    let text = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(text.contains("1 of 1 program can be executed"), "{text}");
    assert!(text.contains("grbl on router"), "{text}");
    let alone = said(&leadscrew(&["check", "plain.nc"], folder.path()));
    assert!(alone.contains("not LinuxCNC's, which --dialect grbl takes: line 3"), "{alone}");
    // named, it stays what it is named
    let words = ["check", ".", "--summary", "--dialect", "linuxcnc"];
    assert!(said(&leadscrew(&words, folder.path())).contains("0 of 1"));
}

/// Programs that are wrong: no other dialect, machine or unit makes them right. The first is the
/// contour in whole millimetres whose arc ends 1.05 mm apart.
const WRONG: [(&str, &str, &str); 12] = [
    (
        "arc.ngc",
        "I0414",
        "G21 G17 G54 G90 G94\nS3000 M3\nG0 X-10 Y0 Z10\nG1 Z-1 F300\nG1 X0\nY40\nG2 X10 Y50 I10 J1\nG1 X60\nY0\nX-10\nG0 Z50\nM2\n",
    ),
    (
        "arc-tools.ngc",
        "I0414",
        "G21 G17 G54 G90 G94\nT1 M6\nG43 H1\nS3000 M3\nG0 X-10 Y0 Z10\nG1 Z-1 F300\nG1 X0\nY40\nG2 X10 Y50 I10 J1\nG1 X60\nG0 Z50\nM2\n",
    ),
    (
        "arc-points.ngc",
        "I0414",
        "G21 G17 G90\nS3000 M3\nG0 X0. Y40. Z10.\nG1 Z-1. F300.\nG2 X10. Y50. I10. J1.\nG0 Z50.\nM2\n",
    ),
    (
        "arc-radius.ngc",
        "I04",
        "G21 G17 G90\nS3000 M3\nG0 X0 Y0 Z10\nG1 Z-1 F300\nG2 X40 Y0 R10\nG0 Z50\nM2\n",
    ),
    (
        "arc-inch.ngc",
        "I0414",
        "G20 G17 G90\nS3000 M3\nG0 X0 Y2 Z1\nG1 Z-.1 F10\nG2 X1 Y3 I1 J.1\nG0 Z2\nM2\n",
    ),
    (
        "arc-full.ngc",
        "I04",
        "G21 G17 G90\nS3000 M3\nG0 X0 Y0 Z10\nG1 Z-1 F300\nG2 X40 Y0 I10 J0\nG0 Z50\nM30\n",
    ),
    ("no-feed.ngc", "I0", "G21 G17 G90\nS3000 M3\nG0 X0 Y0 Z10\nG1 Z-1\nG1 X40\nG0 Z50\nM2\n"),
    ("letter-o.ngc", "P0", "G21 G17 G90\nG0 XO Y0\nM2\n"),
    ("two-points.ngc", "P0102", "G21 G17 G90\nG0 X1.2.3 Y0\nM2\n"),
    ("twice.ngc", "P0105", "G21 G17 G90\nG0 X1 X2 Y0\nM2\n"),
    ("cut-off.ngc", "I0", "G21 G17 G90\nS3000 M3\nG0 X0 Y0 Z10\nG1 Z-1 F300\nG1 X40\nY20\nX0\n"),
    ("word.ngc", "I01", "G21 G17 G90\nG0 X1 Q5 Y0\nM2\n"),
];

#[test]
fn no_other_reading_makes_a_wrong_program_right() {
    let folder = tempfile::tempdir().unwrap();
    for (name, code, text) in WRONG {
        fs::write(folder.path().join(name), text).unwrap();
        let checked = leadscrew(&["check", name], folder.path());
        let alone = said(&checked);
        assert_eq!(checked.status.code(), Some(2), "{name}: {alone}");
        assert!(alone.contains(&format!("error[{code}")), "{name}: {alone}");
        for word in ["nothing is wrong", "--dialect fanuc", "--dialect grbl"] {
            assert!(!alone.contains(word), "{name}: {alone}");
        }
        let table = said(&leadscrew(&["check", name, "--summary"], folder.path()));
        assert!(table.contains("0 of 1"), "{name}: {table}");
        assert_eq!(leadscrew(&["run", name], folder.path()).status.code(), Some(2), "{name}");
    }
}

/// A quarter turn whose ends fit only if 50 is 50 mm; other numbers have their points.
const MIXED: &str = "%\nO0001\nT1 M6 (T1 6 FLAT ENDMILL)\nG90 G54\nS1000 M3\nG43 H1 Z20.\nG0 X0. Y50\nG1 Z0. F200.\nG17 G2 X50. Y0. I0. J-50. F500.\nG0 Z100.\nM30\n%\n";

#[test]
fn a_forgotten_point_is_said_and_does_not_change_how_numbers_are_read() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mixed.nc"), MIXED).unwrap();
    let alone = leadscrew(&["check", "mixed.nc"], folder.path());
    let text = said(&alone);
    assert!(!alone.status.success() && text.contains("write Y50. for 50 mm"), "{text}");
    let summed = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(summed.contains("0 of 1 program can be executed"), "{summed}");
    // where the machine counts whole units, nothing is wrong
    let words = ["check", "mixed.nc", "--dialect", "fanuc", "--decimal-point", "calculator"];
    let told = leadscrew(&[&words[..], &["--missing-tools", "stand-in"]].concat(), folder.path());
    assert!(told.status.success(), "{}", said(&told));
}

#[test]
fn a_rotary_axis_and_the_middle_of_a_table_are_found_on_a_built_in_machine() {
    let folder = tempfile::tempdir().unwrap();
    let text = "G21 G90 G54\nG0 Z50\nG0 X10 A3600\nG53 G0 X120\nM2\n";
    fs::write(folder.path().join("round.ngc"), text).unwrap();
    let text = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(text.contains("portal-mill"), "{text}");
}
