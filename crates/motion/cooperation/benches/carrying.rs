//! How much of random motions two or three arms carry out, and how often they stop, beside one arm alone and hand-overs only
//! at a limit: `cargo bench -p elbowroom-cooperation --bench carrying -- [MOTIONS] [ARMS]`.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{Pair, carry, motion, part_pose};
use elbowroom_cooperation::CooperationSettings;
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
    let numbers: Vec<usize> = elbowroom_testkit::bench::arguments().filter_map(|word| word.parse().ok()).collect();
    let (motions, arms) = (numbers.first().copied().unwrap_or(20), numbers.get(1).copied().unwrap_or(2));
    let pair = Pair::new(arms, 0.6);
    let foresight = CooperationSettings::default();
    let at_limits = CooperationSettings { horizon_s: 0.05, ..foresight };
    let alone = Pair::alone(arms, 0.6);
    println!(
        "{motions} motions, {arms} arms; share carried, whole motions, stopped s, hand-overs, contacts, largest deviation m"
    );
    for (name, pair, settings) in
        [("foresight", &pair, foresight), ("at limits", &pair, at_limits), ("one arm", &alone, foresight)]
    {
        let (mut random, mut totals) = (SplitMix(11), Totals::default());
        let begin = Instant::now();
        for _ in 0..motions {
            // Equal motions for every strategy.
            let way = motion(&mut random, &Pair::new(arms, 0.6), part_pose(pair), 0.4, 3);
            let outcome = carry(pair, settings, &way);
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
