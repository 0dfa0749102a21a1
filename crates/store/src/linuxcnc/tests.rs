//! Small configurations, and what becomes of them; expected values by hand from LinuxCNC's
//! documentation.
#![allow(clippy::unwrap_used)] // a test may panic
use super::{Hal, Ini, RemarkKind, import};
use crate::machine::{self, HomingMethod, MachineFile, PositionFrom};
use proptest::prelude::*;

const MILL: &str = "\
[EMC]
MACHINE = Small mill
[DISPLAY]
MAX_SPINDLE_0_SPEED = 2400
MAX_FEED_OVERRIDE = 1.5
[EMCMOT]
SERVO_PERIOD = 1000000
[EMCIO]
TOOL_TABLE = mill.tbl
TOOL_CHANGE_POSITION = 0 0 2
[KINS]
KINEMATICS = trivkins coordinates=XZ
JOINTS = 2
[TRAJ]
COORDINATES = X Z
LINEAR_UNITS = inch
MAX_LINEAR_VELOCITY = 2
[AXIS_X]
MIN_LIMIT = -1
MAX_LIMIT = 9
MAX_VELOCITY = 3
MAX_ACCELERATION = 20
[JOINT_0]
MIN_LIMIT = -0.5
MAX_LIMIT = 10
MAX_VELOCITY = 1
MAX_ACCELERATION = 30
BACKLASH = 0.002
SCALE = -4000
FERROR = 0.05
MIN_FERROR = 0.01
HOME_SEARCH_VEL = -0.5
HOME_LATCH_VEL = 0.05
HOME_OFFSET = -0.4
HOME = 0.1
HOME_SEQUENCE = 1
[AXIS_Z]
MIN_LIMIT = -4
MAX_LIMIT = 2
MAX_VELOCITY = 3
MAX_ACCELERATION = 20
[JOINT_1]
HOME_SEQUENCE = 0
";

const HAL: &str = "\
setp encoder.0.position-scale [SPINDLE_0]SCALE # a remark
net spindle-pos encoder.0.position => spindle.0.revs
net x-pos joint.0.motor-pos-cmd => stepgen.0.position-cmd
net z-home joint.1.home-sw-in <= parport.0.pin-10-in
";

fn read(text: &str) -> Ini {
    Ini::read("small.ini", text, &mut |name| match name {
        "more.inc" => Ok("[TRAJ]\nCOORDINATES = X\n".to_owned()),
        _ => Err("is not there".to_owned()),
    })
}

fn hal(text: &str, ini: &Ini) -> Hal {
    let mut hal = Hal::default();
    hal.read("small.hal", text, ini, &mut |_| Err("is not there".to_owned()));
    hal
}

fn imported(ini: &str, wiring: &str) -> (MachineFile, Vec<String>) {
    let ini = read(ini);
    let (text, remarks) = import(&ini, &hal(wiring, &ini));
    let remarks: Vec<String> = remarks.iter().map(ToString::to_string).collect();
    let text = text.unwrap_or_else(|| panic!("{remarks:#?}"));
    (machine::parse(&text, 0).unwrap_or_else(|found| panic!("{found:#?}\n{text}")), remarks)
}

/// All that is wrong with a configuration, in one run.
fn wrong(ini: &str) -> Vec<String> {
    let (text, remarks) = import(&read(ini), &Hal::default());
    assert_eq!(text, None, "{remarks:#?}");
    let is_wrong = |remark: &&super::Remark| remark.kind == RemarkKind::Wrong;
    remarks.iter().filter(is_wrong).map(ToString::to_string).collect()
}

fn has(remarks: &[String], part: &str) {
    assert!(remarks.iter().any(|remark| remark.contains(part)), "{part}: {remarks:#?}");
}

