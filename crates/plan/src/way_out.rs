//! The way out of work in which a tool is tied to a spindle, but not screwed to it: turned threads, cams, polygons, gears.
//!
//! ```text
//!     X ▲      ● clear                 after a stop in which spindle and axes ran apart, the law of the coupling leads
//!       │      ↑ 1 infeed axis         through the work: the infeed axis takes the tool off it first, and only then
//!       │ ═════╪═══════◄── groove      the axis along a thread goes back to where the pass began
//!       │ ◄────┘ 2 along the thread
//!       └──────────────────► Z
//! ```
//!
//! Where the tool is clear is where it stood before it was fed in: that of a thread's pass, of a wheel before its cam, of a
//! polygon's cutter when it was geared up.
use canon::Axis;
use units::{Angle, Lead, LeadGrowth, Length, Spin};

/// What is being cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiedCut {
    /// A pass over a thread.
    Thread,
    /// A cam.
    Cam,
    /// A polygon.
    Polygon,
    /// A gear.
    Gear,
    /// A thread, by a tap in a floating or clutch holder: no axis is tied to its spindle, and the thread holds it.
    FloatingTap,
}

/// See the module's header.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayOut {
    /// What is being cut.
    pub cut: TiedCut,
    /// The spindle that leads.
    pub spindle: u8,
    /// The axis that takes the tool off the work.
    pub infeed: Axis,
    /// Its coordinate where the tool is clear of the work.
    pub clear: Length,
    /// +1 where that is on its positive side, else −1.
    pub outward: f64,
    /// The pass over a thread.
    pub pass: Option<Pass>,
}

/// One pass over a thread: `position = start + lead·(θ − angle) + growth·(θ − angle)²/2`, θ within a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// The axis along the thread.
    pub axis: Axis,
    /// Where its straight part begins …
    pub start: Length,
    /// … with the spindle at this angle, …
    pub angle: Angle,
    /// … and where it ends.
    pub end: Length,
    /// Where the whole pass begins.
    pub from: Length,
    /// Where the material begins.
    pub surface: Length,
    /// Travel per positive turn of the spindle.
    pub lead: Lead,
    /// By how much that grows with each of them.
    pub growth: LeadGrowth,
    /// Speed of the spindle.
    pub spin: Spin,
}

impl WayOut {
    /// Of a tool that X takes off the work, towards plus, to where it stands now.
    pub(crate) const fn along_x(cut: TiedCut, spindle: u8, clear: Length) -> Self {
        Self { cut, spindle, infeed: Axis::X, clear, outward: 1.0, pass: None }
    }

    /// Of a tap that no axis is tied to: it is in the work below where it starts, and only its spindle turned backwards takes it out.
    pub(crate) const fn floating(spindle: u8, infeed: Axis, clear: Length, outward: f64) -> Self {
        Self { cut: TiedCut::FloatingTap, spindle, infeed, clear, outward, pass: None }
    }

    /// Nothing but the infeed axis is needed to take the tool off the work: it is held by nothing on the side from which it came.
    pub const fn is_straight(&self) -> bool {
        match self.cut {
            TiedCut::Thread | TiedCut::Cam | TiedCut::Polygon | TiedCut::Gear => true,
            TiedCut::FloatingTap => false,
        }
    }

    /// How far a place of the infeed axis is inside of where the tool is clear.
    pub fn inside(&self, place: Length) -> Length {
        (self.clear - place) * self.outward
    }
}

/// Where each linear axis came from when it last moved: by itself, or beside others.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameFrom([Option<Came>; 3]);

#[derive(Clone, Copy, Debug)]
struct Came {
    from: f64,
    way: f64,
    /// Nothing else has moved since.
    alone: bool,
}

impl CameFrom {
    /// The program moves from here to there.
    pub(crate) fn moved(&mut self, from: &[Length; 3], to: &[Length; 3]) {
        let way: [f64; 3] = core::array::from_fn(|i| (to[i] - from[i]).value());
        let moving = way.iter().filter(|way| **way != 0.0).count();
        for (axis, way) in way.into_iter().enumerate() {
            let came = &mut self.0[axis];
            if way == 0.0 {
                if let Some(came) = came.as_mut().filter(|_| moving > 0) {
                    came.alone = false;
                }
                continue;
            }
            let goes_on =
                moving == 1 && came.is_some_and(|before| before.alone && before.way * way > 0.0);
            if !goes_on {
                *came = Some(Came { from: from[axis].value(), way, alone: moving == 1 });
            }
        }
    }

    /// Where a linear axis was before it came to where it is.
    pub(crate) fn of(&self, axis: usize) -> Option<f64> {
        self.0.get(axis).copied().flatten().map(|came| came.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(places: &[[f64; 3]]) -> CameFrom {
        let mut came = CameFrom::default();
        for pair in places.windows(2) {
            came.moved(&pair[0].map(Length::mm), &pair[1].map(Length::mm));
        }
        came
    }

    #[test]
    fn an_infeed_in_several_steps_began_where_the_first_one_did() {
        let came = after(&[[30.0, 0.0, 50.0], [11.0, 0.0, 6.0], [10.5, 0.0, 6.0], [9.5, 0.0, 6.0]]);
        assert_eq!(came.of(0), Some(11.0));
    }

    #[test]
    fn one_that_comes_straight_from_afar_began_there() {
        let came = after(&[[30.0, 0.0, 50.0], [9.5, 0.0, 6.0]]);
        assert_eq!((came.of(0), came.of(1)), (Some(30.0), None));
    }

    #[test]
    fn going_out_and_in_again_is_a_new_infeed() {
        let came = after(&[[11.0, 0.0, 6.0], [9.5, 0.0, 6.0], [11.5, 0.0, 6.0], [9.4, 0.0, 6.0]]);
        assert_eq!(came.of(0), Some(11.5));
        let came =
            after(&[[9.0, 0.0, -20.0], [11.0, 0.0, -20.0], [11.0, 0.0, 6.0], [9.4, 0.0, 6.0]]);
        assert_eq!(came.of(0), Some(11.0));
    }
}
