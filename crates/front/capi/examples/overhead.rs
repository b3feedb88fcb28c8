//! What a call through the C functions costs beside the call in Rust: `cargo run --release -p elbowroom-capi --example overhead`.
//!
//! Two arms side by side at 20,000 states; both ways set the joint values and ask for the distance, in turn.
#![allow(clippy::print_stdout, reason = "it prints what it measures")]
#![allow(unsafe_code, reason = "it calls the functions as C does")]

use std::error::Error;
use std::mem::MaybeUninit;
use std::time::Instant;

use elbowroom::cell::{OutOfReachProofs, QueryModel};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::query::{QueryChecker, QueryKind, QueryPairs};
use elbowroom::robot::RobotId;
use elbowroom::scene::CheckerOptions;
use elbowroom::spatial::{Pose, Vec3};
use elbowroom_capi::exports::{
    elbowroom_checker_distance, elbowroom_checker_free, elbowroom_checker_new, elbowroom_checker_set_q,
    elbowroom_model_free, elbowroom_model_load_robots,
};
use elbowroom_capi::{PoseRecord, RobotFile, Status};
use elbowroom_testkit::random::Random;

const STATES: usize = 20_000;
const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let path = elbowroom_testkit::folder::model("rx60b");
    let srdf = path.with_extension("srdf");
    let options = LoadOptions { srdf: Some(srdf.clone()), ..LoadOptions::default() };
    let robot = load(&path, &options)?.robot;
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let mut random = Random(3);
    let mut q = || -> Vec<f64> { lower.iter().zip(&upper).map(|(l, u)| random.between(*l, *u)).collect() };
    let states: Vec<[Vec<f64>; 2]> = (0..STATES).map(|_| [q(), q()]).collect();

    let right = Pose { translation: Vec3::new(0.0, 0.7, 0.0), ..Pose::IDENTITY };
    let robots = [("left".to_owned(), robot.clone(), Pose::IDENTITY), ("right".to_owned(), robot, right)];
    let model = QueryModel::of_robots(&path, robots);
    let scene = model.scene(OutOfReachProofs::Compute)?;
    let mut state = model.start_state(&scene)?;
    let mut checker = QueryChecker::new(&scene, CheckerOptions::default(), &QueryPairs::all());
    let mut in_rust = || -> Result<f64, Box<dyn Error>> {
        let begin = Instant::now();
        let mut sum = 0.0;
        for q in &states {
            for (robot, q) in q.iter().enumerate() {
                state.set_q(&scene, RobotId(robot), q)?;
            }
            sum += checker.row(&state, QueryKind::Distance).distance_m.unwrap_or(f64::NAN);
        }
        println!("  Rust {:.4} us per state (sum of distances {sum:.9} m)", micros(begin));
        Ok(micros(begin))
    };

    let [path, srdf] = [&path, &srdf].map(|path| std::ffi::CString::new(path.to_string_lossy().as_ref()));
    let (path, srdf) = (path?, srdf?);
    let file = |name: &'static std::ffi::CStr, y: f64| RobotFile {
        name: name.as_ptr(),
        path: path.as_ptr(),
        srdf: srdf.as_ptr(),
        joints: std::ptr::null(),
        unit: std::ptr::null(),
        base_in_world: PoseRecord { position_m: [0.0, y, 0.0], quaternion_xyzw: [0.0, 0.0, 0.0, 1.0] },
    };
    let files = [file(c"left", 0.0), file(c"right", 0.7)];
    let mut place = MaybeUninit::new(None);
    // SAFETY: two files whose texts live until the end of this function.
    let status = unsafe { elbowroom_model_load_robots(files.as_ptr(), 2, std::ptr::null(), Some(&mut place)) };
    assert_eq!(status, Status::Ok);
    // SAFETY: it was initialized, and the library wrote a handle.
    let model = unsafe { place.assume_init() };
    let mut place = MaybeUninit::new(None);
    // SAFETY: no text.
    let status = unsafe { elbowroom_checker_new(model.as_deref(), 0, std::ptr::null(), Some(&mut place)) };
    assert_eq!(status, Status::Ok);
    // SAFETY: as above.
    let mut checker = unsafe { place.assume_init() };
    let mut in_c = || -> f64 {
        let begin = Instant::now();
        let mut sum = 0.0;
        for q in &states {
            for (robot, q) in q.iter().enumerate() {
                // SAFETY: an array and its length.
                unsafe { elbowroom_checker_set_q(checker.as_deref_mut(), robot, q.as_ptr(), q.len()) };
            }
            let mut answer = MaybeUninit::uninit();
            assert_eq!(elbowroom_checker_distance(checker.as_deref_mut(), Some(&mut answer)), Status::Ok);
            // SAFETY: the call succeeded, so it wrote the answer.
            sum += unsafe { answer.assume_init() }.distance_m;
        }
        println!("  C    {:.4} us per state (sum of distances {sum:.9} m)", micros(begin));
        micros(begin)
    };

    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        least = [least[0].min(in_rust()?), least[1].min(in_c())];
    }
    println!(
        "least: Rust {:.4} us, C {:.4} us, difference {:.4} us per state of three calls",
        least[0],
        least[1],
        least[1] - least[0]
    );
    elbowroom_checker_free(checker);
    elbowroom_model_free(model);
    Ok(())
}

/// Microseconds per state since a time.
fn micros(begin: Instant) -> f64 {
    1e6 * begin.elapsed().as_secs_f64() / STATES as f64
}
