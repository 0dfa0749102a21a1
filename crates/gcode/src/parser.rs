//! Reads blocks one after another (the line rules are filled in next).
use crate::Block;
use diag::Diagnostic;

/// Brackets inside brackets.
pub const MAX_NESTING: u32 = 64;
/// Operators, functions and parameters in one expression.
pub const MAX_OPERATIONS: u32 = 256;
/// Longest line.
pub const MAX_LINE_BYTES: usize = 64 * 1024;
/// Diagnostics kept of one file; the rest is counted.
pub const MAX_DIAGNOSTICS: usize = 100;

/// Reads the blocks of one file.
#[derive(Debug)]
pub struct Parser<'a> {
    source: &'a [u8],
    offset: usize,
    line: u32,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> Parser<'a> {
    /// A reader at the beginning of `source`, which diagnostics will call `file`.
    #[must_use]
    pub fn new(source: &'a [u8], file: u16) -> Self {
        let _ = file;
        Self { source, offset: 0, line: 1, diagnostics: Vec::new() }
    }

    /// Reads the next line into `block`; false at the end of the file.
    pub fn next(&mut self, block: &mut Block) -> bool {
        block.clear();
        self.offset < self.source.len()
    }

    /// Goes to the line that begins at byte `offset` (a block's `span.start`) and has number `line`.
    pub fn seek(&mut self, offset: u32, line: u32) {
        self.offset = (offset as usize).min(self.source.len());
        self.line = line;
    }

    /// Where the next block begins: byte and line, to be given to [`Parser::seek`].
    #[must_use]
    pub fn position(&self) -> (u32, u32) {
        (self.offset as u32, self.line)
    }

    /// Everything found so far, in the order found, and forgets it.
    pub fn take_diagnostics(&mut self) -> Vec<Diagnostic> {
        core::mem::take(&mut self.diagnostics)
    }
}
