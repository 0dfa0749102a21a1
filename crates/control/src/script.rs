//! What happens to a run from outside: faults of the machine, orders of the operator, each with its
//! moment.
//!
//! ```text
//!   --fault     'power-cut at 1.234s; encoder-slip 0.1rev at depth 8mm'
//!   --operator  'hold at 2.5s; resume at 4s; override 50 at line 30'
//!
//!   item    = what moment          items are parted by ;
//!   moment  = at TIME | at line N | at depth LENGTH [out] | at angle ANGLE | at random | between TIME and TIME
//!   TIME    = 1.5s | 250ms     LENGTH = 8mm | 40um | 0.3in     ANGLE = 12.5rev | 90deg
//! ```
//!
//! A *line* is reached when its first step begins. A *depth* is that of the tool's tip below the
//! work's zero, on the way in (or, with `out`, on the way back). An *angle* is what the first
//! spindle has turned since the start. *At random* is anywhere in the time that the program is
//! planned to take, by the run's seed. An emergency stop is the operator's or the machine's, as you
//! like.
use bus::Sample;
use kernel::Order;
use sim::Fault;
use store::machine::MachineFile;
use units::{Angle, Axis, AxisKind, Coordinate, Length, Time};

/// When something comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// At a time.
    Time(Time),
    /// When a program line begins.
    Line(u32),
    /// When the tool's tip is this deep; on the way out if `out`.
    Depth {
        /// How far below the work's surface.
        below: Length,
        /// On the way out.
        out: bool,
    },
    /// When the first spindle has turned this far.
    Turned(Angle),
    /// Between two times, by chance; `None`: anywhere in the run.
    Random(Option<(Time, Time)>),
}

/// Something and its moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<T> {
    /// What comes.
    pub what: T,
    /// When.
    pub moment: Moment,
    /// As it was typed.
    text: String,
}

/// What can be told to come.
pub trait What: Sized {
    /// What `words` order, all words before the moment.
    ///
    /// # Errors
    /// What the words lack.
    fn read(words: &[&str]) -> Result<Self, String>;
}

/// All that is to come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// Faults of the machine.
    pub faults: Vec<Item<Fault>>,
    /// Orders of the operator.
    pub orders: Vec<Item<Order>>,
}

/// From the values of `--fault` and `--operator`, for a machine.
///
/// # Errors
/// Everything that is wrong with them, a line each.
pub fn told(faults: &[String], orders: &[String], machine: &MachineFile) -> Result<Told, String> {
    let (mut told, mut wrong) = (Told::default(), Vec::new());
    for text in faults.iter().flat_map(|list| items(list)) {
        match item(text).and_then(|item| fits(item, machine)) {
            Ok(item) => told.faults.push(item),
            Err(why) => wrong.push(format!("--fault: {why}")),
        }
    }
    for text in orders.iter().flat_map(|list| items(list)) {
        if text.split_whitespace().eq(["confirm", "always"]) {
            continue; // what is done where nothing is said
        }
        if text.starts_with(Fault::EmergencyStop.name()) {
            match item(text) {
                Ok(item) => told.faults.push(item),
                Err(why) => wrong.push(format!("--operator: {why}")),
            }
            continue;
        }
        match item(text) {
            Ok(item) => told.orders.push(item),
            Err(why) => wrong.push(format!("--operator: {why}")),
        }
    }
    if wrong.is_empty() { Ok(told) } else { Err(wrong.join("\nerror: ")) }
}

/// The items of a list; an empty list has one that is empty.
fn items(list: &str) -> impl Iterator<Item = &str> {
    let is_empty = list.trim().is_empty();
    list.split(';').map(str::trim).filter(move |item| is_empty || !item.is_empty())
}

