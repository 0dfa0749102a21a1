//! What a clutch holder is for, shown. The same holes are tapped twice on a spindle whose speed,
//! stopping time and relay scatter: with a clutch holder, and conventionally with a
//! tension/compression holder.
//!
//! ```text
//!   program ─► tools in a clutch holder ───► run on a scattered spindle ─► depth of each hole ─► mean, 1σ
//!           └► tools in a floating holder ─► run on the same spindle ────► depth of each hole ─► mean, 1σ
//! ```
//!
//! What the conventional cycle must scatter by is said beside it, by `closed_form`.
mod closed_form;

use crate::Program;
use canon::{Hand, Holder, ThreadSize, Tool, ToolKind, ToolLibrary, UnknownSize};
use control::Refused;
use control::config;
use control::drives::simulated;
use control::job::ProgramOptions;
use kernel::Kernel;
use plan::{PlainDrive, TapMethod, Unsynchronised};
use report::{Comparison, TappingMethod};
use std::path::PathBuf;
use units::{Angle, Length, Spin, Stiffness, Time};
use verify::{Feature, FeatureKind};

/// Mean time from an order to the drive's obeying, s: a contactor and a scan of its logic.
const RELAY_DELAY: Time = Time::s(0.020);
/// A spindle without synchronisation is at speed when it is this near, as a share.
const AT_SPEED: f64 = 0.10;
/// Holes of one run of the program made for a size: 20 mm apart within the machine's stock.
const HOLES_A_RUN: usize = 200;
/// R plane over the work, unless the conventional cycle needs a higher one.
const CLEARANCE: Length = Length::mm(5.0);
/// By how much more than the mean the scattered spindle overruns and pulls its holder out, as a
/// share.
const SCATTERED: f64 = 0.5;
/// Most travel that tension/compression holders have (makers' tables: 5 to 40 mm for M3 to M30).
const MOST_TRAVEL: Length = Length::mm(40.0);
/// Of the holes: the stock has a lower side.
const DEEPEST: Length = Length::mm(35.0);
/// Runs that a comparison may take.
const MOST_RUNS: u64 = 10_000;

/// Both holders, and the drive that they meet.
struct Case {
    name: &'static str,
    holder: Holder,
    method: TapMethod,
}

impl Case {
    /// Its holder; one that floats has the travel that the spindle asks for, as far as there are
    /// such holders.
    fn holder(&self, args: &CompareOptions, drive: &sim::PlainDrive) -> Holder {
        let thread = args.size.as_deref().unwrap_or("M6").parse::<ThreadSize>();
        match (self.holder, thread) {
            (Holder::TensionCompression { stiffness, travel }, Ok(thread))
                if args.program.is_none() =>
            {
                let out = closed_form::pulled_out(&thread, Spin::rpm(args.speed), drive);
                let needed = out * (1.0 + SCATTERED);
                Holder::TensionCompression {
                    stiffness,
                    travel: travel.max(needed.min(MOST_TRAVEL)),
                }
            }
            (holder, _) => holder,
        }
    }
}

const CASES: [Case; 2] = [
    Case {
        name: "clutch holder",
        holder: Holder::Clutch {
            spline_length: Length::mm(5.0),
            pawl_backlash: Angle::rev(0.1),
            stiffness: Stiffness::n_per_mm(10.0),
            compression: Length::mm(3.0),
        },
        method: TapMethod::Synchronised,
    },
    Case {
        name: "conventional, tension/compression holder",
        holder: Holder::TensionCompression {
            stiffness: Stiffness::n_per_mm(25.0),
            travel: Length::mm(15.0),
        },
        method: TapMethod::Floating,
    },
];

/// What is compared, and on which spindle.
#[derive(Debug, Clone)]
pub struct CompareOptions {
    /// Machine, tools, and how a program is read.
    pub source: ProgramOptions,
    /// The program whose taps are compared; `None` is holes of one size.
    pub program: Option<PathBuf>,
    /// Instead of a program: holes of this thread; `None` is M6.
    pub size: Option<String>,
    /// Speed of the holes of a size, and at which the stopping time is taken, rev/min.
    pub speed: f64,
    /// Depth of the holes, mm; `None` is 5 mm and 1.5 diameters.
    pub depth: Option<f64>,
    /// Holes tapped each way.
    pub samples: u32,
    /// Seed of the scatter.
    pub seed: u64,
    /// Stopping time of the spindle, s; `None` is the machine's own ramp.
    pub stopping_time: Option<f64>,
    /// 1σ of the spindle speed, percent.
    pub speed_scatter: f64,
    /// 1σ of the stopping time, percent.
    pub stopping_scatter: f64,
    /// 1σ of the relay's delay, ms.
    pub relay_scatter: f64,
}

