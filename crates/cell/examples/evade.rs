//! Many runs of a cell with something that crosses its robot's way at random, with avoidance and without; the run's own
//! judge sweeps the exact scene from tick to tick.
//!
//! `cargo run --release -p elbowroom-cell --example evade -- [RUNS] [CELL]`
#![allow(clippy::print_stdout)]

use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_avoidance::Doing;
use elbowroom_cell::run::simulate;
use elbowroom_cell::{Cell, Drive, Recording, Repeat, RobotTrack, RunOptions, Way};
use elbowroom_scene::{Checker, Options, Scene, SceneState, Selection};
use elbowroom_spatial::{Pose, Vec3};

/// What comes keeps so far from the axis of the base, m: a pedestal cannot get out of the way.
const PEDESTAL_M: f64 = 1.0;
/// So far from the robot it begins, m.
const BEGINS_M: f64 = 0.8;
/// Slower than this share of its speed a joint stands.
const STANDS: f64 = 1e-4;

struct Random(u64);

impl Random {
    fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let runs: usize = arguments.next().map_or(Ok(100), |n| n.parse())?;
    let file = arguments.next().map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/pallet/cell.toml")),
        PathBuf::from,
    );
    let cell = Cell::load(file)?;
    let seen = cell.avoidance.first().and_then(Option::as_ref).ok_or("the first robot does not evade")?.objects.clone();
    let moves = |o: &&usize| cell.movers.iter().any(|m| m.object == **o);
    let object = *seen.iter().find(moves).ok_or("nothing that moves is evaded")?;
    let free = alone(&cell)?;
    println!("{}: {} robot(s), the program alone takes {:.2} s", cell.name, cell.robots.len(), free.duration_s);
    // One run alone, with what the robot did before it was hit.
    let only: Option<usize> = std::env::var("EVADE_ONLY").ok().and_then(|o| o.parse().ok());
    let mut random = Random(2026);
    let mut ways = Vec::new();
    let scene = alone_with(&cell, object)?;
    while ways.len() < runs {
        ways.extend(crossing(&cell, &scene, free.duration_s, &mut random)?);
    }
    let chosen: Vec<usize> = only.map_or_else(|| (0..runs).collect(), |o| vec![o.min(runs - 1)]);
    let mut tally = Tally { show: only.is_some(), quietest_s: f64::INFINITY, ..Tally::default() };
    for some in chosen.chunks(50) {
        for run in both(&cell, object, &ways, some)? {
            tally.add(&cell, &run);
        }
        eprintln!("{} runs: {} hit without, {} with", tally.runs, tally.hit_off, tally.hit_on);
    }
    tally.print();
    Ok(())
}

/// One way of the object, without avoidance and with it.
struct Pair {
    number: usize,
    off: Recording,
    on: Recording,
}

/// The chosen runs, on all cores, in order.
fn both(cell: &Cell, object: usize, ways: &[Way], chosen: &[usize]) -> Result<Vec<Pair>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut mine, mut cell) = (Vec::new(), cell.clone());
        while let Some(&number) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            let drive = Drive::Way(ways[number].clone());
            cell.movers.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = drive.clone());
            let run = |evasive| simulate(&cell, &RunOptions { evasive, ..RunOptions::default() });
            let pair = run(false).and_then(|off| Ok(Pair { number, off: off.recording, on: run(true)?.recording }));
            mine.push(pair.map_err(|e| e.to_string()));
        }
        mine
    };
    let all = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("a run does not panic")).collect::<Result<Vec<_>, String>>()
    });
    let mut all = all?;
    all.sort_by_key(|pair| pair.number);
    Ok(all)
}

/// The program with nothing in its way.
fn alone(cell: &Cell) -> Result<Recording, Box<dyn std::error::Error>> {
    let mut cell = cell.clone();
    for m in &mut cell.movers {
        let far = Vec3::new(100.0, 100.0, 100.0);
        m.rest_in_world.translation = far;
        m.drive = Drive::Way(Way::new(vec![far], 0.0, 0.0, Repeat::No, Vec3::ZERO));
    }
    let recording = simulate(&cell, &RunOptions::default())?.recording;
    let robot = &recording.robots[0];
    if !robot.finished || !robot.collisions.is_empty() {
        return Err(format!("the program does not run through by itself: {:?}", robot.collisions.first()).into());
    }
    Ok(recording)
}

