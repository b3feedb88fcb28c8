//! The navigator: one step of a tool towards a desired pose, around protected surfaces.

use std::sync::Arc;

use elbowroom_proximity::advanced::{LocalMinimum, NormalConeHierarchy, for_each_local_minimum, mesh_separation_with};
use elbowroom_proximity::{DistanceSettings, Separation, TriMesh, Workspace};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::constraint_set::ConstraintSet;
use crate::navigation_step::{Limit, NavigationStep};
use crate::remote_center::{PivotMotion, RemoteCenter};
use crate::surface_clearance::{SurfaceClearance, Tool};
use crate::{LinearConstraint, NavigatorError, NavigatorSettings, ProtectedSurface};

/// Most distance queries per step and surface in the proof of a step that is longer than the gap.
const PROOF_STEPS: usize = 32;
/// Relative rounding of an angle.
const ROUNDING: f64 = 1e-6;
/// Angular deceleration of a tool that turns to its point of entry, rad/s².
const TURN_BRAKING_RAD_S2: f64 = 5.0;
/// How often a step that turns the tool about its point of entry, and is not proven, is halved.
const PIVOT_HALVINGS: usize = 5;

/// Moves a tool towards a desired pose, step by step, around surfaces that it never enters.
///
/// The tool is a mesh in the frame of the tool point. Steps never allocate, and equal input gives equal bits.
#[derive(Debug)]
pub struct SurfaceNavigator {
    tool: NormalConeHierarchy,
    /// Largest distance of a point of the tool from the tool point, metres.
    tool_reach_m: f64,
    surfaces: Vec<ProtectedSurface>,
    /// What is known of the distance to each surface.
    clearances: Vec<SurfaceClearance>,
    settings: NavigatorSettings,
    tool_in_world: Pose,
    /// Velocity of the tool point at override 1, m/s.
    velocity: Vec3,
    /// Pose and velocity before the last step.
    before: (Pose, Vec3),
    /// The velocities that the surfaces nearby admit, and the displacements.
    velocities: ConstraintSet,
    displacements: ConstraintSet,
    center: Option<RemoteCenter>,
    workspace: Box<Workspace>,
}

/// What became of a travel: the fraction that was made, and the motion that is proven beyond it (m).
struct Carried {
    fraction: f64,
    turned_rad: f64,
    slack_m: f64,
    limit: Option<Limit>,
}

/// What the tool is to do in a step.
#[derive(Clone, Copy)]
enum Wish<'a> {
    Pose(&'a Pose),
    Velocity(Vec3),
}

impl SurfaceNavigator {
    /// Places the tool, at rest.
    ///
    /// # Errors
    /// A setting that is not usable, a pose that is not finite, or a start that is nearer to a surface than the least
    /// gap.
    pub fn new(
        tool: Arc<TriMesh>,
        surfaces: Vec<ProtectedSurface>,
        tool_in_world: Pose,
        settings: NavigatorSettings,
    ) -> Result<Self, NavigatorError> {
        settings.check()?;
        if !tool_in_world.is_finite() {
            return Err(NavigatorError::PoseNotFinite("the tool"));
        }
        let tool_reach_m = tool.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
        let mut navigator = Self {
            tool: NormalConeHierarchy::new(tool),
            tool_reach_m,
            clearances: vec![SurfaceClearance::default(); surfaces.len()],
            surfaces,
            settings,
            tool_in_world,
            velocity: Vec3::ZERO,
            before: (tool_in_world, Vec3::ZERO),
            velocities: ConstraintSet::EMPTY,
            displacements: ConstraintSet::EMPTY,
            center: None,
            workspace: Box::new(Workspace::new()),
        };
        let gap_m = navigator.least_distance(tool_in_world, 2.0 * settings.least_gap_m);
        if gap_m < settings.least_gap_m {
            return Err(NavigatorError::TooNear { gap_m, least_gap_m: settings.least_gap_m });
        }
        Ok(navigator)
    }

    /// Pose of the tool in the world.
    pub fn tool_in_world(&self) -> Pose {
        self.tool_in_world
    }

