//! Maps of any robot against single configurations: what collides is blocked, and hardly anything else.

use std::sync::Arc;

use elbowroom_cspace::{
    Axis, AxisError, Blocks, Filler, Grid, Layer, Model, Obstacle, Others, PlanarArm, RobotFiller, Table,
};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, collides, separation};
use elbowroom_scene::{Body, Robot, example};
use elbowroom_spatial::{Pose, Vec3};

/// A small generator: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

fn cuboid(at: [f64; 3], rpy: [f64; 3], size: [f64; 3]) -> (Shape, Pose) {
    (Shape::Cuboid(Cuboid { half_extents: Vec3::from(size) * 0.5 }), Pose::from_xyz_rpy(at, rpy))
}

/// A box as a closed mesh.
fn crate_mesh(size: f64) -> TriMesh {
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

/// The three-joint arm of the examples with a wrist of three more joints, a mesh, a box and a cylinder on it.
fn six_joints() -> Robot {
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
    robot.bodies[..4].clone_from_slice(&arm.bodies);
    let body = |shape, at: [f64; 3], rpy| Body { name: String::new(), shape, in_link: Pose::from_xyz_rpy(at, rpy) };
    robot.bodies[4].push(body(Shape::Mesh(Arc::new(crate_mesh(0.08))), [0.0, 0.0, 0.02], [0.3, 0.2, 0.1]));
    robot.bodies[5].push(body(
        Shape::Cylinder(Cylinder { half_length: 0.05, radius: 0.03 }),
        [0.02, 0.0, 0.05],
        [0.4, 0.0, 0.0],
    ));
    robot.bodies[6].push(body(
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.02, 0.05, 0.03) }),
        [0.0, 0.03, 0.06],
        [0.0; 3],
    ));
    robot
}

fn axes(robot: &Robot, joints: &[usize], step: f64) -> Vec<Axis> {
    let axis = |&j: &usize| {
        let joint = &robot.chain.joints()[robot.chain.active_joints()[j].0];
        let step = if joint.kind == JointKind::Prismatic { step / 30.0 } else { step.to_radians() };
        Axis::new(&joint.name, joint.limits.lower, joint.limits.upper, step).unwrap()
    };
    joints.iter().map(axis).collect()
}

/// A robot, a map of it, and what is asked about it.
struct Case {
    robot: Robot,
    joints: Vec<usize>,
    held: Option<Vec<f64>>,
    base: Pose,
    obstacles: Vec<(Shape, Pose)>,
    step: f64,
}

impl Case {
    fn new(obstacles: Vec<(Shape, Pose)>) -> Self {
        let robot = example::arm().unwrap();
        Self { robot, joints: vec![0, 1, 2], held: None, base: Pose::IDENTITY, obstacles, step: 4.0 }
    }

    fn filler(&self) -> RobotFiller {
        let others = self.held.as_deref().map_or(Others::Any, Others::Held);
        RobotFiller::new(&self.robot, self.base, &axes(&self.robot, &self.joints, self.step), &self.joints, others)
            .unwrap()
    }

    /// Least distance of a link that the map's joints move from an obstacle.
    fn gap(&self, state: &mut ChainState, q: &[f64]) -> f64 {
        state.q.copy_from_slice(q);
        self.robot.chain.forward(state);
        let mut least = f64::INFINITY;
        for link in self.moving_links() {
            for body in &self.robot.bodies[link] {
                let in_world = self.base * state.link_in_root(LinkId(link)) * body.in_link;
                for (shape, at) in &self.obstacles {
                    if collides(&body.shape, &in_world, shape, at) {
                        return 0.0;
                    }
                    least = least.min(separation(&body.shape, &in_world, shape, at).distance);
                }
            }
        }
        least
    }

    fn moving_links(&self) -> Vec<usize> {
        let chain = &self.robot.chain;
        let moves = |j: &elbowroom_kinematics::JointId| {
            let source = chain.mimic_source(*j).map_or(*j, |m| m.joint);
            chain.q_index(source).is_some_and(|i| self.joints.contains(&i))
        };
        (0..chain.links().len()).filter(|l| chain.path(LinkId(*l)).iter().any(moves)).collect()
    }

