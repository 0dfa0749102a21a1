//! Axes of a machine file from `[AXIS_X]`, the `[JOINT_N]` that move it, and `[TRAJ]`.
use super::compensation::Stated;
use super::ini::Ini;
use super::writer::{Cited, MachineWriter, RemarkKind, loops, plain};

/// Letters in the order of LinuxCNC's axes.
pub(super) const LETTERS: &str = "XYZABCUVW";
/// Beyond it a limit of travel is none.
const FARTHEST_MM: f64 = 100_000.0;
const FARTHEST_DEG: f64 = 360_000.0;

/// An axis, and how it counts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AxisOf {
    pub(super) letter: char,
    pub(super) joints: Vec<usize>,
    /// mm or degrees of a unit of the configuration.
    pub(super) scale: f64,
}

/// What homing and the rest need of an axis that was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Written {
    pub(super) travel: (f64, f64),
    /// Approach speed and acceleration, per second.
    pub(super) approach: (f64, f64),
    pub(super) acceleration: f64,
}

impl AxisOf {
    pub(super) fn is_rotary(&self) -> bool {
        matches!(self.letter, 'A' | 'B' | 'C')
    }

    pub(super) fn key(&self) -> String {
        format!("axes.{}", self.letter.to_ascii_lowercase())
    }

    /// Its sections: that of the axis, and those of its joints.
    pub(super) fn sections(&self) -> Vec<String> {
        let joints = self.joints.iter().map(|joint| format!("JOINT_{joint}"));
        std::iter::once(format!("AXIS_{}", self.letter)).chain(joints).collect()
    }

    /// A number of its first joint.
    pub(super) fn of_joint(&self, w: &mut MachineWriter, ini: &Ini, key: &str) -> Option<Cited> {
        let joint = self.joints.first()?;
        w.number(ini, &format!("JOINT_{joint}"), key)
    }

    /// The tightest of what all its sections say, in mm or degrees.
    fn tightest(&self, w: &mut MachineWriter, ini: &Ini, key: &str, least: bool) -> Option<Cited> {
        let mut found: Option<Cited> = None;
        for section in self.sections() {
            let Some(one) = w.number(ini, &section, key) else { continue };
            let one = one.map(|value| value * self.scale);
            let tighter =
                |than: &Cited| if least { one.value < than.value } else { one.value > than.value };
            if found.as_ref().is_none_or(tighter) {
                found = Some(one);
            }
        }
        found
    }

    /// Write it; `None`: what it lacks was said.
    pub(super) fn write(
        &self,
        w: &mut MachineWriter,
        ini: &Ini,
        period_us: f64,
    ) -> Option<Written> {
        let key = self.key();
        w.section(&format!("[{key}]"), &key);
        let travel = self.travel(w, ini);
        let speed = self.speed(w, ini);
        let acceleration = self.acceleration(w, ini);
        let (travel, speed, acceleration) = (travel?, speed?, acceleration?);
        let approach = self.motion(w, &speed, &acceleration);
        self.body(w, ini, acceleration.value, period_us);
        Stated::read(w, ini, self).write(w, self, travel);
        Some(Written { travel, approach, acceleration: acceleration.value })
    }

    fn travel(&self, w: &mut MachineWriter, ini: &Ini) -> Option<(f64, f64)> {
        let (unit, far) =
            if self.is_rotary() { ("deg", FARTHEST_DEG) } else { ("mm", FARTHEST_MM) };
        let ends = [("MIN_LIMIT", "travel_from", false), ("MAX_LIMIT", "travel_to", true)];
        let mut travel = [0.0; 2];
        let mut all = true;
        for ((key, ours, least), at) in ends.into_iter().zip(&mut travel) {
            let ours = format!("{ours}_{unit}");
            match self.tightest(w, ini, key, least).filter(|end| end.value.abs() <= far) {
                Some(end) => {
                    *at = end.value;
                    w.taken(&ours, &plain(end.value), &end.from);
                }
                None if self.is_rotary() => {
                    *at = if least { far } else { -far };
                    w.guessed(&ours, &plain(*at), "without a limit it turns on and on");
                }
                None => {
                    all = false;
                    let text = format!(
                        "no {key} in [{}]: a linear axis has a travel",
                        self.sections().join("], [")
                    );
                    w.say(RemarkKind::Wrong, &ours, &text);
                }
            }
        }
        let [from, to] = travel;
        if all && from >= to {
            let (from, to) = (plain(from), plain(to));
            w.say(
                RemarkKind::Wrong,
                "",
                &format!("MIN_LIMIT {from} is not below MAX_LIMIT {to} {unit}"),
            );
            return None;
        }
        if all && self.is_rotary() && !(from..=to).contains(&0.0) {
            let (from, to) = (plain(from), plain(to));
            let text =
                format!("a rotary axis has its zero within its travel of {from} to {to} deg");
            w.say(RemarkKind::Wrong, "", &text);
            return None;
        }
        all.then_some((from, to))
    }

