//! Where everything is at an instant of the motion, and how fast it can go.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::impact::Steady;
use elbowroom_spatial::Vec3;

use super::Move;
use super::levers::{Levers, Turned};
use super::speed::Speed;
use crate::{Level, Member, Scene, SceneError, SceneState};

/// A motion of the scene.
#[derive(Debug)]
pub(super) struct Travel {
    /// The scene at the instant gone to last.
    pub state: SceneState,
    levers: Levers,
    /// Per robot.
    legs: Vec<Leg>,
    /// Per object: how it moves by itself.
    free: Vec<Option<Free>>,
    /// Per model: where its speeds begin in `speeds`. One more: the end.
    first: Vec<usize>,
    speeds: Vec<Speed>,
    /// Per model: sum of the lengths its place is computed from, metres.
    sizes: Vec<f64>,
    /// Velocities of the links are those of the present instant.
    velocities_known: bool,
    now: f64,
}

/// A robot's joint values over time: `from + rate·t`.
#[derive(Debug)]
struct Leg {
    moves: bool,
    from: Vec<f64>,
    rate: Vec<f64>,
    /// Within its limits all the way.
    within: bool,
}

/// An object on a path of its own.
#[derive(Debug, Clone, Copy)]
struct Free {
    steady: Option<Steady>,
}

/// A member as seen from a frame that is `cut` joints above the root on its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub model: usize,
    pub cut: usize,
}

impl Travel {
    pub fn new(scene: &Scene, level: Level) -> Self {
        let levers = Levers::new(scene, level);
        let leg = |dof: usize| Leg { moves: false, from: vec![0.0; dof], rate: vec![0.0; dof], within: true };
        let models = scene.models.len();
        Self {
            state: SceneState::new(scene),
            legs: scene.robots.iter().map(|r| leg(r.robot.chain.dof())).collect(),
            free: vec![None; scene.objects.len()],
            first: Vec::with_capacity(models + 1),
            speeds: Vec::with_capacity(models * (levers.longest() + 1)),
            sizes: vec![0.0; models],
            levers,
            velocities_known: false,
            now: 0.0,
        }
    }

    /// Checks all moves, then takes the start from a state.
    pub fn depart(&mut self, scene: &Scene, start: &SceneState, moves: &[Move]) -> Result<(), SceneError> {
        self.legs.iter_mut().for_each(|l| l.moves = false);
        self.free.fill(None);
        for m in moves {
            match *m {
                Move::Robot { robot, to } => {
                    start.check_q(scene, robot, to)?;
                    if std::mem::replace(&mut self.legs[robot].moves, true) {
                        return Err(SceneError::MovesTwice(scene.robots[robot].name.clone()));
                    }
                }
                Move::Object { object, path } => {
                    let name = start.check_place(scene, object)?;
                    if !(path.pose(0.0).is_finite() && path.pose(1.0).is_finite()) {
                        return Err(SceneError::PoseNotFinite(format!("`{name}` on its path")));
                    }
                    if self.free[object].replace(Free { steady: path.steady() }).is_some() {
                        return Err(SceneError::MovesTwice(name.to_string()));
                    }
                }
            }
        }
        self.state.copy_from(scene, start);
        for (robot, leg) in self.legs.iter_mut().enumerate() {
            self.state.chains[robot].qd.fill(0.0);
            leg.from.copy_from_slice(start.q(robot));
            leg.rate.fill(0.0);
            leg.within = !start.beyond_limits[robot];
        }
        for m in moves {
            if let Move::Robot { robot, to } = *m {
                self.head_for(scene, robot, to);
            }
        }
        self.bound(scene, moves);
        Ok(())
    }

    /// The next leg of a robot that goes on alone, between joint values that were checked.
    pub fn go_on(&mut self, scene: &Scene, robot: usize, (from, to): (&[f64], &[f64])) {
        let leg = &mut self.legs[robot];
        leg.from.copy_from_slice(from);
        leg.within = scene.within_limits(robot, from);
        self.head_for(scene, robot, to);
        self.bound(scene, &[]);
    }

    fn head_for(&mut self, scene: &Scene, robot: usize, to: &[f64]) {
        let leg = &mut self.legs[robot];
        for (rate, (to, from)) in leg.rate.iter_mut().zip(to.iter().zip(&leg.from)) {
            *rate = to - from;
        }
        leg.within &= scene.within_limits(robot, to);
        self.state.chains[robot].qd.copy_from_slice(&leg.rate);
    }

    /// Bounds of all speeds.
    fn bound(&mut self, scene: &Scene, moves: &[Move]) {
        self.first.clear();
        self.speeds.clear();
        for (model, m) in scene.models.iter().enumerate() {
            self.first.push(self.speeds.len());
            let begin = self.speeds.len();
            self.sizes[model] = if let Some((robot, link)) = self.state.carrier(m.member) {
                let leg = &self.legs[robot];
                let carried = self.state.held(m.member).map(|a| a.in_link);
                let turned = Turned { from: &leg.from, rate: &leg.rate };
                let size = self.levers.speeds((robot, link), model, carried, &turned, &mut self.speeds);
                size + scene.robots[robot].base_in_world.translation.length()
            } else {
                self.speeds.push(self.alone(m.member, model, moves));
                self.state.in_world[model].translation.length() + self.levers.extent(model)
            };
            let way = self.speeds[begin].cap;
            self.sizes[model] += if way.is_finite() { way } else { 0.0 };
        }
        self.first.push(self.speeds.len());
    }

