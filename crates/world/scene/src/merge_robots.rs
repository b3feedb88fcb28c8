//! Several robots merged into one, so that a planner for one robot plans for all of them together.

use std::ops::Range;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_spatial::{Pose, Vec3};

use crate::allowed_collision_matrix::{AllowedCollisionMatrix, PairState, Reason};
use crate::{Attachment, MatrixError, Object, PairEdit, Scene, SceneError, SceneState};

/// Reason of a pair whose state is copied from the scene before the merge.
const NOTE: &str = "as before the robots were merged";

/// A scene in which several robots are merged into one.
///
/// The joint values of the merged robot are those of the first robot, then those of the second, and so on. Pairs, margins
/// and weights are unchanged.
///
/// ```
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{MergedRobots, SceneState, example};
/// let scene = example::two_arms();
/// let merged = MergedRobots::new(&scene, &[RobotId(0), RobotId(1)])?;
/// let both = &merged.scene().robots()[merged.robot().0].robot;
/// assert_eq!(both.chain.dof(), 6);
/// let state = merged.state(&scene, &SceneState::new(&scene))?;
/// assert_eq!(merged.split(state.q(merged.robot())).count(), 2);
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MergedRobots {
    scene: Scene,
    /// The robots in order, each with the index of its first link in the merged robot.
    group: Vec<(RobotId, usize)>,
    /// Per robot: the range of its joint values.
    values: Vec<Range<usize>>,
}

impl MergedRobots {
    /// Merges robots.
    ///
    /// The merged robot is the first of the new scene and is named after all of them; the others follow in order.
    ///
    /// # Errors
    /// [`SceneError`] if a robot does not exist or is named twice.
    pub fn new(scene: &Scene, robots: &[RobotId]) -> Result<Self, SceneError> {
        let count = scene.robots().len();
        if let Some(&RobotId(index)) = robots.iter().find(|robot| robot.0 >= count) {
            return Err(SceneError::NoSuchRobot { index, count });
        }
        let mut joined = JoinedLinks::default();
        let (mut group, mut values) = (Vec::new(), Vec::new());
        for &id in robots {
            let dof = scene.robots()[id.0].robot.chain.dof();
            let first = values.last().map_or(0, |before: &Range<usize>| before.end);
            values.push(first..first + dof);
            group.push((id, joined.add(scene, id)));
        }
        let mut merged = Self { scene: Scene::builder().build()?, group, values };
        merged.scene = merged.merge(scene, joined)?;
        Ok(merged)
    }

    fn merge(&self, scene: &Scene, joined: JoinedLinks) -> Result<Scene, SceneError> {
        let name = joined.names.join("+");
        let failed = |what: String| SceneError::Merge { robot: name.clone(), what };
        let chain = Chain::new(name.clone(), joined.links, joined.joints).map_err(|e| failed(e.to_string()))?;
        let mut builder = Scene::builder();
        let mut robot = Robot::new(chain);
        (robot.colliders, robot.visuals) = (joined.colliders, joined.visuals);
        builder.robot(name.clone(), robot, Pose::IDENTITY);
        for (i, other) in scene.robots().iter().enumerate() {
            if !self.is_merged(RobotId(i)) {
                builder.robot(other.name.clone(), other.robot.clone(), other.base_in_world);
            }
        }
        for (i, object) in scene.objects().iter().enumerate() {
            // Scaled, as in the scene.
            let scaled = scene.shapes(GeometryId::Object(ObjectId(i))).next();
            let (shape, in_object) = scaled.unwrap_or((&object.shape, Pose::IDENTITY));
            let in_world = object.in_world * in_object;
            builder.object(Object { name: object.name.clone(), shape: shape.clone(), in_world });
        }
        // The margins of pairs contain the paddings; the margins of attached objects are read from here.
        for id in scene.geometries().filter(|&id| scene.padding_m(id) > 0.0) {
            builder.padding(self.geometry(id), scene.padding_m(id));
        }
        builder.prove_out_of_reach(false);
        let merged = builder.build()?;
        let matrix = self.matrix(scene, &merged).map_err(|e| failed(e.to_string()))?;
        merged.with_allowed_collision_matrix(matrix).map_err(|e| failed(e.to_string()))
    }

    /// The matrix of the merged scene. Entries that would differ from the original scene's matrix are set by hand.
    fn matrix(&self, scene: &Scene, merged: &Scene) -> Result<AllowedCollisionMatrix, MatrixError> {
        let mut matrix = merged.allowed_collision_matrix().clone();
        let before = scene.allowed_collision_matrix();
        for entry in before.entries().iter().chain(before.object_entries()) {
            let (a, b) = (self.geometry(entry.a), self.geometry(entry.b));
            let by_rules = matrix.get(a, b).cloned();
            // A pair out of reach never collides, but has a distance.
            let is_tested = entry.state == PairState::Tested || matches!(entry.reason, Reason::OutOfReach { .. });
            let is_same = by_rules.as_ref().is_some_and(|e| (e.state == PairState::Tested) == is_tested);
            if !is_same || matches!(entry.reason, Reason::ByHand(_)) {
                let edit = if is_tested { PairEdit::Test } else { PairEdit::Skip };
                matrix.edit(merged, a, b, edit(NOTE.into()))?;
            }
            if by_rules.as_ref().is_none_or(|e| e.margin_m != entry.margin_m) {
                matrix.edit(merged, a, b, PairEdit::Margin(entry.margin_m))?;
            }
            if by_rules.is_none_or(|e| e.weight != entry.weight) {
                matrix.edit(merged, a, b, PairEdit::Weight(entry.weight))?;
            }
        }
        Ok(matrix)
    }

