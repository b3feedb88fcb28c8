//! Unit errors of published robots, if the data are available: each factor is identified, and correct units are not
//! suspected.

use std::path::PathBuf;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_inspect::{SuspectQuantity, suspect_units};
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::folder;

/// The factor, the likely unit, and the unit as which the numbers were read.
const FACTORS: [(f64, &str, &str); 9] = [
    (1000.0, "mm", "m"),
    (100.0, "cm", "m"),
    (39.37, "in", "m"),
    (25.4, "in", "m"),
    (10.0, "mm", "cm"),
    (0.1, "cm", "mm"),
    (0.0254, "applied twice", "in"),
    (0.01, "applied twice", "cm"),
    (0.001, "applied twice", "mm"),
];

/// All robots of the data, with each solid replaced by its box.
fn robots() -> Vec<(PathBuf, Robot)> {
    let load = |urdf: PathBuf| {
        let options = LoadOptions { load_visuals: false, ..LoadOptions::default() };
        let robot = boxed(robot::load(&urdf, &options).unwrap().robot);
        (urdf, robot)
    };
    let robots: Vec<_> = folder::robots(&["urdf", "cell"]).into_iter().map(load).collect();
    assert!(robots.is_empty() || robots.len() > 30, "only {}", robots.len());
    robots
}

fn boxed(mut robot: Robot) -> Robot {
    for collider in robot.colliders.iter_mut().flatten() {
        let bounds = collider.shape.aabb(&collider.in_link);
        let half_extents = bounds.extent() * 0.5;
        *collider = Collider {
            name: collider.name.clone(),
            shape: Shape::Cuboid(Cuboid { half_extents }),
            in_link: Pose::from_translation((bounds.min + bounds.max) * 0.5),
        };
    }
    robot
}

/// Scales the solids of one link, or of all links, by `factor`.
fn scaled(robot: &Robot, link: Option<usize>, factor: f64) -> Robot {
    let mut robot = robot.clone();
    for (_, colliders) in robot.colliders.iter_mut().enumerate().filter(|(l, _)| link.is_none_or(|only| only == *l)) {
        for collider in colliders {
            let Shape::Cuboid(c) = &collider.shape else { panic!("a box") };
            collider.shape = Shape::Cuboid(Cuboid { half_extents: c.half_extents * factor });
            collider.in_link = Pose::from_translation(collider.in_link.translation * factor);
        }
    }
    robot
}

/// The robot with modified joints.
fn with_joints(robot: &Robot, change: impl Fn(&mut elbowroom_kinematics::Joint)) -> Robot {
    let mut joints = robot.chain.joints().to_vec();
    joints.iter_mut().for_each(change);
    let chain = Chain::new(robot.chain.name(), robot.chain.links().to_vec(), joints).unwrap();
    Robot { chain, ..robot.clone() }
}

fn moved_links(robot: &Robot) -> Vec<usize> {
    let chain = &robot.chain;
    let moved =
        |l: &usize| chain.path(elbowroom_kinematics::LinkId(*l)).iter().any(|j| chain.joints()[j.0].kind.moves());
    (0..robot.colliders.len()).filter(|l| !robot.colliders[*l].is_empty()).filter(moved).collect()
}

#[test]
fn wrong_units_of_real_arms_are_detected_and_right_ones_are_not_reported() {
    let mut arms = 0;
    for (file, robot) in robots() {
        let file = file.display();
        assert_eq!(suspect_units(&robot), [], "{file}");
        // Two or three links are not enough; several robots, and a rail, have no typical sizes.
        if moved_links(&robot).len() < 4 || file.to_string().contains("/cell/") {
            continue;
        }
        arms += 1;
        for (factor, looks_like, read_as) in FACTORS {
            let suspects = suspect_units(&scaled(&robot, None, factor));
            let named: Vec<_> = suspects.iter().map(|d| (d.of, d.looks_like.symbol(), d.read_as.symbol())).collect();
            assert_eq!(named, [(SuspectQuantity::Meshes, looks_like, read_as)], "{file} times {factor}");
            let word = if looks_like == "applied twice" { read_as } else { looks_like };
            assert!(suspects[0].reason.contains(word), "{file}: {}", suspects[0].reason);
        }
    }
    assert!(arms == 0 || arms > 30, "{arms}");
}

