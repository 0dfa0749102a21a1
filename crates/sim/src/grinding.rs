//! Cam grinding: a wheel that is fed against a turning blank, with the compliance between them.
//!
//! ```text
//!        wheel, radius R                     S(θ)   where the wheel's centre would just touch the work as it is
//!       ╭─────╮        work, turned by θ     a(θ)   where the axis holds the wheel's centre
//!       │  ●  │▒▒▒╭──╮                        gap = S − a > 0: the wheel is pressed into the work
//!       ╰──┊──╯   │ ●│                        ae  = gap·(1 − q)    is ground off:  S ← S − ae
//!    a ◄───┊──────╯  ╰                        Fn  = k·ae           pushes the wheelhead away
//!
//!   k = u·b·vw/(μ·vs)       q = k/(k + km)       wear of the wheel: dR = ae·vw·b·dt/(G·2πR·b)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | u | specific energy | N/mm² (J/mm³·10³) |
//! | b, vw, ae | width in contact, speed of the work's surface, real depth of cut | mm, mm/s, mm |
//! | μ, vs | tangential over normal force, speed of the wheel's rim | 1, mm/s |
//! | km | stiffness of wheel, work and centres together | N/mm |
//! | q | share of the deflection that is left after a turn: qⁿ after n turns of spark-out | 1 |
//! | G | volume of work ground for a volume of wheel lost | 1 |
//!
//! The work is kept as the pitch curve S(θ) of the wheel that grinds it, at [`NODES`] angles; the
//! place along the line of centres is all that matters to the cam's path. The contact's angle on a
//! steep flank is left out: it changes the force by its cosine, not the path.
//!
//! Source: specific energy and the stiffness model as in S. Malkin, *Grinding Technology*, 2nd ed.
//! 2008, ch. 5 and 12; the figures of `machines/cam-grinder.toml`.
use core::f64::consts::TAU;
use units::{Length, Speed, Stiffness};

/// Angles at which a blank is known: each twentieth of a degree.
pub const NODES: usize = 7200;

/// The wheel and what it costs to grind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Radius when new.
    pub radius: Length,
    /// Width in contact with a cam.
    pub width: Length,
    /// Speed of the rim.
    pub rim: Speed,
    /// Specific energy, J/mm³.
    pub energy_j_per_mm3: f64,
    /// Tangential over normal force.
    pub force_ratio: f64,
    /// Volume of work over volume of wheel.
    pub grinding_ratio: f64,
}

/// A blank on the work spindle.
#[derive(Clone, Debug, PartialEq)]
pub struct Blank {
    /// It lies between these places of the axis along the work.
    pub along: (Length, Length),
    /// Coordinate of the infeed axis at which the wheel touches it, at equal steps of the work's
    /// angle from 0.
    pub touches: Vec<Length>,
}

/// Grinding on a machine: which axis feeds, what is ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Grinding {
    /// The work spindle, by its place on the bus.
    pub work: usize,
    /// The axis that feeds the wheel towards the work, in its negative direction.
    pub infeed: usize,
    /// The axis along the work.
    pub along: usize,
    /// Coordinate of the infeed axis at which the wheel's centre would stand in the work's.
    pub centre: Length,
    /// The wheel.
    pub wheel: Wheel,
    /// Stiffness of wheel, work and centres together.
    pub stiffness: Stiffness,
    /// What is clamped.
    pub blanks: Vec<Blank>,
}

impl Grinding {
    /// What is wrong with it, each in one sentence.
    pub(crate) fn problems(&self, found: &mut Vec<String>) {
        let wheel = &self.wheel;
        let numbers = [
            ("wheel radius", wheel.radius.value(), "mm"),
            ("wheel width", wheel.width.value(), "mm"),
            ("rim speed", wheel.rim.value(), "mm/s"),
            ("specific energy", wheel.energy_j_per_mm3, "J/mm³"),
            ("force ratio", wheel.force_ratio, ""),
            ("grinding ratio", wheel.grinding_ratio, ""),
            ("stiffness", self.stiffness.value(), "N/mm"),
        ];
        for (what, value, unit) in numbers {
            if !(value > 0.0 && value.is_finite()) {
                found.push(format!(
                    "grinding: {what} is {value} {unit}, needed is a number above 0"
                ));
            }
        }
        for (index, blank) in self.blanks.iter().enumerate() {
            if blank.touches.len() < 8 || blank.touches.iter().any(|at| !at.is_finite()) {
                found.push(format!(
                    "blank {index}: at least 8 finite places over a turn are needed"
                ));
            }
        }
    }
}

