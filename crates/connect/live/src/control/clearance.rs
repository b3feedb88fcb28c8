//! Distance of robots from a region that is to be switched on or moved.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegion, Follow, Frames, configure};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Life, Monitor, RegionKind, SourceState};
use elbowroom_robot::RobotId;

use super::joints_heard::HeardJoints;
use crate::messages::JointState;
use crate::node::{AttachedVolumes, LOST};

/// Where the robots and the measured sources of a cell are; `None` for those that are not heard.
pub(crate) struct HeardPlaces {
    /// Joint states per robot.
    pub(crate) joints: Vec<Option<HeardJoints>>,
    /// States per measured source.
    pub(crate) measured: Vec<Option<SourceState>>,
}

/// A robot and its distance from a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clearance {
    /// The robot.
    pub(crate) robot: RobotId,
    /// A proven lower bound of the distance, 0 inside, m; `None` if the robot's position is unknown.
    pub(crate) distance_m: Option<f64>,
    /// Upper bound of the movement of any point of the robot until it stops, m, if the region is in force within
    /// [`UNTIL_IT_COUNTS_S`].
    pub(crate) stopping_m: f64,
}

/// Time until a change is in force at the nodes, s: they receive it at once, or with the next message if one is lost.
const UNTIL_IT_COUNTS_S: f64 = 0.2;

/// Age of joint values, s, up to which a robot moves as they say, and a region that follows it is where they say.
const FRESH_S: f64 = 0.05;

/// Computes the distance from a region of each robot that it guards against, with the parts that the robot carries.
///
/// The errors and the missing distances are those of [`ClearanceQuery`].
pub(crate) fn clearances(
    cell: &Cell,
    region: &CellRegion,
    places: &HeardPlaces,
    t_s: f64,
) -> Result<Vec<Clearance>, Diagnostic> {
    Ok(ClearanceQuery::new(cell, region)?.clearances(places, t_s))
}

/// The monitor of one robot, with what the robot carries.
struct RobotMonitor {
    robot: RobotId,
    monitor: Monitor,
    attached: AttachedVolumes,
}

/// The monitors of one region, for its distances from the robots again and again.
pub(crate) struct ClearanceQuery {
    alone: Cell,
    setups: Vec<MonitorSetup>,
    monitors: Vec<RobotMonitor>,
}

impl ClearanceQuery {
    /// Prepares the distances from a region of the robots that it guards against.
    ///
    /// # Errors
    /// [`Diagnostic`] if no monitor accepts the region.
    pub(crate) fn new(cell: &Cell, region: &CellRegion) -> Result<Self, Diagnostic> {
        let alone = with_only(cell, region);
        let setups = configure::setups(&alone)?;
        let monitors = configure::monitors(&alone, &setups)?.into_iter().enumerate();
        let monitors = monitors.filter(|(i, _)| region.robots.contains(&RobotId(*i)));
        let of_robot = |(i, monitor): (usize, Monitor)| {
            let attached = AttachedVolumes::new(&setups[i].configuration);
            RobotMonitor { robot: RobotId(i), monitor, attached }
        };
        let monitors = monitors.map(of_robot).collect();
        Ok(Self { alone, setups, monitors })
    }

    /// The distances at these joint values, with the parts that the robots carry.
    ///
    /// A robot has no distance if it is not heard, or if the region follows a robot or a measured source that is not
    /// heard. A region that follows another encoder or a path is at its place `t_s` after the start of this process.
    pub(crate) fn clearances(&mut self, places: &HeardPlaces, t_s: f64) -> Vec<Clearance> {
        let Self { alone, setups, monitors } = self;
        let HeardPlaces { joints: states, measured } = places;
        let chains: Vec<Option<ChainState>> =
            alone.robots.iter().zip(states).map(|(r, s)| placed(r, s.as_ref().map(|heard| &heard.state))).collect();
        let of_robot = |own: &mut RobotMonitor| {
            let robot = own.robot;
            let state = states[robot.0].as_ref().filter(|_| chains[robot.0].is_some());
            let sources = sources(alone, &setups[robot.0].sources, (&chains, states), measured, t_s);
            let known = state.zip(sources).and_then(|(heard, sources)| own.distance(alone, heard, &sources));
            let (distance_m, stopping_m) =
                known.map_or((None, 0.0), |(distance_m, stopping_m)| (Some(distance_m), stopping_m));
            Clearance { robot, distance_m, stopping_m }
        };
        monitors.iter_mut().map(of_robot).collect()
    }
}

