//! What the kernel executes, one after the other.
use crate::{
    Borrowed, EdgeCount, GearStep, InputWait, InputsWait, Instant, Output, Path, Phase, Piece,
    ProbeEnd, Profile, Storage, Superpose, SurfaceSpeed, TapPlan, ThreadStretch, WayOut,
};
use units::{Angle, Axis, Length, Orientation, Spin, Time};

/// Most bytes in a step whose storage takes no more than a reference for a plan.
pub const STEP_BYTES: usize = 256;

const _: () = assert!(size_of::<Step<Borrowed<'static>>>() <= STEP_BYTES);

/// One step and the operation it serves; its plans are where the storage says.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "S::Of<Move>: serde::Serialize, S::Of<Follow>: serde::Serialize, S::Of<TapPlan>: serde::Serialize, S::Of<Profile>: serde::Serialize, S::Of<ChipThrow>: serde::Serialize",
        deserialize = "S::Of<Move>: serde::Deserialize<'de>, S::Of<Follow>: serde::Deserialize<'de>, S::Of<TapPlan>: serde::Deserialize<'de>, S::Of<Profile>: serde::Deserialize<'de>, S::Of<ChipThrow>: serde::Deserialize<'de>"
    ))
)]
pub struct Step<S: Storage> {
    /// Index of the op, counted from 0.
    pub op: u32,
    /// Program line of the op.
    pub line: u32,
    /// What to do.
    pub kind: StepKind<S>,
}

/// First number of [`StepKind::Consult`] that is a mark of a machine sequence.
pub const SEQUENCE_MARKS: u16 = 0x8000;

/// What to do.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "S::Of<Move>: serde::Serialize, S::Of<Follow>: serde::Serialize, S::Of<TapPlan>: serde::Serialize, S::Of<Profile>: serde::Serialize, S::Of<ChipThrow>: serde::Serialize",
        deserialize = "S::Of<Move>: serde::Deserialize<'de>, S::Of<Follow>: serde::Deserialize<'de>, S::Of<TapPlan>: serde::Deserialize<'de>, S::Of<Profile>: serde::Deserialize<'de>, S::Of<ChipThrow>: serde::Deserialize<'de>"
    ))
)]
pub enum StepKind<S: Storage> {
    /// Move along a path; rest to rest while there is no look-ahead.
    Move(S::Of<Move>),
    /// Go on along a joined path.
    Follow(S::Of<Follow>),
    /// Wait.
    Dwell(Time),
    /// Order a spindle, and wait if the order says so.
    Spindle {
        /// Which, counted from 0.
        spindle: u8,
        /// What.
        order: SpindleStep<S>,
    },
    /// Tap.
    Tap(S::Of<TapPlan>),
    /// Turn a stretch of a thread.
    Thread(ThreadStretch),
    /// From here on the tool may be in the work, tied to a spindle, and this is the way out: wait
    /// until it is written down where that is done. `None`: it is out.
    WayOut(Option<WayOut>),
    /// Gear a spindle to another one, and wait until it is locked.
    Engage(GearStep),
    /// Let go of a geared spindle: it comes to rest under its own control.
    Release {
        /// Which, counted from 0.
        follower: u8,
    },
    /// Superpose a function of a spindle's turn; go on to the next step at once.
    Superpose(Superpose),
    /// Wait until all that was superposed has faded in or out.
    AwaitFades,
    /// Wait for turns of a spindle (spark-out).
    Revolve {
        /// Which, counted from 0.
        spindle: u8,
        /// How many turns from now.
        turns: Angle,
    },
    /// Wait, with spindles turning and couplings engaged, until what runs the kernel has done
    /// what this number stands for, and answers. From [`SEQUENCE_MARKS`] on it is a mark of a
    /// machine sequence, which is recorded before the next step begins.
    Consult(u16),
    /// Change the tool; the planner has brought the axes to the change position before.
    ChangeTool {
        /// Its number; 0 empties the spindle.
        tool: u32,
        /// No changer reaches it: wait until the operator has confirmed that it is in the spindle.
        by_hand: bool,
    },
    /// Switch coolant.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// Whether the operator's feed override acts from here on (M48, M49, M50).
    FeedOverride(bool),
    /// Whether the operator's spindle override acts from here on (M48, M49, M51); what needs the
    /// programmed speed locks it, and goes on when the spindle has it.
    SpindleOverride(bool),
    /// Switch an output.
    Output(Output),
    /// Read an input or wait for it.
    Input(InputWait),
    /// Wait until all of several inputs are as they must be.
    Inputs(InputsWait),
    /// Count edges of an input while an output is on.
    Count(EdgeCount),
    /// From here on digital inputs must stay as they are now wherever something moves: it is an
    /// alarm if one does not. No bit at all: none must.
    Guard {
        /// A bit for each that must be on.
        on: u64,
        /// A bit for each that must be off.
        off: u64,
    },
    /// Move from rest to rest, or to where the probe changes.
    Probe {
        /// The move to its end.
        order: S::Of<Move>,
        /// When it ends before.
        until: ProbeEnd,
    },
    /// A code of the machine's own, by its number after M.
    UserCode(u16),
    /// Stop until told to go on.
    Pause {
        /// Only if optional stop is set.
        optional: bool,
    },
    /// The program is over.
    End,
}

