//! Continuous collision check of a commanded motion.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::ccd::ConstantTwist;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Scene, SweepMove};

use crate::escape_work::EscapeWork;
use crate::proximity_query::ProximityQuery;
use crate::reactive_controller::MAX_PAIRS;
use crate::{DynamicObstacles, ObservedObject, ProximityPair};
use elbowroom_kinematics::JointLimits;

/// Security margin of the sweep, m.
const SECURITY_MARGIN_M: f64 = 1e-3;
/// Fraction of the escapes' work per tick that a sweep may use …
const SHARE_OF_WORK: f64 = 0.5;
/// … but at least this much, because otherwise the robot would brake on every motion off its path.
const LEAST_WORK: EscapeWork = EscapeWork::from_us(500);

/// A motion at constant joint velocities.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VelocitySegment<'a> {
    /// Joint values at the start, rad or m.
    pub(crate) q: &'a [f64],
    /// Joint velocities, rad/s or m/s.
    pub(crate) qd: &'a [f64],
    /// Position limits, at which the motion ends.
    pub(crate) limits: &'a [JointLimits],
    /// Duration, s.
    pub(crate) duration_s: f64,
}

/// The first hit of a command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CommandHit {
    /// Time of the hit as a fraction of the duration.
    pub(crate) time: f64,
    /// False if the work was used up first: then the rest of the motion was not checked.
    pub(crate) is_proven: bool,
}

/// Sweeps of a robot among other robots and dynamic obstacles.
#[derive(Debug)]
pub(crate) struct SweepCheck {
    /// Per robot, the configuration at the end.
    to: Vec<Vec<f64>>,
    /// Indices of the pairs that can close within the duration.
    near: Vec<usize>,
    /// Per pair, the geometries with which its geometries move: themselves, or the links of attached objects.
    carriers: Vec<[GeometryId; 2]>,
    /// Largest work of one sweep.
    work: EscapeWork,
}

impl SweepCheck {
    /// Creates the check for a search for escapes with this work per tick (µs). What a sweep has not proven within its
    /// fraction of the work counts as a hit.
    pub(crate) fn new(scene: &Scene, work_us: u32) -> Self {
        let work = EscapeWork::from_us(work_us).share(SHARE_OF_WORK).max(LEAST_WORK);
        let to = scene.robots().iter().map(|r| vec![0.0; r.robot.chain.dof()]).collect();
        Self { to, near: Vec::with_capacity(MAX_PAIRS), carriers: Vec::with_capacity(MAX_PAIRS), work }
    }

    /// Finds where the segment first hits one of the pairs accepted by `filter`. All dynamic obstacles continue their
    /// present motion. Only pairs that can close within the duration are swept.
    pub(crate) fn first_hit(
        &mut self,
        query: &mut ProximityQuery<'_>,
        segment: &VelocitySegment<'_>,
        obstacles: &DynamicObstacles<'_>,
        filter: impl Fn(&ProximityPair) -> bool,
    ) -> Option<CommandHit> {
        self.update_ends(query.robot, segment, obstacles);
        let excluded_may_close = query
            .excluded
            .iter()
            .flatten()
            .any(|p| filter(p) && p.distance_m <= max_closing_of_any(query, segment, obstacles));
        let (mut first, mut is_proven) = (excluded_may_close.then_some(0.0), true);
        let max_closing = |p: &ProximityPair, a: GeometryId, b: GeometryId| {
            let by_obstacle = [a, b].map(|m| query.max_approach(m, obstacles, segment.duration_s));
            query.own_motion_bounds().max_closing(p, segment.qd, segment.duration_s) + by_obstacle[0] + by_obstacle[1]
        };
        self.near.clear();
        let pairs = query.scene_pairs.iter().enumerate();
        let near = pairs.filter(|(_, p)| filter(&p.pair) && p.pair.distance_m <= max_closing(&p.pair, p.a, p.b));
        self.near.extend(near.map(|(n, _)| n));
        self.carriers.clear();
        self.carriers.extend(query.scene_pairs.iter().map(|p| [p.a, p.b].map(|m| query.carrier(m))));
        let ProximityQuery { robot, checker, state, scene_pairs, .. } = query;
        let own = SweepMove::Robot { robot: *robot, to: &self.to[robot.0] };
        let deadline = EscapeWork::of(&checker.stats(), 0).plus(self.work);
        for &n in &self.near {
            let near = &scene_pairs[n];
            let geometries = self.carriers[n];
            let clearance_m = SECURITY_MARGIN_M.min(0.5 * near.pair.distance_m);
            let left = deadline - EscapeWork::of(&checker.stats(), 0);
            let options = left.sweep_options(clearance_m);
            let mut pair = checker.between(near.a.into(), near.b.into());
            let object = geometries.into_iter().find_map(|m| observed(obstacles, m));
            let path =
                object.map(|o| (o.object, ConstantTwist::from_motion(o.in_world, &o.motion, segment.duration_s)));
            let neighbour = geometries.into_iter().find_map(|m| neighbour(obstacles, m, *robot));
            let result = match (&path, neighbour) {
                (Some((object, path)), _) => {
                    pair.sweep(state, &[own, SweepMove::Object { object: *object, path }], &options)
                }
                (_, Some(other)) => {
                    pair.sweep(state, &[own, SweepMove::Robot { robot: other, to: &self.to[other.0] }], &options)
                }
                _ => pair.sweep(state, &[own], &options),
            };
            // A motion that cannot be checked counts as a hit.
            is_proven &= !matches!(result, Ok(Some(hit)) if !hit.certain);
            let time = result.map_or(Some(0.0), |hit| hit.map(|h| h.time));
            first = [first, time].into_iter().flatten().reduce(f64::min);
        }
        first.map(|time| CommandHit { time, is_proven })
    }

