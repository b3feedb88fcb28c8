//! `elbowroom watch`: rendered pictures of a moving crate under a moving arm, through files alone; the ground truth is
//! kept separate.

use crate::common;
use std::fmt::Write;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use crate::common::{Answer, elbowroom};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::perception::WatchedRobot;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom::vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom::vision::{Camera, Channels, Frame, Intrinsics, Point2, encode_png, polygon};
use serde_json::Value;

const PERIOD_S: f64 = 0.04;
const FRAMES: usize = 140;
const LEARNING: usize = 30;
/// Index of a truncated picture.
const DAMAGED: usize = 90;
const SIZE: [f64; 2] = [0.6, 0.4];

const CAMERA: &str = r#"
[camera.above]
size = [320, 240]
focal_px = FOCAL
pose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }
area = [[750, -3000], [4800, -3000], [4800, 3000], [750, 3000]]
learning_frames = 30
uncertainty = 90
templates = [{ name = "crate", size = [600, 400], height = 300 }]
frames = "pictures"
joints = "joints.csv"
"#;

fn lens() -> Intrinsics {
    Intrinsics::pinhole(320, 240, 0.92)
}

fn cell() -> String {
    let model = elbowroom_testkit::folder::model("kr125");
    let head = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.kr]\nmodel = {:?}\n[map.kr]\nstep = 4\n",
        model.display().to_string()
    );
    head + &CAMERA.replace("FOCAL", &format!("[{:?}, {:?}]", lens().fx, lens().fy))
}

/// Joint values: the arm swings back and forth over the floor while the floor is learnt, and then waits on the other side.
fn joints_at(t_s: f64) -> Vec<f64> {
    let waist = if t_s < LEARNING as f64 * PERIOD_S { 60.0 * (t_s * 5.0).cos() } else { 150.0 };
    [waist, -31.1, 76.6, 0.0, 44.5, 0.0].map(f64::to_radians).to_vec()
}

/// Position of the crate, from the time at which it enters.
fn crate_at(t_s: f64) -> Option<Point2> {
    let y = -3.6 + 1.2 * (t_s - LEARNING as f64 * PERIOD_S);
    (t_s >= LEARNING as f64 * PERIOD_S).then_some(Point2::new(2.2, y))
}

/// Writes pictures, their times and the joint values, as files.
fn write_pictures(dir: &Path) {
    let folder = dir.join("pictures");
    std::fs::create_dir(&folder).unwrap();
    let camera = Camera::look_at(lens(), Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y).unwrap();
    let model = elbowroom_testkit::folder::model("kr125");
    let robot = load(&model, &LoadOptions::default()).unwrap().robot;
    let arm = WatchedRobot { robot, base_in_world: Pose::IDENTITY };
    let mut renderer = Renderer::new(camera, Channels::Grey, 5);
    let (mut frame, mut times) = (Frame::default(), "file,t_s\n".to_owned());
    for i in 0..FRAMES {
        let t_s = i as f64 * PERIOD_S;
        let drawn: Vec<_> = arm.parts(&joints_at(t_s)).into_iter().map(|part| (part, 200)).collect();
        let solids: Vec<_> = crate_at(t_s)
            .map(|at| RenderedSolid::cuboid(at, Vec3::new(SIZE[0], SIZE[1], 0.3), 0.0, 40))
            .into_iter()
            .collect();
        let conditions = RenderConditions { seed: i as u64, ..RenderConditions::default() };
        renderer.render(&solids, &drawn, &conditions, &mut frame).unwrap();
        let mut png = encode_png(&frame).unwrap();
        if i == DAMAGED {
            png.truncate(png.len() / 2);
        }
        let name = format!("frame_{i:04}.png");
        std::fs::write(folder.join(&name), png).unwrap();
        writeln!(times, "{name},{t_s:.3}").unwrap();
    }
    std::fs::write(folder.join("times.csv"), times).unwrap();
    let chain = &arm.robot.chain;
    let names: Vec<&str> = chain.active_joints().iter().map(|j| &chain.joints()[j.0].name[..]).collect();
    let mut joints = format!("t_s,{}\n", names.join(","));
    for i in 0..=FRAMES * 4 {
        let t_s = i as f64 * 0.01;
        let q: Vec<String> = joints_at(t_s).iter().map(|v| format!("{v:.9}")).collect();
        writeln!(joints, "{t_s:.3},{}", q.join(",")).unwrap();
    }
    std::fs::write(dir.join("joints.csv"), joints).unwrap();
}

fn watch(dir: &Path, args: &[&str]) -> Answer {
    elbowroom(dir, &[&["watch", "cell.toml"], args].concat())
}

/// Comparison of the pictures with the ground truth.
#[derive(Debug, Default)]
struct Score {
    due: usize,
    seen: usize,
    contained: usize,
    false_alarms: usize,
    worst_centre_m: f64,
}

