//! Tapping programs at random, run as a user runs them and held to what any of them must keep.
//!
//! ```text
//!   seed, number ─► tools.toml, machine.toml, part.ngc ─► leadscrew run --format json ─► fate
//!
//!   good      every thread is there, in class, at its depth and at its start angle; no alarm
//!   refused   before motion, with a code; what was written wrong on purpose must end here
//!   broken    anything else: a thread out of class that was not predicted, an alarm, a thread too few
//! ```
//!
//! `leadscrew run` itself looks in every servo period for what may never happen (a tap driven
//! against its way, moved sideways in its thread, beyond its bottom, a broken tool, a cut at the
//! wrong speed); its certificate says how often.
//!
//! What is drawn stands in [`case`]; two programs in five have two or three parts, each with holes
//! of a size of its own. One program in eight has a mistake, which must be refused by its own code.
//! A tap in another plane than the spindle's own must be refused too.
mod case;

use case::Case;
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};
use test_support::Dice;

/// Largest depth error of a thread, µm.
const DEPTH_UM: f64 = 10.0;

/// What became of one program.
pub(crate) enum Fate {
    /// Every invariant holds.
    Good,
    /// Refused before motion, by these codes.
    Refused(Vec<String>),
}

/// What it must not be.
enum Broken {
    /// The watch saw what may never happen.
    Invariant(String),
    /// A thread out of class, an alarm, a refusal without a reason, a mistake that was not found.
    Unpredicted(String),
}

/// How many of each.
#[derive(Default)]
pub(crate) struct Tally {
    /// What was drawn: kind, value, how often.
    pub(crate) drawn: BTreeMap<(&'static str, &'static str), u32>,
    /// Programs that ran and were good.
    pub(crate) good: u32,
    /// Programs that were refused.
    pub(crate) refused: u32,
    /// By code.
    pub(crate) codes: BTreeMap<String, u32>,
    /// Programs with an invariant broken in any servo period.
    pub(crate) violations: u32,
    /// What broke, with the number of the program.
    pub(crate) broken: Vec<String>,
}

/// Why a program may be refused before motion, by code.
const REASONS: [(&str, &str); 10] = [
    ("M0320", "faster than the feed axis"),
    ("M0321", "faster than the spindle taps"),
    ("M0322", "deeper than the flutes"),
    ("M0326", "another lead than the tap's"),
    ("M0327", "another hand than the tap's"),
    ("M0331", "heavier than the spindle"),
    ("M0334", "another plane than the spindle's"),
    ("M0340", "no dwell works for the clutch holder"),
    ("M0341", "too shallow for the clutch holder's splines"),
    ("M0343", "a word that a clutch holder cannot obey"),
];
/// Of these, what a program without a mistake may be refused for: what machine or holder cannot do.
const PHYSICS: [&str; 5] = ["M0320", "M0321", "M0331", "M0340", "M0341"];

impl Tally {
    /// For people: what was drawn and what became of it.
    pub(crate) fn text(&self, count: u32, seed: u64) -> String {
        let mut text = format!("{count} tapping programs, seed {seed}\n");
        let mut kind = "";
        for ((of, value), times) in &self.drawn {
            text += &if *of == kind { String::from(",") } else { format!("\n  drawn {of:<9}") };
            text += &format!(" {value} {times}");
            kind = of;
        }
        let unpredicted = self.broken.len() - self.violations as usize;
        text += &format!(
            "\n\n  {:>5}  good: every thread in class, at its depth and start angle\n",
            self.good
        );
        text += &format!("  {:>5}  refused before motion\n", self.refused);
        for (code, times) in &self.codes {
            let why = REASONS.iter().find(|(known, _)| known == code).map_or("", |(_, why)| *why);
            text += &format!("         {times:>5}  {code}  {why}\n");
        }
        text += &format!("  {unpredicted:>5}  out of class, or stopped, and not predicted\n");
        text + &format!("  {:>5}  with an invariant broken in any servo period\n", self.violations)
    }
}

/// Run `count` programs of a seed with the `leadscrew` at `binary`; `each` is told after every
/// program.
pub(crate) fn trials(binary: &Path, count: u32, seed: u64, mut each: impl FnMut(u32)) -> Tally {
    let mut tally = Tally::default();
    let machine = machine(binary);
    for number in 0..count {
        let parts = parts(&mut Dice(seed ^ (u64::from(number) << 32)));
        for drawn in parts.iter().flat_map(Case::traits) {
            *tally.drawn.entry(drawn).or_default() += 1;
        }
        *tally.drawn.entry(("parts", PARTS[parts.len() - 1])).or_default() += 1;
        match trial(binary, &machine, &parts, number) {
            Ok(Fate::Good) => tally.good += 1,
            Ok(Fate::Refused(codes)) => {
                tally.refused += 1;
                for code in codes {
                    *tally.codes.entry(code).or_default() += 1;
                }
            }
            Err(broken) => {
                let (Broken::Invariant(why) | Broken::Unpredicted(why)) = &broken;
                tally.violations += u32::from(matches!(broken, Broken::Invariant(_)));
                let (program, tools) = (program(&parts), tools(&parts));
                tally
                    .broken
                    .push(format!("program {number} of seed {seed}: {why}\n{program}{tools}"));
            }
        }
        each(number + 1);
    }
    tally
}

/// How many parts, for the table.
const PARTS: [&str; 3] = ["one", "two", "three"];

