//! The words of one block as numbers: each letter once, each modal group once.
//!
//! ```text
//!   names   parameters: numbered, named, and those that the interpreter answers itself
//!   eval    expressions to numbers
//! ```
pub(crate) mod eval;
pub(crate) mod names;

use crate::{
    call::Place,
    codes::{
        self, AXES, CENTRE, Code, FREE, G_GROUPS, GGroup, Letters, M_GROUPS, MGroup, POLAR, number,
    },
    dialect::rules::Rules,
    fault::{Outcome, error},
    setup::Setup,
    words::eval::Values,
};
use diag::Span;

/// No code of the group in this block.
const NONE: u16 = u16::MAX;

/// The words of the block at hand; filled again for each block.
#[allow(clippy::struct_excessive_bools)] // facts of their own
#[derive(Clone)]
pub(crate) struct Words {
    /// The block.
    pub(crate) place: Place,
    present: Letters,
    value: [f64; 29],
    at: [Span; 29],
    g: [u16; G_GROUPS],
    m: [u16; M_GROUPS],
    /// G80 beside another code of the motion group.
    pub(crate) cycle_off: bool,
    any_code: bool,
    /// A code of another group than that of the motions.
    any_mode: bool,
    /// What the block's codes take.
    letters: Letters,
    rules: &'static Rules,
    /// M codes of the machine's own.
    own: OwnCodes,
    /// Letters of words that could not be understood.
    pub(crate) unread: Letters,
    /// Its ways are written by letters of their own: Fanuc's U, V and W.
    pub(crate) by_increments: bool,
    /// So much the step to the next hole of a cycle turns, hole by hole, degrees.
    pub(crate) step_turns_deg: f64,
    /// G50 of a dialect that knows no scaling.
    pub(crate) ends_scaling: Option<Span>,
    /// A code that another one of its group comes after, that one, and where it stands.
    pub(crate) outdone: Option<(u16, u16, Span)>,
    /// How far the block was executed.
    pub(crate) stage: Stage,
}

impl Words {
    pub(crate) fn new(rules: &'static Rules, own: OwnCodes) -> Self {
        Self {
            place: Place::default(),
            present: 0,
            value: [0.0; 29],
            at: [Span::default(); 29],
            g: [NONE; G_GROUPS],
            m: [NONE; M_GROUPS],
            cycle_off: false,
            any_code: false,
            any_mode: false,
            letters: 0,
            rules,
            own,
            unread: 0,
            by_increments: false,
            step_turns_deg: 0.0,
            ends_scaling: None,
            outdone: None,
            stage: Stage::Words,
        }
    }

    /// Empty, for this block.
    #[inline]
    pub(crate) fn begin(&mut self, block: &gcode::Block) {
        self.place = Place { span: block.span, number: block.number.map(|n| n as u32) };
        (self.present, self.unread, self.stage) = (0, 0, Stage::Words);
        (self.cycle_off, self.by_increments) = (false, false);
        self.step_turns_deg = 0.0;
        (self.ends_scaling, self.outdone) = (None, None);
        if self.any_code {
            self.g = [NONE; G_GROUPS];
            self.m = [NONE; M_GROUPS];
            (self.any_code, self.any_mode) = (false, false);
            self.letters = 0;
        }
    }

    /// Fill from a block, evaluating what is not a plain number.
    pub(crate) fn read(&mut self, block: &gcode::Block, values: &Values) -> Outcome {
        self.begin(block);
        let mut first = Ok(());
        for word in &block.words {
            if let Err(fault) = self.take_word(block, word, values) {
                // the others are understood all the same: what follows must not suffer
                self.unread |= 1 << codes::index(word.letter);
                first = first.and(Err(fault));
            }
        }
        first
    }

    fn take_word(&mut self, block: &gcode::Block, word: &gcode::Word, values: &Values) -> Outcome {
        let value = match word.value {
            gcode::Value::Number(number) => number,
            gcode::Value::Expression(_) => values.evaluate(block, word.value, word.span)?,
        };
        match word.letter {
            b'G' => match self.rules.own_code(value) {
                Some(own) => self.take_code(own, word.span),
                None if self.rules.ends_scaling && value == 50.0 => {
                    self.ends_scaling = Some(word.span);
                    Ok(())
                }
                None => self.take_g(value, word.span),
            },
            b'M' => self.take_m(value, word.span),
            letter => self.put(letter, value, word.span),
        }
    }

