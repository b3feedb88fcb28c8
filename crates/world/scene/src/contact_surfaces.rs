//! All triangles of two links or objects that touch.

use std::collections::HashMap;
use std::sync::Arc;

use elbowroom_proximity::contact::{ContactSettings, contact_point, for_each_triangle_contact, triangle_surface};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_robot::GeometryId;
use elbowroom_spatial::Vec3;

use crate::{Scene, SceneState};

/// Largest distance of the triangles of spheres, capsules and cylinders from the surface, m.
const CHORD_ERROR_M: f64 = 1e-4;

/// Two triangles that touch, or two colliders that are in contact without touching triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceContact {
    /// Indices of the colliders of the first and the second geometry; 0 for an object.
    pub colliders: [usize; 2],
    /// Indices of the touching triangles of the two colliders.
    ///
    /// `None` if one collider is inside the other, if a round shape is touched outside the triangles inscribed in it, and
    /// for half-spaces.
    pub triangles: Option<[u32; 2]>,
    /// Ends of the segment in which the triangles cross, in the world, m.
    ///
    /// If the triangles only touch, and without triangles: one point of each geometry.
    pub points: [Vec3; 2],
}

/// The surfaces of a scene as triangles.
///
/// Meshes, hulls and boxes have their own triangles (two per face of a box). Spheres, capsules and cylinders have
/// inscribed triangles, at most 0.1 mm from the surface (with at most 256 segments around).
///
/// ```
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{Checker, CheckerOptions, ContactSurfaces, SceneState, example};
/// let scene = example::two_arms();
/// let mut state = SceneState::new(&scene);
/// state.set_q(&scene, RobotId(0), &[0.0, 1.57, 0.0])?;
/// let mut pairs = Vec::new();
/// Checker::new(&scene, CheckerOptions::default()).contacts(&state, |pair| pairs.push(pair));
/// let (mut surfaces, mut contacts) = (ContactSurfaces::new(&scene), 0);
/// for pair in pairs {
///     surfaces.contacts(&state, pair.a, pair.b, |contact| contacts += usize::from(contact.triangles.is_some()));
/// }
/// assert!(contacts > 0);
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct ContactSurfaces<'s> {
    scene: &'s Scene,
    /// Colliders per link or object queried so far; `None` for a collider without triangles.
    meshes: HashMap<GeometryId, Vec<Option<Arc<TriMesh>>>>,
    workspace: Workspace,
}

impl<'s> ContactSurfaces<'s> {
    /// Prepares the shapes of a scene as they are checked, without margins.
    pub fn new(scene: &'s Scene) -> Self {
        Self { scene, meshes: HashMap::new(), workspace: Workspace::new() }
    }

    /// Calls `found` for each pair of touching triangles of two links or objects, ordered by collider and triangle.
    ///
    /// Colliders that are in contact without touching triangles are reported once, without triangles. Does nothing if the
    /// two geometries are apart.
    pub fn contacts(
        &mut self,
        state: &SceneState,
        a: GeometryId,
        b: GeometryId,
        mut found: impl FnMut(SurfaceContact),
    ) {
        let scene = self.scene;
        let (Some(a_in_world), Some(b_in_world)) = (state.pose(scene, a), state.pose(scene, b)) else { return };
        self.prepare(a);
        self.prepare(b);
        for (i, (x, x_in_a)) in scene.shapes(a).enumerate() {
            let x_in_world = a_in_world * x_in_a;
            for (k, (y, y_in_b)) in scene.shapes(b).enumerate() {
                let y_in_world = b_in_world * y_in_b;
                if !self.workspace.collides(x, &x_in_world, y, &y_in_world) {
                    continue;
                }
                let mut contacts = Vec::new();
                if let (Some(m), Some(n)) = (&self.meshes[&a][i], &self.meshes[&b][k]) {
                    for_each_triangle_contact(m, &x_in_world, n, &y_in_world, &mut self.workspace, |c| {
                        contacts.push(c);
                    });
                }
                contacts.sort_by_key(|c| (c.triangle_a, c.triangle_b));
                if contacts.is_empty() {
                    let settings = ContactSettings::default();
                    let point = contact_point(x, &x_in_world, y, &y_in_world, settings, &mut self.workspace);
                    let points = point.map_or([x_in_world, y_in_world].map(|p| p.translation), |c| [c.on_a, c.on_b]);
                    found(SurfaceContact { colliders: [i, k], triangles: None, points });
                }
                for c in contacts {
                    let triangles = Some([c.triangle_a, c.triangle_b]);
                    found(SurfaceContact { colliders: [i, k], triangles, points: c.segment });
                }
            }
        }
    }

    fn prepare(&mut self, id: GeometryId) {
        let scene = self.scene;
        let surfaces = || scene.shapes(id).map(|(shape, _)| triangle_surface(shape, CHORD_ERROR_M)).collect();
        self.meshes.entry(id).or_insert_with(surfaces);
    }
}
