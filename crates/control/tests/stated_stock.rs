//! A stock that a program states is the stock of the judge and of the simulated machine on a
//! control that is on, as in a run.
use crate::workpiece::{make_ready, until};
use control::drives::simulated;
use control::job::{ProgramOptions, Session, preflight};
use control::observers::Workpiece;
use control::operation::{Execution, Request};
use control::{Control, ControlOptions, Executor, Loaded, Running, config};
use verify::{Feature, FeatureKind};

/// Two holes in a block whose top the comment states.
const BLOCK: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\nG99 G81 X0 Y0 Z-16 R2 F600\n\
    G81 X150 Y0 Z-16 R2\nG80\nG0 Z50\nM2\n";
/// M24x1.5 on a bar of 24 mm; of the machine's 20 mm nothing is cut.
const BAR: &str = "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X13 Y0 Z6\n\
    G76 P1.5 Z-12 I-1 J0.3 K0.985 R2 Q29.5 H1\nG0 X30 Z50\nM5\nM30\n";

/// What is said of each feature.
fn said(features: &[Feature]) -> Vec<String> {
    let of = |f: &Feature| {
        let depth = match &f.kind {
            FeatureKind::Hole(hole) => format!(" {:.2} deep", hole.depth.value()),
            FeatureKind::Turned(thread) => thread.class_and_size(),
            _ => String::new(),
        };
        format!("{} {}{depth}: {:?}", f.line, f.kind_name(), f.verdict)
    };
    features.iter().map(of).collect()
}

fn on_a_control(machine: &str, text: &str) -> Vec<String> {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("part.ngc");
    std::fs::write(&path, text).unwrap();
    let options = ControlOptions::simulated(ProgramOptions::from(machine));
    let mut control = Control::new(options).map_err(|why| why.to_string()).unwrap();
    make_ready(&mut control);
    control.request(&Request::Load(path)).map_err(|why| why.to_string()).unwrap();
    control.request(&Request::Start).map_err(|why| why.to_string()).unwrap();
    until(&mut control, |control| control.execution() == Execution::ProgramCompleted);
    (0..10).for_each(|_| control.period());
    said(&control.features())
}

fn in_a_run(machine: &str, text: &str, stock: Option<&str>) -> Vec<String> {
    let options =
        ProgramOptions { stock: stock.map(str::to_owned), ..ProgramOptions::from(machine) };
    let mut session = Session::load(&options, "-".as_ref(), text.as_bytes()).unwrap();
    let material = session.machine.setup.stock.material;
    let plan = session.plan_options(material);
    let proved = preflight::prove(&mut session, text.as_bytes(), plan, &mut |_| ());
    assert!(!proved.known.is_refused(), "{:?}", proved.known.findings);
    let zero = session.work_zero();
    let simulated = config::simulator(session.plant(), &session.tools, material, 1, &zero);
    let machine = simulated::drives(simulated::build(session.plant(), simulated).unwrap(), 0);
    let kernel = kernel::Kernel::new(config::control(&session.machine, None, false));
    let mut executor = Executor::new(kernel, machine);
    let loaded = Loaded {
        session: &session,
        operations: &proved.operations,
        restart: None,
        options: plan,
        planned: proved.known.planned,
    };
    let workpiece = Workpiece::new(session.judge(material, &zero));
    let mut running = Running::attended(&loaded, workpiece, 0, &mut executor);
    while running.period(&mut executor).is_continue() {}
    assert!(executor.kernel.faults().is_empty(), "{:?}", executor.kernel.faults());
    let mut judge = running.end().workpiece().judge;
    judge.settle(u32::MAX);
    said(judge.features())
}

#[test]
fn a_stated_block_is_that_of_holes_and_of_the_machine_on_a_control_as_in_a_run() {
    let text = format!("(STOCK X-20 Y-20 Z-40 X60 Y60 Z-5)\n{BLOCK}");
    let found = on_a_control("tapping-center", &text);
    assert_eq!(found, in_a_run("tapping-center", &text, None));
    assert!(found[0].contains("hole 11.00 deep"), "from the top at Z-5: {found:?}");
    assert!(found[1].contains("hole 0.00 deep") && found[1].contains("Fail"), "beside: {found:?}");
    let stated = in_a_run("tapping-center", BLOCK, Some("X-20 Y-20 Z-40 X60 Y60 Z-5"));
    let one_less = |line: &String| line.split_once(' ').map(|(_, rest)| rest.to_owned());
    let rest = |all: &[String]| all.iter().map(one_less).collect::<Vec<_>>();
    assert_eq!(rest(&found), rest(&stated), "at the command line");
    let own = in_a_run("tapping-center", BLOCK, None);
    assert!(own[0].contains("hole 16.00 deep") && own[1].contains("Pass"), "{own:?}");
}

