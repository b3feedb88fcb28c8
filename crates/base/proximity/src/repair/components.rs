//! Splitting of a mesh into its connected components.

use elbowroom_spatial::Vec3;

use super::error::{RepairError, check};
use crate::shape::topology::{components, first_of_equal};

/// One connected component of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Vertices of the component, in the given order.
    pub vertices: Vec<Vec3>,
    /// Triangles of the component, as indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Indices of the triangles in the original mesh.
    pub from: Vec<u32>,
}

/// Splits a mesh into connected components, in the order of their first triangles.
///
/// Triangles that share a corner are connected; corners with equal coordinates count as one.
///
/// ```
/// use elbowroom_proximity::repair::split_components;
/// use elbowroom_spatial::Vec3;
/// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z, Vec3::Y, Vec3::X, Vec3::splat(1.0)];
/// let components = split_components(&corners, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
/// assert_eq!(components.len(), 2);
/// assert_eq!(components[0].from, [0, 2]);
/// ```
///
/// # Errors
/// [`RepairError`] if a triangle has an index beyond the vertex list.
pub fn split_components(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<Component>, RepairError> {
    check(vertices.len(), triangles)?;
    let first = first_of_equal(vertices);
    let faces: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| first[i as usize])).collect();
    let component_of = components(vertices.len(), &faces);
    let mut number = vec![u32::MAX; vertices.len()];
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (i, f) in faces.iter().enumerate() {
        let slot = &mut number[component_of[f[0] as usize] as usize];
        if *slot == u32::MAX {
            *slot = members.len() as u32;
            members.push(Vec::new());
        }
        members[*slot as usize].push(i as u32);
    }
    Ok(members.into_iter().map(|from| component(vertices, triangles, from)).collect())
}

fn component(vertices: &[Vec3], triangles: &[[u32; 3]], from: Vec<u32>) -> Component {
    let own: Vec<[u32; 3]> = from.iter().map(|&t| triangles[t as usize]).collect();
    // Sorting the indices in use avoids a pass over all vertices per component.
    let mut used: Vec<u32> = own.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let place = |i: u32| used.binary_search(&i).unwrap_or(0) as u32;
    let triangles = own.iter().map(|t| t.map(place)).collect();
    Component { vertices: used.iter().map(|&i| vertices[i as usize]).collect(), triangles, from }
}
