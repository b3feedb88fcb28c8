//! The stopping-distance law: the largest override from which a stop still ends before a region.
//!
//! Two bounds of how far a volume can still go, both for every program that keeps to the accelerations of
//! [`Stopping`](crate::Stopping); the smaller one counts. **By the program's time**: until the robot stands the program runs
//! on for no longer than some time u, and within u no joint leaves its straight course `q′·u` by more than `A·u²/2`. **By the
//! stop**: once it brakes no joint goes farther than `a·n²/2`, whatever the program does. The first is the better one for a
//! robot that passes by or leaves, the second for one that goes straight at a region. `docs/laws.md`, section 7, derives them.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::{Pose, Vec3};

use crate::brake_watch::BrakeWatch;
use crate::commands::{Commands, Obeyed};
use crate::laws::{stop_time, stopping_program_time};
use crate::{Configuration, Stopping, Volume};

/// A robot that is slowed down still runs by earlier, higher overrides: the override is chosen as if it obeyed so many times
/// later than it does. Without this margin the proof would fail from time to time, and the override fall to 0 and rise again.
const LAG: f64 = 2.0;

/// What the law knows in one tick; the memory is taken once.
#[derive(Debug)]
pub(crate) struct StoppingLaw {
    axes: Vec<Axis>,
    volumes: Vec<CarriedVolume>,
    /// Speeds that the program asks for at override 1, per joint.
    program: Pace,
    /// Speeds that the robot has, per joint.
    real: Pace,
    /// False where the program's speeds are only inferred from the robot's.
    program_is_known: bool,
    commands: Commands,
    /// From the snapshot to the start of a stop that is asked for in the next tick, s.
    horizon_s: f64,
    /// The robot stands after this time at the latest, s.
    stands_after_s: f64,
    /// Over how long velocities were derived from positions, s.
    uncertain_s: f64,
    /// Program time that may have passed unnoticed, as the joint values have not changed, s.
    unnoticed_s: f64,
    /// What the robot does until this tick's answer counts.
    pending: Pending,
    brakes: BrakeWatch,
}

/// A joint in the world.
#[derive(Debug, Clone, Copy)]
struct Axis {
    child: LinkId,
    in_child: Vec3,
    direction: Vec3,
    origin: Vec3,
}

/// A volume and the joints that carry it.
#[derive(Debug)]
struct CarriedVolume {
    link: LinkId,
    /// Centre and radius of a sphere around it, in the frame of its shape.
    center_in_shape: Vec3,
    radius: f64,
    /// From the root outwards.
    levers: Vec<Lever>,
    center: Vec3,
    /// In any direction.
    anywhere: Approach,
    /// It comes no farther than this until the robot stands, in any direction, m.
    reach_m: f64,
}

/// How a joint moves a volume.
#[derive(Debug, Clone, Copy)]
struct Lever {
    axis: usize,
    /// Index in q.
    joint: usize,
    /// Per unit of q.
    scale: f64,
    turns: bool,
    /// No point of the volume is farther from the axis, in any configuration, m; 1 for a slide.
    farthest: f64,
}

/// Joint speeds and their stop time.
#[derive(Debug)]
struct Pace {
    speed: Vec<f64>,
    stop_s: f64,
}

/// How fast a volume comes nearer along a direction, at override 1.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Approach {
    /// By the program, m/s; negative where it leaves.
    pub(crate) program_speed: f64,
    /// By what the robot really does, m/s.
    pub(crate) real_speed: f64,
    /// By the largest accelerations of all joints together, m/s².
    acceleration: f64,
    /// By the decelerations of all joints together, m/s².
    deceleration: f64,
}

/// Until a robot stands; times in s.
#[derive(Debug, Clone, Copy)]
struct Course {
    /// Program time until it brakes.
    run: f64,
    /// Stop time when it begins to brake.
    stop: f64,
    /// Program time until it stands.
    total: f64,
}

/// What the robot does until this tick's answer counts, at most.
#[derive(Debug, Clone, Copy, Default)]
struct Pending {
    /// Program time that passes, s.
    run_s: f64,
    /// Override that it has then.
    speed_override: f64,
}

