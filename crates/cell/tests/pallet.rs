//! The example `pallet`: its program is sound, and the cart is in its way.

use std::path::{Path, PathBuf};

use elbowroom_cell::{Cell, RunOptions, RunOutcome, simulate};

fn file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/pallet/cell.toml")
}

fn run(text: &str) -> RunOutcome {
    let cell = Cell::parse(file(), text).unwrap_or_else(|e| panic!("{e}"));
    assert!(cell.warnings.is_empty(), "{:?}", cell.warnings);
    simulate(&cell, &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn without_the_cart_everything_goes_well_and_with_it_they_collide() {
    let text = std::fs::read_to_string(file()).unwrap();
    let (begin, end) = (text.find("[object.cart]").unwrap(), text.find("[program.kr150]").unwrap());
    let alone = run(&format!("{}{}", &text[..begin], &text[end..]));
    let robot = &alone.recording.robots[0];
    assert!(robot.finished && !alone.bad_news(), "{:?}", robot.collisions);

    let met = run(&text);
    let robot = &met.recording.robots[0];
    assert!(robot.finished && met.bad_news());
    assert!(robot.collisions.iter().all(|c| c.b == "cart"), "{:?}", robot.collisions);
}
