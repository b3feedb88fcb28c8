//! The motion of a scene during a sweep: poses at an instant, and bounds on speeds.

use elbowroom_kinematics::LinkId;
use elbowroom_kinematics::motion_bound::SpeedBound;
use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::Vec3;

use super::link_bounds::{JointRates, LinkBounds};
use super::moves::SweepMove;
use crate::{Level, Scene, SceneError, SceneState};

/// A motion of the scene.
#[derive(Debug)]
pub(super) struct SweepTrajectory {
    /// The scene at the last set time.
    pub state: SceneState,
    link_bounds: LinkBounds,
    /// Per robot: its joint values over time.
    segments: Vec<JointSegment>,
    /// Per object: its own path, if it has one.
    free_objects: Vec<Option<FreeObject>>,
    /// Per model: start of its bounds in `bounds`. One more element: the end.
    first: Vec<usize>,
    bounds: Vec<SpeedBound>,
    /// Per model: sum of the lengths from which its pose is computed, metres.
    sizes: Vec<f64>,
    /// True if the velocities of the links belong to the last set time.
    velocities_known: bool,
    now: f64,
}

/// Joint values of a robot over time: `from + rate·t`.
#[derive(Debug)]
struct JointSegment {
    moves: bool,
    from: Vec<f64>,
    rate: Vec<f64>,
    /// True if both ends are within the joint limits.
    within_limits: bool,
}

/// An object on its own path.
#[derive(Debug, Clone, Copy)]
struct FreeObject {
    /// The path, if its velocities are constant.
    constant_twist: Option<ConstantTwist>,
}

/// A model as seen from the frame below the first `cut` joints of the path from the root to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairSide {
    pub model: usize,
    pub cut: usize,
}

impl SweepTrajectory {
    pub fn new(scene: &Scene, level: Level) -> Self {
        let link_bounds = LinkBounds::new(scene, level);
        let segment =
            |dof: usize| JointSegment { moves: false, from: vec![0.0; dof], rate: vec![0.0; dof], within_limits: true };
        let models = scene.models.len();
        Self {
            state: SceneState::new(scene),
            segments: scene.robots.iter().map(|r| segment(r.robot.chain.dof())).collect(),
            free_objects: vec![None; scene.objects.len()],
            first: Vec::with_capacity(models + 1),
            bounds: Vec::with_capacity(models * (link_bounds.longest_path() + 1)),
            sizes: vec![0.0; models],
            link_bounds,
            velocities_known: false,
            now: 0.0,
        }
    }

    /// Checks all moves, then starts the trajectory at a state.
    pub fn start(&mut self, scene: &Scene, start: &SceneState, moves: &[SweepMove]) -> Result<(), SceneError> {
        self.segments.iter_mut().for_each(|s| s.moves = false);
        self.free_objects.fill(None);
        for m in moves {
            match *m {
                SweepMove::Robot { robot, to } => {
                    start.check_q(scene, robot, to)?;
                    if std::mem::replace(&mut self.segments[robot.0].moves, true) {
                        return Err(SceneError::MovesTwice(scene.robots[robot.0].name.clone()));
                    }
                }
                SweepMove::Object { object, path } => {
                    let name = start.check_place(scene, object)?;
                    if !(path.pose(0.0).is_finite() && path.pose(1.0).is_finite()) {
                        return Err(SceneError::PoseNotFinite(format!("`{name}` on its path")));
                    }
                    if self.free_objects[object.0]
                        .replace(FreeObject { constant_twist: path.constant_twist() })
                        .is_some()
                    {
                        return Err(SceneError::MovesTwice(name.to_string()));
                    }
                }
            }
        }
        self.state.copy_from(scene, start);
        for (robot, segment) in self.segments.iter_mut().enumerate() {
            self.state.chains[robot].qd.fill(0.0);
            segment.from.copy_from_slice(start.q(RobotId(robot)));
            segment.rate.fill(0.0);
            segment.within_limits = !start.beyond_limits[robot];
        }
        for m in moves {
            if let SweepMove::Robot { robot, to } = *m {
                self.set_target(scene, robot, to);
            }
        }
        self.compute_bounds(scene, moves);
        Ok(())
    }

