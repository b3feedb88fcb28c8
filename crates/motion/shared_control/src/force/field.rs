//! The forces of all fields on a tool at one place.

use elbowroom_spatial::Vec3;

use super::law::ForceLaw;

/// The sum of the fields at one place of the tool.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FieldSample {
    /// Energy stored, J.
    pub potential_j: f64,
    /// Force on the tool point, N, world axes.
    pub force_n: Vec3,
    /// How much less force there is per metre of motion, N/m, and per velocity, N·s/m; symmetric.
    pub(crate) stiffness: [[f64; 3]; 3],
    pub(crate) damping: [[f64; 3]; 3],
}

impl FieldSample {
    /// Force with the dampers at a velocity of the tool point (m/s), N.
    pub fn damped_force_n(&self, velocity: Vec3) -> Vec3 {
        let row = |i: usize| (0..3).map(|j| self.damping[i][j] * velocity[j]).sum();
        self.force_n - Vec3::new(row(0), row(1), row(2))
    }

    /// Adds a pair of bodies `distance_m` apart. `gradient` is the change of the distance per motion of the tool point:
    /// the unit vector away from the other body if the tool itself is near. `velocity` is that of the tool point, m/s.
    pub fn add(&mut self, law: &ForceLaw, range_m: f64, distance_m: f64, gradient: Vec3, velocity: Vec3) {
        if !(distance_m < range_m) {
            return;
        }
        self.potential_j += law.potential_j(distance_m, range_m);
        self.force_n += gradient * law.force_n(distance_m, range_m);
        add_outer(&mut self.stiffness, gradient, law.slope_n_m(distance_m, range_m));
        if gradient.dot(velocity) < 0.0 {
            add_outer(&mut self.damping, gradient, law.damping_at(distance_m, range_m));
        }
    }
}

fn add_outer(sum: &mut [[f64; 3]; 3], v: Vec3, factor: f64) {
    for (i, row) in sum.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += factor * v[i] * v[j];
        }
    }
}
