//! The frame of a controller's zones.

use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::Cell;

/// The frame in which zones are written. It has to be the world frame of the robot's controller.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneFrame {
    /// A link that no joint moves; `None` for the world of the cell.
    pub link: Option<String>,
    /// Its pose in the world of the cell.
    pub in_world: Pose,
}

impl ZoneFrame {
    /// The frame of this name, for a robot of the cell: `world`, or a link that no joint moves. Without a name, the root
    /// link, with which a controller's world coincides unless it is told otherwise.
    ///
    /// # Errors
    /// [`Diagnostic`] if no such link exists, or if a joint moves it.
    pub fn new(cell: &Cell, robot: RobotId, name: Option<&str>) -> Result<Self, Diagnostic> {
        let robot = &cell.robots[robot.0];
        let chain = &robot.robot.chain;
        let links = || chain.links().iter().map(String::as_str);
        if name == Some("world") {
            return Ok(Self { link: None, in_world: Pose::IDENTITY });
        }
        let link = name.map_or(Some(chain.root()), |name| chain.link(name)).ok_or_else(|| {
            let name = name.unwrap_or_default();
            let what = format!("robot \"{}\" has no link \"{name}\" whose frame the zones could have", robot.name);
            Diagnostic::new(&cell.file, robot.line, what).hint(suggest::hint(name, links().chain(["world"])))
        })?;
        if chain.is_movable(link) {
            let fixed = (0..chain.links().len()).map(LinkId).filter(|l| !chain.is_movable(*l));
            let fixed: Vec<&str> = fixed.map(|l| chain.links()[l.0].as_str()).chain(["world"]).collect();
            let what = format!("joints move the link \"{}\", and zones have a fixed frame", chain.links()[link.0]);
            return Err(Diagnostic::new(&cell.file, robot.line, what).hint(fixed.join(", or ")));
        }
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(&robot.start);
        chain.forward(&mut state);
        let in_world = robot.base_in_world * state.link_in_root(link);
        Ok(Self { link: Some(chain.links()[link.0].clone()), in_world })
    }

    /// The frame in words.
    pub fn title(&self) -> String {
        match &self.link {
            None => "the world of the cell file".into(),
            Some(link) => format!("the frame of the link \"{link}\""),
        }
    }
}
