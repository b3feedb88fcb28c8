//! A mass that a spring couples to the hand: the tool answers to forces.

use elbowroom_spatial::Vec3;
use elbowroom_spatial::linalg::solve_spd;

use super::energy_account::EnergyAccount;
use super::field::FieldSample;
use crate::NavigatorError;
use crate::surface_navigator::split_braking;

/// Share of the energy by which rounding may exceed it.
const ROUNDING: f64 = 1e-13;

/// The mass of a tool as the hand feels it, and its coupling to the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodySettings {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Damping of every motion, N·s/m.
    pub damping_n_s_m: f64,
    /// Stiffness of the coupling to the hand, N/m.
    pub coupling_n_m: f64,
    /// Largest jerk while the acceleration grows, m/s³. The mass slows down as fast as forces demand.
    pub jerk_m_s3: f64,
    /// Largest force of the coupling, N: a hand that is farther away pulls no harder.
    pub largest_force_n: f64,
}

impl Default for BodySettings {
    /// 2 kg that follow the hand within 0.1 s without overshoot: ω = 20 rad/s, critical damping.
    fn default() -> Self {
        Self { mass_kg: 2.0, damping_n_s_m: 80.0, coupling_n_m: 800.0, jerk_m_s3: 500.0, largest_force_n: 150.0 }
    }
}

impl BodySettings {
    /// Checks the constants.
    ///
    /// # Errors
    /// The first one that is not a positive number; damping may be 0.
    pub fn check(&self) -> Result<(), NavigatorError> {
        let positive = [
            ("mass_kg", self.mass_kg),
            ("coupling_n_m", self.coupling_n_m),
            ("jerk_m_s3", self.jerk_m_s3),
            ("largest_force_n", self.largest_force_n),
        ];
        NavigatorError::check_positive(&positive)?;
        NavigatorError::check_not_negative(&[("damping_n_s_m", self.damping_n_s_m)])
    }
}

/// The motion of the mass.
///
/// One step is [`begin`](Self::begin), then the motion of the tool as far as surfaces and the arm allow, then
/// [`end`](Self::end) with what was really done. Energy is counted exactly, by the change of the potential and not by
/// forces of the middle: a step that would make energy loses speed, and is refused if that is not enough.
///
/// ```
/// use elbowroom_shared_control::force::{BodySettings, FieldSample, VirtualBody};
/// use elbowroom_spatial::Vec3;
/// let mut body = VirtualBody::new(BodySettings::default())?;
/// let (mut at, hand) = (Vec3::ZERO, Vec3::X * 0.1);
/// for _ in 0..1000 {
///     let velocity = body.begin(at, Some(hand), &FieldSample::default(), 0.001);
///     let to = at + velocity * 0.001;
///     if body.end(to, velocity, 0.0) { at = to } else { body.stand(); }
/// }
/// assert!(at.distance(hand) < 1e-6);
/// # Ok::<(), elbowroom_shared_control::NavigatorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct VirtualBody {
    settings: BodySettings,
    velocity: Vec3,
    acceleration: Vec3,
    /// Where the hand holds the spring; `None` while it does not.
    hand: Option<Vec3>,
    /// Energy of the fields after the last step.
    potential_j: f64,
    dt_s: f64,
    before: Vec3,
    account: EnergyAccount,
}

impl VirtualBody {
    /// A body at rest.
    ///
    /// # Errors
    /// A constant that is not usable.
    pub fn new(settings: BodySettings) -> Result<Self, NavigatorError> {
        settings.check()?;
        Ok(Self {
            settings,
            velocity: Vec3::ZERO,
            acceleration: Vec3::ZERO,
            hand: None,
            potential_j: 0.0,
            dt_s: 0.0,
            before: Vec3::ZERO,
            account: EnergyAccount::default(),
        })
    }

    /// Velocity of the tool point, m/s.
    pub fn velocity(&self) -> Vec3 {
        self.velocity
    }

    /// Energy that was put in by the hand and by surroundings and is not stored, J. It never falls.
    pub fn dissipated_j(&self) -> f64 {
        self.account.dissipated_j()
    }

    /// Force that the hand feels with the tool at this place, N.
    pub fn force_on_hand(&self, at: Vec3) -> Vec3 {
        self.hand.map_or(Vec3::ZERO, |hand| (at - hand) * self.settings.coupling_n_m)
    }

