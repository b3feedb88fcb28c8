//! Query times for near and approaching pairs of a robot among four boxes and a mesh: `cargo bench -p elbowroom-formats
//! --bench near_times -- ROBOT.urdf [MARGIN_M]`.
//!
//! The robot moves along smooth motions, and is at random states.

use std::time::Instant;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{Robot, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, LevelOfDetail, Object, Scene, SceneMotion, SceneState, Selection};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::Random;

fn main() {
    let mut words = elbowroom_testkit::bench::arguments();
    let urdf = words.next().expect("ROBOT.urdf");
    let margin: f64 = words.next().map_or(0.5, |w| w.parse().expect("a number of metres"));
    let robot = robot::load(urdf.as_ref(), &LoadOptions::default()).expect("a robot").robot;
    let scene = among(robot);
    let mut r = Random(1);
    for (selected, one, other) in
        [("all pairs", Selection::All, Selection::All), ("with objects", Selection::Robots, Selection::Objects)]
    {
        for (states, path) in [("smooth", smooth(&scene, &mut r)), ("random", random(&scene, &mut r))] {
            let mut checker = Checker::new(&scene, CheckerOptions::default());
            let (mut near, mut approaching, mut reported, mut state) =
                (Vec::new(), Vec::new(), 0_u32, SceneState::new(&scene));
            let (mut motion, policy) =
                (SceneMotion::new(&scene), LevelOfDetail { within_m: margin, ..Default::default() });
            for (q, next) in path.iter().zip(path.iter().skip(1)) {
                state.set_q(&scene, RobotId(0), q).expect("a state");
                let mut query = checker.between(one, other);
                near.push(timed(|| query.distances_within(&state, margin, |_| reported += 1)));
                // A hundred steps in two seconds; joints move at most at 2 rad/s.
                let qd: Vec<f64> = q.iter().zip(next).map(|(a, b)| ((b - a) * 50.0).clamp(-2.0, 2.0)).collect();
                motion.set_qd(&scene, &state, RobotId(0), &qd).expect("velocities");
                approaching.push(timed(|| query.approaching(&state, &motion, &policy, 1.0, |_| {})));
            }
            let reported = f64::from(reported) / near.len() as f64;
            for (name, times) in [("near", &mut near), ("approaching", &mut approaching)] {
                times.sort_by(f64::total_cmp);
                let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
                let (median, most) = (at(0.5), at(0.99));
                eprintln!(
                    "{selected:>12}, {states}, {name:<11}: {reported:4.1} reported, {median:7.1} µs median, {most:7.1} µs 99 %"
                );
            }
        }
    }
}

/// Duration of a query, microseconds.
fn timed(query: impl FnOnce()) -> f64 {
    let started = Instant::now();
    query();
    started.elapsed().as_secs_f64() * 1e6
}

/// The robot, surrounded by four boxes and one of its own links as a mesh.
fn among(robot: Robot) -> Scene {
    let part = robot.colliders.iter().flatten().map(|b| b.shape.clone()).find(|s| matches!(s, Shape::Mesh(_)));
    let reach = 1.0;
    let cuboid = |x, y, z| Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) * reach });
    let mut builder = Scene::builder();
    let mut put = |name: &str, shape, at: [f64; 3], rpy| {
        builder.object(Object { name: name.into(), shape, in_world: Pose::from_xyz_rpy(at, rpy) });
    };
    put("table", cuboid(0.5, 0.8, 0.02), [1.8, 0.0, 0.4], [0.0; 3]);
    put("box", cuboid(0.2, 0.3, 0.15), [1.6, 0.9, 0.9], [0.1, 0.2, 0.3]);
    put("post", cuboid(0.05, 0.05, 1.2), [-1.2, 1.2, 1.2], [0.0; 3]);
    put("beam", cuboid(1.0, 0.06, 0.06), [0.5, -1.4, 1.9], [0.0, 0.1, 0.4]);
    put(
        "part",
        part.unwrap_or(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.3) })),
        [1.4, -0.8, 1.2],
        [0.4, 1.0, 0.2],
    );
    builder.robot("robot", robot, Pose::IDENTITY);
    builder.build().expect("a scene")
}

fn random(scene: &Scene, r: &mut Random) -> Vec<Vec<f64>> {
    (0..2000).map(|_| any(scene, r)).collect()
}

fn any(scene: &Scene, r: &mut Random) -> Vec<f64> {
    let chain = &scene.robots()[0].robot.chain;
    let limits = chain.active_joints().iter().map(|j| chain.joints()[j.0].limits);
    limits.map(|l| l.lower.max(-3.0) + (l.upper.min(3.0) - l.lower.max(-3.0)) * r.unit()).collect()
}

/// Twenty motions of a hundred steps each.
fn smooth(scene: &Scene, r: &mut Random) -> Vec<Vec<f64>> {
    let mut path = Vec::new();
    let mut from = any(scene, r);
    for _ in 0..20 {
        let to = any(scene, r);
        path.extend((0..100).map(|k| {
            let t = f64::from(k) / 100.0;
            from.iter().zip(&to).map(|(a, b)| a + (b - a) * t).collect::<Vec<_>>()
        }));
        from = to;
    }
    path
}
