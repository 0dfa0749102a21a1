//! The words that steer a Fanuc custom macro, and what else its tapes write differently.
//!
//! ```text
//!   line    = [ "/" [ level ] ] [ "N" number ] ( program | steer | { word | setting | comment } ) [ ";" ]
//!   program = ( "O" | ":" ) number
//!   steer   = "GOTO" value
//!           | "IF" "[" condition "]" ( "GOTO" value | "THEN" { setting | word } )
//!           | [ "WHILE" "[" condition "]" ] "DO" level   |   "END" level
//!           | "POPEN" | "PCLOS" | ( "DPRNT" | "BPRNT" ) "[" { text | variable "[" digits "]" } "]"
//! ```
//!
//! A semicolon ends a block, so that one line can hold several; I, J and K may stand several times
//! in a block (the arguments of G65); `AND` binds like a product, `OR` and `XOR` like a sum. `,C1.`
//! and `,R1.` are words of their own; `<NAME>` names a program, at the block's beginning or behind
//! M98 or G65. A function's name may be cut to its first letters, two at least; there is no `**`,
//! but `POW[2,3]`, and `ATAN[1,2]` is `ATAN[1]/[2]`.
//!
//! Source: Fanuc, operator's manual of series 30i/0i, "Custom macro" and "Program configuration".

use crate::block::{Keyword, OWord, Text};
use crate::expression::{Operator, Value};
use crate::line::{Line, Read};
use crate::problem::Problem;

/// Whose rules the text follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grammar {
    /// RS-274/NGC as LinuxCNC reads it.
    #[default]
    Rs274,
    /// The same as senders stream it to Grbl: lines for the sender and the controller itself among
    /// the blocks.
    Grbl,
    /// Fanuc's tapes and custom macros.
    Fanuc,
}

/// What a block does to the order of execution, in Fanuc's grammar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// `GOTO n`.
    GoTo(Value),
    /// `IF [condition] GOTO n`.
    IfGoTo {
        /// Above zero: go.
        condition: Value,
        /// The N word of the block to go to.
        to: Value,
    },
    /// `IF [condition] THEN …`: what else the block says is done only if it holds.
    IfThen(Value),
    /// `WHILE [condition] DO m`; without a condition for ever.
    While {
        /// Asked before each round.
        condition: Option<Value>,
        /// Which `END` belongs to it.
        level: u8,
    },
    /// `END m`.
    End(u8),
}

/// What is written to the control's external device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// `POPEN`.
    Open,
    /// `PCLOS`.
    Close,
    /// `DPRNT[…]`: text and decimal digits. What is written is
    /// [`Block::pieces`](crate::Block::pieces).
    Decimal,
    /// `BPRNT[…]`: text and the bytes of binary numbers.
    Binary,
}

/// A part of what DPRNT or BPRNT writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// These characters.
    Text(Text),
    /// A variable's value.
    Value {
        /// The variable.
        value: Value,
        /// Digits before the point; none is said to BPRNT.
        whole: u8,
        /// Digits behind the point.
        decimals: u8,
    },
}

impl Grammar {
    /// How strongly an operator binds.
    pub(crate) const fn strength(self, operator: Operator) -> u8 {
        match (self, operator) {
            (Self::Fanuc, Operator::And) => Operator::Times.strength(),
            (Self::Fanuc, Operator::Or | Operator::Xor) => Operator::Plus.strength(),
            _ => operator.strength(),
        }
    }

    /// Where the block at the beginning of `text` ends, and the next one begins if it is in the
    /// same line.
    pub(crate) fn end_of_block(self, text: &[u8]) -> Option<(usize, usize)> {
        if self != Self::Fanuc {
            return None;
        }
        let (mut inside, mut begun) = (false, false);
        let mark = text.iter().position(|byte| match byte {
            b'(' => {
                inside = true;
                false
            }
            b')' => {
                inside = false;
                false
            }
            b';' => !inside,
            // the end of the tape may stand behind the last block
            b'%' => begun && !inside,
            _ => {
                begun |= !(inside || byte.is_ascii_whitespace());
                false
            }
        })?;
        Some((mark, mark + usize::from(text[mark] == b';')))
    }
}

