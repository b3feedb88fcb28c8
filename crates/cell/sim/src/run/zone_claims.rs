//! Claims of exchange regions: the regions that a program occupies without leaving all of them in between.
//!
//! Claims are computed before the run and declared to the zone arbiter during it, so that it grants in an order without
//! deadlocks.

use std::borrow::Cow;
use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::trajectory::{Playback, volume_motion_bounds};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Region, RegionKind, RobotSlot, SlotId, Volume, ZoneArbiter};
use elbowroom_proximity::within;
use elbowroom_robot::RobotId;
use elbowroom_spatial::{Aabb, Pose};

use crate::motion::{HeldObjects, PlanStep, ProgramClock, ProgramPlan, Segment};

/// Sampling step of programs, s of program time.
const STEP_S: f64 = 0.01;
/// Largest number of samples of a move. The motion between samples is added to the distances.
const MAX_STEPS: f64 = 20_000.0;
/// Margin added to warning zones and their hysteresis, m: rounding must not make a zone smaller than the monitor's.
const MARGIN_M: f64 = 1e-3;

/// The slots that the robot occupies from `from_s` (s, at override 1) on, one bit per slot.
#[derive(Debug, Clone, Copy)]
struct Occupation {
    from_s: f64,
    slots: u64,
}

/// The claimed slots from a point of the program on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ClaimStage {
    /// Index of the step.
    step: usize,
    /// Time in the step (s, at override 1).
    from_s: f64,
    /// One bit per slot.
    slots: u64,
}

/// The slots that a robot may still need, along its program.
#[derive(Debug)]
pub(super) struct ZoneClaims {
    robot: RobotSlot,
    /// In the order of the program.
    stages: Vec<ClaimStage>,
    declared: Option<u64>,
}

impl ZoneClaims {
    /// Computes the claims of a plan.
    ///
    /// `None` for fewer than 2 or more than 63 slots, if exchange regions move, or if it is not known in advance where
    /// an object will be in the hand.
    pub fn of_plan(
        cell: &Cell,
        robot: RobotId,
        setup: &MonitorSetup,
        plan: &ProgramPlan,
        arbiter: &ZoneArbiter,
    ) -> Option<Self> {
        let fixed = |r: &Region| r.follow.is_none();
        let exchanged = |r: &&Region| matches!(r.kind, RegionKind::Exchange { .. });
        let regions = setup.configuration.regions();
        if arbiter.slots() < 2 || arbiter.slots() > 63 || !regions.iter().filter(exchanged).all(fixed) {
            return None;
        }
        let mut held = HeldObjects::default();
        let mut now = Cow::Borrowed(cell);
        let mounted_in =
            |cell: &Cell| cell.robots[robot.0].payload.tools.iter().map(|tool| tool.mounted).collect::<Vec<_>>();
        let mut mounted = mounted_in(cell);
        let mut zones = ZoneTester::new(setup, cell.volumes_holding(robot, &[]));
        let mut here = plan.start.clone();
        let mut occupied: Vec<ClaimStage> = Vec::new();
        let mut slots = zones.slots(&plan.start, 0.0);
        let mut evaluated: Vec<EvaluatedMove> = Vec::new();
        for (step, what) in plan.steps.iter().enumerate() {
            let (key, duration): (*const (), f64) = match what {
                PlanStep::Move(m) => (Arc::as_ptr(m).cast(), m.duration()),
                PlanStep::Play(p) | PlanStep::Planned { play: p, .. } => (Arc::as_ptr(p).cast(), p.duration()),
                _ => {
                    match what {
                        PlanStep::Grip(action) => held.apply(action),
                        PlanStep::Tool(tool) => {
                            now = Cow::Owned(now.with_tool(robot, *tool));
                            mounted = mounted_in(&now);
                        }
                        _ => {}
                    }
                    if let PlanStep::Grip(_) | PlanStep::Tool(_) = what {
                        zones.set_volumes(now.volumes_holding(robot, &held.attachments()?));
                        slots |= zones.slots(&here, 0.0);
                    }
                    occupied.push(ClaimStage { step, from_s: 0.0, slots });
                    continue;
                }
            };
            let is_same =
                |k: &EvaluatedMove| k.key == key && k.before == slots && k.held == held && k.mounted == mounted;
            let index = evaluated.iter().position(is_same).unwrap_or_else(|| {
                let (occupations, after) = zones.occupations(duration, slots, &|t| at(what, t));
                let (held, mounted) = (held.clone(), mounted.clone());
                evaluated.push(EvaluatedMove { key, before: slots, held, mounted, occupations, after });
                evaluated.len() - 1
            });
            let EvaluatedMove { occupations, after, .. } = &evaluated[index];
            occupied.extend(occupations.iter().map(|o| ClaimStage { step, from_s: o.from_s, slots: o.slots }));
            slots = *after;
            here = what.end().unwrap_or(here);
        }
        occupied.push(ClaimStage { step: plan.steps.len(), from_s: 0.0, slots });
        Some(Self { robot: RobotSlot(robot.0), stages: claims_of(occupied), declared: None })
    }

