//! The model that queries are evaluated on: a cell, or a single robot.

use std::path::{Path, PathBuf};

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, JointContact, ObjectId, Robot, RobotId, joint_contacts};
use elbowroom_scene::{Attachment, Object, PairRules, Scene, SceneState, Selection};
use elbowroom_spatial::Pose;

use crate::joint_contacts::reason;
use crate::{Cell, Follow, Frames, rest_pose_contacts};

/// Robots and objects with their default states.
#[derive(Debug, Clone)]
pub struct QueryModel {
    /// The file, for messages.
    pub file: PathBuf,
    /// Robots, in file order.
    pub robots: Vec<QueryRobot>,
    /// Objects.
    pub objects: Vec<Object>,
    /// Objects that a link carries: regions that follow a robot.
    pub carried: Vec<(ObjectId, Attachment)>,
    /// Rules of the files of pairs.
    pub rules: PairRules,
    /// True for a single robot: its links are named without prefix, and its states must have all joints.
    pub is_single_robot: bool,
}

/// A robot of the model.
#[derive(Debug, Clone)]
pub struct QueryRobot {
    /// Its name; empty for a single robot.
    pub name: String,
    /// Links, joints, colliders, with tool and load.
    pub robot: Robot,
    /// Pose of the root link.
    pub base_in_world: Pose,
    /// Default joint values, rad or m.
    pub start: Vec<f64>,
    /// Whether a monitor guards it; false for a mechanism.
    pub is_guarded: bool,
}

impl QueryRobot {
    fn of(robot: &crate::CellRobot) -> Self {
        Self {
            name: robot.name.clone(),
            robot: robot.robot.clone(),
            base_in_world: robot.base_in_world,
            start: robot.start.clone(),
            is_guarded: !robot.is_mechanism(),
        }
    }
}

/// Whether a scene is built with proofs that pairs are out of reach at all joint values.
///
/// The proofs take a moment and make queries faster, with the same results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutOfReachProofs {
    /// Computes them: for many queries.
    Compute,
    /// Builds the scene without them: for few queries.
    Omit,
}

impl QueryModel {
    /// The model of a cell, with its rules of pairs ([`CellPairRules::all`](crate::CellPairRules::all)).
    ///
    /// Tools and loads are colliders of the links that carry them.
    pub fn of_cell(cell: &Cell) -> Self {
        let mut model = Self::without_rules(cell);
        model.add_rules(cell.pair_rules.all());
        model
    }

    /// The model of a cell without its rules of pairs.
    pub fn without_rules(cell: &Cell) -> Self {
        Self {
            file: cell.file.clone(),
            robots: cell.robots.iter().map(QueryRobot::of).collect(),
            objects: cell.objects.clone(),
            carried: Vec::new(),
            rules: PairRules::default(),
            is_single_robot: false,
        }
    }

    /// A single robot whose root link is the world frame. Its default state is zero, or the limits nearest to zero.
    pub fn of_robot(file: &Path, robot: Robot) -> Self {
        let only = (String::new(), robot, Pose::IDENTITY);
        Self { is_single_robot: true, ..Self::of_robots(file, [only]) }
    }

    /// Robots without a cell: each has a name and the pose of its root link in the world. Default states are those of
    /// [`of_robot`](Self::of_robot).
    pub fn of_robots(file: &Path, robots: impl IntoIterator<Item = (String, Robot, Pose)>) -> Self {
        let placed = |(name, robot, base_in_world): (String, Robot, Pose)| {
            let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
            let start = lower.iter().zip(&upper).map(|(lower, upper)| 0.0_f64.min(*upper).max(*lower)).collect();
            QueryRobot { name, robot, base_in_world, start, is_guarded: true }
        };
        Self {
            file: file.to_owned(),
            robots: robots.into_iter().map(placed).collect(),
            objects: Vec::new(),
            carried: Vec::new(),
            rules: PairRules::default(),
            is_single_robot: false,
        }
    }

