//! Cams of a session: the library that is read, the table of phase errors, and what is sent of each
//! profile.
//!
//! ```text
//!   cams.toml, lift.csv ─► forms::cam ─► profile D(θ) ─► course: D(φ + lead(φ)) where the work speed varies
//!                                                          │
//!   phase table ─► sync: address, shift, harmonics, learnt ┴─► planner (after G50), in steps of the table's pulse
//! ```
mod library;

use crate::Refused;
use crate::config;
use crate::job::options::{Compensation, Estimator, ProgramOptions};
use canon::{Axis, CamLibrary, CamOrder, CamProfile, OpKind};
use forms::cam::AxisBounds;
use library::Made;
pub use library::{of_kind, table};
use plan::{CamCommand, Cams, Course, WheelWear};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use store::cams::WorkSpeed;
use store::machine::{Grinding, MachineFile};
use store::phases::{Measured, Phases, form_mark};
use sync::{DriveLoops, Repetition, RepetitionOptions, Response, ShiftOverSpeed, Spectrum};
use units::{Angle, Length, Spin, SpinAccel};

/// Library looked for beside a program.
const BESIDE: &str = "cams.toml";
/// Share of the velocity loop's bandwidth up to which the axis is taught.
const TAUGHT_SHARE: f64 = 0.9;
/// Share of the work spindle's torque that a varying speed may use.
const TORQUE_SHARE: f64 = 0.5;
/// Share of the work spindle's velocity bandwidth up to which its speed varies.
const SWING_SHARE: f64 = 0.25;

/// A blank that a program grinds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clamped {
    profile: u32,
    phase: Angle,
    stock: Length,
    /// Along the work, in the frame of the program.
    z: Length,
}

/// Everything that is known of cams before a program begins.
#[derive(Clone, Debug)]
pub struct CamSetup {
    /// The profiles.
    pub library: CamLibrary,
    /// What was measured.
    pub phases: Phases,
    path: Option<PathBuf>,
    /// How what is sent is compensated.
    pub method: Compensation,
    estimator: Estimator,
    /// Profiles and speeds that the program grinds compensated.
    wanted: Vec<(u32, Spin)>,
    courses: Vec<Course>,
    made: Vec<Made>,
    work_speed: Option<WorkSpeed>,
    grinding: Option<Grinding>,
    clamped: Vec<Clamped>,
    taught: RepetitionOptions,
    /// What X makes of a sine by its loops: where nothing was measured.
    assumed: Response,
    bounds: Option<(AxisBounds, f64)>,
    /// Half a count of C's encoder and of X's: a reading says in which count a place is, its middle
    /// is the best guess.
    pub half_counts: (Angle, Length),
}

impl CamSetup {
    /// As the options say, for a program at this path. A library that only lies beside the program
    /// counts where the machine grinds cams.
    ///
    /// # Errors
    /// A library or a record that cannot be read.
    pub fn load(
        options: &ProgramOptions,
        program: &Path,
        machine: &MachineFile,
    ) -> Result<Self, Refused> {
        let beside = || {
            let folder = program.parent().filter(|_| machine.grinding.is_some())?;
            Some(folder.join(BESIDE)).filter(|path| path.is_file())
        };
        let made = match options.cams.clone().or_else(beside) {
            None => Vec::new(),
            Some(path) => library::read(&path, machine)?,
        };
        let bandwidth = machine.axes[0].as_ref().map_or(50.0, |x| x.loops.velocity_bandwidth_hz);
        Ok(Self {
            library: CamLibrary::new(made.iter().map(|made| made.profile.clone())),
            phases: Phases::new(&machine.name, mark(machine)),
            path: options.phase_table.clone(),
            method: options.compensation,
            estimator: options.estimator,
            wanted: Vec::new(),
            courses: Vec::new(),
            made,
            work_speed: options.work_speed,
            grinding: machine.grinding,
            clamped: Vec::new(),
            taught: RepetitionOptions {
                highest_hz: TAUGHT_SHARE * bandwidth,
                floor: Length::um(0.02),
            },
            assumed: Response::default(),
            bounds: bounds(machine),
            half_counts: (
                machine
                    .spindles
                    .first()
                    .map_or(Angle::ZERO, |c| Angle::rev(0.5 / f64::from(c.encoder_counts_per_rev))),
                machine.axes[0]
                    .as_ref()
                    .map_or(Length::ZERO, |x| x.position_from.resolution().of_linear() / 2.0),
            ),
        })
    }

