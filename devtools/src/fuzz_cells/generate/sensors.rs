//! Cameras, pictures of depths and clouds of points that see boxes on the paths of robots.

use std::f64::consts::PI;

use elbowroom_cell::Cell;

use super::planned::MAPPED;
use super::region::point_on_the_path;
use super::robot;
use super::settings::Places;
use crate::fuzz_cells::oracle;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{
    CellFile, CellSpec, LensSpec, Model, PictureTimes, RobotSpec, SeenBox, SensorSpec, SensorView, Vector, list,
};

/// Every 40th of the first cells has the same kind of sensor, and every 8th of those with planned moves, half of which are
/// refused.
const OF_SENSORS: [u64; 2] = [40, 8];
/// The slots of points, depths and cameras among them.
const SLOTS: [u64; 3] = [2, 5, 7];
/// Percentage of later cells with each kind of sensor.
const PERCENT: u32 = 4;
/// Tries to make a robot of so many joints, or to find a place for a box.
const TRIES: usize = 16;
/// Least distance of most boxes from all robots at the start, m.
const CLEAR_M: f64 = 0.2;
/// Longest time that pictures cover, s.
const MOST_S: f64 = 10.0;
/// The lenses of pictures of depths, and of cameras.
const DEPTHS: LensSpec = LensSpec { columns: 64, rows: 48, focal: 45.0 };
const CAMERA: LensSpec = LensSpec { columns: 160, rows: 120, focal: 110.0 };

/// What a sensor sees with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Eye {
    Points,
    Depths,
    Camera,
}

/// Adds a sensor to some cells.
pub fn some(spec: &mut CellSpec, is_planned: bool, places: &Places<'_>, random: &mut Random) {
    let has_all_keys = random.is_first();
    let of = OF_SENSORS[usize::from(is_planned)];
    let eyes = [Eye::Points, Eye::Depths, Eye::Camera].into_iter().zip(SLOTS);
    let drawn: Vec<(Eye, Option<Random>)> = eyes.map(|(eye, slot)| (eye, random.rare(slot, of, PERCENT))).collect();
    let Some((eye, mut r)) = drawn.into_iter().find_map(|(eye, r)| Some((eye, r?))) else { return };
    let mut with = spec.clone();
    if let Some(sensor) = sensor(&mut with, eye, has_all_keys, places, &mut r) {
        with.extras.sensors.push(sensor);
        *spec = with;
    }
}

fn sensor(
    spec: &mut CellSpec,
    eye: Eye,
    has_all_keys: bool,
    places: &Places<'_>,
    random: &mut Random,
) -> Option<SensorSpec> {
    let mapped = mapped_robot(spec, places, random)?;
    let cell = spec.parse(places.cells).ok()?;
    let avoiding = avoiding(spec, random);
    let learning = if eye == Eye::Camera { random.whole(2, 4) } else { random.whole(0, 3) };
    let (boxes, floor) = boxes(spec, &cell, (&avoiding, eye), learning > 0, random)?;
    let highest = boxes.iter().map(|b| b.at[2] + b.size[2]).fold(floor, f64::max);
    let middle = |k: usize| boxes.iter().map(|b| b.at[k]).sum::<f64>() / boxes.len().max(1) as f64;
    let at = [middle(0), middle(1), highest + random.between(3.5, 6.0)].map(rounded);
    let latency_ms = random.whole(0, 150) as f64;
    let times = times(spec, learning, latency_ms / 1e3, random);
    let (period_s, last_s) = (times.get(1)? - times[0], *times.last()?);
    let stale_ms = if random.percent(40) { 200e3 } else { latency_ms + 1e3 * period_s * random.between(1.0, 4.0) };
    let unusable = match random.whole(0, 3) {
        0 => (0..random.whole(1, 8)).map(|_| random.whole(learning, times.len() - 1)).collect(),
        _ => Vec::new(),
    };
    let needed = needed(&boxes, (eye, highest - floor), random);
    let lines = lines(&boxes, (eye, floor, at), has_all_keys, random);
    let view = match eye {
        Eye::Points => SensorView::Points { spacing: voxel(&boxes) / 2.2, is_ply: random.percent(50) },
        Eye::Depths => SensorView::Depths { lens: DEPTHS, step: random.one(&[0.001, 0.002]) },
        Eye::Camera => SensorView::Camera { lens: CAMERA },
    };
    // Robots that swing while the empty cell is learnt would hide what is learnt.
    let swings = (has_all_keys || random.percent(50)) && !boxes.iter().any(|one| one.is_learnt);
    let joints = (learning > 0 && swings).then(|| joints(spec, &times[..learning], random)).flatten();
    let yaw = random.between(-PI, PI);
    let rpy = if eye == Eye::Points { random.vector(3.0) } else { [rounded(PI), 0.0, yaw] };
    // Robots are held when the last picture is old: programs need not end.
    spec.max_s = spec.max_s.min(last_s + if random.percent(30) { 4.0 } else { 0.3 });
    Some(SensorSpec {
        name: "above",
        view,
        at,
        rpy,
        floor,
        mapped,
        avoiding,
        latency_ms,
        stale_ms: rounded(stale_ms),
        pictures: PictureTimes { learning, times, unusable },
        boxes,
        joints,
        needed,
        lines,
    })
}