    /// Moves the tool for `dt_s` seconds towards the desired pose.
    ///
    /// The tool point takes the admissible velocity nearest to the desired one. The orientation follows as far as the
    /// gap proves that turning is free. After input that is not usable the tool stands, and the result says why.
    pub fn step(&mut self, desired: &Pose, dt_s: f64) -> NavigationStep {
        self.step_at_override(desired, dt_s, 1.0)
    }

    /// Like [`step`](Self::step), with the velocity scaled by an override, 0 to 1 (NaN counts as 0).
    ///
    /// The limit of acceleration is for the scaled velocity: at a small override the tool turns back as soon as the hand
    /// does.
    pub fn step_at_override(&mut self, desired: &Pose, dt_s: f64, speed_override: f64) -> NavigationStep {
        if !(desired.is_finite() && desired.translation.length().is_finite()) {
            self.before = (self.tool_in_world, self.velocity);
            return self.stand(Limit::PoseNotFinite);
        }
        self.advance(Wish::Pose(desired), dt_s, speed_override)
    }

    /// Moves the tool for `dt_s` seconds with a desired velocity (m/s, at override 1), and keeps its orientation.
    ///
    /// The tool takes the admissible velocity nearest to the desired one, within the limit of speed. It slows down at once,
    /// and changes its velocity otherwise within the limit of acceleration.
    pub fn step_at_velocity(&mut self, velocity: Vec3, dt_s: f64, speed_override: f64) -> NavigationStep {
        if !velocity.length().is_finite() {
            self.before = (self.tool_in_world, self.velocity);
            return self.stand(Limit::PoseNotFinite);
        }
        self.advance(Wish::Velocity(velocity), dt_s, speed_override)
    }

    /// Turns the tool about its point towards the desired orientation for `dt_s` seconds, as far as the gap proves that
    /// turning is free. Returns false if it stays as it is.
    pub fn turn(&mut self, desired: &Pose, dt_s: f64, speed_override: f64) -> bool {
        self.before = (self.tool_in_world, self.velocity);
        let turn_rad = self.settings.turn_rad_s * dt_s * within_unit(speed_override);
        if !(desired.is_finite() && turn_rad > 0.0 && dt_s <= self.settings.longest_step_s) {
            return false;
        }
        let least_gap_m = self.settings.least_gap_m;
        let distance_m = self.least_distance(self.tool_in_world, least_gap_m + self.tool_reach_m * turn_rad);
        self.turn_towards(desired, turn_rad, (distance_m - least_gap_m).max(0.0));
        self.tool_in_world != self.before.0
    }

    /// Switches protected surfaces, all at once: `is_on` says of each, by its index, whether the tool keeps off it from now
    /// on.
    ///
    /// # Errors
    /// [`NavigatorError::TooNear`] if the tool is nearer to one that would be switched on than the least gap. Nothing is
    /// switched then.
    pub fn switch(&mut self, is_on: impl Fn(usize) -> bool) -> Result<(), NavigatorError> {
        let least_gap_m = self.settings.least_gap_m;
        for index in 0..self.surfaces.len() {
            if is_on(index) && !self.surfaces[index].is_on {
                let gap_m = self.distance_from(index, self.tool_in_world, 2.0 * least_gap_m);
                if gap_m < least_gap_m {
                    return Err(NavigatorError::TooNear { gap_m, least_gap_m });
                }
            }
        }
        for (index, surface) in self.surfaces.iter_mut().enumerate() {
            surface.is_on = is_on(index);
        }
        Ok(())
    }

    /// Keeps the shaft of the tool at a point of entry from the next step on; `None` lets it move freely.
    ///
    /// Each step turns the tool with its tip, which moves no faster than the tool may turn. A tool that is placed elsewhere
    /// turns until its shaft is there, and only then moves.
    pub fn set_remote_center(&mut self, center: Option<RemoteCenter>) {
        self.center = center;
    }

    /// Distance of the tool from a protected surface, by its index. `None` if the distance exceeds `limit_m`, or there is
    /// no such surface, or it is off.
    pub fn separation_from(&mut self, surface: usize, limit_m: f64) -> Option<Separation> {
        let protected = self.surfaces.get(surface).filter(|surface| surface.is_on)?;
        let settings = DistanceSettings { limit: limit_m, ..DistanceSettings::default() };
        mesh_separation_with(
            self.tool.mesh(),
            &self.tool_in_world,
            protected.surface.mesh(),
            &protected.in_world,
            settings,
            &mut self.workspace,
        )
    }

