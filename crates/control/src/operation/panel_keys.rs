//! Keys, dials and the handwheel of a panel beside the machine, and what each asks for.
//!
//! | pressed, turned, held | asks for |
//! |---|---|
//! | cycle start | go on with what is held, or at M0 or M1; else start the program that is loaded |
//! | hold | hold the feed; without a program: what is moved by hand comes to rest |
//! | stop | give the program up; without one the same |
//! | reset | clear alarms |
//! | power on, power off | the same |
//! | home all | home all axes, in the machine's order |
//! | flood, mist, on and off | switch the coolant, also while a program is under way |
//! | a key of blocks | execute the blocks that the machine file has for it |
//! | single block | hold after each block as long as it is set |
//! | optional stop, block skip | stop at M1, leave out blocks behind `/` as long as it is set |
//! | dial of an override | so much more or less than now, or the value at which it is set |
//! | handwheel | the axis goes by as much, while no program is under way |
//! | jog key | the axis is jogged until the key is released |
//!
//! A key that was pressed before the control began asks for nothing, and cycle start for nothing
//! while hold or stop is pressed. What stops is asked for first.
use super::request::{Jog, Request};
use super::state::Execution;
use bus::{AXES, MDI_KEYS, OverrideDial, Panel};
use canon::Axis;
use std::collections::VecDeque;
use units::{Coordinate, CoordinateSpeed, Time};

/// Requests that wait; keys that are pressed faster than they are answered are left out.
const MOST: usize = 16;
/// A jog is asked for again in this time while its key is held.
const RENEWED: Time = Time::s(0.08);

/// How the control is, for a panel that asks something of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanelContext {
    pub(super) time: Time,
    pub(super) execution: Execution,
    /// Overrides of feed, rapid and spindle, share, and from where to where each may be set.
    pub(super) overrides: [f64; 3],
    pub(super) ranges: [(f64, f64); 3],
    /// Fastest jog of each axis, by bus index; `None`: there is no such axis.
    pub(super) fastest: [Option<CoordinateSpeed>; AXES],
}

/// The panel, as it was, and what it asks for.
#[derive(Debug, Default)]
pub(super) struct PanelKeys {
    before: Option<Panel>,
    asked: VecDeque<Request>,
    /// When jogs of keys were asked for last.
    jogged: Time,
    /// Keys, dials and wheels that have asked for something that begins or changes something.
    count: u64,
    /// What each key of blocks executes.
    mdi: Vec<String>,
}

impl PanelKeys {
    /// A panel whose keys of blocks execute these.
    pub(super) fn new(mdi: &[String]) -> Self {
        Self { mdi: mdi.to_vec(), ..Self::default() }
    }

    /// Takes what is pressed now; what is to be said of it.
    pub(super) fn take(&mut self, now: Panel, context: &PanelContext) -> Option<String> {
        let Some(before) = self.before.replace(now) else {
            for (_, request) in switches(&now).into_iter().filter(|(is_set, _)| *is_set) {
                self.ask(request);
            }
            return None;
        };
        if now == before && now.jog == [0; AXES] {
            return None; // the usual case
        }
        let has_program = context.execution.is_under_way();
        if now.stop && !before.stop {
            self.ask(if has_program { Request::Stop } else { Request::JogStop });
        }
        if now.hold && !before.hold {
            self.ask(if has_program { Request::FeedHold } else { Request::JogStop });
        }
        for (pressed, was_pressed, request) in [
            (now.reset, before.reset, Request::Reset),
            (now.power_off, before.power_off, Request::Power(false)),
            (now.power_on, before.power_on, Request::Power(true)),
            (now.home, before.home, Request::Home(None)),
            (now.flood[0], before.flood[0], Request::Flood(false)),
            (now.flood[1], before.flood[1], Request::Flood(true)),
            (now.mist[0], before.mist[0], Request::Mist(false)),
            (now.mist[1], before.mist[1], Request::Mist(true)),
        ] {
            if pressed && !was_pressed {
                self.begin(request);
            }
        }
        for ((is_set, request), (was_set, _)) in switches(&now).into_iter().zip(switches(&before)) {
            if is_set != was_set {
                self.begin(request);
            }
        }
        self.turn_dials(&now, &before, context);
        self.press_jog_keys(&now, &before, context);
        let wheels = self.turn_wheels(&now, &before, has_program).map(str::to_owned);
        let said = self.press_mdi(now.mdi & !before.mdi).or(wheels);
        if !now.cycle_start || before.cycle_start {
            return said;
        }
        if now.hold || now.stop {
            return Some("hold or stop is pressed: release it, then press cycle start".into());
        }
        self.begin(match context.execution {
            Execution::ProgramStopped | Execution::OptionalStop => Request::Confirm,
            _ if has_program => Request::Resume,
            _ => Request::Start,
        });
        said
    }