/// The robot whose map has the obstacles: one with three joints or more, which is added if there is none.
fn mapped_robot(spec: &mut CellSpec, places: &Places<'_>, random: &mut Random) -> Option<usize> {
    let has_map = |robot: &RobotSpec| {
        matches!(robot.model, Model::Dh { .. }) && robot.start.len() >= MAPPED && !robot.is_mechanism
    };
    let found = spec.robots.iter().position(has_map);
    if found.is_none() {
        let mut watcher = (0..TRIES).map(|_| robot::arm(random)).find(has_map)?;
        watcher.at = [random.between(-1.0, 1.0), 6.0, random.between(-1.0, 1.0)];
        spec.robots.push(watcher);
        let cell = spec.parse(places.cells).ok()?;
        if (0..cell.regions.len()).any(|region| oracle::start_distance(&cell, region) <= 0.0) {
            return None;
        }
    }
    let index = found.unwrap_or(spec.robots.len() - 1);
    let head = format!("[map.r{index}]");
    let Model::Dh { rows, .. } = &spec.robots[index].model else { return None };
    if !spec.extras.tables.iter().any(|table| table.starts_with(&head)) {
        let joints = &spec.robots[index].joint_names()[..MAPPED];
        let steps: Vec<f64> =
            rows[..MAPPED].iter().map(|row| rounded((row.max - row.min) / random.between(8.0, 24.0))).collect();
        let others = random.one(&["any", "any", "start"]);
        let lines = format!("joints = {joints:?}\nstep = {}\nothers = \"{others}\"\n", list(&steps));
        spec.extras.tables.push(format!("{head}\n{lines}"));
    }
    Some(index)
}

/// The robots that avoid what the sensor sees: mostly all that can.
fn avoiding(spec: &CellSpec, random: &mut Random) -> Vec<usize> {
    let can_avoid = |robot: &RobotSpec| !robot.is_mechanism && robot.evades.is_empty() && robot.hand.tools.is_empty();
    let mut avoiding: Vec<usize> = (0..spec.robots.len()).filter(|i| can_avoid(&spec.robots[*i])).collect();
    if random.percent(20) && avoiding.len() > 1 {
        avoiding.remove(random.whole(0, avoiding.len() - 1));
    }
    avoiding
}

/// Makes boxes on the paths of these robots, and the height of the floor below them; `None` without robots.
fn boxes(
    spec: &CellSpec,
    cell: &Cell,
    (avoiding, eye): (&[usize], Eye),
    can_learn: bool,
    random: &mut Random,
) -> Option<(Vec<SeenBox>, f64)> {
    let first = *avoiding.first()?;
    let mut boxes: Vec<SeenBox> = Vec::new();
    for _ in 0..random.whole(1, 3) {
        let robot = if random.percent(70) { first } else { random.one(avoiding) };
        boxes.extend(seen_box(spec, cell, (robot, eye), can_learn, random));
    }
    let lowest = boxes.iter().map(|b| b.at[2]).reduce(f64::min).unwrap_or(0.0);
    let floor = rounded(lowest - random.between(0.2, 1.0));
    if eye == Eye::Camera {
        // It takes what it sees for things that stand on the floor.
        for one in &mut boxes {
            let top = one.at[2] + one.size[2];
            (one.at[2], one.size[2]) = (floor, rounded(top - floor));
        }
    }
    Some((boxes, floor))
}

