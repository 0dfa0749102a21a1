//! What a line means: a request, a wait, a question.
use super::wait::Condition;
use canon::Axis;
use control::job::restart;
use control::operation::{Jog, Request, SequenceOrder, ToolField};
use std::path::PathBuf;
use units::{Angle, Coordinate, CoordinateSpeed, Spin, Time};

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Command {
    /// Ask the control for something.
    Request(Request),
    /// Ask for it again and again, so long.
    Leased(Request, Time),
    /// Let the machine go on until something is so, at most so long.
    Wait(Condition, Time),
    /// Let the machine go on so long.
    Pass(Time),
    /// How it is; as JSON.
    Status(bool),
    /// How far a tool change is, and where the tools are.
    Sequence,
    /// What was cut.
    Features,
    /// Alarms, cleared ones too.
    Alarms,
    /// Work offsets.
    Offsets,
    /// Tools.
    Tools,
    /// What can be typed.
    Help,
    /// The end.
    Quit,
}

/// How long a wait lasts at most that does not say it, machine time.
const WAITS: Time = Time::s(600.0);
/// A continuous jog that does not say for how long.
const JOGS: Time = Time::s(1.0);

/// What can be typed: words, and what they do.
pub(crate) const WORDS: [(&str, &str); 54] = [
    ("power on|off", "drives on or off"),
    ("emergency stop|release", "press or release the emergency stop of the simulated machine"),
    ("home [AXIS]", "home an axis, or all in the machine's order"),
    ("jog AXIS +10|-0.1", "by so much, mm or degrees"),
    ("jog AXIS to 25", "to this machine coordinate"),
    ("jog AXIS at 500 [for 2 s]", "at so many mm/min (deg/min), renewed until the time is over"),
    ("jog stop", "bring to rest what is moved by hand"),
    ("handwheel AXIS +0.1", "turn the handwheel by so much"),
    ("spindle 300 [for 2 s]", "turn spindle 0 by hand at so many rev/min; negative is M4"),
    ("spindle stop", "bring it to rest"),
    ("spindle orient 90", "bring it to so many degrees and hold it there"),
    ("load FILE", "load a program"),
    (
        "search line 27|hole 5|tool 3 [program changed]",
        "where the program would begin, and what is restored before",
    ),
    ("start", "start the program, from where the search has led"),
    ("mdi BLOCKS", "execute blocks; several are separated by ;"),
    ("hold", "hold the feed"),
    ("resume", "go on after a hold or a block"),
    ("confirm", "go on after M0 or M1"),
    ("stop", "give the program up"),
    ("workpiece begin [NAME]", "another one is clamped: what is cut counts for it"),
    ("workpiece end", "it is done: the next start begins another one"),
    ("acknowledge state", "the values in force were compared with what the control wrote last"),
    ("reset", "clear alarms, forget what was executed"),
    ("retract", "back a held tap out of its thread"),
    ("recover", "take a tool out after drives, power or an encoder were gone"),
    ("tool is free", "state that no tool is in the work"),
    ("sequence", "how far a tool change is, inputs as they are and as they should be, pockets"),
    ("sequence go on|undo", "lead a tool change on that was left half way, or back"),
    ("sequence step [back]", "its next step alone; the step before alone, undone"),
    (
        "sequence done TOOL",
        "it was brought to rest by hand, with this tool in the spindle; 0 is none",
    ),
    ("carousel at POCKET", "this pocket is at the spindle"),
    ("pocket POCKET TOOL", "this tool is in this pocket; 0 is none"),
    ("single block on|off", "hold after each block"),
    ("optional stop on|off", "stop at M1"),
    ("flood on|off", "switch the flood coolant, until the program does"),
    ("mist on|off", "the same of the mist coolant"),
    ("block skip 1 on|off", "leave out blocks of this level of /"),
    ("feed 80", "percent of the programmed feed"),
    ("rapid 25", "percent of the rapids"),
    ("spindle override 110", "percent of the programmed spindle speed"),
    ("touch off AXIS 0", "the tool's tip is at this coordinate of the work offset in force"),
    ("offset G54 AXIS -250", "set a work offset, machine coordinates"),
    ("tool 3 wear length|radius -0.02", "its wear, mm, which is added"),
    ("tool 3 length|diameter 120.5", "what the control believes of a tool, mm"),
    ("tool 3 limit 500|none", "holes or threads that it may cut"),
    (
        "tool 3 renew",
        "a new one is in its place: its life begins anew, its wear is 0, it is not broken",
    ),
    ("wait STATE [within 60 s]", "until the control is so; see below"),
    ("wait 2 s", "let machine time pass"),
    ("status [json]", "how it is"),
    ("features", "what was cut, with its verdicts"),
    ("alarms", "alarms, cleared ones too"),
    ("offsets, tools", "as the control believes them"),
    ("help", "this list"),
    ("quit", "switch the control off"),
];

