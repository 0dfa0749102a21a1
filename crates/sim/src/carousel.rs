//! The hardware of a tool carousel without an arm: it swings under the spindle, and Z does the
//! rest.
//!
//! ```text
//!      spindle ┌─┐  drawbar: open against its springs     pocket turns with the motor's turn (Geneva drive):
//!              │ │                                              g │        ╭──╮ dwell: the pocket sensor is on
//!   change_z ──┤▼├── tool ──┐                                     │      ╭╯
//!              └─┘          │ pocket ◄─► swings (valve with two   │ ──╯
//!                                       coils: it stays)          └────────────► m, turns of the motor
//! ```
//!
//! It knows outputs, air, springs and where things are, and nothing of what a control believes.
//! What no machine survives is counted as a [`CarouselTruth`]: a collision, a tool that drops.
use crate::rng::Rng;
use bus::Signals;
use units::{Length, Time};

/// A tool is seated in the taper while Z is this near to the change height, mm.
const SEATED_MM: f64 = 1.0;
/// A drawbar that closes grips the tool if Z is this near, mm.
const GRIPS_MM: f64 = 2.0;
/// From this far above the change height downwards the gripper meets the stud of a tool, mm.
const STUD_MM: f64 = 40.0;
/// Play of a closed gripper over the stud of a tool, mm.
const PLAY_MM: f64 = 0.2;
/// The motor's turn over which a pocket dwells, and its sensor is on, to either side of the middle.
const DWELL: f64 = 0.1;
/// Time constant with which the motor comes to rest, s.
const RUN_ON_S: f64 = 0.02;
/// A spindle that turns faster is no spindle for a tool change, rev/s.
const AT_REST: f64 = 1.0;
/// Most collisions that are described; all are counted.
const MOST_DESCRIBED: usize = 8;

/// A carousel to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct CarouselModel {
    /// Tool in each pocket, pocket 1 first; 0 is none.
    pub pockets: Vec<u32>,
    /// Machine coordinate of Z at which spindle and pocket hold the same tool.
    pub change_z: Length,
    /// Machine coordinate of Z above which an empty spindle is clear of the pockets.
    pub clear_z: Length,
    /// Outputs: drawbar, carousel in, carousel out, forward, backward.
    pub outputs: [u8; 5],
    /// Inputs: drawbar open, tool in the taper, carousel in, carousel out, pocket, pocket 1,
    /// drawbar closed.
    pub inputs: [u8; 7],
    /// Time in which the carousel swings in or out.
    pub swing: Time,
    /// Time in which the drawbar opens or closes.
    pub drawbar: Time,
    /// Time from pocket to pocket.
    pub pocket: Time,
    /// Delay of each sensor.
    pub delay: Time,
    /// Time for which each sensor bounces.
    pub bounce: Time,
    /// Seed of the bouncing.
    pub seed: u64,
}

/// What fails on a carousel, until it is mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CarouselMishap {
    /// The cylinder that swings it is stuck.
    SwingStuck,
    /// The drawbar is stuck.
    DrawbarStuck,
    /// The compressed air is gone: springs close the drawbar.
    AirLost,
    /// A sensor, by its place in [`CarouselModel::inputs`], stays off.
    SensorDead(usize),
}

/// What is true of a carousel, and what happened to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarouselTruth {
    /// Tool in each pocket, pocket 1 first; 0 is none.
    pub pockets: Vec<u32>,
    /// Tool in the spindle; 0 is none. One that a pocket holds as well counts for that alone.
    pub spindle: u32,
    /// Pocket at the spindle, from 1; `None`: it is between two.
    pub at: Option<u32>,
    /// The carousel is at neither end of its swing, or in.
    pub is_in_the_way: bool,
    /// Number of collisions.
    pub collisions: u32,
    /// The first of them, in sentences.
    pub described: Vec<String>,
    /// Tools that dropped.
    pub dropped: Vec<u32>,
}

