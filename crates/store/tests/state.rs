//! A control's state outlives it: whole, or not at all; and nothing that was not written by a
//! control is believed.

use canon::{ToolLibrary, ToolUse};
use std::fs;
use std::path::Path;
use store::parameters::Parameters;
use store::state::{
    AlarmRecord, Finding, HomedAxis, Homing, LastProgram, LengthDisplay, MOST_ALARMS,
    MachineIdentity, Settings, State, StateChange, StateFolder, Weight, WorkpieceRecord,
};
use test_support::size;
use units::{Length, Time};

fn parameters(x: f64) -> Parameters {
    let mut parameters = Parameters::default();
    for (number, value) in [(5220, 1.0), (5221, x), (5222, 0.1 + 0.2)] {
        assert!(parameters.set(number, value));
    }
    parameters
}

fn tools(wear_um: f64) -> ToolLibrary {
    let text = include_str!("../../../programs/tools.toml");
    let library = store::tools::parse_toml(text, 0).unwrap().library;
    let mut tool = library.get(3).unwrap().clone();
    tool.wear.length = Length::um(wear_um);
    tool.life.used = ToolUse { uses: 12, time: Time::s(3.25), length: Length::mm(480.0) };
    tool.life.limit.uses = Some(500);
    let mut library = library;
    library.insert(tool);
    library
}

fn alarm(number: u32) -> AlarmRecord {
    let text = "the axis X does not follow".to_owned();
    AlarmRecord {
        number,
        text,
        unix_ms: 1_790_000_000_000,
        line: Some(12),
        ..AlarmRecord::default()
    }
}

fn program() -> LastProgram {
    LastProgram {
        path: "plate \"12\" x M6.ngc".into(),
        sha256: "ab".repeat(32),
        line: 7,
        operation: 31,
        feature: 4,
        is_completed: false,
    }
}

fn settings() -> Settings {
    Settings {
        feed_override: 0.8,
        block_skip: vec![1, 3],
        units: LengthDisplay::Inch,
        ..Settings::default()
    }
}

fn homing() -> Homing {
    Homing { axis: vec![HomedAxis { axis: 'Z', zero: -12.345_678_9, epoch: u64::MAX >> 1 }] }
}

fn machine() -> MachineIdentity {
    MachineIdentity { name: "tapping-center".into(), axes: "XYZ".into(), spindles: 1 }
}

fn open(path: &Path) -> Result<(StateFolder, State, Vec<Finding>), store::Error> {
    StateFolder::open(path, &machine())
}

/// A folder in which each datum was saved twice.
fn kept(path: &Path) {
    let (mut folder, _, _) = open(path).unwrap();
    for (x, wear) in [(-250.0, 0.0), (-251.5, -12.0)] {
        folder.save_parameters(&parameters(x)).unwrap();
        folder.save_tools(&tools(wear)).unwrap();
        folder.save_last_program(&LastProgram { line: x.abs() as u32, ..program() }).unwrap();
    }
    folder.save_homed(&Homing::default()).unwrap();
    folder.save_homed(&homing()).unwrap();
    folder.save_settings(&Settings::default()).unwrap();
    folder.save_settings(&settings()).unwrap();
    folder.save_alarm(alarm(2101)).unwrap();
    folder.save_alarm(alarm(2102)).unwrap();
}

fn opened(path: &Path) -> (State, Vec<Finding>) {
    let (_, state, found) = open(path).unwrap();
    (state, found)
}

fn in_a_folder(test: impl FnOnce(&Path)) {
    let home = tempfile::tempdir().unwrap();
    test(&home.path().join("state"));
}

#[test]
fn a_new_folder_says_nothing_and_is_remarked_upon_by_nothing() {
    in_a_folder(|path| assert_eq!(opened(path), (State::default(), Vec::new())));
}

