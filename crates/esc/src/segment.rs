//! A segment of the network: devices one behind the other, and the frames that pass them.
//!
//! ```text
//!   master ──hop──► device 0 ──hop──► device 1 ── … ──► last powered device
//!   master ◄────────────────────────────────────────────┘  the ports behind it are closed
//! ```
use crate::controller::PassingTime;
use crate::device::Device;
use crate::frame::{SOURCE, datagrams, has_ethercat_type};

/// From one device to the next, processing and cable, ns.
const HOP_NS: u64 = 600;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passed {
    /// It came back; its time on the wire, ns.
    Back(u64),
    /// No device is there: nothing comes back.
    Nowhere,
}

/// Devices on a wire.
#[derive(Clone, Debug, Default)]
pub struct NetworkSegment {
    devices: Vec<(Device, bool)>,
}

impl NetworkSegment {
    /// Makes a segment of devices in the order of the wire, all of them powered.
    pub fn new(devices: impl IntoIterator<Item = Device>) -> Self {
        Self { devices: devices.into_iter().map(|device| (device, true)).collect() }
    }

    /// Devices, whether they can be reached or not.
    pub fn len(&self) -> usize {
        self.devices.len()
    }

    /// There is no device.
    pub fn is_empty(&self) -> bool {
        self.devices.is_empty()
    }

    /// A device.
    pub fn device(&self, at: usize) -> Option<&Device> {
        self.devices.get(at).map(|(device, _)| device)
    }

    /// A device has power.
    pub fn is_on(&self, at: usize) -> bool {
        self.devices.get(at).is_some_and(|(_, power)| *power)
    }

    /// A device, to be handled.
    pub fn device_mut(&mut self, at: usize) -> Option<&mut Device> {
        self.devices.get_mut(at).map(|(device, _)| device)
    }

    /// Turns a device off or on. Off, it closes the way to all devices behind it.
    pub fn power(&mut self, at: usize, is_on: bool, now_ns: u64) {
        if let Some((device, power)) = self.devices.get_mut(at) {
            if is_on && !*power {
                device.power_cycle(now_ns);
            }
            *power = is_on;
        }
    }

    /// Turns all devices off and on again.
    pub fn power_cycle(&mut self, now_ns: u64) {
        for (device, power) in &mut self.devices {
            device.power_cycle(now_ns);
            *power = true;
        }
    }

    /// Lets time pass without a frame, up to a time that never goes back.
    pub fn advance(&mut self, now_ns: u64) {
        for (device, _) in self.devices.iter_mut().filter(|(_, power)| *power) {
            device.advance(now_ns);
        }
    }

    /// Sends a frame through the devices at a time that never goes back; it comes back changed.
    /// A frame of another protocol comes back as it was.
    pub fn pass(&mut self, frame: &mut [u8], now_ns: u64) -> Passed {
        let reached = self.devices.iter().take_while(|(_, power)| *power).count();
        let devices = self.devices.iter_mut().take(reached);
        if reached == 0 {
            return Passed::Nowhere;
        }
        let back = 2 * HOP_NS * reached as u64;
        let is_ethercat = has_ethercat_type(frame);
        for (i, (device, _)) in devices.enumerate() {
            let arrives_ns = now_ns + HOP_NS * (i as u64 + 1);
            device.advance(arrives_ns);
            if !is_ethercat {
                continue;
            }
            if i == 0 && !device.keeps_source_address() {
                frame[SOURCE] |= 0x02;
            }
            let is_last = i + 1 == reached;
            let returns_ns = (!is_last).then_some(now_ns + back - HOP_NS * (i as u64 + 1));
            device.set_ports(!is_last);
            let moment = PassingTime { arrives_ns, returns_ns };
            datagrams(frame, |mut datagram| device.execute(&mut datagram, moment));
            device.serve(arrives_ns);
        }
        Passed::Back(back)
    }
}
