//! How much of random motions two or three arms carry out, and how often they stop, beside one arm alone and hand-overs only
//! at a limit: `cargo bench -p elbowroom-cooperation --bench carrying -- [MOTIONS] [ARMS] [FIRST] [--real] [--seen] [--out
//! FOLDER]`.
//!
//! With `--seen`, a camera beside the arms looks at the bar, and the second strategy is foresight without a
//! preference for an arm that does not hide it.
//!
//! FIRST is the number of the first motion. With `--real`, each motion has arms of the data, of similar size, instead of two
//! RX60B. With a folder, only motions with foresight run, and are written for `benches/python/continuous_check.py`.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use common::{
    ArmModel, BAR_M, HAND_M, HAND_WIDE_M, Outcome, Pair, THIN_M, carry, carry_seen, motion, one_arm_covers, part_pose,
};
use elbowroom_cooperation::{CooperationSettings, VirtualRobot};
use elbowroom_kinematics::JointId;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Distance of the arms of the data from the middle, and largest distance of their motions from it, for arms of size 1, m.
const REAL: (f64, f64) = (0.8, 0.55);

/// Sums over motions.
#[derive(Default)]
struct Totals {
    share: f64,
    whole: usize,
    stopped_s: f64,
    hand_overs: usize,
    contacts: usize,
    deviation_m: f64,
    hidden_s: f64,
    step_us: Vec<f64>,
    seconds: f64,
}

impl Totals {
    fn add(&mut self, outcome: Outcome, begin: Instant) {
        self.share += outcome.share;
        self.whole += usize::from(outcome.share > 0.999);
        self.stopped_s += outcome.stopped_s;
        self.hand_overs += outcome.hand_overs.len();
        self.contacts += outcome.contacts;
        self.deviation_m = self.deviation_m.max(outcome.deviation_m);
        self.hidden_s += outcome.hidden_s;
        self.step_us.extend(outcome.step_us);
        self.seconds += begin.elapsed().as_secs_f64();
    }

    fn print(mut self, name: &str, motions: usize) {
        self.step_us.sort_by(f64::total_cmp);
        let step = |share: f64| self.step_us[((self.step_us.len() - 1) as f64 * share) as usize];
        println!(
            "{name:12} {:.3} {:3} {:7.1} {:4} {} {:.1e} {:7.1}  {} steps, µs median {:.0}, p99 {:.0}, most {:.0}  ({:.0} s)",
            self.share / motions as f64,
            self.whole,
            self.stopped_s,
            self.hand_overs,
            self.contacts,
            self.deviation_m,
            self.hidden_s,
            self.step_us.len(),
            step(0.5),
            step(0.99),
            step(1.0),
            self.seconds
        );
    }
}

fn main() {
    let words: Vec<String> = elbowroom_testkit::bench::arguments().collect();
    let numbers: Vec<usize> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let number = |index: usize, usual: usize| numbers.get(index).copied().unwrap_or(usual);
    let (motions, count, first) = (number(0, 20), number(1, 2), number(2, 0));
    let folder = words.iter().position(|word| word == "--out").map(|at| PathBuf::from(&words[at + 1]));
    let models = if words.iter().any(|word| word == "--real") { real_arms() } else { vec![ArmModel::rx60b()] };
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder).unwrap();
    }
    let foresight = CooperationSettings::default();
    let is_seen = words.iter().any(|word| word == "--seen");
    let (second, other) = if is_seen {
        ("indifferent", CooperationSettings { hidden_share: 1.0, ..foresight })
    } else {
        ("at limits", CooperationSettings { horizon_s: 0.05, ..foresight })
    };
    let mut all = [Totals::default(), Totals::default(), Totals::default()];
    let mut covered = 0;
    for index in first..first + motions {
        let mut random = SplitMix(11 + index as u64);
        let (arms, mut pair, way) = task(&models, &mut random, count);
        if is_seen {
            let size = pair.size;
            pair = pair.seen_from(Vec3::new(0.0, -1.5, 0.6) * size, Vec3::new(0.0, 0.0, 0.4) * size);
        }
        covered += usize::from(one_arm_covers(&pair, &way));
        let begin = Instant::now();
        if let Some(folder) = &folder {
            std::fs::write(folder.join(format!("cell_{index:03}.json")), setup(&pair, &arms)).unwrap();
            let outcome = recorded(&pair, foresight, &way, &folder.join(format!("motion_{index:03}.csv")));
            all[0].add(outcome, begin);
            continue;
        }
        let names: Vec<_> = arms.iter().map(|arm| arm.file.file_stem().unwrap().to_string_lossy()).collect();
        let outcome = carry(&pair, foresight, &way);
        println!("{index} {} {:.3} {:?}", names.join(" "), outcome.share, outcome.last_hold);
        all[0].add(outcome, begin);
        let begin = Instant::now();
        all[1].add(carry(&pair, other, &way), begin);
        let begin = Instant::now();
        all[2].add(carry(&pair.with_one_hand(), foresight, &way), begin);
    }
    println!(
        "{motions} motions, {count} arms, {covered} could be carried by one of them; share carried, whole motions, stopped s, hand-overs, contacts, largest deviation m, hidden s"
    );
    let done = all.into_iter().zip(["foresight", second, "one arm"]).filter(|(totals, _)| totals.seconds > 0.0);
    done.for_each(|(totals, name)| totals.print(name, motions));
}

