//! Robots and random numbers for the monitor's tests.
#![allow(dead_code, reason = "each test file uses a part of it")]

use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_monitor::{Configuration, ConfigurationParts, Laws, Part, Presence, Region, Volume};
use elbowroom_proximity::{Capsule, Shape};
use elbowroom_spatial::{Pose, Vec3};
pub use elbowroom_testkit::random::XorshiftStar;

pub fn joint(name: &str, kind: JointKind, parent: usize, origin: Vec3, axis: Vec3, range: f64) -> Joint {
    let limits = Limits { velocity: Some(5.0), ..Limits::symmetric(range) };
    Joint {
        name: name.into(),
        kind,
        parent: LinkId(parent),
        child: LinkId(parent + 1),
        origin: Pose::from_translation(origin),
        axis,
        limits,
        mimic: None,
    }
}

/// Three prismatic joints and a spherical wrist: every pose of the last link is reachable.
pub fn gantry() -> Chain {
    let kinds = [JointKind::Prismatic; 3].into_iter().chain([JointKind::Revolute; 3]);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::X];
    let joints = kinds.zip(axes).enumerate();
    let joints = joints.map(|(i, (kind, axis))| joint(&format!("j{i}"), kind, i, Vec3::ZERO, axis, 100.0)).collect();
    Chain::new("gantry", (0..7).map(|i| format!("l{i}")).collect(), joints).unwrap()
}

/// A six-axis arm of about 1.6 m reach.
pub fn arm() -> Chain {
    use JointKind::Revolute;
    let joints = vec![
        joint("j1", Revolute, 0, Vec3::Z * 0.4, Vec3::Z, 3.1),
        joint("j2", Revolute, 1, Vec3::new(0.15, 0.0, 0.2), Vec3::Y, 2.0),
        joint("j3", Revolute, 2, Vec3::Z * 0.7, Vec3::Y, 2.5),
        joint("j4", Revolute, 3, Vec3::new(0.25, 0.0, 0.15), Vec3::X, 3.1),
        joint("j5", Revolute, 4, Vec3::X * 0.4, Vec3::Y, 2.1),
        joint("j6", Revolute, 5, Vec3::X * 0.1, Vec3::X, 6.2),
    ];
    Chain::new("arm", (0..7).map(|i| format!("l{i}")).collect(), joints).unwrap()
}

/// Capsules for the links of [`arm`], a tool box and the TCP.
pub fn arm_volumes() -> Vec<Volume> {
    let capsule = |name: &str, link: usize, from: Vec3, to: Vec3, radius: f64| {
        let axis = (to - from).try_normalize().unwrap();
        let in_link = Pose::new(elbowroom_spatial::Rotation::from_z(axis), (from + to) * 0.5);
        let shape = Shape::Capsule(Capsule { half_length: from.distance(to) * 0.5, radius });
        let (part, presence) = (Part::Arm, Presence::Always);
        Volume { name: name.into(), part, link: LinkId(link), shape, in_link, presence }
    };
    let tool = elbowroom_spatial::Obb {
        pose: Pose::from_translation(Vec3::X * 0.15),
        half_extents: Vec3::new(0.12, 0.04, 0.04),
    };
    vec![
        capsule("l1", 1, Vec3::ZERO, Vec3::new(0.15, 0.0, 0.2), 0.16),
        capsule("l2", 2, Vec3::ZERO, Vec3::Z * 0.7, 0.12),
        capsule("l3", 3, Vec3::ZERO, Vec3::new(0.25, 0.0, 0.15), 0.11),
        capsule("l4", 4, Vec3::ZERO, Vec3::X * 0.35, 0.08),
        capsule("l5", 5, -Vec3::X * 0.03, Vec3::X * 0.05, 0.06),
        capsule("l6", 6, Vec3::ZERO, Vec3::X * 0.02, 0.05),
        Volume::tool_box(LinkId(6), tool),
        Volume::tcp(LinkId(6), Vec3::X * 0.27),
    ]
}

pub fn configuration(chain: Chain, volumes: Vec<Volume>, regions: Vec<Region>) -> Configuration {
    Configuration::new(parts(chain, volumes, regions)).expect("a valid configuration")
}

pub fn parts(chain: Chain, volumes: Vec<Volume>, regions: Vec<Region>) -> ConfigurationParts {
    ConfigurationParts {
        robot: "r".into(),
        base_in_world: Pose::IDENTITY,
        chain,
        volumes,
        regions,
        sources: vec![],
        grids: vec![],
        laws: Laws::default(),
    }
}

/// Random vectors.
pub trait RandomGeometry {
    /// A vector with each coordinate within `range` of 0.
    fn vec3(&mut self, range: f64) -> Vec3;

    /// A direction, uniform on the unit sphere.
    fn direction(&mut self) -> Vec3;
}

impl RandomGeometry for XorshiftStar {
    fn vec3(&mut self, range: f64) -> Vec3 {
        Vec3::from(self.within(range))
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vec3(1.0);
            if v.length_squared() <= 1.0
                && let Some(unit) = v.try_normalize()
            {
                return unit;
            }
        }
    }
}
