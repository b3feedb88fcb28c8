//! Conversion of chains to frames, and back.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::frame::{FrameAxis, FrameChain, JointMotion, LocalFrame};
use crate::forward_step::principal;
use crate::{Chain, ChainError, Joint, JointKind, Limits, LinkId};

impl FrameChain {
    /// Extracts the frames from the root link to the link `tip`: a static frame at the origin for the root, and one
    /// frame for every joint, named after the link that it carries. If the last frame had to be rotated, a static frame
    /// `NAME_end` rotates back.
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        let name = |link: LinkId| chain.links()[link.0].clone();
        let mut frames = vec![LocalFrame::fixed(name(chain.root()), Vec3::ZERO)];
        let mut back = Rotation::IDENTITY;
        for id in chain.path(tip) {
            let joint = &chain.joints()[id.0];
            let (rotation, motion) = motion_of(joint);
            let origin = Pose::new(back, Vec3::ZERO) * joint.origin * Pose::new(rotation, Vec3::ZERO);
            frames.push(LocalFrame { motion, ..placed(name(joint.child), &origin) });
            back = rotation.inverse();
        }
        if back != Rotation::IDENTITY {
            frames.push(placed(format!("{}_end", name(tip)), &Pose::new(back, Vec3::ZERO)));
        }
        Self { frames }
    }

    /// Builds the serial chain of the frames.
    ///
    /// Its links are the frames; if the first frame is not static at the origin, a link `global` precedes it. Joints
    /// have the names of the motions; joints of static frames are called `NAME_fixed`. Mimic joints become independent
    /// joints.
    ///
    /// # Errors
    /// [`ChainError::BadAxis`] if a frame is rotated about a vector without direction; otherwise as [`Chain::new`].
    pub fn to_chain(&self, name: impl Into<String>) -> Result<Chain, ChainError> {
        let mut links = Vec::new();
        let mut joints = Vec::new();
        for frame in &self.frames {
            let is_root = frame.motion.is_none() && frame.fixed_pose() == Pose::IDENTITY;
            if links.is_empty() && is_root {
                links.push(frame.name.clone());
                continue;
            }
            if links.is_empty() {
                links.push("global".to_owned());
            }
            links.push(frame.name.clone());
            joints.push(joint_of(frame, links.len() - 1)?);
        }
        Chain::new(name, links, joints)
    }
}

/// The rotation that takes the joint's axis onto an axis of the frame, and the motion about or along that axis.
fn motion_of(joint: &Joint) -> (Rotation, Option<JointMotion>) {
    if joint.kind == JointKind::Fixed {
        return (Rotation::IDENTITY, None);
    }
    let (rotation, along, reversed) = match principal(joint.axis) {
        Some((0, sign)) => (Rotation::IDENTITY, FrameAxis::X, sign < 0.0),
        Some((1, sign)) => (Rotation::IDENTITY, FrameAxis::Y, sign < 0.0),
        Some((_, sign)) => (Rotation::IDENTITY, FrameAxis::Z, sign < 0.0),
        None => (Rotation::from_z(joint.axis), FrameAxis::Z, false),
    };
    let motion = JointMotion { joint: joint.name.clone(), kind: joint.kind, along, reversed, limits: joint.limits };
    (rotation, Some(motion))
}

fn placed(name: String, pose: &Pose) -> LocalFrame {
    let rotation_vector = pose.rotation.to_rotation_vector();
    let angle = rotation_vector.length();
    let axis = rotation_vector.try_normalize().unwrap_or(Vec3::Z);
    LocalFrame { axis, angle, ..LocalFrame::fixed(name, pose.translation) }
}

fn joint_of(frame: &LocalFrame, link: usize) -> Result<Joint, ChainError> {
    let name = frame.motion.as_ref().map_or_else(|| format!("{}_fixed", frame.name), |m| m.joint.clone());
    if frame.angle != 0.0 && frame.axis.try_normalize().is_none() {
        let [x, y, z] = frame.axis.to_array();
        return Err(ChainError::BadAxis { joint: name, x, y, z });
    }
    let (kind, axis, limits) = frame.motion.as_ref().map_or((JointKind::Fixed, Vec3::Z, Limits::UNLIMITED), |m| {
        let axis = m.along.unit();
        (m.kind, if m.reversed { -axis } else { axis }, m.limits)
    });
    let (parent, child) = (LinkId(link - 1), LinkId(link));
    Ok(Joint { name, kind, parent, child, origin: frame.fixed_pose(), axis, limits, mimic: None })
}
