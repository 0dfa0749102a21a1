//! How far a slide, a table or a disk is from where its encoder puts it: what compensation takes
//! off.
//!
//! ```text
//!   ε │        ╭──● up          x = d + ε(d, w)
//!     │    ●───╯                ε = down + w·(up − down) + b·(½ − w) + Σ a·sin 2π(n·d/T + φ)
//!     │●──╮    ╭──● down
//!     │   ╰●───╯                between two points a cubic (PCHIP): no overshoot, no kink;
//!     └────────────────► d      behind the last point the slope runs out over its last interval
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | d | position by the encoder, in machine coordinates | mm, ° or rev |
//! | x | where the slide is | as d |
//! | ε | deviation x − d of ISO 230-2: positive where the slide is too far towards plus | as d |
//! | w | flank: 1 when the slide was driven towards plus last, 0 towards minus | 1 |
//! | b | play, of which a motor's encoder sees nothing | as d |
//! | a, n, φ, T | amplitude, order and phase of a wave; turn of screw, worm or disk | as d, 1, rev, as d |
//!
//! Since |ε′| is small, d is found from x by Newton's method: three steps leave less than 10⁻¹² of
//! a millimetre.
//!
//! Sources: ISO 230-2 (deviation, bidirectional); Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5
//! (1984) 300–304 (slopes of the cubics).
use alloc::vec::Vec;
use core::f64::consts::TAU;
use libm::{fabs, floor, fmax, fmin, sincos, sqrt};

/// Steps of Newton's method at most.
const STEPS: u32 = 8;
/// A position has been found within this share of itself, or of one unit.
const FOUND: f64 = 2e-15;

/// Deviation at a position, for both senses of approach.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationPoint {
    /// Position by the encoder.
    pub at: f64,
    /// Deviation of a slide that has come towards plus.
    pub up: f64,
    /// Deviation of a slide that has come towards minus.
    pub down: f64,
}

/// Error that repeats with the turn of a screw, a worm or a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationWave {
    /// Waves in a turn.
    pub order: u32,
    /// Half of the distance from crest to trough.
    pub amplitude: f64,
    /// Phase at position zero, rev.
    pub phase_rev: f64,
}

/// Measured errors of one axis or of one spindle's encoder.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationTable {
    /// Points, whose positions rise; none, or two at least.
    pub points: Vec<DeviationPoint>,
    /// Length after which the points repeat; `None` if they do not.
    pub repeats: Option<f64>,
    /// Errors per turn.
    pub waves: Vec<DeviationWave>,
    /// Turn of the waves.
    pub turn: f64,
    /// Play.
    pub backlash: f64,
}

/// A deviation with its derivatives by the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviationValue {
    /// Deviation.
    pub value: f64,
    /// First derivative.
    pub slope: f64,
    /// Second derivative.
    pub curvature: f64,
}

impl DeviationValue {
    fn with(self, other: Self, share: f64) -> Self {
        Self {
            value: self.value + share * other.value,
            slope: self.slope + share * other.slope,
            curvature: self.curvature + share * other.curvature,
        }
    }
}

/// Values of one sense at the points, with the slopes there.
#[derive(Clone, Debug)]
struct Branch {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// A [`DeviationTable`] made ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Deviation {
    at: Vec<f64>,
    down: Branch,
    up: Branch,
    repeats: Option<f64>,
    waves: Vec<DeviationWave>,
    per_turn: f64,
    backlash: f64,
}

impl Deviation {
    /// Makes a table ready. What it says is taken as it is: the reader of its file has checked it.
    pub fn new(table: &DeviationTable) -> Self {
        let mut points: Vec<DeviationPoint> = table.points.clone();
        // a table that repeats is closed by its first point
        if let (Some(length), Some(first)) = (table.repeats, points.first().copied()) {
            let closing = first.at + length;
            points.retain(|point| point.at < closing);
            points.push(DeviationPoint { at: closing, ..first });
        }
        let at: Vec<f64> = points.iter().map(|point| point.at).collect();
        let branch = |of: fn(&DeviationPoint) -> f64| {
            let values: Vec<f64> = points.iter().map(of).collect();
            let slopes = slopes(&at, &values, table.repeats.is_some());
            Branch { values, slopes }
        };
        Self {
            down: branch(|point| point.down),
            up: branch(|point| point.up),
            at,
            repeats: table.repeats,
            waves: table.waves.clone(),
            per_turn: if table.turn > 0.0 { 1.0 / table.turn } else { 0.0 },
            backlash: table.backlash,
        }
    }

    /// Deviation at a position by the encoder; `flank` is 1 for a slide that has come towards plus.
    pub fn at(&self, position: f64, flank: f64) -> DeviationValue {
        let mut base = self.waves(position);
        base.value += self.backlash * (0.5 - flank);
        let Some((piece, from, length)) = self.piece(position) else { return base };
        let down = self.down.at(piece, from, length);
        let up = self.up.at(piece, from, length);
        base.with(down, 1.0 - flank).with(up, flank)
    }

