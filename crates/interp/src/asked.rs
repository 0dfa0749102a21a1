//! What a stretch of execution has asked for of how things stood before it.
//!
//! ```text
//!   G90 G1 X1 Y2      asks for nothing of the place: X and Y are named
//!   G91 X1            moves on from wherever it stands: that much farther, if it stood farther
//!   G2 X5 I2          asks where X and Y stand, unless a block before it has named them
//!   #1=[#2+1]         asks for #2
//!   T2 M6             asks for more than is noted here
//! ```
//!
//! So the end of such a stretch is known, without executing it again, where things stand before it as they stood then
//! but for what it did not ask for ([`Snapshot::carried`](crate::Snapshot::carried)). All that is not plainly
//! one of the blocks a program has by the thousand counts as asking for more.
use crate::{
    codes::{self, AXES, GGroup, POLAR},
    execute::Executor,
    names::ARGUMENTS,
    setup::Dialect,
    state::{Cycle, FeedMode, Motion},
};
use core::cell::Cell;

/// Parameters beginning here tell how things stand.
const SYSTEM: usize = 5000;

/// What was asked for, and what was set.
#[allow(clippy::struct_excessive_bools)] // each is a fact of its own
#[derive(Clone, Debug, Default)]
pub(crate) struct Asked {
    /// More than is noted.
    more: Cell<bool>,
    /// Parameters, as [`of_number`] and [`of_name`] mix them.
    read: Cell<u128>,
    assigned: u128,
    /// Axes whose place mattered before it was named, and those that were named with G90: a bit each.
    place: u16,
    named: u16,
    /// F was set; a motion was named, and before any other a cycle or its end; G98 or G99 was.
    pub(crate) feed: bool,
    pub(crate) motion: bool,
    pub(crate) cycle: bool,
    pub(crate) retract: bool,
    /// What plane is in force, and which units.
    pub(crate) plane: bool,
    pub(crate) units: bool,
    /// Speed and sense of the spindle, and its tool.
    pub(crate) spindle: bool,
    /// From where a cycle began, or where cycles return to.
    pub(crate) initial: bool,
    /// Holes were made that begin and end at levels of their own: see [`Executor::ask_hole`].
    pub(crate) holes: bool,
    /// Something moved that makes no hole.
    pub(crate) moves: bool,
    /// Subprograms began or ended: #1 to #30 are others there.
    pub(crate) calls: bool,
    /// How many more began than ended.
    depth: i32,
    /// Words that a control keeps for its variables: a bit each of those that were set.
    kept: Cell<u8>,
    /// Numbers of a tape's blocks that were looked for: a bit each, by the remainder.
    jumps: Vec<u64>,
}

/// Blocks of a tape that are told apart where one was looked for.
const JUMPS: usize = 1 << 13;

/// A numbered parameter's bit.
pub(crate) const fn of_number(number: usize) -> u128 {
    1 << (number % 128)
}

/// A named parameter's bit.
pub(crate) fn of_name(name: &str) -> u128 {
    let hash =
        name.bytes().fold(7_u32, |hash, byte| hash.wrapping_mul(31).wrapping_add(u32::from(byte)));
    1 << (hash % 128)
}

impl Asked {
    /// For something that is not noted.
    pub(crate) fn more(&self) {
        self.more.set(true);
    }

    pub(crate) fn number(&self, number: usize) {
        if number >= SYSTEM {
            self.more();
        }
        if !self.is_an_argument(number) {
            self.read.set(self.read.get() | of_number(number));
        }
    }

    /// Of a call that began in this stretch: whoever was there before it has others.
    const fn is_an_argument(&self, number: usize) -> bool {
        self.depth > 0 && number <= ARGUMENTS
    }

    /// A numbered parameter is set.
    pub(crate) const fn sets(&mut self, number: usize) {
        if !self.is_an_argument(number) {
            self.assigned |= of_number(number);
        }
    }

    /// A subprogram of O-words begins.
    pub(crate) const fn enters(&mut self) {
        (self.calls, self.depth) = (true, self.depth.saturating_add(1));
    }

    /// It ends.
    pub(crate) const fn leaves(&mut self) {
        (self.calls, self.depth) = (true, self.depth.saturating_sub(1));
    }

    /// A tape's block N of this number is looked for.
    pub(crate) fn jumps(&mut self, number: u32) {
        self.jumps.resize(JUMPS / 64, 0);
        let bit = number as usize % JUMPS;
        self.jumps[bit / 64] |= 1 << (bit % 64);
    }

    /// Whether one of these blocks may have been looked for.
    pub(crate) fn jumps_to(&self, numbers: &[u32]) -> bool {
        numbers.iter().any(|number| {
            let bit = *number as usize % JUMPS;
            self.jumps.get(bit / 64).is_some_and(|bits| bits >> (bit % 64) & 1 == 1)
        })
    }

    /// A word is kept for variables to tell.
    pub(crate) fn keeps(&self, word: usize) {
        self.kept.set(self.kept.get() | 1 << word);
    }

    /// Whether it is not what it was.
    pub(crate) const fn kept(&self, word: usize) -> bool {
        self.kept.get() >> word & 1 == 1
    }

    pub(crate) fn name(&self, name: &str) {
        self.read.set(self.read.get() | of_name(name));
    }

    pub(crate) const fn assigns(&mut self, parameter: u128) {
        self.assigned |= parameter;
    }

    /// Whether nothing was asked for that is not noted.
    pub(crate) const fn is_all_noted(&self) -> bool {
        !self.more.get()
    }

    /// Whether these parameters mattered, or are not what they were.
    pub(crate) const fn touches(&self, parameters: u128) -> bool {
        (self.read.get() | self.assigned) & parameters != 0
    }

