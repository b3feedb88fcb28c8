//! How much of random motions two or three arms carry out, and how often they stop, beside one arm alone and hand-overs only
//! at a limit: `cargo bench -p elbowroom-cooperation --bench carrying -- [MOTIONS] [ARMS] [FOLDER]`.
//!
//! With a folder, only motions with foresight run, and are written for `benches/python/continuous_check.py`.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use common::{BAR_M, HAND_M, HAND_WIDE_M, Outcome, Pair, THIN_M, carry, carry_seen, motion, part_pose};
use elbowroom_cooperation::{CooperationSettings, VirtualRobot};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Sums over motions.
#[derive(Default)]
struct Totals {
    share: f64,
    whole: usize,
    stopped_s: f64,
    hand_overs: usize,
    contacts: usize,
    deviation_m: f64,
    step_us: Vec<f64>,
}

fn main() {
    let words: Vec<String> = elbowroom_testkit::bench::arguments().collect();
    let numbers: Vec<usize> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let folder = words.iter().find(|word| word.parse::<usize>().is_err()).map(PathBuf::from);
    let (motions, arms) = (numbers.first().copied().unwrap_or(20), numbers.get(1).copied().unwrap_or(2));
    let pair = Pair::new(arms, 0.6);
    let foresight = CooperationSettings::default();
    let at_limits = CooperationSettings { horizon_s: 0.05, ..foresight };
    let alone = Pair::alone(arms, 0.6);
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("cell.json"), setup(&pair)).unwrap();
    }
    println!(
        "{motions} motions, {arms} arms; share carried, whole motions, stopped s, hand-overs, contacts, largest deviation m"
    );
    let strategies = [("foresight", &pair, foresight), ("at limits", &pair, at_limits), ("one arm", &alone, foresight)];
    let count = if folder.is_some() { 1 } else { strategies.len() };
    for (name, pair, settings) in strategies.into_iter().take(count) {
        let (mut random, mut totals) = (SplitMix(11), Totals::default());
        let begin = Instant::now();
        for index in 0..motions {
            // Equal motions for every strategy.
            let way = motion(&mut random, &Pair::new(arms, 0.6), part_pose(pair), 0.4, 3);
            let outcome = match &folder {
                Some(folder) => recorded(pair, settings, &way, &folder.join(format!("motion_{index:03}.csv"))),
                None => carry(pair, settings, &way),
            };
            totals.share += outcome.share / motions as f64;
            totals.whole += usize::from(outcome.share > 0.999);
            totals.stopped_s += outcome.stopped_s;
            totals.hand_overs += outcome.hand_overs.len();
            totals.contacts += outcome.contacts;
            totals.deviation_m = totals.deviation_m.max(outcome.deviation_m);
            totals.step_us.extend(outcome.step_us);
        }
        totals.step_us.sort_by(f64::total_cmp);
        let step = |share: f64| totals.step_us[((totals.step_us.len() - 1) as f64 * share) as usize];
        println!(
            "{name:10} {:.3} {:3} {:7.1} {:4} {} {:.1e}  step µs median {:.0}, p99 {:.0}  ({:.0} s)",
            totals.share,
            totals.whole,
            totals.stopped_s,
            totals.hand_overs,
            totals.contacts,
            totals.deviation_m,
            step(0.5),
            step(0.99),
            begin.elapsed().as_secs_f64()
        );
    }
}

/// Bound of the distance of any part that an arm moves from the axis of a joint, m.
const REACH_M: f64 = 1.3;

/// Middle of the hand in the frame of the link that carries it.
const HAND_IN_LINK: Vec3 = Vec3::new(0.0, 0.0, 0.5 * HAND_M);

/// What the check in Python must know of the cell.
fn setup(pair: &Pair) -> String {
    let urdf = std::fs::canonicalize(elbowroom_testkit::folder::model("rx60b")).unwrap();
    let arm = |base: Pose| {
        format!(
            "{{\"urdf\": {:?}, \"base\": {{\"rotation\": {:?}, \"at\": {:?}}}, \"tool\": {{\"link\": \"tool0\", \"half_extents\": [{HAND_WIDE_M}, {HAND_WIDE_M}, {}], \"at\": {:?}}}}}",
            urdf.display().to_string(),
            base.rotation.rows(),
            base.translation.to_array(),
            0.5 * HAND_M,
            HAND_IN_LINK.to_array()
        )
    };
    let arms: Vec<String> = pair.scene.robots().iter().map(|robot| arm(robot.base_in_world)).collect();
    format!(
        "{{\"reach_m\": {REACH_M}, \"bar_half_extents\": [{THIN_M}, {THIN_M}, {BAR_M}], \"arms\": [{}]}}\n",
        arms.join(", ")
    )
}

/// Carries out a motion and writes it: per step the holder, the visitor or -1, the bar in the hand, and all joint values.
fn recorded(pair: &Pair, settings: CooperationSettings, way: &[Pose], file: &Path) -> Outcome {
    let mut text = String::from("t_s,holder,visitor,x,y,z,qx,qy,qz,qw,q\n");
    let outcome = carry_seen(pair, settings, way, &mut |t_s, robot: &VirtualRobot<'_>| {
        let held = robot.attachment().unwrap();
        let member = |id| pair.members.iter().position(|m| m.robot == id).unwrap();
        let visitor = held.visiting_links.first().map_or("-1".to_owned(), |(id, _)| member(*id).to_string());
        let bar = Pose::from_translation(HAND_IN_LINK).inverse_mul(&held.in_link);
        let numbers = bar.translation.to_array().into_iter().chain(bar.rotation.to_quaternion_xyzw());
        let joints = (0..pair.members.len()).flat_map(|m| robot.q(m).iter().copied());
        _ = write!(text, "{t_s},{},{visitor}", member(held.robot));
        numbers.chain(joints).for_each(|number| _ = write!(text, ",{number}"));
        text.push('\n');
    });
    std::fs::write(file, text).unwrap();
    outcome
}
