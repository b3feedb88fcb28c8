//! Names of a model as C has them, made once: an answer only points to them.

use std::ffi::{CString, c_char};

use elbowroom::cell::QueryModel;
use elbowroom::kinematics::LinkId;
use elbowroom::robot::{GeometryId, ObjectId, RobotId};

use crate::failure::c_text;

/// Names of robots, links, joints and objects.
#[derive(Debug)]
pub(crate) struct Names {
    pub robots: Vec<RobotNames>,
    /// In the order of the model.
    pub objects: Vec<CString>,
}

/// Names of a robot and its parts.
#[derive(Debug)]
pub(crate) struct RobotNames {
    pub name: CString,
    /// Independent joints, in the order of joint values.
    pub joints: Vec<CString>,
    /// Links, in the order of the chain.
    pub links: Vec<CString>,
    /// The names of the links in answers, `robot/link`.
    pub in_answers: Vec<CString>,
}

impl Names {
    pub fn of(model: &QueryModel) -> Self {
        let robots = (0..model.robots.len()).map(|robot| RobotNames::of(model, RobotId(robot))).collect();
        Self { robots, objects: model.objects.iter().map(|object| c_text(&object.name)).collect() }
    }

    /// The name of a geometry in answers.
    pub fn geometry(&self, id: GeometryId) -> *const c_char {
        let name = match id {
            GeometryId::Link { robot, link } => self.robots.get(robot.0).and_then(|robot| robot.in_answers.get(link.0)),
            GeometryId::Object(ObjectId(object)) => self.objects.get(object),
        };
        name.map_or(std::ptr::null(), |name| name.as_ptr())
    }
}

impl RobotNames {
    fn of(model: &QueryModel, id: RobotId) -> Self {
        let robot = &model.robots[id.0];
        let chain = &robot.robot.chain;
        let link = |link: usize| c_text(&model.geometry_name(GeometryId::Link { robot: id, link: LinkId(link) }));
        Self {
            // The word by which pairs name a single robot.
            name: c_text(if model.is_single_robot { "robot" } else { &robot.name }),
            joints: chain.active_joints().iter().map(|joint| c_text(&chain.joints()[joint.0].name)).collect(),
            links: chain.links().iter().map(|link| c_text(link)).collect(),
            in_answers: (0..chain.links().len()).map(link).collect(),
        }
    }
}
