//! Jobs for `xtask/planning/cpp/hits.cpp`, which runs them with Coal: a robot, its surroundings, configurations.

use std::fmt::Write as _;

use elbowroom_kinematics::{Chain, JointKind, LinkId};
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_robot::{GeometryId, Robot, collision_pairs};
use elbowroom_spatial::{Pose, Vec3};

/// Half of the edge of the box that replaces a half-space, m.
const FLOOR_M: f64 = 50.0;

/// The links of all colliders, in the order of the colliders in the job.
fn links(robot: &Robot) -> Vec<LinkId> {
    robot.links_with_colliders().flat_map(|link| robot.colliders[link.0].iter().map(move |_| link)).collect()
}

/// Writes the lines of a robot: its joints, and a body per collider.
pub fn robot(job: &mut String, robot: &Robot) {
    let chain = &robot.chain;
    for joint in chain.topological_order().iter().map(|j| &chain.joints()[j.0]) {
        let kind = if joint.kind == JointKind::Prismatic { "p" } else { "r" };
        let Vec3 { x, y, z } = joint.axis.try_normalize().unwrap_or(Vec3::Z);
        writeln!(job, "joint {} {kind} {x} {y} {z} {} 1000", frame(chain, joint.parent), rows(&joint.origin)).unwrap();
    }
    for link in robot.links_with_colliders() {
        for collider in &robot.colliders[link.0] {
            body(job, frame(chain, link), &collider.shape, &collider.in_link);
        }
    }
}

/// Writes the lines of surroundings: solids, pairs, and a path of one state per configuration.
pub fn surroundings(job: &mut String, robot: &Robot, solids: &[(Shape, Pose)], q: &[f64]) {
    let (chain, links) = (&robot.chain, links(robot));
    writeln!(job, "cell").unwrap();
    for (shape, pose) in solids {
        body(job, 0, shape, pose);
    }
    for (a, _) in links.iter().enumerate().filter(|(_, link)| chain.is_movable(**link)) {
        for solid in 0..solids.len() {
            writeln!(job, "pair {a} {}", links.len() + solid).unwrap();
        }
    }
    for pair in collision_pairs(&[robot], 0) {
        let (GeometryId::Link { link: one, .. }, GeometryId::Link { link: other, .. }) = pair else { continue };
        let of = |wanted: LinkId| links.iter().enumerate().filter(move |(_, l)| **l == wanted).map(|(i, _)| i);
        for a in of(one) {
            for b in of(other) {
                writeln!(job, "pair {a} {b}").unwrap();
            }
        }
    }
    for q in q.chunks(chain.dof()) {
        job.push_str("path 1\n");
        for &joint in chain.topological_order() {
            let is_fixed = !chain.joints()[joint.0].kind.moves();
            write!(job, "{} ", if is_fixed { 0.0 } else { chain.joint_value(joint, q) }).unwrap();
        }
        job.push('\n');
    }
}

/// Number of the joint that moves a link, from 1; 0 for the root.
fn frame(chain: &Chain, link: LinkId) -> usize {
    let joint = chain.parent_joint(link);
    joint.map_or(0, |joint| 1 + chain.topological_order().iter().position(|j| *j == joint).unwrap())
}

fn body(job: &mut String, frame: usize, shape: &Shape, pose: &Pose) {
    // A half-space is below its plane.
    let below = Pose::new(pose.rotation, pose.transform_point(Vec3::Z * -FLOOR_M));
    let at = if matches!(shape, Shape::HalfSpace(_)) { &below } else { pose };
    write!(job, "body {frame} {} ", rows(at)).unwrap();
    match shape {
        Shape::Sphere(s) => write!(job, "sphere {}", s.radius),
        Shape::Capsule(c) => write!(job, "capsule {} {}", c.radius, 2.0 * c.half_length),
        Shape::Cylinder(c) => write!(job, "cylinder {} {}", c.radius, 2.0 * c.half_length),
        Shape::Cuboid(c) => {
            let Vec3 { x, y, z } = c.half_extents * 2.0;
            write!(job, "box {x} {y} {z}")
        }
        Shape::HalfSpace(_) => write!(job, "box {0} {0} {0}", 2.0 * FLOOR_M),
        Shape::Hull(_) | Shape::Mesh(_) => {
            let (vertices, triangles) = tessellate(shape, 1e-3);
            write!(job, "mesh {} {}", vertices.len(), triangles.len()).unwrap();
            for v in &vertices {
                write!(job, " {} {} {}", v.x, v.y, v.z).unwrap();
            }
            for [a, b, c] in &triangles {
                write!(job, " {a} {b} {c}").unwrap();
            }
            Ok(())
        }
    }
    .unwrap();
    job.push('\n');
}

fn rows(pose: &Pose) -> String {
    pose.to_rows().iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
