//! One part of a tapping program with its two tools, drawn at random: holes of one size.
//!
//! Drawn: size, hand, depth, speed, holder, units, plane, cycle (G84 and G74, M29, G84.2 and G84.3,
//! G33.1), where the lead comes from, pecks of both kinds, start angle, return speed and
//! acceleration, dwell, preset. A clutch holder taps with plain G84 and G74 and computes its dwell;
//! in G18 and G19 the tap would lie across the spindle.

use test_support::Dice;

/// Where the holes of the next part lie beside this one's, mm.
const BESIDE: f64 = 60.0;

/// One part of a program: a drill, a tap, one or two holes.
pub(super) struct Case {
    size: &'static Size,
    left: bool,
    holder: &'static Holder,
    inch: bool,
    plane: Plane,
    code: &'static str,
    rpm: f64,
    depth: f64,
    lead: Lead,
    peck: Option<f64>,
    pub(super) chip_break: bool,
    pub(super) angle: Option<f64>,
    back: Option<f64>,
    acceleration: Option<f64>,
    dwell: Option<f64>,
    pub(super) preset: &'static str,
    pub(super) holes: u32,
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
    /// A peck, where a clutch holder taps.
    Word,
}

#[derive(Clone, Copy, PartialEq)]
enum Plane {
    G17,
    G18,
    G19,
}

/// What holds the tap, and its line in the tool table.
struct Holder {
    name: &'static str,
    text: &'static str,
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
static HOLDERS: [Holder; 4] = [
    Holder { name: "rigid", text: "{ kind = \"rigid\", stiffness_n_per_um = 20.0 }" },
    Holder {
        name: "soft-synchro",
        text: "{ kind = \"soft-synchro\", stiffness_n_per_um = 0.5, travel_mm = 0.5 }",
    },
    Holder {
        name: "tension/compression",
        text: "{ kind = \"tension-compression\", stiffness_n_per_mm = 25.0, travel_mm = 8.0 }",
    },
    Holder {
        name: "clutch",
        text: "{ kind = \"clutch\", stiffness_n_per_mm = 10.0, spline_length_mm = 3.0, \
               pawl_backlash_rev = 0.1, compression_mm = 3.0 }",
    },
];
const MISTAKES: [Mistake; 5] =
    [Mistake::Lead, Mistake::Speed, Mistake::Flutes, Mistake::Hand, Mistake::Word];

/// Place of the clutch holder among [`HOLDERS`].
const CLUTCH: usize = 3;
/// Speeds for the table, each 2000 rpm wide but the last.
const SPEEDS: [&str; 3] = ["to 2000", "to 4000", "above"];

impl Plane {
    const fn name(self) -> &'static str {
        match self {
            Self::G17 => "G17",
            Self::G18 => "G18",
            Self::G19 => "G19",
        }
    }
}

impl Case {
    /// A part after this one, with what goes for the whole program. It has no mistake: one a
    /// program is enough.
    pub(super) fn after(&self, dice: &mut Dice) -> Self {
        loop {
            let next = Self::draw(dice);
            if next.expected().is_empty() {
                return Self { chip_break: self.chip_break, preset: self.preset, ..next };
            }
        }
    }

