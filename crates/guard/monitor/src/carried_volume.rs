//! A guarded volume and the joints that move it: how far and how fast they can move its points.

use elbowroom_kinematics::motion_bound::{JointReach, joint_reaches, max_stroke_m};
use elbowroom_kinematics::{Chain, ChainState, JointCoupling, LinkId};
use elbowroom_spatial::{Pose, Vec3};

use crate::point_motion::LinkPoint;
use crate::{Configuration, StoppingSettings, Volume};

/// A joint axis in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorldAxis {
    child: LinkId,
    in_child: Vec3,
    direction: Vec3,
    origin: Vec3,
}

impl WorldAxis {
    /// The axes of all joints of a chain, by joint id.
    pub(crate) fn all(chain: &Chain) -> Vec<Self> {
        let axis = |child, in_child| Self { child, in_child, direction: Vec3::ZERO, origin: Vec3::ZERO };
        chain.joints().iter().map(|joint| axis(joint.child, joint.axis)).collect()
    }

    pub(crate) fn place(&mut self, config: &Configuration, state: &ChainState) {
        let child_in_world = config.base_in_world * state.link_in_root(self.child);
        (self.direction, self.origin) = (child_in_world.transform_vector(self.in_child), child_in_world.translation);
    }
}

/// Speed and acceleration with which a volume approaches along a direction, at override 1.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Approach {
    /// Speed of the program, m/s; negative if it leaves.
    pub(crate) program_speed: f64,
    /// Actual speed of the robot, m/s.
    pub(crate) real_speed: f64,
    /// Acceleration if all joints have their largest acceleration, m/s².
    pub(crate) acceleration: f64,
    /// Deceleration if all joints have their stated deceleration, m/s².
    pub(crate) deceleration: f64,
}

/// A guarded volume and the joints that move it.
#[derive(Debug)]
pub(crate) struct CarriedVolume {
    link: LinkId,
    /// Centre and radius of a bounding sphere, in the frame of the shape.
    center_in_shape: Vec3,
    radius: f64,
    /// The joints that move the volume, from the root outwards.
    influences: Vec<JointInfluence>,
    center: Vec3,
    /// Bound for every direction.
    any_direction: Approach,
}

/// How a joint moves a volume.
#[derive(Debug, Clone, Copy)]
struct JointInfluence {
    axis: usize,
    /// Index in q.
    joint: usize,
    /// Motion of the joint per unit of q.
    scale: f64,
    turns: bool,
    /// Largest distance of a point of the volume from the axis in any configuration, m; 1 for a prismatic joint.
    max_radius: f64,
}

impl CarriedVolume {
    pub(crate) fn new(chain: &Chain, volume: &Volume) -> Self {
        let bounds = volume.shape.aabb(&Pose::IDENTITY);
        let mut carried = Self {
            link: volume.link,
            center_in_shape: bounds.center(),
            radius: 0.5 * bounds.extent().length(),
            influences: Vec::new(),
            center: Vec3::ZERO,
            any_direction: Approach::default(),
        };
        carried.set_in_link(chain, &volume.in_link);
        carried
    }

    /// Sets the pose of the shape in the link. Allocates on the first call only.
    pub(crate) fn set_in_link(&mut self, chain: &Chain, in_link: &Pose) {
        let reach_m = self.radius + in_link.transform_point(self.center_in_shape).length();
        let reaches = joint_reaches(chain, self.link, reach_m, |id| max_stroke_m(chain, id));
        self.influences.clear();
        self.influences.extend(reaches.filter_map(|r| JointInfluence::new(&r)));
        self.influences.reverse();
    }

    /// Updates the bounds for the pose `in_world` of the volume and the motion of the chain.
    pub(crate) fn update(
        &mut self,
        config: &Configuration,
        axes: &[WorldAxis],
        stopping: &StoppingSettings,
        in_world: &Pose,
        motion: &VolumeMotion<'_>,
    ) {
        self.center = in_world.transform_point(self.center_in_shape);
        let (mut acceleration, mut deceleration) = (0.0, 0.0);
        for influence in &self.influences {
            let lever = influence.max_lever(axes, self.center, self.radius);
            acceleration += lever * stopping.joint_acceleration[influence.joint];
            deceleration += lever * stopping.joint_deceleration[influence.joint];
        }
        let max_speed = |state| LinkPoint::new(config, state, self.link, self.center).max_speed_within(self.radius);
        self.any_direction = Approach {
            program_speed: max_speed(motion.intent),
            real_speed: max_speed(motion.now) + acceleration * motion.uncertain_s,
            acceleration,
            deceleration,
        };
    }

    /// The approach in any direction.
    pub(crate) fn any_direction(&self) -> Approach {
        self.any_direction
    }

    /// Acceleration and deceleration (m/s²) along the unit vector `towards` (world).
    pub(crate) fn rates_along(&self, axes: &[WorldAxis], stopping: &StoppingSettings, towards: Vec3) -> (f64, f64) {
        let (mut acceleration, mut deceleration) = (0.0, 0.0);
        for influence in &self.influences {
            let lever = influence.lever_along(axes, self.center, self.radius, towards);
            acceleration += lever * stopping.joint_acceleration[influence.joint];
            deceleration += lever * stopping.joint_deceleration[influence.joint];
        }
        (acceleration, deceleration)
    }

    /// Largest distance (m) between a point and its linear extrapolation if each joint moves by at most `joint_travel`:
    /// half of the second derivative of its position. `|∂²p/∂qᵢ∂qⱼ|` is at most the lever of the outer joint if the
    /// inner joint is revolute, and 0 if it is prismatic.
    #[inline]
    pub(crate) fn curvature_offset(&self, joint_travel: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut turned) = (0.0, 0.0);
        for influence in &self.influences {
            let moved = joint_travel(influence.joint) * influence.scale;
            sum += influence.max_radius * moved * turned;
            if influence.turns {
                sum += 0.5 * influence.max_radius * moved * moved;
                turned += moved;
            }
        }
        sum
    }
}

/// Motion of the chain in one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VolumeMotion<'a> {
    /// The chain at the velocities of the program at override 1.
    pub(crate) intent: &'a ChainState,
    /// The chain at the actual velocities.
    pub(crate) now: &'a ChainState,
    /// Time over which the actual velocities were derived from positions, s; 0 if they were given.
    pub(crate) uncertain_s: f64,
}

impl JointInfluence {
    /// `None` for a fixed joint.
    fn new(reach: &JointReach) -> Option<Self> {
        let JointReach { joint, kind, coupling, .. } = *reach;
        let JointCoupling { index, multiplier, .. } = coupling?;
        let (scale, turns) = (multiplier.abs(), kind.turns());
        Some(Self { axis: joint.0, joint: index, scale, turns, max_radius: reach.lever_arm() })
    }

    /// Largest travel of a point of the sphere along the unit vector `towards` per unit of the joint, m.
    #[inline]
    fn lever_along(&self, axes: &[WorldAxis], center: Vec3, radius: f64, towards: Vec3) -> f64 {
        let axis = &axes[self.axis];
        if !self.turns {
            return self.scale * axis.direction.dot(towards).abs();
        }
        let across = towards.cross(axis.direction);
        self.scale * (across.dot(center - axis.origin).abs() + radius * across.length())
    }

    /// Largest travel of a point of the sphere per unit of the joint, m.
    #[inline]
    fn max_lever(&self, axes: &[WorldAxis], center: Vec3, radius: f64) -> f64 {
        if !self.turns {
            return self.scale;
        }
        let axis = &axes[self.axis];
        self.scale * (axis.direction.cross(center - axis.origin).length() + radius)
    }
}
