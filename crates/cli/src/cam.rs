//! `leadscrew cam`: from a lift table or a closed form to the wheel's path, with what it asks of
//! the machine.
//!
//! ```text
//!   lift.csv | --form … ─► Cam ─► wheel path ─► checks, highest speed, even removal ─► table, G-code, pictures
//! ```
use crate::args::{CamArgs, CamFormName, CamOutput};
use crate::say;
use control::Refused;
use control::config::machine_file::MachineSource;
use control::job::cams;
use forms::cam::{AxisBounds, Cam, ClosedForm, Follower, Rhythm, WheelPath};
use report::CamPage;
use serde_json::json;
use std::fmt::Write;
use store::machine::MachineFile;
use units::{Angle, Length, Spin};

/// Steps of a turn of a library that says nothing else.
const USUAL_NODES: usize = 720;
/// How far the wheel stands off the top of a cam, and how far at least; mm.
const CLEAR_MM: f64 = 10.0;
const LEAST_CLEAR_MM: f64 = 1.0;
/// Steps of the curves that are drawn.
const DRAWN: usize = 720;

/// A name within a comment of a program, which ends at its first closing bracket.
fn in_comment(name: &str) -> String {
    name.replace(['(', ')'], "_")
}

/// Everything that was computed.
struct Result {
    name: String,
    cam: Cam,
    path: WheelPath,
    spin: Spin,
    bounds: AxisBounds,
    even: Rhythm,
    /// Machine that it is for.
    machine: String,
    /// X of G54 at which the wheel stands clear of the work.
    clear: f64,
    /// What the cam library has of it, behind its number.
    entry: Vec<String>,
}

/// Do it.
pub(crate) fn command(args: &CamArgs) -> std::result::Result<(), Refused> {
    let result = computed(args, (&args.machine).into())?;
    if let Some(out) = &args.out {
        store::output::write_file(out, report::cam_html(&result.page()).as_bytes())?;
    }
    say::out(&match args.format {
        CamOutput::Text => result.text(args),
        CamOutput::Table => result.table(),
        CamOutput::Gcode => result.gcode(args.number),
        CamOutput::Json => format!("{}\n", result.json()),
    })
}

/// The same for programs, on this machine.
pub(crate) fn answer(
    args: &CamArgs,
    machine: MachineSource,
) -> std::result::Result<serde_json::Value, Refused> {
    let result = computed(args, machine)?;
    let mut value = result.json();
    value["gcode"] = json!(result.gcode(args.number));
    Ok(value)
}

fn computed(args: &CamArgs, machine: MachineSource) -> std::result::Result<Result, Refused> {
    let (name, cam, form) = cam(args)?;
    let machine = control::config::machine_file::load(machine)?;
    let mounted = machine.grinding.map(|grinding| grinding.wheel);
    let radius = args.wheel_radius.map_or_else(
        || mounted.map_or(Length::mm(200.0), |wheel| wheel.diameter / 2.0),
        Length::mm,
    );
    let worn = args.wheel_wear.map_or_else(
        || mounted.filter(|_| args.wheel_radius.is_none()).map_or(Length::ZERO, |wheel| wheel.worn),
        Length::mm,
    );
    let wheel = radius - worn;
    let path =
        cam.wheel_path(wheel, args.nodes).map_err(|e| Refused::because(format!("{name}: {e}")))?;
    let Some((bounds, swing_hz)) = cams::bounds(&machine) else {
        return Err(Refused::because(format!("{} has no X axis or no work spindle", machine.name)));
    };
    if !(args.speed > 0.0 && args.speed.is_finite()) {
        return Err(Refused::because(format!("--speed {}: expected a speed above 0", args.speed)));
    }
    let spin = Spin::rpm(args.speed);
    let even = path.rhythm(spin, &bounds, swing_hz);
    let clear = clear(&path, &machine)?;
    let mut entry = vec!["[[cam]]".to_owned(), format!("number = {}", args.number)];
    entry.extend(form);
    if args.wheel_radius.is_some() || args.wheel_wear.is_some() {
        entry.insert(0, format!("wheel_radius_mm = {}", wheel.value()));
    }
    if args.nodes != USUAL_NODES {
        entry.insert(0, format!("nodes = {}", args.nodes));
    }
    let machine = machine.name;
    Ok(Result { name, cam, path, spin, bounds, even, machine, clear, entry })
}