impl StoppingLaw {
    pub(crate) fn new(config: &Configuration, stopping: &Stopping) -> Self {
        let chain = &config.chain;
        let axes = chain.joints().iter().map(|joint| Axis {
            child: joint.child,
            in_child: joint.axis,
            direction: Vec3::ZERO,
            origin: Vec3::ZERO,
        });
        let pace = || Pace { speed: vec![0.0; chain.dof()], stop_s: 0.0 };
        Self {
            axes: axes.collect(),
            volumes: config.volumes.iter().map(|v| CarriedVolume::new(chain, v)).collect(),
            program: pace(),
            real: pace(),
            program_is_known: false,
            commands: Commands::new(stopping.reaction_s, config.laws.stale_s),
            horizon_s: 0.0,
            stands_after_s: 0.0,
            uncertain_s: 0.0,
            unnoticed_s: 0.0,
            pending: Pending::default(),
            brakes: BrakeWatch::default(),
        }
    }

    /// Takes note of what the robot was told.
    pub(crate) fn told(&mut self, now_s: f64, speed_override: f64) {
        self.commands.push(now_s, speed_override);
    }

    /// The overrides that the robot may be obeying.
    pub(crate) fn obeyed(&self, now_s: f64) -> Obeyed {
        self.commands.obeyed(now_s)
    }

    /// True where the robot brakes less than was stated.
    pub(crate) fn brakes_too_little(&self) -> bool {
        self.brakes.failed()
    }

    /// The stop time that the robot may have by what it was told, s; infinite where that is not known.
    fn told_stop_s(&self) -> f64 {
        match self.commands.largest() {
            0.0 => 0.0,
            told if self.program_is_known => told * self.program.stop_s,
            _ => f64::INFINITY,
        }
    }

    /// Begins a tick. `intent` is the chain at the program's own speed, `now` as it is; velocities that were derived from
    /// positions are uncertain by what joints accelerate in `uncertain_s`.
    pub(crate) fn begin(&mut self, config: &Configuration, stopping: &Stopping, tick: &TickState) {
        let TickState { now, intent, .. } = *tick;
        let (decelerations, accelerations) = (&stopping.joint_deceleration, &stopping.joint_acceleration);
        let growth = stop_time(accelerations, decelerations);
        let wider = |speed: &f64, a: &f64| speed.abs() + a * tick.uncertain_s;
        for (to, (v, a)) in self.real.speed.iter_mut().zip(now.qd.iter().zip(accelerations)) {
            *to = wider(v, a);
        }
        for (to, v) in self.program.speed.iter_mut().zip(&intent.qd) {
            *to = v.abs();
        }
        self.real.stop_s = stop_time(&self.real.speed, decelerations);
        self.program.stop_s = stop_time(&self.program.speed, decelerations);
        self.program_is_known = tick.program_is_known;
        (self.uncertain_s, self.unnoticed_s) = (tick.uncertain_s, tick.unnoticed_s);
        let until_answer_s = tick.now_s - tick.stamp_s + stopping.reaction_s;
        self.horizon_s = until_answer_s + stopping.period_s;
        let full = self.program.stop_s;
        let running = match self.real.stop_s {
            n if n < 1e-9 => 0.0,
            n => (n / full.max(1e-12)).min(1.0),
        };
        let (run_s, speed_override) =
            self.commands.run(tick.stamp_s, tick.now_s, running, |run_s| (full + growth * run_s, growth));
        self.pending = Pending { run_s, speed_override };
        self.brakes.look(tick.stamp_s, stop_time(&now.qd, decelerations), self.told_stop_s());
        for axis in &mut self.axes {
            let child = config.base_in_world * now.link_in_root(axis.child);
            (axis.direction, axis.origin) = (child.transform_vector(axis.in_child), child.translation);
        }
        for (volume, in_world) in self.volumes.iter_mut().zip(tick.volume_in_world) {
            volume.place(&self.axes, stopping, in_world);
            let [program_speed, real_speed] = [intent, now].map(|state| volume.fastest(config, state));
            volume.anywhere.program_speed = program_speed;
            volume.anywhere.real_speed = real_speed + volume.anywhere.acceleration * tick.uncertain_s;
        }
        self.find_reach(stopping, tick.programmed_override);
    }

