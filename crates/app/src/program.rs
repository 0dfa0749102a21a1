//! A program's operations, numbered in the order in which they come.
use canon::Op;

/// Operations with their index.
pub(crate) struct Ops<'a> {
    ops: interp::Ops<'a>,
    next: u32,
    prelude: std::vec::IntoIter<Op>,
}

impl<'a> Ops<'a> {
    /// Of a program.
    pub(crate) fn new(source: &'a [u8], setup: &'a interp::Setup) -> Self {
        Self { ops: interp::Ops::new(source, setup), next: 0, prelude: Vec::new().into_iter() }
    }

    /// The same, begun in the middle.
    pub(crate) fn begun_at(mut self, restart: Option<&crate::restart::Restart>) -> Self {
        if let Some(restart) = restart {
            for _ in 0..restart.skip {
                self.ops.next();
            }
            self.prelude = restart.prelude.clone().into_iter();
        }
        self
    }
}

impl Iterator for Ops<'_> {
    type Item = (u32, Op);

    fn next(&mut self) -> Option<Self::Item> {
        let op = self.prelude.next().or_else(|| self.ops.next())?;
        let index = self.next;
        self.next += 1;
        Some((index, op))
    }
}