/// A carousel as it is.
#[derive(Clone, Debug)]
pub(crate) struct Carousel {
    model: CarouselModel,
    mishaps: Vec<CarouselMishap>,
    /// The valve of the swing: in.
    valve_in: bool,
    /// 0: out; 1: in.
    swung: f64,
    /// 0: closed; 1: open.
    drawbar: f64,
    /// Turns of the motor, of which a pocket is one; whole at the middle of a dwell.
    motor: f64,
    motor_speed: f64,
    pockets: Vec<u32>,
    spindle: u32,
    /// The drawbar grips the tool that a pocket holds as well.
    shared: bool,
    z: f64,
    /// Highest Z since the drawbar has been closed over a pocket.
    closed_from: f64,
    in_collision: bool,
    collisions: u32,
    described: Vec<String>,
    dropped: Vec<u32>,
    sensors: [Sensor; 7],
    rng: Rng,
}

/// A sensor with its delay and its bouncing.
#[derive(Clone, Copy, Debug, Default)]
struct Sensor {
    raw: bool,
    /// Time since what it sees changed, s.
    age: f64,
    shown: bool,
}

impl Sensor {
    fn step(&mut self, raw: bool, dt: f64, (delay, bounce): (f64, f64), rng: &mut Rng) {
        self.age = if raw == self.raw { self.age + dt } else { 0.0 };
        self.raw = raw;
        if self.age >= delay + bounce {
            self.shown = raw;
        } else if self.age >= delay {
            self.shown = rng.unit() < 0.5;
        }
    }
}

impl Carousel {
    /// At rest: out, drawbar closed, nothing in the spindle, pocket 1 at it.
    pub(crate) fn new(model: CarouselModel) -> Self {
        let mut new = Self {
            mishaps: Vec::new(),
            valve_in: false,
            swung: 0.0,
            drawbar: 0.0,
            motor: 0.0,
            motor_speed: 0.0,
            pockets: model.pockets.clone(),
            spindle: 0,
            shared: false,
            z: f64::INFINITY,
            closed_from: f64::NEG_INFINITY,
            in_collision: false,
            collisions: 0,
            described: Vec::new(),
            dropped: Vec::new(),
            sensors: [Sensor::default(); 7],
            rng: Rng::new(model.seed),
            model,
        };
        for (sensor, seen) in new.seen().into_iter().enumerate() {
            new.sensors[sensor] = Sensor { raw: seen, age: f64::INFINITY, shown: seen };
        }
        new
    }

    /// Tools as a person has put them, while everything is out of the way.
    pub(crate) fn load(&mut self, pockets: &[u32], spindle: u32, at: Option<u32>) {
        for (own, tool) in self.pockets.iter_mut().zip(pockets) {
            *own = *tool;
        }
        self.spindle = spindle;
        self.motor = at.map_or(self.motor, |at| f64::from(at.saturating_sub(1)));
    }

    pub(crate) fn fail(&mut self, mishap: CarouselMishap) {
        self.mishaps.push(mishap);
    }

    pub(crate) fn mend(&mut self) {
        self.mishaps.clear();
    }

    fn has(&self, mishap: CarouselMishap) -> bool {
        self.mishaps.contains(&mishap)
    }

    /// The carousel's own place, pockets: the motor's turn through the Geneva drive.
    fn turned(&self) -> f64 {
        let (whole, rest) = (self.motor.floor(), self.motor.rem_euclid(1.0));
        let share = ((rest - 2.0 * DWELL) / (1.0 - 4.0 * DWELL)).clamp(0.0, 1.0);
        whole + share * share * (3.0 - 2.0 * share)
    }

    /// Index of the pocket at the spindle.
    fn at(&self) -> Option<usize> {
        let turned = self.turned();
        let is_there = (turned - turned.round()).abs() < 0.01;
        is_there.then(|| self.pocket_of_turn(turned))
    }

    /// Index of the pocket that this many turns bring to the spindle.
    fn pocket_of_turn(&self, turns: f64) -> usize {
        turns.round().rem_euclid(self.pockets.len().max(1) as f64) as usize
    }

