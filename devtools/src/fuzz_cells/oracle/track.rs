//! Poses of a body at all ticks, and its motion in between: its origin moves in a straight line, and it turns about one
//! axis.

use elbowroom_spatial::{Pose, Vec3};

use super::frame::Frame;

/// Least change per second² (m or rad) that counts as an acceleration; smaller ones are rounding.
const ACCELERATION: f64 = 1e-6;

/// Times that are less than this share of a tick apart are equal.
const SAME_TICK: f64 = 1e-9;

/// A body with its poses at all ticks.
#[derive(Debug)]
pub struct Track {
    frames: Vec<Frame>,
    tick_s: f64,
}

impl Track {
    pub fn new(poses: &[Pose], tick_s: f64) -> Self {
        Self { frames: poses.iter().map(Frame::of).collect(), tick_s }
    }

    pub fn at(&self, t_s: f64) -> Frame {
        let last = self.frames.len().saturating_sub(1);
        let ticks = (t_s / self.tick_s).max(0.0);
        // Times of ticks are rounded.
        let nearest = ticks.round();
        if (ticks - nearest).abs() < SAME_TICK {
            return self.frames[(nearest as usize).min(last)];
        }
        let k = (ticks.floor() as usize).min(last);
        let Some(next) = self.frames.get(k + 1) else { return self.frames[k] };
        self.frames[k].moved_towards(next, ticks - k as f64)
    }

    /// Upper bound of the motion (m) of a point within `radius_m` of its origin from one time to another within a tick.
    pub fn travel_m(&self, from_s: f64, to_s: f64, radius_m: f64) -> f64 {
        way_m(&self.at(from_s), &self.at(to_s), radius_m)
    }
}

/// Upper bound of the motion (m) of a point within `radius_m` of the origin of a frame that moves straight to another.
pub fn way_m(from: &Frame, to: &Frame, radius_m: f64) -> f64 {
    let turn = from.turn_to(to).length();
    // A body that does not turn may be unbounded.
    from.at.distance(to.at) + if turn > 0.0 { turn * radius_m } else { 0.0 }
}

/// Whether the motion at these ticks can be foreseen: the body turns at a constant rate, and its velocity is constant,
/// or turns with the body, or follows a circle at constant speed.
pub fn is_steady(frames: &[Frame], tick_s: f64) -> bool {
    let most = ACCELERATION * tick_s * tick_s;
    let small = |change: Vec3| change.length() <= most;
    let step = |f: &[Frame]| f[1].at - f[0].at;
    let is_turning_steadily = frames.windows(3).all(|f| small(f[1].turn_to(&f[2]) - f[0].turn_to(&f[1])));
    let is_straight_or_its_own_arc = || {
        frames.windows(3).all(|f| {
            let turned = f[0].turn_to(&f[1]);
            let (before, after) = (step(f), step(&f[1..]));
            let on_arc =
                turned.try_normalize().map_or(before, |axis| Frame::turn(axis, turned.length()).vector(before));
            small(after - before) || small(after - on_arc)
        })
    };
    let is_circle = || {
        frames.windows(4).all(|f| {
            let [a, b, c] = [step(f), step(&f[1..]), step(&f[2..])];
            let same = |x: f64, y: f64| (x - y).abs() <= most;
            let [bend, next_bend] = [b - a, c - b];
            // In a plane: three steps of equal length, with equal bends between them.
            let is_flat = a.cross(b).dot(c).abs() <= most * a.length() * b.length();
            same(a.length(), b.length())
                && same(b.length(), c.length())
                && same(bend.length(), next_bend.length())
                && is_flat
        })
    };
    is_turning_steadily && (is_straight_or_its_own_arc() || is_circle())
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Rotation;

    use super::*;

    #[test]
    fn straight_lines_arcs_and_circles_are_steady_and_nothing_else() {
        let steady = |pose: &dyn Fn(f64) -> Pose| {
            let frames: Vec<Frame> = (0..50).map(|k| Frame::of(&pose(0.004 * f64::from(k)))).collect();
            is_steady(&frames, 0.004)
        };
        let turned = |t: f64| Rotation::from_rotation_vector(Vec3::Z * (1.3 * t));
        let circle = |t: f64| Vec3::new((2.0 * t).cos(), (2.0 * t).sin(), 0.3);
        assert!(steady(&|t| Pose { rotation: turned(t), translation: Vec3::X * t }));
        assert!(steady(&|t| Pose { rotation: turned(t), translation: turned(t) * Vec3::X }));
        assert!(steady(&|t| Pose::from_translation(circle(t))));
        assert!(steady(&|t| Pose { rotation: turned(t), translation: circle(t) }));
        assert!(!steady(&|t| Pose::from_translation(Vec3::X * (t * t))));
        assert!(!steady(&|t| Pose::from_translation(circle(t * t))));
        assert!(!steady(&|t| Pose::from_translation(circle(t) + Vec3::Z * (0.2 * t * t))));
        assert!(!steady(&|t| Pose { rotation: turned(t * t), translation: Vec3::X * t }));
    }
}
