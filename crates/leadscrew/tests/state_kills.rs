//! A control that is killed at any instant, while it runs a program and writes offsets, tools,
//! position and alarms, has lost nothing that it had acknowledged, and nothing half-written is
//! believed.
//!
//! The test starts itself as the control ([`control_that_is_killed`]) and sends SIGKILL at random
//! instants. `STATE_KILLS` says how often: `cargo xtask state-kills` 500 times.
use control::drives::simulated;
use control::job::{ProgramOptions, Session, preflight};
use control::observers::Workpiece;
use control::{Executor, Loaded, Running, config};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use store::parameters::Parameters;
use store::state::{AlarmRecord, LastProgram, MachineIdentity, State, StateFolder, Weight};
use test_support::size;
use units::Length;

const FOLDER: &str = "STATE_KILLS_FOLDER";
/// A control is killed within this of its start.
const LONGEST_LIFE_MS: u64 = 400;
const TAP: u32 = 3;
const PROGRAM: &str = "G21 G90 G54 G17 G94\nT3 M6\nG43 H3\nS1000 M3\nG0 X0 Y0 Z20\nG99 G84 X0 Y0 Z-15 R5 F1000\nG80\nG0 Z50\nM2\n";

fn machine() -> MachineIdentity {
    MachineIdentity { name: "tapping-center".into(), axes: "XYZ".into(), spindles: 1 }
}

/// What was saved last of each datum: the number of the save is in every value of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Saved {
    offsets: u32,
    tools: u32,
    position: u32,
    alarms: u32,
}

/// The numbers in a state; a datum whose values do not belong together is half-written.
fn saved(state: &State) -> Saved {
    let value = |number| state.parameters.as_ref().and_then(|p| p.get(number)).unwrap_or(0.0);
    let offsets = value(5221);
    assert!((5221..5230).all(|number| value(number) == offsets), "half-written offsets");
    let tap = state.tools.as_ref().and_then(|tools| tools.get(TAP));
    let tools = tap.map_or(0, |tap| tap.life.used.uses);
    let worn = tap.map_or(Length::ZERO, |tap| tap.wear.length);
    assert_eq!(worn, Length::um(f64::from(tools)), "half-written tools");
    let program = state.last_program.clone().unwrap_or_default();
    assert_eq!(program.line, program.operation, "a half-written position");
    let alarms = state.alarms.last().map_or(0, |alarm| alarm.number);
    Saved { offsets: offsets as u32, tools, position: program.line, alarms }
}

#[test]
#[ignore = "the control that the other test kills"]
fn control_that_is_killed() {
    let Some(path) = std::env::var_os(FOLDER) else { return };
    let (mut folder, state, _) = StateFolder::open(Path::new(&path), &machine()).unwrap();
    let mut last = saved(&state);
    let options = ProgramOptions::from("tapping-center");
    let mut session = Session::load(&options, "-".as_ref(), PROGRAM.as_bytes()).unwrap();
    let mut tools = session.tools.clone();
    let material = session.machine.setup.stock.material;
    let plan = session.plan_options(material);
    let proved = preflight::prove(&mut session, PROGRAM.as_bytes(), plan, &mut |_| ());
    let zero = session.work_zero();
    loop {
        let simulator = config::simulator(&session.machine, &session.tools, material, 1, &zero);
        let machine = simulated::drives(simulated::build(&session.machine, simulator).unwrap(), 0);
        let kernel = kernel::Kernel::new(config::control(&session.machine, None, false));
        let mut executor = Executor::new(kernel, machine);
        let judge = config::judge(&session.machine, &session.tools, material, &zero);
        let loaded = Loaded {
            session: &session,
            operations: &proved.operations,
            restart: None,
            options: plan,
            planned: proved.known.planned,
        };
        let mut running = Running::attended(&loaded, Workpiece::new(judge), 0, &mut executor);
        while running.period(&mut executor).is_continue() {
            save(&mut folder, &mut tools, &mut last);
        }
    }
}

/// The next save of each datum; what is printed has been acknowledged.
fn save(folder: &mut StateFolder, tools: &mut canon::ToolLibrary, last: &mut Saved) {
    last.offsets += 1;
    let mut parameters = Parameters::default();
    assert!((5221..5230).all(|number| parameters.set(number, f64::from(last.offsets))));
    folder.save_parameters(&parameters).unwrap();
    println!("offsets {}", last.offsets);
    last.tools += 1;
    let mut tap = tools.get(TAP).unwrap().clone();
    tap.life.used.uses = last.tools;
    tap.wear.length = Length::um(f64::from(last.tools));
    tools.insert(tap);
    folder.save_tools(tools).unwrap();
    println!("tools {}", last.tools);
    last.position += 1;
    let (line, operation) = (last.position, last.position);
    folder.save_last_program(&LastProgram { line, operation, ..LastProgram::default() }).unwrap();
    println!("position {}", last.position);
    last.alarms += 1;
    folder.save_alarm(AlarmRecord { number: last.alarms, ..AlarmRecord::default() }).unwrap();
    println!("alarms {}", last.alarms);
}

/// Start a control, kill it after so long; what it has acknowledged.
fn killed_after(life: Duration, folder: &Path, before: Saved) -> Saved {
    let mut control = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "state_kills::control_that_is_killed", "--ignored", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let said = BufReader::new(control.stdout.take().unwrap());
    let read = move || said.lines().map_while(Result::ok).collect::<Vec<_>>();
    let reader = std::thread::Builder::new().spawn(read).unwrap();
    std::thread::sleep(life);
    control.kill().unwrap();
    control.wait().unwrap();
    let mut acknowledged = before;
    for line in reader.join().unwrap() {
        let Some((what, number)) = line.split_once(' ') else { continue };
        let Ok(number) = number.parse() else { continue };
        match what {
            "offsets" => acknowledged.offsets = number,
            "tools" => acknowledged.tools = number,
            "position" => acknowledged.position = number,
            "alarms" => acknowledged.alarms = number,
            _ => {}
        }
    }
    acknowledged
}

#[test]
fn a_control_that_is_killed_at_any_instant_has_lost_nothing_that_it_acknowledged() {
    let kills = std::env::var("STATE_KILLS").ok().and_then(|n| n.parse().ok());
    let kills: u32 = kills.unwrap_or_else(|| size::of(8, 200));
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("state");
    let mut before = Saved::default();
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for kill in 0..kills {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let acknowledged =
            killed_after(Duration::from_millis(random % LONGEST_LIFE_MS), &path, before);
        let (_, state, found) = StateFolder::open(&path, &machine()).unwrap();
        let serious: Vec<_> = found.iter().filter(|f| f.weight != Weight::Note).collect();
        assert!(serious.is_empty(), "kill {kill}: {serious:?}");
        assert_eq!(state.changes, [], "kill {kill}: a kill is no damage");
        let now = saved(&state);
        for (kept, said) in [
            (now.offsets, acknowledged.offsets),
            (now.tools, acknowledged.tools),
            (now.position, acknowledged.position),
            (now.alarms, acknowledged.alarms),
        ] {
            // the save that was under way may be whole already
            assert!(kept == said || kept == said + 1, "kill {kill}: {now:?}, {acknowledged:?}");
        }
        before = now;
    }
    println!("{kills} kills, {} saves of each datum: nothing lost", before.offsets);
}
