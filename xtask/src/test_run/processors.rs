//! Idle time of the machine's processors.

use std::time::Duration;

/// Working and idle times of all processors together since the machine was started, in units of the system.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Times {
    all: u64,
    idle: u64,
}

/// Fraction of idle time of the processors during `period`; `None` if the system does not report it.
pub fn idle_share(period: Duration) -> Option<f64> {
    let read = || std::fs::read_to_string("/proc/stat").ok().as_deref().and_then(parse);
    let before = read()?;
    std::thread::sleep(period);
    share(before, read()?)
}

fn share(before: Times, after: Times) -> Option<f64> {
    let all = after.all.checked_sub(before.all).filter(|&all| all > 0)?;
    Some(after.idle.saturating_sub(before.idle) as f64 / all as f64)
}

/// Parses the line `cpu user nice system idle iowait …`.
fn parse(text: &str) -> Option<Times> {
    let line = text.lines().find_map(|line| line.strip_prefix("cpu "))?;
    // The user time includes the time of guests.
    let times: Vec<u64> = line.split_whitespace().take(8).map(str::parse).collect::<Result<_, _>>().ok()?;
    Some(Times { all: times.iter().sum(), idle: times.get(3)? + times.get(4)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_time_is_read_from_the_line_of_all_processors() {
        let before = parse("cpu  10 1 5 100 4 0 0 0 7 0\ncpu0 1 1 1 1 1 0 0 0 0 0\n").unwrap();
        assert_eq!(before, Times { all: 120, idle: 104 });
        let after = Times { all: 220, idle: 134 };
        assert_eq!(share(before, after), Some(0.3));
        assert_eq!(share(before, before), None);
        assert_eq!(parse("cpu0 1 2 3 4 5"), None);
    }
}
