//! What is coupled in the background of every step: geared spindles, and functions of a spindle's
//! turn that are superposed on axes and on geared spindles.
//!
//! ```text
//!   master θ (its setpoint where it is position-controlled, else the observer's) ─┬─ gear ──► follower spindle
//!                                                                                └─ tables ─► axes, follower
//!   steps go on meanwhile: a Move sets an axis' base, the superposition comes on top of it
//! ```
//!
//! A function that is superposed on its own master makes that one swing about its even turn: the
//! even turn is what all followers see, so that they and the master keep step.
//!
//! While a gear is engaged its master is *paced*: position-controlled along the speed that is
//! ordered, so that master and follower obey one trajectory with matched loops, and a change of
//! speed takes both along. A halt of the machine keeps the gear and the superpositions: master,
//! follower and axes stop on the coupling.
use crate::axis::Target;
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::spindle::SpindleLoop;
use alloc::vec::Vec;
use bus::{AXES, SPINDLES};
use motion::{GearStep, Superpose, Superposed, TableId};
use sync::{Blend, Engagement, Engaging, Fade, Gear, Periodic, Rotation, Swing, Travel};
use units::{Accel, Angle, Length, Speed, Time};

mod beside;

/// Tables that a kernel keeps at once.
pub const TABLES: usize = 64;
/// Share of a spindle's torque that a paced change of speed uses.
const PACED: f64 = 0.5;
/// Shortest fade, s.
const SHORTEST_FADE_S: f64 = 0.02;

/// A geared spindle.
#[derive(Clone, Copy, Debug)]
struct GearRun {
    gear: Gear,
    master: usize,
    axis: Option<usize>,
    state: Engagement,
    /// Whole turns by which the follower's count differs from the gear's.
    turns: Angle,
    waited: Time,
}

/// What is superposed on one follower.
#[derive(Clone, Copy, Debug)]
struct Slot {
    master: usize,
    from: Option<Wave>,
    to: Option<Wave>,
    fade: Fade,
}

/// A table in use, and the turns of the master that it spans.
#[derive(Clone, Copy, Debug)]
struct Wave {
    index: usize,
    turns: f64,
}

/// A table that may be superposed, and the largest of its values and of their first three
/// derivatives.
#[derive(Clone, Debug)]
struct Held {
    id: TableId,
    table: Periodic,
    highest: [f64; 4],
    /// Counts up with each table that comes.
    serial: u64,
}

/// Everything that is coupled.
#[derive(Clone, Debug)]
pub(crate) struct Coupled {
    tables: Vec<Option<Held>>,
    serial: u64,
    gears: [Option<GearRun>; SPINDLES],
    slots: [Option<Slot>; AXES + SPINDLES],
}

impl Coupled {
    pub(crate) fn new() -> Self {
        Self {
            tables: core::iter::repeat_with(|| None).take(TABLES).collect(),
            serial: 0,
            gears: [None; SPINDLES],
            slots: [None; AXES + SPINDLES],
        }
    }

    /// Keep a table; the one that was given back is no longer used, or never was.
    pub(crate) fn put(
        &mut self,
        id: TableId,
        table: Periodic,
    ) -> Result<Option<Periodic>, Periodic> {
        let same = self.index_of(id);
        let used = |index: usize| {
            let is = |wave: Option<Wave>| wave.is_some_and(|wave| wave.index == index);
            let names = |slot: &Slot| is(slot.from) || is(slot.to);
            self.slots.iter().flatten().any(names)
        };
        let free = || self.tables.iter().position(Option::is_none);
        // the oldest of those that nothing uses makes room
        let age = |i: &usize| self.tables[*i].as_ref().map_or(0, |held| held.serial);
        let oldest = || (0..TABLES).filter(|i| !used(*i)).min_by_key(age);
        let Some(place) = same.filter(|i| !used(*i)).or_else(free).or_else(oldest) else {
            return Err(table);
        };
        let highest = beside::highest(&table);
        self.serial += 1;
        let held = Held { id, table, highest, serial: self.serial };
        Ok(self.tables[place].replace(held).map(|old| old.table))
    }

    /// Whether a follower spindle is on its gear.
    pub(crate) fn is_locked(&self, follower: u8) -> bool {
        let run = self.gears.get(usize::from(follower)).and_then(Option::as_ref);
        run.is_some_and(|run| run.state == Engagement::Locked)
    }

    /// Whether all that was superposed has faded.
    pub(crate) fn has_faded(&self) -> bool {
        self.slots.iter().flatten().all(|slot| slot.fade.is_over())
    }