#[test]
fn one_mesh_of_an_arm_that_is_far_too_large_is_named_by_its_link() {
    for (file, robot) in robots() {
        let moved = moved_links(&robot);
        if moved.len() < 4 || file.to_string_lossy().contains("/cell/") {
            continue;
        }
        let edge = |l: usize| {
            let bounds = robot.colliders[l].iter().map(|b| b.shape.aabb(&b.in_link).extent().max_element());
            bounds.fold(0.0, f64::max)
        };
        let largest = moved.into_iter().max_by(|a, b| edge(*a).total_cmp(&edge(*b))).unwrap();
        for (factor, looks_like) in [(1000.0, "mm"), (100.0, "cm"), (39.37, "in")] {
            let suspects = suspect_units(&scaled(&robot, Some(largest), factor));
            let link = robot.chain.links()[largest].as_str();
            let what = format!("{} {link} times {factor}: {suspects:?}", file.display());
            assert!(suspects.len() == 1 && suspects[0].link.as_deref() == Some(link), "{what}");
            assert_eq!(suspects[0].looks_like.symbol(), looks_like, "{what}");
        }
    }
}

#[test]
fn limits_in_degrees_and_joints_in_millimetres_are_named() {
    for (file, robot) in robots() {
        let file = file.display();
        let degrees = with_joints(&robot, |j| {
            if j.kind == JointKind::Revolute {
                (j.limits.lower, j.limits.upper) = (j.limits.lower.to_degrees(), j.limits.upper.to_degrees());
            }
        });
        let revolute = robot.chain.joints().iter().filter(|j| j.kind == JointKind::Revolute).count();
        let suspects = suspect_units(&degrees);
        let named: Vec<_> = suspects.iter().map(|d| (d.of, d.looks_like.symbol())).collect();
        assert_eq!(named, vec![(SuspectQuantity::Limits, "deg"); usize::from(revolute > 0)], "{file}");
        // All joints in millimetres, then the meshes as well.
        if moved_links(&robot).len() < 4 || file.to_string().contains("/cell/") {
            continue;
        }
        let far = with_joints(&robot, |j| j.origin.translation = j.origin.translation * 1000.0);
        for (case, robot) in [("joints", &far), ("all", &scaled(&far, None, 1000.0))] {
            let suspects = suspect_units(robot);
            assert!(
                suspects.iter().any(|d| (d.of, d.looks_like.symbol()) == (SuspectQuantity::Joints, "mm")),
                "{file} {case}: {suspects:?}"
            );
        }
    }
}

/// One joint of an arm in degrees is suspected; a screwdriver's axis with a hundred turns is not.
#[test]
fn one_joint_in_degrees_is_distinguished_from_one_with_a_wide_range() {
    let joint = |i: usize, limit: f64| elbowroom_kinematics::Joint {
        name: format!("j{i}"),
        kind: JointKind::Revolute,
        parent: elbowroom_kinematics::LinkId(i),
        child: elbowroom_kinematics::LinkId(i + 1),
        origin: Pose::from_translation(Vec3::Z * 0.3),
        axis: Vec3::Z,
        limits: elbowroom_kinematics::Limits::symmetric(limit),
        mimic: None,
    };
    let arm = |limits: [f64; 4]| {
        let links = (0..5).map(|i| format!("l{i}")).collect();
        let joints = limits.into_iter().enumerate().map(|(i, limit)| joint(i, limit)).collect();
        suspect_units(&Robot::new(Chain::new("arm", links, joints).unwrap()))
    };
    assert_eq!(arm([3.1, 2.0, 2.5, 200.0 * std::f64::consts::PI]), []);
    let suspects = arm([3.1, 120.0, 2.5, 6.1]);
    assert_eq!((suspects.len(), suspects[0].joint.as_deref(), suspects[0].looks_like.symbol()), (1, Some("j1"), "deg"));
}
