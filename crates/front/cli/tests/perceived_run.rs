//! `elbowroom run` with cameras and point clouds: a crate that no file names crosses the path of an arm.
//!
//! Pictures, clouds and cell are files, everything runs through the command line, and the ground truth is kept separate.

#![allow(clippy::print_stdout, reason = "figures of the evidence")]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex};

use crate::common::{Answer, elbowroom};
use elbowroom::formats::image::{ImageHeader, PixelFormat};
use elbowroom::formats::png;
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::kinematics::{ChainState, LinkId};
use elbowroom::perception::WatchedRobot;
use elbowroom::proximity::Shape;
use elbowroom::robot::Robot;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom::vision::{Camera, Channels, Frame, Intrinsics, Point2, encode_png, polygon};
use serde_json::Value;

const PERIOD_S: f64 = 0.04;
pub(crate) const FRAMES: usize = 170;
/// Time from a picture to its use, s.
pub(crate) const LATENCY_S: f64 = 0.06;
/// Default duration of a search, s.
const SEARCH_S: f64 = 0.2;
/// Number of pictures of the empty cell, before the start of the run.
pub(crate) const LEARNING: usize = 30;
/// Length, width and height of the crate, m.
const SIZE: [f64; 3] = [0.6, 0.4, 0.9];
/// Radius of the noise of points of a cloud, m.
const NOISE_M: f64 = 0.004;
/// Distance between the points at which the test measures the clearance, m.
const SURFACE_STEP_M: f64 = 0.02;

pub(crate) const CAMERA: &str = r#"
[camera.above]
size = [320, 240]
focal_px = FOCAL
pose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }
area = [[750, -3000], [4800, -3000], [4800, 3000], [750, 3000]]
uncertainty = 60
templates = [{ name = "crate", size = [600, 400], height = 900 }]
frames = "pictures"
joints = "learning.csv"
latency_ms = 60
"#;

pub(crate) const CLOUD: &str = r#"
[cloud.mast]
pose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }
area = [[750, -3000], [4800, -3000], [4800, 3000], [750, 3000]]
voxel = 50
uncertainty = 40
learning_clouds = 10
clouds = "clouds"
latency_ms = 60

[object.pillar]                       # known: points on it are no obstacle
shape = "cylinder"
at = [4200, 2000, 500]
radius = 150
height = 1000
"#;

/// The move from one side to the other, and a region above it, which limits motion over the crate.
const REST: &str = r#"
[map.kr]
step = 4

[region.hoist]
shape = "box"
from = [1000, -500, 1900]
to = [3000, 500, 2600]
warning = 150

[monitor]
direction_aware = true
stopping_distance = true

[program.kr]
steps = [{ wait = 0.6 }, { move = "KIND", to = [-60, -31.1, 76.6, 0, 44.5, 0], speed = 30 }]
"#;

fn lens() -> Intrinsics {
    Intrinsics::pinhole(320, 240, 0.92)
}

fn camera() -> Camera {
    Camera::look_at(lens(), Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y).unwrap()
}

pub(crate) fn cell(sensor: &str, kind: &str) -> String {
    let head = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 8\n[robot.kr]\nmodel = {:?}\nsrdf = {:?}\n\
         start = [60, -31.1, 76.6, 0, 44.5, 0]\n",
        elbowroom_testkit::folder::model("kr125").display().to_string(),
        elbowroom_testkit::folder::model("kr125").with_extension("srdf").display().to_string()
    );
    let lens = format!("[{:?}, {:?}]", lens().fx, lens().fy);
    head + &sensor.replace("FOCAL", &lens) + &REST.replace("KIND", kind)
}

/// Position of the crate: it comes from outside, and blocks the arm from 1.5 s on, until `leaves_s`.
pub(crate) fn crate_at(t_s: f64, leaves_s: f64) -> Point2 {
    let arrived = (1.2 * t_s).min(1.8);
    Point2::new(3.9 - arrived + (1.5 * (t_s - leaves_s)).max(0.0), 0.0)
}

/// Time of each picture; the pictures of the empty cell are before the run.
pub(crate) fn stamp_s(i: usize) -> f64 {
    (i as f64 - LEARNING as f64) * PERIOD_S
}

/// Joint values while the empty cell is learnt: the arm swings back and forth, so that every part of the floor is seen.
fn learning_joints(t_s: f64) -> [f64; 6] {
    [60.0 * (t_s * 5.0).cos(), -31.1, 76.6, 0.0, 44.5, 0.0].map(f64::to_radians)
}

