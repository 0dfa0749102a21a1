//! What the operator orders while a program runs: hold, resume, abort, retract, overrides, single
//! block.
//!
//! ```text
//!                hold                  standing           resume
//!   running ───────────► slowing down ─────────► held ──────────────► running
//!                                                 │ abort ──────────► the rest of the program is forgotten
//!                                                 │ retract (a tap) ► back out along the thread, then held or over
//! ```
//!
//! This is only the state that the orders leave behind. Who moves something asks it every period:
//!
//! | who | asks | and then |
//! |---|---|---|
//! | a move | [`Operator::wants_rest`], [`Operator::share`] | slows down along its path; goes slower or faster |
//! | a dwell | [`Operator::wants_rest`] | its clock stands |
//! | a tap | [`Operator::wants_rest`], [`Operator::wants_out`] | stops on its coupling, all of it together; backs out |
//! | a spindle | [`Operator::spindle_share`] | turns slower or faster, unless a tap, a thread or a gear needs its speed |
//! | between steps | [`Operator::wants_rest`] | no step begins |
//!
//! A door or another interlock holds as an order does, as long as it is open ([`Inhibit`]); what it
//! has held goes on when it is closed.
//!
//! In a synchronised move overrides are locked: they are remembered, and act after it. What the
//! operator may wonder about is said as a [`Notice`].
use core::fmt;

/// An order, at any time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Order {
    /// Stop what moves as soon as it can be, without leaving path or coupling. The spindle goes on
    /// turning unless it is coupled.
    FeedHold,
    /// Go on after a hold, a program's stop or a single block.
    Resume,
    /// What a person was asked for is done: a program's stop goes on, a tool is in the spindle.
    Confirm,
    /// Stop as for a hold, then forget the rest of the program. A tap in its hole waits for
    /// `Retract`.
    Abort,
    /// Back a held tap out of its hole along its thread.
    Retract,
    /// Share of the programmed feed, within [`Overrides`].
    FeedOverride(f64),
    /// Share of the rapids' speed, 0 to 1.
    RapidOverride(f64),
    /// Share of the programmed spindle speed, within [`Overrides`].
    SpindleOverride(f64),
    /// Hold before each program line.
    SingleBlock(bool),
    /// M1 stops the program as M0 does.
    OptionalStop(bool),
    /// Flood coolant, until the program switches it.
    Flood(bool),
    /// Mist coolant, likewise.
    Mist(bool),
}

/// How far the operator may override, as the machine's file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Overrides {
    /// Largest share of the programmed feed; the least is nothing.
    pub feed_most: f64,
    /// Least and largest share of the programmed spindle speed.
    pub spindle: (f64, f64),
}

impl Overrides {
    /// Feeds to twice, spindles from half to 1.2 times what is programmed, as most panels have it.
    pub const USUAL: Self = Self { feed_most: 2.0, spindle: (0.5, 1.2) };
}

/// What doors and other interlocks hold at present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Inhibit {
    /// Axes, of a program or by hand.
    pub feed: bool,
    /// A spindle, and the program with it, until the spindle has its speed again.
    pub spindle: bool,
}

impl Inhibit {
    /// True where a program is held.
    pub const fn holds(self) -> bool {
        self.feed || self.spindle
    }
}

/// Something that the operator should know of an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Notice {
    /// Everything that was to stop stands.
    Held,
    /// The same, in a thread.
    HeldInThread,
    /// Everything that was to stop for an interlock stands.
    Inhibited,
    /// The same, in a thread.
    InhibitedInThread,
    /// An override was turned during a synchronised move.
    OverrideLocked,
    /// A share that is no number or out of its range, in percent, was taken as the nearest one that
    /// is.
    OverrideOutOfRange {
        /// The least that there is.
        least: u16,
        /// The largest.
        most: u16,
    },
    /// The tap backs out.
    BackingOut,
    /// It is out, after a stop.
    Out,
    /// A retract was ordered with no tap held in a hole.
    NothingToRetract,
    /// A confirmation came, and nothing waits for one.
    NothingToConfirm,
    /// A resume was ordered with nothing held.
    NothingHeld,
    /// A program that an abort or an alarm has ended cannot go on.
    NothingToResume,
    /// The program was given up.
    Aborted,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OverrideOutOfRange { least, most } => write!(
                f,
                "this override goes from {least} to {most} %; the nearest possible one is taken"
            ),
            _ => f.write_str(self.sentence()),
        }
    }
}