/// Where the wheel stands clear of the work, in G54 and within the travel of X.
fn clear(path: &WheelPath, machine: &MachineFile) -> std::result::Result<f64, Refused> {
    let top = path.centre.iter().copied().fold(0.0, f64::max);
    let zero = machine.setup.g54.linear[0].value();
    let most = machine.axes[0].as_ref().map_or(f64::INFINITY, |x| x.travel.to.value() - zero);
    let clear = (top + CLEAR_MM).ceil().min(most);
    if clear >= top + LEAST_CLEAR_MM {
        return Ok(clear);
    }
    Err(Refused::because(format!(
        "the wheel's centre stands X{top:.3} from the work's axis at the top of this cam, and the travel of X on {} ends at X{most:.3}: a smaller wheel or base circle works",
        machine.name
    )))
}

/// The cam, and what a library says of its form.
fn cam(args: &CamArgs) -> std::result::Result<(String, Cam, Vec<String>), Refused> {
    let roller = args.roller_radius;
    let follower = cams::of_kind(args.follower.into(), roller)?;
    let mm = Length::mm;
    if let Some(path) = &args.table {
        let base = args.base.ok_or_else(|| {
            Refused::because("a lift table needs --base, the radius of the base circle in mm")
        })?;
        let file = std::path::absolute(path).unwrap_or_else(|_| path.clone());
        let mut form = vec![
            "kind = \"table\"".to_owned(),
            format!("file = {}", serde_json::Value::from(file.display().to_string())),
            format!("base_mm = {base}"),
        ];
        form.extend(follower_keys(args));
        return Ok((path.display().to_string(), cams::table(path, mm(base), follower)?, form));
    }
    let (base, lift) = (mm(args.base.unwrap_or(25.0)), mm(args.lift));
    let form = match args.form.unwrap_or(CamFormName::Automotive) {
        CamFormName::Eccentric => ClosedForm::Eccentric { radius: base, eccentricity: lift / 2.0 },
        CamFormName::Harmonic => ClosedForm::Harmonic { base, lift, follower },
        CamFormName::Lobes => ClosedForm::Lobes {
            radius: base,
            amplitude: lift / 2.0,
            count: args.lobes,
            phase: Angle::ZERO,
        },
        CamFormName::Polynomial => ClosedForm::Polynomial {
            base,
            lift,
            rise: Angle::deg(args.half_angle),
            dwell: Angle::ZERO,
            fall: Angle::deg(args.half_angle),
            follower,
        },
        CamFormName::Automotive => {
            ClosedForm::Automotive { base, lift, half_angle: Angle::deg(args.half_angle), follower }
        }
    };
    let name = format!("{:?}", args.form.unwrap_or(CamFormName::Automotive)).to_lowercase();
    let cam = form.cam().map_err(|e| Refused::because(format!("{name}: {e}")))?;
    Ok((name, cam, form_keys(args)))
}

/// A closed form in the keys of a cam library.
fn form_keys(args: &CamArgs) -> Vec<String> {
    let (base, lift, half) = (args.base.unwrap_or(25.0), args.lift, args.half_angle);
    let number = |key: &str, value: f64| format!("{key} = {value}");
    let (kind, numbers, has_follower) = match args.form.unwrap_or(CamFormName::Automotive) {
        CamFormName::Eccentric => (
            "eccentric",
            vec![number("radius_mm", base), number("eccentricity_mm", lift / 2.0)],
            false,
        ),
        CamFormName::Harmonic => {
            ("harmonic", vec![number("base_mm", base), number("lift_mm", lift)], true)
        }
        CamFormName::Lobes => (
            "lobes",
            vec![
                number("radius_mm", base),
                number("amplitude_mm", lift / 2.0),
                format!("count = {}", args.lobes),
                number("phase_deg", 0.0),
            ],
            false,
        ),
        CamFormName::Polynomial => (
            "polynomial",
            vec![
                number("base_mm", base),
                number("lift_mm", lift),
                number("rise_deg", half),
                number("dwell_deg", 0.0),
                number("fall_deg", half),
            ],
            true,
        ),
        CamFormName::Automotive => (
            "automotive",
            vec![number("base_mm", base), number("lift_mm", lift), number("half_angle_deg", half)],
            true,
        ),
    };
    let mut keys = vec![format!("kind = \"{kind}\"")];
    keys.extend(numbers);
    keys.extend(follower_keys(args).into_iter().filter(|_| has_follower));
    keys
}

