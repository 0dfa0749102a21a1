//! Tapping programs at random, run as a user runs them and held to what any of them must keep.
//!
//! ```text
//!   seed, number ─► tools.toml, machine.toml, part.ngc ─► leadscrew run --format json ─► fate
//!
//!   good      every thread is there, in class, at its depth and at its start angle; no alarm
//!   refused   before motion, with a code; what was written wrong on purpose must end here
//!   broken    anything else: a thread out of class that nobody predicted, an alarm, a thread too few
//! ```
//!
//! `leadscrew run` itself looks in every servo period for what may never happen (a tap driven against its way, moved
//! sideways in its thread, beyond its bottom, a broken tool, a cut at the wrong speed); its certificate says how often.
//!
//! Drawn: size, hand, depth, speed, holder, units, plane, cycle (G84 and G74, M29, G84.2 and G84.3, G33.1), where the
//! lead comes from, pecks of both kinds, start angle, return speed, dwell, preset; one in eight has a mistake.
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};

/// Largest depth error of a thread, µm.
const DEPTH_UM: f64 = 10.0;

/// What became of one program.
pub(crate) enum Fate {
    /// Every invariant holds.
    Good,
    /// Refused before motion, by these codes.
    Refused(Vec<String>),
}

/// How many of each.
#[derive(Default)]
pub(crate) struct Tally {
    /// Programs that ran and were good.
    pub(crate) good: u32,
    /// Programs that were refused.
    pub(crate) refused: u32,
    /// By code.
    pub(crate) codes: BTreeMap<String, u32>,
    /// What broke, with the number of the program.
    pub(crate) broken: Vec<String>,
}

/// Run `count` programs of a seed with the `leadscrew` at `binary`; `each` is told after every program.
pub(crate) fn trials(binary: &Path, count: u32, seed: u64, mut each: impl FnMut(u32)) -> Tally {
    let mut tally = Tally::default();
    for number in 0..count {
        match trial(binary, seed, number) {
            Ok(Fate::Good) => tally.good += 1,
            Ok(Fate::Refused(codes)) => {
                tally.refused += 1;
                for code in codes {
                    *tally.codes.entry(code).or_default() += 1;
                }
            }
            Err(why) => tally.broken.push(format!("program {number} of seed {seed}: {why}")),
        }
        each(number + 1);
    }
    tally
}

fn trial(binary: &Path, seed: u64, number: u32) -> Result<Fate, String> {
    let case = Case::draw(&mut Dice(seed ^ (u64::from(number) << 32)));
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).map(|()| path).map_err(|e| e.to_string())
    };
    let program = write("part.ngc", &case.program())?;
    let tools = write("tools.toml", &case.tools())?;
    let run = |arguments: &[&str]| {
        Command::new(binary)
            .args(arguments)
            .output()
            .map_err(|e| format!("{}: {e}", binary.display()))
    };
    let shown = run(&["machine", "show", "tapping-center"])?;
    let mut machine = String::from_utf8_lossy(&shown.stdout).into_owned();
    if case.chip_break {
        machine = machine.replace("retract = \"full\"", "retract = \"chip-break\"");
    }
    let machine = write("machine.toml", &machine)?;
    let path = |p: &Path| p.display().to_string();
    let (program, tools, machine) = (path(&program), path(&tools), path(&machine));
    let output = run(&[
        "run",
        &program,
        "--tools",
        &tools,
        "--machine",
        &machine,
        "--tapping-preset",
        case.preset,
        "--seed",
        &number.to_string(),
        "--format",
        "json",
    ])?;
    case.judge(&output).map_err(|why| format!("{why}\n{}{}", case.program(), case.tools()))
}

/// One program with its tools.
struct Case {
    size: &'static Size,
    left: bool,
    holder: &'static str,
    inch: bool,
    code: &'static str,
    rpm: f64,
    depth: f64,
    lead: Lead,
    peck: Option<f64>,
    chip_break: bool,
    angle: Option<f64>,
    back: Option<f64>,
    dwell: Option<f64>,
    preset: &'static str,
    holes: u32,
    mistake: Option<Mistake>,
}

