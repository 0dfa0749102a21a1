//! What in a machine file contradicts each other, beyond one section.
use super::ethercat_check::NetworkDrives;
use super::{Axis, Hal, MachineFile, Spindle};
use crate::keys::Keys;
use units::Coordinate;

impl MachineFile {
    /// What a drive in LinuxCNC's HAL cannot be told.
    pub(super) fn refuse_drives_of_hal(&self, keys: &Keys<'_>) {
        for Spindle { name, own_ramps, closes_position, encoder_index, .. } in &self.spindles {
            if own_ramps.is_none() && !closes_position {
                let text = format!(
                    "the drive of spindle \"{name}\" is told a torque, and HAL's drives take a speed or an angle: expected `kind = \"speed\"` or `kind = \"position\"` under [spindles.drive]"
                );
                keys.conflict("spindles", text);
            }
            if *closes_position && *encoder_index {
                let text = format!(
                    "`encoder_index` of spindle \"{name}\": its drive is told an angle, which counts on from the drive's own zero: expected false"
                );
                keys.conflict("spindles", text);
            }
        }
    }

    /// Drives that say something of themselves are the machine's.
    pub(super) fn refuse_drives_of_nothing(&self, hal: &Hal, keys: &Keys<'_>) {
        use bus::WatchedInput::{AxisForce, AxisReady, SpindleReady, SpindleTorque};
        for (axis, letter) in self.axes.iter().zip(canon::Axis::ALL) {
            let index = letter.index() as u8;
            for (key, input) in [("ready", AxisReady(index)), ("torque", AxisForce(index))] {
                if hal.watched.has(input) && axis.is_none() {
                    let text = format!("`{key}`: the machine has no axis {}", letter.letter());
                    keys.conflict("hal", text);
                }
            }
        }
        let spindles = self.spindles.len();
        for number in (spindles..bus::SPINDLES).map(|number| number as u8) {
            let said = [("ready", SpindleReady(number)), ("torque", SpindleTorque(number))];
            for (key, _) in said.into_iter().filter(|(_, input)| hal.watched.has(*input)) {
                let text =
                    format!("`{key}`: the machine has {spindles} spindle, from spindle.0 on");
                keys.conflict("hal", text);
            }
        }
    }

    /// Errors that a scale sees; where drives are those of HAL or of a network, `position_from`
    /// says what they report, wherever the encoder is.
    pub(super) fn refuse_unseen(&self, keys: &Keys<'_>) {
        if self.hal.is_none() && self.ethercat.is_none() {
            let axes = self.axes.iter().flatten();
            axes.filter_map(Axis::compensates_unseen).for_each(|text| keys.conflict("axes", text));
        }
    }

    /// What drives on a network cannot be.
    pub(super) fn refuse_network(&self, keys: &Keys<'_>) {
        let drives = NetworkDrives {
            network: self.ethercat.as_ref(),
            axes: &self.axes,
            spindles: &self.spindles,
            period: self.control.period,
            has_hal: self.hal.is_some(),
        };
        let key = if self.ethercat.is_some() { "ethercat" } else { "axes" };
        drives.problems().into_iter().for_each(|message| keys.conflict(key, message));
    }

    /// Axes that a sequence moves are there, and the places within their travel.
    pub(super) fn refuse_sequence(&self, keys: &Keys<'_>) {
        let Some(sequence) = &self.tool_change_sequence else { return };
        for step in &sequence.steps {
            for (letter, place) in &step.to {
                let (name, letter_name) = (&step.name, letter.letter());
                let Some(axis) = self.axis(*letter) else {
                    let text = format!(
                        "step \"{name}\" moves {letter_name}, and the machine has no such axis"
                    );
                    keys.conflict("sequences", text);
                    continue;
                };
                if !axis.travel.contains(Coordinate::linear(*place)) {
                    let text = format!(
                        "step \"{name}\" moves {letter_name} to {}: outside its travel from {} to {} mm",
                        place.value(),
                        axis.travel.from.value(),
                        axis.travel.to.value()
                    );
                    keys.conflict("sequences", text);
                }
            }
        }
        if self.own_codes.calls.iter().any(|call| (call.letter, call.number) == ('M', Some(6))) {
            let text = "a tool change is a sequence and, by [user_codes], a program as well: expected one of them";
            keys.conflict("sequences", text);
        }
    }
}
