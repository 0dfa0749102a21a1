//! What a report says of a run beside what was recorded and judged: names, figures, limits, words.
use canon::{Position, ToolLibrary};
use std::collections::BTreeMap;
use units::{Angle, Length, Power, Spin, Time, Torque};
use verify::Tolerances;

/// A run, as the report tells it. All texts are taken literally: none of them can become markup.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Version of Leadscrew.
    pub version: String,
    /// Name of the program.
    pub program: String,
    /// Name of the machine.
    pub machine: String,
    /// Dialect the program was read in.
    pub dialect: String,
    /// Material of the work.
    pub material: String,
    /// Seed of the simulated world.
    pub seed: u64,
    /// Tools the program could call.
    pub tools: ToolLibrary,
    /// Where coordinates are counted from in the report: the work offset in force. `None`: machine
    /// zero.
    pub origin: Option<Origin>,
    /// From start to end.
    pub cycle_time: Time,
    /// The program came to its end.
    pub ended: bool,
    /// Alarms of the machine, in order.
    pub alarms: Vec<Alarm>,
    /// What a reader must know to trust the rest: stand-in tools, holes taken as drilled before.
    pub notes: Vec<Note>,
    /// What the workpiece was judged by.
    pub tolerances: Tolerances,
    /// What the machine can, for the pictures.
    pub limits: Limits,
    /// What kept a tap from being faster, in words, by the index of its op.
    pub limiting: BTreeMap<u32, String>,
    /// Stops in a thread, and the ways out.
    pub stops: Vec<crate::ThreadStop>,
    /// How long it was planned to move; `None`: the planner was not asked.
    pub motion: Option<Motion>,
    /// The program's text, for the listing; empty: there is none.
    pub listing: Vec<u8>,
}

/// Planned time in motion, and what it would be if no axis had a limit of jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// With the machine's limits.
    pub planned: Time,
    /// Without those of jerk; `None`: there are none.
    pub without_jerk: Option<Time>,
}

/// The zero of the coordinates shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// What the program calls it, such as "G54".
    pub name: String,
    /// Where it lies, in machine coordinates; its Z is where the *tip* of a tool stands at Z0.
    pub at: Position,
}

/// An alarm of the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Alarm {
    /// Its number.
    pub number: u32,
    /// What happened.
    pub text: String,
    /// What to do about it, if that is known.
    pub remedy: Option<String>,
    /// Program line; 0 where there is none.
    pub line: u32,
    /// When.
    pub time: Time,
}

/// Something to know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// It is likely to hurt.
    pub warning: bool,
    /// What.
    pub text: String,
    /// Program line; 0 where there is none.
    pub line: u32,
}

/// What the machine can.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Largest torque of the spindle's drive over its speed: points with rising speed, straight
    /// between.
    pub torque: Vec<(Spin, Torque)>,
    /// Synchronisation error that warns.
    pub sync_warn: Length,
    /// Synchronisation error that stops.
    pub sync_stop: Length,
}

impl Limits {
    /// The torque curve of a drive that gives a peak torque, and a peak power from its base speed
    /// on:
    ///
    /// ```text
    ///   M │──────╮               M(n) = min(Mpeak, Ppeak / 2πn)
    ///     │       ╲__
    ///     └───────────── n
    /// ```
    pub fn torque_curve(peak: Torque, power: Power, most: Spin) -> Vec<(Spin, Torque)> {
        let base = Spin::rev_per_s(power.value() / (peak.value() * Angle::rev(1.0).in_rad()));
        let mut curve = vec![(Spin::ZERO, peak)];
        if !(base.is_finite() && base < most) {
            curve.push((most, peak));
            return curve;
        }
        let steps = 48;
        for i in 0..=steps {
            let ratio = f64::powf(most / base, f64::from(i) / f64::from(steps));
            curve.push((base * ratio, peak / ratio));
        }
        curve
    }

    /// The torque curve from rest up to a speed, which ends it wherever it lies between two of its
    /// points.
    pub(crate) fn torque_up_to(&self, spin: Spin) -> Vec<(Spin, Torque)> {
        let below = self.torque.iter().copied().filter(|(speed, _)| *speed < spin);
        let last = self.torque_at(spin).map(|torque| (spin, torque));
        below.chain(last).collect()
    }

    /// Largest torque at a speed, either sense; `None` without a curve or beyond its end.
    pub(crate) fn torque_at(&self, spin: Spin) -> Option<Torque> {
        let spin = spin.abs();
        let next = self.torque.iter().position(|&(s, _)| s >= spin)?;
        let (s1, m1) = self.torque[next];
        let (s0, m0) = self.torque[next.saturating_sub(1)];
        let share = if s1 > s0 { (spin - s0) / (s1 - s0) } else { 0.0 };
        Some(m0 + (m1 - m0) * share)
    }
}

impl Run {
    /// What this tool is, for people.
    pub(crate) fn tool(&self, number: u32) -> String {
        if number == 0 {
            return "no tool".into();
        }
        match self.tools.get(number) {
            Some(tool) if !tool.description.is_empty() => format!("T{number} {}", tool.description),
            _ => format!("T{number}"),
        }
    }

    /// Where the coordinates shown are counted from.
    pub(crate) fn zero(&self) -> [f64; 3] {
        self.origin.as_ref().map_or([0.0; 3], |o| o.at.linear.map(Length::value))
    }

    /// How the coordinates shown are called.
    pub(crate) fn frame(&self) -> &str {
        self.origin.as_ref().map_or("machine coordinates", |o| &o.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_curve_is_flat_up_to_the_base_speed_and_a_hyperbola_beyond() {
        let torque =
            Limits::torque_curve(Torque::n_m(42.0), Power::w(15_000.0), Spin::rpm(10_000.0));
        let limits = Limits { torque, sync_warn: Length::um(20.0), sync_stop: Length::um(50.0) };
        let at = |rpm: f64| limits.torque_at(Spin::rpm(rpm)).map(Torque::value);
        assert_eq!(at(0.0), Some(42.0));
        assert_eq!(at(-3000.0), Some(42.0));
        // P = M·2πn: 15 kW at 6000 rpm are 15000 / (2π·100) N·m
        let exact = 15_000.0 / (std::f64::consts::TAU * 100.0);
        assert!((at(6000.0).expect("within the curve") - exact).abs() < 0.01 * exact);
        assert_eq!(at(10_001.0), None);
        // slower than the base speed: flat, and as long as what is asked for
        let slow = limits.torque_up_to(Spin::rpm(1300.0));
        let slow: Vec<_> = slow.iter().map(|(n, m)| (n.in_rpm().round(), m.value())).collect();
        assert_eq!(slow, [(0.0, 42.0), (1300.0, 42.0)]);
    }
}
