//! Configuration of each robot's monitor from a cell.

use std::fmt::Write as _;
use std::sync::Arc;

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    ConfigError, Configuration, ConfigurationParts, Monitor, Part, Presence, Region, RegionKind, RobotSlot, SlotId,
    SourceId, SourceLimits, SourceSpec, StoppingSettings, Volume, VolumeId, ZoneArbiter, group_overlapping,
};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;
use elbowroom_spatial::Pose;
use sha2::{Digest, Sha256};

use crate::{Cell, CellRegionId, CellRobot, Follow, Frames, seal};

/// Ticks without an answer after which a controller stops by itself.
const MISSED_ANSWERS: f64 = 2.0;

/// Configuration of one robot's monitor, with the mapping of its indices to the cell's indices.
#[derive(Debug, Clone)]
pub struct MonitorSetup {
    /// Configuration for [`Monitor::new`].
    pub configuration: Configuration,
    /// Region of the cell, per region of the configuration.
    pub regions: Vec<CellRegionId>,
    /// Followed source, per source of the configuration.
    pub sources: Vec<Follow>,
    /// The objects that the robot's program grips, and their volumes.
    pub gripped: Vec<(ObjectId, VolumeId)>,
}

impl MonitorSetup {
    /// Volumes of an exchanged tool, which are attached and detached with its link.
    pub fn tool_volumes(&self, link: LinkId) -> impl Iterator<Item = (VolumeId, &Volume)> {
        let volumes = self.configuration.volumes().iter().enumerate();
        let is_of_tool = move |v: &Volume| v.link == link && v.presence != Presence::Always && v.part != Part::Load;
        volumes.filter(move |(_, v)| is_of_tool(v)).map(|(i, v)| (VolumeId(i), v))
    }

    /// The volume of an object that this link grips, and the pose in the link at which a monitor attaches it.
    ///
    /// `object_in_link` is the pose of the object. `None` if the program does not grip the object with this link.
    pub fn gripped_volume(&self, object: ObjectId, link: LinkId, object_in_link: &Pose) -> Option<(VolumeId, Pose)> {
        let volumes = self.configuration.volumes();
        let of_link = |(o, v): &&(ObjectId, VolumeId)| *o == object && volumes[v.0].link == link;
        let (_, volume) = self.gripped.iter().find(of_link)?;
        Some((*volume, *object_in_link * volumes[volume.0].in_link))
    }
}

/// One setup per robot, in order.
///
/// # Errors
/// [`Diagnostic`] at the line of the region or robot that a monitor would refuse.
pub fn setups(cell: &Cell) -> Result<Vec<MonitorSetup>, Diagnostic> {
    let slots = slots(cell);
    let setup = |i: usize| setup(cell, RobotId(i), cell.robots[i].guarded_volumes(), &slots);
    (0..cell.robots.len()).map(setup).collect()
}

/// Like [`setups`], with objects permanently attached to robots, for planning.
///
/// # Errors
/// As for [`setups`].
pub fn setups_holding(cell: &Cell, held: &[(ObjectId, Attachment)]) -> Result<Vec<MonitorSetup>, Diagnostic> {
    let slots = slots(cell);
    let setup = |i: usize| setup(cell, RobotId(i), cell.volumes_holding(RobotId(i), held), &slots);
    (0..cell.robots.len()).map(setup).collect()
}

/// The monitors, connected by a zone arbiter if the cell has exchange regions.
///
/// # Errors
/// As for [`setups`].
pub fn monitors(cell: &Cell, setups: &[MonitorSetup]) -> Result<Vec<Monitor>, Diagnostic> {
    monitors_with(cell, setups, zone_arbiter(cell).as_ref())
}

/// The monitors, connected by the given [`zone_arbiter`].
///
/// # Errors
/// As for [`setups`].
pub fn monitors_with(
    cell: &Cell,
    setups: &[MonitorSetup],
    arbiter: Option<&Arc<ZoneArbiter>>,
) -> Result<Vec<Monitor>, Diagnostic> {
    let monitor = |(i, s): (usize, &MonitorSetup)| {
        Monitor::new(s.configuration.clone(), arbiter.map(|b| (b.clone(), RobotSlot(i)).into()))
            .map_err(|e| config_error(cell, &cell.robots[i], &e))
    };
    setups.iter().enumerate().map(monitor).collect()
}

