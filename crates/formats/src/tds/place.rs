//! Objects and nodes put together: who hangs on whom, and where.

use std::collections::{HashMap, VecDeque};
use std::path::Path;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::Scene;
use super::keyframer::{FileNode, Kind};
use super::look::Targets;
use super::object::Object;
use super::track::FRAMES_PER_SECOND;
use crate::error::Warnings;
use crate::mesh::{MOST_ELEMENTS, MeshData};
use crate::nodetree::{Key, Node, NodeTree, rigid, sample};
use crate::transform::Affine;
use crate::{FormatError, Warning, source};

pub(super) fn tree(scene: Scene, file: &Path, warnings: &mut Warnings) -> Result<NodeTree, FormatError> {
    let Scene { objects, nodes, master_scale } = scene;
    let parents = parents(&nodes, file, warnings);
    let order = order(&nodes, &parents);
    let shown = shown(&objects, &nodes, &order);
    let local = !nodes.iter().any(FileNode::has_track) && objects.iter().any(|o| o.axes.is_some());
    let frames = if local && !nodes.is_empty() {
        Frames::of_axes(&objects, &nodes, &parents, &order, &shown, (file, warnings))
    } else {
        Frames::of_tracks(&nodes, &parents, &order)
    };
    // What hangs on a camera has its keys in a frame that looks about, which is not followed.
    let mut looks_about = vec![false; nodes.len()];
    for &i in &order {
        looks_about[i] = nodes[i].kind != Kind::Object || parents[i].is_some_and(|p| looks_about[p]);
    }
    let mut placer = Placer { objects: &objects, file, elements: 0, tree: NodeTree::new(source::stem(file)) };
    let mut index_of = HashMap::new();
    for &i in &order {
        let parent = parents[i].and_then(|p| index_of.get(&p).copied());
        let mut node = Node::new(nodes[i].shown_name(), parent, frames.in_parent(i, parents[i]));
        if !looks_about[i] {
            node.track = frames.track(&nodes[i], parents[i]);
        }
        if let Some(object) = shown[i] {
            let to_frame =
                Affine::from(&frames.rigid[i].inverse()).after(&frames.of_vertices(i, &nodes[i], &objects[object]));
            placer.mesh(object, &to_frame, &mut node)?;
        }
        index_of.insert(i, placer.tree.push(node));
    }
    let mut is_shown = vec![false; objects.len()];
    shown.iter().flatten().for_each(|&object| is_shown[object] = true);
    for object in (0..objects.len()).filter(|&o| !is_shown[o]) {
        placer.alone(object)?;
    }
    let mut tree = placer.tree;
    apply_master_scale(&mut tree, master_scale, file, warnings);
    Ok(tree)
}

fn apply_master_scale(tree: &mut NodeTree, scale: f64, file: &Path, warnings: &mut Warnings) {
    if scale == 1.0 || scale <= 0.0 {
        return;
    }
    tree.scale(1.0 / scale);
    warnings.push(Warning::new(file, None, format!("has the master scale {scale}: all lengths are divided by it")));
}

/// Who carries each node. Numbers that name nobody, and circles, end at the top.
fn parents(nodes: &[FileNode], file: &Path, warnings: &mut Warnings) -> Vec<Option<usize>> {
    let mut by_number: HashMap<usize, usize> = HashMap::new();
    for (i, node) in nodes.iter().enumerate() {
        by_number.entry(node.number.map_or(i, usize::from)).or_insert(i);
    }
    let mut parents = Vec::with_capacity(nodes.len());
    for node in nodes {
        let parent = node.parent.and_then(|number| {
            let found = by_number.get(&usize::from(number)).copied();
            if found.is_none() {
                let what = format!("the node `{}` hangs on node {number}, which does not exist", node.shown_name());
                warnings.push_with(|| Warning::new(file, None, what).hint("it is put to the top"));
            }
            found
        });
        parents.push(parent);
    }
    // 0 unseen, 1 on the present trail, 2 known to end.
    let mut state = vec![0; nodes.len()];
    for start in 0..nodes.len() {
        let mut trail = Vec::new();
        let mut next = Some(start);
        while let Some(i) = next.filter(|&i| state[i] != 2) {
            if state[i] == 1 {
                let what = format!("the node `{}` hangs on itself, around some corners", nodes[i].shown_name());
                warnings.push_with(|| Warning::new(file, None, what).hint("it is put to the top"));
                parents[i] = None;
                break;
            }
            state[i] = 1;
            trail.push(i);
            next = parents[i];
        }
        for i in trail {
            state[i] = 2;
        }
    }
    parents
}

/// Nodes with parents before children, children in the order of the file; targets that carry nothing are left out.
fn order(nodes: &[FileNode], parents: &[Option<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); nodes.len()];
    for (i, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent].push(i);
        }
    }
    let mut order = Vec::with_capacity(nodes.len());
    let mut waiting: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).rev().collect();
    while let Some(i) = waiting.pop() {
        if nodes[i].kind != Kind::Target || !children[i].is_empty() {
            order.push(i);
        }
        waiting.extend(children[i].iter().rev());
    }
    order
}

/// Which object each node shows: of those with its name the next, or again the only one.
fn shown(objects: &[Object], nodes: &[FileNode], order: &[usize]) -> Vec<Option<usize>> {
    let mut named: HashMap<&str, VecDeque<usize>> = HashMap::new();
    for (i, object) in objects.iter().enumerate() {
        named.entry(&object.name).or_default().push_back(i);
    }
    let mut shown = vec![None; nodes.len()];
    for &i in order.iter().filter(|&&i| nodes[i].kind == Kind::Object) {
        if let Some(list) = named.get_mut(nodes[i].name.as_str()) {
            shown[i] = if list.len() > 1 { list.pop_front() } else { list.front().copied() };
        }
    }
    shown
}

