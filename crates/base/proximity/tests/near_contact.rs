//! Shapes with tiny gaps: collision, distance, lower bound and witness points must be consistent, in either order of the shapes.

use crate::common::{RandomGeometry, SplitMix, cases};
use elbowroom_proximity::{Separation, Shape, collides, project_point, separation, separation_within};
use elbowroom_spatial::Pose;

const KINDS: [&str; 7] = ["sphere", "capsule", "cylinder", "box", "hull", "plane", "mesh"];

/// Gaps in metres; negative if the shapes overlap.
const GAPS: [f64; 20] = [
    0.0, 1e-15, 3e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, -1e-15, -1e-14, -1e-13, -1e-12,
    -1e-11, -1e-9, -1e-6, -1e-3,
];

// The following values, by the number of cylinders, are in metres, for shapes of about 1 m.

/// Gap above which shapes are never in contact.
const SEPARATED: [f64; 3] = [2e-13, 2e-13, 1e-8];
/// Largest error of the distance.
const ACCURATE: [f64; 3] = [1e-11, 1e-8, 1e-8];
/// Largest distance of a witness point outside its shape, as a fraction of the coordinates, on contact and apart.
const ON_SHAPE: [f64; 3] = [1e-9, 1e-8, 1e-8];
const ON_SHAPE_APART: f64 = 1e-15;

/// Excess of the distance of continuous witness points over the distance, as a fraction of the coordinates.
const PARALLEL: f64 = 2e-8;

struct Placed {
    a: Shape,
    a_in_world: Pose,
    b: Shape,
    b_in_world: Pose,
}

impl Placed {
    fn cylinders(&self) -> usize {
        [&self.a, &self.b].iter().filter(|s| matches!(s, Shape::Cylinder(_))).count()
    }

    fn is_flat(&self) -> bool {
        [&self.a, &self.b].iter().all(|s| !matches!(s, Shape::Sphere(_) | Shape::HalfSpace(_)))
    }

    /// Approximately the largest coordinate: shapes of these tests are at most 3 m large.
    fn scale(&self) -> f64 {
        3.0 + self.a_in_world.translation.abs().max_element() + self.b_in_world.translation.abs().max_element()
    }

    /// Checks that all answers about the pair agree, and returns the separation.
    fn consistent(&self) -> Separation {
        let Self { a, a_in_world: pa, b, b_in_world: pb } = self;
        let s = separation(a, pa, b, pb);
        let what = || format!("{a:?} at {pa:?}\n{b:?} at {pb:?}\n{s:?}");
        let hit = s.distance <= 0.0;
        assert_eq!(s.lower_bound <= 0.0, hit, "{}", what());
        assert_eq!(collides(a, pa, b, pb), hit, "{}", what());
        assert_eq!(collides(b, pb, a, pa), hit, "swapped: {}", what());
        assert_eq!(separation_within(a, pa, b, pb, 0.0).is_some(), hit, "{}", what());
        let swapped = separation(b, pb, a, pa);
        assert_eq!((s.distance, s.lower_bound), (swapped.distance, swapped.lower_bound), "{}", what());
        assert_eq!((s.on_a, s.on_b), (swapped.on_b, swapped.on_a), "{}", what());
        let apart = s.on_a.distance(s.on_b);
        let allowed = if self.is_flat() { PARALLEL } else { 1e-15 };
        assert!((apart - s.distance).abs() <= allowed * self.scale(), "witnesses are {apart:e} m apart: {}", what());
        assert!(s.lower_bound <= apart, "{}", what());
        assert!(!hit || apart == 0.0, "{}", what());
        let off = |shape, pose, p| project_point(shape, pose, p).signed_distance;
        let outside = off(a, pa, s.on_a).max(off(b, pb, s.on_b));
        let allowed = if hit { ON_SHAPE[self.cylinders()] } else { ON_SHAPE_APART };
        assert!(outside <= allowed * self.scale(), "a witness is {outside:e} m outside: {}", what());
        s
    }

