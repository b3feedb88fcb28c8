//! The allowed collision matrix of a problem in a scene.

use std::collections::HashMap;

use elbowroom_formats::problem_set::AllowedCollisions;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{AllowedCollisionMatrix, PairEdit, Scene};

/// Reason for skipping a pair, for reports.
const REASON: &str = "allowed collision matrix of the problem";

/// Skips the pairs that may touch. Names that are neither links nor objects have no effect.
pub(super) fn skip_allowed(
    scene: &Scene,
    matrix: &AllowedCollisions,
    objects: &HashMap<&str, Vec<ObjectId>>,
) -> AllowedCollisionMatrix {
    let mut edited = scene.allowed_collision_matrix().clone();
    let mut skip = |a: GeometryId, b: GeometryId| {
        // A pair that the scene does not have is not tested anyway.
        drop(edited.edit(scene, a, b, PairEdit::Skip(REASON.into())));
    };
    let of_name = |name: &str| geometries(scene, name, objects);
    let named: Vec<Vec<GeometryId>> = matrix.names.iter().map(|name| of_name(name)).collect();
    for &(i, j) in &matrix.allowed {
        pairs(&named[i], &named[j]).for_each(|(a, b)| skip(a, b));
    }
    for name in &matrix.allowed_by_default {
        let unnamed = scene.geometries().filter(|id| !named.iter().flatten().any(|n| n == id));
        let unnamed: Vec<GeometryId> = unnamed.collect();
        pairs(&of_name(name), &unnamed).for_each(|(a, b)| skip(a, b));
    }
    edited
}

fn pairs<'a>(a: &'a [GeometryId], b: &'a [GeometryId]) -> impl Iterator<Item = (GeometryId, GeometryId)> + 'a {
    a.iter().flat_map(|a| b.iter().map(|b| (*a, *b)))
}

/// A link, or the solids of an object.
fn geometries(scene: &Scene, name: &str, objects: &HashMap<&str, Vec<ObjectId>>) -> Vec<GeometryId> {
    if let Some(objects) = objects.get(name) {
        return objects.iter().map(|id| GeometryId::Object(*id)).collect();
    }
    let link = scene.robots()[0].robot.chain.link(name);
    link.map(|link| GeometryId::Link { robot: RobotId(0), link }).into_iter().collect()
}