/// Number of frames, and when the crate leaves, as bits.
type Scene = (usize, u64);

/// Names of files relative to a folder, and their bytes.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// Files of frames that several tests read, made once.
#[derive(Default)]
struct Frames(Mutex<BTreeMap<Scene, Files>>);

impl Frames {
    /// Writes the files of a scene, which `make` makes for the first test that asks for them.
    fn write(&self, dir: &Path, frames: usize, leaves_s: f64, make: fn(&Path, usize, f64)) {
        let mut made = self.0.lock().unwrap();
        let files = made.entry((frames, leaves_s.to_bits())).or_insert_with(|| {
            let folder = tempfile::tempdir().unwrap();
            make(folder.path(), frames, leaves_s);
            files_below(folder.path())
        });
        for (name, bytes) in files {
            let file = dir.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, bytes).unwrap();
        }
    }
}

/// The files of a folder and of the folders in it.
fn files_below(folder: &Path) -> Files {
    let mut found = Files::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = PathBuf::from(path.file_name().unwrap());
        if path.is_dir() {
            found.extend(files_below(&path).into_iter().map(|(below, bytes)| (name.join(below), bytes)));
        } else {
            found.push((name, std::fs::read(path).unwrap()));
        }
    }
    found
}

/// Writes pictures of the crate, their times, and the joint values of the first ones.
pub(crate) fn write_pictures(dir: &Path, frames: usize, leaves_s: f64) {
    static PICTURES: LazyLock<Frames> = LazyLock::new(Frames::default);
    PICTURES.write(dir, frames, leaves_s, draw_pictures);
}

/// Writes clouds of the crate and their times.
pub(crate) fn write_clouds(dir: &Path, frames: usize, leaves_s: f64) {
    static CLOUDS: LazyLock<Frames> = LazyLock::new(Frames::default);
    CLOUDS.write(dir, frames, leaves_s, scan_clouds);
}

/// Writes pictures of the crate and their times, as files. The pictures of the empty cell show the arm, whose joint
/// values are known; later ones do not show the arm, whose motion is not known yet.
fn draw_pictures(dir: &Path, frames: usize, leaves_s: f64) {
    let folder = dir.join("pictures");
    std::fs::create_dir(&folder).unwrap();
    let robot = load(&elbowroom_testkit::folder::model("kr125"), &LoadOptions::default()).unwrap().robot;
    let arm = WatchedRobot { robot, base_in_world: Pose::IDENTITY };
    let mut joints = "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n".to_owned();
    for i in 0..=136 {
        let t_s = stamp_s(0) - 0.2 + 0.01 * f64::from(i);
        let q = learning_joints(t_s).map(|v| format!("{v:.9}"));
        writeln!(joints, "{t_s:.3},{}", q.join(",")).unwrap();
    }
    std::fs::write(dir.join("learning.csv"), joints).unwrap();
    let mut renderer = Renderer::new(camera(), Channels::Grey, 5);
    let (mut frame, mut times) = (Frame::default(), "file,t_s\n".to_owned());
    for i in 0..frames {
        let t_s = stamp_s(i);
        let [x, y, z] = SIZE;
        let at = crate_at(t_s, leaves_s);
        let solids: Vec<_> =
            (t_s >= 0.0).then(|| RenderedSolid::cuboid(at, Vec3::new(x, y, z), 0.0, 40)).into_iter().collect();
        let conditions = RenderConditions { seed: i as u64, ..RenderConditions::default() };
        let parts = if t_s < 0.0 { arm.parts(&learning_joints(t_s)) } else { Vec::new() };
        let drawn: Vec<_> = parts.into_iter().map(|part| (part, 200)).collect();
        renderer.render(&solids, &drawn, &conditions, &mut frame).unwrap();
        let name = format!("frame_{i:04}.png");
        std::fs::write(folder.join(&name), encode_png(&frame).unwrap()).unwrap();
        writeln!(times, "{name},{t_s:.3}").unwrap();
    }
    std::fs::write(folder.join("times.csv"), times).unwrap();
}

