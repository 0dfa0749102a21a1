//! A wire in process and in virtual time, with a machine behind it that is watched.
use esc::{DriveState, Passed};
use ethercat::FrameLink;
use leadscrew::ethercat::EmulatedMachine;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// From a frame that is back to where the master can read it, ns.
const READ_NS: u64 = 5_000;

/// Place of Z at which the tap of these tests is four millimetres deep.
const DEEP_MM: f64 = -198.75;

/// A period of the machine: setpoints as its drives took them, and where it really was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moment {
    pub(crate) enabled: bool,
    pub(crate) z_setpoint: f64,
    pub(crate) turn_setpoint: f64,
    pub(crate) z: f64,
    pub(crate) turn: f64,
}

/// What a test and the thread of the wire share.
#[derive(Default)]
pub(crate) struct Shared {
    pub(crate) z_mm: AtomicU64,
    pub(crate) now_ns: AtomicU64,
    /// When a drive was enabled last, ns.
    pub(crate) led_ns: AtomicU64,
    pub(crate) frames: AtomicU64,
    pub(crate) in_op: AtomicUsize,
    pub(crate) stop: AtomicBool,
    pub(crate) vanishes: AtomicBool,
    /// So many of the next frames do not get back; of these, so many do not get there.
    pub(crate) lose: AtomicUsize,
    pub(crate) lose_before: AtomicUsize,
    /// A device whose power is off; 0: none.
    pub(crate) without_power: AtomicUsize,
    /// A drive that finds a fault in the next period; 0: none.
    pub(crate) fails: AtomicUsize,
    /// So many frames are lost in the next tap, on the way to the devices or back.
    pub(crate) lose_in_tap: AtomicUsize,
    pub(crate) loses_before: AtomicBool,
    pub(crate) moments: Mutex<Vec<Moment>>,
    pub(crate) records: AtomicBool,
    pub(crate) outputs: AtomicU64,
}

/// The wire.
pub(crate) struct Wire {
    pub(crate) emulated: EmulatedMachine,
    pub(crate) shared: Arc<Shared>,
    now_ns: u64,
    back: VecDeque<(u64, usize, [u8; 1514])>,
    powered_off: usize,
    before: (f64, f64),
}

impl Wire {
    pub(crate) fn new(emulated: EmulatedMachine, shared: Arc<Shared>) -> Self {
        let back = VecDeque::with_capacity(64);
        Self { emulated, shared, now_ns: 1_000_000, back, powered_off: 0, before: (0.0, 0.0) }
    }

    /// A period of the master is over: the test's thread comes to its turn.
    pub(crate) fn breathe() {
        std::thread::sleep(Duration::from_micros(20));
    }

    fn handle(&mut self) {
        let Shared { without_power, fails, .. } = &*self.shared;
        let off = without_power.load(Relaxed);
        if off != self.powered_off {
            let (is_on, device) = if off == 0 { (true, self.powered_off) } else { (false, off) };
            self.emulated.segment_mut().power(device, is_on, self.now_ns);
            self.powered_off = off;
        }
        let failing = fails.swap(0, Relaxed);
        if failing > 0
            && let Some(device) = self.emulated.segment_mut().device_mut(failing)
        {
            device.fail(0, 0x2310);
        }
    }

    /// Loses frames once the tap goes in at more than 40 mm/s, some millimetres deep.
    fn lose_in_tap(&mut self) {
        let frames = self.shared.lose_in_tap.load(Relaxed);
        let command = self.emulated.command();
        let (z, turn) = (command.axes[2].position.value(), command.spindles[0].angle.value());
        let (dz, turned) = (z - self.before.0, turn - self.before.1);
        self.before = (z, turn);
        let depth = self.emulated.truth().axes[2].value();
        if frames > 0 && depth < DEEP_MM && dz < -0.01 && (dz + turned).abs() < 1e-5 {
            let Shared { lose, lose_before, loses_before, .. } = &*self.shared;
            let lost = if loses_before.load(Relaxed) { lose_before } else { lose };
            lost.store(frames, Relaxed);
            self.shared.lose_in_tap.store(0, Relaxed);
        }
    }

    fn watch(&mut self) {
        let shared = &self.shared;
        let truth = self.emulated.truth();
        let segment = self.emulated.segment();
        let devices = || (0..segment.len()).filter_map(|at| segment.device(at));
        let is_led = devices().any(|d| d.drive_state(0) == Some(DriveState::OperationEnabled));
        let z = truth.axes[2].value();
        shared.z_mm.store(z.to_bits(), Relaxed);
        shared.now_ns.store(self.now_ns, Relaxed);
        shared.in_op.store(devices().filter(|d| d.state() == esc::AlState::Op).count(), Relaxed);
        let outputs = segment.device(5).map_or(0, esc::Device::digital_outputs);
        shared.outputs.store(u64::from(outputs), Relaxed);
        self.lose_in_tap();
        let shared = &self.shared;
        if is_led {
            shared.led_ns.store(self.now_ns, Relaxed);
        }
        if shared.records.load(Relaxed) {
            let command = self.emulated.command();
            let moment = Moment {
                enabled: command.axes[2].enable,
                z_setpoint: command.axes[2].position.value(),
                turn_setpoint: command.spindles[0].angle.value(),
                z,
                turn: truth.spindles[0].value(),
            };
            shared.moments.lock().unwrap().push(moment);
        }
    }
}

fn take_one(count: &AtomicUsize) -> bool {
    count.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_ok()
}

impl FrameLink for Wire {
    fn now_ns(&mut self) -> u64 {
        self.now_ns
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let mut buffer = [0; 1514];
        buffer[..frame.len()].copy_from_slice(frame);
        self.handle();
        self.shared.frames.fetch_add(1, Relaxed);
        if take_one(&self.shared.lose_before) {
            return true;
        }
        let passed = self.emulated.pass(&mut buffer[..frame.len()], self.now_ns);
        self.watch();
        if let Passed::Back(after) = passed
            && !take_one(&self.shared.lose)
            && self.back.len() < 64
        {
            self.back.push_back((self.now_ns + after + READ_NS, frame.len(), buffer));
        }
        true
    }

    fn receive(&mut self, into: &mut [u8]) -> Option<usize> {
        let at = self.back.iter().position(|(due, ..)| *due <= self.now_ns)?;
        let (_, length, bytes) = self.back.remove(at)?;
        into[..length].copy_from_slice(&bytes[..length]);
        Some(length)
    }

    fn wait(&mut self, until_ns: u64) {
        if self.shared.vanishes.load(Relaxed) {
            std::panic::resume_unwind(Box::new("the process is gone"));
        }
        let next = self.back.iter().map(|(due, ..)| *due).min();
        let to = next.map_or(until_ns, |due| due.min(until_ns));
        self.now_ns = to.max(self.now_ns);
        self.emulated.advance(self.now_ns);
    }
}
