//! `[scene.NAME]`: the objects of a planning scene of `MoveIt`.

use std::collections::HashSet;
use std::ops::Range;

use elbowroom_formats::planning_scene::{self, FixedFrame, PlanningScene};
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::ChainState;
use elbowroom_scene::Object;
use elbowroom_spatial::Pose;

use super::models;
use super::schema::{SCENE, names};
use crate::scene_pairs::ScenePairs;
use crate::{Cell, CellRobot};

type Result<T> = std::result::Result<T, Diagnostic>;

/// The frame that a scene is placed by, unless `frame` names another.
const WORLD: &str = "world";

/// Adds the objects of all scenes to the cell, after its own objects. Returns the range of objects of each table.
pub(super) fn read(root: &Table<'_>, cell: &mut Cell, warnings: &mut Vec<Diagnostic>) -> Result<Vec<Range<usize>>> {
    let mut ranges = Vec::new();
    for (_, t) in root.named("scene")? {
        let (scene, objects) = add(&t, cell)?;
        if t.flag_or("allowed_collisions", true)? {
            allow(&scene, &objects, cell, warnings);
        }
        report_unused(&scene, warnings);
        warnings.extend(scene.warnings);
        ranges.push(objects);
    }
    Ok(ranges)
}

/// Exempts the pairs that the scene allows from tests, unless the cell's file of pairs states otherwise.
fn allow(scene: &PlanningScene, objects: &Range<usize>, cell: &mut Cell, warnings: &mut Vec<Diagnostic>) {
    let pairs = ScenePairs::of(scene, objects, cell);
    let mut warn = |what: String, hint: &str| warnings.push(Diagnostic::new(&scene.file, None, what).hint(hint));
    if let Some([a, b]) = &pairs.example {
        let what = format!(
            "`allowed_collision_matrix` is applied: {} of its pairs are not tested, such as `{a}` and `{b}`",
            pairs.count
        );
        warn(what, "allowed_collisions = false in the table of the scene, to test them");
    }
    if let Some([a, b]) = &pairs.ambiguous {
        let what =
            format!("`{a}` and `{b}` may touch by the scene, but several robots have such a link: they are tested");
        warn(what, &format!("pairs = \"pairs.toml\" with {{ a = \"ROBOT/{a}\", b = \"{b}\", reason = \"…\" }}"));
    }
    cell.pair_rules.given.extend(pairs.rules);
}

fn add(t: &Table<'_>, cell: &mut Cell) -> Result<(PlanningScene, Range<usize>)> {
    t.only(&names(&[SCENE]))?;
    let file = t.need("file", "file = \"workshop.scene\"")?;
    let scene = planning_scene::read(&models::path(&file)?)?;
    refuse_attached(&scene)?;
    let place = cell.units.place(t)?;
    let frame = t.get("frame").map_or(Ok(WORLD), |v| placed_frame(&v, &scene))?;
    let frames = SceneFrames { scene: &scene, frame, place, robots: &cell.robots };
    let mut objects = Vec::new();
    for object in &scene.objects {
        let frame_in_world = frames.in_world(&object.frame, &object.id, &file)?;
        let solids = object.named_solids();
        objects.extend(solids.map(|(name, shape, pose)| Object {
            name: name.replace(['/', ',', '"', '\n', '\r'], "_"),
            shape: shape.clone(),
            in_world: frame_in_world * *pose,
        }));
    }
    refuse_known_names(&objects, cell, &file)?;
    let first = cell.objects.len();
    cell.objects.extend(objects);
    Ok((scene, first..cell.objects.len()))
}

/// Refuses a scene with an object that a robot holds, which would be left out.
fn refuse_attached(scene: &PlanningScene) -> Result<()> {
    let Some(attached) = scene.attached.first() else { return Ok(()) };
    let what =
        format!("`{}` is attached to the link `{}`, and a scene has fixed objects", attached.object.id, attached.link);
    let hint = "no `attached_collision_objects`; in the cell file [robot.NAME] load = { box = { at = [0, 0, 350], size = [200, 200, 200] } }";
    Err(Diagnostic::new(&scene.file, None, what).hint(hint))
}

