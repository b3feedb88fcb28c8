//! The result of a robot's program in one sentence.
//!
//! It contains place and time of a stop, what governed, the duration, and what would release the robot.

use elbowroom_monitor::OverrideReason;
use elbowroom_sim::{
    AvoidanceSummary, OperatorSummary, Outcome, Recording, RegionTrack, RobotTrack, Stop, VirtualRobotSummary,
    VirtualRobotTrack,
};
use elbowroom_spatial::Vec3;

use crate::carried_motion::carried;
use crate::explanation::{collision_text, reason_text};
use crate::last_motion::{finished_at, moved_until};
use crate::summary::{followed, millimetres};

/// Fraction of the programmed override below which a robot counts as slowed down.
const SLOWED: f64 = 0.995;

/// Share of its desired motion from which a work-piece counts as carried.
const CARRIED: f64 = 0.999;

/// Override below which the duration of the slow motion is stated.
const CRAWLING: f64 = 0.05;

/// Grade of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grade {
    /// The program was completed.
    Good,
    /// The program was not completed, without a collision.
    Stopped,
    /// A collision or a deadlock, or the entry of a region.
    Bad,
}

/// A sentence on one robot or region.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultLine {
    pub grade: Grade,
    pub text: String,
}

/// One line per robot, one per virtual robot, then one per region that was entered although it must not be.
pub fn results(rec: &Recording) -> Vec<ResultLine> {
    let robots = rec.robots.iter().map(|robot| of_robot(robot, rec));
    let entries = rec.regions.iter().filter(|r| r.is_violated()).map(|r| entry(r, rec));
    robots.chain(rec.virtual_robots.iter().map(|track| together(track, rec.tick_s))).chain(entries).collect()
}

fn of_robot(robot: &RobotTrack, rec: &Recording) -> ResultLine {
    let (grade, what) = match (robot.collisions.first(), robot.ending.outcome) {
        (Some(hit), Outcome::Mechanism) => {
            (Grade::Stopped, format!("is {}; {}", moved_until(robot), collision_text(hit, robot)))
        }
        (None, Outcome::Mechanism) => (Grade::Good, format!("is {}", moved_until(robot))),
        (Some(hit), _) => (Grade::Bad, format!("collided: {}{}", collision_text(hit, robot), after_hit(robot))),
        (None, _) if robot.finished => (Grade::Good, finished(robot, rec)),
        (None, Outcome::Deadlock) => (Grade::Bad, format!("is in a deadlock: it {}", stopped(robot, rec))),
        (None, _) => (Grade::Stopped, stopped(robot, rec)),
    };
    ResultLine { grade, text: format!("{} {what}.", robot.name) }
}

/// What a virtual robot carried out.
fn together(track: &VirtualRobotTrack, tick_s: f64) -> ResultLine {
    let grade = if track.carried_share > CARRIED { Grade::Good } else { Grade::Stopped };
    ResultLine { grade, text: format!("{} {}.", track.name, carried(&VirtualRobotSummary::new(track, tick_s))) }
}

/// The robots that entered a region, and the time of the first entry.
fn entry(region: &RegionTrack, rec: &Recording) -> ResultLine {
    let mut who: Vec<String> = Vec::new();
    for (i, robot) in rec.robots.iter().enumerate() {
        let first = region.inside_spans.iter().find(|s| s.robot.0 == i);
        who.extend(first.map(|s| format!("{} at {:.2} s", robot.name, s.from_s)));
    }
    let text = format!("The {} region {} was entered: {}.", region.kind.name(), region.name, who.join(", "));
    ResultLine { grade: Grade::Bad, text }
}

fn after_hit(robot: &RobotTrack) -> String {
    match (robot.finished, robot.ending.stopped_at_s) {
        (true, _) => "; it completed its program".into(),
        (false, Some(t)) => format!("; it stands since {t:.2} s"),
        (false, None) => String::new(),
    }
}

fn finished(robot: &RobotTrack, rec: &Recording) -> String {
    let at = finished_at(robot);
    match robot.stops.first() {
        Some(first) => {
            let total: f64 = robot.stops.iter().map(|s| s.to_s - s.from_s).sum();
            let times = if robot.stops.len() == 1 {
                format!("had stopped it for {total:.2} s at {:.2} s", first.from_s)
            } else {
                format!(
                    "had stopped it {} times, {total:.2} s in all, first at {:.2} s",
                    robot.stops.len(),
                    first.from_s
                )
            };
            format!("{at}; before, the monitor {times}{}", at_region(first, rec))
        }
        None if rec.regions.is_empty() => at + &evaded(robot, rec) + &guided(robot, rec),
        None => format!("{at}; {}{}{}", slowed(robot, rec), evaded(robot, rec), guided(robot, rec)),
    }
}

