//! The profile at a distance from another one: what is left for finishing.
//!
//! ```text
//!        ╭─ ─ ─ ─ ─        outside of a corner: an arc about it
//!      ╱ ┌─────────
//!     ╎  │                 inside of a corner: where the two parallels meet
//!     ╎  │    ─ ─ ─ ─ ┐ ─
//!            ─────────┘
//! ```
use crate::{
    geometry::offset_curve::{
        Curve, Flat, Way, dot, length, minus, plus, sweep_rad, times, turn_rad,
    },
    profile::{
        corner::beside,
        shape::{NEAR, Profile, Unfit},
    },
};

/// Corners flatter than this are none.
const STRAIGHT_ON_RAD: f64 = 1e-6;

/// A gap in the outside of a corner that is no longer than this along u, however high, is closed
/// where the parallels meet, not by an arc: so LinuxCNC does, as measured on 48 corners.
const NO_ARC: f64 = 0.01;
/// Moves that turn by less touch each other, as drawn; their parallels may miss each other a
/// little: by half a chord of this angle.
const TOUCHING_RAD: f64 = 0.02;

/// To the left by this distance; to the right if it is negative.
pub(crate) fn parallel(profile: &Profile, distance: f64) -> Result<Profile, Unfit> {
    if distance == 0.0 {
        return Ok(profile.clone());
    }
    let mut ways: Vec<Way> = Vec::with_capacity(2 * profile.ways.len());
    let mut before: Option<&Way> = None;
    for way in profile.ways.iter().filter(|way| length(minus(way.to, way.from)) > 0.0) {
        let unfit = || Unfit::Parallel(distance.abs(), way.from);
        let mut new = moved(way, distance).ok_or_else(unfit)?;
        if let (Some(before), Some(last)) = (before, ways.last_mut()) {
            let turn = turn_rad(before.direction(way.from), way.direction(way.from));
            let gap = (new.from[0] - last.to[0]).abs();
            let outside = turn * distance < 0.0;
            let closed = !(outside && gap > NO_ARC) && turn.abs() > STRAIGHT_ON_RAD;
            let reach = if outside { length(minus(new.from, last.to)) } else { 0.0 };
            let met = if closed { joint(last, &new, turn, reach) } else { None };
            if let Some(met) = met {
                (last.to, new.from) = (met, met);
            } else if outside && (closed || gap > NO_ARC) {
                let circle = Some((way.from, if turn > 0.0 { 1 } else { -1 }));
                let round = Way { from: last.to, to: new.from, circle };
                ways.push(round);
            } else if closed {
                return Err(unfit());
            }
        }
        ways.push(new);
        before = Some(way);
    }
    let begin = ways.first().map_or(profile.begin, |way| way.from);
    Ok(Profile { begin, ways })
}

/// Where one parallel way ends and the next begins; arcs may go on by `reach` to meet.
fn joint(last: &Way, new: &Way, turn: f64, reach: f64) -> Option<Flat> {
    let (a, b) = (curve(last, last.from), curve(new, new.to));
    let touching = turn.abs() < TOUCHING_RAD;
    let miss = if touching { TOUCHING_RAD * a.radius().max(b.radius()) } else { 0.0 };
    let met = a.crossings(&b, (miss * miss).max(f64::EPSILON));
    let fits = |met: &Flat| ends(last, *met, reach) && begins(new, *met, reach);
    let met = met.into_iter().flatten().filter(fits);
    if touching {
        // both are equally near: the earlier one, which makes the way before shorter
        let early = |p: &Flat| dot(minus(*p, last.to), last.direction(last.to));
        return met.min_by(|a, b| early(a).total_cmp(&early(b)));
    }
    let distance = |p: &Flat| length(minus(*p, last.to));
    met.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// A way moved to its left; none if it is an arc that has no room there.
fn moved(way: &Way, distance: f64) -> Option<Way> {
    beside(way, way.from, distance)?;
    let end = |at: Flat| {
        plus(at, times(crate::geometry::offset_curve::left(way.direction(at)), distance))
    };
    Some(Way { from: end(way.from), to: end(way.to), circle: way.circle })
}

/// As a line or circle, which passes through its end away from the joint.
fn curve(way: &Way, far: Flat) -> Curve {
    match way.circle {
        None => {
            Curve::Line { from: way.from, through: way.from, direction: way.direction(way.from) }
        }
        Some((centre, turns)) => Curve::Circle {
            from: way.from,
            centre,
            radius: length(minus(far, centre)),
            turns,
            sweep_rad: 0.0,
        },
    }
}

/// Whether a way can end at a point of its line or circle without turning back.
fn ends(way: &Way, point: Flat, reach: f64) -> bool {
    match way.circle {
        None => dot(minus(point, way.from), minus(way.to, way.from)) >= 0.0,
        Some((centre, turns)) => {
            let sweep = |to: Flat| sweep_rad(way.from, to, centre, turns).abs();
            let more = TOUCHING_RAD + reach / length(minus(way.from, centre));
            length(minus(point, way.from)) < NEAR || sweep(point) <= sweep(way.to) + more
        }
    }
}

/// Whether it can begin there.
fn begins(way: &Way, point: Flat, reach: f64) -> bool {
    let circle = way.circle.map(|(centre, turns)| (centre, -turns));
    ends(&Way { from: way.to, to: way.from, circle }, point, reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: Flat, to: Flat) -> Way {
        Way { from, to, circle: None }
    }

    #[test]
    fn an_outer_corner_gets_an_arc_and_an_inner_one_a_meeting_point() {
        // along u, up, along: the first corner is inner for what lies to the left, the second outer
        let ways =
            vec![line([0., 0.], [4., 0.]), line([4., 0.], [4., 3.]), line([4., 3.], [9., 3.])];
        let found = parallel(&Profile { begin: [0.0; 2], ways }, 0.5).unwrap();
        let wanted = [
            line([0.0, 0.5], [3.5, 0.5]),
            line([3.5, 0.5], [3.5, 3.0]),
            Way { from: [3.5, 3.0], to: [4.0, 3.5], circle: Some(([4.0, 3.0], -1)) },
            line([4.0, 3.5], [9.0, 3.5]),
        ];
        assert_eq!(found.ways, wanted);
        assert_eq!(found.begin, [0.0, 0.5]);
    }

    #[test]
    fn a_groove_narrower_than_twice_the_distance_has_no_room() {
        let ways = vec![
            line([0., 5.], [2., 5.]),
            line([2., 5.], [2., 0.]),
            line([2., 0.], [2.8, 0.]),
            line([2.8, 0.], [2.8, 5.]),
        ];
        let found = parallel(&Profile { begin: [0.0, 5.0], ways }, 0.5);
        assert!(matches!(found, Err(Unfit::Parallel(..))), "{found:?}");
    }
}
