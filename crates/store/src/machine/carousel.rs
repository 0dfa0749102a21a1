//! `[simulation.carousel]`: the hardware of a carousel without an arm, as the simulator has it.
use super::sequence::{NamedSignals, named};
use crate::keys::Keys;
use units::{Length, Time};

/// The hardware of a carousel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarouselModel {
    /// Machine coordinate of Z at which spindle and pocket hold the same tool.
    pub change_z: Length,
    /// Machine coordinate of Z above which an empty spindle is clear of the carousel.
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
}

impl CarouselModel {
    pub(super) fn read(keys: &mut Keys<'_>, signals: NamedSignals<'_>) -> Self {
        let output = |keys: &mut Keys<'_>, key| {
            named(keys, key, &signals.outputs.digital, "output").unwrap_or(0)
        };
        let input = |keys: &mut Keys<'_>, key| {
            named(keys, key, &signals.inputs.digital, "input").unwrap_or(0)
        };
        let time = |keys: &mut Keys<'_>, key, least| Time::s(keys.number(key, least..=60.0));
        Self {
            change_z: Length::mm(keys.number("change_z_mm", -10_000.0..=10_000.0)),
            clear_z: Length::mm(keys.number("clear_z_mm", -10_000.0..=10_000.0)),
            outputs: [
                output(keys, "drawbar"),
                output(keys, "swing_in"),
                output(keys, "swing_out"),
                output(keys, "forward"),
                output(keys, "backward"),
            ],
            inputs: [
                input(keys, "drawbar_open"),
                input(keys, "tool_in_taper"),
                input(keys, "is_in"),
                input(keys, "is_out"),
                input(keys, "pocket"),
                input(keys, "pocket_1"),
                input(keys, "drawbar_closed"),
            ],
            swing: time(keys, "swing_s", 0.01),
            drawbar: time(keys, "drawbar_s", 0.01),
            pocket: time(keys, "pocket_s", 0.05),
            delay: time(keys, "sensor_delay_s", 0.0),
            bounce: time(keys, "sensor_bounce_s", 0.0),
        }
    }
}