fn item<T: What>(text: &str) -> Result<Item<T>, String> {
    if text.is_empty() {
        return Err("expected something and its moment, as in \"power-cut at 1.5s\"".into());
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    let split = words.iter().position(|word| matches!(*word, "at" | "between"));
    let (what, moment) = words.split_at(split.unwrap_or(words.len()));
    let what = T::read(what).map_err(|why| format!("\"{text}\": {why}"))?;
    if moment.is_empty() {
        return Err(format!("\"{text}\" has no moment: expected one as in \"{text} at 1.5s\""));
    }
    let moment = read_moment(moment).map_err(|why| format!("\"{text}\": {why}"))?;
    Ok(Item { what, moment, text: text.to_owned() })
}

/// Whether the machine has what is to fail.
fn fits(item: Item<Fault>, machine: &MachineFile) -> Result<Item<Fault>, String> {
    let has_axis = |index: usize| machine.axis(canon::Axis::ALL[index]).is_some();
    let spindles = machine.spindles.len();
    let text = &item.text;
    match item.what {
        Fault::AxisDrive(axis)
        | Fault::Stuck(axis)
        | Fault::Jump(axis, _)
        | Fault::ScaleError(axis, _)
            if !has_axis(axis) =>
        {
            let axes = canon::Axis::ALL.iter().filter(|axis| machine.axis(**axis).is_some());
            let axes: String = axes.map(|axis| axis.letter()).collect();
            let letter = canon::Axis::ALL[axis].letter();
            Err(format!("\"{text}\": {} has no axis {letter}, only {axes}", machine.name))
        }
        Fault::SpindleDrive(spindle)
        | Fault::StuckSpindle(spindle)
        | Fault::TorqueLoss(spindle, _)
        | Fault::Eccentricity(spindle, _)
            if spindle >= spindles =>
        {
            let most = spindles.saturating_sub(1);
            let name = &machine.name;
            Err(format!("\"{text}\": {name} has no spindle {spindle}: its last one is {most}"))
        }
        _ => Ok(item),
    }
}

fn read_moment(words: &[&str]) -> Result<Moment, String> {
    match words {
        ["at", "random"] => Ok(Moment::Random(None)),
        ["at", "line", number] => match number.parse() {
            Ok(line) if line > 0 => Ok(Moment::Line(line)),
            _ => Err(format!("expected a program line from 1 on, found \"{number}\"")),
        },
        ["at", "depth", depth] => Ok(Moment::Depth { below: length(depth)?, out: false }),
        ["at", "depth", depth, "out"] => Ok(Moment::Depth { below: length(depth)?, out: true }),
        ["at", "angle", angle] => Ok(Moment::Turned(self::angle(angle)?)),
        ["at", at] if !matches!(*at, "line" | "depth" | "angle") => Ok(Moment::Time(time(at)?)),
        ["between", from, "and", to] => {
            let (from, to) = (time(from)?, time(to)?);
            if from >= to {
                return Err(format!(
                    "expected two times, the earlier one first, found {from} and {to}"
                ));
            }
            Ok(Moment::Random(Some((from, to))))
        }
        _ => Err(format!(
            "expected a moment such as at 1.5s, at line 30, at depth 8mm, at depth 8mm out, at angle 12rev, at random, \
             between 1s and 2s; found \"{}\"",
            words.join(" ")
        )),
    }
}

/// A number and its unit.
fn measure(text: &str, units: &[(&str, f64)], example: &str) -> Result<f64, String> {
    for (unit, factor) in units {
        if let Some(number) = text.strip_suffix(unit)
            && let Ok(number) = number.trim().parse::<f64>()
            && number.is_finite()
        {
            return Ok(number * factor);
        }
    }
    let known: Vec<_> = units.iter().map(|(unit, _)| *unit).collect();
    Err(format!(
        "expected a number with its unit ({}), as in {example}, found \"{text}\"",
        known.join(", ")
    ))
}

fn time(text: &str) -> Result<Time, String> {
    let seconds = measure(text, &[("ms", 1e-3), ("us", 1e-6), ("s", 1.0)], "1.5s")?;
    if seconds < 0.0 {
        return Err(format!("expected a time from the start on, found {text}"));
    }
    Ok(Time::s(seconds))
}

fn length(text: &str) -> Result<Length, String> {
    measure(text, &[("mm", 1.0), ("um", 1e-3), ("in", units::MM_PER_INCH)], "8mm").map(Length::mm)
}

/// How far along an axis: a length of a linear one, an angle of a rotary one.
fn travel(axis: usize, text: &str) -> Result<Coordinate, String> {
    match Axis::ALL[axis].kind() {
        AxisKind::Linear => length(text).map(Coordinate::linear),
        AxisKind::Rotary => angle(text).map(Coordinate::rotary),
    }
}

fn angle(text: &str) -> Result<Angle, String> {
    measure(text, &[("rev", 1.0), ("deg", 1.0 / 360.0)], "0.25rev").map(Angle::rev)
}

/// How far an encoder's reading may swing: less than what makes it turn back within a revolution.
fn amplitude(text: &str) -> Result<Angle, String> {
    let found = angle(text)?;
    let most = Angle::deg(45.0);
    if found.abs() > most {
        return Err(format!("expected an amplitude of 45deg at most, found {text}"));
    }
    Ok(found)
}

fn ppm(text: &str) -> Result<f64, String> {
    let found = measure(text, &[("ppm", 1e-6), ("%", 1e-2)], "50ppm")?;
    if found.abs() > 0.1 {
        return Err(format!("expected 10% at most, found {text}"));
    }
    Ok(found)
}

fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').unwrap_or(text).parse::<f64>();
    number
        .ok()
        .filter(|n| (0.0..=1000.0).contains(n))
        .map(|n| n / 100.0)
        .ok_or_else(|| format!("expected a percentage, as in 50%, found \"{text}\""))
}

