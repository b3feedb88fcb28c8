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

/// Answers queries about states of one scene; each thread has its own.
///
/// It keeps warm starts (likely pairs, nearest triangles), which make the next answer faster, never different. Queries do not
/// allocate, except the first one about a [selection](Checker::between) and the first one after an object was attached or
/// detached.
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
    /// Made at the first sweep.
    sweeper: Option<Box<Sweeper>>,
}

impl<'s> Checker<'s> {
    /// A checker of a scene, ready for queries about all pairs.
    pub fn new(scene: &'s Scene, options: CheckerOptions) -> Self {
        let core = CheckerCore::new(scene, options);
        // Models that are built at first use are built now.
        scene.models.iter().for_each(|m| _ = m.at(options.level));
        let mut checker = Self { core, lists: Vec::new(), sweeper: None };
        checker.all().update(&SceneState::new(scene));
        checker
    }

    /// The scene it was made for.
    pub fn scene(&self) -> &'s Scene {
        self.core.scene
    }

    /// Its settings.
    pub fn options(&self) -> CheckerOptions {
        self.core.options
    }

    /// Statistics of its queries so far.
    pub fn stats(&self) -> CheckerStats {
        self.core.narrow.stats
    }

    /// Sets the statistics to zero.
    pub fn reset_stats(&mut self) {
        self.core.narrow.stats = CheckerStats::default();
    }

    /// The finest level that the last query needed.
    pub fn last_level(&self) -> Level {
        self.core.finest
    }

    /// Queries about pairs with one geometry in each selection. Equal selections: the pairs within, as the self-collision of a
    /// robot. Pairs excluded by rule stay excluded, even where both are named; two objects, which are no pair otherwise, are
    /// one where only objects are named.
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

    /// A pair in contact (not farther apart than its margin), or `None` if there is none.
    pub fn collides(&mut self, state: &SceneState) -> Option<PairContact> {
        self.all().collides(state)
    }

    /// Every pair in contact, in the order of the hierarchy.
    pub fn contacts(&mut self, state: &SceneState, found: impl FnMut(PairContact)) {
        self.all().contacts(state, found);
    }

    /// A pair not farther apart than `tolerance_m` beyond its margin. Values below 0 count as 0, NaN as infinite.
    pub fn within(&mut self, state: &SceneState, tolerance_m: f64) -> Option<PairContact> {
        self.all().within(state, tolerance_m)
    }

    /// The nearest pair with its distance and witness points; `None` if there is no pair at all.
    pub fn distance(&mut self, state: &SceneState) -> Option<PairDistance> {
        self.all().distance(state)
    }

    /// The collision point: the point, the link, the collider and its triangle, and the normals. Of several collisions it
    /// is that of the pair first in the order of the hierarchy: the link nearest to a base. `None` if nothing collides,
    /// margins included.
    ///
    /// [`Detail::Boxes`] stops at a depth of the box trees of the meshes: "nothing collides" is certain then, a collision may be
    /// none, and the point is a point of the surface in the box. [`Detail::Exact`] goes on to the triangles; which of several
    /// touching triangles is reported is specified in [`contact`](elbowroom_proximity::contact), the same on every instruction
    /// set. Compares the exact models, whatever [`CheckerOptions::level`] is. Allocates only for hulls.
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

    /// Every pair that is not certainly farther apart than `margin_m` beyond its own margin, with distance, proven lower bound
    /// and witness points, in the order of the hierarchy (nearest to a base first). A pair in contact has distance 0 and a point
    /// in or near both. Reports a pair exactly where [`Checker::within`] would find one; values below 0 count as 0, NaN
    /// as infinite. [`Level::L1`] is answered at [`Level::L2`].
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

    /// The pairs that are near or may soon meet at the present velocities, each with its time to collision, in the order of the
    /// hierarchy: progressive level of detail (Reichenbach and Kovačić 2003). Distant pairs are compared by one box each,
    /// approaching ones deeper in the box trees of their meshes, near and fast ones exactly, as `policy` says.
    /// `horizon_s` limits [`ApproachingPair::earliest_s`].
    ///
    /// Guaranteed for every policy: a pair nearer than `exact_m`, or not proven to be apart for `exact_s`, is measured
    /// exactly, contact included; a pair reported coarsely is farther; and a pair that is not reported is farther than
    /// `within_m` and does not meet within `exact_s`. NaN speeds and distances count as near and soon. Compares the exact
    /// models, whatever [`CheckerOptions::level`] is.
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

    /// Continuous collision detection: the first time at which a pair is nearer than its margin during a motion, or `None`
    /// where no pair is during all of it. Proven, not sampled, so that nothing thin is passed through. What is not in `moves`
    /// keeps its pose of `start`. Pairs excluded by rule (adjacent links, SRDF, by hand) never count; a link that no joint moves
    /// counts against an object on a path of its own, objects among themselves only where only objects are
    /// [named](Checker::between).
    ///
    /// The first sweep allocates, and later ones where they are longer than any before. [`Level::L1`] is answered at
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
    /// As [`SceneState::set_q`] and [`SceneState::place`], for the end of the motion; a robot or object that moves twice.
    pub fn sweep(
        &mut self,
        start: &SceneState,
        moves: &[SweepMove],
        options: &SweepOptions,
    ) -> Result<Option<SweepHit>, SceneError> {
        self.all().sweep(start, moves, options)
    }

    /// [`Checker::sweep`] of one robot through waypoints (joint values, rad or m), straight in joint space from each to the
    /// next. The first waypoint is either the configuration in `start` or the end of the first segment. Returns the hit with the
    /// index of the waypoint at the end of its segment; its time is that of the segment.
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
    /// As [`Checker::sweep`], for any of the waypoints, before anything is tested.
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
