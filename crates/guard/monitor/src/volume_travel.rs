//! How far the volumes of a robot travel from one snapshot to the next.

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

use crate::Configuration;
use crate::placement::Placement;

/// Largest travel of the volumes between two snapshots, from their poses at both. It ignores what cannot change a
/// distance: the rotation of a round volume about its axis.
#[derive(Debug)]
pub(crate) struct VolumeTravel {
    /// Poses at the last snapshot.
    former: Vec<Pose>,
    /// False if the poses of some volumes are not known.
    is_known: bool,
    levers: Vec<Lever>,
    /// Rotation of all joints together per unit of each entry of `q`, rad.
    turns: Vec<f64>,
}

/// How far rotation moves the points of a volume, m per unit of the change of its axes.
#[derive(Debug, Clone, Copy)]
enum Lever {
    /// Only the direction of the z axis counts: the volume is round about it.
    Axis(f64),
    /// All axes count.
    Axes(f64),
}

impl VolumeTravel {
    pub(crate) fn new(config: &Configuration) -> Self {
        Self {
            former: vec![Pose::IDENTITY; config.volumes.len()],
            is_known: false,
            levers: config.volumes.iter().map(|v| Lever::of(&v.shape)).collect(),
            turns: turns(&config.chain),
        }
    }

    /// Forgets the poses: other volumes are attached.
    pub(crate) fn forget(&mut self) {
        self.is_known = false;
    }

    /// Largest distance (m) between a point of a volume now and at the last snapshot; infinite if it is not known.
    pub(crate) fn advance(&mut self, now: &Placement) -> f64 {
        let attached = (0..self.former.len()).filter(|v| now.attached.contains(*v));
        let travel = attached.map(|v| self.levers[v].travel(&self.former[v], &now.volume_in_world[v]));
        // `f64::max` would drop NaN.
        let largest = travel.fold(0.0, |max, travel| if travel <= max || max.is_nan() { max } else { travel });
        self.former.copy_from_slice(&now.volume_in_world);
        if std::mem::replace(&mut self.is_known, true) { largest } else { f64::INFINITY }
    }

    /// Largest length (m) of the path of a point, if its ends are at most `shift_m` apart, all joints move straight from
    /// one of the snapshots to the other, and no path is longer than `longest_m`.
    ///
    /// In unit time the acceleration of a point is at most twice the speed of the points times the angular speed of all
    /// joints ([`elbowroom_kinematics::motion_bound::SpeedBound`]); the speed differs from the shift by half of that at most.
    pub(crate) fn path(&self, shift_m: f64, longest_m: f64, from: &[f64], to: &[f64]) -> f64 {
        let turned: f64 = self.turns.iter().zip(from.iter().zip(to)).map(|(turns, (a, b))| turns * (b - a).abs()).sum();
        let bent = shift_m + turned * longest_m;
        // NaN gives the longest path.
        if bent < longest_m { bent } else { longest_m }
    }
}

/// Rotation of all joints together per unit of each entry of `q`, rad.
fn turns(chain: &Chain) -> Vec<f64> {
    let mut turns = vec![0.0; chain.dof()];
    for (id, joint) in chain.topological_order().iter().map(|id| (*id, &chain.joints()[id.0])) {
        if let (true, Some(coupling)) = (joint.kind != JointKind::Prismatic, chain.coupling(id)) {
            turns[coupling.index] += coupling.multiplier.abs();
        }
    }
    turns
}

impl Lever {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Sphere(_) => Self::Axis(0.0),
            Shape::Capsule(c) => Self::Axis(c.half_length),
            _ => Self::Axes(shape.aabb(&Pose::IDENTITY).max_distance(Vec3::ZERO)),
        }
    }

    /// Upper bound of the travel (m) of the volume's points between two poses, as far as it can change distances.
    fn travel(self, from: &Pose, to: &Pose) -> f64 {
        let turned = |axis: usize| to.rotation.axis(axis) - from.rotation.axis(axis);
        let swing = match self {
            Self::Axis(lever) => turned(2).length() * lever,
            // The largest factor by which a difference of rotations stretches a vector is its Frobenius norm divided by √2.
            Self::Axes(lever) => {
                let squared: f64 = (0..3).map(|axis| turned(axis).length_squared()).sum();
                (0.5 * squared).sqrt() * lever
            }
        };
        (to.translation - from.translation).length() + swing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{RandomGeometry, XorshiftStar, arm, arm_volumes, configuration};
    use elbowroom_kinematics::motion_bound::max_motion_bounds;

    /// Random motions of the arm, from its placement at the start, with the bounds of their paths.
    fn motions(check: impl Fn(&Configuration, [&[f64]; 2], f64, f64)) {
        let config = configuration(arm(), arm_volumes(), vec![]);
        let bounds = max_motion_bounds(&config.chain, config.volumes.iter().map(|v| (v.link, v.radius_in_link())));
        let r = &mut XorshiftStar(5);
        for _ in 0..300 {
            let size = r.between(0.0, 0.8);
            let from: Vec<f64> = (0..6).map(|_| r.between(-2.0, 2.0)).collect();
            let to: Vec<f64> = from.iter().map(|q| q + r.between(-size, size)).collect();
            let longest: f64 = bounds.iter().zip(from.iter().zip(&to)).map(|(b, (p, q))| b * (q - p).abs()).sum();
            let (mut travel, mut placement) = (VolumeTravel::new(&config), Placement::new(&config));
            placement.place_robot(&config, &from);
            assert_eq!(travel.advance(&placement), f64::INFINITY);
            placement.place_robot(&config, &to);
            let shift = travel.advance(&placement);
            check(&config, [&from, &to], shift, travel.path(shift, longest, &from, &to));
        }
    }

    fn placed(config: &Configuration, [from, to]: [&[f64]; 2], fraction: f64) -> Placement {
        let mut placement = Placement::new(config);
        let q: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * fraction).collect();
        placement.place_robot(config, &q);
        placement
    }

    #[test]
    fn no_point_travels_farther_than_the_path_between_two_instants_of_a_motion() {
        let farthest = std::cell::Cell::new(0.0_f64);
        motions(|config, ends, _, path| {
            for i in 0..16 {
                let (a, b) = (f64::from(i) / 16.0, f64::from(i + 1) / 16.0);
                let [before, after] = [a, b].map(|fraction| placed(config, ends, fraction));
                for (v, volume) in config.volumes.iter().enumerate() {
                    let travel = Lever::of(&volume.shape).travel(&before.volume_in_world[v], &after.volume_in_world[v]);
                    assert!(travel <= path * (b - a) + 1e-12, "{travel} of {path}");
                    farthest.set(farthest.get().max(travel / (path * (b - a))));
                }
            }
        });
        assert!(farthest.get() > 0.5, "the bound is loose: {}", farthest.get());
    }

    #[test]
    fn no_point_of_a_volume_is_farther_from_where_it_was_than_the_shift() {
        let r = std::cell::RefCell::new(XorshiftStar(7));
        motions(|config, ends, shift, _| {
            let [before, after] = [0.0, 1.0].map(|fraction| placed(config, ends, fraction));
            for (v, volume) in config.volumes.iter().enumerate() {
                // On round volumes, the points of the axis.
                let at = match &volume.shape {
                    Shape::Capsule(c) => Vec3::Z * c.half_length,
                    Shape::Sphere(_) => Vec3::ZERO,
                    shape => shape.support(r.borrow_mut().direction()),
                };
                let [from, to] = [&before, &after].map(|p| p.volume_in_world[v].transform_point(at));
                assert!(from.distance(to) <= shift + 1e-12);
            }
        });
    }
}
