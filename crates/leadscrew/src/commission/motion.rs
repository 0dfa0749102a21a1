//! Motion for measuring: a program that is run by the control itself on the simulated machine, and
//! what drives and encoders said meanwhile.
//!
//! ```text
//!   file as it is ──► careful file: 30 % of the torque, planned_acceleration ramps, the window as travel
//!                         │
//!   program ──────────────┴─► Run (planner, kernel, executor) ⇄ plant     Signals: as said
//! ```
//!
//! Nothing is led beside the control: there is one servo loop. The careful file is what keeps the
//! motion harmless: the kernel gives no more than its peak torque, and no axis leaves its travel.
//! What the plant really is never crosses this file's edge: [`Signals`] has what drives say.
use crate::{Machine, Program, Run, RunOptions};
use bus::Sample;
use control::Refused;
use control::config::machine_file::MachineSource;
use control::job::ProgramOptions;
use control::observers::Observer;
use kernel::Event;
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, PoisonError};
use store::machine::{MachineFile, Motor};

/// Share of a drive's peak that is never exceeded while a machine is commissioned.
pub const MOST_TORQUE_SHARE: f64 = 0.3;
/// Share of the peak that planned acceleration may take.
const PLANNED_SHARE: f64 = 0.15;
/// An axis farther than this from its setpoint ends the step, µm.
const FARTHEST_UM: f64 = 1000.0;
/// Room that is kept at either end of the travel, as a share of it.
const MARGIN: f64 = 0.05;
/// Share of the travel within which an axis is moved, from the end where it stands.
const WINDOW: f64 = 0.5;

/// The machine as it is taken to be, and as it is.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The machine's file, believed.
    pub machine: Machine,
    /// The machine that is simulated; `None`: that of the file.
    pub plant: Option<MachineSource>,
    /// Factor on all that varies about the plant's file.
    pub scatter: f64,
    /// Seed of what varies.
    pub seed: u64,
}

/// Where an axis may be moved, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// From here …
    pub from: f64,
    /// … to here.
    pub to: f64,
}

impl Window {
    /// The part of it in which strokes begin and end.
    pub(crate) fn inner(self) -> Self {
        let margin = (self.to - self.from) * MARGIN;
        Self { from: self.from + margin, to: self.to - margin }
    }
}

/// What drives said while a program ran, at each period.
#[derive(Clone, Debug, Default)]
pub(crate) struct Signals {
    /// Servo period, s.
    pub(crate) period_s: f64,
    /// Program line of each period.
    pub(crate) line: Vec<u32>,
    /// By bus index: position by the encoder, mm, and by that of the motor where there is one of
    /// its own.
    pub(crate) axes: Vec<AxisSignals>,
    /// Of the first spindle.
    pub(crate) spindle: SpindleSignals,
    /// Alarms that ended it.
    pub(crate) alarms: Vec<String>,
}

/// Of one axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisSignals {
    pub(crate) index: usize,
    pub(crate) position_mm: Vec<f64>,
    pub(crate) motor_mm: Vec<f64>,
    pub(crate) setpoint_mm: Vec<f64>,
    pub(crate) force_n: Vec<f64>,
    /// Force that the control asked for.
    pub(crate) asked_n: Vec<f64>,
}

/// Of the first spindle.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpindleSignals {
    pub(crate) angle_rev: Vec<f64>,
    pub(crate) torque_n_m: Vec<f64>,
    /// Torque that the control asked for.
    pub(crate) asked_n_m: Vec<f64>,
    /// Commanded speed, rev/s.
    pub(crate) commanded: Vec<f64>,
}

/// Where everything is written while a program runs.
struct Listener {
    to: Arc<Mutex<Signals>>,
}

impl Observer for Listener {
    fn sample(&mut self, sample: &Sample) {
        let mut signals = self.to.lock().unwrap_or_else(PoisonError::into_inner);
        signals.line.push(sample.report.line);
        for axis in &mut signals.axes {
            let said = &sample.feedback.axes[axis.index];
            axis.position_mm.push(said.position.value());
            axis.motor_mm.extend(said.motor.map(units::Coordinate::value));
            axis.force_n.extend(said.force.map(units::Force::value));
            let asked = &sample.command.axes[axis.index];
            axis.setpoint_mm.push(asked.position.value());
            axis.asked_n.push(asked.force.value());
        }
        let said = &sample.feedback.spindles[0];
        signals.spindle.angle_rev.push(said.angle.value());
        signals.spindle.torque_n_m.extend(said.torque.map(units::Torque::value));
        let asked = &sample.command.spindles[0];
        signals.spindle.commanded.push(asked.spin.value());
        signals.spindle.asked_n_m.push(asked.torque.value());
    }

    fn event(&mut self, _event: &Event) {}
}

impl Bench {
    /// The plant, with its scatter.
    pub(crate) fn plant(&self) -> Result<MachineSource, Refused> {
        let source = self.plant.clone().unwrap_or_else(|| self.machine.source().clone());
        if self.scatter == 1.0 {
            return Ok(source);
        }
        let plant = Machine::load(&source)?;
        let mut changes = Vec::new();
        for what in ["backlash", "stiffness", "friction"] {
            if let Some(Value::Object(mut spread)) = plant.value(&format!("scatter.{what}")) {
                let percent = spread.get("percent").and_then(Value::as_f64).unwrap_or(0.0);
                spread.insert("percent".into(), json!((percent * self.scatter).min(80.0)));
                changes.push((format!("scatter.{what}"), Value::Object(spread)));
            }
        }
        Ok(plant.with(&changes)?.source().clone())
    }