    /// Whether what is superposed on this is fading still.
    pub(crate) fn is_fading(&self, on: Superposed) -> bool {
        self.slots[slot_index(on)].is_some_and(|slot| !slot.fade.is_over())
    }

    /// Something is superposed on an axis, or fading.
    pub(crate) const fn is_superposed(&self, axis: usize) -> bool {
        self.slots[axis].is_some()
    }

    /// Nothing is coupled any more.
    pub(crate) fn reset(&mut self) {
        self.gears = [None; SPINDLES];
        self.slots = [None; AXES + SPINDLES];
    }

    fn index_of(&self, id: TableId) -> Option<usize> {
        self.tables.iter().position(|held| held.as_ref().is_some_and(|held| held.id == id))
    }

    fn swing(&self, slot: &Slot, master: Rotation, later_s: f64) -> Swing {
        let of = |wave: Option<Wave>| {
            let held = wave.and_then(|wave| Some((self.tables[wave.index].as_ref()?, wave.turns)));
            held.map_or_else(Swing::default, |(held, turns)| {
                let slower = Rotation {
                    angle: master.angle / turns,
                    spin: master.spin / turns,
                    accel: master.accel / turns,
                };
                Swing::of(&held.table, slower)
            })
        };
        if slot.fade.is_over() {
            return of(slot.to);
        }
        Swing::faded(of(slot.from), of(slot.to), slot.fade.weight(later_s))
    }
}

const fn slot_index(on: Superposed) -> usize {
    match on {
        Superposed::Axis(axis) => axis.index(),
        // a spindle beyond the bus shares the last place; `superpose` has refused it
        Superposed::Spindle(spindle) => {
            let last = SPINDLES - 1;
            AXES + if (spindle as usize) < last { spindle as usize } else { last }
        }
    }
}

impl Drives {
    /// Gear a spindle to another one.
    pub(crate) fn engage(&mut self, step: &GearStep) -> Result<(), Finding> {
        let (follower, master) = (usize::from(step.follower), usize::from(step.master));
        self.has_spindle(follower)?;
        self.has_spindle(master)?;
        let axis = step.axis.map(|(axis, _)| axis.index());
        if let Some((axis, _)) = step.axis.filter(|(axis, _)| self.axes[axis.index()].is_none()) {
            return Err((FaultKind::NotConfigured, Subject::Axis(axis), 0.0, 0.0));
        }
        let lead = step.axis.map(|(_, lead)| lead);
        let gear = Gear::new(step.ratio.follower, step.ratio.master, step.phase, lead);
        let ratio = gear.ratio().abs().max(f64::MIN_POSITIVE);
        let can = |index: usize| {
            self.spindles[index].as_ref().map_or(f64::INFINITY, |s| s.accel_at_most(PACED))
        };
        self.pace(master, can(follower) / ratio);
        let state = Engagement::Spinning;
        let (turns, waited) = (Angle::ZERO, Time::ZERO);
        self.coupled.gears[follower] = Some(GearRun { gear, master, axis, state, turns, waited });
        Ok(())
    }

    /// Let go of a geared spindle; it comes to rest.
    pub(crate) fn release(&mut self, follower: u8) {
        let follower = usize::from(follower);
        let Some(run) = self.coupled.gears.get_mut(follower).and_then(Option::take) else { return };
        if let Some(spindle) = &mut self.spindles[follower] {
            spindle.stop();
        }
        self.leave(run.master);
    }

    /// Lead a master by angle from now on, if the machine's spindles can be; its speed changes no
    /// faster than a share of its torque, and than `most`, rev/s², allow.
    pub(crate) fn pace(&mut self, master: usize, most: f64) {
        if let Some(spindle) = self.spindles[master].as_mut().filter(|_| self.paces) {
            let most = most.min(spindle.accel_at_most(PACED));
            spindle.pace(Some(most));
        }
    }

    /// A master that nothing follows any more only turns.
    pub(crate) fn leave(&mut self, master: usize) {
        let geared = self.coupled.gears.iter().flatten().any(|run| run.master == master);
        let superposed = self.coupled.slots.iter().flatten().any(|slot| slot.master == master);
        if let Some(spindle) = self.spindles[master].as_mut().filter(|_| !geared && !superposed) {
            spindle.pace(None);
        }
    }

