//! What the inserts of a polygon cutter leave of the bar: the way of each tip in the work, between
//! two periods in steps. It takes no force.
use super::{COLUMNS, Turning, column};
use core::f64::consts::TAU;

/// Steps between two periods.
const STEPS: u32 = 8;
/// Inserts of a cutter that are simulated at most.
const MOST: usize = 12;

/// A cutter on the second spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonCutter {
    radius_mm: f64,
    nose_mm: f64,
    /// Where its inserts stand, rev.
    inserts: [f64; MOST],
    count: usize,
}

impl PolygonCutter {
    /// Of a radius to its tips, their nose radius, and where they stand; `None`: it has too many.
    pub fn new(
        radius: units::Length,
        nose: units::Length,
        stands: &[units::Angle],
    ) -> Option<Self> {
        let mut inserts = [0.0; MOST];
        let count = stands.len();
        inserts.get_mut(..count)?.iter_mut().zip(stands).for_each(|(to, at)| *to = at.value());
        Some(Self { radius_mm: radius.value(), nose_mm: nose.value(), inserts, count })
    }
}

/// Cutter and work at the end of a period: from the work's axis mm, the tip's Z, angles of work and
/// tool rev.
pub(super) type CutterPose = [f64; 5];

impl Turning {
    /// A period with the cutter's axis at machine X and Y and tip Z, mm; angles of work and tool,
    /// rev.
    pub(crate) fn cut_polygon(
        &mut self,
        (number, cutter): (u32, &PolygonCutter),
        at: [f64; 3],
        [work, tool]: [f64; 2],
    ) {
        let axis = self.bar.axis.map(units::Length::value);
        let now = [at[0] - axis[0], at[1] - axis[1], at[2], work, tool];
        let before = self.cutter.replace((number, now)).filter(|(of, _)| *of == number);
        let Some((_, before)) = before else { return };
        let far = self.bar.radius.value() + cutter.radius_mm;
        if now[0].hypot(now[1]) > far || now[2] > self.bar.face.value() + cutter.nose_mm {
            return;
        }
        self.come_with(number);
        for step in 0..STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let pose = core::array::from_fn(|i| before[i] + share * (now[i] - before[i]));
            for insert in &cutter.inserts[..cutter.count] {
                self.pass(&pose, *insert, cutter);
            }
        }
    }

    fn pass(&mut self, [x, y, z, work, tool]: &CutterPose, insert: f64, cutter: &PolygonCutter) {
        let stands = (0.5 + tool + insert).fract() * TAU;
        let tip = [x + cutter.radius_mm * stands.cos(), y + cutter.radius_mm * stands.sin()];
        let radius = tip[0].hypot(tip[1]);
        if radius >= self.bar.radius.value() {
            return;
        }
        let at = (tip[1].atan2(tip[0]) / TAU - work) * COLUMNS as f64;
        let nose = cutter.nose_mm.max(self.step);
        let place = |z: f64| ((z - self.bar.rear.value()) / self.step - 0.5).max(0.0);
        let last = (place(z + nose).floor() as usize + 1).min(self.places);
        let column = column(at.round() as i64);
        for place in place(z - nose).ceil() as usize..last {
            let off = (self.z(place) - z).abs();
            let rise = nose - (nose * nose - off * off).max(0.0).sqrt();
            let outer = &mut self.outer[column * self.places + place];
            *outer = outer.min((radius + rise) as f32);
        }
    }
}