/// The robot and what comes.
fn alone_with(cell: &Cell, object: usize) -> Result<Scene, Box<dyn std::error::Error>> {
    let mut builder = Scene::builder();
    let robot = &cell.robots[0];
    builder.robot(&robot.name, robot.robot.clone(), robot.base_in_world);
    builder.object(cell.objects[object].clone());
    Ok(builder.build()?)
}

/// A straight way through where the arm works; `None` where it would begin in the arm or cross the pedestal.
fn crossing(
    cell: &Cell,
    scene: &Scene,
    seconds: f64,
    random: &mut Random,
) -> Result<Option<Way>, Box<dyn std::error::Error>> {
    let base = cell.robots[0].base_in_world;
    let speed = random.range(0.1, 1.2);
    let (turn, climb) = (random.range(-PI, PI), random.range(-0.3, 0.3));
    let along = Vec3::new(turn.cos() * f64::cos(climb), turn.sin() * f64::cos(climb), f64::sin(climb));
    let (about, radius) = (random.range(-PI, PI), random.range(PEDESTAL_M, 2.6));
    let through = Vec3::new(radius * about.cos(), radius * about.sin(), random.range(0.6, 2.2));
    let when = random.range(0.1, 0.9) * seconds;
    let flat = Vec3::new(along.x, along.y, 0.0).try_normalize().ok_or("no direction")?;
    let miss = through.cross(flat).z.abs();
    let (from, to) = (through - along * (speed * when), through + along * (speed * seconds));
    let from = base.transform_point(from);
    let way = Way::new(vec![from, base.transform_point(to)], speed, 0.0, Repeat::No, Vec3::ZERO);
    if miss < PEDESTAL_M {
        return Ok(None);
    }
    let mut state = SceneState::new(scene);
    state.set_q(scene, 0, &cell.robots[0].start)?;
    state.place(scene, 0, Pose { translation: from, ..scene.objects()[0].in_world })?;
    let mut checker = Checker::new(scene, Options::default());
    let near = checker.between(Selection::Robot(0), Selection::Object(0)).within(&state, BEGINS_M);
    Ok(near.is_none().then_some(way))
}

#[derive(Default)]
struct Tally {
    runs: usize,
    hit_off: usize,
    hit_on: usize,
    resolved: usize,
    moving: usize,
    unfinished: usize,
    late_s: Vec<f64>,
    travel: Vec<f64>,
    nearest_m: Vec<f64>,
    step_us: Vec<f64>,
    /// Largest excess over a speed and a limit of a joint.
    over: [f64; 2],
    quietest_s: f64,
    plans: [usize; 2],
    show: bool,
}

impl Tally {
    fn add(&mut self, cell: &Cell, Pair { number, off, on }: &Pair) {
        self.runs += 1;
        let (without, with) = (&off.robots[0], &on.robots[0]);
        let (hit_off, hit_on) = (!without.collisions.is_empty(), !with.collisions.is_empty());
        self.hit_off += usize::from(hit_off);
        self.hit_on += usize::from(hit_on);
        if let Some(first) = with.collisions.first() {
            println!("run {number}: {} hits {} at {:.3} s, {} without avoidance", first.a, first.b, first.t_s, hit_off);
            if self.show {
                show(with, first.t_s);
            }
        }
        if !with.finished {
            println!("run {number}: not finished after {:.1} s", on.duration_s);
            if self.show {
                show(with, on.duration_s);
            }
            self.unfinished += 1;
        }
        let Some(track) = &with.avoidance else { return };
        if hit_off && !hit_on && with.finished {
            self.resolved += 1;
            self.moving += usize::from(!track.samples.iter().any(|s| s.doing == Doing::Waiting));
        }
        if !hit_on && with.finished {
            self.late_s.push(on.duration_s - off.duration_s);
            self.travel.push(travel(with) / travel(without));
        }
        self.nearest_m.push(track.samples.iter().map(|s| s.nearest_m).fold(f64::INFINITY, f64::min));
        self.step_us.push(track.step_ns.p50 as f64 / 1e3);
        self.plans[0] += track.plans.len();
        self.plans[1] += track.plans.iter().filter(|p| p.1.is_some()).count();
        self.limits(cell, with, on.tick_s);
    }

