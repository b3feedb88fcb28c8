//! Rare features of cells. Each of the first cells has one of them.

use elbowroom_cell::Cell;
use elbowroom_spatial::Vec3;

use super::planned::MAPPED;
use super::region::point_on_the_path;
use super::settings::Places;
use super::{any_robot, goals};
use crate::fuzz_cells::oracle;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellFile, CellSpec, ExtraKey, Model, RobotSpec, SceneBox, SceneSpec, StepSpec, Turns};

/// Number of features of cells.
const OF_CELLS: u64 = 7;

/// Lets moves of robots with six joints end at poses, near the joint values or in their configuration.
pub fn goals(spec: &mut CellSpec, cell: &Cell, random: &mut Random) {
    let (near, chosen) = (random.rare(2, any_robot::OF_MODELS, 30), random.rare(3, any_robot::OF_MODELS, 30));
    let is_near = near.is_some();
    if near.or(chosen).is_some() {
        goals::some(spec, cell, is_near);
    }
}

/// Adds keys, a scene and the form of poses to a cell.
pub fn of_cell(spec: &mut CellSpec, is_scene_free: bool, places: &Places<'_>, random: &mut Random) {
    let rare: Vec<Option<Random>> = (0..5).map(|slot| random.rare(slot, OF_CELLS, 5)).collect();
    let [name, checksum, pairs, limits, scene] = rare.try_into().expect("there are five");
    // The judge takes long for meshes.
    if random.is_first() && spec.robots.iter().any(|robot| matches!(robot.model, Model::File(_))) {
        spec.max_s = spec.max_s.min(3.0);
    }
    if name.is_some() {
        spec.extras.head.push("name = \"random cell\"".into());
    }
    if pairs.is_some() {
        add_pairs(spec);
    }
    if let Some(mut r) = limits {
        for region in spec.regions.iter_mut().filter(|region| region.follow.is_some()) {
            region.limits = Some((r.scaled(0.5, 100.0), r.scaled(0.5, 100.0)));
        }
    }
    if let Some(mut r) = scene.filter(|_| is_scene_free) {
        far_scene(spec, &mut r);
    }
    let mixed = random.rare(5, OF_CELLS, 20).map(|mut r| Turns::Mixed(r.whole(0, 1)));
    let all = random.rare(6, OF_CELLS, 20).map(|_| Turns::Quaternions);
    spec.extras.turns = mixed.or(all).unwrap_or(spec.extras.turns);
    // It is that of the whole cell, so it comes last.
    if checksum.is_some()
        && let Ok(cell) = spec.parse(places.cells)
    {
        spec.extras.head.push(format!("checksum = \"{}\"", cell.approval.checksum));
    }
}

/// Adds a file of pairs: some are tested first, and a floor may be touched.
fn add_pairs(spec: &mut CellSpec) {
    let mut rows = String::from("  { a = \"r0\", b = \"*\", state = \"tested\", weight = 5 },\n");
    if spec.objects.iter().any(|object| object.name == "floor") {
        rows += "  { a = \"r0\", b = \"floor\", reason = \"it is soft\" },\n";
    }
    let file = CellFile::new("pairs", "toml", format!("version = 1\npairs = [\n{rows}]\n"));
    spec.extras.head.push(format!("pairs = \"{}\"", file.name));
    spec.extras.files.push(file);
}

/// Adds a scene that nothing reaches, in part at a link of the first robot.
fn far_scene(spec: &mut CellSpec, random: &mut Random) {
    let link = match &spec.robots[0].model {
        Model::Dh { .. } => "link_1",
        Model::File(_) => "world",
    };
    let (pallet, allowed) = (a_box("pallet", "table", [6.0, 0.0, 0.0], random), random.percent(50));
    // A link of several robots is not known.
    let at = if spec.robots.len() == 1 { link } else { "world" };
    spec.extras.turns = random.one(&[Turns::Rpy, Turns::Quaternions]);
    let crate_box = a_box("box", at, [0.0, 7.0, 5.0], random);
    spec.extras.scenes.push(SceneSpec {
        name: "hall".into(),
        at: random.vector(0.5),
        rpy: random.vector(3.0),
        frame: (at != "world").then(|| "table".into()),
        boxes: if at == "world" { vec![crate_box] } else { vec![pallet, crate_box] },
        allowed: if allowed { vec![["box".into(), link.into()]] } else { Vec::new() },
        heeds_allowed: Some(allowed),
    });
}