/// Where nodes are at rest.
struct Frames {
    /// In the world, with scale and mirror.
    full: Vec<Affine>,
    /// In the world, without.
    rigid: Vec<Pose>,
    /// Vertices are in their object's frame, and there are no tracks.
    local: bool,
}

impl Frames {
    fn of_tracks(nodes: &[FileNode], parents: &[Option<usize>], order: &[usize]) -> Self {
        let targets = Targets::new(nodes, parents);
        let mut full = vec![Affine::IDENTITY; nodes.len()];
        for &i in order {
            let node = &nodes[i];
            let position = node.position.first().map_or(Vec3::ZERO, |k| k.1);
            let mut rotation = node.rotation.first().map_or(Rotation::IDENTITY, |k| k.1);
            if node.kind == Kind::Looks {
                rotation = targets.looking(i);
            }
            full[i] = parent_of(&full, parents[i]).after(&local(position, rotation, scale(node)));
        }
        let rigid = full.iter().map(rigid).collect();
        Self { full, rigid, local: false }
    }

    /// Nodes with an object stand at its axes; others where the nearest object below them does, or with their parent.
    fn of_axes(
        objects: &[Object],
        nodes: &[FileNode],
        parents: &[Option<usize>],
        order: &[usize],
        shown: &[Option<usize>],
        (file, warnings): (&Path, &mut Warnings),
    ) -> Self {
        // Assimp writes the rows of the rotation where the format has its columns.
        let own = |i: usize| shown[i].and_then(|o| objects[o].axes).map(|axes| axes.transposed());
        let mut nearest: Vec<Option<(usize, Affine)>> = (0..nodes.len()).map(|i| own(i).map(|a| (0, a))).collect();
        for &i in order.iter().rev() {
            if let (Some(parent), Some((far, axes))) = (parents[i], nearest[i]) {
                // Backwards through the file, so that of equals the first stays.
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
                unplaced.push(format!("`{}`", nodes[i].shown_name()));
            }
        }
        warnings.push(Warning::new(
            file,
            None,
            "has no tracks: vertices are taken as given in their object's own frame, as assimp writes them",
        ));
        if !unplaced.is_empty() {
            let more = unplaced.len().saturating_sub(8);
            unplaced.truncate(8);
            let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
            let what = format!(
                "nodes without a place of their own stand where the nearest object below them does, or with their \
                 parent: {}{tail}",
                unplaced.join(", ")
            );
            warnings.push(Warning::new(file, None, what));
        }
        let rigid = full.iter().map(rigid).collect();
        Self { full, rigid, local: true }
    }

    fn in_parent(&self, i: usize, parent: Option<usize>) -> Pose {
        parent.map_or(self.rigid[i], |p| self.rigid[p].inverse_mul(&self.rigid[i]))
    }

    /// From the file's vertices to the world.
    fn of_vertices(&self, i: usize, node: &FileNode, object: &Object) -> Affine {
        if self.local {
            return self.full[i];
        }
        let to_object = to_object(object);
        self.full[i].after(&Affine::translation((-node.pivot).to_array())).after(&to_object)
    }

    /// The keys of position and rotation together; empty where there is no more than one.
    fn track(&self, node: &FileNode, parent: Option<usize>) -> Vec<Key> {
        if self.local || node.position.len().max(node.rotation.len()) < 2 {
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
            let in_world = rigid(&parent_full.after(&local(position, rotation, scale(node))));
            Key { time_s: frame / FRAMES_PER_SECOND, in_parent: parent_rigid.inverse_mul(&in_world) }
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

fn local(position: Vec3, rotation: Rotation, scale: Vec3) -> Affine {
    Affine::translation(position.to_array())
        .after(&Affine::rotation(rotation.rows()))
        .after(&Affine::scale(scale.to_array()))
}

/// From the file's vertices to the object's own frame. Under axes that mirror, the vertices stand in the file
/// unmirrored: x is turned round, as other readers do.
fn to_object(object: &Object) -> Affine {
    let Some((axes, back)) = object.axes.and_then(|axes| Some((axes, axes.inverse()?))) else {
        return Affine::IDENTITY;
    };
    if axes.is_mirror() { Affine::scale([-1.0, 1.0, 1.0]).after(&back) } else { back }
}

struct Placer<'a> {
    objects: &'a [Object],
    file: &'a Path,
    elements: usize,
    tree: NodeTree,
}

impl Placer<'_> {
    /// An object in the frame of a node.
    fn mesh(&mut self, object: usize, to_frame: &Affine, node: &mut Node) -> Result<(), FormatError> {
        let Object { name, vertices, triangles, .. } = &self.objects[object];
        self.elements = self.elements.saturating_add(vertices.len()).saturating_add(triangles.len());
        if self.elements > MOST_ELEMENTS {
            let what = format!("unfolds into more than {MOST_ELEMENTS} vertices and triangles");
            return Err(FormatError::new(self.file, None, what).hint(format!("fewer instances of `{name}`")));
        }
        if triangles.is_empty() {
            return Ok(());
        }
        let mut mesh = MeshData { name: name.clone(), vertices: vertices.clone(), triangles: triangles.clone() };
        to_frame.apply(&mut mesh);
        node.meshes.push(mesh);
        Ok(())
    }

    /// An object that no node shows stands where its vertices are.
    fn alone(&mut self, object: usize) -> Result<(), FormatError> {
        let Object { name, axes, .. } = &self.objects[object];
        let frame = axes.as_ref().map_or(Pose::IDENTITY, rigid);
        let mut node = Node::new(name, None, frame);
        self.mesh(object, &Affine::from(&frame.inverse()), &mut node)?;
        self.tree.push(node);
        Ok(())
    }
}
