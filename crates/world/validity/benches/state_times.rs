//! Time per configuration: on proven edges, and for single configurations.
//!
//! `cargo bench -p elbowroom-validity --bench state_times -- ROBOT.urdf ROBOT.srdf [OBSTACLES]` prints a line for each
//! number of random obstacles. With `points:N` for `OBSTACLES` the obstacle is one cloud of N points.
//!
//! `state_times WORKLOAD.json ROBOT.urdf [ROBOT.srdf]` runs the workload that `cargo xtask planning --validity` wrote,
//! and prints one line of JSON.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

use std::path::Path;
use std::time::Instant;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::Random;
use elbowroom_validity::{CoveredRobot, ObstacleSet, Validity, ValidityChecker};
use serde_json::{Value, json};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// States per radian of an edge, as planners sample them.
const STATES_PER_RADIAN: f64 = 32.0;

/// Free edges and configurations.
#[derive(Default)]
struct Questions {
    edges: Vec<(Vec<f64>, Vec<f64>)>,
    states: Vec<Vec<f64>>,
}

/// Times, nanoseconds.
struct Times {
    per_state_on_edge: f64,
    per_state_alone: f64,
    blocks_per_edge: f64,
}

fn main() -> Result<()> {
    let words: Vec<String> = elbowroom_testkit::bench::arguments().collect();
    let first = words.first().ok_or("a URDF file or a workload is missing")?;
    if Path::new(first).extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        return workload(first, words.get(1).ok_or("a URDF file is missing")?, words.get(2));
    }
    let robot = robot(first, words.get(1))?;
    match words.get(2).map(String::as_str) {
        None => [10, 100, 1000].into_iter().try_for_each(|n| random_scene(&robot, n, false)),
        Some(word) => match word.strip_prefix("points:") {
            Some(points) => random_scene(&robot, points.parse()?, true),
            None => random_scene(&robot, word.parse()?, false),
        },
    }
}

fn robot(urdf: &str, srdf: Option<&String>) -> Result<Robot> {
    let options = LoadOptions { srdf: srdf.map(Into::into), ..LoadOptions::default() };
    Ok(load(urdf.as_ref(), &options)?.robot)
}

/// Measures random obstacles, with random edges of one radian that are free among them.
fn random_scene(robot: &Robot, count: usize, is_cloud: bool) -> Result<()> {
    let covered = CoveredRobot::new(robot, Pose::IDENTITY)?;
    let mut random = Random(7);
    let mut place = || {
        let (angle, radius, height) = (random.between(-3.1, 3.1), random.between(0.45, 1.0), random.between(0.0, 1.1));
        Vec3::new(radius * f64::cos(angle), radius * f64::sin(angle), height)
    };
    let places: Vec<Vec3> = (0..count).map(|_| place()).collect();
    let mut obstacles = ObstacleSet::default();
    if is_cloud {
        // A wall and a table as seen by a camera: points on surfaces, one centimetre apart.
        let surface = |p: &Vec3| if p.x > 0.0 { Vec3::new(0.8, p.y, p.z) } else { Vec3::new(p.x, p.y, -0.1) };
        let points: Vec<Vec3> = places.iter().map(surface).collect();
        let mut least = f64::INFINITY;
        for _ in 0..20 {
            let begin = Instant::now();
            obstacles = ObstacleSet::default();
            obstacles.add_points(&points, 0.01);
            std::hint::black_box(ValidityChecker::new(&covered, &obstacles));
            least = least.min(begin.elapsed().as_secs_f64());
        }
        println!("{count:>5} points taken in within {:.2} ms", least * 1e3);
    } else {
        let size = if count > 100 { 0.02 } else { 0.05 };
        for (i, &at) in places.iter().enumerate() {
            let shape = if i % 2 == 0 {
                Shape::Sphere(Sphere { radius: size })
            } else {
                Shape::Cuboid(Cuboid { half_extents: Vec3::splat(size) })
            };
            obstacles.add_shape(&shape, &Pose::from_translation(at), 0.0);
        }
    }
    let mut checker = ValidityChecker::new(&covered, &obstacles);
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let mut q = || -> Vec<f64> {
        let ends = lower.iter().zip(&upper);
        ends.map(|(&l, &u)| if l.is_finite() { random.between(l, u) } else { random.between(-3.2, 3.2) }).collect()
    };
    let mut questions = Questions::default();
    let mut tried = 0;
    while questions.edges.len() < 2000 && tried < 400_000 {
        tried += 1;
        let (a, b) = (q(), q());
        let length = distance(&a, &b);
        let to: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x + (y - x) / length).collect();
        // An edge that takes a slide beyond its limits is not measured.
        if checker.edge_is_free(&a, &to)? {
            questions.edges.push((a.clone(), to));
        }
        if checker.state(&a)? == Validity::Free && questions.states.len() < 2000 {
            questions.states.push(a);
        }
    }
    let states_on_edges = STATES_PER_RADIAN * questions.edges.len() as f64;
    let times = measure(&mut checker, &questions, states_on_edges)?;
    println!(
        "{count:>5} obstacles: {:.1} ns per state on an edge ({:.2} blocks per edge, {} edges of {tried}), {:.0} ns alone",
        times.per_state_on_edge,
        times.blocks_per_edge,
        questions.edges.len(),
        times.per_state_alone
    );
    Ok(())
}

