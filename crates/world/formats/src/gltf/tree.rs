//! The nodes of a scene as a tree, with their animations.

use elbowroom_spatial::Pose;

use super::animation::node_animations;
use super::scene::{SceneNode, SceneReader};
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
    let mut frames: Vec<Pose> = Vec::with_capacity(nodes.len());
    let full: Vec<Affine> = nodes.iter().map(|n| n.to_scene).collect();
    for scene_node in nodes {
        let parent_in_scene = scene_node.parent.map_or(Pose::IDENTITY, |p| frames[p]);
        let SceneNode { index, parent, name, to_scene, mesh } = scene_node;
        let (mut node, frame) = Node::placed(name, parent, &parent_in_scene, &to_scene, mesh);
        frames.push(frame);
        if let Some(animation) = animations.get(&index) {
            let parent = parent.map_or(Affine::IDENTITY, |p| full[p]);
            let in_parent = |to_parent: Affine| parent_in_scene.inverse_mul(&rigid(&parent.after(&to_parent)));
            let keys = animation.keys(&document.nodes[index]);
            node.track = keys.map(|(time_s, map)| Keyframe { time_s, in_parent: in_parent(map) }).collect();
        }
        tree.push(node);
    }
    Ok(())
}
