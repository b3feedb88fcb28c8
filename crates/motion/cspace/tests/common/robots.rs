//! One robot, its map, and the naive oracle: collision queries of every solid at single configurations.
#![allow(dead_code, reason = "each test file uses a part")]

use std::sync::Arc;

use elbowroom_cspace::{BoxTree, GridAxis, RemainingJoints, RobotMapBuilder};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Cuboid, Cylinder, Shape, TriMesh, collides, separation};
use elbowroom_robot::example;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Aabb, Pose, Vec3};
pub use elbowroom_testkit::random::Random;

pub fn cuboid(at: [f64; 3], rpy: [f64; 3], size: [f64; 3]) -> (Shape, Pose) {
    (Shape::Cuboid(Cuboid { half_extents: Vec3::from(size) * 0.5 }), Pose::from_xyz_rpy(at, rpy))
}

/// A box as a closed mesh.
pub fn box_mesh(size: f64) -> TriMesh {
    let half = size * 0.5;
    let side = |i: usize, bit: usize| if i >> bit & 1 == 1 { half } else { -half };
    let corners = (0..8).map(|i| Vec3::new(side(i, 0), side(i, 1), side(i, 2))).collect();
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    TriMesh::new(corners, faces.to_vec()).unwrap()
}

/// The three-joint arm of the examples with a wrist of three more joints, carrying a mesh, a box and a cylinder.
pub fn six_joints() -> Robot {
    let arm = example::arm().unwrap();
    let mut joints = arm.chain.joints().to_vec();
    let mut links = arm.chain.links().to_vec();
    for (i, (height, axis)) in [(0.38, Vec3::Z), (0.05, Vec3::Y), (0.06, Vec3::Z)].into_iter().enumerate() {
        joints.push(Joint {
            name: format!("wrist_{i}"),
            kind: JointKind::Revolute,
            parent: LinkId(3 + i),
            child: LinkId(4 + i),
            origin: Pose::from_translation(Vec3::Z * height),
            axis,
            limits: Limits::symmetric(2.0),
            mimic: None,
        });
        links.push(format!("wrist_link_{i}"));
    }
    let mut robot = Robot::new(Chain::new("six", links, joints).unwrap());
    robot.colliders[..4].clone_from_slice(&arm.colliders);
    let collider =
        |shape, at: [f64; 3], rpy| Collider { name: String::new(), shape, in_link: Pose::from_xyz_rpy(at, rpy) };
    robot.colliders[4].push(collider(Shape::Mesh(Arc::new(box_mesh(0.08))), [0.0, 0.0, 0.02], [0.3, 0.2, 0.1]));
    robot.colliders[5].push(collider(
        Shape::Cylinder(Cylinder { half_length: 0.05, radius: 0.03 }),
        [0.02, 0.0, 0.05],
        [0.4, 0.0, 0.0],
    ));
    robot.colliders[6].push(collider(
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.02, 0.05, 0.03) }),
        [0.0, 0.03, 0.06],
        [0.0; 3],
    ));
    robot
}

pub fn axes(robot: &Robot, joints: &[usize], step: f64) -> Vec<GridAxis> {
    let axis = |&j: &usize| {
        let joint = &robot.chain.joints()[robot.chain.active_joints()[j].0];
        let step = if joint.kind == JointKind::Prismatic { step / 30.0 } else { step.to_radians() };
        GridAxis::new(&joint.name, joint.limits.lower, joint.limits.upper, step).unwrap()
    };
    joints.iter().map(axis).collect()
}

/// A robot and the parameters of its map.
pub struct Case {
    pub robot: Robot,
    pub joints: Vec<usize>,
    pub fixed: Option<Vec<f64>>,
    pub base: Pose,
    pub obstacles: Vec<(Shape, Pose)>,
    pub step: f64,
}

