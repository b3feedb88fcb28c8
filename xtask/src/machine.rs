//! Machine of a measurement.

use std::fs;

/// The last core that this process may use; the first one handles interrupts. `None` if the system does not say.
pub fn core() -> Option<usize> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    last_of(status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"))?)
}

/// Returns the last number of a list such as `0-3,8`.
fn last_of(list: &str) -> Option<usize> {
    list.trim().rsplit([',', '-']).next()?.parse().ok()
}

/// Name of the processor.
pub fn processor() -> String {
    field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Instruction sets of the processor: programs compiled for other sets must be compiled again.
pub fn instruction_sets() -> String {
    field("flags").or_else(|| field("Features")).unwrap_or_default()
}

fn field(name: &str) -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with(name))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::last_of;

    #[test]
    fn lists_of_cores_end_where_they_end() {
        assert_eq!(last_of("\t0-3,8-11\n"), Some(11));
        assert_eq!(last_of("2"), Some(2));
        assert_eq!(last_of(""), None);
    }
}