#[test]
fn inches_become_millimetres_and_the_tightest_limit_of_axis_joint_and_trajectory_counts() {
    let (file, remarks) = imported(MILL, HAL);
    let x = file.axis(canon::Axis::X).unwrap();
    assert!((x.travel.from.value() + 12.7).abs() < 1e-9, "the joint's −0.5 inch is tighter");
    assert!((x.travel.to.value() - 228.6).abs() < 1e-9, "the axis' 9 inch is tighter");
    assert!((x.rapid.value() - 25.4).abs() < 1e-9, "the joint's 1 inch/s");
    assert!((x.acceleration.value() - 508.0).abs() < 1e-9, "the axis' 20 inch/s²");
    let z = file.axis(canon::Axis::Z).unwrap();
    assert!((z.rapid.value() - 50.8).abs() < 1e-9, "[TRAJ] lets no axis go faster than 2 inch/s");
    assert!(file.axis(canon::Axis::Y).is_none());
    assert!((x.structure.backlash.value() - 0.0508).abs() < 1e-9);
    assert!((x.windows.following_error_stop.value() - 1.27).abs() < 1e-9);
    assert!((x.windows.following_error_warn.value() - 0.254).abs() < 1e-9);
    let PositionFrom::Scale { resolution, .. } = x.position_from else { panic!("{x:?}") };
    assert!((resolution.value() - 0.00635).abs() < 1e-9, "4000 counts an inch");
    has(&remarks, "taken    axes.x.rapid_mm_per_min: 1524 from small.ini:26 [JOINT_0]MAX_VELOCITY");
    has(&remarks, "missing  leadscrew.x: counts in mm");
    has(&remarks, "taken    --tools: mill.tbl from small.ini:9 [EMCIO]TOOL_TABLE");
}

#[test]
fn homing_goes_to_the_switch_in_the_order_of_the_sequence_or_asks_the_operator() {
    let (file, remarks) = imported(MILL, HAL);
    let x = &file.axis(canon::Axis::X).unwrap().homing;
    assert_eq!((x.method, x.order, x.positive), (HomingMethod::Switch, 2, false));
    assert!((x.reference.value() + 10.16).abs() < 1e-9, "HOME_OFFSET −0.4 inch");
    assert!((x.pull_off.value() - 12.7).abs() < 1e-9, "from −0.4 to HOME 0.1 inch");
    assert!((x.slow.value() - 1.27).abs() < 1e-9);
    let z = &file.axis(canon::Axis::Z).unwrap().homing;
    assert_eq!((z.method, z.order), (HomingMethod::Given, 1));
    let indexed = MILL.replace("HOME_OFFSET = -0.4", "HOME_USE_INDEX = YES\nHOME_OFFSET = -0.4");
    assert!(x.off_switch, "HOME_LATCH_VEL has the other sign");
    let onto = MILL.replace("HOME_LATCH_VEL = 0.05", "HOME_LATCH_VEL = -0.05");
    assert!(!imported(&onto, HAL).0.axis(canon::Axis::X).unwrap().homing.off_switch);
    let (file, said) = imported(&indexed, HAL);
    let x = &file.axis(canon::Axis::X).unwrap().homing;
    assert_eq!((x.method, x.off_switch), (HomingMethod::SwitchAndIndex, true));
    assert!((x.reference.value() + 10.16).abs() < 1e-9, "HOME_OFFSET is where the mark is");
    has(
        &said,
        "taken    axes.x.homing.method: \"switch-and-index\" from small.ini:34 [JOINT_0]HOME_USE_INDEX",
    );
    has(&said, "missing  axes.x.homing.index_every_mm: 10 stands in for it");
    let alone = indexed.replace("HOME_SEARCH_VEL = -0.5", "HOME_SEARCH_VEL = 0");
    has(
        &imported(&alone, HAL).1,
        "missing  axes.x.homing.method: small.ini:34 [JOINT_0]HOME_USE_INDEX: a mark without a switch",
    );
    has(&remarks, "rewire   joint.1.home-sw-in: leadscrew.z.home-sw on signal z-home, small.hal:4");
}

