//! `[user_codes]`: M codes of the machine's own, and what each does.
//!
//! ```text
//!   M31 = "chip conveyor on"                   a name: nothing that this control would move
//!   M24 = "blow air: output 3 on"              a digital output is switched at once
//!   M10 = "clamp the fourth axis: wait 0.5 s"  the program waits
//! ```
use crate::keys::Keys;
use units::Time;

/// Highest number of an output.
const LAST_OUTPUT: u8 = 63;
/// Longest wait, seconds.
const LONGEST_S: f64 = 3600.0;

/// An M code of the machine's own.
#[derive(Clone, Debug, PartialEq)]
pub struct UserCode {
    /// The number after M.
    pub number: u16,
    /// What it does, for people.
    pub name: String,
    /// What it does, for the machine.
    pub action: UserAction,
}

/// What an M code of the machine's own moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UserAction {
    /// Nothing that the control would know of.
    None,
    /// It switches a digital output: number, on.
    Output(u8, bool),
    /// The program waits so long.
    Wait(Time),
}

impl UserCode {
    /// All of a machine's file.
    pub(super) fn read(keys: &mut Keys<'_>) -> Vec<Self> {
        let texts = keys.texts(number);
        let read = |(number, text): (u16, String)| {
            let (name, action) = match text.rsplit_once(": ") {
                Some((name, order)) if is_order(order) => (name, action(order)),
                _ => (text.as_str(), Some(UserAction::None)),
            };
            if action.is_none() {
                let text = format!(
                    "expected M{number} to end in \"output N on\" or \"output N off\" with N up to {LAST_OUTPUT}, or \
                     in \"wait N s\" with N up to {LONGEST_S}, found \"{text}\""
                );
                keys.unknown_name(&format!("M{number}"), text);
            }
            let name = name.trim().to_owned();
            Some(Self { number, name, action: action? })
        };
        texts.into_iter().filter_map(read).collect()
    }
}

/// `M101`: any number whose meaning is not the same on all controls.
fn number(key: &str) -> Option<u16> {
    let number = key.strip_prefix('M')?.parse().ok()?;
    let is_shared = matches!(number, 0..=9 | 19 | 29 | 30 | 98 | 99);
    (!is_shared && number < 1000 && !key.starts_with("M0")).then_some(number)
}

/// Whether a text is meant to be an order.
fn is_order(text: &str) -> bool {
    let word = text.split_whitespace().next();
    matches!(word, Some("output" | "wait"))
}

fn action(order: &str) -> Option<UserAction> {
    let words: Vec<_> = order.split_whitespace().collect();
    match words[..] {
        ["output", number, state @ ("on" | "off")] => {
            let number = number.parse().ok().filter(|number| *number <= LAST_OUTPUT)?;
            Some(UserAction::Output(number, state == "on"))
        }
        ["wait", seconds, "s"] => {
            let seconds: f64 = seconds.parse().ok()?;
            (0.0..=LONGEST_S).contains(&seconds).then(|| UserAction::Wait(Time::s(seconds)))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_stands_behind_the_name() {
        assert_eq!(action("output 3 on"), Some(UserAction::Output(3, true)));
        assert_eq!(action("wait 0.5 s"), Some(UserAction::Wait(Time::s(0.5))));
        assert_eq!(action("output 64 on"), None);
        assert_eq!(action("wait -1 s"), None);
        assert_eq!(action("wait NaN s"), None);
    }

    #[test]
    fn what_every_control_knows_is_not_the_machines_own() {
        assert_eq!(
            ["M3", "M30", "M031", "M31", "M165", "M10000"].map(number),
            [None, None, None, Some(31), Some(165), None]
        );
    }
}
