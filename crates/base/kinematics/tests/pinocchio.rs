//! Every robot of the data compared with Pinocchio: poses, velocities and accelerations of all links at 100 random
//! configurations, 1,000 with `ELBOWROOM_LONG=1`.
//!
//! Needs a Python with `pin` and `numpy`, given by `ELBOWROOM_PYTHON` (default `python3`); without it the test
//! prints a message and passes.
#![allow(clippy::print_stdout)]

use crate::common;
use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::common::{RandomGeometry, SplitMix, robots};
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_testkit::python::with_modules;

const TOLERANCE: f64 = 1e-9;

/// Number of random configurations of each robot.
fn states() -> usize {
    elbowroom_testkit::extent::amount(100, 1000)
}

/// A Python process with Pinocchio that answers for all robots in turn: starting it takes longer than its answers.
struct Reference {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Reference {
    fn start(python: &str) -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/pin_reference.py");
        let mut process =
            Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (input, output) = (process.stdin.take().unwrap(), BufReader::new(process.stdout.take().unwrap()));
        Self { process, input, output }
    }

    /// Poses, velocities and accelerations of all links at each of the states; `states` has one state per line.
    fn motions(&mut self, urdf: &Path, chain: &Chain, states: &str) -> Vec<f64> {
        let names: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
        let (count, file) = (states.lines().count(), urdf.display());
        let header = format!("{file}\t{}\t{}\t{count}\n", names.join(","), chain.links().join(","));
        let (input, output) = (&mut self.input, &mut self.output);
        std::thread::scope(|scope| {
            let writer =
                scope.spawn(move || input.write_all((header + states).as_bytes()).and_then(|()| input.flush()));
            let lines = output.lines().take(count * chain.links().len());
            let numbers = lines
                .flat_map(|line| line.unwrap().split_whitespace().map(|w| w.parse().unwrap()).collect::<Vec<f64>>());
            let numbers = numbers.collect();
            writer.join().unwrap().unwrap_or_else(|e| panic!("{file}: {e}"));
            numbers
        })
    }

    fn end(mut self) {
        drop(self.input);
        assert!(self.process.wait().unwrap().success());
    }
}

#[test]
fn poses_velocities_and_accelerations_match_pinocchio() {
    let Some(python) = with_modules("pinocchio, numpy", "`pin` and `numpy`") else { return };
    let mut reference = Reference::start(&python);
    let mut worst = [0.0_f64; 3];
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut random = SplitMix(99);
        let mut state = ChainState::new(&chain);
        let mut ours = Vec::new();
        let mut text = String::new();
        for _ in 0..states() {
            random.state(&chain, &mut state.q);
            state.qd.iter_mut().for_each(|v| *v = random.between(-2.0, 2.0));
            state.qdd.iter_mut().for_each(|v| *v = random.between(-5.0, 5.0));
            for v in state.q.iter().chain(&state.qd).chain(&state.qdd) {
                write!(text, "{v:?} ").unwrap();
            }
            text.push('\n');
            chain.forward_motion(&mut state);
            for link in (0..chain.links().len()).map(LinkId) {
                let motion = state.link_motion(link);
                ours.extend(state.link_in_root(link).to_rows().into_iter().flatten());
                for v in [motion.velocity, motion.angular_velocity, motion.acceleration, motion.angular_acceleration] {
                    ours.extend(v.to_array());
                }
            }
        }
        let theirs = reference.motions(&path, &chain, &text);
        assert_eq!(ours.len(), theirs.len(), "{name}");
        let mut of_robot = [0.0_f64; 3];
        for (i, (a, b)) in ours.iter().zip(&theirs).enumerate() {
            assert!((a - b).abs() < TOLERANCE, "{name}, value {i}: {a} {b}");
            let kind = [0, 1, 2][(i % 24).saturating_sub(6) / 6];
            of_robot[kind] = of_robot[kind].max((a - b).abs());
        }
        let [pose, velocity, acceleration] = of_robot;
        println!("{name:<42} pose {pose:.1e}, velocity {velocity:.1e}, acceleration {acceleration:.1e}");
        for (w, r) in worst.iter_mut().zip(of_robot) {
            *w = w.max(r);
        }
    }
    reference.end();
    println!("worst: pose {:.1e}, velocity {:.1e}, acceleration {:.1e}", worst[0], worst[1], worst[2]);
}