impl Command {
    /// What a line means.
    ///
    /// # Errors
    /// What was expected instead.
    pub(crate) fn read(line: &str) -> Result<Self, String> {
        let line = line.trim();
        let words: Vec<&str> = line.split_whitespace().collect();
        if let Some(blocks) = line.strip_prefix("mdi ") {
            let text = blocks.split(';').map(str::trim).collect::<Vec<_>>().join("\n");
            return Ok(Self::Request(Request::ManualDataInput(text)));
        }
        if let Some(path) = line.strip_prefix("load ") {
            return Ok(Self::Request(Request::Load(PathBuf::from(path.trim()))));
        }
        Ok(match words.as_slice() {
            ["power", switch] => Self::Request(Request::Power(is_on(switch)?)),
            ["emergency", "stop"] => Self::Request(Request::EmergencyStop(true)),
            ["emergency", "release"] => Self::Request(Request::EmergencyStop(false)),
            ["home"] => Self::Request(Request::Home(None)),
            ["home", letter] => Self::Request(Request::Home(Some(axis(letter)?))),
            ["jog", "stop"] => Self::Request(Request::JogStop),
            ["jog", letter, rest @ ..] => jog(axis(letter)?, rest)?,
            ["handwheel", letter, by] => {
                Self::Request(Request::Jog(axis(letter)?, Jog::Handwheel(coordinate(by)?)))
            }
            ["spindle", "override", percent] => {
                Self::Request(Request::SpindleOverride(share(percent)?))
            }
            ["spindle", rest @ ..] => spindle(rest)?,
            ["search", rest @ .., "program", "changed"] => {
                Self::Request(Request::Search(rest.join(" ").parse()?, true))
            }
            ["search", rest @ ..] => {
                let from: restart::From = rest.join(" ").parse()?;
                Self::Request(Request::Search(from, false))
            }
            ["start"] => Self::Request(Request::Start),
            ["hold"] => Self::Request(Request::FeedHold),
            ["resume"] => Self::Request(Request::Resume),
            ["confirm"] => Self::Request(Request::Confirm),
            ["stop"] => Self::Request(Request::Stop),
            ["workpiece", "begin"] => Self::Request(Request::BeginWorkpiece(None)),
            ["workpiece", "begin", name @ ..] => {
                Self::Request(Request::BeginWorkpiece(Some(name.join(" "))))
            }
            ["workpiece", "end"] => Self::Request(Request::EndWorkpiece),
            ["acknowledge", "state"] => Self::Request(Request::AcknowledgeState),
            ["reset"] => Self::Request(Request::Reset),
            ["retract"] => Self::Request(Request::Retract),
            ["recover"] => Self::Request(Request::Recover),
            ["sequence" | "carousel" | "pocket", ..] => sequence(&words)?,
            ["tool", "is", "free"] => Self::Request(Request::ToolIsFree),
            ["single", "block", switch] => Self::Request(Request::SingleBlock(is_on(switch)?)),
            ["optional", "stop", switch] => Self::Request(Request::OptionalStop(is_on(switch)?)),
            ["flood", switch] => Self::Request(Request::Flood(is_on(switch)?)),
            ["mist", switch] => Self::Request(Request::Mist(is_on(switch)?)),
            ["block", "skip", level, switch] => {
                Self::Request(Request::BlockSkip(skip_level(level)?, is_on(switch)?))
            }
            ["feed", percent] => Self::Request(Request::FeedOverride(share(percent)?)),
            ["rapid", percent] => Self::Request(Request::RapidOverride(share(percent)?)),
            ["touch", "off", letter, at] => {
                Self::Request(Request::TouchOff(axis(letter)?, coordinate(at)?))
            }
            ["offset", system, letter, at] => Self::Request(Request::SetWorkOffset(
                work_offset(system)?,
                axis(letter)?,
                coordinate(at)?,
            )),
            ["tool", number, "renew"] => Self::Request(Request::RenewTool(tool(number)?)),
            ["tool", number, "limit", "none"] => {
                Self::Request(Request::LimitTool(tool(number)?, None))
            }
            ["tool", number, "limit", uses] => {
                let uses = uses
                    .parse()
                    .map_err(|_| format!("expected a number of uses, or none, found \"{uses}\""))?;
                Self::Request(Request::LimitTool(tool(number)?, Some(uses)))
            }
            ["tool", number, "wear", field, value] => Self::Request(Request::EditTool(
                tool(number)?,
                match *field {
                    "length" => ToolField::WearLength,
                    "radius" => ToolField::WearRadius,
                    _ => return Err(format!("expected length or radius, found \"{field}\"")),
                },
                self::number(value)?,
            )),
            ["tool", number, field, value] => Self::Request(Request::EditTool(
                tool(number)?,
                field_of(field)?,
                self::number(value)?,
            )),
            ["wait", rest @ ..] => wait(rest)?,
            ["status"] => Self::Status(false),
            ["status", "json"] | ["status", "--format", "json"] => Self::Status(true),
            ["features"] => Self::Features,
            ["alarms"] => Self::Alarms,
            ["offsets"] => Self::Offsets,
            ["tools"] => Self::Tools,
            ["help"] => Self::Help,
            ["quit" | "exit"] => Self::Quit,
            _ => return Err(unknown(line, words.first().copied().unwrap_or_default())),
        })
    }
}

