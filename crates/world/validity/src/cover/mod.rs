//! Sphere covers of solids: outer spheres that enclose a solid, inner spheres inside it.
//!
//! The outer cover is complete by construction. The solid is divided into voxels. Every voxel inside lies in one sphere
//! of the cover. So does the content of every voxel that the surface crosses (the clipped triangles, and the corners that
//! are not outside). A sphere is never larger than the distance of its centre from the surface plus the slack, so no
//! point of the cover is farther from the solid than the slack.

mod ball;
mod inner;
mod medial_balls;
mod placement;
mod selection;
mod surface_voxels;
mod triangle_slices;
mod uncovered;
mod voxel_bits;
mod voxel_grid;
mod voxel_tree;

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

pub use ball::Ball;
pub(crate) use ball::{ROUNDING_M, enclosing};

use self::placement::PlacedShapes;
use self::selection::outer_balls;
use self::voxel_grid::VoxelGrid;

/// Largest distance of a covered shape from the origin, m.
///
/// Beyond it, rounding errors of double precision would exceed [`ROUNDING_M`].
const LARGEST_M: f64 = 1e4;

/// Outer and inner spheres of a solid that consists of shapes.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_validity::SphereCover;
/// let block = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.05, 0.05) });
/// let cover = SphereCover::new(&[(&block, Pose::IDENTITY)], 0.005).expect("a bounded solid");
/// let corner = Vec3::new(0.1, 0.05, 0.05);
/// assert!(cover.outer.iter().any(|ball| ball.contains(corner)));
/// assert!(cover.inner.iter().all(|ball| !ball.contains(corner)));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SphereCover {
    /// Outer spheres: their union encloses the solid.
    pub outer: Vec<Ball>,
    /// Inner spheres: each lies in the solid. Empty for surfaces that are not closed.
    pub inner: Vec<Ball>,
}

impl SphereCover {
    /// Covers the union of shapes, each with its pose in the frame of the cover.
    ///
    /// No outer sphere protrudes from the solid by more than `slack_m`, except at gaps narrower than two voxels, at
    /// cavities that the surface encloses, and for solids that need more voxels than the largest number.
    ///
    /// `None` if a shape is unbounded, has NaN or infinite numbers, or reaches beyond 10 km, because spheres cannot
    /// enclose it. Without shapes the cover is empty.
    pub fn new(shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<Self> {
        let mut cover = Self::default();
        let mut others = Vec::new();
        for &(shape, pose) in shapes {
            if shape.validate().is_err() || !pose.is_finite() {
                return None;
            }
            let bounds = shape.aabb(&pose);
            if !(bounds.extent().is_finite() && bounds.max_distance(Vec3::ZERO) <= LARGEST_M) {
                return None;
            }
            match shape {
                Shape::Sphere(s) => {
                    let ball = Ball { centre: pose.translation, radius: s.radius };
                    cover.outer.push(ball.rounded_up());
                    cover.inner.push(ball);
                }
                _ => others.push((shape, pose)),
            }
        }
        let placed = PlacedShapes::new(others);
        if let Some(grid) = VoxelGrid::new(&placed.triangles, slack_m) {
            cover.outer.extend(outer_balls(&placed, &grid, slack_m)?);
            cover.inner.extend(inner::inner_balls(&placed, &grid));
        }
        Some(cover)
    }
}
