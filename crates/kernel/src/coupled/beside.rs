//! What is left of the axes' limits beside what swings, for holds, overrides and all else that
//! has no plan.
//!
//! A plan beside a swing is made with the limits less the swing's speed, acceleration and jerk. A
//! change of how fast the plan is run through must not ask for more:
//!
//! ```text
//!   limit │▒▒▒▒ swing, at most: x′·n, x″·n², x‴·n³ of its table, n: waves a second ▒▒▒▒│
//!         │             what moves may ask for, however the knob stands               │
//! ```
use super::{Coupled, Slot, Wave};
use crate::drives::Drives;
use bus::AXES;
use motion::Limits;
use sync::{Periodic, PeriodicPoint};

/// Least share of an axis' limits that moves keep beside what swings, as they are planned.
const LEAST_BESIDE: f64 = 0.05;

/// The largest of a table's values and of their first three derivatives.
pub(super) fn highest(table: &Periodic) -> [f64; 4] {
    // looked at midway between the nodes, too
    let places = 2 * table.len();
    (0..places).fold([0.0; 4], |most: [f64; 4], place| {
        let PeriodicPoint { value, slope, bend, jolt } = table.at(place as f64 / places as f64);
        let at = [value, slope, bend, jolt];
        core::array::from_fn(|i| most[i].max(at[i].abs()))
    })
}

impl Coupled {
    /// Speed, acceleration and jerk that an axis needs at most for what is superposed on it, while
    /// its master turns evenly.
    fn taken(&self, slot: &Slot, spin: f64) -> [f64; 3] {
        let of = |wave: Option<Wave>| {
            let held = wave.and_then(|wave| Some((self.tables[wave.index].as_ref()?, wave.turns)));
            held.map_or([0.0; 3], |(held, turns)| {
                let n = (spin / turns).abs();
                let [_, slope, bend, jolt] = held.highest;
                [slope * n, bend * n * n, jolt * n * n * n]
            })
        };
        let (from, to) = (of(slot.from), of(slot.to));
        if slot.fade.is_over() { to } else { core::array::from_fn(|i| from[i] + to[i]) }
    }
}

impl Drives {
    /// What moves may ask of the axes beside what swings: of each limit the rest, or a little of it
    /// where nothing is left.
    pub(crate) fn beside(&self, limits: &Limits) -> Option<Limits> {
        let mut rest: Option<Limits> = None;
        for (axis, slot) in self.coupled.slots[..AXES].iter().enumerate() {
            let Some(slot) = slot else { continue };
            let [speed, accel, jerk] =
                self.coupled.taken(slot, self.master(slot.master).spin.value());
            let rest = rest.get_or_insert(*limits);
            for bounds in [&mut rest.feed, &mut rest.rapid] {
                let left = |most: f64, taken: f64| (most - taken).max(most * LEAST_BESIDE);
                bounds.speed[axis] = left(bounds.speed[axis], speed);
                bounds.accel[axis] = left(bounds.accel[axis], accel);
                bounds.jerk[axis] = left(bounds.jerk[axis], jerk);
            }
        }
        rest
    }
}
