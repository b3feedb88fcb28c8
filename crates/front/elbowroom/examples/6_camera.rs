//! A robot under a camera avoids a trolley that is not an object of the cell file, on its joint-space map.
//!
//! The example renders the pictures and writes a cell file, a run and its report.
//!
//! `cargo run --release -p elbowroom --example 6_camera`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::perception::WatchedRobot;
use elbowroom::prelude::*;
use elbowroom::report::{HtmlReport, ReportScene, summary};
use elbowroom::sim::{RunOptions, simulate};
use elbowroom::vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom::vision::{Camera, Channels, Frame, Intrinsics, Point2, encode_png};

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/models/kr125/kr125.urdf");
/// Seconds between pictures; the first ones show the empty cell, before the run.
const PERIOD_S: f64 = 0.04;
const LEARNING: usize = 30;
const PICTURES: usize = 190;

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 8

[robot.kr]
model = MODEL
srdf = SRDF
start = [60, -31.1, 76.6, 0, 44.5, 0]

[camera.above]
size = [320, 240]
focal_px = FOCAL
pose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }
area = [[750, -3000], [4800, -3000], [4800, 3000], [750, 3000]]
uncertainty = 135      # 15 of the outline, and 1.2 m/s until the next picture has been processed: 40 ms and 60 ms
templates = [{ name = "trolley", size = [600, 400], height = 900 }]
frames = "pictures"
joints = "learning.csv"
latency_ms = 60

[map.kr]
step = 4

[monitor]
direction_aware = true
stopping_distance = true

[program.kr]
steps = [
    { wait = 0.6 },
    { move = "planned", to = [-60, -31.1, 76.6, 0, 44.5, 0], speed = 30, planner = "grid" },
]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new("elbowroom-out/camera");
    std::fs::create_dir_all(folder.join("pictures"))?;
    write_cell(folder)?;
    let cell = Cell::load(folder.join("cell.toml"))?;
    let run = simulate(&cell, &RunOptions::default())?.recording;
    println!("{}", summary(&run, 80, false));
    let page = std::fs::File::create(folder.join("report.html"))?;
    HtmlReport::new(&ReportScene::of_cell(&cell), &[("run", &run)]).write(page)?;
    println!("report: {}", folder.join("report.html").display());
    Ok(())
}

/// Joint values while the empty cell is learnt: the arm swings so that the camera sees all of the floor.
fn learning_joints(t_s: f64) -> [f64; 6] {
    [60.0 * (5.0 * t_s).cos(), -31.1, 76.6, 0.0, 44.5, 0.0].map(f64::to_radians)
}

/// Position of the trolley, which drives into the way of the arm and stops there.
fn trolley_at(t_s: f64) -> Option<RenderedSolid> {
    let at = Point2::new(3.9 - (1.2 * t_s).min(1.8), 0.0);
    (t_s >= 0.0).then(|| RenderedSolid::cuboid(at, Vec3::new(0.6, 0.4, 0.9), 0.0, 40))
}

/// Writes the cell file, the camera pictures, and the joint values at the pictures of the empty cell.
fn write_cell(folder: &Path) -> Result<(), Box<dyn Error>> {
    let lens = Intrinsics::pinhole(320, 240, 0.92);
    let focal = format!("[{:?}, {:?}]", lens.fx, lens.fy);
    let srdf = MODEL.replace(".urdf", ".srdf");
    let text = CELL.replace("MODEL", &format!("{MODEL:?}")).replace("SRDF", &format!("{srdf:?}"));
    std::fs::write(folder.join("cell.toml"), text.replace("FOCAL", &focal))?;
    let robot = load_robot(MODEL.as_ref(), &LoadOptions::default())?.robot;
    let arm = WatchedRobot { robot, base_in_world: Pose::IDENTITY };
    let camera = Camera::look_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y)?;
    let (mut renderer, mut frame) = (Renderer::new(camera, Channels::Grey, 5), Frame::default());
    let mut times = "file,t_s\n".to_owned();
    for i in 0..PICTURES {
        let t_s = (i as f64 - LEARNING as f64) * PERIOD_S;
        // The pictures of the run are rendered before it, without the arm.
        let parts = if t_s < 0.0 { arm.parts(&learning_joints(t_s)) } else { Vec::new() };
        let drawn: Vec<_> = parts.into_iter().map(|part| (part, 200)).collect();
        let conditions = RenderConditions { seed: i as u64, ..RenderConditions::default() };
        renderer.render(trolley_at(t_s).as_slice(), &drawn, &conditions, &mut frame)?;
        let name = format!("frame_{i:04}.png");
        std::fs::write(folder.join("pictures").join(&name), encode_png(&frame)?)?;
        writeln!(times, "{name},{t_s:.3}")?;
    }
    std::fs::write(folder.join("pictures/times.csv"), times)?;
    let mut joints = "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n".to_owned();
    for i in 0..=136 {
        let t_s = 0.01 * f64::from(i) - LEARNING as f64 * PERIOD_S - 0.2;
        let q = learning_joints(t_s).map(|v| format!("{v:.9}"));
        writeln!(joints, "{t_s:.3},{}", q.join(","))?;
    }
    std::fs::write(folder.join("learning.csv"), joints)?;
    Ok(())
}
