//! What a slide makes of a small swing of its motor: a mass behind a screw's spring, held by the
//! friction of its guides.
//!
//! ```text
//!   motor A·cos ωt ──/\/\──┤b├── m ──▒▒▒ guide            G = K/(K + N − m·ω² + jω·c)
//!                     k    play        σ0, Fc
//!
//!   K  of the spring, as far as the motor's way is more than the play: k·(1 − (2/π)·(asin ρ + ρ·√(1−ρ²))), ρ = b/2/R
//!   N  of the guide: σ0 while it only bends, A ≤ d = Fc/σ0; beyond, with cos θ = 1 − 2d/A,
//!      σ0/π·(θ − ½·sin 2θ) + j·(4·Fc/(π·A))·(1 − d/A)
//! ```
//!
//! These are describing functions: gain and phase of what has the frequency of the swing. Far below
//! a micrometre's play the slide does not go along at all; up to some micrometres its guides hold
//! it like a second spring; only farther does it swing by itself near its natural frequency. How
//! far the motor swings, R apart from the slide, is found by repetition. A motor's encoder sees
//! nothing of this.
use std::f64::consts::{PI, TAU};
use store::machine::Axis;
use sync::Complex;

/// Repetitions until the amplitudes have settled.
const REPETITIONS: usize = 60;

/// Linear in what a swing makes of it, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    mass: f64,
    damping: f64,
    viscous: f64,
    /// Of the screw alone, and behind its play.
    stiffness: f64,
    spring: f64,
    guide: Complex,
    /// Share of the bending of the guide's bristles in its damping.
    bent: f64,
    bristle_damping: f64,
}

impl Slide {
    /// For a motor that swings at a frequency in Hz with an amplitude in mm.
    pub fn swinging(axis: &Axis, frequency: f64, amplitude_mm: f64) -> Self {
        let stiffness = axis.structure.stiffness.value() * 1e3;
        let (mass, motor) = (axis.moving_mass.value(), axis.drive.motor_mass().value());
        let sent = amplitude_mm.max(0.0) * 1e-3;
        let friction = &axis.friction;
        let reduced = mass * motor / (mass + motor);
        let damping = 2.0 * axis.structure.damping_ratio * (stiffness * reduced).sqrt();
        let mut slide = Self {
            mass,
            damping,
            viscous: friction.viscous_n_s_per_m,
            stiffness,
            spring: stiffness,
            guide: Complex::default(),
            bent: 0.0,
            bristle_damping: friction.bristle_damping_n_s_per_m,
        };
        let [mut swing, mut apart] = [sent, sent];
        for _ in 0..REPETITIONS {
            let bristles = friction.bristle_stiffness.value() * 1e3;
            slide.guide = guide(bristles, friction.coulomb.value(), swing);
            slide.bent = if bristles > 0.0 { slide.guide.re / bristles } else { 0.0 };
            slide.spring = stiffness * through(axis.structure.backlash.value() * 1e-3 / 2.0, apart);
            let answer = slide.answer(frequency);
            let (size, rest) = ((answer * sent).size(), ((Complex::ONE - answer) * sent).size());
            (swing, apart) = (f64::midpoint(swing, size), f64::midpoint(apart, rest));
        }
        slide
    }

    /// Another one, with so many times the stiffness, friction and play.
    #[must_use]
    pub fn with(&self, [stiffness, friction, play]: [f64; 3]) -> Self {
        // behind the play as much less is left as it takes
        let taken = 1.0 - (1.0 - self.spring / self.stiffness) * play;
        Self {
            stiffness: self.stiffness * stiffness,
            spring: self.stiffness * stiffness * taken.max(1e-6),
            guide: self.guide * friction,
            ..*self
        }
    }

    /// G at a frequency in Hz, of this swing or of what is superposed on it.
    pub fn answer(&self, frequency: f64) -> Complex {
        let pull = self.pull(frequency);
        pull / (pull + self.held(frequency))
    }

    /// Force on the screw that a swing of one takes.
    pub fn held(&self, frequency: f64) -> Complex {
        let w = TAU * frequency;
        self.guide(frequency) - Complex { re: self.mass * w * w, im: 0.0 }
    }

    /// Force of the guide against a swing of one.
    pub fn guide(&self, frequency: f64) -> Complex {
        let w = TAU * frequency;
        let lost = w * (self.viscous + self.bent * self.bristle_damping);
        Complex { re: self.guide.re, im: self.guide.im + lost }
    }

