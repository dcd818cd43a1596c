//! The memory available to this process, so that work that cannot fit is refused before it begins.

use std::fs::read_to_string;

/// The number of bytes available to the process: the least of the free memory of the machine, of its control group, and of its address
/// space. `None` if the system does not report it.
pub fn available() -> Option<u64> {
    let file = |path: &str| read_to_string(path).ok();
    let free = file("/proc/meminfo").and_then(|text| free(&text));
    let address_space = file("/proc/self/limits").zip(file("/proc/self/status"));
    let left = address_space.and_then(|(limits, status)| left_of_address_space(&limits, &status));
    [free, left, left_to_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current")]
        .into_iter()
        .flatten()
        .min()
}

/// Why `needed` bytes are too many, in words; `None` if they fit or the system does not report its memory.
pub fn shortage(needed: u64) -> Option<String> {
    let available = available().filter(|available| needed > *available)?;
    Some(format!("about {} are needed, {} are there", in_words(needed), in_words(available)))
}

/// A number of bytes, in words.
pub fn in_words(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes < 1e9 => format!("{:.0} MB", bytes / 1e6),
        bytes if bytes < 1e15 => format!("{:.1} GB", bytes / 1e9),
        bytes => format!("{:.1e} GB", bytes / 1e9),
    }
}

/// Free memory and swap of the machine, of /proc/meminfo.
fn free(text: &str) -> Option<u64> {
    Some(kilobytes(text, "MemAvailable:")? + kilobytes(text, "SwapFree:").unwrap_or(0))
}

/// The remainder of the limit of the address space (`ulimit -v`).
fn left_of_address_space(limits: &str, status: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kilobytes(status, "VmSize:")?))
}

/// The remainder of the limit of the control group, if it has one.
fn left_to_group(limit: &str, taken: &str) -> Option<u64> {
    let number = |path: &str| read_to_string(path).ok()?.trim().parse::<u64>().ok();
    Some(number(limit)?.saturating_sub(number(taken)?))
}

/// The largest memory of this process so far, if the system reports it.
pub fn peak() -> Option<u64> {
    kilobytes(&read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The number of bytes in the line that begins with `name`, which is in kB.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024 * line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read() {
        assert_eq!(free("MemTotal: 9 kB\nMemAvailable:   100 kB\nSwapFree: 5 kB\n"), Some(105 * 1024));
        let limits = "Limit  Soft Limit  Hard Limit  Units\nMax address space         4096000  unlimited  bytes\n";
        assert_eq!(left_of_address_space(limits, "VmSize:\t    1000 kB\n"), Some(4_096_000 - 1_024_000));
        assert_eq!(left_of_address_space("Max address space  unlimited  unlimited  bytes", "VmSize: 1 kB"), None);
        assert_eq!(left_to_group("/nowhere", "/nowhere"), None);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        assert_eq!(shortage(1), None);
        assert_eq!(in_words(528_000_000_000), "528.0 GB");
        assert_eq!(in_words(12_300_000), "12 MB");
    }
}