    /// Tool in the pocket at the spindle.
    fn below(&self) -> u32 {
        self.at().map_or(0, |at| self.pockets[at])
    }

    fn is_in(&self) -> bool {
        self.swung > 0.98
    }

    fn is_out(&self) -> bool {
        self.swung < 0.02
    }

    fn height(&self) -> f64 {
        self.z - self.model.change_z.value()
    }

    /// The tool in the spindle, for what it cuts.
    pub(crate) fn tool(&self) -> u32 {
        self.spindle
    }

    /// One period, which ends with Z at this place and the spindle at this speed.
    pub(crate) fn step(&mut self, outputs: &Signals, z: f64, spin: f64, dt: f64) {
        let [drawbar, swing_in, swing_out, forward, backward] = self.model.outputs;
        let air = !self.has(CarouselMishap::AirLost);
        match (outputs.is_on(swing_in), outputs.is_on(swing_out)) {
            (true, false) => self.valve_in = true,
            (false, true) => self.valve_in = false,
            _ => {}
        }
        let swing_before = self.swung;
        if air && !self.has(CarouselMishap::SwingStuck) {
            let by = dt / self.model.swing.value();
            self.swung = (self.swung + if self.valve_in { by } else { -by }).clamp(0.0, 1.0);
        }
        let drawbar_before = self.drawbar;
        if !self.has(CarouselMishap::DrawbarStuck) {
            let by = dt / self.model.drawbar.value();
            let opens = air && outputs.is_on(drawbar);
            self.drawbar = (self.drawbar + if opens { by } else { -by }).clamp(0.0, 1.0);
        }
        let ordered =
            f64::from(i8::from(outputs.is_on(forward)) - i8::from(outputs.is_on(backward)));
        let speed = ordered / self.model.pocket.value();
        self.motor_speed += (speed - self.motor_speed) * (dt / RUN_ON_S).min(1.0);
        let turned_before = self.turned();
        self.motor += self.motor_speed * dt;
        let z_before = std::mem::replace(&mut self.z, z);
        let moves = Moves {
            swings: (self.swung - swing_before).abs() > 0.0,
            turns: (self.turned() - turned_before).abs() > 1e-9,
            falls: z_before.is_finite() && z < z_before - 1e-4,
            spins: spin.abs() > AT_REST,
        };
        let may_pass = self.drawbar >= 0.5 || !self.is_in();
        self.closed_from = if may_pass { z } else { self.closed_from.max(z) };
        self.hand_over(drawbar_before);
        self.judge(moves);
        self.show(dt);
    }

    /// What holds the tool changes with drawbar, swing and Z.
    fn hand_over(&mut self, drawbar_before: f64) {
        let closes = drawbar_before >= 0.5 && self.drawbar < 0.5;
        let opens = drawbar_before < 0.5 && self.drawbar >= 0.5;
        let height = self.height().abs();
        // the pocket swings to a tool that the spindle holds
        if self.spindle != 0
            && self.is_in()
            && height < SEATED_MM
            && self.below() == 0
            && let Some(at) = self.at()
        {
            self.pockets[at] = std::mem::take(&mut self.spindle);
            self.shared = self.drawbar < 0.5;
        }
        if self.is_in() && self.below() != 0 && self.spindle == 0 {
            if closes && height < GRIPS_MM {
                self.shared = true;
            }
            if opens {
                self.shared = false;
            }
        }
        // the pocket swings away from a tool that the spindle grips
        if self.shared && !self.is_in() {
            self.shared = false;
            if let Some(at) = self.at() {
                self.spindle = std::mem::take(&mut self.pockets[at]);
            }
        }
        if self.spindle != 0 && self.drawbar >= 0.5 {
            self.dropped.push(std::mem::take(&mut self.spindle));
        }
    }