    /// Whether it mattered where an axis stood.
    pub(crate) const fn asks_place(&self, axis: usize) -> bool {
        self.place >> axis & 1 == 1
    }

    /// Whether it does not matter any more.
    pub(crate) const fn names(&self, axis: usize) -> bool {
        self.named >> axis & 1 == 1
    }

    /// Of this stretch and the one before it as one.
    pub(crate) fn join(&mut self, before: &Self) {
        self.place = before.place | self.place & !before.named;
        self.named |= before.named;
        self.more.set(self.more.get() || before.more.get());
        self.read.set(self.read.get() | before.read.get());
        self.assigned |= before.assigned;
        self.kept.set(self.kept.get() | before.kept.get());
        self.jumps.resize(self.jumps.len().max(before.jumps.len()), 0);
        for (own, other) in self.jumps.iter_mut().zip(&before.jumps) {
            *own |= other;
        }
        self.cycle = before.cycle || self.cycle && !before.motion;
        // which came first is not known any more
        self.initial |=
            before.initial || (self.holes || before.holes) && (self.moves || before.moves);
        for (own, other) in [
            (&mut self.feed, before.feed),
            (&mut self.motion, before.motion),
            (&mut self.retract, before.retract),
            (&mut self.plane, before.plane),
            (&mut self.units, before.units),
            (&mut self.spindle, before.spindle),
            (&mut self.holes, before.holes),
            (&mut self.moves, before.moves),
            (&mut self.calls, before.calls),
        ] {
            *own |= other;
        }
    }
}

impl Executor {
    /// Before a block is executed: what it will ask for.
    pub(crate) fn ask(&mut self, motion: Option<Motion>) {
        const PLAIN: [GGroup; 4] =
            [GGroup::Motion, GGroup::Plane, GGroup::Distance, GGroup::Retract];
        let (words, state) = (&self.words, &self.state);
        let unusual = words.any(codes::set("ST$@^"))
            || words.has_modes() && !words.has_only(&PLAIN)
            || self.recording.is_some()
            || state.left_beside.is_some()
            || state.nurbs.is_some()
            || self.is_grinding_or_gearing();
        if unusual {
            self.asked.more();
            return;
        }
        self.asked.feed |= words.any(codes::set("F"));
        let named = words.g(GGroup::Motion);
        self.asked.cycle |= !self.asked.motion && named.is_some_and(|code| code > 30);
        self.asked.motion |= named.is_some();
        self.asked.plane |= words.g(GGroup::Plane).is_some() || self.compensating;
        self.asked.retract |= words.g(GGroup::Retract).is_some();
        self.asked.spindle |= state.feed_mode != FeedMode::PerMinute;
        let Some(motion) = motion else { return };
        let [a, b, _] = state.plane_axes();
        let in_plane = (1 << a | 1 << b) & !self.asked.named;
        match motion {
            Motion::None => self.asked.moves = true,
            Motion::Rapid | Motion::Feed => {
                self.asked.moves = true;
                self.asked.place |= if self.compensating { in_plane } else { 0 };
            }
            Motion::ArcClockwise | Motion::ArcCounterclockwise => {
                (self.asked.plane, self.asked.units, self.asked.moves) = (true, true, true);
                let anywhere = self.will_be_incremental() && !state.absolute_centres;
                if !anywhere || self.compensating {
                    self.asked.place |= in_plane;
                }
            }
            Motion::Cycle(cycle) if !words.any(POLAR) => self.ask_hole(cycle),
            _ => self.asked.more(),
        }
    }

    /// With G90 a hole ends at R or, with G98, where its series began if that is higher, wherever the axis came from.
    fn ask_hole(&mut self, cycle: Cycle) {
        self.asked.plane = true;
        if self.words.get(b'L') == Some(0.0) {
            self.asked.more(); // no hole
        }
        let [_, _, n] = self.state.plane_axes();
        let usual = drills_only(cycle);
        let apart = (usual || cycle.tap_sense().is_some())
            && !self.will_be_incremental()
            && self.state.initial.is_some()
            && !self.asked.retract
            && !self.asked.moves;
        if apart {
            self.asked.holes = true;
        } else {
            self.asked.initial = true;
            self.asked.place |= 1 << n & !self.asked.named;
        }
        self.asked.spindle |=
            !usual || self.dialect == Dialect::Brother || self.cycles.chip_removal.is_some();
    }

    /// After it: which axes it has named. A block with a fault may have done half of it.
    pub(crate) fn asked(&mut self, motion: Option<Motion>, done: bool) {
        let cycle = matches!(motion, Some(Motion::Cycle(_)));
        if !done {
            self.asked.initial |= motion.is_some();
            if cycle || self.words.has_codes() || self.words.any(codes::set("F")) {
                self.asked.more();
            }
            return;
        }
        if motion.is_none() || self.state.incremental || !self.words.any(AXES) {
            return;
        }
        let [_, _, n] = self.state.plane_axes();
        for axis in (0..9).filter(|axis| !(cycle && *axis == n)) {
            let letter = b"XYZABCUVW"[axis];
            self.asked.named |= u16::from(self.words.get(letter).is_some()) << axis;
        }
    }

    fn will_be_incremental(&self) -> bool {
        self.words.g(GGroup::Distance).map_or(self.state.incremental, |code| code == 910)
    }

    const fn is_grinding_or_gearing(&self) -> bool {
        self.state.cam || self.state.hobbing || self.state.polygon
    }
}

/// Whether a cycle goes on whatever the spindle does.
const fn drills_only(cycle: Cycle) -> bool {
    matches!(
        cycle,
        Cycle::ChipBreak
            | Cycle::Drill
            | Cycle::DrillDwell
            | Cycle::Peck
            | Cycle::BoreFeedOut
            | Cycle::BoreDwellFeedOut
    )
}
