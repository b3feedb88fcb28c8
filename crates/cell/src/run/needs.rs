//! Which exchange regions a program needs without leaving them all between: worked out before anything moves, and told
//! to the board while the program runs, so that it grants in an order in which everybody can finish.

use std::rc::Rc;

use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Board, Kind, Region, RobotSlot, SlotId, Volume};
use elbowroom_proximity::within;
use elbowroom_spatial::{Aabb, Pose};

use super::regions::levers;
use crate::configure::Setup;
use crate::motion::{Clock, Plan, PlanStep, Playback, Segment};

/// Programs are looked at in steps of this program time, s.
const STEP_S: f64 = 0.01;
/// Moves and recordings that take longer are looked at in as many steps; the motion within a step is allowed for.
const MOST_STEPS: f64 = 20_000.0;
/// Added to warning zones and their hysteresis, m: rounding never makes a zone smaller than the monitor's.
const MARGIN_M: f64 = 1e-3;

/// From this time on (s, at override 1) in the zones of these slots.
type Spans = Vec<(f64, u64)>;

/// What a robot may still need, along its program.
#[derive(Debug)]
pub(super) struct Needs {
    robot: RobotSlot,
    /// In the order of the program: from this step and time in it (s, at override 1) on, these slots, one bit each.
    stages: Vec<(usize, f64, u64)>,
    declared: Option<u64>,
}

impl Needs {
    /// Of a plan; `None` where there is nothing to put in order, or regions move.
    pub fn of_plan(robot: usize, setup: &Setup, plan: &Plan, board: &Board) -> Option<Self> {
        let fixed = |r: &Region| r.follow.is_none();
        let exchanged = |r: &&Region| matches!(r.kind, Kind::Exchange { .. });
        let regions = setup.configuration.regions();
        if board.slots() < 2 || board.slots() > 63 || !regions.iter().filter(exchanged).all(fixed) {
            return None;
        }
        let mut near = Near::new(setup);
        let mut occupied: Vec<(usize, f64, u64)> = Vec::new();
        let mut here = near.slots(&plan.start, 0.0);
        let mut known: Vec<((*const (), u64), Spans, u64)> = Vec::new();
        for (step, what) in plan.steps.iter().enumerate() {
            let (key, duration): (*const (), f64) = match what {
                PlanStep::Move(m) => (Rc::as_ptr(m).cast(), m.duration()),
                PlanStep::Play(p) => (Rc::as_ptr(p).cast(), p.duration()),
                _ => {
                    occupied.push((step, 0.0, here));
                    continue;
                }
            };
            let index = known.iter().position(|k| k.0 == (key, here)).unwrap_or_else(|| {
                let (spans, end) = near.along(duration, here, &|t| at(what, t));
                known.push(((key, here), spans, end));
                known.len() - 1
            });
            let (_, spans, end) = &known[index];
            occupied.extend(spans.iter().map(|(t, slots)| (step, *t, *slots)));
            here = *end;
        }
        occupied.push((plan.steps.len(), 0.0, here));
        Some(Self { robot: RobotSlot(robot), stages: rest_of_stretches(occupied), declared: None })
    }

    /// Declares what the program needs from where its clock is.
    pub fn declare(&mut self, clock: &Clock, board: &Board) {
        let (step, time) = clock.place();
        let next = self.stages.partition_point(|s| (s.0, s.1) <= (step, time));
        let slots = next.checked_sub(1).map_or(0, |i| self.stages[i].2);
        if self.declared != Some(slots) {
            self.declared = Some(slots);
            board.declare(self.robot, (0..board.slots()).filter(|s| slots >> s & 1 == 1).map(SlotId));
        }
    }
}

fn at(step: &PlanStep, t: f64) -> Vec<f64> {
    let of_move = |m: &Segment| m.at(t).q;
    let of_recording = |p: &Playback| p.q(t);
    match step {
        PlanStep::Move(m) => of_move(m),
        PlanStep::Play(p) => of_recording(p),
        _ => Vec::new(),
    }
}

/// From the slots whose zones the robot is in to those that it may need before it next is in none. Where it is in none,
/// those of the next stretch: they are declared before it comes to them.
fn rest_of_stretches(mut stages: Vec<(usize, f64, u64)>) -> Vec<(usize, f64, u64)> {
    let (mut rest, mut stretch_begins) = (0, true);
    for stage in stages.iter_mut().rev() {
        if stage.2 == 0 {
            stretch_begins = true;
        } else {
            rest = if stretch_begins { stage.2 } else { rest | stage.2 };
            stretch_begins = false;
        }
        stage.2 = rest;
    }
    stages.dedup_by(|later, earlier| later.2 == earlier.2);
    stages
}

/// Tells which warning zones a configuration is in.
struct Near<'a> {
    setup: &'a Setup,
    state: ChainState,
    levers: Vec<(usize, f64)>,
    /// Slot, region and where it stands.
    regions: Vec<(SlotId, &'a Region, Pose, Aabb)>,
}

