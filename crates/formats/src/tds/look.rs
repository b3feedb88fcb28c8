//! Which way cameras and spotlights look.

use std::collections::HashMap;

use elbowroom_spatial::{Rotation, Vec3};

use super::keyframer::{FileNode, Kind};

/// The targets of a file, by their name and by who carries them: a file may have tens of thousands.
pub(super) struct Targets<'a> {
    nodes: &'a [FileNode],
    parents: &'a [Option<usize>],
    /// Of targets of one name and parent the first in the file.
    first: HashMap<(&'a str, Option<usize>), usize>,
}

impl<'a> Targets<'a> {
    pub(super) fn new(nodes: &'a [FileNode], parents: &'a [Option<usize>]) -> Self {
        let mut first = HashMap::new();
        for (i, node) in nodes.iter().enumerate().filter(|(_, n)| n.kind == Kind::Target) {
            first.entry((node.name.as_str(), parents[i])).or_insert(i);
        }
        Self { nodes, parents, first }
    }

    /// A camera looks at its target along -z, its x level; then it rolls. The file has degrees.
    pub(super) fn looking(&self, camera: usize) -> Rotation {
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
