//! The pairs that the allowed collision matrix of a planning scene lets touch, by the names of a cell.

use std::ops::Range;

use elbowroom_formats::planning_scene::PlanningScene;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{PairEdit, PairRule, Selection};

use crate::Cell;

/// The pairs of one scene.
#[derive(Debug, Default)]
pub(crate) struct ScenePairs {
    /// A rule for each pair.
    pub rules: Vec<PairRule>,
    /// Names of the first pair that counts, as in the scene.
    pub example: Option<[String; 2]>,
    /// Number of pairs that count. Other pairs are not tested anyway.
    pub count: usize,
    /// The first pair with a link name that several robots have.
    pub ambiguous: Option<[String; 2]>,
}

impl ScenePairs {
    /// The pairs of a scene whose objects are `objects` of the cell. Names that the cell does not have are ignored.
    pub(crate) fn of(scene: &PlanningScene, objects: &Range<usize>, cell: &Cell) -> Self {
        let names = SceneNames { objects: object_ids(scene, objects), cell };
        let mut pairs = Self::default();
        let reason = format!("allowed in {}", scene.file.file_name().unwrap_or_default().to_string_lossy());
        let allowed = &scene.allowed;
        for &(a, b) in &allowed.allowed {
            pairs.add([&allowed.names[a], &allowed.names[b]], &names, &reason);
        }
        // Default entries apply to names that the matrix does not contain.
        let others: Vec<&str> = names.all().filter(|name| !allowed.names.iter().any(|n| n == name)).collect();
        for name in &allowed.allowed_by_default {
            for other in others.iter().filter(|other| *other != name) {
                pairs.add([name, other], &names, &reason);
            }
        }
        pairs
    }

    fn add(&mut self, pair: [&str; 2], names: &SceneNames<'_>, reason: &str) {
        let [a, b] = pair.map(|name| names.geometries(name));
        let robots = |side: &[GeometryId]| side.iter().filter(|id| matches!(id, GeometryId::Link { .. })).count();
        // Two link names are a pair in each robot. A link name of several robots is ambiguous with an object.
        if (robots(&a) > 1 && robots(&b) == 0) || (robots(&b) > 1 && robots(&a) == 0) {
            let is_one = !a.is_empty() && !b.is_empty();
            self.ambiguous = self.ambiguous.take().or_else(|| is_one.then(|| pair.map(str::to_owned)));
            return;
        }
        let before = self.rules.len();
        for &x in &a {
            let pairs = b.iter().filter(|y| names.are_tested(x, **y));
            let edit = || PairEdit::Skip(reason.to_owned());
            self.rules.extend(pairs.map(|&y| PairRule { a: Selection::from(x), b: Selection::from(y), edit: edit() }));
        }
        if self.rules.len() > before {
            self.count += 1;
            self.example = self.example.take().or_else(|| Some(pair.map(str::to_owned)));
        }
    }
}

/// The objects of the cell with the names that they have in the scene: one for each solid.
fn object_ids<'s>(scene: &'s PlanningScene, objects: &Range<usize>) -> Vec<(&'s str, ObjectId)> {
    let names = scene.objects.iter().flat_map(|o| o.named_solids().map(|_| o.id.as_str()));
    names.zip(objects.clone()).map(|(name, index)| (name, ObjectId(index))).collect()
}

/// Names of a scene in a cell.
struct SceneNames<'a> {
    objects: Vec<(&'a str, ObjectId)>,
    cell: &'a Cell,
}

impl SceneNames<'_> {
    /// The geometries of a name: all solids of an object, or the link of this name of each robot.
    fn geometries(&self, name: &str) -> Vec<GeometryId> {
        let objects = self.objects.iter().filter(|(n, _)| *n == name).map(|(_, o)| GeometryId::Object(*o));
        let links = self.cell.robots.iter().enumerate().filter_map(|(i, r)| {
            let link = r.robot.chain.link(name)?;
            Some(GeometryId::Link { robot: RobotId(i), link })
        });
        objects.chain(links).collect()
    }

    /// The names of all links and of the scene's objects.
    fn all(&self) -> impl Iterator<Item = &str> {
        let links = self.cell.robots.iter().flat_map(|r| r.robot.chain.links().iter().map(String::as_str));
        let mut names: Vec<&str> = self.objects.iter().map(|(name, _)| *name).chain(links).collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter()
    }

    /// False for links of different robots, which planning scenes do not cover, and for links that are not tested
    /// anyway.
    fn are_tested(&self, a: GeometryId, b: GeometryId) -> bool {
        match (a, b) {
            (GeometryId::Link { robot: r, link: a }, GeometryId::Link { robot: s, link: b }) => {
                r == s && a != b && self.cell.robots[r.0].robot.links_can_meet(a, b)
            }
            (GeometryId::Object(a), GeometryId::Object(b)) => a != b,
            _ => true,
        }
    }
}
