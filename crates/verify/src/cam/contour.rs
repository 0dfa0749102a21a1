//! The figures of a ground contour: its errors at equal steps of the turn against the profile that
//! was asked.
//!
//! ```text
//!   x, D at each step ─► e = x − centre − D ─► largest, rms, phase, run-out, waviness
//!   D, R, speed ──────► (ds/dθ)·ω ───────────► removal rate, peak over mean
//! ```
use super::{GroundCam, STEPS};
use canon::CamProfile;
use std::f64::consts::TAU;
use units::{Angle, Length};

/// How near to its lowest point the profile is on the base circle, mm.
const BASE: f64 = 0.5e-3;
/// Waves a turn in which chatter shows.
const CHATTER: std::ops::RangeInclusive<usize> = 30..=180;

/// Where the wheel's edge came nearest to the work's axis at each step, and the speed of the work
/// there.
pub(super) struct Contour<'a> {
    /// mm.
    pub(super) nearest: &'a [f64],
    /// rev/s.
    pub(super) spins: &'a [f64],
}

impl Contour<'_> {
    /// The figures of a contour whose work's axis stands at `centre`.
    pub(super) fn measure(&self, cam: &mut GroundCam, profile: &CamProfile, centre: Length) {
        let ideal: Vec<f64> = (0..STEPS).map(|step| asked(profile, step)).collect();
        let errors: Vec<f64> =
            self.nearest.iter().zip(&ideal).map(|(x, d)| x - centre.value() - d).collect();
        let n = STEPS as f64;
        let mean = errors.iter().sum::<f64>() / n;
        let (mut lag, mut steep) = (0.0, 0.0);
        let mut speed: f64 = 0.0;
        for i in 0..STEPS {
            let slope = around(&ideal, i) * n;
            lag -= (errors[i] - mean) * slope;
            steep += slope * slope;
            speed = speed.max(around(&errors, i).abs() * n / 360.0);
        }
        cam.name.clone_from(&profile.name);
        cam.phase_error = Angle::rev(if steep > 0.0 { lag / steep } else { 0.0 });
        cam.contour_error_max = Length::mm(errors.iter().fold(0.0, |a: f64, e| a.max(e.abs())));
        cam.contour_error_rms = Length::mm((errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt());
        cam.run_out = run_out(&ideal, &errors);
        cam.speed_error_per_deg = Length::mm(speed);
        let waves = CHATTER.map(|k| (amplitude(&errors, k), k));
        let (size, k) = waves.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
        cam.waviness = (Length::mm(size), k);
        let along = contact_speed(&ideal, profile.wheel.value());
        cam.removal_peak = peak_over_mean(&along, self.spins);
        cam.removal_peak_even = peak_over_mean(&along, &[1.0; STEPS]);
        let lowest = ideal.iter().copied().fold(f64::INFINITY, f64::min);
        cam.errors = errors.into_iter().map(Length::mm).collect();
        cam.lift = ideal.into_iter().map(|d| Length::mm(d - lowest)).collect();
    }
}

/// The cubic through four values at −1, 0, 1, 2.
pub(super) fn lagrange([a, b, c, d]: [f64; 4], f: f64) -> f64 {
    -f * (f - 1.0) * (f - 2.0) / 6.0 * a + (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0 * b
        - (f + 1.0) * f * (f - 2.0) / 2.0 * c
        + (f + 1.0) * f * (f - 1.0) / 6.0 * d
}

/// Where the wheel's edge is asked to come nearest to the axis, by steps of the work's turn, mm.
pub(super) fn asked_over(profile: &CamProfile, centre: Length, shift: usize) -> Vec<f64> {
    let at = |k: usize| centre.value() + asked(profile, (k + STEPS - shift) % STEPS);
    (0..STEPS).map(at).collect()
}

/// A profile's value at a step, whatever its own number of nodes.
fn asked(profile: &CamProfile, step: usize) -> f64 {
    let n = profile.nodes.len();
    let place = step as f64 / STEPS as f64 * n as f64;
    let (whole, f) = (place as usize, place.fract());
    let at = |k: usize| profile.nodes[(whole + n + k - 1) % n];
    lagrange([at(0), at(1), at(2), at(3)], f)
}

/// Half the difference of the neighbours, around the turn.
fn around(v: &[f64], i: usize) -> f64 {
    (v[(i + 1) % STEPS] - v[(i + STEPS - 1) % STEPS]) / 2.0
}

/// Spread of the error on the base circle: a stretch of at least an eighth of a turn; a lobe has
/// none.
fn run_out(ideal: &[f64], errors: &[f64]) -> Option<Length> {
    let lowest = ideal.iter().copied().fold(f64::INFINITY, f64::min);
    let base: Vec<f64> =
        errors.iter().zip(ideal).filter(|(_, d)| **d < lowest + BASE).map(|(e, _)| *e).collect();
    (base.len() >= STEPS / 8).then(|| {
        let (low, high) = base
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(*e), b.max(*e)));
        Length::mm(high - low)
    })
}