    fn speed(&self, w: &mut MachineWriter, ini: &Ini) -> Option<Cited> {
        let own = self.tightest(w, ini, "MAX_VELOCITY", true);
        let key = if self.is_rotary() { "MAX_ANGULAR_VELOCITY" } else { "MAX_LINEAR_VELOCITY" };
        let all = w.number(ini, "TRAJ", key).map(|cap| cap.map(|value| value * self.scale));
        let Some(own) = own.filter(|own| own.value > 0.0) else {
            let text = format!(
                "no MAX_VELOCITY above 0 in [{}]: expected how fast it may go, in units per second",
                self.sections().join("], [")
            );
            w.say(RemarkKind::Wrong, "rapid", &text);
            return None;
        };
        Some(all.filter(|all| all.value > 0.0 && all.value < own.value).unwrap_or(own))
    }

    fn acceleration(&self, w: &mut MachineWriter, ini: &Ini) -> Option<Cited> {
        let found =
            self.tightest(w, ini, "MAX_ACCELERATION", true).filter(|found| found.value > 0.0);
        if found.is_none() {
            let text = format!(
                "no MAX_ACCELERATION above 0 in [{}]: expected units per second squared",
                self.sections().join("], [")
            );
            w.say(RemarkKind::Wrong, "acceleration", &text);
        }
        found
    }

    /// Speeds and accelerations, which a machine file has per minute and in m/s², or degrees; the
    /// approach.
    fn motion(&self, w: &mut MachineWriter, speed: &Cited, acceleration: &Cited) -> (f64, f64) {
        /// In it LinuxCNC's acceleration, which jumps, is built up.
        const RISE_S: f64 = 0.05;
        const APPROACH_PER_MIN: f64 = 3000.0;
        let (per_min, accel, jerk, shrunk) = if self.is_rotary() {
            ("deg_per_min", "deg_per_s2", "deg_per_s3", 1.0)
        } else {
            ("mm_per_min", "m_per_s2", "m_per_s3", 1e-3)
        };
        let fast = plain(speed.value * 60.0);
        w.taken(&format!("rapid_{per_min}"), &fast, &speed.from);
        w.taken(&format!("feed_most_{per_min}"), &fast, &speed.from);
        let stated = plain(acceleration.value * shrunk);
        w.taken(&format!("acceleration_{accel}"), &stated, &acceleration.from);
        let rise = plain(acceleration.value * shrunk / RISE_S);
        let why = "the acceleration is built up in 50 ms; LinuxCNC's jumps";
        w.guessed(&format!("jerk_feed_{jerk}"), &rise, why);
        w.guessed(&format!("jerk_rapid_{jerk}"), &rise, why);
        let approach = ((speed.value * 60.0).min(APPROACH_PER_MIN), acceleration.value / 2.0);
        let why = "small moves and stops that are not planned";
        w.guessed(&format!("approach_{per_min}"), &plain(approach.0), why);
        w.guessed(&format!("approach_{accel}"), &plain(approach.1 * shrunk), why);
        (approach.0 / 60.0, approach.1)
    }

    /// What the simulated machine is made of, the encoder, the windows.
    fn body(&self, w: &mut MachineWriter, ini: &Ini, acceleration: f64, period_us: f64) {
        let key = self.key();
        let why = "drive, masses, structure, friction and loops: only the simulated machine is made of them, the drive closes its loops";
        w.say(RemarkKind::Guessed, "", why);
        if self.is_rotary() {
            w.text += ROTARY_MASS;
        } else {
            w.text += LINEAR_MASS;
        }
        w.section(&format!("[{key}.drive]"), &format!("{key}.drive"));
        w.text += if self.is_rotary() { ROTARY_DRIVE } else { LINEAR_DRIVE };
        let torque = if self.is_rotary() {
            rotary_torque(acceleration)
        } else {
            linear_torque(acceleration)
        };
        w.line("peak_torque_n_m", &plain(torque), "guess: four times what the acceleration needs");
        w.section(&format!("[{key}.structure]"), &format!("{key}.structure"));
        w.text += if self.is_rotary() { ROTARY_STRUCTURE } else { LINEAR_STRUCTURE };
        self.backlash(w, ini);
        w.section(&format!("[{key}.friction]"), &format!("{key}.friction"));
        w.text += if self.is_rotary() { ROTARY_FRICTION } else { LINEAR_FRICTION };
        w.section(&format!("[{key}.encoder]"), &format!("{key}.encoder"));
        self.encoder(w, ini);
        w.section(&format!("[{key}.loops]"), &format!("{key}.loops"));
        loops(w, 20.0, period_us);
        w.section(&format!("[{key}.windows]"), &format!("{key}.windows"));
        self.windows(w, ini);
    }

    fn backlash(&self, w: &mut MachineWriter, ini: &Ini) {
        let (key, units) =
            if self.is_rotary() { ("backlash_arcsec", 3600.0) } else { ("backlash_um", 1e3) };
        match self.of_joint(w, ini, "BACKLASH").map(|found| found.map(|v| v.abs() * self.scale)) {
            Some(found) => {
                w.taken(key, &plain(found.value * units), &found.from);
            }
            None => w.guessed(key, "0", "no BACKLASH of its joint"),
        }
    }