#[test]
fn what_was_saved_last_is_there_after_the_control_is_switched_on_again() {
    in_a_folder(|path| {
        kept(path);
        let (state, found) = opened(path);
        assert_eq!(found, []);
        let wanted = State {
            parameters: Some(parameters(-251.5)),
            tools: Some(tools(-12.0)),
            homed: homing(),
            last_program: Some(LastProgram { line: 251, ..program() }),
            alarms: vec![alarm(2101), alarm(2102)],
            settings: Some(settings()),
            workpiece: None,
            changer: None,
            changes: Vec::new(),
        };
        assert_eq!(state, wanted);
    });
}

#[test]
fn a_second_control_is_refused_with_the_process_of_the_first() {
    in_a_folder(|path| {
        let first = open(path).unwrap();
        let refused = open(path).unwrap_err().to_string();
        let id = std::process::id();
        let end = format!("another Leadscrew, process {id}, is controlling this machine");
        assert!(refused.ends_with(&end), "{refused}");
        drop(first);
        assert!(open(path).is_ok());
    });
}

#[test]
fn the_sync_record_lies_in_the_same_folder_under_the_same_lock() {
    in_a_folder(|path| {
        use store::sync_record::slots::StateFolder as Records;
        let (folder, _, _) = open(path).unwrap();
        assert!(Records::open(path).is_err());
        let records = Records::of(&folder);
        drop(folder);
        assert!(open(path).is_err(), "the record's writer still has it");
        drop(records);
        assert!(open(path).is_ok());
    });
}

#[test]
fn a_folder_of_another_machine_is_not_used_whichever_of_its_files_are_left() {
    in_a_folder(|path| {
        kept(path);
        for other in [
            MachineIdentity { name: "vfd-mill".into(), ..machine() },
            MachineIdentity { axes: "XYZA".into(), ..machine() },
            MachineIdentity { spindles: 2, ..machine() },
        ] {
            let refused = StateFolder::open(path, &other).unwrap_err().to_string();
            let said = format!("the machine {}, and this one is {other}: name", machine());
            assert!(refused.contains(&said), "{refused}");
        }
        let mill = MachineIdentity { name: "vfd-mill".into(), ..machine() };
        for name in ["manifest.toml", "manifest.copy.toml"] {
            fs::remove_file(path.join(name)).unwrap();
        }
        let refused = StateFolder::open(path, &mill).unwrap_err().to_string();
        assert!(refused.contains("`tapping-center`, and this one is `vfd-mill`"), "{refused}");
        assert!(open(path).is_ok());
    });
}

#[test]
fn a_file_that_was_edited_and_says_so_is_in_force_and_each_value_is_named_until_acknowledged() {
    in_a_folder(|path| {
        kept(path);
        let file = path.join("parameters.var");
        let text = fs::read_to_string(&file).unwrap();
        let edited = text.replace("-251.500000", "-260.000000");
        assert_ne!(edited, text);
        fs::write(&file, &edited).unwrap();
        let (state, found) = opened(path);
        assert_eq!((state.parameters, state.changes), (Some(parameters(-251.5)), Vec::new()));
        assert_eq!(found[0].weight, Weight::Note);
        assert!(found[0].sentence.contains("writes `edited` in place of the checksum"));
        let (_, body) = edited.split_once('\n').unwrap();
        fs::write(&file, format!("# leadscrew parameters 1, edited\r\n{body}")).unwrap();
        let change = StateChange {
            datum: "G54 X".into(),
            before: "-251.500".into(),
            now: "-260.000".into(),
            why: "parameters.var was edited by hand and is in force".into(),
        };
        let (state, found) = opened(path);
        assert_eq!(state.parameters, Some(parameters(-260.0)));
        let said = "parameters.var was edited by hand: it is used as it stands";
        assert_eq!((found[0].weight, found[0].to_string().as_str()), (Weight::Note, said));
        assert_eq!(state.changes, std::slice::from_ref(&change));
        // as often as the control is started, and whatever it keeps meanwhile
        let (mut folder, state, found) = open(path).unwrap();
        assert_eq!((state.changes, found), (vec![change], Vec::new()));
        folder.save_tools(&tools(9.0)).unwrap();
        folder.acknowledge().unwrap();
        drop(folder);
        assert_eq!(opened(path).0.changes, []);
    });
}