/// The arms of the data that have a flange.
fn real_arms() -> Vec<ArmModel> {
    let files = elbowroom_testkit::folder::robots(&["urdf"]);
    let arms: Vec<ArmModel> = files.iter().filter_map(|file| ArmModel::load(file, None)).collect();
    println!("{} of {} robots of the data have a flange", arms.len(), files.len());
    arms
}

/// Arms that can start together, and a random motion of the bar.
fn task<'m>(models: &'m [ArmModel], random: &mut SplitMix, count: usize) -> (Vec<&'m ArmModel>, Pair, Vec<Pose>) {
    loop {
        let mut arms = vec![&models[random.index(models.len())]];
        while arms.len() < count {
            let other = &models[random.index(models.len())];
            if (other.size / arms[0].size).ln().abs() < 0.25 {
                arms.push(other);
            }
        }
        let (apart_m, wide_m) = if models.len() > 1 { REAL } else { (0.6, 0.4) };
        let Some(pair) = Pair::of(&arms, apart_m, None).filter(Pair::can_start) else { continue };
        let way = motion(random, &pair, part_pose(&pair), wide_m, 3);
        if way.len() > 1 {
            return (arms, pair, way);
        }
    }
}

/// Bound of the distance of any part that an arm moves from the axis of a joint, for an arm of size 1, m.
const REACH_M: f64 = 1.3;

/// Middle of the hand in the frame of the link that carries it.
fn hand_in_link(arm: &ArmModel) -> Vec3 {
    Vec3::Z * (0.5 * HAND_M * arm.size)
}

/// What the check in Python must know of the cell.
fn setup(pair: &Pair, arms: &[&ArmModel]) -> String {
    let describe = |(arm, base): (&&ArmModel, Pose)| {
        let (wide, long) = (HAND_WIDE_M * arm.size, 0.5 * HAND_M * arm.size);
        let chain = &arm.robot.chain;
        let joints = chain.joints().iter().enumerate().filter_map(|(index, joint)| {
            let c = chain.coupling(JointId(index))?;
            Some(format!("[{:?}, {}, {}, {}]", joint.name, c.index, c.multiplier, c.offset))
        });
        let joints: Vec<String> = joints.collect();
        format!(
            "{{\"joints\": [{}], \"urdf\": {:?}, \"base\": {{\"rotation\": {:?}, \"at\": {:?}}}, \"tool\": {{\"link\": \"tool0\", \"half_extents\": [{wide}, {wide}, {long}], \"at\": {:?}}}}}",
            joints.join(", "),
            std::fs::canonicalize(&arm.file).unwrap().display().to_string(),
            base.rotation.rows(),
            base.translation.to_array(),
            hand_in_link(arm).to_array()
        )
    };
    let bases = pair.scene.robots().iter().map(|robot| robot.base_in_world);
    let described: Vec<String> = arms.iter().zip(bases).map(describe).collect();
    let largest = arms.iter().map(|arm| arm.size).fold(0.0, f64::max);
    let (thin, long) = (THIN_M * pair.size, BAR_M * pair.size);
    format!(
        "{{\"reach_m\": {}, \"bar_half_extents\": [{thin}, {thin}, {long}], \"arms\": [{}]}}\n",
        REACH_M * largest,
        described.join(", ")
    )
}

/// Carries out a motion and writes it: per step the holder, the visitor or -1, the bar in the hand, and all joint values.
fn recorded(pair: &Pair, settings: CooperationSettings, way: &[Pose], file: &Path) -> Outcome {
    let mut text = String::from("t_s,holder,visitor,x,y,z,qx,qy,qz,qw,q\n");
    let outcome = carry_seen(pair, settings, way, &mut |t_s, robot: &VirtualRobot<'_>| {
        let held = robot.attachment().unwrap();
        let member = |id| pair.members.iter().position(|m| m.robot == id).unwrap();
        let visitor = held.visiting_links.first().map_or("-1".to_owned(), |(id, _)| member(*id).to_string());
        let middle = 0.5 * pair.members[member(held.robot)].tool_in_tip.translation;
        let bar = Pose::from_translation(middle).inverse_mul(&held.in_link);
        let numbers = bar.translation.to_array().into_iter().chain(bar.rotation.to_quaternion_xyzw());
        let joints = (0..pair.members.len()).flat_map(|m| robot.q(m).iter().copied());
        _ = write!(text, "{t_s},{},{visitor}", member(held.robot));
        numbers.chain(joints).for_each(|number| _ = write!(text, ",{number}"));
        text.push('\n');
    });
    std::fs::write(file, text).unwrap();
    outcome
}