    /// All joint values, the map's being `q`.
    fn whole(&self, q: &[f64], random: &mut Random) -> Vec<f64> {
        let (low, high) = (self.robot.chain.lower(), self.robot.chain.upper());
        let mut all: Vec<f64> = match &self.held {
            Some(held) => held.clone(),
            None => (0..low.len()).map(|i| random.between(low[i], high[i])).collect(),
        };
        for (&j, &v) in self.joints.iter().zip(q) {
            all[j] = v;
        }
        all
    }

    /// No configuration that touches lies in a free cell: over all cells, and in the free cells beside blocked ones.
    fn check(&self, samples: usize) -> Blocks {
        let blocks = self.filler().fill(&self.obstacles).unwrap();
        let mut random = Random(7);
        let mut state = ChainState::new(&self.robot.chain);
        let border = border_cells(&blocks);
        let mut touching = 0;
        for i in 0..samples {
            let q: Vec<f64> = if i % 2 == 0 || border.is_empty() {
                blocks.axes().iter().map(|a| random.between(a.min(), a.max())).collect()
            } else {
                let cell = &border[(random.unit() * border.len() as f64) as usize];
                let within = |(a, c): (&Axis, &u16)| {
                    let low = a.border(usize::from(*c));
                    random.between(low, (low + a.step()).min(a.max()))
                };
                blocks.axes().iter().zip(cell).map(within).collect()
            };
            let whole = self.whole(&q, &mut random);
            if self.gap(&mut state, &whole) == 0.0 {
                touching += 1;
                assert!(blocks.is_blocked(&q), "{q:?} touches and is free");
            }
        }
        assert!(touching > 0 || blocks.blocked() == 0, "the samples never touch: they show nothing");
        blocks
    }

    /// Share of the blocked cells in which no configuration touches, as far as a close look at each of some shows.
    fn needlessly(&self, blocks: &Blocks, looks: usize) -> f64 {
        let mut random = Random(3);
        let mut state = ChainState::new(&self.robot.chain);
        let mut cells = Vec::new();
        blocks.each(|b| each_cell(b.first, b.last, |c| cells.push(c.to_vec())));
        let mut needless = 0u32;
        for _ in 0..looks {
            let cell = &cells[(random.unit() * cells.len() as f64) as usize];
            needless += u32::from(!self.touches_in(&mut state, blocks.axes(), cell));
        }
        f64::from(needless) / looks as f64
    }

    /// Goes to where the gap is least, by smaller and smaller steps from the nearest of the cell's corners and middle.
    fn touches_in(&self, state: &mut ChainState, axes: &[Axis], cell: &[u16]) -> bool {
        let n = axes.len();
        let low: Vec<f64> = axes.iter().zip(cell).map(|(a, c)| a.border((*c).into())).collect();
        let high: Vec<f64> = axes.iter().zip(&low).map(|(a, l)| (l + a.step()).min(a.max())).collect();
        let mut gap = |q: &[f64]| self.gap(state, &self.whole(q, &mut Random(1)));
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

fn each_cell(first: &[u16], last: &[u16], mut found: impl FnMut(&[u16])) {
    let mut cell = first.to_vec();
    loop {
        found(&cell);
        let Some(axis) = (0..cell.len()).rev().find(|&i| cell[i] < last[i]) else { return };
        cell[axis] += 1;
        cell[axis + 1..].copy_from_slice(&first[axis + 1..]);
    }
}

/// Free cells with a blocked neighbour.
fn border_cells(blocks: &Blocks) -> Vec<Vec<u16>> {
    let mut out = std::collections::BTreeSet::new();
    blocks.each(|b| {
        each_cell(b.first, b.last, |cell| {
            for axis in 0..cell.len() {
                for at in [cell[axis].checked_sub(1), cell[axis].checked_add(1)].into_iter().flatten() {
                    let mut next = cell.to_vec();
                    next[axis] = at;
                    if usize::from(at) < blocks.axes()[axis].count() && !blocks.is_blocked_cell(&next) {
                        out.insert(next);
                    }
                }
            }
        });
    });
    out.into_iter().collect()
}

#[test]
fn boxes_and_balls_block_what_touches_and_hardly_more() {
    let case = Case::new(vec![
        cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3]),
        (Shape::Sphere(Sphere { radius: 0.12 }), Pose::from_translation(Vec3::new(-0.4, 0.5, 0.9))),
    ]);
    let blocks = case.check(20_000);
    let needless = case.needlessly(&blocks, 1500);
    assert!(needless <= 0.01, "{needless}");
}

