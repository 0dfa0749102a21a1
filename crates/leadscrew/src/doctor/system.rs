//! The operating system: its kernel, its clock, what it allows a program.
use super::computer::Computer;
use super::finding::{ComputerFinding, Topic};
use rustix::process::{Resource, getrlimit};

/// Rights of a process on Linux, by their bits.
const CAP_NET_RAW: u32 = 13;
const CAP_IPC_LOCK: u32 = 14;
const CAP_SYS_NICE: u32 = 23;

/// What a process may do in real time.
#[derive(Clone, Copy, Debug)]
pub struct Rights {
    /// Highest priority under `SCHED_FIFO`; 0: none.
    pub priority: u64,
    /// Memory that may be locked, bytes; `None`: without a limit.
    pub locked: Option<u64>,
    /// Raw frames may be sent.
    pub sends_raw: bool,
    /// It runs as root.
    pub is_root: bool,
}

impl Rights {
    /// Those of this process.
    pub fn of_this_process(computer: &Computer) -> Self {
        let status = computer.text("proc/self/status").unwrap_or_default();
        let effective = status.lines().find_map(|line| line.strip_prefix("CapEff:"));
        let bits = effective.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok()).unwrap_or(0);
        let may = |capability: u32| bits >> capability & 1 == 1;
        let highest = getrlimit(Resource::Rtprio).current.unwrap_or(99).min(99);
        let locked = getrlimit(Resource::Memlock).current;
        Self {
            priority: if may(CAP_SYS_NICE) { 99 } else { highest },
            locked: if may(CAP_IPC_LOCK) { None } else { locked },
            sends_raw: may(CAP_NET_RAW),
            is_root: rustix::process::geteuid().is_root(),
        }
    }
}

/// Priority that the servo thread asks for.
const PRIORITY: u64 = 80;

const LIMITS: &str = "printf '%s - rtprio 90\\n%s - memlock unlimited\\n' \"$USER\" \"$USER\" | sudo tee /etc/security/limits.d/leadscrew.conf, then log in again";

pub(super) fn kernel(computer: &Computer) -> ComputerFinding {
    let topic = Topic::Kernel;
    let Some(version) = computer.text("proc/version") else {
        return ComputerFinding::unknown(topic, "the kernel does not say its version");
    };
    let release = version.split_whitespace().nth(2).unwrap_or("?");
    if computer.text("sys/kernel/realtime").as_deref() == Some("1")
        || version.contains("PREEMPT_RT")
    {
        return ComputerFinding::good(
            topic,
            format!("{release} is a real-time kernel (PREEMPT_RT)"),
        );
    }
    ComputerFinding::improve(
        topic,
        format!(
            "{release} is not a real-time kernel: a driver or a system call can hold the servo thread up for milliseconds"
        ),
        "on Debian: sudo apt install linux-image-rt-amd64, then start the computer with it; elsewhere a kernel built with CONFIG_PREEMPT_RT",
    )
}

pub(super) fn virtual_machine(computer: &Computer) -> Option<ComputerFinding> {
    let cpu = computer.text("proc/cpuinfo")?;
    let is_guest = cpu
        .lines()
        .filter(|line| line.starts_with("flags"))
        .any(|line| line.split_whitespace().any(|flag| flag == "hypervisor"));
    is_guest.then(|| {
        ComputerFinding::wrong(
            Topic::VirtualMachine,
            "this is a virtual machine: its host stops it whenever it likes, and nothing in here can prevent that",
            "lead drives from a computer of their own; a virtual machine will do for the simulator",
        )
    })
}

pub(super) fn clock(computer: &Computer) -> ComputerFinding {
    let folder = "sys/devices/system/clocksource/clocksource0";
    match computer.text(&format!("{folder}/current_clocksource")).as_deref() {
        Some(name @ ("tsc" | "arch_sys_counter")) => {
            ComputerFinding::good(Topic::Clock, format!("{name}: read in some 20 ns"))
        }
        Some(name @ ("kvm-clock" | "hyperv_clocksource_tsc_page")) => ComputerFinding::good(
            Topic::Clock,
            format!("{name}: the host's, read without a call of the system"),
        ),
        Some(name) => ComputerFinding::improve(
            Topic::Clock,
            format!(
                "{name}: each look at the clock takes a microsecond or more, and the servo thread looks twice a period"
            ),
            "add clocksource=tsc tsc=reliable to GRUB_CMDLINE_LINUX in /etc/default/grub, then sudo update-grub and start the computer again; where the kernel rejects tsc (dmesg | grep -i tsc), it is not steady on this computer",
        ),
        None => {
            ComputerFinding::unknown(Topic::Clock, "the kernel does not say which clock it reads")
        }
    }
}

pub(super) fn rights(computer: &Computer, rights: Rights) -> Vec<ComputerFinding> {
    let priority = if rights.priority >= PRIORITY {
        ComputerFinding::good(
            Topic::Rights,
            format!("SCHED_FIFO up to priority {}", rights.priority),
        )
    } else {
        ComputerFinding::wrong(
            Topic::Rights,
            format!(
                "the servo thread runs as any other: SCHED_FIFO is allowed up to priority {}, and it asks for {PRIORITY}",
                rights.priority
            ),
            LIMITS,
        )
    };
    let memory = match rights.locked {
        None => ComputerFinding::good(Topic::Memory, "memory may be locked without a limit"),
        Some(bytes) => ComputerFinding::improve(
            Topic::Memory,
            format!(
                "{} MB of memory may be locked: the rest may be swapped out in the middle of a period",
                bytes / 1_000_000
            ),
            LIMITS,
        ),
    };
    let throttled = computer.number("proc/sys/kernel/sched_rt_runtime_us").filter(|us| *us >= 0.0);
    let throttled = throttled.map(|us| {
        let says = format!(
            "real-time threads are stopped once they have used {:.0} ms of a second, so that one that hangs does not take the computer along; where --timings shows the servo thread near it: sudo sysctl kernel.sched_rt_runtime_us=-1",
            us / 1000.0
        );
        ComputerFinding::note(Topic::Rights, says)
    });
    [priority, memory].into_iter().chain(throttled).collect()
}