/// Writes clouds of the crate, the floor, a known pillar and an unknown rack that is there from the beginning, as PCD
/// files in the frame of the sensor.
fn scan_clouds(dir: &Path, frames: usize, leaves_s: f64) {
    let folder = dir.join("clouds");
    std::fs::create_dir(&folder).unwrap();
    let (mut times, mut seed) = ("file,t_s\n".to_owned(), 1_u64);
    let mut noise = || {
        // A linear congruential generator: the same numbers everywhere.
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 2.0 * NOISE_M
    };
    for i in 0..frames {
        let t_s = stamp_s(i);
        let mut points = grid_of_box(Point2::new(2.5, -2.6), [0.8, 0.3, 1.2], 0.03);
        points.extend((0..60).map(|n| {
            let angle = f64::from(n) * 0.4;
            Vec3::new(4.2 + 0.15 * angle.cos(), 2.0 + 0.15 * angle.sin(), f64::from(n) / 60.0)
        }));
        points.extend(
            (0..40 * 40).map(|n| Vec3::new(0.8 + f64::from(n % 40) * 0.1, -2.0 + f64::from(n / 40) * 0.1, 0.0)),
        );
        if t_s >= 0.0 {
            points.extend(grid_of_box(crate_at(t_s, leaves_s), SIZE, 0.03));
        }
        let header = format!(
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH {0}\nHEIGHT 1\nPOINTS {0}\nDATA binary\n",
            points.len()
        );
        let mut bytes = header.into_bytes();
        for p in points {
            let p = p + Vec3::new(noise(), noise(), noise());
            // The sensor is at a height of 6.5 m and looks down: its x is the world's, its y and z are reversed.
            bytes.extend([p.x - 1.7, -p.y, 6.5 - p.z].into_iter().flat_map(|value| (value as f32).to_le_bytes()));
        }
        let name = format!("cloud_{i:04}.pcd");
        std::fs::write(folder.join(&name), bytes).unwrap();
        writeln!(times, "{name},{t_s:.3}").unwrap();
    }
    std::fs::write(folder.join("times.csv"), times).unwrap();
}

/// Returns points on the top and the sides of an upright box on the floor.
fn grid_of_box(at: Point2, [length, width, height]: [f64; 3], step: f64) -> Vec<Vec3> {
    let steps = |side: f64| (side / step).ceil() as usize;
    let along = |n: usize, side: f64| side * n as f64 / steps(side) as f64;
    let mut points = Vec::new();
    for i in 0..=steps(length) {
        for j in 0..=steps(width) {
            for k in 1..=steps(height) {
                let on_side = i == 0 || i == steps(length) || j == 0 || j == steps(width);
                if on_side || k == steps(height) {
                    let (x, y) = (along(i, length) - length / 2.0, along(j, width) - width / 2.0);
                    points.push(Vec3::new(at.x + x, at.y + y, along(k, height)));
                }
            }
        }
    }
    points
}

/// Returns points on the surface of the arm, each in the frame of its link: a naive measurement, which shares no
/// distance code with the product.
fn surface_points(robot: &Robot) -> Vec<(LinkId, Vec3)> {
    let mut points = Vec::new();
    for (link, colliders) in robot.colliders.iter().enumerate() {
        for c in colliders {
            let local: Vec<Vec3> = match &c.shape {
                Shape::Cuboid(b) => {
                    let h = b.half_extents;
                    let closed = grid_of_box(Point2::default(), [2.0 * h.x, 2.0 * h.y, 2.0 * h.z], SURFACE_STEP_M);
                    let lowered = closed.iter().map(|p| *p - Vec3::Z * h.z);
                    // The bottom is the mirrored top.
                    lowered.flat_map(|p| [p, Vec3::new(p.x, p.y, -p.z)]).collect()
                }
                Shape::Cylinder(c) => {
                    let rings = (c.radius / SURFACE_STEP_M).ceil() as usize;
                    let turns = (c.radius * std::f64::consts::TAU / SURFACE_STEP_M).ceil() as usize;
                    let floors = (2.0 * c.half_length / SURFACE_STEP_M).ceil() as usize;
                    let at = |radius: f64, turn: usize, z: f64| {
                        let angle = std::f64::consts::TAU * turn as f64 / turns as f64;
                        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
                    };
                    let z = |floor: usize| c.half_length * (2.0 * floor as f64 / floors as f64 - 1.0);
                    let side = (0..=floors).flat_map(|f| (0..turns).map(move |t| (c.radius, t, f)));
                    let caps = (0..=rings).flat_map(|r| {
                        let radius = c.radius * r as f64 / rings as f64;
                        (0..turns).flat_map(move |t| [(radius, t, 0), (radius, t, usize::MAX)])
                    });
                    side.chain(caps).map(|(r, t, f)| at(r, t, z(f.min(floors)))).collect()
                }
                other => panic!("the measurement knows no {other:?}"),
            };
            points.extend(local.into_iter().map(|p| (LinkId(link), c.in_link.transform_point(p))));
        }
    }
    points
}

