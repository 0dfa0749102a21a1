//! What each code means, for people and for programs that show it: `leadscrew codes`, the editor's
//! hover.
//!
//! Nothing is told here that the interpreter does not use itself: a [`CodeInfo`] is a view of a row
//! of the tables by which words are read, checked and executed.
use crate::{
    codes::{self, Code, GGroup, Letters, MGroup},
    dialect::{Dialect, rules::Meaning},
};

/// One G or M code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodeInfo {
    /// As it is written: `G33.1`, `M3`; `M100–M199` for the user's.
    pub code: String,
    /// What it does, in a few words.
    pub name: &'static str,
    /// Codes of one group exclude each other in a block; those of a modal group stay in force.
    pub group: &'static str,
    /// Whether it stays in force after its block.
    pub modal: bool,
    /// Letters it takes beside F, S and T, such as `XYZRQ`.
    pub letters: String,
    /// Whether Leadscrew executes it; if not, a program with it is refused.
    pub executed: bool,
    /// The dialects that have it.
    pub dialects: Vec<Dialect>,
}

/// All of them, G before M, by rising number.
pub fn codes() -> impl Iterator<Item = CodeInfo> {
    let g = codes::G_CODES.iter().map(of_g);
    g.chain(codes::M_CODES.iter().map(of_m))
}

/// The code that a word means: `describe(b'G', 33.1)`.
pub fn describe(letter: u8, value: f64) -> Option<CodeInfo> {
    let tenths = crate::codes::number::tenths(value)?;
    match letter {
        b'G' => codes::g_code(tenths).map(of_g),
        b'M' => codes::m_code(tenths).map(of_m),
        _ => None,
    }
}

fn of_g(code: &'static Code<GGroup>) -> CodeInfo {
    let (group, modal) = match code.group {
        GGroup::NonModal => ("not modal", false),
        GGroup::Motion => ("motion", true),
        GGroup::Plane => ("plane", true),
        GGroup::Distance => ("distance mode", true),
        GGroup::ArcDistance => ("arc distance mode", true),
        GGroup::FeedMode => ("feed mode", true),
        GGroup::Units => ("units", true),
        GGroup::Compensation => ("cutter compensation", true),
        GGroup::ToolLength => ("tool length offset", true),
        GGroup::Retract => ("retract level", true),
        GGroup::WorkOffset => ("work offset", true),
        GGroup::PathControl => ("path control", true),
        GGroup::SpindleMode => ("spindle mode", true),
        GGroup::Diameter => ("lathe diameter mode", true),
        GGroup::Cam => ("cam grinding", false),
    };
    info('G', code, group, modal)
}

fn of_m(code: &'static Code<MGroup>) -> CodeInfo {
    let (group, modal) = match code.group {
        MGroup::Stop => ("stop", false),
        MGroup::Outputs => ("outputs", false),
        MGroup::Tool => ("tool", false),
        MGroup::Spindle => ("spindle", true),
        MGroup::Coolant => ("coolant", true),
        MGroup::Overrides => ("overrides", true),
        MGroup::State => ("saved state", false),
        MGroup::Rigid => ("rigid tapping", false),
        MGroup::User => ("user", false),
    };
    info('M', code, group, modal)
}

fn info<G>(letter: char, code: &Code<G>, group: &'static str, modal: bool) -> CodeInfo {
    let written = match (letter, code.tenths) {
        ('M', 1000) => "M100–M199".to_owned(),
        (_, tenths) => format!("{letter}{}", crate::codes::spelling::written(tenths)),
    };
    let letters = if code.supported { letters_of(code.letters) } else { String::new() };
    CodeInfo {
        code: written,
        name: code.name,
        group,
        modal,
        letters,
        executed: code.supported,
        dialects: dialects_of(letter, code.tenths),
    }
}

/// The dialects in which a code means what it means in the shared language.
fn dialects_of(letter: char, tenths: u16) -> Vec<Dialect> {
    let shares = |dialect: &Dialect| dialect.rules().shares(letter as u8, tenths);
    Dialect::ALL.into_iter().filter(shares).collect()
}

/// The code that a word means in a dialect.
pub fn describe_in(dialect: Dialect, letter: u8, value: f64) -> Option<CodeInfo> {
    let rules = dialect.rules();
    if letter == b'G'
        && let Some(own) = rules.own(value)
        && let Some(code) = codes::g_code(own.code)
    {
        let letters = letters_of(code.letters | own.beside);
        let written = format!("G{value}");
        return Some(CodeInfo { code: written, letters, dialects: vec![dialect], ..of_g(code) });
    }
    let Some(front_end) = rules.codes else { return describe(letter, value) };
    let tenths = crate::codes::number::tenths(value)?;
    let code = format!("{}{}", letter as char, crate::codes::spelling::written(tenths));
    match front_end.meaning(letter, tenths)? {
        Meaning::Shared(shared) if letter == b'G' => {
            codes::g_code(shared).map(|shared| CodeInfo { code, ..of_g(shared) })
        }
        Meaning::Shared(_) => describe(letter, value),
        Meaning::Own { name, group, modal, letters, executed } => {
            let (letters, dialects) = (letters.to_owned(), vec![dialect]);
            Some(CodeInfo { code, name, group, modal, letters, executed, dialects })
        }
    }
}

