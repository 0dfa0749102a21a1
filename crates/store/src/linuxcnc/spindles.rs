//! Spindles from `[SPINDLE_0]`, `[DISPLAY]`, and what the HAL files connect with `spindle.0.revs`.
use super::hal::Hal;
use super::ini::Ini;
use super::writer::{Cited, MachineWriter, RemarkKind, loops, plain};

/// More than so many are not led.
const MOST: usize = 2;

/// All of them; whether the first one has an encoder.
pub(super) fn write(w: &mut MachineWriter, ini: &Ini, hal: &Hal, period_us: f64) -> bool {
    let stated = w.number(ini, "TRAJ", "SPINDLES").map_or(1.0, |found| found.value);
    let count = (stated.clamp(1.0, 64.0) as usize).min(MOST);
    if stated > MOST as f64 {
        let text =
            format!("{stated} spindles: Leadscrew leads {MOST}, the others stay as they are");
        w.say(RemarkKind::Missing, "spindles", &text);
    }
    let mut all = true;
    for number in 0..count {
        all &= spindle(w, ini, hal, number, period_us);
    }
    all
}

fn spindle(w: &mut MachineWriter, ini: &Ini, hal: &Hal, number: usize, period_us: f64) -> bool {
    let key = format!("spindles.{number}");
    w.section("[[spindles]]", &key);
    let name = if number == 0 { "spindle".to_owned() } else { format!("spindle-{number}") };
    w.line("name", &format!("\"{name}\""), "guess");
    speeds(w, ini, number);
    let has_encoder = encoder(w, hal, number);
    w.say(RemarkKind::Guessed, "", "inertia, torque, friction and loops: only the simulated machine is made of them, the converter has its own");
    w.text += BODY;
    w.section("[spindles.friction]", &format!("{key}.friction"));
    w.text += FRICTION;
    w.section("[spindles.loops]", &format!("{key}.loops"));
    loops(w, 10.0, period_us);
    w.section("[spindles.windows]", &format!("{key}.windows"));
    w.text += WINDOWS;
    w.section("[spindles.drive]", &format!("{key}.drive"));
    w.line("kind", "\"speed\"", "LinuxCNC tells spindles a speed");
    ramps(w, hal);
    w.text += REPEATS;
    orientation(w, hal, number);
    has_encoder
}

fn speeds(w: &mut MachineWriter, ini: &Ini, number: usize) {
    let places = [
        (format!("SPINDLE_{number}"), "MAX_FORWARD_VELOCITY".to_owned()),
        (format!("SPINDLE_{number}"), "MAX_RPM".to_owned()),
        ("DISPLAY".to_owned(), format!("MAX_SPINDLE_{number}_SPEED")),
        ("DISPLAY".to_owned(), "MAX_SPINDLE_SPEED".to_owned()),
        ("SPINDLE".to_owned(), "MAX_RPM".to_owned()),
        ("SPINDLE_9".to_owned(), "MAX_OUTPUT".to_owned()),
    ];
    let found = places.iter().find_map(|(section, key)| w.number(ini, section, key));
    let found = found.filter(|found| (1.0..=500_000.0).contains(&found.value));
    if let Some(Cited { value, from }) = found {
        w.taken("max_rpm", &plain(value), &from);
        w.guessed("tapping_max_rpm", &plain(value.min(3000.0)), "as fast as taps go");
    } else {
        let why = "no [SPINDLE_0]MAX_FORWARD_VELOCITY and no [DISPLAY]MAX_SPINDLE_0_SPEED: its highest speed";
        w.missing("max_rpm", "3000", why);
        w.guessed("tapping_max_rpm", "1000", "until its highest speed is stated");
    }
}