/// Most phases in one [`Follow`] step.
pub const PHASES: usize = 6;

/// A stretch of a joined path: it goes on where the step before ended, as fast.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Follow {
    /// Where.
    pub piece: Piece,
    /// When: stretches of constant jerk along it, one after the other.
    pub phases: [Phase; PHASES],
    /// How many of them there are; at least one.
    pub count: u8,
    /// G95: time is revolutions of spindle 0, not seconds.
    pub per_revolution: bool,
    /// It ends at rest; wait until every axis is in position before the next step.
    pub exact_stop: bool,
    /// What feed it was planned for.
    pub pace: Pace,
}

/// What feed a stretch of a path was planned for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pace {
    /// Share of the programmed feed: 1, unless the operator wanted more.
    pub share: f64,
    /// Revolutions of the spindle per second, for a feed per revolution; else 1.
    pub turning: f64,
}

/// The feed that a move asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Programmed {
    /// mm/s, or mm a revolution.
    pub feed: f64,
    /// Revolutions of the spindle per second, for a feed per revolution; else 1.
    pub turning: f64,
}

impl Follow {
    /// How long it lasts, s (or revolutions).
    pub fn duration(&self) -> f64 {
        self.phases[..usize::from(self.count)].iter().map(|phase| phase.duration).sum()
    }

    /// It ends at this time from its start, in the motion that it has there, and goes on into the
    /// next step; whether that is within it.
    #[must_use]
    pub fn cut(&mut self, time: f64) -> bool {
        if !(time > 0.0 && time < self.duration()) {
            return false;
        }
        let mut left = time;
        for (count, phase) in (1..=self.count).zip(&mut self.phases) {
            if left <= phase.duration {
                phase.duration = left;
                (self.count, self.exact_stop) = (count, false);
                return true;
            }
            left -= phase.duration;
        }
        false // its phases are as long as it
    }

    /// Parameter of the piece and its rates (speed, acceleration, jerk) at a time from its start.
    pub fn at(&self, time: f64) -> (f64, f64, f64, f64) {
        let phases = &self.phases[..usize::from(self.count)];
        let mut t = time.max(0.0);
        for phase in phases {
            if t < phase.duration {
                let Instant { s, v, a } = phase.at(t);
                return (s, v, a, phase.j);
            }
            t -= phase.duration;
        }
        let last = phases.last().copied().unwrap_or_default();
        let Instant { s, v, a } = last.end();
        (if self.exact_stop { self.piece.length } else { s }, v, a, last.j)
    }
}

