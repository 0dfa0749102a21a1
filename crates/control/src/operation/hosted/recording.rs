//! The signals of the last moments, every period of them, recorded as long as a client takes them.
//!
//! Rows are numbered by the servo period; a client reads on from where it has come to, and is told
//! when rows are gone.
use super::held;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// Blocks that are kept: of 20 ms each this is a second.
const MOST_BLOCKS: usize = 50;

/// Successive rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalRows {
    /// Number of the first.
    pub first: u64,
    /// Machine time of the first, s.
    pub start_s: f64,
    /// One after another.
    pub values: Vec<f32>,
    /// Values of a row.
    pub width: usize,
}

impl SignalRows {
    /// How many.
    pub fn count(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }
}

/// Rows of the last moments.
#[derive(Debug, Default)]
pub(super) struct Recording {
    takers: AtomicUsize,
    blocks: Mutex<VecDeque<Arc<SignalRows>>>,
}

impl Recording {
    /// Record from now on, for one more client.
    pub(super) fn join(&self) {
        self.takers.fetch_add(1, Ordering::Relaxed);
    }

    /// A client takes no more rows.
    pub(super) fn leave(&self) {
        self.takers.fetch_sub(1, Ordering::Relaxed);
    }

    /// A client takes rows.
    pub(super) fn is_wanted(&self) -> bool {
        self.takers.load(Ordering::Relaxed) > 0
    }

    pub(super) fn push(&self, rows: SignalRows) {
        let mut blocks = held(&self.blocks);
        if blocks.len() == MOST_BLOCKS {
            blocks.pop_front();
        }
        blocks.push_back(Arc::new(rows));
    }

    /// Blocks with this row or later ones, oldest first.
    pub(super) fn rows_from(&self, row: u64) -> Vec<Arc<SignalRows>> {
        let blocks = held(&self.blocks);
        blocks.iter().filter(|rows| rows.first + rows.count() as u64 > row).cloned().collect()
    }
}
