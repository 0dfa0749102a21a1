//! What the planner knows of cams: the profiles, and what is sent instead of them where it has been
//! compensated.
use alloc::vec::Vec;
use canon::{CamLibrary, CamProfile};
use units::{Length, Spin};

/// The number by which a step asks what runs the kernel to look at the turn of a cam that has
/// just ended.
pub const TURN_ENDED: u16 = 151;

/// A compensated table of one profile at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct CamCommand {
    /// The profile.
    pub profile: u32,
    /// Speed of the work.
    pub spin: Spin,
    /// What is sent, at equal steps of the work's even turn, mm.
    pub nodes: Vec<f64>,
}

/// How one profile is sent at one speed without compensation, where that is not the profile as it
/// stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The profile.
    pub profile: u32,
    /// Mean speed of the work.
    pub spin: Spin,
    /// By how much the work is ahead of its even turn φ, at equal steps of that turn, rev: θ = φ +
    /// lead(φ). `None`: it turns evenly.
    pub lead: Option<Vec<f64>>,
    /// Where the wheel's centre belongs, at equal steps of the even turn, mm.
    pub nodes: Vec<f64>,
}

/// How the wheel wears: its radius loses, in a turn that takes the depth s off a work of the mean
/// radius r, s·r/(G·R).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelWear {
    /// R.
    pub radius: Length,
    /// G, volume of work ground for a volume of wheel lost.
    pub ratio: f64,
}

impl WheelWear {
    /// What the radius loses while so much is ground off a profile: the volumes over the width that
    /// both have in common.
    pub fn of(&self, profile: &CamProfile, stock: Length) -> Length {
        let count = profile.nodes.len().max(1) as f64;
        let mean = profile.nodes.iter().sum::<f64>() / count - profile.wheel.value();
        stock * (mean.max(0.0) / (self.ratio * self.radius.value()))
    }
}

/// Profiles and compensations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cams {
    /// What is sent without compensation where that is not the profile itself.
    pub courses: Vec<Course>,
    /// The profiles that programs may call.
    pub library: CamLibrary,
    /// What is sent with compensation on.
    pub commands: Vec<CamCommand>,
    /// How the wheel wears; `None`: as if it did not.
    pub wear: Option<WheelWear>,
}

impl Cams {
    /// What is sent of a profile at a speed with compensation on; `None`: it has not been measured.
    pub fn command(&self, profile: u32, spin: Spin) -> Option<&CamCommand> {
        let same =
            |c: &&CamCommand| c.profile == profile && (c.spin - spin).abs() <= spin.abs() * 1e-9;
        self.commands.iter().rev().find(same)
    }

    /// How a profile is sent at a speed without compensation; `None`: as it stands.
    pub fn course(&self, profile: u32, spin: Spin) -> Option<&Course> {
        let same = |c: &&Course| c.profile == profile && (c.spin - spin).abs() <= spin.abs() * 1e-9;
        self.courses.iter().find(same)
    }

    /// Keep what is sent from here on.
    pub fn set(&mut self, command: CamCommand) {
        self.commands.retain(|c| c.profile != command.profile || c.spin != command.spin);
        self.commands.push(command);
    }
}

/// Node values of the same function later by a part of a turn: a cubic through the four nodes
/// around.
pub fn turned(nodes: &[f64], turn: f64) -> Vec<f64> {
    let n = nodes.len();
    let by = (turn - libm::floor(turn)) * n as f64;
    let (whole, f) = (libm::floor(by) as usize, by - libm::floor(by));
    let at = |i: usize, back: usize| nodes[(i + 2 * n - whole - back) % n];
    let value = |i: usize| {
        if f == 0.0 {
            return at(i, 0);
        }
        // between the node before, at the fraction f back from here
        let (a, b, c, d) = (at(i, 2), at(i, 1), at(i, 0), nodes[(i + 2 * n - whole + 1) % n]);
        let g = 1.0 - f;
        -g * (g - 1.0) * (g - 2.0) / 6.0 * a + (g + 1.0) * (g - 1.0) * (g - 2.0) / 2.0 * b
            - (g + 1.0) * g * (g - 2.0) / 2.0 * c
            + (g + 1.0) * g * (g - 1.0) / 6.0 * d
    };
    (0..n).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    fn wave(phase: f64) -> Vec<f64> {
        (0..720).map(|i| libm::cos(TAU * (3.0 * f64::from(i) / 720.0 - phase))).collect()
    }

    #[test]
    fn a_profile_turned_on_its_shaft_comes_later_by_that_angle() {
        for turn in [0.0, 1.0 / 720.0, 0.1234, -0.25, 7.3] {
            let expected = wave(3.0 * turn);
            for (a, b) in turned(&wave(0.0), turn).iter().zip(&expected) {
                assert!((a - b).abs() < 1e-7, "{turn}: {a} {b}");
            }
        }
    }
}