fn score(records: &[Value]) -> Score {
    let mut score = Score::default();
    for (i, record) in records.iter().enumerate().skip(LEARNING) {
        let truth = crate_at(i as f64 * PERIOD_S).unwrap();
        let obstacles = record["obstacles"].as_array().unwrap();
        let centre = |o: &Value| Point2::new(o["centre_m"][0].as_f64().unwrap(), o["centre_m"][1].as_f64().unwrap());
        let near = obstacles.iter().find(|o| (centre(o) - truth).length() < 0.5);
        score.false_alarms += obstacles.len() - usize::from(near.is_some());
        // Wholly within the picture, which shows 4.8 m of the floor.
        if truth.y.abs() > 2.0 || i == DAMAGED {
            continue;
        }
        score.due += 1;
        let Some(near) = near else { continue };
        score.seen += 1;
        score.worst_centre_m = score.worst_centre_m.max((centre(near) - truth).length());
        let outline: Vec<Point2> = near["outline_m"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| Point2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap()))
            .collect();
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let inside =
            |&(x, y): &(f64, f64)| polygon::convex_contains(&outline, truth + Point2::new(x * SIZE[0], y * SIZE[1]));
        score.contained += usize::from(corners.iter().all(inside));
    }
    score
}

#[test]
fn a_crate_is_tracked_from_files_alone() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell()).unwrap();
    write_pictures(dir.path());
    let answer = watch(dir.path(), &["--json"]).expect(0);
    let records: Vec<Value> = answer.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(records.len(), FRAMES);
    assert!(records[..LEARNING].iter().all(|r| r["status"] == "learning" && r["blocked"] == 0));
    let score = score(&records);
    assert!(score.due > 70 && score.seen == score.due && score.contained == score.due, "{score:?}");
    assert!(score.false_alarms == 0 && score.worst_centre_m < 0.15, "{score:?}");
    // One crate enters once, and blocks cells while it is within reach.
    let entered: usize = records.iter().map(|r| r["entered"].as_array().unwrap().len()).sum();
    assert_eq!(entered, 1, "{score:?}");
    let blocked = |i: usize| records[i]["blocked"].as_u64().unwrap();
    assert!((LEARNING + 60..LEARNING + 90).any(|i| blocked(i) > 0));
    // The damaged picture changes nothing, and the record gives the reason.
    let damaged = &records[DAMAGED];
    assert!(
        damaged["status"] == "rejected" && damaged["reason"].as_str().unwrap().contains("frame_0090.png"),
        "{damaged}"
    );
    assert!(
        damaged["blocked"] == records[DAMAGED - 1]["blocked"]
            && damaged["obstacles"] == records[DAMAGED - 1]["obstacles"]
    );
    let kinds = records.iter().flat_map(|r| r["obstacles"].as_array().unwrap().clone());
    assert!(kinds.filter(|o| o["kind"] == "crate").count() > 50, "the template is found");
    let text = watch(dir.path(), &[]).expect(0).stdout;
    assert!(
        text.contains("entered at 2.") && text.contains("rejected:") && text.contains("30 pictures learnt"),
        "{text}"
    );
}

/// `ffmpeg -f image2pipe -c:v png -` writes the pictures one after another.
#[test]
fn a_stream_of_pictures_gives_what_the_folder_gives() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell()).unwrap();
    write_pictures(dir.path());
    let picture = |i: usize| std::fs::read(dir.path().join(format!("pictures/frame_{i:04}.png"))).unwrap();
    let all: Vec<u8> = (0..DAMAGED).flat_map(picture).collect();
    let stream = |args: &[&str], bytes: &[u8]| {
        let mut child = common::command(dir.path(), &[&["watch", "cell.toml", "--frames", "-"], args].concat())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        let bytes = bytes.to_vec();
        // The command prints while it reads, so both pipes must be served.
        let writer = std::thread::spawn(move || drop(input.write_all(&bytes)));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        common::answer(output)
    };
    let parse = |answer: &Answer| -> Vec<Value> {
        answer.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let folder = parse(&watch(dir.path(), &["--json"]).expect(0));
    let streamed = parse(&stream(&["--fps", "25", "--json"], &all).expect(0));
    assert_eq!(streamed.len(), DAMAGED);
    for (a, b) in streamed.iter().zip(&folder) {
        assert!((a["t_s"].as_f64().unwrap() - b["t_s"].as_f64().unwrap()).abs() < 1e-9);
        assert!(
            a["status"] == b["status"]
                && a["obstacles"].as_array().unwrap().len() == b["obstacles"].as_array().unwrap().len()
        );
    }
    // Without --fps the stamps are times of arrival: they increase.
    std::fs::write(dir.path().join("cell.toml"), cell().replace("joints = \"joints.csv\"\n", "")).unwrap();
    let arrived = parse(&stream(&["--json"], &all[..]).expect(0));
    let times: Vec<f64> = arrived.iter().map(|r| r["t_s"].as_f64().unwrap()).collect();
    assert!(times.len() == DAMAGED && times.windows(2).all(|w| w[0] < w[1]), "{times:?}");
    // Bytes that are not a stream of pictures are reported, with the number of the picture.
    let cut = &all[..picture(0).len() + 100];
    let message = stream(&["--json"], cut).expect(2).stderr;
    assert!(message.contains("picture 1: the stream ends within a picture") && message.contains("ffmpeg"), "{message}");
    assert!(stream(&[], b"JFIF and so on").expect(2).stderr.contains("no PNG picture"));
    assert!(stream(&["--fps", "0"], &all).expect(2).stderr.contains("--fps 25"));
    assert!(watch(dir.path(), &["--fps", "25", "--frames", "pictures"]).expect(2).stderr.contains("--frames -"));
}

