//! The same program in millimetres and in inches: the same is found, in the program's own unit, and
//! what is advised works.
use diag::Diagnostic;
use leadscrew::Program;
use test_support::size;

/// A program in one of the units.
#[derive(Clone, Copy)]
struct Unit {
    inch: bool,
}

impl Unit {
    /// A length or a feed, as the program writes it.
    fn l(self, mm: f64) -> String {
        let value = if self.inch { mm / 25.4 } else { mm };
        let text = format!("{value:.6}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }

    fn head(self) -> &'static str {
        if self.inch { "G20 G90 G94 G54" } else { "G21 G90 G94 G54" }
    }
}

/// A number between two, by a generator that is the same each time.
struct Random(u64);

impl Random {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        ((from + (to - from) * share) * 100.0).round() / 100.0
    }
}

/// A program with one fault, in a unit.
type Faulty = fn(Unit, [f64; 3]) -> String;

/// Each with the code that is found, and whether advice stands in its sentence.
const FAULTS: [(&str, Faulty); 9] = [
    ("M0301", |u, [a, ..]| {
        format!("{}\nG0 Z{}\nG0 X{}\nM2\n", u.head(), u.l(50.0), u.l(300.0 + a))
    }),
    ("M0301", |u, [a, ..]| {
        format!(
            "{}\nG0 Z{}\nG0 X0 Y0\nG1 Y{} F{}\nM2\n",
            u.head(),
            u.l(50.0),
            u.l(-400.0 - a),
            u.l(900.0)
        )
    }),
    ("M0308", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS{} M3\nG0 X0 Y0 Z{}\nM2\n",
            u.head(),
            30_000 + a as u32,
            u.l(50.0)
        )
    }),
    ("M0360", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z{}\nG0 Z{}\nG0 Z{}\nM2\n",
            u.head(),
            u.l(20.0),
            u.l(-2.0 - a / 20.0),
            u.l(20.0)
        )
    }),
    ("M0363", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z{}\nG81 X{} Y{} Z{} R{} F{}\nG80\nM2\n",
            u.head(),
            u.l(20.0),
            u.l(10.0),
            u.l(10.0),
            u.l(-8.0),
            u.l(2.0),
            u.l(2500.0 + 10.0 * a)
        )
    }),
    ("M0326", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z{}\nG81 X{} Y{} Z{} R{} F{}\nG80\nT3 M6\nG43 H3\nS1000 M3\nG0 X{} Y{} Z{}\nG84 X{} Y{} Z{} R{} F{}\nG80\nM2\n",
            u.head(),
            u.l(20.0),
            u.l(10.0),
            u.l(10.0),
            u.l(-20.0),
            u.l(2.0),
            u.l(300.0),
            u.l(10.0),
            u.l(10.0),
            u.l(20.0),
            u.l(10.0),
            u.l(10.0),
            u.l(-10.0),
            u.l(5.0),
            u.l(1100.0 + a)
        )
    }),
    ("M0323", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z{}\nG81 X{} Y{} Z{} R{} F{}\nG80\nT3 M6\nG43 H3\nS1000 M3\nG0 X{} Y{} Z{}\nG84 X{} Y{} Z{} R{} F{}\nG80\nM2\n",
            u.head(),
            u.l(20.0),
            u.l(10.0),
            u.l(10.0),
            u.l(-12.0),
            u.l(2.0),
            u.l(300.0),
            u.l(10.0),
            u.l(10.0),
            u.l(20.0),
            u.l(10.0),
            u.l(10.0),
            u.l(-13.0 - a / 50.0),
            u.l(5.0),
            u.l(1000.0)
        )
    }),
    ("M0361", |u, [a, ..]| {
        format!(
            "{}\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z{}\nG1 Z{} F{}\nG1 X{} F{}\nG0 Z{}\nM2\n",
            u.head(),
            u.l(5.0),
            u.l(-1.0),
            u.l(200.0),
            u.l(5.0 + a / 5.0),
            u.l(200.0),
            u.l(20.0)
        )
    }),
    ("M0304", |u, [a, ..]| {
        format!(
            "{}\nG0 X0 Y0 Z{}\nG1 X{} F{}\nM2\n",
            u.head(),
            u.l(50.0),
            u.l(60.0),
            u.l(90_000.0 + 10.0 * a)
        )
    }),
];

