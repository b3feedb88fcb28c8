//! The feature of a shape in a direction: a point, an edge or a face.

use elbowroom_spatial::Vec3;

use super::tolerances::PatchTolerances;

/// The part of a shape within the tie tolerance of its farthest point along a direction.
#[derive(Debug, Clone, Copy)]
pub(crate) enum SupportFeature {
    /// The feature is smaller than the smallest patch.
    Point,
    /// An edge along this unit vector, and its width, metres.
    Edge(Vec3, f64),
    /// The feature is more than an edge.
    Face,
}

impl SupportFeature {
    /// The feature of the convex hull of `points`, whose farthest point is `top`.
    pub fn of(points: impl Iterator<Item = Vec3>, top: Vec3, along: Vec3, tolerances: PatchTolerances) -> Self {
        let PatchTolerances { tie, min_size } = tolerances;
        let mut found = Self::Point;
        let mut width: f64 = 0.0;
        for p in points {
            let (step, drop) = (p - top, (top - p).dot(along));
            let length = step.length();
            if !(length > min_size && drop * min_size < tie * length) {
                width = if length > min_size { width.max(tie * length / drop) } else { width.max(length) };
                continue;
            }
            match found {
                Self::Point => found = Self::Edge(step / length, 0.0),
                Self::Edge(u, _) if u.cross(step).length() <= min_size => {}
                _ => return Self::Face,
            }
        }
        if let Self::Edge(u, _) = found { Self::Edge(u, width) } else { found }
    }

    /// False if the features of two shapes are guaranteed to overlap in at most a point.
    pub fn may_overlap(self, other: Self, tolerances: PatchTolerances) -> bool {
        match (self, other) {
            (Self::Point, _) | (_, Self::Point) => false,
            (Self::Edge(u, width), Self::Edge(v, other_width)) => {
                u.cross(v).length() * tolerances.min_size <= 2.0 * (width + other_width) + 4.0 * tolerances.tie
            }
            _ => true,
        }
    }
}