#[test]
fn what_is_not_believed_is_set_aside_and_never_written_over() {
    in_a_folder(|path| {
        kept(path);
        for (n, garbage) in ["shop's own words", "others"].iter().enumerate() {
            fs::write(path.join("tools.toml"), garbage).unwrap();
            let (mut folder, state, _) = open(path).unwrap();
            assert!(state.tools.is_some());
            folder.save_tools(&tools(n as f64)).unwrap();
            let aside = path.join(format!("tools.toml.rejected-{}", n + 1));
            assert_eq!(fs::read_to_string(aside).unwrap(), *garbage);
        }
        assert_eq!(opened(path).0.tools, Some(tools(1.0)));
    });
}

#[test]
fn a_file_that_is_missing_is_whole_again_from_the_manifest() {
    in_a_folder(|path| {
        kept(path);
        // on a file system without links the name is free for a moment
        fs::rename(path.join("tools.toml"), path.join("tools.toml.previous")).unwrap();
        let (state, found) = opened(path);
        assert_eq!(state.tools, Some(tools(-12.0)));
        let said =
            "tools.toml is missing: what the control wrote last is in force, from the manifest";
        assert_eq!((found.len(), found[0].sentence.as_str()), (1, said));
    });
}

#[test]
fn a_save_after_a_kill_between_link_and_rename_leaves_no_link_behind() {
    in_a_folder(|path| {
        kept(path);
        // killed there, both names are links of one file
        fs::remove_file(path.join("tools.toml.previous")).unwrap();
        fs::hard_link(path.join("tools.toml"), path.join("tools.toml.previous")).unwrap();
        let (mut folder, _, found) = open(path).unwrap();
        assert_eq!(found, []);
        folder.save_tools(&tools(5.0)).unwrap();
        assert!(!path.join(".state-new-tools.toml").exists());
    });
}

#[test]
fn what_a_killed_control_was_writing_is_removed_by_the_next() {
    in_a_folder(|path| {
        kept(path);
        fs::write(path.join(".state-new-Xy12"), "half a tab").unwrap();
        opened(path);
        assert!(!path.join(".state-new-Xy12").exists());
    });
}

/// Put something hostile in the place of a file; the sentence, with the folder left out.
#[cfg(unix)]
fn hostile(name: &str, put: impl FnOnce(&Path)) -> String {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("state");
    kept(&path);
    let file = path.join(name);
    fs::remove_file(&file).unwrap();
    put(&file);
    match open(&path) {
        Ok((mut folder, _, found)) => {
            assert_eq!(found.len(), 1, "{found:?}");
            folder.save_tools(&tools(77.0)).unwrap();
            folder.save_alarm(alarm(1)).unwrap();
            drop(folder);
            let (state, _) = opened(&path);
            assert_eq!(state.tools, Some(tools(77.0)));
            assert_eq!(state.alarms.last(), Some(&alarm(1)));
            found[0].to_string()
        }
        Err(refused) => refused.to_string().replace(&path.display().to_string(), "FOLDER"),
    }
}

