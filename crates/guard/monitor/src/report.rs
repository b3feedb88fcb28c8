//! Result of a tick.

use std::fmt;

use elbowroom_kinematics::Joint;
use elbowroom_spatial::Vec3;

use crate::{Configuration, RegionId, VolumeId};

/// The result of one tick: plain data with a fixed size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickReport {
    /// Time stamp of the snapshot, s.
    pub stamp_s: f64,
    /// The speed override to apply, 0..1; it includes the programmed override.
    pub speed_override: f64,
    /// Why the override has this value; [`OverrideReason::named`] shows it with names.
    pub reason: OverrideReason,
    /// The virtual TCP that requests the smallest override, if one limits the override.
    pub governing: Option<VirtualTcp>,
    /// Digital outputs, bit i is channel i.
    pub outputs: u64,
    /// Number of pairs of volume and region whose exact distance was computed in this tick.
    pub measured_pairs: u32,
}

/// The closest point of the guarded volume to a region (CPD of Romanelli 2011).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualTcp {
    /// The region.
    pub region: RegionId,
    /// The volume.
    pub volume: VolumeId,
    /// Distance to the region, 0 inside, m.
    pub distance_m: f64,
    /// The point of the volume, in the world, m.
    pub position: Vec3,
    /// The closest point of the region, in the world, m.
    pub on_region: Vec3,
    /// Velocity of the point relative to the region, m/s.
    pub velocity: Vec3,
    /// Acceleration of the point relative to the region, m/s².
    pub acceleration: Vec3,
}

/// Why the speed override has its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OverrideReason {
    /// No region requests less than the programmed override.
    Free,
    /// A forbidden region limits the override.
    Region(RegionId),
    /// A speed zone limits the override.
    SpeedZone(RegionId),
    /// An exchange region that is not granted to this robot limits the override.
    Waiting(RegionId),
    /// The interlock halts the robot: another robot was found inside an exchange region that only one robot may enter.
    Halted(RegionId),
    /// The override is rising or falling at its largest rate.
    Rate,
    /// A fault stops the robot.
    Fault(Fault),
}

impl OverrideReason {
    /// The region that limits the override, if one does.
    pub fn region(self) -> Option<RegionId> {
        match self {
            Self::Region(r) | Self::SpeedZone(r) | Self::Waiting(r) | Self::Halted(r) => Some(r),
            Self::Free | Self::Rate | Self::Fault(_) => None,
        }
    }

    /// The reason with the names of regions and joints, for messages. `configuration` is that of the monitor. Without it,
    /// `Display` shows indices.
    ///
    /// ```
    /// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    /// # use elbowroom_monitor::{Configuration, ConfigurationParts, Laws};
    /// use elbowroom_monitor::{Fault, OverrideReason, Region, RegionId};
    /// use elbowroom_spatial::{Pose, Rotation, Vec3};
    /// # let slide = Joint {
    /// #     name: "slide".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
    /// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None,
    /// # };
    /// # let chain = Chain::new("slide", vec!["base".into(), "carriage".into()], vec![slide])?;
    /// let regions = vec![Region::cylinder("post", Vec3::ZERO, 0.1, 2.0, Rotation::IDENTITY)];
    /// # let configuration = Configuration::new(ConfigurationParts {
    /// #     robot: "slide".into(), base_in_world: Pose::IDENTITY, volumes: vec![], regions, sources: vec![],
    /// #     grids: vec![], laws: Laws::default(), chain,
    /// # })?;
    /// let reason = OverrideReason::Region(RegionId(0));
    /// assert_eq!(reason.named(&configuration).to_string(), "near forbidden region `post`");
    /// assert_eq!(reason.to_string(), "near forbidden region 0");
    /// let reason = OverrideReason::Fault(Fault::BeyondLimits { joint: 0, overshoot: 0.125 });
    /// let text = "joint `slide` is at 2.1250 m, 0.1250 m beyond its upper limit 2.0000 m; 0.0500 m are tolerated";
    /// assert_eq!(reason.named(&configuration).to_string(), text);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn named(self, configuration: &Configuration) -> NamedReason<'_> {
        NamedReason { reason: self, configuration: Some(configuration) }
    }

    /// The reason with its region, or the region of its fault, under another index.
    #[must_use]
    pub fn with_region(self, index: impl FnOnce(RegionId) -> RegionId) -> Self {
        match self {
            Self::Region(r) => Self::Region(index(r)),
            Self::SpeedZone(r) => Self::SpeedZone(index(r)),
            Self::Waiting(r) => Self::Waiting(index(r)),
            Self::Halted(r) => Self::Halted(index(r)),
            Self::Fault(Fault::Source { region }) => Self::Fault(Fault::Source { region: index(region) }),
            Self::Fault(Fault::SourceJump { region }) => Self::Fault(Fault::SourceJump { region: index(region) }),
            Self::Free | Self::Rate | Self::Fault(_) => self,
        }
    }
}