impl RobotMonitor {
    /// Distance of the robot with what it carries from the only region, and the way of its points until it stops and of the
    /// region until it counts, m.
    fn distance(&mut self, cell: &Cell, heard: &HeardJoints, sources: &[SourceState]) -> Option<(f64, f64)> {
        let state = &heard.state;
        let are_attached = self.attached.apply(&state.attached, &mut self.monitor, |_, _| {});
        let mut query = self.monitor.region_distance(sources);
        query.set_q(&state.q);
        let nearest = query.distances(f64::INFINITY).map(|(_, metres)| metres).next();
        let going_on_s = UNTIL_IT_COUNTS_S + cell.monitoring.reaction_s;
        let of_region: f64 = sources.iter().map(|source| source.motion.velocity.length() * going_on_s).sum();
        let stopping_m = query.motion_bound(&state.q, &at_standstill(cell, self.robot, heard)) + of_region;
        nearest.filter(|_| are_attached).map(|metres| (metres, stopping_m))
    }
}

/// Returns the cell with only this region, as a permanent forbidden region.
fn with_only(cell: &Cell, region: &CellRegion) -> Cell {
    let mut closed = region.clone();
    (closed.region.kind, closed.region.life) = (RegionKind::Forbidden, Life::Permanent);
    Cell { regions: vec![closed], ..cell.clone() }
}

/// Joint values at which the robot comes to rest, if it continues at its velocities until the region is in force and
/// then brakes. A robot whose joints were read more than [`FRESH_S`] ago may go at full speed by now. A robot without
/// velocities counts as at rest when they were read.
fn at_standstill(cell: &Cell, robot: RobotId, HeardJoints { state, age_s }: &HeardJoints) -> Vec<f64> {
    let going_on_s = UNTIL_IT_COUNTS_S + cell.monitoring.reaction_s;
    let limits = &cell.robots[robot.0].limits;
    let moved = |((q, limit), qd): ((&f64, &elbowroom_kinematics::JointLimits), &f64)| {
        let full_speed = limit.velocity.max(qd.abs());
        let now = if *age_s > FRESH_S { full_speed } else { qd.abs() };
        q + (full_speed * age_s + now * (going_on_s + now / (2.0 * limit.stop))).copysign(*qd)
    };
    let has_velocities = state.qd.len() == state.q.len() && state.qd.iter().all(|v| v.is_finite());
    let at_rest = vec![0.0; state.q.len()];
    let qd = if has_velocities { &state.qd } else { &at_rest };
    state.q.iter().zip(limits).zip(qd).map(moved).collect()
}

fn placed(robot: &elbowroom_cell::CellRobot, state: Option<&JointState>) -> Option<ChainState> {
    let chain = &robot.robot.chain;
    let q = &state?.q;
    if q.len() != chain.dof() || q.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let mut placed = ChainState::new(chain);
    placed.q.copy_from_slice(q);
    chain.forward_motion(&mut placed);
    Some(placed)
}

