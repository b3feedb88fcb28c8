//! Who entered which forbidden region.

use elbowroom_monitor::RegionKind;

use super::findings::{Finding, Findings, TOLERANCE_M};
use super::guarded::Guarded;
use super::motion::OracleMotion;
use super::sweep::SweptPair;

/// Looks for entries into forbidden regions: of robots that were outside when the region became active and, where it was
/// switched on beside a robot that moved, have been at rest outside since.
pub fn entries(motion: &OracleMotion<'_>, guarded: &[Vec<Guarded>], findings: &mut Findings) {
    for (region, place) in motion.places.iter().enumerate() {
        if !matches!(place.kind, RegionKind::Forbidden) {
            continue;
        }
        for &robot in &place.robots {
            let pairs: Vec<SweptPair<'_>> = guarded[robot]
                .iter()
                .filter(|g| g.counts_for(place.guards))
                .map(|g| SweptPair::new(motion, g, robot, region))
                .filter(SweptPair::is_moved)
                .collect();
            findings.watched += usize::from(!pairs.is_empty());
            let Some((k, u, pair)) = first_entry(motion, &pairs, robot, region) else { continue };
            if !drove_in(pair, k, u) {
                continue;
            }
            let t_s = motion.times[k] + u * motion.recording.tick_s;
            if place.is_carried() || place.changes_speed(t_s - stop_s(motion, robot), t_s) {
                findings.unforeseen_entries += 1;
                continue;
            }
            let speed = if k + 1 < motion.ticks() { pair.own_travel(k) / motion.recording.tick_s } else { 0.0 };
            findings.list.push(Finding::Entry { robot, region, t_s, speed });
        }
    }
}

/// How long (s) the robot may take to stop from full speed, and to obey.
fn stop_s(motion: &OracleMotion<'_>, robot: usize) -> f64 {
    let slowest = motion.cell.robots[robot].limits.iter().map(|l| l.velocity / l.stop).fold(0.0, f64::max);
    slowest + motion.cell.laws.stopping_reaction_s.unwrap_or(0.0) + 2.0 * motion.recording.tick_s
}

/// The first touch within the times in which the robot may be held responsible.
fn first_entry<'p, 'a>(
    motion: &OracleMotion<'_>,
    pairs: &'p [SweptPair<'a>],
    robot: usize,
    region: usize,
) -> Option<(usize, f64, &'p SweptPair<'a>)> {
    let mut k = 0;
    while k < motion.ticks() {
        if !motion.is_active(region, k) {
            k += 1;
            continue;
        }
        let end = (k..motion.ticks()).find(|i| !motion.is_active(region, *i)).unwrap_or(motion.ticks());
        // The start counts as rest: nothing has moved before it.
        let at_rest = |i: &usize| *i == 0 || (!motion.moves(robot, *i) && !motion.moves(robot, i - 1));
        if let Some(from) = (k..end).find(at_rest)
            && is_outside(motion, pairs, region, from)
        {
            let to = jump(pairs, from, end);
            let touches = pairs.iter().filter_map(|p| p.first_touch(from, to).map(|(k, u)| (k, u, p)));
            let first = touches.min_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap_or(std::cmp::Ordering::Equal));
            if first.is_some() {
                return first;
            }
        }
        k = end;
    }
    None
}

fn is_outside(motion: &OracleMotion<'_>, pairs: &[SweptPair<'_>], region: usize, k: usize) -> bool {
    let frames = motion.frames(&motion.q[k]);
    let place = &motion.places[region];
    let at = place.at(place.travel_at(motion.times[k]).0, &frames);
    pairs.iter().all(|p| {
        p.distance(k, 0.0).lower > 10.0 * TOLERANCE_M && !place.contains(&at, p.guarded.center(&frames[p.robot]))
    })
}

/// Until a belt begins again, where it does.
fn jump(pairs: &[SweptPair<'_>], from: usize, end: usize) -> usize {
    let Some(pair) = pairs.first() else { return end };
    let last = end.min(pair.motion.ticks().saturating_sub(1));
    (from..last).find(|k| pair.region_jumps(*k)).unwrap_or(end)
}

/// True where the robot itself came nearer by more than the tolerance within the last tick: a region that runs into a
/// robot at rest, or into one that moves away, was not entered by it.
fn drove_in(pair: &SweptPair<'_>, k: usize, u: f64) -> bool {
    if k == 0 {
        return true;
    }
    let moves = |k: usize| k + 1 < pair.motion.ticks() && pair.own_travel(k) > 0.0;
    let moved = moves(k) || (u <= 0.0 && moves(k - 1));
    if !moved {
        return false;
    }
    let before = (k - 1, u);
    pair.distance_between(before, (k, u)).lower > TOLERANCE_M
}
