//! Whether a tap leaves along its coupling at all: looked at before anything moves.
//!
//! ```text
//!      tip ──┐                     above the work by more than the holder gives: nothing holds it, straight out
//!   ▔▔▔▔▔▔▔▔▔│▔▔▔▔▔▔ surface       within that, and off the coupling by more: not in its thread, straight out
//!            ▼                     in the work: along the coupling, if a whole tap can be so far off it
//! ```
//!
//! To bring a tap that stands over the work back onto its coupling could mean to push it into the
//! work at a wrong angle. And a tap that is further off its coupling than holder and core bear is
//! no longer the whole tap of the record: it broke, or what was stored or read is wrong. That is
//! refused.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | k, D | stiffness of the holder, nominal diameter | N/mm, mm |
//! | σ | what the core, 0.6·D, bears in pure tension: √3·1000 N/mm² | N/mm² |
//! | F = σ·π/4·(0.6·D)² | what tears the core | N |
//! | s, kₑ | travel of a holder that gives, and stiffness at its end: 20 kN/mm, as a rigid holder has | mm, N/mm |
//! | F/k, or s + (F − k·s)/kₑ where that is less | how far off its coupling a tap is when its core tears | mm |
use crate::recovery::{Point, Refusal, Stored};
use units::{Length, Stiffness};

/// Core of a tap over its nominal diameter, and what it bears, N/mm²: high-speed steel, from known
/// break torques.
const CORE: f64 = 0.6;
const SHEAR_N_PER_MM2: f64 = 1000.0;
/// From here on a holder is stiff: an error of a tenth of a millimetre presses with half a
/// kilonewton.
const STIFF: Stiffness = Stiffness::n_per_mm(5000.0);
/// Stiffness of a holder at the end of its travel.
const AT_END: Stiffness = Stiffness::n_per_mm(20_000.0);
/// With so many leads in the work the chamfer is in: before, few teeth hold, and the tap tears at
/// them instead.
const CHAMFER: f64 = 3.0;
/// How far a tap can stand out of a stiff holder that is pulled, and out of one that gives.
const GIVE: (Length, Length) = (Length::mm(0.1), Length::mm(1.0));

/// Work and tool, as far as leaving needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Coordinate of the follower at which the tip touches the work.
    pub surface: Length,
    /// Stiffness of the holder along the axis.
    pub holder: Stiffness,
    /// How far it gives to each side; zero: it is a spring all the way.
    pub travel: Length,
    /// Nominal diameter of the tap.
    pub diameter: Length,
}

/// The way out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Back onto the coupling, then along it.
    Along,
    /// The follower alone: the tap is in no thread.
    Straight,
}

impl Setting {
    /// The holder presses a tap hard that is off its coupling.
    pub fn is_stiff(&self) -> bool {
        self.holder >= STIFF
    }

    /// How far a tap in its thread can stand out of its holder.
    fn give(&self) -> Length {
        if self.is_stiff() { GIVE.0 } else { GIVE.1 }
    }

    /// A tap whose tip is so deep, below zero over the work, is out of it whatever its angle.
    pub fn is_in_air(&self, depth: Length) -> bool {
        depth < -self.give()
    }

    /// How far off its coupling a tap is when its core tears.
    pub fn bears(&self) -> Length {
        let core = CORE * self.diameter.value();
        let force = libm::sqrt(3.0) * SHEAR_N_PER_MM2 * core::f64::consts::FRAC_PI_4 * core * core;
        let (k, s) = (self.holder.value().max(f64::MIN_POSITIVE), self.travel.value());
        let within = force / k;
        let is_at_end = s > 0.0 && s < within;
        Length::mm(if is_at_end { s + (force - k * s) / AT_END.value() } else { within })
    }
}

