//! Prisms in synthetic images.

use elbowroom_spatial::Vec3;

use crate::Point2;

/// A prism on the floor, with one colour for its top and shades of it for its sides.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderedSolid {
    /// Convex footprint, counter-clockwise, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// Lower end, world z, metres.
    pub z_from_m: f64,
    /// Upper end, world z, metres.
    pub z_to_m: f64,
    /// Red, green and blue of the top; grey images show the green.
    pub colour: [u8; 3],
}

impl RenderedSolid {
    /// Creates a box on the floor (z = 0), rotated by `angle` radians about its vertical axis.
    pub fn cuboid(centre_m: Point2, size_m: Vec3, angle: f64, grey: u8) -> Self {
        let (sin, cos) = angle.sin_cos();
        let corner = |(sx, sy): (f64, f64)| {
            let (x, y) = (sx * size_m.x / 2.0, sy * size_m.y / 2.0);
            centre_m + Point2::new(cos * x - sin * y, sin * x + cos * y)
        };
        let footprint_m = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
        Self { footprint_m, z_from_m: 0.0, z_to_m: size_m.z, colour: [grey; 3] }
    }

    /// Creates an upright cylinder on the floor (z = 0), with 32 sides inscribed in the circle.
    pub fn cylinder(centre_m: Point2, radius_m: f64, height_m: f64, grey: u8) -> Self {
        let corner = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 32.0).sin_cos();
            centre_m + Point2::new(cos, sin) * radius_m
        };
        Self { footprint_m: (0..32).map(corner).collect(), z_from_m: 0.0, z_to_m: height_m, colour: [grey; 3] }
    }
}