    /// Begin, exchange or end a superposition.
    pub(crate) fn superpose(&mut self, order: &Superpose) -> Result<(), Finding> {
        let master = usize::from(order.master);
        self.has_spindle(master)?;
        let (speed, accel) = match order.on {
            Superposed::Axis(axis) => {
                let Some(loop_) = &self.axes[axis.index()] else {
                    return Err((FaultKind::NotConfigured, Subject::Axis(axis), 0.0, 0.0));
                };
                (loop_.control.approach.0.value(), loop_.control.approach.1.value())
            }
            Superposed::Spindle(spindle) => {
                self.has_spindle(usize::from(spindle))?;
                let of = self.spindles[usize::from(spindle)].as_ref();
                of.map_or((1.0, 1.0), |s| (s.control.orient.0.value(), s.control.orient.1.value()))
            }
        };
        let to = match order.table {
            None => None,
            Some(id) => {
                let index = self.coupled.index_of(id);
                let name = f64::from(id.0);
                let index = index.ok_or((FaultKind::TableMissing, Subject::Machine, name, 0.0))?;
                Some(Wave { index, turns: order.turns })
            }
        };
        let index = slot_index(order.on);
        let from = self.coupled.slots[index].and_then(|slot| slot.to);
        let highest = |wave: Option<Wave>| {
            let table = wave.and_then(|wave| self.coupled.tables[wave.index].as_ref());
            table.map_or(0.0, |held| held.highest[0])
        };
        let way = if from.is_some() && to.is_some() { 0.0 } else { highest(from) + highest(to) };
        let approach_s = Blend::new(0.0, way, speed, accel).duration_s();
        let spin = self.master(master).spin.abs().value();
        let turning_s = if spin > 0.0 { order.over.abs().value() / spin } else { 0.0 };
        let fade = Fade::lasting(turning_s.max(approach_s).max(SHORTEST_FADE_S));
        self.coupled.slots[index] = Some(Slot { master, from, to, fade });
        self.pace(master, f64::INFINITY);
        Ok(())
    }

    /// Set what the couplings say for this period; after steps and spindles.
    pub(crate) fn couple(&mut self, period: Time) {
        for axis in 0..AXES {
            let Some(mut slot) = self.coupled.slots[axis] else { continue };
            slot.fade.advance(period.value());
            let ended = slot.to.is_none() && slot.fade.is_over();
            let swing = self.coupled.swing(&slot, self.master(slot.master), 0.0);
            if let Some(axis) = &mut self.axes[axis] {
                axis.superposed = if ended { Target::default() } else { target(swing) };
            }
            self.coupled.slots[axis] = (!ended).then_some(slot);
            if ended {
                self.leave(slot.master);
            }
        }
        for spindle in 0..SPINDLES {
            self.swing_master(spindle, period);
        }
        for follower in 0..SPINDLES {
            if let Some(mut run) = self.coupled.gears[follower] {
                self.turn_along(follower, &mut run, period);
                self.coupled.gears[follower] = Some(run);
            }
        }
    }

    /// What is superposed on a spindle by its own turn.
    fn swing_master(&mut self, index: usize, period: Time) {
        let place = AXES + index;
        let own = self.coupled.slots[place].filter(|slot| slot.master == index);
        let master = self.master(index);
        let lookahead = self.spindles[index].as_ref().map_or(0.0, SpindleLoop::lookahead_s);
        let mut swing = (Swing::default(), Swing::default());
        if let Some(mut slot) = own {
            slot.fade.advance(period.value());
            let ended = slot.to.is_none() && slot.fade.is_over();
            if !ended {
                let later = master.after(Time::s(lookahead));
                swing = (
                    self.coupled.swing(&slot, master, 0.0),
                    self.coupled.swing(&slot, later, lookahead),
                );
            }
            self.coupled.slots[place] = (!ended).then_some(slot);
            if ended {
                self.leave(index);
            }
        }
        if let Some(spindle) = &mut self.spindles[index] {
            spindle.swing = swing;
        }
    }

    /// A follower's setpoint for this period.
    fn turn_along(&mut self, follower: usize, run: &mut GearRun, period: Time) {
        let index = AXES + follower;
        if let Some(slot) = &mut self.coupled.slots[index] {
            slot.fade.advance(period.value());
            if slot.to.is_none() && slot.fade.is_over() {
                self.coupled.slots[index] = None; // the gear itself still leads its master
            }
        }
        let lookahead = self.spindles[follower].as_ref().map_or(0.0, SpindleLoop::lookahead_s);
        let master = self.master(run.master);
        let (now, ahead) = (
            self.belongs(index, run, master, Time::ZERO),
            self.belongs(index, run, master.after(Time::s(lookahead)), Time::s(lookahead)),
        );
        run.waited += period;
        let Some(spindle) = &mut self.spindles[follower] else { return };
        if run.state == Engagement::Spinning {
            spindle.slew_to(now.spin);
            if spindle.at_speed().is_some() {
                let place = spindle.now().angle;
                run.state = Engagement::phasing(place, now.angle, &engaging(spindle));
                run.turns = Angle::rev(libm::round((place - now.angle).value()));
                run.waited = Time::ZERO;
            }
            return;
        }
        let locked = run.state == Engagement::Locked;
        run.state = run.state.next(period, Angle::rev(spindle.error()), &engaging(spindle));
        if locked || run.state == Engagement::Locked {
            run.waited = Time::ZERO;
        }
        spindle.lead(now, ahead, true);
    }

