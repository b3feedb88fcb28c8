//! Why a robot is as fast as it is, and what befell it, in words.

use elbowroom_avoidance::Doing;
use elbowroom_monitor::{Fault, Reason};

use crate::recording::{Collision, Recording, RobotTrack};

/// Of a robot at a sample: what it has hit last, how it evades, what the monitor says.
pub fn why(robot: &RobotTrack, index: usize, recording: &Recording) -> String {
    let Some(sample) = robot.samples.get(index) else { return String::new() };
    let mut parts = Vec::new();
    // How long they touched is not recorded: that they did stays true.
    let hits = robot.collisions.iter().filter(|c| c.t_s <= sample.t_s);
    parts.extend(hits.max_by(|a, b| a.t_s.total_cmp(&b.t_s)).map(|c| hit(c, robot)));
    let doing = robot.avoidance.as_ref().and_then(|a| a.samples.get(index)).map(|a| a.doing);
    parts.extend(doing.filter(|d| *d != Doing::Following).map(|d| d.word().to_owned()));
    if sample.reason != Reason::Free || parts.is_empty() {
        parts.push(reason_text(sample.reason, recording));
    }
    parts.join("; ")
}

/// Which of the robot's links hit what, and when.
pub fn hit(collision: &Collision, robot: &RobotTrack) -> String {
    let Collision { t_s, a, b } = collision;
    let link = |side: &str| side.strip_prefix(robot.name.as_str()).and_then(|s| s.strip_prefix('/')).map(str::to_owned);
    match (link(a), link(b)) {
        (Some(own), Some(other)) => format!("{own} hit {other} at {t_s:.3} s"),
        (Some(own), None) => format!("{own} hit {b} at {t_s:.3} s"),
        (None, Some(own)) => format!("{own} hit {a} at {t_s:.3} s"),
        (None, None) => format!("{a} hit {b} at {t_s:.3} s"),
    }
}

/// Why an override is what it is, with the region's name.
pub fn reason_text(reason: Reason, recording: &Recording) -> String {
    let name = |i: usize| recording.regions.get(i).map_or("?", |r| r.name.as_str());
    match reason {
        Reason::Free => "free".into(),
        Reason::Region(r) => format!("near {}", name(r.0)),
        Reason::SpeedZone(r) => format!("speed zone {}", name(r.0)),
        Reason::Waiting(r) => format!("waiting for {}", name(r.0)),
        Reason::Rate => "changing at its largest rate".into(),
        Reason::Fault(Fault::Source { region }) => format!("the source of {} is lost", name(region.0)),
        Reason::Fault(fault) => fault.to_string(),
    }
}
