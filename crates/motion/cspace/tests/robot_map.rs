//! Maps of any robot compared with single configurations: collisions are blocked, and hardly any other cells.

use std::sync::Arc;

use elbowroom_cspace::{
    ConvexObstacle, Grid, GridAxis, GridAxisError, Layer, ObstacleModel, OccupancyBitmap, PlanarArm, PlanarMapBuilder,
    RemainingJoints, RobotMapBuilder, RobotMapSettings,
};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, Mimic};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, collides};
use elbowroom_robot::example;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

use crate::common::robots::{Case, Random, axes, box_mesh, cuboid, each_cell, free_neighbours, six_joints};

#[test]
fn boxes_and_spheres_block_collisions_and_hardly_more() {
    let case = Case::new(vec![
        cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3]),
        (Shape::Sphere(Sphere { radius: 0.12 }), Pose::from_translation(Vec3::new(-0.4, 0.5, 0.9))),
    ]);
    let tree = case.check(20_000);
    let needless = case.needless_share(&tree, 1500);
    assert!(needless <= 0.01, "{needless}");
}

#[test]
fn the_oracle_detects_a_smaller_obstacle() {
    let case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let small = [cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.196, 0.096, 0.296])];
    let tree = case.builder().build(&small).unwrap();
    let mut random = Random(5);
    let mut state = ChainState::new(&case.robot.chain);
    let boundary = free_neighbours(&tree);
    let missed = (0..40_000).any(|_| {
        let cell = &boundary[(random.unit() * boundary.len() as f64) as usize];
        let within = |(a, c): (&GridAxis, &u16)| a.border(usize::from(*c)) + a.step() * random.unit();
        let q: Vec<f64> = tree.axes().iter().zip(cell).map(within).collect();
        !tree.is_blocked(&q) && case.gap(&mut state, &q) == 0.0
    });
    assert!(missed, "the samples do not detect 2 mm");
}

#[test]
fn meshes_floors_and_obstacles_over_the_base_axis() {
    let mesh = Shape::Mesh(Arc::new(box_mesh(0.3)));
    let floor = (Shape::HalfSpace(HalfSpace), Pose::from_translation(Vec3::Z * 0.1));
    Case::new(vec![floor, (mesh.clone(), Pose::from_xyz_rpy([0.5, -0.3, 0.3], [0.2, 0.5, 0.1]))]).check(8000);
    Case::new(vec![(mesh.clone(), Pose::from_xyz_rpy([0.0, 0.0, 1.25], [0.2, 0.5, 0.1]))]).check(8000);
    // Far around the arm, large enough that the arm is inside.
    Case::new(vec![(Shape::Mesh(Arc::new(box_mesh(1.4))), Pose::from_translation(Vec3::Z * 0.4))]).check(2000);
    let around = Case::new(vec![(Shape::Mesh(Arc::new(box_mesh(6.0))), Pose::IDENTITY)]).builder();
    let tree = around.build(&[(Shape::Mesh(Arc::new(box_mesh(6.0))), Pose::IDENTITY)]).unwrap();
    assert_eq!(tree.blocked(), tree.cells());
}

#[test]
fn obstacles_inside_a_closed_link_are_found() {
    let mut case =
        Case::new(vec![(Shape::Sphere(Sphere { radius: 0.01 }), Pose::from_xyz_rpy([0.5, 0.1, 0.6], [0.0; 3]))]);
    for colliders in &mut case.robot.colliders {
        colliders.clear();
    }
    let big = Shape::Mesh(Arc::new(box_mesh(0.25)));
    case.robot.colliders[3].push(Collider {
        name: String::new(),
        shape: big,
        in_link: Pose::from_translation(Vec3::Z * 0.2),
    });
    // Two small components of one mesh, far apart.
    let speck = box_mesh(0.012);
    let far = Vec3::new(0.9, -0.5, 0.3);
    let vertices = speck.vertices().iter().copied().chain(speck.vertices().iter().map(|v| *v + far)).collect();
    let faces = speck.triangles().iter().copied().chain(speck.triangles().iter().map(|t| t.map(|v| v + 8))).collect();
    let both = Shape::Mesh(Arc::new(TriMesh::new(vertices, faces).unwrap()));
    case.obstacles.push((both, Pose::from_xyz_rpy([-0.5, -0.1, 0.4], [0.0; 3])));
    let tiny = (Shape::Mesh(Arc::new(box_mesh(0.01))), Pose::from_xyz_rpy([-0.4, 0.3, 0.5], [0.1, 0.2, 0.3]));
    case.obstacles.push(tiny);
    case.step = 5.0;
    let tree = case.check(30_000);
    let needless = case.needless_share(&tree, 800);
    assert!(needless <= 0.015, "{needless}");
}