    /// Starts the next segment of the only moving robot, between checked joint values.
    pub fn next_segment(&mut self, scene: &Scene, robot: RobotId, from: &[f64], to: &[f64]) {
        let segment = &mut self.segments[robot.0];
        segment.from.copy_from_slice(from);
        segment.within_limits = scene.within_limits(robot, from);
        self.set_target(scene, robot, to);
        self.compute_bounds(scene, &[]);
    }

    fn set_target(&mut self, scene: &Scene, robot: RobotId, to: &[f64]) {
        let segment = &mut self.segments[robot.0];
        for (rate, (to, from)) in segment.rate.iter_mut().zip(to.iter().zip(&segment.from)) {
            *rate = to - from;
        }
        segment.within_limits &= scene.within_limits(robot, to);
        self.state.chains[robot.0].qd.copy_from_slice(&segment.rate);
    }

    fn compute_bounds(&mut self, scene: &Scene, moves: &[SweepMove]) {
        self.first.clear();
        self.bounds.clear();
        for (model, m) in scene.models.iter().enumerate() {
            let begin = self.bounds.len();
            self.first.push(begin);
            self.sizes[model] = if let Some((robot, link)) = self.state.carrier(m.id) {
                let segment = &self.segments[robot.0];
                let in_link = self.state.attachment_of(m.id).map(|a| a.in_link);
                let rates = JointRates { from: &segment.from, rate: &segment.rate };
                let size = self.link_bounds.append_bounds(robot, link, model, in_link, rates, &mut self.bounds);
                size + scene.robots[robot.0].base_in_world.translation.length()
            } else {
                self.bounds.push(self.free_object_bound(m.id, model, moves));
                self.state.in_world[model].translation.length() + self.link_bounds.finite_radius(model)
            };
            let travel = self.bounds[begin].speed;
            self.sizes[model] += if travel.is_finite() { travel } else { 0.0 };
        }
        self.first.push(self.bounds.len());
    }

    /// Speed bound of an unattached object.
    fn free_object_bound(&self, id: GeometryId, model: usize, moves: &[SweepMove]) -> SpeedBound {
        let own = moves.iter().find_map(|m| match m {
            SweepMove::Object { object, path } if GeometryId::Object(*object) == id => Some(*path),
            _ => None,
        });
        own.map_or(SpeedBound::REST, |path| path_bound(path, self.link_bounds.radius(model)))
    }

    /// Moves all robots and objects to their poses at time `t`.
    pub fn set_time(&mut self, scene: &Scene, moves: &[SweepMove], t: f64) {
        for (robot, segment) in self.segments.iter().enumerate().filter(|(_, s)| s.moves) {
            let chain = &mut self.state.chains[robot];
            for (q, (from, rate)) in chain.q.iter_mut().zip(segment.from.iter().zip(&segment.rate)) {
                *q = from + rate * t;
            }
            scene.robots[robot].robot.chain.forward(chain);
            self.state.robot_moved(scene, RobotId(robot));
        }
        for m in moves {
            if let SweepMove::Object { object, path } = m {
                self.state.set_model_pose(scene, scene.object_model(*object), path.pose(t));
            }
        }
        self.velocities_known = false;
        self.now = t;
    }

    /// The two sides of a pair, each relative to the last link that carries both.
    pub fn sides(&self, scene: &Scene, a: usize, b: usize) -> [PairSide; 2] {
        let carriers = [a, b].map(|m| self.state.carrier(scene.models[m].id));
        let cut = match carriers {
            [Some((ra, la)), Some((rb, lb))] if ra == rb => self.link_bounds.common_joints(ra, la, lb),
            _ => 0,
        };
        [PairSide { model: a, cut }, PairSide { model: b, cut }]
    }

    /// Speed bounds of a side throughout the motion.
    pub fn bound(&self, side: PairSide) -> SpeedBound {
        self.bounds[(self.first[side.model] + side.cut).min(self.first[side.model + 1] - 1)]
    }

    /// Resolution (m) of poses of this size in double precision.
    pub fn resolution(&self, a: usize, b: usize) -> f64 {
        64.0 * f64::EPSILON * (self.sizes[a] + self.sizes[b])
    }

    /// True if the out-of-reach proofs of the scene hold throughout the motion.
    pub fn proofs_hold(&self, id: GeometryId) -> bool {
        match id {
            GeometryId::Link { robot, .. } => self.segments[robot.0].within_limits,
            GeometryId::Object(o) => !self.is_free(o) && self.state.proofs_hold(id),
        }
    }