    /// Declares the claims at the position of the clock.
    pub fn declare(&mut self, clock: &ProgramClock, arbiter: &ZoneArbiter) {
        let (step, time) = clock.position();
        let next = self.stages.partition_point(|s| (s.step, s.from_s) <= (step, time));
        let slots = next.checked_sub(1).map_or(0, |i| self.stages[i].slots);
        if self.declared != Some(slots) {
            self.declared = Some(slots);
            arbiter.declare(self.robot, (0..arbiter.slots()).filter(|s| slots >> s & 1 == 1).map(SlotId));
        }
    }
}

fn at(step: &PlanStep, t: f64) -> Vec<f64> {
    let of_move = |m: &Segment| m.at(t).q;
    let of_recording = |p: &Playback| p.q(t);
    match step {
        PlanStep::Move(m) => of_move(m),
        PlanStep::Play(p) | PlanStep::Planned { play: p, .. } => of_recording(p),
        _ => Vec::new(),
    }
}

/// Turns occupied slots into claims: each stage claims all slots that are occupied until the next stage without any.
///
/// A stage without occupied slots gets the claims of the next occupied interval, which are thus declared in advance.
fn claims_of(mut stages: Vec<ClaimStage>) -> Vec<ClaimStage> {
    let (mut claims, mut is_interval_end) = (0, true);
    for stage in stages.iter_mut().rev() {
        if stage.slots == 0 {
            is_interval_end = true;
        } else {
            claims = if is_interval_end { stage.slots } else { claims | stage.slots };
            is_interval_end = false;
        }
        stage.slots = claims;
    }
    stages.dedup_by(|later, earlier| later.slots == earlier.slots);
    stages
}

/// Occupations of a move, computed once for a move that occurs several times.
struct EvaluatedMove {
    /// Identity of the move.
    key: *const (),
    /// Slots at its start.
    before: u64,
    held: HeldObjects,
    /// Whether each tool of the robot is mounted.
    mounted: Vec<bool>,
    occupations: Vec<Occupation>,
    /// Slots at its end.
    after: u64,
}

/// An exchange region at its pose.
struct PlacedRegion<'a> {
    slot: SlotId,
    region: &'a Region,
    in_world: Pose,
    bounds: Aabb,
}

/// Finds the warning zones that a configuration is in.
struct ZoneTester<'a> {
    setup: &'a MonitorSetup,
    /// The guarded volumes, with the objects that the robot holds.
    volumes: Vec<Volume>,
    state: ChainState,
    /// Index and motion bound of each joint that moves a volume.
    motion_bounds: Vec<(usize, f64)>,
    /// The exchange regions at their poses.
    regions: Vec<PlacedRegion<'a>>,
}

