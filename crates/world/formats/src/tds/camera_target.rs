//! Orientation of cameras and spotlights.

use std::collections::HashMap;

use elbowroom_spatial::{Rotation, Vec3};

use super::keyframer::{FileNode, NodeKind};

/// The targets of a file by name and parent. A file may have tens of thousands of them.
pub(super) struct CameraTargets<'a> {
    nodes: &'a [FileNode],
    parents: &'a [Option<usize>],
    /// First target in the file for each name and parent.
    first: HashMap<(&'a str, Option<usize>), usize>,
}

impl<'a> CameraTargets<'a> {
    pub(super) fn new(nodes: &'a [FileNode], parents: &'a [Option<usize>]) -> Self {
        let mut first = HashMap::new();
        for (i, node) in nodes.iter().enumerate().filter(|(_, n)| n.kind == NodeKind::Target) {
            first.entry((node.name.as_str(), parents[i])).or_insert(i);
        }
        Self { nodes, parents, first }
    }

    /// The orientation of a camera: -z points to its target, x is horizontal; then its roll (degrees in the file)
    /// applies.
    pub(super) fn orientation(&self, camera: usize) -> Rotation {
        let node = &self.nodes[camera];
        let target = self.first.get(&(node.name.as_str(), self.parents[camera])).map(|&i| &self.nodes[i]);
        let (Some(eye), Some(target)) = (node.position.first(), target.and_then(|t| t.position.first())) else {
            return Rotation::IDENTITY;
        };
        let Some(back) = (eye.1 - target.1).try_normalize() else { return Rotation::IDENTITY };
        let right = Vec3::Z.cross(back).try_normalize().unwrap_or(Vec3::X);
        let roll = node.roll.first().map_or(0.0, |k| k.1.to_radians());
        let level = Rotation::from_columns(right, back.cross(right), back).unwrap_or(Rotation::IDENTITY);
        level * Rotation::from_axis_angle(Vec3::Z, roll)
    }
}
