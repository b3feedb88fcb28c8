//! Waits before exchange regions, and their reasons: the region is occupied or held, something else is in the way, a fault,
//! a change of regions. A wait without a reason is a finding.

use super::cell::{APART_M, CARRIAGE_M, CART_AT_M, EXCHANGE_AT_M, EXCHANGE_M, Follows, WALL_AT_M, name, sharing};
use super::process::{ARBITER, ArbiterParts, controller_host, node_host};
use super::process_clock::true_us;
use super::world::World;

/// Longest wait without a reason.
const LONGEST_US: u64 = 1_500_000;
/// Time after a change of regions in which it may still be the reason.
const CHANGE_US: u64 = 300_000;
/// Warning distance of the exchange regions, m.
const WARNING_M: f64 = 0.3;
/// Distance within which another region may be the reason, m.
const NEAR_M: f64 = 0.45;

/// Half the length of a rail within its exchange regions, m.
fn half_m() -> f64 {
    ((EXCHANGE_M + CARRIAGE_M).powi(2) - (0.5 * APART_M).powi(2)).sqrt()
}

impl World {
    /// Notes who waits without a reason, and for how long.
    pub(super) fn look_at_waits(&self) {
        for rail in 0..self.cell.rails {
            let waits = self.waits_without_reason(rail);
            if waits {
                self.count("looks at waits");
            }
            let since = {
                let since = &mut self.waits.borrow_mut().since_us[rail];
                *since = waits.then(|| since.unwrap_or(true_us()));
                *since
            };
            if since.is_some_and(|since| true_us() - since > LONGEST_US) {
                self.judge.borrow_mut().wrong(&format!("r{rail} waits without a reason"));
                self.waits.borrow_mut().since_us[rail] = None;
            }
        }
    }

    fn waits_without_reason(&self, rail: usize) -> bool {
        let (places, velocities, targets) = (self.places(), self.velocities(), self.targets());
        let (q, target) = (places[rail], targets[rail]);
        if velocities[rail] != 0.0 || true_us() < self.waits.borrow().changed_us.saturating_add(CHANGE_US) {
            return false;
        }
        let direction = (target - q).signum();
        let before = |region: usize| {
            let ahead_m = (EXCHANGE_AT_M[region] - q) * direction - half_m();
            (0.0..WARNING_M).contains(&ahead_m) && (target - q).abs() > ahead_m + 0.02
        };
        let regions = (0..self.cell.rails - 1).filter(|region| sharing(*region).contains(&rail));
        let Some(region) = regions.into_iter().find(|region| before(*region)) else { return false };
        !self.something_is_near(rail, q, &places)
            && !self.is_disturbed(region)
            && self.could_be_granted(region, rail, &places)
    }

    /// Whether another region may keep it where it is.
    fn something_is_near(&self, rail: usize, q: f64, places: &[f64]) -> bool {
        let is_near = |z: f64| (z - q).abs() < NEAR_M;
        let follows = self.cell.follows != Follows::Nothing && rail == places.len() - 2;
        follows
            || rail == 0 && is_near(CART_AT_M)
            || rail == 1 && is_near(WALL_AT_M)
            || self.judge.borrow().zones.iter().any(|zone| zone.distance(rail, q) < NEAR_M)
    }

    fn is_disturbed(&self, region: usize) -> bool {
        let [a, b] = sharing(region);
        let hosts = [ARBITER, node_host(a), node_host(b), controller_host(a), controller_host(b)];
        hosts.iter().any(|host| true_us() < self.disturbed_until_us(*host))
    }

    /// Whether nobody is in the region, and nobody near it holds it.
    fn could_be_granted(&self, region: usize, rail: usize, places: &[f64]) -> bool {
        let distance = |other: usize| (EXCHANGE_AT_M[region] - places[other]).abs() - half_m();
        let is_empty = sharing(region).iter().all(|other| distance(*other) > 0.0);
        let Some(ArbiterParts { arbiter, .. }) = self.arbiter() else { return false };
        let holder = arbiter.slots().get(region).and_then(|slot| slot.holder.clone());
        let is_held = sharing(region).iter().any(|other| {
            *other != rail && holder.as_ref() == Some(&name(*other)) && distance(*other) < WARNING_M + 0.05
        });
        is_empty && !is_held
    }
}