/// Returns the smallest distance (m) of the arm from the crate over a run, and its time: at every fourth tick, at every
/// point of its surface that could be nearer than the nearest before.
pub(crate) fn clearance(trace: &str, robot: &Robot, crate_at: impl Fn(f64) -> Point2) -> (f64, f64) {
    let mut links: Vec<Vec<Vec3>> = vec![Vec::new(); robot.colliders.len()];
    for (link, p) in surface_points(robot) {
        links[link.0].push(p);
    }
    let radius = |points: &Vec<Vec3>| points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let radii: Vec<f64> = links.iter().map(radius).collect();
    let mut state = ChainState::new(&robot.chain);
    let (mut least, mut when) = (f64::INFINITY, 0.0);
    for row in trace.lines().skip(1).step_by(4) {
        let cells: Vec<f64> = row.split(',').map(|c| c.parse().unwrap_or(f64::NAN)).collect();
        let (t_s, q) = (cells[0], &cells[2..8]);
        state.q.copy_from_slice(q);
        robot.chain.forward(&mut state);
        let crate_at = crate_at(t_s);
        for (link, points) in links.iter().enumerate() {
            let pose = state.link_in_root(LinkId(link));
            if distance_m(pose.translation, crate_at) - radii[link] > least {
                continue;
            }
            for p in points {
                let distance = distance_m(pose.transform_point(*p), crate_at);
                if distance < least {
                    (least, when) = (distance, t_s);
                }
            }
        }
    }
    (least, when)
}

/// Distance of a point from the crate, m.
fn distance_m(p: Vec3, crate_at: Point2) -> f64 {
    let outside = |x: f64, half: f64| (x.abs() - half).max(0.0);
    let x = outside(p.x - crate_at.x, SIZE[0] / 2.0);
    let y = outside(p.y - crate_at.y, SIZE[1] / 2.0);
    let z = outside(p.z - SIZE[2] / 2.0, SIZE[2] / 2.0);
    (x * x + y * y + z * z).sqrt()
}

/// Comparison of the obstacles seen with the ground truth.
#[derive(Debug, Default)]
struct Score {
    due: usize,
    seen: usize,
    contained: usize,
    false_alarms: usize,
    /// Errors of the centres, in increasing order.
    centres_m: Vec<f64>,
    /// Errors of the centres before the camera knows the kind, and with it the height: the centre is then that of the
    /// hidden floor, which the view from one side moves outwards.
    of_unknown_height_m: Vec<f64>,
}

fn score(records: &[Value], leaves_s: f64) -> Score {
    let mut score = Score::default();
    for record in records.iter().filter(|r| r["status"] == "accepted") {
        let t_s = record["t_s"].as_f64().unwrap();
        let truth = crate_at(t_s, leaves_s);
        let obstacles = record["obstacles"].as_array().unwrap();
        let centre = |o: &Value| Point2::new(o["centre_m"][0].as_f64().unwrap(), o["centre_m"][1].as_f64().unwrap());
        let near = obstacles.iter().find(|o| (centre(o) - truth).length() < 0.5);
        let is_there = t_s >= 0.0;
        score.false_alarms += obstacles.len() - usize::from(near.is_some() && is_there);
        // Wholly within the picture and the area.
        if !is_there || truth.x > 4.2 {
            continue;
        }
        score.due += 1;
        let Some(near) = near else { continue };
        score.seen += 1;
        let knows_height = near["height_m"].as_f64().unwrap() < 2.0 * SIZE[2];
        let errors = if knows_height { &mut score.centres_m } else { &mut score.of_unknown_height_m };
        errors.push((centre(near) - truth).length());
        let corner = |p: &Value| Point2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap());
        let outline: Vec<Point2> = near["outline_m"].as_array().unwrap().iter().map(corner).collect();
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let inside =
            |&(x, y): &(f64, f64)| polygon::convex_contains(&outline, truth + Point2::new(x * SIZE[0], y * SIZE[1]));
        score.contained += usize::from(corners.iter().all(inside));
    }
    score.centres_m.sort_by(f64::total_cmp);
    score
}

fn run(dir: &Path) -> Answer {
    elbowroom(dir, &["run", "cell.toml", "--out", "out", "--json"])
}