/// The frame of the file that `at` and `rpy` place.
fn placed_frame<'v>(v: &Value<'v>, scene: &PlanningScene) -> Result<&'v str> {
    let name = v.text()?;
    let fixed = scene.frames.iter().flat_map(|f| [&f.name, &f.parent]);
    let known: HashSet<&str> = scene.objects.iter().map(|o| &o.frame).chain(fixed).map(String::as_str).collect();
    if known.contains(name) || name == WORLD {
        return Ok(name);
    }
    let mut known: Vec<&str> = known.into_iter().filter(|name| !name.is_empty()).chain([WORLD]).collect();
    known.sort_unstable();
    let what = format!("names the frame \"{name}\", which nothing in {} refers to", scene.file.display());
    Err(v.error(what).hint(suggest::hint(name, known.into_iter())))
}

/// The frames of a scene in the cell.
struct SceneFrames<'a> {
    scene: &'a PlanningScene,
    /// The frame that the cell file places.
    frame: &'a str,
    place: Pose,
    robots: &'a [CellRobot],
}

impl SceneFrames<'_> {
    /// The pose of the frame of an object.
    fn in_world(&self, name: &str, object: &str, file: &Value<'_>) -> Result<Pose> {
        let is_placed = |name: &str| name.is_empty() || name == self.frame;
        let is_known = |name: &str| is_placed(name) || self.links(name).next().is_some();
        let (name, pose) = FixedFrame::ancestor(&self.scene.frames, name, is_known);
        if is_placed(name) {
            return Ok(self.place * pose);
        }
        let mut links = self.links(name);
        let wrong = |what: &str| {
            let what = format!("has the object \"{object}\" in the frame \"{name}\", {what}");
            file.error(what).hint(format!("frame = \"{name}\"   (placed by at and rpy)"))
        };
        match (links.next(), links.next()) {
            (Some(link), None) => Ok(link * pose),
            (Some(_), Some(_)) => Err(wrong("which is a link of several robots")),
            (None, _) => Err(wrong("which is neither a link of a robot nor one of `fixed_frame_transforms`")),
        }
    }

    /// Start poses of the links of this name.
    fn links<'s>(&'s self, name: &'s str) -> impl Iterator<Item = Pose> + 's {
        self.robots.iter().filter_map(move |r| {
            let chain = &r.robot.chain;
            let link = chain.link(name)?;
            let mut state = ChainState::new(chain);
            state.q.copy_from_slice(&r.start);
            chain.forward(&mut state);
            Some(r.base_in_world * state.link_in_root(link))
        })
    }
}

fn refuse_known_names(objects: &[Object], cell: &Cell, file: &Value<'_>) -> Result<()> {
    let robots = cell.robots.iter().map(|r| r.name.as_str());
    let mut known: HashSet<&str> = robots.chain(cell.objects.iter().map(|o| o.name.as_str())).collect();
    let Some(same) = objects.iter().find(|o| !known.insert(o.name.as_str())) else { return Ok(()) };
    let what = format!("has an object \"{}\", and the cell has an object or robot of that name", same.name);
    Err(file.error(what).hint("another name in one of the two files"))
}

/// Warns of contents of a scene that a cell does not use.
fn report_unused(scene: &PlanningScene, warnings: &mut Vec<Diagnostic>) {
    if !scene.joints.is_empty() || scene.base_in_world.is_some() {
        let what = "`robot_state` is not applied: robots are where the cell file has them".to_owned();
        let hint = "[robot.NAME] start = [0, 0, 0, 0, 0, 0], base = { at = [0, 0, 0] }";
        warnings.push(Diagnostic::new(&scene.file, None, what).hint(hint));
    }
}
