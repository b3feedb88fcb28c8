//! Inverse kinematics on every real robot: a table (with `--nocapture`), and its requirements.
#![allow(clippy::print_stdout)]

use crate::common;
use crate::common::measure::{Line, measure};
use crate::common::robots;
use elbowroom_kinematics::inverse::IkMethod;

#[test]
fn every_robot_reaches_reachable_targets() {
    println!("{}", Line::HEAD);
    for (name, path) in robots() {
        let chain = common::load(&path);
        let line = measure(&chain, elbowroom_testkit::extent::amount(300, 5000));
        println!("{}", line.text(&name));
        assert!(line.worst_m <= 1e-12 && line.worst_rad <= 1e-12, "{name}");
        let wanted = if line.method == IkMethod::SphericalWrist { 100.0 } else { 99.0 };
        assert!(line.success >= wanted, "{name}: {}", line.success);
        if name.starts_with("comau_ns16") || name.starts_with("staubli") || name.starts_with("kuka_kr") {
            assert_eq!(line.method, IkMethod::SphericalWrist, "{name}");
        }
    }
}
