//! Checksum of a configuration.

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};
use sha2::{Digest, Sha256};

use crate::{Configuration, GridSpace, Laws, Life, OutputGrid, Part, Presence, Region, RegionKind, SourceSpec, Volume};

impl Configuration {
    /// SHA-256 (hex) over all bits that determine an override or an output: chain, volumes, regions, sources,
    /// laws and grids. Equal configurations
    /// have equal checksums on every machine; a change of any number changes it.
    pub fn checksum(&self) -> String {
        let mut hasher = Hasher(Sha256::new());
        hasher.robot(self, &self.volumes.iter().collect::<Vec<_>>());
        hasher.list(&self.regions, Hasher::region);
        hasher.list(&self.sources, Hasher::source);
        hasher.laws(&self.laws);
        hasher.grids(&self.grids);
        hasher.hex()
    }

    /// SHA-256 (hex) over chain, volumes, laws and grids. Regions, sources and the objects that programs grip are left out:
    /// they are not parts of the robot.
    pub fn robot_checksum(&self) -> String {
        let mut hasher = Hasher(Sha256::new());
        let own: Vec<&Volume> = self.volumes.iter().filter(|v| !v.is_gripped_object()).collect();
        hasher.robot(self, &own);
        hasher.laws(&self.laws);
        hasher.grids(&self.grids);
        hasher.hex()
    }
}

impl Region {
    /// SHA-256 (hex) over all bits of the region.
    pub fn checksum(&self) -> String {
        let mut hasher = Hasher(Sha256::new());
        hasher.region(self);
        hasher.hex()
    }
}

/// Hashes values in order, each with its length or a tag, so that different configurations hash different bytes.
struct Hasher(Sha256);

impl Hasher {
    fn hex(self) -> String {
        let digits = self.0.finalize().into_iter().flat_map(|byte| [byte >> 4, byte & 15]);
        digits.filter_map(|digit| char::from_digit(u32::from(digit), 16)).collect()
    }

    fn tag(&mut self, tag: u8) {
        self.0.update([tag]);
    }

    fn count(&mut self, n: usize) {
        self.0.update((n as u64).to_le_bytes());
    }

    fn number(&mut self, v: f64) {
        // -0 and 0 are equal.
        self.0.update((v + 0.0).to_bits().to_le_bytes());
    }

    fn flag(&mut self, v: bool) {
        self.tag(u8::from(v));
    }

    fn optional(&mut self, v: Option<f64>) {
        self.flag(v.is_some());
        self.number(v.unwrap_or(0.0));
    }

    fn text(&mut self, s: &str) {
        self.count(s.len());
        self.0.update(s.as_bytes());
    }

    fn list<T>(&mut self, items: &[T], mut each: impl FnMut(&mut Self, &T)) {
        self.count(items.len());
        for item in items {
            each(self, item);
        }
    }

