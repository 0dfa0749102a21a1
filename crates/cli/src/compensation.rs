//! `leadscrew compensation`: what each way of compensating a cam's phase error leaves of the contour error.
//!
//! ```text
//!   each cam, each speed:   measure in idle turns ─► phase error ─┬─► address ─┐
//!                                  │                              ├─► shift    ├─► idle turns ─► judge ─► contour error
//!                                  └─► gain and phase ────────────┴─► harmonics, learnt ─┘
//! ```
//!
//! Every processor of the computer runs rows. Every cell is a run of its own on a machine that has just been switched on, by a program of the neutral codes; the last
//! whole turn is judged by where work and wheel really were.
use crate::args::{CompensationArgs, CompensationOutput, Switch};
use crate::progress::Progress;
use crate::{say, tables};
use control::Refused;
use control::config;
use control::job::Session;
use control::job::options::{Compensation, DecimalPoint, Estimator, ProgramOptions};
use control::job::preflight::preflight;
use control::plant::{self, Plant};
use control::{Loaded, Outcome, ProgramRun};
use indicatif::ProgressBar;
use report::{CompensationPage, CompensationRow, WayOfCompensation};
use serde_json::json;
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;
use store::phases::{Measured, Phases};
use verify::GroundCam;

/// Idle turns that are measured.
const MEASURED: u32 = 2;
/// Idle turns before one is judged: the last of them.
const JUDGED: u32 = 3;
/// How far the wheel stands clear of a profile's top, mm.
const CLEAR: f64 = 1.0;

/// The ways beside none at all, in the order of the table.
const WAYS: [(&str, Compensation, Estimator); 6] = [
    ("address, by the maximum", Compensation::Address, Estimator::Maximum),
    ("address, by the flanks", Compensation::Address, Estimator::Flanks),
    ("fractional shift", Compensation::Shift, Estimator::LeastSquares),
    ("harmonics", Compensation::Harmonics, Estimator::LeastSquares),
    ("after learning", Compensation::Learn, Estimator::LeastSquares),
    ("wrong sign", Compensation::Wrong, Estimator::LeastSquares),
];

/// A row, and what looking at a turn cost in it.
type Row = (CompensationRow, Duration);

/// One row: a cam at a speed.
struct Case<'a> {
    args: &'a CompensationArgs,
    number: u32,
    top: f64,
    rpm: f64,
}

/// Do it.
pub(crate) fn command(args: &CompensationArgs, quiet: bool) -> Result<(), Refused> {
    if let Some(speed) = args.speeds.iter().find(|s| !(s.is_finite() && **s > 0.0)) {
        return Err(Refused::because(format!("--speeds {speed}: expected speeds above 0")));
    }
    let program = program(args, Compensation::Off, Estimator::LeastSquares);
    let session = Session::load(&program, Path::new("-"), b"")?;
    let known = |number: &u32| session.cams.library.get(*number).is_none();
    if let Some(number) = args.cams.iter().find(|number| known(number)) {
        let path = args.library.display();
        return Err(Refused::because(format!("--cams {number}: {path} has no cam of this number")));
    }
    let mut page = CompensationPage {
        title: format!("Compensation of cams on {}", session.machine.name),
        ways: std::iter::once("uncompensated")
            .chain(WAYS.iter().map(|w| w.0))
            .map(str::to_owned)
            .collect(),
        rows: Vec::new(),
        notes: Vec::new(),
    };
    let asked = session
        .cams
        .library
        .iter()
        .filter(|c| args.cams.is_empty() || args.cams.contains(&c.number));
    let cases: Vec<Case> = asked
        .flat_map(|cam| {
            let top = cam.top().value();
            args.speeds.iter().map(move |rpm| Case { args, number: cam.number, top, rpm: *rpm })
        })
        .collect();
    let mut cost = Duration::ZERO;
    let progress =
        Progress::new((cases.len() * (1 + WAYS.len())) as u64, "turning cams (simulated)");
    let found = rows(&cases, &progress);
    drop(progress);
    for row in found {
        let (row, took) = row?;
        cost = cost.max(took);
        page.rows.push(row);
    }
    page.notes = notes(args, cost);
    if let Some(out) = &args.out {
        store::output::write_file(out, report::compensation_html(&page).as_bytes())?;
    }
    say::out(&match args.format {
        CompensationOutput::Text if quiet => String::new(),
        CompensationOutput::Text => text(&page),
        CompensationOutput::Json => format!("{}\n", as_json(&page)),
    })
}