/// Measures the medians of several rounds.
fn measure(checker: &mut ValidityChecker<'_>, questions: &Questions, states_on_edges: f64) -> Result<Times> {
    let before = checker.blocks();
    for (a, b) in &questions.edges {
        checker.edge_is_free(a, b)?;
    }
    let blocks = checker.blocks() - before;
    let on_edges = median_s(|| {
        for (a, b) in &questions.edges {
            std::hint::black_box(checker.edge_is_free(a, b)?);
        }
        Ok(())
    })?;
    let alone = median_s(|| {
        for a in &questions.states {
            std::hint::black_box(checker.state(a)?);
        }
        Ok(())
    })?;
    Ok(Times {
        per_state_on_edge: on_edges / states_on_edges * 1e9,
        per_state_alone: alone / questions.states.len() as f64 * 1e9,
        blocks_per_edge: blocks as f64 / questions.edges.len() as f64,
    })
}

/// Processor time of a task, s: the median of several rounds, each of which repeats the task for at least a tenth of a
/// second.
fn median_s(mut task: impl FnMut() -> Result<()>) -> Result<f64> {
    const ROUNDS: usize = 7;
    const ROUND_S: f64 = 0.1;
    let mut seconds = Vec::new();
    for _ in 0..ROUNDS {
        let (begin, mut repeats) = (Instant::now(), 0_u32);
        let before = processor_s();
        while repeats == 0 || begin.elapsed().as_secs_f64() < ROUND_S {
            task()?;
            repeats += 1;
        }
        let elapsed = begin.elapsed().as_secs_f64();
        let spent = before.zip(processor_s()).map_or(elapsed, |(before, after)| after - before);
        seconds.push(spent / f64::from(repeats));
    }
    seconds.sort_by(f64::total_cmp);
    Ok(seconds[ROUNDS / 2])
}

/// Processor time of this thread so far, s; `None` if the system does not report it.
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|ns| ns * 1e-9)
}

