//! A minimal URDF reader for the tests of this crate; the complete one is in the `formats` crate, which depends on this one.
#![allow(dead_code, missing_docs, clippy::missing_panics_doc, clippy::print_stdout)]

pub mod awkward;
pub mod measure;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::folder;
pub use elbowroom_testkit::random::SplitMix;

/// Every robot of `urdf` and `cell`, by name.
pub fn robots() -> Vec<(String, PathBuf)> {
    let name = |file: &PathBuf| file.file_stem().unwrap().to_string_lossy().into_owned();
    folder::robots(&["urdf", "cell"]).into_iter().map(|file| (name(&file), file)).collect()
}

pub fn robot(name: &str) -> Option<Chain> {
    robots().into_iter().find(|(n, _)| n == name).map(|(_, path)| load(&path))
}

fn numbers<const N: usize>(text: Option<&str>, default: [f64; N]) -> [f64; N] {
    let Some(text) = text else { return default };
    let values: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
    values.try_into().unwrap()
}

pub fn load(path: &Path) -> Chain {
    let text = std::fs::read_to_string(path).unwrap();
    let xml = roxmltree::Document::parse(&text).unwrap();
    let root = xml.root_element();
    let child = |n: roxmltree::Node<'_, '_>, tag: &str| n.children().find(|c| c.has_tag_name(tag)).map(|c| c.id());
    let of = |tag: &'static str| root.children().filter(move |n| n.has_tag_name(tag));
    let links: Vec<String> = of("link").map(|n| n.attribute("name").unwrap().to_owned()).collect();
    let link_at: HashMap<&str, usize> = links.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
    let joint_at: HashMap<&str, usize> =
        of("joint").enumerate().map(|(i, n)| (n.attribute("name").unwrap(), i)).collect();
    let mut joints = Vec::new();
    for node in of("joint") {
        let attribute = |tag: &str, name: &str| {
            child(node, tag).and_then(|id| xml.get_node(id)).and_then(|n| n.attribute(name)).map(str::to_owned)
        };
        let number = |tag: &str, name: &str| attribute(tag, name).map(|v| v.trim().parse::<f64>().unwrap());
        let kind = match node.attribute("type").unwrap() {
            "revolute" => JointKind::Revolute,
            "continuous" => JointKind::Continuous,
            "prismatic" => JointKind::Prismatic,
            _ => JointKind::Fixed,
        };
        joints.push(Joint {
            name: node.attribute("name").unwrap().to_owned(),
            kind,
            parent: LinkId(link_at[attribute("parent", "link").unwrap().as_str()]),
            child: LinkId(link_at[attribute("child", "link").unwrap().as_str()]),
            origin: Pose::from_xyz_rpy(
                numbers(attribute("origin", "xyz").as_deref(), [0.0; 3]),
                numbers(attribute("origin", "rpy").as_deref(), [0.0; 3]),
            ),
            axis: Vec3::from(numbers(attribute("axis", "xyz").as_deref(), [1.0, 0.0, 0.0])),
            limits: Limits::range(number("limit", "lower").unwrap_or(0.0), number("limit", "upper").unwrap_or(0.0)),
            mimic: attribute("mimic", "joint").map(|source| Mimic {
                joint: JointId(joint_at[source.as_str()]),
                multiplier: number("mimic", "multiplier").unwrap_or(1.0),
                offset: number("mimic", "offset").unwrap_or(0.0),
            }),
        });
    }
    Chain::new(root.attribute("name").unwrap_or("robot"), links, joints).unwrap()
}

/// A serial chain of joints (kind, origin, axis, limits).
pub fn serial(joints: &[(JointKind, Pose, Vec3, Limits)]) -> Chain {
    let joints: Vec<Joint> = joints
        .iter()
        .enumerate()
        .map(|(i, &(kind, origin, axis, limits))| Joint {
            name: format!("j{i}"),
            kind,
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin,
            axis,
            limits,
            mimic: None,
        })
        .collect();
    let links = (0..=joints.len()).map(|i| format!("l{i}")).collect();
    Chain::new("serial", links, joints).unwrap()
}

/// Random geometry and states.
pub trait RandomGeometry {
    /// A vector with each coordinate within 1 of 0.
    fn vector(&mut self) -> Vec3;

    fn pose(&mut self) -> Pose;

    /// A configuration within the limits; unlimited joints within eight turns or metres.
    fn state(&mut self, chain: &Chain, q: &mut [f64]);
}

impl RandomGeometry for SplitMix {
    fn vector(&mut self) -> Vec3 {
        Vec3::from(self.within(1.0))
    }

    fn pose(&mut self) -> Pose {
        let turn = self.vector() * 3.0;
        Pose::new(elbowroom_spatial::Rotation::from_rotation_vector(turn), self.vector())
    }

    fn state(&mut self, chain: &Chain, q: &mut [f64]) {
        for (value, id) in q.iter_mut().zip(chain.active_joints()) {
            let joint = &chain.joints()[id.0];
            let unlimited = if joint.kind.turns() { std::f64::consts::PI } else { 1.0 };
            *value = self.between(joint.limits.lower.max(-unlimited * 8.0), joint.limits.upper.min(unlimited * 8.0));
        }
    }
}

/// Ortho-parallel basis and spherical wrist with every frame rotated at random: no part of the geometry is along an
/// axis.
pub fn disguised_wrist_arm(random: &mut SplitMix, limit: f64) -> Chain {
    let lateral = random.between(-0.2, 0.2) * random.below(2) as f64;
    let points = [
        Vec3::new(0.0, 0.0, random.between(0.0, 0.5)),
        Vec3::new(random.between(-0.4, 0.4) * random.below(3).min(1) as f64, lateral, random.between(0.0, 0.5)),
        Vec3::new(0.0, 0.0, random.between(0.4, 1.0)),
        Vec3::new(random.between(-0.2, 0.2), 0.0, random.between(-0.1, 0.1)),
        Vec3::new(0.0, 0.0, random.between(0.4, 1.0)),
        Vec3::new(0.0, 0.0, random.between(0.0, 0.1)),
    ];
    let axes = [Vec3::Z, Vec3::Y, Vec3::Y, Vec3::Z, Vec3::Y, Vec3::Z];
    // In the file: model frame k = file frame k · hidden(k)
    let hidden: Vec<Rotation> = (0..7).map(|_| random.pose().rotation).collect();
    let mut joints = Vec::new();
    let mut before = random.pose().rotation; // the base itself is rotated
    for k in 0..6 {
        let bend = Rotation::from_axis_angle(axes[k], random.between(-2.0, 2.0)); // zero positions anywhere
        let origin = Pose::new(before * bend * hidden[k].inverse(), before * points[k]);
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        joints.push((JointKind::Revolute, origin, hidden[k] * (axes[k] * sign), Limits::symmetric(limit)));
        before = hidden[k];
    }
    joints.push((JointKind::Fixed, random.pose(), Vec3::Z, Limits::UNLIMITED));
    serial(&joints)
}