impl Notice {
    /// What is said where no number belongs to it.
    const fn sentence(self) -> &'static str {
        match self {
            Self::Held => "held: resume goes on, abort gives the program up",
            Self::HeldInThread => {
                "held in the thread, spindle and feed stopped together: resume goes on, retract backs out along the thread"
            }
            Self::Inhibited => "held by an interlock: it goes on when that is closed",
            Self::InhibitedInThread => {
                "held by an interlock in the thread, spindle and feed stopped together: it goes on when that is closed, retract backs out along the thread"
            }
            Self::OverrideLocked => {
                "overrides are locked while spindle and feed are synchronised; the new one acts after the thread"
            }
            Self::OverrideOutOfRange { .. } => "the nearest possible override is taken",
            Self::BackingOut => "backing out along the thread",
            Self::Out => "the tap is out of its hole",
            Self::NothingToRetract => "nothing to retract: no tap is held in a hole",
            Self::NothingToConfirm => {
                "nothing waits to be confirmed: neither a program's stop nor a tool change by hand"
            }
            Self::NothingHeld => "nothing is held",
            Self::NothingToResume => {
                "the program was ended by an abort or an alarm: start it again, or from a line"
            }
            Self::Aborted => "aborted: the rest of the program is forgotten",
        }
    }
}

/// What the orders have left behind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // independent orders: any of them may be in force with any other
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Operator {
    held: bool,
    aborting: bool,
    inhibit: Inhibit,
    retract: bool,
    limits: Overrides,
    feed: f64,
    rapid: f64,
    spindle: f64,
    single_block: bool,
    optional_stop: bool,
    /// The line that single block has let pass.
    admitted: Option<u32>,
    /// The hold has been said.
    said: bool,
    /// Held by single block alone.
    is_after_block: bool,
}

impl Operator {
    pub(crate) const fn new(limits: Overrides) -> Self {
        Self {
            held: false,
            aborting: false,
            inhibit: Inhibit { feed: false, spindle: false },
            retract: false,
            limits,
            feed: 1.0,
            rapid: 1.0,
            spindle: 1.0,
            single_block: false,
            optional_stop: false,
            admitted: None,
            said: false,
            is_after_block: false,
        }
    }

    /// Overrides and single block as they are; nothing is held or given up.
    pub(crate) const fn without_orders(&self) -> Self {
        Self {
            held: false,
            aborting: false,
            retract: false,
            admitted: None,
            said: false,
            is_after_block: false,
            ..*self
        }
    }

    /// Take an order; what is to be said about it. `synchronised`: a coupling is engaged; `paused`:
    /// the program has a stop of its own; `asked`: that, or a tool to be changed by hand, waits to
    /// be confirmed.
    pub(crate) fn take(
        &mut self,
        order: Order,
        synchronised: bool,
        (paused, asked): (bool, bool),
    ) -> Option<Notice> {
        match order {
            Order::FeedHold => {
                (self.held, self.retract, self.is_after_block) = (true, false, false);
                None
            }
            Order::Resume if self.aborting => Some(Notice::NothingToResume),
            Order::Resume => {
                let nothing = !self.held && !paused;
                (self.held, self.retract, self.said) = (false, false, false);
                self.is_after_block = false;
                nothing.then_some(Notice::NothingHeld)
            }
            Order::Confirm => (!asked).then_some(Notice::NothingToConfirm),
            Order::Abort => {
                (self.aborting, self.is_after_block) = (true, false);
                None
            }
            Order::Retract if synchronised && self.wants_rest() => {
                self.retract = true;
                None
            }
            Order::Retract => Some(Notice::NothingToRetract),
            Order::FeedOverride(share) => {
                let range = (0.0, self.limits.feed_most);
                self.feed = within(share, range, self.feed);
                override_notice(share, self.feed, range, synchronised)
            }
            Order::RapidOverride(share) => {
                let range = (0.0, 1.0);
                self.rapid = within(share, range, self.rapid);
                override_notice(share, self.rapid, range, synchronised)
            }
            Order::SpindleOverride(share) => {
                let range = self.limits.spindle;
                self.spindle = within(share, range, self.spindle);
                override_notice(share, self.spindle, range, synchronised)
            }
            Order::SingleBlock(on) => {
                self.single_block = on;
                None
            }
            Order::OptionalStop(on) => {
                self.optional_stop = on;
                None
            }
            Order::Flood(_) | Order::Mist(_) => None, // the kernel's
        }
    }

