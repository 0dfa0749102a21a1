//! Cams of a session: the library that is read, the table of phase errors, and what is sent of each profile.
//!
//! ```text
//!   cams.toml, lift.csv ─► forms::cam ─► profile D(θ) ──────────────┬─► planner (sent as it is)
//!   phase table ─► sync: address, shift, harmonics, learnt ─► D′(θ) ┘   or compensated, after G50
//! ```
use crate::args::{Compensation, ProgramArgs};
use crate::refused::Refused;
use canon::{Axis, CamLibrary, CamOrder, CamProfile, OpKind};
use forms::cam::{Cam, CamError, ClosedForm, Follower};
use plan::{CamCommand, Cams};
use std::path::{Path, PathBuf};
use store::cams::{CamEntry, CamFile, CamForm, FollowerKind};
use store::machine::MachineFile;
use store::phases::{Measured, Phases, form_mark};
use sync::{Repetition, RepetitionOptions, Response, ShiftOverSpeed, Spectrum};
use units::{Angle, Length, Speed, Spin, Stiffness};

/// Library looked for beside a program.
const BESIDE: &str = "cams.toml";
/// A vitrified wheel of 400 mm at 80 m/s on hardened steel: typical figures; the library gives the radius.
const WHEEL: sim::Wheel = sim::Wheel {
    radius: Length::mm(200.0),
    width: Length::mm(10.0),
    rim: Speed::mm_per_s(80_000.0),
    energy_j_per_mm3: 30.0,
    force_ratio: 0.4,
    grinding_ratio: 60.0,
};
/// Wheel, work and centres together: typical.
const STIFFNESS: Stiffness = Stiffness::n_per_mm(30_000.0);
/// Share of the velocity loop's bandwidth up to which the axis is taught.
const TAUGHT_SHARE: f64 = 0.9;

/// A blank that a program grinds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clamped {
    profile: u32,
    phase: Angle,
    centre: Length,
    stock: Length,
    z: Length,
}

/// Everything that is known of cams before a program begins.
#[derive(Clone, Debug)]
pub(crate) struct CamSetup {
    /// The profiles.
    pub(crate) library: CamLibrary,
    /// What was measured.
    pub(crate) phases: Phases,
    path: Option<PathBuf>,
    /// How what is sent is compensated.
    pub(crate) method: Compensation,
    /// Profiles and speeds that the program grinds compensated.
    wanted: Vec<(u32, Spin)>,
    wheel_radius: Length,
    clamped: Vec<Clamped>,
    taught: RepetitionOptions,
}

impl CamSetup {
    /// As the arguments say, for a program at this path.
    pub(crate) fn load(
        args: &ProgramArgs,
        program: &Path,
        machine: &MachineFile,
    ) -> Result<Self, Refused> {
        let beside =
            program.parent().map(|folder| folder.join(BESIDE)).filter(|path| path.is_file());
        let (library, wheel_radius) = match args.cams.clone().or(beside) {
            None => (CamLibrary::default(), Length::ZERO),
            Some(path) => library(&path)?,
        };
        let loops = (&machine.control.period, &machine.axes, &machine.spindles);
        let mark = store::learning::mark(&format!("{loops:?}"));
        let phases = match &args.phase_table {
            None => None,
            Some(path) => Phases::load(path, &machine.name, mark)?,
        };
        let bandwidth = machine.axes[0].as_ref().map_or(50.0, |x| x.loops.velocity_bandwidth_hz);
        Ok(Self {
            library,
            phases: phases.unwrap_or_else(|| Phases::new(&machine.name, mark)),
            path: args.phase_table.clone(),
            method: args.compensation,
            wanted: Vec::new(),
            wheel_radius,
            clamped: Vec::new(),
            taught: RepetitionOptions {
                highest_hz: TAUGHT_SHARE * bandwidth,
                floor: Length::um(0.02),
            },
        })
    }

    /// Find out what the program grinds compensated.
    pub(crate) fn look_ahead(&mut self, ops: impl Iterator<Item = canon::Op>) {
        let (mut profile, mut compensated) = (0, false);
        let (mut on_shaft, mut z) = ((Angle::ZERO, Length::ZERO), Length::ZERO);
        for op in ops {
            if let OpKind::Cam(CamOrder::Grind { stock, .. }) = op.kind {
                let (phase, centre) = on_shaft;
                let new = Clamped { profile, phase, centre, stock, z };
                match self.clamped.iter_mut().find(|c| Clamped { stock, ..**c } == new) {
                    Some(known) => known.stock = known.stock.max(stock),
                    None => self.clamped.push(new),
                }
            }
            match op.kind {
                OpKind::Rapid { to } | OpKind::Line { to, .. } => z = to.linear[2],
                OpKind::Cam(CamOrder::Select { profile: number, phase, centre }) => {
                    (profile, compensated) = (number, false);
                    on_shaft = (phase, centre);
                }
                OpKind::Cam(CamOrder::Compensate) => compensated = true,
                OpKind::Cam(CamOrder::Grind { spin, .. } | CamOrder::SparkOut { spin, .. })
                    if compensated && !self.wanted.contains(&(profile, spin)) =>
                {
                    self.wanted.push((profile, spin));
                }
                _ => {}
            }
        }
    }

