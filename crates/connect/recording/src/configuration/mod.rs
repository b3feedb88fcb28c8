//! Configuration of a monitor as a message and back, bit by bit.
//!
//! Both conversions name every field: a new field of a configuration does not compile here until it is recorded.

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, GridSpace, Guards, Laws, Life, Monitor, OutputGrid, OutputGridAxis, Part,
    Presence, Region, RegionKind, SlotId, SourceId, SourceLimits, SourceSpec, StoppingSettings, Volume,
};
use elbowroom_ros2::msgs::elbowroom_msgs as msgs;
use elbowroom_spatial::Pose;

use crate::{ConfigurationDefect, solid};

/// Makes the message of a monitor's configuration.
pub(crate) fn of_monitor(robot: u32, monitor: &Monitor) -> msgs::MonitorConfiguration {
    let granted_from_outside = monitor.slot_grants().is_some();
    msgs::MonitorConfiguration { granted_from_outside, ..encode(robot, monitor.configuration()) }
}

fn encode(robot: u32, configuration: &Configuration) -> msgs::MonitorConfiguration {
    let Laws { direction_aware, recovery, stopping_distance, override_rate, stale_s } = configuration.laws().clone();
    let stopping = stopping_distance.as_ref();
    msgs::MonitorConfiguration {
        robot,
        name: configuration.robot().to_owned(),
        checksum: configuration.checksum(),
        base_in_world: solid::pose_values(configuration.base_in_world()),
        chain: configuration.chain().name().to_owned(),
        links: configuration.chain().links().to_vec(),
        joints: configuration.chain().joints().iter().map(joint).collect(),
        volumes: configuration.volumes().iter().map(volume).collect(),
        regions: configuration.regions().iter().map(region).collect(),
        granted_from_outside: false,
        sources: configuration.sources().iter().map(source).collect(),
        direction_aware,
        recovery,
        override_rate,
        stale_s,
        stopping_distance: stopping.is_some(),
        reaction_s: stopping.map_or(0.0, |s| s.reaction_s),
        period_s: stopping.map_or(0.0, |s| s.period_s),
        joint_deceleration: stopping.map_or_else(Vec::new, |s| s.joint_deceleration.clone()),
        joint_acceleration: stopping.map_or_else(Vec::new, |s| s.joint_acceleration.clone()),
        grids: configuration.grids().iter().map(grid).collect(),
    }
}

fn joint(joint: &Joint) -> msgs::ChainJoint {
    let Joint { name, kind, parent, child, origin, axis, limits, mimic } = joint;
    let Limits { lower, upper, velocity, acceleration, effort, overshoot_tolerance } = *limits;
    msgs::ChainJoint {
        name: name.clone(),
        kind: match kind {
            JointKind::Fixed => 0,
            JointKind::Revolute => 1,
            JointKind::Continuous => 2,
            JointKind::Prismatic => 3,
        },
        parent: index(parent.0),
        child: index(child.0),
        origin: solid::pose_values(origin),
        axis: axis.to_array(),
        lower,
        upper,
        velocity: velocity.into_iter().collect(),
        acceleration: acceleration.into_iter().collect(),
        effort: effort.into_iter().collect(),
        overshoot_tolerance: overshoot_tolerance.into_iter().collect(),
        mimic_joint: mimic.iter().map(|m| index(m.joint.0)).collect(),
        mimic_multiplier: mimic.map_or(0.0, |m| m.multiplier),
        mimic_offset: mimic.map_or(0.0, |m| m.offset),
    }
}

fn volume(volume: &Volume) -> msgs::GuardedVolume {
    let Volume { name, part, link, shape, in_link, presence } = volume;
    msgs::GuardedVolume {
        name: name.clone(),
        part: match part {
            Part::Tcp => 0,
            Part::TcpOutside => 1,
            Part::Tool => 2,
            Part::Load => 3,
            Part::Arm => 4,
        },
        link: index(link.0),
        solid: solid::encode(shape),
        in_link: solid::pose_values(in_link),
        presence: match presence {
            Presence::Always => 0,
            Presence::Attached => 1,
            Presence::Detached => 2,
        },
    }
}