#[test]
fn an_absolute_encoder_reads_at_machine_zero_what_its_offset_takes_away() {
    let absolute = MILL.replace("HOME_SEARCH_VEL = -0.5", "HOME_ABSOLUTE_ENCODER = 2");
    let x = imported(&absolute, HAL).0.axis(canon::Axis::X).unwrap().homing;
    assert_eq!(x.method, HomingMethod::Absolute);
    assert!((x.reference.value() - 10.16).abs() < 1e-9, "{x:?}");
}

#[test]
fn the_encoder_of_a_spindle_is_what_the_hal_file_connects_with_its_revs() {
    let counts = |scale: &str| {
        let ini = format!("{MILL}[SPINDLE_0]\nSCALE = {scale}\n");
        let (file, remarks) = imported(&ini, HAL);
        (file.spindles[0].encoder_counts_per_rev, remarks)
    };
    let (forwards, remarks) = counts("4096");
    assert_eq!(forwards, 4096);
    has(&remarks, "small.hal:1 encoder.0.position-scale");
    has(&remarks, "its sign is positive");
    let (backwards, remarks) = counts("-1440");
    assert_eq!(backwards, 1440);
    has(&remarks, "its sign is negative");
    has(&counts("1").1, "expected 16 counts a revolution or more");
    let (file, remarks) = imported(MILL, "");
    has(
        &remarks,
        "missing  spindles.0.encoder_counts_per_rev: 4096 stands in for it: no HAL file wires",
    );
    assert!((file.spindles[0].max.in_rpm() - 2400.0).abs() < 1e-9);
    has(&remarks, "missing  spindles.0.drive.acceleration_rev_per_s2");
}

#[test]
fn a_drive_that_orients_the_spindle_is_one_whose_request_and_answer_are_both_wired() {
    const ASKED: &str = "net orient spindle.0.orient => orient.0.enable\n";
    const ANSWERED: &str = "net in-pos orient.0.is-oriented => spindle.0.is-oriented\n";
    let orients = |wiring: &str| {
        let (file, remarks) = imported(MILL, &format!("{HAL}{wiring}"));
        (file.spindles[0].own_ramps.unwrap().orients, remarks)
    };
    let (both, remarks) = orients(&format!("{ASKED}{ANSWERED}"));
    assert!(both);
    has(&remarks, "taken    spindles.0.drive.orients: true from small.hal:");
    has(
        &remarks,
        "rewire   spindle.0.is-oriented: leadscrew.spindle.0.is-oriented on signal in-pos",
    );
    let (asked, remarks) = orients(ASKED);
    assert!(!asked);
    has(&remarks, "nothing answers at is-oriented");
    let (neither, remarks) = orients("");
    assert!(!neither && !remarks.iter().any(|remark| remark.contains("orient")), "{remarks:#?}");
}

#[test]
fn a_gantry_is_one_axis_and_what_it_loses_is_said() {
    let gantry = MILL
        .replace("coordinates=XZ", "coordinates=XZX kinstype=BOTH")
        .replace("JOINTS = 2", "JOINTS = 3")
        + "[JOINT_2]\nMAX_VELOCITY = 0.5\n";
    let (file, remarks) = imported(&gantry, HAL);
    let x = file.axis(canon::Axis::X).unwrap();
    assert!((x.rapid.value() - 12.7).abs() < 1e-9, "the slower joint leads");
    has(&remarks, "missing  axes.x: joints 0 and 2 move it together");
}

#[test]
fn blocks_of_haluis_keys_are_those_of_the_panel_in_their_order() {
    let mdi = "[HALUI]\nMDI_COMMAND = G53 G0 Z0\nMDI_COMMAND = o<touch> call [1]\n";
    let (written, remarks) = imported(&format!("{MILL}{mdi}"), HAL);
    let hal = written.hal.unwrap();
    assert_eq!(hal.mdi, ["G53 G0 Z0", "o<touch> call [1]"]);
    has(&remarks, "hal.mdi: o<touch> call [1] from small.ini:");
    has(&remarks, "[HALUI]MDI_COMMAND, by leadscrew.mdi-01");
}

