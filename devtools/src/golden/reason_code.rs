//! Reasons of overrides as numbers, independent of their names and texts.

use elbowroom_monitor::{Fault, OverrideReason, RegionId};

/// Returns the kind of a reason, and the region or the joint that it names.
pub fn code(reason: OverrideReason) -> (usize, Option<usize>) {
    let of = |kind, RegionId(region)| (kind, Some(region));
    match reason {
        OverrideReason::Free => (0, None),
        OverrideReason::Region(region) => of(1, region),
        OverrideReason::SpeedZone(region) => of(2, region),
        OverrideReason::Waiting(region) => of(3, region),
        OverrideReason::Halted(region) => of(4, region),
        OverrideReason::Rate => (5, None),
        OverrideReason::Fault(fault) => of_fault(fault),
    }
}

fn of_fault(fault: Fault) -> (usize, Option<usize>) {
    match fault {
        Fault::Stale => (10, None),
        Fault::Backwards => (11, None),
        Fault::NotFinite => (12, None),
        Fault::WrongLength => (13, None),
        Fault::ProgrammedOverride => (14, None),
        Fault::BeyondLimits { joint, .. } => (15, Some(joint)),
        Fault::TooFast { joint } => (16, Some(joint)),
        Fault::NoVelocity => (17, None),
        Fault::Frozen => (18, None),
        Fault::Braking => (19, None),
        Fault::Regions => (20, None),
        Fault::Source { region } => (21, Some(region.0)),
        Fault::SourceJump { region } => (22, Some(region.0)),
    }
}