    /// Read what was measured on this machine before.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn recall(&mut self, machine: &MachineFile) -> Result<(), Refused> {
        let mark = mark(machine);
        let known = match &self.path {
            None => None,
            Some(path) => Phases::load(path, &machine.name, mark)?,
        };
        self.phases = known.unwrap_or_else(|| Phases::new(&machine.name, mark));
        Ok(())
    }

    /// Where nothing was measured, what the machine's loops say counts.
    pub fn assume(&mut self, machine: &MachineFile) {
        if let Some(x) = &machine.axes[0] {
            let loops = DriveLoops {
                position_gain: x.loops.position_gain_per_s,
                bandwidth_hz: x.loops.velocity_bandwidth_hz,
                speed_share: x.loops.velocity_feed_forward_share,
                accel_share: x.loops.acceleration_feed_forward_share,
            };
            self.assumed = Response::of_loops(&loops, self.taught.highest_hz * 1.01);
        }
    }

    /// Find out what the program grinds, at which speeds, and what of it compensated.
    pub fn look_ahead(&mut self, ops: &[canon::Op]) {
        let (mut profile, mut compensated) = (0, false);
        let (mut on_shaft, mut z) = ((Angle::ZERO, Length::ZERO), Length::ZERO);
        for op in ops {
            match &op.kind {
                OpKind::Rapid { to } | OpKind::Line { to, .. } => z = to.linear[2],
                OpKind::Cam(CamOrder::Select { profile: number, phase, zero, .. }) => {
                    (profile, compensated) = (*number, false);
                    on_shaft = (*phase, *zero);
                }
                OpKind::Cam(CamOrder::Compensate) => compensated = true,
                OpKind::Cam(CamOrder::Grind { stock, spin, .. }) => {
                    let (phase, zero) = on_shaft;
                    self.clamp(Clamped { profile, phase, stock: *stock, z: z - zero });
                    self.turned(profile, *spin, compensated);
                }
                OpKind::Cam(CamOrder::SparkOut { spin, .. }) => {
                    self.turned(profile, *spin, compensated);
                }
                _ => {}
            }
        }
    }

    /// The program grinds cams.
    pub fn is_wanted(&self) -> bool {
        !self.courses.is_empty() || !self.clamped.is_empty()
    }

    fn clamp(&mut self, new: Clamped) {
        match self.clamped.iter_mut().find(|c| Clamped { stock: new.stock, ..**c } == new) {
            Some(known) => known.stock = known.stock.max(new.stock),
            None => self.clamped.push(new),
        }
    }

    /// A profile is followed at a speed.
    fn turned(&mut self, profile: u32, spin: Spin, compensated: bool) {
        if compensated && !self.wanted.contains(&(profile, spin)) {
            self.wanted.push((profile, spin));
        }
        let known = self.courses.iter().any(|c| (c.profile, c.spin) == (profile, spin));
        let Some(made) = self.made.iter().find(|m| m.profile.number == profile && !known) else {
            return;
        };
        let even = self.work_speed.unwrap_or(made.work_speed) == WorkSpeed::Even;
        let swing = self.bounds.filter(|_| even).map(|(b, hz)| made.path.rhythm(spin, &b, hz));
        let (nodes, lead) = match swing {
            None => (made.profile.nodes.clone(), None),
            Some(rhythm) => (rhythm.centre, Some(rhythm.lead)),
        };
        self.courses.push(Course { profile, spin, lead, nodes });
    }

    /// Where the wheel belongs over the even turn at a speed, and by how much the work is ahead of
    /// it.
    pub fn course(&self, profile: u32, spin: Spin) -> Option<&Course> {
        self.courses.iter().find(|c| (c.profile, c.spin) == (profile, spin))
    }

    /// The program grinds cams, and the machine can.
    pub fn grinds(&self) -> bool {
        self.grinding.is_some() && !self.clamped.is_empty()
    }

    /// What is clamped on the work spindle, for the simulator; `None`: no cam is ground. The shaft
    /// has its cams where the program's frame has them, and its own zero where the set-up has the
    /// work's.
    pub fn grinding(&self, zero: &canon::Position) -> Option<sim::Grinding> {
        let Grinding { wheel, stiffness, .. } = self.grinding.filter(|_| self.grinds())?;
        let centre = zero.linear[0];
        let blank = |c: &Clamped| {
            let nodes = plan::turned(&self.library.get(c.profile)?.nodes, c.phase.value());
            let touches = nodes.iter().map(|d| centre + Length::mm(*d) + c.stock).collect();
            let half = wheel.width / 2.0;
            let z = zero.linear[2] + c.z;
            Some(sim::Blank { along: (z - half, z + half), touches })
        };
        Some(sim::Grinding {
            work: 0,
            infeed: Axis::X.index(),
            along: Axis::Z.index(),
            centre,
            wheel: sim::Wheel {
                radius: wheel.radius(),
                width: wheel.width,
                rim: wheel.rim,
                energy_j_per_mm3: wheel.energy_j_per_mm3,
                force_ratio: wheel.force_ratio,
                grinding_ratio: wheel.grinding_ratio,
            },
            stiffness,
            blanks: self.clamped.iter().filter_map(blank).collect(),
        })
    }

    /// What the planner is told now.
    pub fn for_planner(&self) -> Cams {
        let commands = self.wanted.iter().filter_map(|(profile, spin)| {
            let nodes = self.sent(self.library.get(*profile)?, *spin)?;
            Some(CamCommand { profile: *profile, spin: *spin, nodes: self.pulsed(nodes) })
        });
        let course = |c: &Course| Course { nodes: self.pulsed(c.nodes.clone()), ..c.clone() };
        Cams {
            commands: commands.collect(),
            courses: self.courses.iter().map(course).collect(),
            library: self.library.clone(),
            wear: self.grinding.map(|Grinding { wheel, .. }| WheelWear {
                radius: wheel.radius(),
                ratio: wheel.grinding_ratio,
            }),
        }
    }

    /// A table in the steps in which it can be sent. What rounding takes from a node is given to
    /// the next one, so that the rounding's error lies where the axis does not follow: a node is
    /// half a degree, friction's mark on a cam is ten.
    pub fn pulsed(&self, mut nodes: Vec<f64>) -> Vec<f64> {
        let pulse = self.grinding.map_or(0.0, |g| g.table_pulse.value());
        if pulse > 0.0 {
            let mut owed = 0.0;
            // twice around: the seam is a node like any other
            for round in 0..2 {
                let mut kept = owed;
                let sent: Vec<f64> = nodes
                    .iter()
                    .map(|x| {
                        let sent = ((x + kept) / pulse).round() * pulse;
                        kept += x - sent;
                        sent
                    })
                    .collect();
                owed = kept;
                if round == 1 {
                    nodes = sent;
                }
            }
        }
        nodes
    }

    /// What is sent of a profile at a speed with compensation on; `None`: it is not known.
    fn sent(&self, profile: &CamProfile, spin: Spin) -> Option<Vec<f64>> {
        let ideal = &self.course(profile.number, spin)?.nodes;
        let measured = self.measured(profile);
        let points = measured.iter().map(|m| (Spin::rpm(m.rpm), self.shift(m)));
        let shift = ShiftOverSpeed::new(points).at(spin);
        match self.method {
            Compensation::Off => Some(ideal.clone()),
            Compensation::Address => {
                shift.ok().map(|d| sync::advanced(ideal, sync::whole_addresses(d, ideal.len())))
            }
            Compensation::Shift => shift.ok().map(|d| sync::advanced(ideal, d)),
            Compensation::Wrong => shift.ok().map(|d| sync::advanced(ideal, -d)),
            Compensation::Harmonics => by_harmonics(ideal, &measured, spin),
            Compensation::Learn => Some(
                learnt(&measured, ideal, spin)
                    .unwrap_or_else(|| self.begin(profile, spin, ideal).table()),
            ),
        }
    }

    fn measured(&self, profile: &CamProfile) -> Vec<&Measured> {
        let (number, form) = (profile.number, form_mark(&profile.nodes));
        let known = self.phases.measured.iter();
        known.filter(|m| m.profile == number && m.form == form).collect()
    }

    /// The phase error by the estimator that is asked.
    fn shift(&self, measured: &Measured) -> Angle {
        Angle::deg(match self.estimator {
            Estimator::LeastSquares => measured.phase_error_deg,
            Estimator::Flanks => measured.by_flanks_deg,
            Estimator::Maximum => measured.by_maximum_deg,
        })
    }

    /// Learning, with what is known.
    pub fn begin(&self, profile: &CamProfile, spin: Spin, ideal: &[f64]) -> Repetition {
        let measured = self.measured(profile);
        let new = match learnt(&measured, ideal, spin) {
            Some(sent) => Repetition::resumed(ideal, spin, self.taught, &sent),
            None => Repetition::new(ideal, spin, self.taught, fastest(&measured, spin).as_ref()),
        };
        new.assuming(self.assumed.clone())
    }

    /// Keep it on disk, if there is a place for it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self) -> Result<(), Refused> {
        match &self.path {
            Some(path) => Ok(self.phases.save(path)?),
            None => Ok(()),
        }
    }
}

