//! Coordinates of a figure that is scaled, turned and mirrored, and those of the work it is cut
//! from: the arithmetic of [`mapping`](crate::front_end::fanuc::mapping).
//!
//! ```text
//!   work = M · R · S · figure      S  c + k·(p − c)     R  about c' = S·c by the angle     M  2·m − p
//! ```
use crate::state::executor::Executor;

/// X, Y, Z.
pub(crate) type Coordinates = [f64; 3];

/// Letters of the axes, and of what belongs to them.
pub(crate) const AXIS: [u8; 3] = *b"XYZ";
pub(crate) const CENTRE: [u8; 3] = *b"IJK";

/// What is in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Mapping {
    pub(crate) polar: Option<Polar>,
    pub(crate) scale: Option<Scale>,
    pub(crate) rotation: Option<Rotation>,
    pub(crate) mirror: [Option<f64>; 3],
}

/// G16.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Polar {
    pub(crate) origin: [f64; 2],
    /// Radius and angle named last.
    pub(crate) last: Option<[f64; 2]>,
}

/// G51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) centre: Coordinates,
    pub(crate) factor: Coordinates,
}

/// G68.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    pub(crate) axes: [usize; 2],
    pub(crate) centre: [f64; 2],
    pub(crate) sin: f64,
    pub(crate) cos: f64,
    /// No block since has named a place in the plane.
    pub(crate) fresh: bool,
}

impl Mapping {
    /// Whether this axis' word is an angle.
    pub(crate) fn is_angle(&self, ex: &Executor, letter: u8) -> bool {
        self.polar.is_some() && letter == AXIS[ex.modes.plane_axes()[1]]
    }

    /// Whether figures are changed.
    pub(crate) fn changes(&self) -> bool {
        self.scale.is_some() || self.rotation.is_some() || self.mirror.iter().any(Option::is_some)
    }

    pub(crate) fn scaled(&self, at: &Coordinates) -> Coordinates {
        let mut to = *at;
        if let Some(Scale { centre, factor }) = &self.scale {
            for i in 0..3 {
                to[i] = centre[i] + factor[i] * (at[i] - centre[i]);
            }
        }
        to
    }

    /// From a block's coordinates to the work's.
    pub(crate) fn forward(&self, at: &Coordinates) -> Coordinates {
        let mut to = self.scaled(at);
        if let Some(Rotation { axes: [a, b], centre, sin, cos, .. }) = self.rotation {
            let (x, y) = (to[a] - centre[0], to[b] - centre[1]);
            (to[a], to[b]) = (centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos);
        }
        for (value, mirror) in to.iter_mut().zip(self.mirror) {
            *value = mirror.map_or(*value, |at| 2.0 * at - *value);
        }
        to
    }

    /// And back.
    pub(crate) fn backward(&self, at: &Coordinates) -> Coordinates {
        let mut to = *at;
        for (value, mirror) in to.iter_mut().zip(self.mirror) {
            *value = mirror.map_or(*value, |at| 2.0 * at - *value);
        }
        if let Some(Rotation { axes: [a, b], centre, sin, cos, .. }) = self.rotation {
            let (x, y) = (to[a] - centre[0], to[b] - centre[1]);
            (to[a], to[b]) = (centre[0] + x * cos + y * sin, centre[1] + y * cos - x * sin);
        }
        if let Some(Scale { centre, factor }) = &self.scale {
            for i in 0..3 {
                to[i] = centre[i] + (to[i] - centre[i]) / factor[i];
            }
        }
        to
    }

    /// What becomes of a distance.
    pub(crate) fn distance(&self, along: &Coordinates) -> Coordinates {
        let zero = self.forward(&[0.0; 3]);
        let mut to = self.forward(along);
        for i in 0..3 {
            to[i] -= zero[i];
        }
        to
    }

    /// How much longer an axis' distances become, negative where they are mirrored; rotation apart.
    pub(crate) fn factor(&self, axis: usize) -> f64 {
        let scale = self.scale.map_or(1.0, |scale| scale.factor[axis]);
        if self.mirror[axis].is_some() { -scale } else { scale }
    }

    /// Whether arcs of these axes turn the other way.
    pub(crate) fn flips(&self, [a, b]: [usize; 2]) -> bool {
        (self.factor(a) < 0.0) != (self.factor(b) < 0.0)
    }
}

impl Polar {
    /// Where radius and angle lead; what is not named stays.
    pub(crate) fn place(&mut self, now: [f64; 2], words: [Option<f64>; 2], by: bool) -> [f64; 2] {
        let here = || [now[0].hypot(now[1]), now[1].atan2(now[0]).to_degrees()];
        let last = self.last.unwrap_or_else(here);
        let named = |i: usize| match words[i] {
            Some(word) if by => last[i] + word,
            Some(word) => word,
            None => last[i],
        };
        let [radius, angle] = [named(0), named(1)];
        self.last = Some([radius, angle]);
        let (sin, cos) = angle.to_radians().sin_cos();
        [self.origin[0] + radius * cos, self.origin[1] + radius * sin]
    }
}
