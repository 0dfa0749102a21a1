//! What is set on the control, and in force.
use canon::ToolLibrary;
use interp::OpsRest;

/// What is set on the control, and in force.
pub(super) struct Data {
    pub(super) parameters: interp::Parameters,
    pub(super) tools: ToolLibrary,
    pub(super) rest: Option<OpsRest>,
    /// How often what is in force has changed.
    pub(super) rest_number: u64,
}

impl Data {
    /// What a program, or something else, has left in force.
    pub(super) fn leave(&mut self, rest: Option<OpsRest>) {
        (self.rest, self.rest_number) = (rest, self.rest_number + 1);
    }

    /// The spindle was stopped, or turned by hand.
    pub(super) fn stop_spindles(&mut self) {
        let rest = self.rest.take().map(OpsRest::stopped);
        self.leave(rest);
    }
}