    /// Window of an axis: a good half of its travel, from the end at which it stands when it is
    /// homed.
    pub fn window(&self, index: usize) -> Option<Window> {
        let axis = self.machine.file().axes.get(index)?.as_ref()?;
        let (from, to) = (axis.travel.from.value(), axis.travel.to.value());
        let (length, stands) = (to - from, control::config::start(axis).value());
        let far = (MARGIN + WINDOW) * length;
        Some(if (stands - to).abs() < (stands - from).abs() {
            Window { from: to - far, to }
        } else {
            Window { from, to: from + far }
        })
    }

    /// The file with which the control leads the machine while it is measured.
    pub(crate) fn careful(&self) -> Result<Machine, Refused> {
        let file = self.machine.file();
        let mut changes = Vec::new();
        for (index, axis) in file.axes.iter().enumerate() {
            let Some(axis) = axis else { continue };
            if axis.letter.kind() == units::AxisKind::Rotary {
                continue;
            }
            let key =
                |what: &str| format!("axes.{}.{what}", axis.letter.letter().to_ascii_lowercase());
            let share = MOST_TORQUE_SHARE;
            let continuous = axis.drive.continuous_force.map(units::Force::value);
            match axis.drive.motor {
                Motor::BallScrew { peak_torque, lead, .. } => {
                    changes
                        .push((key("drive.peak_torque_n_m"), json!(peak_torque.value() * share)));
                    let per_n = lead.value() * 1e-3 / std::f64::consts::TAU;
                    changes.extend(continuous.map(|force| {
                        let most = (force * per_n).min(peak_torque.value() * share);
                        (key("drive.continuous_torque_n_m"), json!(most))
                    }));
                }
                Motor::Linear { peak_force, .. } => {
                    changes.push((key("drive.peak_force_n"), json!(peak_force.value() * share)));
                    changes.extend(continuous.map(|force| {
                        let most = force.min(peak_force.value() * share);
                        (key("drive.continuous_force_n"), json!(most))
                    }));
                }
            }
            let planned_acceleration = self.planned_acceleration(index);
            changes.push((key("acceleration_m_per_s2"), json!(planned_acceleration)));
            let stop = axis.windows.following_error_stop.value() * 1e3;
            changes.push((key("windows.following_error_stop_um"), json!(stop.min(FARTHEST_UM))));
            let warn = axis.windows.following_error_warn.value() * 1e3;
            changes.push((key("windows.following_error_warn_um"), json!(warn.min(FARTHEST_UM))));
        }
        for (index, spindle) in file.spindles.iter().enumerate() {
            let peak = spindle.peak_torque.value() * MOST_TORQUE_SHARE;
            let continuous = spindle.continuous_torque.value().min(peak);
            changes.push((format!("spindles.{index}.peak_torque_n_m"), json!(peak)));
            changes.push((format!("spindles.{index}.continuous_torque_n_m"), json!(continuous)));
        }
        self.machine.with(&changes)
    }

    /// Acceleration at which an axis is moved while it is measured, m/s².
    pub(crate) fn planned_acceleration(&self, index: usize) -> f64 {
        let Some(Some(axis)) = self.machine.file().axes.get(index) else { return 1.0 };
        let mass = axis.moving_mass.value() + axis.drive.motor_mass().value();
        let planned = PLANNED_SHARE * axis.drive.peak_force().value() / mass;
        planned.min(axis.acceleration.value() * 1e-3)
    }

    /// Runs a program of LinuxCNC's dialect with this file, and hears what the drives say.
    pub(crate) fn run(&self, with: &Machine, name: &str, text: &str) -> Result<Signals, Refused> {
        let options = ProgramOptions {
            plant: Some(self.plant()?),
            dialect: Some(interp::Dialect::LinuxCnc),
            ..ProgramOptions::on(with.source())
        };
        let job = Program::of(name, text).on(options)?;
        let asked = RunOptions { seed: Some(self.seed), ..RunOptions::default() };
        let mut run = Run::prepare(job, &asked)?;
        let to = Arc::new(Mutex::new(Signals::of(with.file())));
        run.observers.push(Box::new(Listener { to: Arc::clone(&to) }));
        run.prove(&mut |_| ())?;
        let finished = run.execute(&mut |_| ())?;
        let faults = finished.outcome.faults.iter().map(ToString::to_string);
        let alarms = faults.chain(finished.outcome.broke_off.clone()).collect();
        drop(finished);
        let mut signals = to.lock().unwrap_or_else(PoisonError::into_inner);
        signals.alarms = alarms;
        Ok(std::mem::take(&mut *signals))
    }
}

impl Signals {
    fn of(file: &MachineFile) -> Self {
        let axes = file.axes.iter().enumerate().filter(|(_, axis)| axis.is_some());
        let axes = axes.map(|(index, _)| AxisSignals { index, ..AxisSignals::default() });
        Self { period_s: file.control.period.value(), axes: axes.collect(), ..Self::default() }
    }

    /// Of the axis of this bus index.
    pub(crate) fn axis(&self, index: usize) -> Option<&AxisSignals> {
        self.axes.iter().find(|axis| axis.index == index)
    }
}
