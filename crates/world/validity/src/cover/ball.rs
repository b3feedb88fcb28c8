//! Balls: centre and radius.

use elbowroom_spatial::Vec3;

/// A ball in the frame of its link or obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Centre, m.
    pub centre: Vec3,
    /// Radius, m.
    pub radius: f64,
}

/// Bound on the rounding errors of radii and clipped triangles, for solids of up to 100 m, m.
pub(crate) const ROUNDING_M: f64 = 1e-9;

impl Ball {
    /// True if the point lies in the ball.
    pub fn contains(&self, p: Vec3) -> bool {
        self.centre.distance(p) <= self.radius
    }

    /// A ball that encloses others. Without balls: radius 0 at the origin.
    pub fn enclosing(balls: &[Self]) -> Self {
        enclosing(balls)
    }

    /// True if the ball contains an axis-aligned box, with room for rounding errors.
    pub(crate) fn contains_box(&self, centre: Vec3, half: Vec3) -> bool {
        farthest_squared(self.centre, centre, half) <= (self.radius - ROUNDING_M).powi(2) && self.radius > ROUNDING_M
    }

    /// The ball with a centre in single precision, enlarged by the distance that the centre moved.
    pub(crate) fn rounded_up(self) -> Self {
        let c = self.centre;
        let centre = Vec3::new(f64::from(c.x as f32), f64::from(c.y as f32), f64::from(c.z as f32));
        Self { centre, radius: self.radius + c.distance(centre) + ROUNDING_M }
    }
}

/// Square of the distance from a point to the farthest corner of a box.
pub(crate) fn farthest_squared(from: Vec3, centre: Vec3, half: Vec3) -> f64 {
    ((from - centre).abs() + half).length_squared()
}

/// A ball that encloses others (Bădoiu, Clarkson: *Smaller core-sets for balls*, 2003, extended to balls).
///
/// Without balls: radius 0 at the origin.
pub(crate) fn enclosing(balls: &[Ball]) -> Ball {
    let Some(first) = balls.first() else { return Ball { centre: Vec3::ZERO, radius: 0.0 } };
    let mut centre = balls.iter().fold(Vec3::ZERO, |sum, b| sum + b.centre) * (1.0 / balls.len() as f64);
    if !centre.is_finite() {
        centre = first.centre;
    }
    let reach = |c: Vec3, b: &Ball| c.distance(b.centre) + b.radius;
    let farthest = |c: Vec3| {
        let mut far = (reach(c, first), first);
        for ball in balls {
            // Squares first: most balls are clearly nearer, and need no root.
            let left = far.0 - ball.radius;
            if left > 0.0 && (c - ball.centre).length_squared() < left * left * (1.0 - 1e-12) {
                continue;
            }
            let reached = reach(c, ball);
            if reached > far.0 {
                far = (reached, ball);
            }
        }
        far
    };
    let mut far = farthest(centre);
    let mut best = (far.0, centre);
    for step in 1..=64 {
        let (_, ball) = far;
        let toward = (ball.centre - centre).try_normalize().unwrap_or(Vec3::ZERO);
        // The farthest point of the farthest ball pulls the centre.
        let pull = ball.centre + toward * ball.radius - centre;
        centre += pull * (1.0 / f64::from(step + 1));
        far = farthest(centre);
        if far.0 < best.0 {
            best = (far.0, centre);
        }
    }
    let ball = Ball { centre: best.1, radius: best.0 }.rounded_up();
    let radius = balls.iter().map(|b| reach(ball.centre, b)).fold(0.0, f64::max) + ROUNDING_M;
    Ball { radius, ..ball }
}