/// A move with the time along it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // four yes-or-no words of one order, each on its own
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Move {
    /// Where.
    pub path: Path,
    /// When: path parameter over time. For `per_revolution` moves, over spindle revolutions
    /// instead.
    pub profile: Profile,
    /// Not cutting.
    pub rapid: bool,
    /// G95: the profile's time axis is revolutions of spindle 0 since the move began, not seconds.
    pub per_revolution: bool,
    /// At the end, wait until every axis is in position before the next step.
    pub exact_stop: bool,
    /// A tap's holder takes whatever spindle and feed differ by: nothing is wrong while the spindle
    /// is not at speed.
    pub floats: bool,
    /// Its feed, if it may be planned anew for another one.
    pub programmed: Option<Programmed>,
}

impl Move {
    /// It ends at rest. One that was cut ends in motion, and goes on into the next step.
    pub const fn rests(&self) -> bool {
        !self.profile.is_cut()
    }

    /// It ends at this time from its start, in the motion that it has there, and goes on into the
    /// next step; whether that is within it.
    #[must_use]
    pub fn cut(&mut self, time: f64) -> bool {
        let is_cut = self.profile.cut(time);
        self.exact_stop &= !is_cut;
        is_cut
    }
}

/// What a spindle is told.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "S::Of<Profile>: serde::Serialize, S::Of<ChipThrow>: serde::Serialize",
        deserialize = "S::Of<Profile>: serde::Deserialize<'de>, S::Of<ChipThrow>: serde::Deserialize<'de>"
    ))
)]
pub enum SpindleStep<S: Storage> {
    /// Turn at this speed (sign: sense; zero stops) along `ramp`, which runs from the speed that
    /// the planner knows the spindle to be ordered to; go on to the next step at once.
    Turn {
        /// Speed to hold.
        spin: Spin,
        /// Speed over time, as the profile's `v`; its `s` is revolutions.
        ramp: S::Of<Profile>,
    },
    /// Turn by the place of X from now on, on the ramps that the spindle's drive has; go on to the
    /// next step at once.
    Surface {
        /// Surface speed, limit and axis of the work.
        surface: SurfaceSpeed,
        /// As the planner expects it to come from its speed to the one at the place where X is, for
        /// the planned time alone.
        ramp: S::Of<Profile>,
    },
    /// Wait until the spindle is within its at-speed window of the ordered speed (or at rest).
    AwaitSpeed,
    /// Stop at an angle within a turn and hold it there.
    Orient {
        /// The angle, and how the spindle comes there.
        to: Orientation,
        /// For so long at most; `None`: as long as the machine gives it.
        longest: Option<Time>,
    },
    /// Throw chips off while the axes go on; go on to the next step at once.
    Throw(S::Of<ChipThrow>),
}

/// Chip removal: wait until an axis passes a level, run against the cut, turn round as soon as that
/// speed is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChipThrow {
    /// The speed that throws chips off.
    pub throw: Spin,
    /// From the speed that the spindle has been told to that one, as in [`SpindleStep::Turn`].
    pub against: Profile,
    /// The speed afterwards.
    pub then: Spin,
    /// From `throw` to `then`.
    pub back: Profile,
    /// The axis that leaves the hole.
    pub axis: Axis,
    /// Where on it the manoeuvre begins.
    pub level: Length,
    /// The axis passes it upwards.
    pub upwards: bool,
}

/// The step that a kernel is executing, and the planned time of it that is done, while what follows
/// is planned anew.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UnderWay {
    /// Planned time that is done, s or revolutions.
    pub done: f64,
    /// Planned time per second at the full rate: 1, or revolutions.
    pub pace: f64,
}

/// What a kernel gives back of the steps that it was given, so that they can be planned anew.
/// The giver keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HandedBack {
    /// So many of the last ones.
    pub steps: usize,
    /// Planned time of the first of these that is done, if it is under way, s or revolutions.
    pub done: Option<f64>,
}
