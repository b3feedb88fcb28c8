//! Sweeps between what is commanded now and what can be commanded next.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::impact::Steady;
use elbowroom_scene::{Member, Move, Scene, SweepOptions};

use crate::joint::JointLimit;
use crate::reflex::MOST_THREATS;
use crate::sense::Senses;
use crate::{Around, Seen, Threat};

/// What passes nearer than this, m, is not taken as free.
const GRAZE_M: f64 = 1e-3;

/// A velocity that is held for a while.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Joint values at its begin, rad or m.
    pub q: &'a [f64],
    /// Velocities, rad/s or m/s.
    pub qd: &'a [f64],
    /// Where it ends at the latest.
    pub limits: &'a [JointLimit],
    /// So long, s.
    pub seconds: f64,
}

/// What a robot and its neighbours run through.
#[derive(Debug)]
pub struct Proof {
    /// Per robot: where it ends.
    to: Vec<Vec<f64>>,
    /// Numbers of the threats that can close in time.
    near: Vec<usize>,
}

impl Proof {
    pub fn new(scene: &Scene) -> Self {
        let to = scene.robots().iter().map(|r| vec![0.0; r.robot.chain.dof()]).collect();
        Self { to, near: Vec::with_capacity(MOST_THREATS) }
    }

    /// When the course first meets any of the chosen threats, as a share of its time; all else that moves goes on as it
    /// does now. Only pairs that can close in that time are swept.
    pub fn first_hit(
        &mut self,
        senses: &mut Senses<'_>,
        course: &Course<'_>,
        around: &Around<'_>,
        chosen: impl Fn(&Threat) -> bool,
    ) -> Option<f64> {
        self.ends(senses.robot, course, around);
        let beyond =
            senses.left_off.iter().flatten().any(|t| chosen(t) && t.distance_m <= nearing(senses, course, around));
        let mut first = beyond.then_some(0.0);
        let reach = |t: &Threat, a: Member, b: Member| {
            let theirs = [a, b].map(|m| senses.coming(m, around, course.seconds));
            senses.levers[senses.robot].closing(t, course.qd, course.seconds) + theirs[0] + theirs[1]
        };
        self.near.clear();
        let pairs = senses.threats.iter().zip(&senses.members).enumerate();
        let near = pairs.filter(|(_, (t, (a, b)))| chosen(t) && t.distance_m <= reach(t, *a, *b));
        self.near.extend(near.map(|(n, _)| n));
        let Senses { robot, checker, state, threats, members, .. } = senses;
        let own = Move::Robot { robot: *robot, to: &self.to[*robot] };
        for &n in &self.near {
            let (threat, (a, b)) = (&threats[n], &members[n]);
            // A graze is a hit: what is free stays so by a hair's breadth, or by half of what there is.
            let clearance_m = GRAZE_M.min(0.5 * threat.distance_m);
            let options = SweepOptions { clearance_m, ..SweepOptions::default() };
            let mut pair = checker.between((*a).into(), (*b).into());
            let object = [*a, *b].into_iter().find_map(|m| seen(around, m));
            let path = object.map(|s| (s.object, Steady::from_motion(s.in_world, &s.motion, course.seconds)));
            let neighbour = [*a, *b].into_iter().find_map(|m| neighbour(around, m, *robot));
            let answer = match (&path, neighbour) {
                (Some((object, path)), _) => {
                    pair.sweep(state, &[own, Move::Object { object: *object, path }], &options)
                }
                (_, Some(other)) => {
                    pair.sweep(state, &[own, Move::Robot { robot: other, to: &self.to[other] }], &options)
                }
                _ => pair.sweep(state, &[own], &options),
            };
            // What cannot be checked is not done.
            let time = answer.map_or(Some(0.0), |hit| hit.map(|h| h.time));
            first = [first, time].into_iter().flatten().reduce(f64::min);
        }
        first
    }

    /// Where all robots are at the end.
    fn ends(&mut self, robot: usize, course: &Course<'_>, around: &Around<'_>) {
        for (j, to) in self.to[robot].iter_mut().enumerate() {
            *to = (course.q[j] + course.qd[j] * course.seconds).clamp(course.limits[j].lower, course.limits[j].upper);
        }
        for other in around.robots.iter().filter(|n| n.robot != robot) {
            for (to, (q, v)) in self.to[other.robot].iter_mut().zip(other.q.iter().zip(other.qd)) {
                *to = q + v * course.seconds;
            }
        }
    }
}

