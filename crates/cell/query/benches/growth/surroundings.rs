//! Robots and objects of the tables.

use std::f64::consts::TAU;
use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Shape, Sphere, TriMesh, tessellate::tessellate};
use elbowroom_scene::Object;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::bench::hall_places;
use elbowroom_testkit::random::Random;

/// Free space around the vertical axis of each arm, m: nothing stands where its base does.
const CLEAR_M: f64 = 0.35;
/// Distance of neighbouring robots of a line, m: less than twice their reach of 0.67 m and the wrist.
const APART_M: f64 = 1.0;
/// Obstacles around each robot of a line.
const PER_ROBOT: usize = 8;

/// Bases of the arms, and what stands around them.
pub struct Surroundings {
    /// Number of what grows.
    pub size: usize,
    pub bases: Vec<Pose>,
    pub objects: Vec<Object>,
}

/// One arm among boxes of 6 to 30 cm; each tenth obstacle is a ball of triangles instead, of 20 cm. The hall grows with
/// their number: the arm always has about as many neighbours, and ever more objects are far away.
pub fn hall(count: usize) -> Surroundings {
    let (mut random, ball) = (Random(13), ball());
    let places = hall_places(count).into_iter().enumerate();
    let objects = places.map(|(i, at)| object(i, &ball, at.into(), &mut random));
    Surroundings { size: count, bases: vec![Pose::IDENTITY], objects: objects.collect() }
}

/// One arm in a cell of always the same size and shape: its walls and floor, divided into about so many boxes.
pub fn cell_in_parts(count: usize) -> Surroundings {
    // Two walls 0.5 m beside the base, and a floor 0.1 m below it.
    let tiles = (count as f64 / 3.0).sqrt().round().max(1.0) as usize;
    let half = 1.0 / tiles as f64;
    let mut objects = Vec::with_capacity(3 * tiles * tiles);
    for (i, j) in (0..tiles).flat_map(|i| (0..tiles).map(move |j| (i, j))) {
        let [u, v] = [i, j].map(|n| (2 * n + 1) as f64 * half - 1.0);
        let walls = [
            (Vec3::new(u, v, -0.11), Vec3::new(half, half, 0.01)),
            (Vec3::new(0.51, u, v + 0.9), Vec3::new(0.01, half, half)),
            (Vec3::new(u, 0.51, v + 0.9), Vec3::new(half, 0.01, half)),
        ];
        for (at, half_extents) in walls {
            let (name, shape) = (format!("part {}", objects.len()), Shape::Cuboid(Cuboid { half_extents }));
            objects.push(Object { name, shape, in_world: Pose::from_translation(at) });
        }
    }
    Surroundings { size: objects.len(), bases: vec![Pose::IDENTITY], objects }
}

/// Arms in two rows, each in reach of its neighbours, and with as many obstacles around each.
pub fn line_of_robots(count: usize) -> Surroundings {
    let (mut random, ball) = (Random(12), ball());
    let base = |i: usize| Vec3::new((i / 2) as f64, (i % 2) as f64, 0.0) * APART_M;
    let bases: Vec<Vec3> = (0..count).map(base).collect();
    let mut objects = Vec::new();
    for centre in &bases {
        let mut placed = 0;
        while placed < PER_ROBOT {
            let (angle, radius) = (random.between(0.0, TAU), random.between(0.45, 0.9));
            let at = *centre + Vec3::new(radius * angle.cos(), radius * angle.sin(), random.between(-0.1, 1.1));
            if bases.iter().all(|b| (at - *b).x.hypot((at - *b).y) >= CLEAR_M) {
                objects.push(object(objects.len(), &ball, at, &mut random));
                placed += 1;
            }
        }
    }
    Surroundings { size: count, bases: bases.into_iter().map(Pose::from_translation).collect(), objects }
}

fn ball() -> Arc<TriMesh> {
    let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius: 0.1 }), 0.002);
    Arc::new(TriMesh::new(vertices, triangles).expect("a closed ball"))
}

/// A box of random size, or each tenth time a ball of triangles, with a random rotation.
fn object(i: usize, ball: &Arc<TriMesh>, at: Vec3, random: &mut Random) -> Object {
    let mut half = || random.between(0.03, 0.15);
    let half_extents = Vec3::new(half(), half(), half());
    let shape = if i % 10 == 9 { Shape::Mesh(ball.clone()) } else { Shape::Cuboid(Cuboid { half_extents }) };
    let rotation = Rotation::from_rpy(random.between(-3.0, 3.0), random.between(-1.5, 1.5), random.between(-3.0, 3.0));
    Object { name: format!("object {i}"), shape, in_world: Pose::new(rotation, at) }
}