    /// Add a word that is no code.
    #[inline]
    pub(crate) fn put(&mut self, letter: u8, value: f64, span: Span) -> Outcome {
        let i = codes::index(letter);
        if self.present & (1 << i) != 0 {
            return Err(self.twice(i, span).into());
        }
        self.present |= 1 << i;
        self.value[i] = value;
        self.at[i] = span;
        Ok(())
    }

    #[cold]
    fn twice(&self, i: usize, span: Span) -> diag::Diagnostic {
        let text = format!("{} occurs twice in one block", codes::letter(i));
        error("I0101", span, text).with_label(self.at[i], "first here")
    }

    /// Take a word away.
    pub(crate) fn take(&mut self, letter: u8) -> Option<f64> {
        let value = self.get(letter)?;
        self.present &= !(1 << codes::index(letter));
        Some(value)
    }

    /// Whether the block has this G code, in tenths.
    pub(crate) fn has_g(&self, tenths: u16) -> bool {
        self.g.contains(&tenths)
    }

    /// Add a G code of the shared table.
    pub(crate) fn take_g(&mut self, value: f64, span: Span) -> Outcome {
        let Some(code) = number::tenths(value).filter(|t| *t < codes::OWN).and_then(codes::g_code)
        else {
            if let Some((name, here)) = codes::spelling::of_others(value) {
                let text = format!("G{value} is {name}, and no code of {}", self.rules.people);
                return Err(error("I0102", span, text).with_help(here).into());
            }
            let text = format!("G{value} is no known code");
            return Err(guessed(
                error("I0102", span, text),
                crate::codes::spelling::similar_g(value),
            )
            .into());
        };
        self.take_code(code, span)
    }

    /// Add a G code.
    pub(crate) fn take_code(&mut self, code: &'static Code<GGroup>, span: Span) -> Outcome {
        let written = || crate::codes::spelling::written(code.tenths);
        if !code.supported {
            let text = format!("G{} ({}) is not executed by Leadscrew yet", written(), code.name);
            return Err(error("I0103", span, text).into());
        }
        self.any_code = true;
        self.any_mode |= code.group != GGroup::Motion;
        self.letters |= code.letters;
        let slot = &mut self.g[code.group as usize];
        if *slot == NONE {
            *slot = code.tenths;
            return Ok(());
        }
        // G80 beside G0 … G3 only says that no cycle is meant.
        let plain = |c: u16| c <= 30;
        if code.group == GGroup::Motion
            && (code.tenths == 800 && plain(*slot) || *slot == 800 && plain(code.tenths))
        {
            *slot = (*slot).min(code.tenths);
            self.cycle_off = true;
            return Ok(());
        }
        if self.rules.last_code_acts && code.group != GGroup::NonModal {
            self.outdone = Some((*slot, code.tenths, span));
            *slot = code.tenths;
            return Ok(());
        }
        let other = *slot;
        let other = crate::codes::spelling::written(other);
        let text = format!("G{} and G{other} exclude each other in one block", written());
        Err(error("I0104", span, text)
            .with_help("both set the same mode: write one of them, or two blocks")
            .into())
    }

    /// Add an M code of the shared table.
    pub(crate) fn take_m(&mut self, value: f64, span: Span) -> Outcome {
        let known = number::tenths(value).filter(|_| !self.own.replaces(value));
        let Some(code) = known.and_then(codes::m_code) else {
            if self.own.has(value) {
                return self.take_own_m(value, span);
            }
            let text = format!("M{value} is no known code");
            return Err(guessed(
                error("I0105", span, text),
                crate::codes::spelling::similar_m(value),
            )
            .into());
        };
        let written = || crate::codes::spelling::written(code.tenths);
        (self.any_code, self.any_mode) = (true, true);
        self.letters |= code.letters;
        let slot = &mut self.m[code.group as usize];
        if *slot != NONE {
            let other = *slot;
            let other = crate::codes::spelling::written(other);
            let text = format!("M{} and M{other} exclude each other in one block", written());
            return Err(error("I0107", span, text).with_help("write two blocks").into());
        }
        *slot = number::tenths(value).unwrap_or(code.tenths);
        Ok(())
    }

