//! Poses and bounding boxes of all volumes and regions at one instant.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::{Aabb, FrameMotion, Pose, Rotation};

use crate::attached_volumes::AttachedVolumes;
use crate::{Configuration, Region, RegionId, Snapshot, SourceId, SourceState, VolumeId};

/// A region that follows a source of motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DynamicRegion {
    pub(crate) region: RegionId,
    pub(crate) source: SourceId,
}

/// Poses and boxes in the world, updated in place each tick.
#[derive(Debug)]
pub(crate) struct Placement {
    pub(crate) chain: ChainState,
    pub(crate) attached: AttachedVolumes,
    /// Poses of the volumes. A detached volume keeps its last pose, and its box is empty.
    pub(crate) volume_in_world: Vec<Pose>,
    pub(crate) volume_box: Vec<Aabb>,
    pub(crate) region_in_world: Vec<Pose>,
    pub(crate) region_box: Vec<Aabb>,
    pub(crate) dynamic_regions: Vec<DynamicRegion>,
    /// The volumes of tool centre points.
    tcps: Vec<VolumeId>,
}

impl Placement {
    pub(crate) fn new(config: &Configuration) -> Self {
        let region_in_world: Vec<Pose> = config.regions.iter().map(|r| r.anchor * r.shape_in_anchor).collect();
        let aabb = |(r, pose): (&Region, &Pose)| r.shape.aabb(pose);
        let tcps = config.volumes.iter().enumerate().filter(|(_, volume)| volume.part.is_tcp());
        let dynamic = |(i, r): (usize, &Region)| Some(DynamicRegion { region: RegionId(i), source: r.follow? });
        Self {
            chain: ChainState::new(&config.chain),
            attached: AttachedVolumes::new(config),
            volume_in_world: vec![Pose::IDENTITY; config.volumes.len()],
            volume_box: vec![Aabb::EMPTY; config.volumes.len()],
            region_box: config.regions.iter().zip(&region_in_world).map(aabb).collect(),
            region_in_world,
            dynamic_regions: config.regions.iter().enumerate().filter_map(dynamic).collect(),
            tcps: tcps.map(|(i, _)| VolumeId(i)).collect(),
        }
    }

    /// The tool centre point of the tool that is mounted: exchanged tools are attached and detached. `None` without a tool.
    pub(crate) fn tcp(&self) -> Option<VolumeId> {
        self.tcps.iter().copied().find(|tcp| self.attached.contains(tcp.0))
    }

    /// Places everything as in the snapshot. If it has no joint velocities, `velocity` (empty at rest) replaces them.
    pub(crate) fn place(&mut self, config: &Configuration, s: &Snapshot, velocity: &[f64]) {
        copy_or_zero(&mut self.chain.q, s.q);
        copy_or_zero(&mut self.chain.qd, if s.qd.is_empty() { velocity } else { s.qd });
        copy_or_zero(&mut self.chain.qdd, s.qdd);
        config.chain.forward_motion(&mut self.chain);
        self.place_volumes(config);
        self.place_regions(config, |source| s.sources[source.0].pose);
    }

    /// Places everything as predicted after `ahead_s` seconds at the joint velocities `intent`.
    pub(crate) fn place_ahead(&mut self, config: &Configuration, s: &Snapshot, intent: &[f64], ahead_s: f64) {
        for ((q, now), velocity) in self.chain.q.iter_mut().zip(s.q).zip(intent) {
            *q = now + velocity * ahead_s;
        }
        config.chain.forward(&mut self.chain);
        self.place_volumes(config);
        self.place_regions(config, |source| extrapolated(&s.sources[source.0], ahead_s));
    }

    /// Places the dynamic regions at the poses of their sources.
    pub(crate) fn place_sources(&mut self, config: &Configuration, sources: &[SourceState]) {
        self.place_regions(config, |source| sources[source.0].pose);
    }

    /// Places the volumes at these joint values.
    pub(crate) fn place_robot(&mut self, config: &Configuration, q: &[f64]) {
        self.chain.q.copy_from_slice(q);
        self.place_at_chain_state(config);
    }

    /// Places the volumes at the joint values of `chain`.
    pub(crate) fn place_at_chain_state(&mut self, config: &Configuration) {
        config.chain.forward(&mut self.chain);
        self.place_volumes(config);
    }

    fn place_volumes(&mut self, config: &Configuration) {
        for (i, volume) in config.volumes.iter().enumerate() {
            let Some(in_link) = self.attached.in_link(i) else {
                self.volume_box[i] = Aabb::EMPTY;
                continue;
            };
            let pose = config.base_in_world * self.chain.link_in_root(volume.link) * *in_link;
            self.volume_in_world[i] = pose;
            self.volume_box[i] = volume.shape.aabb(&pose);
        }
    }

    fn place_regions(&mut self, config: &Configuration, source_in_world: impl Fn(SourceId) -> Pose) {
        for DynamicRegion { region: RegionId(r), source } in &self.dynamic_regions {
            let region = &config.regions[*r];
            let pose = source_in_world(*source) * region.anchor * region.shape_in_anchor;
            self.region_in_world[*r] = pose;
            self.region_box[*r] = region.shape.aabb(&pose);
        }
    }
}

fn extrapolated(source: &SourceState, ahead_s: f64) -> Pose {
    let FrameMotion { velocity, angular_velocity, .. } = source.motion;
    let turn = Rotation::from_rotation_vector(angular_velocity * ahead_s);
    Pose::new(turn * source.pose.rotation, source.pose.translation + velocity * ahead_s)
}

/// Copies `from`; an empty slice means zeros.
fn copy_or_zero(to: &mut [f64], from: &[f64]) {
    if from.is_empty() { to.fill(0.0) } else { to.copy_from_slice(from) }
}
