//! A frame with poses over time from a file: a sensor recording, or a planned motion.

use std::path::PathBuf;

use elbowroom_spatial::{FrameMotion, Pose};

/// Poses over time, interpolated linearly and by the shortest rotation.
///
/// Constant before the first row and after the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseTrack {
    /// The file.
    pub file: PathBuf,
    /// Times (s, increasing) and poses in the world.
    rows: Vec<(f64, Pose)>,
}

/// The speeds between two rows of a [`PoseTrack`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseRate {
    /// Time of the first row, s.
    pub from_s: f64,
    /// Speed of the origin, m/s.
    pub speed_m_s: f64,
    /// Angular speed, rad/s.
    pub turn_rad_s: f64,
}

/// The interval between two rows.
struct PoseInterval<'a> {
    from: &'a (f64, Pose),
    to: &'a (f64, Pose),
}

impl PoseInterval<'_> {
    fn seconds(&self) -> f64 {
        self.to.0 - self.from.0
    }

    fn pose(&self, t_s: f64) -> Pose {
        self.from.1.interpolate(&self.to.1, (t_s - self.from.0) / self.seconds())
    }

    /// Constant over the interval: the rotation is about one fixed axis of the world.
    fn motion(&self) -> FrameMotion {
        let turn = (self.to.1.rotation * self.from.1.rotation.inverse()).to_rotation_vector();
        FrameMotion {
            velocity: (self.to.1.translation - self.from.1.translation) / self.seconds(),
            angular_velocity: turn / self.seconds(),
            ..FrameMotion::REST
        }
    }
}

impl PoseTrack {
    /// A track through `rows`: increasing times (s), and poses in the world; `None` without rows.
    ///
    /// ```
    /// use elbowroom_cell::PoseTrack;
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let at = |x: f64| Pose::from_translation(Vec3::X * x);
    /// let track = PoseTrack::new("cart.csv".into(), vec![(0.0, at(0.0)), (2.0, at(1.0))]).unwrap();
    /// assert_eq!(track.pose(1.0).translation, Vec3::X * 0.5);
    /// assert_eq!(track.motion(1.0).velocity, Vec3::X * 0.5);
    /// assert_eq!(track.motion(5.0).velocity, Vec3::ZERO);
    /// ```
    pub fn new(file: PathBuf, rows: Vec<(f64, Pose)>) -> Option<Self> {
        (!rows.is_empty()).then_some(Self { file, rows })
    }

    /// The rows of the file: times (s, increasing) and poses in the world.
    pub fn rows(&self) -> &[(f64, Pose)] {
        &self.rows
    }

    /// Pose of the frame in the world at a time (s).
    pub fn pose(&self, t_s: f64) -> Pose {
        match self.interval(t_s) {
            Some(interval) => interval.pose(t_s),
            None if t_s < self.rows[0].0 => self.rows[0].1,
            None => self.rows[self.rows.len() - 1].1,
        }
    }

    /// Velocity of the frame in the world at a time (s); at a row the velocity after it.
    pub fn motion(&self, t_s: f64) -> FrameMotion {
        self.interval(t_s).map_or(FrameMotion::REST, |interval| interval.motion())
    }

    /// The speeds between consecutive rows.
    pub fn rates(&self) -> impl Iterator<Item = PoseRate> {
        self.rows.windows(2).map(|w| {
            let motion = PoseInterval { from: &w[0], to: &w[1] }.motion();
            PoseRate {
                from_s: w[0].0,
                speed_m_s: motion.velocity.length(),
                turn_rad_s: motion.angular_velocity.length(),
            }
        })
    }

    /// Passes every number that defines the track, for a checksum. A new field must be added here.
    pub(crate) fn numbers(&self, each: &mut dyn FnMut(f64)) {
        let Self { file: _, rows } = self;
        for (t_s, pose) in rows {
            each(*t_s);
            pose.to_rows().into_iter().flatten().for_each(&mut *each);
        }
    }

    fn interval(&self, t_s: f64) -> Option<PoseInterval<'_>> {
        let next = self.rows.partition_point(|r| r.0 <= t_s);
        Some(PoseInterval { from: self.rows.get(next.checked_sub(1)?)?, to: self.rows.get(next)? })
    }
}
