//! Messages of this project, in recordings only: the configuration of a monitor and its input in each tick, bit by bit.
//!
//! Poses are the twelve numbers of a rotation matrix with its translation, row by row, as the monitor has them: a
//! quaternion would round.

use crate::message::message;

message! {
    /// A solid. `kind` says which of the other fields are used.
    Solid = "elbowroom_msgs/msg/Solid" {
        /// 1 sphere, 2 capsule, 3 cylinder, 4 box, 5 half-space, 6 convex hull, 7 mesh.
        kind: u8,
        /// Radius, m.
        radius: f64,
        /// Half of the length along z, m.
        half_length: f64,
        /// Half of the edges of a box, m.
        half_extents: [f64; 3],
        /// Vertices, three numbers each, m.
        vertices: Vec<f64>,
        /// Triangles, three indices each.
        triangles: Vec<u32>,
    }
}

message! {
    /// A joint of a chain.
    ChainJoint = "elbowroom_msgs/msg/ChainJoint" {
        /// Its name.
        name: String,
        /// 0 fixed, 1 revolute, 2 continuous, 3 prismatic.
        kind: u8,
        /// Index of the link that carries it.
        parent: u32,
        /// Index of the link that it moves.
        child: u32,
        /// Pose of the child in the parent at position 0.
        origin: [f64; 12],
        /// Its axis.
        axis: [f64; 3],
        /// Least position, rad or m.
        lower: f64,
        /// Largest position, rad or m.
        upper: f64,
        /// Largest speed, rad/s or m/s; empty if unknown.
        velocity: Vec<f64>,
        /// Largest acceleration, rad/s² or m/s²; empty if unknown.
        acceleration: Vec<f64>,
        /// Largest effort; empty if unknown.
        effort: Vec<f64>,
        /// Largest plausible overshoot of its limits by a reading, rad or m; empty if unknown.
        overshoot_tolerance: Vec<f64>,
        /// Index of the joint that it follows; empty for an independent joint.
        mimic_joint: Vec<u32>,
        /// Multiplier of that joint's position.
        mimic_multiplier: f64,
        /// Offset added to it.
        mimic_offset: f64,
    }
}

message! {
    /// A guarded volume.
    GuardedVolume = "elbowroom_msgs/msg/GuardedVolume" {
        /// Its name.
        name: String,
        /// 0 TCP, 1 TCP outside of all solids, 2 tool, 3 load, 4 arm.
        part: u8,
        /// Index of its link.
        link: u32,
        /// Its shape.
        solid: Solid,
        /// Pose of the shape in the link.
        in_link: [f64; 12],
        /// 0 always present, 1 attached at first, 2 detached at first.
        presence: u8,
    }
}

message! {
    /// An interference region.
    Region = "elbowroom_msgs/msg/Region" {
        /// Its name.
        name: String,
        /// Its shape.
        solid: Solid,
        /// Pose of its frame in the world, or in the frame that it follows.
        anchor: [f64; 12],
        /// Pose of the shape in that frame.
        shape_in_anchor: [f64; 12],
        /// 0 forbidden, 1 monitored, 2 exchange.
        kind: u8,
        /// Override of a speed zone, 0..1; empty for other regions.
        slow_to: Vec<f64>,
        /// Slot of an exchange region.
        slot: u32,
        /// Whether it is permanent: it cannot be switched.
        permanent: bool,
        /// Thickness of the warning zone, m.
        warning_m: f64,
        /// Whether it guards against the TCP.
        guards_tcp: bool,
        /// Whether it guards against the tool.
        guards_tool: bool,
        /// Whether it guards against the whole arm.
        guards_arm: bool,
        /// Index of the source that it follows; empty if it does not move.
        follow: Vec<u32>,
        /// Hysteresis, m.
        hysteresis_m: f64,
        /// Output that is on while the robot is inside; empty without an output.
        output: Vec<u8>,
        /// Output that is on while the robot is in the warning zone; empty without an output.
        warning_output: Vec<u8>,
    }
}

message! {
    /// A source of motion that regions follow.
    Source = "elbowroom_msgs/msg/Source" {
        /// Its name.
        name: String,
        /// Largest speed, m/s.
        speed_m_s: f64,
        /// Largest turning rate, rad/s.
        turn_rad_s: f64,
        /// Travel after which it begins again, m; empty if it does not.
        wrap_m: Vec<f64>,
    }
}

message! {
    /// A division of the working area into numbered cells.
    Grid = "elbowroom_msgs/msg/Grid" {
        /// Its name.
        name: String,
        /// Frame in the world in which the tool centre point counts.
        frame_in_world: [f64; 12],
        /// The joints whose values count instead, as indices; empty if the point counts.
        joints: Vec<u32>,
        /// Low end of each axis, m or rad.
        from: Vec<f64>,
        /// High end of each axis, m or rad.
        to: Vec<f64>,
        /// Divisions of each axis.
        count: Vec<u32>,
        /// The digital output with the lowest bit.
        output: u8,
        /// How far beyond its border a cell is left, m or rad.
        hysteresis: f64,
    }
}

