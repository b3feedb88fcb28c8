//! Searches of a robot for another path: their time, their knowledge, and whether another search could find more.

use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_monitor::{Monitor, SourceState};
use elbowroom_spatial::{Aabb, Pose};

use super::executed_motion::ExecutedMotion;
use super::perceived_obstacles::{PerceivedObstacle, PerceivedSolid};
use super::surroundings::Surroundings;

/// Change of a bounding box (m) up to which an obstacle counts as unmoved: noise of the outlines.
const NOISE_M: f64 = 0.01;
/// Largest duration of a search from rest, as a multiple of a search in motion.
const MAX_FACTOR: f64 = 8.0;
/// Change of the joint values (rad or m) up to which a robot counts as unmoved.
const SAME_Q: f64 = 1e-3;

/// The regions closed to a robot at one instant.
#[derive(Debug)]
pub struct ClosedRegions<'c> {
    /// The monitor of the robot.
    pub monitor: &'c Monitor,
    /// The sources that its regions follow, at that instant.
    pub sources: Vec<SourceState>,
}

impl<'c> ClosedRegions<'c> {
    /// The constraint of paths that keep this fraction of each warning zone.
    pub(super) fn constraint(&self, warning_share: f64) -> Option<RegionConstraint<'c>> {
        RegionConstraint::new(self.monitor, &self.sources, warning_share, 0.0)
    }

    /// Whether all regions are open.
    pub(super) fn are_none(&self) -> bool {
        self.constraint(0.0).is_none()
    }
}

/// A requested search. Its result counts from `due_s` on, and is based on what had been seen when the search began.
#[derive(Debug)]
pub(super) struct PathSearch {
    /// End of the search, s.
    pub due_s: f64,
    /// How long it may take, s.
    pub takes_s: f64,
    /// How long the robot goes on meanwhile, s.
    pub lead_s: f64,
    /// Obstacles that sensors had seen at its start.
    pub perceived: Vec<PerceivedObstacle>,
}

/// Everything that a search knows, and how long it may take: it can run on another thread.
#[derive(Debug)]
pub struct SearchRequest {
    /// The motion that another path replaces.
    pub motion: ExecutedMotion,
    pub(super) known: Surroundings,
    /// A solid per perceived obstacle.
    pub(super) solids: Vec<PerceivedSolid>,
    /// Time in the step (s) before which a moving robot must leave its path.
    pub(super) free_until_s: f64,
    /// How long the search may take, s.
    pub(super) takes_s: f64,
    /// How long the robot continues meanwhile, s.
    pub(super) lead_s: f64,
}

/// A search from rest that found no path.
#[derive(Debug)]
pub(super) struct FutileSearch {
    pub scene: SearchScene,
    /// Duration of the search, as a multiple of the usual one.
    pub factor: f64,
}

impl FutileSearch {
    /// Duration of the next search, as a multiple of the usual one: doubled in the same scene, because a robot at rest
    /// has time.
    ///
    /// `None` if that would be too long.
    pub fn longer_search(&self, now: &SearchScene) -> Option<f64> {
        if self.scene.is_like(now) { Some(2.0 * self.factor).filter(|f| *f <= MAX_FACTOR) } else { Some(1.0) }
    }
}

/// Everything that the result of a search from rest depends on: while it is unchanged, an equal search finds no more.
#[derive(Debug, Clone)]
pub(super) struct SearchScene {
    q: Vec<Vec<f64>>,
    objects: Vec<Pose>,
    obstacles: Vec<Aabb>,
    regions: Vec<String>,
    sources: Vec<Pose>,
}

impl SearchScene {
    pub fn of(surroundings: &Surroundings, regions: &ClosedRegions<'_>) -> Self {
        let solids = surroundings.perceived.iter().flat_map(|o| [&o.observed, &o.predicted]);
        Self {
            q: surroundings.states.iter().map(|s| s.q.clone()).collect(),
            objects: surroundings.objects.iter().map(|o| o.in_world).collect(),
            obstacles: solids.map(|solid| solid.shape.aabb(&Pose::IDENTITY)).collect(),
            regions: regions.constraint(0.0).map_or_else(Vec::new, |c| c.names()),
            sources: regions.sources.iter().map(|s| s.pose).collect(),
        }
    }

    /// Whether the scenes differ by noise only.
    fn is_like(&self, other: &Self) -> bool {
        let q = self.q.iter().flatten().zip(other.q.iter().flatten()).all(|(a, b)| (a - b).abs() <= SAME_Q);
        let is_near = |(a, b): (&Aabb, &Aabb)| {
            (a.min - b.min).abs().max_element() <= NOISE_M && (a.max - b.max).abs().max_element() <= NOISE_M
        };
        let obstacles = self.obstacles.len() == other.obstacles.len();
        let obstacles = obstacles && self.obstacles.iter().zip(&other.obstacles).all(is_near);
        let regions = self.regions == other.regions && self.sources == other.sources;
        q && obstacles && regions && self.objects == other.objects
    }
}
