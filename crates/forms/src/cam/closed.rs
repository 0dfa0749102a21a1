//! Cams with a closed form.
//!
//! ```text
//!   eccentric      a circle of radius r, its centre e off the axis          h = r + e·cos φ
//!   harmonic       s = L/2·(1 − cos φ)
//!   lobes          r(φ) = r + a·cos m(φ − φ₀)                               a contour with m lobes
//!   polynomial     rise, dwell, fall and rest with 10u³ − 15u⁴ + 6u⁵        no jump of the acceleration
//!   automotive     s = L·(1 − u²)³, u = (φ − 180°)/β                        base circle outside of ±β
//! ```
use super::error::{CamError, Problem};
use super::lift::{Cam, Follower};
use core::f64::consts::TAU;
use units::{Angle, Length};

/// Nodes of a cam with a closed form: each tenth of a degree.
const NODES: usize = 3600;

/// A cam given by its formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosedForm {
    /// A circle off its axis; any follower gives the same part, a flat one is meant.
    Eccentric {
        /// Radius of the circle.
        radius: Length,
        /// Distance of its centre from the axis; the high point is at φ = 0.
        eccentricity: Length,
    },
    /// A harmonic lift over the whole turn, highest at φ = 180°.
    Harmonic {
        /// Base radius.
        base: Length,
        /// Lift.
        lift: Length,
        /// What runs on it.
        follower: Follower,
    },
    /// Equal lobes of the contour.
    Lobes {
        /// Mean radius.
        radius: Length,
        /// Amplitude.
        amplitude: Length,
        /// How many.
        count: u32,
        /// Angle of a lobe's top.
        phase: Angle,
    },
    /// Rise, dwell, fall and rest by a polynomial of fifth degree; the rise begins at φ = 0.
    Polynomial {
        /// Base radius.
        base: Length,
        /// Lift.
        lift: Length,
        /// Angle of the rise.
        rise: Angle,
        /// Angle at full lift.
        dwell: Angle,
        /// Angle of the fall.
        fall: Angle,
        /// What runs on it.
        follower: Follower,
    },
    /// The lift of an engine's valve, highest at φ = 180°.
    Automotive {
        /// Base radius.
        base: Length,
        /// Lift.
        lift: Length,
        /// β: half of the angle over which the valve is open.
        half_angle: Angle,
        /// What runs on it.
        follower: Follower,
    },
}

impl ClosedForm {
    /// Base radius, follower and lift at an angle in revolutions from 0 to 1.
    fn parts(&self) -> (Length, Follower, Box<dyn Fn(f64) -> f64>) {
        match *self {
            Self::Eccentric { radius, eccentricity } => {
                let e = eccentricity.value();
                (radius - eccentricity, Follower::Flat, Box::new(move |t| e + e * (TAU * t).cos()))
            }
            Self::Harmonic { base, lift, follower } => {
                let half = lift.value() / 2.0;
                (base, follower, Box::new(move |t| half * (1.0 - (TAU * t).cos())))
            }
            Self::Lobes { radius, amplitude, count, phase } => {
                let (a, m, p) = (amplitude.value(), f64::from(count), phase.value());
                let base = radius - amplitude;
                (base, Follower::Knife, Box::new(move |t| a + a * (TAU * m * (t - p)).cos()))
            }
            Self::Polynomial { base, lift, rise, dwell, fall, follower } => {
                let l = lift.value();
                let (rise, dwell, fall) = (rise.value(), dwell.value(), fall.value());
                let law = move |t: f64| {
                    let down = t - rise - dwell;
                    if t < rise {
                        l * smooth(t / rise)
                    } else if down < 0.0 {
                        l
                    } else {
                        l * (1.0 - smooth((down / fall).min(1.0)))
                    }
                };
                (base, follower, Box::new(law))
            }
            Self::Automotive { base, lift, half_angle, follower } => {
                let (l, beta) = (lift.value(), half_angle.value());
                let law = move |t: f64| {
                    let u = (t - 0.5) / beta;
                    if u.abs() < 1.0 { l * (1.0 - u * u).powi(3) } else { 0.0 }
                };
                (base, follower, Box::new(law))
            }
        }
    }

    /// The cam.
    ///
    /// # Errors
    /// A figure makes no cam.
    pub fn cam(&self) -> Result<Cam, CamError> {
        let positive = |what, value: f64| {
            let good = value > 0.0 && value.is_finite();
            if good { Ok(()) } else { Err(CamError::of(Problem::NotPositive { what })) }
        };
        match *self {
            Self::Eccentric { radius, eccentricity } => {
                positive("a radius", radius.value())?;
                positive("an eccentricity", eccentricity.value())?;
            }
            Self::Harmonic { lift, .. } => positive("a lift", lift.value())?,
            Self::Lobes { radius, amplitude, count, phase: _ } => {
                positive("a radius", radius.value())?;
                positive("an amplitude", amplitude.value())?;
                positive("a number of lobes", f64::from(count))?;
            }
            Self::Polynomial { lift, rise, dwell, fall, .. } => {
                positive("a lift", lift.value())?;
                positive("an angle of the rise", rise.value())?;
                positive("an angle of the fall", fall.value())?;
                positive(
                    "a rest, 360° less rise, dwell and fall,",
                    1.0 + 1e-12 - (rise + dwell.abs() + fall).value(),
                )?;
            }
            Self::Automotive { lift, half_angle, .. } => {
                positive("a lift", lift.value())?;
                positive("an opening angle", half_angle.value())?;
                positive("180° less half the opening angle", 0.5 - half_angle.value())?;
            }
        }
        let (base, follower, law) = self.parts();
        positive("a base radius", base.value())?;
        let values: Vec<f64> = (0..NODES).map(|i| law(i as f64 / NODES as f64)).collect();
        Cam::from_nodes(&values, 0.0, base, follower)
    }
}

/// From 0 to 1 without a jump of the second derivative.
fn smooth(u: f64) -> f64 {
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}