#[test]
#[cfg(unix)]
fn everything_hostile_in_a_files_place_is_one_sentence_and_does_no_harm() {
    use std::os::unix::fs::symlink;
    use std::process::Command;
    let elsewhere = tempfile::tempdir().unwrap();
    let target = elsewhere.path().join("target");
    fs::write(&target, "of somebody else").unwrap();
    let link = |file: &Path| symlink(&target, file).unwrap();
    let used = "what the control wrote last is in force, from the manifest";
    let not_plain = "and a state folder holds plain files";
    assert_eq!(
        hostile("tools.toml", link),
        format!("tools.toml is a symbolic link, {not_plain}: {used}")
    );
    assert_eq!(
        hostile("tools.toml", |file| fs::create_dir(file).unwrap()),
        format!("tools.toml is a folder, {not_plain}: {used}")
    );
    let pipe = |file: &Path| assert!(Command::new("mkfifo").arg(file).status().unwrap().success());
    assert_eq!(
        hostile("tools.toml", pipe),
        format!("tools.toml is no plain file, {not_plain}: {used}")
    );
    let huge = |file: &Path| fs::File::create(file).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(
        hostile("tools.toml", huge),
        format!("tools.toml has 1099511627776 bytes, where 16777216 are the most: {used}")
    );
    let garbage = |file: &Path| fs::write(file, [0xff, 0x00, 0x9f]).unwrap();
    assert_eq!(
        hostile("tools.toml", garbage),
        format!(
            "tools.toml does not begin with the line `# leadscrew tools 1, checksum …`: {used}"
        )
    );
    let future = |file: &Path| fs::write(file, "# leadscrew tools 2, checksum 00000000\n").unwrap();
    assert_eq!(
        hostile("tools.toml", future),
        format!("tools.toml has layout 2, and this version of Leadscrew reads layout 1: {used}")
    );
    let nan = |file: &Path| {
        let body = "[[tool]]\nnumber = 1\nkind = \"other\"\nlength_mm = nan\ndiameter_mm = 1\n";
        fs::write(file, format!("# leadscrew tools 1, edited\n{body}")).unwrap();
    };
    assert_eq!(
        hostile("tools.toml", nan),
        format!(
            "tools.toml says what cannot be (line 5: `length_mm` is NaN: expected a number from -10000 to 10000): {used}"
        )
    );
    assert_eq!(
        hostile("alarms.jsonl", link),
        format!("alarms.jsonl is a symbolic link, {not_plain}: nothing of it is used")
    );
    assert_eq!(
        hostile("alarms.jsonl", garbage),
        "alarms.jsonl has 1 line cut short or changed: the others are used"
    );
    assert!(hostile("lock", link).starts_with("cannot write to the state folder FOLDER: "));
    assert!(
        hostile("lock", |file| fs::hard_link(&target, file).unwrap())
            .ends_with("its file `lock` is no plain file of its own: remove it")
    );
    assert_eq!(fs::read_to_string(&target).unwrap(), "of somebody else");
}

#[test]
#[cfg(unix)]
fn a_lock_that_is_a_folder_and_a_folder_that_is_a_file_are_refused_in_a_sentence() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("state");
    fs::create_dir_all(path.join("lock")).unwrap();
    let refused = open(&path).unwrap_err().to_string();
    assert!(refused.ends_with("it is a folder"), "{refused}");
    let file = home.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(open(&file).is_err());
}

#[test]
fn of_very_many_alarms_the_newest_are_kept() {
    in_a_folder(|path| {
        // a full file, as a control would have written it
        let (mut folder, _, _) = open(path).unwrap();
        folder.save_alarm(alarm(0)).unwrap();
        let line = fs::read_to_string(path.join("alarms.jsonl")).unwrap();
        drop(folder);
        assert!(line.starts_with("{\"nth\":1,"));
        let (mut folder, _, _) = open(path).unwrap();
        folder.begin_batch();
        for _ in 1..MOST_ALARMS {
            folder.save_alarm(alarm(0)).unwrap();
        }
        folder.commit().unwrap();
        drop(folder);
        let (mut folder, state, found) = open(path).unwrap();
        assert_eq!((state.alarms.len(), found.len()), (MOST_ALARMS, 0));
        folder.save_alarm(alarm(1)).unwrap();
        folder.save_alarm(alarm(2)).unwrap();
        drop(folder);
        let (state, found) = opened(path);
        assert_eq!((state.alarms.len(), found.len()), (MOST_ALARMS / 2 + 1, 0));
        assert_eq!(state.alarms[MOST_ALARMS / 2 - 1..], [alarm(1), alarm(2)]);
    });
}

#[test]
fn an_alarm_that_was_cut_short_by_a_power_cut_costs_no_other() {
    in_a_folder(|path| {
        kept(path);
        let file = path.join("alarms.jsonl");
        let whole = fs::read(&file).unwrap();
        fs::write(&file, &whole[..whole.len() - 9]).unwrap();
        let (mut folder, state, found) = open(path).unwrap();
        assert_eq!((state.alarms, found.len()), (vec![alarm(2101)], 1));
        folder.save_alarm(alarm(2103)).unwrap();
        drop(folder);
        let (state, found) = opened(path);
        assert_eq!((state.alarms, found.len()), (vec![alarm(2101), alarm(2103)], 0));
    });
}

