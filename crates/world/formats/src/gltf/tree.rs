//! The nodes of a scene as a tree, with their animations.

use elbowroom_spatial::Pose;

use super::animation::node_animations;
use super::scene::SceneReader;
use crate::Diagnostic;
use crate::affine::Affine;
use crate::nodetree::{Keyframe, Node, NodeTree, rigid};

pub(super) fn build(scene: &mut SceneReader<'_>, tree: &mut NodeTree) -> Result<(), Diagnostic> {
    let animations = node_animations(&scene.reader, &mut scene.elements)?;
    let document = scene.reader.document;
    if document.animations.len() > 1 {
        let what = "has several animations: of each node the first that moves it counts";
        scene.warnings.push(Diagnostic::new(scene.reader.file, None, what));
    }
    let nodes = std::mem::take(&mut scene.nodes);
    let frames: Vec<Pose> = nodes.iter().map(|n| rigid(&n.to_scene)).collect();
    let full: Vec<Affine> = nodes.iter().map(|n| n.to_scene).collect();
    for (i, scene_node) in nodes.into_iter().enumerate() {
        let parent_in_scene = scene_node.parent.map_or(Pose::IDENTITY, |p| frames[p]);
        let mut node = Node::new(scene_node.name, scene_node.parent, parent_in_scene.inverse_mul(&frames[i]));
        if let Some(mut mesh) = scene_node.mesh {
            Affine::from(&frames[i].inverse()).after(&scene_node.to_scene).apply(&mut mesh);
            node.meshes.push(mesh);
        }
        if let Some(animation) = animations.get(&scene_node.index) {
            let parent = scene_node.parent.map_or(Affine::IDENTITY, |p| full[p]);
            let in_parent = |to_parent: Affine| parent_in_scene.inverse_mul(&rigid(&parent.after(&to_parent)));
            let keys = animation.keys(&document.nodes[scene_node.index]);
            node.track = keys.map(|(time_s, map)| Keyframe { time_s, in_parent: in_parent(map) }).collect();
        }
        tree.push(node);
    }
    Ok(())
}
