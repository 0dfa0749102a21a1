//! A block: what one line of a program says, as data.
//!
//! ```text
//!   /N10 o100 call [#1] [2]      G1 X[#1*2] F100   #2=5     (seen)
//!   └┬┘  └───────┬────────┘      └──────┬─────┘    └─┬┘     └─┬──┘
//!  delete,   o: OWord,              words      assignments  comments
//!  number    arguments
//! ```
//!
//! A block is filled again and again by [`Parser::next`](crate::Parser::next): its vectors keep
//! their memory, so that a program of a million lines costs no allocation per line. Everything
//! nested (expressions, names, texts) lies in the block's own arenas and is reached by index.

use crate::expression::{Expr, ExprId, Node, Parameter, Value};
use crate::fanuc::{Control, Output, Piece};
use diag::Span;

/// A stretch of text kept by the block: a name or a comment. Read it with [`Block::text`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Text {
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// A letter and its value: `X1.5`, `G33.1`, `F[#1*60]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// `A` to `Z` in upper case (never `N` or `O`), `@`, `^` or `$`; `c` and `r` for Fanuc's `,C`
    /// and `,R`.
    pub letter: u8,
    /// Its value: nearly always a plain number.
    pub value: Value,
    /// From the letter to the end of the value.
    pub span: Span,
}

/// A parameter setting: `#1=5`, `#<depth>=[#1+2]`. All settings of a block are evaluated after
/// its words are read, with the values from before the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assignment {
    /// Which parameter is set.
    pub target: Parameter,
    /// To what.
    pub value: Value,
    /// From the `#` to the end of the value.
    pub span: Span,
}

/// What a comment asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentKind {
    /// Nothing: words for people.
    Plain,
    /// `(MSG, text)`: show the text to the operator.
    Message,
    /// `(DEBUG, text)`: the same, with the values of `#...` in it.
    Debug,
    /// `(PRINT, text)`: write to standard output, with values.
    Print,
    /// `(LOG, text)`: write to the open log, with values.
    Log,
    /// `(LOGOPEN, file)`.
    LogOpen,
    /// `(LOGAPPEND, file)`.
    LogAppend,
    /// `(LOGCLOSE)`.
    LogClose,
    /// `(PROBEOPEN file)`.
    ProbeOpen,
    /// `(PROBECLOSE)`.
    ProbeClose,
    /// `(ABORT, text)`: end the program with this message.
    Abort,
    /// `(PY, statement)` or `;py,statement`: Python, which Leadscrew does not run.
    Python,
}

/// A comment and what it asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comment {
    /// What it asks for.
    pub kind: CommentKind,
    /// What stands after the keyword and its comma (all of it, for a plain comment), without the
    /// brackets; bytes that are not UTF-8 are replaced by U+FFFD.
    pub text: Text,
    /// Written after a semicolon instead of in brackets. LinuxCNC passes only the bracketed on.
    pub semicolon: bool,
    /// With its brackets, or from the semicolon to the end of the line.
    pub span: Span,
}

/// What an O-word belongs to: the number, name or computed number after the `O`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Label {
    /// `o100`.
    Number(u32),
    /// `o<name>`, in lower case and without blanks.
    Name(Text),
    /// `o[#1+100]`, `o#1`.
    Computed(Value),
}

/// What an O-word does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    /// `o100` alone: a numbered program or subprogram begins here (the Fanuc way, ended by M99).
    Program,
    /// `o100 sub`.
    Sub,
    /// `o100 endsub`, `o100 endsub [value]`: 0 or 1 argument.
    EndSub,
    /// `o100 return`, `o100 return [value]`: 0 or 1 argument.
    Return,
    /// `o100 call [a] [b] ...`: any number of arguments.
    Call,
    /// `o100 if [condition]`: 1 argument.
    If,
    /// `o100 elseif [condition]`: 1 argument.
    ElseIf,
    /// `o100 else`.
    Else,
    /// `o100 endif`.
    EndIf,
    /// `o100 while [condition]`: 1 argument; begins a loop, or ends one begun by `do`.
    While,
    /// `o100 endwhile`.
    EndWhile,
    /// `o100 do`.
    Do,
    /// `o100 repeat [count]`: 1 argument.
    Repeat,
    /// `o100 endrepeat`.
    EndRepeat,
    /// `o100 break`.
    Break,
    /// `o100 continue`.
    Continue,
}

