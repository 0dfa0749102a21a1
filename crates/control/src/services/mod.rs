//! What answers the kernel beside the loop: the sync record, measuring and teaching of cams and
//! polygons, and what comes from outside to stop the run.
pub mod cam;
pub mod learning;
pub mod polygon;
pub mod sequence;
pub mod supervision;
pub mod sync_record;

pub use cam::CamHost;
pub use polygon::PolygonHost;
pub use sequence::SequenceHost;
pub use sync_record::RecordWriter;

use crate::KernelHandle;
use crate::MachineHandle;
use crate::job::Session;
use crate::stops::Stops;
use bus::Sample;
use canon::Op;
use plan::Planner;

/// The services of a run.
pub struct Services {
    /// Writes the sync record: what taking a tap out needs.
    pub record_writer: Option<RecordWriter>,
    /// Measures and teaches cams.
    pub cams: CamHost,
    /// Measures and compensates oscillations of polygons.
    pub polygons: PolygonHost,
    /// Answers the marks of machine sequences.
    pub sequences: SequenceHost,
    /// What comes from outside to stop it.
    pub stops: Stops,
}

impl Services {
    /// Of a run that nothing stops and that keeps no record.
    pub fn new(session: &Session) -> Self {
        Self {
            record_writer: None,
            cams: CamHost::new(session.cams.clone()),
            polygons: PolygonHost::new(&session.machine),
            sequences: SequenceHost::default(),
            stops: Stops::none(),
        }
    }

    /// An operation has been read.
    pub(super) fn announced(&mut self, index: u32, op: &Op) {
        self.cams.op(index, op);
        self.polygons.op(index, op);
    }

    /// An operation is planned.
    pub(super) fn op(&mut self, index: u32, op: &Op) {
        if let Some(record_writer) = &mut self.record_writer {
            record_writer.op(index, op);
        }
    }

    /// What was heard and commanded in a period.
    pub(super) fn sample(&mut self, sample: &Sample, kernel: &KernelHandle) {
        self.cams.sample(sample);
        self.polygons.sample(sample, kernel);
    }

    /// Answer what the kernel has asked.
    pub(super) fn serve(
        &mut self,
        kernel: &mut KernelHandle,
        machine: &mut MachineHandle,
        planner: &mut Planner,
        sample: &Sample,
    ) {
        if let Some(record_writer) = &mut self.record_writer {
            record_writer.serve(kernel, machine, &sample.feedback);
        }
        self.cams.consult(kernel, planner);
        self.polygons.consult(kernel);
        self.sequences.consult(kernel, sample.feedback.time);
    }
}
