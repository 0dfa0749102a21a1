//! A work speed that varies, as a function that a control can superpose: by how much the work is
//! ahead of its even turn.
//!
//! ```text
//!   n(ψ) of even removal ─► time t(ψ) = ∫dψ/n ─► even turn φ = t/T ─► lead g(φ) = ψ − φ, smoothed ─► X(φ) = D(φ + g(φ))
//!
//!   C = φ + g(φ),  X = D(φ + g(φ)):   both follow the even turn φ, so they keep step with each other at any speed
//! ```
//!
//! The planned speed has corners where one limit takes over from another; a drive cannot follow
//! those. Harmonic k of g is taken times exp(−(k·n/f)²), f the frequency up to which the work's
//! drive answers. If smoothing has brought a limit to be exceeded, or the work to turn back, the
//! whole swing is made smaller.
use super::path::WheelPath;
use super::speed::AxisBounds;
use sync::{Periodic, Spectrum};
use units::{Angle, Spin};

/// Parts of the swing that are tried, from all of it to a tenth.
const PARTS: u32 = 10;
/// The work never turns slower than this share of its mean speed.
const SLOWEST: f64 = 0.05;

/// How the work swings about its even turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Rhythm {
    /// By how much it is ahead, at equal steps of the even turn, rev.
    pub lead: Vec<f64>,
    /// Where the wheel's centre belongs then, mm.
    pub centre: Vec<f64>,
    /// Greatest removal rate over its mean: 1 is constant.
    pub peak: f64,
    /// The same at a constant speed.
    pub peak_constant: f64,
}

impl Rhythm {
    /// Speed of the work at equal steps of its own angle, rev/s.
    pub fn speed(&self, mean: Spin) -> Vec<f64> {
        let n = self.lead.len();
        let Ok(lead) = Periodic::new(&self.lead) else { return vec![mean.value(); n] };
        let speed = |k: usize| {
            let psi = k as f64 / n as f64;
            let mut phi = psi;
            for _ in 0..8 {
                let at = lead.at(phi);
                phi -= (phi + at.value - psi) / (1.0 + at.slope);
            }
            (1.0 + lead.at(phi).slope) * mean.value()
        };
        (0..n).map(speed).collect()
    }
}

impl WheelPath {
    /// The swing that removes as evenly as the axes and a drive that answers up to `highest_hz`
    /// allow, at a mean speed.
    pub fn rhythm(&self, mean: Spin, bounds: &AxisBounds, highest_hz: f64) -> Rhythm {
        let n = self.centre.len();
        let even = self.even_removal(mean, bounds);
        let wanted = lead_of(&even.spin);
        let cut = highest_hz / mean.abs().value().max(1e-9);
        let mut spectrum = Spectrum::of(&wanted, usize::MAX);
        for (k, c) in spectrum.harmonics.iter_mut().enumerate() {
            *c = *c * (-(k as f64 / cut).powi(2)).exp();
        }
        let smooth = spectrum.values(n);
        let part = |part: u32| -> Vec<f64> {
            smooth.iter().map(|g| g * f64::from(part) / f64::from(PARTS)).collect()
        };
        let allowed = |lead: &Vec<f64>| self.follows(lead, mean, bounds);
        let lead = (1..=PARTS).rev().map(part).find(allowed).unwrap_or_else(|| vec![0.0; n]);
        let centre = (0..n).map(|k| self.at(Angle::rev(k as f64 / n as f64 + lead[k])).value);
        Rhythm {
            centre: centre.collect(),
            peak: self.removal_peak(&lead),
            peak_constant: even.peak_constant,
            lead,
        }
    }

    /// Whether both axes can.
    fn follows(&self, lead: &[f64], mean: Spin, bounds: &AxisBounds) -> bool {
        let Ok(table) = Periodic::new(lead) else { return false };
        let (n, w) = (lead.len(), mean.abs().value());
        let highest = self.steepest_at(mean);
        (0..n).all(|k| {
            let phi = k as f64 / n as f64;
            let g = table.at(phi);
            let (spin, accel) = ((1.0 + g.slope) * w, g.bend * w * w);
            let jerk = g.jolt * w * w * w;
            let d = self.at(Angle::rev(phi + g.value));
            let x_accel = d.bend * spin * spin + d.slope * accel;
            let x_jerk = d.jolt * spin.powi(3) + 3.0 * d.bend * spin * accel + d.slope * jerk;
            spin >= SLOWEST * w
                && spin <= bounds.spin.value()
                && accel.abs() <= bounds.spin_accel.value()
                && (d.slope * spin).abs() <= bounds.speed.value().max(highest[0])
                && x_accel.abs() <= bounds.accel.value().max(highest[1])
                && x_jerk.abs() <= bounds.jerk.value().max(highest[2])
        })
    }