/// What presses and brakes at present.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Contact {
    /// On the wheelhead, away from the work, N.
    pub(crate) normal: f64,
    /// On the work spindle against its turn, N·m.
    pub(crate) torque: f64,
    /// How far the wheel stands back from where its axis holds it, mm.
    pub(crate) deflection: f64,
}

/// The work and the wheel while they are being ground.
#[derive(Clone, Debug)]
pub(crate) struct Grinder {
    model: Grinding,
    /// mm.
    surfaces: Vec<Vec<f64>>,
    worn_mm: f64,
    before: Option<(f64, f64)>,
    contact: Contact,
    energy: f64,
}

impl Grinder {
    /// `energy` scales the specific energy: what scatters.
    pub(crate) fn new(model: Grinding, energy: f64) -> Self {
        let surfaces = model.blanks.iter().map(|blank| resampled(&blank.touches)).collect();
        Self { model, surfaces, worn_mm: 0.0, before: None, contact: Contact::default(), energy }
    }

    /// These blanks are clamped, beside this wheel.
    pub(crate) fn has(&self, grinding: &Grinding) -> bool {
        self.model == *grinding
    }

    /// The blanks as they were ground elsewhere; the wheel is another one.
    pub(crate) fn take_surfaces_of(&mut self, other: &Self) {
        if self.surfaces.len() == other.surfaces.len() {
            self.surfaces.clone_from(&other.surfaces);
        }
    }

    pub(crate) const fn contact(&self) -> Contact {
        self.contact
    }

    /// Which axis feeds, and which spindle turns the work.
    pub(crate) const fn members(&self) -> (usize, usize, usize) {
        (self.model.infeed, self.model.along, self.model.work)
    }

    /// How much of the wheel's radius is worn off, mm.
    pub(crate) const fn worn_mm(&self) -> f64 {
        self.worn_mm
    }

    /// A period has passed: the work stands at `turn` rev, the wheel at `infeed` and `along`, mm;
    /// `omega` in rad/s.
    #[allow(clippy::cast_possible_wrap)] // nodes are far below 2⁶³
    pub(crate) fn step(&mut self, turn: f64, infeed: f64, along: f64, omega: f64) {
        let (turn_before, infeed_before) =
            self.before.replace((turn, infeed)).unwrap_or((turn, infeed));
        let over = |blank: &Blank| {
            let (from, to) = (blank.along.0.value(), blank.along.1.value());
            (from.min(to)..=from.max(to)).contains(&along)
        };
        let Some(index) = self.model.blanks.iter().position(over) else {
            self.contact = Contact::default();
            return;
        };
        let (from, to) = (turn_before * NODES as f64, turn * NODES as f64);
        let (first, last) = if to >= from {
            (from.floor() as i64 + 1, to.floor() as i64)
        } else {
            (to.ceil() as i64, from.ceil() as i64 - 1)
        };
        // a leap of more than a turn in a period is no motion of a machine
        let last = last.min(first + NODES as i64);
        let mut contact = None;
        for node in first..=last {
            let share = if to == from { 1.0 } else { (node as f64 - from) / (to - from) };
            let held = infeed_before + (infeed - infeed_before) * share + self.worn_mm;
            contact = Some(self.grind(index, node.rem_euclid(NODES as i64) as usize, held, omega));
        }
        if let Some(contact) = contact {
            self.contact = contact;
        }
    }

    /// Grind one node with the wheel held at a place.
    fn grind(&mut self, blank: usize, node: usize, held: f64, omega: f64) -> Contact {
        let surface = &mut self.surfaces[blank][node];
        let gap = *surface - held;
        if gap <= 0.0 {
            return Contact::default();
        }
        let wheel = &self.model.wheel;
        let (radius, width) = (wheel.radius.value() - self.worn_mm, wheel.width.value());
        let work_mm = (*surface - self.model.centre.value() - wheel.radius.value()).max(1.0);
        let work_speed = omega.abs() * work_mm;
        let energy = self.energy * wheel.energy_j_per_mm3 * 1e3;
        let k = energy * width * work_speed / (wheel.force_ratio * wheel.rim.value());
        let km = self.model.stiffness.value();
        let depth = gap * km / (k + km);
        *surface -= depth;
        let normal = k * depth;
        // the arc of this node, ground to this depth
        let volume = depth * work_mm * TAU / NODES as f64 * width;
        self.worn_mm += volume / (wheel.grinding_ratio * TAU * radius.max(1.0) * width);
        Contact {
            normal,
            torque: normal * wheel.force_ratio * work_mm * 1e-3,
            deflection: normal / km,
        }
    }
}

