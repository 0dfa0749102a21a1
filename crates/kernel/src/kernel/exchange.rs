//! What the kernel exchanges with those around it between two ticks: learning records, tables,
//! records of taps.
//!
//! It has no disk and no files: what it has learnt is read from it, what it shall know is given to
//! it, and what has to be written down is a [`RecordRequest`] until it is acknowledged.
use super::Kernel;
use crate::execute::Activity;
use crate::fault::FaultKind;
use crate::record_requests::RecordRequest;
use alloc::vec::Vec;
use motion::{Superpose, TableId};
use sync::Periodic;

impl Kernel {
    /// What repeated taps have learnt so far.
    pub fn learning_records(&self) -> &[sync::LearningRecord] {
        self.drives.learning_records.list()
    }

    /// Begin with what was learnt before; ignored where learning is off. Not during a tap.
    pub fn recall(&mut self, learning_records: Vec<sync::LearningRecord>) {
        self.drives.learning_records.recall(learning_records);
    }

    /// What good holes have been like so far.
    pub fn bands(&self) -> &[sync::supervision::band::StrokeBand] {
        self.drives.supervision.bands()
    }

    /// Begin with what good holes were like before; ignored where taps are not supervised. Not
    /// during a tap.
    pub fn recall_bands(&mut self, bands: Vec<sync::supervision::band::StrokeBand>) {
        self.drives.supervision.recall(bands);
    }

    /// A tool is new: nothing is known of its holes.
    pub fn forget_bands(&mut self, tool: u32) {
        self.drives.supervision.forget(tool);
    }

    /// Keep the table of a function that steps superpose. What it replaces comes back.
    ///
    /// # Errors
    /// All [`crate::TABLES`] places hold tables that are in use; the table comes back.
    pub fn put_table(
        &mut self,
        id: TableId,
        table: Periodic,
    ) -> Result<Option<Periodic>, Periodic> {
        self.drives.coupled.put(id, table)
    }

    /// What the step in work waits for from outside, if it does: see [`motion::StepKind::Consult`].
    pub fn consulted(&self) -> Option<u16> {
        self.queue.consults().filter(|_| self.begun)
    }

    /// While it is consulted: begin, exchange or end a superposition.
    ///
    /// # Errors
    /// The spindle, the axis or the table is missing.
    pub fn superpose(&mut self, order: &Superpose) -> Result<(), FaultKind> {
        self.drives.superpose(order).map_err(|(kind, ..)| kind)
    }

    /// All that was superposed has faded in or out.
    pub fn has_faded(&self) -> bool {
        self.drives.coupled.has_faded()
    }

    /// Go on after a consultation.
    pub fn answer(&mut self) {
        if matches!(self.activity, Activity::Consulting { .. }) {
            self.activity = Activity::AtOnce;
        }
    }

    /// From now on what taking a tap out needs is written down, and no tap goes in before it is.
    pub const fn keep_records(&mut self) {
        self.drives.record_requests.begin();
    }

    /// What shall be written down next.
    pub fn next_record_request(&mut self) -> Option<RecordRequest> {
        self.drives.record_requests.take()
    }

    /// The request of this number is on the disk.
    pub fn acknowledge(&mut self, number: u32) {
        self.drives.record_requests.acknowledge(number);
    }

    /// The disk refuses: no further tap goes in.
    pub const fn not_written(&mut self) {
        self.drives.record_requests.refuse();
    }
}
