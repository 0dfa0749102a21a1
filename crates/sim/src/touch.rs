//! What a touch probe and a tool setter meet: faces, bores and bosses of the work.
//!
//! ```text
//!        │ axis            d(p): distance of a point to the material, negative within it
//!      ──┴──               contact:  d(centre of the ball) ≤ r − s
//!        │                 s: how far the stylus gives until it switches (pretravel),
//!       (●) r                 s = s₀ + s₃·cos 3φ in the plane across the axis, by the direction φ of the contact:
//!   ▔▔▔▔▔▔▔▔▔▔▔▔▔▔            three bearings of a kinematic probe; s₀ along the axis
//! ```
//!
//! Of a box the distance is exact outside, round its edges too; in a bore it is R − ρ below its
//! rim. The moment of contact is found between two periods, as the machine's probe input states it:
//! the places between them lie on a line.
//!
//! Source: ISO 230-10 (probing of machine tools), 3.2.8 pre-travel; the three lobes: Estler et al.,
//! NIST (1996).
use crate::work::{Bore, Hole, Stock};
use units::Length;

/// A touch probe in the spindle: its ball is `diameter`, and its `length` reaches to the ball's
/// lower end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// Of the ball.
    pub diameter: Length,
    /// How far the stylus gives until it switches: s₀.
    pub pretravel: Length,
    /// By how much that differs by direction: s₃.
    pub lobing: Length,
}

/// How far a stylus gives until it breaks.
const OVERTRAVEL_MM: f64 = 8.0;
/// From contact to its end, mm: no chatter.
const RELEASES_MM: f64 = 0.0005;
/// Step of the numeric gradient, mm.
const GRADIENT_MM: f64 = 1e-4;

/// A cylinder that stands on the surface of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boss {
    /// Its axis, machine X.
    pub x: Length,
    /// Its axis, machine Y.
    pub y: Length,
    /// Its diameter.
    pub diameter: Length,
    /// How high it stands above the surface.
    pub height: Length,
}

/// A plate on a switch: the tip of a tool touches it from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSetter {
    /// The middle of its plate in machine coordinates of a tool's tip.
    pub at: [Length; 3],
    /// Diameter of its plate.
    pub diameter: Length,
    /// How far it gives until it switches.
    pub pretravel: Length,
}

/// What can be touched, and whether it is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touch {
    bosses: Vec<Boss>,
    setter: Option<ToolSetter>,
    /// How far from contact at the end of the last period, mm.
    before: Option<f64>,
    touches: bool,
    broken: bool,
}

/// What the probe's input says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Touched {
    pub(crate) touches: bool,
    /// Share of the period that has passed since it changed, if it did.
    pub(crate) since: Option<f64>,
    pub(crate) broken: bool,
}

impl Touch {
    pub(crate) fn new(bosses: Vec<Boss>, setter: Option<ToolSetter>) -> Self {
        Self { bosses, setter, ..Self::default() }
    }

    /// One period has ended with the tool's tip there.
    pub(crate) fn step(
        &mut self,
        probe: Option<&TouchProbe>,
        tip: [f64; 3],
        work: Option<(&Stock, &[Hole])>,
    ) -> Touched {
        let by_probe = probe.zip(work).map_or(f64::INFINITY, |(probe, (stock, holes))| {
            self.to_contact(probe, tip, stock, holes)
        });
        let by_setter = self.setter.map_or(f64::INFINITY, |setter| to_plate(&setter, tip));
        self.broken = probe.is_some() && (self.broken || by_probe < -OVERTRAVEL_MM);
        let now = by_probe.min(by_setter);
        let level = if self.touches { RELEASES_MM } else { 0.0 };
        let touches = now <= level;
        let changed = touches != self.touches;
        let before = self.before.replace(now);
        self.touches = touches;
        let since = before.filter(|before| changed && before.is_finite() && now.is_finite());
        Touched {
            touches,
            since: since.map(|before| ((now - level) / (now - before)).clamp(0.0, 1.0)),
            broken: self.broken,
        }
    }