    /// Updates the configurations of all robots at the end of the segment.
    fn update_ends(&mut self, robot: RobotId, segment: &VelocitySegment<'_>, obstacles: &DynamicObstacles<'_>) {
        for (j, to) in self.to[robot.0].iter_mut().enumerate() {
            let end = segment.q[j] + segment.qd[j] * segment.duration_s;
            *to = end.clamp(segment.limits[j].lower, segment.limits[j].upper);
        }
        for other in obstacles.robots.iter().filter(|n| n.robot != robot) {
            for (to, (q, v)) in self.to[other.robot.0].iter_mut().zip(other.q.iter().zip(other.qd)) {
                *to = q + v * segment.duration_s;
            }
        }
    }
}

/// Upper bound of the decrease of the distance of any pair, m.
fn max_closing_of_any(
    query: &ProximityQuery<'_>,
    segment: &VelocitySegment<'_>,
    obstacles: &DynamicObstacles<'_>,
) -> f64 {
    let objects = obstacles.objects.iter().map(|o| GeometryId::Object(o.object));
    let robots = obstacles.robots.iter().map(|n| GeometryId::Link { robot: n.robot, link: LinkId(0) });
    let approach = |m| query.max_approach(m, obstacles, segment.duration_s);
    let by_obstacle = objects.chain(robots).map(approach).fold(0.0, f64::max);
    query.own_motion_bounds().max_travel(segment.qd, segment.duration_s) + by_obstacle
}

fn observed<'a>(obstacles: &'a DynamicObstacles<'_>, geometry: GeometryId) -> Option<&'a ObservedObject> {
    obstacles.objects.iter().find(|o| GeometryId::Object(o.object) == geometry)
}

/// The other robot to which a geometry belongs, if this robot reports its motion.
fn neighbour(obstacles: &DynamicObstacles<'_>, geometry: GeometryId, robot: RobotId) -> Option<RobotId> {
    let GeometryId::Link { robot: other, .. } = geometry else { return None };
    (other != robot && obstacles.robots.iter().any(|n| n.robot == other)).then_some(other)
}

#[cfg(test)]
mod tests {
    use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection, example};
    use elbowroom_testkit::random::Random;

    use super::*;
    use crate::Neighbour;
    use crate::proximity_query::ProximityRange;

    /// True if a sample of the motion of both arms collides.
    fn collides(scene: &Scene, q: [&[f64]; 2], qd: [&[f64]; 2], duration_s: f64) -> bool {
        let mut checker = Checker::new(scene, CheckerOptions::default());
        let mut state = SceneState::new(scene);
        (0..=400).any(|n| {
            let t = duration_s * f64::from(n) / 400.0;
            for robot in 0..2 {
                let at: Vec<f64> = q[robot].iter().zip(qd[robot]).map(|(q, v)| q + v * t).collect();
                state.set_q(scene, RobotId(robot), &at).unwrap();
            }
            let (one, other) = (Selection::Robot(RobotId(0)), Selection::Robot(RobotId(1)));
            checker.between(one, other).collides(&state).is_some()
        })
    }

    #[test]
    fn the_sweep_includes_the_motion_of_a_neighbour() {
        let scene = example::two_arms();
        let limits = JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.25, 0.1, 1.0);
        let (mut query, mut check) = (ProximityQuery::new(&scene, RobotId(0)), SweepCheck::new(&scene, u32::MAX));
        let duration_s = 0.3;
        let mut random = Random(7);
        let (mut hits, mut free, mut only_moving) = (0, 0, 0);
        for _ in 0..3_000 {
            // Both arms lean towards each other.
            let q = [1.0, -1.0].map(|lean| {
                vec![random.between(-0.6, 0.6), lean * random.between(0.4, 1.5), lean * random.between(-0.2, 1.2)]
            });
            let qd: [Vec<f64>; 2] = std::array::from_fn(|_| (0..3).map(|_| random.between(-1.0, 1.0)).collect());
            let robots = [Neighbour { robot: RobotId(1), q: &q[1], qd: &qd[1], known: false }];
            let obstacles = DynamicObstacles { objects: &[], robots: &robots };
            if query.update_scene(&q[0], &obstacles).is_err() {
                continue;
            }
            query.find_pairs(&obstacles, ProximityRange { dynamic_m: 1.5, fixed_m: 0.0, ahead_s: 0.3 });
            let other = |p: &ProximityPair| p.obstacle.is_dynamic() && p.distance_m > 2.0 * SECURITY_MARGIN_M;
            let apart = query.pairs.iter().all(|p| p.distance_m > 2.0 * SECURITY_MARGIN_M);
            let inside =
                (0..3).all(|j| (limits[j].lower..limits[j].upper).contains(&(q[0][j] + qd[0][j] * duration_s)));
            if !apart || !inside || query.pairs.is_empty() {
                continue;
            }
            let segment = VelocitySegment { q: &q[0], qd: &qd[0], limits: &limits, duration_s };
            let found = check.first_hit(&mut query, &segment, &obstacles, other).is_some();
            let sampled = collides(&scene, [&q[0], &q[1]], [&qd[0], &qd[1]], duration_s);
            // A segment without a hit is free; a hit within the security margin may be missed by the samples.
            assert!(found || !sampled, "{q:?} {qd:?}");
            (hits, free) = (hits + usize::from(sampled), free + usize::from(!found));
            only_moving += usize::from(sampled && !collides(&scene, [&q[0], &q[1]], [&qd[0], &[0.0; 3]], duration_s));
        }
        assert!(hits > 20 && free > 20 && only_moving > 5, "{hits} {free} {only_moving}");
    }
}