/// Every row, in the order of the cases: they know nothing of one another, so each processor takes the next one that is left.
fn rows(cases: &[Case], bar: &ProgressBar) -> Vec<Result<Row, Refused>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(index) else { return done };
            done.push((index, case.row(bar)));
        }
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(cases.len());
    let mut rows: Vec<_> = thread::scope(|scope| {
        let others: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        let mut rows = work();
        for other in others {
            match other.join() {
                Ok(done) => rows.extend(done),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        rows
    });
    rows.sort_by_key(|(index, _)| *index);
    rows.into_iter().map(|(_, row)| row).collect()
}

fn notes(args: &CompensationArgs, cost: Duration) -> Vec<String> {
    vec![
        "contour error: the largest distance along X of the wheel's edge from the profile, in the last whole turn in the air, by where work and wheel really were".to_owned(),
        format!(
            "measuring takes {MEASURED} turns; each of the {} turns that are learnt from takes 2.25: one that is measured, a quarter in which one table fades into the next, one to settle; looking at a turn takes {:.1} ms of computing here",
            args.learn,
            cost.as_secs_f64() * 1e3
        ),
    ]
}

/// What a session is told for one cell.
fn program(args: &CompensationArgs, method: Compensation, estimator: Estimator) -> ProgramOptions {
    ProgramOptions {
        dialect: Some(interp::Dialect::LinuxCnc),
        decimal_point: Some(DecimalPoint::Calculator),
        cams: Some(args.library.clone()),
        compensation: method,
        estimator,
        work_speed: args.work_speed.map(Into::into),
        without_feed_forward: args.feed_forward == Switch::Off,
        ..ProgramOptions::on(&args.machine)
    }
}

impl Case<'_> {
    /// The row; the bar counts its runs.
    fn row(&self, bar: &ProgressBar) -> Result<Row, Refused> {
        let off = self.run(Compensation::Off, Estimator::LeastSquares, None)?;
        bar.set_message(format!("P{} at {} rpm", self.number, self.rpm));
        bar.inc(1);
        let phases = off.cams.phases().clone();
        let measured = phases.measured.first().cloned().unwrap_or_default();
        let first = self.judged(&off)?;
        let (name, removal_peak) = (first.name.clone(), first.removal_peak);
        let mut ways = vec![way(first)];
        let mut cost = Duration::ZERO;
        for (_, method, estimator) in WAYS {
            let outcome = self.run(method, estimator, Some(&phases))?;
            bar.inc(1);
            cost = cost.max(outcome.cams.cost().unwrap_or_default());
            ways.push(way(self.judged(&outcome)?));
        }
        let Measured { phase_error_deg, by_flanks_deg, by_maximum_deg, .. } = measured;
        let shifts_deg = [phase_error_deg, by_flanks_deg, by_maximum_deg];
        Ok((
            CompensationRow {
                profile: self.number,
                name,
                rpm: self.rpm,
                shifts_deg,
                removal_peak,
                ways,
            },
            cost,
        ))
    }

    /// The last idle turn.
    fn judged<'o>(&self, outcome: &'o Outcome) -> Result<&'o GroundCam, Refused> {
        let turned = outcome.idle.last().filter(|cam| !cam.errors.is_empty());
        turned.ok_or_else(|| {
            Refused::because(format!(
                "P{} at {} rpm: no whole turn was seen",
                self.number, self.rpm
            ))
        })
    }

    /// The blocks of one cell.
    fn text(&self, method: Compensation) -> String {
        let (number, rpm) = (self.number, self.rpm);
        let turns = match method {
            Compensation::Off => {
                format!("G152\nG153\nG154 S{rpm} P{MEASURED}\nG155\nG152\n")
            }
            Compensation::Learn => {
                let learn = self.args.learn;
                format!("G150\nG152\nG153\nG154 S{rpm} P{learn}\nG155\nG152\n")
            }
            _ => "G150\n".to_owned(),
        };
        let clear = self.top + CLEAR;
        format!(
            "G21 G90 G54\nG0 X{clear:.3}\nG151 P{number}\n{turns}G154 S{rpm} P{JUDGED}\nG151 P0\nM2\n"
        )
    }

    fn run(
        &self,
        method: Compensation,
        estimator: Estimator,
        phases: Option<&Phases>,
    ) -> Result<Outcome, Refused> {
        let text = self.text(method);
        let text = text.as_bytes();
        let program = program(self.args, method, estimator);
        let mut session = Session::load(&program, Path::new("-"), text)?;
        if let Some(phases) = phases {
            session.cams.phases = phases.clone();
        }
        let material = session.machine.setup.stock.material;
        let options = session.plan_options(material);
        let known = preflight(&mut session, text, options);
        if known.is_refused() {
            let name = format!("the program for P{} at {} rpm", self.number, self.rpm);
            return Err(Refused::program(name, text.to_vec(), session.drawn, known.findings));
        }
        let setup = session.interp_setup();
        let zero = session.work_zero();
        let seed = u64::from(session.machine.simulation.seed);
        let iron = config::simulator(&session.machine, &session.tools, material, seed, &zero);
        let iron = plant::simulated(&session.machine, iron)?;
        let judge = verify::Config {
            cams: session.cams.library.clone(),
            ..config::judge(&session.machine, &session.tools, material, &zero)
        };
        let planned = known.planned;
        let loaded = Loaded { session: &session, text, setup: &setup, options, planned };
        let idle = verify::IdleTurns::new(judge.clone());
        let mut run = ProgramRun::new(&loaded, Plant::simulated(iron), judge);
        run.observers.idle = Some(idle);
        run.run_without_alarm().map_err(|e| {
            Refused::because(format!("P{} at {} rpm: {}", self.number, self.rpm, e.sentence()))
        })
    }
}