impl fmt::Display for OverrideReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        NamedReason { reason: *self, configuration: None }.fmt(f)
    }
}

/// An [`OverrideReason`] with the names of regions and joints: [`OverrideReason::named`].
#[derive(Debug, Clone, Copy)]
pub struct NamedReason<'a> {
    reason: OverrideReason,
    configuration: Option<&'a Configuration>,
}

impl NamedReason<'_> {
    /// The name of a region, or its index if it is not one of the given regions.
    fn name(&self, id: RegionId) -> RegionName<'_> {
        let region = self.configuration.and_then(|configuration| configuration.regions().get(id.0));
        region.map_or(RegionName::Index(id.0), |region| RegionName::Name(&region.name))
    }

    /// The independent joint with this index in `q`.
    fn joint(&self, index: usize) -> Option<&Joint> {
        let chain = self.configuration?.chain();
        Some(&chain.joints()[chain.active_joints().get(index)?.0])
    }
}

/// A reading beyond the limits of its joint, in words.
fn write_overshoot(f: &mut fmt::Formatter<'_>, joint: &Joint, overshoot: f64) -> fmt::Result {
    let unit = if joint.kind.turns() { "rad" } else { "m" };
    let (side, limit) = if overshoot < 0.0 { ("lower", joint.limits.lower) } else { ("upper", joint.limits.upper) };
    let (name, value, beyond) = (&joint.name, limit + overshoot, overshoot.abs());
    let tolerated = joint.limits.tolerated_overshoot();
    write!(
        f,
        "joint `{name}` is at {value:.4} {unit}, {beyond:.4} {unit} beyond its {side} limit {limit:.4} {unit}; "
    )?;
    write!(f, "{tolerated:.4} {unit} are tolerated")
}

impl fmt::Display for NamedReason<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reason {
            OverrideReason::Free => write!(f, "free"),
            OverrideReason::Region(r) => write!(f, "near forbidden region {}", self.name(r)),
            OverrideReason::SpeedZone(r) => write!(f, "speed zone {}", self.name(r)),
            OverrideReason::Waiting(r) => write!(f, "waiting for exchange region {}", self.name(r)),
            OverrideReason::Halted(r) => {
                write!(f, "halted: two robots are in exchange region {}, move one of them out by hand", self.name(r))
            }
            OverrideReason::Rate => write!(f, "override changing at its largest rate"),
            OverrideReason::Fault(Fault::Source { region }) => {
                write!(f, "the source that region {} follows is lost", self.name(region))
            }
            OverrideReason::Fault(Fault::SourceJump { region }) => {
                let name = self.name(region);
                write!(f, "the source that region {name} follows jumped, or moves otherwise than it says")
            }
            OverrideReason::Fault(fault @ Fault::BeyondLimits { joint, overshoot }) => match self.joint(joint) {
                Some(joint) => write_overshoot(f, joint, overshoot),
                None => write!(f, "{fault}"),
            },
            OverrideReason::Fault(fault) => write!(f, "{fault}"),
        }
    }
}

enum RegionName<'a> {
    Index(usize),
    Name(&'a str),
}

impl fmt::Display for RegionName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Name(name) => write!(f, "`{name}`"),
        }
    }
}

