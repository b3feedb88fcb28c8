//! Errors for infeasible programs; randomly corrupted cell files never panic.

use crate::common::{ARM, HEAD, valid_cell};
use elbowroom_cell::Cell;
use elbowroom_sim::{RunOptions, simulate};
use proptest::prelude::*;

#[test]
fn the_error_of_an_unreachable_line_states_where_it_fails() {
    let text = format!(
        "{HEAD}[robot.arm]\n{ARM}start = [0, 0, 0, 0, 40, 0]\n[program.arm]\nsteps = [\n\
         {{ move = \"linear\", to = {{ at = [4000, 0, 900], rpy = [180, 0, 0] }} }},\n]\n"
    );
    let cell = Cell::parse("t.toml", &text).unwrap();
    let e = simulate(&cell, &RunOptions::default()).unwrap_err();
    assert!(e.message.contains("step 1") && e.message.contains("beyond") && e.message.contains(" mm"), "{e}");
    let line = text.lines().position(|l| l.contains("move = \"linear\"")).unwrap() + 1;
    assert_eq!(e.line, Some(line));
}

/// Never a panic; a cell that still parses is also simulated for a few ticks.
fn parse_and_run(text: &str) {
    if let Ok(mut cell) = Cell::parse("fuzz.toml", text) {
        cell.timing.max_s = 0.02;
        let _ = simulate(&cell, &RunOptions::default());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn corrupted_bytes_never_panic(at in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 1..6)) {
        let mut bytes = valid_cell().into_bytes();
        for (share, byte) in at {
            let i = (share * bytes.len() as f64) as usize;
            bytes[i] = byte;
        }
        parse_and_run(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn reordered_and_repeated_lines_never_panic(moves in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<bool>()), 1..5)) {
        let text = valid_cell();
        let mut lines: Vec<&str> = text.lines().collect();
        for (from, to, keep) in moves {
            let line = if keep { lines[from.index(lines.len())] } else { lines.remove(from.index(lines.len())) };
            lines.insert(to.index(lines.len()), line);
        }
        parse_and_run(&lines.join("\n"));
    }

    #[test]
    fn extreme_numbers_never_panic(which in any::<prop::sample::Index>(), number in prop::sample::select(vec!["0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "9223372036854775807", "1e20", "0x7fffffff", "-0.0"])) {
        let text = valid_cell();
        let digits: Vec<(usize, &str)> = text.match_indices(|c: char| c.is_ascii_digit()).collect();
        let (at, _) = digits[which.index(digits.len())];
        let end = at + text[at..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(1);
        parse_and_run(&format!("{}{number}{}", &text[..at], &text[end..]));
    }
}
