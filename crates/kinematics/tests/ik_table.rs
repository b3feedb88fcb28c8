//! Inverse kinematics on every real robot: a table (with `--nocapture`), and what it must show.
#![allow(clippy::print_stdout)]

mod common;

use common::measure::{Line, measure};
use common::robots;
use elbowroom_kinematics::inverse::Method;

#[test]
fn every_robot_reaches_what_it_can_reach() {
    println!("{}", Line::HEAD);
    for (name, path) in robots() {
        let chain = common::load(&path);
        let line = measure(&chain, if cfg!(debug_assertions) { 300 } else { 5000 });
        println!("{}", line.text(&name));
        assert!(line.worst_m <= 1e-12 && line.worst_rad <= 1e-12, "{name}");
        let wanted = if line.method == Method::SphericalWrist { 100.0 } else { 99.0 };
        assert!(line.success >= wanted, "{name}: {}", line.success);
        if name.starts_with("comau_ns16") || name.starts_with("staubli") || name.starts_with("kuka_kr") {
            assert_eq!(line.method, Method::SphericalWrist, "{name}");
        }
    }
}