/// What came of it.
pub struct Compared {
    /// Both ways, with the depth of every hole.
    pub comparison: Comparison,
    /// What the conventional cycle must scatter by, for holes of a size.
    pub closed_form: Option<String>,
}

/// Tap the same holes with a clutch holder and without, on a spindle that scatters; `progress`
/// hears of every hole.
///
/// # Errors
/// A number is out of its range, the program is refused, or there is nothing to tap.
pub fn compare(args: &CompareOptions, progress: &mut dyn FnMut()) -> Result<Compared, Refused> {
    let drive = drive(args)?;
    let (program, name) = match (&args.program, &args.size) {
        (Some(path), None) => {
            let program = Program::open(path)?;
            let name = program.name.clone();
            (program, name)
        }
        (_, size) => {
            let size = size.as_deref().unwrap_or("M6");
            let text = program_for(size, args, &drive)?;
            (Program::of("the program for this size", text), size.to_owned())
        }
    };
    let mut ways = Vec::new();
    for case in &CASES {
        ways.push(way(args, case, &program, drive, progress)?);
    }
    let closed_form = if args.program.is_none() {
        let thread = thread_of(args.size.as_deref().unwrap_or("M6"))?;
        let fastest = drive_limits(args)?.tapping_max;
        let depth = depth(args, &thread);
        Some(closed_form::Scatter { thread, depth, drive }.text(Spin::rpm(args.speed), fastest))
    } else {
        None
    };
    let comparison = Comparison {
        title: format!("{name}: clutch holder and conventional cycle"),
        scatter: scatter_sentence(args, &drive),
        ways,
    };
    Ok(Compared { comparison, closed_form })
}

/// Holders that are compared.
pub const WAYS: u32 = CASES.len() as u32;

/// The spindle that taps.
fn drive_limits(args: &CompareOptions) -> Result<plan::SpindleLimits, Refused> {
    let machine = control::config::machine_file::load(&args.source.machine)?;
    config::planner(&machine)
        .spindles
        .first()
        .copied()
        .ok_or_else(|| Refused::because("this machine has no spindle to tap with".to_owned()))
}

/// The drive that scatters; its ramp is as long as the machine's own from the speed of the
/// comparison to rest.
fn drive(args: &CompareOptions) -> Result<sim::PlainDrive, Refused> {
    let spindle = drive_limits(args)?;
    let speed = Spin::rpm(args.speed);
    let stopping = match args.stopping_time {
        Some(seconds) => Time::s(seconds),
        None => Time::s(spindle.ramp(speed, Spin::ZERO).duration()),
    };
    let numbers = [args.speed, stopping.value(), f64::from(args.samples)];
    let scatters = [args.speed_scatter, args.stopping_scatter, args.relay_scatter];
    let sound = numbers.into_iter().all(|x| x.is_finite() && x > 0.0)
        && scatters.into_iter().all(|x| (0.0..=50.0).contains(&x));
    if !sound {
        return Err(Refused::because(
            "expected a speed, a stopping time and samples above 0, and scatters from 0 to 50"
                .to_owned(),
        ));
    }
    Ok(sim::PlainDrive {
        delay: RELAY_DELAY,
        delay_scatter: Time::s(args.relay_scatter * 1e-3),
        accel: speed / stopping,
        decel: speed / stopping,
        ramp_scatter: args.stopping_scatter / 100.0,
        speed_scatter: args.speed_scatter / 100.0,
        orients: None,
    })
}

fn scatter_sentence(args: &CompareOptions, drive: &sim::PlainDrive) -> String {
    let stopping = Spin::rpm(args.speed) / drive.accel;
    format!(
        "1σ of the spindle: speed {} %, stopping time {} % of {:.3} s, relay {} ms about {:.0} ms; seed {}",
        args.speed_scatter,
        args.stopping_scatter,
        stopping.value(),
        args.relay_scatter,
        drive.delay.value() * 1e3,
        args.seed,
    )
}

