//! Text to blocks: the words, expressions, parameters and O-words of a program, with spans.
//!
//! ```text
//!   bytes ──► Parser ──► Block ──► the interpreter
//!               └──────► diagnostics (all of the file's, at once)
//! ```
//!
//! The language is RS-274/NGC as LinuxCNC 2.9 reads it: case and blanks mean nothing outside
//! comments (`g 1 x1 . 5` is `G1 X1.5`), one line is one block. This crate knows the shape of the
//! language and none of its meanings: it does not know what G1 does, or what `#1` holds.
//!
//! Reading never fails. A line that cannot be read gives one diagnostic and a block marked
//! [`faulty`](Block::faulty), and reading goes on with the next line.
//!
//! ```
//! let mut parser = gcode::Parser::new(b"G1 X[#1*2] F100 (to the left)\n", 0);
//! let mut block = gcode::Block::new();
//! while parser.next(&mut block) {
//!     assert_eq!(block.to_string(), "G1 X[#1*2] F100 (to the left)");
//! }
//! assert!(parser.take_diagnostics().is_empty());
//! ```
//!
//! Source: T. Kramer, F. Proctor, E. Messina, "The NIST RS274/NGC Interpreter, version 3",
//! NISTIR 6556 (2000), section 3; LinuxCNC 2.9 manual, "G-code overview" and "O codes".

mod block;
mod comment;
mod expression;
mod fanuc;
mod format;
mod leader;
mod line;
mod number;
mod o_word;
mod parser;
mod print;
mod problem;
mod value;

pub use block::{Assignment, Block, Comment, CommentKind, Keyword, Label, OWord, Text, Word};
pub use expression::{Expr, ExprId, Function, Operator, Parameter, Value};
pub use fanuc::{Control, Grammar, Output, Piece};
pub use format::format;
pub use line::end_lines_with_lf;
pub use parser::{MAX_DIAGNOSTICS, MAX_LINE_BYTES, MAX_NESTING, MAX_OPERATIONS, Parser};