/// How far anything can come nearer at most, m.
fn nearing(senses: &Senses<'_>, course: &Course<'_>, around: &Around<'_>) -> f64 {
    let objects = around.objects.iter().map(|s| Member::Object(s.object));
    let robots = around.robots.iter().map(|n| Member::Link { robot: n.robot, link: LinkId(0) });
    let coming = objects.chain(robots).map(|m| senses.coming(m, around, course.seconds)).fold(0.0, f64::max);
    senses.levers[senses.robot].farthest(course.qd, course.seconds) + coming
}

fn seen<'a>(around: &'a Around<'_>, member: Member) -> Option<&'a Seen> {
    around.objects.iter().find(|s| Member::Object(s.object) == member)
}

/// The other robot that a member is a link of, where it says how it moves.
fn neighbour(around: &Around<'_>, member: Member, robot: usize) -> Option<usize> {
    let Member::Link { robot: other, .. } = member else { return None };
    (other != robot && around.robots.iter().any(|n| n.robot == other)).then_some(other)
}

#[cfg(test)]
mod tests {
    use elbowroom_scene::{SceneState, example};

    use super::*;
    use crate::Neighbour;

    /// The least distance between the two arms when both go straight on, from many looks.
    fn meets(scene: &Scene, q: [&[f64]; 2], qd: [&[f64]; 2], seconds: f64) -> bool {
        let mut checker = elbowroom_scene::Checker::new(scene, elbowroom_scene::Options::default());
        let mut state = SceneState::new(scene);
        (0..=400).any(|n| {
            let t = seconds * f64::from(n) / 400.0;
            for robot in 0..2 {
                let at: Vec<f64> = q[robot].iter().zip(qd[robot]).map(|(q, v)| q + v * t).collect();
                state.set_q(scene, robot, &at).unwrap();
            }
            let (one, other) = (elbowroom_scene::Selection::Robot(0), elbowroom_scene::Selection::Robot(1));
            checker.between(one, other).collides(&state).is_some()
        })
    }

    #[test]
    fn a_neighbour_is_swept_as_it_moves() {
        let scene = example::two_arms();
        let limits = JointLimit::of(&scene.robots()[0].robot.chain, 0.25, 0.1, 1.0);
        let (mut senses, mut proof) = (Senses::new(&scene, 0), Proof::new(&scene));
        let seconds = 0.3;
        let mut seed = 7_u64;
        let mut random = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)
        };
        let (mut hits, mut free, mut only_moving) = (0, 0, 0);
        for _ in 0..3_000 {
            // Both lean towards each other.
            let q = [1.0, -1.0].map(|lean| vec![random(-0.6, 0.6), lean * random(0.4, 1.5), lean * random(-0.2, 1.2)]);
            let qd: [Vec<f64>; 2] = std::array::from_fn(|_| (0..3).map(|_| random(-1.0, 1.0)).collect());
            let robots = [Neighbour { robot: 1, q: &q[1], qd: &qd[1], known: false }];
            let around = Around { objects: &[], robots: &robots };
            if senses.place(&q[0], &around).is_err() {
                continue;
            }
            senses.look(&around, 1.5, 0.0, 0.3);
            let other = |t: &Threat| matches!(t.other, crate::Other::Loose { .. }) && t.distance_m > 2.0 * GRAZE_M;
            let apart = senses.threats.iter().all(|t| t.distance_m > 2.0 * GRAZE_M);
            let inside = (0..3).all(|j| (limits[j].lower..limits[j].upper).contains(&(q[0][j] + qd[0][j] * seconds)));
            if !apart || !inside || senses.threats.is_empty() {
                continue;
            }
            let course = Course { q: &q[0], qd: &qd[0], limits: &limits, seconds };
            let told = proof.first_hit(&mut senses, &course, &around, other).is_some();
            let looked = meets(&scene, [&q[0], &q[1]], [&qd[0], &qd[1]], seconds);
            // What is told free is free; a graze may be told that looks do not see.
            assert!(told || !looked, "{q:?} {qd:?}");
            (hits, free) = (hits + usize::from(looked), free + usize::from(!told));
            only_moving += usize::from(looked && !meets(&scene, [&q[0], &q[1]], [&qd[0], &[0.0; 3]], seconds));
        }
        assert!(hits > 20 && free > 20 && only_moving > 5, "{hits} {free} {only_moving}");
    }
}
