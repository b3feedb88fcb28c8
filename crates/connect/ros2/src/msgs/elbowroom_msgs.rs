//! Messages of our own, in recordings only: what a monitor was built from, and what it was given in each tick, bit by bit.
//!
//! Poses are the twelve numbers of a rotation matrix with its translation, row by row, as the monitor has them: a quaternion
//! would round.

use crate::message::message;

message! {
    /// A solid. `kind` says which of the fields count.
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
        /// Pose of the child in the parent at 0.
        origin: [f64; 12],
        /// Its axis.
        axis: [f64; 3],
        /// Least position, rad or m.
        lower: f64,
        /// Largest position, rad or m.
        upper: f64,
        /// Largest speed; empty if it is not known.
        velocity: Vec<f64>,
        /// Largest acceleration; empty if it is not known.
        acceleration: Vec<f64>,
        /// Largest effort; empty if it is not known.
        effort: Vec<f64>,
        /// Index of the joint that it follows; empty for one that moves by itself.
        mimic_joint: Vec<u32>,
        /// Multiplier of that joint's position.
        mimic_multiplier: f64,
        /// Added to it.
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
        /// 0 always there, 1 attached at first, 2 detached at first.
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
        /// Of a speed zone its override, 0..1; else empty.
        slow_to: Vec<f64>,
        /// Of an exchange region its slot.
        slot: u32,
        /// It cannot be switched.
        permanent: bool,
        /// Thickness of the warning zone, m.
        warning_m: f64,
        /// It guards against the TCP.
        guards_tcp: bool,
        /// It guards against the tool.
        guards_tool: bool,
        /// It guards against the whole arm.
        guards_arm: bool,
        /// Index of the source that it follows; else empty.
        follow: Vec<u32>,
        /// Hysteresis, m.
        hysteresis_m: f64,
        /// Output that is on while the robot is inside; else empty.
        output: Vec<u8>,
        /// Output that is on while the robot is in the warning zone; else empty.
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
        /// The travel after which it begins again, m; else empty.
        wrap_m: Vec<f64>,
    }
}

message! {
    /// Everything that the monitor of one robot was built from.
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
        /// Exchange regions are granted from outside of the process.
        granted_from_outside: bool,
        /// What regions follow.
        sources: Vec<Source>,
        /// The law that knows directions is on.
        direction_aware: bool,
        /// Override at which a robot may leave a region.
        recovery: f64,
        /// Largest change of the override per second; 0: any.
        override_rate: f64,
        /// Age at which input is stale, s.
        stale_s: f64,
        /// The stopping-distance law is on.
        stopping_distance: bool,
        /// Its reaction time, s.
        reaction_s: f64,
        /// Its period, s.
        period_s: f64,
        /// Decelerations, rad/s² or m/s².
        joint_deceleration: Vec<f64>,
        /// Accelerations, rad/s² or m/s².
        joint_acceleration: Vec<f64>,
    }
}

message! {
    /// A region was switched.
    RegionSwitch = "elbowroom_msgs/msg/RegionSwitch" {
        /// Index of the region in the configuration.
        region: u32,
        /// On or off.
        active: bool,
    }
}

message! {
    /// A volume was attached or detached.
    VolumeAttachment = "elbowroom_msgs/msg/VolumeAttachment" {
        /// Index of the volume in the configuration.
        volume: u32,
        /// Attached, or detached.
        attached: bool,
        /// Where it was attached.
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
    /// One tick of a monitor: what had changed since the tick before, the input, and the answer.
    MonitorTick = "elbowroom_msgs/msg/MonitorTick" {
        /// Index of the robot in the recording.
        robot: u32,
        /// Number of the tick, one more for each; where one is missing, it was lost.
        sequence: u64,
        /// Regions that were switched before it, in order.
        switched: Vec<RegionSwitch>,
        /// Volumes that were attached or detached before it, in order.
        attached: Vec<VolumeAttachment>,
        /// The position before it was forgotten: the robot may have been moved by hand.
        forgot_position: bool,
        /// A fault stopped the robot that the input does not show, such as other regions than the monitor's.
        has_external_fault: bool,
        /// Time of the recording's clock, s.
        t_s: f64,
        /// Time of the monitor's clock, s: that of the controller, where they differ.
        now_s: f64,
        /// Time stamp of the joint values, s.
        stamp_s: f64,
        /// Positions, rad or m.
        q: Vec<f64>,
        /// Velocities; empty if they are not known.
        qd: Vec<f64>,
        /// Accelerations; empty if they are not known.
        qdd: Vec<f64>,
        /// The override of the program, 0..1.
        programmed_override: f64,
        /// The velocities of the program at override 1 are known.
        has_intent: bool,
        /// They.
        intent: Vec<f64>,
        /// What regions follow.
        sources: Vec<SourceState>,
        /// The exchange slots that were granted to the robot in the tick.
        granted: Vec<u32>,
        /// The exchange slots because of which it had to halt.
        halted: Vec<u32>,
        /// The answer: the override to apply, 0..1.
        speed_override: f64,
        /// The answer's reason: 0 free, 1 region, 2 speed zone, 3 waiting, 4 rate, 5 fault, 6 halted.
        reason: u8,
        /// Index of the region that limits the override; else -1.
        region: i32,
        /// The digital outputs.
        outputs: u64,
    }
}

message! {
    /// What a recorder had to leave out, as its queue was full.
    Lost = "elbowroom_msgs/msg/Lost" {
        /// Ticks of monitors since the start.
        ticks: u64,
        /// Statuses since the start.
        statuses: u64,
    }
}