    /// True if a millimetre along the normal stays inside, which is not so beyond the edge of a thin disc or a sharp
    /// corner of a hull.
    fn blunt(&self) -> bool {
        let least = |shape: &Shape| match shape {
            Shape::Sphere(s) => s.radius,
            Shape::Capsule(c) => c.radius,
            Shape::Cylinder(c) => c.radius.min(c.half_length),
            Shape::Cuboid(c) => c.half_extents.min_element(),
            Shape::HalfSpace(_) => f64::INFINITY,
            Shape::Hull(_) | Shape::Mesh(_) => 0.0,
        };
        least(&self.a).min(least(&self.b)) > 0.01
    }
}

fn pair(first: &str, second: &str, rng: &mut SplitMix) {
    let solid = first != "mesh" && second != "mesh";
    let (mut apart, mut touching) = (0, 0);
    for _ in 0..cases(250) {
        let mut placed =
            Placed { a: rng.shape(first), a_in_world: rng.pose(1.5), b: rng.shape(second), b_in_world: rng.pose(1.5) };
        let far = placed.consistent();
        let Some(toward_b) = (far.on_b - far.on_a).try_normalize() else { continue };
        let start = placed.a_in_world;
        let blunt = placed.blunt();
        for gap in GAPS.into_iter().filter(|_| far.distance > 1e-3) {
            placed.a_in_world = Pose::new(start.rotation, start.translation + toward_b * (far.distance - gap));
            let near = placed.consistent();
            let (separated, accurate) = (SEPARATED[placed.cylinders()], ACCURATE[placed.cylinders()]);
            // The excess of continuous witness points.
            let excess = if placed.is_flat() { PARALLEL * placed.scale() } else { 0.0 };
            let what = || format!("{:?}\n{:?}\n{near:?}", placed.a, placed.b);
            assert!(gap <= separated || near.distance > 0.0, "{gap:e} m apart count as contact: {}", what());
            assert!(gap < 0.0 || (near.distance - gap).abs() <= accurate + excess, "{gap:e} m: {}", what());
            assert!(!blunt || gap >= -1e-13 - excess || near.distance == 0.0, "{gap:e} m: {}", what());
            apart += usize::from(near.distance > 0.0);
            touching += usize::from(near.distance <= 0.0);
        }
    }
    assert!(!solid || apart.min(touching) > 100, "{first} {second}: {apart} apart, {touching} touching are too few");
}

#[test]
fn near_contact_every_answer_agrees() {
    let mut rng = SplitMix(2026);
    for first in KINDS {
        for second in KINDS {
            // Two half-spaces are apart in too few poses, and two meshes have their own tests.
            if first != second || !["plane", "mesh"].contains(&first) {
                pair(first, second, &mut rng);
            }
        }
    }
}

#[test]
fn overlapping_shapes_share_the_witness_point() {
    let mut rng = SplitMix(77);
    for first in KINDS {
        for second in KINDS {
            for _ in 0..cases(100) {
                let (a, b) = (rng.shape(first), rng.shape(second));
                let placed = Placed { a, a_in_world: rng.pose(0.7), b, b_in_world: rng.pose(0.7) };
                if first != "mesh" || second != "mesh" {
                    placed.consistent();
                }
            }
        }
    }
}

/// The shapes have the same pose, like the shapes of one link in the link's frame.
#[test]
fn shapes_at_the_same_place_have_one_answer() {
    let mut rng = SplitMix(5);
    for first in KINDS {
        for second in KINDS.into_iter().filter(|second| first != "mesh" || *second != "mesh") {
            for _ in 0..cases(20) {
                let pose = rng.pose(1.0);
                Placed { a: rng.shape(first), a_in_world: pose, b: rng.shape(second), b_in_world: pose }.consistent();
            }
        }
    }
}