/// Counts a revolution, by what is connected with `revs`.
fn encoder(w: &mut MachineWriter, hal: &Hal, number: usize) -> bool {
    const KEY: &str = "encoder_counts_per_rev";
    let mut pins = vec![format!("spindle.{number}.revs")];
    if number == 0 {
        pins.push("motion.spindle-revs".to_owned());
    }
    let outputs = ["position", "position-interpolated", "pos", "position-fb"];
    let source = pins.iter().flat_map(|pin| hal.beside(pin)).find_map(|(_, other, place)| {
        let (component, pin) = other.rsplit_once('.')?;
        outputs.contains(&pin).then_some((component, pin, place))
    });
    let Some((component, pin, place)) = source else {
        let wired = pins.iter().any(|pin| hal.pins.iter().any(|(_, of, _)| of == pin));
        let why = if wired {
            "what the spindle's revs pin is wired to is no encoder's position: state its counts a revolution"
        } else {
            "no HAL file wires an encoder to the spindle's revs pin: no tapping and no threads without one"
        };
        w.missing(KEY, "4096", why);
        return wired;
    };
    if pin == "position-fb" {
        w.guessed(
            KEY,
            "4096",
            &format!("{component}, {place}, simulates a spindle without counts"),
        );
        return true;
    }
    let scale = ["position-scale", "scale"]
        .into_iter()
        .find_map(|of| Some((of, hal.value(&format!("{component}.{of}"))?)));
    let counts = scale.and_then(|(of, (value, place))| {
        let counts = value.parse::<f64>().ok().filter(|v| v.abs() >= 16.0 && v.abs() <= 4e9)?;
        Some((counts, format!("{place} {component}.{of}")))
    });
    match (counts, scale) {
        (Some((counts, from)), _) => {
            w.taken(KEY, &plain(counts.abs().round()), &from);
            let text = if counts < 0.0 {
                "negative: the encoder counts backwards, and setp keeps that in the HAL file"
            } else {
                "positive: the encoder counts up when the spindle turns forwards"
            };
            w.say(RemarkKind::Taken, KEY, &format!("its sign is {text}"));
        }
        (None, Some((of, (value, place)))) => {
            let why = format!(
                "{place} {component}.{of} {value}: expected 16 counts a revolution or more"
            );
            w.missing(KEY, "4096", &why);
        }
        (None, None) => {
            let why = format!("no HAL file sets {component}.position-scale or {component}.scale");
            w.missing(KEY, "4096", &why);
        }
    }
    true
}

/// Whether the drive orients the spindle by itself: what M19 asks of it and what it answers are
/// both wired.
fn orientation(w: &mut MachineWriter, hal: &Hal, number: usize) {
    let wired = |what: &str| {
        let names = [format!("spindle.{number}.{what}"), format!("motion.spindle-{what}")];
        let names = &names[..if number == 0 { 2 } else { 1 }];
        let found = hal.pins.iter().find(|(_, pin, _)| names.contains(pin));
        found.map(|(_, pin, place)| (pin, place))
    };
    match (wired("orient"), wired("is-oriented")) {
        (Some((pin, place)), Some(_)) => w.taken("orients", "true", &format!("{place} {pin}")),
        (Some((pin, place)), None) => {
            let why = format!(
                "{place} wires {pin}, and nothing answers at is-oriented: M19 is refused until it is wired, and orients = true"
            );
            w.say(RemarkKind::Missing, "orients", &why);
        }
        (None, _) => {}
    }
}

/// Ramps that a HAL file limits speed with.
fn ramps(w: &mut MachineWriter, hal: &Hal) {
    w.line("delay_ms", "10", "guess: scan of a frequency converter");
    let limited = hal.values.iter().rev().find_map(|(name, value, place)| {
        let component = name.strip_suffix(".maxv")?;
        let pin = format!("{component}.in");
        let told = hal.beside(&pin).find_map(|(_, other, _)| match other.as_str() {
            "spindle.0.speed-out" | "motion.spindle-speed-out" => Some(1.0 / 60.0),
            "spindle.0.speed-out-rps" | "motion.spindle-speed-out-rps" => Some(1.0),
            _ => None,
        })?;
        let per_s2 = value.parse::<f64>().ok()? * told;
        (0.1..=1e5).contains(&per_s2).then(|| (per_s2, format!("{place} {name}")))
    });
    for key in ["acceleration_rev_per_s2", "deceleration_rev_per_s2"] {
        match &limited {
            Some((value, from)) => w.taken(key, &plain(*value), from),
            None => w.missing(key, "20", "the ramp that is set in the converter; rev/min of its top speed over 60 and the seconds to it"),
        }
    }
}

const BODY: &str = "\
inertia_kg_m2 = 0.02
peak_torque_n_m = 40
continuous_torque_n_m = 20
peak_power_w = 5000
torque_lag_ms = 1
planned_percent = 80
torque_rise_ms = 6
orient_rpm = 100
orient_rev_per_s2 = 10
";
const FRICTION: &str = "\
coulomb_n_m = 0.3
smoothing_rad_per_s = 1
viscous_n_m_s_per_rad = 0.0012
";
const WINDOWS: &str = "\
at_speed_percent = 5                  # guess: slip
at_rest_rpm = 3                       # guess
oriented_deg = 0.5                    # guess
following_error_stop_deg = 90         # guess
";
const REPEATS: &str = "\
uncertainty_percent = 25              # guess: of the stopping angle, before the first stroke has taught it
repeats_ms = 1.2                      # guess
repeats_percent = 0.2                 # guess
turns_within_um = 25                  # guess
creep_percent = 10                    # guess
";