fn region(region: &Region) -> msgs::Region {
    let Region {
        name,
        shape,
        anchor,
        shape_in_anchor,
        kind,
        life,
        warning_m,
        guards: Guards { tcp, tool, arm },
        follow,
        hysteresis_m,
        output,
        warning_output,
    } = region;
    let (kind, slow_to, slot) = match kind {
        RegionKind::Forbidden => (0, None, SlotId(0)),
        RegionKind::Monitored { slow_to } => (1, *slow_to, SlotId(0)),
        RegionKind::Exchange { slot } => (2, None, *slot),
    };
    msgs::Region {
        name: name.clone(),
        solid: solid::encode(shape),
        anchor: solid::pose_values(anchor),
        shape_in_anchor: solid::pose_values(shape_in_anchor),
        kind,
        slow_to: slow_to.into_iter().collect(),
        slot: index(slot.0),
        permanent: *life == Life::Permanent,
        warning_m: *warning_m,
        guards_tcp: *tcp,
        guards_tool: *tool,
        guards_arm: *arm,
        follow: follow.iter().map(|s| index(s.0)).collect(),
        hysteresis_m: *hysteresis_m,
        output: output.iter().copied().collect(),
        warning_output: warning_output.iter().copied().collect(),
    }
}

fn source(source: &SourceSpec) -> msgs::Source {
    let SourceSpec { name, limits: SourceLimits { speed_m_s, turn_rad_s, wrap_m } } = source;
    msgs::Source {
        name: name.clone(),
        speed_m_s: *speed_m_s,
        turn_rad_s: *turn_rad_s,
        wrap_m: wrap_m.iter().flat_map(|w| w.to_array()).collect(),
    }
}

fn grid(grid: &OutputGrid) -> msgs::Grid {
    let OutputGrid { name, space, axes, output, hysteresis } = grid;
    let (frame_in_world, joints) = match space {
        GridSpace::Tcp { frame_in_world } => (*frame_in_world, Vec::new()),
        GridSpace::Joints(joints) => (Pose::IDENTITY, joints.iter().map(|j| index(*j)).collect()),
    };
    msgs::Grid {
        name: name.clone(),
        frame_in_world: solid::pose_values(&frame_in_world),
        joints,
        from: axes.iter().map(|a| a.from).collect(),
        to: axes.iter().map(|a| a.to).collect(),
        count: axes.iter().map(|a| a.count).collect(),
        output: *output,
        hysteresis: *hysteresis,
    }
}