    /// Add an M code of the machine's own.
    pub(crate) fn take_own_m(&mut self, value: f64, span: Span) -> Outcome {
        (self.any_code, self.any_mode) = (true, true);
        self.letters |= codes::set("PQ");
        let slot = &mut self.m[MGroup::User as usize];
        if *slot != NONE {
            let other = crate::codes::spelling::written(*slot);
            let text = format!("M{value} and M{other} exclude each other in one block");
            return Err(error("I0107", span, text).with_help("write two blocks").into());
        }
        *slot = number::tenths(value).unwrap_or(NONE);
        Ok(())
    }

    /// Whether the machine knows an M code, or lets it pass, that is none of the language's.
    pub(crate) fn is_own_m(&self, value: f64) -> bool {
        self.own.has(value)
    }

    /// An M code of this group, in tenths, as if it stood in the block.
    pub(crate) fn put_m(&mut self, group: MGroup, tenths: u16) {
        (self.any_code, self.any_mode) = (true, true);
        self.m[group as usize] = tenths;
    }

    /// As if the block had no code of this group.
    pub(crate) fn forget_g(&mut self, group: GGroup) {
        self.g[group as usize] = NONE;
    }

    /// One code of a group in the place of another, and the other way round.
    pub(crate) fn exchange_g(&mut self, group: GGroup, one: u16, other: u16) {
        let slot = &mut self.g[group as usize];
        *slot = match *slot {
            code if code == one => other,
            code if code == other => one,
            code => code,
        };
    }

    /// The code of a group, in tenths.
    #[inline]
    pub(crate) fn g(&self, group: GGroup) -> Option<u16> {
        let code = self.g[group as usize];
        (code != NONE).then_some(code)
    }

    /// The code of a group, as written.
    #[inline]
    pub(crate) fn m(&self, group: MGroup) -> Option<u16> {
        let code = self.m[group as usize];
        (code != NONE).then_some(code / 10)
    }

    /// Whether there is any G or M code.
    #[inline]
    pub(crate) const fn has_codes(&self) -> bool {
        self.any_code
    }

    /// Whether there is any code besides that of the motion.
    #[inline]
    pub(crate) const fn has_modes(&self) -> bool {
        self.any_mode
    }

    /// Whether there is any M code.
    pub(crate) fn has_m(&self) -> bool {
        self.m.iter().any(|code| *code != NONE)
    }

    /// The number after a letter.
    #[inline]
    pub(crate) fn get(&self, letter: u8) -> Option<f64> {
        let i = codes::index(letter);
        (self.present & (1 << i) != 0).then(|| self.value[i])
    }

    /// The letters of its words that are no codes.
    pub(crate) const fn letters_present(&self) -> Letters {
        self.present
    }

    /// Where a letter's word is; the block if it is not there.
    pub(crate) fn span(&self, letter: u8) -> Span {
        let i = codes::index(letter);
        if self.present & (1 << i) != 0 { self.at[i] } else { self.place.span }
    }

    /// Whether any of these letters is there.
    #[inline]
    pub(crate) const fn any(&self, letters: Letters) -> bool {
        self.present & letters != 0
    }

    /// Whether the block has one G code, no M code, and no other letters than these.
    pub(crate) fn is_alone(&self, letters: Letters) -> bool {
        let codes = self.g.iter().chain(&self.m).filter(|code| **code != NONE).count();
        let free = codes::set("G") | letters;
        codes == 1 && self.present & !free == 0
    }

    /// The number after a letter as a whole number from 0 to `most`.
    pub(crate) fn whole(&self, letter: u8, most: u32) -> Outcome<Option<u32>> {
        let Some(value) = self.get(letter) else { return Ok(None) };
        match number::near_whole(value) {
            Some(number) if (0..=i64::from(most)).contains(&number) => Ok(Some(number as u32)),
            _ => {
                let text = format!(
                    "expected a whole number from 0 to {most} after {}, found {value}",
                    letter as char
                );
                Err(error("I0108", self.span(letter), text).into())
            }
        }
    }

