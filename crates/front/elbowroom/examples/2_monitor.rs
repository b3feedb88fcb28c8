//! A monitor in a control loop: the arm swings towards a post, slows down, stops before it, and may leave again.
//!
//! `cargo run --release -p elbowroom --example 2_monitor`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::path::Path;

use elbowroom::monitor::arm_volumes;
use elbowroom::prelude::*;
use elbowroom::proximity::VolumeModel;

/// Period of the controller, s.
const TICK_S: f64 = 0.004;
/// Speed of joint 1 in the program, rad/s.
const SPEED: f64 = 0.8;

fn main() -> Result<(), Box<dyn Error>> {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/models/ns16/ns16.urdf");
    let arm = load_robot(&urdf, &LoadOptions::default())?.robot;
    let joints = arm.chain.dof();

    // The region that the robot must not enter, and the thickness of the zone in which it slows down.
    let foot = Vec3::new(mm(900.0), 0.0, 0.0);
    let post = Region::cylinder("post", foot, mm(100.0), mm(2000.0), Rotation::IDENTITY).warning(mm(300.0));
    // How the robot stops, and how hard its programs accelerate: with these the law holds for any program.
    let stopping = StoppingSettings {
        reaction_s: 0.02,
        period_s: TICK_S,
        joint_deceleration: vec![6.0; joints],
        joint_acceleration: vec![4.0; joints],
    };
    let configuration = Configuration::new(ConfigurationParts {
        robot: "arm".into(),
        base_in_world: Pose::IDENTITY,
        // Encloses every link in a capsule or box.
        volumes: arm_volumes(&arm, VolumeModel::default()),
        regions: vec![post],
        sources: vec![],
        grids: vec![],
        laws: Laws { direction_aware: true, stopping_distance: Some(stopping), ..Laws::default() },
        chain: arm.chain,
    })?;
    let mut monitor = Monitor::new(configuration, None)?;
    let post = monitor.region("post").ok_or("the region is there")?;

    println!("   time  joint_1   distance  override  reason");
    let mut q = [deg(-90.0), deg(20.0), deg(10.0), 0.0, deg(40.0), 0.0];
    let mut qd = [0.0; 6];
    let mut least_m = f64::INFINITY;
    for tick in 0..1000 {
        let now_s = f64::from(tick) * TICK_S;
        // The program moves towards the post for 3 s, then away from it.
        let intent = [if now_s < 3.0 { SPEED } else { -SPEED }, 0.0, 0.0, 0.0, 0.0, 0.0];
        let report = monitor.tick(&Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) });
        let distance_m = monitor.distance(post, 10.0).unwrap_or(10.0);
        least_m = least_m.min(distance_m);
        if tick % 50 == 0 {
            let reason = report.reason.named(monitor.configuration());
            let (angle_deg, distance_mm) = (q[0].to_degrees(), 1000.0 * distance_m);
            println!(
                "{now_s:>5.1} s  {angle_deg:>6.1}°  {distance_mm:>6.0} mm  {:>8.2}  {reason}",
                report.speed_override
            );
        }
        // A real controller scales its program by the override and reads the joints; this one brakes at the stated deceleration.
        let wanted = report.speed_override * intent[0];
        qd[0] += (wanted - qd[0]).clamp(-6.0 * TICK_S, 6.0 * TICK_S);
        q[0] += qd[0] * TICK_S;
    }
    println!("\nnearest to the post: {:.1} mm", 1000.0 * least_m);
    Ok(())
}
