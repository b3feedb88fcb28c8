//! The geometry of robots and objects at one instant.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{Shape, collides, penetration, separation_within};
use elbowroom_robot::{GeometryId, Robot};
use elbowroom_spatial::{Aabb, Pose};

use crate::Object;

/// Above this distance (m) a lower bound on the distance is sufficient.
const NEAR: f64 = 0.05;

/// All geometry at one instant.
#[derive(Clone, Copy)]
pub(super) struct PlacedGeometry<'w, 'a> {
    pub robots: &'w [(&'a Robot, Pose)],
    pub objects: &'a [Object],
    pub boxes: &'w [Vec<Vec<Aabb>>],
    pub placed: &'w [(Pose, Aabb)],
    pub states: &'w [&'w ChainState],
}

impl<'a> PlacedGeometry<'_, 'a> {
    fn shape_count(&self, id: GeometryId) -> usize {
        match id {
            GeometryId::Link { robot, link } => self.robots[robot.0].0.colliders[link.0].len(),
            GeometryId::Object(_) => 1,
        }
    }

    pub fn shape(&self, id: GeometryId, i: usize) -> (&'a Shape, Pose, Aabb) {
        match id {
            GeometryId::Object(o) => (&self.objects[o.0].shape, self.placed[o.0].0, self.placed[o.0].1),
            GeometryId::Link { robot, link } => {
                let (model, base) = &self.robots[robot.0];
                let collider = &model.colliders[link.0][i];
                let pose = *base * self.states[robot.0].link_in_root(link) * collider.in_link;
                (&collider.shape, pose, self.boxes[robot.0][link.0][i].transformed(&pose))
            }
        }
    }

    /// The largest penetration depth of two geometries in contact, m. For meshes: the depth of their hulls.
    pub fn depth(&self, a: GeometryId, b: GeometryId) -> f64 {
        let solids = |id| (0..self.shape_count(id)).map(move |i| (id, i));
        let pairs = solids(a).flat_map(|a| solids(b).map(move |b| (a, b)));
        let depth = |((a, i), (b, k))| {
            let ((a, pose_a, _), (b, pose_b, _)): ((&Shape, Pose, _), (&Shape, Pose, _)) =
                (self.shape(a, i), self.shape(b, k));
            penetration(a, &pose_a, b, &pose_b).map_or(0.0, |p| p.depth)
        };
        pairs.map(depth).fold(0.0, f64::max)
    }

    /// Proven lower bound on the distance, m; `None` on contact.
    pub fn gap(&self, a: GeometryId, b: GeometryId) -> Option<f64> {
        let mut least = f64::INFINITY;
        for i in 0..self.shape_count(a) {
            let (shape_a, pose_a, box_a) = self.shape(a, i);
            for k in 0..self.shape_count(b) {
                let (shape_b, pose_b, box_b) = self.shape(b, k);
                let apart = box_a.distance(&box_b);
                if apart > NEAR {
                    least = least.min(apart);
                    continue;
                }
                let bound = match separation_within(shape_a, &pose_a, shape_b, &pose_b, NEAR) {
                    None => NEAR,
                    Some(s) => s.lower_bound,
                };
                if bound <= 0.0 && collides(shape_a, &pose_a, shape_b, &pose_b) {
                    return None;
                }
                least = least.min(bound);
            }
        }
        Some(least)
    }
}
