//! Statistics of many runs with and without avoidance, with an obstacle that crosses the workspace at random.
//! Collisions are detected by continuous sweeps of the exact scene from tick to tick.
//!
//! `cargo run --release -p elbowroom-sim --example evade -- [RUNS] [CELL] [--noise-mm N] [--delay-ms N] [--csv FILE]
//! [--add FILE]`
//!
//! `--add` adds the tables of a file to the cell, such as the regions of `examples/evade_regions.toml`. `--csv` writes a row per run: whether it hits without and with avoidance, its extra time, and the time in each state.
//!
//! Environment: `EVADE_ONLY=135,301` makes these runs only, and prints what the arm did; `EVADE_EXPLAIN=5000` searches an escape
//! with so many motions from several instants before each hit, against the true path of the obstacle.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/crossing.rs"]
mod crossing;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_avoidance::{AvoiderState, DynamicObstacles, EscapeState, ObservedObject, search_escape_tree};
use elbowroom_cell::{Cell, Drive, ObjectPath, OutOfReachProofs, QueryModel};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_sim::run::{evasion_limits, simulate};
use elbowroom_sim::{Recording, RobotTrack, RunOptions};
use elbowroom_testkit::random::Random;

/// Times before a hit from which an escape is searched, s.
const EXPLAINED_S: [f64; 7] = [3.0, 2.5, 2.0, 1.5, 1.0, 0.75, 0.5];
/// An escape is free for this time after the time of the hit, s.
const AFTER_HIT_S: f64 = 1.5;
/// Below this share of its speed a joint counts as stationary.
const STATIONARY_SHARE: f64 = 1e-4;
/// The columns of the table of `--csv`.
const STATES: [AvoiderState; 6] = [
    AvoiderState::Following,
    AvoiderState::Evading,
    AvoiderState::Returning,
    AvoiderState::Detouring,
    AvoiderState::Waiting,
    AvoiderState::Halted,
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let noise_mm: Option<f64> = option(&mut arguments, "--noise-mm")?;
    let delay_ms: Option<f64> = option(&mut arguments, "--delay-ms")?;
    let add: Option<PathBuf> = option(&mut arguments, "--add")?;
    let csv: Option<PathBuf> = option(&mut arguments, "--csv")?;
    let mut rows = csv.map(std::fs::File::create).transpose()?;
    if let Some(rows) = &mut rows {
        let states = STATES.map(|s| format!("{}_s", s.name())).join(",");
        writeln!(rows, "run,hit_without,hit_with,finished,extra_s,{states},plans")?;
    }
    let mut arguments = arguments.into_iter();
    let runs: usize = arguments.next().map_or(Ok(100), |n| n.parse())?;
    let file = arguments
        .next()
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/evade.toml")), PathBuf::from);
    let mut text = std::fs::read_to_string(&file)?;
    if let Some(add) = add {
        text += &std::fs::read_to_string(add)?;
    }
    let mut cell = Cell::parse(file, &text)?;
    for spec in cell.avoidance.iter_mut().flatten() {
        spec.noise_m = noise_mm.map_or(spec.noise_m, |mm| 1e-3 * mm);
        spec.delay_s = delay_ms.map_or(spec.delay_s, |ms| 1e-3 * ms);
    }
    let seen =
        cell.avoidance.first().and_then(Option::as_ref).ok_or("the first robot has no avoidance")?.objects.clone();
    let moves = |o: &&ObjectId| cell.moving_objects.iter().any(|m| m.object == **o);
    let object = *seen.iter().find(moves).ok_or("no moving object is evaded")?;
    let free = crossing::without_obstacle(&cell)?;
    println!(
        "{}: {} robot(s), without the obstacle the program takes {:.2} s",
        cell.name,
        cell.robots.len(),
        free.duration_s
    );
    // Single runs, `EVADE_ONLY=135,301`, with the state of the robot before a collision.
    let only: Option<Vec<usize>> =
        std::env::var("EVADE_ONLY").ok().map(|o| o.split(',').filter_map(|n| n.trim().parse().ok()).collect());
    let paths = crossing::paths(&cell, object, free.duration_s, runs)?;
    let explain_tries: Option<usize> = std::env::var("EVADE_EXPLAIN").ok().and_then(|n| n.parse().ok());
    let show = only.is_some();
    let chosen: Vec<usize> =
        only.map_or_else(|| (0..runs).collect(), |o| o.into_iter().filter(|n| *n < runs).collect());
    let mut statistics = Statistics { show, least_reversal_s: f64::INFINITY, ..Statistics::default() };
    for some in chosen.chunks(50) {
        for run in compare(&cell, object, &paths, some)? {
            statistics.add(&cell, &run);
            if let Some(rows) = &mut rows {
                writeln!(rows, "{}", row(&run))?;
            }
            if let (Some(tries), Some(hit)) = (explain_tries, run.on.robots[0].collisions.first()) {
                explain(&cell, object, &paths[run.number], &run.on, hit.t_s, tries)?;
            }
        }
        eprintln!("{} runs: {} collide without, {} with", statistics.runs, statistics.hit_off, statistics.hit_on);
    }
    statistics.print();
    Ok(())
}