    /// What moves shall come to rest, and nothing new begin.
    pub const fn wants_rest(&self) -> bool {
        self.is_ordered_to_rest() || self.inhibit.holds()
    }

    /// An order or an alarm wants rest, whatever interlocks do.
    pub const fn is_ordered_to_rest(&self) -> bool {
        self.held || self.aborting
    }

    /// What is moved by hand shall come to rest: axes, spindles.
    pub(crate) const fn hands_rest(&self) -> (bool, bool) {
        let ordered = self.is_ordered_to_rest();
        (ordered || self.inhibit.feed, ordered || self.inhibit.spindle)
    }

    /// What interlocks hold.
    pub const fn inhibit(&self) -> Inhibit {
        self.inhibit
    }

    /// Takes what interlocks hold from now on.
    pub(crate) const fn take_inhibit(&mut self, inhibit: Inhibit) {
        if self.inhibit.holds() && !inhibit.holds() && !self.is_ordered_to_rest() {
            self.said = false;
        }
        self.inhibit = inhibit;
    }

    /// Held by single block, after a line, and by no order.
    pub const fn is_held_after_block(&self) -> bool {
        self.held && self.is_after_block
    }

    /// The program shall be given up.
    pub const fn wants_abort(&self) -> bool {
        self.aborting
    }

    /// A tap that is held shall back out.
    pub const fn wants_out(&self) -> bool {
        self.retract
    }

    /// The override for a move: of rapids, or of feeds. What is synchronised does not ask.
    pub const fn share(&self, rapid: bool) -> f64 {
        if rapid { self.rapid } else { self.feed }
    }

    /// The override of spindles. What is synchronised does not ask.
    pub const fn spindle_share(&self) -> f64 {
        self.spindle
    }

    /// Each program line shall be followed by a hold: a move must come to rest at its end.
    pub const fn single_block(&self) -> bool {
        self.single_block
    }

    /// M1 stops the program.
    pub const fn optional_stop(&self) -> bool {
        self.optional_stop
    }

    /// A step of another line is about to begin, with everything at rest: whether single block
    /// holds it.
    pub(crate) fn holds_line(&mut self, line: u32, last: u32) -> bool {
        if !self.single_block || line == last || self.admitted == Some(line) {
            return false;
        }
        self.admitted = Some(line);
        (self.held, self.is_after_block) = (true, true);
        true
    }

    /// Everything stands: what is to be said, once.
    pub(crate) const fn standing(&mut self, in_thread: bool) -> Option<Notice> {
        if self.said {
            return None;
        }
        self.said = true;
        Some(match (self.is_ordered_to_rest(), in_thread) {
            (true, true) => Notice::HeldInThread,
            (true, false) => Notice::Held,
            (false, true) => Notice::InhibitedInThread,
            (false, false) => Notice::Inhibited,
        })
    }

    /// An alarm stops everything as a hold does.
    pub(crate) const fn alarm(&mut self) {
        (self.held, self.retract, self.is_after_block) = (true, false, false);
    }

    /// The tap is out: the retract is done, the hold remains.
    pub(crate) const fn is_out(&mut self) {
        self.retract = false;
        self.said = true;
    }
}

/// The nearest share that can be meant; a number that is none changes nothing.
fn within(share: f64, (least, most): (f64, f64), before: f64) -> f64 {
    if share.is_nan() { before } else { share.max(least).min(most) }
}