    /// Blocks of the keys that were pressed; what is said of one that has none.
    fn press_mdi(&mut self, pressed: u32) -> Option<String> {
        let mut said = None;
        for key in (0..MDI_KEYS).filter(|key| pressed >> key & 1 == 1) {
            match self.mdi.get(key).cloned() {
                Some(blocks) => {
                    self.begin(Request::ManualDataInput(blocks));
                }
                None => {
                    said = Some(format!(
                        "mdi-{key:02} has no blocks: the machine file has {} under [hal], in `mdi`",
                        self.mdi.len()
                    ));
                }
            }
        }
        said
    }

    fn turn_dials(&mut self, now: &Panel, before: &Panel, context: &PanelContext) {
        let orders = [Request::FeedOverride, Request::RapidOverride, Request::SpindleOverride];
        for (index, order) in orders.into_iter().enumerate() {
            let share =
                turned(now.overrides[index], before.overrides[index], context.overrides[index]);
            let (least, most) = context.ranges[index];
            if let Some(share) = share.filter(|share| share.is_finite()) {
                self.begin(order(share.clamp(least, most)));
            }
        }
    }

    /// What the wheel has asked for while a program is under way is left out, and said.
    fn turn_wheels(
        &mut self,
        now: &Panel,
        before: &Panel,
        has_program: bool,
    ) -> Option<&'static str> {
        let mut said = None;
        for (index, axis) in Axis::ALL.into_iter().enumerate() {
            let by = now.wheel[index].since(before.wheel[index]);
            if by == Coordinate::ZERO {
                continue;
            }
            if has_program {
                said = Some("the handwheel moves nothing while a program is under way");
            } else if !self.begin(Request::Jog(axis, Jog::Handwheel(by))) {
                // it is asked for as soon as there is room
                if let Some(kept) = &mut self.before {
                    kept.wheel[index] = before.wheel[index];
                }
            }
        }
        said
    }

    /// A key that is released stops what is jogged; those that are held are asked for again, so
    /// that they go on.
    fn press_jog_keys(&mut self, now: &Panel, before: &Panel, context: &PanelContext) {
        let is_released = (0..AXES).any(|at| before.jog[at] != 0 && now.jog[at] != before.jog[at]);
        if is_released {
            self.ask(Request::JogStop);
        }
        let is_due = (context.time - self.jogged).abs() >= RENEWED;
        let is_changed = now.jog != before.jog || now.jog_speed != before.jog_speed;
        if now.jog == [0; AXES] || !is_due && !is_changed {
            return;
        }
        self.jogged = context.time;
        for (index, axis) in Axis::ALL.into_iter().enumerate() {
            let Some(fastest) = context.fastest[index].filter(|_| now.jog[index] != 0) else {
                continue;
            };
            let speed = now.jog_speed.abs().min(fastest) * f64::from(now.jog[index]);
            let jog = Request::Jog(axis, Jog::Continuous(speed));
            let _ = if is_changed { self.begin(jog) } else { self.ask(jog) };
        }
    }

    /// Something that begins or changes something; false: there is no room.
    fn begin(&mut self, request: Request) -> bool {
        let has_room = self.ask(request);
        self.count += u64::from(has_room);
        has_room
    }

    fn ask(&mut self, request: Request) -> bool {
        let has_room = self.asked.len() < MOST;
        if has_room {
            self.asked.push_back(request);
        }
        has_room
    }

    /// What is asked for next.
    pub(super) fn next(&mut self) -> Option<Request> {
        self.asked.pop_front()
    }

    /// How often a key, a dial or the wheel has begun or changed something: the panel commands
    /// then.
    pub(super) const fn count(&self) -> u64 {
        self.count
    }
}

/// Switches, and what each asks for as it is set.
fn switches(panel: &Panel) -> [(bool, Request); 3] {
    let Panel { single_block, optional_stop, block_skip, .. } = *panel;
    [
        (single_block, Request::SingleBlock(single_block)),
        (optional_stop, Request::OptionalStop(optional_stop)),
        (block_skip, Request::BlockSkip(1, block_skip)),
    ]
}

/// Where a dial has set an override, share; `None`: it was not turned.
fn turned(now: OverrideDial, before: OverrideDial, share: f64) -> Option<f64> {
    match now.at {
        Some(at) => (before.at != Some(at)).then(|| f64::from(at) / 100.0),
        None => (now.turned != before.turned)
            .then(|| share + f64::from(now.turned - before.turned) / 100.0),
    }
}