impl<'a> ZoneTester<'a> {
    fn new(setup: &'a MonitorSetup, volumes: Vec<Volume>) -> Self {
        let place = |r: &'a Region| {
            let RegionKind::Exchange { slot } = r.kind else { return None };
            let in_world = r.anchor * r.shape_in_anchor;
            Some(PlacedRegion { slot, region: r, in_world, bounds: r.shape.aabb(&in_world) })
        };
        let configuration = &setup.configuration;
        let mut tester = Self {
            setup,
            volumes: Vec::new(),
            state: ChainState::new(configuration.chain()),
            motion_bounds: Vec::new(),
            regions: configuration.regions().iter().filter_map(place).collect(),
        };
        tester.set_volumes(volumes);
        tester
    }

    fn set_volumes(&mut self, volumes: Vec<Volume>) {
        let bounds = volume_motion_bounds(self.setup.configuration.chain(), &volumes);
        self.motion_bounds = bounds.into_iter().enumerate().filter(|(_, bound)| *bound != 0.0).collect();
        self.volumes = volumes;
    }

    /// Occupations over a motion of this duration that starts with `slots`, and the slots at its end.
    ///
    /// A robot occupies a slot from entering its zone until it can stop before the region.
    fn occupations(&mut self, duration: f64, mut slots: u64, q: &dyn Fn(f64) -> Vec<f64>) -> (Vec<Occupation>, u64) {
        let steps = (duration / STEP_S).ceil().clamp(1.0, MAX_STEPS);
        let time = |i: usize| duration * i as f64 / steps;
        let mut occupations: Vec<Occupation> = Vec::new();
        let mut here = q(0.0);
        for i in 0..steps as usize {
            let next = q(time(i + 1));
            let moved: f64 = self.motion_bounds.iter().map(|(j, bound)| bound * (next[*j] - here[*j]).abs()).sum();
            let speed: Vec<f64> = next.iter().zip(&here).map(|(b, a)| (b - a).abs() * steps / duration).collect();
            slots = self.slots(&here, moved) | self.kept_slots(slots, &here, moved + self.stopping_distance_m(&speed));
            if occupations.last().is_none_or(|o| o.slots != slots) {
                occupations.push(Occupation { from_s: time(i), slots });
            }
            here = next;
        }
        let end = self.slots(&here, 0.0) | self.kept_slots(slots, &here, self.stopping_distance_m(&[]));
        (occupations, end)
    }

    /// Upper bound of the distance (m) to a stop from these joint speeds (rad/s, m/s; empty: at rest) at override 1,
    /// under the assumptions of the stopping law; 0 if the law is off.
    fn stopping_distance_m(&self, speed: &[f64]) -> f64 {
        let Some(law) = &self.setup.configuration.laws().stopping_distance else { return 0.0 };
        // Twice the time until braking begins: the law keeps the same reserve.
        let run_s = 2.0 * (law.reaction_s + 2.0 * law.period_s);
        let speed = |j: usize| speed.get(j).copied().unwrap_or(0.0);
        let (acceleration, deceleration) = (&law.joint_acceleration, &law.joint_deceleration);
        let stop_s = |(j, a): (usize, &f64)| (speed(j) + acceleration[j] * run_s) / a;
        let stop_s = deceleration.iter().enumerate().map(stop_s).fold(0.0, f64::max);
        let distance = |j: usize| {
            speed(j) * run_s + 0.5 * acceleration[j] * run_s * run_s + 0.5 * deceleration[j] * stop_s * stop_s
        };
        self.motion_bounds.iter().map(|(j, bound)| bound * distance(*j)).sum()
    }

    /// The given slots that have a region within `reach_m` of the robot.
    fn kept_slots(&mut self, slots: u64, q: &[f64], reach_m: f64) -> u64 {
        if slots == 0 { 0 } else { slots & self.slots_within(q, |region| reach_m.max(zone_m(region))) }
    }

    /// Slots in whose zones the robot is, or may be after a motion of at most `moved` (m).
    fn slots(&mut self, q: &[f64], moved: f64) -> u64 {
        self.slots_within(q, |region| zone_m(region) + moved)
    }

    fn slots_within(&mut self, q: &[f64], reach_m: impl Fn(&Region) -> f64) -> u64 {
        let configuration = &self.setup.configuration;
        self.state.q.copy_from_slice(q);
        configuration.chain().forward(&mut self.state);
        let in_world = |v: &Volume| *configuration.base_in_world() * self.state.link_in_root(v.link) * v.in_link;
        let volumes: Vec<(&Volume, Pose)> = self.volumes.iter().map(|v| (v, in_world(v))).collect();
        let boxes: Vec<Aabb> = volumes.iter().map(|(v, pose)| v.shape.aabb(pose)).collect();
        let mut slots = 0;
        for PlacedRegion { slot, region, in_world, bounds } in &self.regions {
            let limit_m = reach_m(region);
            let near = |((volume, at), boxed): (&(&Volume, Pose), &Aabb)| {
                volume.part.counts_for(region.guards)
                    && bounds.distance(boxed) <= limit_m
                    && within(&volume.shape, at, &region.shape, in_world, limit_m)
            };
            if slots >> slot.0 & 1 == 0 && volumes.iter().zip(&boxes).any(near) {
                slots |= 1 << slot.0;
            }
        }
        slots
    }
}

/// Upper bound of the thickness of the monitor's warning zone, m.
fn zone_m(region: &Region) -> f64 {
    region.warning_m + region.hysteresis_m + MARGIN_M
}

#[cfg(test)]
mod tests {
    use super::{ClaimStage, claims_of};

    #[test]
    fn a_claim_ends_where_all_zones_are_left() {
        let (a, b) = (1, 2);
        let slots = [0, a, a | b, b, 0, b, 0].into_iter().enumerate();
        let stages = slots.map(|(step, slots)| ClaimStage { step, from_s: 0.0, slots }).collect();
        let rest: Vec<(usize, u64)> = claims_of(stages).iter().map(|s| (s.step, s.slots)).collect();
        // Before and within each occupied interval, the remaining claims; after the last one, none.
        assert_eq!(rest, [(0, a | b), (3, b), (6, 0)]);
    }
}
