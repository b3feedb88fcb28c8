//! A zone as a controller would watch it.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// Largest reach at which planes become boxes, m.
const FARTHEST_M: f64 = 1000.0;

/// Which side of its solid a zone covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// The solid.
    Inside,
    /// Everything but the solid.
    Outside,
}

/// The solid of a zone in the frame of the zones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ZoneSolid {
    /// About the centre `in_frame`.
    Cuboid {
        in_frame: Pose,
        half_extents: Vec3,
    },
    Sphere {
        center: Vec3,
        radius_m: f64,
    },
    /// About the centre `in_frame`, along its z axis.
    Cylinder {
        in_frame: Pose,
        radius_m: f64,
        half_length_m: f64,
    },
}

/// A ball that contains every place of a tool centre point, in the frame of the zones.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReachBall {
    pub center: Vec3,
    pub radius_m: f64,
}

/// What a robot that enters a zone causes, and where.
#[derive(Debug, Clone)]
pub(super) struct Zone {
    pub solid: ZoneSolid,
    pub side: Side,
    /// Whether the robot is stopped.
    pub stops: bool,
    /// The digital output of the cell that is on.
    pub output: Option<u8>,
    /// Which part of its region it is, such as `warning zone` or `wall 3`; empty for the whole of it.
    pub part: String,
    /// For a wall of a fence: the direction to the inside, in the frame of the zones.
    pub inwards: Option<Vec3>,
}

impl ZoneSolid {
    /// The zone of a shape; half-spaces become boxes that cover them within the ball.
    ///
    /// # Errors
    /// Why no controller has such a zone.
    pub fn new(shape: &Shape, in_frame: Pose, reach: ReachBall) -> Result<Self, String> {
        match shape {
            Shape::Cuboid(c) => Ok(Self::Cuboid { in_frame, half_extents: c.half_extents }),
            Shape::Sphere(s) => Ok(Self::Sphere { center: in_frame.translation, radius_m: s.radius }),
            Shape::Cylinder(c) => Ok(Self::Cylinder { in_frame, radius_m: c.radius, half_length_m: c.half_length }),
            Shape::HalfSpace(_) if !(reach.radius_m <= FARTHEST_M) => {
                Err("a plane becomes a box as large as the robot's reach, and that is more than 1 km".to_owned())
            }
            Shape::HalfSpace(_) => Ok(Self::below_plane(in_frame, reach)),
            Shape::Capsule(_) | Shape::Hull(_) | Shape::Mesh(_) => {
                Err(format!("controllers have no zone of the shape {}", shape.kind().name()))
            }
        }
    }

    /// All of the ball that is below the xy plane of `plane_in_frame`: more of the half-space is out of reach.
    fn below_plane(plane_in_frame: Pose, reach: ReachBall) -> Self {
        let plane = Pose::new(along_axes(plane_in_frame.rotation), plane_in_frame.translation);
        let center = plane.inverse_transform_point(reach.center);
        let depth_m = reach.radius_m + center.z.abs();
        let middle = Vec3::new(center.x, center.y, -0.5 * depth_m);
        Self::Cuboid {
            in_frame: Pose::new(plane.rotation, plane.transform_point(middle)),
            half_extents: Vec3::new(reach.radius_m, reach.radius_m, 0.5 * depth_m),
        }
    }

    /// The solid grown by a thickness (m) on all sides, with sharp edges; shrunk if it is negative. `None` if nothing is
    /// left.
    pub fn grown(self, by_m: f64) -> Option<Self> {
        match self {
            Self::Cuboid { in_frame, half_extents } => {
                let half_extents = half_extents + Vec3::splat(by_m);
                (half_extents.min_element() > 0.0).then_some(Self::Cuboid { in_frame, half_extents })
            }
            Self::Sphere { center, radius_m } => {
                (radius_m + by_m > 0.0).then_some(Self::Sphere { center, radius_m: radius_m + by_m })
            }
            Self::Cylinder { in_frame, radius_m, half_length_m } => {
                let (radius_m, half_length_m) = (radius_m + by_m, half_length_m + by_m);
                let is_solid = radius_m > 0.0 && half_length_m > 0.0;
                is_solid.then_some(Self::Cylinder { in_frame, radius_m, half_length_m })
            }
        }
    }

    /// `box`, `sphere` or `cylinder`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cuboid { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
        }
    }
}

/// The rotation turned about its z axis so that x is as parallel as possible to an axis of the frame: a plane is the same
/// in any direction, and not all controllers have boxes that are turned.
fn along_axes(rotation: Rotation) -> Rotation {
    let z = rotation.z_axis();
    let most_across = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().min_by(|a, b| a.dot(z).abs().total_cmp(&b.dot(z).abs()));
    let x = most_across.and_then(|axis| (axis - z * axis.dot(z)).try_normalize());
    x.and_then(|x| Rotation::from_columns(x, z.cross(x), z)).unwrap_or(rotation)
}