    /// What X does at a constant speed: no reason to refuse a swing.
    fn steepest_at(&self, mean: Spin) -> [f64; 3] {
        let motion = self.motion(mean);
        [motion.speed.value(), motion.accel.value(), motion.jerk.value()]
    }

    /// Peak over mean of the contact's speed along the contour, over time.
    fn removal_peak(&self, lead: &[f64]) -> f64 {
        let n = lead.len();
        let (Ok(lead), Ok(contact)) = (Periodic::new(lead), Periodic::new(&self.contact)) else {
            return f64::NAN;
        };
        let rate = |k: usize| {
            let phi = k as f64 / n as f64;
            let g = lead.at(phi);
            contact.at(phi + g.value).value * (1.0 + g.slope)
        };
        let (sum, most) =
            (0..n).map(rate).fold((0.0, 0.0), |(sum, most), r| (sum + r, f64::max(most, r)));
        most * n as f64 / sum
    }
}

/// ψ − φ at equal steps of the even turn φ, from the speed at equal steps of ψ.
fn lead_of(spin: &[f64]) -> Vec<f64> {
    let n = spin.len();
    // even turns at which the nodes of ψ are passed: the trapezium of 1/n
    let mut passed = Vec::with_capacity(n + 1);
    let mut time = 0.0;
    passed.push(0.0);
    for k in 0..n {
        time += 0.5 / spin[k] + 0.5 / spin[(k + 1) % n];
        passed.push(time);
    }
    for t in &mut passed {
        *t /= time;
    }
    let mut node = 0;
    let at = |j: usize| {
        let phi = j as f64 / n as f64;
        while passed[node + 1] < phi {
            node += 1;
        }
        let f = (phi - passed[node]) / (passed[node + 1] - passed[node]);
        (node as f64 + f) / n as f64 - phi
    };
    (0..n).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::{ClosedForm, Follower};
    use units::{Accel, Jerk, Length, Speed, SpinAccel};

    const BOUNDS: AxisBounds = AxisBounds {
        speed: Speed::mm_per_s(330.0),
        accel: Accel::mm_per_s2(14_000.0),
        jerk: Jerk::mm_per_s3(800_000.0),
        spin: Spin::rpm(300.0),
        spin_accel: SpinAccel::rev_per_s2(30.0),
    };

    fn automotive() -> WheelPath {
        let form = ClosedForm::Automotive {
            base: Length::mm(34.0),
            lift: Length::mm(9.0),
            half_angle: Angle::deg(65.0),
            follower: Follower::Flat,
        };
        form.cam().unwrap().wheel_path(Length::mm(200.0), 720).unwrap()
    }

    #[test]
    fn a_speed_that_is_one_over_a_cosine_leads_by_its_integral() {
        // dφ/dψ = 1 + a·cos ψ  ⇒  φ = ψ + a/2π·sin ψ, so the lead at φ(ψ) is −a/2π·sin ψ
        use std::f64::consts::TAU;
        let (n, a) = (720_u32, 0.4);
        let spin: Vec<f64> =
            (0..n).map(|k| 1.0 / (1.0 + a * (TAU * f64::from(k) / f64::from(n)).cos())).collect();
        let lead = Periodic::new(&lead_of(&spin)).unwrap();
        for k in 0..100 {
            let psi = f64::from(k) / 100.0;
            let ahead = -a / TAU * (TAU * psi).sin();
            assert!((lead.at(psi - ahead).value - ahead).abs() < 1e-5, "{psi}");
        }
    }

    #[test]
    fn the_swing_removes_more_evenly_and_both_axes_can_follow_it() {
        let path = automotive();
        let rhythm = path.rhythm(Spin::rpm(30.0), &BOUNDS, 15.0);
        assert!(
            rhythm.peak < 1.2 && rhythm.peak_constant > 1.5,
            "{} {}",
            rhythm.peak,
            rhythm.peak_constant
        );
        assert!(path.follows(&rhythm.lead, Spin::rpm(30.0), &BOUNDS));
        // X belongs where the profile has it at the angle at which the work stands
        for (k, (lead, x)) in rhythm.lead.iter().zip(&rhythm.centre).enumerate() {
            let at = path.at(Angle::rev(k as f64 / 720.0 + lead)).value;
            assert!((at - x).abs() < 1e-9);
        }
    }

    #[test]
    fn a_round_part_is_turned_evenly() {
        let form =
            ClosedForm::Eccentric { radius: Length::mm(25.0), eccentricity: Length::mm(1e-6) };
        let path = form.cam().unwrap().wheel_path(Length::mm(200.0), 720).unwrap();
        let rhythm = path.rhythm(Spin::rpm(60.0), &BOUNDS, 15.0);
        assert!(rhythm.lead.iter().all(|g| g.abs() < 1e-6));
    }
}
