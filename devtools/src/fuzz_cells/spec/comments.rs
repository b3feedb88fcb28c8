//! Settings that no cell file has, in its comments: faults of the input, and the option `--repeat`.

use std::fmt::Write as _;

use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind};

/// Prefix of the lines of a cell file that `--replay` reads as faults.
const FAULT: &str = "# fault:";
/// Prefix of the line with the option `--repeat` of the run.
const REPEAT: &str = "# run --repeat";

pub(super) fn write_repeat(t: &mut String, repeat: u32) {
    if repeat > 1 {
        let _ = writeln!(t, "{REPEAT} {repeat}");
    }
}

pub(super) fn write_fault(t: &mut String, f: &InputFault) {
    let InputFault { robot: RobotId(robot), from_s, to_s, kind } = f;
    let kind = match kind {
        InputFaultKind::Delayed { by_s } => format!("late {by_s}"),
        InputFaultKind::Lost { timeout_s } => format!("lost {timeout_s}"),
        InputFaultKind::Frozen => "frozen".to_owned(),
        InputFaultKind::Jump { joint, by } => format!("jump {joint} {by}"),
        InputFaultKind::NotANumber => "not_a_number".to_owned(),
    };
    let _ = writeln!(t, "{FAULT} {robot} {from_s} {to_s} {kind}");
}

/// Reads from the comments of a cell file how often the programs run.
pub fn read_repeat(text: &str) -> Result<u32, String> {
    let Some(value) = text.lines().find_map(|line| line.trim().strip_prefix(REPEAT)) else { return Ok(1) };
    value.trim().parse().map_err(|_| format!("`{REPEAT}{value}`: write a whole number"))
}

/// Reads the faults in the comments of a cell file.
pub fn read_faults(text: &str) -> Result<Vec<InputFault>, String> {
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix(FAULT));
    lines
        .map(|line| read_fault(line).ok_or_else(|| format!("`{FAULT}{line}`: write `{FAULT} ROBOT FROM TO KIND …`")))
        .collect()
}

fn read_fault(line: &str) -> Option<InputFault> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words.get(i)?.parse::<f64>().ok();
    let kind = match *words.get(3)? {
        "late" => InputFaultKind::Delayed { by_s: number(4)? },
        "lost" => InputFaultKind::Lost { timeout_s: number(4)? },
        "frozen" => InputFaultKind::Frozen,
        "jump" => InputFaultKind::Jump { joint: words.get(4)?.parse().ok()?, by: number(5)? },
        "not_a_number" => InputFaultKind::NotANumber,
        _ => return None,
    };
    let robot = RobotId(words.first()?.parse().ok()?);
    Some(InputFault { robot, from_s: number(1)?, to_s: number(2)?, kind })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_written_and_read() {
        let kinds = [
            InputFaultKind::Delayed { by_s: 0.01 },
            InputFaultKind::Lost { timeout_s: 0.0 },
            InputFaultKind::Frozen,
            InputFaultKind::Jump { joint: 2, by: -0.3 },
            InputFaultKind::NotANumber,
        ];
        let faults = kinds.map(|kind| InputFault { robot: RobotId(1), from_s: 0.5, to_s: 0.75, kind });
        let mut text = String::new();
        for fault in &faults {
            write_fault(&mut text, fault);
        }
        assert_eq!(read_faults(&text).unwrap(), faults);
        assert!(read_faults("# fault: 0 1").is_err());
    }

    #[test]
    fn a_repeat_is_written_and_read() {
        let mut text = String::from("version = 1\n");
        write_repeat(&mut text, 1);
        assert_eq!(read_repeat(&text), Ok(1));
        write_repeat(&mut text, 3);
        assert_eq!(read_repeat(&text), Ok(3));
        assert!(read_repeat("# run --repeat often").is_err());
    }
}