/// The O-word of a block. Its arguments are [`Block::arguments`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OWord {
    /// What it belongs to.
    pub label: Label,
    /// What it does.
    pub keyword: Keyword,
    /// From the `O` to the end of the last argument.
    pub span: Span,
}

/// One line of a program. Filled by [`Parser::next`](crate::Parser::next).
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The whole line, without its end. Give `span.start` and `span.line` to
    /// [`Parser::seek`](crate::Parser::seek) to read the block again.
    pub span: Span,
    /// `/` or `/3`: to be left out while the block delete switch (of that level, 1 if it is not
    /// given) is on.
    pub delete: Option<u8>,
    /// The line is a `%`: begin or end of the tape.
    pub percent: bool,
    /// Something in the line could not be read (a diagnostic says what): do not execute it.
    pub faulty: bool,
    /// The line number after `N`: any number, without meaning in RS-274/NGC.
    pub number: Option<f64>,
    /// The O-word.
    pub o: Option<OWord>,
    /// IF, GOTO, WHILE, DO, END of Fanuc's grammar.
    pub control: Option<Control>,
    /// POPEN, PCLOS, DPRNT, BPRNT of Fanuc's grammar.
    pub output: Option<Output>,
    /// `<NAME>` among the words in Fanuc's grammar: the program that they call.
    pub called: Option<Text>,
    /// The words in the order written; no letter but `G` and `M` occurs twice.
    pub words: Vec<Word>,
    /// The parameter settings in the order written.
    pub assignments: Vec<Assignment>,
    /// The comments in the order written.
    pub comments: Vec<Comment>,
    /// The arguments of the O-word.
    pub arguments: Vec<Value>,
    /// What DPRNT or BPRNT writes.
    pub pieces: Vec<Piece>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) texts: String,
}

impl Block {
    /// An empty block to hand to the parser.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A name or comment.
    #[must_use]
    pub fn text(&self, text: Text) -> &str {
        self.texts.get(text.start as usize..text.end as usize).unwrap_or("")
    }

    /// What an expression says. Never deeper than [`MAX_OPERATIONS`](crate::MAX_OPERATIONS), so
    /// that a recursive evaluation is safe.
    ///
    /// # Panics
    /// If the index comes from another block.
    #[must_use]
    pub fn expr(&self, id: ExprId) -> Expr {
        self.nodes[id.0 as usize].expr
    }

    /// Where an expression stands.
    ///
    /// # Panics
    /// If the index comes from another block.
    #[must_use]
    pub fn expr_span(&self, id: ExprId) -> Span {
        self.nodes[id.0 as usize].span
    }

    /// The only word with this letter (upper case), or the first `G` or `M`.
    #[must_use]
    pub fn word(&self, letter: u8) -> Option<&Word> {
        self.words.iter().find(|w| w.letter == letter)
    }

    /// Whether the line says nothing at all (comments apart).
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.o.is_none()
            && self.control.is_none()
            && self.output.is_none()
            && self.called.is_none()
            && self.words.is_empty()
            && self.assignments.is_empty()
            && !self.percent
    }

    /// Empties the block and keeps its memory.
    pub fn clear(&mut self) {
        self.span = Span::default();
        self.delete = None;
        self.percent = false;
        self.faulty = false;
        self.number = None;
        self.o = None;
        self.control = None;
        self.output = None;
        self.called = None;
        self.pieces.clear();
        self.words.clear();
        self.assignments.clear();
        self.comments.clear();
        self.arguments.clear();
        self.nodes.clear();
        self.texts.clear();
    }
}
