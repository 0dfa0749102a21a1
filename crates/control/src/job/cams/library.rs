//! From a cam library's file to the paths of the wheel that is mounted.
use crate::Refused;
use canon::CamProfile;
use forms::cam::{Cam, CamError, ClosedForm, Follower, WheelPath};
use std::path::Path;
use store::cams::{CamEntry, CamForm, FollowerKind, WorkSpeed};
use store::machine::MachineFile;
use units::{Angle, Length};

/// One cam of the library.
#[derive(Clone, Debug)]
pub(super) struct Made {
    /// What programs, planner and judge know of it.
    pub profile: CamProfile,
    /// The wheel's path.
    pub path: WheelPath,
    /// How the work turns.
    pub work_speed: WorkSpeed,
}

/// Read a library and make its paths for the wheel of a machine.
pub(super) fn read(path: &Path, machine: &MachineFile) -> Result<Vec<Made>, Refused> {
    let file = store::cams::load(path)?;
    let Some(grinding) = &machine.grinding else {
        return Err(Refused::because(format!(
            "{} grinds no cams: its file has no section [grinding]",
            machine.name
        )));
    };
    let wheel = grinding.wheel.radius();
    if let Some(radius) = file.wheel_radius_mm.filter(|r| (r - wheel.value()).abs() > 1e-6) {
        return Err(Refused::because(format!(
            "{}: it is for a wheel of radius {radius} mm, that of {} has {} mm: leave wheel_radius_mm out, and the \
             paths are made for the wheel that is mounted",
            path.display(),
            machine.name,
            wheel.value()
        )));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    file.cam.iter().map(|entry| made(entry, folder, wheel, file.nodes)).collect()
}

fn made(entry: &CamEntry, folder: &Path, wheel: Length, nodes: usize) -> Result<Made, Refused> {
    let number = entry.number;
    let name = if entry.name.is_empty() { format!("P{number}") } else { entry.name.clone() };
    let refused = |e: CamError| Refused::because(format!("cam {number} ({name}): {e}"));
    let cam = match &entry.form {
        CamForm::Table { file, base_mm, follower, roller_radius_mm } => {
            let follower = of_kind(*follower, *roller_radius_mm)?;
            table(&folder.join(file), Length::mm(*base_mm), follower)?
        }
        form => closed(form)?.cam().map_err(refused)?,
    };
    let path = if entry.path_only {
        cam.path_unchecked(wheel, nodes)
    } else {
        cam.wheel_path(wheel, nodes)
    };
    let path = path.map_err(refused)?;
    let (nodes, steepest) = (path.centre.clone(), path.steepest());
    let profile = CamProfile { number, name, nodes, wheel, steepest };
    Ok(Made { profile, path, work_speed: entry.work_speed })
}

/// A lift table from a file.
///
/// # Errors
/// A file that cannot be read, and a table that is no cam.
pub fn table(path: &Path, base: Length, follower: Follower) -> Result<Cam, Refused> {
    let text = store::cams::table_text(path)?;
    let name = path.display().to_string();
    let found = |text: String, finding| Refused::text(name.clone(), text, vec![finding]);
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
///
/// # Errors
/// A roller without a radius, and a radius without a roller.
pub fn of_kind(kind: FollowerKind, roller_mm: Option<f64>) -> Result<Follower, Refused> {
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
pub(super) fn closed(form: &CamForm) -> Result<ClosedForm, Refused> {
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
