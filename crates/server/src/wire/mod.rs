//! What goes over the wire: plain values with their units in their names. From these types come the
//! TypeScript of the page and the schemas of the OpenAPI document.
mod answers;
mod feature;
mod files;
mod lists;
mod machine;
mod needs;
mod request;
mod runs;
mod values;

pub(crate) use answers::{
    AcceptedBody, EventBody, EventsBody, OperatorBody, RefusalBody, SessionBody,
};
pub(crate) use feature::FeatureBody;
pub(crate) use files::{FileBody, FolderBody};
pub(crate) use lists::{
    AlarmBody, HoleBody, OffsetBody, ProgramBody, SavedBody, SegmentBody, ToolBody, ToolLifeBody,
};
pub(crate) use machine::{
    MachineAxis, MachineBody, MachineSpindle, OverrideRange, OverrideRanges, StockBody,
};
pub(crate) use needs::RequestNeeds;
pub(crate) use request::{OperatorOrder, RequestBody, SessionOrder, ToolFieldName};
pub(crate) use runs::{RunBody, RunDetailBody, RunTraceBody, RunTraceSignal, RunsBody};