/// Of a line that is none: what its first word takes, or how to see all.
fn unknown(line: &str, first: &str) -> String {
    let meant: Vec<&str> = WORDS
        .iter()
        .map(|(words, _)| *words)
        .filter(|words| words.split_whitespace().next() == Some(first))
        .collect();
    if meant.is_empty() {
        format!("\"{line}\" is no request: help lists them")
    } else {
        format!("\"{line}\" is incomplete or wrong: expected {}", meant.join(", or "))
    }
}

fn jog(axis: Axis, rest: &[&str]) -> Result<Command, String> {
    Ok(match rest {
        ["to", to] => Command::Request(Request::Jog(axis, Jog::To(coordinate(to)?))),
        ["at", speed] => leased_jog(axis, speed, JOGS)?,
        ["at", speed, "for", time @ ..] => leased_jog(axis, speed, self::time(time)?)?,
        [by] if by.starts_with(['+', '-']) => {
            Command::Request(Request::Jog(axis, Jog::Increment(coordinate(by)?)))
        }
        _ => {
            return Err(format!(
                "expected jog {0} +10, jog {0} to 25 or jog {0} at 500 for 2 s",
                axis.letter()
            ));
        }
    })
}

fn leased_jog(axis: Axis, speed: &str, lasts: Time) -> Result<Command, String> {
    let speed = CoordinateSpeed::per_min(number(speed)?);
    Ok(Command::Leased(Request::Jog(axis, Jog::Continuous(speed)), lasts))
}

fn spindle(rest: &[&str]) -> Result<Command, String> {
    let turn = |rpm: f64| Request::TurnSpindle(0, Spin::rpm(rpm));
    Ok(match rest {
        ["stop"] => Command::Request(turn(0.0)),
        ["orient", angle] => {
            Command::Request(Request::OrientSpindle(0, Angle::deg(number(angle)?)))
        }
        [rpm] => Command::Leased(turn(number(rpm)?), JOGS),
        [rpm, "for", time @ ..] => Command::Leased(turn(number(rpm)?), self::time(time)?),
        _ => return Err("expected spindle 300 for 2 s, spindle stop or spindle orient 90".into()),
    })
}

fn wait(rest: &[&str]) -> Result<Command, String> {
    if let Ok(time) = time(rest) {
        return Ok(Command::Pass(time));
    }
    let at = rest.iter().position(|word| *word == "within").unwrap_or(rest.len());
    let (what, within) = rest.split_at(at);
    let within = within.get(1..).filter(|words| !words.is_empty());
    Ok(Command::Wait(Condition::read(what)?, within.map_or(Ok(WAITS), time)?))
}

fn is_on(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("expected on or off, found \"{text}\"")),
    }
}

fn axis(text: &str) -> Result<Axis, String> {
    let mut letters = text.chars();
    match (letters.next().and_then(Axis::from_letter), letters.next()) {
        (Some(axis), None) => Ok(axis),
        _ => Err(format!("expected an axis such as X, found \"{text}\"")),
    }
}

/// A number that is one.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let number = text.trim_start_matches('+').parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| format!("expected a number, found \"{text}\""))
}

/// In the axis' own unit.
fn coordinate(text: &str) -> Result<Coordinate, String> {
    number(text).map(Coordinate::new)
}

fn share(percent: &str) -> Result<f64, String> {
    Ok(number(percent.trim_end_matches('%'))? / 100.0)
}

