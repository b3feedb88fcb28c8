//! Keys of the cell file that other tests leave out: a good case and three bad ones each, with message and line.

mod common;

use common::{HEAD, rail};
use elbowroom_cell::Cell;

/// A cell with a robot, an object that moves, and a table that has one more line.
fn cell(table: &str, line: &str) -> String {
    let cart = "[object.cart]\nshape = \"box\"\nat = [0, 3000, 0]\nsize = [100, 100, 100]\nmotion = { via = [[0, -3000, 0]], speed = 500 }\n";
    match table {
        "top" => format!("{HEAD}{line}\n{}{cart}", rail("r", 0.0)),
        "robot" => format!("{HEAD}{}{line}\n{cart}", rail("r", 0.0)),
        _ => format!("{HEAD}{}{cart}{table}\n{line}\n", rail("r", 0.0)),
    }
}

/// Table, good line, then bad lines with words of the message and of the hint.
type Case = (&'static str, &'static str, [(&'static str, &'static str, &'static str); 3]);

const AVOIDANCE: &str = "[avoidance.r]";
const CASES: &[Case] = &[
    (
        AVOIDANCE,
        "horizon = 2.5",
        [
            ("horizon = 11", "is 11, and can be 0 to 10 s", "0: no prediction"),
            ("horizon = -1", "is -1, and can be 0 to 10 s", "horizon = 3"),
            ("horizon = \"3 s\"", "must be a number", "horizon"),
        ],
    ),
    (
        AVOIDANCE,
        "noise = 10",
        [
            ("noise = 600", "is 600, and can be 0 to 500", "standard deviation"),
            ("noise = -1", "is -1, and can be 0 to 500", "noise = 10"),
            ("noise = [1, 1, 1]", "must be a number", "noise"),
        ],
    ),
    (
        AVOIDANCE,
        "delay_ms = 60",
        [
            ("delay_ms = 2001", "is 2001, and can be 0 to 2000 ms", "delay_ms = 60"),
            ("delay_ms = nan", "NaN", "finite"),
            ("delay = 60", "no key `delay`", "delay_ms"),
        ],
    ),
    (
        AVOIDANCE,
        "plan_ms = 0",
        [
            ("plan_ms = 10001", "is 10001, and can be 0 to 10000 ms", "plan_ms = 70"),
            ("plan_ms = -1", "is -1, and can be 0 to 10000 ms", "computing time"),
            ("plan_ms = true", "must be a number", "plan_ms"),
        ],
    ),
    (
        AVOIDANCE,
        "return_speed = 40",
        [
            ("return_speed = 0.5", "is less than 1 percent", "return_speed = 50"),
            ("return_speed = 101", "0 to 100, not 101", "return_speed = 50"),
            ("return_speed = \"slow\"", "must be a number", "return_speed"),
        ],
    ),
    (
        AVOIDANCE,
        "stall_timeout = 1",
        [
            ("stall_timeout = 61", "is 61 s, and can be 0.01 to 60 s", "stall_timeout = 0.6"),
            ("stall_timeout = 0", "above 0", "stall_timeout"),
            ("stall_timeout = [1]", "must be a number", "stall_timeout"),
        ],
    ),
    (
        AVOIDANCE,
        "replan = false",
        [
            ("replan = 0", "must be true or false", "replan = true"),
            ("replan = \"no\"", "must be true or false", "replan = true"),
            ("replans = true", "no key `replans`", "replan"),
        ],
    ),
    (
        AVOIDANCE,
        "objects = [\"cart\"]",
        [
            ("objects = [\"card\"]", "card", "cart"),
            ("objects = \"cart\"", "must be a list", "objects = [\"cart\"]"),
            ("objects = [3]", "must be a text", "\""),
        ],
    ),
    (
        "robot",
        "jerk = 30",
        [
            ("jerk = -1", "above 0", "jerk"),
            ("jerk = [1, 2, 3]", "3 values for", "one per joint"),
            ("jerk = \"soft\"", "must be", "jerk"),
        ],
    ),
    (
        "top",
        "max_s = 30",
        [
            ("max_s = 0", "above 0", "max_s"),
            ("max_s = \"long\"", "must be a number", "max_s"),
            ("max = 30", "no key `max`", "max_s"),
        ],
    ),
];

#[test]
fn keys_have_a_good_case_and_three_bad_ones_at_their_line() {
    let mut wrong = Vec::new();
    for (table, good, bad) in CASES {
        if let Err(e) = Cell::parse("cell.toml", &cell(table, good)) {
            wrong.push(format!("{good}: {e}"));
        }
        for (line, what, hint) in bad {
            let text = cell(table, line);
            let at = text.lines().position(|l| l == *line).unwrap() + 1;
            match Cell::parse("cell.toml", &text) {
                Ok(_) => wrong.push(format!("{line}: accepted")),
                Err(e) => {
                    let hinted = e.write_instead.as_deref().is_some_and(|h| h.contains(hint));
                    if e.line != Some(at) || !e.what.contains(what) || !hinted {
                        wrong.push(format!("{line} at {at}: {e}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