    pub(super) fn draw(dice: &mut Dice) -> Self {
        let size = dice.one_of(&SIZES);
        let mistake = if dice.chance(0.125) { Some(*dice.one_of(&MISTAKES)) } else { None };
        let holder =
            if mistake == Some(Mistake::Word) { &HOLDERS[CLUTCH] } else { dice.one_of(&HOLDERS) };
        let clutch = holder.name == HOLDERS[CLUTCH].name;
        let code = if clutch { "plain" } else { *dice.one_of(&["plain", "M29", "G84.2", "G33.1"]) };
        let plane =
            if dice.chance(0.88) { Plane::G17 } else { *dice.one_of(&[Plane::G18, Plane::G19]) };
        let depth = (dice.between(1.5, 2.5) * size.diameter * 1e3).round() / 1e3;
        let stroke = depth + 2.0 * size.pitch;
        let rpm = match mistake {
            Some(Mistake::Speed) => dice.between(6100.0, 9000.0),
            _ => dice.between(5.0, 8.6).exp(), // 150 to 5400, as many slow ones as fast ones
        };
        let with = |chance: f64, dice: &mut Dice| dice.chance(chance) && code != "G33.1" && !clutch;
        let peck = with(0.4, dice).then(|| dice.between(0.2, 0.7) * stroke);
        let dwell = with(0.3, dice).then(|| dice.between(0.0, 0.3));
        let angle = with(0.4, dice).then(|| dice.between(0.0, 359.0).round());
        let acceleration = with(0.3, dice).then(|| {
            if dice.chance(0.5) {
                (dice.between(0.05, 1.0) * 100.0).round() / 100.0
            } else {
                dice.between(20.0, 200.0).round()
            }
        });
        let back =
            (dice.chance(0.4) && !clutch).then(|| (dice.between(0.5, 2.0) * 10.0).round() / 10.0);
        Self {
            size,
            left: dice.chance(0.3) && !size.name.contains("UNC"),
            holder,
            inch: dice.chance(0.3),
            plane,
            code,
            rpm: rpm.round(),
            depth,
            lead: *dice.one_of(&[Lead::PerMinute, Lead::PerRevolution, Lead::OfTheTap]),
            peck: peck.or_else(|| (mistake == Some(Mistake::Word)).then_some(size.pitch)),
            chip_break: dice.chance(0.5),
            angle,
            back,
            acceleration,
            dwell,
            preset: *dice.one_of::<&str>(&["gentle", "standard", "fast", "max"]),
            holes: 1 + (dice.draw() % 2) as u32,
            mistake,
        }
    }

    fn has(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// What was drawn, for the table.
    pub(super) fn traits(&self) -> [(&'static str, &'static str); 8] {
        let yes_no = |has: bool| if has { "with" } else { "without" };
        [
            ("size", self.size.name),
            ("hand", if self.left { "left" } else { "right" }),
            ("holder", self.holder.name),
            ("units", if self.inch { "inch" } else { "mm" }),
            ("plane", self.plane.name()),
            ("pecks", yes_no(self.peck.is_some())),
            ("speed", SPEEDS[(self.rpm / 2000.0).min(2.0) as usize]),
            ("cycle", self.code),
        ]
    }

    /// The tap is tied to the spindle.
    pub(super) fn is_tied(&self) -> bool {
        self.holder.name != HOLDERS[CLUTCH].name
    }

    /// By which code it must be refused; by none if it is right.
    pub(super) fn expected(&self) -> Vec<&'static str> {
        let plane = (self.plane != Plane::G17).then_some("M0334");
        let mistake = self.mistake.map(|mistake| match mistake {
            Mistake::Lead => "M0326",
            Mistake::Speed => "M0321",
            Mistake::Flutes => "M0322",
            Mistake::Hand => "M0327",
            Mistake::Word => "M0343",
        });
        plane.into_iter().chain(mistake).collect()
    }

    /// A length in the program's units.
    fn length(&self, mm: f64) -> String {
        format!("{:.6}", if self.inch { mm / 25.4 } else { mm })
    }

    /// Its tools, if it is the part of this number, counted from 0.
    pub(super) fn tools(&self, part: u32) -> String {
        let (first, second) = (2 * part + 1, 2 * part + 2);
        let Size { name, diameter, pitch, drill } = self.size;
        let hand = if self.left { "-LH" } else { "" };
        let flutes = if self.has(Mistake::Flutes) { self.depth * 0.8 } else { self.depth + 5.0 };
        format!(
            "[[tool]]\nnumber = {first}\npocket = {first}\nkind = \"drill\"\ndescription = \"drill\"\n\
             diameter_mm = {drill:?}\npoint_angle_deg = 140.0\nlength_mm = 120.0\n\n\
             [[tool]]\nnumber = {second}\npocket = {second}\nkind = \"tap\"\ndescription = \"tap\"\n\
             diameter_mm = {diameter:?}\nlength_mm = 100.0\nthread = \"{name}{hand}\"\n\
             chamfer_pitches = 2.5\nthread_length_mm = {flutes:?}\nflute = \"spiral-flute\"\n\
             oversize_um = {:.1}\nholder = {}\n",
            25.0 + 15.0 * pitch,
            self.holder.text,
        )
    }