/// Takes an option and its number from the arguments.
fn option<T: std::str::FromStr>(arguments: &mut Vec<String>, name: &str) -> Result<Option<T>, String> {
    let Some(at) = arguments.iter().position(|a| a == name) else { return Ok(None) };
    let value =
        arguments.get(at + 1).and_then(|text| text.parse().ok()).ok_or_else(|| format!("{name} needs a value"))?;
    arguments.drain(at..=at + 1);
    Ok(Some(value))
}

/// The line of a run in the table of `--csv`.
fn row(RunComparison { number, off, on }: &RunComparison) -> String {
    let (without, with) = (&off.robots[0], &on.robots[0]);
    let hits = [without, with].map(|track| u8::from(!track.collisions.is_empty()));
    let samples = with.avoidance.iter().flat_map(|track| &track.samples);
    let mut times_s = [0.0; STATES.len()];
    for sample in samples {
        if let Some(state) = STATES.iter().position(|s| *s == sample.state) {
            times_s[state] += on.tick_s;
        }
    }
    let times = times_s.map(|t| format!("{t:.3}")).join(",");
    let plans = with.avoidance.as_ref().map_or(0, |track| track.plans.len());
    let (finished, extra_s) = (u8::from(with.finished), on.duration_s - off.duration_s);
    format!("{number},{},{},{finished},{extra_s:.3},{times},{plans}", hits[0], hits[1])
}

/// The runs of one object path, without avoidance and with it.
struct RunComparison {
    number: usize,
    off: Recording,
    on: Recording,
}

/// The chosen runs, in parallel, in order.
fn compare(
    cell: &Cell,
    object: ObjectId,
    paths: &[ObjectPath],
    chosen: &[usize],
) -> Result<Vec<RunComparison>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut mine, mut cell) = (Vec::new(), cell.clone());
        while let Some(&number) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            let drive = Drive::Path(paths[number].clone());
            cell.moving_objects.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = drive.clone());
            let run = |avoidance| simulate(&cell, &RunOptions { avoidance, ..RunOptions::default() });
            let comparison =
                run(false).and_then(|off| Ok(RunComparison { number, off: off.recording, on: run(true)?.recording }));
            mine.push(comparison.map_err(|e| e.to_string()));
        }
        mine
    };
    let all = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("a run does not panic")).collect::<Result<Vec<_>, String>>()
    });
    let mut all = all?;
    all.sort_by_key(|comparison| comparison.number);
    Ok(all)
}

#[derive(Default)]
struct Statistics {
    runs: usize,
    hit_off: usize,
    hit_on: usize,
    resolved: usize,
    moving: usize,
    unfinished: usize,
    extra_s: Vec<f64>,
    travel: Vec<f64>,
    nearest_m: Vec<f64>,
    step_us: Vec<f64>,
    /// 99th percentile and largest of each run.
    step_p99_us: Vec<f64>,
    step_max_us: Vec<f64>,
    /// Runs in which the robot followed an escape.
    escaped: usize,
    /// Largest excess over a speed and a limit of a joint.
    over: [f64; 2],
    least_reversal_s: f64,
    plans: [usize; 2],
    /// Runs in which a region was entered, and in which the monitor stopped the robot off its path at one.
    entered: usize,
    stopped: usize,
    longest_stop_s: f64,
    show: bool,
}

/// Override below which the robot stands.
const STOPPED_OVERRIDE: f64 = 1e-3;