    /// Another tool is in the spindle.
    pub(crate) const fn forget(&mut self) {
        (self.before, self.broken) = (None, false);
    }

    /// How far the ball is from where the probe switches, mm; negative beyond it.
    fn to_contact(&self, probe: &TouchProbe, tip: [f64; 3], stock: &Stock, holes: &[Hole]) -> f64 {
        let radius = probe.diameter.value() / 2.0;
        let centre = [tip[0], tip[1], tip[2] + radius];
        let distance = |p: [f64; 3]| self.distance(p, stock, holes);
        let far = distance(centre) - radius;
        if far.abs() > 1.0 {
            return far; // no direction is needed
        }
        let slope = |i: usize| {
            let (mut a, mut b) = (centre, centre);
            a[i] -= GRADIENT_MM;
            b[i] += GRADIENT_MM;
            (distance(b) - distance(a)) / (2.0 * GRADIENT_MM)
        };
        let (x, y) = (slope(0), slope(1));
        let across = (x * x + y * y).min(1.0);
        let lobes = (3.0 * y.atan2(x)).cos() * across;
        far + probe.pretravel.value() + probe.lobing.value() * lobes
    }

    /// Distance of a point to the material, mm; negative within it.
    fn distance(&self, p: [f64; 3], stock: &Stock, holes: &[Hole]) -> f64 {
        let mut material = block(p, stock);
        let top = stock.top.value();
        for hole in holes {
            for bore in &hole.bores {
                material = material.max(-inside(p, hole, bore, top));
            }
        }
        for boss in &self.bosses {
            material = material.min(cylinder(p, boss, top));
        }
        material
    }
}

/// Of a point to a block.
fn block(p: [f64; 3], stock: &Stock) -> f64 {
    const FAR: f64 = 1e9;
    let top = stock.top.value();
    let bottom = stock.thickness.map_or(-FAR, |thickness| top - thickness.value());
    let (from, to) = stock.sides.map_or(([-FAR, -FAR, bottom], [FAR, FAR, top]), |s| {
        ([s.x_from.value(), s.y_from.value(), bottom], [s.x_to.value(), s.y_to.value(), top])
    });
    let beyond = [0, 1, 2].map(|i| (from[i] - p[i]).max(p[i] - to[i]));
    let outside = beyond.map(|q| q.max(0.0)).iter().map(|q| q * q).sum::<f64>().sqrt();
    outside + beyond.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
}

/// Of a point to the wall or the floor of a bore: negative within the bore, which is open above.
fn inside(p: [f64; 3], hole: &Hole, bore: &Bore, top: f64) -> f64 {
    let across = (p[0] - hole.x.value()).hypot(p[1] - hole.y.value());
    let floor = top - bore.full_depth().value();
    (across - bore.diameter.value() / 2.0).max(floor - p[2])
}

/// Of a point to a cylinder on the surface.
fn cylinder(p: [f64; 3], boss: &Boss, top: f64) -> f64 {
    let across = (p[0] - boss.x.value()).hypot(p[1] - boss.y.value()) - boss.diameter.value() / 2.0;
    let above = p[2] - (top + boss.height.value());
    let outside = across.max(0.0).hypot(above.max(0.0));
    outside + across.max(above).min(0.0)
}

