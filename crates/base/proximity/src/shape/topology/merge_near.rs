//! Vertices that are nearly equal.

use std::collections::HashMap;

use elbowroom_spatial::Vec3;

/// Maps every vertex selected by `merge` to the nearest kept vertex within the tolerance (the first, if several are
/// equally near), or keeps it. At the start, `target` contains the first vertex with equal coordinates for each
/// vertex.
///
/// Cells are twice as wide as the tolerance, so that neighbours are in the 27 cells around, even with rounding.
pub(crate) fn merge_near(vertices: &[Vec3], target: &mut [u32], tolerance: f64, merge: impl Fn(usize) -> bool) {
    let width = (2.0 * tolerance).max(1e-290);
    let mut kept: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    for i in 0..vertices.len() {
        let v = vertices[i];
        if target[i] as usize != i {
            // The first vertex with the same coordinates has been decided already.
            target[i] = target[target[i] as usize];
            continue;
        }
        if !v.is_finite() || !merge(i) {
            continue;
        }
        let cell = v.to_array().map(|c| (c / width).floor());
        match nearest_kept(vertices, &kept, cell, v, tolerance) {
            Some(first) => target[i] = first,
            None => kept.entry(cell.map(key)).or_default().push(i as u32),
        }
    }
}

/// Cells are numbered by integral f64: an i64 would overflow if the tolerance is tiny compared with a coordinate.
fn key(cell: f64) -> u64 {
    (cell + 0.0).to_bits()
}

fn nearest_kept(
    vertices: &[Vec3],
    kept: &HashMap<[u64; 3], Vec<u32>>,
    cell: [f64; 3],
    v: Vec3,
    tolerance: f64,
) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for n in 0..27 {
        let step = [n % 3, n / 3 % 3, n / 9].map(|s| f64::from(s) - 1.0);
        let neighbour = std::array::from_fn(|k| key(cell[k] + step[k]));
        for &k in kept.get(&neighbour).into_iter().flatten() {
            let found = (vertices[k as usize].distance(v), k);
            if found.0 <= tolerance && best.is_none_or(|b| found < b) {
                best = Some(found);
            }
        }
    }
    best.map(|(_, k)| k)
}