    /// What may not be.
    fn judge(&mut self, moves: Moves) {
        let height = self.height();
        let above = self.z > self.model.clear_z.value();
        let at_height = height.abs() < SEATED_MM;
        let in_the_way = !self.is_out();
        let what = if !in_the_way {
            None
        } else if moves.spins {
            Some("the spindle turns beside a carousel that is not out")
        } else if self.shared && height.abs() > GRIPS_MM {
            Some("Z moves while spindle and pocket both hold the tool")
        } else if self.spindle != 0 && !at_height {
            Some("the tool in the spindle is not at the change height, and the carousel is not out")
        } else if self.spindle != 0 && self.below() != 0 {
            Some("a full pocket swings against the tool in the spindle")
        } else if self.spindle != 0 && moves.turns {
            Some("the carousel turns against the tool in the spindle")
        } else if moves.turns && !above && in_the_way {
            Some("the carousel turns under a spindle that is not clear of it")
        } else if moves.swings && !above && self.spindle == 0 && !self.shared && self.below() != 0 {
            Some("a full pocket swings against a spindle that is not clear of it")
        } else if self.z < self.closed_from - PLAY_MM
            && self.is_in()
            && self.below() != 0
            && !self.shared
            && height < STUD_MM
        {
            Some("Z comes down on a tool with the drawbar closed")
        } else if moves.falls && !self.is_in() && self.spindle == 0 && !above {
            Some("Z comes down on a carousel that is on its way")
        } else {
            None
        };
        let began = what.filter(|_| !self.in_collision);
        self.in_collision = what.is_some();
        if let Some(what) = began {
            self.collisions += 1;
            if self.described.len() < MOST_DESCRIBED {
                let (z, swung) = (self.z, self.swung * 100.0);
                self.described.push(format!("{what} (Z{z:.2}, swung in by {swung:.0} %)"));
            }
        }
    }

    /// What its sensors see.
    fn seen(&self) -> [bool; 7] {
        let seated = self.is_in() && self.below() != 0 && self.height().abs() < SEATED_MM;
        let dwells = (self.motor - self.motor.round()).abs() < DWELL;
        let is_first = self.pocket_of_turn(self.motor) == 0;
        [
            self.drawbar > 0.95,
            self.spindle != 0 || seated,
            self.is_in(),
            self.is_out(),
            dwells,
            dwells && is_first,
            self.drawbar < 0.05,
        ]
    }

    fn show(&mut self, dt: f64) {
        let times = (self.model.delay.value(), self.model.bounce.value());
        for (index, raw) in self.seen().into_iter().enumerate() {
            let raw = raw && !self.mishaps.contains(&CarouselMishap::SensorDead(index));
            self.sensors[index].step(raw, dt, times, &mut self.rng);
        }
    }

    /// Its sensors among the machine's inputs.
    pub(crate) fn inputs(&self, signals: &mut Signals) {
        for (number, sensor) in self.model.inputs.iter().zip(&self.sensors) {
            signals.switch(*number, sensor.shown);
        }
    }

    pub(crate) fn truth(&self) -> CarouselTruth {
        CarouselTruth {
            pockets: self.pockets.clone(),
            spindle: self.spindle,
            at: self.at().map(|at| at as u32 + 1),
            is_in_the_way: !self.is_out(),
            collisions: self.collisions,
            described: self.described.clone(),
            dropped: self.dropped.clone(),
        }
    }
}

/// What moves in a period.
#[derive(Clone, Copy)]
#[allow(clippy::struct_excessive_bools)] // four facts, each on its own
struct Moves {
    swings: bool,
    turns: bool,
    falls: bool,
    spins: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.001;

    fn carousel() -> Carousel {
        let mut carousel = Carousel::new(CarouselModel {
            pockets: vec![1, 2, 3, 0],
            change_z: Length::mm(-100.0),
            clear_z: Length::mm(-5.0),
            outputs: [0, 1, 2, 3, 4],
            inputs: [0, 1, 2, 3, 4, 5, 6],
            swing: Time::s(0.5),
            drawbar: Time::s(0.2),
            pocket: Time::s(0.4),
            delay: Time::ZERO,
            bounce: Time::ZERO,
            seed: 1,
        });
        carousel.z = 0.0;
        carousel
    }

