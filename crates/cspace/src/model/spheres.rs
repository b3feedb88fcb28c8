//! Many spheres, refined while time remains.

use std::time::Instant;

use elbowroom_spatial::{Pose, Vec3};

use crate::obstacle::Solid;
use crate::{Filler, Layer, Obstacle};

/// Most spheres of one obstacle.
pub(super) const MOST: u32 = 4096;

/// Replaces a layer by what spheres around parts of an obstacle block: one sphere first, then 2, 4, 8 … while the deadline
/// has not passed and there are fewer than `most`. Returns how many spheres the layer comes from.
///
/// The first sphere is always done. Each refinement can only free cells: what more spheres block is cut with what fewer
/// did, and both hold all that the obstacle blocks. A refinement that the deadline interrupts is dropped.
///
/// ```
/// use elbowroom_cspace::{Axis, Filler, Grid, Layer, Obstacle, PlanarArm, spheres_until};
/// use elbowroom_spatial::{Pose, Vec3};
/// use std::time::{Duration, Instant};
/// # let axis = |name: &str| Axis::from_degrees(name, -90.0, 90.0, 5.0);
/// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let mut filler = Filler::new(PlanarArm::KR125_SIZED, &grid)?;
/// let beam = Obstacle::cuboid(Pose::from_xyz_rpy([1.2, 0.0, 0.8], [0.0; 3]), Vec3::new(0.1, 0.8, 0.1))?;
/// let mut layer = Layer::new();
/// let deadline = Instant::now() + Duration::from_millis(5);
/// let spheres = spheres_until(&mut filler, &beam, 64, Some(deadline), &mut layer);
/// assert!(spheres >= 1 && spheres <= 64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn spheres_until(
    filler: &mut Filler,
    obstacle: &Obstacle,
    most: u32,
    deadline: Option<Instant>,
    layer: &mut Layer,
) -> u32 {
    let mut parts = vec![Part::around(obstacle)];
    let (center, radius) = obstacle.enclosing_sphere();
    filler.fill(&Obstacle { solid: Solid::Sphere { center, radius } }, layer);
    if matches!(obstacle.solid, Solid::Sphere { .. }) {
        return 1;
    }
    let cells = filler.grid().shape()[2];
    let mut count = 1;
    while count < most.min(MOST) {
        parts = parts.iter().flat_map(Part::halves).collect();
        let Some(finer) = all(filler, &parts, deadline) else { break };
        layer.intersect(&finer, cells);
        count *= 2;
    }
    count
}

/// What all spheres block; `None` where time ran out.
fn all(filler: &mut Filler, parts: &[Part], deadline: Option<Instant>) -> Option<Layer> {
    let (mut whole, mut one) = (Layer::new(), Layer::new());
    for part in parts {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return None;
        }
        filler.fill(&part.sphere(), &mut one);
        whole.spans.extend_from_slice(&one.spans);
    }
    whole.spans.sort_unstable();
    Some(whole)
}

/// A part of the obstacle's box.
#[derive(Clone, Copy)]
struct Part {
    in_base: Pose,
    half: Vec3,
}

impl Part {
    fn around(obstacle: &Obstacle) -> Self {
        match &obstacle.solid {
            Solid::Sphere { center, radius } => {
                Self { in_base: Pose::from_translation(*center), half: Vec3::splat(*radius) }
            }
            Solid::Cuboid { in_base, half_extents } => Self { in_base: *in_base, half: *half_extents },
            Solid::Hull { in_base, hull } => {
                let (min, max) = (hull.aabb().min, hull.aabb().max);
                let middle = in_base.transform_point((min + max) * 0.5);
                Self { in_base: Pose::new(in_base.rotation, middle), half: (max - min) * 0.5 }
            }
        }
    }

    /// Cut across the longest edge.
    fn halves(&self) -> [Self; 2] {
        let h = self.half.to_array();
        let longest = (0..3).max_by(|&i, &j| h[i].total_cmp(&h[j])).unwrap_or(0);
        let mut half = h;
        half[longest] *= 0.5;
        let mut by = [0.0; 3];
        by[longest] = half[longest];
        [1.0, -1.0].map(|side| {
            let middle = self.in_base.transform_point(Vec3::from(by) * side);
            Self { in_base: Pose::new(self.in_base.rotation, middle), half: Vec3::from(half) }
        })
    }

    fn sphere(&self) -> Obstacle {
        Obstacle { solid: Solid::Sphere { center: self.in_base.translation, radius: self.half.length() } }
    }
}