/// Makes a box on the path of a robot, or somewhere beside it.
fn seen_box(
    spec: &CellSpec,
    cell: &Cell,
    (robot, eye): (usize, Eye),
    can_learn: bool,
    random: &mut Random,
) -> Option<SeenBox> {
    let least = if eye == Eye::Points { 0.1 } else { 0.4 };
    for _ in 0..TRIES {
        let place = point_on_the_path(spec, cell, robot, random).unwrap_or_else(|| random.vector(1.0));
        let size: Vector = std::array::from_fn(|_| random.scaled(least, 0.8));
        let at = [place[0], place[1], rounded(place[2] - 0.5 * size[2])];
        let standing = SeenBox {
            at,
            size,
            yaw: random.between(-PI, PI),
            from_s: f64::NEG_INFINITY,
            to_s: f64::INFINITY,
            velocity: [0.0; 2],
            is_learnt: false,
        };
        let from_s = random.between(0.0, 3.0);
        match random.whole(0, 9) {
            0 => {
                let to_s = if random.percent(50) { f64::INFINITY } else { from_s + random.between(0.3, 3.0) };
                return Some(SeenBox { from_s, to_s, ..standing });
            }
            1 => {
                let (speed, angle) = (random.scaled(0.05, 1.5), random.between(-PI, PI));
                let velocity = [angle.cos(), angle.sin()].map(|share| rounded(speed * share));
                let comes_s = random.between(0.0, 2.0);
                let at = [at[0] - velocity[0] * comes_s, at[1] - velocity[1] * comes_s, at[2]].map(rounded);
                return Some(SeenBox { at, from_s, to_s: from_s + 2.0 * comes_s + 0.5, velocity, ..standing });
            }
            // Points on robots are not learnt.
            2 if can_learn && oracle::is_clear_of_box(cell, &standing, CLEAR_M) => {
                return Some(SeenBox { is_learnt: true, ..standing });
            }
            _ if random.percent(5) || oracle::is_clear_of_box(cell, &standing, CLEAR_M) => return Some(standing),
            _ => {}
        }
    }
    None
}

/// Makes the times of the pictures: first of the empty cell, before the start, then mostly until the end.
fn times(spec: &CellSpec, learning: usize, latency_s: f64, random: &mut Random) -> Vec<f64> {
    let period_s = random.between(0.1, 0.4);
    let late_s = if random.percent(20) { random.between(0.0, 1.5) } else { -(1.0 + random.unit()) * period_s };
    let first_s = late_s - latency_s - learning as f64 * period_s;
    let end_s = if random.percent(25) { random.between(0.5, 4.0) } else { spec.max_s.min(MOST_S) };
    let count = ((end_s - first_s) / period_s).ceil().max(2.0) as usize + learning;
    (0..count).map(|i| rounded(first_s + i as f64 * period_s)).collect()
}

/// Side of the cubes in which points are counted, m.
fn voxel(boxes: &[SeenBox]) -> f64 {
    let longest = boxes.iter().flat_map(|b| b.size).fold(0.1, f64::max);
    rounded(longest / 7.0)
}

/// Lines of the table without which the sensor would not see its boxes, the highest of which ends at a height.
fn needed(boxes: &[SeenBox], (eye, height): (Eye, f64), random: &mut Random) -> Vec<String> {
    let (voxel, min_points) = match eye {
        // A pixel or two.
        Eye::Camera => return vec![format!("uncertainty = {}", random.between(0.1, 0.2))],
        Eye::Points => (voxel(boxes), random.whole(1, 2)),
        Eye::Depths => (0.2, 1),
    };
    // A small box may be in a single cube.
    let is_wide = boxes.iter().all(|one| one.size.into_iter().fold(0.0, f64::max) > 3.0 * voxel);
    let min_voxels = if is_wide { random.whole(1, 2) } else { 1 };
    let ceiling = rounded(height + random.between(0.2, 2.0));
    vec![
        format!("voxel = {voxel}\nmin_points = {min_points}\nmin_voxels = {min_voxels}"),
        format!("ceiling = {ceiling}"),
    ]
}

