//! What a call through the C functions costs beside the call in Rust: `cargo run --release -p elbowroom-capi --example overhead`.
//!
//! Two arms side by side at 20,000 states; both ways set the joint values of both arms and ask for the distance of the boxes of
//! two links, in turn: an answer so cheap that what the call adds can be seen.
#![allow(clippy::print_stdout, reason = "it prints what it measures")]
#![allow(unsafe_code, reason = "it calls the functions as C does")]

use std::error::Error;
use std::ffi::{CStr, CString};
use std::hint::black_box;
use std::mem::MaybeUninit;
use std::path::Path;
use std::time::Instant;

use elbowroom::cell::{OutOfReachProofs, QueryModel};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::query::{Level, QueryChecker, QueryKind, QueryPairs};
use elbowroom::robot::{Robot, RobotId};
use elbowroom::scene::CheckerOptions;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom_capi::exports::{
    elbowroom_checker_distance, elbowroom_checker_free, elbowroom_checker_new, elbowroom_checker_set_q,
    elbowroom_model_free, elbowroom_model_load_robots,
};
use elbowroom_capi::{LevelCode, ModelHandle, PoseRecord, RobotFile, StateChecker, Status};
use elbowroom_testkit::random::Random;

const STATES: usize = 20_000;
const ROUNDS: usize = 51;
/// The pair that is asked for.
const PAIR: &CStr = c"left/link_3,right/link_3";

/// The distance between the bases, m.
const APART_M: f64 = 0.7;

type States = [[Vec<f64>; 2]];

fn main() -> Result<(), Box<dyn Error>> {
    let path = elbowroom_testkit::folder::model("rx60b");
    let options = LoadOptions { srdf: Some(path.with_extension("srdf")), ..LoadOptions::default() };
    let robot = load(&path, &options)?.robot;
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let mut random = Random(3);
    let mut q = || -> Vec<f64> { lower.iter().zip(&upper).map(|(l, u)| random.between(*l, *u)).collect() };
    let states: Vec<[Vec<f64>; 2]> = (0..STATES).map(|_| [q(), q()]).collect();

    let (model, mut in_c) = checker_in_c(&path)?;
    let mut least = [f64::INFINITY; 2];
    for_rounds_in_rust(&path, robot, &states, |rust_us| {
        let c_us = round_in_c(&mut in_c, &states);
        least = [least[0].min(rust_us), least[1].min(c_us)];
    })?;
    let [rust, c] = least;
    println!("least of {ROUNDS}: Rust {rust:.4} us, C {c:.4} us, {:.4} us more for three calls", c - rust);
    elbowroom_checker_free(in_c);
    elbowroom_model_free(model);
    Ok(())
}

/// Measures rounds in Rust, and calls `beside` with the time of each, us per state.
fn for_rounds_in_rust(
    path: &Path,
    robot: Robot,
    states: &States,
    mut beside: impl FnMut(f64),
) -> Result<(), Box<dyn Error>> {
    let right = Pose { translation: Vec3::new(0.0, APART_M, 0.0), ..Pose::IDENTITY };
    let robots = [("left".to_owned(), robot.clone(), Pose::IDENTITY), ("right".to_owned(), robot, right)];
    let model = QueryModel::of_robots(path, robots);
    let scene = model.scene(OutOfReachProofs::Compute)?;
    let mut state = model.start_state(&scene)?;
    let pairs = QueryPairs::between(PAIR.to_str()?, &mut model.clone(), None)?;
    let options = CheckerOptions { level: Level::L2, ..CheckerOptions::default() };
    let mut checker = QueryChecker::new(&scene, options, &pairs);
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        let mut sum = 0.0;
        for q in states {
            for (robot, q) in q.iter().enumerate() {
                state.set_q(&scene, RobotId(robot), q)?;
            }
            sum += checker.row(&state, QueryKind::Distance).distance_m.unwrap_or(f64::NAN);
        }
        let us = micros(begin);
        black_box(sum);
        beside(us);
    }
    Ok(())
}

type Handles = (Option<Box<ModelHandle>>, Option<Box<StateChecker>>);

/// Loads the arms, and makes a checker, as C does.
fn checker_in_c(path: &Path) -> Result<Handles, Box<dyn Error>> {
    let text = |path: &Path| CString::new(path.to_string_lossy().as_ref());
    let (path, srdf) = (text(path)?, text(&path.with_extension("srdf"))?);
    let file = |name: &'static CStr, y: f64| RobotFile {
        name: name.as_ptr(),
        path: path.as_ptr(),
        srdf: srdf.as_ptr(),
        joints: std::ptr::null(),
        unit: std::ptr::null(),
        base_in_world: PoseRecord { position_m: [0.0, y, 0.0], quaternion_xyzw: [0.0, 0.0, 0.0, 1.0] },
    };
    let files = [file(c"left", 0.0), file(c"right", APART_M)];
    let (mut model, mut checker) = (MaybeUninit::new(None), MaybeUninit::new(None));
    // SAFETY: two files, whose texts live until the end of this function.
    let status = unsafe { elbowroom_model_load_robots(files.as_ptr(), 2, std::ptr::null(), Some(&mut model)) };
    assert_eq!(status, Status::Ok);
    // SAFETY: it was initialized before the library wrote a handle.
    let model = unsafe { model.assume_init() };
    // SAFETY: a text that is never freed.
    let status =
        unsafe { elbowroom_checker_new(model.as_deref(), LevelCode::L2 as i32, PAIR.as_ptr(), Some(&mut checker)) };
    assert_eq!(status, Status::Ok);
    // SAFETY: it was initialized before the library wrote a handle.
    Ok((model, unsafe { checker.assume_init() }))
}

/// One round through the functions of C, us per state.
fn round_in_c(checker: &mut Option<Box<StateChecker>>, states: &States) -> f64 {
    let begin = Instant::now();
    let mut sum = 0.0;
    for q in states {
        for (robot, q) in q.iter().enumerate() {
            // SAFETY: an array and its length.
            unsafe { elbowroom_checker_set_q(checker.as_deref_mut(), robot, q.as_ptr(), q.len()) };
        }
        let mut answer = MaybeUninit::uninit();
        assert_eq!(elbowroom_checker_distance(checker.as_deref_mut(), Some(&mut answer)), Status::Ok);
        // SAFETY: the call succeeded, so it wrote the answer.
        sum += unsafe { answer.assume_init() }.distance_m;
    }
    let us = micros(begin);
    black_box(sum);
    us
}

/// Microseconds per state since a time.
fn micros(begin: Instant) -> f64 {
    1e6 * begin.elapsed().as_secs_f64() / STATES as f64
}