/// What is said of a key that came to nothing.
pub(super) fn said_of_panel(why: &str) -> String {
    format!("the panel: {why}")
}

#[cfg(test)]
mod tests {
    use super::*;

    use bus::WheelTravel;

    fn none() -> Panel {
        Panel { jog_speed: CoordinateSpeed::new(5.0), ..Panel::default() }
    }

    fn cycle_start() -> Panel {
        Panel { cycle_start: true, ..none() }
    }

    /// A control with X and Z, whose overrides are at 100 %.
    fn context(execution: Execution) -> PanelContext {
        let mut fastest = [None; AXES];
        fastest[Axis::X.index()] = Some(CoordinateSpeed::new(10.0));
        fastest[Axis::Z.index()] = Some(CoordinateSpeed::new(3.0));
        PanelContext {
            time: Time::ZERO,
            execution,
            overrides: [1.0; 3],
            ranges: [(0.0, 2.0), (0.0, 1.0), (0.5, 1.2)],
            fastest,
        }
    }

    fn all(keys: &mut PanelKeys) -> Vec<Request> {
        std::iter::from_fn(|| keys.next()).collect()
    }

    /// What is asked for when this is pressed after nothing was.
    fn asked(now: Panel, execution: Execution) -> Vec<Request> {
        let mut keys = PanelKeys::default();
        keys.take(none(), &context(execution));
        keys.take(now, &context(execution));
        keys.take(now, &context(execution)); // it is asked for once
        all(&mut keys)
    }

    #[test]
    fn a_dial_turns_an_override_on_from_where_it_is_or_sets_it() {
        let dial = |turned, at| {
            let mut panel = none();
            panel.overrides[0] = OverrideDial { turned, at };
            panel
        };
        assert_eq!(asked(dial(-10.0, None), Execution::Active), [Request::FeedOverride(0.9)]);
        assert_eq!(asked(dial(500.0, None), Execution::Active), [Request::FeedOverride(2.0)]);
        assert_eq!(asked(dial(0.0, Some(75.0)), Execution::Ready), [Request::FeedOverride(0.75)]);
        let mut spindle = none();
        spindle.overrides[2].at = Some(10.0);
        assert_eq!(asked(spindle, Execution::Active), [Request::SpindleOverride(0.5)]);
        let mut keys = PanelKeys::default();
        keys.take(dial(30.0, None), &context(Execution::Ready));
        assert_eq!(all(&mut keys), [], "where it stands when the control begins is no turn");
        // the page has set 50 % meanwhile: the next click goes on from there
        let mut changed = context(Execution::Ready);
        changed.overrides[0] = 0.5;
        keys.take(dial(31.0, None), &changed);
        assert_eq!(all(&mut keys), [Request::FeedOverride(0.51)]);
    }

    #[test]
    fn each_step_of_the_wheel_moves_its_axis_and_none_is_lost() {
        let at = |steps| {
            let mut panel = none();
            panel.wheel[Axis::Z.index()] = WheelTravel::of_steps(steps);
            panel
        };
        let by = |requests: Vec<Request>| -> f64 {
            let one = |request| match request {
                Request::Jog(Axis::Z, Jog::Handwheel(by)) => by.value(),
                other => panic!("{other:?}"),
            };
            requests.into_iter().map(one).sum()
        };
        assert_eq!(by(asked(at(250), Execution::Ready)), 0.025);
        let mut keys = PanelKeys::default();
        for steps in 0..1000 {
            keys.take(at(i32::MAX.wrapping_add(steps)), &context(Execution::Ready));
        }
        let first = by(all(&mut keys));
        keys.take(at(i32::MAX.wrapping_add(999)), &context(Execution::Ready));
        assert!((first + by(all(&mut keys)) - 0.0999).abs() < 1e-9);
        let mut keys = PanelKeys::default();
        keys.take(at(0), &context(Execution::Active));
        let said = keys.take(at(10), &context(Execution::Active));
        assert!(said.is_some_and(|said| said.contains("program is under way")));
        keys.take(at(10), &context(Execution::Ready));
        assert_eq!(all(&mut keys), [], "what was turned meanwhile is not made up for");
    }

