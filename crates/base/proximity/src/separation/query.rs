//! The distance query: its entry points, and the choice of the method for each pair of shapes.

use elbowroom_spatial::Pose;

use super::capsule::capsule;
use super::convex::rounded_convex;
use super::core::rounded;
use super::gap::rounding;
use super::goal::Goal;
use super::pair_order::comes_first;
use super::result::Separation;
use super::settings::DistanceSettings;
use super::sphere::sphere;
use super::{half_space, mesh_convex};
use crate::mesh_mesh::{
    EXPECT_FAR, EXPECT_NEAR, FirstBound, QueryStats, WarmStart, Workspace, distance_upper_bound, features_within,
    mesh_separation_with, with_thread_workspace,
};
use crate::shape::is_usable_pose;
use crate::{Shape, TriMesh};

/// Distance between two shapes, with witness points.
///
/// A NaN or an infinity in a pose or a dimension gives distance 0: unknown does not count as free.
///
/// ```
/// use elbowroom_proximity::{Cuboid, Shape, Sphere, separation};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.5, 0.5, 0.1) });
/// let s = separation(&ball, &Pose::from_translation(Vec3::new(0.2, 0.0, 0.5)), &table, &Pose::IDENTITY);
/// assert!((s.distance - 0.3).abs() < 1e-15 && s.lower_bound <= s.distance);
/// assert!((s.on_b - Vec3::new(0.2, 0.0, 0.1)).length() < 1e-15);
/// ```
pub fn separation(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Separation {
    // Without a limit the answer is always `Some`.
    separation_within(a, a_in_world, b, b_in_world, f64::INFINITY)
        .unwrap_or_else(|| Separation::unknown(a_in_world, b_in_world))
}

/// Like [`separation`], or `None` if the shapes are guaranteed to be farther apart than `limit` metres. Much faster
/// for far pairs of boxes, cylinders, hulls and meshes.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, separation_within};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (ball, far) = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::X * 3.0));
/// assert!(separation_within(&ball, &Pose::IDENTITY, &ball, &far, 1.0).is_none());
/// assert!(separation_within(&ball, &Pose::IDENTITY, &ball, &far, 2.9).is_some());
/// ```
pub fn separation_within(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, limit: f64) -> Option<Separation> {
    dispatch_meshes(a, a_in_world, b, b_in_world, limit, Goal::CONTINUOUS, MeshOptions::DEFAULT)
}

/// True if the shapes touch or overlap, or are too close for f64 to separate.
///
/// It is true exactly if the distance of [`separation`] is 0, in either order of the shapes.
///
/// ```
/// use elbowroom_proximity::{Cuboid, HalfSpace, Shape, collides};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (floor, gun) = (Shape::HalfSpace(HalfSpace), Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) }));
/// assert!(collides(&gun, &Pose::from_translation(Vec3::Z * 0.1), &floor, &Pose::IDENTITY));
/// assert!(!collides(&gun, &Pose::from_translation(Vec3::Z * 0.11), &floor, &Pose::IDENTITY));
/// ```
pub fn collides(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    within(a, a_in_world, b, b_in_world, 0.0)
}

/// True if the shapes are not proven to be farther apart than `tolerance` metres.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, within};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (ball, there) = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::X));
/// assert!(within(&ball, &Pose::IDENTITY, &ball, &there, 0.81));
/// assert!(!within(&ball, &Pose::IDENTITY, &ball, &there, 0.79));
/// ```
pub fn within(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, tolerance: f64) -> bool {
    dispatch_meshes(a, a_in_world, b, b_in_world, tolerance, Goal::WithinLimit, MeshOptions::DEFAULT).is_some()
}

/// The distance query with reused memory and all settings.
impl Workspace {
    /// Distance and witness points, or `None` if the shapes are guaranteed to be farther apart than the limit.
    ///
    /// ```
    /// use elbowroom_proximity::{DistanceSettings, Shape, TriMesh, WarmStart, Workspace};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let shape = Shape::Mesh(mesh.into());
    /// let (mut workspace, mut warm_start) = (Workspace::new(), WarmStart::default());
    /// for tick in 0..3 {
    ///     let there = Pose::from_translation(Vec3::X * (1.5 + 0.1 * f64::from(tick)));
    ///     let settings = DistanceSettings { limit: 0.65, warm_start: Some(&mut warm_start), ..Default::default() };
    ///     let near = workspace.separation(&shape, &Pose::IDENTITY, &shape, &there, settings);
    ///     assert_eq!(near.is_some(), tick < 2);
    /// }
    /// # Ok::<(), elbowroom_proximity::MeshError>(())
    /// ```
    pub fn separation(
        &mut self,
        a: &Shape,
        a_in_world: &Pose,
        b: &Shape,
        b_in_world: &Pose,
        settings: DistanceSettings,
    ) -> Option<Separation> {
        let DistanceSettings { limit, witness_points, warm_start } = settings;
        let options = MeshOptions { workspace: Some(self), warm_start, ..MeshOptions::DEFAULT };
        dispatch_meshes(a, a_in_world, b, b_in_world, limit, Goal::Separation(witness_points), options)
    }

    /// Like [`collides`](crate::collides()), with reused memory.
    pub fn collides(&mut self, a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
        self.within(a, a_in_world, b, b_in_world, 0.0)
    }

    /// Like [`within`](crate::within()), with reused memory. Fastest if most pairs are farther apart than the tolerance,
    /// as after a broad phase.
    pub fn within(&mut self, a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, tolerance: f64) -> bool {
        let options = MeshOptions { workspace: Some(self), first_bound: EXPECT_FAR, ..MeshOptions::DEFAULT };
        dispatch_meshes(a, a_in_world, b, b_in_world, tolerance, Goal::WithinLimit, options).is_some()
    }

    /// An upper bound of the distance of two shapes, metres, at a small fraction of the cost of the distance: of two meshes
    /// as [`distance_upper_bound`](crate::advanced::distance_upper_bound), of a mesh and another bounded shape that of one
    /// triangle. `None` for other pairs, or if a pose is not finite. `warm_start` as in [`DistanceSettings`].
    pub fn distance_upper_bound(
        &mut self,
        a: &Shape,
        a_in_world: &Pose,
        b: &Shape,
        b_in_world: &Pose,
        warm_start: &mut WarmStart,
    ) -> Option<f64> {
        let bound = match (a, b) {
            (Shape::Mesh(a), Shape::Mesh(b)) => distance_upper_bound(a, a_in_world, b, b_in_world, warm_start, self),
            _ if !(a.is_usable(a_in_world) && b.is_usable(b_in_world)) => return None,
            (Shape::Mesh(mesh), solid) => upper_bound_beside(mesh, solid, &a_in_world.inverse_mul(b_in_world))?,
            (solid, Shape::Mesh(mesh)) => upper_bound_beside(mesh, solid, &b_in_world.inverse_mul(a_in_world))?,
            _ => return None,
        };
        (bound < f64::INFINITY).then_some(bound)
    }
}

/// An upper bound of the distance of a mesh and a bounded convex shape in its frame.
fn upper_bound_beside(mesh: &TriMesh, solid: &Shape, in_mesh: &Pose) -> Option<f64> {
    let (core, radius) = rounded(solid)?;
    let gap = mesh_convex::mesh_core_upper_bound(mesh, &core, in_mesh);
    Some((gap - radius).max(0.0) + rounding(radius))
}

/// Options that only queries on two meshes use.
struct MeshOptions<'w> {
    /// Workspace; the thread's own workspace if `None`.
    workspace: Option<&'w mut Workspace>,
    warm_start: Option<&'w mut WarmStart>,
    /// First upper bound of tolerance queries.
    first_bound: FirstBound,
}