/// Description of the guidance.
fn guided(robot: &RobotTrack, rec: &Recording) -> String {
    OperatorSummary::of(robot, rec.tick_s).map_or_else(String::new, |guided| format!("; {}", followed(&guided)))
}

/// Description of the evasion.
fn evaded(robot: &RobotTrack, rec: &Recording) -> String {
    let Some(track) = &robot.avoidance else { return String::new() };
    let summary = AvoidanceSummary::new(track, rec.tick_s);
    let samples = track.samples.iter().enumerate().filter(|(i, _)| robot.governing_obstacle(*i).is_some());
    let nearest = samples.min_by(|a, b| a.1.nearest_m.total_cmp(&b.1.nearest_m));
    let nearest = nearest.and_then(|(i, s)| Some((robot.governing_obstacle(i)?, s.nearest_m)));
    nearest.map_or_else(String::new, |(name, distance)| {
        let (evading, waiting) = (summary.evading_s, summary.waiting_s);
        format!(
            "; it evaded for {evading:.2} s and waited {waiting:.2} s, closest: {} to {name}",
            millimetres(Some(distance))
        )
    })
}

fn at_region(stop: &Stop, rec: &Recording) -> String {
    let Some(by) = &stop.by else { return String::new() };
    let place = format!(", {}", before(by, stop.distance_m, rec));
    stop.part.as_ref().map_or(place.clone(), |part| format!("{place} (closest: {part})"))
}

/// The smallest override, and what governed at that time.
fn slowed(robot: &RobotTrack, rec: &Recording) -> String {
    let governed = robot.samples.iter().filter(|s| s.region.is_some());
    let least = governed.min_by(|a, b| a.speed_override.total_cmp(&b.speed_override));
    let Some(least) = least.filter(|s| s.speed_override < SLOWED) else { return "no region slowed it down".into() };
    let region = least.region.and_then(|r| rec.regions.get(r.0)).map_or("?", |r| r.name.as_str());
    let part = robot.governing_part(least).map_or_else(String::new, |part| format!(" (closest: {part})"));
    let (percent, t) = (100.0 * least.speed_override, least.t_s);
    let crawl_s = robot.samples.iter().filter(|s| s.speed_override < CRAWLING).count() as f64 * rec.tick_s;
    let long =
        if crawl_s > 0.0 { format!(", below {:.0} % for {crawl_s:.2} s", 100.0 * CRAWLING) } else { String::new() };
    format!("slowed down to {percent:.1} % at {t:.2} s near {}{part}{long}", described(region, rec))
}

/// Text from "stopped" on: time, place, what governs, duration, what releases.
fn stopped(robot: &RobotTrack, rec: &Recording) -> String {
    let ending = &robot.ending;
    let Some(since) = ending.stopped_at_s else {
        return format!("was still moving when the run ended at {:.2} s", rec.duration_s);
    };
    let Some(last) = robot.samples.last() else { return "has no samples".into() };
    let verb = if ending.outcome == Outcome::Held { "waits since" } else { "stopped at" };
    let at = match (&ending.by, last.distance_m) {
        (Some(by), distance) => format!(", {}", before(by, distance, rec)),
        (None, _) if last.reason != OverrideReason::Free => format!(": {}", reason_text(last.reason, rec)),
        (None, _) => format!(", TCP at {}", place(last.tcp)),
    };
    let closest = match (&ending.part, ending.point) {
        (Some(part), Some(p)) => format!("; closest: {part} at {}", place(p)),
        _ => String::new(),
    };
    let stood = format!("; it stood still for {:.2} s until the end of the run", rec.duration_s - since);
    let release = ending.release.as_ref().map_or_else(String::new, |ways| format!(" and continues when {ways}"));
    format!("{verb} {since:.2} s{at}{closest}{stood}{release}")
}

fn place(p: Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3}) m", p.x, p.y, p.z)
}

/// Distance and its reference: `0.50 mm before the forbidden region post`.
fn before(by: &str, distance_m: Option<f64>, rec: &Recording) -> String {
    let what = described(by, rec);
    match distance_m {
        Some(0.0) => format!("inside {what}"),
        Some(d) => format!("{} before {what}", millimetres(Some(d))),
        None => format!("before {what}"),
    }
}

/// A region with its kind, or an obstacle.
fn described(name: &str, rec: &Recording) -> String {
    let region = rec.regions.iter().find(|r| r.name == name);
    region.map_or_else(|| name.to_owned(), |r| format!("the {} region {name}", r.kind.name()))
}