/// Whether what stands behind a semicolon is for people, and no block: two letters follow one
/// another, and they begin none of the words that stand for flow and output.
pub(crate) fn is_for_people(behind: &[u8]) -> bool {
    let mut letters = behind.iter().filter(|byte| !byte.is_ascii_whitespace());
    let [Some(first), Some(second)] = [letters.next(), letters.next()] else { return false };
    let both = [first.to_ascii_uppercase(), second.to_ascii_uppercase()];
    let is_flow = [b"IF", b"WH", b"GO", b"DO", b"EN", b"PO", b"PC", b"DP", b"BP", b"TH"];
    both.iter().all(u8::is_ascii_alphabetic) && !is_flow.contains(&&both)
}

impl Line<'_, '_> {
    /// A block of Fanuc's, after block delete and N.
    pub(crate) fn fanuc_block(&mut self) -> Read<()> {
        match self.peek() {
            b'O' | b':' | b'<' => {
                let from = self.start();
                if self.peek() != b'<' {
                    self.take();
                }
                let label = self.label()?;
                self.block.o =
                    Some(OWord { label, keyword: Keyword::Program, span: self.span(from) });
                return self.only_comments(Problem::EndAfterOWord);
            }
            b'%' => {
                self.take();
                self.block.percent = true;
                // the beginning of the tape up to the first end of a block is skipped, and so is
                // what follows its end
                let rest = self.text.get(self.at..).unwrap_or_default().trim_ascii();
                if !rest.is_empty() && !rest.starts_with(b"(") {
                    self.leave_out_rest(Problem::BehindPercent);
                    return Ok(());
                }
                return self.only_comments(Problem::PercentNotAlone);
            }
            // `[BILLET X50 Z100`: what a school's simulator is told
            b'[' => {
                self.leave_out_rest(Problem::ForTheSender);
                return Ok(());
            }
            b'G' | b'I' | b'W' | b'D' | b'E' => self.control()?,
            _ => {}
        }
        self.output()?;
        match self.block.control {
            _ if self.block.output.is_some() => self.only_comments(Problem::EndAfterControl),
            None | Some(Control::IfThen(_)) => self.items(),
            Some(_) => self.only_comments(Problem::EndAfterControl),
        }
    }

    /// A name in the place of the number of a program that is called.
    pub(crate) fn called(&mut self) -> Read<()> {
        let from = self.at;
        let name = self.name()?;
        if self.block.called.replace(name).is_some() {
            return self.fault_since(Problem::LetterTwice(b'<'), from);
        }
        Ok(())
    }

    /// `,C1.`, `,R1.` or `,A45.`: the comma comes next.
    pub(crate) fn comma_word(&mut self, seen: &mut u64) -> Read<()> {
        self.take();
        match self.peek() {
            letter @ (b'A' | b'C' | b'R') => self.word(letter.to_ascii_lowercase(), seen),
            _ => self.fault_here(Problem::CommaWord),
        }
    }

    fn output(&mut self) -> Read<()> {
        let output = if self.take_text("DPRNT[") {
            Output::Decimal
        } else if self.take_text("BPRNT[") {
            Output::Binary
        } else if self.take_text("POPEN") {
            Output::Open
        } else if self.take_text("PCLOS") {
            Output::Close
        } else {
            return Ok(());
        };
        self.block.output = Some(output);
        if matches!(output, Output::Decimal | Output::Binary) { self.pieces() } else { Ok(()) }
    }

