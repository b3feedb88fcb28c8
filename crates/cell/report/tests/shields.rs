//! Shields of virtual fixtures in the scene of the report.

use crate::page_data;
use elbowroom_cell::Cell;
use elbowroom_report::{ReportScene, write_html};
use elbowroom_sim::{RunOptions, simulate};

#[test]
fn the_report_has_a_shield_and_when_it_is_switched() {
    let examples = elbowroom_testkit::folder::examples();
    let read = |name: &str| std::fs::read_to_string(examples.join("guided").join(name)).unwrap();
    let folder = std::env::temp_dir().join(format!("elbowroom-shields-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = read("cell.toml").replace("../models", &examples.join("models").display().to_string());
    std::fs::write(folder.join("cell.toml"), text.replace("tolerance = 4", "tolerance = 8")).unwrap();
    let row =
        |(k, line): (usize, &str)| format!("{line},{}\n", if k == 0 { "fixture.pocket" } else { ["1", "0"][k / 6] });
    let stream: String = read("hand.csv").lines().take(12).enumerate().map(row).collect();
    std::fs::write(folder.join("hand.csv"), stream).unwrap();
    let cell = Cell::load(folder.join("cell.toml")).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let mut page = Vec::new();
    write_html(&mut page, &ReportScene::of_cell(&cell), &[("run", &outcome.recording)]).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let data = page_data::block(&String::from_utf8(page).unwrap(), "scene-data");
    let shield = &data["shields"][0];
    assert_eq!((&shield["name"], &shield["active"]), (&"pocket".into(), &true.into()));
    let triangles = data["meshes"][shield["mesh"].as_u64().unwrap() as usize]["i"]["n"].as_u64().unwrap() / 3;
    assert!((1_000..100_000).contains(&triangles), "{triangles}");
    assert_eq!(data["runs"][0]["shields"], serde_json::json!([[[0.25, false]]]));
}
