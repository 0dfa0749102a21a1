//! The strokes that clear what lies above a profile, level by level.
use crate::{
    geometry::offset_curve::{Flat, Way, length, minus},
    profile::shape::{NEAR, Profile, ProfileMove},
};

/// Which part of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// All: G71, G72.
    All,
    /// Down to the first pocket's bottom; later pockets are passed over: G71.1, G72.1.
    FirstPocket,
    /// The later pockets: G71.2, G72.2.
    LaterPockets,
}

/// Whose strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Manner {
    /// A pass at the start's own level too; back to over the begin of a pass at a slant.
    LinuxCnc,
    /// The first pass one step below the start; back to over the begin of a pass, and down from
    /// there.
    Fanuc,
}

/// How it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Roughing {
    pub(crate) part: Part,
    /// From level to level.
    pub(crate) step: f64,
    /// How far a pass comes away from the profile.
    pub(crate) retract: f64,
    pub(crate) manner: Manner,
}

/// All strokes from `start`, which lies over the profile and not beyond its begin.
pub(crate) fn rough(start: Flat, profile: &Profile, how: Roughing) -> Vec<ProfileMove> {
    let mut path = vec![Way { from: start, to: profile.begin, circle: None }];
    path.extend_from_slice(&profile.ways);
    let end = profile.end();
    if end[1] < start[1] - NEAR {
        path.push(Way { from: end, to: [end[0], start[1]], circle: None });
    }
    let level = start[1];
    let mut walk =
        Walk { path: &path, how, strokes: Vec::new(), level, anchor: true, at: start, first: true };
    walk.all();
    walk.strokes
}

struct Walk<'a> {
    path: &'a [Way],
    how: Roughing,
    strokes: Vec<ProfileMove>,
    /// The next one to be cut.
    level: f64,
    /// The levels count anew from where the path falls next.
    anchor: bool,
    at: Flat,
    /// Nothing but falling so far.
    first: bool,
}

impl Walk<'_> {
    fn all(&mut self) {
        for (i, way) in self.path.iter().enumerate() {
            let (from, to) = (way.from[1], way.to[1]);
            if to >= from - NEAR {
                if self.first && i > 0 || to > from + NEAR {
                    self.anchor |= self.how.part == Part::LaterPockets;
                }
                if self.first && i > 0 && self.how.part == Part::FirstPocket {
                    self.climb_only(i);
                    return;
                }
                self.first &= i == 0 && to <= from + NEAR;
                self.follow(i, way.to);
            } else if self.how.part == Part::LaterPockets && self.first {
                self.follow(i, way.to);
            } else {
                self.descend(i);
            }
        }
    }

    /// Along a part of the path that falls, with a pass at each level.
    fn descend(&mut self, i: usize) {
        let way = &self.path[i];
        let top = way.from[1];
        if core::mem::take(&mut self.anchor) {
            self.level = top;
        }
        let raise = ((top - self.level + NEAR) / self.how.step).floor().max(0.0);
        self.level += raise * self.how.step;
        if i == 0 && self.how.manner == Manner::Fanuc {
            self.level -= self.how.step;
        }
        while self.level > way.to[1] + NEAR {
            let from = crossing(way, self.level);
            self.follow(i, from);
            self.pass(i, from);
            self.level -= self.how.step;
        }
        self.follow(i, way.to);
    }

    /// One pass, and back to where it began.
    fn pass(&mut self, i: usize, from: Flat) {
        let level = from[1];
        let end = self.path[i + 1..].iter().find(|way| way.to[1] >= level - NEAR);
        let last = self.path.last().map_or(from, |way| way.to);
        let end = end.map_or(last[0], |way| crossing(way, level)[0]);
        self.say(ProfileMove::Line([end, level]));
        let away = self.how.retract.min((end - from[0]) / 2.0);
        self.say(ProfileMove::Rapid([end - away, level + away]));
        if i == 0 && self.how.manner == Manner::Fanuc {
            self.say(ProfileMove::Rapid([from[0], level + away]));
            return;
        }
        self.say(ProfileMove::Rapid([from[0] + away, level + away]));
        self.go(i, from);
    }

    /// Over all pockets that lie deeper than what was reached.
    fn climb_only(&mut self, i: usize) {
        let mut level = self.at[1];
        for (i, way) in self.path.iter().enumerate().skip(i) {
            if way.to[1] < level - NEAR {
                continue;
            }
            self.say(ProfileMove::Line(crossing(way, level)));
            self.follow(i, way.to);
            level = way.to[1];
        }
    }

    /// Along the path to a point of this part of it.
    fn follow(&mut self, i: usize, to: Flat) {
        match self.path[i].circle {
            Some((centre, turns)) => {
                if length(minus(to, self.at)) > NEAR {
                    self.say(ProfileMove::Arc { to, centre, turns });
                }
            }
            None => self.go(i, to),
        }
    }

    /// Straight; fast where there is no work: on the way in, downwards.
    fn go(&mut self, i: usize, to: Flat) {
        let way = &self.path[i];
        let air = i == 0 && way.to[1] <= way.from[1] + NEAR;
        self.say(if air { ProfileMove::Rapid(to) } else { ProfileMove::Line(to) });
    }

    fn say(&mut self, stroke: ProfileMove) {
        // an arc through its lowest point is one stroke
        if let (
            ProfileMove::Arc { to, centre, .. },
            Some(ProfileMove::Arc { to: before, centre: c, .. }),
        ) = (stroke, self.strokes.last_mut())
            && *c == centre
            && before[1] < centre[1]
            && (before[0] - centre[0]).abs() < NEAR
            && to[1] > before[1]
        {
            *before = to;
            self.at = to;
            return;
        }
        if let ProfileMove::Rapid(to) | ProfileMove::Line(to) | ProfileMove::Arc { to, .. } = stroke
        {
            self.at = to;
        }
        self.strokes.push(stroke);
    }
}

