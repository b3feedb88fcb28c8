//! Loads a robot, puts it beside a post and reports their distance, the nearest parts and the nearest points.
//!
//! `cargo run --release -p elbowroom --example 1_distance`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::path::Path;

use elbowroom::prelude::*;
use elbowroom::proximity::Cylinder;
use elbowroom::scene::Selection;

fn main() -> Result<(), Box<dyn Error>> {
    // A URDF with its meshes; the SRDF beside it says which links may touch.
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/models/ns16/ns16.urdf");
    let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
    let loaded = load_robot(&urdf, &options)?;
    for warning in &loaded.warnings {
        eprintln!("warning: {warning}");
    }
    let arm = loaded.robot;
    println!("{}: {} joints, {} links", arm.chain.name(), arm.chain.dof(), arm.chain.links().len());

    // A scene is constant: robots, objects, and the pairs that are compared.
    let mut builder = Scene::builder();
    let robot = builder.robot("arm", arm, Pose::IDENTITY);
    builder.object(Object {
        name: "post".into(),
        shape: Shape::Cylinder(Cylinder { half_length: mm(1000.0), radius: mm(100.0) }),
        in_world: Pose::from_translation(Vec3::new(mm(900.0), 0.0, mm(1000.0))),
    });
    let scene = builder.build()?;

    // The state holds the joint values; the checker holds the memory of the queries. Each thread has its own pair.
    let mut state = SceneState::new(&scene);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    println!("\njoint_1  to the post  nearest parts          at (m)");
    for angle_deg in [-90.0, -60.0, -45.0, -30.0, -20.0, -10.0] {
        state.set_q(&scene, robot, &[deg(angle_deg), deg(20.0), deg(10.0), 0.0, deg(40.0), 0.0])?;
        let mut query = checker.between(Selection::Robots, Selection::Objects);
        let nearest = query.distance(&state).ok_or("nothing to compare")?;
        println!(
            "{angle_deg:>6}°  {:>8.1} mm  {:<21}  ({:.3}, {:.3}, {:.3})",
            1000.0 * nearest.metres,
            format!("{} - {}", scene.name(nearest.a), scene.name(nearest.b)),
            nearest.on_a.x,
            nearest.on_a.y,
            nearest.on_a.z,
        );
    }

    // Asking only whether anything touches is cheaper; the answer includes the robot's links against each other.
    match checker.collides(&state) {
        Some(contact) => println!("\nthe last one collides: {} with {}", scene.name(contact.a), scene.name(contact.b)),
        None => println!("\nthe last one does not collide"),
    }
    Ok(())
}
