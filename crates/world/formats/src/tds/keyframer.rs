//! Nodes of the keyframer.

use std::path::Path;

use elbowroom_spatial::{Rotation, Vec3};

use super::chunk::Chunk;
use super::track::{self, Track};
use crate::Diagnostic;
use crate::warning_list::WarningList;

/// The kind of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// An object, or a dummy.
    Object,
    /// A camera or a spotlight, whose -z axis points to its target.
    Aimed,
    /// The target of a camera or a spotlight.
    Target,
    /// An omnidirectional light.
    Light,
}

/// A node as in the file.
pub(super) struct FileNode {
    pub(super) kind: NodeKind,
    pub(super) name: String,
    /// Instance name, which distinguishes dummies and instances of one object.
    pub(super) instance: Option<String>,
    pub(super) number: Option<u16>,
    pub(super) parent: Option<u16>,
    pub(super) pivot: Vec3,
    pub(super) position: Track<Vec3>,
    pub(super) rotation: Track<Rotation>,
    pub(super) scale: Track<Vec3>,
    pub(super) roll: Track<f64>,
}

impl FileNode {
    pub(super) fn has_track(&self) -> bool {
        !(self.position.is_empty() && self.rotation.is_empty() && self.scale.is_empty())
    }

    /// Name of the node in the tree.
    pub(super) fn display_name(&self) -> String {
        match &self.instance {
            Some(instance) if self.name.starts_with("$$$") => instance.clone(),
            Some(instance) => format!("{}.{instance}", self.name),
            None if self.kind == NodeKind::Target => format!("{}.target", self.name),
            None => self.name.clone(),
        }
    }
}

/// Reads a node; `None` for other chunks.
pub(super) fn read(chunk: &Chunk<'_>, file: &Path, warnings: &mut WarningList) -> Result<Option<FileNode>, Diagnostic> {
    let kind = match chunk.id {
        0xb002 => NodeKind::Object,
        0xb003 | 0xb007 => NodeKind::Aimed,
        0xb004 | 0xb006 => NodeKind::Target,
        0xb005 => NodeKind::Light,
        _ => return Ok(None),
    };
    let mut node = FileNode {
        kind,
        name: String::new(),
        instance: None,
        number: None,
        parent: None,
        pivot: Vec3::ZERO,
        position: Vec::new(),
        rotation: Vec::new(),
        scale: Vec::new(),
        roll: Vec::new(),
    };
    for child in chunk.children(file) {
        let child = child?;
        let mut cursor = child.cursor(file);
        match child.id {
            0xb010 => {
                node.name = cursor.text()?;
                cursor.skip(4)?;
                node.parent = Some(cursor.u16()?).filter(|&p| p != u16::MAX);
            }
            0xb011 => node.instance = Some(cursor.text()?).filter(|name| !name.is_empty()),
            0xb013 => node.pivot = cursor.vector()?,
            0xb020 => node.position = track::vectors(&mut cursor)?,
            0xb021 => node.rotation = track::rotations(&mut cursor)?,
            0xb022 => node.scale = track::vectors(&mut cursor)?,
            0xb024 => node.roll = track::numbers(&mut cursor)?,
            0xb030 => node.number = Some(cursor.u16()?),
            _ => {}
        }
    }
    if !node.rotation.is_sorted_by(|a, b| a.0 <= b.0) {
        let what = format!("the rotation keys of `{}` are not in order of time; only the first counts", node.name);
        warnings.push(Diagnostic::new(file, None, what).hint("keys in order; export the animation again"));
        node.rotation.truncate(1);
    }
    Ok(Some(node))
}
