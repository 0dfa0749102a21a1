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

#[test]
fn a_machine_that_is_too_small_is_said_with_one_that_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let long = "G21 G90 G54\nG0 Z50\nG0 X-300\nX300\nM2\n";
    fs::write(folder.path().join("long.ngc"), long).unwrap();
    let checked = leadscrew(&["check", "long.ngc"], folder.path());
    let text = said(&checked);
    assert_eq!(checked.status.code(), Some(2), "{text}");
    let hint = "tapping-center is too small for this program (2 beyond its travel): --machine machining-center is not";
    assert!(text.contains(hint), "{text}");
    let there = ["check", "long.ngc", "--machine", "machining-center", "--dialect", "linuxcnc"];
    assert!(leadscrew(&there, folder.path()).status.success());
}

/// What `check` finds for a program without a machine is said where it is refused elsewhere, too.
#[test]
fn a_run_that_is_refused_says_where_it_would_not_be() {
    let folder = tempfile::tempdir().unwrap();
    let long = "G21 G90 G54\nG0 Z50\nG0 X-300\nX300\nM2\n";
    fs::write(folder.path().join("long.ngc"), long).unwrap();
    fs::write(folder.path().join("hobby.nc"), HOBBY).unwrap();
    for command in ["run", "time"] {
        let text = said(&leadscrew(&[command, "long.ngc"], folder.path()));
        let hint = "long.ngc: tapping-center is too small for this program (2 beyond its travel): --machine machining-center is not";
        assert!(text.contains(hint), "{command}: {text}");
        let text = said(&leadscrew(&[command, "hobby.nc"], folder.path()));
        let hint = "hobby.nc: nothing is wrong with it with --dialect grbl --machine router";
        assert!(text.contains(hint), "{command}: {text}");
        // where a machine is named, it is the one that is meant
        let named = [command, "long.ngc", "--machine", "tapping-center"];
        assert!(!said(&leadscrew(&named, folder.path())).contains("too small"), "{command}");
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
fn numbers_that_are_too_small_by_a_thousand_are_read_as_whole_units_in_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let text = "%\nO1\nG90 G54 G21\nT1 M6 (T1 10 FLAT ENDMILL)\nS2000 M3\nG43 H1 Z50\nG0 X-10 Y0\nG1 Z-2 F200\nX60\nG0 Z50\nM30\n%\n";
    fs::write(folder.path().join("school.nc"), text).unwrap();
    let alone = said(&leadscrew(&["check", "school.nc"], folder.path()));
    assert!(alone.contains("I1068") && alone.contains("--decimal-point calculator"), "{alone}");
    let summed = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(summed.contains("whole units"), "{summed}");
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
fn a_program_whose_words_tell_nothing_is_read_as_the_dialect_in_which_nothing_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    // an end of the tape in its middle, as senders skip it: nothing else in it tells who reads it
    fs::write(folder.path().join("plain.nc"), "G21 G90\nG0 X5\n%X\nG0 X10\nM2\n").unwrap();
    let text = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(text.contains("1 of 1 program can be executed"), "{text}");
    assert!(text.contains("grbl on router"), "{text}");
    // alone it is read as a run would read it, and told how nothing is wrong
    let alone = leadscrew(&["check", "plain.nc"], folder.path());
    let hint = "nothing is wrong with it with --dialect grbl --machine router";
    assert!(!alone.status.success() && said(&alone).contains(hint), "{}", said(&alone));
    // named, it stays what it is named
    let words = ["check", ".", "--summary", "--dialect", "linuxcnc"];
    assert!(said(&leadscrew(&words, folder.path())).contains("0 of 1"));
}

/// A quarter turn whose ends fit only if 50 is 50 mm; other numbers have their points.
const MIXED: &str = "%\nO0001\nT1 M6 (T1 6 FLAT ENDMILL)\nG90 G54\nS1000 M3\nG43 H1 Z20.\nG0 X0. Y50\nG1 Z0. F200.\nG17 G2 X50. Y0. I0. J-50. F500.\nG0 Z100.\nM30\n%\n";

#[test]
fn a_program_that_fits_together_in_whole_units_only_is_read_so_in_a_folder_and_alone_told_of_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mixed.nc"), MIXED).unwrap();
    let alone = leadscrew(&["check", "mixed.nc"], folder.path());
    let hint = "nothing is wrong with it with --dialect fanuc --decimal-point calculator";
    assert!(!alone.status.success() && said(&alone).contains(hint), "{}", said(&alone));
    let summed = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(summed.contains("1 of 1 program can be executed"), "{summed}");
    assert!(summed.contains("whole"), "{summed}");
    // as told, nothing is wrong
    let words = ["check", "mixed.nc", "--dialect", "fanuc", "--decimal-point", "calculator"];
    let told = leadscrew(&[&words[..], &["--missing-tools", "stand-in"]].concat(), folder.path());
    assert!(told.status.success(), "{}", said(&told));
    let named = ["check", ".", "--summary", "--decimal-point", "increments"];
    assert!(said(&leadscrew(&named, folder.path())).contains("0 of 1"));
}

#[test]
fn a_rotary_axis_and_the_middle_of_a_table_are_found_on_a_built_in_machine() {
    let folder = tempfile::tempdir().unwrap();
    let text = "G21 G90 G54\nG0 Z50\nG0 X10 A3600\nG53 G0 X120\nM2\n";
    fs::write(folder.path().join("round.ngc"), text).unwrap();
    let text = said(&leadscrew(&["check", ".", "--summary"], folder.path()));
    assert!(text.contains("portal-mill"), "{text}");
}
