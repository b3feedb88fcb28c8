//! Plans a path around a post and turns it into a motion within the joint limits.
//!
//! `cargo run --release -p elbowroom --example 3_plan`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::path::Path;

use elbowroom::kinematics::TrajectoryRow;
use elbowroom::prelude::*;
use elbowroom::proximity::Cylinder;

/// Period of the controller, s.
const PERIOD_S: f64 = 0.004;

fn main() -> Result<(), Box<dyn Error>> {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/models/ns16/ns16.urdf");
    let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
    let arm = load_robot(&urdf, &options)?.robot;
    let velocity = arm.chain.joints().iter().filter_map(|joint| joint.limits.velocity);
    let limits: Vec<JointLimits> = velocity.map(|velocity| JointLimits::new(velocity, 6.0, 60.0)).collect();

    let mut builder = Scene::builder();
    let robot = builder.robot("arm", arm, Pose::IDENTITY);
    builder.object(Object {
        name: "post".into(),
        shape: Shape::Cylinder(Cylinder { half_length: mm(600.0), radius: mm(100.0) }),
        in_world: Pose::from_translation(Vec3::new(mm(900.0), 0.0, mm(600.0))),
    });
    let scene = builder.build()?;

    let [start, goal] = [-60.0, 60.0].map(|base| [deg(base), deg(20.0), deg(10.0), 0.0, deg(40.0), 0.0]);
    let mut state = SceneState::new(&scene);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut first_contact = None;
    for step in 0..=100 {
        let q: Vec<f64> = start.iter().zip(&goal).map(|(a, b)| a + (b - a) * f64::from(step) / 100.0).collect();
        state.set_q(&scene, robot, &q)?;
        first_contact = first_contact.or(checker.collides(&state).map(|contact| (step, contact)));
    }
    if let Some((percent, contact)) = first_contact {
        println!("straight on: {} hits {} at {percent} %", scene.name(contact.a), scene.name(contact.b));
    }

    // Every segment of the path is proven free by continuous collision detection, with a margin of 20 mm.
    state.set_q(&scene, robot, &start)?;
    let settings = RrtConnectSettings { clearance_m: mm(20.0), ..RrtConnectSettings::default() };
    let mut planner = RrtConnect::new(&scene, robot)?;
    let path = planner.plan(&state, &goal, &settings)?;
    println!(
        "planned in {:.1} ms, {:.2} rad long, {} configurations checked:",
        1e3 * (path.planning_time + path.simplification_time).as_secs_f64(),
        path.length_rad,
        path.states_checked
    );
    for waypoint in &path.waypoints {
        let degrees: Vec<String> = waypoint.iter().map(|q| format!("{:>6.1}", q.to_degrees())).collect();
        println!("  {}", degrees.join(" "));
    }

    // A corner is blended if the blend is proven free; a controller follows the samples.
    let motion = planner.time_parametrize(&state, &path, &limits, PERIOD_S, &settings)?;
    let samples = motion.samples(PERIOD_S)?;
    println!("takes {:.2} s, {} stops, {} samples", motion.seconds(), motion.stops(), samples.rows().len());

    let mut least = None;
    for TrajectoryRow { t_s, q } in samples.rows() {
        state.set_q(&scene, robot, q)?;
        let pair = checker.distance(&state).ok_or("nothing to compare")?;
        if least.is_none_or(|(_, metres)| pair.metres < metres) {
            least = Some((*t_s, pair.metres));
        }
    }
    if let Some((t_s, metres)) = least {
        println!("nearest: {:.1} mm at {t_s:.2} s, of the arm to the post or to itself", 1000.0 * metres);
    }
    Ok(())
}
