//! The navigator: one step of a tool towards a desired pose, around protected surfaces.

use std::sync::Arc;

use elbowroom_proximity::advanced::{LocalMinimum, NormalConeHierarchy, for_each_local_minimum, mesh_separation_with};
use elbowroom_proximity::{DistanceSettings, Separation, TriMesh, Workspace};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::constraint_set::ConstraintSet;
use crate::navigation_step::{Limit, NavigationStep};
use crate::surface_clearance::{SurfaceClearance, Tool};
use crate::{LinearConstraint, NavigatorError, NavigatorSettings, ProtectedSurface, project_onto_constraints};

/// Most distance queries per step and surface in the proof of a step that is longer than the gap.
const PROOF_STEPS: usize = 32;
/// Distance below which the line between two nearest points has no usable direction, metres.
const TOUCHING_M: f64 = 1e-9;

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
    workspace: Box<Workspace>,
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
        let (velocity, now) = project(self.velocity + braking + change * share, &mut self.velocities);
        // Two walls that are nearly opposite can ask for a velocity far above that of either.
        let velocity = velocity * (self.settings.speed_m_s / velocity.length()).min(1.0);
        let active_rows = now.max(on_the_way);
        let travel = velocity * (dt_s * speed_override);
        // The proof does not rely on the constraints: their search uses normals, and this distance does not.
        let turn_rad = match wish {
            Wish::Pose(_) => self.settings.turn_rad_s * dt_s * speed_override,
            Wish::Velocity(_) => 0.0,
        };
        let turn_m = self.tool_reach_m * turn_rad;
        let slack_limit_m = travel.length() + turn_m + self.settings.least_gap_m;
        let distance_m = self.least_distance(self.tool_in_world, slack_limit_m);
        let slack_m = (distance_m - self.settings.least_gap_m).max(0.0);
        let proven = if travel.length() <= slack_m { 1.0 } else { self.proven_share(travel) };
        self.velocity = velocity * proven;
        self.tool_in_world.translation += travel * proven;
        if let Wish::Pose(desired) = wish {
            let left_m = if proven < 1.0 { 0.0 } else { (slack_m - travel.length()).max(0.0) };
            self.turn_towards(desired, turn_rad, left_m);
        }
        let limit = if proven < 1.0 { Some(Limit::Proof) } else { (active_rows > 0).then_some(Limit::Surface) };
        let is_near = distance_m < slack_limit_m;
        let is_in_range = !self.velocities.as_slice().is_empty();
        let gap_m = if is_near { Some(distance_m) } else { is_in_range.then_some(gap_m) };
        let velocity = self.velocity * speed_override;
        NavigationStep { tool_in_world: self.tool_in_world, velocity, gap_m, active_rows, limit }
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
        let (way, active) = project(way, &mut self.displacements);
        let s = &self.settings;
        let distance = way.length();
        let speed = (distance / dt_s).min(s.speed_m_s).min((2.0 * s.acceleration_m_s2 * distance).sqrt());
        (if distance > 0.0 { way * (speed / distance) } else { Vec3::ZERO }, active)
    }

    /// Collects a constraint for every local minimum of the distance in the range that limits the speed of this step.
    /// Returns the least of these distances, at most the range; `None` if it is unknown.
    fn collect_constraints(&mut self, dt_s: f64, largest_change: f64) -> Option<f64> {
        let Self { tool, surfaces, settings, tool_in_world, velocities, displacements, workspace, .. } = self;
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
                let normal = away_from_surface(&near, surface, in_world);
                velocities.push(LinearConstraint { normal, least: -settings.approach_speed(distance_m, dt_s) });
                displacements.push(LinearConstraint { normal, least: settings.gap_m - distance_m });
            };
            if !for_each_local_minimum(tool, tool_in_world, surface, in_world, range_m, workspace, add) {
                return None;
            }
        }
        Some(gap_m)
    }

    /// The share of the travel for which the distance provably stays above the least gap. Each step of the proof advances
    /// by the distance there less the least gap.
    fn proven_share(&mut self, travel: Vec3) -> f64 {
        let length = travel.length();
        let mut at = self.tool_in_world;
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
            at.translation = self.tool_in_world.translation + travel * (gone / length);
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
        let way = (desired.rotation * self.tool_in_world.rotation.inverse()).to_rotation_vector();
        let angle = way.length();
        let provable = if self.tool_reach_m > 0.0 { slack_m / self.tool_reach_m } else { f64::INFINITY };
        let turned = angle.min(turn_rad).min(provable);
        if !(turned > 0.0) {
            return;
        }
        let turn = Rotation::from_rotation_vector(way * (turned / angle));
        self.tool_in_world.rotation = (turn * self.tool_in_world.rotation).renormalized();
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

/// The admissible vector nearest to the wanted one, and the number of constraints that decide it.
fn project(wanted: Vec3, constraints: &mut ConstraintSet) -> (Vec3, usize) {
    project_onto_constraints(wanted, constraints.as_slice())
        .or_else(|_| {
            // Two walls that both ask for more distance: neither gets it.
            constraints.allow_rest();
            project_onto_constraints(wanted, constraints.as_slice())
        })
        .unwrap_or((Vec3::ZERO, constraints.as_slice().len()))
}

/// The unit vector along which the distance grows.
fn away_from_surface(near: &LocalMinimum, surface: &NormalConeHierarchy, surface_in_world: &Pose) -> Vec3 {
    let apart = near.separation.on_a - near.separation.on_b;
    if near.separation.distance > TOUCHING_M
        && let Some(direction) = apart.try_normalize()
    {
        return direction;
    }
    let mesh = surface.mesh();
    let [a, b, c] = mesh.triangles()[near.triangle_b as usize].map(|v| mesh.vertices()[v as usize]);
    let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z);
    surface_in_world.transform_vector(normal)
}