/// States of the sources that the region follows; `None` if one of them is a robot or a measured source that was not heard
/// lately.
fn sources(
    cell: &Cell,
    follows: &[Follow],
    (chains, heard): (&[Option<ChainState>], &[Option<HeardJoints>]),
    measured: &[Option<SourceState>],
    t_s: f64,
) -> Option<Vec<SourceState>> {
    let states: Vec<SourceState> = measured.iter().map(|state| state.unwrap_or(LOST)).collect();
    let frames = Frames::with_measured(cell, &states);
    let is_known = |f: &Follow| match (f, frames.measured_source(f)) {
        (Follow::Robot { robot, .. }, _) => {
            chains[robot.0].is_some() && heard[robot.0].as_ref().is_some_and(|heard| heard.age_s <= FRESH_S)
        }
        (_, source) => source.is_none_or(|index| measured[index].is_some()),
    };
    if !follows.iter().all(is_known) {
        return None;
    }
    let or_start = |(chain, robot): (&Option<ChainState>, &elbowroom_cell::CellRobot)| {
        chain.clone().unwrap_or_else(|| ChainState::new(&robot.robot.chain))
    };
    let all: Vec<ChainState> = chains.iter().zip(&cell.robots).map(or_start).collect();
    Some(frames.sources(follows, &all, t_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::AttachedVolume;

    const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[robot.other]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
base = { at = [3000, 0, 0] }
[region.end]
shape = "sphere"
centre = [0, 0, 1500]
radius = 200
kind = "exchange"
life = "temporary"
warning = 100
[region.on_other]
shape = "sphere"
centre = [-3000, 0, 0]
radius = 200
warning = 100
follow = { robot = "other", frame = "flange" }
"#;

    fn heard(joints: [Option<JointState>; 2]) -> HeardPlaces {
        HeardPlaces { joints: joints.map(|state| state.map(of_age(0.0))).into(), measured: Vec::new() }
    }

    fn of_age(age_s: f64) -> impl Fn(JointState) -> HeardJoints {
        move |state| HeardJoints { state, age_s }
    }

    fn at(q: f64) -> JointState {
        JointState { q: vec![q], qd: vec![0.0], ..JointState::default() }
    }

    #[test]
    fn distances_are_those_of_the_arm_at_its_joint_values() {
        let cell = Cell::parse("rails.toml", CELL).unwrap_or_else(|e| panic!("{e}"));
        let distance = |region: usize, states: [Option<JointState>; 2]| {
            let found = clearances(&cell, &cell.regions[region], &heard(states), 0.0).unwrap();
            found.iter().map(|c| c.distance_m).collect::<Vec<_>>()
        };
        let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-6);
        let far = distance(0, [Some(at(1.0)), Some(at(0.0))]);
        assert!(near(far[0], 0.25), "{far:?}");
        assert!(far[1].is_some_and(|d| d > 2.0));
        assert_eq!(distance(0, [Some(at(1.5)), None]), [Some(0.0), None]);
        assert_eq!(distance(0, [Some(at(f64::NAN)), Some(at(0.0))])[0], None);
        // The region is where the other robot is: as far along its own rail.
        let follows = distance(1, [Some(at(0.5)), Some(at(1.0))]);
        assert!(follows.len() == 1 && near(follows[0], 0.25), "{follows:?}");
        assert_eq!(distance(1, [Some(at(0.5)), None]), [None]);
    }

    /// The tool that is mounted at the start counts until the controller names another one; a query is asked again and again.
    #[test]
    fn distances_are_those_of_the_tool_that_is_on_the_robot() {
        let tools = "[robot.rail.tools.gripper]\nbox = { at = [0, 0, 50], size = [60, 60, 100] }\n\
                     [robot.rail.tools.lance]\nbox = { at = [0, 0, 500], size = [60, 60, 1000] }\nmounted = false\n";
        let cell = Cell::parse("rails.toml", &CELL.replace("[robot.other]", &format!("{tools}[robot.other]")));
        let cell = cell.unwrap_or_else(|e| panic!("{e}"));
        let mut query = ClearanceQuery::new(&cell, &cell.regions[0]).unwrap();
        let attached = |tool: usize| -> Vec<AttachedVolume> {
            let volumes = query.setups[0].tool_volumes(cell.robots[0].payload.tools[tool].link);
            volumes.map(|(volume, v)| AttachedVolume { volume, in_link: v.in_link }).collect()
        };
        let [gripper, lance] = [attached(0), attached(1)];
        let unknown = AttachedVolume { volume: elbowroom_monitor::VolumeId(99), ..lance[0] };
        // The near side of the region is 1.3 m away, and the ball of the carriage has 0.05 m.
        for (named, expected) in [
            (Vec::new(), Some(1.2)),
            (lance.clone(), Some(0.3)),
            (gripper, Some(1.2)),
            (vec![unknown], None),
            (lance, Some(0.3)),
            (Vec::new(), Some(1.25)),
        ] {
            let state = JointState { attached: named, ..at(0.0) };
            let found = query.clearances(&heard([Some(state), None]), 0.0)[0].distance_m;
            let agree = match (found, expected) {
                (Some(a), Some(b)) => (a - b).abs() < 1e-6,
                (found, expected) => found == expected,
            };
            assert!(agree, "{found:?}, not {expected:?}");
        }
    }

    #[test]
    fn a_region_on_a_belt_is_where_the_belt_was_heard() {
        let belt = r#"
[encoder.belt]
direction = [0, 0, 1]
speed = 0
measured = true
[region.on_belt]
shape = "sphere"
centre = [0, 0, 500]
radius = 200
warning = 100
robots = ["rail"]
follow = { encoder = "belt" }
"#;
        let cell = Cell::parse("rails.toml", &format!("{CELL}{belt}")).unwrap_or_else(|e| panic!("{e}"));
        let region = cell.regions.iter().find(|r| r.region.name == "on_belt").unwrap();
        let clearance = |travel_m: Option<f64>| {
            let (pose, motion) = cell.frame_sources.encoders[0].displacement(travel_m.unwrap_or(0.0), 0.3);
            let measured = vec![travel_m.map(|_| SourceState { pose, motion, stamp_s: 0.0 })];
            let places = HeardPlaces { joints: vec![Some(of_age(0.0)(at(0.5))), None], measured };
            clearances(&cell, region, &places, 0.0).unwrap()[0]
        };
        assert_eq!(clearance(None).distance_m, None);
        let far = clearance(Some(1.0));
        // The centres are 1 m apart, the radii are 0.2 and 0.05 m. The belt goes on until the region counts.
        assert!(far.distance_m.is_some_and(|d| (d - 0.75).abs() < 1e-6), "{far:?}");
        assert!((far.stopping_m - 0.3 * (UNTIL_IT_COUNTS_S + cell.monitoring.reaction_s)).abs() < 1e-9, "{far:?}");
    }

    #[test]
    fn a_robot_that_moves_needs_room_to_stop() {
        let cell = Cell::parse("rails.toml", CELL).unwrap_or_else(|e| panic!("{e}"));
        let moving = |qd: Vec<f64>| {
            let state = JointState { q: vec![0.5], qd, ..JointState::default() };
            clearances(&cell, &cell.regions[0], &heard([Some(state), None]), 0.0).unwrap()[0].stopping_m
        };
        let braking_m = 0.5 * 0.5 / (2.0 * cell.robots[0].limits[0].stop);
        let expected = 0.5 * (UNTIL_IT_COUNTS_S + cell.monitoring.reaction_s) + braking_m;
        assert!((moving(vec![0.5]) - expected).abs() < 1e-9 && (moving(vec![-0.5]) - expected).abs() < 1e-9);
        assert_eq!((moving(vec![0.0]), moving(Vec::new())), (0.0, 0.0));
        // What is 0.1 s old may have been left at full speed.
        let places = HeardPlaces { joints: vec![Some(of_age(0.1)(at(0.5))), None], measured: Vec::new() };
        let old = clearances(&cell, &cell.regions[0], &places, 0.0).unwrap()[0].stopping_m;
        let limit = cell.robots[0].limits[0];
        let on_s = 0.1 + UNTIL_IT_COUNTS_S + cell.monitoring.reaction_s;
        let expected = limit.velocity * (on_s + limit.velocity / (2.0 * limit.stop));
        assert!((old - expected).abs() < 1e-9, "{old}");
    }
}
