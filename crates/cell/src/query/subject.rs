//! What is asked about: a cell, or one robot alone.

use std::path::{Path, PathBuf};

use elbowroom_formats::{FormatError, Warning};
use elbowroom_scene::{Member, Object, Robot, Scene};
use elbowroom_spatial::Pose;

use crate::{Cell, resting};

/// Robots and objects with the states that they are in unless told otherwise.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The file it came from, for messages.
    pub file: PathBuf,
    /// In the order of the file.
    pub robots: Vec<SubjectRobot>,
    /// Solid things.
    pub objects: Vec<Object>,
    /// True for one robot alone: its links are called by their bare names, and its states must have all its joints.
    pub alone: bool,
}

/// A robot of a subject.
#[derive(Debug, Clone)]
pub struct SubjectRobot {
    /// Its name; empty where it is alone.
    pub name: String,
    /// Links, joints, solids, with tool and load.
    pub robot: Robot,
    /// Where its root link stands.
    pub base_in_world: Pose,
    /// Joint values without states, rad or m.
    pub start: Vec<f64>,
}

impl Subject {
    /// All that stands in a cell; tools and loads are solids of the links that carry them.
    pub fn of_cell(cell: &Cell) -> Self {
        let robot = |r: &crate::CellRobot| SubjectRobot {
            name: r.name.clone(),
            robot: r.robot.clone(),
            base_in_world: r.base_in_world,
            start: r.start.clone(),
        };
        Self {
            file: cell.file.clone(),
            robots: cell.robots.iter().map(robot).collect(),
            objects: cell.objects.clone(),
            alone: false,
        }
    }

    /// One robot whose root link is the world. Without states it is at zero, or at the limit nearest to zero.
    pub fn of_robot(file: &Path, robot: Robot) -> Self {
        let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
        let start = lower.iter().zip(&upper).map(|(lower, upper)| 0.0_f64.min(*upper).max(*lower)).collect();
        let only = SubjectRobot { name: String::new(), robot, base_in_world: Pose::IDENTITY, start };
        Self { file: file.to_owned(), robots: vec![only], objects: Vec::new(), alone: true }
    }

    /// The scene. `thorough` looks for pairs that no joint values bring together, which takes a moment and makes the
    /// answers faster, never different.
    ///
    /// # Errors
    /// [`FormatError`] for what the scene refuses.
    pub fn scene(&self, thorough: bool) -> Result<Scene, FormatError> {
        let mut builder = Scene::builder();
        builder.reach(thorough);
        for r in &self.robots {
            builder.robot(&r.name, r.robot.clone(), r.base_in_world);
        }
        for o in &self.objects {
            builder.object(o.clone());
        }
        builder.build().map_err(|e| FormatError::new(&self.file, None, e.to_string()))
    }

    /// Links of its robots that touch in the state without [`States`](super::States) and have no solid between them: what to
    /// write in an SRDF where the robot is built so. Reading a cell warns of these by itself.
    ///
    /// ```
    /// # use elbowroom_cell::query::Subject;
    /// # use elbowroom_formats::robot::{LoadOptions, load};
    /// # let dir = tempfile::tempdir()?;
    /// # let path = dir.path().join("grip.urdf");
    /// # let finger = |name: &str| format!("<link name=\"{name}\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>\
    /// #   <joint name=\"to_{name}\" type=\"prismatic\"><parent link=\"palm\"/><child link=\"{name}\"/><limit lower=\"0\" upper=\"1\" \
    /// #   velocity=\"1\" effort=\"1\"/></joint>");
    /// # std::fs::write(&path, format!("<robot name=\"g\"><link name=\"palm\"/>{}{}</robot>", finger("left"), finger("right")))?;
    /// let robot = load(&path, &LoadOptions::default())?.robot;
    /// let warnings = Subject::of_robot(&path, robot).touching_at_rest();
    /// assert!(warnings[0].what.contains("`left` and `right` touch"));
    /// assert!(warnings[0].write_instead.as_ref().unwrap().contains("<disable_collisions link1=\"left\" link2=\"right\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn touching_at_rest(&self) -> Vec<Warning> {
        let of_robot = |r: &SubjectRobot| {
            let name = (!self.alone).then_some(r.name.as_str());
            let warnings = resting::warnings(&r.robot, &r.start, name);
            warnings.map(|(what, hint)| Warning::new(&self.file, None, what).hint(hint)).collect::<Vec<_>>()
        };
        self.robots.iter().flat_map(of_robot).collect()
    }

    /// `robot/link` or the object's name; the link's name alone where the robot is.
    pub fn member_name(&self, member: Member) -> String {
        match member {
            Member::Object(o) => self.objects.get(o).map_or_else(String::new, |o| o.name.clone()),
            Member::Link { robot, link } => self.robots.get(robot).map_or_else(String::new, |r| {
                let link = r.robot.chain.links().get(link.0).map_or("", String::as_str);
                if self.alone { link.to_owned() } else { format!("{}/{link}", r.name) }
            }),
        }
    }

    /// Number of joint values of one state, over all robots.
    pub fn values(&self) -> usize {
        self.robots.iter().map(|r| r.start.len()).sum()
    }
}
