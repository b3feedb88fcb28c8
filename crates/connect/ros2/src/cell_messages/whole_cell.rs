//! The whole cell as one URDF, for viewers.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_cell::Cell;
use elbowroom_formats::{robot, stl};
use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

use super::frames;

/// A cell as a URDF: the links of all robots, and the objects, fixed to the link `world`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellUrdf {
    text: String,
    meshes: Vec<UrdfMesh>,
}

/// A mesh that the URDF names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UrdfMesh {
    /// Path of its file, relative to the URDF.
    pub file: String,
    /// Its bytes: binary STL.
    pub stl: Vec<u8>,
}

impl CellUrdf {
    /// Makes the URDF of a cell. The text is empty if names of robots and links clash, so that no tree can be made.
    pub fn of_cell(cell: &Cell) -> Self {
        let Some(robot) = whole_cell(cell) else { return Self { text: String::new(), meshes: Vec::new() } };
        let export = robot::to_urdf(&robot, &cell.name);
        let mesh = |(file, mesh)| {
            let mut stl = Vec::new();
            // Writing to memory cannot fail.
            let _ = stl::write_binary(&mut stl, &[mesh]);
            UrdfMesh { file, stl }
        };
        Self { text: export.urdf, meshes: export.meshes.into_iter().map(mesh).collect() }
    }

    /// The URDF, with its meshes as files relative to it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The meshes.
    pub fn meshes(&self) -> &[UrdfMesh] {
        &self.meshes
    }

    /// The URDF with its meshes inside, as `data:` addresses.
    pub fn inline(&self) -> String {
        let mut text =
            String::with_capacity(self.text.len() + self.meshes.iter().map(|m| 4 * m.stl.len() / 3).sum::<usize>());
        let mut rest = &self.text[..];
        // One pass over the text, as the addresses are long.
        while let Some((before, after)) = rest.split_once("filename=\"") {
            let (file, behind) = after.split_once('"').unwrap_or((after, ""));
            text += before;
            text += "filename=\"";
            match self.meshes.iter().find(|m| m.file == file) {
                Some(mesh) => {
                    text += "data:model/stl;base64,";
                    STANDARD.encode_string(&mesh.stl, &mut text);
                }
                None => text += file,
            }
            text += "\"";
            rest = behind;
        }
        text + rest
    }
}

/// Combines all robots and objects as links of one robot.
fn whole_cell(cell: &Cell) -> Option<Robot> {
    let mut links = vec![frames::WORLD.to_owned()];
    let mut joints: Vec<Joint> = Vec::new();
    let (mut colliders, mut visuals): (Vec<Vec<Collider>>, _) = (vec![Vec::new()], vec![Vec::new()]);
    for robot in &cell.robots {
        let chain = &robot.robot.chain;
        let (first_link, first_joint) = (links.len(), joints.len() + 1);
        links.extend(chain.links().iter().map(|link| frames::link(&robot.name, link)));
        colliders.extend(robot.robot.colliders.iter().cloned());
        visuals.extend(robot.robot.visuals.iter().cloned());
        let root = LinkId(first_link + chain.root().0);
        joints.push(fixed(frames::joint(&robot.name, "base"), root, robot.base_in_world));
        joints.extend(chain.joints().iter().map(|joint| Joint {
            name: frames::joint(&robot.name, &joint.name),
            parent: LinkId(joint.parent.0 + first_link),
            child: LinkId(joint.child.0 + first_link),
            mimic: joint.mimic.map(|m| elbowroom_kinematics::Mimic { joint: JointId(m.joint.0 + first_joint), ..m }),
            ..joint.clone()
        }));
    }
    for object in &cell.objects {
        let link = LinkId(links.len());
        links.push(frames::object(&object.name));
        joints.push(fixed(frames::object(&object.name), link, object.in_world));
        let solid = Collider { name: object.name.clone(), shape: object.shape.clone(), in_link: Pose::IDENTITY };
        colliders.push(vec![solid]);
        visuals.push(Vec::new());
    }
    let mut whole = Robot::new(Chain::new(&cell.name, links, joints).ok()?);
    (whole.colliders, whole.visuals) = (colliders, visuals);
    Some(whole)
}

fn fixed(name: String, child: LinkId, origin: Pose) -> Joint {
    let (kind, parent, axis) = (JointKind::Fixed, LinkId(0), Vec3::Z);
    Joint { name, kind, parent, child, origin, axis, limits: Limits::UNLIMITED, mimic: None }
}
