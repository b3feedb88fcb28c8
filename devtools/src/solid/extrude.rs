//! Thick plate of any outline, with rounded rims.

use std::f64::consts::FRAC_PI_2;

use elbowroom_spatial::Vec3;

use super::outline::{Outline, inset};
use super::{Mesh, loft};

/// Number of edges of a rounded rim.
const RIM: usize = 3;

/// Extrudes the outline (x, y) from `from` to `to` along z, with both rims rounded with radius `rim`; 0 leaves them sharp.
pub fn extrude(outline: &[[f64; 2]], from: f64, to: f64, rim: f64) -> Mesh {
    let at = |flat: Outline, z: f64| -> Vec<Vec3> { flat.iter().map(|&[x, y]| Vec3::new(x, y, z)).collect() };
    if rim <= 0.0 {
        return loft(&[at(outline.to_vec(), from), at(outline.to_vec(), to)]);
    }
    let step = |i: usize| {
        let (sin, cos) = (FRAC_PI_2 * i as f64 / RIM as f64).sin_cos();
        (rim * (1.0 - sin), rim * (1.0 - cos))
    };
    let lower = (0..=RIM).map(|i| at(inset(outline, step(i).0), from + step(i).1));
    let upper = (0..=RIM).rev().map(|i| at(inset(outline, step(i).0), to - step(i).1));
    loft(&lower.chain(upper).collect::<Vec<_>>())
}
