//! `[grid.NAME]`: what the monitors of a cell get, and errors.

use crate::common::{HEAD, rail};
use elbowroom_cell::{Cell, configure};
use elbowroom_monitor::{GridSpace, Monitor, OutputGrid, OutputGridAxis, Snapshot};
use elbowroom_spatial::Vec3;

const BOX: &str = "[grid.area]\nfrom = [600, -200, 400]\nto = [-400, 200, -400]\ncells = [5, 2, 1]\noutput = 4\n";

fn cell(text: &str) -> Cell {
    Cell::parse("test.toml", &format!("{HEAD}{}{text}", rail("a", 0.0))).unwrap_or_else(|e| panic!("{e}"))
}

fn grids(text: &str) -> Vec<OutputGrid> {
    configure::setups(&cell(text)).unwrap()[0].configuration.grids().to_vec()
}

#[test]
fn a_box_is_placed_as_a_region_of_the_same_corners_is() {
    let turned = format!("{BOX}rpy = [10, 20, 30]\n");
    let region = BOX.replace("cells = [5, 2, 1]\noutput = 4\n", "rpy = [10, 20, 30]\nwarning = 10\n");
    let region = region.replace("[grid.area]", "[region.same]\nshape = \"box\"");
    let with_region = cell(&format!("{turned}{region}"));
    let grid = &with_region.monitoring.grids[0].grid;
    let GridSpace::Tcp { frame_in_world } = &grid.space else { panic!("{grid:?}") };
    let anchor = with_region.regions[0].region.anchor;
    assert!(frame_in_world.translation.distance(anchor.translation) < 1e-12);
    assert!((frame_in_world.rotation.inverse() * anchor.rotation).angle() < 1e-9);
    let ends: Vec<_> = grid.axes.iter().map(|a| (a.from, a.to, a.count)).collect();
    assert_eq!(ends, [(-0.5, 0.5, 5), (-0.2, 0.2, 2), (0.0, 0.8, 1)]);
    assert_eq!((grid.output, grid.hysteresis, grid.channels()), (4, 1e-3, 4..8));
    // Through the monitor: the TCP of the rail, whose x is its joint value.
    let plain = cell(BOX);
    let setup = &configure::setups(&plain).unwrap()[0];
    let mut monitor = Monitor::new(setup.configuration.clone(), None).unwrap();
    // Along y the rail is at the border of two cells, which belongs to the upper one. Beyond 0.6 m it stays within the
    // hysteresis, and from outside it enters only at the border.
    let places = [(-0.45, None), (-0.39, Some(0)), (0.05, Some(2)), (0.599, Some(4)), (0.6005, Some(4))];
    let places = places.into_iter().chain([(0.602, None), (0.6005, None), (0.5, Some(4))]);
    for (i, (q, place)) in places.enumerate() {
        monitor.forget_position();
        let outputs = monitor.tick(&Snapshot::stationary(0.002 * i as f64, &[q])).outputs;
        let tcp = plain.robots[0].base_in_world * plain.robots[0].tcp_in_root(&[q]);
        assert!(tcp.translation.distance(Vec3::X * q) < 1e-12);
        let expected = place.map_or(0, |place| 1 + place + 5);
        assert_eq!(setup.configuration.grids()[0].number_in(outputs), expected, "at {q}");
    }
}

#[test]
fn joints_have_their_limits_and_the_units_of_the_file() {
    let whole = grids("[grid.g]\njoints = [\"joint_1\"]\ncells = [4]\noutput = 0\n");
    let joint = &cell("").robots[0].robot.chain;
    assert_eq!(whole[0].axes, [OutputGridAxis { from: joint.lower()[0], to: joint.upper()[0], count: 4 }]);
    let part = "[grid.g]\njoints = [\"joint_1\"]\nfrom = [100]\nto = [700]\ncells = [4]\noutput = 0\nhysteresis = 5\n";
    assert_eq!(grids(part)[0].axes, [OutputGridAxis { from: 0.1, to: 0.7, count: 4 }]);
    assert_eq!((grids(part)[0].hysteresis, &grids(part)[0].space), (0.005, &GridSpace::Joints(vec![0])));
}

#[test]
fn what_is_no_grid_is_refused_with_its_line() {
    let line = format!("{HEAD}{}", rail("a", 0.0)).lines().count();
    let joints = "[grid.area]\njoints = [\"joint_1\"]\ncells = [3]\noutput = 4\n";
    let region = "[region.x]\nshape = \"sphere\"\ncentre = [0, 900, 0]\nradius = 10\nwarning = 10\noutput = 6\n";
    let other = BOX.replace("area", "other").replace("output = 4", "output = 7");
    let many = "cells = [300, 300, 1]";
    for (text, at, what, hint) in [
        (BOX.replace("cells", "cels"), 4, "no key `cels`", "cells"),
        (BOX.replace("cells = [5, 2, 1]\n", ""), 1, "needs the key `cells`", "cells = [4, 3, 1]"),
        (BOX.replace("output = 4\n", ""), 1, "needs the key `output`", "output = 8"),
        (BOX.replace("[5, 2, 1]", "[5, 2]"), 4, "2 numbers for 3 axes", "1 leaves an axis undivided"),
        (BOX.replace("[5, 2, 1]", "[5, 2, 0]"), 4, "cells", "1"),
        (BOX.replace("-400]", "400]"), 3, "has no volume", "differ in x, y and z"),
        (BOX.replace("output = 4", "output = 61"), 5, "numbers up to 10 take 4 outputs", "output = 60"),
        (BOX.replace("cells = [5, 2, 1]", many) + "hysteresis = 0\n", 4, "makes 90000 cells", "fewer divisions"),
        (
            format!("{BOX}hysteresis = 150\n"),
            6,
            "is 150 mm, more than half of a cell of 200 mm",
            "a smaller `hysteresis`",
        ),
        (format!("{BOX}robots = []\n"), 6, "is empty", "leave it out"),
        (format!("{BOX}robots = [\"b\"]\n"), 6, "the robot \"b\"", "a"),
        (format!("{BOX}{region}"), 1, "region `x` has one of its outputs 4 to 7", "another `output`"),
        (format!("{BOX}{other}"), 6, "grid `area` has one of its outputs 7 to 10", "another `output`"),
        (joints.replace("joint_1", "joint_7"), 2, "the joint \"joint_7\"", "joint_1"),
        (joints.replace("[\"joint_1\"]", "[]"), 2, "is empty", "joints = "),
        (joints.replace("[\"joint_1\"]", "[\"joint_1\", \"joint_1\"]"), 2, "is named twice", "once"),
        (format!("{joints}from = [1, 2]\n"), 5, "2 values for 1 joints", "one value per joint"),
        (format!("{joints}from = [5]\nto = [5]\n"), 6, "they would go from 5 mm to 5 mm", "from < to"),
        (format!("{joints}from = [2000]\n"), 5, "they would go from 2000 mm to 2000 mm", "from < to"),
        (format!("{joints}rpy = [0, 0, 1]\n"), 5, "turns a box", "one of the two"),
    ] {
        let e = Cell::parse("test.toml", &format!("{HEAD}{}{text}", rail("a", 0.0))).unwrap_err();
        assert_eq!(e.line, Some(line + at), "{e}\n{text}");
        assert!(e.to_string().contains(what) && e.hint.as_deref().unwrap_or_default().contains(hint), "{e}\n{text}");
    }
}
