//! A program's operations, numbered in the order in which they come.
use canon::Op;

/// Operations with their index.
pub(crate) struct Ops<'a> {
    ops: interp::Ops<'a>,
    next: u32,
}

impl<'a> Ops<'a> {
    /// Of a program.
    pub(crate) fn new(source: &'a [u8], setup: &'a interp::Setup) -> Self {
        Self { ops: interp::Ops::new(source, setup), next: 0 }
    }
}

impl Iterator for Ops<'_> {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<Self::Item> {
        let op = self.ops.next()?;
        let index = self.next;
        self.next += 1;
        Some((index, op))
    }
}
