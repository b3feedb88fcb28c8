//! Collision queries about a state of a scene.

mod approaching;
mod broad_phase;
mod collision_point;
mod contact;
pub(crate) mod core;
mod distances_within;
mod minimum_distance;
mod options;
mod pair_distance;
pub(crate) mod pair_list;
mod pair_query;
mod result;

pub use options::CheckerOptions;
pub use pair_query::PairQuery;
pub use result::{ApproachingPair, CollisionPoint, PairContact, PairDistance};

use elbowroom_proximity::contact::Detail;
use elbowroom_robot::{GeometryId, RobotId};

use self::core::CheckerCore;
use self::pair_list::PairList;
use crate::sweep::{SweepHit, SweepMove, SweepOptions, Sweeper};
use crate::{CheckerStats, Level, LevelOfDetail, Scene, SceneError, SceneMotion, SceneState, Selection};

/// Answers queries about states of one scene. Each thread needs its own checker.
///
/// The checker keeps warm starts (likely pairs, nearest triangles), which make the next answer faster but never
/// different. Queries do not allocate, except the first query about a [selection](Checker::between) and the first query
/// after an object was attached or detached.
///
/// ```
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection, example};
/// let scene = example::two_arms();
/// let [left, right] = [RobotId(0), RobotId(1)].map(Selection::Robot);
/// let mut state = SceneState::new(&scene);
/// let mut checker = Checker::new(&scene, CheckerOptions::default());
/// assert!(checker.collides(&state).is_none());
/// let nearest = checker.distance(&state).unwrap();
/// assert!(nearest.lower_bound <= nearest.metres && checker.within(&state, nearest.metres + 1e-6).is_some());
/// let upright = checker.between(left, right).distance(&state).unwrap();
/// state.set_q(&scene, RobotId(0), &[0.0, 0.7, 0.0])?; // leans towards the other arm
/// let leaning = checker.between(left, right).distance(&state).unwrap();
/// assert!(leaning.metres < upright.metres);
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Checker<'s> {
    core: CheckerCore<'s>,
    lists: Vec<PairList>,
    /// Created at the first sweep.
    sweeper: Option<Box<Sweeper>>,
}

impl Clone for Checker<'_> {
    /// Copies the settings, the statistics and what was learned; the copy makes its memory for sweeps at its first sweep.
    fn clone(&self) -> Self {
        Self { core: self.core.clone(), lists: self.lists.clone(), sweeper: None }
    }
}

impl<'s> Checker<'s> {
    /// Creates a checker of a scene, ready for queries about all pairs.
    pub fn new(scene: &'s Scene, options: CheckerOptions) -> Self {
        let core = CheckerCore::new(scene, options);
        // Models that are built at first use are built here.
        scene.models.iter().for_each(|m| m.prepare(options.level));
        let mut checker = Self { core, lists: Vec::new(), sweeper: None };
        checker.all().update(&SceneState::new(scene));
        checker
    }