/// Longest time (s) for which the monitor stopped a robot at a region while it was off its path.
fn longest_stop_s(track: &RobotTrack, tick_s: f64) -> f64 {
    let (mut longest_s, mut stopped_s): (f64, f64) = (0.0, 0.0);
    let avoidance = track.avoidance.iter().flat_map(|a| &a.samples);
    for (sample, a) in track.samples.iter().zip(avoidance) {
        let is_stopped =
            a.path_deviation_s > 0.0 && sample.region.is_some() && sample.speed_override < STOPPED_OVERRIDE;
        stopped_s = if is_stopped { stopped_s + tick_s } else { 0.0 };
        longest_s = longest_s.max(stopped_s);
    }
    longest_s
}

impl Statistics {
    fn add(&mut self, cell: &Cell, RunComparison { number, off, on }: &RunComparison) {
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
        let stop_s = longest_stop_s(with, on.tick_s);
        self.entered += usize::from(on.regions.iter().any(|region| region.entered));
        self.stopped += usize::from(stop_s > 0.0);
        self.longest_stop_s = self.longest_stop_s.max(stop_s);
        let Some(track) = &with.avoidance else { return };
        if hit_off && !hit_on && with.finished {
            self.resolved += 1;
            self.moving += usize::from(!track.samples.iter().any(|s| s.state == AvoiderState::Waiting));
        }
        if !hit_on && with.finished {
            self.extra_s.push(on.duration_s - off.duration_s);
            self.travel.push(travel(with) / travel(without));
        }
        self.nearest_m.push(track.samples.iter().map(|s| s.nearest_m).fold(f64::INFINITY, f64::min));
        self.step_us.push(track.step_ns.p50 as f64 / 1e3);
        self.step_p99_us.push(track.step_ns.p99 as f64 / 1e3);
        self.step_max_us.push(track.step_ns.max as f64 / 1e3);
        self.escaped += usize::from(track.samples.iter().any(|s| s.escape == EscapeState::Escaping));
        self.plans[0] += track.plans.len();
        self.plans[1] += track.plans.iter().filter(|p| p.search_s.is_some()).count();
        self.limits(cell, with, on.tick_s);
    }

