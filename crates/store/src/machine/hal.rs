//! How the control leads drives through LinuxCNC's HAL.
use crate::keys::Keys;
use bus::{MDI_KEYS, WatchedInput, WatchedInputs};
use units::Time;

/// With it an answer begins that nobody has given yet.
pub(crate) const UNANSWERED: &str = "unanswered";
/// An answer: the machine is safe without it.
const NOT_NEEDED: &str = "not needed";
/// Before the names of the component's pins.
const COMPONENT: &str = "leadscrew.";

/// `[hal]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Hal {
    /// Name of the component: `loadrt leadscrew name=NAME`.
    pub component: String,
    /// A control that shows no sign of life for so long is gone: the component stops the machine.
    pub silent_after: Time,
    /// Servo periods after which an axis is where its drive was commanded to be.
    pub obeys_after_periods: f64,
    /// Inputs that something must drive: the emergency stop chain unless `estop = "none"`, `ready`
    /// and `torque-fb` of these drives, and pins that are answers of `[hal.safety]`.
    pub watched: WatchedInputs,
    /// Blocks that the panel's keys of blocks execute: `mdi-00` the first.
    pub mdi: Vec<String>,
    /// What stopped the machine in another control, and has no answer yet: in a sentence each.
    pub unanswered: Vec<String>,
}

impl Hal {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let component = keys.optional_text("component").unwrap_or_else(|| "default".into());
        let silent_after = Time::s(keys.number("silent_after_ms", 5.0..=5000.0) * 1e-3);
        let obeys_after_periods = keys.number("obeys_after_periods", 0.0..=20.0);
        let has_chain = keys.optional_choice("estop", &[("wired", true), ("none", false)]);
        let mut watched = WatchedInputs::default();
        if has_chain.unwrap_or(true) {
            watched = watched.with(WatchedInput::EmergencyStop);
        }
        for (key, pin) in [("ready", "ready"), ("torque", "torque-fb")] {
            for name in keys.optional_texts(key) {
                match named(&format!("{name}.{pin}")) {
                    Some(input) => watched = watched.with(input),
                    None => keys.unknown_name(
                        key,
                        format!("`{key}`: found `{name}`, expected letters of axes, or spindle.0"),
                    ),
                }
            }
        }
        let answers = keys.optional_section("safety", answers).unwrap_or_default();
        let mut unanswered = Vec::new();
        for answer in answers {
            match answer {
                SafetyAnswer::Wired(input) => watched = watched.with(input),
                SafetyAnswer::NotNeeded => {}
                SafetyAnswer::None(why) => unanswered.push(why),
            }
        }
        let mdi = keys.optional_texts("mdi");
        if mdi.len() > MDI_KEYS {
            let found = mdi.len();
            let sentence = format!("`mdi`: found {found} keys, expected at most {MDI_KEYS}");
            keys.unknown_name("mdi", sentence);
        }
        Self { component, silent_after, obeys_after_periods, watched, mdi, unanswered }
    }
}

/// What a person has said of something that stopped the machine.
enum SafetyAnswer {
    Wired(WatchedInput),
    NotNeeded,
    None(String),
}

/// `[hal.safety]`.
fn answers(keys: &mut Keys<'_>) -> Vec<SafetyAnswer> {
    let stated = keys.texts(|pin| Some(pin.to_owned()));
    let answered = |(pin, answer): (String, String)| match answer.strip_prefix(COMPONENT) {
        _ if answer == NOT_NEEDED => SafetyAnswer::NotNeeded,
        Some(ours) if let Some(input) = named(ours) => SafetyAnswer::Wired(input),
        _ if answer.starts_with(UNANSWERED) => SafetyAnswer::None(format!("{pin} is {answer}")),
        _ => {
            let expected = format!(
                "`{pin}`: found `{answer}`, expected \"{NOT_NEEDED}\", or the pin that does it: {}",
                guards()
            );
            keys.unknown_name(&pin, expected);
            SafetyAnswer::NotNeeded
        }
    };
    stated.into_iter().map(answered).collect()
}

fn named(name: &str) -> Option<WatchedInput> {
    WatchedInput::all().find(|input| input.to_string() == name)
}