/// How fast the contact runs along the contour, mm for each radian of the work's turn.
fn contact_speed(path: &[f64], wheel: f64) -> Vec<f64> {
    let step = TAU / STEPS as f64;
    let speed = |i: usize| {
        let d = path[i];
        let slope = around(path, i) / step;
        let bend =
            (path[(i + 1) % STEPS] - 2.0 * d + path[(i + STEPS - 1) % STEPS]) / (step * step);
        let squared = d * d + slope * slope;
        let turning = 1.0 + (slope * slope - d * bend) / squared;
        squared.sqrt() - wheel * turning
    };
    (0..STEPS).map(speed).collect()
}

/// Of the contact's speed while the work turns at these speeds: the mean is over time.
fn peak_over_mean(along: &[f64], spins: &[f64]) -> f64 {
    let most = along.iter().zip(spins).map(|(a, s)| (a * s).abs()).fold(0.0, f64::max);
    let way: f64 = along.iter().map(|a| a.abs()).sum();
    let time: f64 = spins.iter().map(|s| 1.0 / s.abs()).sum();
    most * time / way
}

/// Amplitude of the wave with k periods a turn.
fn amplitude(values: &[f64], k: usize) -> f64 {
    let n = values.len() as f64;
    let (re, im) = values.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, v)| {
        let (sin, cos) = (TAU * (k * i) as f64 / n).sin_cos();
        (re + v * cos, im + v * sin)
    });
    2.0 * re.hypot(im) / n
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of radius 220 about a point 4 mm off: the contact runs at its constant radius R
    /// where the wheel's centre is led along the crank's equation; peak over mean follows from the
    /// angle at which the work stands.
    #[test]
    fn the_removal_rate_of_an_eccentric_turned_evenly_peaks_as_its_geometry_says() {
        let (e, pitch, wheel) = (4.0, 220.0_f64, 195.0);
        let path: Vec<f64> = (0..STEPS)
            .map(|i| {
                let (sin, cos) = (TAU * i as f64 / STEPS as f64).sin_cos();
                e * cos + (pitch * pitch - (e * sin).powi(2)).sqrt()
            })
            .collect();
        let along = contact_speed(&path, wheel);
        for (i, speed) in along.iter().enumerate() {
            // the centre of the circle, seen from the wheel's: α = ψ + asin(e/p·sin ψ), so ds = (p
            // − R)·dα
            let (sin, cos) = (TAU * i as f64 / STEPS as f64).sin_cos();
            let turning = 1.0 + e * cos / (pitch * pitch - (e * sin).powi(2)).sqrt();
            assert!((speed / ((pitch - wheel) * turning) - 1.0).abs() < 1e-3, "{i}: {speed}");
        }
        let peak = peak_over_mean(&along, &[1.0; STEPS]);
        assert!((peak - (1.0 + e / pitch)).abs() < 1e-3, "{peak}");
        // turned inversely to that speed it is even
        let inverse: Vec<f64> = along.iter().map(|a| 100.0 / a).collect();
        assert!((peak_over_mean(&along, &inverse) - 1.0).abs() < 1e-9);
    }
}