    /// What is written, up to the `]`.
    fn pieces(&mut self) -> Read<()> {
        loop {
            let start = self.block.texts.len() as u32;
            loop {
                match self.peek() {
                    b'*' => self.block.texts.push(' '),
                    b'#' | b'[' | b']' | b'(' | b')' | b';' => break,
                    byte @ b'!'..=b'~' => self.block.texts.push(byte as char),
                    _ => return self.fault_here(Problem::OutputText),
                }
                self.take();
            }
            let end = self.block.texts.len() as u32;
            if end > start {
                self.block.pieces.push(Piece::Text(Text { start, end }));
            }
            match self.peek() {
                b']' => {
                    self.take();
                    return Ok(());
                }
                b'#' => self.variable_to_write()?,
                _ => return self.fault_here(Problem::OutputText),
            }
        }
    }

    /// `#1[53]`: five digits before the point and three behind it; BPRNT says only those behind it.
    fn variable_to_write(&mut self) -> Read<()> {
        let value = self.whole_value()?;
        if !self.take_if(b'[') {
            return self.fault_here(Problem::OutputText);
        }
        let mut digits = [0; 2];
        let mut count = 0;
        while let digit @ b'0'..=b'9' = self.peek() {
            if count == 2 {
                return self.fault_here(Problem::OutputText);
            }
            digits[count] = digit - b'0';
            count += 1;
            self.take();
        }
        if count == 0 || !self.take_if(b']') {
            return self.fault_here(Problem::OutputText);
        }
        let [whole, decimals] = if count == 2 { digits } else { [0, digits[0]] };
        self.block.pieces.push(Piece::Value { value, whole, decimals });
        Ok(())
    }

    fn control(&mut self) -> Read<()> {
        let control = if self.take_text("GOTO") || self.take_short_goto() {
            Control::GoTo(self.whole_value()?)
        } else if self.take_text("IF[") {
            let condition = self.condition()?;
            if self.take_word("GOTO") {
                Control::IfGoTo { condition, to: self.whole_value()? }
            } else if self.take_word("THEN") {
                Control::IfThen(condition)
            } else {
                return self.fault_here(Problem::ThenExpected);
            }
        } else if self.take_text("WHILE[") || self.take_text("WH[") {
            let condition = Some(self.condition()?);
            if !self.take_text("DO") {
                return self.fault_here(Problem::DoExpected);
            }
            Control::While { condition, level: self.level()? }
        } else if self.take_text("DO") {
            Control::While { condition: None, level: self.level()? }
        } else if self.take_word("END") {
            Control::End(self.level()?)
        } else {
            return Ok(());
        };
        self.block.control = Some(control);
        Ok(())
    }

    /// The rest of a condition whose `[` was taken with its keyword.
    fn condition(&mut self) -> Read<Value> {
        self.at -= 1;
        self.whole_value()
    }

    /// 1, 2 or 3.
    fn level(&mut self) -> Read<u8> {
        let from = self.start();
        if !self.peek().is_ascii_digit() {
            return self.fault_here(Problem::LevelExpected);
        }
        match self.number()? {
            level @ (1.0 | 2.0 | 3.0) => Ok(level as u8),
            _ => self.fault_since(Problem::LevelExpected, from),
        }
    }

    /// Takes a word of the macro language: its first two letters are enough.
    fn take_word(&mut self, word: &str) -> bool {
        self.take_text(word) || self.take_text(&word[..2])
    }

    /// `GO100`, where nothing but a number follows: `GO1 Z-5` is a G0 that was written with a
    /// letter.
    fn take_short_goto(&mut self) -> bool {
        let before = (self.at, self.end);
        let is_number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'#' | b' ' | b'\t');
        if self.take_text("GO") {
            let to = self.text[self.at..].split(|byte| matches!(byte, b'(' | b';')).next();
            if to.is_some_and(|to| to.iter().all(is_number) && !to.trim_ascii().is_empty()) {
                return true;
            }
        }
        (self.at, self.end) = before;
        false
    }

    /// Takes these bytes if they come next, blanks between them or not.
    fn take_text(&mut self, text: &str) -> bool {
        let before = (self.at, self.end);
        let taken = text.bytes().all(|byte| self.take_if(byte));
        if !taken {
            (self.at, self.end) = before;
        }
        taken
    }
}