/// Converts an index; no index in a configuration comes near the limit.
fn index(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

/// Reads a configuration from a message.
pub(crate) fn decode(message: &msgs::MonitorConfiguration) -> Result<Configuration, ConfigurationDefect> {
    let joints = message.joints.iter().map(read_joint).collect::<Result<_, _>>()?;
    let chain = Chain::new(&message.chain, message.links.clone(), joints)?;
    let stopping = StoppingSettings {
        reaction_s: message.reaction_s,
        period_s: message.period_s,
        joint_deceleration: message.joint_deceleration.clone(),
        joint_acceleration: message.joint_acceleration.clone(),
    };
    let laws = Laws {
        direction_aware: message.direction_aware,
        recovery: message.recovery,
        stopping_distance: message.stopping_distance.then_some(stopping),
        override_rate: message.override_rate,
        stale_s: message.stale_s,
    };
    let parts = ConfigurationParts {
        robot: message.name.clone(),
        base_in_world: pose(&message.base_in_world, "the base")?,
        chain,
        volumes: message.volumes.iter().map(read_volume).collect::<Result<_, _>>()?,
        regions: message.regions.iter().map(read_region).collect::<Result<_, _>>()?,
        sources: message.sources.iter().map(read_source).collect::<Result<_, _>>()?,
        grids: message.grids.iter().map(read_grid).collect::<Result<_, _>>()?,
        laws,
    };
    Ok(Configuration::new(parts)?)
}

fn pose(values: &[f64; 12], what: &str) -> Result<Pose, ConfigurationDefect> {
    solid::pose_of(values).ok_or_else(|| ConfigurationDefect::Pose(what.to_owned()))
}

fn read_joint(message: &msgs::ChainJoint) -> Result<Joint, ConfigurationDefect> {
    let mimic = one(&message.mimic_joint).map(|joint| Mimic {
        joint: JointId(joint as usize),
        multiplier: message.mimic_multiplier,
        offset: message.mimic_offset,
    });
    Ok(Joint {
        name: message.name.clone(),
        kind: match message.kind {
            0 => JointKind::Fixed,
            1 => JointKind::Revolute,
            2 => JointKind::Continuous,
            3 => JointKind::Prismatic,
            number => return Err(ConfigurationDefect::Kind { what: "joint of kind", number }),
        },
        parent: LinkId(message.parent as usize),
        child: LinkId(message.child as usize),
        origin: pose(&message.origin, &message.name)?,
        axis: message.axis.into(),
        limits: Limits {
            lower: message.lower,
            upper: message.upper,
            velocity: one(&message.velocity),
            acceleration: one(&message.acceleration),
            effort: one(&message.effort),
            overshoot_tolerance: one(&message.overshoot_tolerance),
        },
        mimic,
    })
}

fn read_volume(message: &msgs::GuardedVolume) -> Result<Volume, ConfigurationDefect> {
    Ok(Volume {
        name: message.name.clone(),
        part: match message.part {
            0 => Part::Tcp,
            1 => Part::TcpOutside,
            2 => Part::Tool,
            3 => Part::Load,
            4 => Part::Arm,
            number => return Err(ConfigurationDefect::Kind { what: "part", number }),
        },
        link: LinkId(message.link as usize),
        shape: solid::decode(&message.solid)?,
        in_link: pose(&message.in_link, &message.name)?,
        presence: match message.presence {
            0 => Presence::Always,
            1 => Presence::Attached,
            2 => Presence::Detached,
            number => return Err(ConfigurationDefect::Kind { what: "presence", number }),
        },
    })
}

fn read_region(message: &msgs::Region) -> Result<Region, ConfigurationDefect> {
    Ok(Region {
        name: message.name.clone(),
        shape: solid::decode(&message.solid)?,
        anchor: pose(&message.anchor, &message.name)?,
        shape_in_anchor: pose(&message.shape_in_anchor, &message.name)?,
        kind: match message.kind {
            0 => RegionKind::Forbidden,
            1 => RegionKind::Monitored { slow_to: one(&message.slow_to) },
            2 => RegionKind::Exchange { slot: SlotId(message.slot as usize) },
            number => return Err(ConfigurationDefect::Kind { what: "region of kind", number }),
        },
        life: if message.permanent { Life::Permanent } else { Life::Temporary },
        warning_m: message.warning_m,
        guards: Guards { tcp: message.guards_tcp, tool: message.guards_tool, arm: message.guards_arm },
        follow: one(&message.follow).map(|s| SourceId(s as usize)),
        hysteresis_m: message.hysteresis_m,
        output: one(&message.output),
        warning_output: one(&message.warning_output),
    })
}

fn read_source(message: &msgs::Source) -> Result<SourceSpec, ConfigurationDefect> {
    let wrap_m = match message.wrap_m[..] {
        [] => None,
        [x, y, z] => Some([x, y, z].into()),
        _ => return Err(ConfigurationDefect::Travel),
    };
    let limits = SourceLimits { speed_m_s: message.speed_m_s, turn_rad_s: message.turn_rad_s, wrap_m };
    Ok(SourceSpec { name: message.name.clone(), limits })
}

fn read_grid(message: &msgs::Grid) -> Result<OutputGrid, ConfigurationDefect> {
    let msgs::Grid { name, frame_in_world, joints, from, to, count, output, hysteresis } = message;
    let frame_in_world = pose(frame_in_world, name)?;
    let space = match &joints[..] {
        [] => GridSpace::Tcp { frame_in_world },
        joints => GridSpace::Joints(joints.iter().map(|j| *j as usize).collect()),
    };
    if from.len() != to.len() || to.len() != count.len() {
        return Err(ConfigurationDefect::Axes(name.clone()));
    }
    let ends = from.iter().zip(to).zip(count);
    let axes = ends.map(|((from, to), count)| OutputGridAxis { from: *from, to: *to, count: *count }).collect();
    Ok(OutputGrid { name: name.clone(), space, axes, output: *output, hysteresis: *hysteresis })
}

/// Reads the value of an optional field.
fn one<T: Copy>(values: &[T]) -> Option<T> {
    values.first().copied()
}

#[cfg(test)]
mod tests;