    /// Its blocks, if it is the part of this number; the program's end is not among them.
    pub(super) fn program(&self, part: u32) -> String {
        let (first, second) = (2 * part + 1, 2 * part + 2);
        let beside = BESIDE * f64::from(part);
        let mm = |value: f64| self.length(value);
        let units = if self.inch { "G20" } else { "G21" };
        let left = self.left != self.has(Mistake::Hand);
        let turn = if left { "M4" } else { "M3" };
        let clear = 3.0 * self.size.pitch;
        let drill_feed = 3000.0 * 0.015 * self.size.drill;
        let drilled = self.depth + self.size.drill * 0.3 + 2.0;
        let mut text = format!(
            "{units} G17 G40 G49 G80 G90 G94 G54\nT{first} M6\nG43 H{first}\nS3000 M3\nG0 X{} Y0 Z{}\n",
            mm(beside),
            mm(10.0)
        );
        for hole in 0..self.holes {
            let x = beside + 15.0 * f64::from(hole);
            text += &format!(
                "G98 G81 X{} Y0 Z{} R{} F{}\n",
                mm(x),
                mm(-drilled),
                mm(2.0),
                mm(drill_feed)
            );
        }
        text += &format!("G80\nT{second} M6\nG43 H{second}\nG0 X{} Y0 Z{}\n", mm(beside), mm(10.0));
        text += match self.code {
            "plain" | "G33.1" => "",
            _ => "M5\n",
        };
        let rpm = self.rpm;
        let lead = self.size.pitch * if self.has(Mistake::Lead) { 1.25 } else { 1.0 };
        for hole in 0..self.holes {
            let x = beside + 15.0 * f64::from(hole);
            if self.code == "G33.1" {
                let back = self.back.map_or(String::new(), |f| format!(" I{f}"));
                let (plane, to) = match self.plane {
                    Plane::G17 => ("Z", -self.depth),
                    Plane::G18 => ("Y", -self.depth),
                    Plane::G19 => ("X", x - self.depth),
                };
                text += &format!("S{rpm} {turn}\nG0 X{} Y0\nG0 Z{}\n", mm(x), mm(clear));
                text += &format!("G33.1 {plane}{} K{}{back}\n", mm(to), mm(lead));
            } else if hole == 0 {
                text += &self.first_hole(lead, left, turn, clear);
            } else {
                let along = if self.plane == Plane::G19 { "Y" } else { "X" };
                text += &format!("{along}{}\n", mm(x));
            }
        }
        text + "G80\n"
    }

    /// The block that begins the tapping cycle, and what goes before it.
    fn first_hole(&self, lead: f64, left: bool, turn: &str, clear: f64) -> String {
        let mm = |value: f64| self.length(value);
        let rpm = self.rpm;
        let (mode, feed) = match self.lead {
            Lead::PerMinute => ("G94", format!(" F{}", mm(lead * rpm))),
            Lead::OfTheTap if !self.has(Mistake::Lead) => ("G95", String::new()),
            Lead::PerRevolution | Lead::OfTheTap => ("G95", format!(" F{}", mm(lead))),
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
        let (out, with) = (word("J", self.back), word("I", self.acceleration));
        let words = [word("P", self.dwell), word("A", self.angle), out, with, peck].concat();
        let (plane, deep) = match self.plane {
            Plane::G17 => ("", "Z"),
            Plane::G18 => ("G18 ", "Y"),
            Plane::G19 => ("G19 ", "X"),
        };
        format!(
            "{plane}{mode}\n{start}\nG99 {cycle} {deep}{} R{}{words}{feed}\n",
            mm(-self.depth),
            mm(clear)
        )
    }
}
