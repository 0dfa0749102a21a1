//! What the operating system is asked for the servo thread: a core of its own where one is set
//! apart, one that does not sleep, to be run first, and to have its memory at hand; and for threads
//! that can wait: to be run last.
use rustix::fs::{Mode, OFlags};
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_setaffinity};
use std::hint::black_box;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::sync::OnceLock;
use thread_priority::{
    NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue,
    ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id,
};

/// Stack that is touched before the first period, bytes.
const STACK: usize = 256 * 1024;

/// Cores that the kernel keeps free of other threads (`isolcpus`).
const ISOLATED: &str = "/sys/devices/system/cpu/isolated";

/// Numbers in a list of the kernel's, `0-2,5`; what is no number is left out.
pub fn numbers_of_list(list: &str) -> Vec<usize> {
    let number = |text: &str| text.trim().parse::<usize>().ok();
    let ranges = list.trim().split(',').filter_map(|part| {
        let (from, to) = part.split_once('-').unwrap_or((part, part));
        Some(number(from)?..=number(to)?.min(CpuSet::MAX_CPU))
    });
    ranges.flatten().collect()
}

/// The core of the servo thread: the last one that is set apart, as LinuxCNC takes it; `None`: no
/// core is, and the operating system chooses.
pub fn servo_core() -> Option<usize> {
    let list = store::read_text(Path::new(ISOLATED), "the list of cores", store::SMALL_FILE_LIMIT);
    numbers_of_list(&list.ok()?).into_iter().max()
}

/// Asks the operating system to run the calling thread first, on the core that is set apart, and to
/// keep its memory at hand; what was not granted, in sentences.
pub fn run_by_deadline(priority: u8) -> Vec<String> {
    let mut refused = Vec::new();
    if let Some(core) = servo_core()
        && let Err(why) = run_on(core)
    {
        refused.push(format!(
            "core {core} is set apart, and the servo thread may not run on it: {why}"
        ));
    }
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
    stay_awake();
    refused
}

/// Where a program says how long its cores may take to wake up; it counts while the file is open.
pub const WAKE_UP_FILE: &str = "/dev/cpu_dma_latency";

/// Keeps the cores out of states from which they wake up slowly, until this process ends, where it
/// may.
fn stay_awake() {
    static HELD: OnceLock<Option<OwnedFd>> = OnceLock::new();
    HELD.get_or_init(|| {
        let flags = OFlags::WRONLY | OFlags::CLOEXEC;
        let file = rustix::fs::open(WAKE_UP_FILE, flags, Mode::empty()).ok()?;
        rustix::io::write(&file, &0_i32.to_ne_bytes()).ok()?;
        Some(file)
    });
}

/// The calling thread runs on this core alone.
fn run_on(core: usize) -> rustix::io::Result<()> {
    let mut cores = CpuSet::new();
    cores.set(core);
    sched_setaffinity(None, &cores)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_the_kernel_is_read_as_it_is_written() {
        assert_eq!(numbers_of_list("0-2,5\n"), [0, 1, 2, 5]);
        assert_eq!(numbers_of_list("3"), [3]);
        assert_eq!(numbers_of_list("\n"), [0_usize; 0]);
        assert_eq!(numbers_of_list("x,2-,7"), [7]);
        assert!(numbers_of_list("0-99999999999").len() <= CpuSet::MAX_CPU + 1);
    }
}
