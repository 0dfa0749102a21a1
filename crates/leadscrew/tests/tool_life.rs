//! The life of a tool: counted by what is executed, said or refused where the tool is called at its
//! end.
use control::drives::simulated;
use control::job::preflight;
use control::job::{ProgramOptions, Session};
use control::observers::{Workpiece, use_up};
use control::{Executor, Loaded, Running, config};
use diag::Severity;
use leadscrew::Program;
use std::path::PathBuf;

const TOOLS: &str = "[[tool]]\nnumber = 2\nkind = \"drill\"\ndiameter_mm = 5.0\npoint_angle_deg = 140.0\nlength_mm = 118.5\n\
    [[tool]]\nnumber = 3\nkind = \"tap\"\nlength_mm = 105.25\nthread = \"M6x1\"\nchamfer_pitches = 2.5\nthread_length_mm = 25.0\n\
    flute = \"spiral-flute\"\nholder = { kind = \"rigid\", stiffness_n_per_um = 20.0 }\n";

/// Two M6 holes, drilled and tapped; the tap comes twice.
const PROGRAM: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\nG99 G81 X0 Y0 Z-20 R5 F300\nX20\nG80\n\
    T3 M6\nG43 H3\nS1000 M3\nG0 X0 Y0 Z20\nG99 G84 X0 Y0 Z-15 R5 F1000\nG80\nT2 M6\nT3 M6\nG43 H3\nS1000 M3\nG0 X20 Y0 Z20\n\
    G99 G84 X20 Y0 Z-15 R5 F1000\nG80\nG0 Z50\nM2\n";

fn options(life_of_tap: &str) -> (ProgramOptions, tempfile::TempDir) {
    let home = tempfile::tempdir().unwrap();
    let path: PathBuf = home.path().join("tools.toml");
    std::fs::write(&path, format!("{TOOLS}{life_of_tap}\n")).unwrap();
    let options = ProgramOptions { tools: Some(path), ..ProgramOptions::from("tapping-center") };
    (options, home)
}

fn found(life_of_tap: &str) -> Vec<(Severity, u32, String)> {
    let (options, _home) = options(life_of_tap);
    let mut job = Program::of("two holes", PROGRAM).on(options).unwrap();
    let found = job.check().iter().filter(|f| f.code == "A0105");
    found.map(|f| (f.severity, f.span.line, f.message.clone())).collect()
}

#[test]
fn a_tool_at_the_end_of_its_life_is_remarked_upon_or_refused_where_it_is_called() {
    assert_eq!(found(""), []);
    assert_eq!(found("life = { uses = 9, limit_uses = 500 }"), []);
    let said = |used: &str| format!("T3 is at the end of its life: {used}");
    assert_eq!(
        found("life = { uses = 500, limit_uses = 500 }"),
        [(Severity::Warning, 9, said("500 of 500 uses"))]
    );
    assert_eq!(
        found("life = { time_s = 61, limit_time_s = 60, at_limit = \"refuse\" }"),
        [(Severity::Error, 9, said("61 of 60 s of cutting"))]
    );
}

#[test]
fn a_tool_that_comes_to_its_end_within_the_program_is_said_at_its_next_call() {
    assert_eq!(
        found("life = { uses = 499, limit_uses = 500 }"),
        [(Severity::Warning, 16, "T3 is at the end of its life: 500 of 500 uses".into())]
    );
}

#[test]
fn a_life_that_cannot_be_is_refused_with_its_place() {
    let (options, _home) = options("life = { uses = -1, limit_uses = 0, at_limit = \"stop\" }");
    let Err(refused) = Program::of("two holes", PROGRAM).on(options) else { panic!("it is read") };
    let said = format!("{refused:?}");
    for word in ["uses", "limit_uses", "at_limit"] {
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn what_is_executed_is_counted_in_holes_time_and_length() {
    let (options, _home) = options("");
    let mut session = Session::load(&options, "-".as_ref(), PROGRAM.as_bytes()).unwrap();
    let material = session.machine.setup.stock.material;
    let plan = session.plan_options(material);
    let proved = preflight::prove(&mut session, PROGRAM.as_bytes(), plan, &mut |_| ());
    let zero = session.work_zero();
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
    running.count_tool_use(0);
    while running.period(&mut executor).is_continue() {}
    assert!(executor.kernel.faults().is_empty(), "{:?}", executor.kernel.faults());
    let mut ended = running.end();
    let used = ended.take_tool_use();
    assert_eq!((used[&2].uses, used[&3].uses), (2, 2));
    // each tap goes 20 mm in and out: from R5 to Z-15; each drill 25 mm in, at 5 mm/s, and out in a
    // rapid
    let close = |found: f64, wanted: f64| (found - wanted).abs() < 0.02 * wanted;
    assert!(close(used[&3].length.value(), 80.0), "{used:?}");
    assert!(close(used[&2].length.value(), 50.0), "{used:?}");
    assert!(close(used[&2].time.value(), 10.0), "{used:?}");
    let mut tools = session.tools.clone();
    use_up(&mut tools, &used);
    use_up(&mut tools, &ended.take_tool_use());
    assert_eq!(tools.get(3).unwrap().life.used, used[&3]);
}