    /// What is clamped on the work spindle, for the simulator; `None`: no cam is ground.
    pub(crate) fn grinding(&self) -> Option<sim::Grinding> {
        let centre = self.clamped.first()?.centre;
        let blank = |c: &Clamped| {
            let nodes = plan::turned(&self.library.get(c.profile)?.nodes, c.phase.value());
            let touches = nodes.iter().map(|d| c.centre + Length::mm(*d) + c.stock).collect();
            let half = Length::mm(WHEEL.width.value() / 2.0);
            Some(sim::Blank { along: (c.z - half, c.z + half), touches })
        };
        Some(sim::Grinding {
            work: 0,
            infeed: Axis::X.index(),
            along: Axis::Z.index(),
            centre,
            wheel: sim::Wheel { radius: self.wheel_radius, ..WHEEL },
            stiffness: STIFFNESS,
            blanks: self.clamped.iter().filter_map(blank).collect(),
        })
    }

    /// What the planner is told now.
    pub(crate) fn for_planner(&self) -> Cams {
        let commands = self.wanted.iter().filter_map(|(profile, spin)| {
            let nodes = self.sent(self.library.get(*profile)?, *spin)?;
            Some(CamCommand { profile: *profile, spin: *spin, nodes })
        });
        Cams { commands: commands.collect(), library: self.library.clone() }
    }

    /// What is sent of a profile at a speed with compensation on; `None`: it is not known.
    fn sent(&self, profile: &CamProfile, spin: Spin) -> Option<Vec<f64>> {
        let (ideal, form) = (&profile.nodes, form_mark(&profile.nodes));
        let measured: Vec<&Measured> = self.phases.of(profile.number, &form).collect();
        let points = measured.iter().map(|m| (Spin::rpm(m.rpm), Angle::deg(m.phase_error_deg)));
        let shift = ShiftOverSpeed::new(points).at(spin);
        match self.method {
            Compensation::Off => Some(ideal.clone()),
            Compensation::Address => {
                shift.ok().map(|d| sync::advanced(ideal, sync::whole_addresses(d, ideal.len())))
            }
            Compensation::Shift => shift.ok().map(|d| sync::advanced(ideal, d)),
            Compensation::Wrong => shift.ok().map(|d| sync::advanced(ideal, -d)),
            Compensation::Harmonics => by_harmonics(ideal, &measured, spin),
            Compensation::Learn => {
                let same = measured.iter().find(|m| (m.rpm - spin.in_rpm()).abs() < 1e-6 * m.rpm);
                let learnt = same.filter(|m| m.learnt_nm.len() == ideal.len());
                let add = |m: &&Measured| {
                    ideal.iter().zip(&m.learnt_nm).map(|(d, nm)| d + nm * 1e-6).collect()
                };
                learnt.map(add).or_else(|| Some(self.begin(profile, spin).table()))
            }
        }
    }

    /// Learning, with what is known.
    pub(crate) fn begin(&self, profile: &CamProfile, spin: Spin) -> Repetition {
        let (ideal, form) = (&profile.nodes, form_mark(&profile.nodes));
        let measured: Vec<&Measured> = self.phases.of(profile.number, &form).collect();
        let same = measured.iter().find(|m| (m.rpm - spin.in_rpm()).abs() < 1e-6 * m.rpm);
        if let Some(learnt) = same.filter(|m| m.learnt_nm.len() == ideal.len()) {
            let sent: Vec<f64> =
                ideal.iter().zip(&learnt.learnt_nm).map(|(d, nm)| d + nm * 1e-6).collect();
            return Repetition::resumed(ideal, spin, self.taught, &sent);
        }
        Repetition::new(ideal, spin, self.taught, fastest(&measured, spin).as_ref())
    }

    /// Keep it on disk, if there is a place for it.
    pub(crate) fn save(&self) -> Result<(), Refused> {
        match &self.path {
            Some(path) if !self.phases.measured.is_empty() => Ok(self.phases.save(path)?),
            _ => Ok(()),
        }
    }
}

/// What is known of the machine's answer, measured at the slowest speed that is not slower than this one.
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