#[test]
fn a_reference_counts_only_as_long_as_its_encoder_has_kept_its_own() {
    assert_eq!(homing().of('Z', u64::MAX >> 1).map(|h| h.zero), Some(-12.345_678_9));
    assert_eq!(homing().of('Z', 3), None);
    assert_eq!(homing().of('X', u64::MAX >> 1), None);
}

#[test]
fn a_library_written_as_toml_reads_back_bit_for_bit() {
    let text = include_str!("../../../programs/tools.toml");
    let mut library = store::tools::parse_toml(text, 0).unwrap().library;
    let lathe = "[[tool]]\nnumber = 90\nkind = \"turning-insert\"\nlength_mm = 80\npoint_angle_deg = 55.1\nnose_radius_mm = 0.8\n\
        [[tool]]\nnumber = 91\nkind = \"threading-insert\"\nlength_mm = 80\nflat_mm = 0.1\ncrest_height_mm = 0.9\n\
        [[tool]]\nnumber = 92\nkind = \"polygon-cutter\"\nlength_mm = 80\ntip_radius_mm = 33.3\ninsert_angles_deg = [0, 91.7, 180.3]\n\
        [[tool]]\nnumber = 94\nkind = \"hob\"\nlength_mm = 60\ndiameter_mm = 80\ndiametral_pitch = 9.7\nstarts = 3\nhand = \"left\"\npressure_angle_deg = 14.5\nhob_length_in = 3.3\ncuts_with = \"M4\"\n\
        [[tool]]\nnumber = 93\nkind = \"tap\"\nlength_mm = 80\nthread = \"1/4-20 UNC-LH\"\nchamfer_pitches = 2.5\nthread_length_in = 0.9\nflute = \"straight\"\nholder = { kind = \"clutch\", stiffness_n_per_mm = 3.7, spline_length_mm = 5, pawl_backlash_rev = 0.3 }\n\
        wear_length_in = -0.0003\nlife = { uses = 3, limit_time_s = 60, at_limit = \"refuse\" }\n";
    for tool in store::tools::parse_toml(lathe, 0).unwrap().library.iter() {
        library.insert(tool.clone());
    }
    let written = store::tools::to_toml(&library);
    assert_eq!(store::tools::parse_controls_toml(&written).unwrap(), library);
    let none = ToolLibrary::default();
    assert_eq!(store::tools::parse_controls_toml(&store::tools::to_toml(&none)).unwrap(), none);
}

const FILES: [&str; 9] = [
    "parameters.var",
    "tools.toml",
    "homing.toml",
    "program.toml",
    "settings.toml",
    "workpiece.toml",
    "alarms.jsonl",
    "manifest.toml",
    "manifest.copy.toml",
];

/// What becomes of files of a state while no control has the folder.
#[derive(Clone, Copy, Debug)]
enum Damage {
    BitFlipped(usize, u8),
    CutShort(usize),
    Emptied,
    Removed,
    /// Together with the version before, and the other copy.
    RemovedWithItsBackup,
    /// The same file of another machine, and of another folder of this one.
    OfAnotherMachine,
    OfAnotherFolder,
    OfANewerVersion,
    /// As it was when each datum had been saved once.
    AnOlderCopy,
}

impl Damage {
    fn all(at: usize, bit: u8) -> [Self; 9] {
        [
            Self::BitFlipped(at, bit),
            Self::CutShort(at),
            Self::Emptied,
            Self::Removed,
            Self::RemovedWithItsBackup,
            Self::OfAnotherMachine,
            Self::OfAnotherFolder,
            Self::OfANewerVersion,
            Self::AnOlderCopy,
        ]
    }

