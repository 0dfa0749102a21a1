//! Memory and processor time of this process, as the system counts them.

/// Bytes of memory that it has in use; `None`: this system does not say it.
pub(super) fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

/// Processor time that it has used, s.
pub(super) fn processor_s() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // the name of the program stands in brackets and may have blanks; user and system time are the
    // 14th and 15th field
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11).map(str::parse::<u64>);
    let ticks = times.next()?.ok()? + times.next()?.ok()?;
    Some(ticks as f64 / rustix::param::clock_ticks_per_second() as f64)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_system_says_memory_and_processor_time() {
        let before = processor_s().expect("a time");
        let mut sum = 0.0_f64;
        while processor_s().expect("a time") <= before {
            sum = (0..10_000).fold(sum, |sum, n| (sum + f64::from(n)).sqrt());
        }
        assert!(sum.is_finite());
        assert!(resident_bytes().is_some_and(|bytes| (1 << 20..1 << 40).contains(&bytes)));
    }
}