struct Size {
    name: &'static str,
    diameter: f64,
    pitch: f64,
    drill: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Lead {
    PerMinute,
    PerRevolution,
    OfTheTap,
}

#[derive(Clone, Copy, PartialEq)]
enum Mistake {
    Lead,
    Speed,
    Flutes,
    Hand,
    Plane,
}

const fn size(name: &'static str, diameter: f64, pitch: f64, drill: f64) -> Size {
    Size { name, diameter, pitch, drill }
}

const SIZES: [Size; 8] = [
    size("M3x0.5", 3.0, 0.5, 2.5),
    size("M4x0.7", 4.0, 0.7, 3.3),
    size("M5x0.8", 5.0, 0.8, 4.2),
    size("M6x1", 6.0, 1.0, 5.0),
    size("M8x1.25", 8.0, 1.25, 6.8),
    size("M10x1.5", 10.0, 1.5, 8.5),
    size("M12x1.75", 12.0, 1.75, 10.2),
    size("1/4-20 UNC", 6.35, 1.27, 5.2),
];
const HOLDERS: [&str; 3] = [
    "{ kind = \"rigid\", stiffness_n_per_um = 20.0 }",
    "{ kind = \"soft-synchro\", stiffness_n_per_um = 0.5, travel_mm = 0.5 }",
    "{ kind = \"tension-compression\", stiffness_n_per_mm = 25.0, travel_mm = 8.0 }",
];
const MISTAKES: [Mistake; 5] =
    [Mistake::Lead, Mistake::Speed, Mistake::Flutes, Mistake::Hand, Mistake::Plane];

impl Case {
    fn draw(dice: &mut Dice) -> Self {
        let size = dice.one_of(&SIZES);
        let mistake = if dice.chance(0.125) { Some(*dice.one_of(&MISTAKES)) } else { None };
        let code = *dice.one_of(&["plain", "M29", "G84.2", "G33.1"]);
        let depth = (dice.between(1.5, 2.5) * size.diameter * 1e3).round() / 1e3;
        let stroke = depth + 2.0 * size.pitch;
        let rpm = match mistake {
            Some(Mistake::Speed) => dice.between(6100.0, 9000.0),
            _ => dice.between(5.0, 8.6).exp(), // 150 to 5400, as many slow ones as fast ones
        };
        let with = |chance: f64, dice: &mut Dice| dice.chance(chance) && code != "G33.1";
        let peck = with(0.4, dice).then(|| dice.between(0.2, 0.7) * stroke);
        let dwell = with(0.3, dice).then(|| dice.between(0.0, 0.3));
        let angle = with(0.4, dice).then(|| dice.between(0.0, 359.0).round());
        let back = dice.chance(0.4).then(|| (dice.between(0.5, 2.0) * 10.0).round() / 10.0);
        Self {
            size,
            left: dice.chance(0.3) && !size.name.contains("UNC"),
            holder: *dice.one_of::<&str>(&HOLDERS),
            inch: dice.chance(0.3),
            code,
            rpm: rpm.round(),
            depth,
            lead: *dice.one_of(&[Lead::PerMinute, Lead::PerRevolution, Lead::OfTheTap]),
            peck,
            chip_break: dice.chance(0.5),
            angle,
            back,
            dwell,
            preset: *dice.one_of::<&str>(&["gentle", "standard", "fast", "max"]),
            holes: 1 + (dice.next() % 2) as u32,
            mistake,
        }
    }

