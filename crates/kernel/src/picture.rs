//! How a kernel is, as one plain value: what looks at it may be another thread, or another process.
use crate::fault::Fault;
use crate::kernel::{FAULTS, Kernel};
use crate::operator::Operator;
use crate::waiting::Waiting;
use bus::{AXES, Report, SPINDLES};
use motion::WayOut;
use units::{Angle, Axis, Coordinate, Length, Spin};

/// What the methods of these names answer after the last tick.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools)] // independent facts, each asked for by itself
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Picture {
    /// [`Kernel::report`].
    pub report: Report,
    /// [`Kernel::operator`].
    pub operator: Operator,
    /// [`Kernel::steps`].
    pub steps: usize,
    /// [`Kernel::is_over`].
    pub is_over: bool,
    /// [`Kernel::is_off`].
    pub is_off: bool,
    /// [`Kernel::is_ready`].
    pub is_ready: bool,
    /// [`Kernel::is_standing`].
    pub is_standing: bool,
    /// A motion is under way: nothing is handed back meanwhile.
    pub is_flowing: bool,
    /// [`Kernel::is_retreating`].
    pub is_retreating: bool,
    /// [`Kernel::can_back_out`].
    pub can_back_out: bool,
    /// [`Kernel::is_in_thread`].
    pub is_in_thread: bool,
    /// [`Kernel::is_moving_manually`].
    pub is_moving_manually: bool,
    /// [`Kernel::is_moving_on_lease`].
    pub is_moving_on_lease: bool,
    /// [`Kernel::has_faded`].
    pub has_faded: bool,
    /// [`Kernel::consulted`].
    pub consulted: Option<u16>,
    /// [`Kernel::engaged`].
    pub engaged: Option<sync::recovery::Stored>,
    /// [`Kernel::surface`].
    pub surface: Option<Length>,
    /// [`Kernel::way_out`].
    pub way_out: Option<WayOut>,
    /// [`Kernel::waiting`].
    pub waiting: Option<Waiting>,
    /// [`Kernel::setpoint`], by axis.
    pub setpoints: [Option<Coordinate>; AXES],
    /// [`Kernel::tool_side`], by axis.
    pub tool_sides: [Option<Coordinate>; AXES],
    /// [`Kernel::is_homed`], by axis.
    pub is_homed: [bool; AXES],
    /// [`Kernel::zero`], by axis.
    pub zeros: [Coordinate; AXES],
    /// [`Kernel::shift`], by axis.
    pub shifts: [Coordinate; AXES],
    /// [`Kernel::spindle_shift`], by spindle.
    pub spindle_shifts: [Angle; SPINDLES],
    /// It looks for where its encoder counts from ([`Kernel::homing`]), by axis.
    pub is_homing: [bool; AXES],
    /// [`Kernel::ordered_spin`], by spindle.
    pub ordered_spins: [Spin; SPINDLES],
    /// [`Kernel::coolant`].
    pub coolant: [bool; 2],
    /// [`Kernel::faults`], oldest first.
    pub faults: [Option<Fault>; FAULTS],
}

impl Kernel {
    /// How it is.
    pub fn picture(&self) -> Picture {
        let mut is_homing = [false; AXES];
        for (axis, _) in self.homing() {
            is_homing[axis.index()] = true;
        }
        let mut faults = [None; FAULTS];
        for (kept, fault) in faults.iter_mut().zip(self.faults()) {
            *kept = Some(*fault);
        }
        Picture {
            report: self.report(),
            operator: *self.operator(),
            steps: self.steps(),
            is_over: self.is_over(),
            is_off: self.is_off(),
            is_ready: self.is_ready(),
            is_standing: self.is_standing(),
            is_flowing: self.is_flowing(),
            is_retreating: self.is_retreating(),
            can_back_out: self.can_back_out(),
            is_in_thread: self.is_in_thread(),
            is_moving_manually: self.is_moving_manually(),
            is_moving_on_lease: self.is_moving_on_lease(),
            has_faded: self.has_faded(),
            consulted: self.consulted(),
            engaged: self.engaged(),
            surface: self.surface(),
            way_out: self.way_out().copied(),
            waiting: self.waiting(),
            setpoints: Axis::ALL.map(|axis| self.setpoint(axis)),
            tool_sides: Axis::ALL.map(|axis| self.tool_side(axis)),
            is_homed: Axis::ALL.map(|axis| self.is_homed(axis)),
            zeros: Axis::ALL.map(|axis| self.zero(axis)),
            shifts: Axis::ALL.map(|axis| self.shift(axis)),
            spindle_shifts: core::array::from_fn(|spindle| self.spindle_shift(spindle)),
            is_homing,
            ordered_spins: core::array::from_fn(|spindle| self.ordered_spin(spindle)),
            coolant: self.coolant(),
            faults,
        }
    }
}