impl MeshOptions<'_> {
    const DEFAULT: Self = Self { workspace: None, warm_start: None, first_bound: EXPECT_NEAR };
}

/// Entry point of every query over a pair of shapes: two meshes, or any other pair.
#[inline]
fn dispatch_meshes(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
    options: MeshOptions,
) -> Option<Separation> {
    match (a, b) {
        (Shape::Mesh(m), Shape::Mesh(n)) => mesh_mesh(m, a_in_world, n, b_in_world, limit, goal, options),
        (Shape::Mesh(_), _) | (_, Shape::Mesh(_)) => {
            let mut stats = QueryStats::default();
            let found = validated(a, a_in_world, b, b_in_world, limit, goal, &mut stats);
            if let Some(workspace) = options.workspace {
                workspace.set_stats(stats);
            }
            found
        }
        _ => validated(a, a_in_world, b, b_in_world, limit, goal, &mut QueryStats::default()),
    }
}

/// All pairs except two meshes: checks the input, orders the pair, selects its method, and applies the limit.
fn validated(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
    stats: &mut QueryStats,
) -> Option<Separation> {
    if !(a.is_usable(a_in_world) && b.is_usable(b_in_world)) {
        return Some(Separation::unknown(a_in_world, b_in_world));
    }
    let found = if comes_first(a, a_in_world, b, b_in_world) {
        by_first_shape(a, a_in_world, b, b_in_world, limit, goal, stats)?
    } else {
        by_first_shape(b, b_in_world, a, a_in_world, limit, goal, stats)?.swapped()
    };
    // Products of large numbers may have overflowed.
    let (p, q) = (found.on_a, found.on_b);
    if !(found.distance + (p.x + p.y + p.z) + (q.x + q.y + q.z)).is_finite() {
        return Some(Separation::unknown(a_in_world, b_in_world));
    }
    (!(found.lower_bound > limit)).then_some(found)
}