    fn limits(&mut self, cell: &Cell, track: &RobotTrack, tick_s: f64) {
        let robot = &cell.robots[0];
        let chain = &robot.robot.chain;
        let (lower, upper) = (chain.lower(), chain.upper());
        for j in 0..robot.limits.len() {
            let (mut sign, mut reversed_s) = (0.0, f64::NEG_INFINITY);
            let off_path = track.avoidance.iter().flat_map(|a| &a.samples).map(|a| a.path_deviation_s > 0.0);
            for (w, off_path) in track.samples.windows(2).zip(off_path.skip(1)) {
                let v = (w[1].q[j] - w[0].q[j]) / tick_s;
                self.over[0] = self.over[0].max(v.abs() / robot.limits[j].velocity - 1.0);
                self.over[1] = self.over[1].max(w[1].q[j] - upper[j]).max(lower[j] - w[1].q[j]);
                // Reversals of the program itself do not count.
                if !off_path {
                    (sign, reversed_s) = (0.0, f64::NEG_INFINITY);
                } else if v.abs() > STATIONARY_SHARE * robot.limits[j].velocity {
                    if sign * v < 0.0 {
                        self.least_reversal_s = self.least_reversal_s.min(w[1].t_s - reversed_s);
                        reversed_s = w[1].t_s;
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
        println!("{} runs: {} collide without avoidance, {} with it", self.runs, self.hit_off, self.hit_on);
        let hit = self.hit_off.max(1) as f64;
        println!(
            "of those that collide without avoidance: {} ({:.1} %) complete with it, {} ({:.1} %) without waiting; \
             {} of all not completed",
            self.resolved,
            100.0 * self.resolved as f64 / hit,
            self.moving,
            100.0 * self.moving as f64 / hit,
            self.unfinished
        );
        let [extra, travel, nearest] = [&mut self.extra_s, &mut self.travel, &mut self.nearest_m].map(three);
        println!("extra time, s: median {:.2}, 90 % {:.2}, most {:.2}", extra[0], extra[1], extra[2]);
        println!("joint travel, times: median {:.2}, 90 % {:.2}, most {:.2}", travel[0], travel[1], travel[2]);
        println!("nearest, m: least {:.4}, median {:.3}", at(&mut self.nearest_m, 0.0), nearest[0]);
        println!("over a joint's speed by {:.1e}, over a limit by {:.1e} rad", self.over[0], self.over[1]);
        println!("shortest time between two reversals of a joint: {:.3} s", self.least_reversal_s);
        println!("replanning attempts: {}, found: {}", self.plans[0], self.plans[1]);
        println!(
            "step, us: median of the runs' medians {:.0}, largest median {:.0}; 99th percentile: median {:.0}, largest \
             {:.0}; longest {:.0}",
            at(&mut self.step_us, 0.5),
            at(&mut self.step_us, 1.0),
            at(&mut self.step_p99_us, 0.5),
            at(&mut self.step_p99_us, 1.0),
            at(&mut self.step_max_us, 1.0)
        );
        println!("runs with an escape: {}", self.escaped);
        println!(
            "runs that entered a region: {}; stopped off the path at one: {}, longest {:.2} s",
            self.entered, self.stopped, self.longest_stop_s
        );
    }
}

/// Searches an escape from the states of the robot before a hit, in space and time, and prints what was found.
fn explain(
    cell: &Cell,
    object: ObjectId,
    path: &ObjectPath,
    run: &Recording,
    hit_s: f64,
    tries: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let robot = RobotId(0);
    let mut cell = cell.clone();
    cell.moving_objects.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = Drive::Path(path.clone()));
    let scene = QueryModel::of_cell(&cell).scene(OutOfReachProofs::Omit)?;
    let limits = evasion_limits(&cell, robot);
    let samples = &run.robots[0].samples;
    for before_s in EXPLAINED_S {
        let Some(at) = samples.iter().rposition(|s| s.t_s <= hit_s - before_s).filter(|n| *n > 0) else { continue };
        let (last, now) = (&samples[at - 1], &samples[at]);
        let qd: Vec<f64> = now.q.iter().zip(&last.q).map(|(a, b)| (a - b) / run.tick_s).collect();
        // The obstacle moves straight: its present motion is its true path.
        let seen = cell.moving_objects.iter().map(|m| ObservedObject {
            object: m.object,
            in_world: m.pose(now.t_s),
            motion: m.motion(now.t_s),
            known: m.object != object,
        });
        let objects: Vec<ObservedObject> = seen.collect();
        let obstacles = DynamicObstacles { objects: &objects, robots: &[] };
        let mut random = Random(1);
        let horizon_s = before_s + AFTER_HIT_S;
        let from = [&now.q[..], &qd[..]];
        let found = search_escape_tree(&scene, robot, &limits, from, &obstacles, horizon_s, tries, &mut || {
            random.between(0.0, 1.0)
        })?;
        let outcome = found.gap_m.map_or_else(|| "no escape".to_owned(), |gap| format!("an escape, gap {gap:.3} m"));
        println!(
            "  {before_s:.2} s before the hit: {outcome} after {} motions; longest without a hit {:.2} s of {horizon_s:.2} s",
            found.tries, found.longest_s
        );
    }
    Ok(())
}

/// Prints the states of the robot in the last second.
fn show(track: &RobotTrack, until_s: f64) {
    let Some(avoidance) = &track.avoidance else { return };
    let last = |t: f64| t > until_s - 1.5 && t < until_s + 0.1;
    let both = track.samples.iter().zip(&avoidance.samples).filter(|(s, _)| last(s.t_s));
    for (sample, a) in both.step_by(10) {
        println!(
            "  {:.3} {:9} {:9} nearest {:.3} size {:.2} deviation {:.3} rate {:.2} q {:.3?}",
            sample.t_s,
            a.state.name(),
            format!("{:?}", a.escape),
            a.nearest_m,
            a.size,
            a.path_deviation_s,
            a.rate,
            sample.q
        );
    }
    println!("  plans {:?}", avoidance.plans);
}

/// Sum of the motion of all joints.
fn travel(track: &RobotTrack) -> f64 {
    let step = |w: &[elbowroom_sim::Sample]| w[1].q.iter().zip(&w[0].q).map(|(a, b)| (a - b).abs()).sum::<f64>();
    track.samples.windows(2).map(step).sum()
}