    /// Of an object that no robot carries.
    fn alone(&self, member: Member, model: usize, moves: &[Move]) -> Speed {
        let own = moves.iter().find_map(|m| match m {
            Move::Object { object, path } if Member::Object(*object) == member => Some(*path),
            _ => None,
        });
        own.map_or(Speed::REST, |path| Speed::of_path(path, self.levers.radius(model)))
    }

    /// Moves everything to where it is at `t`.
    pub fn go(&mut self, scene: &Scene, moves: &[Move], t: f64) {
        for (robot, leg) in self.legs.iter().enumerate().filter(|(_, l)| l.moves) {
            let chain = &mut self.state.chains[robot];
            for (q, (from, rate)) in chain.q.iter_mut().zip(leg.from.iter().zip(&leg.rate)) {
                *q = from + rate * t;
            }
            scene.robots[robot].robot.chain.forward(chain);
            self.state.moved(scene, robot);
        }
        for m in moves {
            if let Move::Object { object, path } = m {
                self.state.put(scene, scene.first_object + object, path.pose(t));
            }
        }
        self.velocities_known = false;
        self.now = t;
    }

    /// The two sides of a pair, each as seen from the last link that both hang on.
    pub fn sides(&self, scene: &Scene, a: usize, b: usize) -> [Side; 2] {
        let carriers = [a, b].map(|m| self.state.carrier(scene.models[m].member));
        let cut = match carriers {
            [Some((ra, la)), Some((rb, lb))] if ra == rb => self.levers.common(ra, la, lb),
            _ => 0,
        };
        [Side { model: a, cut }, Side { model: b, cut }]
    }

    /// Bounds that hold during all of the motion.
    pub fn speed(&self, side: Side) -> Speed {
        self.speeds[(self.first[side.model] + side.cut).min(self.first[side.model + 1] - 1)]
    }

    /// Metres below which places of this size cannot be told apart.
    pub fn finest(&self, a: usize, b: usize) -> f64 {
        64.0 * f64::EPSILON * (self.sizes[a] + self.sizes[b])
    }

    /// True where what was proven when the scene was built holds during all of the motion.
    pub fn proofs_hold(&self, member: Member) -> bool {
        match member {
            Member::Link { robot, .. } => self.legs[robot].within,
            Member::Object(o) => self.free[o].is_none() && self.state.proofs_hold(member),
        }
    }

    /// True where the object moves by itself.
    pub fn is_free(&self, object: usize) -> bool {
        self.free[object].is_some()
    }

    /// The largest speed of any point of a side at the present instant, metres per unit of time.
    pub fn speed_now(&mut self, scene: &Scene, side: Side) -> f64 {
        let bound = self.speed(side);
        if bound.cap == 0.0 {
            return 0.0;
        }
        let member = scene.models[side.model].member;
        if self.state.carrier(member).is_some() {
            self.know_velocities(scene);
        }
        let Some(corners) = self.levers.corners(side.model) else { return bound.cap };
        let in_world = self.state.in_world[side.model];
        let fastest = if let Some((robot, link)) = self.state.carrier(member) {
            let base = &scene.robots[robot].base_in_world;
            let above = self.levers.above(robot, link, side.cut);
            let own = self.twist(robot, link);
            let other = above.map_or((Vec3::ZERO, Vec3::ZERO), |l| self.twist(robot, l));
            // The field of relative velocities: at the root's origin, and how it turns.
            let (velocity, turn) = (own.0 - other.0, own.1 - other.1);
            let in_root = base.inverse_mul(&in_world);
            longest(corners, |p| velocity + turn.cross(in_root.transform_point(p)))
        } else {
            let Member::Object(o) = member else { return bound.cap };
            let Some(Free { steady: Some(s) }) = self.free[o] else { return bound.cap };
            longest(corners, |p| s.velocity_at(in_world.transform_point(p), self.now))
        };
        // Rounding is relative to the parts, not to their difference.
        let careful = fastest * (1.0 + 1e-9) + 1e-12 * bound.cap;
        if careful < bound.cap { careful } else { bound.cap }
    }

    /// Velocity of the point of a link that is at the root's origin, and the link's turn, in the root's frame.
    fn twist(&self, robot: usize, link: LinkId) -> (Vec3, Vec3) {
        let (motion, at) = (self.state.chains[robot].link_motion(link), self.state.chains[robot].link_in_root(link));
        (motion.velocity_at(-at.translation), motion.angular_velocity)
    }

    fn know_velocities(&mut self, scene: &Scene) {
        if !std::mem::replace(&mut self.velocities_known, true) {
            for (robot, _) in self.legs.iter().enumerate().filter(|(_, l)| l.moves) {
                scene.robots[robot].robot.chain.forward_motion(&mut self.state.chains[robot]);
            }
        }
    }
}

