//! Animations of nodes.

use std::collections::HashMap;

use elbowroom_spatial::{Rotation, Vec3};

use super::accessor::AccessorReader;
use super::document::{Interpolation, Node, Sampler};
use super::scene::decomposed;
use crate::Diagnostic;
use crate::affine::Affine;
use crate::mesh_data::MAX_ELEMENTS;
use crate::nodetree::sample;

/// Channels of one node: values at increasing times.
#[derive(Default)]
pub(super) struct NodeAnimation {
    /// Index of the animation of these channels.
    animation: usize,
    positions: Vec<(f64, Vec3)>,
    rotations: Vec<(f64, Rotation)>,
}

impl NodeAnimation {
    /// The node's transform at every time of a channel. Parts without a channel are as in `rest`.
    pub(super) fn keys(&self, rest: &Node) -> impl Iterator<Item = (f64, Affine)> + '_ {
        let mut times: Vec<f64> =
            self.positions.iter().map(|k| k.0).chain(self.rotations.iter().map(|k| k.0)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let (position, rotation, scale) = decomposed(rest);
        let scale = Affine::scale(scale);
        times.into_iter().map(move |t| {
            let position = sample(&self.positions, t, Vec3::lerp).unwrap_or(position);
            let rotation = sample(&self.rotations, t, Rotation::interpolate).unwrap_or(rotation);
            let rotated = Affine::rotation(rotation.rows()).after(&scale);
            (t, Affine::translation(position.to_array()).after(&rotated))
        })
    }
}

/// The animated nodes, by their index in the document. If several animations move a node, the first one counts.
pub(super) fn node_animations(
    reader: &AccessorReader<'_>,
    elements: &mut usize,
) -> Result<HashMap<usize, NodeAnimation>, Diagnostic> {
    let document = reader.document;
    let mut nodes: HashMap<usize, NodeAnimation> = HashMap::new();
    for (a, animation) in document.animations.iter().enumerate() {
        for (c, channel) in animation.channels.iter().enumerate() {
            let place = format!("animation {a}, channel {c}");
            let Some(node) = channel.target.node else { continue };
            if node >= document.nodes.len() {
                let what = format!("moves node {node}, which does not exist");
                return Err(reader.error(&place, &what).hint("the number of a node, counted from 0"));
            }
            let is_translation = match channel.target.path.as_str() {
                "translation" => true,
                "rotation" => false,
                _ => continue,
            };
            let of_node =
                nodes.entry(node).or_insert_with(|| NodeAnimation { animation: a, ..NodeAnimation::default() });
            if of_node.animation != a {
                continue;
            }
            let sampler = animation.samplers.get(channel.sampler).ok_or_else(|| {
                reader
                    .error(&place, &format!("has the sampler {}, which does not exist", channel.sampler))
                    .hint("the number of a sampler, counted from 0")
            })?;
            let keys = Keys { reader, sampler, place: &place };
            if is_translation {
                of_node.positions = keys.read(elements, 3, |v| Some(Vec3::new(v[0], v[1], v[2])))?;
            } else {
                of_node.rotations =
                    keys.read(elements, 4, |v| Rotation::from_quaternion_xyzw([v[0], v[1], v[2], v[3]]))?;
            }
        }
    }
    Ok(nodes)
}

/// The keys of a channel.
struct Keys<'a, 'r> {
    reader: &'a AccessorReader<'r>,
    sampler: &'a Sampler,
    place: &'a str,
}

impl Keys<'_, '_> {
    fn read<T>(
        &self,
        elements: &mut usize,
        width: usize,
        value: impl Fn(&[f64]) -> Option<T>,
    ) -> Result<Vec<(f64, T)>, Diagnostic> {
        let (reader, place) = (self.reader, self.place);
        let input = reader.accessor(self.sampler.input, place, "times")?;
        let output = reader.accessor(self.sampler.output, place, "values")?;
        // Many channels may share one accessor.
        *elements = elements.saturating_add(input.count).saturating_add(output.count);
        if *elements > MAX_ELEMENTS {
            let what = format!("is one too many: the file expands to more than {MAX_ELEMENTS} numbers");
            return Err(reader.error(place, &what).hint("an animation with fewer keys, or none"));
        }
        let times = reader.vectors(input, 1, place)?;
        let values = reader.vectors(output, width, place)?;
        // A cubic spline has a tangent before and after each value.
        let is_cubic = self.sampler.interpolation == Interpolation::CubicSpline;
        let (step, first) = if is_cubic { (3, 1) } else { (1, 0) };
        let hint = "the animation exported again, or left out";
        if values.len() < times.len().saturating_mul(step * width) {
            return Err(reader.error(place, "has fewer values than times").hint(hint));
        }
        if !times.is_sorted_by(|a, b| a < b) {
            return Err(reader.error(place, "has times that do not rise").hint(hint));
        }
        let rows = values.chunks_exact(width).skip(first).step_by(step);
        let key = |(time, row): (f64, &[f64])| {
            let value = value(row).ok_or_else(|| {
                reader
                    .error(place, "has a rotation that is no unit quaternion")
                    .hint("unit quaternions; export the animation again")
            })?;
            Ok((time, value))
        };
        times.into_iter().zip(rows).map(key).collect()
    }
}
