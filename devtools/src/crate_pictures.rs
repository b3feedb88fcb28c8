//! The pictures of `examples/crate`: a camera above the cell sees a crate that drives in and out of the way of the arm.

use std::fmt::Write;
use std::path::Path;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_perception::WatchedRobot;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, Point2, encode_png};

use crate::robots::File;

const MODEL: &str = "examples/models/kr125/kr125.urdf";
/// Seconds between pictures.
const PERIOD_S: f64 = 0.1;
/// Pictures of the empty cell, before the run.
const LEARNING: usize = 30;
const PICTURES: usize = 180;
/// Length, width and height of the crate, m.
const SIZE: Vec3 = Vec3::new(0.6, 0.4, 0.9);
/// Where the crate is: times of pictures (s) and its centre (m); it drives straight in between, at 0.75 m/s.
const DRIVE: [(f64, f64, f64); 7] = [
    (0.0, 3.9, 0.0),
    (2.4, 2.1, 0.0),
    (4.2, 2.1, 0.0),
    (6.6, 3.9, 0.0),
    (9.0, 2.1, 0.0),
    (10.0, 2.1, 0.0),
    (12.4, 3.9, 0.0),
];

/// Names below `examples/crate` and contents.
pub fn files(root: &Path) -> Result<Vec<File>, String> {
    let robot = load(&root.join(MODEL), &LoadOptions::default()).map_err(|e| e.to_string())?.robot;
    let arm = WatchedRobot { robot, base_in_world: Pose::IDENTITY };
    // As the cell file has them.
    let lens = Intrinsics { fx: 161.5, fy: 161.5, ..Intrinsics::pinhole(160, 120, 0.92) };
    let camera = Camera::look_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y)
        .map_err(|e| e.to_string())?;
    let (mut renderer, mut frame) = (Renderer::new(camera, Channels::Grey, 5), Frame::default());
    let mut files = Vec::new();
    let (mut times, mut truth) = ("file,t_s\n".to_owned(), "t_s,x_m,y_m\n".to_owned());
    for i in 0..PICTURES {
        let t_s = (i as f64 - LEARNING as f64) * PERIOD_S;
        let parts = if t_s < 0.0 { arm.parts(&learning_joints(t_s)) } else { Vec::new() };
        let drawn: Vec<_> = parts.into_iter().map(|part| (part, 200)).collect();
        let at = (t_s >= 0.0).then(|| crate_at(t_s));
        let solid = at.map(|at| RenderedSolid::cuboid(at, SIZE, 0.0, 40));
        let conditions = RenderConditions { seed: i as u64, noise: 0.5, ..RenderConditions::default() };
        renderer.render(solid.as_slice(), &drawn, &conditions, &mut frame).map_err(|e| e.to_string())?;
        let name = format!("frame_{i:03}.png");
        files.push((format!("pictures/{name}"), encode_png(&frame).map_err(|e| e.to_string())?));
        let _ = writeln!(times, "{name},{t_s:.2}");
        if let Some(at) = at {
            let _ = writeln!(truth, "{t_s:.2},{:.4},{:.4}", at.x, at.y);
        }
    }
    files.push(("pictures/times.csv".to_owned(), times.into_bytes()));
    files.push(("truth.csv".to_owned(), truth.into_bytes()));
    files.push(("learning.csv".to_owned(), learning_table().into_bytes()));
    Ok(files)
}

/// Centre of the crate at a time.
fn crate_at(t_s: f64) -> Point2 {
    let next = DRIVE.iter().position(|(t, ..)| *t > t_s);
    let (from, to) = match next {
        Some(next) => (DRIVE[next.max(1) - 1], DRIVE[next.max(1)]),
        None => (DRIVE[DRIVE.len() - 1], DRIVE[DRIVE.len() - 1]),
    };
    let share = if to.0 > from.0 { (t_s - from.0) / (to.0 - from.0) } else { 0.0 };
    Point2::new(from.1 + share * (to.1 - from.1), from.2 + share * (to.2 - from.2))
}

/// Joint values while the empty cell is learnt: the arm swings so that the camera sees all of the floor.
fn learning_joints(t_s: f64) -> [f64; 6] {
    [60.0 * (2.5 * t_s).cos(), -31.1, 76.6, 0.0, 44.5, 0.0].map(f64::to_radians)
}

fn learning_table() -> String {
    let mut table = "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n".to_owned();
    let begin_s = -(LEARNING as f64 * PERIOD_S) - 0.2;
    for i in 0..=((-begin_s / 0.02).round() as usize) {
        let t_s = begin_s + 0.02 * i as f64;
        let q = learning_joints(t_s).map(|v| format!("{v:.6}"));
        let _ = writeln!(table, "{t_s:.2},{}", q.join(","));
    }
    table
}