/// Index of an axis on the bus.
fn axis(text: &str) -> Result<usize, String> {
    let mut letters = text.chars();
    let found = match (letters.next(), letters.next()) {
        (Some(letter), None) => {
            canon::Axis::ALL.iter().position(|a| a.letter() == letter.to_ascii_uppercase())
        }
        _ => None,
    };
    found.ok_or_else(|| format!("expected an axis such as Z, found \"{text}\""))
}

/// Counted from 0, as the machine's file and the alarms count them.
fn spindle(text: &str) -> Result<usize, String> {
    let most = bus::SPINDLES - 1;
    let found = text.parse().ok().filter(|n| *n <= most);
    found.ok_or_else(|| format!("expected a spindle from 0 to {most}, found \"{text}\""))
}

/// What is left of a share that is lost.
fn left(lost: &str) -> Result<f64, String> {
    match percent(lost)? {
        share if share <= 1.0 => Ok(1.0 - share),
        _ => Err(format!("expected a loss from 0 to 100%, found \"{lost}\"")),
    }
}

/// Each fault, and what it takes.
const FAULTS: [(&str, &str); 15] = [
    ("power-cut", ""),
    ("kill", ""),
    ("emergency-stop", ""),
    ("drive-fault", " spindle [N]|AXIS"),
    ("lost-index", ""),
    ("encoder-slip", " ANGLE"),
    ("dropout", " TIME"),
    ("feedback-lost", " TIME"),
    ("stuck", " spindle [N]|AXIS"),
    ("feedback-jump", " AXIS LENGTH"),
    ("scale-error", " AXIS PPM"),
    ("eccentricity", " ANGLE [spindle N]"),
    ("late", ""),
    ("missed", ""),
    ("torque-loss", " PERCENT [spindle N]"),
];

/// What was expected: of a fault that there is, what it takes; else all there are.
fn no_fault(words: &[&str]) -> String {
    let whole = |(name, takes): &(&str, &str)| format!("{name}{takes}");
    let meant = FAULTS.iter().find(|(name, _)| words.first() == Some(name));
    let all = || format!("one of {}", FAULTS.iter().map(whole).collect::<Vec<_>>().join(", "));
    let expected = meant.map_or_else(all, whole);
    format!("expected {expected}; found \"{}\"", words.join(" "))
}

