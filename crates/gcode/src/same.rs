//! Whether two blocks say the same: everything but where it stands.

use crate::block::{Block, Label, Text};
use crate::expression::{Expr, Parameter, Value};
use crate::fanuc::{Control, Piece};

impl Block {
    /// Whether the two blocks say the same: words, settings, O-word, comments and arguments in
    /// the same order, with equal values and expressions. Spans are not compared.
    #[must_use]
    pub fn says_the_same(&self, other: &Self) -> bool {
        let to = Pair { a: self, b: other };
        (self.delete, self.percent, self.faulty) == (other.delete, other.percent, other.faulty)
            && self.number == other.number
            && to.o_word()
            && to.control()
            && self.output == other.output
            && self.called.map(|name| self.text(name)) == other.called.map(|name| other.text(name))
            && all(&self.pieces, &other.pieces, |a, b| to.piece(*a, *b))
            && all(&self.arguments, &other.arguments, |a, b| to.value(*a, *b))
            && all(&self.words, &other.words, |a, b| {
                a.letter == b.letter && to.value(a.value, b.value)
            })
            && all(&self.assignments, &other.assignments, |a, b| {
                to.parameter(a.target, b.target) && to.value(a.value, b.value)
            })
            && all(&self.comments, &other.comments, |a, b| {
                (a.kind, a.semicolon) == (b.kind, b.semicolon) && to.text(a.text, b.text)
            })
    }
}

fn all<T>(a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
}

struct Pair<'a> {
    a: &'a Block,
    b: &'a Block,
}

impl Pair<'_> {
    fn text(&self, a: Text, b: Text) -> bool {
        self.a.text(a) == self.b.text(b)
    }

    fn o_word(&self) -> bool {
        let (Some(a), Some(b)) = (self.a.o, self.b.o) else {
            return self.a.o.is_none() && self.b.o.is_none();
        };
        let label = match (a.label, b.label) {
            (Label::Name(a), Label::Name(b)) => self.text(a, b),
            (Label::Computed(a), Label::Computed(b)) => self.value(a, b),
            (a, b) => a == b,
        };
        label && a.keyword == b.keyword
    }

    fn control(&self) -> bool {
        let parts = |control: Option<Control>| match control {
            None => (0, None, None),
            Some(Control::GoTo(to)) => (1, None, Some(to)),
            Some(Control::IfGoTo { condition, to }) => (2, Some(condition), Some(to)),
            Some(Control::IfThen(condition)) => (3, Some(condition), None),
            Some(Control::While { condition, level }) => (10 + level, condition, None),
            Some(Control::End(level)) => (20 + level, None, None),
        };
        let (a, b) = (parts(self.a.control), parts(self.b.control));
        let same = |a: Option<Value>, b: Option<Value>| match (a, b) {
            (Some(a), Some(b)) => self.value(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        a.0 == b.0 && same(a.1, b.1) && same(a.2, b.2)
    }

    fn piece(&self, a: Piece, b: Piece) -> bool {
        match (a, b) {
            (Piece::Text(a), Piece::Text(b)) => self.text(a, b),
            (
                Piece::Value { value, whole, decimals },
                Piece::Value { value: v, whole: w, decimals: d },
            ) => self.value(value, v) && (whole, decimals) == (w, d),
            _ => false,
        }
    }

    fn value(&self, a: Value, b: Value) -> bool {
        match (a, b) {
            (Value::Number(a), Value::Number(b)) => a.to_bits() == b.to_bits(),
            (Value::Expression(a), Value::Expression(b)) => {
                self.expr(self.a.expr(a), self.b.expr(b))
            }
            _ => false,
        }
    }

    fn parameter(&self, a: Parameter, b: Parameter) -> bool {
        match (a, b) {
            (Parameter::Numbered(a), Parameter::Numbered(b)) => self.value(a, b),
            (Parameter::Named(a), Parameter::Named(b)) => self.text(a, b),
            _ => false,
        }
    }

    fn expr(&self, a: Expr, b: Expr) -> bool {
        match (a, b) {
            (Expr::Parameter(a), Expr::Parameter(b)) | (Expr::Exists(a), Expr::Exists(b)) => {
                self.parameter(a, b)
            }
            (Expr::Negate(a), Expr::Negate(b)) => self.value(a, b),
            (
                Expr::Binary { operator, left, right },
                Expr::Binary { operator: o, left: l, right: r },
            ) => operator == o && self.value(left, l) && self.value(right, r),
            (
                Expr::Function { function, argument },
                Expr::Function { function: f, argument: a },
            ) => function == f && self.value(argument, a),
            (Expr::Pow { base, exponent }, Expr::Pow { base: b, exponent: e }) => {
                self.value(base, b) && self.value(exponent, e)
            }
            (Expr::Atan { y, x }, Expr::Atan { y: v, x: u }) => {
                self.value(y, v) && self.value(x, u)
            }
            _ => false,
        }
    }
}
