//! Distance of an oriented box.

use elbowroom_spatial::{Aabb, Pose, Vec3};
use fearless_simd::{Simd, dispatch, prelude::*};

use super::bvh16::Bvh16;
use super::node::{ARITY, LEAF_SIZE, Leaf, Node};
use super::node_bound::{NodeBound, normals};
use crate::lanes::{
    F32_ERROR, V3, W8, W16, abs16, array8, array16, detected_simd_level, load_corners, load16, narrow, splat8, splat16,
};

/// Largest extent, units of the tree's frame, whose square is finite in f32.
const LARGEST_EXTENT: f64 = 1e18;

/// Distance from a box in its own frame.
pub(crate) struct BoxDistance {
    /// Centre of the box in the mesh's frame.
    center: [f32; 3],
    /// The box's axes in the mesh's frame, as rows.
    axes: [[f32; 3]; 3],
    half: [f32; 3],
    /// Half extents of the bounding box of this box, along the mesh's axes.
    bounding_half: [f32; 3],
    /// Upper bound of the error of every bound.
    error: f32,
}

impl BoxDistance {
    /// Distance from the box `bounds` in the frame that `in_mesh` places, metres.
    pub fn new(tree: &Bvh16, bounds: &Aabb, in_mesh: &Pose) -> Self {
        let unit = tree.frame.unit;
        let middle = tree.frame.to_units(in_mesh.transform_point(bounds.center()));
        let half = bounds.extent() * (0.5 / unit);
        let axes = [in_mesh.rotation.x_axis(), in_mesh.rotation.y_axis(), in_mesh.rotation.z_axis()];
        let bounding_half = axes[0].abs() * half.x + axes[1].abs() * half.y + axes[2].abs() * half.z;
        let extent = 1.0 + middle.abs().max_element() + half.x + half.y + half.z;
        // Squares of larger numbers overflow: then nothing is excluded.
        let error = if extent < LARGEST_EXTENT { extent * F32_ERROR } else { f64::INFINITY };
        Self {
            center: narrow(middle),
            axes: [narrow(axes[0]), narrow(axes[1]), narrow(axes[2])],
            half: narrow(half),
            bounding_half: narrow(bounding_half),
            error: error as f32,
        }
    }

    /// Distance from a point in the mesh's frame, metres.
    pub fn from_point(tree: &Bvh16, p: Vec3) -> Self {
        Self::new(tree, &Aabb { min: Vec3::ZERO, max: Vec3::ZERO }, &Pose::from_translation(p))
    }

    /// Converts a length in metres to a limit of the traversal.
    pub fn limit(tree: &Bvh16, metres: f64) -> f32 {
        (metres * tree.frame.inverse * (1.0 + 1e-6)) as f32
    }

    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let zero = W16::splat(simd, 0.0);
        let c = load16(simd, &node.center).minus(splat16(simd, self.center));
        let h = load16(simd, &node.half);
        let [a, b, d] = self.bounding_half;
        let in_mesh =
            V3((c.0.abs() - (h.0 + a)).max(zero), (c.1.abs() - (h.1 + b)).max(zero), (c.2.abs() - (h.2 + d)).max(zero));
        let own = V3(
            axis_gap(simd, c, h, self.axes[0], self.half[0]).max(zero),
            axis_gap(simd, c, h, self.axes[1], self.half[1]).max(zero),
            axis_gap(simd, c, h, self.axes[2], self.half[2]).max(zero),
        );
        let slab = self.slab_gap(simd, node);
        in_mesh.dot(in_mesh).max(own.dot(own)).sqrt().max(slab) - self.error
    }

    /// The distance of each triangle's bounds in the frame of the box, or the gap along its normal.
    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, leaf: &Leaf) -> W8<S> {
        let zero = W8::splat(simd, 0.0);
        let center = splat8(simd, self.center);
        let [p, q, r] = load_corners(simd, &leaf.corner).map(|corner| corner.minus(center));
        let gap = |axis: [f32; 3], half: f32| {
            let along = splat8(simd, axis);
            let (p, q, r) = (p.dot(along), q.dot(along), r.dot(along));
            (p.min(q).min(r) - half).max(-p.max(q).max(r) - half).max(zero)
        };
        let own = V3(gap(self.axes[0], self.half[0]), gap(self.axes[1], self.half[1]), gap(self.axes[2], self.half[2]));
        let n = normals(simd, [p, q, r]);
        let (p, q, r) = (n.dot(p), n.dot(q), n.dot(r));
        let reach = |axis: [f32; 3], half: f32| n.dot(splat8(simd, axis)).abs() * half;
        let reach =
            reach(self.axes[0], self.half[0]) + reach(self.axes[1], self.half[1]) + reach(self.axes[2], self.half[2]);
        let slab = p.min(q).min(r).max(-p.max(q).max(r)) - reach;
        own.dot(own).sqrt().max(slab) - self.error
    }

    /// Gap along each child's slab normal.
    #[inline(always)]
    fn slab_gap<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let n = load16(simd, &node.normal);
        let p = n.dot(splat16(simd, self.center));
        let spread = V3(
            n.dot(splat16(simd, self.axes[0])),
            n.dot(splat16(simd, self.axes[1])),
            n.dot(splat16(simd, self.axes[2])),
        );
        let reach = abs16(spread).dot(splat16(simd, self.half));
        let (low, high) = (W16::load_array_ref(simd, &node.low), W16::load_array_ref(simd, &node.high));
        (p - high).max(low - p) - reach
    }
}