    /// By how much the deviation grows from one flank to the other.
    pub fn across(&self, position: f64) -> f64 {
        let Some((piece, from, length)) = self.piece(position) else { return -self.backlash };
        let (down, up) = (self.down.at(piece, from, length), self.up.at(piece, from, length));
        up.value - down.value - self.backlash
    }

    /// Position by the encoder at which the slide is here.
    pub fn encoder_position(&self, slide: f64, flank: f64) -> f64 {
        let mut position = slide - self.at(slide, flank).value;
        for _ in 0..STEPS {
            let here = self.at(position, flank);
            let apart = position + here.value - slide;
            position -= apart / (1.0 + here.slope);
            if fabs(apart) <= FOUND * fmax(fabs(slide), 1.0) {
                break;
            }
        }
        position
    }

    /// Errors of a turn alone.
    fn waves(&self, position: f64) -> DeviationValue {
        let mut sum = DeviationValue::default();
        for wave in &self.waves {
            let rate = TAU * f64::from(wave.order) * self.per_turn;
            let turns = f64::from(wave.order) * self.per_turn * position + wave.phase_rev;
            let (sin, cos) = sincos(TAU * (turns - floor(turns)));
            sum.value += wave.amplitude * sin;
            sum.slope += wave.amplitude * rate * cos;
            sum.curvature -= wave.amplitude * rate * rate * sin;
        }
        sum
    }

    /// The interval of a position, how far within it the position is, and the interval's length.
    fn piece(&self, position: f64) -> Option<(usize, f64, f64)> {
        let (first, last) = (*self.at.first()?, *self.at.last()?);
        let position = match self.repeats {
            Some(length) => {
                let turns = (position - first) / length;
                first + (turns - floor(turns)) * length
            }
            None => position,
        };
        if self.at.len() < 2 {
            return Some((0, 0.0, 1.0));
        }
        let most = self.at.len() - 2;
        let piece = self.at.partition_point(|at| *at <= position).saturating_sub(1).min(most);
        let length = self.at[piece + 1] - self.at[piece];
        // no farther out than the slope needs to run out
        let position = fmin(fmax(position, first - length), last + length);
        Some((piece, position - self.at[piece], length))
    }

    /// Largest absolute value of the deviation at the points with the waves at their largest, and
    /// where that is.
    pub fn largest(&self) -> (f64, f64) {
        let waves: f64 = self.waves.iter().map(|wave| fabs(wave.amplitude)).sum();
        let half = self.backlash / 2.0;
        let mut found = (0.0, fabs(half) + waves);
        for (index, at) in self.at.iter().enumerate() {
            let (up, down) = (self.up.values[index] - half, self.down.values[index] + half);
            let here = fmax(fabs(up), fabs(down)) + waves;
            if here > found.1 || index == 0 {
                found = (*at, here);
            }
        }
        found
    }

    /// Largest absolute slope and largest absolute second derivative of the points' curves.
    pub fn bounds_of_points(&self) -> (f64, f64) {
        let mut most = (0.0, 0.0);
        for piece in 0..self.at.len().saturating_sub(1) {
            let length = self.at[piece + 1] - self.at[piece];
            for branch in [&self.down, &self.up] {
                let (slope, curvature) = branch.bounds(piece, length);
                most = (fmax(most.0, slope), fmax(most.1, curvature));
            }
        }
        most
    }

    /// Largest slope and largest second derivative of the errors per turn.
    pub fn bounds_of_waves(&self) -> (f64, f64) {
        self.waves.iter().fold((0.0, 0.0), |(slope, curvature), wave| {
            let rate = TAU * f64::from(wave.order) * self.per_turn;
            let amplitude = fabs(wave.amplitude);
            (slope + amplitude * rate, curvature + amplitude * rate * rate)
        })
    }

    /// Largest change of the deviation where the slide turns back.
    pub fn reversal(&self) -> f64 {
        let mut most = if self.at.is_empty() { fabs(self.backlash) } else { 0.0 };
        for (index, at) in self.at.iter().enumerate() {
            let next = self.at.get(index + 1).copied().unwrap_or(*at);
            for at in [*at, 0.5 * (at + next)] {
                most = fmax(most, fabs(self.across(at)));
            }
        }
        // behind the ends, where the slopes have run out
        for end in [f64::NEG_INFINITY, f64::INFINITY] {
            if self.repeats.is_none() && !self.at.is_empty() {
                most = fmax(most, fabs(self.across(end)));
            }
        }
        most
    }

