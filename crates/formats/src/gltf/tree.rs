//! The nodes of a scene as a tree, with what their animations say.

use std::collections::HashMap;

use elbowroom_spatial::{Pose, Rotation, Vec3};
use gltf::Document;
use gltf::animation::{Channel, Interpolation, Property};
use gltf::json::validation::Checked;
use gltf::scene::Transform;

use super::{Reader, Scene};
use crate::mesh::MOST_ELEMENTS;
use crate::nodetree::{Key, Node, NodeTree, rigid, sample};
use crate::transform::Affine;
use crate::{FormatError, Warning};

pub(super) fn build(document: &Document, scene: &mut Scene<'_>, tree: &mut NodeTree) -> Result<(), FormatError> {
    let motions = motions(document, &scene.reader, &mut scene.elements)?;
    if document.animations().len() > 1 {
        let what = "has several animations: of each node the first that moves it counts";
        scene.warnings.push(Warning::new(scene.reader.file, None, what));
    }
    let visits = std::mem::take(&mut scene.visits);
    let frames: Vec<Pose> = visits.iter().map(|v| rigid(&v.to_scene)).collect();
    let full: Vec<Affine> = visits.iter().map(|v| v.to_scene).collect();
    let transforms: HashMap<usize, Transform> = document.nodes().map(|n| (n.index(), n.transform())).collect();
    for (i, visit) in visits.into_iter().enumerate() {
        let parent_in_scene = visit.parent.map_or(Pose::IDENTITY, |p| frames[p]);
        let mut node = Node::new(visit.name, visit.parent, parent_in_scene.inverse_mul(&frames[i]));
        if let Some(mut mesh) = visit.mesh {
            Affine::from(&frames[i].inverse()).after(&visit.to_scene).apply(&mut mesh);
            node.meshes.push(mesh);
        }
        if let (Some(motion), Some(rest)) = (motions.get(&visit.index), transforms.get(&visit.index)) {
            let parent = visit.parent.map_or(Affine::IDENTITY, |p| full[p]);
            let to_parent = |to_parent: Affine| parent_in_scene.inverse_mul(&rigid(&parent.after(&to_parent)));
            node.track = motion.keys(rest).map(|(time_s, map)| Key { time_s, in_parent: to_parent(map) }).collect();
        }
        tree.push(node);
    }
    Ok(())
}

/// Channels of one node; values at rising times.
#[derive(Default)]
struct Motion {
    /// Which animation they belong to.
    animation: usize,
    positions: Vec<(f64, Vec3)>,
    rotations: Vec<(f64, Rotation)>,
}

impl Motion {
    /// The node's transform at every time of a channel; what has no channel stays as at rest.
    fn keys<'a>(&'a self, rest: &Transform) -> impl Iterator<Item = (f64, Affine)> + 'a {
        let mut times: Vec<f64> =
            self.positions.iter().map(|k| k.0).chain(self.rotations.iter().map(|k| k.0)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let (position, rotation, scale) = rest.clone().decomposed();
        let (position, scale) = (Vec3::from(position.map(f64::from)), Affine::scale(scale.map(f64::from)));
        let rotation = Rotation::from_quaternion_xyzw(rotation.map(f64::from)).unwrap_or(Rotation::IDENTITY);
        times.into_iter().map(move |t| {
            let position = sample(&self.positions, t, Vec3::lerp).unwrap_or(position);
            let rotation = sample(&self.rotations, t, Rotation::interpolate).unwrap_or(rotation);
            let turned = Affine::rotation(rotation.rows()).after(&scale);
            (t, Affine::translation(position.to_array()).after(&turned))
        })
    }
}

fn motions(
    document: &Document,
    reader: &Reader<'_>,
    elements: &mut usize,
) -> Result<HashMap<usize, Motion>, FormatError> {
    let mut motions: HashMap<usize, Motion> = HashMap::new();
    for animation in document.animations() {
        for channel in animation.channels() {
            let place = format!("animation {}, channel {}", animation.index(), channel.index());
            // The library checks samplers, but not what a channel aims at.
            let target = &document.as_json().animations[animation.index()].channels[channel.index()].target;
            let node = target.node.value();
            if node >= document.nodes().len() {
                let what = format!("moves node {node}, which does not exist");
                return Err(reader.error(&place, &what).hint("the number of a node, counted from 0"));
            }
            let Checked::Valid(property @ (Property::Translation | Property::Rotation)) = target.path else {
                continue;
            };
            let motion =
                motions.entry(node).or_insert_with(|| Motion { animation: animation.index(), ..Motion::default() });
            if motion.animation != animation.index() {
                continue;
            }
            let sampler = channel.sampler();
            // Many channels may share one accessor.
            *elements = elements.saturating_add(sampler.input().count()).saturating_add(sampler.output().count());
            if *elements > MOST_ELEMENTS {
                let what = format!("is one too many: the file unfolds into more than {MOST_ELEMENTS} numbers");
                return Err(reader.error(&place, &what).hint("an animation with fewer keys, or none"));
            }
            if property == Property::Translation {
                motion.positions = keys(&channel, reader, 3, &place, |v| Some(Vec3::new(v[0], v[1], v[2])))?;
            } else {
                let rotation = |v: &[f64]| Rotation::from_quaternion_xyzw([v[0], v[1], v[2], v[3]]);
                motion.rotations = keys(&channel, reader, 4, &place, rotation)?;
            }
        }
    }
    Ok(motions)
}

fn keys<T>(
    channel: &Channel<'_>,
    reader: &Reader<'_>,
    width: usize,
    place: &str,
    value: impl Fn(&[f64]) -> Option<T>,
) -> Result<Vec<(f64, T)>, FormatError> {
    let sampler = channel.sampler();
    let times = reader.vectors(&sampler.input(), 1, place)?;
    let values = reader.vectors(&sampler.output(), width, place)?;
    // A cubic spline has a tangent before and after each value.
    let (step, first) = if sampler.interpolation() == Interpolation::CubicSpline { (3, 1) } else { (1, 0) };
    if values.len() < times.len() * step * width {
        return Err(reader
            .error(place, "has fewer values than times")
            .hint("the animation exported again, or left out"));
    }
    if !times.is_sorted_by(|a, b| a < b) {
        return Err(reader
            .error(place, "has times that do not rise")
            .hint("the animation exported again, or left out"));
    }
    let rows = values.chunks_exact(width).skip(first).step_by(step);
    let key = |(time, row): (f64, &[f64])| {
        let value = value(row).ok_or_else(|| {
            reader.error(place, "has a rotation that is none").hint("unit quaternions; export the animation again")
        })?;
        Ok((time, value))
    };
    times.into_iter().zip(rows).map(key).collect()
}