/// Pins that stop something.
fn guards() -> String {
    let is_of_drive = |input: &WatchedInput| {
        matches!(
            input,
            WatchedInput::AxisReady(_)
                | WatchedInput::SpindleReady(_)
                | WatchedInput::AxisForce(_)
                | WatchedInput::SpindleTorque(_)
        )
    };
    let names = WatchedInput::all().filter(|input| !is_of_drive(input));
    names.map(|input| format!("{COMPONENT}{input}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::machine::parse;
    use bus::WatchedInput;

    /// A machine in HAL whose spindle has such a drive.
    fn with(drive: &str) -> Result<crate::machine::MachineFile, String> {
        let hal = "[hal]\nsilent_after_ms = 500\nobeys_after_periods = 1\n";
        let text =
            format!("extends = \"tapping-center\"\nname = \"x\"\n{hal}[[spindles]]\n{drive}");
        parse(&text, 0).map_err(|found| format!("{found:?}"))
    }

    /// A machine with this in its section.
    fn hal(section: &str) -> Result<crate::machine::Hal, String> {
        let text = format!(
            "extends = \"vfd-mill\"\nname = \"x\"\n[hal]\nsilent_after_ms = 500\nobeys_after_periods = 1\n{section}"
        );
        let file = parse(&text, 0).map_err(|found| format!("{found:?}"))?;
        Ok(file.hal.unwrap())
    }

    #[test]
    fn the_emergency_stop_is_wired_unless_the_file_says_that_there_is_none() {
        let chain = |section| hal(section).unwrap().watched.has(WatchedInput::EmergencyStop);
        assert!(chain("") && chain("estop = \"wired\"\n") && !chain("estop = \"none\"\n"));
        assert!(hal("estop = \"no\"\n").unwrap_err().contains("S0407"));
    }

    #[test]
    fn drives_that_say_that_they_are_ready_are_those_of_the_machine() {
        let watched = hal("ready = [\"x\", \"spindle.0\"]\n").unwrap().watched;
        let has = [WatchedInput::AxisReady(0), WatchedInput::SpindleReady(0)];
        assert!(has.iter().all(|input| watched.has(*input)));
        assert!(!watched.has(WatchedInput::AxisReady(2)));
        for (list, why) in [("q", "found `q`"), ("w", "has no axis W"), ("spindle.1", "1 spindle")]
        {
            let found = hal(&format!("ready = [\"{list}\"]\n")).unwrap_err();
            assert!(found.contains(why), "{found}");
        }
    }

    #[test]
    fn what_stopped_the_machine_has_an_answer_or_is_said() {
        let safety =
            |answer: &str| hal(&format!("[hal.safety]\n\"motion.enable\" = \"{answer}\"\n"));
        assert_eq!(
            safety("unanswered: mill.hal:31").unwrap().unanswered,
            ["motion.enable is unanswered: mill.hal:31"]
        );
        assert!(safety("not needed").unwrap().unanswered.is_empty());
        let wired = safety("leadscrew.feed-inhibit").unwrap();
        assert!(wired.unanswered.is_empty() && wired.watched.has(WatchedInput::FeedInhibit));
        for wrong in ["", "yes", "leadscrew.inhibit"] {
            let why = safety(wrong).unwrap_err();
            assert!(why.contains("S0407") && why.contains("leadscrew.estop-ok"), "{why}");
        }
    }

    #[test]
    fn a_drive_in_hal_takes_a_speed_or_an_angle() {
        let told_an_angle = with("[spindles.drive]\nkind = \"position\"\n").unwrap();
        assert!(told_an_angle.spindles[0].closes_position);
        assert!(told_an_angle.spindles[0].own_ramps.is_none());
        for drive in ["", "[spindles.drive]\nkind = \"torque\"\n"] {
            let why = with(drive).unwrap_err();
            assert!(why.contains("S0406") && why.contains("or `kind = "), "{why}");
        }
        let why =
            with("encoder_index = true\n[spindles.drive]\nkind = \"position\"\n").unwrap_err();
        assert!(why.contains("S0406") && why.contains("expected false"), "{why}");
    }
}
