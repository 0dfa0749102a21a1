//! The types of the API as TypeScript, for the page.
use crate::wire::{
    AcceptedBody, AlarmBody, EventBody, EventsBody, FeatureBody, FileBody, FolderBody, HoleBody,
    MachineAxis, MachineBody, MachineSpindle, OffsetBody, OperatorBody, OperatorOrder,
    OverrideRange, OverrideRanges, ProgramBody, RefusalBody, RequestBody, RequestNeeds, RunBody,
    RunDetailBody, RunTraceBody, RunTraceSignal, RunsBody, SavedBody, SegmentBody, SessionBody,
    SessionOrder, StockBody, ToolBody, ToolFieldName, ToolLifeBody,
};
use control::RealTimeFigures;
use control::operation::hosted::FindingData;
use control::operation::{
    AxisStatus, FeatureCount, LeftInWork, LoadingStatus, MagazineStatus, MessageStatus, NeedStatus,
    Overrides, ProgramStatus, SequenceInput, SequenceStatus, SpindleStatus, StateChangeStatus,
    Status, Switches, WaitingStatus, WorkpieceStatus,
};
use ts_rs::{Config, TS};

/// A file with all of them.
pub fn typescript() -> String {
    // numbers that JSON.parse reads
    let config = Config::default().with_large_int("number");
    let mut text = String::from(
        "// Types of the API, written by a test of `crates/server` from the Rust types. Do not edit:\n\
         // UPDATE_API=1 cargo test -p server --test all types::\n",
    );
    macro_rules! declare {
        ($($name:ty),* $(,)?) => {
            $(
                text.push_str("\nexport ");
                text.push_str(&<$name as TS>::decl(&config));
                text.push('\n');
            )*
        };
    }
    declare!(
        Status,
        RealTimeFigures,
        AxisStatus,
        SpindleStatus,
        Overrides,
        Switches,
        NeedStatus,
        WaitingStatus,
        ProgramStatus,
        LeftInWork,
        SequenceStatus,
        SequenceInput,
        MagazineStatus,
        MessageStatus,
        LoadingStatus,
        StateChangeStatus,
        WorkpieceStatus,
        FeatureCount,
        RequestBody,
        ToolFieldName,
        AcceptedBody,
        RefusalBody,
        FindingData,
        EventBody,
        EventsBody,
        MachineBody,
        MachineAxis,
        MachineSpindle,
        OverrideRanges,
        OverrideRange,
        StockBody,
        RequestNeeds,
        ProgramBody,
        SegmentBody,
        HoleBody,
        FolderBody,
        FileBody,
        SavedBody,
        OffsetBody,
        ToolBody,
        ToolLifeBody,
        FeatureBody,
        AlarmBody,
        RunsBody,
        RunBody,
        RunDetailBody,
        RunTraceBody,
        RunTraceSignal,
        SessionOrder,
        SessionBody,
        OperatorOrder,
        OperatorBody,
    );
    text
}