    /// A single robot of a cell, at its pose. States may contain its name.
    pub fn of_robot_in_cell(cell: &Cell, robot: &crate::CellRobot) -> Self {
        Self {
            file: cell.file.clone(),
            robots: vec![QueryRobot::of(robot)],
            objects: Vec::new(),
            carried: Vec::new(),
            rules: PairRules::default(),
            is_single_robot: true,
        }
    }

    /// Adds the rules of a file of pairs, which override earlier rules.
    pub fn add_rules(&mut self, rules: PairRules) {
        for (i, r) in self.robots.iter_mut().enumerate() {
            rules.edit_robot(RobotId(i), &mut r.robot);
        }
        self.rules.extend(rules);
    }

    /// Adds a region of the cell as an object, at its pose at the start. Returns false if the cell has no such region.
    ///
    /// A region that follows a robot is carried by the robot.
    pub fn add_region(&mut self, cell: &Cell, name: &str) -> bool {
        let Some(region) = cell.regions.iter().find(|r| r.region.name == name) else { return false };
        let state = |r: &crate::CellRobot| {
            let mut state = ChainState::new(&r.robot.chain);
            state.q.copy_from_slice(&r.start);
            r.robot.chain.forward_motion(&mut state);
            state
        };
        let states: Vec<_> = cell.robots.iter().map(state).collect();
        let in_source = region.region.anchor * region.region.shape_in_anchor;
        let source = region.follow.map(|follow| Frames::new(cell).source(&follow, &states, 0.0).pose);
        let id = ObjectId(self.objects.len());
        let in_world = source.map_or(in_source, |source| source * in_source);
        self.objects.push(Object { name: name.to_owned(), shape: region.region.shape.clone(), in_world });
        if let Some(Follow::Robot { robot, link, in_link }) = region.follow {
            let touch_links = (0..cell.robots[robot.0].robot.chain.links().len()).map(LinkId).collect();
            self.carried.push((
                id,
                Attachment { robot, link, in_link: in_link * in_source, touch_links, visiting_links: Vec::new() },
            ));
        }
        true
    }

    /// The initial state of queries, with carried objects attached to their links.
    ///
    /// # Errors
    /// [`Diagnostic`] if the scene belongs to another model.
    pub fn start_state(&self, scene: &Scene) -> Result<SceneState, Diagnostic> {
        let mut state = SceneState::new(scene);
        for (object, attachment) in &self.carried {
            state.attach_at(scene, *object, attachment.clone()).map_err(|e| Diagnostic::new(&self.file, None, e))?;
        }
        Ok(state)
    }

    /// Builds the scene.
    ///
    /// # Errors
    /// [`Diagnostic`] if the scene refuses the model.
    pub fn scene(&self, proofs: OutOfReachProofs) -> Result<Scene, Diagnostic> {
        let mut builder = Scene::builder();
        builder.prove_out_of_reach(proofs == OutOfReachProofs::Compute);
        for r in &self.robots {
            builder.robot(&r.name, r.robot.clone(), r.base_in_world);
        }
        for o in &self.objects {
            builder.object(o.clone());
        }
        builder.rules(self.rules.clone());
        builder.build().map_err(|e| Diagnostic::new(&self.file, None, e))
    }

