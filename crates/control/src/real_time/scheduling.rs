//! What the operating system is asked for the servo thread: to be run first, and to have its memory
//! at hand; and for threads that can wait: to be run last.
use rustix::mm::{MlockAllFlags, mlockall};
use std::hint::black_box;
use thread_priority::{
    NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue,
    ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
};

/// Stack that is touched before the first period, bytes.
const STACK: usize = 256 * 1024;

/// Asks the operating system to run the calling thread first and to keep its memory at hand; what
/// was not granted, in sentences.
pub fn run_by_deadline(priority: u8) -> Vec<String> {
    let mut refused = Vec::new();
    if let Err(e) = run_first(priority) {
        refused.push(format!(
            "the servo thread runs as any other: real-time scheduling (SCHED_FIFO, priority {priority}) is refused: {e}; \
             a limit of rtprio {priority} for this user would allow it"
        ));
    }
    // what is not used yet is locked when it is touched
    let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
    if let Err(e) = mlockall(flags) {
        refused.push(format!(
            "memory may be swapped out: it cannot be locked: {e}; a limit of memlock unlimited for this user would allow it"
        ));
    }
    touch_stack();
    refused
}

fn run_first(priority: u8) -> Result<(), String> {
    let value = ThreadPriorityValue::try_from(priority)?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy)
        .map_err(|e| e.to_string())
}

/// The calling thread is run where no other one wants the core: what it does can wait.
pub fn run_last() {
    let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
    // one that is not is run like the others
    let _ = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy);
}

#[inline(never)]
#[allow(clippy::large_stack_arrays)] // this is what it is for
fn touch_stack() {
    let mut stack = [0_u8; STACK];
    for page in stack.chunks_mut(4096) {
        page[0] = 1;
    }
    black_box(&stack);
}