impl<'a> Near<'a> {
    fn new(setup: &'a Setup) -> Self {
        let place = |r: &'a Region| {
            let Kind::Exchange { slot } = r.kind else { return None };
            let pose = r.anchor * r.shape_in_anchor;
            Some((slot, r, pose, r.shape.aabb(&pose)))
        };
        let configuration = &setup.configuration;
        Self {
            setup,
            state: ChainState::new(configuration.chain()),
            levers: levers(setup),
            regions: configuration.regions().iter().filter_map(place).collect(),
        }
    }

    /// Over a motion of this duration that begins with `slots`: from when on the robot has which slots, and at the end. It
    /// has those in whose zones it is, and keeps what it had until it can stop before the region.
    fn along(&mut self, duration: f64, mut slots: u64, q: &dyn Fn(f64) -> Vec<f64>) -> (Spans, u64) {
        let steps = (duration / STEP_S).ceil().clamp(1.0, MOST_STEPS);
        let time = |i: usize| duration * i as f64 / steps;
        let mut spans = Spans::new();
        let mut here = q(0.0);
        for i in 0..steps as usize {
            let next = q(time(i + 1));
            let moved: f64 = self.levers.iter().map(|(j, lever)| lever * (next[*j] - here[*j]).abs()).sum();
            let speed: Vec<f64> = next.iter().zip(&here).map(|(b, a)| (b - a).abs() * steps / duration).collect();
            slots = self.slots(&here, moved) | self.kept(slots, &here, moved + self.stopping_way(&speed));
            if spans.last().is_none_or(|s| s.1 != slots) {
                spans.push((time(i), slots));
            }
            here = next;
        }
        let end = self.slots(&here, 0.0) | self.kept(slots, &here, self.stopping_way(&[]));
        (spans, end)
    }

    /// No point goes farther (m) until the robot stands, at these joint speeds (rad/s, m/s; none: at rest) and told override
    /// 1, by the stopping law's assumptions. 0 where it does not count.
    fn stopping_way(&self, speed: &[f64]) -> f64 {
        let Some(law) = &self.setup.configuration.laws().stopping_distance else { return 0.0 };
        // Twice the time until a stop begins: the law keeps as much in reserve.
        let run_s = 2.0 * (law.reaction_s + 2.0 * law.period_s);
        let speed = |j: usize| speed.get(j).copied().unwrap_or(0.0);
        let (acceleration, deceleration) = (&law.joint_acceleration, &law.joint_deceleration);
        let stop_s = |(j, a): (usize, &f64)| (speed(j) + acceleration[j] * run_s) / a;
        let stop_s = deceleration.iter().enumerate().map(stop_s).fold(0.0, f64::max);
        let way = |j: usize| {
            speed(j) * run_s + 0.5 * acceleration[j] * run_s * run_s + 0.5 * deceleration[j] * stop_s * stop_s
        };
        self.levers.iter().map(|(j, lever)| lever * way(*j)).sum()
    }

    /// Those of the slots with a region that the robot comes to within `reach` (m).
    fn kept(&mut self, slots: u64, q: &[f64], reach: f64) -> u64 {
        if slots == 0 { 0 } else { slots & self.slots_within(q, |region| reach.max(zone_m(region))) }
    }

    /// Slots in whose zones the robot is, or may be after moving by no more than `moved` (m).
    fn slots(&mut self, q: &[f64], moved: f64) -> u64 {
        self.slots_within(q, |region| zone_m(region) + moved)
    }

    fn slots_within(&mut self, q: &[f64], reach: impl Fn(&Region) -> f64) -> u64 {
        let configuration = &self.setup.configuration;
        self.state.q.copy_from_slice(q);
        configuration.chain().forward(&mut self.state);
        let in_world = |v: &Volume| *configuration.base_in_world() * self.state.link_in_root(v.link) * v.in_link;
        let volumes: Vec<(&Volume, Pose)> = configuration.volumes().iter().map(|v| (v, in_world(v))).collect();
        let boxes: Vec<Aabb> = volumes.iter().map(|(v, pose)| v.shape.aabb(pose)).collect();
        let mut slots = 0;
        for (slot, region, pose, bounds) in &self.regions {
            let reach = reach(region);
            let near = |((volume, at), boxed): (&(&Volume, Pose), &Aabb)| {
                volume.part.counts_for(region.guards)
                    && bounds.distance(boxed) <= reach
                    && within(&volume.shape, at, &region.shape, pose, reach)
            };
            if slots >> slot.0 & 1 == 0 && volumes.iter().zip(&boxes).any(near) {
                slots |= 1 << slot.0;
            }
        }
        slots
    }
}

/// As thick as the monitor may take a region's warning zone to be, m.
fn zone_m(region: &Region) -> f64 {
    region.warning_m + region.hysteresis_m + MARGIN_M
}

#[cfg(test)]
mod tests {
    use super::rest_of_stretches;

    #[test]
    fn a_stretch_ends_where_all_zones_are_left() {
        let (a, b) = (1, 2);
        let stages = [0, a, a | b, b, 0, b, 0].iter().enumerate().map(|(i, s)| (i, 0.0, *s)).collect();
        let rest: Vec<(usize, u64)> = rest_of_stretches(stages).iter().map(|s| (s.0, s.2)).collect();
        // Before each stretch and in it what is left of it; after the last nothing more.
        assert_eq!(rest, [(0, a | b), (3, b), (6, 0)]);
    }
}