impl Stored {
    /// How a tap leaves the work from here.
    ///
    /// # Errors
    /// A reading is no number, or no whole tap can be so far off its coupling.
    pub fn leaving(&self, at: Point, setting: &Setting) -> Result<Leaving, Refusal> {
        if !(at.angle.is_finite() && at.place.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        let depth = (at.place - setting.surface) * self.inward();
        let (error, give) = (self.error(at).abs(), setting.give());
        if setting.is_in_air(depth) || depth <= Length::ZERO && error > give {
            return Ok(Leaving::Straight);
        }
        let bears = setting.bears();
        let lead = Length::mm(self.lead().value().abs());
        if error > bears && depth > lead * CHAMFER {
            return Err(Refusal::BeyondTap { error, bears });
        }
        Ok(Leaving::Along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::Direction;
    use units::Angle;

    const RIGID_M8: Setting = Setting {
        surface: Length::ZERO,
        holder: Stiffness::n_per_mm(20_000.0),
        travel: Length::ZERO,
        diameter: Length::mm(8.0),
    };

    /// √3·1000·π/4·1.8² = 4407 N: 0.5 mm of spring take 250 of them, and the stop the rest in 0.208
    /// mm.
    #[test]
    fn a_holder_that_gives_is_stiff_at_the_end_of_its_travel() {
        let setting = Setting {
            holder: Stiffness::n_per_mm(500.0),
            travel: Length::mm(0.5),
            diameter: Length::mm(3.0),
            ..RIGID_M8
        };
        assert!((setting.bears().value() - 0.708).abs() < 0.001, "{}", setting.bears());
        let endless = Setting { travel: Length::ZERO, ..setting };
        assert!((endless.bears().value() - 8.815).abs() < 0.001, "{}", endless.bears());
        let long = Setting { travel: Length::mm(9.0), ..setting };
        assert_eq!(long.bears(), endless.bears());
    }

    fn point(rev: f64, mm: f64) -> Point {
        Point { angle: Angle::rev(rev), place: Length::mm(mm) }
    }

    /// M8×1.25 from 5 mm above to 20 mm deep; so many turns, at this height.
    fn leaving(rev: f64, mm: f64, setting: &Setting) -> Result<Leaving, Refusal> {
        let stored = Stored::line(point(0.0, 5.0), point(20.0, -20.0), Direction::Inward).unwrap();
        stored.leaving(point(rev, mm), setting)
    }

    #[test]
    fn in_the_work_it_goes_along_its_coupling() {
        assert_eq!(leaving(8.0, -5.0, &RIGID_M8), Ok(Leaving::Along));
        assert_eq!(leaving(8.2, -5.0, &RIGID_M8), Ok(Leaving::Along));
    }

    #[test]
    fn over_the_work_it_goes_straight_out_whatever_the_angle_says() {
        for turns in [0.0, 3.6, 18.0] {
            assert_eq!(leaving(turns, 0.5, &RIGID_M8), Ok(Leaving::Straight));
        }
    }

    #[test]
    fn just_over_the_work_the_distance_from_the_coupling_tells_whether_a_thread_holds_it() {
        // 4 turns: the surface
        assert_eq!(leaving(4.0, 0.05, &RIGID_M8), Ok(Leaving::Along));
        assert_eq!(leaving(4.5, 0.05, &RIGID_M8), Ok(Leaving::Straight));
        let soft = Setting { holder: Stiffness::n_per_mm(500.0), ..RIGID_M8 };
        assert_eq!(leaving(4.5, 0.05, &soft), Ok(Leaving::Along));
        assert_eq!(leaving(6.0, 0.05, &soft), Ok(Leaving::Straight));
    }

    #[test]
    fn further_off_than_a_whole_tap_can_be_is_refused() {
        // √3·1000 N/mm²·π/4·(4.8 mm)² = 31.3 kN: 1.57 mm of a rigid holder
        assert_eq!(leaving(8.0, -6.5, &RIGID_M8), Ok(Leaving::Along));
        let Err(Refusal::BeyondTap { error, bears }) = leaving(8.0, -6.6, &RIGID_M8) else {
            panic!("it is refused")
        };
        assert!((error.value() - 1.6).abs() < 1e-9 && (bears.value() - 1.567).abs() < 1e-3);
        // with a turn in the work nothing holds it that hard
        assert_eq!(leaving(5.0, -2.9, &RIGID_M8), Ok(Leaving::Along));
        assert_eq!(leaving(f64::NAN, -5.0, &RIGID_M8), Err(Refusal::NotFinite));
    }
}
