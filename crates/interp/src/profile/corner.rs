//! Fillets and chamfers: a corner of two moves, rounded or cut off.
//!
//! ```text
//!   ──────────●───╮ fillet: the circle of radius r that touches both moves
//!              ╲   ╲         chamfer: the straight way between the same two points
//!   chamfer ──► ╲   ●
//!                   │
//! ```
use crate::{
    geometry::offset_curve::{Curve, Flat, Way, left, length, minus, plus, times, turn_rad},
    profile::shape::{Profile, Unfit},
};

/// What becomes of the corner at the end of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Corner {
    #[default]
    Sharp,
    Fillet(f64),
    Chamfer(f64),
}

/// The profile whose moves and corners these are.
pub(crate) fn profile(begin: Flat, moves: &[(Way, Corner)]) -> Result<Profile, Unfit> {
    let mut ways: Vec<Way> = Vec::with_capacity(moves.len());
    let mut corner = Corner::Sharp;
    for (way, next) in moves {
        let mut way = *way;
        let size = match corner {
            Corner::Sharp => None,
            Corner::Fillet(size) | Corner::Chamfer(size) => Some(size),
        };
        if let (Some(size), Some(before)) = (size, ways.last_mut())
            && let Some((first, centre, second)) = touches(before, &way, size)?
        {
            let turns = if turned(before, &way) > 0.0 { 1 } else { -1 };
            (before.to, way.from) = (first, second);
            let circle = matches!(corner, Corner::Fillet(_)).then_some((centre, turns));
            ways.push(Way { from: first, to: second, circle });
        }
        ways.push(way);
        corner = *next;
    }
    Ok(Profile { begin, ways })
}

fn turned(before: &Way, after: &Way) -> f64 {
    turn_rad(before.direction(before.to), after.direction(after.from))
}

/// Where a circle of this radius touches both moves, and its centre; nothing where they go on
/// straight.
fn touches(before: &Way, after: &Way, size: f64) -> Result<Option<(Flat, Flat, Flat)>, Unfit> {
    let turn = turned(before, after);
    if turn.abs() < 1e-6 {
        return Ok(None);
    }
    let unfit = Unfit::Corner(size, before.to);
    let side = turn.signum() * size;
    let (a, b) = (beside(before, before.to, side), beside(after, after.from, side));
    let centre = match (a, b) {
        (Some(a), Some(b)) => a.meets(&b, before.to).ok_or(unfit.clone())?,
        _ => return Err(unfit),
    };
    let [first, second] = [before, after].map(|way| foot(way, centre));
    let inside = before.reaches(first).is_some() && after.reaches(second).is_some();
    if inside { Ok(Some((first, centre, second))) } else { Err(unfit) }
}

/// The way this far to the left of another one.
pub(super) fn beside(way: &Way, from: Flat, side: f64) -> Option<Curve> {
    match way.circle {
        None => {
            let direction = way.direction(from);
            let from = plus(from, times(left(direction), side));
            Some(Curve::Line { from, through: from, direction })
        }
        Some((centre, turns)) => {
            let out = minus(from, centre);
            let radius = length(out) - f64::from(turns.signum()) * side;
            let from = plus(centre, times(out, radius / length(out)));
            let circle = Curve::Circle { from, centre, radius, turns, sweep_rad: 0.0 };
            (radius > 0.0).then_some(circle)
        }
    }
}

/// The point of a line or circle that is nearest.
fn foot(way: &Way, to: Flat) -> Flat {
    match way.circle {
        None => {
            let direction = way.direction(way.from);
            let along = crate::geometry::offset_curve::dot(minus(to, way.from), direction);
            plus(way.from, times(direction, along))
        }
        Some((centre, _)) => {
            let out = minus(to, centre);
            let radius = length(minus(way.from, centre));
            plus(centre, times(out, radius / length(out).max(f64::MIN_POSITIVE)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: Flat, to: Flat) -> Way {
        Way { from, to, circle: None }
    }

    #[test]
    fn a_right_angle_is_rounded_at_its_radius_from_the_corner() {
        let moves = [
            (line([0.0, 0.0], [4.0, 0.0]), Corner::Fillet(1.0)),
            (line([4.0, 0.0], [4.0, 3.0]), Corner::Sharp),
        ];
        let ways = profile([0.0, 0.0], &moves).unwrap().ways;
        let near = |a: Flat, b: Flat| length(minus(a, b)) < 1e-12;
        assert!(near(ways[0].to, [3.0, 0.0]) && near(ways[2].from, [4.0, 1.0]), "{ways:?}");
        assert!(
            ways[1].circle.is_some_and(|(centre, turns)| near(centre, [3.0, 1.0]) && turns == 1)
        );
    }

    #[test]
    fn a_fillet_longer_than_its_moves_does_not_fit() {
        let moves = [
            (line([0.0, 0.0], [4.0, 0.0]), Corner::Chamfer(3.5)),
            (line([4.0, 0.0], [4.0, 3.0]), Corner::Sharp),
        ];
        assert_eq!(profile([0.0, 0.0], &moves).unwrap_err(), Unfit::Corner(3.5, [4.0, 0.0]));
    }
}
