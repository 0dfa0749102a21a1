//! What the component keeps of a tool in the work: words of shared memory, also damaged ones.
use super::*;

/// Memory of its own, as a component that was just loaded has it.
fn memory(of: &str) -> Arc<Mapping> {
    let name = format!("/leadscrew-retained-{of}-{}", std::process::id());
    Arc::new(Mapping::create(&name, head::SIZE).expect("shared memory"))
}

fn tap(number: u64, tool: u32) -> EngagedTool {
    EngagedTool { number, tool, touches: true, may_be_broken: false, sync_error: Length::mm(0.004) }
}

fn period(rpm: f64, error_mm: f64, stop: RunDownKind) -> TiedPeriod {
    TiedPeriod { spin: Some(Spin::rpm(rpm)), sync_error: Some(Length::mm(error_mm)), stop }
}

#[test]
fn nothing_is_kept_before_a_tool_is_in_the_work() {
    let memory = memory("before");
    keep(&memory, &period(1000.0, 0.1, RunDownKind::Coasted));
    assert_eq!(RetainedMemory::new(&memory).state(), RetainedState::default());
}

#[test]
fn a_tool_is_kept_with_the_sense_the_largest_error_and_the_least_certain_stop() {
    let memory = memory("kept");
    let control = RetainedMemory::new(&memory);
    control.engage(Some(tap(7, 11)));
    assert_eq!(control.state().evidence.in_work, Some(tap(7, 11)));
    assert_eq!(
        (control.state().evidence.last, control.state().evidence.sense),
        (7, SpindleSense::Unknown)
    );
    keep(&memory, &period(1000.0, -0.020, RunDownKind::None));
    keep(&memory, &period(-1000.0, 0.010, RunDownKind::Coasted));
    // slower than at a standstill: the sense of before; coupled is more certain than what was
    keep(&memory, &period(2.0, 0.0, RunDownKind::Coupled));
    let state = control.state();
    assert_eq!(state.evidence.sense, SpindleSense::Negative);
    assert_eq!(state.stop, RunDownKind::Coasted);
    assert_eq!(state.evidence.in_work.map(|tool| tool.sync_error), Some(Length::mm(0.020)));
}

#[test]
fn another_engagement_begins_anew_and_none_ends_it() {
    let memory = memory("anew");
    let control = RetainedMemory::new(&memory);
    control.engage(Some(tap(7, 11)));
    keep(&memory, &period(1000.0, 0.5, RunDownKind::Coasted));
    control.engage(Some(EngagedTool { may_be_broken: true, touches: false, ..tap(8, 3) }));
    // what was kept of engagement 7 is none of 8
    let state = control.state();
    assert_eq!((state.evidence.sense, state.stop), (SpindleSense::Unknown, RunDownKind::None));
    let expected = EngagedTool { may_be_broken: true, touches: false, ..tap(8, 3) };
    assert_eq!(state.evidence.in_work, Some(expected));
    keep(&memory, &period(500.0, 0.001, RunDownKind::Coupled));
    assert_eq!(control.state().stop, RunDownKind::Coupled);
    control.engage(None);
    assert_eq!((control.state().evidence.in_work, control.state().evidence.last), (None, 8));
}

#[test]
fn what_cannot_be_is_read_as_nothing() {
    let memory = memory("damaged");
    let control = RetainedMemory::new(&memory);
    control.engage(Some(tap(7, 11)));
    keep(&memory, &period(1000.0, 0.5, RunDownKind::None));
    for word in [head::ERROR_BEFORE, head::ERROR_SINCE] {
        memory.words()[word].store(f64::NAN.to_bits(), Release);
    }
    memory.words()[head::SENSE].store(u64::MAX, Release);
    // the least certain of all stops
    memory.words()[head::STOP].store(u64::MAX, Release);
    let state = control.state();
    assert_eq!(state.evidence.in_work.map(|tool| tool.sync_error), Some(Length::ZERO));
    assert_eq!((state.evidence.sense, state.stop), (SpindleSense::Unknown, RunDownKind::Coasted));
    // and the next error counts again
    keep(&memory, &period(1000.0, 0.002, RunDownKind::None));
    assert_eq!(
        control.state().evidence.in_work.map(|tool| tool.sync_error),
        Some(Length::mm(0.002))
    );
}
