//! Merging of vertices that represent the same point.

use elbowroom_spatial::Vec3;

use super::error::{RepairError, check};
use crate::shape::topology::{Edges, first_of_equal, is_degenerate, is_proper, merge_near};

/// The result of [`weld`].
#[derive(Debug, Clone, PartialEq)]
pub struct Welded {
    /// The remaining vertices, in the given order.
    pub vertices: Vec<Vec3>,
    /// The remaining triangles, in the given order, as indices into the remaining vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Counts of the changes.
    pub report: WeldReport,
}

/// Counts of what [`weld`] changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WeldReport {
    /// Number of vertices replaced by an earlier one.
    pub merged: usize,
    /// Number of vertices removed because no remaining triangle uses them.
    pub unused: usize,
    /// Number of triangles removed because they have no area.
    pub zero_area: usize,
    /// Number of triangles without area that were kept, because without them a closed surface would open: three
    /// different corners on a line, for example at the meeting of a long edge and two short ones.
    pub slivers_kept: usize,
    /// Number of triangles removed because an earlier one has the same corners in the same orientation. Two triangles of
    /// opposite orientation are kept: they are the wall between two solids.
    pub duplicate: usize,
}

/// Merges vertices within `tolerance` metres, and removes triangles that have lost their area or are duplicates.
///
/// Vertices are processed in order. Each is merged into the nearest kept vertex within the tolerance (the first, if
/// several are equally near), or is kept itself. So under any input:
///
/// - a vertex never moves by more than the tolerance, however long a chain of close neighbours is;
/// - two kept vertices are never within the tolerance of each other;
/// - the result depends only on the input.
///
/// Tolerance 0 merges equal coordinates. Vertices that are not finite are not changed.
///
/// # Errors
/// [`RepairError`] if the tolerance is not a finite number of metres, 0 or more, or a triangle has an index beyond
/// the vertex list.
pub fn weld(vertices: &[Vec3], triangles: &[[u32; 3]], tolerance: f64) -> Result<Welded, RepairError> {
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(RepairError::Tolerance(tolerance));
    }
    check(vertices.len(), triangles)?;
    let target = merge_targets(vertices, tolerance);
    let merged = target.iter().enumerate().filter(|&(i, &t)| t as usize != i).count();
    let faces: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| target[i as usize])).collect();
    let mut report = WeldReport { merged, ..WeldReport::default() };
    let kept = without_copies(&without_flat(vertices, faces, &mut report), &mut report);
    let (vertices, triangles) = compact(vertices, &kept);
    report.unused = target.len() - merged - vertices.len();
    Ok(Welded { vertices, triangles, report })
}

/// For each vertex, the index of the vertex into which [`weld`] merges it; its own index if it is kept. A tolerance
/// that is not a positive finite number of metres merges equal coordinates.
///
/// ```
/// use elbowroom_proximity::repair::merge_targets;
/// use elbowroom_spatial::Vec3;
/// let vertices = [Vec3::ZERO, Vec3::X, Vec3::ZERO, Vec3::X * (1.0 + 1e-10)];
/// assert_eq!(merge_targets(&vertices, 0.0), [0, 1, 0, 3]);
/// assert_eq!(merge_targets(&vertices, 1e-9), [0, 1, 0, 1]);
/// ```
pub fn merge_targets(vertices: &[Vec3], tolerance: f64) -> Vec<u32> {
    let mut target = first_of_equal(vertices);
    if tolerance > 0.0 && tolerance.is_finite() {
        merge_near(vertices, &mut target, tolerance, |_| true);
    }
    target
}

/// Removes triangles without area. A triangle with three different corners toggles whether its edges are matched, so
/// it is removed only if one of its edges is unmatched anyway.
fn without_flat(vertices: &[Vec3], faces: Vec<[u32; 3]>, report: &mut WeldReport) -> Vec<[u32; 3]> {
    let flat: Vec<bool> = faces.iter().map(|f| is_degenerate(f.map(|i| vertices[i as usize]))).collect();
    let mut beside_open = vec![false; faces.len()];
    if flat.iter().zip(&faces).any(|(&flat, f)| flat && is_proper(f)) {
        let edges = Edges::new(vertices.len(), &faces, |triangle, _| triangle as u32);
        edges.for_each(|_, _, uses| {
            if uses.len() % 2 == 1 {
                for &u in uses {
                    beside_open[u as u32 as usize] = true;
                }
            }
        });
    }
    let mut kept = Vec::with_capacity(faces.len());
    for (i, f) in faces.into_iter().enumerate() {
        if flat[i] && (!is_proper(&f) || beside_open[i]) {
            report.zero_area += 1;
        } else {
            report.slivers_kept += usize::from(flat[i]);
            kept.push(f);
        }
    }
    kept
}

fn without_copies(faces: &[[u32; 3]], report: &mut WeldReport) -> Vec<[u32; 3]> {
    // Rotated so that the smallest corner is first, triangles with the same corners and orientation are equal.
    let rotated = |f: &[u32; 3]| {
        let least = (0..3).min_by_key(|&k| f[k]).unwrap_or(0);
        [f[least], f[(least + 1) % 3], f[(least + 2) % 3]]
    };
    let mut order: Vec<([u32; 3], u32)> = faces.iter().enumerate().map(|(i, f)| (rotated(f), i as u32)).collect();
    order.sort_unstable();
    let mut duplicate = vec![false; faces.len()];
    for pair in order.windows(2).filter(|p| p[0].0 == p[1].0) {
        duplicate[pair[1].1 as usize] = true;
    }
    report.duplicate = duplicate.iter().filter(|&&d| d).count();
    faces.iter().zip(duplicate).filter(|(_, duplicate)| !duplicate).map(|(f, _)| *f).collect()
}

/// The vertices in use, in their given order, and the triangles with the new indices.
fn compact(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut index = vec![u32::MAX; vertices.len()];
    triangles.iter().flatten().for_each(|&i| index[i as usize] = 0);
    let mut used = Vec::new();
    for (p, v) in index.iter_mut().zip(vertices).filter(|(p, _)| **p == 0) {
        *p = used.len() as u32;
        used.push(*v);
    }
    (used, triangles.iter().map(|t| t.map(|i| index[i as usize])).collect())
}