    fn limits(&mut self, cell: &Cell, track: &RobotTrack, tick_s: f64) {
        let robot = &cell.robots[0];
        let chain = &robot.robot.chain;
        let (lower, upper) = (chain.lower(), chain.upper());
        for j in 0..robot.limits.len() {
            let (mut sign, mut turned) = (0.0, f64::NEG_INFINITY);
            let astray = track.avoidance.iter().flat_map(|a| &a.samples).map(|a| a.astray_s > 0.0);
            for (w, astray) in track.samples.windows(2).zip(astray.skip(1)) {
                let v = (w[1].q[j] - w[0].q[j]) / tick_s;
                self.over[0] = self.over[0].max(v.abs() / robot.limits[j].velocity - 1.0);
                self.over[1] = self.over[1].max(w[1].q[j] - upper[j]).max(lower[j] - w[1].q[j]);
                // The program itself may turn as it likes.
                if !astray {
                    (sign, turned) = (0.0, f64::NEG_INFINITY);
                } else if v.abs() > STANDS * robot.limits[j].velocity {
                    if sign * v < 0.0 {
                        self.quietest_s = self.quietest_s.min(w[1].t_s - turned);
                        turned = w[1].t_s;
                    }
                    sign = v.signum();
                }
            }
        }
    }

    fn print(&mut self) {
        let at = |v: &mut Vec<f64>, share: f64| {
            v.sort_by(f64::total_cmp);
            v.get(((v.len() as f64 * share) as usize).min(v.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
        };
        let three = |v: &mut Vec<f64>| [at(v, 0.5), at(v, 0.9), at(v, 1.0)];
        println!("{} runs: {} hit without avoidance, {} with it", self.runs, self.hit_off, self.hit_on);
        let hit = self.hit_off.max(1) as f64;
        println!(
            "of those that hit without: {} ({:.1} %) run through with it, {} ({:.1} %) without ever waiting; {} of all not finished",
            self.resolved,
            100.0 * self.resolved as f64 / hit,
            self.moving,
            100.0 * self.moving as f64 / hit,
            self.unfinished
        );
        let [late, travel, nearest] = [&mut self.late_s, &mut self.travel, &mut self.nearest_m].map(three);
        println!("extra time, s: median {:.2}, 90 % {:.2}, most {:.2}", late[0], late[1], late[2]);
        println!("joint travel, times: median {:.2}, 90 % {:.2}, most {:.2}", travel[0], travel[1], travel[2]);
        println!("nearest, m: least {:.4}, median {:.3}", at(&mut self.nearest_m, 0.0), nearest[0]);
        println!("over a joint's speed by {:.1e}, over a limit by {:.1e} rad", self.over[0], self.over[1]);
        println!("shortest time between two reversals of a joint: {:.3} s", self.quietest_s);
        println!("ways planned: {}, found: {}", self.plans[0], self.plans[1]);
        println!(
            "step, us: median of the runs' medians {:.0}, largest median {:.0}",
            at(&mut self.step_us, 0.5),
            at(&mut self.step_us, 1.0)
        );
    }
}

/// What the robot did in the second before.
fn show(track: &RobotTrack, until_s: f64) {
    let Some(evaded) = &track.avoidance else { return };
    let last = |t: f64| t > until_s - 1.5 && t < until_s + 0.1;
    let both = track.samples.iter().zip(&evaded.samples).filter(|(s, _)| last(s.t_s));
    for (sample, a) in both.step_by(10) {
        println!(
            "  {:.3} {:9} nearest {:.3} size {:.2} astray {:.3} rate {:.2} q {:.3?}",
            sample.t_s,
            a.doing.word(),
            a.nearest_m,
            a.size,
            a.astray_s,
            a.rate,
            sample.q
        );
    }
    println!("  ways {:?}", evaded.plans);
}

/// Sum of all joints' motion.
fn travel(track: &RobotTrack) -> f64 {
    let step = |w: &[elbowroom_cell::Sample]| w[1].q.iter().zip(&w[0].q).map(|(a, b)| (a - b).abs()).sum::<f64>();
    track.samples.windows(2).map(step).sum()
}
