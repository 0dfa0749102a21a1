//! Lines and circles moved aside by the tool's radius, and where two of them meet: plane geometry.
//!
//! ```text
//!            offset line                    a tool on the left (side = +1) of
//!   ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ×  meets            a line:      start + r·n,  n = direction turned 90° left
//!   ━━━━━━━━━━━━━━━━━━┓ ╎                    a circle:    R′ = R − side·sense·r
//!        programmed   ┃ ╎ offset line          (sense +1: counter-clockwise)
//! ```
//!
//! Lengths in the program's units, angles in radians; points along the plane's first and second
//! axis.

/// A point, or a vector, of the plane.
pub(crate) type Flat = [f64; 2];

/// Nothing is nearer to zero than this and still a length.
const NOTHING: f64 = 1e-9;

pub(crate) fn plus(a: Flat, b: Flat) -> Flat {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn minus(a: Flat, b: Flat) -> Flat {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn times(a: Flat, k: f64) -> Flat {
    [a[0] * k, a[1] * k]
}

pub(crate) fn dot(a: Flat, b: Flat) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Flat, b: Flat) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn length(a: Flat) -> f64 {
    a[0].hypot(a[1])
}

/// Turned by 90° to the left.
pub(crate) fn left(a: Flat) -> Flat {
    [-a[1], a[0]]
}

/// Angle from one direction to another, −π to π, positive to the left.
pub(crate) fn turn_rad(from: Flat, to: Flat) -> f64 {
    cross(from, to).atan2(dot(from, to))
}

/// A move of the plane as programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Way {
    pub(crate) from: Flat,
    pub(crate) to: Flat,
    /// The circle, if it is one: centre and turns.
    pub(crate) circle: Option<(Flat, i32)>,
}

impl Way {
    /// Unit vector along it, at one of its ends.
    pub(crate) fn direction(&self, at: Flat) -> Flat {
        match self.circle {
            None => {
                let way = minus(self.to, self.from);
                times(way, 1.0 / length(way))
            }
            Some((centre, turns)) => {
                let out = minus(at, centre);
                times(left(out), f64::from(turns.signum()) / length(out))
            }
        }
    }

    /// How far along it a point of its line or circle lies, if it lies between its ends: a length,
    /// or radians.
    pub(crate) fn reaches(&self, point: Flat) -> Option<f64> {
        const SLACK: f64 = 1e-9;
        let (along, whole) = match self.circle {
            None => {
                let way = minus(self.to, self.from);
                (dot(minus(point, self.from), way) / length(way).max(NOTHING), length(way))
            }
            Some((centre, turns)) => {
                if length(minus(point, self.from)) < SLACK {
                    return Some(0.0);
                }
                let sweep = |to: Flat| sweep_rad(self.from, to, centre, turns.signum()).abs();
                (sweep(point), sweep(self.to))
            }
        };
        (-SLACK..=whole + SLACK).contains(&along).then_some(along)
    }
}

/// The way the tool's centre goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Curve {
    /// A straight way.
    Line {
        /// Where it begins.
        from: Flat,
        /// A point beside the programmed way: the first move reaches it only at its end.
        through: Flat,
        /// Unit vector.
        direction: Flat,
    },
    /// Part of a circle.
    Circle {
        /// Where it begins.
        from: Flat,
        centre: Flat,
        radius: f64,
        /// Turns begun, as in [`Call::Arc`](crate::Call::Arc).
        turns: i32,
        /// Largest angle that it may sweep: that of the programmed arc.
        sweep_rad: f64,
    },
    /// Fanuc's start-up: straight to beside the beginning of the move that follows, wherever that
    /// is.
    StartUp {
        /// Unit vector of the programmed move.
        direction: Flat,
    },
}

impl Curve {
    /// Direction of travel at one of its points.
    pub(crate) fn direction(&self, at: Flat) -> Flat {
        match *self {
            Self::Line { direction, .. } | Self::StartUp { direction } => direction,
            Self::Circle { centre, turns, .. } => {
                let out = minus(at, centre);
                times(left(out), f64::from(turns.signum()) / length(out).max(NOTHING))
            }
        }
    }

    /// Of its circle; of a line, 0.
    pub(crate) const fn radius(&self) -> f64 {
        match *self {
            Self::Line { .. } | Self::StartUp { .. } => 0.0,
            Self::Circle { radius, .. } => radius,
        }
    }

    /// Whether the tool would go backwards to end here.
    pub(crate) fn turns_back(&self, end: Flat) -> bool {
        match *self {
            Self::Line { from, direction, .. } => dot(minus(end, from), direction) <= 0.0,
            Self::StartUp { .. } => false,
            Self::Circle { from, centre, turns, sweep_rad: most, .. } => {
                // Inwards moves make the sweep shorter; past zero it is nearly a whole turn.
                let between = f64::midpoint(most.abs(), core::f64::consts::TAU);
                sweep_rad(from, end, centre, turns).abs() > between.max(most.abs() + 1e-3)
            }
        }
    }

