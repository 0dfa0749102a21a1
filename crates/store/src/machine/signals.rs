//! Signals that a machine has, and what stands on its inputs in simulation.
//!
//! ```toml
//! [inputs]                       # numbers and names: M66 P3 and M66 E0 may be written
//! digital_3 = "vice closed"
//! analogue_0 = "chuck pressure, bar"
//!
//! [outputs]                      # M62 to M65, M67, M68
//! digital_1 = "close the vice"
//!
//! [probe]                        # G38.2 to G38.5 may be written
//! [probe.setter]                 # a tool setter on the table, machine coordinates
//!
//! [simulation.inputs]            # by what they change: see InputSource
//! digital_3 = "follows output 1 after 0.3 s"
//! analogue_0 = "follows output 1 from 0 to 40 after 0.1 s within 0.5 s"
//! digital_4 = "on at 2 s, off at 5 s"
//! ```
use super::axis::FARTHEST_MM;
use crate::keys::Keys;
use units::{Length, Time};

/// Signals by kind and number, each with its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// On or off.
    pub digital: Vec<(u8, String)>,
    /// A value.
    pub analogue: Vec<(u8, String)>,
}

/// A touch probe can be plugged in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeInput {
    /// A plate on the table that tools touch.
    pub setter: Option<Setter>,
}

/// A tool setter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setter {
    /// The middle of its plate, in machine coordinates of a tool's tip.
    pub at: [Length; 3],
    /// Of its plate.
    pub diameter: Length,
    /// How far it gives until it switches.
    pub pretravel: Length,
}

/// What a simulated input shows.
#[derive(Clone, Debug, PartialEq)]
pub struct InputModel {
    /// Which of its kind.
    pub number: u8,
    /// On or off; else a value.
    pub digital: bool,
    /// By what.
    pub source: InputSource,
}

/// By what a simulated input changes. Of a digital one 0 is off.
#[derive(Clone, Debug, PartialEq)]
pub enum InputSource {
    /// By a script.
    Timed {
        /// From the beginning.
        first: f64,
        /// And from each moment on.
        changes: Vec<(Time, f64)>,
    },
    /// By an output.
    Follows {
        /// Which digital output.
        output: u8,
        /// What it shows while that is off, and on.
        values: [f64; 2],
        /// How long after.
        after: Time,
        /// Time constant of an analogue one.
        within: Time,
    },
}

impl Names {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let mut names = Self::default();
        for ((digital, number), name) in keys.texts(signal) {
            let of = if digital { &mut names.digital } else { &mut names.analogue };
            of.push((number, name));
        }
        names.digital.sort();
        names.analogue.sort();
        names
    }
}

impl ProbeInput {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self { setter: keys.optional_section("setter", Setter::read) }
    }
}

impl Setter {
    fn read(keys: &mut Keys<'_>) -> Self {
        let mut at = |key| Length::mm(keys.number(key, -FARTHEST_MM..=FARTHEST_MM));
        Self {
            at: [at("x_mm"), at("y_mm"), at("z_mm")],
            diameter: Length::mm(keys.number("diameter_mm", 1.0..=500.0)),
            pretravel: Length::um(keys.number("pretravel_um", 0.0..=1000.0)),
        }
    }
}

/// `[simulation.inputs]`.
pub(super) fn read_models(keys: &mut Keys<'_>) -> Vec<InputModel> {
    let stated = keys.texts(|key| signal(key).map(|signal| (signal, key.to_owned())));
    let mut models = Vec::new();
    for (((digital, number), key), text) in stated {
        match source(&text, digital) {
            Ok(source) => models.push(InputModel { number, digital, source }),
            Err(why) => keys.conflict("", format!("`{key}`: {why}")),
        }
    }
    models
}

/// `digital_3` is (true, 3).
fn signal(key: &str) -> Option<(bool, u8)> {
    let (kind, number) = key.rsplit_once('_')?;
    let number: u8 = number.parse().ok()?;
    match kind {
        "digital" => (usize::from(number) < bus::DIGITAL).then_some((true, number)),
        "analogue" => (usize::from(number) < bus::ANALOGUE).then_some((false, number)),
        _ => None,
    }
}

/// From lines `digital_3 = follows output 1 after 0.3 s`; `#` begins a comment.
///
/// # Errors
/// Everything that is wrong with them, with the line.
pub fn parse_inputs(text: &str) -> Result<Vec<InputModel>, Vec<String>> {
    let (mut models, mut wrong) = (Vec::new(), Vec::new());
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        match input_line(content) {
            Ok(model) => models.push(model),
            Err(why) => wrong.push(format!("line {line}: {why}")),
        }
    }
    if wrong.is_empty() { Ok(models) } else { Err(wrong) }
}

fn input_line(content: &str) -> Result<InputModel, String> {
    let Some((key, text)) = content.split_once('=') else {
        return Err(format!(
            "expected an input and what it does, as in digital_3 = on at 2 s; found \"{content}\""
        ));
    };
    let key = key.trim();
    let Some((digital, number)) = signal(key) else {
        let (digital, analogue) = (bus::DIGITAL - 1, bus::ANALOGUE - 1);
        return Err(format!(
            "expected an input from digital_0 to digital_{digital} or analogue_0 to analogue_{analogue}, found \"{key}\""
        ));
    };
    let text = text.trim().trim_matches('"');
    Ok(InputModel { number, digital, source: source(text, digital)? })
}

