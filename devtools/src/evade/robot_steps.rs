//! `cargo xtask evade --robots`: time of a step of avoidance for every robot of the data, with the joints of its file.

use std::error::Error;
use std::path::{Path, PathBuf};

use elbowroom_cell::Cell;
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_kinematics::{ChainState, JointKind};
use elbowroom_robot::Robot;
use elbowroom_sim::run::simulate;
use elbowroom_sim::{AvoidanceSummary, RobotTrack, RunOptions};
use elbowroom_testkit::random::SplitMix;

/// Runs of each robot.
const RUNS: u64 = 3;
/// Number of random programs tried for the runs: some make the robot collide with itself, or exceed its limits.
const TRIED: u64 = 12;
/// Range of joints without limits or with wide ones, rad.
const RANGE: f64 = 3.0;
/// Tick of the cells, s.
const TICK_S: f64 = 0.002;

/// Prints a line per robot.
pub fn run() -> Result<(), Box<dyn Error>> {
    let Some(data) = elbowroom_testkit::folder::data() else { return Ok(()) };
    println!("robot                      runs  hits  evading, s   step, us: median, 99 %, longest of the runs");
    for file in urdf_files(&data.join("urdf"))? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let tracks = runs(&file)?;
        let hits = tracks.iter().filter(|t| !t.collisions.is_empty()).count();
        let runs = tracks.iter().filter_map(|t| t.avoidance.as_ref()).map(|a| AvoidanceSummary::new(a, TICK_S));
        let ([mut p50, mut p99, mut longest], mut evading) = ([0; 3], 0.0);
        for AvoidanceSummary { step_ns: s, evading_s, .. } in runs {
            (p50, p99, longest) = (p50.max(s.p50), p99.max(s.p99), longest.max(s.max));
            evading += evading_s;
        }
        println!(
            "{name:26} {:4}  {hits:4}  {evading:10.1}  {:8} {:7} {:7}",
            tracks.len(),
            p50 / 1000,
            p99 / 1000,
            longest / 1000
        );
    }
    Ok(())
}

fn urdf_files(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut files = Vec::new();
    for robot in std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
        let Ok(of_robot) = std::fs::read_dir(robot?.path()) else { continue };
        for file in of_robot {
            let name = file?.path();
            // Each file has a variant of the same robot with package paths.
            let is_of_package = name.file_stem().is_some_and(|stem| Path::new(stem).extension().is_some());
            if name.extension().is_some_and(|kind| kind == "urdf") && !is_of_package {
                files.push(name);
            }
        }
    }
    files.sort();
    Ok(files)
}

fn runs(file: &Path) -> Result<Vec<RobotTrack>, Box<dyn Error>> {
    let robot = load(file, &LoadOptions::default())?.robot;
    let mut tracks = Vec::new();
    if robot.chain.dof() == 0 {
        return Ok(tracks);
    }
    for seed in 0..TRIED {
        let text = cell(file, &robot, &mut SplitMix(seed));
        let Ok(cell) = Cell::parse(PathBuf::from("steps.toml"), &text) else { continue };
        let alone = simulate(&cell, &RunOptions { avoidance: false, ..RunOptions::default() });
        // A run in which the robot hits itself says nothing about the obstacle.
        let hits_itself = |t: &RobotTrack| t.collisions.iter().any(|c| c.a != "crate" && c.b != "crate");
        if alone.map_or(true, |o| hits_itself(&o.recording.robots[0])) {
            continue;
        }
        let mut recording = simulate(&cell, &RunOptions::default())?.recording;
        tracks.push(recording.robots.remove(0));
        if tracks.len() as u64 == RUNS {
            break;
        }
    }
    Ok(tracks)
}

/// Makes a cell in which the robot moves back and forth, and a crate crosses the place of its tip in between.
fn cell(file: &Path, robot: &Robot, random: &mut SplitMix) -> String {
    let limits = robot.chain.joints().iter().filter(|j| j.kind != JointKind::Fixed && j.mimic.is_none());
    let limits: Vec<[f64; 2]> = limits.map(|j| [j.limits.lower.max(-RANGE), j.limits.upper.min(RANGE)]).collect();
    let mut between = |share: [f64; 2]| -> Vec<f64> {
        limits.iter().map(|[low, high]| low + (high - low) * random.between(share[0], share[1])).collect()
    };
    let (from, mut to) = (between([0.3, 0.7]), between([0.4, 0.6]));
    to[0] = limits[0][0] + 0.9 * (limits[0][1] - limits[0][0]);
    let mut state = ChainState::new(&robot.chain);
    state.q = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
    robot.chain.forward(&mut state);
    let tip = state.link_in_root(robot.chain.tip()).translation;
    let size = 0.2 * tip.length().max(0.3);
    format!(
        "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\ntick_ms = {}\nmax_s = 12\n\
         [robot.arm]\nmodel = {:?}\nstart = {from:?}\n\
         [encoder.belt]\ndirection = [0, 1, 0]\nspeed = 0.4\n\
         [object.crate]\nshape = \"box\"\nat = [{:.4}, {:.4}, {:.4}]\nsize = [{size:.4}, {size:.4}, {size:.4}]\n\
         follow = {{ encoder = \"belt\" }}\n\
         [avoidance.arm]\nobjects = [\"crate\"]\n\
         [program.arm]\nrepeat = 3\n\
         steps = [{{ move = \"joint\", to = {to:?}, speed = 40 }}, {{ move = \"joint\", to = {from:?}, speed = 40 }}]\n",
        1e3 * TICK_S,
        file.display().to_string(),
        tip.x,
        tip.y - 1.6,
        tip.z
    )
}