fn records(dir: &Path, name: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(dir.join("out").join(name)).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn events(dir: &Path) -> String {
    std::fs::read_to_string(dir.join("out/events.csv")).unwrap()
}

/// Prints the figures of a run and checks them.
fn check_run(dir: &Path, answer: &Answer, sensors: &str, records_name: &str) {
    let json = answer.json();
    let (robot, sensor) = (&json["robots"][0], &json[sensors][0]);
    let robot_model = load(&elbowroom_testkit::folder::model("kr125"), &LoadOptions::default()).unwrap().robot;
    let trace = std::fs::read_to_string(dir.join("out/trace.csv")).unwrap();
    let (least_m, when_s) = clearance(&trace, &robot_model, |t_s| crate_at(t_s, f64::INFINITY));
    let score = score(&records(dir, records_name), f64::INFINITY);
    let centre = |share: f64| score.centres_m[((score.centres_m.len() - 1) as f64 * share) as usize] * 1e3;
    let p = &robot["perception"];
    println!("{sensors}: recall {} of {}, wholly contained {}", score.seen, score.due, score.contained);
    println!("{sensors}: false alarms {}", score.false_alarms);
    println!("{sensors}: centre error median {:.0} mm, worst {:.0} mm", centre(0.5), centre(1.0));
    let unknown = &score.of_unknown_height_m;
    let worst_unknown_m = unknown.iter().copied().fold(0.0, f64::max);
    println!("{sensors}: before the height is known: {} frames, worst {:.0} mm", unknown.len(), worst_unknown_m * 1e3);
    let ms = |key: &str| sensor["processing_ns"][key].as_f64().unwrap() / 1e6;
    println!("{sensors}: frame to checked path median {:.1} ms, worst {:.1} ms", ms("p50"), ms("max"));
    println!(
        "{sensors}: new paths {} in motion, {} from rest, {} searches without one; waited {} s",
        p["replans_in_motion"], p["replans_from_rest"], p["replans_failed"], p["waited_s"]
    );
    println!("{sensors}: least distance to the true crate {:.0} mm at {when_s:.2} s", least_m * 1e3);
    let hoist = &json["regions"][0];
    println!("{sensors}: region entered {}, least distance {} m", hoist["entered"], hoist["min_distance_m"]);
    assert!(robot["outcome"] == "finished", "{robot}");
    assert!(score.due > 60 && score.seen == score.due && score.contained == score.due, "{score:?}");
    assert!(score.false_alarms == 0 && centre(1.0) < 50.0, "{score:?}");
    // At most twelve pictures, 0.5 s; each contains the crate.
    assert!(unknown.len() <= 12 && worst_unknown_m < 0.25, "{unknown:?}");
    assert!(p["replans_in_motion"].as_u64().unwrap() + p["replans_from_rest"].as_u64().unwrap() > 0, "{p}");
    let events = events(dir);
    let replan = events.lines().find(|l| l.ends_with(",kr,,replan")).unwrap_or_else(|| panic!("{events}"));
    // A search takes its time, counted from the use of the first picture that shows the crate.
    let replan_s: f64 = replan.split(',').next().unwrap().parse().unwrap();
    let shows = |r: &&Value| r["status"] == "accepted" && !r["obstacles"].as_array().unwrap().is_empty();
    let shown_s = records(dir, records_name).iter().find(shows).unwrap()["t_s"].as_f64().unwrap();
    assert!(replan_s >= shown_s + LATENCY_S + SEARCH_S - 1e-9, "{replan_s} s after {shown_s} s");
    assert!(p["longest_search_s"].as_f64().unwrap() < 2.0 * SEARCH_S, "{p}");
    // The points are 20 mm apart: no point of the surface is farther from one of them than 15 mm.
    assert!(least_m > 0.03, "{least_m} m at {when_s} s");
    assert!(hoist["entered"] == false, "{hoist}");
}

#[test]
fn the_arm_goes_around_a_crate_that_only_the_camera_knows() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    write_pictures(dir.path(), FRAMES, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    check_run(dir.path(), &answer, "cameras", "camera-above.jsonl");
    assert_eq!(answer.json()["cameras"][0]["learned"], LEARNING);
    // Without the camera the same program hits the crate, so the test would notice a run that ignores the camera.
    let blind = cell("", "planned");
    std::fs::write(dir.path().join("cell.toml"), blind).unwrap();
    run(dir.path()).expect(0);
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let robot = load(&elbowroom_testkit::folder::model("kr125"), &LoadOptions::default()).unwrap().robot;
    assert_eq!(clearance(&trace, &robot, |t_s| crate_at(t_s, f64::INFINITY)).0, 0.0);
}

#[test]
fn the_arm_goes_around_a_crate_that_only_point_clouds_know() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CLOUD, "planned")).unwrap();
    write_clouds(dir.path(), FRAMES, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    check_run(dir.path(), &answer, "clouds", "cloud-mast.jsonl");
    // Perception alone gives the same obstacles; the arm hides none of them.
    let watched = elbowroom(dir.path(), &["watch", "cell.toml", "--clouds", "clouds", "--json"]).expect(0);
    let lines: Vec<Value> = watched.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let score = score(&lines, f64::INFINITY);
    assert!(lines.len() == FRAMES && score.seen == score.due && score.false_alarms == 0, "{score:?}");
}