fn follower_keys(args: &CamArgs) -> Vec<String> {
    let name = match args.follower.into() {
        store::cams::FollowerKind::Flat => "flat",
        store::cams::FollowerKind::Roller => "roller",
        store::cams::FollowerKind::Knife => "knife",
    };
    let radius = args.roller_radius.map(|radius| format!("roller_radius_mm = {radius}"));
    [Some(format!("follower = \"{name}\"")), radius].into_iter().flatten().collect()
}

impl Result {
    fn figures(&self) -> Vec<(String, String)> {
        let motion = self.path.motion(self.spin);
        let (fastest, bound) = self.path.highest_speed(&self.bounds);
        let rpm = self.work_speed();
        let hollow = match self.cam.tightest_hollow() {
            None => "none: any wheel fits".to_owned(),
            Some((at, radius)) => {
                format!(
                    "radius {:.2} mm at {:.1}°: the wheel must be smaller",
                    radius.value(),
                    at.in_deg()
                )
            }
        };
        let follower = match self.cam.follower {
            Follower::Flat => "flat".to_owned(),
            Follower::Roller(radius) => format!("roller, radius {} mm", radius.value()),
            Follower::Knife => "knife edge".to_owned(),
        };
        let row = |what: &str, value: String| (what.to_owned(), value);
        vec![
            row("base radius", format!("{} mm", self.cam.base.value())),
            row("lift", format!("{:.4} mm", self.cam.greatest_lift().value())),
            row("follower", follower),
            row("wheel radius", format!("{} mm", self.path.wheel.value())),
            row("hollows", hollow),
            row("stroke of X", format!("{:.4} mm", motion.stroke.value())),
            row("speed of the work", format!("{:.1} rpm", self.spin.in_rpm())),
            row(
                "speed of X",
                format!("{:.1} of {:.1} mm/s", motion.speed.value(), self.bounds.speed.value()),
            ),
            row(
                "acceleration of X",
                format!(
                    "{:.2} of {:.2} m/s²",
                    motion.accel.value() * 1e-3,
                    self.bounds.accel.value() * 1e-3
                ),
            ),
            row(
                "jerk of X",
                format!(
                    "{:.0} of {:.0} m/s³",
                    motion.jerk.value() * 1e-3,
                    self.bounds.jerk.value() * 1e-3
                ),
            ),
            row(
                "highest speed that works",
                format!("{:.1} rpm, by the {}", fastest.in_rpm(), bound.name()),
            ),
            row(
                "removal rate, peak over mean",
                format!(
                    "{:.2} at a constant speed, {:.2} with the speed varied from {:.1} to {:.1} rpm",
                    self.even.peak_constant,
                    self.even.peak,
                    rpm.iter().copied().fold(f64::INFINITY, f64::min),
                    rpm.iter().copied().fold(0.0, f64::max)
                ),
            ),
        ]
    }

    fn text(&self, args: &CamArgs) -> String {
        let mut table = crate::tables::table([self.name.as_str(), ""]);
        for (what, value) in self.figures() {
            table.add_row([what, value]);
        }
        let mut said = format!("{table}\n\n{}", self.gcode(args.number));
        if let Some(out) = &args.out {
            let _ = writeln!(said, "\npictures: {}", out.display());
        }
        said
    }

