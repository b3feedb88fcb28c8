//! Maps of cells.

use crate::common::parse;
use elbowroom_query::map::{MapRequest, map};

fn ball(radius: f64, at: [f64; 3], motion: &str) -> String {
    format!("[object.ball]\nshape = \"sphere\"\nradius = {radius}\nat = {at:?}\n{motion}\n")
}

#[test]
fn only_fixed_objects_count_as_static_in_a_map() {
    let cell = |motion: &str| {
        parse(&format!(
            "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.arm]\n\
             dh = [{{ a = 400, min = -170, max = 170, speed = 90 }}, {{ a = 300, min = -170, max = 170, speed = 90 }}]\n\
             links = [[], {{ capsule = {{ from = [-300, 0, 0], to = [0, 0, 0], radius = 40 }} }}]\n\
             [object.post]\nshape = \"sphere\"\nat = [600, 0, 0]\nradius = 100\n{}",
            ball(100.0, [-500.0, 200.0, 0.0], motion)
        ))
    };
    let stationary = map(&cell(""), &MapRequest::default()).unwrap();
    let moving = map(&cell("motion = { via = [[0, 900, 0]], speed = 100 }"), &MapRequest::default()).unwrap();
    assert_eq!((stationary.blocked, stationary.static_blocked), (moving.blocked, stationary.blocked));
    assert_eq!(moving.static_blocked, moving.obstacles[0].blocks.blocked());
    assert!(moving.static_blocked < moving.blocked && moving.warnings.iter().any(|w| w.to_string().contains("ball")));
}