    /// The settings.
    pub fn settings(&self) -> &NavigatorSettings {
        &self.settings
    }

    /// Moves, then turns, as far as it is proven.
    fn advance(&mut self, wish: Wish<'_>, dt_s: f64, speed_override: f64) -> NavigationStep {
        let speed_override = within_unit(speed_override);
        self.before = (self.tool_in_world, self.velocity);
        if !(dt_s > 0.0 && dt_s <= self.settings.longest_step_s) {
            return self.stand(Limit::StepDuration);
        }
        // Of the velocity at override 1; without a limit at override 0.
        let largest_change = self.settings.acceleration_m_s2 * dt_s / speed_override;
        let Some(gap_m) = self.collect_constraints(dt_s, largest_change) else {
            return self.stand(Limit::DistanceUnknown);
        };
        let (wanted, on_the_way) = match wish {
            Wish::Pose(desired) => self.wanted_velocity(desired, dt_s),
            Wish::Velocity(velocity) => (velocity * (self.settings.speed_m_s / velocity.length()).min(1.0), 0),
        };
        let change = wanted - self.velocity;
        let (braking, change) = match wish {
            Wish::Pose(_) => (Vec3::ZERO, change),
            // What forces demand is physics: slowing down has no limit, up to standing.
            Wish::Velocity(_) => split_braking(self.velocity, change),
        };
        let share = if change.length() > largest_change { largest_change / change.length() } else { 1.0 };
        let (step_s, turn_rad) = (dt_s * speed_override, self.settings.turn_rad_s * dt_s * speed_override);
        let wanted = self.slowed_aside(self.velocity + braking + change * share, step_s, turn_rad);
        let (velocity, now) = self.velocities.nearest_to(wanted);
        // Two walls that are nearly opposite can ask for a velocity far above that of either.
        let velocity = velocity * (self.settings.speed_m_s / velocity.length()).min(1.0);
        let active_rows = now.max(on_the_way);
        let travel = velocity * step_s;
        // The proof does not rely on the constraints: their search uses normals, and this distance does not.
        let turns = self.center.is_some() || matches!(wish, Wish::Pose(_));
        let turn_m = if turns { self.tool_reach_m * turn_rad } else { 0.0 };
        let slack_limit_m = travel.length() + turn_m + self.settings.least_gap_m;
        let distance_m = self.least_distance(self.tool_in_world, slack_limit_m);
        let carried = self.carry(travel, turn_rad, (distance_m - self.settings.least_gap_m).max(0.0));
        self.velocity = velocity * carried.fraction;
        if let Wish::Pose(desired) = wish {
            self.turn_towards(desired, turn_rad - carried.turned_rad, carried.slack_m);
        }
        let limit = carried.limit.or_else(|| (active_rows > 0).then_some(Limit::Surface));
        let is_near = distance_m < slack_limit_m;
        let is_in_range = !self.velocities.as_slice().is_empty();
        let gap_m = if is_near { Some(distance_m) } else { is_in_range.then_some(gap_m) };
        let velocity = self.velocity * speed_override;
        NavigationStep { tool_in_world: self.tool_in_world, velocity, gap_m, active_rows, limit }
    }

    /// The velocity with which the tip may move so that the tool does not turn too fast about its point of entry.
    fn slowed_aside(&self, velocity: Vec3, step_s: f64, turn_rad: f64) -> Vec3 {
        let Some(center) = &self.center else { return velocity };
        center.slowed_aside(&self.tool_in_world, velocity, step_s, turn_rad)
    }