/// How far a tool's tip is above where a plate switches, mm; beside it: far.
fn to_plate(setter: &ToolSetter, tip: [f64; 3]) -> f64 {
    let [x, y, z] = setter.at.map(Length::value);
    if (tip[0] - x).hypot(tip[1] - y) > setter.diameter.value() / 2.0 {
        return f64::INFINITY;
    }
    tip[2] - z + setter.pretravel.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work::Sides;
    use core::f64::consts::PI;

    const PROBE: TouchProbe = TouchProbe {
        diameter: Length::mm(6.0),
        pretravel: Length::um(12.0),
        lobing: Length::um(3.0),
    };

    fn stock() -> Stock {
        Stock {
            top: Length::mm(-100.0),
            thickness: Some(Length::mm(20.0)),
            sides: Some(Sides {
                x_from: Length::mm(0.0),
                x_to: Length::mm(50.0),
                y_from: Length::mm(0.0),
                y_to: Length::mm(40.0),
            }),
            cutting_n_per_mm2: 1000.0,
            holes: Vec::new(),
            assume_predrilled: true,
        }
    }

    /// Where along a way, in micrometres' steps, the probe switches.
    fn switches(touch: &Touch, from: [f64; 3], towards: [f64; 3], holes: &[Hole]) -> f64 {
        let stock = stock();
        (0..60_000)
            .map(|k| f64::from(k) * 1e-3)
            .find(|at| {
                let tip = [0, 1, 2].map(|i| from[i] + towards[i] * at);
                touch.to_contact(&PROBE, tip, &stock, holes) <= 0.0
            })
            .expect("it touches")
    }

    #[test]
    fn a_face_is_met_by_the_ball_and_the_pretravel_beyond() {
        let touch = Touch::default();
        // down onto the face: the tip is there, and 12 µm beyond it
        let down = switches(&touch, [25.0, 20.0, -80.0], [0.0, 0.0, -1.0], &[]);
        assert!((down - 20.012).abs() < 0.0015, "{down}");
        // from the left onto the side at X0: the contact is to the left of the ball's material
        // side, φ = 180°
        let right = switches(&touch, [-20.0, 20.0, -110.0], [1.0, 0.0, 0.0], &[]);
        let pretravel = 0.012 + 0.003 * (3.0 * PI).cos();
        assert!((right - (17.0 + pretravel)).abs() < 0.0015, "{right}");
    }

    #[test]
    fn a_bore_and_a_boss_are_met_on_their_radius() {
        let bore =
            Bore { diameter: Length::mm(30.0), tip_depth: Length::mm(15.0), cone: Length::ZERO };
        let hole = Hole { bores: vec![bore], ..Hole::at(Length::mm(25.0), Length::mm(20.0)) };
        let touch = Touch::default();
        for (towards, angle) in [([1.0, 0.0, 0.0], PI), ([0.0, 1.0, 0.0], -PI / 2.0)] {
            let way = switches(&touch, [25.0, 20.0, -110.0], towards, std::slice::from_ref(&hole));
            let exact = 12.0 + 0.012 + 0.003 * (3.0 * angle).cos();
            assert!((way - exact).abs() < 0.0015, "{way}, {exact}");
        }
        let boss = Boss {
            x: Length::mm(25.0),
            y: Length::mm(20.0),
            diameter: Length::mm(20.0),
            height: Length::mm(15.0),
        };
        let touch = Touch::new(vec![boss], None);
        let way = switches(&touch, [25.0, -5.0, -95.0], [0.0, 1.0, 0.0], &[]);
        let exact = 12.0 + 0.012 + 0.003 * (3.0 * -PI / 2.0).cos();
        assert!((way - exact).abs() < 0.0015, "{way}, {exact}");
    }

    #[test]
    fn the_moment_of_contact_is_found_within_the_period() {
        let mut touch = Touch::default();
        let stock = stock();
        let tip = |z| [25.0, 20.0, z];
        let work = Some((&stock, &[][..]));
        assert!(!touch.step(Some(&PROBE), tip(-99.9), work).touches);
        let touched = touch.step(Some(&PROBE), tip(-100.1), work);
        // it switches at -100.012: 88 of 200 µm before the end
        assert!(touched.touches && (touched.since.unwrap() - 0.44).abs() < 1e-6, "{touched:?}");
        assert!(touch.step(Some(&PROBE), tip(-109.0), work).broken);
    }

    #[test]
    fn any_tool_touches_the_setter() {
        let setter = ToolSetter {
            at: [Length::mm(1.0), Length::mm(2.0), Length::mm(-300.0)],
            diameter: Length::mm(20.0),
            pretravel: Length::um(5.0),
        };
        let mut touch = Touch::new(Vec::new(), Some(setter));
        assert!(!touch.step(None, [1.0, 2.0, -300.004], None).touches);
        assert!(touch.step(None, [1.0, 2.0, -300.006], None).touches);
        assert!(!touch.step(None, [20.0, 2.0, -300.006], None).touches);
    }
}
