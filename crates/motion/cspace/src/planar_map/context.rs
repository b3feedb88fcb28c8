//! Constants of one convex obstacle for all planes, and the outlines of one plane.

use elbowroom_spatial::Vec3;
use elbowroom_validity::lanes::simd::Level as SimdLevel;

use super::arm_grid::{ArmDirections, ArmGrid, half_arc};
use super::normals::{OutlineNormals, PADDED_NORMALS};
use super::outline::Outline;
use super::precision::{MARGIN, ROUNDING};
use super::simd_math::WIDTH;
use super::span_writer::SpanWriter;
use super::sphere::SphereObstacle;
use crate::PlanarArm;

/// Constants of one obstacle, shared by all planes.
pub(super) struct ConvexContext {
    pub simd_level: SimdLevel,
    pub arm: PlanarArm,
    pub spans: SpanWriter,
    /// The obstacle's enclosing sphere, grown by the largest radius of the arm.
    pub grown: SphereObstacle,
    /// Tangent of half a step of θ1, and (in `stretch`) 1/cos − 1.
    pub tangent: f64,
    pub stretch: f64,
    /// Largest difference between the distance of a point of the grown obstacle from the base axis and its distance
    /// along the wedge's middle (x/cos δ1 instead of x), metres.
    pub max_stretch: f32,
    /// Sine and cosine of half a step of θ2.
    pub turn: [f32; 2],
    /// Margin for single precision, metres.
    pub margin: f32,
    pub sectors: Sectors,
    /// Cosine of the angle between neighbouring normals.
    pub spacing_cosine: f32,
    /// Cosine and sine of half the arc of the elbow over sixteen rows.
    pub arc: [f32; 2],
    /// Length of the upper arm plus its rounding error in single precision, metres.
    pub upper_reach: f32,
    /// Rounding error of a distance from a line in single precision, metres.
    pub rounding: f32,
    /// Distance of the elbow outside a line, metres, above which tangents are accurate to the margins: at a corner this
    /// near, rounding of a tangent moves the end of the forearm by at most the margin (eight times the rounding).
    pub clear: f32,
}

/// Conditions and width for cutting an outline into sectors around the shoulder.
#[derive(Clone, Copy)]
pub(super) struct Sectors {
    /// Angle below which an outline stays whole, radians.
    pub whole_rad: f64,
    /// Width of a sector, radians.
    pub width_rad: f64,
}

impl ConvexContext {
    /// Creates the constants of an obstacle within a sphere around `center` with `radius`, metres.
    pub fn new(arm_grid: &ArmGrid, center: Vec3, radius: f64) -> Self {
        let [half1, half2, _] = arm_grid.grid.half_widths();
        // The forearm ends in half a sphere, so the wrist's sphere is at least as large.
        let wrist_radius_m = arm_grid.arm.wrist_radius_m.max(arm_grid.arm.fore_radius_m);
        let arm = PlanarArm { wrist_radius_m, ..arm_grid.arm };
        let size = center.length() + radius + arm.reach_m();
        let grown_radius = radius + arm.max_radius_m();
        let stretch = 1.0 / half1.cos() - 1.0;
        Self {
            simd_level: arm_grid.simd_level,
            arm,
            spans: SpanWriter::new(&arm_grid.grid.axes()[2]),
            grown: SphereObstacle { center, radius: grown_radius },
            tangent: half1.tan(),
            stretch,
            max_stretch: ((center.x.hypot(center.y) + grown_radius) * stretch) as f32,
            turn: [half2.sin() as f32, half2.cos() as f32],
            margin: (MARGIN * size) as f32,
            sectors: Sectors::new(half2 * 2.0, radius > arm.fore_length_m),
            spacing_cosine: spacing_cosine(half2 * 2.0),
            arc: half_arc(half2 * (WIDTH - 1) as f64),
            upper_reach: (arm.upper_length_m + 1e-6 * size) as f32,
            rounding: (ROUNDING * size) as f32,
            clear: (arm.fore_length_m / 8.0) as f32,
        }
    }

    /// Disables cutting into sectors: faster, but more cells are blocked.
    pub fn without_sectors(mut self) -> Self {
        self.sectors.whole_rad = f64::INFINITY;
        self
    }

    /// Whether the enclosing sphere, grown by the largest radius of the arm, intersects the wedge.
    pub fn may_reach(&self, [cos, sin]: [f64; 2], side: f64) -> bool {
        let center = self.grown.center;
        let x = (center.x * cos + center.y * sin) * side;
        let y = (center.y * cos - center.x * sin).abs();
        let radius = self.grown.radius + f64::from(self.margin);
        x + radius > 0.0 && y - self.tangent * x <= radius * (1.0 + self.stretch)
    }
}

impl Sectors {
    /// Chooses the sectors. Coarse grids have few inner cells compared with the cells blocked needlessly at the
    /// boundary, and few rows to compute. For floors and walls at the end of the arm's reach, nearly all cells are at
    /// the boundary.
    fn new(step2: f64, is_large: bool) -> Self {
        let whole_rad = if is_large { 0.6 } else { (0.08 / step2).clamp(0.6, 2.0) };
        Self { whole_rad, width_rad: 0.25 }
    }
}

/// Cosine of 24 degrees between neighbouring normals, of 12 degrees in coarse grids.
fn spacing_cosine(step2: f64) -> f32 {
    if step2 > 0.045 { 0.978 } else { 0.9135 }
}

/// Outlines for the radii of the three links in one plane: the upper arm's outline unrotated, the other two rotated by
/// half a step of θ2.
pub(super) struct Outlines {
    pub normals: OutlineNormals,
    pub raw: Outline,
    pub upper: Outline,
    pub fore: Outline,
    pub wrist: Outline,
    /// Limits for corners: corner `k` of the wrist's outline is within reach of an elbow on its circle if `corner·elbow
    /// ≥ reach_limits[k]`.
    pub reach_limits: [f32; PADDED_NORMALS],
}

impl Outlines {
    pub fn new(context: &ConvexContext) -> Self {
        Self {
            normals: OutlineNormals::new([[1.0, 0.0]].into_iter(), context.spacing_cosine),
            raw: Outline::EMPTY,
            upper: Outline::EMPTY,
            fore: Outline::EMPTY,
            wrist: Outline::EMPTY,
            reach_limits: [0.0; PADDED_NORMALS],
        }
    }

    /// Sets [`Outlines::reach_limits`] from the wrist's corners.
    pub fn set_reach_limits(&mut self, context: &ConvexContext) {
        let (upper, fore) = (context.arm.upper_length_m, context.arm.fore_length_m);
        let squares = (upper * upper - fore * fore) as f32;
        let corners = self.wrist.corner_x.iter().zip(&self.wrist.corner_y).take(self.normals.count);
        for (limit, (x, y)) in self.reach_limits.iter_mut().zip(corners) {
            *limit = (x * x + y * y + squares) * 0.5;
        }
    }
}

/// The rows of one plane.
pub(super) struct PlaneRows<'a> {
    /// Index of the first row.
    pub first: usize,
    pub count: usize,
    /// One bit per row, set if the upper arm blocks the whole row.
    pub full: &'a [u16],
    pub middles: &'a ArmDirections,
    pub borders: &'a ArmDirections,
}
