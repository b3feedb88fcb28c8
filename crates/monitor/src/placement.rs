//! Where every volume and every region stands at one instant.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::{Aabb, Motion, Pose, Rotation, Vec3};

use crate::{Configuration, Region, Snapshot, Source};

/// Poses and boxes in the world, updated in place each tick.
#[derive(Debug)]
pub(crate) struct Placement {
    pub(crate) chain: ChainState,
    pub(crate) volume_in_world: Vec<Pose>,
    pub(crate) volume_box: Vec<Aabb>,
    pub(crate) region_in_world: Vec<Pose>,
    pub(crate) region_box: Vec<Aabb>,
    /// Regions that follow a source, each with its source.
    pub(crate) riders: Vec<(usize, usize)>,
}

impl Placement {
    pub(crate) fn new(config: &Configuration) -> Self {
        let region_in_world: Vec<Pose> = config.regions.iter().map(|r| r.anchor * r.shape_in_anchor).collect();
        let boxed = |(r, pose): (&Region, &Pose)| r.shape.aabb(pose);
        Self {
            chain: ChainState::new(&config.chain),
            volume_in_world: vec![Pose::IDENTITY; config.volumes.len()],
            volume_box: vec![Aabb::EMPTY; config.volumes.len()],
            region_box: config.regions.iter().zip(&region_in_world).map(boxed).collect(),
            region_in_world,
            riders: config.regions.iter().enumerate().filter_map(|(r, g)| Some((r, g.follow?.0))).collect(),
        }
    }

    /// Places everything as the snapshot says, at these joint velocities (empty for at rest).
    pub(crate) fn place(&mut self, config: &Configuration, s: &Snapshot, velocity: &[f64]) {
        fill(&mut self.chain.q, s.q);
        fill(&mut self.chain.qd, if s.qd.is_empty() { velocity } else { s.qd });
        fill(&mut self.chain.qdd, s.qdd);
        config.chain.forward_motion(&mut self.chain);
        self.place_volumes(config);
        self.place_regions(config, |source| s.sources[source].pose);
    }

    /// Places everything as it will be after `ahead_s` seconds at the joint velocities `intent`.
    pub(crate) fn place_ahead(&mut self, config: &Configuration, s: &Snapshot, intent: &[f64], ahead_s: f64) {
        for ((q, now), velocity) in self.chain.q.iter_mut().zip(s.q).zip(intent) {
            *q = now + velocity * ahead_s;
        }
        config.chain.forward(&mut self.chain);
        self.place_volumes(config);
        self.place_regions(config, |source| advanced(&s.sources[source], ahead_s));
    }

    /// Places the regions where the sources are, at once.
    pub(crate) fn place_sources(&mut self, config: &Configuration, sources: &[Source]) {
        self.place_regions(config, |source| sources[source].pose);
    }

    /// Places the volumes as they are at these joint values.
    pub(crate) fn place_robot(&mut self, config: &Configuration, q: &[f64]) {
        self.chain.q.copy_from_slice(q);
        config.chain.forward(&mut self.chain);
        self.place_volumes(config);
    }

    fn place_volumes(&mut self, config: &Configuration) {
        for (i, volume) in config.volumes.iter().enumerate() {
            let pose = config.base_in_world * self.chain.link_in_root(volume.link) * volume.in_link;
            self.volume_in_world[i] = pose;
            self.volume_box[i] = volume.shape.aabb(&pose);
        }
    }

    fn place_regions(&mut self, config: &Configuration, source_in_world: impl Fn(usize) -> Pose) {
        for (r, source) in &self.riders {
            let region = &config.regions[*r];
            let pose = source_in_world(*source) * region.anchor * region.shape_in_anchor;
            self.region_in_world[*r] = pose;
            self.region_box[*r] = region.shape.aabb(&pose);
        }
    }

    /// Motion, seen from the world, of the point of volume `volume` that is now at `point`.
    pub(crate) fn point_motion(&self, config: &Configuration, volume: usize, point: Vec3) -> (Vec3, Vec3) {
        let link = config.volumes[volume].link;
        let base = &config.base_in_world;
        let motion = self.chain.link_motion(link);
        let origin = base.transform_point(self.chain.link_in_root(link).translation);
        let offset = base.inverse_transform_vector(point - origin);
        let to_world = |v: Vec3| base.transform_vector(v);
        (to_world(motion.velocity_at(offset)), to_world(motion.acceleration_at(offset)))
    }
}

/// Motion, seen from the world, of the point of a region that is now at `point`.
pub(crate) fn region_point_motion(region: &Region, sources: &[Source], point: Vec3) -> (Vec3, Vec3) {
    let Some(source) = region.follow.and_then(|s| sources.get(s.0)) else { return (Vec3::ZERO, Vec3::ZERO) };
    let offset = point - source.pose.translation;
    (source.motion.velocity_at(offset), source.motion.acceleration_at(offset))
}

fn advanced(source: &Source, ahead_s: f64) -> Pose {
    let Motion { velocity, angular_velocity, .. } = source.motion;
    let turn = Rotation::from_rotation_vector(angular_velocity * ahead_s);
    Pose::new(turn * source.pose.rotation, source.pose.translation + velocity * ahead_s)
}

/// Copies `from`; an empty slice stands for zeros.
fn fill(to: &mut [f64], from: &[f64]) {
    if from.is_empty() { to.fill(0.0) } else { to.copy_from_slice(from) }
}
