//! What differs from control to control in the shared language, as data.
//!
//! Each control's folder has one [`Rules`] for each of its dialects. What a control does not say of
//! its own is taken from [`SHARED`](crate::dialect::linuxcnc::RULES), RS-274/NGC as LinuxCNC reads
//! it.
use crate::codes::{Code, GGroup, Letters, g_code};
use crate::dialect::fanuc::kind::Kind;
use gcode::Grammar;

/// A dialect's differences.
#[allow(clippy::struct_excessive_bools)] // conventions that have nothing to do with one another
pub(crate) struct Rules {
    /// Its name on the command line and in machine files.
    pub(crate) name: &'static str,
    /// Whose programs these are, as a sentence says it.
    pub(crate) people: &'static str,
    /// What they are like, in a line for those who choose one.
    pub(crate) about: &'static str,
    /// What letters do beside codes, where that is not what they do in the language that it shares.
    pub(crate) roles: &'static [Role],
    /// How its text is read.
    pub(crate) grammar: Grammar,
    /// What decides which block comes next, and what its words mean in the shared language.
    pub(crate) front_end: FrontEndKind,
    /// What its codes are, where the front end knows other ones than the shared table.
    pub(crate) codes: Option<&'static (dyn FrontEndCodes + Sync)>,
    /// Its own G words of codes in the shared table.
    pub(crate) own_codes: &'static [OwnCode],
    /// Words that give it away.
    pub(crate) evidence: &'static [Family],
    /// Tool and offset are called in one number, T0101.
    pub(crate) turret: bool,
    /// Where its cycles measure Z from under G91, unless the machine says otherwise.
    pub(crate) depth_from: DepthFrom,
    /// G98 is in force where a program begins.
    pub(crate) starts_at_initial_level: bool,
    /// R and Z that a cycle keeps stay where they were meant, when G90 or G91 comes between.
    pub(crate) keeps_levels: bool,
    /// Letter that counts a cycle's repetitions.
    pub(crate) repeats: u8,
    /// No repetition at all is allowed: it makes no hole.
    pub(crate) no_repetition: bool,
    /// U and E throw chips off in cycles, whatever the machine has set.
    pub(crate) chip_removal: bool,
    /// P waits at the bottom in G81 too.
    pub(crate) drilling_waits: bool,
    /// A tap without P waits as long as the last cycle with P.
    pub(crate) taps_keep_dwell: bool,
    /// Tapping cycles turn the spindle by themselves where S is known.
    pub(crate) taps_turn_spindle: bool,
    /// G53 leads to a machine coordinate while G91 is in force, too.
    pub(crate) machine_place_in_increments: bool,
    /// Modes may be restated and ended in one block with G40, and the work offset in force may be
    /// called again.
    pub(crate) restates_modes: bool,
    /// Of two codes of one group in a block the last acts.
    pub(crate) last_code_acts: bool,
    /// How the tool comes beside the way.
    pub(crate) start_up: StartUp,
    /// An external work offset lies under all others.
    pub(crate) external_offset: bool,
    /// The lead of a straight thread is that of the axis that goes farthest, not that of the path.
    pub(crate) lead_along_axis: bool,
    /// G97 without S keeps the speed that the spindle has under G96 there, and G96 without S the
    /// surface speed of before.
    pub(crate) keeps_speed: bool,
    /// In cam mode G1 X grinds, and G4 sparks out.
    pub(crate) grinds_by_feed: bool,
    /// A program ends where its text does, whether M2 or M30 stands there or not.
    pub(crate) ends_with_text: bool,
    /// G0 is in force where a program begins.
    pub(crate) begins_rapidly: bool,
    /// M4 with S is a laser's power that follows the speed.
    pub(crate) has_laser: bool,
    /// S of G4 is a wait in seconds, where no P stands.
    pub(crate) dwells_by_s: bool,
    /// G50 ends a scaling, of which there is none.
    pub(crate) ends_scaling: bool,
    /// Arcs and G43.1 without an axis word are refused; block numbers have seven digits at most.
    pub(crate) needs_axis_words: bool,
    /// Codes, in tenths, that the controls of this dialect lack, and that are executed all the
    /// same.
    pub(crate) lacks: &'static [u16],
    /// Tools are changed by hand: T names the one that is clamped, and needs no M6.
    pub(crate) tools_by_hand: bool,
    /// Letters that may stand where no code takes them: they have no effect there.
    pub(crate) idle: Letters,
    /// R may be too short by so much to reach an arc's end, mm and inches.
    pub(crate) short_radius: [f64; 2],
    /// Reading a block stops at the first word that is not understood.
    pub(crate) reads_up_to_fault: bool,
}