    /// True if the object moves on its own path.
    pub fn is_free(&self, object: ObjectId) -> bool {
        self.free_objects[object.0].is_some()
    }

    /// The largest speed of any point of a side at the last set time, metres per unit of time.
    pub fn speed_now(&mut self, scene: &Scene, side: PairSide) -> f64 {
        let bound = self.bound(side).speed;
        if bound == 0.0 {
            return 0.0;
        }
        let id = scene.models[side.model].id;
        if self.state.carrier(id).is_some() {
            self.compute_velocities(scene);
        }
        let Some(corners) = self.link_bounds.corners(side.model) else { return bound };
        let in_world = self.state.in_world[side.model];
        let fastest = if let Some((robot, link)) = self.state.carrier(id) {
            let base = &scene.robots[robot.0].base_in_world;
            let seen_from = self.link_bounds.link_below(robot, link, side.cut);
            let own = self.twist(robot, link);
            let other = seen_from.map_or((Vec3::ZERO, Vec3::ZERO), |l| self.twist(robot, l));
            // The relative velocity field: velocity at the root's origin, and angular velocity.
            let (velocity, angular) = (own.0 - other.0, own.1 - other.1);
            let in_root = base.inverse_mul(&in_world);
            largest_speed(corners, |p| velocity + angular.cross(in_root.transform_point(p)))
        } else {
            let GeometryId::Object(o) = id else { return bound };
            let Some(FreeObject { constant_twist: Some(s) }) = self.free_objects[o.0] else { return bound };
            largest_speed(corners, |p| s.velocity_at(in_world.transform_point(p), self.now))
        };
        // Rounding is relative to the terms, not to their difference.
        let rounded_up = fastest * (1.0 + 1e-9) + 1e-12 * bound;
        if rounded_up < bound { rounded_up } else { bound }
    }

    /// Velocity of the link's point at the root's origin, and the link's angular velocity, in the root's frame.
    fn twist(&self, robot: RobotId, link: LinkId) -> (Vec3, Vec3) {
        let chain = &self.state.chains[robot.0];
        (chain.point_velocity(link, Vec3::ZERO), chain.link_motion(link).angular_velocity)
    }

    fn compute_velocities(&mut self, scene: &Scene) {
        if !std::mem::replace(&mut self.velocities_known, true) {
            for (robot, _) in self.segments.iter().enumerate().filter(|(_, s)| s.moves) {
                scene.robots[robot].robot.chain.forward_motion(&mut self.state.chains[robot]);
            }
        }
    }
}

/// Speed bound of an object on its own path, whose points are within `radius` metres of its frame's origin.
fn path_bound(path: &dyn RigidMotion, radius: f64) -> SpeedBound {
    let constant_twist = path.constant_twist();
    let speed = match constant_twist {
        // Without rotation, far points are no faster than near points.
        Some(s) if s.rotation == Vec3::ZERO => s.velocity.length(),
        _ => path.speed(radius, 0.0, 1.0),
    };
    let acceleration = constant_twist.map_or(f64::INFINITY, |s| {
        let rotation = s.rotation.length();
        if rotation == 0.0 { 0.0 } else { rotation * rotation * (s.start.translation.distance(s.pivot) + radius) }
    });
    SpeedBound { speed, acceleration }.rounded_up()
}

