//! A tick as a message.

use elbowroom_monitor::{Monitor, OverrideReason, RegionId, RegionKind, SlotId, Snapshot, SourceState, TickReport};
use elbowroom_ros2::msgs::elbowroom_msgs::{MonitorTick, SourceState as SourceMessage};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use crate::solid::{pose_of, pose_values};

/// Writes a tick into a message. Does not allocate if the message has held such a tick before.
pub(crate) fn write(to: &mut MonitorTick, robot: u32, snapshot: &Snapshot<'_>, report: &TickReport, monitor: &Monitor) {
    let copy = |to: &mut Vec<f64>, from: &[f64]| {
        to.clear();
        to.extend_from_slice(from);
    };
    to.robot = robot;
    to.has_external_fault = monitor.external_fault().is_some();
    (to.now_s, to.stamp_s) = (snapshot.now_s, snapshot.stamp_s);
    copy(&mut to.q, snapshot.q);
    copy(&mut to.qd, snapshot.qd);
    copy(&mut to.qdd, snapshot.qdd);
    to.programmed_override = snapshot.programmed_override;
    to.has_intent = snapshot.intent.is_some();
    copy(&mut to.intent, snapshot.intent.unwrap_or_default());
    to.sources.clear();
    to.sources.extend(snapshot.sources.iter().map(source));
    let grants = monitor.slot_grants();
    to.granted.clear();
    // A robot that shares an arbiter was granted the slots that it holds now.
    to.granted.extend(slots(monitor, |r, slot| grants.map_or_else(|| monitor.holds(r), |g| g.may_enter(slot))));
    to.halted.clear();
    to.halted.extend(slots(monitor, |_, slot| grants.is_some_and(|g| g.must_halt(slot))));
    to.speed_override = report.speed_override;
    (to.reason, to.region) = reason(report.reason);
    to.outputs = report.outputs;
}

/// Returns the slots of exchange regions that satisfy `is_so`, each once.
fn slots(monitor: &Monitor, is_so: impl Fn(RegionId, SlotId) -> bool) -> impl Iterator<Item = u32> {
    let regions = monitor.configuration().regions();
    let slot = move |r: usize| match regions[r].kind {
        RegionKind::Exchange { slot } if is_so(RegionId(r), slot) => u32::try_from(slot.0).ok(),
        _ => None,
    };
    (0..regions.len()).filter_map(move |r| slot(r).filter(|s| !(0..r).any(|before| slot(before) == Some(*s))))
}

fn source(state: &SourceState) -> SourceMessage {
    let FrameMotion { velocity, angular_velocity, acceleration, angular_acceleration } = state.motion;
    let mut motion = [0.0; 12];
    let vectors = [velocity, angular_velocity, acceleration, angular_acceleration];
    motion.as_chunks_mut::<3>().0.iter_mut().zip(vectors).for_each(|(to, v)| *to = v.to_array());
    SourceMessage { pose: pose_values(&state.pose), motion, stamp_s: state.stamp_s }
}

/// Reads the state of a source. An invalid rotation counts as not finite, as the monitor saw it.
pub(crate) fn source_state(message: &SourceMessage) -> SourceState {
    let vector = |i: usize| Vec3::new(message.motion[3 * i], message.motion[3 * i + 1], message.motion[3 * i + 2]);
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, f64::NAN, f64::NAN));
    SourceState {
        pose: pose_of(&message.pose).unwrap_or(nowhere),
        motion: FrameMotion {
            velocity: vector(0),
            angular_velocity: vector(1),
            acceleration: vector(2),
            angular_acceleration: vector(3),
        },
        stamp_s: message.stamp_s,
    }
}

/// Returns the number of a reason, and its region.
pub(crate) fn reason(reason: OverrideReason) -> (u8, i32) {
    let code = match reason {
        OverrideReason::Free => 0,
        OverrideReason::Region(_) => 1,
        OverrideReason::SpeedZone(_) => 2,
        OverrideReason::Waiting(_) => 3,
        OverrideReason::Rate => 4,
        OverrideReason::Fault(_) => 5,
        OverrideReason::Halted(_) => 6,
    };
    (code, reason.region().and_then(|r| i32::try_from(r.0).ok()).unwrap_or(-1))
}
