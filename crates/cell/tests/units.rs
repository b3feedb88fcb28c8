//! Wrong units of real robots, where the data is there: each factor is named, and nothing is doubted that is right.

use std::path::{Path, PathBuf};

use elbowroom_cell::inspect::unit_doubts;
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::{Pose, Vec3};

/// The factor, what the numbers look like, and what they were read as.
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

/// All robots of the data, each solid as the box around it.
fn robots() -> Vec<(PathBuf, Robot)> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("ELBOWROOM_DATA").map_or_else(beside, PathBuf::from);
    if !data.is_dir() {
        eprintln!("skipped: no data at {}", data.display());
        return Vec::new();
    }
    let folders = ["urdf", "cell"].into_iter().flat_map(|group| std::fs::read_dir(data.join(group)).unwrap());
    let mut robots = Vec::new();
    for folder in folders {
        let folder = folder.unwrap().path();
        let urdf = folder.join(format!("{}.urdf", folder.file_name().unwrap().to_str().unwrap()));
        if urdf.is_file() {
            let options = LoadOptions { load_visuals: false, ..LoadOptions::default() };
            robots.push((urdf.clone(), boxed(robot::load(&urdf, &options).unwrap().robot)));
        }
    }
    assert!(robots.len() > 30, "only {}", robots.len());
    robots
}

fn boxed(mut robot: Robot) -> Robot {
    for body in robot.bodies.iter_mut().flatten() {
        let bounds = body.shape.aabb(&body.in_link);
        let half_extents = bounds.extent() * 0.5;
        *body = Body {
            name: body.name.clone(),
            shape: Shape::Cuboid(Cuboid { half_extents }),
            in_link: Pose::from_translation((bounds.min + bounds.max) * 0.5),
        };
    }
    robot
}

/// Solids of one link, or of all, `factor` times as large.
fn scaled(robot: &Robot, link: Option<usize>, factor: f64) -> Robot {
    let mut robot = robot.clone();
    for (_, bodies) in robot.bodies.iter_mut().enumerate().filter(|(l, _)| link.is_none_or(|only| only == *l)) {
        for body in bodies {
            let Shape::Cuboid(c) = &body.shape else { panic!("a box") };
            body.shape = Shape::Cuboid(Cuboid { half_extents: c.half_extents * factor });
            body.in_link = Pose::from_translation(body.in_link.translation * factor);
        }
    }
    robot
}

/// The chain with other joints.
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
    (0..robot.bodies.len()).filter(|l| !robot.bodies[*l].is_empty()).filter(moved).collect()
}

#[test]
fn meshes_of_real_arms_in_a_wrong_unit_are_named_and_right_ones_are_not_doubted() {
    let mut arms = 0;
    for (file, robot) in robots() {
        let file = file.display();
        assert_eq!(unit_doubts(&robot), [], "{file}");
        // Of two or three links nobody can tell; of several robots and a rail the sizes have no rule.
        if moved_links(&robot).len() < 4 || file.to_string().contains("/cell/") {
            continue;
        }
        arms += 1;
        for (factor, looks_like, read_as) in FACTORS {
            let doubts = unit_doubts(&scaled(&robot, None, factor));
            let named: Vec<_> = doubts.iter().map(|d| (d.of, d.looks_like, d.read_as)).collect();
            assert_eq!(named, [("meshes", looks_like, read_as)], "{file} times {factor}");
            let word = if looks_like == "applied twice" { read_as } else { looks_like };
            assert!(doubts[0].reason.contains(word), "{file}: {}", doubts[0].reason);
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
            let bounds = robot.bodies[l].iter().map(|b| b.shape.aabb(&b.in_link).extent().max_element());
            bounds.fold(0.0, f64::max)
        };
        let largest = moved.into_iter().max_by(|a, b| edge(*a).total_cmp(&edge(*b))).unwrap();
        for (factor, looks_like) in [(1000.0, "mm"), (100.0, "cm"), (39.37, "in")] {
            let doubts = unit_doubts(&scaled(&robot, Some(largest), factor));
            let link = robot.chain.links()[largest].as_str();
            let what = format!("{} {link} times {factor}: {doubts:?}", file.display());
            assert!(doubts.len() == 1 && doubts[0].link.as_deref() == Some(link), "{what}");
            assert_eq!(doubts[0].looks_like, looks_like, "{what}");
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
        let doubts = unit_doubts(&degrees);
        let named: Vec<_> = doubts.iter().map(|d| (d.of, d.looks_like)).collect();
        assert_eq!(named, vec![("limits", "deg"); usize::from(revolute > 0)], "{file}");
        // Joints of the whole model in millimetres, and then the meshes, too.
        if moved_links(&robot).len() < 4 || file.to_string().contains("/cell/") {
            continue;
        }
        let far = with_joints(&robot, |j| j.origin.translation = j.origin.translation * 1000.0);
        for (case, robot) in [("joints", &far), ("all", &scaled(&far, None, 1000.0))] {
            let doubts = unit_doubts(robot);
            assert!(doubts.iter().any(|d| (d.of, d.looks_like) == ("joints", "mm")), "{file} {case}: {doubts:?}");
        }
    }
}

/// One joint of an arm in degrees, and a screwdriver's axis that turns a hundred times: the first is doubted, not the second.
#[test]
fn one_joint_in_degrees_is_told_from_one_that_turns_far() {
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
        unit_doubts(&Robot::new(Chain::new("arm", links, joints).unwrap()))
    };
    assert_eq!(arm([3.1, 2.0, 2.5, 200.0 * std::f64::consts::PI]), []);
    let doubts = arm([3.1, 120.0, 2.5, 6.1]);
    assert_eq!((doubts.len(), doubts[0].joint.as_deref(), doubts[0].looks_like), (1, Some("j1"), "deg"));
}
