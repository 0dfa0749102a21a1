//! The processor: cores set apart, interrupts that reach them, states in which they sleep.
use super::computer::Computer;
use super::finding::{ComputerFinding, Topic};
use units::Time;

const CPU: &str = "sys/devices/system/cpu";
const GRUB: &str = "to GRUB_CMDLINE_LINUX in /etc/default/grub, then sudo update-grub and start the computer again";
/// Share of a period that a core may take to wake up.
const WAKE_UP_SHARE: f64 = 0.1;

pub(super) fn cores(computer: &Computer) -> Vec<ComputerFinding> {
    let (all, isolated) = (computer.cores(), computer.isolated());
    let Some(core) = isolated.iter().copied().max() else {
        return vec![none_apart(&all)];
    };
    let apart = ComputerFinding::good(
        Topic::Cores,
        format!("the servo thread runs on core {core}, which is set apart"),
    );
    std::iter::once(apart).chain(sibling(computer, core, &isolated)).collect()
}

fn none_apart(all: &[usize]) -> ComputerFinding {
    let Some((last, others)) = all.split_last().filter(|(_, others)| !others.is_empty()) else {
        return ComputerFinding::improve(
            Topic::Cores,
            "one core for everything: servo thread, planner, page and disk take turns",
            "a computer with two cores or more",
        );
    };
    let rest = match others {
        [one] => one.to_string(),
        [first, .., end] => format!("{first}-{end}"),
        [] => String::new(), // excluded above
    };
    ComputerFinding::improve(
        Topic::Cores,
        format!(
            "no core is set apart: the servo thread shares all {} with everything else",
            all.len()
        ),
        format!(
            "add isolcpus=managed_irq,domain,{last} nohz_full={last} rcu_nocbs={last} irqaffinity={rest} {GRUB}"
        ),
    )
}

/// Two threads of one core share its arithmetic: the other one must be set apart as well.
fn sibling(computer: &Computer, core: usize, isolated: &[usize]) -> Option<ComputerFinding> {
    let siblings = computer.text(&format!("{CPU}/cpu{core}/topology/thread_siblings_list"))?;
    let siblings = control::numbers_of_list(&siblings);
    let other = siblings.into_iter().find(|other| *other != core && !isolated.contains(other))?;
    Some(ComputerFinding::improve(
        Topic::Cores,
        format!(
            "core {core} shares its arithmetic with core {other} (hyper-threading), which does other work"
        ),
        format!(
            "echo 0 | sudo tee /sys/devices/system/cpu/cpu{other}/online, or switch hyper-threading off in the BIOS"
        ),
    ))
}

/// Interrupts of devices that may come to a core that is set apart.
pub(super) fn interrupts(computer: &Computer) -> Option<ComputerFinding> {
    let core = computer.isolated().into_iter().max()?;
    let table = computer.text("proc/interrupts")?;
    let mut here: Vec<String> = Vec::new();
    for line in table.lines() {
        let Some((number, rest)) = line.trim().split_once(':') else { continue };
        if !number.bytes().all(|byte| byte.is_ascii_digit()) {
            continue; // the kernel's own, on every core
        }
        let allowed = computer.text(&format!("proc/irq/{number}/smp_affinity_list"));
        let may_come = allowed.is_some_and(|list| control::numbers_of_list(&list).contains(&core));
        if may_come {
            here.push(rest.split_whitespace().last().unwrap_or(number).to_owned());
        }
    }
    if here.is_empty() {
        let says = format!("no device's interrupt comes to core {core}");
        return Some(ComputerFinding::good(Topic::Interrupts, says));
    }
    here.dedup();
    let (count, shown) = (here.len(), here.iter().take(4).cloned().collect::<Vec<_>>().join(", "));
    let more = if count > 4 { ", …" } else { "" };
    let others: Vec<_> = computer.cores().into_iter().filter(|other| *other != core).collect();
    let others = others.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
    Some(ComputerFinding::improve(
        Topic::Interrupts,
        format!("{count} interrupts of devices may come to core {core}: {shown}{more}"),
        format!(
            "add irqaffinity={others} {GRUB}; and where irqbalance runs: sudo systemctl disable --now irqbalance"
        ),
    ))
}

/// The state from which a core wakes up slowest: its name and µs.
fn slowest(computer: &Computer, cores: &[usize]) -> Option<(String, f64)> {
    let states = cores.iter().flat_map(|core| {
        let folder = format!("{CPU}/cpu{core}/cpuidle");
        let names = computer.names(&folder);
        names.into_iter().map(move |state| format!("{folder}/{state}"))
    });
    let wakes = states.filter_map(|state| {
        let is_off = computer.number(&format!("{state}/disable")).is_some_and(|off| off != 0.0);
        let us = computer.number(&format!("{state}/latency")).filter(|_| !is_off)?;
        Some((computer.text(&format!("{state}/name")).unwrap_or_default(), us))
    });
    wakes.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn looked_at(computer: &Computer) -> Vec<usize> {
    let isolated = computer.isolated().into_iter().max();
    isolated.map_or_else(|| computer.cores(), |core| vec![core])
}

pub(super) fn idle(computer: &Computer, period: Time) -> ComputerFinding {
    let Some((name, us)) = slowest(computer, &looked_at(computer)) else {
        return ComputerFinding::unknown(
            Topic::Idle,
            "the kernel does not say in which states cores sleep",
        );
    };
    let says =
        format!("an idle core may sleep in {name}, from which it takes {us:.0} µs to wake up");
    if us <= WAKE_UP_SHARE * period.value() * 1e6 {
        return ComputerFinding::good(Topic::Idle, says);
    }
    if computer.may_write(control::WAKE_UP_FILE) {
        let kept = format!(
            "{says}; drives, run, control and serve keep it awake in real time. HAL does not"
        );
        return ComputerFinding::good(Topic::Idle, kept);
    }
    ComputerFinding::improve(
        Topic::Idle,
        says,
        format!(
            "sudo cpupower idle-set -D {:.0} until the computer is started again; for good, add processor.max_cstate=1 intel_idle.max_cstate=0 {GRUB}",
            WAKE_UP_SHARE * period.value() * 1e6
        ),
    )
}

pub(super) fn speed(computer: &Computer) -> Option<ComputerFinding> {
    let governors = looked_at(computer)
        .into_iter()
        .filter_map(|core| computer.text(&format!("{CPU}/cpu{core}/cpufreq/scaling_governor")));
    let mut governors: Vec<_> = governors.collect();
    governors.sort();
    governors.dedup();
    match &governors[..] {
        [] => None,
        [one] if one == "performance" => Some(ComputerFinding::good(
            Topic::Speed,
            "the cores keep their highest speed (performance)",
        )),
        slow => Some(ComputerFinding::improve(
            Topic::Speed,
            format!("the cores slow down when there is little to do ({})", slow.join(", ")),
            "sudo cpupower frequency-set -g performance",
        )),
    }
}
