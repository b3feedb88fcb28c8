//! Keys of the cell file that other tests omit: a good case and three bad ones each, with message and line.

use crate::common::{HEAD, rail};
use elbowroom_cell::Cell;
use elbowroom_spatial::Pose;

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
const CLOUD: &str = "[cloud.mast]\npose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }\narea = [[750, -3000], [4800, -3000], [4800, 3000]]";
const SPHERE: &str = "[region.ball]\nshape = \"sphere\"\nradius = 100\nwarning = 50";
const ENCODER: &str = "[encoder.belt]\nspeed = 200";
const CAMERA: &str = "[camera.top]\nsize = [640, 480]\nfocal_px = 500\npose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }\n\
                      area = [[750, -3000], [4800, -3000], [4800, 3000]]";
const FOLLOWING: &str = "[region.ball]\nshape = \"sphere\"\ncentre = [0, 0, 500]\nradius = 100\nwarning = 50";
const CASES: &[Case] = &[
    (
        "robot",
        "overshoot = 10",
        [
            ("overshoot = -1", "must be 0 or more, not -1", "overshoot = 0"),
            ("overshoot = 501", "overshoot its limits by 501 mm", "at most 500 mm"),
            ("overshoot = [10, 10]", "has 2 values for 1 joints", "a list with one per joint"),
        ],
    ),
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
        CLOUD,
        "to_floor = false",
        [
            ("to_floor = 0", "must be true or false", "to_floor = true"),
            ("to_floor = \"no\"", "must be true or false", "to_floor = true"),
            ("to_flor = true", "no key `to_flor`", "to_floor"),
        ],
    ),
    (
        SPHERE,
        "center = [0, 0, 500]",
        [
            ("center = [0, 0]", "needs 3 numbers", "center"),
            ("center = 3", "must be a list", "center"),
            ("center = [0, 0, nan]", "NaN", "finite"),
        ],
    ),
    (
        FOLLOWING,
        "follow = { object = \"cart\", max_turn = 90 }",
        [
            ("follow = { object = \"cart\", max_turn = 0 }", "above 0", "max_turn"),
            ("follow = { object = \"cart\", max_turn = \"fast\" }", "must be a number", "max_turn"),
            ("follow = { object = \"cart\", max_turns = 3 }", "no key `max_turns`", "max_turn"),
        ],
    ),
    (
        ENCODER,
        "wrap = 500",
        [
            ("wrap = 0", "above 0", "wrap"),
            ("wrap = \"turn\"", "must be a number", "wrap"),
            ("wraps = 500", "no key `wraps`", "wrap"),
        ],
    ),
    (
        ENCODER,
        "measured = true",
        [
            ("measured = 1", "must be true or false", "measured = true"),
            ("measured = \"yes\"", "must be true or false", "measured = true"),
            ("measurd = true", "no key `measurd`", "measured"),
        ],
    ),
    (
        CAMERA,
        "center_px = [320, 240]",
        [
            ("center_px = [320]", "needs 2 numbers", "centre_px"),
            ("center_px = 320", "must be a list", "centre_px"),
            ("center_pix = [320, 240]", "no key `center_pix`", "center_px"),
        ],
    ),
    (
        "[monitor]",
        "recovery = 5",
        [
            ("recovery = 101", "0 to 100, not 101", "recovery"),
            ("recovery = -1", "0 to 100, not -1", "recovery"),
            ("recovery = true", "must be a number", "recovery"),
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
                    let hinted = e.hint.as_deref().is_some_and(|h| h.contains(hint));
                    if e.line != Some(at) || !e.message.contains(what) || !hinted {
                        wrong.push(format!("{line} at {at}: {e}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const TRIANGLES: &str = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

#[test]
fn a_mesh_has_the_unit_that_is_named() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cart.obj"), TRIANGLES).unwrap();
    let file = dir.path().join("cell.toml");
    let cell = |line: &str| {
        let text = format!("{HEAD}{}[object.cart]\nshape = \"mesh\"\nmesh = \"cart.obj\"\n{line}\n", rail("r", 0.0));
        let at = text.lines().position(|l| l == line).unwrap() + 1;
        (Cell::parse(&file, &text), at)
    };
    for (unit, length_m) in [("m", 100.0), ("mm", 0.1), ("cm", 1.0), ("in", 2.54)] {
        let (read, _) = cell(&format!("mesh_unit = \"{unit}\""));
        let read = read.unwrap();
        let bounds = read.objects[0].shape.aabb(&Pose::IDENTITY);
        assert!((bounds.max.x - length_m).abs() < 1e-9 * length_m.max(1.0), "{unit}: {bounds:?}");
    }
    for (line, what, hint) in [
        ("mesh_unit = \"km\"", "cannot be \"km\"", "mm"),
        ("mesh_unit = 0.001", "must be one of", "mesh_unit"),
        ("mesh_units = \"mm\"", "no key `mesh_units`", "mesh_unit"),
    ] {
        let (read, at) = cell(line);
        let e = read.unwrap_err();
        assert!(e.message.contains(what) && e.hint.as_deref().unwrap_or("").contains(hint), "{line}: {e}");
        assert_eq!(e.line, Some(at), "{line}");
    }
}

#[test]
fn the_overshoot_of_the_file_is_in_the_units_of_each_joint() {
    let robot = |key: &str| {
        let text = format!(
            "{HEAD}[robot.r]\ndh = [{{ min = -90, max = 90, speed = 90 }}, {{ kind = \"prismatic\", min = 0, max = 500, speed = 90 }}]\n{key}\n"
        );
        Cell::parse("cell.toml", &text).unwrap_or_else(|e| panic!("{e}"))
    };
    let tolerances = |key: &str| {
        let chain = robot(key).robots[0].robot.chain.clone();
        chain.active_joints().iter().map(|id| chain.joints()[id.0].limits.overshoot_tolerance).collect::<Vec<_>>()
    };
    assert_eq!(tolerances(""), [None, None]);
    assert_eq!(tolerances("overshoot = 2"), [Some(2_f64.to_radians()), Some(0.002)]);
    assert_eq!(tolerances("overshoot = [0, 12]\nspeed = [30, 40]"), [Some(0.0), Some(0.012)]);
    // A change of the tolerance needs a new approval; a file without the key keeps its checksum.
    let checksum = |key: &str| robot(key).approval.checksum;
    assert_ne!(checksum("overshoot = 2"), checksum(""));
    assert_ne!(checksum("overshoot = 2"), checksum("overshoot = 3"));
    assert_eq!(checksum("overshoot = 2"), checksum("overshoot = [2, 2]"));
}

#[test]
fn what_is_measured_moves_by_itself_and_has_another_seal() {
    let text = |belt: &str, parcel: &str, plane: &str| {
        format!(
            "{HEAD}{}{ENCODER}\n{belt}\n[object.parcel]\nshape = \"box\"\nsize = [100, 100, 100]\nat = [0, 0, 900]\n\
             {parcel}\n[object.floor]\nshape = \"plane\"\nat = [0, 0, -900]\n{plane}\n\
             {FOLLOWING}\nfollow = {{ object = \"parcel\" }}\n",
            rail("r", 0.0)
        )
    };
    let cell = |belt: &str, parcel: &str, plane: &str| Cell::parse("cell.toml", &text(belt, parcel, plane));
    let on_belt = "follow = { encoder = \"belt\" }";
    let seal = |belt: &str, parcel: &str| cell(belt, parcel, "").map(|cell| cell.approval.checksum).unwrap();
    // A region on what is measured is another region: it is not where the file says.
    assert_ne!(seal("", on_belt), seal("measured = true", on_belt));
    assert_ne!(seal("", ""), seal("", "measured = true"));
    assert_eq!(seal("", on_belt), seal("measured = false", on_belt));
    assert_eq!(seal("", ""), seal("measured = true", ""));
    for (wrong, what) in [
        (cell("", &format!("{on_belt}\nmeasured = true"), ""), "contradicts `follow`"),
        (cell("", "", "measured = true"), "moves a plane"),
    ] {
        let error = wrong.unwrap_err();
        assert!(error.message.contains(what) && error.line.is_some() && error.hint.is_some(), "{error}");
    }
    assert!(cell("", "", "measured = false").is_ok());
}
