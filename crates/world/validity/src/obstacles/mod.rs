//! Obstacles: solids that do not move while configurations are tested.

mod box_tree;
mod broad_phase;
mod prism;
mod slab_index;
mod solid;

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

pub(crate) use broad_phase::BroadPhase;
pub(crate) use solid::RoundedSolid;

use crate::cover_source::{BuiltCovers, CoverSource};
use prism::PrismBoxes;

/// Largest protrusion of the cover of a mesh or hull, m.
const MESH_SLACK_M: f64 = 0.005;
/// Rounding errors of coordinates and distances in single precision, per metre of coordinates and extents.
const ROUNDING_SHARE: f64 = 2e-6;
/// Largest distance or size of an enclosed obstacle, margins included, m. Beyond it, squares would overflow.
const LARGEST_M: f64 = 1e8;

/// Obstacles that do not move: shapes, and points of a cloud.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_validity::ObstacleSet;
/// let mut obstacles = ObstacleSet::default();
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.4, 0.3, 0.02) });
/// let id = obstacles.add_shape(&table, &Pose::from_translation(Vec3::new(0.6, 0.0, 0.3)), 0.0);
/// assert_eq!((id, obstacles.len()), (0, 1));
/// ```
#[derive(Debug, Clone, Default)]
pub struct ObstacleSet {
    /// Solids whose union encloses all obstacles, margins included.
    pub(crate) outer: Vec<RoundedSolid>,
    /// The obstacle of each entry of `outer`.
    pub(crate) outer_source: Vec<u32>,
    /// Solids that each lie in an obstacle.
    pub(crate) inner: Vec<RoundedSolid>,
    /// The obstacle of each entry of `inner`.
    pub(crate) inner_source: Vec<u32>,
    count: usize,
    /// True if an obstacle has no enclosing solid.
    pub(crate) has_unknown: bool,
}

impl ObstacleSet {
    /// Adds a shape with a margin (m) around its surface, and returns its number.
    ///
    /// A shape with NaN or infinite numbers, or with a coordinate beyond 10⁸ m, makes every answer uncertain.
    pub fn add_shape(&mut self, shape: &Shape, in_world: &Pose, margin_m: f64) -> usize {
        self.add_shape_with(shape, in_world, margin_m, &BuiltCovers)
    }

    /// Like [`add_shape`](Self::add_shape), with the covers of meshes and hulls from a source.
    pub fn add_shape_with(&mut self, shape: &Shape, in_world: &Pose, margin_m: f64, covers: &dyn CoverSource) -> usize {
        let id = self.next();
        if shape.validate().is_err() || !in_world.is_finite() || !margin_m.is_finite() {
            self.has_unknown = true;
            return id;
        }
        let extent = match shape {
            Shape::HalfSpace(_) => 0.0,
            _ => shape.aabb(&Pose::IDENTITY).max_distance(Vec3::ZERO),
        };
        let size_m = in_world.translation.length() + extent + margin_m.max(0.0) + 1.0;
        if !(size_m <= LARGEST_M) {
            self.has_unknown = true;
            return id;
        }
        let rounding_m = ROUNDING_SHARE * size_m;
        let core_radius = match shape {
            Shape::Sphere(s) => s.radius,
            Shape::Capsule(c) => c.radius,
            _ => 0.0,
        };
        let solid = |radius: f64| match shape {
            Shape::Sphere(_) => Some(RoundedSolid::point(in_world.translation, radius as f32)),
            Shape::Capsule(c) => Some(RoundedSolid::segment(c.half_length, in_world, radius as f32)),
            Shape::Cylinder(c) => Some(RoundedSolid::cylinder(c.radius, c.half_length, in_world, radius as f32)),
            Shape::Cuboid(c) => Some(RoundedSolid::cuboid(c.half_extents, in_world, radius as f32)),
            Shape::HalfSpace(_) => Some(RoundedSolid::half_space(in_world, radius as f32)),
            Shape::Hull(_) | Shape::Mesh(_) => None,
        };
        if let (Some(outer), Some(inner)) =
            (solid(core_radius + margin_m.max(0.0) + rounding_m), solid(core_radius - rounding_m))
        {
            self.push_outer(outer, id);
            self.push_inner(inner, id);
            return id;
        }
        let margins = [margin_m.max(0.0) + rounding_m, rounding_m];
        if !self.add_prism(shape, in_world, margins, id) {
            self.add_covered(shape, in_world, margins, id, covers);
        }
        id
    }

    /// Adds the boxes of a hull that is a prism. Returns false for other shapes.
    ///
    /// The outer boxes are enlarged by the first margin (m); the inner ones are made smaller by the second.
    fn add_prism(&mut self, shape: &Shape, in_world: &Pose, [outside_m, rounding_m]: [f64; 2], id: usize) -> bool {
        let Shape::Hull(hull) = shape else { return false };
        let Some(boxes) = PrismBoxes::of(hull, MESH_SLACK_M) else { return false };
        for b in boxes.outer {
            self.push_outer(RoundedSolid::cuboid(b.half_extents, &(*in_world * b.in_prism), outside_m as f32), id);
        }
        for b in boxes.inner {
            self.push_inner(RoundedSolid::cuboid(b.half_extents, &(*in_world * b.in_prism), -rounding_m as f32), id);
        }
        true
    }

    /// Adds the points of a cloud as balls of one radius (m), and returns the number that they share.
    ///
    /// Points that are not finite, or beyond 10⁸ m, make every answer uncertain.
    pub fn add_points(&mut self, points: &[Vec3], radius_m: f64) -> usize {
        let id = self.next();
        for p in points {
            let size_m = p.length() + radius_m.abs() + 1.0;
            if !(size_m <= LARGEST_M && radius_m >= 0.0) {
                self.has_unknown = true;
                continue;
            }
            let rounding_m = ROUNDING_SHARE * size_m;
            self.push_outer(RoundedSolid::point(*p, (radius_m + rounding_m) as f32), id);
            self.push_inner(RoundedSolid::point(*p, (radius_m - rounding_m) as f32), id);
        }
        id
    }

    /// Number of obstacles.
    pub fn len(&self) -> usize {
        self.count
    }

    /// True if the set has no obstacles.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn next(&mut self) -> usize {
        self.count += 1;
        self.count - 1
    }

    fn add_covered(
        &mut self,
        shape: &Shape,
        in_world: &Pose,
        [outside_m, rounding_m]: [f64; 2],
        id: usize,
        covers: &dyn CoverSource,
    ) {
        let Some(cover) = covers.cover(&[(shape, Pose::IDENTITY)], MESH_SLACK_M) else {
            self.has_unknown = true;
            return;
        };
        for ball in cover.outer {
            let centre = in_world.transform_point(ball.centre);
            self.push_outer(RoundedSolid::point(centre, (ball.radius + outside_m) as f32), id);
        }
        for ball in cover.inner {
            let centre = in_world.transform_point(ball.centre);
            self.push_inner(RoundedSolid::point(centre, (ball.radius - rounding_m) as f32), id);
        }
    }

    fn push_outer(&mut self, solid: RoundedSolid, id: usize) {
        self.outer.push(solid);
        self.outer_source.push(id as u32);
    }

    fn push_inner(&mut self, solid: RoundedSolid, id: usize) {
        self.inner.push(solid);
        self.inner_source.push(id as u32);
    }
}
