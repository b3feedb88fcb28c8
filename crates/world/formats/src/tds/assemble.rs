//! Assembly of objects and nodes to a tree.

use std::collections::{HashMap, VecDeque};
use std::path::Path;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::camera_target::CameraTargets;
use super::content::TdsFile;
use super::keyframer::{FileNode, NodeKind};
use super::object::Object;
use super::track::FRAMES_PER_SECOND;
use crate::affine::Affine;
use crate::cycles::find_cycles;
use crate::mesh_data::{MAX_ELEMENTS, MeshData};
use crate::nodetree::{Keyframe, Node, NodeTree, rigid, sample};
use crate::warning_list::WarningList;
use crate::{Diagnostic, input};

pub(super) fn tree(content: TdsFile, file: &Path, warnings: &mut WarningList) -> Result<NodeTree, Diagnostic> {
    let TdsFile { objects, nodes, master_scale } = content;
    let parents = parents(&nodes, file, warnings);
    let order = order(&nodes, &parents);
    let object_of = object_of(&objects, &nodes, &order);
    let is_local = !nodes.iter().any(FileNode::has_track) && objects.iter().any(|o| o.axes.is_some());
    let frames = if is_local && !nodes.is_empty() {
        Frames::of_axes(&objects, &nodes, &parents, &order, &object_of, file, warnings)
    } else {
        Frames::of_tracks(&nodes, &parents, &order)
    };
    // The keys of a camera's descendants are in the frame of the camera, whose motion is not read.
    let mut follows_camera = vec![false; nodes.len()];
    for &i in &order {
        follows_camera[i] = nodes[i].kind != NodeKind::Object || parents[i].is_some_and(|p| follows_camera[p]);
    }
    let mut assembler = Assembler { objects: &objects, file, elements: 0, tree: NodeTree::new(input::stem(file)) };
    let mut index_of = HashMap::new();
    for &i in &order {
        let parent = parents[i].and_then(|p| index_of.get(&p).copied());
        let mut node = Node::new(nodes[i].display_name(), parent, frames.in_parent(i, parents[i]));
        if !follows_camera[i] {
            node.track = frames.track(&nodes[i], parents[i]);
        }
        if let Some(object) = object_of[i] {
            let to_frame =
                Affine::from(&frames.rigid[i].inverse()).after(&frames.of_vertices(i, &nodes[i], &objects[object]));
            assembler.mesh(object, &to_frame, &mut node)?;
        }
        index_of.insert(i, assembler.tree.push(node));
    }
    let mut is_used = vec![false; objects.len()];
    object_of.iter().flatten().for_each(|&object| is_used[object] = true);
    for object in (0..objects.len()).filter(|&o| !is_used[o]) {
        assembler.unreferenced_object(object)?;
    }
    let mut tree = assembler.tree;
    apply_master_scale(&mut tree, master_scale, file, warnings);
    Ok(tree)
}

fn apply_master_scale(tree: &mut NodeTree, scale: f64, file: &Path, warnings: &mut WarningList) {
    if scale == 1.0 || scale <= 0.0 {
        return;
    }
    tree.scale(1.0 / scale);
    warnings.push(Diagnostic::new(file, None, format!("has the master scale {scale}: all lengths are divided by it")));
}

/// The parent of each node. Nodes with a missing parent, and one node of each cycle, become top nodes.
fn parents(nodes: &[FileNode], file: &Path, warnings: &mut WarningList) -> Vec<Option<usize>> {
    let mut by_number: HashMap<usize, usize> = HashMap::new();
    for (i, node) in nodes.iter().enumerate() {
        by_number.entry(node.number.map_or(i, usize::from)).or_insert(i);
    }
    let mut parents = Vec::with_capacity(nodes.len());
    for node in nodes {
        let parent = node.parent.and_then(|number| {
            let found = by_number.get(&usize::from(number)).copied();
            if found.is_none() {
                let what = format!("the node `{}` has the parent {number}, which does not exist", node.display_name());
                warnings.push_with(|| Diagnostic::new(file, None, what).hint("it is put to the top"));
            }
            found
        });
        parents.push(parent);
    }
    for i in find_cycles(nodes.len(), |i| parents[i]) {
        let what = format!("the node `{}` is its own ancestor", nodes[i].display_name());
        warnings.push_with(|| Diagnostic::new(file, None, what).hint("it is put to the top"));
        parents[i] = None;
    }
    parents
}