/// Run the program until there are enough holes.
fn way(
    args: &CompareOptions,
    case: &Case,
    program: &Program,
    drive: sim::PlainDrive,
    progress: &mut dyn FnMut(),
) -> Result<TappingMethod, Refused> {
    let mut way = TappingMethod {
        name: case.name.to_owned(),
        depth_errors_mm: Vec::new(),
        failed: 0,
        why_failed: None,
        not_cut: 0,
        why_not: None,
    };
    let wanted = args.samples as usize;
    for run in 0..MOST_RUNS {
        if way.depth_errors_mm.len() + way.not_cut >= wanted {
            break;
        }
        let (threads, alarm) = run_once(args, case, program, drive, args.seed + run)?;
        if threads.is_empty() {
            return Err(Refused::because(
                "the program taps no hole: there is nothing to compare".to_owned(),
            ));
        }
        for feature in &threads {
            let FeatureKind::Thread(thread) = &feature.kind else { continue };
            if way.depth_errors_mm.len() + way.not_cut >= wanted {
                break;
            }
            let number = way.depth_errors_mm.len() + way.not_cut + 1;
            let reason = || {
                let reason = feature.verdict.reason().unwrap_or("not cut");
                format!("hole {number} of seed {}: {reason}", args.seed + run)
            };
            if is_cut(feature, thread) {
                way.depth_errors_mm.push(thread.depth_error.value());
                if !feature.verdict.is_pass() {
                    way.failed += 1;
                    way.why_failed = way.why_failed.take().or_else(|| Some(reason()));
                }
            } else {
                way.not_cut += 1;
                let alarm = || alarm.as_ref().map_or_else(String::new, |text| format!("; {text}"));
                way.why_not = way.why_not.take().or_else(|| Some(reason() + &alarm()));
            }
            progress();
        }
    }
    Ok(way)
}

/// There is a thread whose depth means something: the tap was in the material, and came out of it
/// whole.
fn is_cut(feature: &Feature, thread: &verify::Thread) -> bool {
    feature.contact.is_cut() && thread.is_gauged()
}

/// One run of the program: its threads, and the alarm that ended it if one did.
fn run_once(
    args: &CompareOptions,
    case: &Case,
    program: &Program,
    drive: sim::PlainDrive,
    seed: u64,
) -> Result<(Vec<Feature>, Option<String>), Refused> {
    let mut job = program.clone().on(args.source.clone())?;
    let session = &mut job.session;
    if let Some(size) = args.size.as_deref().or(args.program.is_none().then_some("M6")) {
        session.tools.insert(tap_of(size, args, &drive)?);
    }
    session.tools = held(&session.tools, case.holder(args, &drive));
    let told = PlainDrive { delay: drive.delay, accel: drive.accel };
    session.taps = Unsynchronised { method: case.method, drive: Some(told), ..session.taps };
    for spindle in &mut session.machine.spindles {
        spindle.windows.at_speed_share = AT_SPEED;
    }
    job.plan = job.session.plan_options(job.material);
    let machine = sim::SimulatedMachine::new(job.simulator(seed))
        .map_err(|problems| {
            Refused::because(format!("the machine cannot be simulated: {}", problems.join("; ")))
        })?
        .with_plain_drive(drive);
    let judge = verify::Config { synchronised: false, ..job.judge() };
    // the drive of the conventional cycle stops as it may, and nothing in this cycle asks it to do
    // otherwise
    let mut control = config::control(&job.session.machine, None, false);
    for spindle in control.spindles.iter_mut().flatten() {
        spindle.follows_orders = false;
    }
    let mut run = job.start(simulated::drives(machine, 0), judge)?;
    run.executor.kernel = Kernel::new(control).into();
    let outcome = run.run(&mut |_| {})?;
    let alarm = outcome.faults.first().map(ToString::to_string);
    let is_thread = |f: &Feature| matches!(f.kind, FeatureKind::Thread(_));
    Ok((outcome.features.into_iter().filter(is_thread).collect(), alarm))
}

