//! Proximity pairs of the robot from the exact scene.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{Attachment, Checker, CheckerOptions, Object, PairDistance, Scene, SceneState, Selection};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use crate::motion_bounds::MotionBounds;
use crate::reactive_controller::MAX_PAIRS;
use crate::{AvoidanceError, DynamicObstacles, ObservedObject, ObstacleKind, ProximityPair};

/// Distance below which witness points do not define a direction, m.
const TOUCHING_M: f64 = 1e-7;

/// A proximity pair and its geometries in the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScenePair {
    pub(crate) pair: ProximityPair,
    pub(crate) a: GeometryId,
    pub(crate) b: GeometryId,
}

/// An object that was observed at least once.
#[derive(Debug, Clone, Copy)]
struct Observation {
    motion: FrameMotion,
    known: bool,
}

/// Range of a proximity query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProximityRange {
    /// Distance (m) within which all obstacles that may move are found.
    pub(crate) dynamic_m: f64,
    /// Distance (m) within which all obstacles are found, including obstacles that can come as near within `ahead_s`.
    pub(crate) fixed_m: f64,
    /// Prediction time, s.
    pub(crate) ahead_s: f64,
}

/// The scene at the present instant, and the proximity pairs of one robot.
#[derive(Debug)]
pub(crate) struct ProximityQuery<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) robot: RobotId,
    pub(crate) checker: Checker<'s>,
    pub(crate) state: SceneState,
    /// Chain state per robot, for velocities.
    pub(crate) chains: Vec<ChainState>,
    /// Motion bounds per robot.
    pub(crate) motion_bounds: Vec<MotionBounds>,
    /// The nearest pairs beyond [`MAX_PAIRS`]: with an obstacle that may move, and with a fixed one.
    pub(crate) excluded: [Option<ProximityPair>; 2],
    /// The pairs, nearest first.
    pub(crate) pairs: Vec<ProximityPair>,
    /// The same pairs in the same order, with their geometries in the scene.
    pub(crate) scene_pairs: Vec<ScenePair>,
    /// Radius of a sphere about each object's origin that encloses it.
    object_radii: Vec<f64>,
    observed: Vec<Option<Observation>>,
    /// Per robot, whether the path was planned with it.
    known_robots: Vec<bool>,
    /// All geometries that may move, and the distance within which they are found, m.
    movable: Vec<(GeometryId, f64)>,
}

impl<'s> ProximityQuery<'s> {
    pub(crate) fn new(scene: &'s Scene, robot: RobotId) -> Self {
        let object_radius = |o: &Object| o.shape.aabb(&Pose::IDENTITY).max_distance(Vec3::ZERO);
        let state = SceneState::new(scene);
        let bounds = |r| MotionBounds::of_state(scene, &state, RobotId(r));
        Self {
            scene,
            robot,
            checker: Checker::new(scene, CheckerOptions::default()),
            chains: scene.robots().iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            object_radii: scene.objects().iter().map(object_radius).collect(),
            motion_bounds: (0..scene.robots().len()).map(bounds).collect(),
            state,
            excluded: [None; 2],
            observed: vec![None; scene.objects().len()],
            known_robots: vec![false; scene.robots().len()],
            pairs: Vec::with_capacity(MAX_PAIRS),
            scene_pairs: Vec::with_capacity(64),
            movable: Vec::with_capacity(scene.objects().len() + scene.robots().len()),
        }
    }

    /// Updates the configurations and poses of the scene.
    pub(crate) fn update_scene(&mut self, q: &[f64], obstacles: &DynamicObstacles<'_>) -> Result<(), AvoidanceError> {
        self.state.set_q(self.scene, self.robot, q)?;
        self.chains[self.robot.0].q.copy_from_slice(q);
        self.scene.robots()[self.robot.0].robot.chain.forward(&mut self.chains[self.robot.0]);
        // Robots without updates are assumed stationary.
        for (_, chain) in self.chains.iter_mut().enumerate().filter(|(i, _)| *i != self.robot.0) {
            chain.qd.fill(0.0);
        }
        for neighbour in obstacles.robots.iter().filter(|n| n.robot != self.robot) {
            self.state.set_q(self.scene, neighbour.robot, neighbour.q)?;
            self.known_robots[neighbour.robot.0] = neighbour.known;
            let chain = &mut self.chains[neighbour.robot.0];
            chain.q.copy_from_slice(neighbour.q);
            if neighbour.qd.len() != chain.qd.len() || neighbour.qd.iter().any(|v| !v.is_finite()) {
                let (robot, joints) = (self.scene.robots()[neighbour.robot.0].name.clone(), chain.qd.len());
                return Err(AvoidanceError::Neighbour { robot, given: neighbour.qd.len(), joints });
            }
            chain.qd.copy_from_slice(neighbour.qd);
            self.scene.robots()[neighbour.robot.0].robot.chain.forward_motion(chain);
        }
        // Objects that are no longer observed are assumed stationary.
        self.observed.iter_mut().flatten().for_each(|o| o.motion = FrameMotion::REST);
        for observed in obstacles.objects {
            self.state.place(self.scene, observed.object, observed.in_world)?;
            if !observed.motion.is_finite() {
                return Err(AvoidanceError::Motion { object: self.scene.objects()[observed.object.0].name.clone() });
            }
            self.observed[observed.object.0] = Some(Observation { motion: observed.motion, known: observed.known });
        }
        Ok(())
    }

