//! Expressions: what stands in brackets, as a tree without meaning.
//!
//! The language's operators, strongest first; equals associate to the left:
//!
//! ```text
//!   - +                 sign              -#1**2 is (-#1)**2
//!   **                  power             2**3**2 is 64
//!   * / MOD             product
//!   + -                 sum
//!   EQ NE GT GE LT LE   comparison: 1 or 0
//!   AND OR XOR          logic: 1 or 0
//! ```
//!
//! A plain number is a [`Value::Number`] wherever a value may stand, so that the common word
//! `X1.5` costs no node. Values of parameters and the arithmetic itself are the interpreter's.
//! Source: LinuxCNC 2.9 manual, "G-code overview", sections "Expressions" and "Functions".

use crate::block::Text;
use diag::Span;

/// A number, or where to find the expression for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A literal: finite.
    Number(f64),
    /// Something to be computed: [`Block::expr`](crate::Block::expr).
    Expression(ExprId),
}

/// The place of an expression in its block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExprId(pub(crate) u32);

/// Which parameter is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// `#5`, `##5`, `#[#1+2]`: the value is the parameter's number.
    Numbered(Value),
    /// `#<name>`, `#<_global>`, `#<_hal[pin]>`: in lower case and without blanks.
    Named(Text),
}

/// One step of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expr {
    /// A parameter's value.
    Parameter(Parameter),
    /// Minus what follows.
    Negate(Value),
    /// Two values and the operator between them.
    Binary {
        /// Which one.
        operator: Operator,
        /// Left of it.
        left: Value,
        /// Right of it.
        right: Value,
    },
    /// A function of one argument.
    Function {
        /// Which one.
        function: Function,
        /// Its argument.
        argument: Value,
    },
    /// `ATAN[y]/[x]`: the angle of the point (x, y), in degrees.
    Atan {
        /// First argument.
        y: Value,
        /// Second argument.
        x: Value,
    },
    /// `POW[base,exponent]` of Fanuc's grammar.
    Pow {
        /// First argument.
        base: Value,
        /// Second argument.
        exponent: Value,
    },
    /// `EXISTS[#<name>]`: 1 if the parameter is there, else 0.
    Exists(Parameter),
}

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `**`.
    Power,
    /// `*`.
    Times,
    /// `/`.
    Divide,
    /// `MOD`.
    Modulo,
    /// `+`.
    Plus,
    /// `-`.
    Minus,
    /// `EQ`.
    Equal,
    /// `NE`.
    NotEqual,
    /// `GT`.
    Greater,
    /// `GE`.
    GreaterOrEqual,
    /// `LT`.
    Less,
    /// `LE`.
    LessOrEqual,
    /// `AND`.
    And,
    /// `OR`.
    Or,
    /// `XOR`.
    Xor,
}

impl Operator {
    /// How strongly it binds: 5 for `**` down to 1 for `AND OR XOR`.
    #[must_use]
    pub const fn strength(self) -> u8 {
        match self {
            Self::Power => 5,
            Self::Times | Self::Divide | Self::Modulo => 4,
            Self::Plus | Self::Minus => 3,
            Self::Equal
            | Self::NotEqual
            | Self::Greater
            | Self::GreaterOrEqual
            | Self::Less
            | Self::LessOrEqual => 2,
            Self::And | Self::Or | Self::Xor => 1,
        }
    }

    /// As it is written.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Power => "**",
            Self::Times => "*",
            Self::Divide => "/",
            Self::Modulo => "MOD",
            Self::Plus => "+",
            Self::Minus => "-",
            Self::Equal => "EQ",
            Self::NotEqual => "NE",
            Self::Greater => "GT",
            Self::GreaterOrEqual => "GE",
            Self::Less => "LT",
            Self::LessOrEqual => "LE",
            Self::And => "AND",
            Self::Or => "OR",
            Self::Xor => "XOR",
        }
    }
}

/// A function of one argument; angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Absolute value.
    Abs,
    /// Inverse cosine.
    Acos,
    /// Inverse sine.
    Asin,
    /// Cosine.
    Cos,
    /// e to the power of the argument.
    Exp,
    /// Round down: `FIX[-2.8]` is -3.
    Fix,
    /// Round up: `FUP[-2.8]` is -2.
    Fup,
    /// Natural logarithm.
    Ln,
    /// To the nearest whole number, halves away from zero.
    Round,
    /// Sine.
    Sin,
    /// Square root.
    Sqrt,
    /// Tangent.
    Tan,
    /// Fanuc: inverse tangent of one argument, -90 to 90.
    Atan,
    /// Fanuc: from binary-coded decimal, 18 (0x12) to 12.
    Bin,
    /// Fanuc: to binary-coded decimal, 12 to 18 (0x12).
    Bcd,
}

impl Function {
    /// Every function with its name, in alphabetical order.
    pub const ALL: [(&'static str, Self); 12] = [
        ("ABS", Self::Abs),
        ("ACOS", Self::Acos),
        ("ASIN", Self::Asin),
        ("COS", Self::Cos),
        ("EXP", Self::Exp),
        ("FIX", Self::Fix),
        ("FUP", Self::Fup),
        ("LN", Self::Ln),
        ("ROUND", Self::Round),
        ("SIN", Self::Sin),
        ("SQRT", Self::Sqrt),
        ("TAN", Self::Tan),
    ];

    /// What Fanuc's grammar has besides, and its other names.
    pub const FANUC: [(&'static str, Self); 5] = [
        ("BIN", Self::Bin),
        ("BCD", Self::Bcd),
        ("SQR", Self::Sqrt),
        ("RND", Self::Round),
        ("ATAN", Self::Atan),
    ];

    /// As it is written.
    #[must_use]
    pub fn text(self) -> &'static str {
        Self::ALL.iter().chain(&Self::FANUC).find(|(_, f)| *f == self).map_or("", |(name, _)| name)
    }
}

/// An expression and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) expr: Expr,
    pub(crate) span: Span,
}