    fn strike(self, path: &Path, name: &str, others: &Others) {
        let file = path.join(name);
        let mut bytes = fs::read(&file).unwrap();
        let of = |folder: &tempfile::TempDir| fs::read(folder.path().join(name)).unwrap();
        match self {
            Self::BitFlipped(at, bit) => {
                let at = at % bytes.len();
                bytes[at] ^= 1 << (bit % 8);
            }
            Self::CutShort(at) => bytes.truncate(at % bytes.len()),
            Self::Emptied => bytes.clear(),
            Self::Removed => return fs::remove_file(&file).unwrap(),
            Self::RemovedWithItsBackup => {
                let all = match name.strip_prefix("manifest") {
                    Some(_) => vec!["manifest.toml".into(), "manifest.copy.toml".into()],
                    None => vec![name.to_owned(), format!("{name}.previous")],
                };
                return all.iter().for_each(|name: &String| {
                    let _ = fs::remove_file(path.join(name)); // it has no version before
                });
            }
            Self::OfAnotherMachine => bytes = of(&others.machine),
            Self::OfAnotherFolder => bytes = of(&others.folder),
            Self::OfANewerVersion => {
                let text = String::from_utf8(bytes).unwrap();
                bytes = text.replacen(" 1, checksum ", " 9, checksum ", 1).into_bytes();
            }
            Self::AnOlderCopy => bytes = of(&others.before),
        }
        fs::write(file, bytes).unwrap();
    }
}

/// Folders from which files are taken.
struct Others {
    machine: tempfile::TempDir,
    folder: tempfile::TempDir,
    before: tempfile::TempDir,
}

fn copied(from: &Path) -> tempfile::TempDir {
    let to = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), to.path().join(entry.file_name())).unwrap();
    }
    to
}

/// A folder as it was left, the same state that differs in each value, and the folder before that.
fn written() -> (tempfile::TempDir, Others, State) {
    let all = |folder: &mut StateFolder, n: f64| {
        folder.save_parameters(&parameters(n)).unwrap();
        folder.save_tools(&tools(n)).unwrap();
        folder.save_last_program(&LastProgram { line: n as u32, ..program() }).unwrap();
        let zero = HomedAxis { axis: 'Z', zero: n, epoch: 1 };
        folder.save_homed(&Homing { axis: vec![zero] }).unwrap();
        folder.save_settings(&Settings { feed_override: n / 10.0, ..settings() }).unwrap();
        let workpiece = WorkpieceRecord { number: n as u32, ..WorkpieceRecord::default() };
        folder.save_workpiece(&workpiece).unwrap();
        folder.save_alarm(alarm(n as u32)).unwrap();
    };
    let with = |machine: &MachineIdentity, first: f64| {
        let home = tempfile::tempdir().unwrap();
        let (mut folder, _, _) = StateFolder::open(home.path(), machine).unwrap();
        all(&mut folder, first);
        (home, folder)
    };
    let (home, mut folder) = with(&machine(), 1.0);
    let before = copied(home.path());
    all(&mut folder, 2.0);
    drop(folder);
    let mill = MachineIdentity { name: "vfd-mill".into(), ..machine() };
    let others = Others { machine: with(&mill, 3.0).0, folder: with(&machine(), 4.0).0, before };
    let (state, found) = opened(home.path());
    assert_eq!(found, []);
    (home, others, state)
}

/// After any damage the state is the same, or the start is refused, or each value that is another
/// one is named, at this start and at the next.
fn held(folder: &Path, last: &State, what: &str) -> &'static str {
    let (state, found) = match open(folder) {
        Ok((folder, state, found)) => {
            drop(folder);
            (state, found)
        }
        Err(refused) => {
            let why = refused.to_string();
            assert!(why.contains("name another folder"), "{what}: {why}");
            return "refused";
        }
    };
    if state.changes.is_empty() {
        assert_eq!(state, *last, "{what}: {found:?}");
        let (again, found) = opened(folder);
        assert_eq!((again, found), (last.clone(), Vec::new()), "{what}: it is whole again");
        return "the same state";
    }
    let named = |part: &str| state.changes.iter().any(|change| change.datum.contains(part));
    for (part, differs) in [
        ("G54 X", state.parameters != last.parameters),
        ("tool 3", state.tools != last.tools),
        ("axis Z", state.homed != last.homed),
        ("program", state.last_program != last.last_program),
        ("settings", state.settings != last.settings),
        ("workpiece", state.workpiece != last.workpiece),
        ("alarms", state.alarms != last.alarms),
    ] {
        let is_all = named("all that was kept") || named("more values of");
        let is_all = is_all || named("history of alarms") && part == "alarms";
        assert!(!differs || named(part) || is_all, "{what}: {part}: {:?}", state.changes);
    }
    let (again, _) = opened(folder);
    assert_eq!(again, state, "{what}: it is said as long as it is not acknowledged");
    "named"
}

