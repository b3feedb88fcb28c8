//! Explanations of overrides and collisions in words.

use elbowroom_avoidance::AvoiderState;
use elbowroom_monitor::{Fault, OverrideReason};
use elbowroom_sim::{Collision, HoldReason, Recording, RobotTrack};

/// Description of a robot at a sample: its last collision, its avoidance state, the reason of the override.
pub fn explanation(robot: &RobotTrack, index: usize, recording: &Recording) -> String {
    let Some(sample) = robot.samples.get(index) else { return String::new() };
    let mut parts = Vec::new();
    // The duration of a contact is not recorded.
    let hits = robot.collisions.iter().filter(|c| c.t_s <= sample.t_s);
    parts.extend(hits.max_by(|a, b| a.t_s.total_cmp(&b.t_s)).map(|c| collision_text(c, robot)));
    let state = robot.avoidance.as_ref().and_then(|a| a.samples.get(index)).map(|a| a.state);
    parts.extend(state.filter(|d| *d != AvoiderState::Following).map(|d| d.name().to_owned()));
    let mut holds = robot.perception.iter().flat_map(|p| &p.holds);
    let hold = holds.rfind(|h| h.from_s <= sample.t_s && sample.t_s <= h.to_s);
    parts.extend(hold.map(|h| match h.reason {
        HoldReason::Obstacle => format!("{} blocks its path", h.by),
        HoldReason::Stale => format!("{} has sent nothing usable for too long", h.by),
    }));
    if sample.reason != OverrideReason::Free || parts.is_empty() {
        parts.push(reason_text(sample.reason, recording));
    }
    parts.join("; ")
}

/// Description of a collision, from the robot's point of view.
pub fn collision_text(collision: &Collision, robot: &RobotTrack) -> String {
    let Collision { t_s, a, b } = collision;
    let link = |side: &str| side.strip_prefix(robot.name.as_str()).and_then(|s| s.strip_prefix('/')).map(str::to_owned);
    match (link(a), link(b)) {
        (Some(own), Some(other)) => format!("{own} hit {other} at {t_s:.3} s"),
        (Some(own), None) => format!("{own} hit {b} at {t_s:.3} s"),
        (None, Some(own)) => format!("{own} hit {a} at {t_s:.3} s"),
        (None, None) => format!("{a} hit {b} at {t_s:.3} s"),
    }
}

/// Description of the reason of an override, with the region's name.
pub fn reason_text(reason: OverrideReason, recording: &Recording) -> String {
    let name = |i: usize| recording.regions.get(i).map_or("?", |r| r.name.as_str());
    match reason {
        OverrideReason::Free => "free".into(),
        OverrideReason::Region(r) => format!("near {}", name(r.0)),
        OverrideReason::SpeedZone(r) => format!("speed zone {}", name(r.0)),
        OverrideReason::Waiting(r) => format!("waiting for {}", name(r.0)),
        OverrideReason::Halted(r) => format!("halted: two robots are in {}", name(r.0)),
        OverrideReason::Rate => "changing at its largest rate".into(),
        OverrideReason::Fault(Fault::Source { region }) => format!("the source of {} is lost", name(region.0)),
        OverrideReason::Fault(Fault::SourceJump { region }) => format!("the source of {} jumped", name(region.0)),
        OverrideReason::Fault(fault) => fault.to_string(),
    }
}
