//! A profile of lines and arcs, the strokes that cut it, and the frame in which passes see it.

use crate::geometry::offset_curve::{Flat, Way, length, minus, plus, turn_rad};
/// Two heights nearer than this are one.
pub(crate) const NEAR: f64 = 1e-6;

/// What programs round their coordinates to, and that as a share of an arc's radius.
const ROUNDING: f64 = 0.005;
const ROUNDING_SHARE: f64 = 1e-3;

/// What the tool's tip is to go along.
#[derive(Clone, Debug, Default)]
pub(crate) struct Profile {
    pub(crate) begin: Flat,
    pub(crate) ways: Vec<Way>,
}

/// One stroke of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ProfileMove {
    Rapid(Flat),
    Line(Flat),
    Arc {
        to: Flat,
        centre: Flat,
        turns: i32,
    },
    /// From here on.
    Feed(f64),
    /// From here on the tool is beside the way: G40, G41 or G42, in tenths.
    Side(u16),
}

/// Why a profile cannot be cut.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Unfit {
    /// It runs back along the passes' way, here.
    Back(Flat),
    /// A fillet or chamfer of this size does not fit in the corner.
    Corner(f64, Flat),
    /// The parallel profile at this distance has no room here.
    Parallel(f64, Flat),
}

impl Unfit {
    /// What was found in a frame, said of the workpiece.
    pub(crate) fn seen_from(self, facing: Facing) -> Self {
        self.at(|point| facing.back(point))
    }

    /// Said of a profile that lies beside the one in which it was found.
    pub(crate) fn shifted(self, by: Flat) -> Self {
        self.at(|point| plus(point, by))
    }

    fn at(self, place: impl Fn(Flat) -> Flat) -> Self {
        match self {
            Self::Back(point) => Self::Back(place(point)),
            Self::Corner(size, point) => Self::Corner(size, place(point)),
            Self::Parallel(distance, point) => Self::Parallel(distance, place(point)),
        }
    }
}

/// From [Z, X] to [u, v].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facing {
    /// Passes go along X.
    pub(crate) across: bool,
    /// Signs of u and v.
    pub(crate) along: f64,
    pub(crate) outwards: f64,
}

/// Not one of its ends.
pub(crate) fn strictly(point: Flat, way: &Way) -> bool {
    [way.from, way.to].iter().all(|end| length(minus(point, *end)) > NEAR)
}

impl Profile {
    /// Through other eyes.
    pub(crate) fn seen(&self, facing: Facing) -> Self {
        let way = |way: &Way| Way {
            from: facing.to(way.from),
            to: facing.to(way.to),
            circle: way.circle.map(|(centre, turns)| (facing.to(centre), turns * facing.sense())),
        };
        Self { begin: facing.to(self.begin), ways: self.ways.iter().map(way).collect() }
    }

    /// Moved as it is.
    pub(crate) fn shifted(&self, by: Flat) -> Self {
        let way = |way: &Way| Way {
            from: plus(way.from, by),
            to: plus(way.to, by),
            circle: way.circle.map(|(centre, turns)| (plus(centre, by), turns)),
        };
        Self { begin: plus(self.begin, by), ways: self.ways.iter().map(way).collect() }
    }

    /// Along it, from its begin.
    pub(crate) fn strokes(&self) -> impl Iterator<Item = ProfileMove> + '_ {
        self.ways.iter().map(|way| match way.circle {
            None => ProfileMove::Line(way.to),
            Some((centre, turns)) => ProfileMove::Arc { to: way.to, centre, turns },
        })
    }

    /// Where it ends.
    pub(crate) fn end(&self) -> Flat {
        self.ways.last().map_or(self.begin, |way| way.to)
    }

    /// On which side of its first move a point lies: 1 left, −1 right.
    pub(crate) fn side_of(&self, point: Flat) -> f64 {
        let Some(first) = self.ways.first() else { return 1.0 };
        let turn = turn_rad(first.direction(first.from), minus(point, first.from));
        if turn < 0.0 { -1.0 } else { 1.0 }
    }

    /// Never back along u. Arcs are parted where they are highest or lowest, so that each rises or
    /// falls only.
    pub(crate) fn parted(&self) -> Result<Self, Unfit> {
        let mut ways = Vec::with_capacity(self.ways.len());
        for way in &self.ways {
            if way.to[0] < way.from[0] - NEAR {
                return Err(Unfit::Back(way.to));
            }
            let Some((centre, turns)) = way.circle else {
                ways.push(*way);
                continue;
            };
            let radius = length(minus(way.from, centre));
            let inside = |point: Flat| way.reaches(point).filter(|_| strictly(point, way));
            let ends = [-radius, radius].map(|r| [centre[0] + r, centre[1]]);
            // the arc of a tangent begin or end turns back by what its numbers are rounded
            let rounding = ROUNDING.min(radius * ROUNDING_SHARE);
            let is_rounding = |turn: Flat| {
                [way.from, way.to].iter().any(|end| (turn[0] - end[0]).abs() < rounding)
            };
            let turns_back = |end: &Flat| inside(*end).is_some() && !is_rounding(*end);
            if let Some(turn) = ends.into_iter().find(turns_back) {
                return Err(Unfit::Back(turn));
            }
            let mut tops: Vec<_> = [-radius, radius]
                .into_iter()
                .map(|r| [centre[0], centre[1] + r])
                .filter_map(|top| inside(top).map(|turned| (turned, top)))
                .collect();
            tops.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut from = way.from;
            for to in tops.into_iter().map(|(_, top)| top).chain([way.to]) {
                ways.push(Way { from, to, circle: Some((centre, turns)) });
                from = to;
            }
        }
        Ok(Self { begin: self.begin, ways })
    }
}

