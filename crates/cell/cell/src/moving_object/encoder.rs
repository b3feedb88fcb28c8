//! Encoders: the travel of conveyors and rails over time.

use elbowroom_spatial::{FrameMotion, Pose, Vec3};

/// A conveyor or a rail: motion along a line.
#[derive(Debug, Clone)]
pub struct Encoder {
    /// Its name.
    pub name: String,
    /// Unit vector of positive travel, in the world.
    pub direction: Vec3,
    /// Its motion.
    pub travel: Travel,
    /// Travel after which it wraps to 0, m.
    pub wrap_m: Option<f64>,
}

/// Travel over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Travel {
    /// Constant speed between two times.
    Constant {
        /// Travel before the start, m.
        at_m: f64,
        /// m/s.
        speed: f64,
        /// Start, s.
        start_s: f64,
        /// End, s; infinite if it never ends.
        end_s: f64,
    },
    /// Times (s, increasing) and travels (m), linear in between.
    Table(Vec<(f64, f64)>),
}

impl Encoder {
    /// Travel (m) and speed (m/s) at a time (s).
    pub fn at(&self, t_s: f64) -> (f64, f64) {
        let (travel, speed) = self.travelled(t_s);
        (self.wrap_m.map_or(travel, |wrap| travel.rem_euclid(wrap)), speed)
    }

    /// Displacement and velocity of what the belt carries, after a travel (m), wrapped or not, at a speed (m/s).
    pub fn displacement(&self, travel_m: f64, speed: f64) -> (Pose, FrameMotion) {
        let travel_m = self.wrap_m.map_or(travel_m, |wrap| travel_m.rem_euclid(wrap));
        let motion = FrameMotion { velocity: self.direction * speed, ..FrameMotion::REST };
        (Pose::from_translation(self.direction * travel_m), motion)
    }

    /// Passes every number that defines the motion, for a checksum. A new field must be added here.
    pub(crate) fn numbers(&self, each: &mut dyn FnMut(f64)) {
        let Self { name: _, direction, travel, wrap_m } = self;
        direction.to_array().into_iter().for_each(&mut *each);
        // 0 stands for no wrap: a travel of 0 m is refused.
        each(wrap_m.unwrap_or(0.0));
        match travel {
            Travel::Constant { at_m, speed, start_s, end_s } => {
                [0.0, *at_m, *speed, *start_s, *end_s].into_iter().for_each(each);
            }
            Travel::Table(rows) => {
                each(1.0);
                rows.iter().flat_map(|(t_s, at_m)| [*t_s, *at_m]).for_each(each);
            }
        }
    }

    /// True if the travel wraps between two times.
    pub(super) fn wraps(&self, from_s: f64, to_s: f64) -> bool {
        let round = |t_s| self.wrap_m.map(|wrap| (self.travelled(t_s).0 / wrap).floor());
        round(from_s) != round(to_s)
    }

    /// Largest speed between two times, m/s.
    pub fn fastest(&self, from_s: f64, to_s: f64) -> f64 {
        match &self.travel {
            Travel::Constant { speed, start_s, end_s, .. } => {
                if to_s < *start_s || from_s > *end_s {
                    0.0
                } else {
                    speed.abs()
                }
            }
            Travel::Table(rows) => {
                let over = rows.windows(2).filter(|w| w[0].0 <= to_s && w[1].0 >= from_s);
                over.map(|w| ((w[1].1 - w[0].1) / (w[1].0 - w[0].0)).abs()).fold(0.0, f64::max)
            }
        }
    }

    /// True if the speed changes between two times.
    pub(super) fn changes(&self, from_s: f64, to_s: f64) -> bool {
        let within = |t: f64| t > from_s && t < to_s;
        match &self.travel {
            Travel::Constant { start_s, end_s, .. } => within(*start_s) || within(*end_s),
            Travel::Table(rows) => rows.iter().any(|r| within(r.0)),
        }
    }

    /// True for a belt that never stops once it runs.
    pub(crate) fn is_endless(&self) -> bool {
        matches!(self.travel, Travel::Constant { end_s, .. } if end_s == f64::INFINITY)
    }

    /// Like [`Self::at`], without wrapping.
    fn travelled(&self, t_s: f64) -> (f64, f64) {
        match &self.travel {
            Travel::Constant { at_m, speed, start_s, end_s } => {
                let moving = t_s >= *start_s && t_s < *end_s;
                (at_m + speed * (t_s.min(*end_s) - start_s).max(0.0), if moving { *speed } else { 0.0 })
            }
            Travel::Table(rows) => table(rows, t_s),
        }
    }
}

fn table(rows: &[(f64, f64)], t_s: f64) -> (f64, f64) {
    let next = rows.partition_point(|r| r.0 <= t_s);
    match (next.checked_sub(1).map(|i| rows[i]), rows.get(next)) {
        (None, Some(first)) => (first.1, 0.0),
        (Some(last), None) => (last.1, 0.0),
        (Some(a), Some(b)) => {
            let speed = (b.1 - a.1) / (b.0 - a.0);
            (a.1 + speed * (t_s - a.0), speed)
        }
        (None, None) => (0.0, 0.0),
    }
}
