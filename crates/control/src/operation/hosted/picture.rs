//! How a control is, with all that a client may ask to see: made by the control's thread, read by
//! any other.
use crate::operation::{Alarm, Control, LoadedProgram, LoadingStatus, Status};
use canon::{Axis, Tool};
use std::sync::Arc;
use units::Coordinate;
use verify::Feature;

/// Work offsets that there are: G54 to G59.3.
const SYSTEMS: u8 = 9;

/// A work offset.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkOffset {
    /// As a program writes it.
    pub name: String,
    /// Its zero in machine coordinates.
    pub zeros: Vec<(Axis, Coordinate)>,
}

/// A control, as it was.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Number of the picture: each has the next.
    pub number: u64,
    /// How it is.
    pub status: Status,
    /// What was cut.
    pub features: Arc<Vec<Feature>>,
    /// Work offsets.
    pub offsets: Arc<Vec<WorkOffset>>,
    /// Tools, as the control believes them to be.
    pub tools: Arc<Vec<Tool>>,
    /// Alarms, oldest first, cleared ones too.
    pub alarms: Arc<Vec<Alarm>>,
    /// The program that is loaded.
    pub program: Option<Arc<LoadedProgram>>,
    /// Of the features: another one means that there are others.
    version: (u64, usize, usize, bool),
}

impl Picture {
    /// The first.
    pub(super) fn first(control: &Control) -> Self {
        let mut picture = Self {
            number: 1,
            status: control.status(),
            features: Arc::default(),
            offsets: Arc::default(),
            tools: Arc::default(),
            alarms: Arc::default(),
            program: None,
            version: control.features_version(),
        };
        picture.features = Arc::new(control.features());
        picture.take_lists(control);
        picture
    }

    /// The next one; `has_changed`: something was asked for or has happened since.
    pub(super) fn next(
        &self,
        control: &Control,
        loading: Option<LoadingStatus>,
        has_changed: bool,
    ) -> Self {
        let status = Status { loading, ..control.status() };
        let mut next = Self { number: self.number + 1, status, ..self.clone() };
        let version = control.features_version();
        if version != self.version {
            (next.version, next.features) = (version, Arc::new(control.features()));
        }
        if has_changed || version != self.version {
            next.take_lists(control);
        }
        next
    }

    fn take_lists(&mut self, control: &Control) {
        keep_or_take(&mut self.offsets, offsets(control));
        keep_or_take(&mut self.tools, control.tools().cloned().collect());
        keep_or_take(&mut self.alarms, control.alarms().to_vec());
        self.program = control.loaded_program();
    }
}

/// What has not changed is the same object, so that a client sees it at once.
fn keep_or_take<T: PartialEq>(kept: &mut Arc<Vec<T>>, now: Vec<T>) {
    if **kept != now {
        *kept = Arc::new(now);
    }
}

fn offsets(control: &Control) -> Vec<WorkOffset> {
    let axes = || control.machine().axes.iter().flatten().map(|axis| axis.letter);
    (1..=SYSTEMS)
        .map(|system| WorkOffset {
            name: control.work_offset_name(system),
            zeros: axes().map(|axis| (axis, control.zero_of(system, axis))).collect(),
        })
        .collect()
}