impl Facing {
    /// A profile as roughing sees it: u runs from its begin to its end, and v too.
    pub(crate) fn of(profile: &Profile, across: bool) -> Self {
        let (begin, end) = (profile.begin, profile.end());
        let [u, v] = if across { [1, 0] } else { [0, 1] };
        let sign = |i: usize| if end[i] < begin[i] { -1.0 } else { 1.0 };
        // a shoulder, whose begin and end have one Z, is faced from the side of larger Z
        let shoulder = !across && end[u] == begin[u];
        Self { across, along: if shoulder { -1.0 } else { sign(u) }, outwards: sign(v) }
    }

    pub(crate) fn to(self, [z, x]: Flat) -> Flat {
        let [u, v] = if self.across { [x, z] } else { [z, x] };
        [u * self.along, v * self.outwards]
    }

    pub(crate) fn back(self, [u, v]: Flat) -> Flat {
        let [u, v] = [u * self.along, v * self.outwards];
        if self.across { [v, u] } else { [u, v] }
    }

    /// −1 if what turns left in one frame turns right in the other.
    pub(crate) fn sense(self) -> i32 {
        let mirrored = (self.along * self.outwards < 0.0) != self.across;
        if mirrored { -1 } else { 1 }
    }

    pub(crate) fn stroke(self, stroke: ProfileMove) -> ProfileMove {
        match stroke {
            ProfileMove::Rapid(to) => ProfileMove::Rapid(self.back(to)),
            ProfileMove::Line(to) => ProfileMove::Line(self.back(to)),
            ProfileMove::Arc { to, centre, turns } => ProfileMove::Arc {
                to: self.back(to),
                centre: self.back(centre),
                turns: turns * self.sense(),
            },
            ProfileMove::Feed(feed) => ProfileMove::Feed(feed),
            ProfileMove::Side(code) => ProfileMove::Side(code),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_over_the_top_is_parted_there() {
        let arc = Way { from: [-1.0, 0.0], to: [1.0, 0.0], circle: Some(([0.0, 0.0], -1)) };
        let parted = Profile { begin: [-1.0, 0.0], ways: vec![arc] }.parted().unwrap();
        let ends: Vec<_> = parted.ways.iter().map(|way| way.to).collect();
        assert_eq!(ends, [[0.0, 1.0], [1.0, 0.0]]);
    }

    #[test]
    fn an_arc_that_runs_back_is_no_profile() {
        let arc = Way { from: [0.0, -1.0], to: [0.5, 0.75f64.sqrt()], circle: Some(([0.0; 2], 1)) };
        let profile = Profile { begin: [0.0, -1.0], ways: vec![arc] };
        assert_eq!(profile.parted().unwrap_err(), Unfit::Back([1.0, 0.0]));
    }

    #[test]
    fn facing_there_and_back_changes_nothing() {
        for across in [false, true] {
            for (along, outwards) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let facing = Facing { across, along, outwards };
                assert_eq!(facing.back(facing.to([3.0, 7.0])), [3.0, 7.0]);
                let arc = Way { from: [1.0, 0.0], to: [0.0, 1.0], circle: Some(([0.0; 2], 1)) };
                let seen = Profile { begin: arc.from, ways: vec![arc] }.seen(facing);
                // a quarter of a turn stays one, seen from either side
                let (from, to) = (seen.ways[0].from, seen.ways[0].to);
                let turns = seen.ways[0].circle.unwrap().1;
                let cross = from[0] * to[1] - from[1] * to[0];
                assert_eq!(cross.signum(), f64::from(turns));
            }
        }
    }
}
