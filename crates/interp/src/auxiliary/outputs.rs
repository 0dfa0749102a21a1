//! Outputs, inputs and the machine's own codes: M62 … M68, M100 … M199.
//!
//! ```text
//!   M62 M63 P     a digital output on, off: when the next move begins     M64 M65 P     at once
//!   M67 E Q       an analogue output at Q: when the next move begins      M68 E Q       at once
//!   M66 P L Q     wait Q seconds at most for a digital input: L1 rise, L2 fall, L3 on, L4 off; L0 only read it
//!   M66 E         read an analogue input
//!   M100 … M199   what the machine's file says they do, with P and Q
//! ```
//!
//! `#5399` is what M66 has read, −1 if the wait ran out of its time. While a program is run
//! [`Live`](crate::Live) is told. In a check, where there is no machine, a rule stands for
//! it: **what is waited for comes at once**, so `#5399` is 1 after L1 and L3; inputs that are only
//! read are 0.
//!
//! Source: LinuxCNC 2.9 manual, "M62 - M65", "M66", "M67", "M68", "M100 - M199".
use crate::{
    call::{Call, Sink, out::Out},
    codes::MGroup,
    dialect::rules::FrontEndKind,
    fault::{Outcome, error, refuse},
    setup::CodeAction,
    state::executor::{Executor, Settings},
    words::{Words, names::Store},
};
use canon::{Await, InputWait, Output, Signal};
use diag::Diagnostic;
use units::Time;

/// Highest number of an output or input of each kind.
const LAST: u32 = 63;
/// What M66 has read.
const READ: usize = 5399;

/// M62 … M68 of the block at hand.
pub(crate) fn outputs<S: Sink>(
    words: &Words,
    store: &mut Store,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(code) = words.m(MGroup::Outputs) else { return Ok(()) };
    match code {
        62..=65 => {
            let number = signal(words, code, b'P', "a digital output")?;
            let signal = Signal::Digital { on: code % 2 == 0 };
            out.say(&Call::Output(Output { number, signal, with_motion: code <= 63 }));
            Ok(())
        }
        66 => input(words, store, settings, out),
        _ => {
            let number = signal(words, code, b'E', "an analogue output")?;
            let Some(value) = words.get(b'Q') else {
                let text = format!("M{code} needs Q, the value to put out");
                return refuse("I0642", words.place.span, text);
            };
            let signal = Signal::Analogue { value };
            out.say(&Call::Output(Output { number, signal, with_motion: code == 67 }));
            Ok(())
        }
    }
}

/// The number of an output or input.
fn signal(words: &Words, code: u16, letter: u8, what: &str) -> Outcome<u8> {
    let Some(number) = words.whole(letter, LAST)? else {
        let text = format!("M{code} needs {}, the number of {what}: 0 to {LAST}", letter as char);
        return refuse("I0640", words.place.span, text);
    };
    Ok(number as u8)
}

/// M66.
fn input<S: Sink>(
    words: &Words,
    store: &mut Store,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    let digital = words.get(b'P').is_some();
    if digital == words.get(b'E').is_some() {
        let text = "M66 needs one input: P for a digital one, or E for an analogue one";
        return refuse("I0641", span, text);
    }
    let letter = if digital { b'P' } else { b'E' };
    let number = signal(words, 66, letter, "an input")?;
    let until = match words.whole(b'L', 4)?.unwrap_or(0) {
        0 => Await::Nothing,
        1 => Await::Rise,
        2 => Await::Fall,
        3 => Await::On,
        _ => Await::Off,
    };
    if until != Await::Nothing && !digital {
        let text = "an analogue input is read, not waited for: L0, or no L";
        return refuse("I0643", words.span(b'L'), text);
    }
    let longest = words.get(b'Q').unwrap_or(0.0);
    if until != Await::Nothing && longest <= 0.0 {
        let text = "M66 with L1 to L4 needs Q above 0, the longest wait in seconds";
        return refuse("I0644", span, text);
    }
    let comes = matches!(until, Await::Rise | Await::On) && !settings.stand_alone;
    store.numbered.set(READ, f64::from(u8::from(comes)));
    let wait = InputWait { number, digital, until, longest: Time::s(longest.max(0.0)) };
    store.asked = store.asked.wrapping_add(1);
    out.say(&Call::Input(wait));
    Ok(())
}

/// What the machine has read; `None`: the wait ran out of its time.
pub(crate) fn was_read(store: &mut Store, value: Option<f64>) {
    store.numbered.set(READ, value.unwrap_or(-1.0));
}

/// M100 … M199 of the block at hand, and what else the machine's file names.
pub(crate) fn user_code<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    let (words, settings) = (&ex.words, &ex.settings);
    let Some(number) = words.m(MGroup::User) else { return Ok(()) };
    let called = settings.macro_calls.iter().find(|call| {
        settings.rules.front_end == FrontEndKind::Rs274
            && (call.letter, call.number) == ('M', Some(number))
    });
    if let Some(call) = called {
        let text = format!("M{number} calls O{} on this machine", call.program);
        let help =
            "only Fanuc's dialects and their variants call programs by M codes: --dialect fanuc";
        return Err(error("I0645", words.place.span, text).with_help(help).into());
    }
    let Some(code) = settings.user_codes.iter().find(|code| code.number == number) else {
        if !settings.leaves.unknown_codes {
            return Err(unnamed(words, settings, number).into());
        }
        if ex.codes_told.insert(number) {
            let text = format!("M{number} is the machine builder's, and has no effect here");
            let help = format!(
                "write M{number} = \"what it does\" under [user_codes] of the machine's file. Said once for each code"
            );
            let remark = Diagnostic::warning("I0646", words.place.span, text).with_help(help);
            ex.remarks.push(remark);
        }
        return Ok(());
    };
    let (p, q) = (words.get(b'P'), words.get(b'Q'));
    out.say(&Call::User { number, name: &code.name, p, q });
    match code.action {
        CodeAction::None => {}
        CodeAction::Output { number, on } => {
            let signal = Signal::Digital { on };
            out.say(&Call::Output(Output { number, signal, with_motion: false }));
        }
        CodeAction::Wait(time) => out.say(&Call::Dwell(time.value())),
    }
    Ok(())
}

fn unnamed(words: &Words, settings: &Settings, number: u16) -> Diagnostic {
    let known: Vec<_> = settings
        .user_codes
        .iter()
        .take(12)
        .map(|code| format!("M{} ({})", code.number, code.name))
        .collect();
    let text = format!("M{number} is the machine's own, and its file does not say what it does");
    let help =
        format!("write M{number} = \"what it does\" under [user_codes] of the machine's file");
    let help = match known.len() {
        0 => help,
        _ => format!("{help}; it has {}", known.join(", ")),
    };
    error("I0645", words.place.span, text).with_help(help)
}