fn override_notice(
    wanted: f64,
    taken: f64,
    (least, most): (f64, f64),
    synchronised: bool,
) -> Option<Notice> {
    if wanted.is_nan() || (wanted - taken).abs() > 1e-12 {
        let percent = |share: f64| (share * 100.0 + 0.5) as u16; // rounded; a machine file has 400 at most
        Some(Notice::OverrideOutOfRange { least: percent(least), most: percent(most) })
    } else {
        synchronised.then_some(Notice::OverrideLocked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_are_kept_within_their_range_and_said_when_locked() {
        let mut operator = Operator::new(Overrides::USUAL);
        assert_eq!(operator.take(Order::FeedOverride(0.5), false, (false, false)), None);
        assert_eq!(operator.share(false), 0.5);
        let notice = operator.take(Order::FeedOverride(9.0), false, (false, false));
        let out_of = |least, most| Some(Notice::OverrideOutOfRange { least, most });
        assert_eq!((notice, operator.share(false)), (out_of(0, 200), 2.0));
        let notice = operator.take(Order::RapidOverride(f64::NAN), false, (false, false));
        assert_eq!((notice, operator.share(true)), (out_of(0, 100), 1.0));
        let notice = operator.take(Order::RapidOverride(0.25), true, (false, false));
        assert_eq!((notice, operator.share(true)), (Some(Notice::OverrideLocked), 0.25));
        let notice = operator.take(Order::SpindleOverride(0.1), false, (false, false));
        assert_eq!((notice, operator.spindle_share()), (out_of(50, 120), 0.5));
        let mut weak = Operator::new(Overrides { feed_most: 1.5, spindle: (0.8, 1.0) });
        let notice = weak.take(Order::FeedOverride(2.0), false, (false, false));
        assert_eq!((notice, weak.share(false)), (out_of(0, 150), 1.5));
        let said = notice.map(|n| std::string::ToString::to_string(&n)).unwrap_or_default();
        assert!(said.contains("from 0 to 150 %"), "{said}");
    }

    #[test]
    fn a_hold_ends_with_resume_and_an_abort_does_not() {
        let mut operator = Operator::new(Overrides::USUAL);
        assert_eq!(operator.take(Order::Resume, false, (false, false)), Some(Notice::NothingHeld));
        operator.take(Order::FeedHold, false, (false, false));
        assert!(operator.wants_rest() && !operator.wants_abort());
        assert_eq!(operator.take(Order::Resume, false, (false, false)), None);
        assert!(!operator.wants_rest());
        operator.take(Order::Abort, false, (false, false));
        assert_eq!(
            operator.take(Order::Resume, false, (false, false)),
            Some(Notice::NothingToResume)
        );
        assert!(operator.wants_rest() && operator.wants_abort());
    }

    #[test]
    fn an_interlock_holds_as_long_as_it_is_open_whatever_is_ordered() {
        let mut operator = Operator::new(Overrides::USUAL);
        operator.take_inhibit(Inhibit { feed: true, spindle: false });
        assert!(operator.wants_rest() && !operator.wants_abort());
        assert_eq!(operator.hands_rest(), (true, false));
        assert_eq!(operator.standing(false), Some(Notice::Inhibited));
        assert_eq!(operator.standing(false), None);
        operator.take(Order::Resume, false, (false, false));
        assert!(operator.wants_rest(), "only the door ends it");
        operator.take(Order::FeedHold, false, (false, false));
        operator.take_inhibit(Inhibit::default());
        assert!(operator.wants_rest(), "the hold of the operator remains");
        operator.take(Order::Resume, false, (false, false));
        assert!(!operator.wants_rest());
        operator.take_inhibit(Inhibit { feed: false, spindle: true });
        assert_eq!(operator.hands_rest(), (false, true));
        assert_eq!(operator.standing(true), Some(Notice::InhibitedInThread));
    }

    #[test]
    fn only_a_tap_that_is_held_can_be_retracted() {
        let mut operator = Operator::new(Overrides::USUAL);
        assert_eq!(
            operator.take(Order::Retract, true, (false, false)),
            Some(Notice::NothingToRetract)
        );
        operator.take(Order::FeedHold, true, (false, false));
        assert_eq!(
            operator.take(Order::Retract, false, (false, false)),
            Some(Notice::NothingToRetract)
        );
        assert_eq!(operator.take(Order::Retract, true, (false, false)), None);
        assert!(operator.wants_out());
    }

    #[test]
    fn single_block_holds_each_line_once() {
        let mut operator = Operator::new(Overrides::USUAL);
        assert!(!operator.holds_line(2, 1));
        operator.take(Order::SingleBlock(true), false, (false, false));
        assert!(!operator.holds_line(1, 1));
        assert!(operator.holds_line(2, 1) && operator.wants_rest());
        operator.take(Order::Resume, false, (false, false));
        assert!(!operator.holds_line(2, 1) && operator.holds_line(3, 2));
    }
}