/// A fault, such as invalid input, that stops the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// The input is older than [`Laws::stale_s`](crate::Laws).
    Stale,
    /// The time stamp lies before the time stamp of the previous snapshot, or in the future.
    Backwards,
    /// A number is NaN or infinite.
    NotFinite,
    /// A slice does not have one entry per joint, or per source.
    WrongLength,
    /// The programmed override is not within 0..1.
    ProgrammedOverride,
    /// A joint is farther beyond its limits than is [tolerated](elbowroom_kinematics::Limits::tolerated_overshoot).
    BeyondLimits {
        /// Index of the joint in `q`.
        joint: usize,
        /// Its [overshoot](elbowroom_kinematics::Limits::overshoot), rad or m.
        overshoot: f64,
    },
    /// A joint is implausibly fast, or has moved implausibly far since the previous snapshot.
    TooFast {
        /// Index of the joint in `q`.
        joint: usize,
    },
    /// The stopping-distance law is on and no velocity is known: the snapshot has none, and its position is the first.
    NoVelocity,
    /// The joint values are bitwise constant although the robot is commanded to move: the reading is frozen.
    Frozen,
    /// The robot brakes less than stated in [`StoppingSettings`](crate::StoppingSettings).
    Braking,
    /// The present regions are unknown, or the monitor is not built for them yet. A monitor cannot detect this by
    /// itself: its host reports it with [`Monitor::set_external_fault`](crate::Monitor::set_external_fault).
    Regions,
    /// The source of motion that an active region follows is stale or not finite.
    Source {
        /// The region.
        region: RegionId,
    },
    /// The source of motion that an active region follows has moved farther than its limits, or than its reported motion,
    /// allow.
    SourceJump {
        /// The region.
        region: RegionId,
    },
}

impl Fault {
    /// Whether two faults are one that goes on: of the same kind and place, whatever its numbers are in this tick.
    pub(crate) fn is_same_as(self, other: Self) -> bool {
        match (self, other) {
            (Self::BeyondLimits { joint: a, .. }, Self::BeyondLimits { joint: b, .. }) => a == b,
            (a, b) => a == b,
        }
    }

    /// True if the time stamps of the snapshot are valid.
    pub(crate) fn has_valid_time(self) -> bool {
        use Fault::{BeyondLimits, Braking, Frozen, NoVelocity, Source, SourceJump, TooFast};
        matches!(
            self,
            BeyondLimits { .. } | TooFast { .. } | NoVelocity | Frozen | Braking | Source { .. } | SourceJump { .. }
        )
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stale => write!(f, "input is stale"),
            Self::Backwards => write!(f, "input is out of order"),
            Self::NotFinite => write!(f, "input is not a finite number"),
            Self::WrongLength => write!(f, "input has the wrong number of values"),
            Self::ProgrammedOverride => write!(f, "the programmed override is not within 0..1"),
            Self::BeyondLimits { joint, overshoot } => {
                write!(f, "joint {joint} is {:.4} rad or m beyond its limits", overshoot.abs())
            }
            Self::TooFast { joint } => write!(f, "joint {joint} moves faster than it can"),
            Self::NoVelocity => write!(f, "no joint velocities are known yet"),
            Self::Frozen => write!(f, "joint values do not change although the robot is reported to move"),
            Self::Braking => write!(f, "the robot brakes less than its stated deceleration"),
            Self::Regions => write!(f, "the regions of the cell have changed, or are not known"),
            Self::Source { region } => write!(f, "the source that region {} follows is lost", region.0),
            Self::SourceJump { region } => {
                write!(f, "the source that region {} follows jumped, or moves otherwise than it says", region.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_with_a_region_gets_its_other_index() {
        let [from, to] = [RegionId(0), RegionId(7)];
        let reasons = |region: RegionId| {
            [
                OverrideReason::Region(region),
                OverrideReason::SpeedZone(region),
                OverrideReason::Waiting(region),
                OverrideReason::Halted(region),
                OverrideReason::Fault(Fault::Source { region }),
                OverrideReason::Fault(Fault::SourceJump { region }),
            ]
        };
        assert_eq!(reasons(from).map(|r| r.with_region(|_| to)), reasons(to));
    }
}
