//! Questions about a state of a scene.

mod answer;
mod approach;
mod between;
mod collision;
mod first;
mod list;
pub(crate) mod narrow;
mod near;
mod nearest;

pub use answer::{CollisionPoint, Contact, Distance};
pub use between::Between;

use elbowroom_proximity::contact::Detail;
use elbowroom_spatial::Motion;

use crate::sweep::Sweeper;
use crate::{
    Approach, Counts, Impact, Level, LevelOfDetail, Member, Move, Scene, SceneError, SceneMotion, SceneState,
    Selection, SweepOptions,
};
pub(crate) use list::{Pair, PairList};
use narrow::Narrow;

/// How questions are answered. None of these but [`Options::level`] changes an answer; at levels of enclosing volumes the
/// matrix, which knows more than they do, makes it more exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// How closely solids are looked at.
    pub level: Level,
    /// Where [`Level::Auto`] begins: [`Level::L1`], [`Level::L2`], or [`Level::L3`], which is to look at nothing but the
    /// exact geometry.
    pub start: Level,
    /// Whether the likeliest pairs are looked at first, by kinematics and by what was found before. Without, the order
    /// is that of the hierarchy: of several contacts, the one nearest to a base is told.
    pub weights: bool,
    /// Whether pairs that the matrix knows to be out of reach are passed over. Pairs that are none by rule (neighbours,
    /// SRDF, by hand) never count.
    pub matrix: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: Level::Auto, start: Level::L1, weights: true, matrix: true }
    }
}

/// Answers questions about states of one scene; each thread has its own.
///
/// It remembers what it found (likely pairs, nearest triangles), which makes the next answer faster, never different.
/// Questions do not allocate, except the first about a [selection](Checker::between) and the first after something
/// was attached or detached.
///
/// ```
/// use elbowroom_scene::{Checker, Options, SceneState, Selection, example};
/// let scene = example::two_arms();
/// let mut state = SceneState::new(&scene);
/// let mut checker = Checker::new(&scene, Options::default());
/// assert!(checker.collides(&state).is_none());
/// let nearest = checker.distance(&state).unwrap();
/// assert!(nearest.lower_bound <= nearest.metres && checker.within(&state, nearest.metres + 1e-6).is_some());
/// let upright = checker.between(Selection::Robot(0), Selection::Robot(1)).distance(&state).unwrap();
/// state.set_q(&scene, 0, &[0.0, 0.7, 0.0])?; // leans over to the other arm
/// let leaning = checker.between(Selection::Robot(0), Selection::Robot(1)).distance(&state).unwrap();
/// assert!(leaning.metres < upright.metres);
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Checker<'s> {
    core: Core<'s>,
    lists: Vec<PairList>,
    /// Made when first asked.
    sweeper: Option<Box<Sweeper>>,
}

/// All but the pair lists.
#[derive(Debug)]
pub(crate) struct Core<'s> {
    pub scene: &'s Scene,
    pub options: Options,
    pub narrow: Narrow,
    candidates: Vec<Candidate>,
    /// Per model: how it moves, and a speed (m/s) that none of its points exceeds. Memory of one question.
    moving: Vec<(Motion, f64)>,
    /// The nearest pair is no farther, metres.
    guessed: f64,
    /// The finest level that the present answer has needed.
    pub deepest: Level,
}

/// A pair that is still in question.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// What it is sorted by: small first.
    key: f64,
    rank: u32,
    index: u32,
}

impl<'s> Checker<'s> {
    /// For a scene, ready for questions about everything.
    pub fn new(scene: &'s Scene, options: Options) -> Self {
        let narrow = Narrow::new(scene);
        // Models that are made when first asked for are asked for now.
        scene.models.iter().for_each(|m| _ = m.at(options.level));
        let (candidates, moving) = (Vec::new(), Vec::with_capacity(scene.models.len()));
        let core = Core { scene, options, narrow, candidates, moving, guessed: f64::INFINITY, deepest: Level::L1 };
        let mut checker = Self { core, lists: Vec::new(), sweeper: None };
        checker.between(Selection::All, Selection::All).fresh(&SceneState::new(scene));
        checker
    }

