//! Groups of meshes, and the query whether two of them touch.

use std::sync::Arc;

use elbowroom_spatial::{Pose, Vec3};
use fearless_simd::{Level as SimdLevel, Simd, dispatch};

use super::capsule_row::{BoundingCapsule, CapsuleRow, PlacedRow};
use super::group_frame::GroupFrame;
use super::interior_spheres::interior_spheres;
use super::sphere_row::{LANES, SphereRow};
use crate::TriMesh;
use crate::lanes::{detected_simd_level, narrow};
use crate::mesh_mesh::{Workspace, colliding_triangles};

/// Meshes that each move with their own pose, such as the links of an arm, with data that decides most of their
/// collision queries.
///
/// ```
/// use std::sync::Arc;
/// use elbowroom_proximity::{TriMesh, advanced::{GroupWorkspace, MeshGroup}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = Arc::new(TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?);
/// let (one, two) = (MeshGroup::new(vec![mesh.clone()]), MeshGroup::new(vec![mesh.clone(), mesh]));
/// let at = |x: f64| Pose::from_translation(Vec3::X * x);
/// let mut workspace = GroupWorkspace::new();
/// assert!(one.collides(&[at(0.0)], &two, &[at(-3.0), at(0.9)], &mut workspace));
/// assert!(!one.collides(&[at(0.0)], &two, &[at(-3.0), at(1.1)], &mut workspace));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MeshGroup {
    meshes: Vec<GroupMesh>,
    /// Rows of the capsules around the meshes.
    rows: Vec<CapsuleRow>,
    /// Middles of the capsules.
    middles: Vec<Vec3>,
    /// Upper bound of the distance from the origin of a mesh to its farthest point, m.
    reach: f64,
}

#[derive(Debug, Clone)]
struct GroupMesh {
    mesh: Arc<TriMesh>,
    capsule: BoundingCapsule,
    /// Spheres inside the solid; empty if the mesh has no interior.
    interior: SphereRow,
}

/// Memory for queries on groups, one per thread. Answers never depend on earlier queries.
#[derive(Debug, Default)]
pub struct GroupWorkspace {
    mesh: Workspace,
    simd_level: Option<SimdLevel>,
    sides: [PlacedSpheres; 2],
    /// Meshes of the first group, rows of the second, and the lanes that may touch.
    near: Vec<(usize, usize, u32)>,
    /// Pairs that the spheres do not decide: how deep the inner spheres overlap (negative: how far they are apart), and
    /// the pair.
    unsettled: Vec<(f32, (usize, usize))>,
}

/// A group in the frame of a query.
#[derive(Debug, Default)]
struct PlacedSpheres {
    rows: Vec<PlacedRow>,
    interior: Vec<SphereRow>,
    /// True for meshes whose spheres are placed.
    is_placed: Vec<bool>,
}

impl GroupWorkspace {
    /// Creates a workspace for the best instruction set of this processor.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a workspace for a given instruction set.
    #[doc(hidden)]
    pub fn with_simd_level(simd_level: SimdLevel) -> Self {
        Self { simd_level: Some(simd_level), mesh: Workspace::with_simd_level(simd_level), ..Self::default() }
    }
}

impl MeshGroup {
    /// Creates a group; takes some milliseconds for each mesh.
    pub fn new(meshes: Vec<Arc<TriMesh>>) -> Self {
        let meshes: Vec<_> = meshes.into_iter().map(GroupMesh::new).collect();
        let capsules: Vec<_> = meshes.iter().map(|m| m.capsule).collect();
        let reach = capsules.iter().fold(0.0, |reach: f64, c| reach.max(c.reach));
        let middles = capsules.iter().map(|c| c.middle).collect();
        Self { meshes, rows: capsules.chunks(LANES).map(CapsuleRow::new).collect(), middles, reach }
    }

    /// True if a mesh of this group touches a mesh of the other, as [`colliding_triangles`] decides for each pair.
    ///
    /// `poses` has one pose for each mesh of this group, `other_poses` one for each mesh of the other group; if the
    /// number is wrong the answer is true.
    pub fn collides(&self, poses: &[Pose], other: &Self, other_poses: &[Pose], workspace: &mut GroupWorkspace) -> bool {
        if poses.len() != self.meshes.len() || other_poses.len() != other.meshes.len() {
            return true;
        }
        let Some(first) = poses.first() else { return false };
        let frame = GroupFrame::at(first.translation);
        let query = GroupQuery { frame, groups: [self, other], poses: [poses, other_poses] };
        let simd_level = workspace.simd_level.unwrap_or_else(detected_simd_level);
        workspace.unsettled.clear();
        dispatch!(simd_level, simd => query.settle(simd, workspace)) || query.measure(workspace)
    }
}

impl GroupMesh {
    fn new(mesh: Arc<TriMesh>) -> Self {
        let capsule = BoundingCapsule::of(&mesh);
        let interior = SphereRow::new(&interior_spheres(&mesh, LANES));
        Self { mesh, capsule, interior }
    }
}