/// Lines of the table that any sensor may have.
fn lines(
    boxes: &[SeenBox],
    (eye, floor, [x, y, z]): (Eye, f64, Vector),
    has_all_keys: bool,
    random: &mut Random,
) -> Vec<String> {
    let mut lines = Vec::new();
    let mut some = |percent: u32, random: &mut Random, line: &dyn Fn(&mut Random) -> String| {
        if random.percent(percent) || has_all_keys {
            lines.push(line(random));
        }
    };
    // Half of what is in view on the floor.
    let half = match eye {
        Eye::Points => random.between(2.0, 6.0),
        Eye::Depths | Eye::Camera => rounded(0.4 * (z - floor) * CAMERA.rows as f64 / CAMERA.focal),
    };
    let corner = |dx: f64, dy: f64| [rounded(x + dx), rounded(y + dy)];
    let area = [corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)];
    some(50, random, &|_| format!("area = {area:?}"));
    some(30, random, &|r| format!("prediction = {}", r.between(0.0, 1.0)));
    some(30, random, &|r| format!("search_ms = {}", r.whole(50, 400)));
    some(30, random, &|r| format!("max_speed = {}", r.between(1.5, 6.0)));
    match eye {
        Eye::Camera => {
            some(30, random, &|r| format!("mask_margin = {}", r.between(0.0, 0.08)));
            some(20, random, &|r| format!("shadows = {}", r.percent(50)));
            some(40, random, &|r| templates(boxes, r));
        }
        Eye::Points | Eye::Depths => {
            some(40, random, &|r| format!("floor_thickness = {}", r.between(0.01, 0.15)));
            some(40, random, &|r| format!("mask_margin = {}", r.between(0.0, 0.1)));
            some(40, random, &|r| format!("uncertainty = {}", r.between(0.0, 0.1)));
            some(40, random, &|r| format!("to_floor = {}", r.percent(60)));
        }
    }
    lines
}

/// Templates of a box, and of something round that is not there.
fn templates(boxes: &[SeenBox], random: &mut Random) -> String {
    let of_box = |one: &SeenBox| {
        let [length, width, height] = one.size;
        format!(
            "{{ name = \"crate\", size = [{length}, {width}], height = {height}, tolerance = 0.12, height_tolerance = 0.05 }}"
        )
    };
    let drum = format!("{{ name = \"drum\", diameter = {}, height = 0.9 }}", random.between(1.2, 2.0));
    let all: Vec<String> = boxes.first().map(of_box).into_iter().chain([drum]).collect();
    format!("templates = [{}]", all.join(", "))
}

/// A file of joint values while the empty cell is learnt: the robots swing, so that the floor below them is seen.
fn joints(spec: &CellSpec, times: &[f64], random: &mut Random) -> Option<CellFile> {
    let (first_s, last_s) = (*times.first()?, *times.last()?);
    // Pictures of the run have the robots where the run has them.
    let last_s = last_s.min(-0.15);
    if first_s > last_s {
        return None;
    }
    let mut head = String::from("t_s");
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for (i, robot) in spec.robots.iter().enumerate() {
        let Model::Dh { rows, .. } = &robot.model else { return None };
        let of_robot = if spec.robots.len() > 1 { format!("r{i}.") } else { String::new() };
        for (name, row) in robot.joint_names().iter().zip(rows) {
            head.extend([",", &of_robot, name]);
            ranges.push((row.min, row.max));
        }
    }
    let row = |t_s: f64, random: &mut Random| {
        let values = ranges.iter().map(|(low, high)| random.between(*low, *high)).collect::<Vec<f64>>();
        [&[rounded(t_s)], &values[..]].concat()
    };
    let rows: Vec<Vec<f64>> =
        times.iter().filter(|t_s| **t_s < last_s).chain([&last_s]).map(|t_s| row(*t_s, random)).collect();
    Some(CellFile::csv("swing", &head, rows))
}
