//! The opening of a shield: where the tool may pass.

use elbowroom_spatial::Vec3;

/// A point of the target on the surface, and the direction out of the solid there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Foot {
    pub point: Vec3,
    /// Unit vector.
    pub axis: Vec3,
}

/// Shape of the opening around each foot: a cylinder that widens like a cone above its ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// Radius at the ground, metres.
    pub radius_m: f64,
    /// How far the ground is below the surface, metres.
    pub depth_m: f64,
    /// How far the opening reaches above the surface, metres.
    pub height_m: f64,
    /// Sine and cosine of the angle between wall and axis.
    pub flare: (f64, f64),
}

impl Cut {
    /// A lower bound of the distance from a point outside the opening of one foot, metres; negative inside.
    fn distance(&self, foot: &Foot, p: Vec3) -> f64 {
        let offset = p - foot.point;
        let along = foot.axis.dot(offset);
        let across = (offset - foot.axis * along).length();
        let (sine, cosine) = self.flare;
        let wall = cosine * (across - self.radius_m) - sine * (along + self.depth_m);
        // Not below the distance from the ball around it, so that whole groups can be left out.
        let ball = offset.length() - self.reach_m();
        wall.max(-(along + self.depth_m)).max(along - self.height_m).max(ball)
    }

    /// Radius of a ball around a foot that contains its part of the opening, metres.
    fn reach_m(&self) -> f64 {
        let height = self.depth_m + self.height_m;
        let widest = self.radius_m + height * self.flare.0 / self.flare.1;
        widest.hypot(self.depth_m.max(self.height_m))
    }
}

/// Feet of a group lie near each other, so a point far from all of them is settled at once.
const GROUP: usize = 16;

/// The union of the openings of all feet.
#[derive(Debug)]
pub(super) struct Opening {
    cut: Cut,
    groups: Vec<Group>,
}

#[derive(Debug)]
struct Group {
    center: Vec3,
    radius_m: f64,
    feet: Vec<Foot>,
}

impl Opening {
    pub fn new(feet: &[Foot], cut: Cut) -> Self {
        let group = |feet: &[Foot]| {
            let center = feet.iter().fold(Vec3::ZERO, |sum, f| sum + f.point) / feet.len() as f64;
            let spread = feet.iter().map(|f| f.point.distance(center)).fold(0.0, f64::max);
            Group { center, radius_m: spread + cut.reach_m(), feet: feet.to_vec() }
        };
        Self { cut, groups: feet.chunks(GROUP).map(group).collect() }
    }

    /// A lower bound of the distance to the opening, metres; negative inside. It changes by at most 1 per metre.
    pub fn distance(&self, p: Vec3) -> f64 {
        let mut least = f64::INFINITY;
        for group in &self.groups {
            if p.distance(group.center) - group.radius_m < least {
                least = group.feet.iter().map(|foot| self.cut.distance(foot, p)).fold(least, f64::min);
            }
        }
        least
    }
}
