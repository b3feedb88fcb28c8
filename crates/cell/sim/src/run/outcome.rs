//! Outcome of each robot's run.

use elbowroom_monitor::{Configuration, OverrideReason, VirtualTcp, VolumeId};

use crate::recording::{Outcome, PartKind, RobotEnding, RobotTrack};

/// Joint difference to the final value below which a joint has reached it (rad, m).
const SETTLED: f64 = 1e-5;

/// Outcome of a robot with the recording `track`.
///
/// `governing` is the point with the smallest requested override of the last tick, `region` the name of the governing
/// region.
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
        let part = part.strip_prefix(&own).map(str::to_owned);
        // The tool is a solid of the flange.
        let is_link = |name: &String| configuration.chain().link(name).is_some();
        return RobotEnding {
            outcome: Outcome::Collided,
            stopped_at_s: if track.finished { None } else { stopped_at(track) },
            by: Some(by.clone()),
            part_kind: part.as_ref().map(|p| if is_link(p) { PartKind::Link } else { PartKind::Load }),
            part,
            point: None,
            release: None,
        };
    }
    if track.finished {
        return RobotEnding::default();
    }
    let is_waiting = matches!(track.samples.last().map(|s| s.reason), Some(OverrideReason::Waiting(_)));
    let outcome = match (deadlocked, is_waiting) {
        (true, _) => Outcome::Deadlock,
        (false, true) => Outcome::Held,
        (false, false) => Outcome::Stopped,
    };
    let point = governing.filter(|_| region.is_some());
    let held_by = track.perception.as_ref().and_then(|p| p.ends_held.as_ref()).map(|(_, by)| by.as_str());
    let obstacle = track.samples.len().checked_sub(1).and_then(|last| track.governing_obstacle(last));
    let volume = point.and_then(|p| configuration.volumes().get(p.volume.0));
    RobotEnding {
        outcome,
        stopped_at_s: stopped_at(track),
        by: region.or(held_by).or(obstacle).map(str::to_owned),
        part: volume.map(|v| v.name.clone()),
        part_kind: volume.map(|v| v.part.into()),
        point: point.map(|p| p.position),
        release: None,
    }
}

/// Outcome of a mechanism, which no region stops.
pub(super) fn of_mechanism(track: &RobotTrack) -> RobotEnding {
    RobotEnding { outcome: Outcome::Mechanism, stopped_at_s: stopped_at(track), ..RobotEnding::default() }
}

/// Name of a guarded volume: the name of a link, or `tool`, `load`, `tcp`.
pub(super) fn part_name(configuration: &Configuration, volume: VolumeId) -> Option<String> {
    configuration.volumes().get(volume.0).map(|v| v.name.clone())
}

/// Time at which the robot stopped at its final configuration, s; `None` if it was still moving.
pub(super) fn stopped_at(track: &RobotTrack) -> Option<f64> {
    let last = track.samples.last()?;
    let is_elsewhere = |q: &[f64]| q.iter().zip(&last.q).any(|(a, b)| (a - b).abs() > SETTLED);
    let moving = track.samples.iter().rposition(|s| is_elsewhere(&s.q));
    let first = moving.map_or(0, |i| i + 1);
    (first + 1 < track.samples.len()).then(|| track.samples[first].t_s)
}
