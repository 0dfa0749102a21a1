//! What `leadscrew machine check` says of taps whose spindle is left to coast: up to which speed
//! they survive that.
//!
//! Drives that brake, together or each along its ramp, stop a tap within its planned braking from
//! every speed ([`plan::overrun`] is of those that coast): of those nothing is said.
use canon::Flute;
use store::machine::MachineFile;
use units::{Lead, Length};

/// Taps that the sentence is about: name, diameter, pitch, mm.
const TAPS: [(&str, f64, f64); 2] = [("M6", 6.0, 1.0), ("M8", 8.0, 1.25)];
/// Room below the tap in a usual hole, mm: what tables of tap makers leave under a blind thread of
/// these sizes.
const ROOM: Length = Length::mm(5.0);

/// One sentence for each event in which the spindle coasts.
pub(crate) fn warnings(file: &MachineFile) -> Vec<String> {
    let limits = control::config::planner(file);
    let coasts = limits.tapping.coasts;
    let Some(spindle) = limits.spindles.first() else { return Vec::new() };
    let material = file.setup.stock.material;
    let survives: Vec<_> = TAPS
        .iter()
        .map(|(name, diameter, pitch)| {
            let drilled = Length::mm(diameter - pitch);
            let kc = material.cutting_force_n_per_mm2;
            let cut = plan::tapping_torque(Length::mm(*diameter), drilled, Flute::SpiralFlute, kc);
            let (lead, most) = (Lead::mm_per_rev(*pitch), spindle.tapping_max);
            let slow = plan::survives(spindle, cut, lead, ROOM, most).in_rpm();
            let deep = plan::overrun(spindle, cut, lead, most).value();
            format!(
                "{name} up to S{slow:.0} (from S{:.0} it goes {deep:.0} mm deeper)",
                most.in_rpm()
            )
        })
        .collect();
    let brakes = if limits.tapping.own_ramps.is_some() {
        "\"coupled-stop\" brakes"
    } else {
        "\"coupled-stop\" and \"quick-stop\" brake"
    };
    [
        (coasts.on_link_loss, "on_link_loss", "the control dies"),
        (coasts.on_power_loss, "on_power_loss", "the mains fail"),
    ]
    .into_iter()
    .filter(|(does, ..)| *does)
    .map(|(_, key, when)| {
        format!(
            "[drives] {key}: if {when} in a tap the spindle coasts and the tap goes on into its hole. In {} with {} mm of hole below it \
             survive {}; {brakes} from every speed",
            material.name(),
            ROOM.value(),
            survives.join(" and ")
        )
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use store::machine;

    fn warnings(drives: &str) -> Vec<String> {
        let text = format!("extends = \"tapping-center\"\nname = \"mine\"\n[drives]\n{drives}\n");
        super::warnings(&machine::parse(&text, 0).unwrap())
    }

    #[test]
    fn a_machine_whose_spindle_coasts_says_up_to_which_speed_a_tap_survives() {
        assert!(warnings("on_link_loss = \"quick-stop\"").is_empty());
        for reaction in ["coast", "off"] {
            let said = warnings(&format!("on_link_loss = \"{reaction}\""));
            assert!(said.len() == 1 && said[0].contains("M6 up to S9"), "{said:?}");
        }
        // the bus pays for braking, unless the outputs go off
        assert!(warnings("on_power_loss = \"coast\"").is_empty());
        assert_eq!(warnings("on_power_loss = \"off\"").len(), 1);
    }
}
