//! From lift and follower to the contour, and to the path of a wheel's centre over the C axis.
use super::error::{CamError, Problem, Undercut};
use super::lift::{Cam, Follower};
use core::f64::consts::TAU;
use sync::{Periodic, PeriodicPoint};
use units::{Angle, Length};

/// Angles at which curvature is looked at: each twentieth of a degree.
const CHECKED: usize = 7200;

/// A point of the contour, in the frame of the cam: φ = 0 along +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourPoint {
    /// Angle of the follower that touches here.
    pub angle: Angle,
    /// Lift there.
    pub lift: Length,
    /// Place, along and across φ = 0.
    pub at: [Length; 2],
    /// Radius of curvature: positive where the contour bulges, negative in a hollow.
    pub radius: Length,
}

/// Where the centre of a wheel runs over one turn of the C axis.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelPath {
    /// Radius of the wheel.
    pub wheel: Length,
    /// Distance of its centre from the C axis in equal steps of C from zero, mm.
    pub centre: Vec<f64>,
    /// Where the contact runs along the contour meanwhile: length per revolution of C, mm/rev.
    pub contact: Vec<f64>,
    pub(crate) spline: Periodic,
}

impl WheelPath {
    /// Centre distance and its derivatives by revolutions of C.
    pub fn at(&self, c: Angle) -> PeriodicPoint {
        self.spline.at(c.value())
    }
}

/// Offset point in the frame of n and t, and the contour's radius of curvature.
struct Touch {
    radial: f64,
    tangential: f64,
    curvature_radius: f64,
}

impl Cam {
    /// The point at an angle of the follower, offset outwards by `wheel` from the contour.
    fn touch(&self, turn: f64, wheel: f64) -> Touch {
        let [s, s1, s2, _] = self.lift(Angle::rev(turn));
        let r0 = self.base.value();
        let roller = match self.follower {
            Follower::Flat => {
                let h = r0 + s;
                return Touch { radial: h + wheel, tangential: s1, curvature_radius: h + s2 };
            }
            Follower::Roller(radius) => radius.value(),
            Follower::Knife => 0.0,
        };
        let r = r0 + roller + s;
        let g = r.hypot(s1);
        let offset = wheel - roller;
        let pitch_radius = g * g * g / (r * r + 2.0 * s1 * s1 - r * s2);
        Touch {
            radial: r + offset * r / g,
            tangential: -offset * s1 / g,
            curvature_radius: pitch_radius - roller,
        }
    }

    /// The contour in equal steps of the follower's angle.
    pub fn contour(&self, steps: usize) -> Vec<ContourPoint> {
        let point = |i: usize| {
            let turn = i as f64 / steps as f64;
            let touch = self.touch(turn, 0.0);
            let (sin, cos) = (TAU * turn).sin_cos();
            ContourPoint {
                angle: Angle::rev(turn),
                lift: Length::mm(self.lift(Angle::rev(turn))[0]),
                at: [
                    Length::mm(touch.radial * cos - touch.tangential * sin),
                    Length::mm(touch.radial * sin + touch.tangential * cos),
                ],
                radius: Length::mm(touch.curvature_radius),
            }
        };
        (0..steps).map(point).collect()
    }

    /// Whether the follower can run on it at all.
    ///
    /// # Errors
    /// The contour would be cut away under itself, with the base or roller radius that works.
    pub(crate) fn is_makeable(&self) -> Result<(), CamError> {
        let turns = || (0..CHECKED).map(|i| i as f64 / CHECKED as f64);
        match self.follower {
            Follower::Flat => {
                let radius = |turn: f64| self.touch(turn, 0.0).curvature_radius;
                let Some((at, least)) =
                    turns().map(|t| (t, radius(t))).min_by(|a, b| a.1.total_cmp(&b.1))
                else {
                    return Ok(());
                };
                if least > 0.0 {
                    return Ok(());
                }
                let works = Undercut::Base(Length::mm(self.base.value() - least));
                Err(CamError::of(Problem::Undercut { at: Angle::rev(at), works }))
            }
            Follower::Roller(roller) => {
                let pitch = |turn: f64| self.touch(turn, 0.0).curvature_radius + roller.value();
                let convex = turns().map(|t| (t, pitch(t))).filter(|p| p.1 > 0.0);
                match convex.min_by(|a, b| a.1.total_cmp(&b.1)) {
                    Some((at, least)) if least <= roller.value() => {
                        let works = Undercut::Roller(Length::mm(least));
                        Err(CamError::of(Problem::Undercut { at: Angle::rev(at), works }))
                    }
                    _ => Ok(()),
                }
            }
            Follower::Knife => Ok(()),
        }
    }

