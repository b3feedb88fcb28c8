//! A frame whose poses over time stand in a file: what a sensor saw, or another program planned.

use std::path::PathBuf;

use elbowroom_spatial::{Motion, Pose};

/// Poses over time, straight and by the shortest turn in between; before the first row and after the last one it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseTrack {
    /// Where they were read.
    pub file: PathBuf,
    /// Times (s, rising) and poses in the world.
    rows: Vec<(f64, Pose)>,
}

/// From one row to the next.
struct Leg<'a> {
    from: &'a (f64, Pose),
    to: &'a (f64, Pose),
}

impl Leg<'_> {
    fn seconds(&self) -> f64 {
        self.to.0 - self.from.0
    }

    fn pose(&self, t_s: f64) -> Pose {
        self.from.1.interpolate(&self.to.1, (t_s - self.from.0) / self.seconds())
    }

    /// The same all along: the turn is about one axis, seen from the world.
    fn motion(&self) -> Motion {
        let turn = (self.to.1.rotation * self.from.1.rotation.inverse()).to_rotation_vector();
        Motion {
            velocity: (self.to.1.translation - self.from.1.translation) / self.seconds(),
            angular_velocity: turn / self.seconds(),
            ..Motion::REST
        }
    }
}

impl PoseTrack {
    /// A track through `rows`: times (s) that rise, and poses in the world; `None` without rows.
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

    /// Where the frame is at a time (s), in the world.
    pub fn pose(&self, t_s: f64) -> Pose {
        match self.leg(t_s) {
            Some(leg) => leg.pose(t_s),
            None if t_s < self.rows[0].0 => self.rows[0].1,
            None => self.rows[self.rows.len() - 1].1,
        }
    }

    /// How the frame moves at a time (s), in the world; at a row as it goes on.
    pub fn motion(&self, t_s: f64) -> Motion {
        self.leg(t_s).map_or(Motion::REST, |leg| leg.motion())
    }

    /// Per pair of rows that follow one another: the time (s) of the first, the speed (m/s) and the turning rate (rad/s).
    pub fn rates(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.rows.windows(2).map(|w| {
            let motion = Leg { from: &w[0], to: &w[1] }.motion();
            (w[0].0, motion.velocity.length(), motion.angular_velocity.length())
        })
    }

    /// Every number that decides where the frame is, for a checksum. A field that is added has to be named here.
    pub(crate) fn numbers(&self, each: &mut dyn FnMut(f64)) {
        let Self { file: _, rows } = self;
        for (t_s, pose) in rows {
            each(*t_s);
            pose.to_rows().into_iter().flatten().for_each(&mut *each);
        }
    }

    fn leg(&self, t_s: f64) -> Option<Leg<'_>> {
        let next = self.rows.partition_point(|r| r.0 <= t_s);
        Some(Leg { from: self.rows.get(next.checked_sub(1)?)?, to: self.rows.get(next)? })
    }
}