    /// Where a follower belongs under a master's motion, with what is superposed on it.
    fn belongs(&self, index: usize, run: &GearRun, master: Rotation, later: Time) -> Rotation {
        let travel =
            run.axis.and_then(|i| self.axes[i].as_ref()).map_or_else(Travel::default, |axis| {
                Travel {
                    position: Length::mm(axis.target.position + later.value() * axis.target.speed),
                    speed: Speed::mm_per_s(axis.target.speed),
                    accel: Accel::mm_per_s2(axis.target.accel),
                }
            });
        let swing = self.coupled.slots[index]
            .as_ref()
            .map_or_else(Swing::default, |slot| self.coupled.swing(slot, master, later.value()));
        let (on_gear, gap) = (run.gear.follow(master, travel), run.state.offset(later));
        Rotation {
            angle: on_gear.angle + run.turns + gap.angle + Angle::rev(swing.value),
            spin: on_gear.spin + gap.spin + units::Spin::rev_per_s(swing.rate),
            accel: on_gear.accel + gap.accel + units::SpinAccel::rev_per_s2(swing.accel),
        }
    }

    /// How a master turns: by its setpoint where it has one, else by its observer.
    pub(crate) fn master(&self, index: usize) -> Rotation {
        self.spindles[index].as_ref().map_or_else(Rotation::default, SpindleLoop::master)
    }

    /// The same as it will be once the spindles have advanced, for steps: they come before them in
    /// a period.
    pub(crate) fn master_after_steps(&self, index: usize, period: Time) -> Rotation {
        let led = self.spindles[index].as_ref().is_some_and(SpindleLoop::position_controlled);
        let master = self.master(index);
        if led { master.after(period) } else { master }
    }

    /// Whether all geared spindles get and stay on their gears.
    pub(crate) fn check_coupled(
        &self,
        coarse: Time,
        fine: Time,
        off: Option<Angle>,
    ) -> Result<(), Finding> {
        for (index, run) in self.coupled.gears.iter().enumerate() {
            let (Some(run), Some(spindle)) = (run, &self.spindles[index]) else { continue };
            let of = Subject::Spindle(index as u8);
            match run.state {
                Engagement::Spinning if run.waited > coarse => {
                    let has = spindle.now().spin;
                    let wanted = self.master(run.master).spin * run.gear.ratio();
                    let clamped = has.abs() < spindle.control.windows.at_rest;
                    let kind =
                        if clamped { FaultKind::StillClamped } else { FaultKind::RatioNotHeld };
                    return Err((kind, of, has.value(), wanted.value()));
                }
                Engagement::Phasing { .. } if run.waited > fine => {
                    let window = spindle.control.windows.oriented.value();
                    return Err((FaultKind::PhaseNotReached, of, spindle.error(), window));
                }
                Engagement::Locked => {
                    let master = self.spindles[run.master].as_ref().map_or(0.0, SpindleLoop::error);
                    let lost = spindle.error() - run.gear.ratio() * master;
                    let window = off.unwrap_or(spindle.control.windows.following_stop).value();
                    if lost.abs() > window {
                        return Err((FaultKind::CouplingLost, of, lost, window));
                    }
                }
                Engagement::Spinning | Engagement::Phasing { .. } => {}
            }
        }
        Ok(())
    }

    fn has_spindle(&self, index: usize) -> Result<(), Finding> {
        if self.spindles.get(index).is_some_and(Option::is_some) {
            return Ok(());
        }
        Err((FaultKind::NotConfigured, Subject::Spindle(index as u8), 0.0, 0.0))
    }
}

fn engaging(spindle: &SpindleLoop) -> Engaging {
    let control = &spindle.control;
    Engaging {
        spin: control.orient.0,
        accel: control.orient.1,
        fine: control.windows.oriented,
        settle: Time::s(spindle.lookahead_s() * 8.0),
    }
}

const fn target(swing: Swing) -> Target {
    Target { position: swing.value, speed: swing.rate, accel: swing.accel, jerk: swing.jerk }
}