    /// The screw's stretch in a swing of one, by its spring and play.
    pub fn stretch(&self, frequency: f64) -> Complex {
        self.held(frequency) / Complex { re: self.spring, im: 0.0 }
    }

    /// Of the screw, N/m.
    pub const fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn pull(&self, frequency: f64) -> Complex {
        Complex { re: self.spring, im: TAU * frequency * self.damping }
    }
}

/// Of a guide that bends like a spring up to Fc, and slides.
fn guide(bristles: f64, coulomb: f64, amplitude: f64) -> Complex {
    let reach = coulomb / bristles.max(1e-9);
    if amplitude <= reach {
        return Complex { re: bristles, im: 0.0 };
    }
    let angle = (1.0 - 2.0 * reach / amplitude).acos();
    Complex {
        re: bristles / PI * (angle - 0.5 * (2.0 * angle).sin()),
        im: 4.0 * coulomb / (PI * amplitude) * (1.0 - reach / amplitude),
    }
}

/// Share of a spring's stiffness that is left behind a play, each way, of a way.
fn through(play: f64, way: f64) -> f64 {
    if play <= 0.0 {
        return 1.0;
    }
    let share = (play / way.max(1e-12)).min(1.0);
    1.0 - 2.0 / PI * (share.asin() + share * (1.0 - share * share).sqrt())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test may panic
    use super::*;

    /// X of the embedded lathe.
    fn x() -> Axis {
        let machine = crate::config::machine_file::load("polygon-lathe").unwrap();
        machine.axes.iter().flatten().find(|axis| axis.letter == canon::Axis::X).unwrap().clone()
    }

    /// The same motion in time: LuGre friction, play and spring in small steps, its fundamental
    /// after it has settled.
    fn in_time(axis: &Axis, frequency: f64, amplitude_mm: f64) -> Complex {
        const STEPS: usize = 40_000;
        let (k, m) = (axis.structure.stiffness.value() * 1e3, axis.moving_mass.value());
        let motor_mass = axis.drive.motor_mass().value();
        let c = 2.0 * axis.structure.damping_ratio * (k * m * motor_mass / (m + motor_mass)).sqrt();
        let half = axis.structure.backlash.value() * 1e-3 / 2.0;
        let f = &axis.friction;
        let (sent, w) = (amplitude_mm * 1e-3, TAU * frequency);
        let h = 1.0 / frequency / STEPS as f64;
        let (mut x, mut v, mut z) = (0.0, 0.0, 0.0);
        let mut sum = Complex::default();
        let turns = 12;
        for step in 0..turns * STEPS {
            let angle = w * h * step as f64;
            let (motor, rate) = (sent * angle.cos(), -sent * w * angle.sin());
            let gap: f64 = motor - x;
            let pull = k * (gap - gap.clamp(-half, half)) + c * (rate - v);
            let vs = f.stribeck_speed.value() * 1e-3;
            let extra = (f.static_force - f.coulomb).value();
            let slip = f.coulomb.value() + extra * (-(v / vs) * (v / vs)).exp();
            let bristles = f.bristle_stiffness.value() * 1e3;
            let bend = v - bristles * f64::abs(v) * z / slip;
            z += h * bend;
            let friction =
                bristles * z + f.bristle_damping_n_s_per_m * bend + f.viscous_n_s_per_m * v;
            v += h * (pull - friction) / m;
            x += h * v;
            if step >= (turns - 4) * STEPS {
                sum = sum + Complex { re: angle.cos(), im: -angle.sin() } * x;
            }
        }
        sum * (2.0 / (4 * STEPS) as f64 / sent)
    }

    #[test]
    fn gain_and_phase_are_about_those_of_the_motion_in_time() {
        let x = x();
        for (frequency, amplitude_mm) in
            [(50.0, 0.014), (80.0, 0.0035), (100.0, 0.0018), (20.0, 0.2)]
        {
            let told = Slide::swinging(&x, frequency, amplitude_mm).answer(frequency);
            let real = in_time(&x, frequency, amplitude_mm);
            println!("{frequency} Hz, {amplitude_mm} mm: {told:?}, in time {real:?}");
            assert!((told - real).size() < 0.25 * real.size().max(0.5), "{told:?} {real:?}");
        }
    }

    #[test]
    fn a_slide_far_from_its_limits_is_a_mass_on_a_spring() {
        // 1/(1 − r²), r = 10 Hz of 112.5
        let gain = Slide::swinging(&x(), 10.0, 20.0).answer(10.0).size();
        let r = 10.0 / 112.54;
        assert!((gain - 1.0 / (1.0 - r * r)).abs() < 1e-3, "{gain}");
    }
}
