//! A robot of a scene covered by spheres, and the solids around it.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_scene::{PairState, Reason, Scene, SceneState};
use elbowroom_spatial::Pose;
use elbowroom_validity::{
    BuiltCovers, CoverSource, CoveredLinkId, CoveredRobot, NotCertain, ObstacleSet, ValidityChecker, ValidityError,
};

/// Tolerance, m: pairs that are proven to stay apart by at most this much more than the clearance are tested, too.
const REACH_TOLERANCE_M: f64 = 1e-3;

/// One robot of a scene, with sphere covers of its links and of the objects that it holds. A model is built once and
/// serves all scenes with the same robot, whatever their objects.
#[derive(Debug, Clone)]
pub struct CoverModel {
    pub(super) robot: CoveredRobot,
    /// The geometry of each covered link.
    covered_links: Vec<GeometryId>,
    /// Pairs of covered links that the scene tests, and their margins.
    pairs: Vec<(usize, usize, f64)>,
    index: RobotId,
    base_in_world: Pose,
    clearance_m: f64,
}

impl CoverModel {
    /// Covers a robot and the objects that it holds in a state. The model tests the same pairs of links as the scene,
    /// and keeps them farther apart than their margins and the clearance (m).
    ///
    /// # Errors
    /// No spheres enclose some link or held object.
    ///
    /// # Panics
    /// The scene does not have this robot.
    pub fn new(scene: &Scene, state: &SceneState, robot: RobotId, clearance_m: f64) -> Result<Self, ValidityError> {
        Self::with_covers(scene, state, robot, clearance_m, &BuiltCovers)
    }

    /// Like [`new`](Self::new), with the covers of links from a source.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    ///
    /// # Panics
    /// The scene does not have this robot.
    pub fn with_covers(
        scene: &Scene,
        state: &SceneState,
        robot: RobotId,
        clearance_m: f64,
        source: &dyn CoverSource,
    ) -> Result<Self, ValidityError> {
        let r = &scene.robots()[robot.0];
        let mut covered = CoveredRobot::with_covers(&as_checked(scene, robot), r.base_in_world, source)?;
        let link = |link: LinkId| GeometryId::Link { robot, link };
        let mut covered_links: Vec<GeometryId> = covered.covered_links().map(link).collect();
        for i in 0..scene.objects().len() {
            let id = ObjectId(i);
            let Some(held) = state.attachment(id).filter(|a| a.robot == robot) else { continue };
            let shapes: Vec<_> = scene.shapes(GeometryId::Object(id)).map(|(s, at)| (s, held.in_link * at)).collect();
            covered.add_covered_link(&r.robot.chain, held.link, &shapes)?;
            covered_links.push(GeometryId::Object(id));
        }
        let pairs = tested_pairs(scene, state, &covered_links, clearance_m);
        for &(a, b, margin_m) in &pairs {
            covered.add_pair(CoveredLinkId(a), CoveredLinkId(b), margin_m + clearance_m);
        }
        let base_in_world = r.base_in_world;
        Ok(Self { robot: covered, covered_links, pairs, index: robot, base_in_world, clearance_m })
    }

    /// Whether the model also serves another scene with the same robot: it was made for the same pairs, base and
    /// clearance (m), and nothing is held.
    pub(crate) fn serves(&self, scene: &Scene, state: &SceneState, robot: RobotId, clearance_m: f64) -> bool {
        let holds = (0..scene.objects().len()).any(|i| state.attachment(ObjectId(i)).is_some());
        let held = self.covered_links.iter().any(|b| matches!(b, GeometryId::Object(_)));
        self.index == robot
            && !holds
            && !held
            && self.clearance_m == clearance_m
            && scene.robots().get(self.index.0).is_some_and(|r| r.base_in_world == self.base_in_world)
            && self.pairs == tested_pairs(scene, state, &self.covered_links, clearance_m)
    }
}

/// A robot with the shapes that the scene checks.
fn as_checked(scene: &Scene, robot: RobotId) -> Robot {
    let mut checked = scene.robots()[robot.0].robot.clone();
    for (link, colliders) in checked.colliders.iter_mut().enumerate() {
        let id = GeometryId::Link { robot, link: LinkId(link) };
        for (collider, (shape, in_link)) in colliders.iter_mut().zip(scene.shapes(id)) {
            (collider.shape, collider.in_link) = (shape.clone(), in_link);
        }
    }
    checked
}

/// Pairs of links that the scene tests, each with its margin in metres.
fn tested_pairs(
    scene: &Scene,
    state: &SceneState,
    covered_links: &[GeometryId],
    clearance_m: f64,
) -> Vec<(usize, usize, f64)> {
    let mut pairs = Vec::new();
    for i in 0..covered_links.len() {
        for j in i + 1..covered_links.len() {
            let margin_m = tested_margin(scene, state, covered_links[i], covered_links[j], clearance_m);
            pairs.extend(margin_m.map(|margin_m| (i, j, margin_m)));
        }
    }
    pairs
}