#[test]
fn a_path_on_the_map_goes_around_the_crate_too() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CLOUD, "planned\", planner = \"grid")).unwrap();
    write_clouds(dir.path(), FRAMES, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    check_run(dir.path(), &answer, "clouds", "cloud-mast.jsonl");
    // The wrist is not in the map, so it keeps its values.
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let mut rows = trace.lines();
    let columns: Vec<&str> = rows.next().unwrap().split(',').collect();
    let wrist: Vec<usize> = (0..columns.len()).filter(|i| columns[*i] == "q5").collect();
    let bent = 44.5_f64.to_radians();
    let is_held = |row: &str| row.split(',').nth(wrist[0]).unwrap().parse().is_ok_and(|q: f64| (q - bent).abs() < 1e-6);
    assert!(wrist.len() == 1 && rows.all(is_held), "{columns:?}");
}

/// Depth images of the crate in front of a learnt wall, 1 mm per step.
#[test]
fn pictures_of_depths_are_clouds() {
    const LEARNT: usize = 5;
    let dir = tempfile::tempdir().unwrap();
    let (fx, fy) = (lens().fx, lens().fy);
    let depth = format!("depth = {{ size = [320, 240], focal_px = [{fx:?}, {fy:?}], step = 1 }}");
    let sensor = CLOUD.replace("voxel = 50", &format!("voxel = 60\n{depth}")).replace("= 10", "= 5");
    std::fs::write(dir.path().join("cell.toml"), cell(&sensor, "planned")).unwrap();
    let folder = dir.path().join("clouds");
    std::fs::create_dir(&folder).unwrap();
    let mut times = "file,t_s\n".to_owned();
    for i in 0..LEARNT + 5 {
        let crate_at = Point2::new(2.0 + 0.1 * i as f64, 1.0);
        let mut pixels = Vec::new();
        for n in 0..320 * 240 {
            let (u, v) = (f64::from(n % 320) + 0.5 - 160.0, f64::from(n / 320) + 0.5 - 120.0);
            // Point at which the ray of a pixel meets a height above the floor; the picture's y is the world's, reversed.
            let at = |height: f64| Point2::new(1.7 + u / fx * (6.5 - height), -v / fy * (6.5 - height));
            let on_box = |height: f64, centre: Point2, size: [f64; 2]| {
                let p = at(height) - centre;
                p.x.abs() <= size[0] / 2.0 && p.y.abs() <= size[1] / 2.0
            };
            let top = if i >= LEARNT && on_box(SIZE[2], crate_at, [SIZE[0], SIZE[1]]) {
                SIZE[2]
            } else if on_box(0.5, Point2::new(3.0, -2.0), [1.0, 0.2]) {
                0.5
            } else {
                0.0
            };
            pixels.extend((((6.5 - top) * 1e3).round() as u16).to_be_bytes());
        }
        let name = format!("depth_{i:02}.png");
        let header = ImageHeader { width: 320, height: 240, format: PixelFormat::Grey16 };
        png::write(std::fs::File::create(folder.join(&name)).unwrap(), &header, &pixels).unwrap();
        writeln!(times, "{name},{:.2}", 0.1 * i as f64).unwrap();
    }
    std::fs::write(folder.join("times.csv"), times).unwrap();
    let watched = elbowroom(dir.path(), &["watch", "cell.toml", "--camera", "mast", "--json"]).expect(0);
    let lines: Vec<Value> = watched.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (i, line) in lines.iter().enumerate() {
        let obstacles = line["obstacles"].as_array().unwrap();
        if i < LEARNT {
            assert!(line["status"] == "learning" && obstacles.is_empty(), "{line}");
            continue;
        }
        assert!(line["status"] == "accepted" && obstacles.len() == 1, "{line}");
        let centre = &obstacles[0]["centre_m"];
        let error = Point2::new(centre[0].as_f64().unwrap() - 2.0 - 0.1 * i as f64, centre[1].as_f64().unwrap() - 1.0);
        let height_m = obstacles[0]["height_m"].as_f64().unwrap();
        assert!(error.length() < 0.05 && (height_m - SIZE[2]).abs() < 0.06, "{line}");
    }
    // A brightness image is not a depth image.
    std::fs::remove_dir_all(&folder).unwrap();
    write_pictures(dir.path(), LEARNING + 2, f64::INFINITY);
    std::fs::rename(dir.path().join("pictures"), &folder).unwrap();
    let watched = elbowroom(dir.path(), &["watch", "cell.toml", "--json"]).expect(0);
    assert!(watched.stdout.contains("16 bits") && !watched.stdout.contains("accepted"), "{}", watched.stdout);
}

