//! A motor's own encoder beside a scale: what the speed loop goes by, and the force of a cut.
use core::f64::consts::TAU;

/// Beside a motor's encoder a scale tells what lasts longer than this, s: a swing of the screw is
/// none of the position loop's.
const LASTS_S: f64 = 0.01;
/// Bandwidth of the cut's force that is fed forward, Hz: at three times this a share of 1.3 of it
/// would swing.
const CUT_HZ: f64 = 100.0;

/// The motor's own encoder beside a scale. Its zero is where the scale's was when the drive came
/// up.
#[derive(Clone, Debug, Default)]
pub(super) struct MotorSide {
    pub(super) offset: f64,
    pub(super) reading: f64,
    /// How much further than by motor and model the tool side is, as far as it lasts.
    pub(super) apart: f64,
    /// How much further than by the model the screw is stretched: the force of the cut.
    pub(super) cut: f64,
    pub(super) error: f64,
}

impl MotorSide {
    /// The following error that the loops go by, and the motor's own.
    pub(super) fn errors(
        &mut self,
        setpoint: f64,
        stretch: f64,
        scale: f64,
        period_s: f64,
    ) -> (f64, f64) {
        let tool_side = self.reading + self.offset - stretch;
        self.apart += (scale - tool_side - self.apart) * (period_s / LASTS_S).min(1.0);
        self.cut += (tool_side - scale - self.cut) * (TAU * CUT_HZ * period_s).min(1.0);
        self.error = setpoint - tool_side;
        (self.error - self.apart, self.error)
    }
}