    fn has(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// A length in the program's units.
    fn length(&self, mm: f64) -> String {
        format!("{:.6}", if self.inch { mm / 25.4 } else { mm })
    }

    fn tools(&self) -> String {
        let Size { name, diameter, pitch, drill } = self.size;
        let hand = if self.left { "-LH" } else { "" };
        let flutes = if self.has(Mistake::Flutes) { self.depth * 0.8 } else { self.depth + 5.0 };
        format!(
            "[[tool]]\nnumber = 1\npocket = 1\nkind = \"drill\"\ndescription = \"drill\"\n\
             diameter_mm = {drill:?}\npoint_angle_deg = 140.0\nlength_mm = 120.0\n\n\
             [[tool]]\nnumber = 2\npocket = 2\nkind = \"tap\"\ndescription = \"tap\"\n\
             diameter_mm = {diameter:?}\nlength_mm = 100.0\nthread = \"{name}{hand}\"\n\
             chamfer_pitches = 2.5\nthread_length_mm = {flutes:?}\nflute = \"spiral-flute\"\n\
             oversize_um = {:.1}\nholder = {}\n",
            25.0 + 15.0 * pitch,
            self.holder,
        )
    }

    fn program(&self) -> String {
        let mm = |value: f64| self.length(value);
        let units = if self.inch { "G20" } else { "G21" };
        let left = self.left != self.has(Mistake::Hand);
        let turn = if left { "M4" } else { "M3" };
        let clear = 3.0 * self.size.pitch;
        let drill_feed = 3000.0 * 0.015 * self.size.drill;
        let drilled = self.depth + self.size.drill * 0.3 + 2.0;
        let mut text = format!(
            "{units} G17 G40 G49 G80 G90 G94 G54\nT1 M6\nG43 H1\nS3000 M3\nG0 X0 Y0 Z{}\n",
            mm(10.0)
        );
        for hole in 0..self.holes {
            let x = 15.0 * f64::from(hole);
            text += &format!(
                "G98 G81 X{} Y0 Z{} R{} F{}\n",
                mm(x),
                mm(-drilled),
                mm(2.0),
                mm(drill_feed)
            );
        }
        text += &format!("G80\nT2 M6\nG43 H2\nG0 X0 Y0 Z{}\n", mm(10.0));
        text += match self.code {
            "plain" | "G33.1" => "",
            _ => "M5\n",
        };
        let rpm = self.rpm;
        let lead = self.size.pitch * if self.has(Mistake::Lead) { 1.25 } else { 1.0 };
        for hole in 0..self.holes {
            let x = 15.0 * f64::from(hole);
            if self.code == "G33.1" {
                let back = self.back.map_or(String::new(), |f| format!(" I{f}"));
                let plane = if self.has(Mistake::Plane) { "X" } else { "Z" };
                let to = if self.has(Mistake::Plane) { x - self.depth } else { -self.depth };
                text += &format!("S{rpm} {turn}\nG0 X{} Y0\nG0 Z{}\n", mm(x), mm(clear));
                text += &format!("G33.1 {plane}{} K{}{back}\n", mm(to), mm(lead));
            } else if hole == 0 {
                text += &self.first_hole(lead, left, turn, clear);
            } else {
                text += &format!("X{}\n", mm(x));
            }
        }
        text + "G80\nM2\n"
    }

    /// The block that begins the tapping cycle, and what goes before it.
    fn first_hole(&self, lead: f64, left: bool, turn: &str, clear: f64) -> String {
        let mm = |value: f64| self.length(value);
        let rpm = self.rpm;
        let feed = match self.lead {
            Lead::PerMinute => format!("G94 F{}", mm(lead * rpm)),
            Lead::OfTheTap if !self.has(Mistake::Lead) => "G95".into(),
            Lead::PerRevolution | Lead::OfTheTap => format!("G95 F{}", mm(lead)),
        };
        let word = |letter: &str, value: Option<f64>| {
            value.map_or(String::new(), |v| format!(" {letter}{v}"))
        };
        let (start, cycle) = match (self.code, left) {
            ("M29", false) => (format!("M29 S{rpm}"), "G84"),
            ("M29", true) => (format!("M29 S{rpm}"), "G74"),
            ("G84.2", false) => (format!("S{rpm}"), "G84.2"),
            ("G84.2", true) => (format!("S{rpm}"), "G84.3"),
            (_, false) => (format!("S{rpm} {turn}"), "G84"),
            (_, true) => (format!("S{rpm} {turn}"), "G74"),
        };
        let peck = self.peck.map_or(String::new(), |q| format!(" Q{}", mm(q)));
        let words =
            [word("P", self.dwell), word("A", self.angle), word("J", self.back), peck].concat();
        let (plane, deep) = if self.has(Mistake::Plane) { ("G18 ", "Y") } else { ("", "Z") };
        format!(
            "{plane}{feed}\n{start}\nG99 {cycle} {deep}{} R{}{words}\n",
            mm(-self.depth),
            mm(clear)
        )
    }

    fn judge(&self, output: &Output) -> Result<Fate, String> {
        let said = String::from_utf8_lossy(&output.stdout);
        let complained = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(2) => {
                let codes = complained.lines().filter_map(|line| line.strip_prefix("error["));
                let mut codes: Vec<_> =
                    codes.filter_map(|rest| Some(rest.split_once(']')?.0.to_owned())).collect();
                codes.dedup();
                // a program that is right may only be refused for what the machine cannot do
                let physics = ["M0320", "M0321", "M0331"];
                let fair = codes.iter().all(|c| physics.contains(&c.as_str()));
                let any = !codes.is_empty() && (fair || self.mistake.is_some());
                if any { Ok(Fate::Refused(codes)) } else { Err(format!("refused: {complained}")) }
            }
            Some(0) if self.mistake.is_some() => {
                Err(format!("a mistake was not found\n{complained}"))
            }
            Some(0) => self.invariants(&said),
            code => Err(format!("exit code {code:?}\n{said}{complained}")),
        }
    }

    fn invariants(&self, certificate: &str) -> Result<Fate, String> {
        let threads = certificate.matches("\"kind\": \"thread\"").count();
        if threads != self.holes as usize {
            return Err(format!("{threads} threads for {} holes\n{certificate}", self.holes));
        }
        if !certificate.contains("\"alarms\": []") {
            return Err(format!("an alarm\n{certificate}"));
        }
        let violations: Vec<_> = figures(certificate, "violations").collect();
        if violations != [0.0] {
            return Err(format!(
                "invariants broken in {violations:?} servo periods\n{certificate}"
            ));
        }
        let too_deep = figures(certificate, "depth_error_um").find(|um| um.abs() > DEPTH_UM);
        if let Some(um) = too_deep {
            return Err(format!("depth error {um} µm\n{certificate}"));
        }
        let asked = self.angle.unwrap_or(0.0);
        let elsewhere = figures(certificate, "start_angle_deg")
            .find(|deg| ((deg - asked + 180.0).rem_euclid(360.0) - 180.0).abs() > 5.0);
        match elsewhere {
            Some(deg) => Err(format!("starts at {deg}°, asked {asked}°\n{certificate}")),
            None => Ok(Fate::Good),
        }
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

/// Numbers at random, the same on every machine (`SplitMix64`, Steele, Lea and Flood 2014).
struct Dice(u64);

impl Dice {
    const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    fn one_of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[(self.next() % list.len() as u64) as usize]
    }
}