struct GroupQuery<'a> {
    frame: GroupFrame,
    groups: [&'a MeshGroup; 2],
    poses: [&'a [Pose]; 2],
}

impl GroupQuery<'_> {
    /// Tests the bounding volumes of all pairs, then the spheres of the remaining pairs. True if a collision is proven;
    /// the pairs without a proof are in `unsettled`.
    #[inline(always)]
    fn settle<S: Simd>(&self, simd: S, workspace: &mut GroupWorkspace) -> bool {
        // The rows of the second group are read first, soon after they were written.
        let [one, other] = &mut workspace.sides;
        let sum = self.place_middles(1, &mut other.rows) + self.place_middles(0, &mut one.rows);
        let reach = self.groups[0].reach.max(self.groups[1].reach);
        let Some(error) = self.frame.error_m(f64::from(sum) + 2.0 * reach) else {
            self.settle_nothing(workspace);
            return false;
        };
        self.near_spheres(simd, error, workspace);
        !workspace.near.is_empty() && self.settle_near(simd, error, workspace)
    }

    /// Places the middles of the capsules. Returns the sum of their coordinates' magnitudes, m, which is NaN if one of
    /// them is.
    #[inline(always)]
    fn place_middles(&self, side: usize, rows: &mut Vec<PlacedRow>) -> f32 {
        let group = self.groups[side];
        rows.resize(group.rows.len(), PlacedRow::EMPTY);
        let mut sum = 0.0;
        let chunks = group.middles.chunks(LANES).zip(self.poses[side].chunks(LANES));
        for (row, (middles, poses)) in rows.iter_mut().zip(chunks) {
            let [x, y, z] = &mut row.middle;
            for (((x, y), z), (middle, pose)) in x.iter_mut().zip(y).zip(z).zip(middles.iter().zip(poses)) {
                [*x, *y, *z] = self.frame.point(pose, *middle);
                sum += x.abs() + y.abs() + z.abs();
            }
        }
        sum
    }

    #[inline(always)]
    fn near_spheres<S: Simd>(&self, simd: S, error: f32, workspace: &mut GroupWorkspace) {
        let GroupWorkspace { sides: [one, other], near, .. } = workspace;
        near.clear();
        for a in 0..self.poses[0].len() {
            let capsule = self.groups[0].rows[a / LANES].capsule(&one.rows[a / LANES], a % LANES);
            for (r, (row, placed)) in self.groups[1].rows.iter().zip(&other.rows).enumerate() {
                let lanes = row.near_spheres(simd, placed, &capsule, error);
                if lanes != 0 {
                    near.push((a, r, lanes));
                }
            }
        }
    }

    #[inline(always)]
    fn settle_near<S: Simd>(&self, simd: S, error: f32, workspace: &mut GroupWorkspace) -> bool {
        let GroupWorkspace { sides: [one, other], near, unsettled, .. } = workspace;
        self.prepare(0, one);
        self.prepare(1, other);
        for &(a, r, mut lanes) in near.iter() {
            self.place_axis(0, a, one);
            while lanes != 0 {
                self.place_axis(1, r * LANES + lanes.trailing_zeros() as usize, other);
                lanes &= lanes - 1;
            }
        }
        for &(a, r, lanes) in near.iter() {
            let capsule = self.groups[0].rows[a / LANES].capsule(&one.rows[a / LANES], a % LANES);
            let mut lanes = lanes & self.groups[1].rows[r].near_capsules(simd, &other.rows[r], &capsule, error);
            while lanes != 0 {
                let b = r * LANES + lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                self.place_spheres(simd, 0, a, one);
                self.place_spheres(simd, 1, b, other);
                let deepest = one.interior[a].deepest(simd, &other.interior[b], -error);
                if deepest > 0.0 {
                    return true;
                }
                unsettled.push((deepest, (a, b)));
            }
        }
        false
    }

    #[inline(always)]
    fn prepare(&self, side: usize, placed: &mut PlacedSpheres) {
        let count = self.poses[side].len();
        placed.is_placed.clear();
        placed.is_placed.resize(count, false);
        placed.interior.resize(count, SphereRow::EMPTY);
    }

    #[inline(always)]
    fn place_axis(&self, side: usize, i: usize, placed: &mut PlacedSpheres) {
        let axis = narrow(self.poses[side][i].rotation * self.groups[side].meshes[i].capsule.axis);
        for (k, x) in axis.into_iter().enumerate() {
            placed.rows[i / LANES].axis[k][i % LANES] = x;
        }
    }

    #[inline(always)]
    fn place_spheres<S: Simd>(&self, simd: S, side: usize, i: usize, placed: &mut PlacedSpheres) {
        if !placed.is_placed[i] {
            placed.is_placed[i] = true;
            let (mesh, pose) = (&self.groups[side].meshes[i], self.frame.pose(&self.poses[side][i]));
            mesh.interior.place(simd, &pose, &mut placed.interior[i]);
        }
    }

    fn settle_nothing(&self, workspace: &mut GroupWorkspace) {
        let [one, other] = self.poses.map(<[Pose]>::len);
        workspace.unsettled.extend((0..one).flat_map(|a| (0..other).map(move |b| (0.0, (a, b)))));
    }

    /// Measures the triangles of the remaining pairs, the deepest first.
    fn measure(&self, workspace: &mut GroupWorkspace) -> bool {
        let GroupWorkspace { mesh, unsettled, .. } = workspace;
        unsettled.sort_unstable_by(|x, y| y.0.total_cmp(&x.0));
        let [one, other] = &self.groups;
        unsettled.iter().any(|&(_, (a, b))| {
            let (x, y) = (&one.meshes[a].mesh, &other.meshes[b].mesh);
            colliding_triangles(x, &self.poses[0][a], y, &self.poses[1][b], mesh).is_some()
        })
    }
}