    /// The smallest radius of a hollow and where it is; `None`: there is none.
    pub fn tightest_hollow(&self) -> Option<(Angle, Length)> {
        let radii = (0..CHECKED).map(|i| i as f64 / CHECKED as f64);
        let hollows = radii.map(|t| (t, self.touch(t, 0.0).curvature_radius)).filter(|h| h.1 < 0.0);
        let tightest = hollows.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((Angle::rev(tightest.0), Length::mm(-tightest.1)))
    }

    /// The path of a wheel's centre over C, in `nodes` equal steps.
    ///
    /// # Errors
    /// The cam cannot be made, or the wheel does not fit into a hollow.
    pub fn wheel_path(&self, wheel: Length, nodes: usize) -> Result<WheelPath, CamError> {
        if !(wheel > Length::ZERO && wheel.is_finite()) {
            return Err(CamError::of(Problem::NotPositive { what: "a wheel radius" }));
        }
        self.is_makeable()?;
        if let Some((at, largest)) = self.tightest_hollow().filter(|(_, radius)| *radius <= wheel) {
            return Err(CamError::of(Problem::WheelTooBig { at, largest }));
        }
        self.path_unchecked(wheel, nodes)
    }

    /// The same without asking whether the contour is what the follower asks for: where it is
    /// undercut, the wheel takes away what it should have left.
    ///
    /// # Errors
    /// `nodes` are no table.
    pub fn path_unchecked(&self, wheel: Length, nodes: usize) -> Result<WheelPath, CamError> {
        let w = wheel.value();
        let at = |k: usize| {
            let c = k as f64 / nodes as f64;
            self.touching(c, w)
        };
        let angles: Vec<f64> = (0..nodes).map(at).collect();
        let distance = |turn: &f64| {
            let touch = self.touch(*turn, w);
            touch.radial.hypot(touch.tangential)
        };
        let centre: Vec<f64> = angles.iter().map(distance).collect();
        let point = |turn: f64| {
            let touch = self.touch(turn, 0.0);
            let (sin, cos) = (TAU * turn).sin_cos();
            [
                touch.radial * cos - touch.tangential * sin,
                touch.radial * sin + touch.tangential * cos,
            ]
        };
        let contact = (0..nodes).map(|k| {
            let (a, b) = (point(angles[(k + nodes - 1) % nodes]), point(angles[(k + 1) % nodes]));
            (b[0] - a[0]).hypot(b[1] - a[1]) * nodes as f64 / 2.0
        });
        let spline =
            Periodic::new(&centre).map_err(|_| CamError::of(Problem::Rows { count: nodes }))?;
        Ok(WheelPath { wheel, contact: contact.collect(), centre, spline })
    }

