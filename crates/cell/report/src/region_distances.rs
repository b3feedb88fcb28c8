//! Distance of every region over time, from the joint values of a recording.

use elbowroom_cell::CellRegionId;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::Volume;
use elbowroom_proximity::separation_within;
use elbowroom_robot::RobotId;
use elbowroom_sim::{Recording, RegionPoses, RegionTrack};
use elbowroom_spatial::Pose;

use crate::scene::{ReportRobot, ReportScene};

/// Distance of the guarded volumes of one robot to one region.
#[derive(Debug, Clone)]
pub struct DistanceCurve {
    /// The region.
    pub region: CellRegionId,
    /// Distance per requested tick, m; NaN while the region is inactive.
    pub metres: Vec<f64>,
}

/// The curves of one robot at these ticks: one per region that applies to it. Empty if the scene has no guarded
/// volumes.
pub fn curves(scene: &ReportScene, rec: &Recording, robot: RobotId, ticks: &[usize]) -> Vec<DistanceCurve> {
    let (Some(model), Some(track)) = (scene.robots.get(robot.0), rec.robots.get(robot.0)) else { return Vec::new() };
    let applies =
        |r: &RegionTrack| r.robots.contains(&robot) && model.volumes.iter().any(|v| v.part.counts_for(r.guards));
    let all = rec.regions.iter().enumerate().filter(|(_, r)| applies(r));
    let curve = |region: usize| DistanceCurve { region: CellRegionId(region), metres: Vec::with_capacity(ticks.len()) };
    let mut curves: Vec<DistanceCurve> = all.map(|(region, _)| curve(region)).collect();
    let mut state = ChainState::new(&model.chain);
    for &tick in ticks {
        let Some(sample) = track.samples.get(tick).filter(|s| s.q.len() == state.q.len()) else { continue };
        state.q.copy_from_slice(&sample.q);
        model.chain.forward(&mut state);
        let volumes = placed(model, &state);
        for curve in &mut curves {
            curve.metres.push(distance(&volumes, &rec.regions[curve.region.0], tick, sample.t_s));
        }
    }
    curves
}

fn placed<'m>(model: &'m ReportRobot, state: &ChainState) -> Vec<(&'m Volume, Pose)> {
    let in_world = |v: &Volume| model.base_in_world * state.link_in_root(v.link) * v.in_link;
    model.volumes.iter().map(|v| (v, in_world(v))).collect()
}

/// Distance at one tick, m; NaN while the region is inactive.
fn distance(volumes: &[(&Volume, Pose)], region: &RegionTrack, tick: usize, t_s: f64) -> f64 {
    let is_active = region.active.iter().rev().find(|(since, _)| *since <= t_s).is_some_and(|(_, on)| *on);
    let pose = match &region.poses {
        RegionPoses::Fixed(pose) => Some(pose),
        RegionPoses::Moving(poses) => poses.get(tick),
    };
    let (true, Some(pose)) = (is_active, pose) else { return f64::NAN };
    let region_box = region.shape.aabb(pose);
    let mut least = f64::INFINITY;
    for (volume, in_world) in volumes.iter().filter(|(v, _)| v.part.counts_for(region.guards)) {
        if region_box.distance(&volume.shape.aabb(in_world)) > least {
            continue;
        }
        let found = separation_within(&volume.shape, in_world, &region.shape, pose, least);
        least = found.map_or(least, |s| least.min(s.distance));
    }
    least
}
