//! A model as a tree of frames with meshes and animations: the common representation of 3DS, glTF and VRML.

use std::path::Path;

use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use crate::Diagnostic;
use crate::affine::Affine;
use crate::mesh_data::{LoadedMeshes, MeshData};

/// A tree of frames with meshes, parents before their children.
///
/// ```
/// use elbowroom_formats::nodetree::{Node, NodeTree};
/// use elbowroom_spatial::{Pose, Vec3};
/// let mut tree = NodeTree::new("arm");
/// let base = tree.push(Node::new("base", None, Pose::from_xyz_rpy([0.0, 0.0, 0.5], [0.0; 3])));
/// tree.push(Node::new("link_1", Some(base), Pose::from_xyz_rpy([0.1, 0.0, 0.2], [0.0; 3])));
/// assert_eq!(tree.in_world()[1].translation, Vec3::new(0.1, 0.0, 0.7));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NodeTree {
    /// Name of the model, or the file's stem.
    pub name: String,
    /// Nodes, parents before their children.
    pub nodes: Vec<Node>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
}

/// A frame of a [`NodeTree`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Node {
    /// Name in the file; may repeat.
    pub name: String,
    /// Index of the parent; `None` for a top node.
    pub parent: Option<usize>,
    /// Rest frame in the frame of the parent, or in the world for a top node (m). In a 3DS file the origin is the pivot.
    pub in_parent: Pose,
    /// Meshes in the node's frame (m), with the scale of the file applied.
    pub meshes: Vec<MeshData>,
    /// Animation, in order of time; empty if the node does not move. In a 3DS file the first key is the rest frame.
    pub track: Vec<Keyframe>,
}

/// The frame of a node at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// Time, seconds.
    pub time_s: f64,
    /// The node's frame in the frame of its parent.
    pub in_parent: Pose,
}

impl Node {
    /// Creates a node without meshes and without animation.
    pub fn new(name: impl Into<String>, parent: Option<usize>, in_parent: Pose) -> Self {
        Self { name: name.into(), parent, in_parent, ..Self::default() }
    }

    /// Creates a node without animation from its place in the scene, and returns its rigid frame in the scene too.
    ///
    /// Scale, shear and mirror of `to_scene` are applied to the mesh. `parent_in_scene` is the rigid frame of the parent.
    pub(crate) fn placed(
        name: String,
        parent: Option<usize>,
        parent_in_scene: &Pose,
        to_scene: &Affine,
        mesh: Option<MeshData>,
    ) -> (Self, Pose) {
        let frame = rigid(to_scene);
        let mut node = Self::new(name, parent, parent_in_scene.inverse_mul(&frame));
        if let Some(mut mesh) = mesh {
            Affine::from(&frame.inverse()).after(to_scene).apply(&mut mesh);
            node.meshes.push(mesh);
        }
        (node, frame)
    }
}

impl NodeTree {
    /// Creates a tree without nodes.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a node and returns its index.
    pub fn push(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// The rest frame of every node in the world. A parent that is not before its child counts as the world.
    pub fn in_world(&self) -> Vec<Pose> {
        let mut all: Vec<Pose> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let parent = node.parent.and_then(|p| all.get(p)).copied().unwrap_or(Pose::IDENTITY);
            all.push(parent * node.in_parent);
        }
        all
    }

    /// Indices of the children of a node; for `None`, of the top nodes.
    pub fn children(&self, of: Option<usize>) -> impl Iterator<Item = usize> + '_ {
        self.nodes.iter().enumerate().filter(move |(_, n)| n.parent == of).map(|(i, _)| i)
    }

    /// Index of the first node with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.nodes.iter().position(|n| n.name == name)
    }

    /// Multiplies all lengths by a factor.
    pub fn scale(&mut self, factor: f64) {
        for node in &mut self.nodes {
            node.in_parent.translation = node.in_parent.translation * factor;
            node.track.iter_mut().for_each(|k| k.in_parent.translation = k.in_parent.translation * factor);
            node.meshes.iter_mut().flat_map(|m| &mut m.vertices).for_each(|v| *v = *v * factor);
        }
    }

    /// The bounding box of all meshes at rest, in the world.
    pub fn aabb(&self) -> Aabb {
        let frames = self.in_world();
        let points = self
            .nodes
            .iter()
            .zip(&frames)
            .flat_map(|(n, frame)| n.meshes.iter().flat_map(|m| &m.vertices).map(|v| frame.transform_point(*v)));
        Aabb::from_points(points)
    }

    /// All meshes at rest, in the world.
    pub(crate) fn flatten(self) -> LoadedMeshes {
        let frames = self.in_world();
        let mut meshes = Vec::new();
        for (node, frame) in self.nodes.into_iter().zip(frames) {
            for mut mesh in node.meshes {
                mesh.vertices.iter_mut().for_each(|v| *v = frame.transform_point(*v));
                meshes.push(mesh);
            }
        }
        LoadedMeshes { meshes, warnings: self.warnings }
    }

    /// Refuses frames and vertices that a scale has made infinite.
    pub(crate) fn check_finite(&self, file: &Path) -> Result<(), Diagnostic> {
        let frames = self.in_world();
        for (node, frame) in self.nodes.iter().zip(&frames) {
            let moves = node.track.iter().all(|k| k.in_parent.is_finite() && k.time_s.is_finite());
            let corners = node.meshes.iter().flat_map(|m| &m.vertices).all(|v| v.is_finite());
            if !(frame.is_finite() && moves && corners) {
                let what = format!("the node `{}` is infinitely large or far away", node.name);
                return Err(Diagnostic::new(file, None, what).hint("finite numbers; export the model again"));
            }
        }
        Ok(())
    }
}

/// The rigid part of an affine transform: its origin, and its axes made orthonormal, x first.
///
/// Scale, shear and mirror are applied to the meshes instead.
pub(crate) fn rigid(map: &Affine) -> Pose {
    let column = |c: usize| Vec3::new(map.0[0][c], map.0[1][c], map.0[2][c]);
    let x = if map.is_mirror() { -column(0) } else { column(0) };
    Pose::new(Rotation::from_x_and_xy(x, column(1)).unwrap_or(Rotation::IDENTITY), column(3))
}

/// The value at a time, interpolated between the neighbouring keys; `None` without keys. Keys must be in order of time.
pub(crate) fn sample<T: Copy>(keys: &[(f64, T)], time: f64, interpolate: impl Fn(T, T, f64) -> T) -> Option<T> {
    let after = keys.partition_point(|(t, _)| *t < time);
    match (after.checked_sub(1).and_then(|i| keys.get(i)), keys.get(after)) {
        (Some((t0, a)), Some((t1, b))) => Some(interpolate(*a, *b, (time - t0) / (t1 - t0))),
        (Some((_, v)), None) | (None, Some((_, v))) => Some(*v),
        (None, None) => None,
    }
}