#[test]
fn a_smaller_obstacle_would_be_noticed() {
    let case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let small = [cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.196, 0.096, 0.296])];
    let blocks = case.filler().fill(&small).unwrap();
    let mut random = Random(5);
    let mut state = ChainState::new(&case.robot.chain);
    let border = border_cells(&blocks);
    let missed = (0..40_000).any(|_| {
        let cell = &border[(random.unit() * border.len() as f64) as usize];
        let within = |(a, c): (&Axis, &u16)| a.border(usize::from(*c)) + a.step() * random.unit();
        let q: Vec<f64> = blocks.axes().iter().zip(cell).map(within).collect();
        !blocks.is_blocked(&q) && case.gap(&mut state, &q) == 0.0
    });
    assert!(missed, "the samples would not notice 2 mm");
}

#[test]
fn meshes_floors_and_obstacles_over_the_base_axis() {
    let mesh = Shape::Mesh(Arc::new(crate_mesh(0.3)));
    let floor = (Shape::HalfSpace(HalfSpace), Pose::from_translation(Vec3::Z * 0.1));
    Case::new(vec![floor, (mesh.clone(), Pose::from_xyz_rpy([0.5, -0.3, 0.3], [0.2, 0.5, 0.1]))]).check(8000);
    Case::new(vec![(mesh.clone(), Pose::from_xyz_rpy([0.0, 0.0, 1.25], [0.2, 0.5, 0.1]))]).check(8000);
    // Far around the arm, and so large that the arm is inside.
    Case::new(vec![(Shape::Mesh(Arc::new(crate_mesh(1.4))), Pose::from_translation(Vec3::Z * 0.4))]).check(2000);
    let around = Case::new(vec![(Shape::Mesh(Arc::new(crate_mesh(6.0))), Pose::IDENTITY)]).filler();
    let blocks = around.fill(&[(Shape::Mesh(Arc::new(crate_mesh(6.0))), Pose::IDENTITY)]).unwrap();
    assert_eq!(blocks.blocked(), blocks.cells());
}

#[test]
fn what_fits_inside_a_link_without_touching_it_is_found() {
    let mut case =
        Case::new(vec![(Shape::Sphere(Sphere { radius: 0.01 }), Pose::from_xyz_rpy([0.5, 0.1, 0.6], [0.0; 3]))]);
    for bodies in &mut case.robot.bodies {
        bodies.clear();
    }
    let big = Shape::Mesh(Arc::new(crate_mesh(0.25)));
    case.robot.bodies[3].push(Body { name: String::new(), shape: big, in_link: Pose::from_translation(Vec3::Z * 0.2) });
    let tiny = (Shape::Mesh(Arc::new(crate_mesh(0.01))), Pose::from_xyz_rpy([-0.4, 0.3, 0.5], [0.1, 0.2, 0.3]));
    case.obstacles.push(tiny);
    case.step = 3.0;
    let blocks = case.check(30_000);
    let needless = case.needlessly(&blocks, 800);
    assert!(needless <= 0.015, "{needless}");
}

#[test]
fn other_joints_anywhere_are_enclosed_and_held_ones_are_exact() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.6], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    case.robot = six_joints();
    let any = case.check(20_000);
    case.held = Some(vec![0.0, 0.0, 0.0, 0.4, -0.9, 1.0]);
    let held = case.check(20_000);
    assert!(held.blocked() < any.blocked());
    held.each(|b| each_cell(b.first, b.last, |c| assert!(any.is_blocked_cell(c))));
    let needless = case.needlessly(&held, 800);
    assert!(needless <= 0.01, "{needless}");
}