    /// Work speed at equal steps of C for an even removal rate, rev/min.
    fn work_speed(&self) -> Vec<f64> {
        self.even.speed(self.spin).iter().map(|spin| spin * 60.0).collect()
    }

    /// Angle of C, the wheel's centre, and the work speed for an even removal rate.
    fn table(&self) -> String {
        let n = self.path.centre.len();
        let mut said = String::from("c_deg,x_mm,work_speed_rpm\n");
        for (k, (x, rpm)) in self.path.centre.iter().zip(&self.work_speed()).enumerate() {
            let _ = writeln!(said, "{:.4},{x:.6},{rpm:.3}", 360.0 * k as f64 / n as f64);
        }
        said
    }

    fn gcode(&self, number: u32) -> String {
        let fastest = (self.path.highest_speed(&self.bounds).0.in_rpm() * 10.0).floor() / 10.0;
        let asked = self.spin.in_rpm();
        let speed = asked.min(fastest);
        let slower = if speed < asked {
            format!("(S{speed} and not S{asked}: it is the highest speed that works)\n")
        } else {
            String::new()
        };
        let library = format!("({})\n", self.entry.join(")\n("));
        format!(
            "(cam {} on {}; the cam library, cams.toml beside this program or --cams FILE, has)\n\
             {library}{slower}G21 G90 G54\n\
             (measure once, in the air: the phase error goes into the table of --phase-table)\n\
             G0 X{}\nG151 P{number}\nG152\nG153\nG154 S{speed} P2\nG155\n\
             (then grind 0.1 mm in two turns, and spark out three)\n\
             G150\nG154 X-0.1 F0.05 S{speed}\nG154 P3\nG151 P0\nM30\n",
            in_comment(&self.name),
            self.machine,
            self.clear,
        )
    }

    fn json(&self) -> serde_json::Value {
        let motion = self.path.motion(self.spin);
        let (fastest, bound) = self.path.highest_speed(&self.bounds);
        json!({
            "name": self.name,
            "base_mm": self.cam.base.value(),
            "lift_mm": self.cam.greatest_lift().value(),
            "wheel_radius_mm": self.path.wheel.value(),
            "tightest_hollow_mm": self.cam.tightest_hollow().map(|h| h.1.value()),
            "rpm": self.spin.in_rpm(),
            "library": self.entry.join("\n") + "\n",
            "stroke_mm": motion.stroke.value(),
            "speed_mm_per_s": motion.speed.value(),
            "acceleration_m_per_s2": motion.accel.value() * 1e-3,
            "jerk_m_per_s3": motion.jerk.value() * 1e-3,
            "highest_rpm": fastest.in_rpm(),
            "bounded_by": bound.name(),
            "removal_peak_constant": self.even.peak_constant,
            "removal_peak_varied": self.even.peak,
            "centre_mm": self.path.centre,
            "work_speed_rpm": self.work_speed(),
        })
    }

    fn page(&self) -> CamPage {
        let n = self.spin.value();
        let contour = self.cam.contour(DRAWN);
        let degrees = |k: usize| 360.0 * k as f64 / DRAWN as f64;
        let along =
            |f: &dyn Fn(usize) -> f64| (0..DRAWN).map(|k| (degrees(k), f(k))).collect::<Vec<_>>();
        let at = |k: usize| self.path.at(Angle::rev(k as f64 / DRAWN as f64));
        let rpm = self.work_speed();
        CamPage {
            title: format!("Cam {}", self.name),
            figures: self.figures(),
            contour: contour
                .iter()
                .chain(contour.first())
                .map(|p| (p.at[0].value(), p.at[1].value()))
                .collect(),
            lift: along(&|k| contour[k].lift.value()),
            speed: along(&|k| at(k).slope * n),
            accel: along(&|k| at(k).bend * n * n * 1e-3),
            curvature: along(&|k| 1.0 / contour[k].radius.value()),
            work_speed: rpm
                .iter()
                .enumerate()
                .map(|(k, spin)| (360.0 * k as f64 / rpm.len() as f64, *spin))
                .collect(),
        }
    }
}