    /// Moves the tool as far along a travel as a slack or a distance proves; with a point of entry it turns as well.
    fn carry(&mut self, travel: Vec3, turn_rad: f64, slack_m: f64) -> Carried {
        let Some(center) = self.center else {
            let motion = PivotMotion { travel, turn: Vec3::ZERO };
            let fraction = if travel.length() <= slack_m { 1.0 } else { self.proven_fraction(&motion) };
            self.tool_in_world.translation += travel * fraction;
            let slack_m = if fraction < 1.0 { 0.0 } else { (slack_m - travel.length()).max(0.0) };
            let limit = (fraction < 1.0).then_some(Limit::Proof);
            return Carried { fraction, turned_rad: 0.0, slack_m, limit };
        };
        let start = self.tool_in_world;
        let missed_rad = center.missed_rad(&start);
        let is_missed = missed_rad > 0.0;
        let mut limit = is_missed.then_some(Limit::Entry);
        // A shaft that is not at the point yet turns there, slow enough to stop, and its tip waits.
        let slow_rad = (2.0 * TURN_BRAKING_RAD_S2 * missed_rad).sqrt() * (turn_rad / self.settings.turn_rad_s);
        let (mut fraction, mut most_rad) = if is_missed {
            (0.0, turn_rad.min(slow_rad))
        } else {
            (center.turnable_fraction(&start, travel, turn_rad), turn_rad)
        };
        for _ in 0..=PIVOT_HALVINGS {
            let motion = center.motion(&start, travel * fraction, most_rad);
            let needed_m = self.needed_m(&motion);
            if needed_m <= slack_m || self.proven_fraction(&motion) >= 1.0 {
                self.tool_in_world = motion.carried(&start, 1.0);
                let slack_m = if is_missed { 0.0 } else { (slack_m - needed_m).max(0.0) };
                return Carried { fraction, turned_rad: motion.turn.length(), slack_m, limit };
            }
            limit = limit.or(Some(Limit::Proof));
            fraction *= 0.5;
            most_rad *= if is_missed { 0.5 } else { 1.0 };
        }
        Carried { fraction: 0.0, turned_rad: 0.0, slack_m: 0.0, limit: Some(Limit::Entry) }
    }

    /// Largest motion of a point of the tool, metres.
    fn needed_m(&self, motion: &PivotMotion) -> f64 {
        motion.travel.length() + self.tool_reach_m * motion.turn.length()
    }

    /// Takes the last step back: what carries the tool could not follow it.
    pub fn undo(&mut self) {
        (self.tool_in_world, self.velocity) = self.before;
    }

    /// Stops the tool where it is.
    pub fn stand_still(&mut self) -> NavigationStep {
        self.velocity = Vec3::ZERO;
        NavigationStep {
            tool_in_world: self.tool_in_world,
            velocity: Vec3::ZERO,
            gap_m: None,
            active_rows: 0,
            limit: None,
        }
    }

    fn stand(&mut self, limit: Limit) -> NavigationStep {
        NavigationStep { limit: Some(limit), ..self.stand_still() }
    }

    /// The velocity with which the tool point would follow if it could: towards the admissible point nearest to the
    /// desired one, within the limit of speed, and slow enough to stop there.
    ///
    /// The desired point is projected before the speed is limited, so that a hand deep inside a solid does not slow the
    /// tool down along its surface. Also returns the number of constraints that keep it from the desired point.
    fn wanted_velocity(&mut self, desired: &Pose, dt_s: f64) -> (Vec3, usize) {
        let way = desired.translation - self.tool_in_world.translation;
        let (way, active) = self.displacements.nearest_to(way);
        let s = &self.settings;
        let distance = way.length();
        let speed = (distance / dt_s).min(s.speed_m_s).min((2.0 * s.acceleration_m_s2 * distance).sqrt());
        (if distance > 0.0 { way * (speed / distance) } else { Vec3::ZERO }, active)
    }

    /// Collects a constraint for every local minimum of the distance in the range that limits the speed of this step.
    /// Returns the least of these distances, at most the range; `None` if it is unknown.
    fn collect_constraints(&mut self, dt_s: f64, largest_change: f64) -> Option<f64> {
        let Self { tool, surfaces, settings, tool_in_world, velocities, displacements, center, workspace, .. } = self;
        velocities.clear();
        displacements.clear();
        let speed_m_s = settings.speed_m_s.min(self.velocity.length() + largest_change);
        let range_m = settings.influence_m(speed_m_s, dt_s);
        let mut gap_m = range_m;
        for protected in surfaces.iter().filter(|surface| surface.is_on) {
            let (surface, in_world) = (&protected.surface, &protected.in_world);
            let add = |near: LocalMinimum| {
                let distance_m = near.separation.distance;
                gap_m = gap_m.min(near.separation.lower_bound);
                let normal = protected.away(&near);
                let speed = LinearConstraint { normal, least: -settings.approach_speed(distance_m, dt_s) };
                let way = LinearConstraint { normal, least: settings.gap_m - distance_m };
                for (set, row) in [(&mut *velocities, speed), (&mut *displacements, way)] {
                    let at_tip = |center: &RemoteCenter| center.at_tip(tool_in_world, near.separation.on_a, row);
                    if let Some(row) = center.as_ref().map_or(Some(row), at_tip) {
                        set.push(row);
                    }
                }
            };
            if !for_each_local_minimum(tool, tool_in_world, surface, in_world, range_m, workspace, add) {
                return None;
            }
        }
        Some(gap_m)
    }