/// A length that is NaN is no bound.
fn longest(points: &[Vec3], velocity: impl Fn(Vec3) -> Vec3) -> f64 {
    let known = |v: f64| if v.is_nan() { f64::INFINITY } else { v };
    points.iter().map(|p| known(velocity(*p).length_squared())).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Object, Robot};
    use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, Mimic};
    use elbowroom_proximity::{Cuboid, Shape};
    use elbowroom_spatial::{Pose, Rotation};

    struct Random(u64);

    impl Random {
        fn between(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn vec3(&mut self, size: f64) -> Vec3 {
            Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
        }

        fn pose(&mut self) -> Pose {
            Pose::new(Rotation::from_rotation_vector(self.vec3(2.0)), self.vec3(0.3))
        }
    }

    /// Turning, sliding, fixed and following joints at all angles, and a held object.
    fn scene(r: &mut Random) -> Scene {
        use JointKind::{Continuous, Fixed, Prismatic, Revolute};
        let kinds = [Revolute, Prismatic, Fixed, Revolute, Continuous, Revolute, Prismatic];
        let joint = |(i, kind): (usize, JointKind)| Joint {
            name: format!("j{i}"),
            kind,
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: r.pose(),
            axis: r.vec3(1.0),
            limits: Limits::symmetric(2.0),
            mimic: (i == 5).then(|| Mimic { joint: JointId(0), multiplier: -1.5, offset: 0.2 }),
        };
        let joints = kinds.into_iter().enumerate().map(joint).collect();
        let links = (0..=kinds.len()).map(|i| format!("l{i}")).collect();
        let mut robot = Robot::new(Chain::new("any", links, joints).unwrap());
        let solid = |r: &mut Random| Shape::Cuboid(Cuboid { half_extents: r.vec3(0.1).abs() + Vec3::splat(0.01) });
        for bodies in &mut robot.bodies {
            bodies.push(Body { name: String::new(), shape: solid(r), in_link: r.pose() });
        }
        let mut builder = Scene::builder();
        builder.reach(false);
        builder.robot("any", robot, r.pose());
        for name in ["held", "free"] {
            builder.object(Object { name: name.into(), shape: solid(r), in_world: r.pose() });
        }
        builder.build().unwrap()
    }

    #[test]
    fn no_point_goes_farther_than_the_bounds_say_seen_from_any_link() {
        let mut r = Random(3);
        let mut tightest: f64 = 0.0;
        for _ in 0..60 {
            let scene = scene(&mut r);
            let mut start = SceneState::new(&scene);
            let dof = scene.robots[0].robot.chain.dof();
            let mut q = |size: f64| (0..dof).map(|_| r.between(-size, size)).collect::<Vec<_>>();
            let to = q(2.0);
            start.set_q(&scene, 0, &q(2.0)).unwrap();
            let hand = LinkId(scene.robots[0].robot.chain.links().len() - 1);
            start.attach(&scene, 0, 0, hand, &[]).unwrap();
            let path = Steady { start: r.pose(), pivot: r.vec3(0.5), velocity: r.vec3(1.0), rotation: r.vec3(2.0) };
            let moves = [Move::Robot { robot: 0, to: &to }, Move::Object { object: 1, path: &path }];
            let mut travel = Travel::new(&scene, Level::L3);
            travel.depart(&scene, &start, &moves).unwrap();
            for (model, m) in scene.models.iter().enumerate() {
                let carrier = start.carrier(m.member);
                let above = carrier.map_or(0, |(_, link)| scene.robots[0].robot.chain.path(link).len());
                for cut in 0..=above {
                    let side = Side { model, cut };
                    // The member as seen from the link that is so many joints above the root.
                    let seen = |travel: &Travel| {
                        let link = carrier.and_then(|(robot, link)| travel.levers.above(robot, link, cut));
                        let from = link.map_or(Pose::IDENTITY, |l| travel.state.link_in_world(&scene, 0, l));
                        from.inverse_mul(&travel.state.in_world[model])
                    };
                    let (t, u) = (r.between(0.0, 1.0), r.between(0.0, 1.0));
                    travel.go(&scene, &moves, t);
                    let (before, now, speed) = (seen(&travel), travel.speed_now(&scene, side), travel.speed(side));
                    travel.go(&scene, &moves, u);
                    let after = seen(&travel);
                    let way = |p: &Vec3| before.transform_point(*p).distance(after.transform_point(*p));
                    let farthest = travel.levers.corners(model).unwrap().iter().map(way).fold(0.0, f64::max);
                    let bound = speed.over(now, (t - u).abs());
                    assert!(farthest <= bound + 1e-12, "{farthest} {bound} {:?} {cut}", m.member);
                    assert!(now <= speed.cap);
                    if farthest > 1e-3 {
                        tightest = tightest.max(farthest / bound);
                    }
                }
            }
        }
        assert!(tightest > 0.9, "{tightest}");
    }
}
