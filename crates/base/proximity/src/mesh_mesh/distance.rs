//! Distance and tolerance queries of two meshes.

use elbowroom_spatial::{Pose, Vec3};

use super::collision::colliding_triangles;
use super::containment::contained_point;
use super::continuous_witness::{continuous_witness, has_parallel_features, tolerances};
use super::mesh_features::MeshFeatures;
use super::mesh_pair::MeshPair;
use super::nearest_pair::NearestPair;
use super::nearest_pair_search::{FirstBound, SearchSettings, nearest_pair, upper_bound_pair};
use super::relative_placement::{RelativePlacement, spheres_farther_than};
use super::warm_start::WarmStart;
use super::workspace::Workspace;
use crate::TriMesh;
use crate::separation::{DistanceSettings, Separation, WitnessPoints};

/// Widths of the beam search over landmarks that finds the first upper bound: for a distance, a tolerance query, and
/// [`distance_upper_bound`].
const DISTANCE_WIDTH: usize = 4;
const TOLERANCE_WIDTH: usize = 2;
const UPPER_BOUND_WIDTH: usize = 2;

/// First upper bound of the tolerance query if near pairs are expected.
pub(crate) const EXPECT_NEAR: FirstBound = FirstBound::Landmarks { width: TOLERANCE_WIDTH };
/// First upper bound of the tolerance query if pairs beyond the tolerance are expected.
pub(crate) const EXPECT_FAR: FirstBound = FirstBound::FirstLeaves;

/// The [`separation`](crate::separation()) of two meshes.
///
/// ```
/// use elbowroom_proximity::{TriMesh, Workspace, advanced::mesh_separation};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// let there = Pose::from_translation(Vec3::X * 1.5);
/// let near = mesh_separation(&mesh, &Pose::IDENTITY, &mesh, &there, &mut Workspace::new());
/// assert!((near.distance - 0.5).abs() < 1e-12 && near.lower_bound <= near.distance);
/// assert!((near.on_a - Vec3::X).length() < 1e-12);
/// ```
pub fn mesh_separation(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
) -> Separation {
    let found = mesh_separation_with(a, a_in_world, b, b_in_world, DistanceSettings::default(), workspace);
    found.unwrap_or_else(|| Separation::unknown(a_in_world, b_in_world))
}

/// Like [`mesh_separation`], with settings; `None` if the meshes are guaranteed to be farther apart than the limit.
///
/// Afterwards, [`Workspace::closest_features`] returns the nearest triangles and [`Workspace::stats`] the work done.
pub fn mesh_separation_with(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    settings: DistanceSettings,
    workspace: &mut Workspace,
) -> Option<Separation> {
    let DistanceSettings { limit, witness_points, warm_start } = settings;
    let mut cold_start = WarmStart::default();
    let warm_start = warm_start.unwrap_or(&mut cold_start);
    workspace.begin_query();
    if spheres_farther_than(&a.bvh, a_in_world, &b.bvh, b_in_world, limit) {
        return None;
    }
    let placement = RelativePlacement::new(&a.bvh, a_in_world, &b.bvh, b_in_world);
    if !placement.is_usable() {
        *warm_start = WarmStart::default();
        return Some(unknown(a_in_world, b_in_world, workspace));
    }
    let meshes = MeshPair { a, b, placement: &placement, simd_level: workspace.simd_level() };
    let unit = a.bvh.frame.unit;
    let radius = limit.max(0.0) / unit + placement.f64_error;
    // With a limit, most meshes are beyond it, and the traversal shows that soonest.
    let first_bound = if radius < f64::INFINITY { EXPECT_FAR } else { FirstBound::Landmarks { width: DISTANCE_WIDTH } };
    let continuous = witness_points == WitnessPoints::Continuous;
    let tolerances = tolerances(a, b);
    let settings = SearchSettings {
        radius,
        sufficient: placement.f64_error,
        tie_tolerance: if continuous { tolerances.tie } else { 0.0 },
        warm_start: *warm_start,
        first_bound,
    };
    let found = nearest_pair(&meshes, &settings, workspace);
    if workspace.stack.overflowed() {
        *warm_start = WarmStart::default();
        return Some(unknown(a_in_world, b_in_world, workspace));
    }
    let touching = found.is_some_and(|f| f.distance <= placement.f64_error);
    if !touching && let Some(p) = contained_point(a, a_in_world, b, b_in_world) {
        *warm_start = found.map_or(WarmStart::default(), |f| f.warm_start);
        workspace.closest_features = Some(MeshFeatures::Containment);
        return Some(Separation { distance: 0.0, lower_bound: 0.0, on_a: p, on_b: p });
    }
    let mut found = found?;
    let ambiguous = || found.spread > tolerances.min_size || has_parallel_features(&meshes, &found, tolerances);
    if continuous
        && !touching
        && ambiguous()
        && let Some((points, triangles)) = continuous_witness(&meshes, &found, tolerances, workspace)
    {
        found = NearestPair { points, triangles, ..found };
    }
    *warm_start = found.warm_start;
    workspace.closest_features = Some(MeshFeatures::Triangles(found.triangles.0, found.triangles.1));
    Some(in_world(&found, touching, a, a_in_world, placement.f64_error))
}