    fn vec3(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|c| self.number(c));
    }

    fn pose(&mut self, pose: &Pose) {
        pose.to_rows().into_iter().flatten().for_each(|c| self.number(c));
    }

    fn mesh(&mut self, vertices: &[Vec3], triangles: &[[u32; 3]]) {
        self.list(vertices, |s, v| s.vec3(*v));
        self.list(triangles, |s, t| t.iter().for_each(|i| s.count(*i as usize)));
    }

    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Sphere(s) => {
                self.tag(1);
                self.number(s.radius);
            }
            Shape::Capsule(s) => {
                self.tag(2);
                self.number(s.half_length);
                self.number(s.radius);
            }
            Shape::Cylinder(s) => {
                self.tag(3);
                self.number(s.half_length);
                self.number(s.radius);
            }
            Shape::Cuboid(s) => {
                self.tag(4);
                self.vec3(s.half_extents);
            }
            Shape::HalfSpace(_) => self.tag(5),
            Shape::Hull(h) => {
                self.tag(6);
                self.mesh(h.vertices(), h.triangles());
            }
            Shape::Mesh(m) => {
                self.tag(7);
                self.mesh(m.vertices(), m.triangles());
            }
        }
    }

    fn robot(&mut self, config: &Configuration, volumes: &[&Volume]) {
        self.text(&config.robot);
        self.pose(&config.base_in_world);
        self.chain(&config.chain);
        self.list(volumes, |s, volume| s.volume(volume));
    }

    fn chain(&mut self, chain: &Chain) {
        self.list(chain.links(), |s, name| s.text(name));
        self.list(chain.joints(), |s, joint| {
            s.text(&joint.name);
            s.tag(match joint.kind {
                JointKind::Fixed => 0,
                JointKind::Revolute => 1,
                JointKind::Continuous => 2,
                JointKind::Prismatic => 3,
            });
            s.count(joint.parent.0);
            s.count(joint.child.0);
            s.pose(&joint.origin);
            s.vec3(joint.axis);
            s.number(joint.limits.lower);
            s.number(joint.limits.upper);
            s.optional(joint.limits.velocity);
            // Chains without tolerances hash as before there were any, so that their seals stay valid.
            if let Some(tolerance) = joint.limits.overshoot_tolerance {
                s.tag(2);
                s.number(tolerance);
            }
            s.flag(joint.mimic.is_some());
            if let Some(mimic) = &joint.mimic {
                s.count(mimic.joint.0);
                s.number(mimic.multiplier);
                s.number(mimic.offset);
            }
        });
    }

    fn volume(&mut self, volume: &Volume) {
        self.text(&volume.name);
        let presence = match volume.presence {
            Presence::Always => 0,
            Presence::Attached => 16,
            Presence::Detached => 32,
        };
        let part = match volume.part {
            Part::Tcp => 0,
            // Tool and load have the same effect.
            Part::Tool | Part::Load => 1,
            Part::Arm => 2,
            Part::TcpOutside => 3,
        };
        self.tag(part + presence);
        self.count(volume.link.0);
        self.pose(&volume.in_link);
        self.shape(&volume.shape);
    }

    fn region(&mut self, region: &Region) {
        self.text(&region.name);
        self.shape(&region.shape);
        self.pose(&region.anchor);
        self.pose(&region.shape_in_anchor);
        match region.kind {
            RegionKind::Forbidden => self.tag(0),
            RegionKind::Monitored { slow_to } => {
                self.tag(1);
                self.optional(slow_to);
            }
            RegionKind::Exchange { slot } => {
                self.tag(2);
                self.count(slot.0);
            }
        }
        self.flag(region.life == Life::Permanent);
        self.number(region.warning_m);
        self.flag(region.guards.tcp);
        self.flag(region.guards.tool);
        self.flag(region.guards.arm);
        self.count(region.follow.map_or(usize::MAX, |s| s.0));
        self.number(region.hysteresis_m);
        self.tag(region.output.unwrap_or(u8::MAX));
        self.tag(region.warning_output.unwrap_or(u8::MAX));
    }

    fn source(&mut self, source: &SourceSpec) {
        self.text(&source.name);
        self.number(source.limits.speed_m_s);
        self.number(source.limits.turn_rad_s);
        self.flag(source.limits.wrap_m.is_some());
        self.vec3(source.limits.wrap_m.unwrap_or_default());
    }

    /// Configurations without grids hash as before there were any, so that their seals stay valid.
    fn grids(&mut self, grids: &[OutputGrid]) {
        if grids.is_empty() {
            return;
        }
        self.list(grids, |s, grid| {
            s.text(&grid.name);
            match &grid.space {
                GridSpace::Tcp { frame_in_world } => {
                    s.tag(0);
                    s.pose(frame_in_world);
                }
                GridSpace::Joints(joints) => {
                    s.tag(1);
                    s.list(joints, |s, joint| s.count(*joint));
                }
            }
            s.list(&grid.axes, |s, axis| {
                s.number(axis.from);
                s.number(axis.to);
                s.count(axis.count as usize);
            });
            s.tag(grid.output);
            s.number(grid.hysteresis);
        });
    }

    fn laws(&mut self, laws: &Laws) {
        self.flag(laws.direction_aware);
        self.number(laws.recovery);
        self.number(laws.override_rate);
        self.number(laws.stale_s);
        self.flag(laws.stopping_distance.is_some());
        if let Some(stopping) = &laws.stopping_distance {
            self.number(stopping.reaction_s);
            self.number(stopping.period_s);
            self.list(&stopping.joint_deceleration, |s, a| s.number(*a));
            self.list(&stopping.joint_acceleration, |s, a| s.number(*a));
        }
    }
}

#[cfg(test)]
mod tests;