    /// The velocity with which the tool would move in a step of `dt_s` seconds from `at`: implicit Euler.
    ///
    /// `hand` is the point where the hand wants the tool; without it the spring is released and the body slows down.
    /// A duration that is not positive counts as none.
    pub fn begin(&mut self, at: Vec3, hand: Option<Vec3>, field: &FieldSample, dt_s: f64) -> Vec3 {
        self.before = at;
        self.dt_s = if dt_s > 0.0 { dt_s } else { 0.0 };
        let longest_m = self.settings.largest_force_n / self.settings.coupling_n_m;
        let hand = hand.filter(|h| h.is_finite()).map(|hand| {
            let way = hand - at;
            if way.length() > longest_m { at + way * (longest_m / way.length()) } else { hand }
        });
        // Moving the end of the spring puts energy in; releasing the spring gives its energy to nobody.
        let (old, new) = (self.spring_j(self.hand, at), self.spring_j(hand, at));
        if hand.is_some() {
            self.account.put_in(new - old);
        } else {
            self.account.keep(self.account.stored_j() - old);
        }
        self.account.put_in(field.potential_j - self.potential_j);
        (self.hand, self.potential_j) = (hand, field.potential_j);
        let s = &self.settings;
        let coupling_n_m = if hand.is_some() { s.coupling_n_m } else { 0.0 };
        let diagonal = s.mass_kg + self.dt_s * (s.damping_n_s_m + self.dt_s * coupling_n_m);
        let force = field.force_n - self.force_on_hand(at);
        let momentum = self.velocity * s.mass_kg + force * self.dt_s;
        let matrix: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let own = if i == j { diagonal } else { 0.0 };
                own + self.dt_s * (field.damping[i][j] + self.dt_s * field.stiffness[i][j])
            })
        });
        let velocity = solve_spd(matrix, momentum.to_array(), 3).map_or(Vec3::ZERO, Vec3::from);
        self.within_jerk(velocity)
    }

    /// Ends a step at `to`, reached with `velocity`, where the fields store `potential_j`.
    ///
    /// Returns false, and changes nothing, if so much energy is not there: go less far, or [`stand`](Self::stand).
    pub fn end(&mut self, to: Vec3, velocity: Vec3, potential_j: f64) -> bool {
        let allowed = self.account.stored_j();
        let resting = self.spring_j(self.hand, to) + potential_j;
        let left = allowed - resting;
        if !(to.is_finite() && velocity.is_finite() && left >= -ROUNDING * allowed) {
            return false;
        }
        let mass = self.settings.mass_kg;
        let kinetic = 0.5 * mass * velocity.length_squared();
        // At rest nothing is there to be taken away, also if rounding has left less than nothing.
        let left = left.max(0.0);
        let share = if kinetic > left { (left / kinetic).sqrt() } else { 1.0 };
        let velocity = velocity * share;
        if self.dt_s > 0.0 {
            self.acceleration = (velocity - self.velocity) / self.dt_s;
        }
        self.velocity = velocity;
        self.potential_j = potential_j;
        self.account.keep(resting + 0.5 * mass * velocity.length_squared());
        true
    }

    /// Ends a step at the place where it began: the body stands. Returns the force that the hand feels, N.
    pub fn stand(&mut self) -> Vec3 {
        self.end(self.before, Vec3::ZERO, self.potential_j);
        (self.velocity, self.acceleration) = (Vec3::ZERO, Vec3::ZERO);
        self.force_on_hand(self.before)
    }

    /// The tool was turned where it is, and the fields store `potential_j` now.
    ///
    /// The hand feels no torque, so it does not pay for that: the mass does. Returns false, and changes nothing, if it
    /// cannot: turn back.
    pub fn turned(&mut self, at: Vec3, potential_j: f64) -> bool {
        let acceleration = self.acceleration;
        let is_paid = self.end(at, self.velocity, potential_j);
        self.acceleration = acceleration;
        is_paid
    }

    /// Stops the mass: its motion becomes heat.
    pub fn halt(&mut self) {
        let kinetic_j = 0.5 * self.settings.mass_kg * self.velocity.length_squared();
        self.account.keep(self.account.stored_j() - kinetic_j);
        (self.velocity, self.acceleration) = (Vec3::ZERO, Vec3::ZERO);
    }

    fn spring_j(&self, hand: Option<Vec3>, at: Vec3) -> f64 {
        hand.map_or(0.0, |hand| 0.5 * self.settings.coupling_n_m * (hand - at).length_squared())
    }

    /// Limits the jerk, except of slowing down.
    fn within_jerk(&self, velocity: Vec3) -> Vec3 {
        if self.dt_s == 0.0 {
            return velocity;
        }
        let (braking, change) = split_braking(self.velocity, velocity - self.velocity);
        let before = split_braking(self.velocity, self.acceleration * self.dt_s).1;
        if change.length_squared() <= before.length_squared() {
            return velocity;
        }
        let largest = self.settings.jerk_m_s3 * self.dt_s * self.dt_s;
        let share = (largest / (change - before).length()).min(1.0);
        self.velocity + braking + before + (change - before) * share
    }
}