#[test]
fn everything_that_is_wrong_is_said_at_once_and_there_is_no_file() {
    let broken = MILL
        .replace("MAX_LIMIT = 9", "MAX_LIMIT = 9,5")
        .replace("[AXIS_Z]\nMIN_LIMIT = -4", "[AXIS_Z]\nmin_limit = -4")
        .replace("LINEAR_UNITS = inch", "LINEAR_UNITS = cubit");
    let found = wrong(&broken.replace("cubit", "mm"));
    has(&found, "small.ini:20 [AXIS_X]MAX_LIMIT: found `9,5`, expected a number");
    has(&found, "axes.z.travel_from_mm: no MIN_LIMIT in [AXIS_Z], [JOINT_1]");
    has(&wrong(&broken), "found `cubit`, expected mm or inch");
    has(
        &wrong(&MILL.replace("trivkins", "scarakins")),
        "found `scarakins coordinates=XZ`, expected trivkins",
    );
    has(&wrong("[AXIS_0]\nTYPE = LINEAR\n"), "LinuxCNC 2.7 or older");
    has(&wrong(&MILL.replace("MAX_ACCELERATION", "MAX_ACCEL")), "no MAX_ACCELERATION above 0");
    let crossed = MILL.replace("MAX_LIMIT = 9", "MAX_LIMIT = -3");
    has(&wrong(&crossed), "MIN_LIMIT -12.7 is not below MAX_LIMIT -76.2 mm");
}

#[test]
fn remarks_continued_lines_included_files_and_capitals_are_read_as_linuxcnc_reads_them() {
    let ini = read(
        "# A = 1\n; B = 2\n[ S ]\nA = 1 # two \nC = a \\\n  b\nA = 3\na = 4\n#INCLUDE more.inc\n#INCLUDE no.inc\nword\n",
    );
    assert_eq!(ini.get("S", "A").map(|entry| entry.value.as_str()), Some("1 # two"));
    assert_eq!(ini.get("S", "A").unwrap().number(), Ok(1.0));
    assert_eq!(ini.get("S", "C").unwrap().value, "a b");
    assert_eq!(ini.all("S", "A").count(), 2);
    assert_eq!(ini.get("S", "B"), None);
    assert_eq!(ini.get("TRAJ", "COORDINATES").unwrap().place.to_string(), "more.inc:2");
    assert_eq!(ini.unread.len(), 2, "{:?}", ini.unread);
    let small = MILL.replace("MAX_FEED_OVERRIDE", "max_feed_override");
    has(
        &imported(&small, HAL).1,
        "small.ini:5 [DISPLAY]max_feed_override: LinuxCNC reads [DISPLAY]MAX_FEED_OVERRIDE",
    );
}

#[test]
fn a_file_that_includes_itself_comes_to_an_end() {
    let itself = |_: &str| Ok("[A]\nB = 1\n#INCLUDE x\n".to_owned());
    let ini = Ini::read("x", "#INCLUDE x\n", &mut itself.clone());
    assert_eq!(ini.all("A", "B").count(), super::ini::MOST_FILES);
    let mut hal = Hal::default();
    hal.read("x", "source x\n", &ini, &mut |_| Ok("setp a 1\nsource x\nsource x\n".to_owned()));
    assert!(hal.values.len() <= super::ini::MOST_FILES, "{}", hal.values.len());
}

proptest! {
    #[test]
    fn any_text_is_imported_or_refused(ini in "(\\[(TRAJ|KINS|AXIS_X|JOINT_0)\\]\n|(COORDINATES|MAX_LIMIT|MIN_LIMIT|HOME|KINEMATICS|\\PC{0,6}) ?= ?[-+0-9.eXYZ ]{0,8}\n|\\PC{0,12}\n){0,20}", wiring in "((net|setp|source) [a-z.0-9\\[\\]()]{0,12} [a-z.0-9\\[\\]()]{0,12}\n){0,6}") {
        let ini = read(&ini);
        let (text, remarks) = import(&ini, &hal(&wiring, &ini));
        prop_assert!(text.is_some() != remarks.iter().any(|remark| remark.kind == RemarkKind::Wrong));
    }
}