/// The solids that a robot must not touch: objects and other robots, placed as in a state.
#[derive(Debug, Clone)]
pub struct CoverObstacles {
    pub(super) set: ObstacleSet,
    /// The geometry of each obstacle.
    sources: Vec<GeometryId>,
    /// Pairs that the scene does not test.
    skipped: Vec<(CoveredLinkId, usize)>,
}

impl CoverObstacles {
    /// The obstacles of a model in a state, each with its largest margin to a link of the model, and the clearance (m).
    pub fn new(model: &CoverModel, scene: &Scene, state: &SceneState, clearance_m: f64) -> Self {
        Self::with_covers(model, scene, state, clearance_m, &BuiltCovers)
    }

    /// Like [`new`](Self::new), with the covers of meshes and hulls from a source.
    pub fn with_covers(
        model: &CoverModel,
        scene: &Scene,
        state: &SceneState,
        clearance_m: f64,
        source: &dyn CoverSource,
    ) -> Self {
        let mut obstacles = Self { set: ObstacleSet::default(), sources: Vec::new(), skipped: Vec::new() };
        for i in 0..scene.objects().len() {
            let id = GeometryId::Object(ObjectId(i));
            if model.covered_links.contains(&id) {
                continue;
            }
            let Some(in_world) = state.pose(scene, id) else { continue };
            let shapes: Vec<_> = scene.shapes(id).map(|(s, at)| (s, in_world * at)).collect();
            obstacles.add((model, scene, state), id, &shapes, clearance_m, source);
        }
        for (r, other) in scene.robots().iter().enumerate().filter(|(r, _)| *r != model.index.0) {
            for link in other.robot.links_with_colliders() {
                let id = GeometryId::Link { robot: RobotId(r), link };
                let Some(link_in_world) = state.pose(scene, id) else { continue };
                let shapes: Vec<_> = scene.shapes(id).map(|(s, at)| (s, link_in_world * at)).collect();
                obstacles.add((model, scene, state), id, &shapes, clearance_m, source);
            }
        }
        obstacles
    }

    fn add(
        &mut self,
        (model, scene, state): (&CoverModel, &Scene, &SceneState),
        id: GeometryId,
        shapes: &[(&Shape, Pose)],
        clearance_m: f64,
        source: &dyn CoverSource,
    ) {
        let margin = |&link: &GeometryId| tested_margin(scene, state, link, id, clearance_m);
        let margins: Vec<_> = model.covered_links.iter().map(margin).collect();
        let Some(largest) = margins.iter().flatten().copied().reduce(f64::max) else { return };
        for (shape, in_world) in shapes {
            let number = self.set.add_shape_with(shape, in_world, largest + clearance_m, source);
            self.sources.push(id);
            let untested = margins.iter().enumerate().filter(|(_, m)| m.is_none());
            self.skipped.extend(untested.map(|(body, _)| (CoveredLinkId(body), number)));
        }
    }

    /// A checker of the model among these obstacles.
    pub(super) fn checker<'m>(&'m self, model: &'m CoverModel) -> ValidityChecker<'m> {
        let mut checker = ValidityChecker::new(&model.robot, &self.set);
        for &(body, obstacle) in &self.skipped {
            checker.skip(body, obstacle);
        }
        checker
    }

    /// The geometries of a pair.
    pub(super) fn pair(&self, model: &CoverModel, pair: NotCertain) -> (GeometryId, GeometryId) {
        match pair {
            NotCertain::Links(a, b) => (model.covered_links[a.0], model.covered_links[b.0]),
            NotCertain::Obstacle(body, obstacle) => (model.covered_links[body.0], self.sources[obstacle]),
        }
    }
}

/// The margin of a pair in metres; `None` if the scene does not test the pair with a clearance (m).
fn tested_margin(scene: &Scene, state: &SceneState, a: GeometryId, b: GeometryId, clearance_m: f64) -> Option<f64> {
    let (pair_state, reason) = state.pair(scene, a, b)?;
    let entry = scene.allowed_collision_matrix().get(a, b);
    // Pairs of held objects do not have an entry.
    let margin_m = entry.map_or_else(|| scene.padding_m(a) + scene.padding_m(b), |e| e.margin_m);
    match (pair_state, reason) {
        (PairState::Tested, _) => Some(margin_m),
        // Out of reach of contact, but within reach of the clearance.
        (_, Reason::OutOfReach { least_m }) if least_m <= margin_m + clearance_m + REACH_TOLERANCE_M => Some(margin_m),
        _ => None,
    }
}
