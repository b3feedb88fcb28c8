//! Status of one robot.

use std::collections::BTreeMap;

use elbowroom_monitor::{Configuration, Monitor, RegionId, Snapshot, TickReport, VirtualTcp};
use elbowroom_spatial::Pose;
use serde::{Deserialize, Serialize};

use crate::event_status::EventStatus;
use crate::status_sample::{RegionSample, StatusSample};

/// The status of one robot after a tick of its monitor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotStatus {
    /// Time since the service started, s.
    pub t_s: f64,
    /// Name of the robot.
    pub robot: String,
    /// Joint positions in the order of the chain, rad or m; empty while unknown.
    pub q: Vec<f64>,
    /// The speed override to apply, 0..1.
    #[serde(rename = "override")]
    pub speed_override: f64,
    /// Reason for the override, in words.
    pub reason: String,
    /// The region that limits the override, if one does.
    pub region: Option<String>,
    /// State of each exchange region: `outside`, `waiting`, `granted`, `committed` or `inside`.
    pub exchange: BTreeMap<String, String>,
    /// Sequence number of the joint state that the override answers.
    pub sequence: u64,
    /// Pose of the TCP in the world, of the tool that is mounted; `None` without one, or without joint values.
    pub tcp: Option<PoseStatus>,
    /// Digital outputs, bit i is channel i.
    pub outputs: u64,
    /// The cell that the robot occupies in each of its grids; 0 is outside.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub grids: BTreeMap<String, u32>,
    /// The point that requests the smallest override, if one limits it.
    pub governing: Option<PointStatus>,
    /// The closest point of the robot to each region near it.
    pub virtual_tcps: Vec<PointStatus>,
    /// Every region of the robot.
    pub regions: Vec<RegionStatus>,
    /// The part about the service that runs the monitor; its fields are fields of the JSON object of the robot.
    #[serde(flatten)]
    pub service: ServiceStatus,
}

/// Status of the service of one robot.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ServiceStatus {
    /// The first 16 hexadecimal digits of the checksum of the configuration of the tick; empty if it is the cell file's
    /// configuration.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub configuration: String,
    /// Start of the keeper and revision of the table of regions that the node has received last; zeros before the first.
    #[serde(default)]
    pub table: (u64, u64),
    /// Health of the service.
    pub health: HealthStatus,
    /// Events since the status before.
    #[serde(default)]
    pub events: Vec<EventStatus>,
}

/// Health of the service of one robot.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct HealthStatus {
    /// Ticks since the service started.
    pub ticks: u64,
    /// Longest tick since the status before, from joint values to override, µs.
    pub tick_max_us: u64,
    /// Refused messages of the controller: late, doubled, damaged, of another start or another configuration.
    pub rejected: u64,
    /// Ticks without fresh joint values.
    pub stale: u64,
    /// Age of the node's message, s; 0 if the status is made in the node's process.
    #[serde(default)]
    pub age_s: f64,
}

/// A pose in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PoseStatus {
    /// Position, m.
    pub position_m: [f64; 3],
    /// Rotation as a unit quaternion `[x, y, z, w]`.
    pub quaternion_xyzw: [f64; 4],
}

/// A point of a robot and the closest point of a region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointStatus {
    /// The link, tool or load.
    pub part: String,
    /// The region.
    pub region: String,
    /// Distance, 0 inside, m.
    pub distance_m: f64,
    /// The point of the robot in the world, m.
    pub point_m: [f64; 3],
    /// The point of the region in the world, m.
    pub on_region_m: [f64; 3],
}

/// A region, for one robot.
#[allow(clippy::struct_excessive_bools, reason = "each is a state of its own")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionStatus {
    /// Its name.
    pub name: String,
    /// Whether it is on.
    pub active: bool,
    /// Whether the robot is inside.
    pub inside: bool,
    /// Whether the robot is inside or in the warning zone.
    pub warned: bool,
    /// Whether it stops this robot: it is forbidden, or taken by another robot.
    pub closed: bool,
    /// Pose of its shape in the world.
    pub pose: PoseStatus,
}

impl From<&Pose> for PoseStatus {
    fn from(pose: &Pose) -> Self {
        Self { position_m: pose.translation.to_array(), quaternion_xyzw: pose.rotation.to_quaternion_xyzw() }
    }
}