/// What an input does, in words.
fn source(text: &str, digital: bool) -> Result<InputSource, String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    match words.as_slice() {
        ["follows", rest @ ..] => follows(rest, digital),
        _ => timed(text, digital),
    }
    .map_err(|why| {
        let example = if digital {
            "on, off, on at 2 s, off at 5 s, or follows [not] output 1 after 0.3 s"
        } else {
            "2.5, 2.5 at 2 s, 3 at 5 s, or follows output 1 from 0 to 40 after 0.1 s within 0.5 s"
        };
        format!("{why}; what works: {example}")
    })
}

fn timed(text: &str, digital: bool) -> Result<InputSource, String> {
    let (mut first, mut changes) = (0.0, Vec::<(Time, f64)>::new());
    for part in text.split(',') {
        let words: Vec<&str> = part.split_whitespace().collect();
        match words.as_slice() {
            [value] => first = level(value, digital)?,
            [value, "at", at @ ..] => {
                let (at, value) = (time(at)?, level(value, digital)?);
                if changes.last().is_some_and(|(last, _)| *last >= at) {
                    return Err(format!("\"{}\" is not later than the one before", part.trim()));
                }
                changes.push((at, value));
            }
            _ => return Err(format!("found \"{}\"", part.trim())),
        }
    }
    Ok(InputSource::Timed { first, changes })
}

fn follows(words: &[&str], digital: bool) -> Result<InputSource, String> {
    let (inverted, words) = match words {
        ["not", rest @ ..] => (true, rest),
        _ => (false, words),
    };
    let ["output", number, rest @ ..] = words else {
        return Err(format!("expected an output, found \"{}\"", words.join(" ")));
    };
    let output = number.parse().ok().filter(|n| usize::from(*n) < bus::DIGITAL);
    let most = bus::DIGITAL - 1;
    let output: u8 =
        output.ok_or_else(|| format!("expected an output from 0 to {most}, found \"{number}\""))?;
    let mut values = if inverted { [1.0, 0.0] } else { [0.0, 1.0] };
    let (mut after, mut within) = (Time::ZERO, Time::ZERO);
    let mut rest = rest;
    loop {
        rest = match rest {
            [] => break,
            ["from", off, "to", on, more @ ..] if !digital => {
                values = [level(off, false)?, level(on, false)?];
                more
            }
            ["after", value, unit @ ("s" | "ms"), more @ ..] => {
                after = time(&[value, unit])?;
                more
            }
            ["within", value, unit @ ("s" | "ms"), more @ ..] if !digital => {
                within = time(&[value, unit])?;
                more
            }
            _ => return Err(format!("found \"{}\"", rest.join(" "))),
        };
    }
    Ok(InputSource::Follows { output, values, after, within })
}

fn level(text: &str, digital: bool) -> Result<f64, String> {
    match (digital, text) {
        (true, "on") => Ok(1.0),
        (true, "off") => Ok(0.0),
        (true, _) => Err(format!("expected on or off, found \"{text}\"")),
        (false, _) => text
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| format!("expected a number, found \"{text}\"")),
    }
}

/// `2 s`, `2s`, `300 ms`.
fn time(words: &[&str]) -> Result<Time, String> {
    let text = words.concat();
    let (number, scale) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => ("", 1.0),
    };
    let seconds = number.parse::<f64>().ok().map(|value| value * scale);
    seconds.filter(|seconds| (0.0..1e6).contains(seconds)).map(Time::s).ok_or_else(|| {
        format!("expected a time such as 2 s or 300 ms, found \"{}\"", words.join(" "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(line: &str) -> InputSource {
        parse_inputs(line).unwrap().remove(0).source
    }

    #[test]
    fn what_an_input_does_is_read_as_it_is_written() {
        let at = |s, v| (Time::s(s), v);
        assert_eq!(
            one("digital_3 = on at 2 s, off at 5s"),
            InputSource::Timed { first: 0.0, changes: vec![at(2.0, 1.0), at(5.0, 0.0)] }
        );
        assert_eq!(one("digital_0 = on"), InputSource::Timed { first: 1.0, changes: Vec::new() });
        assert_eq!(
            one("digital_3 = follows not output 1 after 300 ms"),
            InputSource::Follows {
                output: 1,
                values: [1.0, 0.0],
                after: Time::s(0.3),
                within: Time::ZERO
            }
        );
        assert_eq!(
            one("analogue_0 = follows output 1 from 0 to 40 after 0.1 s within 0.5 s # bar"),
            InputSource::Follows {
                output: 1,
                values: [0.0, 40.0],
                after: Time::s(0.1),
                within: Time::s(0.5)
            }
        );
    }

    #[test]
    fn everything_wrong_is_said_at_once_with_what_would_work() {
        let text = "digital_64 = on\n\ndigital_1 = maybe\nanalogue_0 = follows output 99\ndigital_2 = on at 5 s, off at 2 s\nvice\n";
        let wrong = parse_inputs(text).unwrap_err();
        let expected = [
            "line 1: expected an input from digital_0 to digital_63",
            "line 3: expected on or off, found \"maybe\"; what works: on, off, on at 2 s",
            "line 4: expected an output from 0 to 63, found \"99\"",
            "line 5: \"off at 2 s\" is not later",
            "line 6: expected an input and what it does",
        ];
        assert_eq!(wrong.len(), expected.len(), "{wrong:?}");
        for (found, begins) in wrong.iter().zip(expected) {
            assert!(found.starts_with(begins), "{found}");
        }
    }
}