    /// The merged scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Id of the merged robot.
    pub fn robot(&self) -> RobotId {
        RobotId(0)
    }

    /// Converts the id of a link or object of the original scene to the merged scene.
    pub fn geometry(&self, id: GeometryId) -> GeometryId {
        match id {
            GeometryId::Object(_) => id,
            GeometryId::Link { robot, link } => {
                let link = self.first_link(robot).map_or(link, |first| LinkId(first + link.0));
                GeometryId::Link { robot: self.robot_id(robot), link }
            }
        }
    }

    /// Converts a state of the original scene to the merged scene.
    ///
    /// # Errors
    /// The errors of [`SceneState::set_q`], [`SceneState::place`] and [`SceneState::attach_at`].
    pub fn state(&self, scene: &Scene, state: &SceneState) -> Result<SceneState, SceneError> {
        let mut merged = SceneState::new(&self.scene);
        let all: Vec<f64> = self.group.iter().flat_map(|(robot, _)| state.q(*robot)).copied().collect();
        merged.set_q(&self.scene, self.robot(), &all)?;
        for robot in (0..scene.robots().len()).map(RobotId).filter(|&robot| !self.is_merged(robot)) {
            merged.set_q(&self.scene, self.robot_id(robot), state.q(robot))?;
        }
        for object in (0..scene.objects().len()).map(ObjectId) {
            let id = GeometryId::Object(object);
            let in_object = scene.shapes(id).next().map_or(Pose::IDENTITY, |(_, in_object)| in_object);
            if let Some(held) = state.attachment(object) {
                merged.attach_at(&self.scene, object, self.attachment(held, in_object))?;
            } else {
                let in_world = state.pose(scene, id).unwrap_or(scene.objects()[object.0].in_world);
                merged.place(&self.scene, object, in_world * in_object)?;
            }
        }
        Ok(merged)
    }

    /// Splits joint values of the merged robot into those of each robot.
    pub fn split<'q>(&'q self, q: &'q [f64]) -> impl ExactSizeIterator<Item = &'q [f64]> {
        self.values.iter().map(|range| q.get(range.clone()).unwrap_or_default())
    }

    fn attachment(&self, held: &Attachment, in_object: Pose) -> Attachment {
        let link = |link: &LinkId| self.link_id(held.robot, *link);
        Attachment {
            robot: self.robot_id(held.robot),
            link: link(&held.link),
            in_link: held.in_link * in_object,
            touch_links: held.touch_links.iter().map(link).collect(),
            visiting_links: held
                .visiting_links
                .iter()
                .map(|(r, l)| (self.robot_id(*r), self.link_id(*r, *l)))
                .collect(),
        }
    }

    fn link_id(&self, robot: RobotId, link: LinkId) -> LinkId {
        LinkId(self.first_link(robot).unwrap_or(0) + link.0)
    }

    fn is_merged(&self, robot: RobotId) -> bool {
        self.first_link(robot).is_some()
    }

    fn first_link(&self, robot: RobotId) -> Option<usize> {
        self.group.iter().find(|(id, _)| *id == robot).map(|(_, first)| *first)
    }

    fn robot_id(&self, robot: RobotId) -> RobotId {
        if self.is_merged(robot) {
            return self.robot();
        }
        let merged_before = self.group.iter().filter(|(id, _)| id.0 < robot.0).count();
        RobotId(1 + robot.0 - merged_before)
    }
}

/// Links and joints of several robots on one common root.
struct JoinedLinks {
    names: Vec<String>,
    links: Vec<String>,
    joints: Vec<Joint>,
    colliders: Vec<Vec<elbowroom_robot::Collider>>,
    visuals: Vec<Vec<elbowroom_robot::Collider>>,
}

impl Default for JoinedLinks {
    fn default() -> Self {
        Self {
            names: Vec::new(),
            links: vec!["root".into()],
            joints: Vec::new(),
            colliders: vec![Vec::new()],
            visuals: vec![Vec::new()],
        }
    }
}

impl JoinedLinks {
    /// Adds a robot and returns the index of its first link.
    fn add(&mut self, scene: &Scene, id: RobotId) -> usize {
        let placed = &scene.robots()[id.0];
        let (robot, name) = (&placed.robot, &placed.name);
        let (first_link, first_joint) = (self.links.len(), self.joints.len());
        self.names.push(name.clone());
        self.links.extend(robot.chain.links().iter().map(|link| format!("{name}/{link}")));
        // Scaled, as in the scene.
        let shapes = |link: usize| {
            let id = GeometryId::Link { robot: id, link: LinkId(link) };
            let mut colliders = robot.colliders[link].clone();
            for (collider, (shape, in_link)) in colliders.iter_mut().zip(scene.shapes(id)) {
                (collider.shape, collider.in_link) = (shape.clone(), in_link);
            }
            colliders
        };
        self.colliders.extend((0..robot.colliders.len()).map(shapes));
        self.visuals.extend(robot.visuals.iter().cloned());
        self.joints.extend(robot.chain.joints().iter().map(|joint| Joint {
            name: format!("{name}/{}", joint.name),
            parent: LinkId(first_link + joint.parent.0),
            child: LinkId(first_link + joint.child.0),
            mimic: joint.mimic.map(|m| Mimic { joint: JointId(first_joint + m.joint.0), ..m }),
            ..joint.clone()
        }));
        self.joints.push(Joint {
            name: format!("{name}/base"),
            kind: JointKind::Fixed,
            parent: LinkId(0),
            child: LinkId(first_link + robot.chain.root().0),
            origin: placed.base_in_world,
            axis: Vec3::Z,
            limits: Limits::UNLIMITED,
            mimic: None,
        });
        first_link
    }
}