/// What the machine's drives and loops are: what was measured on others does not count.
pub fn mark(machine: &MachineFile) -> u32 {
    let loops = (&machine.control.period, &machine.axes, &machine.spindles);
    store::learning::mark(&format!("{loops:?}"))
}

/// What X and C may do, and up to which frequency C's speed may vary.
pub fn bounds(machine: &MachineFile) -> Option<(AxisBounds, f64)> {
    let limits = config::planner(machine);
    let (x, work) = (limits.axes[0]?, limits.spindles.first()?);
    let torque = work.peak_torque.value() * TORQUE_SHARE;
    let bounds = AxisBounds {
        speed: x.rapid_speed.of_linear(),
        accel: x.accel.of_linear(),
        jerk: x.feed_jerk.of_linear(),
        spin: work.reachable(units::Torque::ZERO),
        spin_accel: SpinAccel::rev_per_s2(torque / work.inertia.value() / TAU),
    };
    let hz = SWING_SHARE * machine.spindles.first()?.loops.velocity_bandwidth_hz;
    Some((bounds, hz))
}

/// What was learnt for just this course at just this speed.
fn learnt(measured: &[&Measured], ideal: &[f64], spin: Spin) -> Option<Vec<f64>> {
    let same = measured.iter().find(|m| (m.rpm - spin.in_rpm()).abs() < 1e-6 * m.rpm)?;
    let form = if same.learnt_form.is_empty() { &same.form } else { &same.learnt_form };
    (same.learnt_nm.len() == ideal.len() && *form == form_mark(ideal))
        .then(|| ideal.iter().zip(&same.learnt_nm).map(|(d, nm)| d + nm * 1e-6).collect())
}

/// What is known of the machine's answer, measured at the slowest speed that is not slower than
/// this one.
fn fastest(measured: &[&Measured], spin: Spin) -> Option<Response> {
    let reaches = measured
        .iter()
        .find(|m| m.rpm >= spin.in_rpm() * (1.0 - 1e-3) && !m.response.is_empty())?;
    Some(Response::from_points(
        reaches.response.iter().map(|[hz, gain, delay]| (*hz, *gain, *delay)),
    ))
}

fn by_harmonics(ideal: &[f64], measured: &[&Measured], spin: Spin) -> Option<Vec<f64>> {
    let response = fastest(measured, spin)?;
    let wanted = Spectrum::of(ideal, usize::MAX);
    Some(response.precompensated(&wanted, spin).values(ideal.len()))
}
