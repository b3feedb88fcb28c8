//! What else a route stays out of, beside what the scene has in it.

use std::fmt::Debug;

use super::way::lerp;

/// Closer than this to what a way has to keep, m, is not looked at any closer: as sweeps do.
const TOLERANCE_M: f64 = 1e-4;
/// After so many looks a leg is not proven.
const LOOKS: u32 = 20_000;
/// Factor on what is travelled for the rounding of the sums it is made of.
const CAREFUL: f64 = 1.0 + 1e-9;

/// Something beside solids that a route stays out of: regions of a monitor, most of all.
///
/// Configurations are all values of the robot, rad (m where a joint slides). What is not a number is not free.
pub trait Fence: Debug {
    /// Metres that all guarded points may still move, at least, before one of them enters what is fenced off; 0 or less
    /// inside. Where it is more than `limit_m`, any number that is more does.
    fn room_m(&mut self, q: &[f64], limit_m: f64) -> f64;

    /// The same less what ways keep, which may differ from place to place. A route may have less of it only where it leaves
    /// a start or comes to a goal that has less.
    fn spare_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.room_m(q, limit_m)
    }

    /// No guarded point travels farther than this, m, while all joints go straight and together from one configuration to
    /// another, and in a share of that no farther than the same share.
    fn travel_m(&mut self, from: &[f64], to: &[f64]) -> f64;

    /// What a configuration is in, or nearest to, in words: "region `press`".
    fn nearest(&mut self, q: &[f64]) -> String;
}

impl<F: Fence + ?Sized> Fence for &mut F {
    fn room_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        (**self).room_m(q, limit_m)
    }

    fn spare_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        (**self).spare_m(q, limit_m)
    }

    fn travel_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        (**self).travel_m(from, to)
    }

    fn nearest(&mut self, q: &[f64]) -> String {
        (**self).nearest(q)
    }
}

/// A fence, and what a route may do at it.
#[derive(Debug)]
pub(super) struct Fenced<'f> {
    fence: Box<dyn Fence + 'f>,
}

impl<'f> Fenced<'f> {
    pub fn new(fence: impl Fence + 'f) -> Self {
        Self { fence: Box::new(fence) }
    }

    /// What a configuration is in, and its room, where it is not outside of everything.
    pub fn inside(&mut self, q: &[f64]) -> Option<(String, f64)> {
        let room = self.fence.room_m(q, 0.0);
        // Comparisons with NaN are false.
        (!(room > 0.0)).then(|| (self.fence.nearest(q), room))
    }

    /// Keeps what a way has to, and what a proof needs.
    pub fn is_free(&mut self, q: &[f64]) -> bool {
        self.fence.spare_m(q, TOLERANCE_M) > TOLERANCE_M
    }

    /// Straight from one to the other, keeping what a way has to all along.
    pub fn proven(&mut self, from: &[f64], to: &[f64]) -> bool {
        let travel = self.fence.travel_m(from, to);
        proven(from, to, travel, TOLERANCE_M, |q, limit| self.fence.spare_m(q, limit))
    }

    /// The same where `from` need not keep that: then nothing comes nearer than it is there, but for a hair, which is less than
    /// what parts that from being inside.
    pub fn leaves(&mut self, from: &[f64], to: &[f64]) -> bool {
        if self.is_free(from) {
            return self.proven(from, to);
        }
        let room = self.fence.room_m(from, f64::INFINITY);
        let hair = if room > 0.0 { TOLERANCE_M.min(0.5 * room) } else { TOLERANCE_M };
        let kept = room - hair;
        let travel = self.fence.travel_m(from, to);
        proven(from, to, travel, 0.5 * hair, |q, limit| self.fence.room_m(q, limit + kept.max(0.0)) - kept)
    }
}

/// Conservative advancement from the middle outwards: the metres that are left where one looks last for as long as it takes to
/// travel that far. Where less than `need` are left nothing is proven, else it might not end.
fn proven(from: &[f64], to: &[f64], travel: f64, need: f64, mut left: impl FnMut(&[f64], f64) -> f64) -> bool {
    let travel = travel * CAREFUL;
    if !travel.is_finite() {
        return false;
    }
    let mut q = from.to_vec();
    let mut open = vec![(0.0, 1.0)];
    for _ in 0..LOOKS {
        let Some((begin, end)) = open.pop() else { return true };
        let middle = 0.5 * (begin + end);
        lerp(from, to, middle, &mut q);
        let half = 0.5 * (end - begin) * travel;
        let left = left(&q, half + need);
        // Comparisons with NaN are false.
        if !(left > need) {
            return false;
        }
        if left <= half {
            let free = left / travel;
            open.push((middle + free, end));
            open.push((begin, middle - free));
        }
    }
    open.is_empty()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        /// A ball in the plane and a straight way: what is proven has room at every sample, what has room at every sample
        /// (and a little more than a proof needs) is proven.
        #[test]
        fn proven_is_what_a_fine_sampling_says(
            from in prop::array::uniform2(-1.0..1.0_f64),
            to in prop::array::uniform2(-1.0..1.0_f64),
            radius in 0.0..0.7_f64,
            loose in 1.0..5.0_f64,
        ) {
            let room = |q: &[f64]| q[0].hypot(q[1]) - radius;
            let travel = (from[0] - to[0]).hypot(from[1] - to[1]) * loose;
            let told = proven(&from, &to, travel, TOLERANCE_M, |q, _| room(q));
            let mut q = [0.0; 2];
            let least = (0..=2_000).map(|n| {
                lerp(&from, &to, f64::from(n) / 2_000.0, &mut q);
                room(&q)
            }).fold(f64::INFINITY, f64::min);
            prop_assert!(!told || least > 0.0, "{least}");
            // No sample is farther than 0.75 mm from the nearest point of all.
            prop_assert!(told || least < TOLERANCE_M + 7.5e-4, "{least}");
        }
    }

    #[test]
    fn what_is_no_number_is_not_proven() {
        let (from, to) = ([0.0], [1.0]);
        for (travel, left) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, f64::NAN), (0.0, f64::NAN)] {
            assert!(!proven(&from, &to, travel, 1e-4, |_, _| left));
        }
        assert!(proven(&from, &to, 1.0, 1e-4, |_, _| 0.6) && proven(&from, &from, 0.0, 1e-4, |_, _| f64::INFINITY));
        // A place in between that is not known.
        assert!(!proven(&from, &to, 1.0, 1e-4, |q, _| if q[0] > 0.7 && q[0] < 0.8 { f64::NAN } else { 0.1 }));
    }
}
