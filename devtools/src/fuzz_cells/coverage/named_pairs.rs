//! Pairs of features that share state: cells must have them together.

use std::collections::BTreeSet;

use toml::{Table, Value};

use crate::fuzz_cells::spec::read_repeat;

/// A feature of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Tools that are exchanged.
    Tool,
    Region,
    Fence,
    Exchange,
    MovingRegion,
    /// A robot with a region on it.
    Carrier,
    Grip,
    Recording,
    Avoidance,
    /// A camera or a sensor of points whose obstacles robots avoid.
    Sensor,
    /// Programs that run more than once.
    Repeat,
    Grid,
    Belt,
    MovingObject,
    PlannedMove,
    LinearMove,
    TemporaryRegion,
}

/// Features that cells must have together.
pub const NAMED_PAIRS: &[[Feature; 2]] = &[
    [Feature::Tool, Feature::Region],
    [Feature::Tool, Feature::Exchange],
    [Feature::Grip, Feature::Region],
    [Feature::Grip, Feature::Exchange],
    [Feature::Recording, Feature::MovingRegion],
    [Feature::Avoidance, Feature::Carrier],
    [Feature::Sensor, Feature::Exchange],
    [Feature::Sensor, Feature::Region],
    [Feature::Sensor, Feature::PlannedMove],
    [Feature::Sensor, Feature::Recording],
    [Feature::Repeat, Feature::Tool],
    [Feature::Repeat, Feature::Region],
    [Feature::Repeat, Feature::Fence],
    [Feature::Repeat, Feature::Exchange],
    [Feature::Repeat, Feature::MovingRegion],
    [Feature::Repeat, Feature::Carrier],
    [Feature::Repeat, Feature::Grip],
    [Feature::Repeat, Feature::Recording],
    [Feature::Repeat, Feature::Grid],
    [Feature::Repeat, Feature::Belt],
    [Feature::Repeat, Feature::MovingObject],
    [Feature::Repeat, Feature::PlannedMove],
    [Feature::Repeat, Feature::LinearMove],
    [Feature::Repeat, Feature::TemporaryRegion],
];

/// The features of a cell file; `paths` are those of its keys.
pub fn features(text: &str, file: &Table, paths: &BTreeSet<String>) -> BTreeSet<Feature> {
    let has = |path: &str| paths.contains(path);
    let in_tables = |word: &str, is: &dyn Fn(&Table) -> bool| {
        let tables = file.get(word).and_then(Value::as_table).into_iter().flatten();
        tables.filter_map(|(_, table)| table.as_table()).any(is)
    };
    let with_word =
        |key: &'static str, word: &'static str| move |t: &Table| t.get(key).and_then(Value::as_str) == Some(word);
    let moves = |word: &'static str| {
        in_tables("program", &|program| {
            let steps = program.get("steps").and_then(Value::as_array).into_iter().flatten();
            steps.filter_map(Value::as_table).any(with_word("move", word))
        })
    };
    let repeats = read_repeat(text).is_ok_and(|repeat| repeat > 1) || has("program.*.repeat");
    let all = [
        (Feature::Tool, has("robot.*.tools")),
        (Feature::Region, has("region")),
        (Feature::Fence, has("fence")),
        (Feature::Exchange, in_tables("region", &with_word("kind", "exchange"))),
        (Feature::MovingRegion, has("region.*.follow")),
        (Feature::Carrier, has("region.*.follow.robot")),
        (Feature::Grip, has("program.*.steps.grip")),
        (Feature::Recording, has("program.*.trajectory")),
        (Feature::Avoidance, has("avoidance")),
        (Feature::Sensor, has("camera.*.frames") || has("cloud.*.clouds")),
        (Feature::Repeat, repeats),
        (Feature::Grid, has("grid")),
        (Feature::Belt, has("encoder")),
        (Feature::MovingObject, has("object.*.motion")),
        (Feature::PlannedMove, moves("planned")),
        (Feature::LinearMove, moves("linear")),
        (Feature::TemporaryRegion, has("region.*.life")),
    ];
    all.into_iter().filter(|(_, is_there)| *is_there).map(|(feature, _)| feature).collect()
}
