//! Motion in, force out: what the hand feels while the tool stands at a surface.

use elbowroom_spatial::Vec3;

use crate::NavigatorError;

/// A spring and a damper between the tool and the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpedanceSettings {
    /// Stiffness K, N/m.
    pub stiffness_n_m: f64,
    /// Damping B, N·s/m.
    pub damping_n_s_m: f64,
    /// Energy that the port may give before it has taken any, J. It must not be 0: a force that is held over a tick gives
    /// a little back.
    pub tank_j: f64,
    /// Speed of the hand for which the energy suffices, m/s.
    pub hand_speed_m_s: f64,
    /// Largest force, N.
    pub largest_force_n: f64,
}

impl Default for ImpedanceSettings {
    /// 1000 N/m, no damping, 10 mJ, 1 m/s, 150 N.
    fn default() -> Self {
        Self { stiffness_n_m: 1000.0, damping_n_s_m: 0.0, tank_j: 0.01, hand_speed_m_s: 1.0, largest_force_n: 150.0 }
    }
}

/// Computes the force on the hand and watches its energy (Hannaford and Ryu, 2002).
///
/// A force that is held for a period T on a hand that moves makes up to K T² v² / 2 a step. The port pays for that from
/// what the hand has put in and from a tank: it never gives more than it has taken and the tank, at speeds of the hand
/// up to the stated one. A device with a damping of at least [`least_device_damping`](Self::least_device_damping) never
/// needs the tank (Colgate and Schenkel, 1997).
///
/// ```
/// use elbowroom_shared_control::force::{ImpedancePort, ImpedanceSettings};
/// use elbowroom_spatial::Vec3;
/// let mut port = ImpedancePort::new(ImpedanceSettings::default())?;
/// // The tool stands at the surface, the hand is 2 mm deeper: 1000 N/m · 2 mm push it back.
/// let force = port.step(Vec3::ZERO, Vec3::Z * -0.002, Vec3::ZERO, 0.001);
/// assert!((force - Vec3::Z * 2.0).length() < 1e-12);
/// # Ok::<(), elbowroom_shared_control::NavigatorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ImpedancePort {
    settings: ImpedanceSettings,
    /// Tool, hand, and the force since then.
    last: Option<(Vec3, Vec3, Vec3)>,
    energy_j: f64,
}

impl ImpedancePort {
    /// A port without force.
    ///
    /// # Errors
    /// A constant that is not usable.
    pub fn new(settings: ImpedanceSettings) -> Result<Self, NavigatorError> {
        NavigatorError::check_positive(&[
            ("stiffness_n_m", settings.stiffness_n_m),
            ("tank_j", settings.tank_j),
            ("hand_speed_m_s", settings.hand_speed_m_s),
            ("largest_force_n", settings.largest_force_n),
        ])?;
        NavigatorError::check_not_negative(&[("damping_n_s_m", settings.damping_n_s_m)])?;
        Ok(Self { settings, last: None, energy_j: 0.0 })
    }

    /// Force on the hand for the next `dt_s` seconds, N, with the force of fields on the tool. It is 0 for input that is not
    /// finite, or a duration that is not positive.
    pub fn step(&mut self, tool: Vec3, hand: Vec3, field_n: Vec3, dt_s: f64) -> Vec3 {
        if !(tool.is_finite() && hand.is_finite() && field_n.is_finite() && dt_s > 0.0) {
            self.release();
            return Vec3::ZERO;
        }
        let s = &self.settings;
        let mut force = (tool - hand) * s.stiffness_n_m + field_n;
        if let Some((old_tool, old_hand, held)) = self.last {
            self.energy_j -= held.dot(hand - old_hand);
            force += ((tool - old_tool) - (hand - old_hand)) * (s.damping_n_s_m / dt_s);
        }
        let available_j = (self.energy_j + s.tank_j).max(0.0);
        let payable_n = (available_j / (s.hand_speed_m_s * dt_s)).min(s.largest_force_n);
        if force.length() > payable_n {
            force = force * (payable_n / force.length());
        }
        self.last = Some((tool, hand, force));
        force
    }

    /// The hand lets go: no force until the next step.
    pub fn release(&mut self) {
        self.last = None;
    }

    /// Energy taken from the hand, less what was given back, J; at least −[`ImpedanceSettings::tank_j`].
    pub fn energy_j(&self) -> f64 {
        self.energy_j
    }

    /// Damping (N·s/m) from which a device is passive with this port at a period of `dt_s`: K T / 2 + B.
    pub fn least_device_damping(&self, dt_s: f64) -> f64 {
        0.5 * self.settings.stiffness_n_m * dt_s + self.settings.damping_n_s_m
    }
}
