//! What the doctor says of computers that are made up file by file.
use leadscrew::doctor::{
    Computer, ComputerFinding, ExaminationOptions, Health, LatencyOptions, Rights, Topic, examine,
    measure,
};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;
use units::{Spin, Time};

const ALL_RIGHTS: Rights = Rights { priority: 99, locked: None, sends_raw: true, is_root: false };

/// A computer with these files.
fn computer(files: &[(&str, &str)]) -> TempDir {
    let root = tempfile::tempdir().expect("a folder");
    for (file, text) in files {
        write(root.path(), file, text);
    }
    root
}

fn write(root: &Path, file: &str, text: &str) {
    let path = root.join(file);
    std::fs::create_dir_all(path.parent().expect("it is within the root")).expect("a folder");
    std::fs::write(path, text).expect("a file");
}

/// Four cores, the last one set apart, real time, nothing to change.
const GOOD: [(&str, &str); 16] = [
    ("proc/version", "Linux version 6.12.9-rt (a@b) #1 SMP PREEMPT_RT Debian\n"),
    ("proc/cpuinfo", "flags\t\t: fpu vme sse\n"),
    ("sys/kernel/realtime", "1\n"),
    ("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n"),
    ("sys/devices/system/cpu/online", "0-3\n"),
    ("sys/devices/system/cpu/isolated", "3\n"),
    ("sys/devices/system/cpu/cpu3/topology/thread_siblings_list", "3\n"),
    ("sys/devices/system/cpu/cpu3/cpuidle/state0/name", "POLL\n"),
    ("sys/devices/system/cpu/cpu3/cpuidle/state0/latency", "0\n"),
    ("sys/devices/system/cpu/cpu3/cpuidle/state1/name", "C6\n"),
    ("sys/devices/system/cpu/cpu3/cpuidle/state1/latency", "133\n"),
    ("sys/devices/system/cpu/cpu3/cpuidle/state1/disable", "1\n"),
    ("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "performance\n"),
    (
        "proc/interrupts",
        "      CPU0 CPU1\n  24:  5  0  IO-APIC  5-edge  eth0\n NMI:  1  1  Non-maskable\n",
    ),
    ("proc/irq/24/smp_affinity_list", "0-2\n"),
    ("proc/sys/kernel/sched_rt_runtime_us", "-1\n"),
];

fn options() -> ExaminationOptions {
    ExaminationOptions {
        period: Time::s(1e-3),
        tapping_max: Spin::rpm(3000.0),
        interface: None,
        uses_hal: false,
    }
}

fn found(root: &TempDir, rights: Rights, options: &ExaminationOptions) -> Vec<ComputerFinding> {
    examine(&Computer::at(root.path()), rights, options).findings
}

fn of(findings: &[ComputerFinding], topic: Topic) -> Vec<&ComputerFinding> {
    findings.iter().filter(|finding| finding.topic == topic).collect()
}

#[test]
fn nothing_is_to_be_changed_on_a_computer_made_for_it() {
    let all = found(&computer(&GOOD), ALL_RIGHTS, &options());
    assert!(all.iter().all(|finding| finding.health == Health::Good), "{all:#?}");
    assert_eq!(all.len(), 8, "{all:#?}");
}

/// What is wrong with a computer that differs from the good one in one file.
#[test]
fn each_fault_is_found_alone_and_says_what_to_change() {
    let cases: [(&str, &str, Topic, &str); 9] = [
        ("sys/kernel/realtime", "0", Topic::Kernel, "linux-image-rt"),
        ("proc/cpuinfo", "flags : fpu hypervisor", Topic::VirtualMachine, "computer of their own"),
        (
            "sys/devices/system/clocksource/clocksource0/current_clocksource",
            "hpet",
            Topic::Clock,
            "clocksource=tsc",
        ),
        ("sys/devices/system/cpu/isolated", "", Topic::Cores, "isolcpus=managed_irq,domain,3"),
        (
            "sys/devices/system/cpu/cpu3/topology/thread_siblings_list",
            "1,3",
            Topic::Cores,
            "cpu1/online",
        ),
        ("proc/irq/24/smp_affinity_list", "0-3", Topic::Interrupts, "irqaffinity=0,1,2"),
        ("sys/devices/system/cpu/cpu3/cpuidle/state1/disable", "0", Topic::Idle, "idle-set -D 100"),
        (
            "sys/devices/system/cpu/cpu3/cpufreq/scaling_governor",
            "powersave",
            Topic::Speed,
            "frequency-set -g performance",
        ),
        ("proc/sys/kernel/sched_rt_runtime_us", "950000", Topic::Rights, ""),
    ];
    for (file, text, topic, remedy) in cases {
        let root = computer(&GOOD);
        if file == "sys/kernel/realtime" {
            write(root.path(), "proc/version", "Linux version 6.12.9 (a@b) #1 SMP PREEMPT_DYNAMIC");
        }
        write(root.path(), file, text);
        let all = found(&root, ALL_RIGHTS, &options());
        let not_good: Vec<_> = all.iter().filter(|one| one.health != Health::Good).collect();
        let [one] = not_good[..] else { panic!("{file}: {not_good:#?}") };
        assert_eq!(one.topic, topic, "{file}");
        assert!(one.remedy.as_deref().unwrap_or_default().contains(remedy), "{one:?}");
    }
}

#[test]
fn a_user_without_rights_reads_which_limits_to_set() {
    let rights = Rights { priority: 0, locked: Some(8 << 20), sends_raw: false, is_root: false };
    let all = found(&computer(&GOOD), rights, &options());
    let scheduling = of(&all, Topic::Rights);
    assert_eq!(scheduling[0].health, Health::Wrong);
    let memory = of(&all, Topic::Memory);
    assert_eq!(memory[0].health, Health::Improve);
    for finding in [scheduling[0], memory[0]] {
        let remedy = finding.remedy.as_deref().expect("what to change");
        assert!(remedy.contains("rtprio 90") && remedy.contains("memlock unlimited"), "{remedy}");
    }
}

#[test]
fn the_card_of_the_drives_is_looked_at() {
    let root = computer(&GOOD);
    let folder = "sys/class/net/eth1";
    write(root.path(), &format!("{folder}/carrier"), "1");
    write(root.path(), &format!("{folder}/speed"), "100");
    let driver = root.path().join(folder).join("device");
    std::fs::create_dir_all(&driver).expect("a folder");
    std::os::unix::fs::symlink("../../bus/pci/drivers/igb", driver.join("driver")).expect("a link");
    let with =
        |interface: &str| ExaminationOptions { interface: Some(interface.to_owned()), ..options() };
    let network = |rights, interface: &str| {
        let all = found(&root, rights, &with(interface));
        of(&all, Topic::Network).into_iter().cloned().collect::<Vec<_>>()
    };
    let good = network(ALL_RIGHTS, "eth1");
    assert!(good.iter().all(|one| one.health == Health::Good), "{good:#?}");
    let refused = network(Rights { sends_raw: false, ..ALL_RIGHTS }, "eth1");
    assert!(refused.iter().any(|one| one.says.contains("CAP_NET_RAW")), "{refused:#?}");
    let none = network(ALL_RIGHTS, "eth7");
    assert_eq!(none.len(), 1);
    assert!(none[0].remedy.as_deref().is_some_and(|remedy| remedy.ends_with(": eth1")), "{none:?}");
    assert_eq!(network(ALL_RIGHTS, "../net/eth1").len(), 1, "a name, not a path");
    write(root.path(), &format!("{folder}/speed"), "1000");
    write(root.path(), "proc/net/route", "Iface Destination\neth1 00000000\n");
    let shared = network(ALL_RIGHTS, "eth1");
    let says: Vec<_> = shared.iter().filter(|one| one.health != Health::Good).collect();
    assert!(says.iter().any(|one| one.says.contains("1000 Mbit/s")), "{says:?}");
    assert!(says.iter().any(|one| one.says.contains("uses eth1 as well")), "{says:?}");
    write(root.path(), &format!("{folder}/carrier"), "0");
    let dead = network(ALL_RIGHTS, "eth1");
    assert!(dead.iter().any(|one| one.says.contains("no link")), "{dead:?}");
}

#[test]
fn hal_and_its_component_belong_to_this_build() {
    let root = computer(&GOOD);
    let wanted = ExaminationOptions { uses_hal: true, ..options() };
    let hal = |root: &TempDir, rights| {
        let all = found(root, rights, &wanted);
        of(&all, Topic::Hal).into_iter().cloned().collect::<Vec<_>>()
    };
    assert_eq!(hal(&root, ALL_RIGHTS)[0].health, Health::Wrong, "LinuxCNC is not there");
    let root_user = Rights { is_root: true, ..ALL_RIGHTS };
    write(root.path(), "usr/bin/rtapi_app", "");
    let status =
        "Package: adduser\nVersion: 3\n\nPackage: linuxcnc-uspace\nStatus: ok\nVersion: 1:2.9.4\n";
    write(root.path(), "var/lib/dpkg/status", status);
    let module = "usr/lib/linuxcnc/modules/leadscrew.so";
    let of_build = |mark: &str| format!("ELF leadscrew-build:\0 {mark} more");
    let own = String::from_utf8_lossy(&shm::BUILD_MARK).into_owned();
    write(root.path(), module, &of_build(&own));
    let all = hal(&root, root_user);
    assert!(all.iter().all(|one| one.health == Health::Good), "{all:#?}");
    assert!(all[0].says.contains("1:2.9.4"), "{all:#?}");
    for (mark, word) in [("leadscrew-build:0123456789abcdef", "another build"), ("", "older")] {
        write(root.path(), module, &of_build(mark));
        let all = hal(&root, root_user);
        let wrong: Vec<_> = all.iter().filter(|one| one.health == Health::Wrong).collect();
        assert!(wrong.len() == 1 && wrong[0].says.contains(word), "{all:#?}");
    }
}

#[test]
fn a_computer_that_says_nothing_is_not_called_good() {
    let all = found(&computer(&[]), ALL_RIGHTS, &options());
    for topic in [Topic::Kernel, Topic::Clock, Topic::Idle] {
        assert_eq!(of(&all, topic)[0].health, Health::Unknown, "{topic:?}");
    }
}

#[test]
fn every_period_is_counted_once_and_a_late_one_is_said_at_the_tap() {
    let period = Time::s(500e-6);
    let asked = LatencyOptions { period, lasts: Time::s(0.1), under_load: true, priority: 80 };
    let latency = measure(&asked, &AtomicBool::new(false), &|_| ()).expect("a thread starts");
    assert_eq!(latency.periods, 200);
    assert_eq!(latency.histogram.iter().sum::<u64>(), 200);
    assert!(latency.quantile(0.5) <= latency.quantile(0.99));
    let examined = examine(&Computer::at("/nowhere"), ALL_RIGHTS, &options());
    let mut late = latency.clone();
    // 1 mm · 50 rev/s · 2 ms
    (late.worst, late.missed) = (Time::s(2e-3), 7);
    let examined = examined.with_latency(late);
    let finding = examined.findings.last().expect("the latency's");
    assert_eq!(finding.health, Health::Wrong);
    assert!(finding.says.contains("100.0 µm behind its thread. 7 began"), "{}", finding.says);
    let stopped = measure(&asked, &AtomicBool::new(true), &|_| ());
    assert!(
        stopped
            .map_or_else(|why| why.to_string().contains("interrupted"), |some| some.periods < 200)
    );
}
