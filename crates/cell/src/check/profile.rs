//! How fast the guarded parts of a robot go in its program, and how soon they can stop.

use std::collections::HashSet;
use std::rc::Rc;

use elbowroom_formats::FormatError;
use elbowroom_kinematics::{ChainState, LinkId};

use super::outline::Outline;
use crate::motion::{Geometry, Plan, PlanStep, Point, plan};
use crate::{Cell, JointLimits};

/// A program is looked at in steps of this time (s), or finer.
const STEP_S: f64 = 0.004;
/// Fewest and most looks at one move.
const LOOKS: [f64; 2] = [32.0, 20_000.0];
/// The share of a joint's deceleration that is left for a stop where following a curve takes all of it: as in the simulation.
const RESERVE: f64 = 0.1;

/// A solid or a point that moves with a link.
#[derive(Debug, Clone)]
pub(super) struct Rider {
    pub link: LinkId,
    /// Its outline in the link's frame.
    pub outline: Outline,
}

/// What a program does to one rider.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pace {
    /// Largest speed of any of its points, the programmed override in it, m/s.
    pub fastest_m_s: f64,
    /// Longest way of any of its points from the first deceleration to rest, m: v²/2a.
    pub braking_m: f64,
    /// By how much more than that it needs because the override may not fall as fast as the robot could brake, m.
    pub late_m: f64,
}

/// What a robot's program does.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Joint values at the beginning, rad or m.
    pub start: Vec<f64>,
    /// One per rider.
    pub paces: Vec<Pace>,
    /// Longest time from the first deceleration to rest, s.
    pub braking_s: f64,
}

impl Profile {
    /// Looks at the program of a robot (by index) in small steps.
    ///
    /// # Errors
    /// [`FormatError`] at the line of a step that cannot be done.
    pub fn of(cell: &Cell, robot: usize, riders: &[Rider]) -> Result<Self, FormatError> {
        let plan = plan(cell, robot, 1, &mut Vec::new())?;
        let mut profile =
            Self { start: plan.start.clone(), paces: vec![Pace::default(); riders.len()], braking_s: 0.0 };
        let chain = &cell.robots[robot].robot.chain;
        let mut look = Look {
            limits: &cell.robots[robot].limits,
            riders,
            chain,
            state: ChainState::new(chain),
            falls_at_most: cell.laws.laws.override_rate,
        };
        each_move(&plan, |point, programmed, straight| look.at(point, programmed, straight, &mut profile));
        Ok(profile)
    }
}

/// Shows every move of a plan at many instants, at override 1: the point, the programmed override, and whether the joints go
/// straight. What is repeated is shown once.
fn each_move(plan: &Plan, mut show: impl FnMut(&Point, f64, bool)) {
    let mut programmed = plan.speed_override;
    let mut seen = HashSet::new();
    for step in &plan.steps {
        match step {
            PlanStep::Override(o) => programmed = *o,
            PlanStep::Move(m) if seen.insert((Rc::as_ptr(m).cast::<()>(), programmed.to_bits())) => {
                let straight = matches!(m.geometry(), Geometry::Joint { .. });
                instants(m.duration()).for_each(|t| show(&m.at(t), programmed, straight));
            }
            PlanStep::Play(p) if seen.insert((Rc::as_ptr(p).cast::<()>(), programmed.to_bits())) => {
                instants(p.duration()).for_each(|t| show(&p.at(t), programmed, false));
            }
            _ => {}
        }
    }
}

fn instants(duration_s: f64) -> impl Iterator<Item = f64> {
    let count = (duration_s / STEP_S).ceil().clamp(LOOKS[0], LOOKS[1]) as usize;
    (0..=count).map(move |i| duration_s * i as f64 / count as f64)
}

struct Look<'a> {
    limits: &'a [JointLimits],
    riders: &'a [Rider],
    chain: &'a elbowroom_kinematics::Chain,
    state: ChainState,
    /// Largest change of the override per second; 0 for none.
    falls_at_most: f64,
}

impl Look<'_> {
    fn at(&mut self, point: &Point, programmed: f64, straight: bool, profile: &mut Profile) {
        let able = fall(&point.first, (!straight).then_some(&point.second), programmed, self.limits);
        if !able.is_finite() {
            return; // nothing moves
        }
        let allowed = if self.falls_at_most > 0.0 { able.min(self.falls_at_most) } else { able };
        profile.braking_s = profile.braking_s.max(programmed / allowed);
        self.state.q.copy_from_slice(&point.q);
        self.state.qd.copy_from_slice(&point.first);
        self.chain.forward_motion(&mut self.state);
        for (rider, pace) in self.riders.iter().zip(&mut profile.paces) {
            let frame = self.state.link_in_root(rider.link);
            let speed = rider.outline.fastest(&frame, &self.state.link_motion(rider.link));
            // The override falls from the programmed one to 0: half of that on average.
            let way = |rate: f64| speed * programmed * programmed / (2.0 * rate);
            pace.fastest_m_s = pace.fastest_m_s.max(speed * programmed);
            pace.braking_m = pace.braking_m.max(way(allowed));
            pace.late_m = pace.late_m.max(way(allowed) - way(able));
        }
    }
}

/// How fast the override can fall without asking more of a joint than its stopping deceleration, 1/s; infinite where nothing
/// moves.
///
/// With joints in units of their deceleration, `u = q′/a` and `w = q″/a`: the part of `w` along `u` is the program's own time
/// law, which a stop takes the place of; the rest of it keeps the robot on its curve and is not left for the stop.
fn fall(first: &[f64], second: Option<&Vec<f64>>, programmed: f64, limits: &[JointLimits]) -> f64 {
    let u: Vec<f64> = first.iter().zip(limits).map(|(v, l)| v / l.stop).collect();
    let square: f64 = u.iter().map(|x| x * x).sum();
    if square < 1e-18 {
        return f64::INFINITY;
    }
    let w = |j: usize| second.map_or(0.0, |s| s[j] / limits[j].stop);
    let along = (0..u.len()).map(|j| u[j] * w(j)).sum::<f64>() / square;
    let left = |j: usize| (1.0 - (w(j) - along * u[j]).abs() * programmed * programmed).max(RESERVE);
    (0..u.len()).filter(|j| u[*j] != 0.0).map(|j| left(j) / u[j].abs()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINT: JointLimits = JointLimits { velocity: 2.0, acceleration: 8.0, jerk: 80.0, stop: 4.0 };

    #[test]
    fn a_straight_joint_stops_by_its_own_deceleration() {
        assert_eq!(fall(&[2.0], None, 1.0, &[JOINT]), 2.0);
        // The program's own acceleration gives way to the stop.
        assert_eq!(fall(&[2.0], Some(&vec![-3.0]), 1.0, &[JOINT]), 2.0);
        assert_eq!(fall(&[0.0], None, 1.0, &[JOINT]), f64::INFINITY);
    }

    #[test]
    fn a_curve_leaves_less() {
        let two = [JOINT, JOINT];
        // Joint 2 turns the path: half of its deceleration is spent on that, but it moves by itself only a little.
        let bent = fall(&[2.0, 0.5], Some(&vec![-0.5, 2.0]), 1.0, &two);
        assert!(bent < fall(&[2.0, 0.5], None, 1.0, &two), "{bent}");
        // At half the programmed override the curve takes a quarter.
        assert!(fall(&[2.0, 0.5], Some(&vec![-0.5, 2.0]), 0.5, &two) > bent);
    }
}