    fn encoder(&self, w: &mut MachineWriter, ini: &Ini) {
        let found = ["ENCODER_SCALE", "INPUT_SCALE", "SCALE"]
            .into_iter()
            .find_map(|key| self.of_joint(w, ini, key))
            .filter(|found| found.value != 0.0);
        if self.is_rotary() {
            w.line("position_from", "\"table\"", "pos-fb tells where the axis is");
            let counts = found.map(|found| found.map(|v| (v.abs() / self.scale * 360.0).round()));
            match counts.filter(|found| (16.0..=4e9).contains(&found.value)) {
                Some(found) => w.taken("table_counts_per_rev", &plain(found.value), &found.from),
                None => {
                    w.guessed("table_counts_per_rev", "360000", "no scale of its joint says it");
                }
            }
            return;
        }
        w.line("position_from", "\"scale\"", "pos-fb tells where the axis is");
        let step = found.map(|found| found.map(|v| self.scale / v.abs() * 1e6));
        match step.filter(|found| (0.01..=1e6).contains(&found.value)) {
            Some(found) => w.taken("scale_resolution_nm", &plain(found.value), &found.from),
            None => w.guessed("scale_resolution_nm", "1000", "no scale of its joint says it"),
        }
    }

    fn windows(&self, w: &mut MachineWriter, ini: &Ini) {
        let (unit, shrunk) = if self.is_rotary() { ("arcsec", 3600.0) } else { ("um", 1e3) };
        let bounds = 0.1..=if self.is_rotary() { 3.6e6 } else { 1e6 };
        let mut read = |key| {
            let found = self.of_joint(w, ini, key)?.map(|v| v * self.scale * shrunk);
            Some(found).filter(|found| bounds.contains(&found.value))
        };
        let (most, least) = (read("FERROR"), read("MIN_FERROR"));
        w.line(&format!("in_position_{unit}"), "10", "guess");
        w.line("settle_ms", "5", "guess");
        let (warn, stop) =
            (format!("following_error_warn_{unit}"), format!("following_error_stop_{unit}"));
        let Some(most) = most else {
            let why = "no FERROR of its joint";
            w.guessed(&warn, "500", why);
            return w.guessed(&stop, "2000", why);
        };
        match least.filter(|least| least.value <= most.value) {
            Some(least) => w.taken(&warn, &plain(least.value), &least.from),
            None => w.guessed(&warn, &plain(most.value / 2.0), "half of what stops the machine"),
        }
        w.taken(&stop, &plain(most.value), &most.from);
    }
}

/// Four times the torque that 100 kg and screw need, and 1500 N: `linear_mass` below.
fn linear_torque(acceleration_mm: f64) -> f64 {
    const LEAD_M: f64 = 0.005;
    let per_m = std::f64::consts::TAU / LEAD_M;
    let force = (100.0 + 0.0005 * per_m * per_m) * acceleration_mm * 1e-3 + 1500.0;
    (4.0 * force / per_m).clamp(1.0, 1e5)
}

/// Four times the torque at a gear of 4° a turn of the motor, for 2 kg·m².
fn rotary_torque(acceleration_deg: f64) -> f64 {
    const RATIO: f64 = 90.0;
    let table = (2.0 + 0.0005 * RATIO * RATIO) * acceleration_deg.to_radians() + 20.0;
    (4.0 * table / RATIO).clamp(1.0, 1e5)
}

const LINEAR_MASS: &str = "\
moving_mass_kg = 100
weight_percent = 0                    # the drive holds it
";
const LINEAR_DRIVE: &str = "\
kind = \"ball-screw\"
lead_mm_per_rev = 5
rotating_inertia_kg_m2 = 0.0005
force_lag_ms = 0
brake = false
";
const LINEAR_STRUCTURE: &str = "\
stiffness_n_per_um = 60
damping_ratio = 0.04
";
const LINEAR_FRICTION: &str = "\
bristle_stiffness_n_per_um = 20
bristle_damping_n_s_per_m = 20_000
viscous_n_s_per_m = 600
coulomb_n = 150
static_n = 190
stribeck_speed_mm_per_s = 2
";
const ROTARY_MASS: &str = "moving_inertia_kg_m2 = 2\n";
const ROTARY_DRIVE: &str = "\
gear_deg_per_rev = 4
rotating_inertia_kg_m2 = 0.0005
torque_lag_ms = 0
brake = false
";
const ROTARY_STRUCTURE: &str = "\
stiffness_n_m_per_rad = 1e6
damping_ratio = 0.04
";
const ROTARY_FRICTION: &str = "\
bristle_stiffness_n_m_per_rad = 2e5
bristle_damping_n_m_s_per_rad = 200
viscous_n_m_s_per_rad = 10
coulomb_n_m = 5
static_n_m = 7
stribeck_speed_deg_per_s = 1
";