    /// Where two curves meet, as near as possible to a point.
    pub(crate) fn meets(&self, other: &Self, near: Flat) -> Option<Flat> {
        let distance = |p: &Flat| length(minus(*p, near));
        let candidates = self.crossings(other, NOTHING).into_iter().flatten();
        candidates.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The points, two at most, that two curves have in common; circles may miss by `slack`, the
    /// square of the missing half chord.
    pub(crate) fn crossings(&self, other: &Self, slack: f64) -> [Option<Flat>; 2] {
        match (*self, *other) {
            (
                Self::Line { through: a, direction: u, .. },
                Self::Line { through: b, direction: v, .. },
            ) => {
                let across = cross(u, v);
                let met = plus(a, times(u, cross(minus(b, a), v) / across));
                [Some(met).filter(|_| across.abs() > NOTHING), None]
            }
            (Self::Line { through, direction, .. }, Self::Circle { centre, radius, .. })
            | (Self::Circle { centre, radius, .. }, Self::Line { through, direction, .. }) => {
                line_and_circle(through, direction, centre, radius, slack)
            }
            (
                Self::Circle { centre, radius, .. },
                Self::Circle { centre: centre_2, radius: radius_2, .. },
            ) => two_circles(centre, radius, centre_2, radius_2, slack),
            (Self::StartUp { .. }, _) | (_, Self::StartUp { .. }) => [None; 2],
        }
    }
}

fn line_and_circle(
    through: Flat,
    direction: Flat,
    centre: Flat,
    radius: f64,
    slack: f64,
) -> [Option<Flat>; 2] {
    let foot = plus(through, times(direction, dot(minus(centre, through), direction)));
    around(foot, direction, radius, length(minus(foot, centre)), slack)
}

fn two_circles(a: Flat, radius_a: f64, b: Flat, radius_b: f64, slack: f64) -> [Option<Flat>; 2] {
    let between = minus(b, a);
    let distance = length(between);
    if distance < NOTHING {
        return [None; 2];
    }
    let along = times(between, 1.0 / distance);
    let to_foot =
        (distance * distance + radius_a * radius_a - radius_b * radius_b) / (2.0 * distance);
    around(plus(a, times(along, to_foot)), left(along), radius_a, to_foot.abs(), slack)
}

/// The two points of a chord: half as long as the radius and the distance of its foot from the
/// centre leave.
fn around(foot: Flat, along: Flat, radius: f64, distance: f64, slack: f64) -> [Option<Flat>; 2] {
    let squared = radius * radius - distance * distance;
    if squared < -slack {
        return [None; 2];
    }
    let half = squared.max(0.0).sqrt();
    [half, -half].map(|k| Some(plus(foot, times(along, k))))
}

/// Angle swept from start to end about a centre, radians, counter-clockwise positive; ends in the
/// same direction mean a full turn.
pub(crate) fn sweep_rad(start: [f64; 2], end: [f64; 2], centre: [f64; 2], turns: i32) -> f64 {
    use core::f64::consts::TAU;
    /// Less than this is a full turn, not none.
    const FUZZ: f64 = 1e-6;
    let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
    let between = (angle(end) - angle(start)).rem_euclid(TAU);
    let more = f64::from(turns.abs().max(1) - 1) * TAU;
    if turns >= 0 {
        (if between < FUZZ { between + TAU } else { between }) + more
    } else {
        (if between < FUZZ { between } else { between - TAU }).min(0.0)
            - if between < FUZZ { TAU } else { 0.0 }
            - more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Flat, b: Flat) -> bool {
        length(minus(a, b)) < 1e-12
    }

    #[test]
    fn a_line_and_a_circle_meet_at_the_nearer_of_two_points() {
        // y = 1 and a circle of radius 5 about (0, 4): x = ±4.
        let line = Curve::Line { from: [-10.0, 1.0], through: [0.0, 1.0], direction: [1.0, 0.0] };
        let circle = Curve::Circle {
            from: [-5.0, 4.0],
            centre: [0.0, 4.0],
            radius: 5.0,
            turns: 1,
            sweep_rad: 3.0,
        };
        assert!(near(line.meets(&circle, [3.0, 0.0]).unwrap(), [4.0, 1.0]));
        assert!(near(circle.meets(&line, [-3.0, 0.0]).unwrap(), [-4.0, 1.0]));
    }

    #[test]
    fn circles_out_of_reach_do_not_meet() {
        let circle = |centre| Curve::Circle {
            from: [0.0; 2],
            centre,
            radius: 1.0,
            turns: 1,
            sweep_rad: 1.0,
        };
        assert_eq!(circle([0.0, 0.0]).meets(&circle([3.0, 0.0]), [0.0; 2]), None);
        assert!(near(circle([0.0, 0.0]).meets(&circle([2.0, 0.0]), [0.0; 2]).unwrap(), [1.0, 0.0]));
    }

    #[test]
    fn a_line_that_would_end_before_its_beginning_turns_back() {
        let line = Curve::Line { from: [1.0, 0.0], through: [1.0, 0.0], direction: [1.0, 0.0] };
        assert!(line.turns_back([0.5, 0.0]));
        assert!(!line.turns_back([1.5, 0.0]));
    }
}