    /// Attaches an object to a link of any robot, which makes it part of that robot.
    pub(crate) fn attach(&mut self, object: ObjectId, attachment: Attachment) -> Result<(), AvoidanceError> {
        let robot = attachment.robot;
        self.state.attach_at(self.scene, object, attachment)?;
        self.observed[object.0] = None;
        self.update_motion_bounds(robot);
        Ok(())
    }

    /// Detaches an object, which stays in place; returns its pose.
    pub(crate) fn detach(&mut self, object: ObjectId) -> Result<Pose, AvoidanceError> {
        let robot = self.state.attachment(object).map(|a| a.robot);
        self.state.detach(self.scene, object)?;
        if let Some(robot) = robot {
            self.update_motion_bounds(robot);
        }
        Ok(self.state.pose(self.scene, GeometryId::Object(object)).unwrap_or(Pose::IDENTITY))
    }

    fn update_motion_bounds(&mut self, robot: RobotId) {
        self.motion_bounds[robot.0] = MotionBounds::of_state(self.scene, &self.state, robot);
    }

    /// The link with which an attached object moves; any other geometry itself.
    pub(crate) fn carrier(&self, geometry: GeometryId) -> GeometryId {
        carrier(&self.state, geometry)
    }

    /// Motion bounds of the controlled robot.
    pub(crate) fn own_motion_bounds(&self) -> &MotionBounds {
        &self.motion_bounds[self.robot.0]
    }

    /// Upper bound of the travel (m) of any point of a geometry by its own motion.
    pub(crate) fn max_approach(&self, geometry: GeometryId, obstacles: &DynamicObstacles<'_>, duration_s: f64) -> f64 {
        let speed = |o: &ObservedObject| {
            o.motion.velocity.length() + o.motion.angular_velocity.length() * self.object_radii[o.object.0]
        };
        match self.carrier(geometry) {
            GeometryId::Object(o) => {
                let same = obstacles.objects.iter().filter(|observed| observed.object == o);
                same.map(|observed| speed(observed) * duration_s).fold(0.0, f64::max)
            }
            GeometryId::Link { robot, .. } => {
                let same = obstacles.robots.iter().filter(|n| n.robot == robot && robot != self.robot);
                same.map(|n| self.motion_bounds[robot.0].max_travel(n.qd, duration_s)).fold(0.0, f64::max)
            }
        }
    }

    /// Finds the proximity pairs within the range, nearest first.
    pub(crate) fn find_pairs(&mut self, obstacles: &DynamicObstacles<'_>, range: ProximityRange) {
        let mut movable = std::mem::take(&mut self.movable);
        movable.clear();
        let objects =
            (0..self.observed.len()).filter(|o| self.observed[*o].is_some()).map(|o| GeometryId::Object(ObjectId(o)));
        // One link represents all links of a robot.
        let robots = (0..self.chains.len()).filter(|r| *r != self.robot.0);
        let robots = robots.map(|robot| GeometryId::Link { robot: RobotId(robot), link: LinkId(0) });
        let reach = |m: GeometryId| range.dynamic_m.max(range.fixed_m + self.max_approach(m, obstacles, range.ahead_s));
        movable.extend(objects.chain(robots).map(|m| (m, reach(m))));
        self.movable = movable;
        let base = self.scene.robots()[self.robot.0].base_in_world;
        let converter = PairConverter {
            scene: self.scene,
            robot: self.robot,
            root_in_world: base,
            world_in_root: base.inverse(),
            chains: &self.chains,
            object_radii: &self.object_radii,
            observed: &self.observed,
            known_robots: &self.known_robots,
            state: &self.state,
        };
        let (found, checker, state) = (&mut self.scene_pairs, &mut self.checker, &self.state);
        let convert = |d: &PairDistance| converter.convert(d).map(|pair| ScenePair { pair, a: d.a, b: d.b });
        found.clear();
        let own = Selection::Robot(self.robot);
        for (other, reach_m) in &self.movable {
            let other = match other {
                GeometryId::Object(o) => Selection::Object(*o),
                GeometryId::Link { robot, .. } => Selection::Robot(*robot),
            };
            checker.between(own, other).distances_within(state, *reach_m, |d| found.extend(convert(&d)));
        }
        checker.between(own, Selection::All).distances_within(state, range.fixed_m, |d| {
            found.extend(convert(&d).filter(|f| !f.pair.obstacle.may_move()));
        });
        // Fixed obstacles never displace obstacles that may move.
        let may_move = |f: &ScenePair| f.pair.obstacle.may_move();
        let by_distance = |a: &ScenePair, b: &ScenePair| a.pair.distance_m.total_cmp(&b.pair.distance_m);
        found.sort_unstable_by(|a, b| may_move(b).cmp(&may_move(a)).then(by_distance(a, b)));
        let beyond = found.get(MAX_PAIRS..).unwrap_or_default();
        self.excluded = [true, false].map(|c| beyond.iter().find(|f| may_move(f) == c).map(|f| f.pair));
        found.truncate(MAX_PAIRS);
        found.sort_unstable_by(by_distance);
        self.pairs.clear();
        self.pairs.extend(found.iter().map(|f| f.pair));
    }
}