fn way(cam: &GroundCam) -> WayOfCompensation {
    WayOfCompensation {
        contour_um: cam.contour_error_max.in_um(),
        rms_um: cam.contour_error_rms.in_um(),
        errors_um: cam.errors.iter().map(|e| e.in_um()).collect(),
    }
}

/// Two tables: a screen has no room for phase errors and what the ways leave beside one another.
fn text(page: &CompensationPage) -> String {
    let named = |row: &CompensationRow| vec![row.name.clone(), row.rpm.to_string()];
    let rows: Vec<_> = page
        .rows
        .iter()
        .map(|row| {
            let shifts = row.shifts_deg.iter().map(|deg| format!("{deg:.4}"));
            named(row).into_iter().chain(shifts).collect()
        })
        .collect();
    let heads = ["cam", "rpm", "least squares", "by the flanks", "by the maximum"];
    let phases = tables::figures(&heads, &rows);
    let rows: Vec<_> = page
        .rows
        .iter()
        .map(|row| {
            let errors = row.ways.iter().map(|way| report::um_figure(way.contour_um));
            named(row).into_iter().chain(errors).collect()
        })
        .collect();
    let heads = ["cam", "rpm"].map(str::to_owned).into_iter();
    // a word a line: the columns are as narrow as their figures
    let heads: Vec<_> = heads.chain(page.ways.iter().map(|way| way.replace(' ', "\n"))).collect();
    let errors = tables::figures(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
    let notes = page.notes.join("\n");
    format!("phase error, °\n{phases}\n\ncontour error, µm\n{errors}\n{notes}\n")
}

fn as_json(page: &CompensationPage) -> serde_json::Value {
    let rows = page.rows.iter().map(|row| {
        let ways = row.ways.iter().zip(&page.ways).map(|(way, name)| {
            json!({ "way": name, "contour_error_max_um": way.contour_um, "contour_error_rms_um": way.rms_um })
        });
        json!({
            "profile": row.profile,
            "name": row.name,
            "rpm": row.rpm,
            "phase_error_deg": row.shifts_deg[0],
            "by_flanks_deg": row.shifts_deg[1],
            "by_maximum_deg": row.shifts_deg[2],
            "removal_rate_peak": row.removal_peak,
            "ways": ways.collect::<Vec<_>>(),
        })
    });
    json!({ "title": page.title, "rows": rows.collect::<Vec<_>>() })
}