    /// The dialect's conventions.
    pub(crate) const fn rules(&self) -> &'static Rules {
        self.rules
    }

    /// Take away, of these letters, the words that belong to no code: where they stood.
    pub(crate) fn drop_idle(&mut self, letters: Letters, modal: Letters) -> Option<(char, Span)> {
        let idle = self.strays(modal, 0) & letters;
        if idle == 0 {
            return None;
        }
        self.present &= !idle;
        let first = idle.trailing_zeros() as usize;
        Some((codes::letter(first), self.at[first]))
    }

    /// Every word must belong to a code: the block's own, or the modal motion (whose letters are
    /// given). `beside` are those that the dialect or the machine adds.
    pub(crate) fn check_letters(&self, modal: Letters, beside: Letters) -> Outcome {
        let stray = self.strays(modal, beside);
        if stray == 0 { Ok(()) } else { Err(self.stray(stray).into()) }
    }

    fn strays(&self, modal: Letters, beside: Letters) -> Letters {
        let mut allowed = FREE | beside | self.letters;
        if self.any(codes::set("S")) {
            allowed |= codes::set("$");
        }
        if self.any(AXES | CENTRE | POLAR) {
            allowed |= modal;
        }
        self.present & !allowed
    }

    fn stray(&self, stray: Letters) -> diag::Diagnostic {
        let i = stray.trailing_zeros() as usize;
        let letter = codes::letter(i);
        if let Some(code) = self.g(GGroup::Motion).and_then(codes::g_code)
            && (AXES | CENTRE) & (1 << i) != 0
        {
            let text = format!(
                "{letter} has no place in G{} ({})",
                crate::codes::spelling::written(code.tenths),
                code.name
            );
            return error("I0112", self.at[i], text);
        }
        if AXES & (1 << i) != 0 {
            let text = format!(
                "{letter} has no effect: no motion is in force and no code in this block takes it"
            );
            return error("I0109", self.at[i], text).with_help("write G0 or G1 before it");
        }
        let text = format!("{letter} has no effect here: {}", crate::codes::spelling::takers(i));
        let fault = error("I0110", self.at[i], text);
        match letter {
            'E' => {
                fault.with_help("if it is to be an exponent: write the number out, 2500 for 2.5E3")
            }
            _ => fault,
        }
    }
}

/// The M codes that a machine's file names, and whether others pass.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnCodes {
    named: Vec<u16>,
    others: bool,
}

impl OwnCodes {
    pub(crate) fn of(setup: &Setup) -> Self {
        let named = setup.user_codes.iter().map(|code| code.number).collect();
        Self { named, others: setup.leaves.unknown_codes }
    }

    /// Named, or one that nothing names and that may pass. What the machine's files may name, they
    /// name.
    fn has(&self, value: f64) -> bool {
        let whole = number::near_whole(value).and_then(|number| u16::try_from(number).ok());
        whole.is_some_and(|number| number < 1000 && (self.others || self.named.contains(&number)))
    }

    /// A code of the language that the machine's file gives another meaning.
    fn replaces(&self, value: f64) -> bool {
        !self.named.is_empty()
            && number::near_whole(value)
                .and_then(|number| u16::try_from(number).ok())
                .is_some_and(|number| number < 100 && self.named.contains(&number))
    }
}

/// A finding with what was perhaps meant.
fn guessed(fault: diag::Diagnostic, guess: String) -> diag::Diagnostic {
    if guess.is_empty() { fault } else { fault.with_help(guess) }
}

/// How far a block was executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// Its words, and whether they belong together.
    Words,
    /// F.
    Feed,
    /// S.
    Speed,
    /// T, M6, spindle, coolant, dwell.
    Tools,
    /// M29.
    Rigid,
    /// Plane, units, compensation, offsets, distances.
    Modes,
    /// G10, G28, G52, G92 and the like.
    NonModal,
    /// The move.
    Motion,
    /// All but stops and calls.
    Done,
}