#[test]
fn a_joint_move_waits_until_the_crate_has_left() {
    const LEAVES_S: f64 = 2.6;
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "joint")).unwrap();
    write_pictures(dir.path(), FRAMES + 60, LEAVES_S);
    let json = run(dir.path()).expect(0).json();
    let robot = &json["robots"][0];
    assert!(robot["outcome"] == "finished", "{robot}");
    let p = &robot["perception"];
    assert!(p["waited_s"].as_f64().unwrap() > 0.3 && p["replans_from_rest"] == 0 && p["replans_in_motion"] == 0, "{p}");
    let events = events(dir.path());
    assert!(events.contains(",kr,above#1,wait") && events.contains(",kr,above#1,stop"), "{events}");
    assert!(events.contains(",resume"), "{events}");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let robot_model = load(&elbowroom_testkit::folder::model("kr125"), &LoadOptions::default()).unwrap().robot;
    let (least_m, when_s) = clearance(&trace, &robot_model, |t_s| crate_at(t_s, LEAVES_S));
    println!("joint move: least distance to the true crate {:.0} mm at {when_s:.2} s", least_m * 1e3);
    assert!(least_m > 0.03, "{least_m} m at {when_s} s");
}

/// The crate stands at the goal of the arm: no search can find a path, and nothing changes.
#[test]
fn an_unchanged_crate_is_not_searched_around_for_ever() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned").replace("to = [-60,", "to = [0,")).unwrap();
    write_pictures(dir.path(), FRAMES, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    let robot = &answer.json()["robots"][0];
    let p = &robot["perception"];
    println!("{} searches without a path, the longest {} s", p["replans_failed"], p["longest_search_s"]);
    // The crate stands there from 2 s on for 4 s: four searches, each longer than the one before. Earlier searches are
    // in motion.
    assert!((1..=12).contains(&p["replans_failed"].as_u64().unwrap()), "{p}");
    assert!(p["longest_search_s"].as_f64().unwrap() < 10.0 * SEARCH_S, "{p}");
    // The pictures end, but the obstacle is the crate.
    assert!(robot["outcome"] == "stopped" && robot["by"] == "above#1", "{robot}");
}

/// An arm that does not move while the empty cell is learnt hides floor, which is reported at once; a moving arm hides
/// none.
#[test]
fn floor_that_the_arm_hid_from_the_first_pictures_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    write_pictures(dir.path(), LEARNING + 2, f64::INFINITY);
    let watched = |command: &[&str]| elbowroom(dir.path(), command).expect(0);
    let moving = watched(&["watch", "cell.toml", "--json"]);
    assert!(!moving.stderr.contains("hidden") && !moving.stdout.contains("hidden_floor"), "{}", moving.stderr);
    let joints = "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n";
    let q = learning_joints(0.0).map(|v| format!("{v:.9}")).join(",");
    std::fs::write(dir.path().join("learning.csv"), format!("{joints}-2,{q}\n0,{q}\n")).unwrap();
    let standing = watched(&["watch", "cell.toml", "--json"]);
    let (before, said) = standing.stdout.split_once("\"hidden_floor\":").expect("the record that ends learning");
    assert_eq!(before.lines().count(), LEARNING, "{said}");
    for answer in [standing.stderr, watched(&["run", "cell.toml"]).stderr] {
        assert!(answer.contains("m² of the floor") && answer.contains("cell.toml:"), "{answer}");
    }
}

#[test]
fn a_camera_that_sees_no_more_stops_the_arm() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    // The last picture is taken at 0.36 s: from 0.86 s on the obstacles are unknown.
    write_pictures(dir.path(), LEARNING + 10, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    let robot = &answer.json()["robots"][0];
    assert!(robot["outcome"] == "stopped" && robot["by"] == "above" && robot["min_override"] == 0.0, "{robot}");
    assert!(robot["release"].as_str().unwrap().contains("above sees again"), "{robot}");
    let stopped_s = robot["stopped_at_s"].as_f64().unwrap();
    assert!((0.86..1.2).contains(&stopped_s), "{robot}");
    let events = events(dir.path());
    let stale = events.lines().find(|l| l.ends_with(",kr,above,stale")).unwrap_or_else(|| panic!("{events}"));
    let stale_s: f64 = stale.split(',').next().unwrap().parse().unwrap();
    assert!((stale_s - 0.86).abs() < 0.01, "{stale}");
    let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(text.contains("above has sent nothing usable for too long") && text.contains("40 pictures"), "{text}");
}

#[test]
fn an_arm_does_not_move_before_its_camera_has_seen_anything() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell(CAMERA, "planned")).unwrap();
    // The empty cell is learnt, and no pictures follow.
    write_pictures(dir.path(), LEARNING, f64::INFINITY);
    let answer = run(dir.path()).expect(0);
    let robot = &answer.json()["robots"][0];
    assert!(robot["outcome"] == "stopped" && robot["by"] == "above", "{robot}");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let first_joint: Vec<&str> = trace.lines().skip(1).filter_map(|row| row.split(',').nth(2)).collect();
    assert!(first_joint.len() > 100 && first_joint.iter().all(|q| *q == first_joint[0]), "it moved");
}