/// Makes a box about a place in a frame.
pub fn a_box(name: &str, frame: &str, place: [f64; 3], random: &mut Random) -> SceneBox {
    let (axis, angle) = (random.vector(1.0), random.between(-3.0, 3.0));
    let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-3);
    let (sin, cos) = (0.5 * angle).sin_cos();
    let [x, y, z] = axis.map(|v| v / length * sin);
    let turn = if length > 0.1 { [x, y, z, cos] } else { [0.0, 0.0, 0.0, 1.0] };
    let size = std::array::from_fn(|_| random.between(0.05, 0.4));
    let near = random.vector(0.2);
    let at = std::array::from_fn(|i| rounded(place[i] + near[i]));
    SceneBox { name: name.into(), size, at, turn, frame: frame.into() }
}

/// Adds a scene with a box near the tool of a guided robot.
pub fn scene_at(spec: &mut CellSpec, tool: Vec3, places: &Places<'_>, random: &mut Random) {
    let Some(mut r) = random.rare(1, 3, 15) else { return };
    let (frame, heeds_allowed) = (None, None);
    let boxes = vec![a_box("scene box", "world", tool.to_array(), &mut r)];
    let scene = SceneSpec {
        name: "hall".into(),
        at: [0.0; 3],
        rpy: [0.0; 3],
        frame,
        boxes,
        allowed: Vec::new(),
        heeds_allowed,
    };
    let mut with = spec.clone();
    with.extras.scenes.push(scene);
    if with.parse(places.cells).is_ok_and(|cell| oracle::is_clear_at_start(&cell, 0.005)) {
        *spec = with;
    }
}

/// Adds boxes of a scene beside the path of the first robot, if its moves neither begin nor end at one.
pub fn near_scene(spec: &mut CellSpec, places: &Places<'_>, random: &mut Random) {
    let Some(mut r) = random.rare(1, 3, 30) else { return };
    // The meshes of other robots take too long.
    if !matches!(spec.robots[0].model, Model::Dh { .. }) {
        return;
    }
    let Ok(cell) = spec.parse(places.cells) else { return };
    for i in 0..r.whole(1, 3) {
        let Some(place) = point_on_the_path(spec, &cell, 0, &mut r) else { return };
        let one = a_box(&format!("box{i}"), "world", place, &mut r);
        let mut with = spec.clone();
        match with.extras.scenes.first_mut() {
            Some(scene) => scene.boxes.push(one),
            None => with.extras.scenes.push(SceneSpec {
                name: "hall".into(),
                at: [0.0; 3],
                rpy: [0.0; 3],
                frame: None,
                // What may touch by the scene is tested all the same.
                allowed: vec![[one.name.clone(), "link_1".into()]],
                heeds_allowed: Some(false),
                boxes: vec![one],
            }),
        }
        if is_clear_at_rest(&with, places) {
            *spec = with;
        }
    }
}

/// Whether the first robot is clear of everything wherever it rests.
fn is_clear_at_rest(spec: &CellSpec, places: &Places<'_>) -> bool {
    let Ok(mut cell) = spec.parse(places.cells) else { return false };
    rests(spec).all(|q| {
        cell.robots[0].start.clone_from(q);
        oracle::is_clear_at_start(&cell, 0.005)
    })
}

/// The joint values at which the first robot rests.
fn rests(spec: &CellSpec) -> impl Iterator<Item = &Vec<f64>> {
    let robot = &spec.robots[0];
    std::iter::once(&robot.start).chain(robot.program.steps.iter().filter_map(StepSpec::target))
}

/// Adds the table of the map of a robot that plans on it.
pub fn map(spec: &mut CellSpec, random: &mut Random) {
    let on_map = |robot: &RobotSpec| {
        robot.program.steps.iter().any(|step| matches!(step, StepSpec::Planned { on_map: true, .. }))
    };
    for (i, robot) in spec.robots.iter().enumerate().filter(|(_, robot)| on_map(robot)) {
        let Some(mut r) = random.rare(0, 1, 50) else { continue };
        let names = robot.joint_names();
        let Some(three) = names.get(..MAPPED) else { continue };
        let steps: [f64; 3] = std::array::from_fn(|_| r.between(0.1, 0.3));
        let others = r.one(&["any", "start", "start"]);
        let lines = [format!("joints = {three:?}"), format!("step = {steps:?}"), format!("others = \"{others}\"")];
        spec.extras.tables.push(format!("[map.r{i}]\n{}\n", lines.join("\n")));
    }
}

/// Adds the built-in rules, from their file, to a robot that evades.
pub fn rules(spec: &mut CellSpec, random: &mut Random) {
    for (i, _) in spec.robots.iter().enumerate().filter(|(_, robot)| !robot.evades.is_empty()) {
        if random.rare(0, 1, 50).is_some() {
            spec.extras.keys.push(ExtraKey { table: format!("avoidance.r{i}"), line: "rules = \"rules.toml\"".into() });
        }
    }
}