/// The parts of a program.
fn parts(dice: &mut Dice) -> Vec<Case> {
    let mut parts = vec![Case::draw(dice)];
    while parts.len() < PARTS.len() && dice.chance(0.4) {
        parts.push(parts[0].after(dice));
    }
    parts
}

fn program(parts: &[Case]) -> String {
    (0..).zip(parts).map(|(number, part)| part.program(number)).collect::<String>() + "M2\n"
}

fn tools(parts: &[Case]) -> String {
    (0..).zip(parts).map(|(number, part)| part.tools(number)).collect::<Vec<_>>().join("\n")
}

fn trial(
    binary: &Path,
    machine: &Result<String, String>,
    parts: &[Case],
    number: u32,
) -> Result<Fate, Broken> {
    let shown = machine.as_ref().map_err(|why| Broken::Unpredicted(why.clone()))?;
    let output = run(binary, shown, parts, number).map_err(Broken::Unpredicted)?;
    judge(parts, &output)
}

fn started(binary: &Path, arguments: &[&str]) -> Result<Output, String> {
    let output = Command::new(binary).args(arguments).output();
    output.map_err(|e| format!("{}: {e}", binary.display()))
}

/// The machine's file as the program shows it.
fn machine(binary: &Path) -> Result<String, String> {
    let shown = started(binary, &["machine", "show", "tapping-center"])?;
    Ok(String::from_utf8_lossy(&shown.stdout).into_owned())
}

/// In a folder of its own, as a user runs it.
fn run(binary: &Path, machine: &str, parts: &[Case], number: u32) -> Result<Output, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).map(|()| path).map_err(|e| e.to_string())
    };
    let program = write("part.ngc", &program(parts))?;
    let tools = write("tools.toml", &tools(parts))?;
    let mut machine = machine.to_owned();
    if parts[0].chip_break {
        machine = machine.replace("retract = \"full\"", "retract = \"chip-break\"");
    }
    let machine = write("machine.toml", &machine)?;
    let path = |p: &Path| p.display().to_string();
    let (program, tools, machine) = (path(&program), path(&tools), path(&machine));
    let (seed, preset) = (number.to_string(), parts[0].preset);
    let options = ["--tapping-preset", preset, "--seed", &seed, "--format", "json"];
    let run = ["run", &program, "--tools", &tools, "--machine", &machine];
    started(binary, &[&run[..], &options].concat())
}

fn judge(parts: &[Case], output: &Output) -> Result<Fate, Broken> {
    let expected: Vec<_> = parts.iter().flat_map(Case::expected).collect();
    let said = String::from_utf8_lossy(&output.stdout);
    let complained = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(2) => {
            let codes = complained.lines().filter_map(|line| line.strip_prefix("error["));
            let mut codes: Vec<_> =
                codes.filter_map(|rest| Some(rest.split_once(']')?.0.to_owned())).collect();
            codes.dedup();
            // each by the code of what was written wrong, or for what machine or holder cannot do
            let fair = |code: &String| {
                PHYSICS.contains(&code.as_str()) || expected.contains(&code.as_str())
            };
            if !codes.is_empty() && codes.iter().all(fair) {
                Ok(Fate::Refused(codes))
            } else {
                Err(Broken::Unpredicted(format!("refused: {complained}")))
            }
        }
        Some(0) if !expected.is_empty() => {
            Err(Broken::Unpredicted(format!("a mistake was not found\n{complained}")))
        }
        Some(0) => invariants(parts, &said),
        code => Err(Broken::Unpredicted(format!("exit code {code:?}\n{said}{complained}"))),
    }
}

fn invariants(parts: &[Case], certificate: &str) -> Result<Fate, Broken> {
    let unpredicted = |why: String| Err(Broken::Unpredicted(format!("{why}\n{certificate}")));
    let threads = certificate.matches("\"kind\": \"thread\"").count();
    let holes: u32 = parts.iter().map(|part| part.holes).sum();
    if threads != holes as usize {
        return unpredicted(format!("{threads} threads for {holes} holes"));
    }
    if !certificate.contains("\"alarms\": []") {
        return unpredicted("an alarm".into());
    }
    let violations: Vec<_> = figures(certificate, "violations").collect();
    if violations != [0.0] {
        let why = format!("invariants broken in {violations:?} servo periods\n{certificate}");
        return Err(Broken::Invariant(why));
    }
    let too_deep = figures(certificate, "depth_error_um").find(|um| um.abs() > DEPTH_UM);
    if let Some(um) = too_deep {
        return unpredicted(format!("depth error {um} µm"));
    }
    // nothing ties a clutch holder's tap to an angle
    let asked = parts.iter().flat_map(|part| {
        let asked = part.is_tied().then(|| part.angle.unwrap_or(0.0));
        (0..part.holes).map(move |_| asked)
    });
    let elsewhere = figures(certificate, "start_angle_deg").zip(asked).find(|(deg, asked)| {
        asked.is_some_and(|asked| ((deg - asked + 180.0).rem_euclid(360.0) - 180.0).abs() > 5.0)
    });
    match elsewhere {
        Some((deg, asked)) => unpredicted(format!("starts at {deg}°, asked {asked:?}°")),
        None => Ok(Fate::Good),
    }
}

/// The numbers of a key.
fn figures<'a>(certificate: &'a str, key: &'a str) -> impl Iterator<Item = f64> + 'a {
    let value = move |line: &'a str| {
        let (name, value) = line.trim().split_once(": ")?;
        let wanted = name.trim_matches('"') == key;
        wanted.then(|| value.trim_end_matches(',').parse().unwrap_or(f64::INFINITY))
    };
    certificate.lines().filter_map(value)
}