#[test]
fn the_map_of_a_sensor_has_three_joints() {
    let dir = tempfile::tempdir().unwrap();
    write_pictures(dir.path(), 1, f64::INFINITY);
    let two = cell(CAMERA, "planned").replace("[map.kr]\n", "[map.kr]\njoints = [\"joint_1\", \"joint_2\"]\n");
    std::fs::write(dir.path().join("cell.toml"), two).unwrap();
    let said = run(dir.path()).expect(2).stderr;
    assert!(said.contains("has 2 joints: obstacles of a camera need 3") && said.contains("\"joint_3\"]"), "{said}");
}

#[test]
fn keys_of_sensors_are_checked() {
    let dir = tempfile::tempdir().unwrap();
    let of = |cell: &str| {
        std::fs::write(dir.path().join("cell.toml"), cell).unwrap();
        run(dir.path()).expect(2).stderr
    };
    std::fs::write(dir.path().join("learning.csv"), "t_s\n").unwrap();
    let (camera, cloud) = (cell(CAMERA, "planned"), cell(CLOUD, "planned"));
    assert!(of(&camera).contains("a folder of pictures"));
    assert!(of(&cloud).contains("a folder of point clouds"));
    for (good, from, to, expected) in [
        (&camera, "latency_ms = 60", "latency_ms = -1", "must be 0 or more"),
        (&camera, "latency_ms = 60", "latency_ms = 60\nstale_ms = 50", "longer than the latency"),
        (&camera, "latency_ms = 60", "latency_ms = 60\nstale_ms = 0", "above 0"),
        (&camera, "latency_ms = 60", "search_ms = 0", "above 0"),
        (&camera, "latency_ms = 60", "search_ms = 1e300", "60000"),
        (&camera, "latency_ms = 60", "robots = [\"kuka\"]", "kuka"),
        (&camera, "latency_ms = 60", "robots = [\"kr\", \"kr\"]", "second time"),
        (&camera, "latency_ms = 60", "robots = \"kr\"", "a list"),
        (&camera, "latency_ms = 60", "latency = 60", "latency_ms"),
        (&cloud, "voxel = 50", "voxel = 0", "above 0"),
        (&cloud, "voxel = 50", "voxels = 50", "voxel"),
        (&cloud, "learning_clouds = 10", "learning_clouds = 1.5", "whole number"),
        (&cloud, "pose = {", "poses = {", "pose"),
        (&cloud, "clouds = \"clouds\"", "clouds = \"\"", "names no folder"),
        (&cloud, "voxel = 50", "depth = { size = [320, 240], focal_px = 300 }", "needs the key `step`"),
        (&cloud, "voxel = 50", "depth = { focal_px = 300, step = 1 }", "needs the key `size`"),
        (&cloud, "voxel = 50", "depth = { size = [320, 240], focal_px = 300, step = 0 }", "above 0"),
    ] {
        let message = of(&good.replacen(from, to, 1));
        assert!(message.contains(expected) && message.contains("cell.toml:"), "{from} -> {to}: {message}");
    }
}