/// The order of the nodes: parents before children, children in the order of the file.
///
/// Targets without children are omitted.
fn order(nodes: &[FileNode], parents: &[Option<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); nodes.len()];
    for (i, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent].push(i);
        }
    }
    let mut order = Vec::with_capacity(nodes.len());
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).rev().collect();
    while let Some(i) = stack.pop() {
        if nodes[i].kind != NodeKind::Target || !children[i].is_empty() {
            order.push(i);
        }
        stack.extend(children[i].iter().rev());
    }
    order
}

/// The object of each node. Of several objects with its name, the next unused one; the last one is reused.
fn object_of(objects: &[Object], nodes: &[FileNode], order: &[usize]) -> Vec<Option<usize>> {
    let mut named: HashMap<&str, VecDeque<usize>> = HashMap::new();
    for (i, object) in objects.iter().enumerate() {
        named.entry(&object.name).or_default().push_back(i);
    }
    let mut object_of = vec![None; nodes.len()];
    for &i in order.iter().filter(|&&i| nodes[i].kind == NodeKind::Object) {
        if let Some(list) = named.get_mut(nodes[i].name.as_str()) {
            object_of[i] = if list.len() > 1 { list.pop_front() } else { list.front().copied() };
        }
    }
    object_of
}

/// Rest frames of the nodes.
struct Frames {
    /// Frames in the world, with scale and mirror.
    full: Vec<Affine>,
    /// Frames in the world, without scale and mirror.
    rigid: Vec<Pose>,
    /// Whether vertices are in their object's frame; tracks are then absent.
    is_local: bool,
}

impl Frames {
    fn of_tracks(nodes: &[FileNode], parents: &[Option<usize>], order: &[usize]) -> Self {
        let targets = CameraTargets::new(nodes, parents);
        let mut full = vec![Affine::IDENTITY; nodes.len()];
        for &i in order {
            let node = &nodes[i];
            let position = node.position.first().map_or(Vec3::ZERO, |k| k.1);
            let mut rotation = node.rotation.first().map_or(Rotation::IDENTITY, |k| k.1);
            if node.kind == NodeKind::Aimed {
                rotation = targets.orientation(i);
            }
            full[i] = parent_of(&full, parents[i]).after(&node_transform(position, rotation, scale(node)));
        }
        let rigid = full.iter().map(rigid).collect();
        Self { full, rigid, is_local: false }
    }

    /// Frames from the axes of objects.
    ///
    /// A node without an object has the axes of the nearest object below it, or of its parent.
    fn of_axes(
        objects: &[Object],
        nodes: &[FileNode],
        parents: &[Option<usize>],
        order: &[usize],
        object_of: &[Option<usize>],
        file: &Path,
        warnings: &mut WarningList,
    ) -> Self {
        // Assimp writes the rows of the rotation instead of its columns.
        let own = |i: usize| object_of[i].and_then(|o| objects[o].axes).map(|axes| axes.transposed());
        let mut nearest: Vec<Option<(usize, Affine)>> = (0..nodes.len()).map(|i| own(i).map(|a| (0, a))).collect();
        for &i in order.iter().rev() {
            if let (Some(parent), Some((far, axes))) = (parents[i], nearest[i]) {
                // In reverse order, so that the first of equally near objects is selected.
                if nearest[parent].is_none_or(|(d, _)| far < d) {
                    nearest[parent] = Some((far + 1, axes));
                }
            }
        }
        let mut full = vec![Affine::IDENTITY; nodes.len()];
        let mut unplaced = Vec::new();
        for &i in order {
            full[i] = match (own(i), parents[i]) {
                (Some(axes), _) => axes,
                (None, None) => Affine::IDENTITY,
                (None, Some(parent)) => nearest[i].map_or(full[parent], |(_, axes)| axes),
            };
            if own(i).is_none() && parents[i].is_some() {
                unplaced.push(format!("`{}`", nodes[i].display_name()));
            }
        }
        warnings.push(Diagnostic::new(
            file,
            None,
            "has no tracks: vertices are taken as given in their object's own frame, as assimp writes them",
        ));
        if !unplaced.is_empty() {
            let more = unplaced.len().saturating_sub(8);
            unplaced.truncate(8);
            let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
            let what = format!(
                "nodes without a frame of their own have that of the nearest object below them, or of their \
                 parent: {}{tail}",
                unplaced.join(", ")
            );
            warnings.push(Diagnostic::new(file, None, what));
        }
        let rigid = full.iter().map(rigid).collect();
        Self { full, rigid, is_local: true }
    }