/// What dialects have beside the shared codes, or with another meaning, dialect by dialect.
pub fn dialect_codes() -> impl Iterator<Item = CodeInfo> {
    let with = |front_end: bool| {
        let same = move |dialect: &Dialect| dialect.rules().codes.is_some() == front_end;
        Dialect::ALL.into_iter().filter(same)
    };
    with(true).chain(with(false)).flat_map(|dialect| {
        let described = move |tenths| describe_in(dialect, b'G', f64::from(tenths) / 10.0);
        let own = move |info: &CodeInfo| {
            let shared = codes().find(|code| code.code == info.code);
            shared.is_none_or(|shared| shared.name != info.name)
        };
        let variant_of = dialect.variant_of();
        let last = if variant_of.is_some() { 2700 } else { 1000 };
        let of_calls = move |number| {
            let code = describe_in(dialect, b'M', number);
            code.filter(|code| code.code == format!("M{number}"))
        };
        let differs = move |(letter, value): (u8, f64), info: &CodeInfo| {
            let before = variant_of.and_then(|base| describe_in(base, letter, value));
            before.is_none_or(|before| before.name != info.name)
        };
        let g = (0..=last).filter_map(move |tenths: u16| {
            described(tenths).filter(|info| differs((b'G', f64::from(tenths) / 10.0), info))
        });
        let m = [97.0, 198.0].into_iter().filter_map(move |number| {
            of_calls(number).filter(|info| differs((b'M', number), info))
        });
        g.chain(m).filter(own).map(move |info| CodeInfo { dialects: vec![dialect], ..info })
    })
}

/// A set of letters in the order in which people write them.
fn letters_of(set: Letters) -> String {
    const ORDER: &[u8] = b"XYZABCUVW@^IJKRPQLDEHFST$";
    let has = |letter: &&u8| set & (1 << codes::index(**letter)) != 0;
    ORDER.iter().filter(has).map(|letter| *letter as char).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_described_by_its_word() {
        let tap = describe(b'G', 33.1).map(|c| (c.code, c.name, c.modal, c.executed));
        assert_eq!(tap, Some(("G33.1".to_owned(), "rigid tapping", true, true)));
        assert_eq!(describe(b'G', 12.0), None);
        assert_eq!(describe(b'M', 150.0).map(|c| c.code), Some("M100–M199".to_owned()));
    }

    #[test]
    fn a_code_means_something_else_on_a_lathe() {
        let name = |dialect, value| describe_in(dialect, b'G', value).map(|code| code.name);
        assert_eq!(name(Dialect::LinuxCnc, 90.0), Some("absolute"));
        assert_eq!(name(Dialect::Fanuc, 90.0), Some("absolute"));
        assert_eq!(name(Dialect::FanucLatheA, 90.0), Some("turning cycle"));
        assert_eq!(name(Dialect::FanucLatheC, 20.0), Some("turning cycle"));
        assert_eq!(name(Dialect::FanucLatheC, 73.0), Some("roughing cycle along Z"));
        assert_eq!(name(Dialect::FanucLatheB, 92.0), name(Dialect::LinuxCnc, 92.0));
        assert_eq!(name(Dialect::FanucLatheB, 71.0), Some("roughing cycle along Z"));
        assert_eq!(name(Dialect::Fanuc, 333.0), None);
        let of = |value| describe(b'G', value).map(|code| code.dialects.len());
        assert_eq!((of(0.0), of(33.1)), (Some(11), Some(4)));
        let own = |dialect, code: &str| {
            dialect_codes().any(|info| info.dialects == [dialect] && info.code == code)
        };
        assert!(own(Dialect::FanucLatheA, "G90") && !own(Dialect::Fanuc, "G90"));
        assert!(
            own(Dialect::Toyoda, "G51")
                && name(Dialect::Toyoda, 51.0) == name(Dialect::LinuxCnc, 151.0)
        );
        assert!(dialect_codes().all(|info| !info.name.is_empty()));
        assert!(dialect_codes().all(|info| info.code != "G81.1" && info.code != "G80.1"));
    }

    #[test]
    fn every_code_has_a_name_and_appears_once() {
        let all: Vec<_> = codes().collect();
        assert!(all.len() > 100);
        assert!(all.iter().all(|c| !c.name.is_empty()));
        let mut names: Vec<_> = all.iter().map(|c| &c.code).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all.len());
    }
}
