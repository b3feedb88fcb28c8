//! Distances for a status, by the engine: pairs of the scene as `query` measures them, regions as the monitors do.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, QueryModel};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Presence, Volume};
use elbowroom_proximity::separation_within;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, PairDistance, Scene, SceneState, Selection};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_status::{CellStatus, PoseStatus, RobotStatus};

use crate::frame::{FrameRobot, PairSeparation, RegionDistance, ViewFrame};

/// Measures the distances for statuses of a cell.
pub(crate) struct Distances<'s> {
    cell: &'s Cell,
    model: &'s QueryModel,
    setups: &'s [MonitorSetup],
    checker: Checker<'s>,
    state: SceneState,
    chains: Vec<ChainState>,
}

impl<'s> Distances<'s> {
    pub(crate) fn new(cell: &'s Cell, model: &'s QueryModel, setups: &'s [MonitorSetup], scene: &'s Scene) -> Self {
        Self {
            cell,
            model,
            setups,
            checker: Checker::new(scene, CheckerOptions::default()),
            state: SceneState::new(scene),
            chains: cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
        }
    }

    /// Makes the frame of a status: robots in the order of the cell, with distances if their joint values are known.
    pub(crate) fn frame(&mut self, mut cell_status: CellStatus) -> ViewFrame {
        let robots = self.in_order(std::mem::take(&mut cell_status.robots));
        let known: Vec<bool> =
            robots.iter().enumerate().map(|(r, robot)| self.place_robot(RobotId(r), &robot.q)).collect();
        for object in &cell_status.objects {
            self.place_object(&object.name, &object.pose);
        }
        let mut nearest: Option<PairDistance> = None;
        let mut measured = Vec::with_capacity(robots.len());
        for (r, status) in robots.into_iter().enumerate() {
            let robot = RobotId(r);
            let mut out = FrameRobot { status, ..FrameRobot::default() };
            if known[r] {
                let (others, itself) = (self.nearest_other(robot, &known), self.nearest_self(robot));
                out.nearest = others.map(|d| self.named(&d));
                out.nearest_self = itself.map(|d| self.named(&d));
                out.distances = self.regions(robot, &out.status);
                nearest = [others, itself].into_iter().flatten().chain(nearest).min_by(by_distance);
            }
            measured.push(out);
        }
        let mut frame = ViewFrame::of(cell_status, measured);
        frame.nearest = nearest.map(|d| self.named(&d));
        frame
    }

    /// Sorts the statuses into the order of the cell; a robot without a status gets one without joint values.
    fn in_order(&self, mut given: Vec<RobotStatus>) -> Vec<RobotStatus> {
        let of = |name: &str| {
            let found = given.iter().position(|status| status.robot == name).map(|at| given.swap_remove(at));
            found.unwrap_or_else(|| RobotStatus {
                robot: name.to_owned(),
                reason: "no status has come".into(),
                ..RobotStatus::default()
            })
        };
        self.cell.robots.iter().map(|r| r.name.as_str()).map(of).collect()
    }

    /// Places a robot; false if the joint values are unknown or do not fit.
    fn place_robot(&mut self, robot: RobotId, q: &[f64]) -> bool {
        let chain = &self.cell.robots[robot.0].robot.chain;
        let fits = q.len() == chain.dof() && q.iter().all(|v| v.is_finite());
        if !fits || self.state.set_q(self.checker.scene(), robot, q).is_err() {
            return false;
        }
        self.chains[robot.0].q.copy_from_slice(q);
        chain.forward(&mut self.chains[robot.0]);
        true
    }

    fn place_object(&mut self, name: &str, pose: &PoseStatus) {
        let Some(object) = self.model.objects.iter().position(|o| o.name == name) else { return };
        if let Some(pose) = pose_of(pose) {
            // If the scene refuses the pose, the object stays where it was.
            let _ = self.state.place(self.checker.scene(), ObjectId(object), pose);
        }
    }

    fn nearest_other(&mut self, robot: RobotId, known: &[bool]) -> Option<PairDistance> {
        let this = Selection::Robot(robot);
        let others = (0..known.len()).map(RobotId).filter(|other| *other != robot && known[other.0]);
        let sides = others.map(Selection::Robot).chain([Selection::Objects]);
        sides.filter_map(|side| self.pair(this, side)).min_by(by_distance)
    }

    fn nearest_self(&mut self, robot: RobotId) -> Option<PairDistance> {
        let this = Selection::Robot(robot);
        self.pair(this, this)
    }

    /// Measures the nearest pair as a row of `query` does: below the accuracy of the distance the collision test decides.
    fn pair(&mut self, a: Selection, b: Selection) -> Option<PairDistance> {
        let found = self.checker.between(a, b).distance(&self.state)?;
        if !(found.metres > 0.0) || found.lower_bound > 0.0 {
            return Some(found);
        }
        let Some(contact) = self.checker.between(a, b).within(&self.state, 0.0) else { return Some(found) };
        let at = self.checker.between(contact.a.into(), contact.b.into()).distance(&self.state);
        Some(PairDistance { metres: 0.0, ..at.unwrap_or(found) })
    }

    fn named(&self, d: &PairDistance) -> PairSeparation {
        PairSeparation {
            a: self.model.geometry_name(d.a),
            b: self.model.geometry_name(d.b),
            distance_m: if d.metres > 0.0 { d.metres } else { 0.0 },
            points_m: [d.on_a.to_array(), d.on_b.to_array()],
        }
    }

    /// Measures the distances of a robot from its regions, at the region poses of its status.
    fn regions(&self, robot: RobotId, status: &RobotStatus) -> Vec<RegionDistance> {
        let configuration = &self.setups[robot.0].configuration;
        let volumes: Vec<(&Volume, Pose)> = configuration
            .volumes()
            .iter()
            .filter(|v| v.presence != Presence::Detached)
            .map(|v| (v, *configuration.base_in_world() * self.chains[robot.0].link_in_root(v.link) * v.in_link))
            .collect();
        let distance = |region: &elbowroom_monitor::Region| {
            let pose = pose_of(&status.regions.iter().find(|r| r.name == region.name)?.pose)?;
            let counted = volumes.iter().filter(|(v, _)| v.part.counts_for(region.guards));
            let mut nearest: Option<RegionDistance> = None;
            for (volume, in_world) in counted {
                let limit = nearest.as_ref().map_or(f64::INFINITY, |n| n.distance_m);
                let found = separation_within(&volume.shape, in_world, &region.shape, &pose, limit);
                if let Some(s) = found.filter(|s| nearest.is_none() || s.distance < limit) {
                    nearest = Some(RegionDistance {
                        region: region.name.clone(),
                        part: volume.name.clone(),
                        distance_m: s.distance,
                        points_m: [s.on_a.to_array(), s.on_b.to_array()],
                    });
                }
            }
            nearest
        };
        configuration.regions().iter().filter_map(distance).collect()
    }
}

/// Orders pairs by distance; a NaN distance counts as contact.
fn by_distance(a: &PairDistance, b: &PairDistance) -> std::cmp::Ordering {
    let order = |d: &PairDistance| if d.metres.is_nan() { f64::NEG_INFINITY } else { d.metres };
    order(a).total_cmp(&order(b))
}

/// Converts a pose; `None` if a number is not finite or the quaternion has no direction.
pub(super) fn pose_of(status: &PoseStatus) -> Option<Pose> {
    let [x, y, z] = status.position_m;
    let pose = Pose::new(Rotation::from_quaternion_xyzw(status.quaternion_xyzw)?, Vec3::new(x, y, z));
    pose.is_finite().then_some(pose)
}