    fn in_parent(&self, i: usize, parent: Option<usize>) -> Pose {
        parent.map_or(self.rigid[i], |p| self.rigid[p].inverse_mul(&self.rigid[i]))
    }

    /// The transform from the vertices of the file to the world.
    fn of_vertices(&self, i: usize, node: &FileNode, object: &Object) -> Affine {
        if self.is_local {
            return self.full[i];
        }
        let to_object = to_object(object);
        self.full[i].after(&Affine::translation((-node.pivot).to_array())).after(&to_object)
    }

    /// The keys of position and rotation combined; empty for fewer than two keys.
    fn track(&self, node: &FileNode, parent: Option<usize>) -> Vec<Keyframe> {
        if self.is_local || node.position.len().max(node.rotation.len()) < 2 {
            return Vec::new();
        }
        let mut frames: Vec<f64> = node.position.iter().map(|k| k.0).chain(node.rotation.iter().map(|k| k.0)).collect();
        frames.sort_by(f64::total_cmp);
        frames.dedup();
        let parent_full = parent_of(&self.full, parent);
        let parent_rigid = parent.map_or(Pose::IDENTITY, |p| self.rigid[p]);
        let key = |frame: f64| {
            let position = sample(&node.position, frame, Vec3::lerp).unwrap_or(Vec3::ZERO);
            let rotation = sample(&node.rotation, frame, Rotation::interpolate).unwrap_or(Rotation::IDENTITY);
            let in_world = rigid(&parent_full.after(&node_transform(position, rotation, scale(node))));
            Keyframe { time_s: frame / FRAMES_PER_SECOND, in_parent: parent_rigid.inverse_mul(&in_world) }
        };
        frames.into_iter().map(key).collect()
    }
}

fn parent_of(full: &[Affine], parent: Option<usize>) -> Affine {
    parent.and_then(|p| full.get(p)).copied().unwrap_or(Affine::IDENTITY)
}

fn scale(node: &FileNode) -> Vec3 {
    node.scale.first().map_or(Vec3::splat(1.0), |k| k.1)
}

fn node_transform(position: Vec3, rotation: Rotation, scale: Vec3) -> Affine {
    Affine::translation(position.to_array())
        .after(&Affine::rotation(rotation.rows()))
        .after(&Affine::scale(scale.to_array()))
}

/// The transform from the vertices of the file to the object's frame.
///
/// If the axes mirror, the file contains the vertices unmirrored. Then x is negated, as in other readers.
fn to_object(object: &Object) -> Affine {
    let Some((axes, back)) = object.axes.and_then(|axes| Some((axes, axes.inverse()?))) else {
        return Affine::IDENTITY;
    };
    if axes.is_mirror() { Affine::scale([-1.0, 1.0, 1.0]).after(&back) } else { back }
}

struct Assembler<'a> {
    objects: &'a [Object],
    file: &'a Path,
    elements: usize,
    tree: NodeTree,
}

impl Assembler<'_> {
    /// Adds an object to a node, in the frame of the node.
    fn mesh(&mut self, object: usize, to_frame: &Affine, node: &mut Node) -> Result<(), Diagnostic> {
        let Object { name, vertices, triangles, .. } = &self.objects[object];
        self.elements = self.elements.saturating_add(vertices.len()).saturating_add(triangles.len());
        if self.elements > MAX_ELEMENTS {
            let what = format!("expands to more than {MAX_ELEMENTS} vertices and triangles");
            return Err(Diagnostic::new(self.file, None, what).hint(format!("fewer instances of `{name}`")));
        }
        if triangles.is_empty() {
            return Ok(());
        }
        let mut mesh = MeshData { name: name.clone(), vertices: vertices.clone(), triangles: triangles.clone() };
        to_frame.apply(&mut mesh);
        node.meshes.push(mesh);
        Ok(())
    }

    /// Adds an object that no node refers to, at its position in the file.
    fn unreferenced_object(&mut self, object: usize) -> Result<(), Diagnostic> {
        let Object { name, axes, .. } = &self.objects[object];
        let frame = axes.as_ref().map_or(Pose::IDENTITY, rigid);
        let mut node = Node::new(name, None, frame);
        self.mesh(object, &Affine::from(&frame.inverse()), &mut node)?;
        self.tree.push(node);
        Ok(())
    }
}