impl Case {
    pub fn new(obstacles: Vec<(Shape, Pose)>) -> Self {
        let robot = example::arm().unwrap();
        Self { robot, joints: vec![0, 1, 2], fixed: None, base: Pose::IDENTITY, obstacles, step: 4.0 }
    }

    pub fn builder(&self) -> RobotMapBuilder {
        let remaining = self.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
        RobotMapBuilder::new(
            &self.robot,
            self.base,
            &axes(&self.robot, &self.joints, self.step),
            &self.joints,
            remaining,
        )
        .unwrap()
    }

    /// Whether a link that the map's joints move is in collision.
    pub fn collides(&self, state: &mut ChainState, q: &[f64], links: &[usize], around: &[Aabb]) -> bool {
        state.q.copy_from_slice(q);
        self.robot.chain.forward(state);
        links.iter().any(|&link| {
            self.robot.colliders[link].iter().any(|collider| {
                let in_world = self.base * state.link_in_root(LinkId(link)) * collider.in_link;
                let bounds = collider.shape.aabb(&in_world).inflated(1e-9);
                self.obstacles
                    .iter()
                    .zip(around)
                    .any(|((shape, at), o)| bounds.overlaps(o) && collides(&collider.shape, &in_world, shape, at))
            })
        })
    }

    /// Least distance of an obstacle from a link that the map's joints move.
    pub fn gap(&self, state: &mut ChainState, q: &[f64]) -> f64 {
        state.q.copy_from_slice(q);
        self.robot.chain.forward(state);
        let mut least = f64::INFINITY;
        for link in self.moving_links() {
            for collider in &self.robot.colliders[link] {
                let in_world = self.base * state.link_in_root(LinkId(link)) * collider.in_link;
                for (shape, at) in &self.obstacles {
                    if collides(&collider.shape, &in_world, shape, at) {
                        return 0.0;
                    }
                    least = least.min(separation(&collider.shape, &in_world, shape, at).distance);
                }
            }
        }
        least
    }

    pub fn moving_links(&self) -> Vec<usize> {
        let chain = &self.robot.chain;
        let moves = |j: &elbowroom_kinematics::JointId| {
            let source = chain.mimic_source(*j).map_or(*j, |m| m.joint);
            chain.q_index(source).is_some_and(|i| self.joints.contains(&i))
        };
        (0..chain.links().len()).filter(|l| chain.path(LinkId(*l)).iter().any(moves)).collect()
    }

    /// Values of all joints; the values of the map's joints are `q`.
    pub fn all_values(&self, q: &[f64], random: &mut Random) -> Vec<f64> {
        let (low, high) = (self.robot.chain.lower(), self.robot.chain.upper());
        let mut all: Vec<f64> = match &self.fixed {
            Some(fixed) => fixed.clone(),
            None => (0..low.len()).map(|i| random.between(low[i], high[i])).collect(),
        };
        for (&j, &v) in self.joints.iter().zip(q) {
            all[j] = v;
        }
        all
    }

    /// Builds the map and checks that free cells contain no collision: tests all cells, and free neighbours of blocked
    /// cells.
    pub fn check(&self, samples: usize) -> BoxTree {
        let tree = self.builder().build(&self.obstacles).unwrap();
        self.compare(&tree, samples);
        tree
    }

    /// Checks an existing map like [`check`](Self::check).
    pub fn compare(&self, tree: &BoxTree, samples: usize) {
        let mut random = Random(7);
        let mut state = ChainState::new(&self.robot.chain);
        let boundary = free_neighbours(tree);
        let around: Vec<Aabb> = self.obstacles.iter().map(|(shape, at)| shape.aabb(at)).collect();
        let links = self.moving_links();
        let mut collisions = 0;
        for i in 0..samples {
            let q: Vec<f64> = if i % 2 == 0 || boundary.is_empty() {
                tree.axes().iter().map(|a| random.between(a.min(), a.max())).collect()
            } else {
                let cell = &boundary[(random.unit() * boundary.len() as f64) as usize];
                let within = |(a, c): (&GridAxis, &u16)| {
                    let low = a.border(usize::from(*c));
                    random.between(low, (low + a.step()).min(a.max()))
                };
                tree.axes().iter().zip(cell).map(within).collect()
            };
            let all_values = self.all_values(&q, &mut random);
            if self.collides(&mut state, &all_values, &links, &around) {
                collisions += 1;
                assert!(tree.is_blocked(&q), "{q:?} collides and is free");
            }
        }
        assert!(collisions > 0 || tree.blocked() == 0, "no sample is in collision: the test is void");
    }

