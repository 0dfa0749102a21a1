//! A wire in process: frames pass an emulated segment, and time is a number.
use esc::{DriveModel, NetworkSegment, Passed, Quirks, coupler, digital_io, drive};
use ethercat::cia402::Wanted;
use ethercat::{Bus, Device, DriveCommand, FrameLink, Network};
use std::collections::VecDeque;

/// Frames that are under way at most.
const MOST_FRAMES: usize = 64;

/// What happens to a frame that comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    Comes,
    IsLost,
    ComesLate(u64),
    ComesTwice,
    /// So many bytes after the Ethernet header have other values.
    IsChanged(u64),
}

/// What is done to a segment before a frame: its number, the segment, the time.
type Before = Box<dyn FnMut(u64, &mut NetworkSegment, u64)>;

/// A segment behind a wire.
pub(crate) struct Wire<F> {
    pub(crate) segment: NetworkSegment,
    pub(crate) now_ns: u64,
    pub(crate) frames: u64,
    pub(crate) fate: F,
    /// Called before each frame with its number and the segment.
    pub(crate) before: Option<Before>,
    back: VecDeque<(u64, usize, [u8; 1514])>,
}

impl Wire<fn(u64) -> Fate> {
    pub(crate) fn new(segment: NetworkSegment) -> Self {
        Self::with_fate(segment, |_| Fate::Comes)
    }
}

impl<F: FnMut(u64) -> Fate> Wire<F> {
    pub(crate) fn with_fate(segment: NetworkSegment, fate: F) -> Self {
        let back = VecDeque::with_capacity(2 * MOST_FRAMES);
        Self { segment, now_ns: 1_000_000, frames: 0, fate, before: None, back }
    }

    pub(crate) fn inject(&mut self, frame: &[u8]) {
        let mut buffer = [0; 1514];
        buffer[..frame.len()].copy_from_slice(frame);
        self.back.push_back((self.now_ns, frame.len(), buffer));
    }
}

impl<F: FnMut(u64) -> Fate> FrameLink for Wire<F> {
    fn now_ns(&mut self) -> u64 {
        self.now_ns
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let mut buffer = [0; 1514];
        buffer[..frame.len()].copy_from_slice(frame);
        if let Some(before) = &mut self.before {
            before(self.frames, &mut self.segment, self.now_ns);
        }
        let passed = self.segment.pass(&mut buffer[..frame.len()], self.now_ns);
        let fate = (self.fate)(self.frames);
        self.frames += 1;
        let Passed::Back(after) = passed else { return true };
        let due = self.now_ns + after + 5_000;
        let due = match fate {
            Fate::IsLost => return true,
            Fate::ComesLate(by) => due + by,
            Fate::Comes | Fate::ComesTwice | Fate::IsChanged(_) => due,
        };
        if let Fate::IsChanged(bytes) = fate {
            let mut random = Random(self.frames);
            for _ in 0..bytes {
                let at = 14 + random.below(frame.len() as u64 - 14) as usize;
                buffer[at] = random.next() as u8;
            }
        }
        let copies = if fate == Fate::ComesTwice { 2 } else { 1 };
        for _ in 0..copies {
            if self.back.len() < MOST_FRAMES {
                self.back.push_back((due, frame.len(), buffer));
            }
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
        let next = self.back.iter().map(|(due, ..)| *due).min();
        let to = next.map_or(until_ns, |due| due.min(until_ns));
        self.now_ns = to.max(self.now_ns);
    }
}

/// Counts that a drive may go in a cycle of a millisecond.
pub(crate) const MOST_STEP: u32 = 6_000;

/// A coupler, six drives whose clocks differ, and a terminal with digital inputs and outputs.
pub(crate) fn six_drives(quirks: &Quirks) -> NetworkSegment {
    let drives = (0..6).map(|i| {
        let drift_ppb = 15_000 * (i64::from(i) - 3);
        drive(&DriveModel { drift_ppb, quirks: quirks.clone(), ..DriveModel::new(i + 1) })
    });
    NetworkSegment::new([coupler(20_000)].into_iter().chain(drives).chain([digital_io()]))
}

/// What is expected of [`six_drives`].
pub(crate) fn six_drives_expected() -> Network {
    let drives = ["X", "Y", "Z", "A", "B", "C"].map(|name| Device::csp(name, MOST_STEP));
    let devices = [Device::plain("coupler")].into_iter().chain(drives);
    Network::new(devices.chain([Device::plain("I/O")]).collect())
}

/// A coupler, two drives and the terminal: the smallest network that has one of each.
pub(crate) fn two_drives(quirks: &Quirks) -> NetworkSegment {
    let drives = [40_000, -70_000].into_iter().zip(1..).map(|(drift_ppb, serial)| {
        drive(&DriveModel { drift_ppb, quirks: quirks.clone(), ..DriveModel::new(serial) })
    });
    NetworkSegment::new([coupler(20_000)].into_iter().chain(drives).chain([digital_io()]))
}

/// What is expected of [`two_drives`].
pub(crate) fn two_drives_expected() -> Network {
    let devices = ["X", "Z"].map(|name| Device::csp(name, MOST_STEP));
    let devices = [Device::plain("coupler")].into_iter().chain(devices);
    let mut network = Network::new(devices.chain([Device::plain("I/O")]).collect());
    network.clock_frames = 200;
    network
}

/// Enables all drives; panics if that takes more than a hundred cycles.
pub(crate) fn enable<F: FnMut(u64) -> Fate>(bus: &mut Bus<'_, '_>, wire: &mut Wire<F>) {
    for _ in 0..100 {
        for axis in 0..bus.drives().len() {
            let target = bus.drives()[axis].sent_target();
            bus.command(axis, DriveCommand { wanted: Wanted::On, target });
        }
        bus.cycle(wire);
        if bus.drives().iter().all(|drive| drive.feedback().is_enabled()) {
            return;
        }
    }
    panic!(
        "not enabled: {:?}",
        bus.drives().iter().map(|d| d.feedback().status).collect::<Vec<_>>()
    );
}

/// A random number from a seed: splitmix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    pub(crate) fn below(&mut self, most: u64) -> u64 {
        self.next() % most
    }
}
