//! The controls whose programs can be read, and the one table that says what is whose.
//!
//! ```text
//!   Dialect ──rules()──► Rules     data: letters, codes, conventions of the shared language
//!                          └─ front_end      the reader of blocks: O-words, or tapes and macros
//! ```
//!
//! A dialect is a folder here with its [`Rules`], and a line in [`Dialect::rules`] and
//! [`Dialect::ALL`]. Nothing else in this crate asks which dialect is read: it asks for the rule.
pub(crate) mod brother;
pub(crate) mod fanuc;
pub(crate) mod grbl;
pub(crate) mod haas;
pub(crate) mod linuxcnc;
pub(crate) mod mitsubishi;
pub(crate) mod rules;
pub(crate) mod toyoda;

use gcode::Grammar;
pub use rules::DepthFrom;
use rules::Rules;

/// Whose words a program uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// RS-274/NGC as LinuxCNC 2.9 reads it, and M29 (rigid tapping follows) as Fanuc has it.
    #[default]
    LinuxCnc,
    /// The same core with the cycles of Brother's tapping centres: K counts repetitions, P waits at
    /// the bottom in G81 too, U and E throw chips off on the way; G98 at the start of a program.
    Brother,
    /// Fanuc's machining centres: custom macro B, least input increments, milliseconds.
    Fanuc,
    /// Haas' machining centres: Fanuc's language with pockets, local subprograms and work offsets
    /// of their own.
    Haas,
    /// Haas' lathes: Fanuc's system A with cycles and work offsets of their own.
    HaasLathe,
    /// Mitsubishi's machining centres: Fanuc's language with circles, variables and calls of their
    /// own.
    Mitsubishi,
    /// Fanuc's lathes, G code system A.
    FanucLatheA,
    /// Fanuc's lathes, G code system B.
    FanucLatheB,
    /// Fanuc's lathes, G code system C.
    FanucLatheC,
    /// Grbl 1.1, `grblHAL` and `FluidNC`: programs as hobby CAM and senders make them.
    Grbl,
    /// The same core with the cam grinding words of Toyoda's grinders: G50 to G53 and G55, and in
    /// cam mode G01 and G04.
    Toyoda,
}

impl Dialect {
    /// All of them, the shared language first.
    pub const ALL: [Self; 11] = [
        Self::LinuxCnc,
        Self::Grbl,
        Self::Brother,
        Self::Toyoda,
        Self::Fanuc,
        Self::Haas,
        Self::Mitsubishi,
        Self::HaasLathe,
        Self::FanucLatheA,
        Self::FanucLatheB,
        Self::FanucLatheC,
    ];

    /// Those that a program's words can tell apart, the rarer words first.
    pub(crate) const BY_RARITY: [Self; 9] = [
        Self::Brother,
        Self::Toyoda,
        Self::Fanuc,
        Self::Haas,
        Self::Mitsubishi,
        Self::FanucLatheA,
        Self::HaasLathe,
        Self::LinuxCnc,
        Self::Grbl,
    ];

    /// The dialect of which it is a variant: what its own tables do not say is that one's.
    pub(crate) const fn variant_of(self) -> Option<Self> {
        match self {
            Self::Haas | Self::Mitsubishi => Some(Self::Fanuc),
            Self::HaasLathe => Some(Self::FanucLatheA),
            _ => None,
        }
    }

    /// What it has of its own.
    pub(crate) const fn rules(self) -> &'static Rules {
        match self {
            Self::LinuxCnc => &linuxcnc::RULES,
            Self::Brother => &brother::RULES,
            Self::Grbl => &grbl::RULES,
            Self::Fanuc => &fanuc::MILL,
            Self::Haas => &haas::RULES,
            Self::HaasLathe => &haas::LATHE,
            Self::Mitsubishi => &mitsubishi::RULES,
            Self::FanucLatheA => &fanuc::LATHE_A,
            Self::FanucLatheB => &fanuc::LATHE_B,
            Self::FanucLatheC => &fanuc::LATHE_C,
            Self::Toyoda => &toyoda::RULES,
        }
    }

    /// Its name on the command line and in machine files.
    pub const fn name(self) -> &'static str {
        self.rules().name
    }

    /// The dialect with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dialect| dialect.name() == name)
    }

    /// Whose programs it reads, such as "Fanuc's machining centres".
    pub const fn people(self) -> &'static str {
        self.rules().people
    }

    /// What its programs are like, in a line for those who choose one.
    pub const fn about(self) -> &'static str {
        self.rules().about
    }

    /// What a letter does beside a code such as `G83`, where the dialect has a meaning of its own
    /// for it.
    pub fn role(self, letter: u8, code: &str) -> Option<&'static str> {
        let role = self
            .rules()
            .roles
            .iter()
            .find(|role| role.letter == letter && role.codes.contains(&code));
        role.map(|role| role.what)
    }

    /// How its text is read.
    pub const fn grammar(self) -> Grammar {
        self.rules().grammar
    }

    /// Whether tools are called by a turret's number, T0101: place 1 with offset 1.
    pub const fn has_turret(self) -> bool {
        self.rules().turret
    }

    /// Whether tools are clamped by hand, so that a program need not name any.
    pub const fn has_tools_by_hand(self) -> bool {
        self.rules().tools_by_hand
    }

    /// Where its cycles measure Z from under G91, unless the machine says otherwise.
    pub const fn depth_from(self) -> DepthFrom {
        self.rules().depth_from
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dialect_is_listed_once_and_has_a_name_of_its_own() {
        for (i, dialect) in Dialect::ALL.into_iter().enumerate() {
            let others = &Dialect::ALL[i + 1..];
            assert!(others.iter().all(|other| other.name() != dialect.name()), "{dialect:?}");
        }
        assert!(Dialect::BY_RARITY.iter().all(|dialect| Dialect::ALL.contains(dialect)));
    }

    #[test]
    fn words_of_a_dialects_own_have_a_code_in_the_shared_table() {
        for rules in Dialect::ALL.map(Dialect::rules) {
            for own in rules.own_codes {
                assert!(rules.own_code(f64::from(own.written)).is_some(), "{}", rules.name);
                assert_eq!(rules.writes(own.code), own.written, "{}", rules.name);
            }
        }
    }
}
