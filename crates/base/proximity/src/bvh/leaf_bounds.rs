//! Boxes, slabs and landmarks of consecutive leaves.

use elbowroom_spatial::Vec3;

use super::node::{LEAF_SIZE, Leaf};

/// Smallest and largest corner of the box around all triangles.
pub(crate) fn box_of(leaves: &[Leaf]) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = ([[f32::INFINITY; LEAF_SIZE]; 3], [[f32::NEG_INFINITY; LEAF_SIZE]; 3]);
    for leaf in leaves {
        for corner in &leaf.corner {
            for k in 0..3 {
                for lane in 0..LEAF_SIZE {
                    low[k][lane] = if corner[k][lane] < low[k][lane] { corner[k][lane] } else { low[k][lane] };
                    high[k][lane] = if corner[k][lane] > high[k][lane] { corner[k][lane] } else { high[k][lane] };
                }
            }
        }
    }
    let least = |x: [f32; LEAF_SIZE]| x.into_iter().fold(f32::INFINITY, f32::min);
    let most = |x: [f32; LEAF_SIZE]| x.into_iter().fold(f32::NEG_INFINITY, f32::max);
    (low.map(least), high.map(most))
}

/// The triangle centroid nearest to `center`.
pub(crate) fn most_central(leaves: &[Leaf], center: [f32; 3]) -> [f32; 3] {
    let (mut nearest, mut landmark) = ([f32::INFINITY; LEAF_SIZE], [center; LEAF_SIZE]);
    for Leaf { corner: [p, q, r] } in leaves {
        for lane in 0..LEAF_SIZE {
            let middle: [f32; 3] = std::array::from_fn(|k| (p[k][lane] + q[k][lane] + r[k][lane]) * (1.0 / 3.0));
            let [x, y, z]: [f32; 3] = std::array::from_fn(|k| middle[k] - center[k]);
            let square = x * x + y * y + z * z;
            if square < nearest[lane] {
                (nearest[lane], landmark[lane]) = (square, middle);
            }
        }
    }
    let best = (0..LEAF_SIZE).min_by(|&i, &j| nearest[i].total_cmp(&nearest[j])).unwrap_or(0);
    landmark[best]
}

/// Area-weighted mean normal, slightly shorter than 1; zero if the normals cancel or have no length.
pub(super) fn mean_normal(leaves: &[Leaf]) -> [f32; 3] {
    let mut sum = [[0.0f32; LEAF_SIZE]; 3];
    for leaf in leaves {
        let [a, b, c] = &leaf.corner;
        for lane in 0..LEAF_SIZE {
            let u: [f32; 3] = std::array::from_fn(|k| b[k][lane] - a[k][lane]);
            let v: [f32; 3] = std::array::from_fn(|k| c[k][lane] - a[k][lane]);
            sum[0][lane] += u[1] * v[2] - u[2] * v[1];
            sum[1][lane] += u[2] * v[0] - u[0] * v[2];
            sum[2][lane] += u[0] * v[1] - u[1] * v[0];
        }
    }
    let total = sum.map(|lanes| lanes.iter().map(|&x| f64::from(x)).sum::<f64>());
    let n = Vec3::from(total).try_normalize().map_or(Vec3::ZERO, |n| n * (1.0 - 1e-6));
    n.to_array().map(|x| x as f32)
}

/// Smallest and largest height of the corners along `n`.
pub(super) fn interval(leaves: &[Leaf], n: [f32; 3]) -> (f32, f32) {
    let (mut low, mut high) = ([f32::INFINITY; LEAF_SIZE], [f32::NEG_INFINITY; LEAF_SIZE]);
    for leaf in leaves {
        for [x, y, z] in &leaf.corner {
            for lane in 0..LEAF_SIZE {
                let p = n[0] * x[lane] + n[1] * y[lane] + n[2] * z[lane];
                low[lane] = if p < low[lane] { p } else { low[lane] };
                high[lane] = if p > high[lane] { p } else { high[lane] };
            }
        }
    }
    (low.into_iter().fold(f32::INFINITY, f32::min), high.into_iter().fold(f32::NEG_INFINITY, f32::max))
}