/// Query on two meshes. A negative limit counts as 0.
#[inline(never)]
fn mesh_mesh(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
    options: MeshOptions,
) -> Option<Separation> {
    let MeshOptions { workspace, warm_start, first_bound } = options;
    let run = |workspace: &mut Workspace| match goal {
        Goal::Separation(_) if !(is_usable_pose(a_in_world) && is_usable_pose(b_in_world)) => {
            workspace.set_stats(QueryStats::default());
            Some(Separation::unknown(a_in_world, b_in_world))
        }
        Goal::Separation(witness_points) => {
            let settings = DistanceSettings { limit, witness_points, warm_start };
            mesh_separation_with(a, a_in_world, b, b_in_world, settings, workspace)
        }
        Goal::WithinLimit => features_within(a, a_in_world, b, b_in_world, limit, first_bound, workspace)
            .map(|_| Separation::unknown(a_in_world, b_in_world)),
    };
    match workspace {
        Some(workspace) => run(workspace),
        None => with_thread_workspace(run),
    }
}

/// Applies the method for a pair of shapes in the order of [`comes_first`]. The gaps are in the frame of the second
/// shape.
#[inline]
fn by_first_shape(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
    stats: &mut QueryStats,
) -> Option<Separation> {
    match a {
        Shape::Sphere(s) => sphere(*s, a_in_world, b, b_in_world, limit, stats),
        _ => all_but_spheres(a, a_in_world, b, b_in_world, limit, goal, stats),
    }
}

/// All shapes except spheres. It is a separate function, because its register pressure would slow down the few
/// instructions for spheres.
#[inline(never)]
fn all_but_spheres(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
    stats: &mut QueryStats,
) -> Option<Separation> {
    match (a, b) {
        (Shape::Capsule(c), Shape::Capsule(_) | Shape::Cylinder(_) | Shape::Cuboid(_)) => {
            capsule(c, a_in_world, b, b_in_world, limit, goal)
        }
        (Shape::HalfSpace(_), _) => {
            let gap = half_space::half_space_half_space(&b_in_world.inverse_mul(a_in_world));
            Some(gap.separation([0.0; 2], b_in_world))
        }
        (Shape::Capsule(_) | Shape::Cylinder(_) | Shape::Cuboid(_) | Shape::Hull(_), Shape::HalfSpace(_)) => {
            let (core, radius) = rounded(a)?;
            let gap = half_space::core_half_space(&core, &b_in_world.inverse_mul(a_in_world));
            Some(gap.separation([radius, 0.0], b_in_world))
        }
        (Shape::Mesh(m), Shape::HalfSpace(_)) => {
            let gap = mesh_convex::mesh_half_space(m, &b_in_world.inverse_mul(a_in_world), stats);
            Some(gap.separation([0.0; 2], b_in_world))
        }
        (_, Shape::Mesh(m)) => {
            let (core, radius) = rounded(a)?;
            let core_in_mesh = b_in_world.inverse_mul(a_in_world);
            let gap = mesh_convex::mesh_core(m, &core, &core_in_mesh, limit, radius, goal, stats)?;
            Some(gap.separation([0.0, radius], b_in_world).swapped())
        }
        _ => {
            let (gap, radii) = rounded_convex(a, b, &b_in_world.inverse_mul(a_in_world), limit, goal)?;
            Some(gap.separation(radii, b_in_world))
        }
    }
}
