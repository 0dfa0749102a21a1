//! A profile as its blocks have told it so far, and what will be done with it.

use crate::{
    call::Place,
    geometry::{
        frame::Point,
        offset_curve::{Flat, Way, length, minus},
    },
    modes::Motion,
    profile::{
        corner::{self, Corner},
        roughing::Roughing,
        shape::{Profile, ProfileMove, Unfit},
    },
};
/// What has been taken down.
#[derive(Clone)]
pub(crate) struct Recording {
    /// What to do with it.
    pub(crate) order: ProfileOrder,
    /// The cycle's block.
    pub(crate) place: Place,
    /// Where the cycle begins: while a profile is taken down, the state's position is the
    /// profile's.
    pub(crate) start: Point,
    /// Errors before it.
    pub(crate) faults: u64,
    /// How deep the calls are where it is taken down.
    pub(crate) depth: usize,
    pub(crate) motion: Motion,
    pub(crate) begin: Option<Flat>,
    pub(crate) moves: Vec<(Way, Corner)>,
    /// Its last move is a rapid one.
    pub(crate) ends_rapidly: bool,
    /// F of the moves that have one.
    pub(crate) feeds: Vec<(usize, f64)>,
    /// G40, G41 and G42, each with how many moves stand before it, the one to the begin among them.
    pub(crate) sides: Vec<(usize, u16)>,
    pub(crate) warned: bool,
}

/// More moves than this are no profile.
pub(crate) const MAX_MOVES: usize = 10_000;

impl Recording {
    pub(crate) fn new(order: ProfileOrder, place: Place, start: Point) -> Self {
        Self {
            order,
            place,
            start,
            faults: 0,
            depth: 0,
            motion: Motion::Feed,
            begin: None,
            moves: Vec::new(),
            ends_rapidly: false,
            feeds: Vec::new(),
            sides: Vec::new(),
            warned: false,
        }
    }

    /// The motion of a block that names none.
    pub(crate) const fn motion(&self) -> Motion {
        self.motion
    }

    pub(crate) const fn go_on_with(&mut self, motion: Motion) {
        self.motion = motion;
    }

    /// All of it; none if it has no move.
    pub(crate) fn profile(&self) -> Option<Result<Profile, Unfit>> {
        let begin = self.begin.filter(|_| !self.moves.is_empty())?;
        Some(corner::profile(begin, &self.moves))
    }

    /// A block says on which side of the way the tool is.
    pub(crate) fn side(&mut self, code: u16) {
        self.sides.push((usize::from(self.begin.is_some()) + self.moves.len(), code));
    }

    /// Along it with the feeds of its blocks and on their side, and back: as it is finished on a
    /// Fanuc.
    pub(crate) fn with_feeds(&self, start: Flat) -> Vec<ProfileMove> {
        let side_before = |moves: usize| {
            let here = self.sides.iter().filter(move |(at, _)| *at == moves);
            here.map(|(_, code)| ProfileMove::Side(*code))
        };
        let mut strokes: Vec<_> = side_before(0).collect();
        strokes.extend(self.begin.map(ProfileMove::Rapid));
        let mut feeds = self.feeds.iter().peekable();
        for (i, (way, _)) in self.moves.iter().enumerate() {
            strokes.extend(side_before(i + 1));
            while let Some((_, feed)) = feeds.next_if(|(first, _)| *first <= i) {
                strokes.push(ProfileMove::Feed(*feed));
            }
            strokes.push(match way.circle {
                None => ProfileMove::Line(way.to),
                Some((centre, turns)) => ProfileMove::Arc { to: way.to, centre, turns },
            });
        }
        if self.sides.last().is_some_and(|(_, code)| *code != 400) {
            strokes.push(ProfileMove::Side(400));
        }
        strokes.push(ProfileMove::Rapid(start));
        strokes
    }

    /// The shape that is roughed: a rapid move at the end that leads back along the passes' way
    /// only takes the tool away.
    pub(crate) fn without_withdrawal(&self, mut shape: Profile, across: bool) -> Profile {
        let axis = usize::from(across);
        if let [.., before, last] = &shape.ways[..]
            && self.ends_rapidly
            && (before.to[axis] - shape.begin[axis]) * (last.to[axis] - last.from[axis]) < 0.0
        {
            shape.ways.pop();
        }
        shape
    }

    pub(crate) fn go(&mut self, way: Way, corner: Corner) {
        self.ends_rapidly = self.motion == Motion::Rapid;
        if self.begin.is_none() {
            self.begin = Some(if way.circle.is_some() { way.from } else { way.to });
            if way.circle.is_none() {
                return;
            }
        }
        if way.circle.is_some() || length(minus(way.to, way.from)) > 0.0 {
            self.moves.push((way, corner));
        }
    }
}

/// What is to be done with a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ProfileOrder {
    /// Along it, at distances that shrink from `first` towards `last`.
    Finish { first: f64, last: f64, passes: u32 },
    /// Clear what lies over it.
    Rough { across: bool, leave: f64, how: Roughing },
    /// Fanuc's G70: along it with its own feeds, and back to the start.
    Along,
    /// Fanuc's G71 and G72: what is left is a shift (Z, X).
    Shifted { across: bool, shift: Flat, how: Roughing },
    /// Fanuc's G73: along it so many times, from `relief` further away to `shift`.
    Repeat { relief: Flat, shift: Flat, times: u32 },
}