    #[test]
    fn a_jog_key_jogs_while_it_is_held_and_stops_when_it_is_released() {
        let held = |x, z| {
            let mut panel = none();
            (panel.jog[Axis::X.index()], panel.jog[Axis::Z.index()]) = (x, z);
            panel
        };
        let jog = |axis, speed| Request::Jog(axis, Jog::Continuous(CoordinateSpeed::new(speed)));
        let mut keys = PanelKeys::default();
        let mut ready = context(Execution::Ready);
        keys.take(held(0, 0), &ready);
        keys.take(held(1, -1), &ready);
        assert_eq!(all(&mut keys), [jog(Axis::X, 5.0), jog(Axis::Z, -3.0)], "at most its fastest");
        for _ in 0..100 {
            ready.time += Time::s(1e-3);
            keys.take(held(1, -1), &ready);
        }
        assert_eq!(all(&mut keys).len(), 2, "asked for again within its lease of 0.2 s");
        let begun = keys.count();
        keys.take(held(1, 0), &ready);
        assert_eq!(all(&mut keys), [Request::JogStop, jog(Axis::X, 5.0)]);
        keys.take(held(0, 0), &ready);
        assert_eq!(all(&mut keys), [Request::JogStop]);
        assert_eq!(keys.count(), begun + 1, "a stop does not take the right to command");
    }

    #[test]
    fn each_key_asks_for_what_can_be_meant() {
        assert_eq!(asked(cycle_start(), Execution::Ready), [Request::Start]);
        assert_eq!(asked(cycle_start(), Execution::FeedHold), [Request::Resume]);
        assert_eq!(asked(cycle_start(), Execution::ProgramStopped), [Request::Confirm]);
        let stop = Panel { stop: true, ..none() };
        assert_eq!(asked(stop, Execution::Active), [Request::Stop]);
        assert_eq!(asked(stop, Execution::Ready), [Request::JogStop]);
        assert_eq!(asked(Panel { hold: true, ..none() }, Execution::Active), [Request::FeedHold]);
        assert_eq!(asked(Panel { reset: true, ..none() }, Execution::Stopped), [Request::Reset]);
        let both = Panel { stop: true, ..cycle_start() };
        assert_eq!(asked(both, Execution::Active), [Request::Stop], "never a start beside a stop");
    }

    #[test]
    fn keys_of_power_homing_and_blocks_ask_for_them_and_switches_as_they_are_set() {
        let power = Panel { power_on: true, ..none() };
        assert_eq!(asked(power, Execution::Ready), [Request::Power(true)]);
        let off = Panel { power_off: true, ..none() };
        assert_eq!(asked(off, Execution::Ready), [Request::Power(false)]);
        let home = Panel { home: true, ..none() };
        assert_eq!(asked(home, Execution::Ready), [Request::Home(None)]);
        let flood = Panel { flood: [false, true], mist: [true, false], ..none() };
        let both = [Request::Flood(true), Request::Mist(false)];
        assert_eq!(asked(flood, Execution::Active), both);
        let mut keys = PanelKeys::new(&["G53 G0 Z0".into(), "M8".into()]);
        let ready = context(Execution::Ready);
        keys.take(none(), &ready);
        assert_eq!(keys.take(Panel { mdi: 0b10, ..none() }, &ready), None);
        assert_eq!(keys.take(Panel { mdi: 0b10, ..none() }, &ready), None, "once");
        let said = keys.take(Panel { mdi: 0b1000, ..none() }, &ready);
        assert!(
            said.is_some_and(
                |said| said.starts_with("mdi-03 has no blocks: the machine file has 2")
            )
        );
        assert_eq!(all(&mut keys), [Request::ManualDataInput("M8".into())]);
        let set = Panel { optional_stop: true, block_skip: true, ..none() };
        let on = [Request::OptionalStop(true), Request::BlockSkip(1, true)];
        assert_eq!(asked(set, Execution::Ready), on);
        let mut keys = PanelKeys::default();
        keys.take(set, &ready);
        assert_eq!(all(&mut keys), on, "also where it was set before the control began");
        keys.take(none(), &ready);
        let off = [Request::OptionalStop(false), Request::BlockSkip(1, false)];
        assert_eq!(all(&mut keys), off);
    }

    #[test]
    fn a_key_that_is_stuck_when_the_control_begins_asks_for_nothing() {
        let mut keys = PanelKeys::default();
        for _ in 0..3 {
            keys.take(cycle_start(), &context(Execution::Ready));
        }
        assert_eq!(keys.next(), None);
        keys.take(none(), &context(Execution::Ready));
        keys.take(cycle_start(), &context(Execution::Ready));
        assert_eq!(keys.next(), Some(Request::Start));
    }

    #[test]
    fn a_key_that_is_hammered_waits_for_no_more_than_so_many_answers() {
        let mut keys = PanelKeys::default();
        for at in 0..1000 {
            keys.take(Panel { cycle_start: at % 2 == 1, ..none() }, &context(Execution::Ready));
        }
        assert_eq!(std::iter::from_fn(|| keys.next()).count(), MOST);
    }
}
