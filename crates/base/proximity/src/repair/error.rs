//! Errors of mesh repair.

/// Why triangles were refused and not changed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RepairError {
    /// The tolerance is negative, NaN or infinite.
    #[error("the welding tolerance is {0}, it must be a finite number of metres, 0 (equal coordinates) or more")]
    Tolerance(f64),
    /// A triangle has an index beyond the vertex list.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex index in the triangle.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// More vertices or triangles than 32-bit indices can number.
    #[error("{0} is more vertices or triangles than 32-bit indices can name (4294967295)")]
    TooLarge(usize),
}

pub(super) fn check(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), RepairError> {
    let largest = vertices.max(triangles.len());
    if u32::try_from(largest).is_err() {
        return Err(RepairError::TooLarge(largest));
    }
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices) {
            return Err(RepairError::IndexOutOfRange { triangle, index, vertices });
        }
    }
    Ok(())
}