#[test]
fn swept_joints_are_enclosed_and_fixed_ones_are_exact() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.6], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    case.robot = six_joints();
    let any = case.check(20_000);
    case.fixed = Some(vec![0.0, 0.0, 0.0, 0.4, -0.9, 1.0]);
    let fixed = case.check(20_000);
    assert!(fixed.blocked() < any.blocked());
    fixed.for_each_box(|b| each_cell(b.first, b.last, |c| assert!(any.is_blocked_cell(c))));
    let needless = case.needless_share(&fixed, 800);
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
        case.fixed = Some(vec![0.3, 0.9, 0.4, 0.4, -0.9, 1.0]);
        case.joints = joints;
        case.step = step;
        let tree = case.check(3000);
        assert!(tree.bytes() < 20_000_000);
    }
}

#[test]
fn prismatic_and_mimic_joints() {
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
    let tree = case.check(20_000);
    assert!(case.needless_share(&tree, 500) <= 0.02);
}

#[test]
fn maps_hardly_depend_on_the_number_of_threads() {
    let case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let cells = |threads: usize| {
        let settings = RobotMapSettings { threads: Some(threads), ..RobotMapSettings::default() };
        let tree = case.builder().with_settings(settings).build(&case.obstacles).unwrap();
        let mut all = std::collections::BTreeSet::new();
        tree.for_each_box(|b| each_cell(b.first, b.last, |c| assert!(all.insert(c.to_vec()))));
        assert_eq!(all.len() as u64, tree.blocked());
        all
    };
    let [one, many] = [cells(1), cells(5)];
    // Slabs have other borders, so undecided cells may differ.
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
    let mut add =
        |link: usize, shape, in_link| robot.colliders[link].push(Collider { name: String::new(), shape, in_link });
    let (upper, fore) = (arm.upper_length_m, arm.fore_length_m);
    add(2, capsule(upper, arm.upper_radius_m), Pose::from_translation(Vec3::Z * (0.5 * upper)));
    // At θ3 = 0 the forearm points outward.
    let quarter = std::f64::consts::FRAC_PI_2;
    add(3, capsule(fore, arm.fore_radius_m), Pose::from_xyz_rpy([0.5 * fore, 0.0, 0.0], [0.0, quarter, 0.0]));
    add(3, Shape::Sphere(Sphere { radius: arm.wrist_radius_m }), Pose::from_translation(Vec3::X * fore));
    let axis = |name: &str, low, high| GridAxis::from_degrees(name, low, high, 4.0).unwrap();
    let grid = Grid::new([axis("a", -170.0, 170.0), axis("b", -90.0, 90.0), axis("c", -120.0, 150.0)]).unwrap();
    let (shape, at) = cuboid([1.3, 0.4, 0.9], [0.2, 0.1, 0.5], [0.5, 0.4, 0.6]);
    let builder =
        RobotMapBuilder::new(&robot, Pose::IDENTITY, grid.axes(), &[0, 1, 2], RemainingJoints::Swept).unwrap();
    let ours = builder.build(&[(shape, at)]).unwrap().to_layer(&grid).unwrap();
    let mut theirs = Layer::new();
    let half_extents = Vec3::new(0.25, 0.2, 0.3);
    let obstacle = ConvexObstacle::cuboid(at, half_extents).unwrap();
    PlanarMapBuilder::new(arm, &grid).unwrap().build_layer(&obstacle, &mut theirs);
    let occupancy = |layer: &Layer| {
        let mut occupancy = OccupancyBitmap::new(grid.shape());
        occupancy.add(layer);
        occupancy
    };
    let [ours, theirs] = [occupancy(&ours), occupancy(&theirs)];
    let more = |a: &OccupancyBitmap, b: &OccupancyBitmap| a.iter().filter(|c| !b.is_blocked(*c)).count();
    let (here, there) = (more(&ours, &theirs), more(&theirs, &ours));
    assert!((here + there) * 60 < ours.blocked(), "{here} {there} of {}", ours.blocked());
}