#[test]
fn what_is_missing_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let of = |cell: &str, args: &[&str]| {
        std::fs::write(dir.path().join("cell.toml"), cell).unwrap();
        watch(dir.path(), args).expect(2).stderr
    };
    let good = cell();
    let without = good.split("[camera").next().unwrap().to_owned();
    assert!(of(&without, &[]).contains("[camera.NAME]"));
    assert!(of(&good, &["--camera", "abov"]).contains("above"));
    std::fs::write(dir.path().join("joints.csv"), "t_s\n").unwrap();
    assert!(of(&good, &[]).contains("a folder of pictures"));
    for (from, to, expected) in [
        ("learning_frames = 30", "learning_frames = 1", "learning_frames"),
        (
            "area = [[750, -3000], [4800, -3000], [4800, 3000], [750, 3000]]",
            "area = [[750, -3000], [4800, -3000]]",
            "three or more",
        ),
        ("size = [320, 240]\n", "", "needs the key `size`"),
        ("size = [320, 240]\n", "size = [320]\n", "needs 2 numbers"),
        ("size = [320, 240]\n", "size = [320, 240]\ndistortion = [0, 0, 0, 1]\n", "k1, k2 and k3"),
        ("rpy = [180, 0, 0]", "rpy = [90, 0, 0]", "camera.above"),
        ("height = 300", "higth = 300", "height"),
        ("size = [600, 400], height", "height", "either `size` or `diameter`"),
        ("uncertainty = 90", "uncertainty = -1", "0 or more"),
        ("learning_frames = 30", "robot = \"kuka\"", "kuka"),
    ] {
        let message = of(&good.replacen(from, to, 1), &[]);
        assert!(message.contains(expected) && message.contains("cell.toml:"), "{from} -> {to}: {message}");
    }
    assert!(elbowroom(dir.path(), &["check", "cell.toml"]).stderr.contains("kuka"), "every verb reads the table");
}

#[test]
fn wrong_flags_are_refused_with_what_to_write() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    for folder in ["empty", "times", "two", "good"] {
        std::fs::create_dir(dir.path().join(folder)).unwrap();
    }
    for picture in ["times/a.png", "two/a.png", "two/b.png", "good/a.png"] {
        write(picture, "");
    }
    write("two/times.csv", "file,t_s\na.png,1\nb.png,1\n");
    write("good/times.csv", "file,t_s\na.png,0\n");
    write("joints.csv", "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0,0\n");
    write("no_time.csv", "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0\n");
    write("five.csv", "t_s,joint_1,joint_2,joint_3,joint_4,joint_5\n0,0,0,0,0,0\n");
    write("word.csv", "t_s,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0,0\n1,0,0,x,0,0,0\n");
    let one = cell();
    let two = one.clone() + &CAMERA.replace("above", "beside").replace("FOCAL", "300");
    let none = one.split("[camera").next().unwrap().to_owned();
    let good = ["--frames", "good"];
    let cases: &[(&str, &[&str], &str, &str)] = &[
        (&one, &["--camera", "abov"], "cell.toml: has no camera \"abov\"", "above"),
        (&two, &[], "cell.toml: has several cameras", "--camera above"),
        (&none, &["--camera", "above"], "cell.toml: has no camera", "[camera.NAME]"),
        (&one, &["--frames", "nowhere"], "nowhere: cannot be read", "a folder of pictures"),
        (&one, &["--frames", "empty"], "empty: has no picture", "with times.csv"),
        (&one, &["--frames", "times"], "times.csv: cannot be read", "the header file,t_s"),
        (&one, &["--frames", "two"], "times.csv:3: b.png has the time 1 after 1", "rise together"),
        (&one, &[&good[..], &["--joints", "nowhere.csv"]].concat(), "nowhere.csv: cannot be read", "write: "),
        (&one, &[&good[..], &["--joints", "no_time.csv"]].concat(), "no_time.csv:1: ", "t_s"),
        (&one, &[&good[..], &["--joints", "five.csv"]].concat(), "five.csv:1: ", "joint_6"),
        (&one, &[&good[..], &["--joints", "word.csv"]].concat(), "word.csv:3: ", "joint_3"),
    ];
    for (cell, args, what, hint) in cases {
        write("cell.toml", cell);
        let refused = watch(dir.path(), args).expect(2);
        assert!(refused.stderr.contains(what) && refused.stderr.contains(hint), "{args:?}: {}", refused.stderr);
        assert!(refused.stdout.is_empty(), "{args:?}: {}", refused.stdout);
    }
}