    /// The fraction of a motion for which the distance provably stays above the least gap. Each step of the proof advances
    /// by the distance there less the least gap.
    fn proven_fraction(&mut self, motion: &PivotMotion) -> f64 {
        let length = self.needed_m(motion);
        let start = self.tool_in_world;
        let mut at = start;
        let mut gone = 0.0;
        for _ in 0..PROOF_STEPS {
            let left = length - gone;
            let slack = self.least_distance(at, left + self.settings.least_gap_m) - self.settings.least_gap_m;
            if slack >= left {
                return 1.0;
            }
            if slack <= 1e-6 * self.settings.least_gap_m {
                break;
            }
            gone += slack;
            at = motion.carried(&start, gone / length);
        }
        gone / length
    }

    /// A lower bound of the distance between the tool at this pose and the surfaces, at most `limit_m`; 0 inside.
    fn least_distance(&mut self, tool_in_world: Pose, limit_m: f64) -> f64 {
        let mut least = limit_m;
        for index in 0..self.surfaces.len() {
            if self.surfaces[index].is_on {
                least = self.distance_from(index, tool_in_world, least);
            }
        }
        least
    }

    /// The same of one surface.
    fn distance_from(&mut self, surface: usize, tool_in_world: Pose, limit_m: f64) -> f64 {
        let tool = Tool { mesh: self.tool.mesh(), reach_m: self.tool_reach_m };
        let limits_m = (limit_m, self.settings.gap_m);
        self.clearances[surface].at(&tool, &self.surfaces[surface], tool_in_world, limits_m, &mut self.workspace)
    }

    /// Turns the tool about its point as far as the slack proves.
    fn turn_towards(&mut self, desired: &Pose, turn_rad: f64, slack_m: f64) {
        let (here, center) = (self.tool_in_world, self.center);
        let wanted = center.map_or(desired.rotation, |center| center.turned(&here, desired.rotation).rotation);
        let way = (wanted * here.rotation.inverse()).to_rotation_vector();
        let angle = way.length();
        let lever_m = self.tool_reach_m + center.map_or(0.0, |center| center.slide_per_angle_m());
        let most = turn_rad.min(if lever_m > 0.0 { slack_m / lever_m } else { f64::INFINITY });
        let mut turned = angle.min(most);
        if !(turned > 0.0) {
            return;
        }
        for _ in 0..=PIVOT_HALVINGS {
            let turn = Rotation::from_rotation_vector(way * (turned / angle));
            let rotation = (turn * here.rotation).renormalized();
            // On the way from one orientation with the shaft at the point to another, it may leave the point.
            let end = center.map_or(Pose::new(rotation, here.translation), |center| center.turned(&here, rotation));
            let whole = if center.is_some() { (end.rotation * here.rotation.inverse()).angle() } else { turned };
            if whole <= most * (1.0 + ROUNDING) {
                self.tool_in_world = end;
                return;
            }
            turned *= most / whole;
        }
    }
}

/// The part of a change of velocity that slows down, at most to rest, and the other part.
pub(crate) fn split_braking(velocity: Vec3, change: Vec3) -> (Vec3, Vec3) {
    let Some(ahead) = velocity.try_normalize() else { return (Vec3::ZERO, change) };
    let braking = ahead * ahead.dot(change).clamp(-velocity.length(), 0.0);
    (braking, change - braking)
}

/// A share of a speed, 0 to 1; NaN counts as 0.
fn within_unit(share: f64) -> f64 {
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}