/// The same tools, with every tap in this holder.
fn held(tools: &ToolLibrary, holder: Holder) -> ToolLibrary {
    ToolLibrary::new(tools.iter().cloned().map(|mut tool| {
        if let ToolKind::Tap(tap) = &mut tool.kind {
            tap.holder = holder;
        }
        tool
    }))
}

/// Number of the tap made for a size: no table has it.
const TAP: u32 = 9001;

fn thread_of(size: &str) -> Result<ThreadSize, Refused> {
    size.parse().map_err(|why: UnknownSize| Refused::because(format!("--size: {why}")))
}

/// Its flutes are as long as the conventional cycle needs them: it overruns.
fn tap_of(size: &str, args: &CompareOptions, drive: &sim::PlainDrive) -> Result<Tool, Refused> {
    let thread = thread_of(size)?;
    let mut tap = store::tools::usual_tap(&thread);
    let overrun = closed_form::overrun(&thread, Spin::rpm(args.speed), drive) * (1.0 + SCATTERED);
    tap.thread_length = tap.thread_length.max(depth(args, &thread) + overrun);
    Ok(Tool {
        number: TAP,
        pocket: TAP,
        length: Length::mm(150.0),
        diameter: thread.nominal,
        kind: ToolKind::Tap(tap),
        description: format!("{size} for the comparison"),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    })
}

/// Depth of the holes: as asked, or 1.5 diameters and the splines' length.
fn depth(args: &CompareOptions, thread: &ThreadSize) -> Length {
    args.depth.map_or_else(|| Length::mm(5.0) + thread.nominal * 1.5, Length::mm)
}

/// Holes on a grid in the middle of the stock.
fn program_for(
    size: &str,
    args: &CompareOptions,
    drive: &sim::PlainDrive,
) -> Result<Vec<u8>, Refused> {
    let thread = thread_of(size)?;
    let depth = depth(args, &thread).value();
    let spin = Spin::rpm(args.speed);
    let overrun = closed_form::overrun(&thread, spin, drive).value() * (1.0 + SCATTERED);
    if depth + overrun > DEEPEST.value() {
        let (stock, works) = (DEEPEST.value(), (DEEPEST.value() - overrun).floor());
        let speed = args.speed;
        let remedy = if works > 5.0 {
            format!("--depth {works} works, or a shorter stopping time")
        } else {
            "a shorter stopping time or a lower --speed works".to_owned()
        };
        return Err(Refused::because(format!(
            "the conventional cycle overruns by up to {overrun:.1} mm at S{speed}: a hole of {depth} mm and that are more than \
             the {stock} mm of the work: {remedy}"
        )));
    }
    // at the R plane the tap must be out of its thread, as far as its holder has been pulled out
    let clear = CLEARANCE.max(closed_form::pulled_out(&thread, spin, drive) * (1.0 + SCATTERED));
    let clear = clear.value().ceil();
    let flutes = store::tools::usual_tap(&thread).thread_length;
    let deepest = flutes.min(DEEPEST).value();
    if !(depth > 5.0 && depth <= deepest) {
        return Err(Refused::because(format!(
            "--depth {depth}: expected more than the 5 mm of the splines, and {deepest} mm at most, where flutes or work \
             end"
        )));
    }
    let cycle = if thread.hand == Hand::Left { ("G74", "M4") } else { ("G84", "M3") };
    let feed = thread.pitch.value() * args.speed;
    let (code, turn) = cycle;
    let mut text = format!(
        "G21 G17 G40 G49 G80 G90 G94 G54\nT{TAP} M6\nG43 H{TAP}\nS{} {turn}\nG0 X-180 Y-130 Z{}\n",
        args.speed,
        clear + 5.0
    );
    let holes = HOLES_A_RUN.min(args.samples as usize);
    for hole in 0..holes {
        let (x, y) = (hole % 19, hole / 19);
        let words = if hole == 0 {
            format!("G98 {code} Z-{depth} R{clear} F{feed} ")
        } else {
            String::new()
        };
        text += &format!("{words}X{} Y{}\n", x as f64 * 20.0 - 180.0, y as f64 * 20.0 - 130.0);
    }
    text += "G80\nM2\n";
    Ok(text.into_bytes())
}
