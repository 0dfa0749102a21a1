//! Where a tool that is tied to a spindle came from: that is where it is clear of the work, and its
//! way out.
use motion::{TiedCut, WayOut};
use units::{Axis, Length};

/// Of a tool that X takes off the work, towards plus, to where it stands now.
pub(crate) const fn along_x(cut: TiedCut, spindle: u8, clear: Length) -> WayOut {
    WayOut { cut, spindle, infeed: Axis::X, clear, outward: 1.0, pass: None }
}

/// Of a tap that no axis is tied to: it is in the work below where it starts, and only its spindle
/// turned backwards takes it out.
pub(crate) const fn floating(spindle: u8, infeed: Axis, clear: Length, outward: f64) -> WayOut {
    WayOut { cut: TiedCut::FloatingTap, spindle, infeed, clear, outward, pass: None }
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