/// The separation in metres, with points in the world, from the nearest pair in the frame and units of A.
fn in_world(found: &NearestPair, touching: bool, a: &TriMesh, a_in_world: &Pose, error: f64) -> Separation {
    let unit = a.bvh.frame.unit;
    let to_world = |p: Vec3| a_in_world.transform_point(p * unit + a.bvh.frame.center);
    let distance = if touching { 0.0 } else { found.distance * unit };
    Separation {
        distance,
        lower_bound: (distance - error * unit).max(0.0),
        on_a: to_world(found.points.on_a),
        on_b: to_world(found.points.on_b),
    }
}

/// An upper bound of the distance of two meshes, metres: the distance of a pair of triangles that is likely near.
/// Infinite if a pose is not finite.
///
/// It is often the distance itself, at a small fraction of its cost; with the warm start of a recent query it costs
/// a single pair of triangles. `warm_start` is set to the pair that was found. For several pairs of meshes, the
/// smallest upper bound is a limit for all of them.
///
/// ```
/// use elbowroom_proximity::advanced::{distance_upper_bound, mesh_separation_with};
/// use elbowroom_proximity::{DistanceSettings, TriMesh, WarmStart, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// let (mut workspace, mut warm_start) = (Workspace::new(), WarmStart::default());
/// let limit = distance_upper_bound(&mesh, &here, &mesh, &there, &mut warm_start, &mut workspace);
/// let settings = DistanceSettings { limit, warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
/// let near = mesh_separation_with(&mesh, &here, &mesh, &there, settings, &mut workspace).expect("it is no farther");
/// assert!(near.distance <= limit);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn distance_upper_bound(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    warm_start: &mut WarmStart,
    workspace: &mut Workspace,
) -> f64 {
    workspace.begin_query();
    let placement = RelativePlacement::new(&a.bvh, a_in_world, &b.bvh, b_in_world);
    if !placement.is_usable() {
        return f64::INFINITY;
    }
    let meshes = MeshPair { a, b, placement: &placement, simd_level: workspace.simd_level() };
    let settings = SearchSettings {
        radius: f64::INFINITY,
        sufficient: placement.f64_error,
        tie_tolerance: 0.0,
        warm_start: *warm_start,
        first_bound: FirstBound::Landmarks { width: UPPER_BOUND_WIDTH },
    };
    let Some(found) = upper_bound_pair(&meshes, &settings, workspace) else { return f64::INFINITY };
    *warm_start = found.warm_start;
    (found.distance + placement.f64_error) * a.bvh.frame.unit
}

/// A pair of triangles no farther apart than `tolerance` metres, or `None` if the meshes are guaranteed to be
/// farther apart.
///
/// A NaN or negative tolerance counts as 0; a mesh inside a closed mesh is near. If several pairs are near, the
/// choice is unspecified. The query starts where the surfaces are likely nearest; if most meshes are beyond the
/// tolerance, [`is_farther_than`] is faster.
///
/// ```
/// use elbowroom_proximity::{TriMesh, Workspace, advanced::triangles_within};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// assert!(triangles_within(&mesh, &here, &mesh, &there, 0.51, &mut Workspace::new()).is_some());
/// assert!(triangles_within(&mesh, &here, &mesh, &there, 0.49, &mut Workspace::new()).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn triangles_within(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    workspace: &mut Workspace,
) -> Option<MeshFeatures> {
    features_within(a, a_in_world, b, b_in_world, tolerance, EXPECT_NEAR, workspace)
}

/// True if two meshes are guaranteed to be farther apart than `tolerance` metres. It is the negation of
/// [`triangles_within`], and faster if true is the usual answer.
///
/// ```
/// use elbowroom_proximity::{TriMesh, Workspace, advanced::is_farther_than};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// assert!(is_farther_than(&mesh, &here, &mesh, &there, 0.49, &mut Workspace::new()));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn is_farther_than(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    workspace: &mut Workspace,
) -> bool {
    features_within(a, a_in_world, b, b_in_world, tolerance, EXPECT_FAR, workspace).is_none()
}

/// Like [`triangles_within`], with a choice of the first upper bound.
pub(crate) fn features_within(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    first_bound: FirstBound,
    workspace: &mut Workspace,
) -> Option<MeshFeatures> {
    if !(tolerance > 0.0) {
        return colliding_triangles(a, a_in_world, b, b_in_world, workspace);
    }
    workspace.begin_query();
    if spheres_farther_than(&a.bvh, a_in_world, &b.bvh, b_in_world, tolerance) {
        return None;
    }
    let placement = RelativePlacement::new(&a.bvh, a_in_world, &b.bvh, b_in_world);
    if !placement.is_usable() {
        return Some(MeshFeatures::Unknown);
    }
    let meshes = MeshPair { a, b, placement: &placement, simd_level: workspace.simd_level() };
    let radius = tolerance / a.bvh.frame.unit + placement.f64_error;
    let warm_start = WarmStart::default();
    let settings = SearchSettings { radius, sufficient: radius, tie_tolerance: 0.0, warm_start, first_bound };
    match nearest_pair(&meshes, &settings, workspace) {
        Some(found) => Some(MeshFeatures::Triangles(found.triangles.0, found.triangles.1)),
        None if workspace.stack.overflowed() => Some(MeshFeatures::Unknown),
        None => contained_point(a, a_in_world, b, b_in_world).map(|_| MeshFeatures::Containment),
    }
}

fn unknown(a_in_world: &Pose, b_in_world: &Pose, workspace: &mut Workspace) -> Separation {
    workspace.closest_features = Some(MeshFeatures::Unknown);
    Separation::unknown(a_in_world, b_in_world)
}