#[test]
fn invalid_input_is_rejected_with_a_reason() {
    let robot = example::arm().unwrap();
    let good = axes(&robot, &[0, 1, 2], 5.0);
    let new = |joints: &[usize], axes: &[GridAxis], remaining: RemainingJoints<'_>| {
        RobotMapBuilder::new(&robot, Pose::IDENTITY, axes, joints, remaining)
    };
    assert!(new(&[0, 1, 1], &good, RemainingJoints::Swept).unwrap_err().to_string().contains("second time"));
    assert!(new(&[0, 1, 7], &good, RemainingJoints::Swept).is_err());
    assert!(new(&[], &[], RemainingJoints::Swept).is_err());
    assert!(new(&[0, 1], &good, RemainingJoints::Swept).is_err());
    assert!(
        new(&[0, 1, 2], &good, RemainingJoints::Fixed(&[0.0, f64::NAN, 0.0])).unwrap_err().to_string().contains('3')
    );
    let builder = new(&[0, 1, 2], &good, RemainingJoints::Swept).unwrap();
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(builder.build(&[(Shape::Sphere(Sphere { radius: 0.1 }), nowhere)]).is_err());
    assert!(builder.build(&[(Shape::Sphere(Sphere { radius: f64::NAN }), Pose::IDENTITY)]).is_err());
    let ball = (Shape::Sphere(Sphere { radius: 0.3 }), Pose::from_translation(Vec3::new(0.6, 0.0, 0.5)));
    let small = RobotMapSettings { max_bytes: 200, ..RobotMapSettings::default() };
    let error = builder.clone().with_settings(small).build(std::slice::from_ref(&ball)).unwrap_err();
    assert!(error.to_string().contains("steps larger"), "{error}");
    assert!(builder.build(&[]).unwrap().blocked() == 0);
    assert!(matches!(GridAxis::new("a", f64::NEG_INFINITY, f64::INFINITY, 0.1), Err(GridAxisError::NotFinite { .. })));
    let tree = builder.build(&[ball]).unwrap();
    assert!(
        tree.is_blocked(&[f64::NAN, 0.0, 0.0]) && tree.is_blocked(&[0.0, 0.0]) && tree.is_blocked(&[9.0, 0.0, 0.0])
    );
}

#[test]
fn every_obstacle_model_encloses_the_obstacle() {
    let shapes = [
        Shape::Mesh(Arc::new(box_mesh(0.4))),
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
                let solids = word.parse::<ObstacleModel>().unwrap().solids(shape, &in_world, &base);
                for _ in 0..400 {
                    let direction =
                        Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                    let p = in_world.transform_point(shape.support(direction) * random.unit().sqrt());
                    let speck = Shape::Sphere(Sphere { radius: 1e-9 });
                    let enclosed = solids.iter().any(|(s, at)| collides(s, at, &speck, &Pose::from_translation(p)));
                    assert!(enclosed, "{word} of {shape:?} at {at:?} leaves out {p:?}");
                }
            }
        }
    }
}

#[test]
fn joints_before_those_of_the_map_are_swept() {
    let ball = |x: f64| (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::new(x, 0.0, 0.6)));
    let robot = example::arm().unwrap();
    let blocked = |x: f64| {
        let axes = axes(&robot, &[1, 2], 5.0);
        let builder = RobotMapBuilder::new(&robot, Pose::IDENTITY, &axes, &[1, 2], RemainingJoints::Swept).unwrap();
        let tree = builder.build(&[ball(x)]).unwrap();
        (tree.blocked(), tree.cells())
    };
    let (all, cells) = blocked(-0.5);
    assert_eq!(all, cells);
    assert_eq!(blocked(3.0).0, 0);
}

