//! Table 1 of the joint-space paper in the documents: its counts and lengths are what the models and the planner give.

use std::path::Path;

use crate::common::table1::{MODELS, Setting, Table, settings};

/// The rows of a setting in the document, by columns.
fn documented(setting: &Setting) -> Vec<Vec<String>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/measurements/joint-space-map.md");
    let text = std::fs::read_to_string(file).unwrap();
    let title = format!("**{}**", setting.name);
    let rows = text.lines().skip_while(|line| !line.starts_with(&title)).skip_while(|line| !line.starts_with('|'));
    let rows = rows.take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|line| line.trim_matches('|').split('|').map(|word| word.trim().to_owned()).collect()).collect()
}

#[test]
fn the_documented_table_is_what_the_models_give() {
    for setting in settings() {
        let table = Table::of(&setting);
        let rows = documented(&setting);
        assert_eq!(rows.len(), MODELS.len(), "{}", setting.name);
        for (i, (model, row)) in MODELS.iter().zip(&rows).enumerate() {
            let found = format!("{:.1} %", 100.0 * table.found[i]);
            let length = format!("{:.3}", table.length_rad[i]);
            let computed = [model.to_string(), found, length, table.blocked[i].to_string()];
            assert_eq!([0, 4, 5, 6].map(|column| row[column].clone()), computed, "{}", setting.name);
        }
        // A better model blocks less, and more is found on it.
        let [sphere, two, bounds, slices, four, eight, exact] = table.blocked[..] else { panic!() };
        assert!(sphere > two && two >= four && four >= eight && eight > exact && bounds >= exact);
        assert!(table.found.iter().all(|found| *found <= table.found[MODELS.len() - 1]));
        // The paper's order, with its arm.
        let is_paper = setting.name.starts_with("the paper");
        assert!(!is_paper || (slices > sphere && two > bounds), "{}: {:?}", setting.name, table.blocked);
    }
}
