//! Sets of spheres, refined until a deadline.

use std::time::Instant;

use elbowroom_spatial::{Pose, Vec3};

use super::model::MAX_SPHERES;
use crate::convex_obstacle::ConvexShape;
use crate::sphere_lattice::SphereLattice;
use crate::{ConvexObstacle, Layer, PlanarMapBuilder};

/// Replaces a layer by the cells that spheres around parts of an obstacle block: first one sphere, then 2, 4, 8 … until
/// the deadline passes or `max_spheres` is reached. Returns the number of spheres of the layer.
///
/// The first sphere is always completed. Each refinement only frees cells: its cells are intersected with the cells of
/// fewer spheres, and both sets contain all cells that the obstacle blocks. A refinement that the deadline interrupts
/// is discarded.
///
/// ```
/// use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, Layer, PlanarMapBuilder, PlanarArm, spheres_until};
/// use elbowroom_spatial::{Pose, Vec3};
/// use std::time::{Duration, Instant};
/// # let axis = |name: &str| GridAxis::from_degrees(name, -90.0, 90.0, 5.0);
/// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let mut builder = PlanarMapBuilder::new(PlanarArm::KR125_SIZED, &grid)?;
/// let beam = ConvexObstacle::cuboid(Pose::from_xyz_rpy([1.2, 0.0, 0.8], [0.0; 3]), Vec3::new(0.1, 0.8, 0.1))?;
/// let mut layer = Layer::new();
/// let deadline = Instant::now() + Duration::from_millis(5);
/// let spheres = spheres_until(&mut builder, &beam, 64, Some(deadline), &mut layer);
/// assert!(spheres >= 1 && spheres <= 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn spheres_until(
    builder: &mut PlanarMapBuilder,
    obstacle: &ConvexObstacle,
    max_spheres: u32,
    deadline: Option<Instant>,
    layer: &mut Layer,
) -> u32 {
    let bounds = BoundingBox::new(obstacle);
    let (center, radius) = obstacle.enclosing_sphere();
    builder.build_layer(&ConvexObstacle { solid: ConvexShape::Sphere { center, radius } }, layer);
    if matches!(obstacle.solid, ConvexShape::Sphere { .. }) {
        return 1;
    }
    let cells = builder.grid().shape()[2];
    let mut count = 1;
    while count < max_spheres.min(MAX_SPHERES) {
        let Some(finer) = union_of_spheres(builder, &bounds, 2 * count, deadline) else { break };
        layer.intersect(&finer, cells);
        count *= 2;
    }
    count
}

/// The cells that spheres around parts of a box block; `None` if the deadline passes.
fn union_of_spheres(
    builder: &mut PlanarMapBuilder,
    bounds: &BoundingBox,
    count: u32,
    deadline: Option<Instant>,
) -> Option<Layer> {
    let (mut whole, mut one) = (Layer::new(), Layer::new());
    for (centre, radius) in SphereLattice::new(bounds.half, count).spheres() {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return None;
        }
        let center = bounds.in_base.transform_point(centre);
        builder.build_layer(&ConvexObstacle { solid: ConvexShape::Sphere { center, radius } }, &mut one);
        whole.spans.extend_from_slice(&one.spans);
    }
    whole.spans.sort_unstable();
    Some(whole)
}

/// The box around an obstacle, aligned with the obstacle.
struct BoundingBox {
    in_base: Pose,
    half: Vec3,
}

impl BoundingBox {
    fn new(obstacle: &ConvexObstacle) -> Self {
        match &obstacle.solid {
            ConvexShape::Sphere { center, radius } => {
                Self { in_base: Pose::from_translation(*center), half: Vec3::splat(*radius) }
            }
            ConvexShape::Cuboid { in_base, half_extents } => Self { in_base: *in_base, half: *half_extents },
            ConvexShape::Hull { in_base, hull } => {
                let (min, max) = (hull.aabb().min, hull.aabb().max);
                let middle = in_base.transform_point((min + max) * 0.5);
                Self { in_base: Pose::new(in_base.rotation, middle), half: (max - min) * 0.5 }
            }
        }
    }
}