    /// The scene of this checker.
    pub fn scene(&self) -> &'s Scene {
        self.core.scene
    }

    /// The settings of this checker.
    pub fn options(&self) -> CheckerOptions {
        self.core.options
    }

    /// Statistics of the queries so far.
    pub fn stats(&self) -> CheckerStats {
        self.core.narrow.stats
    }

    /// Sets the statistics to zero.
    pub fn reset_stats(&mut self) {
        self.core.narrow.stats = CheckerStats::default();
    }

    /// The finest level that the last query used.
    pub fn last_level(&self) -> Level {
        self.core.finest
    }

    /// Selects the pairs with one geometry in each selection, for queries.
    ///
    /// Equal selections select the pairs within: for a robot, its self-collision. Pairs excluded by rule stay excluded,
    /// even if both geometries are named. A pair of unattached objects counts only if both selections contain objects
    /// only.
    ///
    /// ```
    /// use elbowroom_kinematics::LinkId;
    /// use elbowroom_robot::{ObjectId, RobotId};
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection, example};
    /// let scene = example::two_arms();
    /// let state = SceneState::new(&scene);
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// let robot = RobotId(0);
    /// let forearm = Selection::Link { robot, link: LinkId(3) };
    /// assert!(checker.between(forearm, Selection::Objects).distance(&state).unwrap().metres > 0.0);
    /// assert!(checker.between(Selection::Robot(robot), Selection::Robot(robot)).collides(&state).is_none());
    /// let [part, table] = [ObjectId(0), ObjectId(1)].map(Selection::Object);
    /// assert!(checker.between(part, table).within(&state, 0.01).is_some());
    /// ```
    pub fn between(&mut self, one: Selection, other: Selection) -> PairQuery<'_, 's> {
        let key = (one, other);
        let at = self.lists.iter().position(|l| l.key == key).unwrap_or_else(|| {
            self.lists.push(PairList::new(key));
            self.lists.len() - 1
        });
        PairQuery { core: &mut self.core, list: &mut self.lists[at], sweeper: &mut self.sweeper }
    }

    /// Queries about all pairs.
    fn all(&mut self) -> PairQuery<'_, 's> {
        self.between(Selection::All, Selection::All)
    }

    /// Finds a pair in contact (at most its margin apart); `None` if no pair is in contact.
    pub fn collides(&mut self, state: &SceneState) -> Option<PairContact> {
        self.all().collides(state)
    }

    /// Reports every pair in contact, in the order of the hierarchy.
    pub fn contacts(&mut self, state: &SceneState, found: impl FnMut(PairContact)) {
        self.all().contacts(state, found);
    }

    /// Finds a pair at most `tolerance_m` (metres) beyond its margin apart. Values below 0 count as 0, NaN as infinite.
    pub fn within(&mut self, state: &SceneState, tolerance_m: f64) -> Option<PairContact> {
        self.all().within(state, tolerance_m)
    }

    /// Finds the nearest pair, with its distance and witness points; `None` if the scene has no pair to test.
    pub fn distance(&mut self, state: &SceneState) -> Option<PairDistance> {
        self.all().distance(state)
    }

    /// Finds the collision point with link, collider, triangle and normals; `None` if nothing collides, margins included.
    ///
    /// If several pairs collide, it is the point of the pair that is first in the order of the hierarchy: the link
    /// nearest to a base.
    ///
    /// [`Detail::Boxes`] stops at a depth of the box trees of the meshes: "nothing collides" is guaranteed, a reported
    /// collision may be a false positive, and the point is a surface point in the box. [`Detail::Exact`] continues to the
    /// triangles. [`contact`](elbowroom_proximity::contact) specifies which of several touching triangles is reported;
    /// the choice is equal on every instruction set. Compares the exact models, whatever [`CheckerOptions::level`] is.
    /// Allocates only for hulls.
    ///
    /// ```
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{Checker, CheckerOptions, Detail, SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// assert!(checker.collision_point(&state, Detail::Exact).is_none());
    /// state.set_q(&scene, RobotId(0), &[0.0, 1.57, 0.0])?;
    /// let hit = checker.collision_point(&state, Detail::Exact).expect("the arm overlaps the part and the table");
    /// assert_eq!([hit.link, hit.other].map(|id| scene.name(id)), ["left/forearm", "part"]);
    /// assert!(hit.touching && hit.on_link.distance(hit.on_other) < 0.1);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn collision_point(&mut self, state: &SceneState, detail: Detail) -> Option<CollisionPoint> {
        self.all().collision_point(state, detail)
    }

    /// Reports every pair that is not proven farther apart than `margin_m` (metres) beyond its own margin.
    ///
    /// Each pair has its distance, proven lower bound and witness points. The order is that of the hierarchy (nearest to
    /// a base first). A pair in contact has distance 0 and a point in or near both geometries. A pair is reported if and
    /// only if [`Checker::within`] would find it. Values below 0 count as 0, NaN as infinite. [`Level::L1`] is answered
    /// at [`Level::L2`].
    ///
    /// ```
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, RobotId(0), &[0.0, 1.2, 0.3])?;
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// let mut near = Vec::new();
    /// let mut query = checker.between(Selection::Robots, Selection::Objects);
    /// query.distances_within(&state, 0.15, |pair| near.push(pair));
    /// let names: Vec<_> = near.iter().map(|d| [scene.name(d.a), scene.name(d.b)].join(" - ")).collect();
    /// assert_eq!(names, ["left/upper_arm - part", "left/upper_arm - table", "left/forearm - part"]);
    /// assert!(near.iter().all(|d| d.lower_bound <= d.metres && d.metres <= 0.15));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn distances_within(&mut self, state: &SceneState, margin_m: f64, found: impl FnMut(PairDistance)) {
        self.all().distances_within(state, margin_m, found);
    }

    /// Reports the pairs that are near or may soon meet at the present velocities, each with its time to collision.
    ///
    /// The order is that of the hierarchy. The query uses progressive level of detail (Reichenbach and Kovačić 2003):
    /// distant pairs are compared by one box each, approaching pairs deeper in the box trees of their meshes, near and
    /// fast pairs exactly, as `policy` says. `horizon_s` (seconds) limits [`ApproachingPair::earliest_s`].
    ///
    /// Under every policy these guarantees hold:
    /// - A pair nearer than `exact_m`, or not proven to be apart for `exact_s`, is always measured exactly, contact
    ///   included.
    /// - A pair reported coarsely is always farther apart than `exact_m`, and never meets within `exact_s` at constant
    ///   velocities.
    /// - A pair that is not reported is always farther apart than `within_m`, and never meets within `exact_s` at
    ///   constant velocities.
    ///
    /// NaN speeds and distances count as near and soon. Compares the exact models, whatever [`CheckerOptions::level`] is.
    ///
    /// ```
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{ApproachingPair, Checker, CheckerOptions, LevelOfDetail, SceneMotion, SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, RobotId(0), &[0.0, 0.9, 0.3])?;
    /// let mut motion = SceneMotion::new(&scene);
    /// motion.set_qd(&scene, &state, RobotId(0), &[0.0, 0.5, 0.0])?; // down towards the part
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// let mut soonest = None;
    /// checker.approaching(&state, &motion, &LevelOfDetail::default(), 2.0, |p| {
    ///     if soonest.is_none_or(|s: ApproachingPair| p.estimate_s < s.estimate_s) {
    ///         soonest = Some(p);
    ///     }
    /// });
    /// let soonest = soonest.expect("it approaches the part");
    /// assert_eq!([soonest.a, soonest.b].map(|id| scene.name(id)), ["left/forearm", "part"]);
    /// assert!(soonest.earliest_s > 0.0 && soonest.earliest_s <= soonest.estimate_s);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn approaching(
        &mut self,
        state: &SceneState,
        motion: &SceneMotion,
        policy: &LevelOfDetail,
        horizon_s: f64,
        found: impl FnMut(ApproachingPair),
    ) {
        self.all().approaching(state, motion, policy, horizon_s, found);
    }

    /// Finds the first time at which a pair is nearer than its margin during a motion (continuous collision detection).
    ///
    /// `None` means that every pair is clear during the whole motion. This is proven, not sampled, so that thin geometry
    /// cannot be passed through. Geometry that is not in `moves` keeps its pose of `start`. Pairs excluded by rule
    /// (adjacent links, SRDF, by hand) never count. A link that no joint moves counts against an object on its own path.
    /// Two unattached objects count only if both selections [name](Checker::between) objects only.
    ///
    /// The first sweep allocates, as does a later sweep that is longer than all before it. [`Level::L1`] is answered at
    /// [`Level::L2`].
    ///
    /// ```
    /// use elbowroom_proximity::ccd::ConstantTwist;
    /// use elbowroom_robot::{ObjectId, RobotId};
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepMove, SweepOptions, example};
    /// use elbowroom_spatial::Vec3;
    /// let scene = example::two_arms();
    /// let mut start = SceneState::new(&scene);
    /// start.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// // Across the part on the table: both ends are free, the segment between them is not.
    /// let across = [SweepMove::Robot { robot: RobotId(0), to: &[0.9, 1.3, 0.6] }];
    /// let hit = checker.sweep(&start, &across, &SweepOptions::default())?.expect("the part is hit");
    /// assert_eq!((scene.name(hit.a), scene.name(hit.b)), ("left/forearm".into(), "part".into()));
    /// assert!(hit.certain && hit.metres <= 1e-4);
    /// // The part moves on a path of its own.
    /// let part = scene.objects()[0].in_world;
    /// let path = ConstantTwist::linear(part, Vec3::X * -0.6);
    /// let moves = [SweepMove::Object { object: ObjectId(0), path: &path }];
    /// let hit = checker.sweep(&start, &moves, &SweepOptions::default())?;
    /// assert!(hit.is_some_and(|h| h.time > 0.3));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`SceneState::set_q`] and [`SceneState::place`] for the end of the motion; a robot or object that
    /// moves twice.
    pub fn sweep(
        &mut self,
        start: &SceneState,
        moves: &[SweepMove],
        options: &SweepOptions,
    ) -> Result<Option<SweepHit>, SceneError> {
        self.all().sweep(start, moves, options)
    }

    /// Like [`Checker::sweep`], but moves one robot through waypoints (joint values, rad or m).
    ///
    /// The robot moves straight in joint space from each waypoint to the next. The first waypoint is either the
    /// configuration in `start` or the end of the first segment. Returns the hit with the index of the waypoint at the
    /// end of its segment; the time of the hit is relative to that segment.
    ///
    /// ```
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepOptions, example};
    /// let (scene, robot) = (example::two_arms(), RobotId(0));
    /// let mut start = SceneState::new(&scene);
    /// start.set_q(&scene, robot, &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, CheckerOptions::default());
    /// let over = [[-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6]];
    /// assert_eq!(checker.sweep_path(&start, robot, &over, &SweepOptions::default())?, None);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Checker::sweep`] for any of the waypoints, reported before any test.
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        robot: RobotId,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, SweepHit)>, SceneError> {
        self.all().sweep_path(start, robot, waypoints, options)
    }

    /// The present weights of all pairs: (a, b, weight), in the order of the hierarchy.
    pub fn weights(&self) -> impl Iterator<Item = (GeometryId, GeometryId, f64)> + '_ {
        let models = &self.core.scene.models;
        let all = self.lists.first().map_or(&[][..], |l| &l.pairs);
        all.iter().map(|p| (models[p.a as usize].id, models[p.b as usize].id, p.weight))
    }
}
