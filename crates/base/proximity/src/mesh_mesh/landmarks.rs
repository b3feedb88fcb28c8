//! A few points of a surface, for estimating which of many meshes is nearest.

use elbowroom_spatial::Pose;
use fearless_simd::{Simd, dispatch, prelude::*};

use crate::TriMesh;
use crate::bvh::{ARITY, Bvh16, Leaf, box_of, most_central};
use crate::lanes::{V3, W16, detected_simd_level, load16, rows16, splat16, store16};

/// Sixteen points spread over a mesh's surface.
///
/// Of many pairs of meshes, measure the pair with the nearest landmarks first: most other pairs exceed its distance,
/// which is then their limit. The distance of landmarks is an upper bound up to f32 rounding, not a lower bound.
///
/// ```
/// use elbowroom_proximity::{TriMesh, advanced::Landmarks};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let of_mesh = Landmarks::of(&mesh);
/// let here = of_mesh.placed(&Pose::IDENTITY);
/// let (near, far) = (Pose::from_translation(Vec3::X * 2.0), Pose::from_translation(Vec3::X * 3.0));
/// assert!(here.distance_squared(&of_mesh.placed(&near)) < here.distance_squared(&of_mesh.placed(&far)));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Landmarks {
    points: [[f32; ARITY]; 3],
}

/// [`Landmarks`] in a common frame, in single precision.
#[derive(Debug, Clone, Copy)]
pub struct PlacedLandmarks {
    points: [[f32; ARITY]; 3],
}

impl Landmarks {
    /// Landmarks of a mesh, in its own frame, metres.
    pub fn of(mesh: &TriMesh) -> Self {
        let Bvh16 { leaves, frame, .. } = &mesh.bvh;
        let mut points = [[0.0; ARITY]; 3];
        for k in 0..ARITY {
            let first = (k * leaves.len() / ARITY).min(leaves.len() - 1);
            let end = ((k + 1) * leaves.len() / ARITY).max(first + 1);
            let p = frame.in_metres(middle_of(&leaves[first..end]));
            for axis in 0..3 {
                points[axis][k] = p[axis] as f32;
            }
        }
        Self { points }
    }

    /// The landmarks in the frame in which the mesh has this pose.
    pub fn placed(&self, pose: &Pose) -> PlacedLandmarks {
        let rows = pose.rotation.rows().map(|row| row.map(|x| x as f32));
        let shift = pose.translation.to_array().map(|x| x as f32);
        let points = dispatch!(detected_simd_level(), simd => {
            store16(load16(simd, &self.points).placed(&rows16(simd, &rows), splat16(simd, shift)))
        });
        PlacedLandmarks { points }
    }
}

impl PlacedLandmarks {
    /// Squared distance of the nearest two, m², in single precision; infinite if that is NaN.
    pub fn distance_squared(&self, other: &Self) -> f32 {
        dispatch!(detected_simd_level(), simd => least(simd, &load16(simd, &self.points), &other.points))
    }
}

#[inline(always)]
fn least<S: Simd>(simd: S, points: &V3<W16<S>>, others: &[[f32; ARITY]; 3]) -> f32 {
    let mut best = W16::splat(simd, f32::INFINITY);
    for j in 0..ARITY {
        let apart = points.minus(splat16(simd, [others[0][j], others[1][j], others[2][j]]));
        best = best.min(apart.dot(apart));
    }
    let mut squares = [0.0; ARITY];
    best.store_slice(&mut squares);
    squares.into_iter().fold(f32::INFINITY, f32::min)
}

/// The triangle centroid nearest to the middle of the box.
fn middle_of(leaves: &[Leaf]) -> [f32; 3] {
    let (low, high) = box_of(leaves);
    most_central(leaves, std::array::from_fn(|k| 0.5 * (low[k] + high[k])))
}