/// What decides which block comes next, and what its words mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrontEndKind {
    /// O-words, and words that are those of the shared language.
    Rs274,
    /// Tapes, custom macros.
    Fanuc(Kind),
}

/// How the first move of a cutter radius compensation is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartUp {
    /// To beside its own end; it must be longer than the tool's radius.
    BesideEnd,
    /// To beside the beginning of the move that follows (Fanuc's type A).
    BesideNext,
}

/// Where a cycle's Z counts from under G91.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthFrom {
    /// The R plane.
    #[default]
    RPlane,
    /// The level where the axis stood before the cycle, like R.
    InitialLevel,
}

/// What a letter does beside some codes, for people.
#[derive(Clone, Copy)]
pub(crate) struct Role {
    /// The letter.
    pub(crate) letter: u8,
    /// The codes, as they are written.
    pub(crate) codes: &'static [&'static str],
    /// What it does, in a few words.
    pub(crate) what: &'static str,
}

/// A dialect's G word whose code is in the shared table.
pub(crate) struct OwnCode {
    /// The whole number after G.
    pub(crate) written: u16,
    /// The code, in tenths.
    pub(crate) code: u16,
    /// Letters it takes besides those of the table.
    pub(crate) beside: Letters,
}

/// Words of one origin, by which a program is recognised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    LinuxCnc,
    Grbl,
    /// G38.2 to G38.5, which several have.
    Probing,
    Brother,
    Toyoda,
    /// All of Fanuc's.
    Fanuc,
    FanucMill,
    FanucLathe,
    Haas,
    Mitsubishi,
}

/// What a front end's codes mean, for people.
pub(crate) trait FrontEndCodes {
    /// The meaning of a G or M word, in tenths; none if there is no such code.
    fn meaning(&self, letter: u8, tenths: u16) -> Option<Meaning>;
}

/// What a word means to a front end.
pub(crate) enum Meaning {
    /// This code of the shared table, in tenths.
    Shared(u16),
    /// Something of its own.
    Own {
        /// What it does, in a few words.
        name: &'static str,
        /// The codes that it excludes.
        group: &'static str,
        /// Whether it stays in force.
        modal: bool,
        /// Letters that it takes.
        letters: &'static str,
        /// Whether it is executed.
        executed: bool,
    },
}

impl Rules {
    /// The code of the shared table that a G word of the dialect's own means.
    #[inline]
    pub(crate) fn own_code(&self, value: f64) -> Option<&'static Code<GGroup>> {
        if self.own_codes.is_empty() {
            return None;
        }
        self.own(value).and_then(|own| g_code(own.code))
    }

    /// The same with the letters that it takes.
    pub(crate) fn own(&self, value: f64) -> Option<&'static OwnCode> {
        self.own_codes.iter().find(|own| f64::from(own.written) == value)
    }

    /// The whole number by which it writes a code of the shared table, in tenths.
    pub(crate) fn writes(&self, code: u16) -> u16 {
        let own = self.own_codes.iter().find(|own| own.code == code);
        own.map_or(code / 10, |own| own.written)
    }

    /// The same as a number, if the word is the dialect's own.
    pub(crate) fn writes_own(&self, code: u16) -> Option<f64> {
        let own = self.own_codes.iter().find(|own| own.code == code)?;
        Some(f64::from(own.written))
    }

    /// Whether a code, in tenths, means what it means in the shared language.
    pub(crate) fn shares(&self, letter: u8, tenths: u16) -> bool {
        if letter == b'G' && self.own(f64::from(tenths) / 10.0).is_some() {
            return false;
        }
        self.codes.is_none_or(|codes| {
            matches!(codes.meaning(letter, tenths), Some(Meaning::Shared(shared)) if shared == tenths)
        })
    }
}