    /// The scene it was made for.
    pub fn scene(&self) -> &'s Scene {
        self.core.scene
    }

    /// How it answers.
    pub fn options(&self) -> Options {
        self.core.options
    }

    /// What it has done so far.
    pub fn counts(&self) -> Counts {
        self.core.narrow.counts
    }

    /// Counts from zero again.
    pub fn reset_counts(&mut self) {
        self.core.narrow.counts = Counts::default();
    }

    /// The finest level that the last answer needed.
    pub fn last_level(&self) -> Level {
        self.core.deepest
    }

    /// Questions about pairs with one member in each selection. Equal selections: the pairs within, as a robot's
    /// self-collision. Pairs that are none by rule stay none, even where both are named; two objects, which are no pair
    /// otherwise, are one where nothing but objects is named.
    ///
    /// ```
    /// use elbowroom_kinematics::LinkId;
    /// use elbowroom_scene::{Checker, Options, SceneState, Selection, example};
    /// let scene = example::two_arms();
    /// let state = SceneState::new(&scene);
    /// let mut checker = Checker::new(&scene, Options::default());
    /// let hand = Selection::Link { robot: 0, link: LinkId(3) };
    /// assert!(checker.between(hand, Selection::Objects).distance(&state).unwrap().metres > 0.0);
    /// assert!(checker.between(Selection::Robot(0), Selection::Robot(0)).collides(&state).is_none());
    /// let (part, table) = (Selection::Object(0), Selection::Object(1));
    /// assert!(checker.between(part, table).within(&state, 0.01).is_some());
    /// ```
    pub fn between(&mut self, one: Selection, other: Selection) -> Between<'_, 's> {
        let key = (one, other);
        let list = self.lists.iter().position(|l| l.key == key).unwrap_or_else(|| {
            self.lists.push(PairList::new(key));
            self.lists.len() - 1
        });
        Between { checker: self, list }
    }

    /// A pair that is in contact (not farther apart than its margin), or `None` where there is none.
    pub fn collides(&mut self, state: &SceneState) -> Option<Contact> {
        self.between(Selection::All, Selection::All).collides(state)
    }

    /// Tells every pair in contact, in the order of the hierarchy.
    pub fn contacts(&mut self, state: &SceneState, found: impl FnMut(Contact)) {
        self.between(Selection::All, Selection::All).contacts(state, found);
    }

    /// A pair that is not farther apart than `tolerance_m` beyond its margin. Less than 0 counts as 0, NaN as infinite.
    pub fn within(&mut self, state: &SceneState, tolerance_m: f64) -> Option<Contact> {
        self.between(Selection::All, Selection::All).within(state, tolerance_m)
    }

    /// The nearest pair; `None` where there is no pair at all.
    pub fn distance(&mut self, state: &SceneState) -> Option<Distance> {
        self.between(Selection::All, Selection::All).distance(state)
    }

    /// Where the robot collides: the point, the link, the body and its triangle, and the normals (S4). Of several
    /// collisions it is that of the pair first in the order of the hierarchy: the link nearest to a base. `None` where
    /// nothing collides, margins included.
    ///
    /// [`Detail::Boxes`] stops at a depth of the meshes' trees of boxes: "nothing collides" is certain then, a
    /// collision may be none, and the point is a point of the surface in the box. [`Detail::Exact`] goes on to the triangles;
    /// which of those that touch is told is laid down in [`contact`](elbowroom_proximity::contact), alike on every
    /// instruction set. Solids are looked at, whatever [`Options::level`] says. Allocates only for hulls.
    ///
    /// ```
    /// use elbowroom_proximity::contact::Detail;
    /// use elbowroom_scene::{Checker, Options, SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// let mut checker = Checker::new(&scene, Options::default());
    /// assert!(checker.collision(&state, Detail::Exact).is_none());
    /// state.set_q(&scene, 0, &[0.0, 1.57, 0.0])?;
    /// let met = checker.collision(&state, Detail::Exact).expect("the arm lies in the part and the table");
    /// assert_eq!([met.link, met.other].map(|m| scene.name(m)), ["left/forearm", "part"]);
    /// assert!(met.touching && met.on_link.distance(met.on_other) < 0.1);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn collision(&mut self, state: &SceneState, detail: Detail) -> Option<CollisionPoint> {
        self.between(Selection::All, Selection::All).collision(state, detail)
    }

    /// Tells every pair that is not certainly farther apart than `margin_m` beyond its own margin: distance, proven lower
    /// bound, nearest points; in the order of the hierarchy (nearest to a base first). What is in contact has distance 0
    /// and a point in or near both. Work ends where a pair is proven to be farther. A pair is told exactly where
    /// [`Checker::within`] would tell one; less than 0 counts as 0, NaN as infinite. [`Level::L1`] is answered at
    /// [`Level::L2`].
    ///
    /// ```
    /// use elbowroom_scene::{Checker, Options, SceneState, Selection, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, 0, &[0.0, 1.2, 0.3])?;
    /// let mut checker = Checker::new(&scene, Options::default());
    /// let mut near = Vec::new();
    /// checker.between(Selection::Robots, Selection::Objects).near(&state, 0.15, |pair| near.push(pair));
    /// let names: Vec<_> = near.iter().map(|d| [scene.name(d.a), scene.name(d.b)].join(" - ")).collect();
    /// assert_eq!(names, ["left/upper_arm - part", "left/upper_arm - table", "left/forearm - part"]);
    /// assert!(near.iter().all(|d| d.lower_bound <= d.metres && d.metres <= 0.15));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn near(&mut self, state: &SceneState, margin_m: f64, found: impl FnMut(Distance)) {
        self.between(Selection::All, Selection::All).near(state, margin_m, found);
    }

    /// Tells the pairs that are near or that may soon meet as everything moves now, each with its time to collision, in
    /// the order of the hierarchy: progressive level of detail (S4). Far pairs are looked at by one box each, approaching ones
    /// deeper in the trees of boxes of their meshes, near and fast ones exactly; `policy` says which. `horizon_s` is how
    /// far ahead [`Approach::earliest_s`] is proven.
    ///
    /// Guaranteed, whatever the policy: what is nearer than `exact_m`, or is not proven to be apart for `exact_s`, is
    /// measured exactly, contact included; what is told coarsely is farther, and a pair that is not told is farther than
    /// `within_m` and does not meet within `exact_s`. A speed or a distance that is not a number is near and soon. Solids
    /// are looked at, whatever [`Options::level`] says.
    ///
    /// ```
    /// use elbowroom_scene::{Approach, Checker, LevelOfDetail, Options, SceneMotion, SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, 0, &[0.0, 0.9, 0.3])?;
    /// let mut motion = SceneMotion::new(&scene);
    /// motion.set_qd(&scene, &state, 0, &[0.0, 0.5, 0.0])?; // goes down to the part
    /// let mut checker = Checker::new(&scene, Options::default());
    /// let mut soonest = None;
    /// checker.approaching(&state, &motion, &LevelOfDetail::default(), 2.0, |p| {
    ///     if soonest.is_none_or(|s: Approach| p.estimate_s < s.estimate_s) {
    ///         soonest = Some(p);
    ///     }
    /// });
    /// let soonest = soonest.expect("it comes near the part");
    /// assert_eq!([soonest.a, soonest.b].map(|m| scene.name(m)), ["left/forearm", "part"]);
    /// assert!(soonest.earliest_s > 0.0 && soonest.earliest_s <= soonest.estimate_s);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    pub fn approaching(
        &mut self,
        state: &SceneState,
        motion: &SceneMotion,
        policy: &LevelOfDetail,
        horizon_s: f64,
        found: impl FnMut(Approach),
    ) {
        self.between(Selection::All, Selection::All).approaching(state, motion, policy, horizon_s, found);
    }

    /// The first time that a pair is nearer than its margin while things move, or `None` where nothing is during all of
    /// the motion: proven, not sampled, so that no thin plate is jumped over. What is not in `moves` stands where `start`
    /// has it. Pairs that are none by rule (neighbours, SRDF, by hand) never count; a link that no joint moves counts
    /// against an object that moves by itself, objects among themselves only where nothing but objects is
    /// [named](Checker::between).
    ///
    /// The first sweep takes memory, and later ones where they are longer than any before. [`Level::L1`] is answered at
    /// [`Level::L2`].
    ///
    /// ```
    /// use elbowroom_proximity::impact::Steady;
    /// use elbowroom_scene::{Checker, Move, Options, SceneState, SweepOptions, example};
    /// use elbowroom_spatial::Vec3;
    /// let scene = example::two_arms();
    /// let mut start = SceneState::new(&scene);
    /// start.set_q(&scene, 0, &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, Options::default());
    /// // Across the part on the table: both ends are free, the way is not.
    /// let across = [Move::Robot { robot: 0, to: &[0.9, 1.3, 0.6] }];
    /// let hit = checker.sweep(&start, &across, &SweepOptions::default())?.expect("in the way");
    /// assert_eq!((scene.name(hit.a), scene.name(hit.b)), ("left/forearm".into(), "part".into()));
    /// assert!(hit.certain && hit.metres <= 1e-4);
    /// // The part comes along by itself.
    /// let part = scene.objects()[0].in_world;
    /// let path = Steady::linear(part, Vec3::X * -0.6);
    /// let hit = checker.sweep(&start, &[Move::Object { object: 0, path: &path }], &SweepOptions::default())?;
    /// assert!(hit.is_some_and(|h| h.time > 0.3));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`SceneState::set_q`] and [`SceneState::place`], for the end of the motion; something that moves twice.
    pub fn sweep(
        &mut self,
        start: &SceneState,
        moves: &[Move],
        options: &SweepOptions,
    ) -> Result<Option<Impact>, SceneError> {
        self.between(Selection::All, Selection::All).sweep(start, moves, options)
    }

    /// [`Checker::sweep`] of one robot through waypoints (joint values, rad or m), straight in joint space from each to
    /// the next; the first is where `start` has the robot already or the end of the first segment. With the impact
    /// comes the index of the waypoint that was being gone to; its time is that of the segment.
    ///
    /// ```
    /// use elbowroom_scene::{Checker, Options, SceneState, SweepOptions, example};
    /// let scene = example::two_arms();
    /// let mut start = SceneState::new(&scene);
    /// start.set_q(&scene, 0, &[-0.9, 1.3, 0.6])?;
    /// let mut checker = Checker::new(&scene, Options::default());
    /// let over = [[-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6]];
    /// assert_eq!(checker.sweep_path(&start, 0, &over, &SweepOptions::default())?, None);
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Checker::sweep`], for any of the waypoints, before anything is looked at.
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        robot: usize,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, Impact)>, SceneError> {
        self.between(Selection::All, Selection::All).sweep_path(start, robot, waypoints, options)
    }

    /// The weights as they are now, of the pairs of everything: (a, b, weight), in the order of the hierarchy.
    pub fn weights(&self) -> impl Iterator<Item = (Member, Member, f64)> + '_ {
        let models = &self.core.scene.models;
        let all = self.lists.first().map_or(&[][..], |l| &l.pairs);
        all.iter().map(|p| (models[p.a as usize].member, models[p.b as usize].member, p.weight))
    }
}
