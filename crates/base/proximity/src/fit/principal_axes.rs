//! Principal axes of a set of points, and descent over rotations.

use elbowroom_spatial::{Rotation, Vec3};

/// Orthonormal axes of the covariance, by Jacobi rotations.
pub(super) fn principal(points: &[Vec3]) -> Rotation {
    let mean = points.iter().fold(Vec3::ZERO, |s, &p| s + p / points.len() as f64);
    let mut m = [[0.0; 3]; 3];
    for p in points {
        let d = (*p - mean).to_array();
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += d[i] * d[j];
            }
        }
    }
    let mut axes = Rotation::IDENTITY;
    for _ in 0..12 {
        for (i, j, axis) in [(0, 1, Vec3::Z), (1, 2, Vec3::X), (2, 0, Vec3::Y)] {
            if m[i][j] == 0.0 {
                continue;
            }
            let angle = 0.5 * (2.0 * m[i][j]).atan2(m[i][i] - m[j][j]);
            let turn = Rotation::from_axis_angle(axis, angle);
            axes = axes * turn;
            m = congruent(&m, turn);
        }
    }
    if axes.is_finite() { axes.renormalized() } else { Rotation::IDENTITY }
}

/// `turnᵀ m turn`.
fn congruent(m: &[[f64; 3]; 3], turn: Rotation) -> [[f64; 3]; 3] {
    let r = turn.rows();
    let product = |i: usize, j: usize| {
        let mut sum = 0.0;
        for k in 0..3 {
            for l in 0..3 {
                sum += r[k][i] * m[k][l] * r[l][j];
            }
        }
        sum
    };
    std::array::from_fn(|i| std::array::from_fn(|j| product(i, j)))
}

/// Rotates a frame about its own axes by ever smaller steps while the cost decreases.
pub(super) fn descend(start: Rotation, axes: &[Vec3], mut cost: impl FnMut(Rotation) -> f64) -> (f64, Rotation) {
    let mut best = (cost(start), start);
    let mut step = 0.3;
    while step > 1e-4 {
        let mut improved = false;
        for &axis in axes {
            for angle in [step, -step] {
                let rotated = (best.1 * Rotation::from_axis_angle(axis, angle)).renormalized();
                let value = cost(rotated);
                if value < best.0 * (1.0 - 1e-9) {
                    best = (value, rotated);
                    improved = true;
                }
            }
        }
        if !improved {
            step *= 0.5;
        }
    }
    best
}