#[test]
fn any_number_of_joints_in_any_order() {
    let obstacles = vec![cuboid([0.6, 0.2, 0.6], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])];
    for (joints, step) in [
        (vec![1], 2.0),
        (vec![2, 0], 3.0),
        (vec![2, 0, 1], 5.0),
        (vec![0, 1, 2, 4], 12.0),
        (vec![0, 1, 2, 3, 4, 5], 40.0),
    ] {
        let mut case = Case::new(obstacles.clone());
        case.robot = six_joints();
        case.held = Some(vec![0.3, 0.9, 0.4, 0.4, -0.9, 1.0]);
        case.joints = joints;
        case.step = step;
        let blocks = case.check(3000);
        assert!(blocks.bytes() < 20_000_000);
    }
}

#[test]
fn slides_and_joints_that_follow_others() {
    let mut case = Case::new(vec![cuboid([0.5, 0.2, 0.7], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let mut joints = case.robot.chain.joints().to_vec();
    joints[0].kind = JointKind::Prismatic;
    joints[0].axis = Vec3::new(0.6, 0.8, 0.0);
    joints[0].limits = Limits::symmetric(0.8);
    joints[2].mimic = Some(Mimic { joint: elbowroom_kinematics::JointId(1), multiplier: -0.7, offset: 0.3 });
    let chain = Chain::new("slide", case.robot.chain.links().to_vec(), joints).unwrap();
    case.robot = Robot { chain, ..case.robot };
    case.joints = vec![0, 1];
    case.step = 1.5;
    case.base = Pose::from_xyz_rpy([0.1, -0.2, 0.05], [0.0, 0.0, 0.4]);
    let blocks = case.check(20_000);
    assert!(case.needlessly(&blocks, 500) <= 0.02);
}

#[test]
fn the_same_whatever_the_number_of_threads() {
    let case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let cells = |threads: usize| {
        let blocks = case.filler().with_threads(threads).fill(&case.obstacles).unwrap();
        let mut all = std::collections::BTreeSet::new();
        blocks.each(|b| each_cell(b.first, b.last, |c| assert!(all.insert(c.to_vec()))));
        assert_eq!(all.len() as u64, blocks.blocked());
        all
    };
    let [one, many] = [cells(1), cells(5)];
    // Slabs are cut elsewhere, so a doubtful cell may be looked at from another side.
    assert!(one.symmetric_difference(&many).count() * 200 <= one.len());
}

#[test]
fn agrees_with_the_planar_arm() {
    let arm = PlanarArm::KR125_SIZED;
    let chain = example::arm().unwrap().chain;
    let mut joints = chain.joints().to_vec();
    let origins = [
        Pose::IDENTITY,
        Pose::from_translation(Vec3::new(arm.offset_m, 0.0, arm.height_m)),
        Pose::from_translation(Vec3::Z * arm.upper_length_m),
    ];
    for (joint, origin) in joints.iter_mut().zip(origins) {
        joint.origin = origin;
    }
    let mut robot = Robot::new(Chain::new("planar", chain.links().to_vec(), joints).unwrap());
    let capsule = |length: f64, radius| Shape::Capsule(Capsule { half_length: 0.5 * length, radius });
    let mut add = |link: usize, shape, in_link| robot.bodies[link].push(Body { name: String::new(), shape, in_link });
    let (upper, fore) = (arm.upper_length_m, arm.fore_length_m);
    add(2, capsule(upper, arm.upper_radius_m), Pose::from_translation(Vec3::Z * (0.5 * upper)));
    // At θ3 = 0 the forearm points outward.
    let quarter = std::f64::consts::FRAC_PI_2;
    add(3, capsule(fore, arm.fore_radius_m), Pose::from_xyz_rpy([0.5 * fore, 0.0, 0.0], [0.0, quarter, 0.0]));
    add(3, Shape::Sphere(Sphere { radius: arm.wrist_radius_m }), Pose::from_translation(Vec3::X * fore));
    let axis = |name: &str, low, high| Axis::from_degrees(name, low, high, 4.0).unwrap();
    let grid = Grid::new([axis("a", -170.0, 170.0), axis("b", -90.0, 90.0), axis("c", -120.0, 150.0)]).unwrap();
    let (shape, at) = cuboid([1.3, 0.4, 0.9], [0.2, 0.1, 0.5], [0.5, 0.4, 0.6]);
    let filler = RobotFiller::new(&robot, Pose::IDENTITY, grid.axes(), &[0, 1, 2], Others::Any).unwrap();
    let ours = filler.fill(&[(shape, at)]).unwrap().layer(&grid).unwrap();
    let mut theirs = Layer::new();
    let half_extents = Vec3::new(0.25, 0.2, 0.3);
    Filler::new(arm, &grid).unwrap().fill(&Obstacle::cuboid(at, half_extents).unwrap(), &mut theirs);
    let table = |layer: &Layer| {
        let mut table = Table::new(grid.shape());
        table.add(layer);
        table
    };
    let [ours, theirs] = [table(&ours), table(&theirs)];
    let more = |a: &Table, b: &Table| a.iter().filter(|c| !b.is_blocked(*c)).count();
    let (here, there) = (more(&ours, &theirs), more(&theirs, &ours));
    assert!((here + there) * 60 < ours.blocked(), "{here} {there} of {}", ours.blocked());
}

#[test]
fn bad_input_is_refused_with_a_reason() {
    let robot = example::arm().unwrap();
    let good = axes(&robot, &[0, 1, 2], 5.0);
    let new = |joints: &[usize], axes: &[Axis], others: Others<'_>| {
        RobotFiller::new(&robot, Pose::IDENTITY, axes, joints, others)
    };
    assert!(new(&[0, 1, 1], &good, Others::Any).unwrap_err().to_string().contains("second time"));
    assert!(new(&[0, 1, 7], &good, Others::Any).is_err());
    assert!(new(&[], &[], Others::Any).is_err());
    assert!(new(&[0, 1], &good, Others::Any).is_err());
    assert!(new(&[0, 1, 2], &good, Others::Held(&[0.0, f64::NAN, 0.0])).unwrap_err().to_string().contains('3'));
    let filler = new(&[0, 1, 2], &good, Others::Any).unwrap();
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(filler.fill(&[(Shape::Sphere(Sphere { radius: 0.1 }), nowhere)]).is_err());
    assert!(filler.fill(&[(Shape::Sphere(Sphere { radius: f64::NAN }), Pose::IDENTITY)]).is_err());
    let ball = (Shape::Sphere(Sphere { radius: 0.3 }), Pose::from_translation(Vec3::new(0.6, 0.0, 0.5)));
    let error = filler.clone().with_most_bytes(200).fill(std::slice::from_ref(&ball)).unwrap_err();
    assert!(error.to_string().contains("steps larger"), "{error}");
    assert!(filler.fill(&[]).unwrap().blocked() == 0);
    assert!(matches!(Axis::new("a", f64::NEG_INFINITY, f64::INFINITY, 0.1), Err(AxisError::NotFinite { .. })));
    let blocks = filler.fill(&[ball]).unwrap();
    assert!(
        blocks.is_blocked(&[f64::NAN, 0.0, 0.0])
            && blocks.is_blocked(&[0.0, 0.0])
            && blocks.is_blocked(&[9.0, 0.0, 0.0])
    );
}

#[test]
fn every_model_of_an_obstacle_holds_it() {
    let shapes = [
        Shape::Mesh(Arc::new(crate_mesh(0.4))),
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.5, 0.02) }),
        Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.1 }),
        Shape::Capsule(Capsule { half_length: 0.3, radius: 0.1 }),
        Shape::Sphere(Sphere { radius: 0.2 }),
    ];
    let base = Pose::from_xyz_rpy([0.3, -0.2, 0.1], [0.2, 0.1, 0.7]);
    let mut random = Random(11);
    for shape in &shapes {
        for at in [[0.9, 0.3, 0.4], [0.25, -0.2, 0.4], [-1.2, -0.1, 0.0]] {
            let in_world = Pose::from_xyz_rpy(at, [0.4, 1.0, -0.3]);
            for word in ["sphere", "spheres=8", "spheres=64", "box", "slices"] {
                let solids = word.parse::<Model>().unwrap().solids(shape, &in_world, &base);
                for _ in 0..400 {
                    let direction =
                        Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                    let p = in_world.transform_point(shape.support(direction) * random.unit().sqrt());
                    let speck = Shape::Sphere(Sphere { radius: 1e-9 });
                    let held = solids.iter().any(|(s, at)| collides(s, at, &speck, &Pose::from_translation(p)));
                    assert!(held, "{word} of {shape:?} at {at:?} leaves out {p:?}");
                }
            }
        }
    }
}
