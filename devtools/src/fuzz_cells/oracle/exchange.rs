//! Checks of exchange regions: two robots are never inside, and no deadlock is silent.

use elbowroom_monitor::RegionKind;
use elbowroom_sim::VirtualRobotTrack;
use elbowroom_spatial::Vec3;

use super::findings::{Finding, Findings};
use super::guarded::Guarded;
use super::motion::OracleMotion;
use super::promises::Promises;
use super::sweep::{SweptPair, first_touch};

/// Number of parts of a tick in which two robots are inside at some time each.
const PARTS: usize = 64;
/// A robot that has not moved for this long (s) at the end stays at rest: a run continues for a second without motion.
const AT_REST_S: f64 = 0.5;
/// Largest change (rad, m) in that time that is not a motion: by the override law a robot approaches a border without
/// ever reaching it.
const NO_MOTION: f64 = 1e-4;

/// A finished robot within this distance (m) beyond a zone may still hold the region: zones end later than they begin
/// (hysteresis), and monitors measure volumes that enclose a link's solids, which may lie apart.
const PARKED_M: f64 = 0.1;

/// Longest time, s, for which a robot is on its way into a region without being able to stop. A robot whose program
/// accelerates harder than it brakes cannot be proven to stop until late.
const COMMITTED_S: f64 = 5.0;

/// A robot, its solids that count, and for each tick whether it is inside at some time until the next.
type ZoneVisit<'a> = (usize, Vec<SweptPair<'a>>, Vec<bool>);

/// Checks all exchange regions. `has_violation`: whether the run reported that something went wrong.
pub fn check(
    motion: &OracleMotion<'_>,
    guarded: &[Vec<Guarded>],
    promises: &Promises<'_>,
    has_violation: bool,
    findings: &mut Findings,
) {
    let mut in_zone = vec![vec![false; motion.places.len()]; guarded.len()];
    for (region, place) in motion.places.iter().enumerate() {
        if !matches!(place.kind, RegionKind::Exchange { .. }) {
            continue;
        }
        let visits: Vec<ZoneVisit<'_>> = place
            .robots
            .iter()
            .map(|&robot| {
                let counting = guarded[robot].iter().filter(|g| g.counts_for(place.guards));
                let pairs: Vec<SweptPair<'_>> = counting.map(|g| SweptPair::new(motion, g, robot, region)).collect();
                let mut during = vec![false; motion.ticks()];
                for p in &pairs {
                    mark_inside(p, &mut during);
                }
                (robot, pairs, during)
            })
            .collect();
        for (i, a) in visits.iter().enumerate() {
            for b in &visits[i + 1..] {
                two_inside(motion, region, [a, b], promises, findings);
            }
        }
        let last = motion.ticks().saturating_sub(1);
        let zone = motion.cell.regions[region].region.warning_m;
        for (robot, pairs, _) in &visits {
            let more = if motion.recording.robots[*robot].finished { PARKED_M + spread_m(motion, pairs) } else { 0.0 };
            in_zone[*robot][region] =
                pairs.iter().any(|p| p.is_there(last) && p.distance(last, 0.0).lower < zone + more);
        }
    }
    deadlock(motion, &in_zone, has_violation, findings);
}

/// Largest distance (m) between the centres of two of a robot's solids, at the start.
fn spread_m(motion: &OracleMotion<'_>, pairs: &[SweptPair<'_>]) -> f64 {
    let frames = motion.frames(0);
    let middles: Vec<_> = pairs.iter().map(|p| p.guarded.center(&frames[p.robot])).collect();
    let from = |a: &Vec3| middles.iter().map(|b| a.distance(*b)).fold(0.0, f64::max);
    middles.iter().map(from).fold(0.0, f64::max)
}

/// Marks the ticks during which the solid touches the region at some time until the next tick, while it is on the robot.
fn mark_inside(pair: &SweptPair<'_>, during: &mut [bool]) {
    let spans = pair.motion.hand_spans(pair.robot).into_iter();
    for (from, to) in spans.filter(|(from, _)| pair.is_there(*from)) {
        let mut k = from;
        while let Some((at, _)) = pair.first_touch(k, to) {
            during[at] = true;
            k = at + 1;
        }
    }
}