    /// The acceleration that is left for turning back of all that compensation may take beside its
    /// points and waves, for an axis that may go at this speed meanwhile:
    /// r + 2·|ε′up − ε′down|·v·√(r/b) = left.
    pub fn reversal_acceleration(&self, left: f64, speed: f64) -> f64 {
        let (mut apart, reversal) = (0.0, self.reversal());
        for piece in 0..self.at.len().saturating_sub(1) {
            let length = self.at[piece + 1] - self.at[piece];
            let values = |branch: &Branch| [branch.values[piece], branch.values[piece + 1]];
            let slopes = |branch: &Branch| [branch.slopes[piece], branch.slopes[piece + 1]];
            let off = |of: &dyn Fn(&Branch) -> [f64; 2]| {
                let (up, down) = (of(&self.up), of(&self.down));
                Vec::from([up[0] - down[0], up[1] - down[1]])
            };
            let difference = Branch { values: off(&values), slopes: off(&slopes) };
            apart = fmax(apart, difference.bounds(0, length).0);
        }
        if reversal <= 0.0 {
            return left;
        }
        let half = apart * speed / sqrt(reversal);
        let root = sqrt(half * half + left) - half;
        root * root
    }

    /// Positions of the points.
    pub fn points(&self) -> &[f64] {
        &self.at
    }
}

impl Branch {
    /// At a distance from the beginning of an interval; outside of it the slope runs out over the
    /// interval's length.
    fn at(&self, piece: usize, from: f64, length: f64) -> DeviationValue {
        let Some(next) = self.values.get(piece + 1) else {
            return DeviationValue { value: self.values[piece], ..DeviationValue::default() };
        };
        let (before, slopes) = (self.values[piece], (self.slopes[piece], self.slopes[piece + 1]));
        if from < 0.0 || from > length {
            let (value, slope, out) = if from < 0.0 {
                (before, slopes.0, from)
            } else {
                (*next, slopes.1, from - length)
            };
            let bend = slope / length;
            let sign = if out < 0.0 { -1.0 } else { 1.0 };
            let ends = fabs(out) >= length;
            return DeviationValue {
                value: value + out * (slope - sign * bend * out / 2.0),
                slope: if ends { 0.0 } else { slope - sign * bend * out },
                curvature: if ends { 0.0 } else { -sign * bend },
            };
        }
        let (square, cube) = self.cubic(piece, length);
        DeviationValue {
            value: before + from * (slopes.0 + from * (square + from * cube)),
            slope: slopes.0 + from * (2.0 * square + from * 3.0 * cube),
            curvature: 2.0 * square + from * 6.0 * cube,
        }
    }

    /// Coefficients of the square and of the cube.
    fn cubic(&self, piece: usize, length: f64) -> (f64, f64) {
        let (from, to) = (self.slopes[piece], self.slopes[piece + 1]);
        let secant = (self.values[piece + 1] - self.values[piece]) / length;
        ((3.0 * secant - 2.0 * from - to) / length, (from + to - 2.0 * secant) / (length * length))
    }

    /// Largest absolute slope and second derivative within an interval, and behind the ends.
    fn bounds(&self, piece: usize, length: f64) -> (f64, f64) {
        let (from, to) = (self.slopes[piece], self.slopes[piece + 1]);
        let (square, cube) = self.cubic(piece, length);
        let curvature = fmax(fabs(2.0 * square), fabs(2.0 * square + 6.0 * cube * length));
        let outside = fmax(fabs(from), fabs(to)) / length;
        let mut slope = fmax(fabs(from), fabs(to));
        // the slope is a parabola: its vertex may lie within
        let vertex = -square / (3.0 * cube);
        if vertex > 0.0 && vertex < length {
            slope = fmax(slope, fabs(from + vertex * (2.0 * square + vertex * 3.0 * cube)));
        }
        let is_end = piece == 0 || piece + 2 == self.values.len();
        (slope, if is_end { fmax(curvature, outside) } else { curvature })
    }
}

/// Slopes at the points: the weighted harmonic mean of the secants beside, zero at an extreme.
fn slopes(at: &[f64], values: &[f64], closed: bool) -> Vec<f64> {
    let intervals = at.len().saturating_sub(1);
    let length = |piece: usize| at[piece + 1] - at[piece];
    let secant = |piece: usize| (values[piece + 1] - values[piece]) / length(piece);
    if intervals < 2 {
        let slope = if intervals == 1 && !closed { secant(0) } else { 0.0 };
        return at.iter().map(|_| slope).collect();
    }
    let inner = |before: usize, after: usize| {
        let (left, right) = (secant(before), secant(after));
        if left * right <= 0.0 {
            return 0.0;
        }
        let (first, second) =
            (2.0 * length(after) + length(before), length(after) + 2.0 * length(before));
        (first + second) / (first / left + second / right)
    };
    let end = |near: usize, far: usize| {
        let (h, next, slope, other) = (length(near), length(far), secant(near), secant(far));
        let found = ((2.0 * h + next) * slope - h * other) / (h + next);
        if found * slope <= 0.0 {
            0.0
        } else if slope * other <= 0.0 && fabs(found) > fabs(3.0 * slope) {
            3.0 * slope
        } else {
            found
        }
    };
    let last = intervals - 1;
    let of = |point: usize| match (point == 0, point == intervals) {
        (true, _) | (_, true) if closed => inner(last, 0),
        (true, _) => end(0, 1),
        (_, true) => end(last, last - 1),
        (false, false) => inner(point - 1, point),
    };
    (0..at.len()).map(of).collect()
}

#[cfg(test)]
#[path = "deviation_tests.rs"]
mod tests;