    fn outputs(on: &[u8]) -> Signals {
        let mut outputs = Signals::default();
        for number in on {
            outputs.switch(*number, true);
        }
        outputs
    }

    /// Periods with these outputs, with Z on its way to a place at 100 mm/s.
    fn run(carousel: &mut Carousel, on: &[u8], z: f64, seconds: f64) {
        for _ in 0..(seconds / DT) as usize {
            let by = (z - carousel.z).clamp(-0.1, 0.1);
            let to = carousel.z + by;
            carousel.step(&outputs(on), to, 0.0, DT);
        }
    }

    #[test]
    fn a_tool_is_fetched_and_brought_back() {
        let mut carousel = carousel();
        run(&mut carousel, &[0, 1], 0.0, 1.0); // open, in
        run(&mut carousel, &[0], -100.0, 2.0); // down
        run(&mut carousel, &[], -100.0, 0.5); // clamp
        run(&mut carousel, &[2], -100.0, 1.0); // out
        let truth = carousel.truth();
        assert_eq!((truth.spindle, &truth.pockets[..]), (1, &[0, 2, 3, 0][..]));
        run(&mut carousel, &[1], -100.0, 1.0);
        run(&mut carousel, &[0], -100.0, 0.5);
        run(&mut carousel, &[0], 0.0, 2.0);
        run(&mut carousel, &[2], 0.0, 1.0);
        let truth = carousel.truth();
        assert_eq!((truth.spindle, &truth.pockets[..]), (0, &[1, 2, 3, 0][..]));
        assert_eq!((truth.collisions, truth.dropped.len()), (0, 0), "{:?}", truth.described);
    }

    #[test]
    fn a_motor_turns_it_by_pockets_that_its_sensor_counts() {
        let mut carousel = carousel();
        let (mut edges, mut before) = (0, true);
        for _ in 0..((3.0 * 0.4 + 0.2) / DT) as usize {
            let on = if edges < 3 { &[3][..] } else { &[] };
            carousel.step(&outputs(on), 0.0, 0.0, DT);
            let now = carousel.sensors[4].shown;
            edges += i32::from(now && !before);
            before = now;
        }
        assert_eq!((edges, carousel.truth().at), (3, Some(4)));
    }

    #[test]
    fn what_no_machine_survives_is_counted() {
        let check = |steps: &[(&[u8], f64, f64)], collisions: u32, dropped: &[u32]| {
            let mut carousel = carousel();
            carousel.load(&[1, 2, 3, 0], 0, None);
            for (on, z, seconds) in steps {
                run(&mut carousel, on, *z, *seconds);
            }
            let truth = carousel.truth();
            let found = (truth.collisions, &truth.dropped[..]);
            assert_eq!(found, (collisions, dropped), "{:?}", truth.described);
        };
        let fetch: [(&[u8], f64, f64); 2] = [(&[0, 1], 0.0, 1.0), (&[0], -100.0, 2.0)];
        let held = [fetch[0], fetch[1], (&[], -100.0, 0.5)];
        // Z up with spindle and pocket holding it
        check(&[held[0], held[1], held[2], (&[], 0.0, 1.0)], 1, &[]);
        // down on a tool with the drawbar closed
        check(&[(&[1], 0.0, 1.0), (&[], -100.0, 2.0)], 1, &[]);
        // open with no pocket below
        check(&[held[0], held[1], held[2], (&[2], -100.0, 1.0), (&[0], -100.0, 0.5)], 0, &[1]);
        // a full pocket against a spindle that stands low
        check(&[(&[], -100.0, 2.0), (&[1], -100.0, 1.0)], 1, &[]);
        // turned under a spindle that stands low
        check(&[fetch[0], fetch[1], (&[0, 3], -100.0, 0.3)], 1, &[]);
    }
}