/// Where a way that only rises or only falls is at a height.
fn crossing(way: &Way, height: f64) -> Flat {
    let (low, high) = (way.from[0].min(way.to[0]), way.from[0].max(way.to[0]));
    if (height - way.from[1]).abs() <= NEAR {
        return [way.from[0], height];
    }
    let u = match way.circle {
        None => {
            let part = (height - way.from[1]) / (way.to[1] - way.from[1]);
            way.from[0] + part * (way.to[0] - way.from[0])
        }
        Some((centre, _)) => {
            let radius = length(minus(way.from, centre));
            let half = (radius * radius - (height - centre[1]).powi(2)).max(0.0).sqrt();
            let out = |u: &f64| (low - u).max(u - high);
            let sides = [centre[0] - half, centre[0] + half];
            if out(&sides[0]) <= out(&sides[1]) { sides[0] } else { sides[1] }
        }
    };
    [u.clamp(low, high), height]
}

#[cfg(test)]
mod tests {
    use super::*;
    use ProfileMove::{Line, Rapid};

    fn line(from: Flat, to: Flat) -> Way {
        Way { from, to, circle: None }
    }

    #[test]
    fn a_step_is_cut_in_passes_that_end_at_it() {
        let ways = vec![line([0.0, 1.0], [10.0, 1.0]), line([10.0, 1.0], [10.0, 5.0])];
        let profile = Profile { begin: [0.0, 1.0], ways };
        let how = Roughing { part: Part::All, step: 2.0, retract: 0.5, manner: Manner::LinuxCnc };
        let wanted = [
            Rapid([0.0, 5.0]),
            Line([10.0, 5.0]),
            Rapid([9.5, 5.5]),
            Rapid([0.5, 5.5]),
            Rapid([0.0, 5.0]),
            Rapid([0.0, 3.0]),
            Line([10.0, 3.0]),
            Rapid([9.5, 3.5]),
            Rapid([0.5, 3.5]),
            Rapid([0.0, 3.0]),
            Rapid([0.0, 1.0]),
            Line([10.0, 1.0]),
            Line([10.0, 5.0]),
        ];
        assert_eq!(rough([0.0, 5.0], &profile, how), wanted);
    }

    #[test]
    fn no_stroke_goes_below_the_profile_and_no_level_is_left_uncut() {
        // a V-shaped pocket in a plain: height above it is |u − 5| up to 3
        let ways = vec![
            line([0.0, 3.0], [2.0, 3.0]),
            line([2.0, 3.0], [5.0, 0.0]),
            line([5.0, 0.0], [8.0, 3.0]),
            line([8.0, 3.0], [9.0, 3.0]),
        ];
        let profile = Profile { begin: [0.0, 3.0], ways };
        for (step, part) in [(0.7, Part::All), (1.0, Part::All), (0.9, Part::LaterPockets)] {
            let how = Roughing { part, step, retract: 0.2, manner: Manner::LinuxCnc };
            let mut at = [-1.0, 4.0];
            let mut lowest = 4.0f64;
            for stroke in rough(at, &profile, how) {
                let (ProfileMove::Rapid(to) | ProfileMove::Line(to) | ProfileMove::Arc { to, .. }) =
                    stroke
                else {
                    continue;
                };
                for k in 0..=20 {
                    let t = f64::from(k) / 20.0;
                    let [u, v] = [at[0] + t * (to[0] - at[0]), at[1] + t * (to[1] - at[1])];
                    let floor = if u < 0.0 { -1.0 } else { (u - 5.0).abs().min(3.0) };
                    assert!(v >= floor - 1e-9, "{stroke:?} at {u} {v}");
                }
                if let ProfileMove::Line(to) = stroke
                    && to[1] == at[1]
                    && to[1] < 3.0
                {
                    assert!(lowest - to[1] <= step + 1e-9, "{lowest} {to:?}");
                    lowest = to[1];
                }
                lowest = lowest.min(at[1].max(3.0));
                at = to;
            }
            assert!(lowest <= step + 1e-9, "{lowest}");
        }
    }
}
