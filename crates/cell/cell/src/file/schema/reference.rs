//! The tables of `docs/cell-file.md`.

use super::key::{Key, Variant};
use super::{fixtures, grids, model, motion, regions, sensors, settings};

/// Lists of keys, as the document calls them.
const KEYS: &[(&str, &[Key])] = &[
    ("keys of the file", settings::TOP),
    ("keys of `units`", settings::UNITS),
    ("keys of a pose", model::POSE),
    ("keys of [robot.NAME]", model::ROBOT),
    ("keys of a row of `dh`", model::DH_ROW),
    ("keys of [robot.NAME.tool]", model::TOOL),
    ("keys of [robot.NAME.tools.TOOL]", model::NAMED_TOOL),
    ("keys of [object.NAME]", model::OBJECT),
    ("keys of `follow` of an object", model::OBJECT_FOLLOW),
    ("keys of `motion`", model::OBJECT_MOTION),
    ("keys of [scene.NAME]", model::SCENE),
    ("keys of [region.NAME]", regions::REGION),
    ("keys of [fence.NAME]", regions::FENCE),
    ("keys of a gate", regions::GATE),
    ("keys of [grid.NAME]", grids::GRID),
    ("keys of [encoder.NAME]", regions::ENCODER),
    ("keys of [fixture.NAME]", fixtures::FIXTURE),
    ("keys of a guide", fixtures::GUIDE),
    ("keys of [operator.NAME]", fixtures::OPERATOR),
    ("keys of [virtual_robot.NAME]", fixtures::VIRTUAL_ROBOT),
    ("keys of a grasp", fixtures::GRASP),
    ("keys of [force.NAME]", fixtures::FORCE),
    ("keys of `target`", fixtures::FIXTURE_TARGET),
    ("keys of `drill`", fixtures::FIXTURE_DRILL),
    ("keys of `faces_within`", fixtures::FIXTURE_FACES),
    ("keys of a sensor", sensors::SENSOR),
    ("keys of a lens", sensors::LENS),
    ("keys of [camera.NAME]", sensors::CAMERA),
    ("keys of a template", sensors::TEMPLATE),
    ("keys of [cloud.NAME]", sensors::CLOUD),
    ("keys of `depth`", sensors::DEPTH),
    ("keys of [monitor]", settings::MONITOR),
    ("keys of [program.ROBOT]", motion::PROGRAM),
    ("keys of `keep`", motion::KEPT_AXIS),
    ("keys of `trajectory`", motion::RECORDING),
    ("keys of a goal", motion::GOAL),
    ("keys of [map.ROBOT]", settings::MAP),
    ("keys of [avoidance.ROBOT]", settings::AVOIDANCE),
];

/// Words with their keys, as the document calls them.
const SHAPES: &[(&str, &[Variant])] = &[
    ("solids", model::SOLIDS),
    ("shapes of objects", model::OBJECT_SHAPES),
    ("shapes of regions", regions::REGION_SHAPES),
];

/// The keys of a cell file that the readers accept: the tables of `docs/cell-file.md` in Markdown, each with the title
/// that its place in the document has.
pub fn key_reference() -> Vec<(&'static str, String)> {
    let steps: Vec<Key> = motion::STEPS.iter().flat_map(|step| step.keys).copied().collect();
    let follow = [regions::FOLLOW_SOURCES, regions::FOLLOW].concat();
    let lists = KEYS.iter().map(|(title, keys)| (*title, key_table(keys)));
    let joined = [("keys of a step", key_table(&steps)), ("keys of `follow` of a region", key_table(&follow))];
    let shapes = SHAPES.iter().map(|(title, variants)| (*title, variant_table(variants)));
    lists.chain(joined).chain(shapes).collect()
}

fn key_table(keys: &[Key]) -> String {
    let row = |k: &Key| format!("| `{}` | {} | {} | {} |\n", k.name, k.kind, k.default, k.meaning);
    let head = "| key | type | default | meaning |\n| --- | --- | --- | --- |\n".to_owned();
    keys.iter().map(row).fold(head, |table, row| table + &row)
}

fn variant_table(variants: &[Variant]) -> String {
    let row = |s: &Variant| {
        let keys: Vec<String> = s.keys.iter().map(in_a_list).collect();
        format!("| `{}` | {} | {} |\n", s.word, if keys.is_empty() { "none".into() } else { keys.join(", ") }, s.note)
    };
    let head = "| shape | keys | |\n| --- | --- | --- |\n".to_owned();
    variants.iter().map(row).fold(head, |table, row| table + &row)
}

/// A key with its type and meaning, in a list of keys.
fn in_a_list(key: &Key) -> String {
    let texts: Vec<&str> = [key.kind, key.meaning].into_iter().filter(|text| !text.is_empty()).collect();
    format!("`{}` ({})", key.name, texts.join(": "))
}

#[cfg(test)]
mod tests {
    use super::super::key::names;
    use super::*;

    #[test]
    fn no_list_has_a_key_twice_and_every_key_has_a_meaning() {
        for (title, keys) in KEYS {
            let mut names = names(&[keys]);
            names.sort_unstable();
            assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{title}: {names:?}");
            assert!(keys.iter().all(|key| !key.kind.is_empty() && !key.meaning.is_empty()), "{title}");
        }
    }

    #[test]
    fn every_table_has_a_title_of_its_own() {
        let tables = key_reference();
        for (i, (title, _)) in tables.iter().enumerate() {
            assert!(tables[..i].iter().all(|(other, _)| other != title), "{title}");
        }
    }
}