    /// How a volume comes nearer along the unit vector `towards` (world), where its points do so no faster than given, m/s.
    pub(crate) fn approach(
        &self,
        stopping: &Stopping,
        volume: usize,
        towards: Vec3,
        [program_speed, real_speed]: [f64; 2],
    ) -> Approach {
        let of = &self.volumes[volume];
        let (mut acceleration, mut deceleration) = (0.0, 0.0);
        for lever in &of.levers {
            let reach = lever.along(&self.axes, of.center, of.radius, towards);
            acceleration += reach * stopping.joint_acceleration[lever.joint];
            deceleration += reach * stopping.joint_deceleration[lever.joint];
        }
        let real_speed = real_speed + acceleration * self.uncertain_s;
        Approach { program_speed, real_speed, acceleration, deceleration }
    }

    /// As [`StoppingLaw::approach`], whatever the direction.
    pub(crate) fn approach_anywhere(&self, volume: usize) -> Approach {
        self.volumes[volume].anywhere
    }

    /// The largest override up to `most` from which the volume comes no nearer than `left_m`, while the region comes nearer
    /// with `region_speed` (m/s) until the robot stands.
    pub(crate) fn limit(&self, stopping: &Stopping, gap: &Gap, most: f64) -> f64 {
        let growth = stop_time(&stopping.joint_acceleration, &stopping.joint_deceleration);
        let fits = |c: f64| self.fits(stopping, gap, &self.course(c, growth));
        let limit = if fits(most) {
            most
        } else if fits(0.0) {
            bisect(most, fits)
        } else {
            return 0.0;
        };
        if self.may_ask(stopping, gap, limit, growth) { limit } else { 0.0 }
    }

    /// True where a stop that is asked for in this tick ends outside.
    pub(crate) fn stops_outside(&self, stopping: &Stopping, gap: &Gap) -> bool {
        let growth = stop_time(&stopping.joint_acceleration, &stopping.joint_deceleration);
        self.may_ask(stopping, gap, 0.0, growth)
    }

    /// How far (m) a volume can still go, in any direction; with the time until then, s.
    pub(crate) fn reach(&self, volume: usize) -> (f64, f64) {
        (self.volumes[volume].reach_m, self.stands_after_s)
    }

    /// True where the volume cannot come so far (m), whatever its direction.
    pub(crate) fn is_out_of_reach(&self, volume: usize, distance_m: f64) -> bool {
        self.volumes[volume].reach_m < distance_m
    }

    /// True where the program's speeds are known and not only inferred.
    pub(crate) fn program_is_known(&self) -> bool {
        self.program_is_known
    }

    /// Finds how far each volume can still go where the program's override is `most`.
    fn find_reach(&mut self, stopping: &Stopping, most: f64) {
        let growth = stop_time(&stopping.joint_acceleration, &stopping.joint_deceleration);
        let courses = [self.course(most, growth), self.pending_course(most, stopping.period_s, growth)];
        let real = self.real_course(growth);
        let stop_s = courses.iter().fold(real.stop, |most: f64, c| most.max(c.stop));
        self.stands_after_s = self.horizon_s + stop_s;
        for volume in 0..self.volumes.len() {
            let approach = self.volumes[volume].anywhere;
            let travel = |course: &Course| self.travel(stopping, volume, &approach, course, &self.program);
            let mut reach_m = travel(&courses[0]).max(travel(&courses[1]));
            if !self.program_is_known {
                let approach = Approach { program_speed: approach.real_speed, ..approach };
                reach_m = reach_m.max(self.travel(stopping, volume, &approach, &real, &self.real));
            }
            self.volumes[volume].reach_m = reach_m;
        }
    }