    /// Fraction of some blocked cells in which a local search finds no collision.
    pub fn needless_share(&self, tree: &BoxTree, samples: usize) -> f64 {
        let mut random = Random(3);
        let mut state = ChainState::new(&self.robot.chain);
        let mut cells = Vec::new();
        tree.for_each_box(|b| each_cell(b.first, b.last, |c| cells.push(c.to_vec())));
        let mut needless = 0u32;
        for _ in 0..samples {
            let cell = &cells[(random.unit() * cells.len() as f64) as usize];
            needless += u32::from(!self.collides_in(&mut state, tree.axes(), cell));
        }
        f64::from(needless) / samples as f64
    }

    /// Whether a local search for the least distance finds a collision. It starts from the nearest of the cell's
    /// corners and centre, with decreasing steps.
    pub fn collides_in(&self, state: &mut ChainState, axes: &[GridAxis], cell: &[u16]) -> bool {
        let n = axes.len();
        let low: Vec<f64> = axes.iter().zip(cell).map(|(a, c)| a.border((*c).into())).collect();
        let high: Vec<f64> = axes.iter().zip(&low).map(|(a, l)| (l + a.step()).min(a.max())).collect();
        let mut gap = |q: &[f64]| self.gap(state, &self.all_values(q, &mut Random(1)));
        let mut best: Vec<f64> = (0..n).map(|i| 0.5 * (low[i] + high[i])).collect();
        let mut least = gap(&best);
        for corner in 0..1 << n {
            let q: Vec<f64> = (0..n).map(|i| if corner >> i & 1 == 0 { low[i] } else { high[i] }).collect();
            let d = gap(&q);
            if d < least {
                (best, least) = (q, d);
            }
        }
        let mut step = 0.5;
        while least > 0.0 && step > 1e-3 {
            let mut better = false;
            for i in 0..2 * n {
                let (axis, sign) = (i / 2, if i % 2 == 0 { 1.0 } else { -1.0 });
                let mut q = best.clone();
                q[axis] = (q[axis] + sign * step * (high[axis] - low[axis])).clamp(low[axis], high[axis]);
                let d = gap(&q);
                if d < least {
                    (best, least, better) = (q, d, true);
                }
            }
            if !better {
                step *= 0.5;
            }
        }
        least == 0.0
    }
}

pub fn each_cell(first: &[u16], last: &[u16], mut found: impl FnMut(&[u16])) {
    let mut cell = first.to_vec();
    loop {
        found(&cell);
        let Some(axis) = (0..cell.len()).rev().find(|&i| cell[i] < last[i]) else { return };
        cell[axis] += 1;
        cell[axis + 1..].copy_from_slice(&first[axis + 1..]);
    }
}

/// Free cells with a blocked neighbour.
pub fn free_neighbours(tree: &BoxTree) -> Vec<Vec<u16>> {
    let mut out = std::collections::BTreeSet::new();
    tree.for_each_box(|b| {
        each_cell(b.first, b.last, |cell| {
            for axis in 0..cell.len() {
                for at in [cell[axis].checked_sub(1), cell[axis].checked_add(1)].into_iter().flatten() {
                    let mut next = cell.to_vec();
                    next[axis] = at;
                    if usize::from(at) < tree.axes()[axis].count() && !tree.is_blocked_cell(&next) {
                        out.insert(next);
                    }
                }
            }
        });
    });
    out.into_iter().collect()
}