#[test]
fn whatever_becomes_of_a_file_the_state_is_the_same_or_each_value_that_differs_is_named() {
    let (home, others, last) = written();
    let mut random = 0x9e37_79b9_7f4a_7c15_usize;
    for round in 0..size::of(2, 60) {
        for name in FILES {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            for damage in Damage::all(random >> 20, (random >> 12) as u8) {
                let folder = copied(home.path());
                damage.strike(folder.path(), name, &others);
                let what = format!("round {round}: {name}: {damage:?}");
                let ended = held(folder.path(), &last, &what);
                // one file alone costs nothing: it is in the manifest, which is there twice
                let is_alone = !matches!(damage, Damage::RemovedWithItsBackup)
                    || !name.starts_with("manifest");
                let is_history = name == "alarms.jsonl";
                assert!(!is_alone || is_history || ended == "the same state", "{what}: {ended}");
            }
        }
    }
}

#[test]
fn whatever_becomes_of_two_files_at_once_the_same_holds() {
    let (home, others, last) = written();
    let mut random = 0x2545_f491_4f6c_dd1d_usize;
    let mut ends = std::collections::BTreeMap::<_, u32>::new();
    for round in 0..size::of(120, 5000) {
        let folder = copied(home.path());
        let mut what = format!("round {round}");
        for _ in 0..2 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let name = FILES[(random >> 40) % FILES.len()];
            let damage = Damage::all(random >> 20, (random >> 12) as u8)[(random >> 50) % 9];
            what = format!("{what}; {name}: {damage:?}");
            if folder.path().join(name).exists() {
                damage.strike(folder.path(), name, &others);
            }
        }
        *ends.entry(held(folder.path(), &last, &what)).or_default() += 1;
    }
    println!("{ends:?}");
    assert!(ends["the same state"] > 0 && ends["named"] > 0, "{ends:?}");
}

#[test]
fn a_folder_whose_files_are_all_gone_is_no_new_one() {
    let (home, _, _) = written();
    for entry in fs::read_dir(home.path()).unwrap() {
        let entry = entry.unwrap();
        if entry.file_name() != "lock" {
            fs::remove_file(entry.path()).unwrap();
        }
    }
    let (state, _) = opened(home.path());
    assert_eq!(state.changes[0].datum, "all that was kept");
    let new = tempfile::tempdir().unwrap();
    assert_eq!(opened(new.path()), (State::default(), Vec::new()));
    assert_eq!(opened(new.path()), (State::default(), Vec::new()), "it has kept nothing yet");
}

#[test]
fn a_folder_of_a_version_without_manifest_is_used_when_its_values_are_acknowledged() {
    in_a_folder(|path| {
        fs::create_dir(path).unwrap();
        let body = "5221\t5.000000\n";
        let checksum = crc32(body);
        let text = format!("# leadscrew parameters 1, checksum {checksum:08x}\n{body}");
        fs::write(path.join("parameters.var"), text).unwrap();
        let (mut folder, state, _) = open(path).unwrap();
        assert_eq!(state.parameters.unwrap().get(5221), Some(5.0));
        let said = state.changes[0].to_string();
        assert!(said.starts_with("G54 X not known → 5.000: parameters.var "), "{said}");
        folder.acknowledge().unwrap();
        drop(folder);
        assert_eq!(opened(path).0.changes, []);
    });
}

/// CRC-32 of ISO-HDLC, a bit at a time.
fn crc32(text: &str) -> u32 {
    !text.bytes().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 }
        })
    })
}