    /// Where the robot runs at override `c`.
    fn course(&self, c: f64, growth: f64) -> Course {
        self.stop_after(LAG * c * self.horizon_s + self.unnoticed_s, c, growth)
    }

    /// Where it does until then what it was told before, and `c` after that.
    fn pending_course(&self, c: f64, period_s: f64, growth: f64) -> Course {
        let faster = self.pending.speed_override.max(c);
        self.stop_after(self.pending.run_s + faster * period_s + self.unnoticed_s, faster, growth)
    }

    fn stop_after(&self, run_s: f64, sigma: f64, growth: f64) -> Course {
        let full_stop_s = self.program.stop_s + growth * run_s;
        Course {
            run: run_s,
            stop: sigma * full_stop_s,
            total: run_s + stopping_program_time(sigma, full_stop_s, growth),
        }
    }

    /// Where nothing is known but how the robot really moves: all accelerate until the stop begins.
    fn real_course(&self, growth: f64) -> Course {
        let run_s = self.horizon_s + self.unnoticed_s;
        let stop_s = self.real.stop_s + growth * run_s;
        Course { run: run_s, stop: stop_s, total: run_s + stop_s }
    }

    fn may_ask(&self, stopping: &Stopping, gap: &Gap, c: f64, growth: f64) -> bool {
        if self.program_is_known {
            return self.fits(stopping, gap, &self.pending_course(c, stopping.period_s, growth));
        }
        let course = self.real_course(growth);
        let approach = Approach { program_speed: gap.approach.real_speed, ..gap.approach };
        let nearer = gap.region_speed * (self.horizon_s + course.stop);
        self.travel(stopping, gap.volume, &approach, &course, &self.real) + nearer <= gap.left_m
    }

    fn fits(&self, stopping: &Stopping, gap: &Gap, course: &Course) -> bool {
        let nearer = gap.region_speed * (self.horizon_s + course.stop);
        // Whatever is not a number does not fit.
        self.travel(stopping, gap.volume, &gap.approach, course, &self.program) + nearer <= gap.left_m
    }

    /// The smaller of the two bounds, m.
    fn travel(&self, stopping: &Stopping, volume: usize, approach: &Approach, course: &Course, pace: &Pace) -> f64 {
        let levers = &self.volumes[volume].levers;
        let acceleration = &stopping.joint_acceleration;
        let drift = |j: usize, u: f64| pace.speed[j] * u + 0.5 * acceleration[j] * u * u;
        let u = course.total;
        let by_program =
            approach.program_speed * u + 0.5 * approach.acceleration * u * u + bending(levers, |j| drift(j, u));
        let (u, stop) = (course.run, 0.5 * course.stop * course.stop);
        let by_stop = approach.program_speed.max(0.0) * u
            + 0.5 * approach.acceleration * u * u
            + approach.deceleration * stop
            + bending(levers, |j| drift(j, u) + stopping.joint_deceleration[j] * stop);
        by_program.min(by_stop)
    }
}

/// What a tick brings.
pub(crate) struct TickState<'a> {
    pub(crate) now: &'a ChainState,
    pub(crate) intent: &'a ChainState,
    pub(crate) program_is_known: bool,
    pub(crate) now_s: f64,
    pub(crate) stamp_s: f64,
    pub(crate) programmed_override: f64,
    pub(crate) uncertain_s: f64,
    pub(crate) unnoticed_s: f64,
    pub(crate) volume_in_world: &'a [Pose],
}

/// A volume before a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    pub(crate) volume: usize,
    pub(crate) approach: Approach,
    /// How far it may still go, m.
    pub(crate) left_m: f64,
    /// How fast the region comes nearer by itself, m/s.
    pub(crate) region_speed: f64,
}

impl Gap {
    /// With so much (m) kept in reserve.
    pub(crate) fn shorter(self, reserve_m: f64) -> Self {
        Self { left_m: self.left_m - reserve_m, ..self }
    }
}