/// The arbiter of the cell's exchange regions, with its robots in the order of the cell; `None` without exchange
/// regions.
///
/// Regions whose warning zones overlap, or that move, share a slot. The name of the slot lists the names of its
/// regions.
pub fn zone_arbiter(cell: &Cell) -> Option<Arc<ZoneArbiter>> {
    let slots = slots(cell);
    let count = slots.iter().flatten().map(|s| s.0 + 1).max()?;
    let robots: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
    let members = |slot: SlotId| slots.iter().zip(&cell.regions).filter(move |(s, _)| **s == Some(slot));
    let name = |slot: SlotId| members(slot).map(|(_, r)| r.region.name.as_str()).collect::<Vec<_>>().join(", ");
    let names: Vec<String> = (0..count).map(SlotId).map(name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    // Five ticks of silence, at least 0.1 s.
    let silence_timeout_s = (5.0 * cell.timing.tick_s).max(0.1);
    Some(Arc::new(ZoneArbiter::new(&robots, &names).silence_timeout(silence_timeout_s)))
}

/// SHA-256 (hex) over the checksums of all monitors' configurations.
pub(crate) fn checksum(cell: &Cell) -> Result<String, Diagnostic> {
    let mut hash = Sha256::new();
    for setup in setups(cell)? {
        hash.update(setup.configuration.checksum());
        hash.update("\n");
        // Of measured sources each node computes the place from messages, so all must agree about direction and rest.
        let is_measured = |follow: &&Follow| Frames::new(cell).measured_source(follow).is_some();
        for follow in setup.sources.iter().filter(is_measured) {
            hash.update(seal::source_checksum(cell, *follow, &SourceLimits::default()));
        }
    }
    Ok(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// Slot of each region of the cell; `None` if it is not an exchange region. Overlapping zones share a slot, which
/// avoids deadlocks.
pub fn slots(cell: &Cell) -> Vec<Option<SlotId>> {
    let exchange: Vec<usize> = (0..cell.regions.len())
        .filter(|i| matches!(cell.regions[*i].region.kind, RegionKind::Exchange { .. }))
        .collect();
    // Grouping depends on `follow`, which the cell stores beside the region.
    let regions: Vec<Region> = exchange
        .iter()
        .map(|i| {
            let r = &cell.regions[*i];
            Region { follow: r.follow.map(|_| SourceId(0)), ..r.region.clone() }
        })
        .collect();
    let groups = group_overlapping(&regions.iter().collect::<Vec<_>>());
    let mut slots = vec![None; cell.regions.len()];
    exchange.iter().zip(groups).for_each(|(i, g)| slots[*i] = Some(SlotId(g)));
    slots
}

fn setup(
    cell: &Cell,
    id: RobotId,
    mut volumes: Vec<Volume>,
    slots: &[Option<SlotId>],
) -> Result<MonitorSetup, Diagnostic> {
    let robot = &cell.robots[id.0];
    let mut gripped = Vec::new();
    for (object, link) in cell.grips(id) {
        gripped.push((object, VolumeId(volumes.len())));
        volumes.push(cell.gripped_volume(id, object, link));
    }
    let mut regions = Vec::new();
    let mut region_ids = Vec::new();
    let mut sources: Vec<(Follow, SourceLimits)> = Vec::new();
    for (i, r) in cell.regions.iter().enumerate().filter(|(_, r)| r.robots.contains(&id)) {
        let mut region = r.region.clone();
        if let Some(slot) = slots[i] {
            region.kind = RegionKind::Exchange { slot };
        }
        region.follow = r.follow.map(|follow| {
            let source = (follow, r.source_limits);
            let known = sources.iter().position(|s| *s == source);
            SourceId(known.unwrap_or_else(|| {
                sources.push(source);
                sources.len() - 1
            }))
        });
        regions.push(region);
        region_ids.push(CellRegionId(i));
    }
    let stopping_distance = cell.monitoring.stopping_reaction_s.map(|reaction_s| StoppingSettings {
        reaction_s,
        // A simulated controller stops by itself if an answer is missing for longer.
        period_s: MISSED_ANSWERS * cell.timing.tick_s,
        joint_deceleration: robot.limits.iter().map(|l| l.stop).collect(),
        joint_acceleration: crate::trajectory::accelerations(cell, id),
    });
    let parts = ConfigurationParts {
        robot: robot.name.clone(),
        base_in_world: robot.base_in_world,
        chain: robot.robot.chain.clone(),
        volumes,
        regions,
        sources: sources.iter().map(|(s, limits)| SourceSpec { name: source_name(cell, s), limits: *limits }).collect(),
        grids: cell.monitoring.grids.iter().filter(|g| g.robot == id).map(|g| g.grid.clone()).collect(),
        laws: elbowroom_monitor::Laws { stopping_distance, ..cell.monitoring.laws.clone() },
    };
    let configuration = Configuration::new(parts).map_err(|e| config_error(cell, robot, &e))?;
    Ok(MonitorSetup {
        configuration,
        regions: region_ids,
        sources: sources.into_iter().map(|s| s.0).collect(),
        gripped,
    })
}

fn source_name(cell: &Cell, follow: &Follow) -> String {
    match follow {
        Follow::Encoder(i) => format!("encoder {}", cell.frame_sources.encoders[*i].name),
        Follow::Object(i) => format!("object {}", cell.objects[i.0].name),
        Follow::Poses(i) => {
            let file = cell.frame_sources.pose_tracks[*i].file.file_name();
            format!("poses {}", file.map_or_else(String::new, |name| name.to_string_lossy().into_owned()))
        }
        Follow::Robot { robot, link, .. } => {
            let robot = &cell.robots[robot.0];
            format!("{}/{}", robot.name, robot.robot.chain.links()[link.0])
        }
    }
}

fn config_error(cell: &Cell, robot: &CellRobot, e: &ConfigError) -> Diagnostic {
    let line = match e {
        ConfigError::Region { region, .. } | ConfigError::DuplicateRegion(region) | ConfigError::NoArbiter(region) => {
            cell.regions.iter().find(|r| r.region.name == *region).map_or(robot.line, |r| r.line)
        }
        ConfigError::Grid { grid, .. } => {
            cell.monitoring.grids.iter().find(|g| g.grid.name == *grid).map_or(robot.line, |g| g.line)
        }
        _ => robot.line,
    };
    let error = Diagnostic::new(&cell.file, line, e);
    match e {
        ConfigError::Grid { .. } => error.hint("another `output`, so that each has its own"),
        _ => error,
    }
}
