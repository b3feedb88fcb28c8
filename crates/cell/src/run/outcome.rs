//! How each robot's run ended.

use elbowroom_monitor::{Configuration, Reason, VirtualTcp};

use crate::{Outcome, RobotEnding, RobotTrack};

/// Joints that differ by less than this (rad, m) from where they end are there.
const THERE: f64 = 1e-5;

/// Of a robot whose program ended as `track` says; `governing` is the point that asked for the smallest override last,
/// `region` the name of the region that governed then.
pub(super) fn ending(
    track: &RobotTrack,
    deadlocked: bool,
    region: Option<&str>,
    governing: Option<&VirtualTcp>,
    configuration: &Configuration,
) -> RobotEnding {
    if let Some(hit) = track.collisions.first() {
        let own = format!("{}/", track.name);
        let (part, by) = if hit.a.starts_with(&own) { (&hit.a, &hit.b) } else { (&hit.b, &hit.a) };
        return RobotEnding {
            outcome: Outcome::Collided,
            stopped_at_s: if track.finished { None } else { stopped_at(track) },
            by: Some(by.clone()),
            part: part.strip_prefix(&own).map(str::to_owned),
            point: None,
        };
    }
    if track.finished {
        return RobotEnding::default();
    }
    let waits = matches!(track.samples.last().map(|s| s.reason), Some(Reason::Waiting(_)));
    let outcome = match (deadlocked, waits) {
        (true, _) => Outcome::Deadlock,
        (false, true) => Outcome::Held,
        (false, false) => Outcome::Stopped,
    };
    let point = governing.filter(|_| region.is_some());
    RobotEnding {
        outcome,
        stopped_at_s: stopped_at(track),
        by: region.map(str::to_owned),
        part: point.and_then(|p| configuration.volumes().get(p.volume)).map(|v| v.name.clone()),
        point: point.map(|p| p.position),
    }
}

/// Since when the robot is where it ended, s; `None` where it was still under way.
pub(super) fn stopped_at(track: &RobotTrack) -> Option<f64> {
    let last = track.samples.last()?;
    let elsewhere = |q: &[f64]| q.iter().zip(&last.q).any(|(a, b)| (a - b).abs() > THERE);
    let moving = track.samples.iter().rposition(|s| elsewhere(&s.q));
    let first = moving.map_or(0, |i| i + 1);
    (first + 1 < track.samples.len()).then(|| track.samples[first].t_s)
}