/// `2 s`, `2s`, `500 ms`, `3 min`.
fn time(words: &[&str]) -> Result<Time, String> {
    let text = words.concat();
    let units = [("ms", 1e-3), ("min", 60.0), ("s", 1.0)];
    let seconds = units
        .iter()
        .find_map(|(unit, factor)| Some(number(text.strip_suffix(unit)?).ok()? * factor));
    seconds.filter(|seconds| (0.0..=86_400.0).contains(seconds)).map(Time::s).ok_or_else(|| {
        format!("expected a time up to a day, as in 2 s, found \"{}\"", words.join(" "))
    })
}

/// `G54` is 1, `G59.3` is 9.
fn work_offset(text: &str) -> Result<u8, String> {
    let names = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
    let at = names.iter().position(|name| name.eq_ignore_ascii_case(text));
    at.map(|at| at as u8 + 1)
        .ok_or_else(|| format!("expected a work offset from G54 to G59.3, found \"{text}\""))
}

fn skip_level(text: &str) -> Result<u8, String> {
    text.parse().map_err(|_| format!("expected a level from 1 to 9, found \"{text}\""))
}

/// What leads a tool change on, or says where tools are.
fn sequence(words: &[&str]) -> Result<Command, String> {
    let order = match words {
        ["sequence"] => return Ok(Command::Sequence),
        ["sequence", "go", "on"] => SequenceOrder::GoOn,
        ["sequence", "undo"] => SequenceOrder::Undo,
        ["sequence", "step"] => SequenceOrder::Step,
        ["sequence", "step", "back"] => SequenceOrder::StepBack,
        ["sequence", "done", number] => SequenceOrder::Done(tool(number)?),
        ["carousel", "at", pocket] => SequenceOrder::Carousel(tool(pocket)?),
        ["pocket", pocket, number] => {
            SequenceOrder::Pocket(tool(pocket)?, tool(number.trim_start_matches('T'))?)
        }
        _ => {
            return Err(format!(
                "expected sequence [go on|undo|step [back]|done TOOL], carousel at POCKET or pocket POCKET TOOL, found \"{}\"",
                words.join(" ")
            ));
        }
    };
    Ok(Command::Request(Request::Sequence(order)))
}

fn tool(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| format!("expected a tool's number, found \"{text}\""))
}

fn field_of(text: &str) -> Result<ToolField, String> {
    match text {
        "length" => Ok(ToolField::Length),
        "diameter" => Ok(ToolField::Diameter),
        _ => Err(format!("expected length or diameter, found \"{text}\"")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_mean_what_they_say() {
        let read = |line: &str| Command::read(line).unwrap();
        assert_eq!(read("power on"), Command::Request(Request::Power(true)));
        assert_eq!(
            read("jog x +10"),
            Command::Request(Request::Jog(Axis::X, Jog::Increment(Coordinate::new(10.0))))
        );
        assert_eq!(
            read("jog Z at -600 for 500 ms"),
            Command::Leased(
                Request::Jog(Axis::Z, Jog::Continuous(CoordinateSpeed::new(-10.0))),
                Time::s(0.5)
            )
        );
        assert_eq!(
            read("mdi G0 X10; G1 Y5 F100"),
            Command::Request(Request::ManualDataInput("G0 X10\nG1 Y5 F100".into()))
        );
        assert_eq!(
            read("search hole 5"),
            Command::Request(Request::Search(restart::From::Hole(5), false))
        );
        assert_eq!(read("wait 2 s"), Command::Pass(Time::s(2.0)));
        assert_eq!(
            read("wait completed within 2 min"),
            Command::Wait(Condition::Execution("PROGRAM_COMPLETED"), Time::s(120.0))
        );
        assert_eq!(
            read("offset g59.1 y -3"),
            Command::Request(Request::SetWorkOffset(7, Axis::Y, Coordinate::new(-3.0)))
        );
    }

    #[test]
    fn a_line_that_is_none_is_answered_with_what_its_word_takes() {
        assert!(Command::read("jump").unwrap_err().contains("help lists them"));
        assert!(Command::read("power up").unwrap_err().contains("expected on or off"));
        assert!(Command::read("jog x 10").unwrap_err().contains("jog X +10"));
        assert!(Command::read("power").unwrap_err().contains("power on|off"));
        assert!(Command::read("wait for godot").unwrap_err().contains("completed"));
        assert!(Command::read("jog q +1").unwrap_err().contains("axis such as X"));
        assert!(Command::read("feed NaN").unwrap_err().contains("a number"));
    }
}
