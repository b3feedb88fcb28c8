//! Detection of numbers in another unit than the stated one.

use crate::common::{ARM, parse};
use elbowroom_cell::Cell;

/// A cell with lengths scaled by `k` and the unit `length`.
fn cell(length: &str, k: f64) -> String {
    let n = |v: f64| format!("{}", v * k);
    format!(
        "version = 1\nunits = {{ length = \"{length}\", angle = \"deg\" }}\n\
         [robot.a]\n{ARM}\n\
         [robot.a.tool]\ntcp = {{ at = [0, 0, {}] }}\nbox = {{ at = [0, 0, {}], size = [{1}, {1}, {}] }}\n\
         [object.floor]\nshape = \"box\"\nat = [0, 0, {}]\nsize = [{}, {4}, {}]\n\
         [object.fence]\nshape = \"box\"\nat = [{}, 0, {2}]\nsize = [{5}, {4}, {4}]\n\
         [region.column]\nshape = \"cylinder\"\nbase = [{}, 0, 0]\nradius = {}\nheight = {}\nwarning = {0}\n\
         [region.table]\nshape = \"plane\"\norigin = [0, 0, {}]\nx = [{0}, 0, {10}]\ny = [0, {0}, {10}]\nwarning = {0}\n",
        n(250.0),
        n(125.0),
        n(250.0),
        n(-30.0),
        n(6000.0),
        n(40.0),
        n(3500.0),
        n(1248.0),
        n(150.0),
        n(1200.0),
        n(-500.0),
    )
}

/// Like [`cell`] in metres, with the robot's own numbers converted from millimetres.
fn in_metres(k: f64) -> String {
    let metres = |text: &str| {
        // The rows of ARM in metres: `a`, `d`, the points and radii of capsules.
        let mut out = String::new();
        let mut rest = text;
        while let Some(i) = rest.find(|c: char| c.is_ascii_digit() || c == '-') {
            let (head, tail) = rest.split_at(i);
            let end = tail[1..].find(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(tail.len(), |e| e + 1);
            let angle = ["alpha = ", "theta = ", "min = ", "max = ", "speed = "].iter().any(|k| head.ends_with(k));
            let value: f64 = tail[..end].parse().unwrap();
            out += head;
            out += &(if angle { value } else { value / 1000.0 }).to_string();
            rest = &tail[end..];
        }
        out + rest
    };
    cell("m", k).replace(ARM, &metres(ARM))
}

fn warnings(text: &str) -> Vec<String> {
    parse(text).warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn the_right_unit_causes_no_warning() {
    assert_eq!(warnings(&cell("mm", 1.0)), Vec::<String>::new());
    assert_eq!(warnings(&in_metres(0.001)), Vec::<String>::new());
}

#[test]
fn millimetres_under_metres_are_named() {
    let all = warnings(&in_metres(1.0));
    let of = |what: &str| {
        let mut found = all.iter().filter(|w| w.contains(what));
        let one = found.next().unwrap_or_else(|| panic!("nothing on {what}: {all:#?}"));
        assert!(one.contains("units = { length = \"mm\", angle = \"deg\" }"), "{one}");
        one.clone()
    };
    for what in
        ["object \"floor\"", "object \"fence\"", "the tool of robot \"a\"", "the tool centre point of robot \"a\""]
    {
        of(what);
    }
    let column = of("region \"column\"");
    let text = in_metres(1.0);
    let line = text.lines().position(|l| l == "[region.column]").unwrap() + 1;
    assert!(column.starts_with(&format!("test.toml:{line}: ")), "{column}");
}

#[test]
fn a_region_1200_metres_away_causes_a_warning() {
    // Only the position is in millimetres.
    let text = in_metres(0.001).replace("base = [1.248, 0, 0]", "base = [1248, 0, 0]");
    let all = warnings(&text);
    assert_eq!(all.len(), 1, "{all:#?}");
    for words in ["region \"column\" is beyond reach", "1248 m away", "in mm, it would be 1.248 m"] {
        assert!(all[0].contains(words), "{}", all[0]);
    }
}

#[test]
fn metres_under_millimetres_are_named() {
    let all = warnings(&cell("mm", 0.001));
    for what in ["region \"column\"", "object \"floor\"", "object \"fence\"", "the tool of", "the tool centre point of"]
    {
        let one = all.iter().find(|w| w.contains(what)).unwrap_or_else(|| panic!("nothing on {what}: {all:#?}"));
        assert!(one.contains("units = { length = \"m\", angle = \"deg\" }"), "{one}");
    }
}

#[test]
fn a_region_out_of_reach_is_reported_without_an_implausible_unit() {
    let all = warnings(&cell("mm", 1.0).replace("base = [1248, 0, 0]", "base = [12480, 0, 0]"));
    assert!(all.len() == 1 && all[0].contains("beyond reach") && !all[0].contains("units ="), "{all:#?}");
    // Its warning zone reaches the robot.
    let zone = cell("mm", 1.0)
        .replace("base = [1248, 0, 0]", "base = [12480, 0, 0]")
        .replace("height = 1200\nwarning = 250", "height = 1200\nwarning = 9900");
    assert_eq!(warnings(&zone), Vec::<String>::new());
}

#[test]
fn regions_that_come_into_range_are_measured_exactly() {
    let cart = "[object.cart]\nshape = \"sphere\"\nat = [20000, 0, 500]\nradius = 100\nmotion = { via = [[1000, 0, 500]], speed = 1000 }\n";
    let ride = "[encoder.belt]\ndirection = [-1, 0, 0]\nspeed = 1000\n\
                [region.ride]\nshape = \"sphere\"\ncentre = [15000, 0, 500]\nradius = 100\nwarning = 50\nfollow = { encoder = \"belt\" }\n";
    assert_eq!(warnings(&format!("{}{cart}{ride}", cell("mm", 1.0))), Vec::<String>::new());
}

#[test]
fn the_example_cells_are_valid() {
    for name in
        ["figure12", "exchange", "fence", "conveyor", "full_speed", "guided", "inspection", "tool_box", "pallet"]
    {
        let file = elbowroom_testkit::folder::examples().join(name).join("cell.toml");
        assert_eq!(Cell::load(file).unwrap().warnings, [], "{name}");
    }
}