/// At [`NODES`] angles, straight between the given ones, around the turn.
fn resampled(touches: &[Length]) -> Vec<f64> {
    let count = touches.len();
    let at = |node: usize| {
        let place = node as f64 * count as f64 / NODES as f64;
        let (whole, part) = (place.floor() as usize, place.fract());
        let (a, b) = (touches[whole % count].value(), touches[(whole + 1) % count].value());
        a + (b - a) * part
    };
    (0..NODES).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round blank of radius 18 mm on a machine whose wheel, 200 mm, touches it at X 0.
    fn round(allowance_mm: f64) -> Grinder {
        let model = Grinding {
            work: 0,
            infeed: 0,
            along: 2,
            centre: Length::mm(-218.0),
            wheel: Wheel {
                radius: Length::mm(200.0),
                width: Length::mm(15.0),
                rim: Speed::mm_per_s(80_000.0),
                energy_j_per_mm3: 30.0,
                force_ratio: 0.4,
                grinding_ratio: 2000.0,
            },
            stiffness: Stiffness::n_per_mm(30_000.0),
            blanks: vec![Blank {
                along: (Length::mm(-10.0), Length::mm(10.0)),
                touches: vec![Length::mm(allowance_mm); 8],
            }],
        };
        Grinder::new(model, 1.0)
    }

    /// Turns at 60 rpm with the wheel held, in servo periods of 250 µs.
    fn turns(grinder: &mut Grinder, from: f64, count: f64, held: f64) {
        let periods = (count / 250e-6) as u32;
        for k in 0..=periods {
            grinder.step(from + f64::from(k) * 250e-6, held, 0.0, TAU);
        }
    }

    /// k = 30 000·15·(18·2π)/(0.4·80 000) = 1590 N/mm at the base circle, as machine files say: 1.5
    /// N/µm.
    #[test]
    fn at_the_base_circle_a_micrometre_of_real_depth_takes_one_and_a_half_newtons() {
        let mut grinder = round(0.010);
        turns(&mut grinder, 0.0, 0.9, 0.0);
        let k = 30_000.0 * 15.0 * (18.01 * TAU) / (0.4 * 80_000.0);
        let real = 0.010 * 30_000.0 / (k + 30_000.0);
        assert!((grinder.contact().normal - k * real).abs() < 0.01, "{:?}", grinder.contact());
        assert!((k - 1590.0).abs() < 5.0);
    }

    #[test]
    fn each_turn_of_spark_out_leaves_the_share_q_of_the_deflection() {
        let mut grinder = round(0.010);
        let k = 30_000.0 * 15.0 * (18.0 * TAU) / (0.4 * 80_000.0);
        let q = k / (k + 30_000.0);
        turns(&mut grinder, 0.0, 3.0, 0.0);
        let left = grinder.surfaces[0][1234] + grinder.worn_mm();
        assert!(
            (left - 0.010 * q.powi(3)).abs() < 0.03e-3,
            "{left} mm, q³ of it {}",
            0.010 * q.powi(3)
        );
    }

    #[test]
    fn a_wheel_wears_by_the_ground_volume_over_the_grinding_ratio() {
        let mut grinder = round(0.050);
        turns(&mut grinder, 0.0, 4.0, 0.0);
        let volume = TAU * 18.025 * 0.050; // per mm of width
        let expected = volume / (2000.0 * TAU * 200.0);
        assert!((grinder.worn_mm() / expected - 1.0).abs() < 0.02, "{}", grinder.worn_mm());
    }

    #[test]
    fn a_wheel_beside_the_blank_or_off_it_touches_nothing() {
        let mut grinder = round(0.010);
        grinder.step(0.0, 0.0, 25.0, TAU);
        grinder.step(0.1, 0.0, 25.0, TAU);
        assert_eq!(grinder.contact(), Contact::default());
        turns(&mut grinder, 0.1, 1.0, 0.5);
        assert_eq!(grinder.contact(), Contact::default());
    }
}
