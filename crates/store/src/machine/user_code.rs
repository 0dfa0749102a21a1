//! `[user_codes]`: codes of the machine's own, and what each does.
//!
//! ```text
//!   M31 = "chip conveyor on"                   a name: nothing that this control would move
//!   M24 = "blow air: output 3 on"              a digital output is switched at once
//!   M10 = "clamp the fourth axis: wait 0.5 s"  the program waits
//!   M60 = "change the pallet: call O9020"      a macro, with the block's other words as its arguments (Fanuc)
//!   G101 = "probe a bore: call O9010"          likewise
//!   M6 = "change the tool: subprogram O9001"   a program as M98 calls it, after the block's other words
//!   T = "fetch the tool: subprogram O9000"     likewise; #149 is the number of T
//! ```
use crate::keys::Keys;
use units::Time;

/// Highest number of an output.
const LAST_OUTPUT: u8 = 63;
/// Longest wait, seconds.
const LONGEST_S: f64 = 3600.0;

/// An entry of `[user_codes]`: an M code of the machine's own.
#[derive(Clone, Debug, PartialEq)]
pub struct CodeEntry {
    /// The number after M.
    pub number: u16,
    /// What it does, for people.
    pub name: String,
    /// What it does, for the machine.
    pub action: CodeEntryAction,
}

/// An entry of `[user_codes]`: a word that calls a program (Fanuc and its variants).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CallEntry {
    /// `G`, `M` or `T`.
    pub letter: char,
    /// The number after G or M; none for T.
    pub number: Option<u16>,
    /// O of the program.
    pub program: u32,
    /// The block's other words are its arguments.
    pub takes_arguments: bool,
}

/// `[user_codes]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnCodes {
    /// M codes, with their names.
    pub codes: Vec<CodeEntry>,
    /// Words that call programs.
    pub calls: Vec<CallEntry>,
}

/// What an M code of the machine's own moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CodeEntryAction {
    /// Nothing that the control would know of.
    None,
    /// It switches a digital output: number, on.
    Output(u8, bool),
    /// The program waits so long.
    Wait(Time),
}

/// What stands behind a name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Action(CodeEntryAction),
    Call { program: u32, takes_arguments: bool },
}

impl OwnCodes {
    /// All of a machine's file.
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let mut all = Self::default();
        for ((letter, number), text) in keys.texts(word) {
            let (name, order) = match text.rsplit_once(": ") {
                Some((name, order)) if is_order(order) => (name, read(order)),
                _ => (text.as_str(), Some(Order::Action(CodeEntryAction::None))),
            };
            let fits = order.filter(|order| match order {
                Order::Action(_) => letter == 'M' && number != Some(6),
                Order::Call { takes_arguments, .. } => match letter {
                    'G' => *takes_arguments,
                    'T' => !*takes_arguments,
                    _ => true,
                },
            });
            let key = number.map_or("T".to_owned(), |number| format!("{letter}{number}"));
            let Some(order) = fits else {
                let text =
                    format!("expected {key} to {}, found \"{text}\"", expected(letter, number));
                keys.unknown_name(&key, text);
                continue;
            };
            let (name, action) = (
                name.trim().to_owned(),
                match order {
                    Order::Action(action) => action,
                    Order::Call { program, takes_arguments } => {
                        all.calls.push(CallEntry { letter, number, program, takes_arguments });
                        CodeEntryAction::None // the plain word, in the program that it calls
                    }
                },
            );
            if let Some(number) = number.filter(|number| letter == 'M' && *number != 6) {
                all.codes.push(CodeEntry { number, name, action });
            }
        }
        all
    }
}

/// What such a key can order.
fn expected(letter: char, number: Option<u16>) -> String {
    match (letter, number) {
        ('G', _) => "end in \": call O9010\"".to_owned(),
        ('T', _) => "end in \": subprogram O9000\"".to_owned(),
        (_, Some(6)) => "end in \": call O9020\" or \": subprogram O9001\"".to_owned(),
        _ => format!(
            "end in \"output N on\" or \"output N off\" with N up to {LAST_OUTPUT}, in \"wait N s\" with N up to \
             {LONGEST_S}, in \"call O9020\" or in \"subprogram O9001\""
        ),
    }
}

/// `M101`, `G101`, `T`: a word whose meaning is not the same on all controls, and M6.
fn word(key: &str) -> Option<(char, Option<u16>)> {
    if key == "T" {
        return Some(('T', None));
    }
    let letter = key.chars().next().filter(|letter| matches!(letter, 'M' | 'G'))?;
    let number: u16 = key.strip_prefix(letter)?.parse().ok()?;
    let is_shared = match letter {
        'M' => matches!(number, 0..=5 | 7..=9 | 19 | 29 | 30 | 98 | 99),
        _ => matches!(number, 0..=3 | 65..=67),
    };
    let is_plain = key.len() == 1 + number.to_string().len();
    (!is_shared && number < 1000 && is_plain).then_some((letter, Some(number)))
}

/// Whether a text is meant to be an order.
fn is_order(order: &str) -> bool {
    let first = order.split_whitespace().next();
    matches!(first, Some("output" | "wait" | "call" | "subprogram"))
}

fn read(order: &str) -> Option<Order> {
    let words: Vec<_> = order.split_whitespace().collect();
    let program = |text: &str| {
        let number: u32 = text.strip_prefix('O')?.parse().ok()?;
        (1..=99_999_999).contains(&number).then_some(number)
    };
    Some(match words[..] {
        ["output", number, state @ ("on" | "off")] => {
            let number = number.parse().ok().filter(|number| *number <= LAST_OUTPUT)?;
            Order::Action(CodeEntryAction::Output(number, state == "on"))
        }
        ["wait", seconds, "s"] => {
            let seconds: f64 = seconds.parse().ok()?;
            let is_short = (0.0..=LONGEST_S).contains(&seconds);
            Order::Action(is_short.then(|| CodeEntryAction::Wait(Time::s(seconds)))?)
        }
        ["call", name] => Order::Call { program: program(name)?, takes_arguments: true },
        ["subprogram", name] => Order::Call { program: program(name)?, takes_arguments: false },
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_stands_behind_the_name() {
        let action = |text| match read(text) {
            Some(Order::Action(action)) => Some(action),
            _ => None,
        };
        assert_eq!(action("output 3 on"), Some(CodeEntryAction::Output(3, true)));
        assert_eq!(action("wait 0.5 s"), Some(CodeEntryAction::Wait(Time::s(0.5))));
        assert_eq!(action("output 64 on"), None);
        assert_eq!(action("wait -1 s"), None);
        assert_eq!(action("wait NaN s"), None);
        let call = Order::Call { program: 9020, takes_arguments: true };
        assert_eq!(
            (read("call O9020"), read("call 9020"), read("call O0")),
            (Some(call), None, None)
        );
    }

    #[test]
    fn what_every_control_knows_is_not_the_machines_own() {
        let m = |number| Some(('M', Some(number)));
        assert_eq!(
            ["M3", "M30", "M031", "M31", "M165", "M10000", "M6"].map(word),
            [None, None, None, m(31), m(165), None, m(6)]
        );
        assert_eq!(
            ["G1", "G65", "G101", "T", "T5"].map(word),
            [None, None, Some(('G', Some(101))), Some(('T', None)), None]
        );
    }
}