#[test]
fn an_obstacle_that_nearly_fills_a_closed_link_is_found() {
    let mut case =
        Case::new(vec![(Shape::Mesh(Arc::new(box_mesh(0.3))), Pose::from_xyz_rpy([0.3, 0.0, 0.55], [0.0; 3]))]);
    for colliders in &mut case.robot.colliders {
        colliders.clear();
    }
    let big = Shape::Mesh(Arc::new(box_mesh(0.35)));
    // At these joint values the box is inside and touches nothing.
    let mut state = ChainState::new(&case.robot.chain);
    state.q.copy_from_slice(&[0.0, 1.2, 0.8]);
    case.robot.chain.forward(&mut state);
    let (_, at) = case.obstacles[0];
    let in_link = state.link_in_root(elbowroom_kinematics::LinkId(3)).inverse() * at;
    case.robot.colliders[3].push(Collider { name: String::new(), shape: big, in_link });
    case.joints = vec![0, 1, 2];
    case.step = 4.0;
    // Farther away, the box only cuts the link's surface, as in other tests.
    let mut joints = case.robot.chain.joints().to_vec();
    for (joint, middle) in joints.iter_mut().zip([0.0, 1.2, 0.8]) {
        (joint.limits.lower, joint.limits.upper) = (middle - 0.5, middle + 0.5);
    }
    case.robot.chain = Chain::new("near", case.robot.chain.links().to_vec(), joints).unwrap();
    let tree = case.builder().build(&case.obstacles).unwrap();
    assert!(tree.is_blocked(&[0.0, 1.2, 0.8]));
    case.compare(&tree, 10_000);
}

/// Trees of 2 and of 3 axes: each model encloses the obstacle's own cells, and more spheres block a part of what fewer block.
#[test]
fn more_spheres_block_a_part_of_what_fewer_block() {
    let robot = example::arm().unwrap();
    let beam = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.5, 0.04) });
    let plate = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.25) });
    for (joints, step, shape, at) in [
        (&[0, 1, 2][..], 6.0, &beam, [0.25, 0.1, 0.7]),
        (&[1, 2], 2.0, &beam, [1.1, 0.0, 0.9]),
        (&[0, 1, 2], 8.0, &plate, [0.8, 0.6, 0.9]),
    ] {
        let axes = axes(&robot, joints, step);
        let builder = RobotMapBuilder::new(&robot, Pose::IDENTITY, &axes, joints, RemainingJoints::Swept).unwrap();
        let obstacle = [(shape, Pose::from_xyz_rpy(at, [0.2, 0.5, 0.1]))];
        let build = |model: ObstacleModel| builder.build_model(model, &obstacle, &|_| ()).unwrap();
        let exact = build(ObstacleModel::Exact);
        let mut before = build(ObstacleModel::Sphere);
        let mut cell = vec![0_u16; joints.len()];
        for count in [1, 2, 4, 7, 16, 64] {
            let finer = build(ObstacleModel::Spheres(count));
            let mut blocked = 0;
            'cells: loop {
                let [was, is, must] = [&before, &finer, &exact].map(|tree| tree.is_blocked_cell(&cell));
                assert!((was || !is) && (is || !must), "{count} spheres, cell {cell:?}: {was} {is} {must}");
                blocked += u64::from(is);
                for (index, axis) in cell.iter_mut().zip(&axes) {
                    *index += 1;
                    if usize::from(*index) < axis.count() {
                        continue 'cells;
                    }
                    *index = 0;
                }
                break;
            }
            assert_eq!(blocked, finer.blocked());
            before = finer;
        }
        let [fewest, most] = [before.blocked(), build(ObstacleModel::Sphere).blocked()];
        assert!(fewest < most, "{joints:?}: {fewest} of {most} of {}", exact.cells());
    }
}
