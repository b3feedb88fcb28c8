//! Connected parts as meshes of their own.

use elbowroom_spatial::Vec3;

use super::{RepairError, check};
use crate::shape::topology::{first_of_equal, parts};

/// One connected part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its vertices, in the order given.
    pub vertices: Vec<Vec3>,
    /// Its triangles, indices into its vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Which triangles of the whole they were.
    pub from: Vec<u32>,
}

/// Connected parts in the order of their first triangles. Triangles that share a corner are connected; corners of
/// equal coordinates count as one.
///
/// ```
/// use elbowroom_proximity::repair::split;
/// use elbowroom_spatial::Vec3;
/// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z, Vec3::Y, Vec3::X, Vec3::splat(1.0)];
/// let parts = split(&corners, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
/// assert_eq!(parts.len(), 2);
/// assert_eq!(parts[0].from, [0, 2]);
/// ```
///
/// # Errors
/// A triangle names a vertex that is not there.
pub fn split(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<Part>, RepairError> {
    check(vertices.len(), triangles)?;
    let first = first_of_equal(vertices);
    let faces: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| first[i as usize])).collect();
    let part_of = parts(vertices.len(), &faces);
    let mut number = vec![u32::MAX; vertices.len()];
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (i, f) in faces.iter().enumerate() {
        let slot = &mut number[part_of[f[0] as usize] as usize];
        if *slot == u32::MAX {
            *slot = members.len() as u32;
            members.push(Vec::new());
        }
        members[*slot as usize].push(i as u32);
    }
    Ok(members.into_iter().map(|from| part(vertices, triangles, from)).collect())
}

fn part(vertices: &[Vec3], triangles: &[[u32; 3]], from: Vec<u32>) -> Part {
    let own: Vec<[u32; 3]> = from.iter().map(|&t| triangles[t as usize]).collect();
    // Sorting the few indices in use keeps many small parts from each walking all the vertices.
    let mut used: Vec<u32> = own.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let place = |i: u32| used.binary_search(&i).unwrap_or(0) as u32;
    let triangles = own.iter().map(|t| t.map(place)).collect();
    Part { vertices: used.iter().map(|&i| vertices[i as usize]).collect(), triangles, from }
}