impl What for Fault {
    fn read(words: &[&str]) -> Result<Self, String> {
        match words {
            ["power-cut"] => Ok(Self::PowerCut),
            ["kill"] => Ok(Self::Kill),
            ["emergency-stop"] => Ok(Self::EmergencyStop),
            ["drive-fault", "spindle"] => Ok(Self::SpindleDrive(0)),
            ["drive-fault", "spindle", which] => spindle(which).map(Self::SpindleDrive),
            ["drive-fault", letter] => axis(letter).map(Self::AxisDrive),
            ["lost-index"] => Ok(Self::LostIndex),
            ["encoder-slip", by] => angle(by).map(Self::Slip),
            ["dropout", lasts] => time(lasts).map(Self::Dropout),
            ["feedback-lost", lasts] => time(lasts).map(Self::FeedbackLost),
            ["stuck", "spindle"] => Ok(Self::StuckSpindle(0)),
            ["stuck", "spindle", which] => spindle(which).map(Self::StuckSpindle),
            ["stuck", letter] => axis(letter).map(Self::Stuck),
            ["feedback-jump", letter, by] => {
                let axis = axis(letter)?;
                Ok(Self::Jump(axis, travel(axis, by)?))
            }
            ["scale-error", letter, by] => Ok(Self::ScaleError(axis(letter)?, ppm(by)?)),
            ["eccentricity", by] => Ok(Self::Eccentricity(0, amplitude(by)?)),
            ["eccentricity", by, "spindle", which] => {
                Ok(Self::Eccentricity(spindle(which)?, amplitude(by)?))
            }
            ["late"] => Ok(Self::Late),
            ["missed"] => Ok(Self::Missed),
            ["torque-loss", lost] => Ok(Self::TorqueLoss(0, left(lost)?)),
            ["torque-loss", lost, "spindle", which] => {
                Ok(Self::TorqueLoss(spindle(which)?, left(lost)?))
            }
            _ => Err(no_fault(words)),
        }
    }
}

impl What for Order {
    fn read(words: &[&str]) -> Result<Self, String> {
        match words {
            ["hold"] => Ok(Self::FeedHold),
            ["resume"] => Ok(Self::Resume),
            ["confirm"] => Ok(Self::Confirm),
            ["abort"] => Ok(Self::Abort),
            ["retract"] => Ok(Self::Retract),
            ["override", share] => percent(share).map(Self::FeedOverride),
            ["spindle-override", share] => percent(share).map(Self::SpindleOverride),
            ["rapid-override", share] => percent(share).map(Self::RapidOverride),
            ["single-block", "on"] => Ok(Self::SingleBlock(true)),
            ["single-block", "off"] => Ok(Self::SingleBlock(false)),
            _ => Err(format!(
                "expected one of hold, resume, confirm, abort, retract, override PERCENT, rapid-override PERCENT, spindle-override PERCENT, single-block on|off, \
                 emergency-stop; found \"{}\"",
                words.join(" ")
            )),
        }
    }
}

/// Items that wait for their moments.
#[derive(Clone, Debug)]
pub struct Script<T> {
    waiting: Vec<Item<T>>,
    first_angle: Option<Angle>,
    /// Depth of the tip in the last period.
    before: Option<Length>,
}

impl<T: Copy> Script<T> {
    /// Chance is drawn from the seed; anywhere is within `whole`.
    pub fn new(items: Vec<Item<T>>, seed: u64, whole: Time) -> Self {
        let mut waiting = items;
        let mut chance = seed;
        for item in &mut waiting {
            if let Moment::Random(span) = item.moment {
                let (from, to) = span.unwrap_or((Time::ZERO, whole));
                item.moment = Moment::Time(from + (to - from) * unit(&mut chance));
            }
        }
        Self { waiting, first_angle: None, before: None }
    }

    /// Nothing is left to come.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// What has not come, as it was typed.
    pub fn left(&self) -> impl Iterator<Item = &str> {
        self.waiting.iter().map(|item| item.text.as_str())
    }

    /// What comes in this period. `tip`: how deep the tool's tip is below the work's zero.
    pub fn due(&mut self, sample: &Sample, tip: Length) -> Vec<T> {
        if self.waiting.is_empty() {
            return Vec::new();
        }
        let angle = sample.feedback.spindles[0].angle;
        let turned = (angle - *self.first_angle.get_or_insert(angle)).abs();
        let before = self.before.replace(tip).unwrap_or(tip);
        let comes = |moment: Moment| match moment {
            Moment::Time(time) => sample.feedback.time >= time,
            Moment::Line(line) => sample.report.line == line,
            Moment::Turned(angle) => turned >= angle,
            Moment::Depth { below, out: false } => before < below && tip >= below,
            Moment::Depth { below, out: true } => before > below && tip <= below,
            Moment::Random(_) => false, // drawn in the beginning
        };
        let now =
            self.waiting.iter().filter(|item| comes(item.moment)).map(|item| item.what).collect();
        self.waiting.retain(|item| !comes(item.moment));
        now
    }
}

/// `SplitMix64` (Steele, Lea, Flood 2014), from 0 to 1.
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
#[path = "script_tests.rs"]
mod tests;
