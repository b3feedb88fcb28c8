//! Guarded volumes of the robot.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{Cuboid, Shape, Sphere, VolumeModel};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Obb, Pose, Vec3};

use crate::Guards;

/// The part of the robot that a volume belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The tool centre point, enclosed by a solid that moves with it.
    Tcp,
    /// The tool centre point, not enclosed by a solid that moves with it: regions that guard against the tool or the arm
    /// include it.
    TcpOutside,
    /// The tool.
    Tool,
    /// The load, or an object that the tool has gripped.
    Load,
    /// A link.
    Arm,
}

impl Part {
    /// True for the tool centre point.
    pub(crate) fn is_tcp(self) -> bool {
        matches!(self, Self::Tcp | Self::TcpOutside)
    }

    /// True if a region with these guards includes this part. `arm` includes the links, the tool and the load; every
    /// guard includes a tool centre point outside all solids.
    pub fn counts_for(self, guards: Guards) -> bool {
        match self {
            Self::Tcp => guards.tcp,
            Self::TcpOutside => guards.tcp || guards.tool || guards.arm,
            Self::Tool | Self::Load => guards.tool || guards.arm,
            Self::Arm => guards.arm,
        }
    }
}

/// Whether a volume is a part of the robot all the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Presence {
    /// The volume is always a part of the robot.
    #[default]
    Always,
    /// The volume is attached and detached while the robot runs ([`Monitor::attach`](crate::Monitor::attach)); attached
    /// at first.
    Attached,
    /// The volume is attached and detached while the robot runs; detached at first, such as an object that the robot
    /// will grip.
    Detached,
}

/// A guarded volume: a solid that moves with a link and that the monitor keeps out of regions.
#[derive(Debug, Clone)]
pub struct Volume {
    /// Name of the link, the tool or the object, for reports.
    pub name: String,
    /// The part of the robot.
    pub part: Part,
    /// The link that the volume moves with.
    pub link: LinkId,
    /// The solid.
    pub shape: Shape,
    /// Pose of the shape in the frame of the link. For a volume that is detached at first, the pose until it is attached
    /// elsewhere.
    pub in_link: Pose,
    /// Whether the volume is always there.
    pub presence: Presence,
}

impl Volume {
    /// The tool centre point at `tcp_in_link` (m).
    pub fn tcp(link: LinkId, tcp_in_link: Vec3) -> Self {
        let shape = Shape::Sphere(Sphere { radius: 0.0 });
        let in_link = Pose::from_translation(tcp_in_link);
        Self { name: "tcp".into(), part: Part::Tcp, link, shape, in_link, presence: Presence::Always }
    }

    /// The tool's oriented box `B = (bc, bu, bv, bw, hu, hv, hw)` in the frame of its link (Romanelli 2011, eq. 5).
    pub fn tool_box(link: LinkId, obb_in_link: Obb) -> Self {
        let shape = Shape::Cuboid(Cuboid { half_extents: obb_in_link.half_extents });
        let presence = Presence::Always;
        Self { name: "tool".into(), part: Part::Tool, link, shape, in_link: obb_in_link.pose, presence }
    }

    /// An object that the robot will grip with this link; detached at first.
    pub fn gripped(name: impl Into<String>, link: LinkId, shape: Shape) -> Self {
        let (part, presence) = (Part::Load, Presence::Detached);
        Self { name: name.into(), part, link, shape, in_link: Pose::IDENTITY, presence }
    }

    /// Radius (m) of a sphere around the link's origin that encloses the volume, for motion bounds of the link.
    pub fn radius_in_link(&self) -> f64 {
        self.radius_at(&self.in_link)
    }

    /// Like [`Volume::radius_in_link`], with the shape at another pose in the link.
    pub(crate) fn radius_at(&self, in_link: &Pose) -> f64 {
        self.shape.aabb(in_link).max_distance(Vec3::ZERO)
    }

    /// True for an object that is gripped only while the robot runs.
    pub(crate) fn is_gripped_object(&self) -> bool {
        self.part == Part::Load && self.presence == Presence::Detached
    }
}

/// The volumes of all links that joints move. Solids fixed to the root link do not move and get no volume.
pub fn arm_volumes(robot: &Robot, model: VolumeModel) -> Vec<Volume> {
    let chain = &robot.chain;
    let links = robot.colliders.iter().enumerate().filter(|(link, _)| chain.is_movable(LinkId(*link)));
    let colliders: Vec<_> = links.flat_map(|(link, colliders)| colliders.iter().map(move |c| (link, c))).collect();
    let solids: Vec<_> = colliders.iter().map(|(_, collider)| (&collider.shape, collider.in_link)).collect();
    let volume = |((link, _), (shape, in_link)): ((usize, &Collider), (Shape, Pose))| {
        let (name, presence) = (chain.links()[link].clone(), Presence::Always);
        Volume { name, part: Part::Arm, link: LinkId(link), shape, in_link, presence }
    };
    colliders.into_iter().zip(model.of_all(&solids)).map(volume).collect()
}