impl RobotStatus {
    /// Makes the status after a tick: the results of the monitor at this snapshot.
    ///
    /// `t_s` is the time since the service started, s; `tcp` the pose of the TCP in the world.
    pub fn of_tick(
        t_s: f64,
        monitor: &Monitor,
        snapshot: &Snapshot<'_>,
        report: &TickReport,
        tcp: Option<&Pose>,
    ) -> Self {
        let mut sample = StatusSample::new(monitor);
        sample.fill(monitor, snapshot, report);
        Self::of_sample(t_s, monitor.configuration(), &sample, tcp)
    }

    /// Makes the status from a sample of a tick, by a monitor of this configuration.
    pub fn of_sample(t_s: f64, configuration: &Configuration, sample: &StatusSample, tcp: Option<&Pose>) -> Self {
        let (regions, grids) = (configuration.regions(), configuration.grids());
        let name = |r: RegionId| regions[r.0].name.clone();
        let of_region = || sample.regions.iter().zip(regions);
        let report = &sample.report;
        let point = |point: &VirtualTcp| PointStatus::of(configuration, point);
        Self {
            t_s,
            robot: configuration.robot().to_owned(),
            q: sample.q.clone(),
            speed_override: report.speed_override,
            reason: report.reason.named(configuration).to_string(),
            region: report.reason.region().map(name),
            exchange: of_region().filter_map(|(s, r)| Some((r.name.clone(), s.exchange?.name().to_owned()))).collect(),
            sequence: 0,
            tcp: tcp.map(PoseStatus::from),
            outputs: report.outputs,
            grids: grids.iter().map(|g| (g.name.clone(), g.number_in(report.outputs))).collect(),
            governing: report.governing.as_ref().map(point),
            virtual_tcps: sample.virtual_tcps.iter().map(point).collect(),
            regions: of_region().map(|(s, r)| RegionStatus::of(&r.name, s)).collect(),
            service: ServiceStatus::default(),
        }
    }
}

impl PointStatus {
    fn of(configuration: &Configuration, point: &VirtualTcp) -> Self {
        Self {
            part: configuration.volumes()[point.volume.0].name.clone(),
            region: configuration.regions()[point.region.0].name.clone(),
            distance_m: point.distance_m,
            point_m: point.position.to_array(),
            on_region_m: point.on_region.to_array(),
        }
    }
}

impl RegionStatus {
    fn of(name: &str, sample: &RegionSample) -> Self {
        Self {
            name: name.to_owned(),
            active: sample.active,
            inside: sample.inside,
            warned: sample.warned,
            closed: sample.closed,
            pose: PoseStatus::from(&sample.in_world),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    use elbowroom_monitor::{ConfigurationParts, Guards, Laws, Region, Volume};
    use elbowroom_spatial::Vec3;

    /// Creates the monitor of a carriage on a rail, in front of a sphere.
    fn monitor() -> Result<Monitor, Box<dyn std::error::Error>> {
        let joint = Joint {
            name: "slide".into(),
            kind: JointKind::Prismatic,
            parent: LinkId(0),
            child: LinkId(1),
            origin: Pose::IDENTITY,
            axis: Vec3::X,
            limits: Limits { velocity: Some(1.0), ..Limits::symmetric(5.0) },
            mimic: None,
        };
        let chain = Chain::new("rail", vec!["bed".into(), "carriage".into()], vec![joint])?;
        let configuration = Configuration::new(ConfigurationParts {
            robot: "rail".into(),
            base_in_world: Pose::IDENTITY,
            chain,
            volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
            regions: vec![Region::sphere("ball", Vec3::X * 2.0, 0.5).warning(1.0).guards(Guards::TCP)],
            sources: vec![],
            grids: vec![],
            laws: Laws::default(),
        })?;
        Ok(Monitor::new(configuration, None)?)
    }

    #[test]
    fn a_point_of_the_robot_is_told_from_the_point_of_the_region() -> Result<(), Box<dyn std::error::Error>> {
        let mut monitor = monitor()?;
        let snapshot = Snapshot::stationary(0.0, &[0.75]);
        let report = monitor.tick(&snapshot);
        let status = RobotStatus::of_tick(0.0, &monitor, &snapshot, &report, None);
        let governing = status.governing.as_ref().ok_or("nothing governs")?;
        assert_eq!((governing.part.as_str(), governing.region.as_str()), ("tcp", "ball"));
        assert!((governing.distance_m - 0.75).abs() < 1e-9);
        assert_eq!((governing.point_m, governing.on_region_m), ([0.75, 0.0, 0.0], [1.5, 0.0, 0.0]));
        assert_eq!(status.virtual_tcps, std::slice::from_ref(governing));
        assert!(status.regions[0].warned && !status.regions[0].inside);
        assert_eq!(status.regions[0].pose.position_m, [2.0, 0.0, 0.0]);
        Ok(())
    }
}