/// Read a library and make its profiles.
fn library(path: &Path) -> Result<(CamLibrary, Length), Refused> {
    let file = store::cams::load(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let profiles: Result<Vec<_>, _> =
        file.cam.iter().map(|entry| profile(&file, entry, folder)).collect();
    Ok((CamLibrary::new(profiles?), Length::mm(file.wheel_radius_mm)))
}

fn profile(file: &CamFile, entry: &CamEntry, folder: &Path) -> Result<CamProfile, Refused> {
    let wheel = Length::mm(file.wheel_radius_mm);
    let name =
        if entry.name.is_empty() { format!("P{}", entry.number) } else { entry.name.clone() };
    let refused = |e: CamError| Refused::because(format!("cam {} ({name}): {e}", entry.number));
    let cam = match &entry.form {
        CamForm::Table { file, base_mm, follower, roller_radius_mm } => {
            let follower = of_kind(*follower, *roller_radius_mm)?;
            table(&folder.join(file), Length::mm(*base_mm), follower)?
        }
        form => closed(form)?.cam().map_err(refused)?,
    };
    let path = if entry.path_only {
        cam.path_unchecked(wheel, file.nodes)
    } else {
        cam.wheel_path(wheel, file.nodes)
    };
    let mut nodes = path.map_err(refused)?.centre;
    if file.table_pulse_um > 0.0 {
        let pulse = file.table_pulse_um * 1e-3;
        for x in &mut nodes {
            *x = (*x / pulse).round() * pulse;
        }
    }
    Ok(CamProfile { number: entry.number, name, nodes })
}

/// A lift table from a file.
pub(crate) fn table(path: &Path, base: Length, follower: Follower) -> Result<Cam, Refused> {
    let text = store::read_text(path, "a lift table", store::cams::LIFT_TABLE_LIMIT)?;
    let name = path.display().to_string();
    let found = |text: String, finding| Refused::Findings {
        name: name.clone(),
        text: text.into_bytes(),
        findings: vec![finding],
    };
    let rows = match store::cams::lift_rows(&text) {
        Ok(rows) => rows,
        Err(finding) => return Err(found(text, finding)),
    };
    let lifts: Vec<_> =
        rows.iter().map(|r| forms::cam::LiftRow { angle: r.angle, lift: r.lift }).collect();
    Cam::from_rows(&lifts, base, follower).map_err(|e| {
        let span =
            e.row.and_then(|row| rows.get(row)).map_or_else(diag::Span::default, |row| row.span);
        found(text, diag::Diagnostic::error("A0201", span, e.to_string()))
    })
}

/// A follower's words in a file or on the command line.
pub(crate) fn of_kind(kind: FollowerKind, roller_mm: Option<f64>) -> Result<Follower, Refused> {
    match (kind, roller_mm) {
        (FollowerKind::Flat, None) => Ok(Follower::Flat),
        (FollowerKind::Knife, None) => Ok(Follower::Knife),
        (FollowerKind::Roller, Some(radius)) => Ok(Follower::Roller(Length::mm(radius))),
        (FollowerKind::Roller, None) => {
            Err(Refused::because("a roller follower needs its radius (roller_radius_mm)"))
        }
        (FollowerKind::Flat | FollowerKind::Knife, Some(_)) => {
            Err(Refused::because("only a roller follower has a roller radius"))
        }
    }
}

/// A cam with a closed form.
pub(crate) fn closed(form: &CamForm) -> Result<ClosedForm, Refused> {
    let mm = Length::mm;
    Ok(match *form {
        CamForm::Table { .. } => return Err(Refused::because("a table has no closed form")),
        CamForm::Eccentric { radius_mm, eccentricity_mm } => {
            ClosedForm::Eccentric { radius: mm(radius_mm), eccentricity: mm(eccentricity_mm) }
        }
        CamForm::Harmonic { base_mm, lift_mm, follower, roller_radius_mm } => {
            ClosedForm::Harmonic {
                base: mm(base_mm),
                lift: mm(lift_mm),
                follower: of_kind(follower, roller_radius_mm)?,
            }
        }
        CamForm::Lobes { radius_mm, amplitude_mm, count, phase_deg } => ClosedForm::Lobes {
            radius: mm(radius_mm),
            amplitude: mm(amplitude_mm),
            count,
            phase: Angle::deg(phase_deg),
        },
        CamForm::Polynomial {
            base_mm,
            lift_mm,
            rise_deg,
            dwell_deg,
            fall_deg,
            follower,
            roller_radius_mm,
        } => ClosedForm::Polynomial {
            base: mm(base_mm),
            lift: mm(lift_mm),
            rise: Angle::deg(rise_deg),
            dwell: Angle::deg(dwell_deg),
            fall: Angle::deg(fall_deg),
            follower: of_kind(follower, roller_radius_mm)?,
        },
        CamForm::Automotive { base_mm, lift_mm, half_angle_deg, follower, roller_radius_mm } => {
            ClosedForm::Automotive {
                base: mm(base_mm),
                lift: mm(lift_mm),
                half_angle: Angle::deg(half_angle_deg),
                follower: of_kind(follower, roller_radius_mm)?,
            }
        }
    })
}
