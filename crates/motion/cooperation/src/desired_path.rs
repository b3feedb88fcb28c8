//! The desired motion of the work-piece as it has arrived.

use std::collections::VecDeque;

use elbowroom_spatial::{Pose, Rotation};

use crate::{CooperationSettings, PoseRefusal};

/// Number of poses that can wait to be carried out.
const CAPACITY: usize = 16_384;

/// Longest way from one pose to the next, s.
const LONGEST_S: f64 = 86_400.0;

/// The poses that have arrived, joined by straight motions.
///
/// Places on it are named by the path time at which the work-piece gets there at the earliest: between two poses it takes
/// the time between their arrivals, or longer where the work-piece would be too fast.
#[derive(Debug)]
pub(crate) struct DesiredPath {
    /// Path times (s, increasing) and poses; the first one is behind the work-piece.
    poses: VecDeque<(f64, Pose)>,
    /// Time at which the last pose arrived, s.
    arrived_s: Option<f64>,
    is_paused: bool,
}

impl DesiredPath {
    /// A path of one pose.
    pub fn new(start: Pose) -> Self {
        let mut poses = VecDeque::with_capacity(CAPACITY);
        poses.push_back((0.0, start));
        Self { poses, arrived_s: None, is_paused: false }
    }

    /// Adds a pose that has arrived at a time (s).
    ///
    /// # Errors
    /// [`PoseRefusal`]; the path is then as before.
    pub fn push(&mut self, t_s: f64, pose: &Pose, settings: &CooperationSettings) -> Result<(), PoseRefusal> {
        if !(t_s.is_finite() && pose.is_finite()) {
            return Err(PoseRefusal::NotFinite);
        }
        if self.arrived_s.is_some_and(|last| t_s <= last) {
            return Err(PoseRefusal::Time);
        }
        if self.poses.len() == CAPACITY {
            return Err(PoseRefusal::Full);
        }
        let (end_s, end) = self.end();
        let since_s = if self.is_paused { 0.0 } else { self.arrived_s.map_or(0.0, |last| t_s - last) };

        let moved_s = end.translation.distance(pose.translation) / settings.speed_m_s;
        let turned_s = angle_between(&end.rotation, &pose.rotation) / settings.angular_speed_rad_s;
        let takes_s = since_s.max(moved_s).max(turned_s);
        if takes_s.is_nan() || takes_s > LONGEST_S {
            return Err(PoseRefusal::Far);
        }
        (self.arrived_s, self.is_paused) = (Some(t_s), false);
        if takes_s > 0.0 {
            self.poses.push_back((end_s + takes_s, *pose));
        }
        Ok(())
    }

    /// The next pose is not joined in time to the last one.
    pub fn pause(&mut self) {
        self.is_paused = true;
    }

    /// The last pose, and its path time (s).
    pub fn end(&self) -> (f64, Pose) {
        self.poses.back().copied().unwrap_or((0.0, Pose::IDENTITY))
    }

    /// The pose at a path time (s).
    pub fn at(&self, path_s: f64) -> Pose {
        let next = self.poses.partition_point(|(s, _)| *s <= path_s);
        match (next.checked_sub(1).and_then(|k| self.poses.get(k)), self.poses.get(next)) {
            (Some((from_s, from)), Some((to_s, to))) => from.interpolate(to, (path_s - from_s) / (to_s - from_s)),
            (Some((_, pose)), None) | (None, Some((_, pose))) => *pose,
            (None, None) => Pose::IDENTITY,
        }
    }

    /// The pose at a path time (s), beyond the end as if the last motion went on.
    pub fn foreseen(&self, path_s: f64) -> Pose {
        let (end_s, end) = self.end();
        if path_s <= end_s {
            return self.at(path_s);
        }
        let from_s = (end_s - 0.05).max(self.poses.front().map_or(0.0, |first| first.0));
        if from_s >= end_s {
            return end;
        }
        let (before, ahead) = (self.at(from_s), (path_s - end_s) / (end_s - from_s));
        let turn = (end.rotation * before.rotation.inverse()).to_rotation_vector();
        let rotation = Rotation::from_rotation_vector(turn * ahead) * end.rotation;
        Pose::new(rotation, end.translation + (end.translation - before.translation) * ahead)
    }

    /// Forgets what is behind a path time (s).
    pub fn passed(&mut self, path_s: f64) {
        while self.poses.get(1).is_some_and(|(s, _)| *s <= path_s - 0.1) {
            self.poses.pop_front();
        }
    }
}

/// Angle between two rotations, rad.
pub(crate) fn angle_between(a: &Rotation, b: &Rotation) -> f64 {
    (a.inverse() * *b).angle()
}
