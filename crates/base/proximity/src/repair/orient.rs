//! Consistent orientation: faces of a closed surface point outward.

use elbowroom_spatial::Vec3;

use super::error::{RepairError, check};
use super::shells::{Shell, Shells};
use crate::TriMesh;

/// The result of [`orient`].
#[derive(Debug, Clone, PartialEq)]
pub struct Oriented {
    /// The same triangles in the same order, some with two corners swapped.
    pub triangles: Vec<[u32; 3]>,
    /// Counts of the changes.
    pub report: OrientReport,
}

/// Counts of what [`orient`] found and changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OrientReport {
    /// Number of reversed triangles.
    pub flipped: usize,
    /// Number of shells: surfaces connected over edges of two faces.
    pub shells: usize,
    /// Number of closed shells.
    pub closed: usize,
    /// Number of closed shells that face inward because they bound a cavity inside another shell.
    pub cavities: usize,
    /// Number of shells that are not orientable, such as a Möbius strip; they are not changed.
    pub one_sided: usize,
}

/// Reverses triangles so that neighbours agree and closed surfaces face outward.
///
/// Corners with equal coordinates count as one; edges of more than two faces do not connect. Open surfaces keep the
/// orientation of their first triangle. A closed surface inside another of the opposite orientation bounds a cavity
/// and stays opposite.
///
/// # Errors
/// [`RepairError`] if a triangle has an index beyond the vertex list.
pub fn orient(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Oriented, RepairError> {
    check(vertices.len(), triangles)?;
    let Shells { list, reversed } = Shells::of(vertices, triangles);
    let outward = outward(&list, vertices, triangles);
    let mut report = OrientReport { shells: list.len(), ..OrientReport::default() };
    let mut oriented = triangles.to_vec();
    for (shell, outward) in list.iter().zip(&outward) {
        report.closed += usize::from(shell.closed);
        report.one_sided += usize::from(!shell.orientable);
        report.cavities += usize::from(!outward);
        if !shell.orientable {
            continue;
        }
        let inverted = shell.volume.is_some_and(|v| (v > 0.0) != *outward);
        for &f in shell.faces.iter().filter(|&&f| reversed[f as usize] != inverted) {
            oriented[f as usize].swap(1, 2);
            report.flipped += 1;
        }
    }
    Ok(Oriented { triangles: oriented, report })
}

/// Whether each shell faces outward: true unless it bounds a cavity.
fn outward(list: &[Shell], vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut outward = vec![true; list.len()];
    // The sign of the volume is meaningful only if the orientation is consistent.
    let signed: Vec<(usize, f64)> =
        list.iter().enumerate().filter(|(_, s)| s.consistent).filter_map(|(i, s)| Some((i, s.volume?))).collect();
    let mixed = signed.iter().any(|d| d.1 > 0.0) && signed.iter().any(|d| d.1 < 0.0);
    if !mixed {
        return outward;
    }
    let mut by_size = signed;
    by_size.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
    let mut solids: Vec<Option<TriMesh>> = vec![None; list.len()];
    for n in 0..by_size.len() {
        let (i, volume) = by_size[n];
        let enclosing =
            by_size[..n].iter().rev().find(|&&(e, _)| encloses(e, i, list, vertices, triangles, &mut solids));
        if let Some(&(parent, parent_volume)) = enclosing {
            outward[i] = !(outward[parent] && (volume > 0.0) != (parent_volume > 0.0));
        }
    }
    outward
}

fn encloses(
    outer: usize,
    inner: usize,
    list: &[Shell],
    vertices: &[Vec3],
    triangles: &[[u32; 3]],
    solids: &mut [Option<TriMesh>],
) -> bool {
    let (o, i) = (&list[outer], &list[inner]);
    if !(o.bounds.contains(i.bounds.min) && o.bounds.contains(i.bounds.max)) {
        return false;
    }
    if solids[outer].is_none() {
        let corners: Vec<Vec3> =
            o.faces.iter().flat_map(|&f| triangles[f as usize].map(|v| vertices[v as usize])).collect();
        let own = (0..o.faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        solids[outer] = TriMesh::new(corners, own).ok();
    }
    let corner = vertices[triangles[i.faces[0] as usize][0] as usize];
    solids[outer].as_ref().is_some_and(|m| m.contains(corner))
}
