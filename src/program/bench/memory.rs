//! How much memory this process holds.

use std::fs;

/// Memory of a system of grains, from what the operating system says of the
/// whole process. Only Linux says it in a file; elsewhere nothing is known.
pub(super) struct Memory {
    /// Resident bytes before there was any grain.
    empty: Option<u64>,
}

impl Memory {
    /// Before anything is made.
    pub(super) fn before() -> Self {
        Memory {
            empty: read("VmRSS:"),
        }
    }

    /// Forgets what was needed up to now: what has to be let go of again, such as
    /// a generator's working space, is no memory of the simulation.
    pub(super) fn forget_peak(&self) {
        // Where it can't be written, the peak is that of the whole process.
        let _ = fs::write("/proc/self/clear_refs", "5");
    }

    /// The most that was resident since then, above what there was before any
    /// grain, in bytes for each of `count` grains.
    pub(super) fn peak_each(&self, count: usize) -> Option<f64> {
        self.each("VmHWM:", count)
    }

    /// What is resident now, likewise.
    pub(super) fn now_each(&self, count: usize) -> Option<f64> {
        self.each("VmRSS:", count)
    }

    fn each(&self, what: &str, count: usize) -> Option<f64> {
        let more = read(what)?.saturating_sub(self.empty?);
        Some(more as f64 / count as f64)
    }
}

/// A line of this process's status, in bytes.
fn read(what: &str) -> Option<u64> {
    in_bytes(&fs::read_to_string("/proc/self/status").ok()?, what)
}

fn in_bytes(status: &str, what: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(what))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_and_bytes_counted() {
        let status = "Name:\tgrainfall\nVmHWM:\t   12345 kB\nVmRSS:\t     678 kB\n";
        assert_eq!(in_bytes(status, "VmHWM:"), Some(12_641_280));
        assert_eq!(in_bytes(status, "VmRSS:"), Some(694_272));
        assert_eq!(in_bytes(status, "VmSwap:"), None);
        assert_eq!(in_bytes("VmRSS:\tmany kB\n", "VmRSS:"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_system_of_known_size_is_found() {
        let memory = Memory::before();
        memory.forget_peak();
        let grains = vec![1u8; 1 << 26];
        let held = memory.now_each(grains.len());
        let peak = memory.peak_each(grains.len());
        // Other tests in the same process may hold memory and let go of it.
        assert!(held.is_some_and(|bytes| bytes > 0.5), "{held:?}");
        assert!(peak >= held, "{peak:?} {held:?}");
    }
}