/// The largest speed over some points; NaN counts as infinite.
fn largest_speed(points: &[Vec3], velocity: impl Fn(Vec3) -> Vec3) -> f64 {
    let known = |v: f64| if v.is_nan() { f64::INFINITY } else { v };
    points.iter().map(|p| known(velocity(*p).length_squared())).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Object;
    use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, Mimic};
    use elbowroom_proximity::{Cuboid, Shape};
    use elbowroom_robot::{Collider, Robot};
    use elbowroom_spatial::{Pose, Rotation};
    use elbowroom_testkit::random::Random;

    fn vec3(r: &mut Random, size: f64) -> Vec3 {
        Vec3::from(r.within(size))
    }

    fn pose(r: &mut Random) -> Pose {
        Pose::new(Rotation::from_rotation_vector(vec3(r, 2.0)), vec3(r, 0.3))
    }

    /// A robot of revolute, prismatic, fixed and mimic joints at all angles, and two objects.
    fn scene(r: &mut Random) -> Scene {
        use JointKind::{Continuous, Fixed, Prismatic, Revolute};
        let kinds = [Revolute, Prismatic, Fixed, Revolute, Continuous, Revolute, Prismatic];
        let joint = |(i, kind): (usize, JointKind)| Joint {
            name: format!("j{i}"),
            kind,
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: pose(r),
            axis: vec3(r, 1.0),
            limits: Limits::symmetric(2.0),
            mimic: (i == 5).then(|| Mimic { joint: JointId(0), multiplier: -1.5, offset: 0.2 }),
        };
        let joints = kinds.into_iter().enumerate().map(joint).collect();
        let links = (0..=kinds.len()).map(|i| format!("l{i}")).collect();
        let mut robot = Robot::new(Chain::new("any", links, joints).unwrap());
        let cuboid = |r: &mut Random| Shape::Cuboid(Cuboid { half_extents: vec3(r, 0.1).abs() + Vec3::splat(0.01) });
        for colliders in &mut robot.colliders {
            colliders.push(Collider { name: String::new(), shape: cuboid(r), in_link: pose(r) });
        }
        let mut builder = Scene::builder();
        builder.prove_out_of_reach(false);
        builder.robot("any", robot, pose(r));
        for name in ["attached", "free"] {
            builder.object(Object { name: name.into(), shape: cuboid(r), in_world: pose(r) });
        }
        builder.build().unwrap()
    }

    #[test]
    fn no_point_travels_farther_than_the_bounds_seen_from_any_link() {
        let mut r = Random(3);
        let mut tightest: f64 = 0.0;
        let robot = RobotId(0);
        for _ in 0..60 {
            let scene = scene(&mut r);
            let mut start = SceneState::new(&scene);
            let dof = scene.robots[0].robot.chain.dof();
            let mut q = |size: f64| (0..dof).map(|_| r.between(-size, size)).collect::<Vec<_>>();
            let to = q(2.0);
            start.set_q(&scene, robot, &q(2.0)).unwrap();
            let hand = LinkId(scene.robots[0].robot.chain.links().len() - 1);
            start.attach(&scene, ObjectId(0), robot, hand, &[]).unwrap();
            let path = ConstantTwist {
                start: pose(&mut r),
                pivot: vec3(&mut r, 0.5),
                velocity: vec3(&mut r, 1.0),
                rotation: vec3(&mut r, 2.0),
            };
            let moves = [SweepMove::Robot { robot, to: &to }, SweepMove::Object { object: ObjectId(1), path: &path }];
            let mut trajectory = SweepTrajectory::new(&scene, Level::L3);
            trajectory.start(&scene, &start, &moves).unwrap();
            for (model, m) in scene.models.iter().enumerate() {
                let carrier = start.carrier(m.id);
                let above = carrier.map_or(0, |(_, link)| scene.robots[0].robot.chain.path(link).len());
                for cut in 0..=above {
                    let side = PairSide { model, cut };
                    // The pose of the model in the link below the first `cut` joints.
                    let seen = |trajectory: &SweepTrajectory| {
                        let link =
                            carrier.and_then(|(robot, link)| trajectory.link_bounds.link_below(robot, link, cut));
                        let from = link.map_or(Pose::IDENTITY, |l| trajectory.state.link_in_world(&scene, robot, l));
                        from.inverse_mul(&trajectory.state.in_world[model])
                    };
                    let (t, u) = (r.between(0.0, 1.0), r.between(0.0, 1.0));
                    trajectory.set_time(&scene, &moves, t);
                    let before = seen(&trajectory);
                    let (now, bound) = (trajectory.speed_now(&scene, side), trajectory.bound(side));
                    trajectory.set_time(&scene, &moves, u);
                    let after = seen(&trajectory);
                    let travel = |p: &Vec3| before.transform_point(*p).distance(after.transform_point(*p));
                    let corners = trajectory.link_bounds.corners(model).unwrap();
                    let farthest = corners.iter().map(travel).fold(0.0, f64::max);
                    let most = bound.distance(now, (t - u).abs());
                    assert!(farthest <= most + 1e-12, "{farthest} {most} {:?} {cut}", m.id);
                    assert!(now <= bound.speed);
                    if farthest > 1e-3 {
                        tightest = tightest.max(farthest / most);
                    }
                }
            }
        }
        assert!(tightest > 0.9, "{tightest}");
    }
}