#[test]
fn a_stated_bar_is_turned_on_a_control_as_in_a_run() {
    let text = format!("(STOCK DIA 24 LENGTH 90)\n{BAR}");
    let found = on_a_control("lathe", &text);
    assert_eq!(found, in_a_run("lathe", &text, None));
    assert!(found.len() == 1 && found[0].contains("M24x1.5"), "{found:?}");
    let stated = in_a_run("lathe", BAR, Some("X-12 Y-12 Z-90 X12 Y12 Z0"));
    assert!(stated[0].contains("M24x1.5"), "{stated:?}");
}

#[test]
fn the_next_program_that_states_none_goes_on_with_the_workpiece_and_the_next_workpiece_does_not() {
    let home = tempfile::tempdir().unwrap();
    let options = ControlOptions::simulated(ProgramOptions::from("tapping-center"));
    let mut control = Control::new(options).map_err(|why| why.to_string()).unwrap();
    make_ready(&mut control);
    let cut = |control: &mut Control, stock: &str| {
        let path = home.path().join("part.ngc");
        std::fs::write(&path, format!("{stock}\n{BLOCK}")).unwrap();
        control.request(&Request::Load(path)).map_err(|why| why.to_string()).unwrap();
        control.request(&Request::Start).map_err(|why| why.to_string()).unwrap();
        until(control, |control| control.execution() == Execution::ProgramCompleted);
        (0..10).for_each(|_| control.period());
        said(&control.features())
    };
    assert!(cut(&mut control, "(STOCK X-20 Y-20 Z-40 X60 Y60 Z-5)")[0].contains("11.00 deep"));
    control.request(&Request::BeginWorkpiece(None)).unwrap();
    assert!(cut(&mut control, "(the machine's)")[0].contains("16.00 deep"));
}

/// A hole from 5 mm below the zero on, approached by a rapid to 4 mm below it.
const BELOW: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS2000 M3\nG0 X20 Y0 Z20\nG0 Z-4\n\
    G81 Z-16 R-4 F300\nG80\nG0 Z50\nM2\n";

#[test]
fn the_next_program_is_planned_against_the_stock_that_one_before_has_stated_or_the_command_line() {
    let home = tempfile::tempdir().unwrap();
    let path = |name: &str, text: &str| {
        let path = home.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let below = path("below.ngc", BELOW);
    let block = path("block.ngc", &format!("(STOCK X-20 Y-20 Z-40 X200 Y60 Z-5)\n{BLOCK}"));
    let start = |control: &mut Control, path: &std::path::PathBuf| {
        control.request(&Request::Load(path.clone())).map_err(|why| why.to_string())?;
        control.request(&Request::Start).map_err(|why| why.to_string())?;
        until(control, |control| control.execution() == Execution::ProgramCompleted);
        (0..10).for_each(|_| control.period());
        Ok::<_, String>(said(&control.features()))
    };
    let on = |stock: Option<&str>| {
        let stock = stock.map(str::to_owned);
        let program = ProgramOptions { stock, ..ProgramOptions::from("tapping-center") };
        let options = ControlOptions::simulated(program);
        let mut control = Control::new(options).map_err(|why| why.to_string()).unwrap();
        make_ready(&mut control);
        control
    };
    let mut control = on(None);
    let into_the_stock = |found: Result<Vec<String>, String>| {
        let why = found.expect_err("4 mm into the machine's own stock");
        assert!(why.contains("4 mm into the stock"), "{why}");
    };
    into_the_stock(start(&mut control, &below));
    start(&mut control, &block).unwrap();
    let found = start(&mut control, &below).unwrap();
    assert!(found.last().is_some_and(|last| last.contains("11.00 deep: Pass")), "{found:?}");
    control.request(&Request::EndWorkpiece).unwrap();
    into_the_stock(start(&mut control, &below));
    control.request(&Request::BeginWorkpiece(None)).unwrap();
    into_the_stock(start(&mut control, &below));
    let mut control = on(Some("X-20 Y-20 Z-40 X60 Y60 Z-5"));
    let found = start(&mut control, &below).unwrap();
    assert!(found[0].contains("11.00 deep: Pass"), "{found:?}");
}