fn found(text: &str) -> Vec<Diagnostic> {
    Program::of("part.ngc", text).on("tapping-center").unwrap().check().to_vec()
}

/// The numbers of a sentence that stand for themselves.
fn numbers(text: &str) -> Vec<f64> {
    let mut all = Vec::new();
    let mut word = String::new();
    for c in text.chars().chain([' ']) {
        if c.is_ascii_digit() || matches!(c, '.' | '-') {
            word.push(c);
        } else {
            all.extend(word.trim_end_matches('.').parse::<f64>().ok());
            word.clear();
        }
    }
    all
}

/// A number in inches is the one in millimetres: a count, a speed of the spindle, or converted.
fn is_same(mm: f64, inch: f64) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= 0.006_f64.max(2e-3 * a.abs());
    mm == inch || close(mm, 25.4 * inch) || close(mm, inch)
        // the distance that is advised to keep is a round one in either unit
        || (mm - 25.4 * inch).abs() < 1.1
}

/// The word that is advised: a letter with the number that works.
fn advised(message: &str) -> Option<(char, String)> {
    let (before, _) = message
        .rsplit_once(" works")
        .or_else(|| message.rsplit_once(" is the nearest that works"))
        .or_else(|| message.rsplit_once(" is the deepest that works"))?;
    let before = ["is the nearest that", "is the deepest that", "or higher", "or more"]
        .iter()
        .fold(before, |text, tail| text.trim_end().strip_suffix(tail).unwrap_or(text).trim_end());
    let word = before.rsplit([' ', ':']).next()?;
    let letter = word.chars().next().filter(|c| "XYZFS".contains(*c))?;
    word[1..].parse::<f64>().ok()?;
    Some((letter, word[1..].to_owned()))
}

/// The line with this letter's number replaced.
fn followed(text: &str, line: u32, letter: char, number: &str) -> String {
    let change = |row: &str| -> String {
        let words = row.split(' ').map(|word| {
            let is_it = word.starts_with(letter) && word[1..].parse::<f64>().is_ok();
            if is_it { format!("{letter}{number}") } else { word.to_owned() }
        });
        words.collect::<Vec<_>>().join(" ")
    };
    let rows = text
        .lines()
        .zip(1..)
        .map(|(row, at)| if at == line { change(row) } else { row.to_owned() });
    rows.collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn the_same_is_found_in_either_unit_and_what_is_advised_works() {
    let mut random = Random(7);
    for round in 0..size::of(3, 60) {
        for (code, make) in FAULTS {
            let by = [random.between(1.0, 50.0), 0.0, 0.0];
            let texts = [false, true].map(|inch| make(Unit { inch }, by));
            let [mm, inch] = texts.each_ref().map(|text| found(text));
            let codes = |all: &[Diagnostic]| -> Vec<_> {
                all.iter().map(|finding| (finding.code, finding.span.line)).collect()
            };
            assert_eq!(codes(&mm), codes(&inch), "{round} {texts:?}\n{mm:?}\n{inch:?}");
            assert!(mm.iter().any(|finding| finding.code == code), "{code}: {mm:?}\n{}", texts[0]);
            for (mm, inch) in mm.iter().zip(&inch).filter(|(mm, _)| mm.code.starts_with('M')) {
                let is_foreign = inch.message.contains(" mm");
                assert!(!is_foreign, "{code}: {}", inch.message);
                let [a, b] = [mm, inch].map(|finding| numbers(&finding.message));
                let are_same = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| is_same(*a, *b));
                assert!(are_same, "{code}:\n{}\n{}", mm.message, inch.message);
            }
            for (text, all) in texts.iter().zip([&mm, &inch]) {
                for finding in all.iter().filter(|finding| finding.code == code) {
                    let Some((letter, number)) = advised(&finding.message) else { continue };
                    let followed = followed(text, finding.span.line, letter, &number);
                    let again = found(&followed);
                    let is_said =
                        again.iter().any(|f| f.code == code && f.span.line == finding.span.line);
                    assert!(!is_said, "{code}: {}\n{followed}{again:?}", finding.message);
                }
            }
        }
    }
}
