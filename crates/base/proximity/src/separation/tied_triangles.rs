//! The triangles of a mesh that are equally near to a solid.

/// The triangles that may be as near as the nearest one.
pub(super) struct TiedTriangles {
    triangles: [u32; Self::CAPACITY],
    /// More than the capacity if some were not noted.
    count: usize,
}

impl TiedTriangles {
    /// The flange of a robot has up to 130 tied triangles beside a box.
    const CAPACITY: usize = 256;

    pub(super) fn new() -> Self {
        Self { triangles: [0; Self::CAPACITY], count: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn note(&mut self, triangle: usize) {
        if let Some(place) = self.triangles.get_mut(self.count) {
            *place = triangle as u32;
        }
        self.count += 1;
    }

    /// All tied triangles; `None` if they are too many to be noted.
    pub(super) fn all(&self) -> Option<&[u32]> {
        self.triangles.get(..self.count)
    }
}

/// The triangles of a mesh nearest to a core.
pub(super) struct NearestTriangles<'a> {
    /// A triangle that contains the point of the gap.
    pub(super) nearest: usize,
    /// Triangles that may be as near.
    pub(super) tied: &'a TiedTriangles,
    /// Sum of the distances of the points of tied triangles.
    pub(super) spread: f64,
}
