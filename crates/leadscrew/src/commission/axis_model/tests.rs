//! The fit on an axis that is integrated here, with finer steps than the model's own.
use super::*;

const T: f64 = 250e-6;

fn truth() -> AxisParameters {
    AxisParameters {
        motor_mass: 1080.0,
        table_mass: 200.0,
        stiffness: 90e6,
        damping: 9300.0,
        play: 1e-6,
        coulomb: 150.0,
        viscous: 600.0,
        weight: 40.0,
        delay: 1e-3,
    }
}

/// Strokes at 60 and 300 mm/s with a swept force on top, and 470 N of noise.
fn recorded(p: &AxisParameters, seed: u64, noise: f64) -> AxisSamples {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut draw = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut samples = AxisSamples { period_s: T, ..AxisSamples::default() };
    let steps = 20;
    let h = T / f64::from(steps);
    let (mut x1, mut v1, mut x2, mut v2) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let mut given = Vec::new();
    let mut phase = 0.0;
    for stroke in 0..16 {
        let sense = if stroke % 2 == 0 { 1.0 } else { -1.0 };
        let speed = if stroke % 4 < 2 { 0.06 } else { 0.3 };
        for n in 0..6000 {
            let t = f64::from(n) * T;
            let swept = 50.0 + 130.0 * t;
            phase += std::f64::consts::TAU * swept * T;
            // a speed loop that knows nothing of the plant
            let swings = if t > 0.4 { phase.sin() } else { 0.0 };
            let force = 1300.0 * 30.0 * (speed * sense - v1) + 1000.0 * swings;
            samples.position.push((x1 / 15e-9).round() * 15e-9);
            given.push(force);
            for _ in 0..steps {
                let ahead = x1 - x2;
                let spring = p.stiffness * (ahead - ahead.clamp(-p.play / 2.0, p.play / 2.0))
                    + p.damping * (v1 - v2);
                let friction = p.coulomb * (v2 / 2e-3).tanh() + p.viscous * v2 + p.weight;
                v1 += h / p.motor_mass * (force - spring);
                v2 += h / p.table_mass * (spring - friction);
                x1 += h * v1;
                x2 += h * v2;
            }
        }
    }
    // a reading is of the force that was given over the period before, and late by four of them
    let read = |n: usize| if n >= 5 { given[n - 5] } else { 0.0 };
    let bell = |u: f64, v: f64| (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos();
    samples.force = (0..given.len()).map(|n| read(n) + noise * bell(draw(), draw())).collect();
    samples
}

fn believed() -> AxisParameters {
    AxisParameters {
        motor_mass: 950.0,
        table_mass: 260.0,
        stiffness: 75e6,
        damping: 7000.0,
        play: 2e-6,
        coulomb: 110.0,
        viscous: 800.0,
        weight: 0.0,
        delay: 0.7e-3,
    }
}

#[test]
fn an_axis_is_found_from_a_file_that_is_wrong_in_everything() {
    let truth = truth();
    let found = fit_axis(&recorded(&truth, 3, 470.0), &believed(), 8e-3).unwrap();
    let p = found.parameters;
    let near = |what: &str, found: f64, real: f64, share: f64| {
        assert!((found / real - 1.0).abs() < share, "{what}: {found}, really {real}");
    };
    near("inertia", p.motor_mass + p.table_mass, 1280.0, 0.01);
    near("Coulomb", p.coulomb, truth.coulomb, 0.05);
    near("viscous", p.viscous, truth.viscous, 0.05);
    near("antiresonance", p.antiresonance_hz(), truth.antiresonance_hz(), 0.01);
    near("stiffness", p.stiffness, truth.stiffness, 0.05);
    near("delay", p.delay, truth.delay, 0.02);
    assert!(found.play_shows && (p.play - truth.play).abs() < 0.5e-6, "{}", p.play);
}

#[test]
fn without_noise_little_is_left() {
    let truth = truth();
    let p = fit_axis(&recorded(&truth, 3, 0.0), &believed(), 8e-3).unwrap().parameters;
    for (what, found, real, within) in [
        ("inertia", p.motor_mass + p.table_mass, 1280.0, 2e-3),
        ("Coulomb", p.coulomb, truth.coulomb, 5e-3),
        ("viscous", p.viscous, truth.viscous, 1e-2),
        ("antiresonance", p.antiresonance_hz(), truth.antiresonance_hz(), 3e-3),
        ("stiffness", p.stiffness, truth.stiffness, 1e-2),
    ] {
        assert!((found / real - 1.0).abs() < within, "{what}: {found}, really {real}");
    }
}

#[test]
fn an_axis_that_has_not_moved_is_not_fitted() {
    let samples = AxisSamples { period_s: T, position: vec![0.0; 9000], force: vec![5.0; 9000] };
    assert!(fit_axis(&samples, &believed(), 8e-3).is_none());
}
