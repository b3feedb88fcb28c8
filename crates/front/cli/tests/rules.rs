//! `elbowroom rules`: table, copy, pictures, messages.

use crate::common::elbowroom;

#[test]
fn the_rules_are_shown_copied_changed_and_read_again() {
    let dir = tempfile::tempdir().unwrap();
    let table = elbowroom(dir.path(), &["rules"]).expect(0).stdout;
    assert!(table.starts_with("16 rules") && table.contains("distance (m)"), "{table}");
    assert!(table.lines().all(|l| l.chars().count() <= 100));
    elbowroom(dir.path(), &["rules", "--write", "mine.toml"]).expect(0);
    assert_eq!(elbowroom(dir.path(), &["rules", "mine.toml"]).expect(0).stdout, table);
    // An existing file is not overwritten.
    elbowroom(dir.path(), &["rules", "--write", "mine.toml"]).expect(2);
    let text = std::fs::read_to_string(dir.path().join("mine.toml")).unwrap();
    std::fs::write(
        dir.path().join("mine.toml"),
        text.replace("very_near and speed is stop then size is small", "very_near and speed is stop then size is huge"),
    )
    .unwrap();
    let message = elbowroom(dir.path(), &["rules", "mine.toml"]).expect(2).stderr;
    assert!(
        message.contains("mine.toml:") && message.contains("huge") && message.contains("small, medium, large"),
        "{message}"
    );
}

#[test]
fn surfaces_as_numbers_and_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let answer = elbowroom(dir.path(), &["rules", "--json", "--picture", "out"]).expect(0).json();
    assert_eq!(answer["rules"], 16);
    let size = &answer["surfaces"][0];
    assert_eq!(size["output"], "size");
    let rows = size["values"].as_array().unwrap();
    assert_eq!(rows.len(), size["speed_m_s"].as_array().unwrap().len());
    assert!(rows[40][0].as_f64().unwrap() > 0.9 && rows[0][40].as_f64().unwrap() < 0.01);
    for name in ["size.svg", "direction.svg"] {
        assert!(std::fs::read_to_string(dir.path().join("out").join(name)).unwrap().starts_with("<svg"));
    }
}