impl NodeBound for BoxDistance {
    fn lower_bounds(&self, node: &Node) -> [f32; ARITY] {
        dispatch!(detected_simd_level(), simd => array16(self.lanes(simd, node)))
    }

    fn leaf_bounds(&self, leaf: &Leaf) -> [f32; LEAF_SIZE] {
        dispatch!(detected_simd_level(), simd => array8(self.triangles(simd, leaf)))
    }
}

/// Gap of boxes and an interval around 0 along an axis.
#[inline(always)]
fn axis_gap<S: Simd>(simd: S, c: V3<W16<S>>, h: V3<W16<S>>, axis: [f32; 3], half: f32) -> W16<S> {
    let [x, y, z] = axis;
    c.dot(splat16(simd, axis)).abs() - (h.dot(splat16(simd, [x.abs(), y.abs(), z.abs()])) + half)
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Rotation;
    use elbowroom_testkit::random::Random;

    use super::*;
    use crate::separation::{core::Core, projections};
    use crate::{Cuboid, TriMesh};

    #[test]
    fn no_bound_of_a_triangle_is_above_its_distance() {
        let mut random = Random(5);
        for size in [1e-6, 1.0, 1e3] {
            for _ in 0..40 {
                let off = Vec3::from(random.within(1.0)) * (size * 10f64.powf(random.between(-2.0, 2.0)));
                let corners: Vec<Vec3> = (0..60).map(|_| off + Vec3::from(random.within(1.0)) * size).collect();
                let mesh = TriMesh::new(corners, (0..20).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
                let rotation =
                    Rotation::from_rpy(random.between(-3.0, 3.0), random.between(-1.5, 1.5), random.between(-3.0, 3.0));
                let in_mesh = Pose::new(rotation, off + Vec3::from(random.within(2.0)) * size);
                let solid = Cuboid { half_extents: Vec3::from(random.within(1.0)).abs() * size };
                let bounds = Aabb { min: -solid.half_extents, max: solid.half_extents };
                let query = BoxDistance::new(&mesh.bvh, &bounds, &in_mesh);
                for (number, leaf) in mesh.bvh.leaves.iter().enumerate() {
                    for (lane, bound) in query.leaf_bounds(leaf).into_iter().take(mesh.bvh.leaf_len(number)).enumerate()
                    {
                        let triangle = mesh.bvh.triangle((number * LEAF_SIZE + lane) as u32);
                        let local = mesh.corners(triangle).map(|p| in_mesh.inverse_transform_point(p));
                        let core = (Core::Triangle(local), Core::Cuboid(solid));
                        let gap = projections::distance(&core.0, &core.1, &Pose::IDENTITY, f64::INFINITY).unwrap();
                        let metres = f64::from(bound) * mesh.bvh.frame.unit;
                        assert!(metres <= gap.distance, "{metres} {gap:?}");
                        // The bounds of a triangle in the frame of the box are no farther than its corners.
                        let corner = local.iter().map(|p| p.distance(solid.nearest(*p))).fold(f64::INFINITY, f64::min);
                        assert!(metres <= corner);
                    }
                }
            }
        }
    }
}
