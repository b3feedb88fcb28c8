//! Units suspected wrong: lengths of solids against lengths of the chain that carries them.
//!
//! The chain's own dimensions are the reference `R`: the longest way from the root to a leaf through the origins and
//! strokes of its joints. A unit taken for another is a factor of 25 at least, so wide bounds catch every mistake and
//! no odd robot. Where there is no chain, the size of the thing alone must do.

use elbowroom_formats::mesh::Format;
use elbowroom_kinematics::{Chain, JointKind, LinkId};
use elbowroom_scene::Robot;
use elbowroom_spatial::Aabb;
use serde::Serialize;

/// A doubt about a unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitDoubt {
    /// The link, or the object of a mesh file; null where all of the model is meant.
    pub link: Option<String>,
    /// Largest edge of its box as read, m.
    pub extent_m: f64,
    /// What it was compared with, m: the longest way through the chain; null for a mesh file.
    pub reference_m: Option<f64>,
    /// `mm`, `cm` or `in` where numbers of that unit were read as metres; `applied twice` where a unit was.
    pub looks_like: &'static str,
    /// In words.
    pub reason: String,
}

/// A link this many times larger than the chain is long is in doubt.
const LARGE: f64 = 10.0;
/// So is one that stands still, which may be a hall, from here on.
const LARGE_AND_FIXED: f64 = 100.0;
/// Nothing smaller than this (m) is in doubt of being too large.
const LARGE_M: f64 = 5.0;
/// A model whose largest solid is smaller than the chain divided by this is in doubt.
const SMALL: f64 = 200.0;
/// A mesh file of no stated unit larger than this (m) is in doubt.
const LARGE_FILE_M: f64 = 50.0;
/// And one smaller than this.
const SMALL_FILE_M: f64 = 1e-3;

pub(super) fn of_robot(robot: &Robot) -> Vec<UnitDoubt> {
    let chain = &robot.chain;
    let reference = longest_way(chain);
    let extents: Vec<(LinkId, f64)> =
        (0..robot.bodies.len()).filter_map(|l| Some((LinkId(l), extent(robot, l)?))).collect();
    if !(reference > 0.0 && reference.is_finite()) {
        return Vec::new();
    }
    let mut doubts: Vec<UnitDoubt> = extents.iter().filter_map(|(l, e)| too_large(chain, *l, *e, reference)).collect();
    let largest = extents.iter().fold(0.0, |m: f64, e| m.max(e.1));
    if largest > 0.0 && largest * SMALL < reference {
        doubts.push(too_small(largest, reference));
    }
    doubts
}

/// `format` is that of the file where it can be told.
pub(super) fn of_mesh(object: &str, extent_m: f64, format: Option<Format>) -> Option<UnitDoubt> {
    if format.is_some_and(Format::states_its_unit) {
        return None;
    }
    let doubt = |looks_like, reason| {
        Some(UnitDoubt { link: Some(object.to_owned()), extent_m, reference_m: None, looks_like, reason })
    };
    if extent_m > LARGE_FILE_M {
        let what =
            format!("`{object}` is {extent_m:.4} m large and its file states no unit: looks like mm; write: --unit mm");
        return doubt("mm", what);
    }
    if extent_m > 0.0 && extent_m < SMALL_FILE_M {
        let what =
            format!("`{object}` is only {extent_m:.1e} m large: looks like a unit applied twice; write: --unit m");
        return doubt("applied twice", what);
    }
    None
}

/// Longest edge of the box around all solids of a link, in its frame.
fn extent(robot: &Robot, link: usize) -> Option<f64> {
    let around = robot.bodies[link].iter().fold(Aabb::EMPTY, |all, b| all.union(&b.shape.aabb(&b.in_link)));
    let extent = around.extent().max_element();
    (!around.is_empty() && extent.is_finite()).then_some(extent)
}

fn longest_way(chain: &Chain) -> f64 {
    let stride = |id: &elbowroom_kinematics::JointId| {
        let joint = &chain.joints()[id.0];
        let stroke = match joint.kind {
            JointKind::Prismatic => {
                [joint.limits.lower, joint.limits.upper].map(f64::abs).into_iter().fold(0.0, f64::max)
            }
            _ => 0.0,
        };
        joint.origin.translation.length() + if stroke.is_finite() { stroke } else { 0.0 }
    };
    let way = |leaf: &LinkId| chain.path(*leaf).iter().map(stride).sum::<f64>();
    chain.leaves().iter().map(way).fold(0.0, f64::max)
}

fn too_large(chain: &Chain, link: LinkId, extent_m: f64, reference: f64) -> Option<UnitDoubt> {
    let moved = chain.path(link).iter().any(|j| chain.joints()[j.0].kind.moves());
    let bound = if moved { LARGE } else { LARGE_AND_FIXED };
    if !(extent_m > bound * reference && extent_m > LARGE_M) {
        return None;
    }
    // A link is commonly about a third of its chain: the unit that brings it nearest to that is named.
    let misfit = |factor: f64| (extent_m * factor / (0.3 * reference)).ln().abs();
    let units = [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254)];
    let (looks_like, factor) = units.into_iter().min_by(|x, y| misfit(x.1).total_cmp(&misfit(y.1)))?;
    let name = &chain.links()[link.0];
    let reason = format!(
        "link `{name}` is {extent_m:.4} m large on a chain of {reference:.4} m: its mesh looks like {looks_like}\n  \
         write: <mesh filename=\"…\" scale=\"{factor} {factor} {factor}\"/>, or --unit {looks_like} where all meshes are so"
    );
    Some(UnitDoubt { link: Some(name.clone()), extent_m, reference_m: Some(reference), looks_like, reason })
}

fn too_small(largest: f64, reference: f64) -> UnitDoubt {
    let reason = format!(
        "the largest solid is {largest:.1e} m on a chain of {reference:.4} m: looks like a unit applied twice, or \
         joints in mm\n  write: meshes without scale=\"0.001 0.001 0.001\", --unit m, <origin xyz=\"…\"/> in metres"
    );
    UnitDoubt { link: None, extent_m: largest, reference_m: Some(reference), looks_like: "applied twice", reason }
}