fn carrier(state: &SceneState, geometry: GeometryId) -> GeometryId {
    let GeometryId::Object(object) = geometry else { return geometry };
    state.attachment(object).map_or(geometry, |a| GeometryId::Link { robot: a.robot, link: a.link })
}

/// Converts distances of the scene to proximity pairs of the robot.
struct PairConverter<'a> {
    scene: &'a Scene,
    robot: RobotId,
    root_in_world: Pose,
    world_in_root: Pose,
    chains: &'a [ChainState],
    object_radii: &'a [f64],
    observed: &'a [Option<Observation>],
    known_robots: &'a [bool],
    state: &'a SceneState,
}

impl PairConverter<'_> {
    /// Converts a pair; `None` if the robot's joints do not change its distance.
    fn convert(&self, d: &PairDistance) -> Option<ProximityPair> {
        let own_link = |m: GeometryId| match carrier(self.state, m) {
            GeometryId::Link { robot, link } if robot == self.robot => Some(link),
            _ => None,
        };
        let (link, on_link, other, on_other) = match (own_link(d.a), own_link(d.b)) {
            (Some(link), _) => (link, d.on_a, d.b, d.on_b),
            (None, Some(link)) => (link, d.on_b, d.a, d.on_a),
            (None, None) => return None,
        };
        let obstacle = match own_link(other) {
            Some(own) => ObstacleKind::OwnLink(own),
            None => self.obstacle(other, on_other),
        };
        let away_in_world = if d.metres > TOUCHING_M && (on_link - on_other).length() > TOUCHING_M {
            (on_link - on_other).try_normalize()?
        } else {
            self.away_on_contact(on_link, link, other)?
        };
        Some(ProximityPair {
            link,
            on_link: self.world_in_root.transform_point(on_link),
            away: self.world_in_root.rotation * away_in_world,
            distance_m: d.metres,
            on_obstacle: self.world_in_root.transform_point(on_other),
            obstacle,
        })
    }

    /// Direction on contact, when witness points do not define one: away from the origin of the other geometry.
    fn away_on_contact(&self, on_link: Vec3, link: LinkId, other: GeometryId) -> Option<Vec3> {
        let origin = self.state.pose(self.scene, other)?.translation;
        let own = self.root_in_world * self.chains[self.robot.0].link_in_root(link);
        (on_link - origin).try_normalize().or_else(|| (own.translation - origin).try_normalize()).or(Some(Vec3::Z))
    }

    fn obstacle(&self, other: GeometryId, on_other: Vec3) -> ObstacleKind {
        match carrier(self.state, other) {
            GeometryId::Object(o) => {
                let Some(Observation { motion, known }) = self.observed[o.0] else { return ObstacleKind::Fixed };
                let Some(pose) = self.state.pose(self.scene, other) else { return ObstacleKind::Fixed };
                let velocity = motion.velocity_at(on_other - pose.translation);
                if known {
                    return ObstacleKind::KnownMoving { velocity: self.world_in_root.rotation * velocity };
                }
                self.dynamic(velocity, pose.translation, self.object_radii[o.0], o.0)
            }
            GeometryId::Link { robot, link } => {
                let base = self.scene.robots()[robot.0].base_in_world;
                let chain = &self.chains[robot.0];
                let velocity = chain.point_velocity(link, base.inverse().transform_point(on_other));
                if self.known_robots[robot.0] {
                    let velocity = self.world_in_root.rotation * (base.rotation * velocity);
                    return ObstacleKind::KnownMoving { velocity };
                }
                let before = self.scene.robots()[..robot.0].iter().map(|r| r.robot.chain.links().len());
                let key = self.object_radii.len() + before.sum::<usize>() + link.0;
                self.dynamic(base.rotation * velocity, on_other, 0.0, key)
            }
        }
    }

    fn dynamic(&self, velocity: Vec3, centre: Vec3, radius_m: f64, key: usize) -> ObstacleKind {
        ObstacleKind::Dynamic {
            velocity: self.world_in_root.rotation * velocity,
            centre: self.world_in_root.transform_point(centre),
            radius_m,
            key,
        }
    }
}