impl CarriedVolume {
    fn new(chain: &Chain, volume: &Volume) -> Self {
        let bounds = volume.shape.aabb(&Pose::IDENTITY);
        let (center_in_shape, radius) = (bounds.center(), 0.5 * bounds.extent().length());
        let mut farthest = radius + volume.in_link.transform_point(center_in_shape).length();
        let mut levers = Vec::new();
        for id in chain.path(volume.link).iter().rev() {
            let joint = &chain.joints()[id.0];
            let mimic = chain.mimic_source(*id);
            let (source, scale, offset) =
                mimic.map_or((*id, 1.0, 0.0), |m| (m.joint, m.multiplier.abs(), m.offset.abs()));
            if let Some(index) = chain.q_index(source).filter(|_| joint.kind.moves()) {
                let turns = joint.kind.turns();
                let farthest = if turns { farthest } else { 1.0 };
                levers.push(Lever { axis: id.0, joint: index, scale, turns, farthest });
            }
            farthest += joint.origin.translation.length();
            if !joint.kind.turns() && joint.kind.moves() {
                let stroke = chain.joints()[source.0].limits;
                farthest += stroke.lower.abs().max(stroke.upper.abs()) * scale + offset;
            }
        }
        levers.reverse();
        let anywhere = Approach::default();
        Self {
            link: volume.link,
            center_in_shape,
            radius,
            levers,
            center: Vec3::ZERO,
            anywhere,
            reach_m: f64::INFINITY,
        }
    }

    fn place(&mut self, axes: &[Axis], stopping: &Stopping, in_world: &Pose) {
        self.center = in_world.transform_point(self.center_in_shape);
        let (mut acceleration, mut deceleration) = (0.0, 0.0);
        for lever in &self.levers {
            let reach = lever.anywhere(axes, self.center, self.radius);
            acceleration += reach * stopping.joint_acceleration[lever.joint];
            deceleration += reach * stopping.joint_deceleration[lever.joint];
        }
        (self.anywhere.acceleration, self.anywhere.deceleration) = (acceleration, deceleration);
    }

    /// No point of it is faster, m/s.
    fn fastest(&self, config: &Configuration, state: &ChainState) -> f64 {
        let motion = state.link_motion(self.link);
        let origin = config.base_in_world.transform_point(state.link_in_root(self.link).translation);
        let offset = config.base_in_world.inverse_transform_vector(self.center - origin);
        motion.velocity_at(offset).length() + motion.angular_velocity.length() * self.radius
    }
}

impl Lever {
    /// How far at most a unit of the joint moves a point of the sphere along the unit vector `towards`, m.
    #[inline]
    fn along(&self, axes: &[Axis], center: Vec3, radius: f64, towards: Vec3) -> f64 {
        let axis = &axes[self.axis];
        if !self.turns {
            return self.scale * axis.direction.dot(towards).abs();
        }
        let across = towards.cross(axis.direction);
        self.scale * (across.dot(center - axis.origin).abs() + radius * across.length())
    }

    /// How far at most a unit of the joint moves a point of the sphere, m.
    #[inline]
    fn anywhere(&self, axes: &[Axis], center: Vec3, radius: f64) -> f64 {
        if !self.turns {
            return self.scale;
        }
        let axis = &axes[self.axis];
        self.scale * (axis.direction.cross(center - axis.origin).length() + radius)
    }
}

/// How far (m) a point may be from where its velocity alone would take it, when each joint moves by no more than `by`:
/// half of the second derivative of its position, `|∂²p/∂qᵢ∂qⱼ|` being at most the lever of the outer joint where the inner
/// one turns, and 0 where that slides.
#[inline]
fn bending(levers: &[Lever], by: impl Fn(usize) -> f64) -> f64 {
    let (mut sum, mut turned) = (0.0, 0.0);
    for lever in levers {
        let moved = by(lever.joint) * lever.scale;
        sum += lever.farthest * moved * turned;
        if lever.turns {
            sum += 0.5 * lever.farthest * moved * moved;
            turned += moved;
        }
    }
    sum
}

/// The largest value below `most` for which `fits` holds, to a part in sixty thousands; it holds for 0.
fn bisect(most: f64, fits: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests;
