//! What each way of compensating a cam's phase error leaves of the contour error.
//!
//! ```text
//!   each cam, each speed:   measure in idle turns ─► phase error ─┬─► address ─┐
//!                                  │                              ├─► shift    ├─► idle turns ─► judge ─► contour error
//!                                  └─► gain and phase ────────────┴─► harmonics, learnt ─┘
//! ```
//!
//! Every processor of the computer runs rows. Every cell is a run of its own on a machine that has
//! just been switched on, by a program of the neutral codes; the last whole turn is judged by where
//! work and wheel really were.
use crate::Program;
use control::Outcome;
use control::Refused;
use control::drives::simulated;
use control::job::options::{Compensation, DecimalPoint, Estimator, ProgramOptions};
use report::{CompensationPage, CompensationRow, WayOfCompensation};
use std::num::NonZero;
use std::path::PathBuf;
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
    options: &'a CompensationOptions,
    number: u32,
    top: f64,
    rpm: f64,
}

/// What is compared.
#[derive(Debug, Clone)]
pub struct CompensationOptions {
    /// The cam library (TOML).
    pub library: PathBuf,
    /// The machine: an embedded name, or a file.
    pub machine: String,
    /// Speeds of the work, rev/min.
    pub speeds: Vec<f64>,
    /// Numbers of the cams; none is all of the library.
    pub cams: Vec<u32>,
    /// Revolutions that are learnt from.
    pub learn: u32,
    /// With X's feed-forward; without it the lag of its loop shows.
    pub feed_forward: bool,
    /// How the work turns; `None` is as the cam library says.
    pub work_speed: Option<store::cams::WorkSpeed>,
}

/// What is told of a comparison under way.
#[derive(Debug, Clone, Copy)]
pub enum Progress<'a> {
    /// So many runs are to come.
    Runs(u64),
    /// This cam and speed are looked at.
    Row(&'a str),
    /// A run is done.
    Run,
}

/// Who hears of it.
pub type Hear<'a> = &'a (dyn Fn(Progress<'_>) + Sync);

/// Grind each cam at each speed, compensated in each way, and judge the contour that comes.
///
/// # Errors
/// A speed is not above 0, the library has no such cam, or a run is refused or ends in an alarm.
pub fn compensation(
    options: &CompensationOptions,
    hear: Hear<'_>,
) -> Result<CompensationPage, Refused> {
    if let Some(speed) = options.speeds.iter().find(|s| !(s.is_finite() && **s > 0.0)) {
        return Err(Refused::because(format!("--speeds {speed}: expected speeds above 0")));
    }
    let source = program(options, Compensation::Off, Estimator::LeastSquares);
    let session = Program::of("-", "").on(source)?.session;
    let known = |number: &u32| session.cams.library.get(*number).is_none();
    if let Some(number) = options.cams.iter().find(|number| known(number)) {
        let path = options.library.display();
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
        .filter(|c| options.cams.is_empty() || options.cams.contains(&c.number));
    let cases: Vec<Case> = asked
        .flat_map(|cam| {
            let (number, top) = (cam.number, cam.top().value());
            options.speeds.iter().map(move |rpm| Case { options, number, top, rpm: *rpm })
        })
        .collect();
    hear(Progress::Runs((cases.len() * (1 + WAYS.len())) as u64));
    let mut cost = Duration::ZERO;
    for row in rows(&cases, hear) {
        let (row, took) = row?;
        cost = cost.max(took);
        page.rows.push(row);
    }
    page.notes = notes(options, cost);
    Ok(page)
}

/// Every row, in the order of the cases: they know nothing of one another, so each processor takes
/// the next one that is left.
fn rows(cases: &[Case], hear: Hear<'_>) -> Vec<Result<Row, Refused>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(index) else { return done };
            done.push((index, case.row(hear)));
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

fn notes(options: &CompensationOptions, cost: Duration) -> Vec<String> {
    vec![
        "contour error: the largest distance along X of the wheel's edge from the profile, in the last whole turn in the air, by where work and wheel really were".to_owned(),
        format!(
            "measuring takes {MEASURED} turns; each of the {} turns that are learnt from takes 2.25: one that is measured, a quarter in which one table fades into the next, one to settle; looking at a turn takes {:.1} ms of computing here",
            options.learn,
            cost.as_secs_f64() * 1e3
        ),
    ]
}

/// What a session is told for one cell.
fn program(
    options: &CompensationOptions,
    method: Compensation,
    estimator: Estimator,
) -> ProgramOptions {
    ProgramOptions {
        dialect: Some(interp::Dialect::LinuxCnc),
        decimal_point: Some(DecimalPoint::Calculator),
        cams: Some(options.library.clone()),
        compensation: method,
        estimator,
        work_speed: options.work_speed,
        without_feed_forward: !options.feed_forward,
        ..ProgramOptions::on(&options.machine)
    }
}

impl Case<'_> {
    /// The row; the listener counts its runs.
    fn row(&self, hear: Hear<'_>) -> Result<Row, Refused> {
        let off = self.run(Compensation::Off, Estimator::LeastSquares, None)?;
        hear(Progress::Row(&format!("P{} at {} rpm", self.number, self.rpm)));
        hear(Progress::Run);
        let phases = off.cams.phases().clone();
        let measured = phases.measured.first().cloned().unwrap_or_default();
        let first = self.judged(&off)?;
        let (name, removal_peak) = (first.name.clone(), first.removal_peak);
        let mut ways = vec![way(first)];
        let mut cost = Duration::ZERO;
        for (_, method, estimator) in WAYS {
            let outcome = self.run(method, estimator, Some(&phases))?;
            hear(Progress::Run);
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
                let learn = self.options.learn;
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
        let name = format!("the program for P{} at {} rpm", self.number, self.rpm);
        let source = program(self.options, method, estimator);
        let mut job = Program::of(name, self.text(method)).on(source)?;
        if let Some(phases) = phases {
            job.session.cams.phases = phases.clone();
        }
        let machine = job.machine(u64::from(job.session.machine.simulation.seed))?;
        let judge = job.judge();
        let idle = verify::IdleTurns::new(judge.clone());
        let mut run = job.start(simulated::drives(machine, 0), judge)?;
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