    /// Warnings for links that always touch where they are joined, and for links that touch in the default state.
    ///
    /// Links that touch in the default state count only if no collider is in between. The warnings contain the SRDF
    /// entry for robots that are built so. Reading a cell gives the same warnings.
    ///
    /// ```
    /// # use elbowroom_cell::QueryModel;
    /// # use elbowroom_formats::robot::{LoadOptions, load};
    /// # let dir = tempfile::tempdir()?;
    /// # let path = dir.path().join("grip.urdf");
    /// # let finger = |name: &str| format!("<link name=\"{name}\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>\
    /// #   <joint name=\"to_{name}\" type=\"prismatic\"><parent link=\"palm\"/><child link=\"{name}\"/><limit lower=\"0\" upper=\"1\" \
    /// #   velocity=\"1\" effort=\"1\"/></joint>");
    /// # std::fs::write(&path, format!("<robot name=\"g\"><link name=\"palm\"/>{}{}</robot>", finger("left"), finger("right")))?;
    /// let robot = load(&path, &LoadOptions::default())?.robot;
    /// let warnings = QueryModel::of_robot(&path, robot).touching_at_rest();
    /// assert!(warnings[0].message.contains("`left` and `right` touch"));
    /// assert!(warnings[0].hint.as_ref().unwrap().contains("<disable_collisions link1=\"left\" link2=\"right\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn touching_at_rest(&self) -> Vec<Diagnostic> {
        let of_robot = |r: &QueryRobot| {
            let name = (!self.is_single_robot).then_some(r.name.as_str());
            let at_joints = joint_contacts(&r.robot, &r.start);
            let is_new = |a, b| !at_joints.iter().any(|found| (found.a, found.b) == (a, b));
            let warnings = rest_pose_contacts::warnings(&r.robot, &r.start, name, is_new);
            let at_joints = at_joints.iter().map(|found| joint_contact_warning(&r.robot, found));
            at_joints
                .chain(warnings)
                .map(|(what, hint)| Diagnostic::new(&self.file, None, what).hint(hint))
                .collect::<Vec<_>>()
        };
        self.robots.iter().flat_map(of_robot).collect()
    }

    /// `robot/link` or the object's name; the link's name only for a single robot.
    pub fn geometry_name(&self, id: GeometryId) -> String {
        match id {
            GeometryId::Object(o) => self.objects.get(o.0).map_or_else(String::new, |o| o.name.clone()),
            GeometryId::Link { robot, link } => self.robots.get(robot.0).map_or_else(String::new, |r| {
                let link = r.robot.chain.links().get(link.0).map_or("", String::as_str);
                if self.is_single_robot { link.to_owned() } else { format!("{}/{link}", r.name) }
            }),
        }
    }

    /// Selection by a name: a robot, a link (`robot/link`; in a single robot only the link's name, and `robot` for
    /// all), or an object.
    pub fn selection(&self, name: &str) -> Option<Selection> {
        let link = |robot: RobotId, link: &str| {
            let link = self.robots.get(robot.0)?.robot.chain.link(link)?;
            Some(Selection::Link { robot, link })
        };
        let robot = if self.is_single_robot {
            link(RobotId(0), name).or_else(|| (name == "robot").then_some(Selection::Robot(RobotId(0))))
        } else if let Some((robot, of_robot)) = name.split_once('/') {
            self.robots.iter().position(|r| r.name == robot).and_then(|robot| link(RobotId(robot), of_robot))
        } else {
            self.robots.iter().position(|r| r.name == name).map(|r| Selection::Robot(RobotId(r)))
        };
        let object = || self.objects.iter().position(|o| o.name == name).map(|o| Selection::Object(ObjectId(o)));
        robot.or_else(object)
    }

    /// All names that [`Self::selection`] knows: robots, objects, links.
    pub fn names(&self) -> Vec<String> {
        let robots = self.robots.iter().map(|r| if self.is_single_robot { "robot".to_owned() } else { r.name.clone() });
        let objects = self.objects.iter().map(|o| o.name.clone());
        let links = self.robots.iter().flat_map(|r| {
            let prefix = if self.is_single_robot { String::new() } else { format!("{}/", r.name) };
            r.robot.chain.links().iter().map(move |link| format!("{prefix}{link}"))
        });
        robots.chain(objects).chain(links).collect()
    }

    /// Number of joint values of one state, over all robots.
    pub fn values(&self) -> usize {
        self.robots.iter().map(|r| r.start.len()).sum()
    }
}

/// The warning and the hint for a single robot.
fn joint_contact_warning(robot: &Robot, found: &JointContact) -> (String, String) {
    let [a, b] = [found.a, found.b].map(|link| &robot.chain.links()[link.0]);
    let states = if found.contacts == found.samples { "every state counts" } else { "these states count" };
    let what = format!("links `{a}` and `{b}` touch {}: {states} as a collision", reason(robot, found));
    let hint = "if they are built so: --pairs FILE, which `elbowroom inspect MODEL --pairs FILE --accept` writes";
    (what, hint.to_owned())
}
