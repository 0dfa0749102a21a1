//! Blocks as text: the one way to write each.
//!
//! ```text
//!   /2N10 o100 call [#1] [2]        /N10 G1 X[#1*2+1] F100 #2=5 (seen)
//! ```
//!
//! In the order block delete, N, O-word or words, settings, comments; no bracket that is not
//! needed; letters, functions and operators in upper case, names and O-words in lower case. Read
//! again, the text gives the same block (spans apart).

use crate::block::{Block, Comment, Label, Word};
use crate::expression::{Expr, ExprId, Operator, Parameter, Value};
use crate::fanuc::{Control, Grammar, Output, Piece};
use core::fmt::{Display, Formatter, Result};
use diag::Span;

impl Display for Block {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        Printed { block: self, source: &[], grammar: Grammar::Rs274 }.fmt(f)
    }
}

/// A block as text of a grammar. What of the source is no matter of spacing stays: the decimal
/// point of a whole number (where a number without one counts least increments), and the digits
/// that name a program or a tool.
pub(crate) struct Printed<'a> {
    pub(crate) block: &'a Block,
    /// The text that the block was read from; empty if it is not known.
    pub(crate) source: &'a [u8],
    /// By whose rules the text will be read: how strongly operators bind.
    pub(crate) grammar: Grammar,
}

impl Display for Printed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        self.write(f)
    }
}