    /// The angle of the follower whose contact faces the wheel while C stands at `c`.
    fn touching(&self, c: f64, wheel: f64) -> f64 {
        let facing = |turn: f64| {
            let touch = self.touch(turn, wheel);
            turn + touch.tangential.atan2(touch.radial) / TAU - c
        };
        // the contact is within a quarter turn of the line of centres; angles rise together
        let (mut low, mut high) = (c - 0.25, c + 0.25);
        for _ in 0..48 {
            let middle = f64::midpoint(low, high);
            if facing(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        f64::midpoint(low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::ClosedForm;

    const WHEEL: Length = Length::mm(200.0);

    fn eccentric() -> Cam {
        let form =
            ClosedForm::Eccentric { radius: Length::mm(25.0), eccentricity: Length::mm(4.0) };
        form.cam().unwrap()
    }

    #[test]
    fn the_path_over_an_eccentric_is_the_crank_equation() {
        // law of cosines: X = e·cos ψ + √((r + W)² − e²·sin² ψ)
        let path = eccentric().wheel_path(WHEEL, 720).unwrap();
        for (k, x) in path.centre.iter().enumerate() {
            let (sin, cos) = (TAU * k as f64 / 720.0).sin_cos();
            let exact = 4.0 * cos + (225.0f64.powi(2) - 16.0 * sin * sin).sqrt();
            assert!((x - exact).abs() < 1e-9, "node {k}: {x} instead of {exact}");
        }
    }

    #[test]
    fn the_contour_of_an_eccentric_is_a_circle() {
        for point in eccentric().contour(360) {
            let r = (point.at[0].value() - 4.0).hypot(point.at[1].value());
            assert!((r - 25.0).abs() < 1e-9);
            assert!((point.radius.value() - 25.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_roller_and_the_knife_that_touches_at_its_contour_make_the_same_path() {
        // the contour under a roller, as a polar table for a knife
        let lift = ClosedForm::Harmonic {
            base: Length::mm(22.0),
            lift: Length::mm(6.0),
            follower: Follower::Roller(Length::mm(15.0)),
        };
        let cam = lift.cam().unwrap();
        let dense = cam.contour(36_000);
        let polar: Vec<(f64, f64)> = dense
            .iter()
            .map(|p| {
                (
                    p.at[1].value().atan2(p.at[0].value()) / TAU,
                    p.at[0].value().hypot(p.at[1].value()),
                )
            })
            .map(|(a, r)| (a.rem_euclid(1.0), r))
            .collect();
        let mut sorted = polar.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |turn: f64| {
            let i = sorted.partition_point(|p| p.0 <= turn);
            let (a, b) = (sorted[(i + sorted.len() - 1) % sorted.len()], sorted[i % sorted.len()]);
            let span = (b.0 - a.0).rem_euclid(1.0);
            a.1 + (b.1 - a.1) * ((turn - a.0).rem_euclid(1.0) / span)
        };
        let values: Vec<f64> = (0..720).map(|i| at(f64::from(i) / 720.0)).collect();
        let knife = Cam::from_nodes(&values, 0.0, Length::mm(1e-6), Follower::Knife).unwrap();
        let (a, b) = (cam.wheel_path(WHEEL, 720).unwrap(), knife.wheel_path(WHEEL, 720).unwrap());
        for (x, y) in a.centre.iter().zip(&b.centre) {
            assert!((x - y).abs() < 1e-4, "{x} {y}");
        }
    }

    #[test]
    fn a_flat_follower_on_too_small_a_base_is_refused_with_the_base_that_works() {
        // 9(1 − u²)³ over ±65°: s″(180°) = −6·9/1.1345² = −41.96, so the base must be 32.96 at
        // least
        let of = |base: f64| ClosedForm::Automotive {
            base: Length::mm(base),
            lift: Length::mm(9.0),
            half_angle: Angle::deg(65.0),
            follower: Follower::Flat,
        };
        let refused = of(18.0).cam().unwrap().wheel_path(WHEEL, 720).unwrap_err();
        let Problem::Undercut { works: Undercut::Base(base), at } = refused.problem else {
            panic!("{refused}");
        };
        assert!((base.value() - 32.96).abs() < 0.01, "{base}");
        assert!((at.in_deg() - 180.0).abs() < 0.1);
        assert!(of(33.0).cam().unwrap().wheel_path(WHEEL, 720).is_ok());
    }

    #[test]
    fn a_wheel_larger_than_a_hollow_is_refused_with_the_one_that_fits() {
        let cam = ClosedForm::Lobes {
            radius: Length::mm(25.0),
            amplitude: Length::mm(3.0),
            count: 4,
            phase: Angle::ZERO,
        };
        let cam = cam.cam().unwrap();
        // ρ at a valley: r²/(r − r″) with r = 22, r″ = 48
        let exact = 22.0 * 22.0 / (48.0 - 22.0);
        let refused = cam.wheel_path(WHEEL, 720).unwrap_err();
        let Problem::WheelTooBig { largest, .. } = refused.problem else { panic!("{refused}") };
        assert!((largest.value() - exact).abs() < 0.01, "{largest} {exact}");
        assert!(cam.wheel_path(Length::mm(18.0), 720).is_ok());
    }

    #[test]
    fn a_worn_wheel_has_another_path() {
        let cam = eccentric();
        let (new, worn) =
            (cam.wheel_path(WHEEL, 720).unwrap(), cam.wheel_path(Length::mm(180.0), 720).unwrap());
        let differs = new.centre.iter().zip(&worn.centre).map(|(a, b)| (a - b - 20.0).abs());
        assert!(differs.fold(0.0, f64::max) > 1e-3, "the difference is more than the radius");
    }
}