/// Reads a workload, drops the parts that are not found free, and prints the times.
fn workload(path: &str, urdf: &str, srdf: Option<&String>) -> Result<()> {
    let document: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let list = |name: &str| document[name].as_array().cloned().ok_or(format!("{path}: no list `{name}`"));
    let robot = robot(urdf, srdf)?;
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY)?;
    let mut obstacles = ObstacleSet::default();
    for obstacle in list("obstacles")? {
        add(&mut obstacles, &obstacle)?;
    }
    let order = JointOrder::new(&robot, &document)?;
    let mut checker = ValidityChecker::new(&covered, &obstacles);
    let mut questions = Questions::default();
    let (edges, states) = (list("edges")?, list("states")?);
    let mut states_on_edges = 0.0;
    for edge in &edges {
        let (given_a, given_b) = (numbers(&edge[0])?, numbers(&edge[1])?);
        let (a, b) = (order.q(&given_a)?, order.q(&given_b)?);
        if checker.edge_is_free(&a, &b)? {
            states_on_edges += (STATES_PER_RADIAN * distance(&given_a, &given_b)).ceil();
            questions.edges.push((a, b));
        }
    }
    for state in &states {
        let q = order.q(&numbers(state)?)?;
        if checker.state(&q)? == Validity::Free {
            questions.states.push(q);
        }
    }
    let (free_edges, free_states) = (questions.edges.len(), questions.states.len());
    eprintln!("{free_edges} of {} edges and {free_states} of {} states are proven free", edges.len(), states.len());
    let times = measure(&mut checker, &questions, states_on_edges)?;
    println!(
        "{}",
        json!({
            "lib": "elbowroom",
            "obstacles": obstacles.len(),
            "ns_per_state_edge": times.per_state_on_edge,
            "ns_per_state_single": times.per_state_alone,
        })
    );
    Ok(())
}

/// Source of each value of a configuration: an index in the workload's values, or a constant.
struct JointOrder(Vec<std::result::Result<usize, f64>>);

impl JointOrder {
    /// By the names in `joints` and the values in `fixed`. Without `joints`, the values are those of the robot, in its
    /// order.
    fn new(robot: &Robot, document: &Value) -> Result<Self> {
        let Some(names) = document["joints"].as_array() else {
            return Ok(Self((0..robot.chain.dof()).map(Ok).collect()));
        };
        let source = |name: &str| {
            let place = names.iter().position(|n| n.as_str() == Some(name)).map(Ok);
            place.or_else(|| document["fixed"][name].as_f64().map(Err)).ok_or(format!("no value for joint `{name}`"))
        };
        let joints = robot.chain.active_joints().iter();
        let order = joints.map(|j| source(&robot.chain.joints()[j.0].name)).collect::<std::result::Result<_, _>>();
        Ok(Self(order?))
    }

    fn q(&self, given: &[f64]) -> Result<Vec<f64>> {
        let value = |source: &std::result::Result<usize, f64>| match *source {
            Ok(i) => given.get(i).copied(),
            Err(constant) => Some(constant),
        };
        self.0.iter().map(value).collect::<Option<_>>().ok_or_else(|| "a configuration has too few values".into())
    }
}

fn add(obstacles: &mut ObstacleSet, given: &Value) -> Result<()> {
    let centre = vec3(&given["centre"])?;
    let (shape, rotation) = match given["type"].as_str() {
        Some("sphere") => {
            let radius = given["radius"].as_f64().ok_or("a sphere without `radius`")?;
            (Shape::Sphere(Sphere { radius }), Rotation::IDENTITY)
        }
        Some("box") => {
            let turn = numbers(&given["quat_wxyz"])?;
            let [w, x, y, z] = turn[..] else { return Err("`quat_wxyz` has four numbers".into()) };
            let (vector, half) = (Vec3::new(x, y, z), vec3(&given["half"])?);
            let angle = 2.0 * vector.length().atan2(w);
            let rotation = Rotation::from_axis_angle(vector.try_normalize().unwrap_or(Vec3::Z), angle);
            (Shape::Cuboid(Cuboid { half_extents: half }), rotation)
        }
        other => return Err(format!("obstacles are spheres and boxes, not {other:?}").into()),
    };
    obstacles.add_shape(&shape, &Pose::new(rotation, centre), 0.0);
    Ok(())
}

fn vec3(value: &Value) -> Result<Vec3> {
    let found = numbers(value)?;
    let [x, y, z] = found[..] else { return Err(format!("not three numbers: {value}").into()) };
    Ok(Vec3::new(x, y, z))
}

fn numbers(value: &Value) -> Result<Vec<f64>> {
    let list = value.as_array().ok_or_else(|| format!("not a list: {value}"))?;
    list.iter().map(Value::as_f64).collect::<Option<_>>().ok_or_else(|| format!("not numbers: {value}").into())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}
