//! A table of plans of one type, of fixed size.
//!
//! ```text
//!   put(plan) ─► Handle { slot 2, use 7 } ─► get ─► the plan ─► release: slot 2 is free, its next use is the 8th
//!                                             ▲
//!                       an older handle names use 6: nothing
//! ```
//!
//! The table takes its memory when it is made. A handle says which use of its slot it names, so
//! that one that is kept too long finds nothing, and not the plan of another step.
use alloc::vec::Vec;
use core::marker::PhantomData;

/// Names a plan in a [`Plans`] table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Handle<T> {
    slot: u8,
    generation: u32,
    of: PhantomData<fn() -> T>,
}

/// At most `N` plans.
#[derive(Clone, Debug)]
pub(crate) struct Plans<T, const N: usize> {
    slots: Vec<Slot<T>>,
    /// A bit for each slot: set where it is free.
    free: u64,
}

#[derive(Clone, Debug)]
struct Slot<T> {
    /// How many plans it has had.
    generation: u32,
    plan: Option<T>,
}

impl<T: Copy, const N: usize> Plans<T, N> {
    const ALL: u64 = u64::MAX >> (64 - N);
    /// What its slots take.
    pub(crate) const BYTES: usize = N * size_of::<Slot<T>>();

    /// With all its slots free.
    pub(crate) fn new() -> Self {
        const { assert!(N >= 1 && N <= 64, "a table has 1 to 64 slots: one bit for each") }
        let slots = (0..N).map(|_| Slot { generation: 0, plan: None }).collect();
        Self { slots, free: Self::ALL }
    }

    /// Keep a plan; `None`: all slots are in use.
    pub(crate) fn put(&mut self, plan: &T) -> Option<Handle<T>> {
        let slot = self.free.trailing_zeros() as u8;
        let Slot { generation, plan: kept } = self.slots.get_mut(usize::from(slot))?;
        *kept = Some(*plan);
        self.free &= self.free - 1;
        Some(Handle { slot, generation: *generation, of: PhantomData })
    }

    /// The plan, unless it was released.
    pub(crate) fn get(&self, handle: Handle<T>) -> Option<&T> {
        let slot = self.slots.get(usize::from(handle.slot))?;
        slot.plan.as_ref().filter(|_| slot.generation == handle.generation)
    }

    /// The plan, to be changed, unless it was released.
    pub(crate) fn get_mut(&mut self, handle: Handle<T>) -> Option<&mut T> {
        let slot = self.slots.get_mut(usize::from(handle.slot))?;
        slot.plan.as_mut().filter(|_| slot.generation == handle.generation)
    }

    /// Free the slot of a plan; whether it was still in use.
    pub(crate) fn release(&mut self, handle: Handle<T>) -> bool {
        let Some(slot) = self.slots.get_mut(usize::from(handle.slot)) else { return false };
        if slot.plan.is_none() || slot.generation != handle.generation {
            return false;
        }
        slot.plan = None;
        slot.generation = slot.generation.wrapping_add(1);
        self.free |= 1 << handle.slot;
        true
    }

    /// How many plans it has.
    #[cfg(test)]
    pub(crate) fn in_use(&self) -> usize {
        N - self.free.count_ones() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    #[test]
    fn a_full_table_takes_no_more_until_a_plan_is_released() {
        let mut plans = Plans::<u16, 2>::new();
        let first = plans.put(&10).expect("a free slot");
        let second = plans.put(&20).expect("a free slot");
        assert_eq!(plans.put(&30), None);
        assert!(plans.release(first));
        let third = plans.put(&30).expect("a free slot");
        assert_eq!([plans.get(second), plans.get(third)], [Some(&20), Some(&30)]);
        assert_eq!(third.slot, first.slot, "the slot is used again");
    }

    #[test]
    fn a_released_handle_finds_nothing_and_releases_nothing() {
        let mut plans = Plans::<u16, 1>::new();
        let old = plans.put(&1).expect("a free slot");
        assert!(plans.release(old));
        assert!(!plans.release(old) && plans.get(old).is_none());
        let new = plans.put(&2).expect("a free slot");
        assert!(!plans.release(old) && plans.get(old).is_none());
        assert_eq!((plans.get(new), plans.in_use()), (Some(&2), 1));
    }

    #[test]
    fn a_table_of_64_uses_every_bit() {
        let mut plans = Plans::<u8, 64>::new();
        let all: Vec<_> = (0..64).map(|n| plans.put(&n).expect("a free slot")).collect();
        assert!(plans.put(&64).is_none());
        assert!((0..64).zip(&all).all(|(n, handle)| plans.get(*handle) == Some(&n)));
        assert!(all.iter().all(|handle| plans.release(*handle)) && plans.in_use() == 0);
    }

    proptest! {
        /// Against a list of what should be in it, over any order of puts and releases, of live and
        /// of old handles.
        #[test]
        fn it_holds_what_was_put_and_not_released(orders in proptest::collection::vec((any::<bool>(), 0_usize..8), 0..200)) {
            let mut plans = Plans::<u32, 5>::new();
            let (mut live, mut dead) = (Vec::<(Handle<u32>, u32)>::new(), Vec::<Handle<u32>>::new());
            for (n, (puts, which)) in (0..).zip(orders) {
                if puts {
                    let put = plans.put(&n);
                    prop_assert_eq!(put.is_none(), live.len() == 5);
                    live.extend(put.map(|handle| (handle, n)));
                } else if which < live.len() {
                    let (handle, _) = live.swap_remove(which);
                    prop_assert!(plans.release(handle));
                    dead.push(handle);
                }
                prop_assert_eq!(plans.in_use(), live.len());
                prop_assert!(live.iter().all(|(handle, plan)| plans.get(*handle) == Some(plan)));
                prop_assert!(dead.iter().all(|handle| plans.get(*handle).is_none()));
            }
        }
    }
}