message! {
    /// The complete configuration of one robot's monitor.
    MonitorConfiguration = "elbowroom_msgs/msg/MonitorConfiguration" {
        /// Index of the robot in the recording.
        robot: u32,
        /// Its name.
        name: String,
        /// Checksum of this configuration.
        checksum: String,
        /// Pose of the root link in the world.
        base_in_world: [f64; 12],
        /// Name of the chain.
        chain: String,
        /// Names of the links.
        links: Vec<String>,
        /// The joints.
        joints: Vec<ChainJoint>,
        /// The guarded volumes.
        volumes: Vec<GuardedVolume>,
        /// The regions.
        regions: Vec<Region>,
        /// Whether exchange regions are granted from outside the process.
        granted_from_outside: bool,
        /// Sources that regions follow.
        sources: Vec<Source>,
        /// Whether the direction-aware law is on.
        direction_aware: bool,
        /// Override at which a robot may leave a region.
        recovery: f64,
        /// Largest change of the override per second; 0 for unlimited.
        override_rate: f64,
        /// Age at which input is stale, s.
        stale_s: f64,
        /// Whether the stopping-distance law is on.
        stopping_distance: bool,
        /// Its reaction time, s.
        reaction_s: f64,
        /// Its period, s.
        period_s: f64,
        /// Decelerations, rad/s² or m/s².
        joint_deceleration: Vec<f64>,
        /// Accelerations, rad/s² or m/s².
        joint_acceleration: Vec<f64>,
        /// The grids whose occupied cell is on digital outputs.
        grids: Vec<Grid>,
    }
}

message! {
    /// A region was switched.
    RegionSwitch = "elbowroom_msgs/msg/RegionSwitch" {
        /// Index of the region in the configuration.
        region: u32,
        /// Whether it is on now.
        active: bool,
    }
}

message! {
    /// A volume was attached or detached.
    VolumeAttachment = "elbowroom_msgs/msg/VolumeAttachment" {
        /// Index of the volume in the configuration.
        volume: u32,
        /// Whether it was attached; otherwise it was detached.
        attached: bool,
        /// Pose at which it was attached.
        in_link: [f64; 12],
    }
}

message! {
    /// Pose and motion of a source.
    SourceState = "elbowroom_msgs/msg/SourceState" {
        /// Pose in the world.
        pose: [f64; 12],
        /// Velocity, angular velocity, acceleration and angular acceleration in the world.
        motion: [f64; 12],
        /// Time stamp, s.
        stamp_s: f64,
    }
}

message! {
    /// One tick of a monitor: the changes since the tick before, the input, and the answer.
    MonitorTick = "elbowroom_msgs/msg/MonitorTick" {
        /// Index of the robot in the recording.
        robot: u32,
        /// Number of the tick, increasing by one; a missing number is a lost tick.
        sequence: u64,
        /// Regions that were switched before it, in order.
        switched: Vec<RegionSwitch>,
        /// Volumes that were attached or detached before it, in order.
        attached: Vec<VolumeAttachment>,
        /// Whether the position before it was forgotten: the robot may have been moved by hand.
        forgot_position: bool,
        /// Whether the robot was stopped by a fault that the input does not show, such as other regions than the monitor's.
        has_external_fault: bool,
        /// Time on the recording's clock, s.
        t_s: f64,
        /// Time on the monitor's clock, s: the controller's clock, if they differ.
        now_s: f64,
        /// Time stamp of the joint values, s.
        stamp_s: f64,
        /// Positions, rad or m.
        q: Vec<f64>,
        /// Velocities, rad/s or m/s; empty if unknown.
        qd: Vec<f64>,
        /// Accelerations, rad/s² or m/s²; empty if unknown.
        qdd: Vec<f64>,
        /// The override of the program, 0..1.
        programmed_override: f64,
        /// Whether the velocities of the program at override 1 are known.
        has_intent: bool,
        /// Velocities of the program at override 1.
        intent: Vec<f64>,
        /// States of the sources that regions follow.
        sources: Vec<SourceState>,
        /// The exchange slots that were granted to the robot in the tick.
        granted: Vec<u32>,
        /// The exchange slots because of which the robot had to halt.
        halted: Vec<u32>,
        /// The answer: the override to apply, 0..1.
        speed_override: f64,
        /// The answer's reason: 0 free, 1 region, 2 speed zone, 3 waiting, 4 rate, 5 fault, 6 halted.
        reason: u8,
        /// Index of the region that limits the override; -1 if none does.
        region: i32,
        /// The digital outputs.
        outputs: u64,
    }
}

message! {
    /// Data that a recorder had to omit because its queue was full.
    Lost = "elbowroom_msgs/msg/Lost" {
        /// Number of omitted ticks since the start.
        ticks: u64,
        /// Number of omitted statuses since the start.
        statuses: u64,
    }
}