impl Printed<'_> {
    /// What a stretch of the source says; nothing if the source is not known.
    fn written(&self, span: Span) -> &[u8] {
        self.source.get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    /// The digits of a whole number as the source has them, if they begin with a zero and name
    /// something.
    fn named_digits(&self, word: &Word) -> Option<&str> {
        let names = match word.letter {
            b'T' => true,
            b'P' => self.block.words.iter().any(calls_a_program),
            _ => false,
        };
        let text = self.written(word.span).get(1..)?.trim_ascii();
        let padded = text.len() > 1 && text[0] == b'0' && text.iter().all(u8::is_ascii_digit);
        core::str::from_utf8(text).ok().filter(|_| names && padded)
    }

    fn write(&self, f: &mut Formatter<'_>) -> Result {
        let pointed = |word: &Word| match word.value {
            Value::Number(number) if number.fract() == 0.0 => {
                self.written(word.span).contains(&b'.')
            }
            _ => false,
        };
        let mut gap = "";
        if let Some(level) = self.block.delete {
            f.write_str("/")?;
            if level != 1 {
                write!(f, "{level} ")?;
            }
        }
        if let Some(number) = self.block.number {
            write!(f, "N{number}")?;
            gap = " ";
        }
        if self.block.percent {
            write!(f, "{gap}%")?;
            gap = " ";
        }
        if let Some(o) = self.block.o {
            f.write_str(gap)?;
            self.write_o_word(f, o.label, o.keyword.text())?;
            gap = " ";
        }
        if let Some(control) = self.block.control {
            f.write_str(gap)?;
            self.write_control(f, control)?;
            gap = " ";
        }
        if let Some(output) = self.block.output {
            f.write_str(gap)?;
            self.write_output(f, output)?;
            gap = " ";
        }
        for word in &self.block.words {
            let comma = if word.letter.is_ascii_lowercase() { "," } else { "" };
            write!(f, "{gap}{comma}{}", word.letter.to_ascii_uppercase() as char)?;
            match self.named_digits(word) {
                Some(digits) => f.write_str(digits)?,
                None => self.write_atom(f, word.value)?,
            }
            if pointed(word) {
                f.write_str(".")?;
            }
            gap = " ";
        }
        if let Some(name) = self.block.called {
            write!(f, "{gap}<{}>", self.block.text(name))?;
            gap = " ";
        }
        for setting in &self.block.assignments {
            write!(f, "{gap}")?;
            self.write_parameter(f, setting.target)?;
            f.write_str("=")?;
            self.write_atom(f, setting.value)?;
            gap = " ";
        }
        for comment in &self.block.comments {
            f.write_str(gap)?;
            self.write_comment(f, comment)?;
            gap = " ";
        }
        Ok(())
    }

    fn write_o_word(&self, f: &mut Formatter<'_>, label: Label, keyword: &str) -> Result {
        match label {
            Label::Number(number) => write!(f, "o{number}")?,
            Label::Name(name) => write!(f, "o<{}>", self.block.text(name))?,
            Label::Computed(value @ Value::Number(_)) => {
                f.write_str("o")?;
                self.write_bracket(f, value)?;
            }
            Label::Computed(value @ Value::Expression(id)) => {
                f.write_str("o")?;
                match self.block.expr(id) {
                    Expr::Parameter(_) => self.write_atom(f, value)?,
                    _ => self.write_bracket(f, value)?,
                }
            }
        }
        if !keyword.is_empty() {
            write!(f, " {keyword}")?;
        }
        for argument in &self.block.arguments {
            f.write_str(" ")?;
            self.write_bracket(f, *argument)?;
        }
        Ok(())
    }

    fn write_control(&self, f: &mut Formatter<'_>, control: Control) -> Result {
        match control {
            Control::GoTo(to) => {
                f.write_str("GOTO")?;
                self.write_atom(f, to)
            }
            Control::IfGoTo { condition, to } => {
                f.write_str("IF")?;
                self.write_bracket(f, condition)?;
                f.write_str("GOTO")?;
                self.write_atom(f, to)
            }
            Control::IfThen(condition) => {
                f.write_str("IF")?;
                self.write_bracket(f, condition)?;
                f.write_str("THEN")
            }
            Control::While { condition, level } => {
                if let Some(condition) = condition {
                    f.write_str("WHILE")?;
                    self.write_bracket(f, condition)?;
                }
                write!(f, "DO{level}")
            }
            Control::End(level) => write!(f, "END{level}"),
        }
    }

    fn write_output(&self, f: &mut Formatter<'_>, output: Output) -> Result {
        match output {
            Output::Open => return f.write_str("POPEN"),
            Output::Close => return f.write_str("PCLOS"),
            Output::Decimal => f.write_str("DPRNT[")?,
            Output::Binary => f.write_str("BPRNT[")?,
        }
        for piece in &self.block.pieces {
            match *piece {
                Piece::Text(text) => f.write_str(&self.block.text(text).replace(' ', "*"))?,
                Piece::Value { value, whole, decimals } => {
                    self.write_atom(f, value)?;
                    if output == Output::Decimal || whole > 0 {
                        write!(f, "[{whole}{decimals}]")?;
                    } else {
                        write!(f, "[{decimals}]")?;
                    }
                }
            }
        }
        f.write_str("]")
    }

    fn write_comment(&self, f: &mut Formatter<'_>, comment: &Comment) -> Result {
        let (text, keyword) = (self.block.text(comment.text), comment.kind.keyword());
        if comment.semicolon {
            return write!(f, ";{keyword}{text}");
        }
        write!(f, "({keyword}{text})")
    }

    /// A value that needs no brackets around it where a word's number may stand.
    fn write_atom(&self, f: &mut Formatter<'_>, value: Value) -> Result {
        match value {
            Value::Number(number) => write!(f, "{number}"),
            Value::Expression(id) => match self.block.expr(id) {
                Expr::Binary { .. } => self.write_bracket(f, value),
                _ => self.write_expr(f, id),
            },
        }
    }

    fn write_bracket(&self, f: &mut Formatter<'_>, value: Value) -> Result {
        f.write_str("[")?;
        self.write_inside(f, value)?;
        f.write_str("]")
    }

    fn write_inside(&self, f: &mut Formatter<'_>, value: Value) -> Result {
        match value {
            Value::Number(number) => write!(f, "{number}"),
            Value::Expression(id) => self.write_expr(f, id),
        }
    }

    fn write_parameter(&self, f: &mut Formatter<'_>, parameter: Parameter) -> Result {
        match parameter {
            Parameter::Numbered(value) => {
                f.write_str("#")?;
                self.write_atom(f, value)
            }
            Parameter::Named(name) => write!(f, "#<{}>", self.block.text(name)),
        }
    }

    fn write_expr(&self, f: &mut Formatter<'_>, id: ExprId) -> Result {
        match self.block.expr(id) {
            Expr::Parameter(parameter) => self.write_parameter(f, parameter),
            // -5 would be read as a literal
            Expr::Negate(Value::Number(number)) if number.is_sign_positive() => {
                write!(f, "-[{number}]")
            }
            Expr::Negate(operand) => {
                f.write_str("-")?;
                self.write_atom(f, operand)
            }
            Expr::Binary { operator, left, right } => {
                let strength = self.grammar.strength(operator);
                self.write_side(f, left, strength)?;
                write_operator(f, operator)?;
                self.write_side(f, right, strength + 1)
            }
            Expr::Function { function, argument } => {
                f.write_str(function.text())?;
                self.write_bracket(f, argument)
            }
            Expr::Atan { y, x } => {
                f.write_str("ATAN")?;
                self.write_bracket(f, y)?;
                f.write_str("/")?;
                self.write_bracket(f, x)
            }
            Expr::Pow { base, exponent } => {
                f.write_str("POW[")?;
                self.write_inside(f, base)?;
                f.write_str(",")?;
                self.write_inside(f, exponent)?;
                f.write_str("]")
            }
            Expr::Exists(parameter) => {
                f.write_str("EXISTS[")?;
                self.write_parameter(f, parameter)?;
                f.write_str("]")
            }
        }
    }

    /// One side of an operator, in brackets if it binds more weakly than `strength`.
    fn write_side(&self, f: &mut Formatter<'_>, side: Value, strength: u8) -> Result {
        if let Value::Expression(id) = side
            && let Expr::Binary { operator, .. } = self.block.expr(id)
        {
            if self.grammar.strength(operator) >= strength {
                return self.write_expr(f, id);
            }
            return self.write_bracket(f, side);
        }
        self.write_atom(f, side)
    }
}

/// M98, M198, G65, G66: P is a program's number.
fn calls_a_program(word: &Word) -> bool {
    let codes: &[f64] = match word.letter {
        b'M' => &[98.0, 198.0],
        b'G' => &[65.0, 66.0, 66.1],
        _ => &[],
    };
    matches!(word.value, Value::Number(number) if codes.contains(&number))
}

fn write_operator(f: &mut Formatter<'_>, operator: Operator) -> Result {
    match operator {
        Operator::Power | Operator::Times | Operator::Divide | Operator::Plus | Operator::Minus => {
            f.write_str(operator.text())
        }
        _ => write!(f, " {} ", operator.text()),
    }
}