/// Whether a robot that is inside since tick `entered` came in by exchanging a tool or by gripping an object, and `check` says that this
/// is not excluded.
fn is_exchanged_inside(
    motion: &OracleMotion<'_>,
    region: usize,
    visit: &ZoneVisit<'_>,
    promises: &Promises<'_>,
    entered: usize,
) -> bool {
    entered > 0 && motion.hand_gains(visit.0).contains(&entered) && !promises.exclude(region, visit.0)
}

fn two_inside(
    motion: &OracleMotion<'_>,
    region: usize,
    [a, b]: [&ZoneVisit<'_>; 2],
    promises: &Promises<'_>,
    findings: &mut Findings,
) {
    let both = |k: &usize| motion.is_active(region, *k) && a.2[*k] && b.2[*k];
    // The protocol does not bring a robot in that starts inside: the pair counts once one of the two has been outside.
    let apart = (0..motion.ticks()).find(|k| !(a.2[*k] && b.2[*k])).unwrap_or(motion.ticks());
    let inside =
        |s: &ZoneVisit<'_>, k: usize, u: f64| s.1.iter().any(|p| p.is_there(k) && p.distance(k, u).upper <= 0.0);
    let mut excused = None;
    for k in (apart..motion.ticks()).filter(both) {
        let entered = [a, b].map(|visit| entered_at(visit, k));
        if excused == Some(entered) {
            continue;
        }
        let at_once = (0..PARTS).map(|i| i as f64 / PARTS as f64).find(|u| inside(a, k, *u) && inside(b, k, *u));
        let Some(u) = at_once else { continue };
        let visits = [(a, entered[0]), (b, entered[1])];
        let mounted = visits.iter().any(|(visit, at)| is_exchanged_inside(motion, region, visit, promises, *at));
        if mounted || !is_driven_in(motion, region, visits) {
            findings.unforeseen_entries += 1;
            excused = Some(entered);
            continue;
        }
        findings.list.push(Finding::TwoInside { region, robots: [a.0, b.0], t_s: motion.time_s(k, u) });
        return;
    }
}

/// Returns the tick since which the robot has been inside until tick `k`.
fn entered_at(visit: &ZoneVisit<'_>, k: usize) -> usize {
    (0..k).rev().find(|before| !visit.2[*before]).map_or(0, |before| before + 1)
}

/// Whether one of two robots drove in, since these ticks, while the other one was inside. A moving region may come over
/// a robot at rest while another robot, which can no longer stop outside, continues into it.
fn is_driven_in(motion: &OracleMotion<'_>, region: usize, visits: [(&ZoneVisit<'_>, usize); 2]) -> bool {
    if motion.places[region].is_fixed() {
        return true;
    }
    let [first, last] = if visits[0].1 <= visits[1].1 { visits } else { [visits[1], visits[0]] };
    let drove = |(visit, entered): (&ZoneVisit<'_>, usize)| drove_in(motion, region, visit, entered);
    // At the start no robot is on its way.
    let could_stop = first.1 == 0 || motion.times[last.1] - motion.times[first.1] > COMMITTED_S;
    drove(last) && (could_stop || drove(first))
}

/// Whether the robot that is inside since tick `entered` came in by its own motion, although it avoids regions with
/// foreseeable motion.
fn drove_in(motion: &OracleMotion<'_>, region: usize, visit: &ZoneVisit<'_>, entered: usize) -> bool {
    let keeps_away = motion.cell.monitoring.stopping_reaction_s.is_some();
    first_touch(&visit.1, entered, entered + 1)
        .is_some_and(|(k, u, pair)| keeps_away && pair.moves_at(k, u) && motion.is_foreseen(region, visit.0, (k, u)))
}

/// Finds a deadlock: robots at rest at the end that have not finished, each in a zone of another of them, in a cycle. A
/// robot that waits for a finished one, or is at rest for another reason, is in no cycle.
fn deadlock(motion: &OracleMotion<'_>, in_zone: &[Vec<bool>], has_violation: bool, findings: &mut Findings) {
    let ticks = motion.ticks();
    let held = (AT_REST_S / motion.recording.tick_s).ceil() as usize;
    if ticks <= held + 1 {
        return;
    }
    let at_rest = |robot: usize| {
        let track = &motion.recording.robots[robot];
        let (then, now) = (&motion.q[ticks - 1 - held][robot], &motion.q[ticks - 1][robot]);
        !track.finished && then.iter().zip(now).all(|(a, b)| (a - b).abs() < NO_MOTION)
    };
    // Robots that act as one stand for a reason that is reported with their work-piece.
    let stands_with_others = |robot: usize| {
        let name = &motion.recording.robots[robot].name;
        // The last stop lasts to the end of the run.
        let stands = |v: &VirtualRobotTrack| {
            let end_s = v.samples.last().filter(|sample| sample.is_stopped).map(|sample| sample.t_s);
            v.stops.last().zip(end_s).is_some_and(|(stop, end_s)| stop.to_s >= end_s)
        };
        motion.recording.virtual_robots.iter().any(|v| v.robots.contains(name) && stands(v))
    };
    // A sensor holds a robot until the way is free, or pictures come again.
    let is_held = |robot: usize| {
        motion.recording.robots[robot].perception.as_ref().is_some_and(|track| track.ends_held.is_some())
    };
    // While a robot moves, for example in a run that was cut off, robots at rest may still be granted a region.
    if (0..in_zone.len()).any(|r| !motion.recording.robots[r].finished && !at_rest(r)) {
        return;
    }
    // A region that still moves may free robots that wait, and come over robots at rest.
    let moves_on = |region: &usize| {
        let [then, now] = [ticks - 1 - held, ticks - 1].map(|k| motion.region_at(*region, k));
        then.at.distance(now.at) + then.turn_to(&now).length() > NO_MOTION
    };
    let mut exchanges =
        (0..motion.places.len()).filter(|r| matches!(motion.places[*r].kind, RegionKind::Exchange { .. }));
    if exchanges.any(|region| moves_on(&region)) {
        return;
    }
    // Overlapping regions form one crossing: a robot in the zone of one of them is in all.
    let in_crossing: Vec<Vec<bool>> = in_zone.iter().map(|zones| spread(motion, zones)).collect();
    let waits = |r: &usize| at_rest(*r) && in_zone[*r].contains(&true) && !stands_with_others(*r) && !is_held(*r);
    let robots: Vec<usize> = (0..in_zone.len()).filter(waits).collect();
    let meet = |a: usize, b: usize| a != b && in_crossing[a].iter().zip(&in_crossing[b]).any(|(a, b)| *a && *b);
    let circle: Vec<usize> = robots.iter().copied().filter(|a| robots.iter().any(|b| meet(*a, *b))).collect();
    // A robot that has finished in the zone blocks the others for good: they wait, but not in a cycle.
    let parked = |a: usize| (0..in_zone.len()).any(|b| motion.recording.robots[b].finished && meet(a, b));
    if circle.len() < 2 || circle.iter().any(|a| parked(*a)) {
        return;
    }
    findings.deadlocks += 1;
    let named = |robot: &usize| {
        let name = &motion.recording.robots[*robot].name;
        motion.recording.deadlocks.iter().any(|d| d.robots.contains(name))
    };
    let reported = circle.iter().any(named);
    if !(reported && has_violation) {
        findings.list.push(Finding::SilentDeadlock { robots: circle });
    }
}

/// Returns these regions, and those whose zones overlap with one of them, directly or through others.
fn spread(motion: &OracleMotion<'_>, zones: &[bool]) -> Vec<bool> {
    let exchange = |r: usize| matches!(motion.places[r].kind, RegionKind::Exchange { .. });
    let warning = |r: usize| motion.cell.regions[r].region.warning_m;
    let overlap = |a: usize, b: usize| motion.places[a].distance(&motion.places[b]) <= warning(a) + warning(b);
    let mut reached = zones.to_vec();
    let mut open: Vec<usize> = (0..zones.len()).filter(|r| zones[*r]).collect();
    while let Some(from) = open.pop() {
        for to in (0..reached.len()).filter(|r| exchange(*r)) {
            if !reached[to] && overlap(from, to) {
                reached[to] = true;
                open.push(to);
            }
        }
    }
    reached
}
