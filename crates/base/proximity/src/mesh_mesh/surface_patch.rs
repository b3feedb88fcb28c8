//! A part of a surface, as the search for local minima sees it: a ball, and a cone around its normals.

use elbowroom_spatial::Vec3;

use super::relative_placement::{AffineF32, RelativePlacement};
use crate::lanes::narrow;

/// Relative error of a difference of two squares of the same way in f32, with its factor: twice the 16 half-units of
/// rounding of a dot product, of an axis of nearly unit length, and of the squares.
pub(super) const SQUARE_ERROR: f32 = 2e-6;
/// Rounding of a coordinate in f32, with a margin, in units of a mesh.
const ROUNDING: f32 = 1e-6;

/// A set of directions around an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalCone {
    pub axis: [f32; 3],
    /// Half of the opening angle, radians; π contains every direction.
    pub half_angle: f32,
    pub cos: f32,
    pub sin: f32,
}

impl NormalCone {
    /// Every direction, with an axis along which a patch is thin.
    pub fn every_direction(axis: Vec3) -> Self {
        Self { axis: narrow(axis), half_angle: std::f32::consts::PI, cos: -1.0, sin: 0.0 }
    }

    /// A cone that contains cones given by their axes and half-angles; if it would not be convex, every direction with the
    /// other axis.
    pub fn around(cones: &(impl Iterator<Item = (Vec3, f64)> + Clone), other_axis: Vec3) -> Self {
        let widest = |axis: Vec3| {
            cones.clone().fold(0.0, |widest: f64, (n, half)| widest.max(axis.dot(n).clamp(-1.0, 1.0).acos() + half))
        };
        Self::of_axes(cones.clone().map(|(axis, _)| axis), widest, other_axis)
    }

    /// Like [`NormalCone::around`], for cones of the same half-angle: the axis that is farthest off decides.
    pub fn around_equal(axes: &(impl Iterator<Item = Vec3> + Clone), half_angle: f64, other_axis: Vec3) -> Self {
        let widest = |axis: Vec3| {
            let farthest = axes.clone().fold(1.0, |least: f64, n| least.min(axis.dot(n)));
            farthest.max(-1.0).acos() + half_angle
        };
        Self::of_axes(axes.clone(), widest, other_axis)
    }

    /// A cone around the mean of axes, with the half-angle that `widest` returns for it.
    fn of_axes(axes: impl Iterator<Item = Vec3>, widest: impl Fn(Vec3) -> f64, other_axis: Vec3) -> Self {
        let Some(axis) = axes.fold(Vec3::ZERO, |sum, axis| sum + axis).try_normalize() else {
            return Self::every_direction(other_axis);
        };
        let half_angle = widest(axis);
        if !(half_angle < std::f64::consts::FRAC_PI_2) {
            return Self::every_direction(other_axis);
        }
        Self {
            axis: narrow(axis),
            half_angle: half_angle as f32,
            cos: half_angle.cos() as f32,
            sin: half_angle.sin() as f32,
        }
    }

    fn axis_and_half_angle(&self) -> (Vec3, f64) {
        (Vec3::from(self.axis.map(f64::from)), f64::from(self.half_angle))
    }

    /// False if no direction of this cone is opposite to one of a cone with this axis, given in the same frame.
    #[inline(always)]
    fn may_face(&self, other: &Self, other_axis: [f32; 3]) -> bool {
        self.half_angle + other.half_angle >= std::f32::consts::PI
            || -dot(self.axis, other_axis) >= self.cos * other.cos - self.sin * other.sin
    }
}

/// A part of a surface: a ball around it, in the unit frame of its mesh, and the cone of its normals.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfacePatch {
    pub center: [f32; 3],
    pub radius: f32,
    /// Largest distance of a point from the centre along the axis of the cone.
    pub thickness: f32,
    pub cone: NormalCone,
}

impl SurfacePatch {
    /// A patch around others: the ball around the middle of their box.
    pub fn around(patches: &[Self]) -> Self {
        let bounds = |side: f32| -> [f32; 3] {
            std::array::from_fn(|k| {
                let ends = patches.iter().map(|p| side.mul_add(p.radius, p.center[k]) * side);
                ends.fold(f32::NEG_INFINITY, f32::max) * side
            })
        };
        let (low, high) = (bounds(-1.0), bounds(1.0));
        let center: [f32; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let reach = |p: &Self| {
            let offset: [f32; 3] = std::array::from_fn(|k| p.center[k] - center[k]);
            dot(offset, offset).sqrt() + p.radius
        };
        let radius = patches.iter().map(reach).fold(0.0, f32::max) * 1.000_01;
        let cones = patches.iter().map(|p| p.cone.axis_and_half_angle());
        let middle = cones.clone().fold(Vec3::ZERO, |sum, (axis, _)| sum + axis).try_normalize().unwrap_or(Vec3::Z);
        let cone = NormalCone::around(&cones, middle);
        let thickness = |p: &Self| {
            let offset: [f32; 3] = std::array::from_fn(|k| p.center[k] - center[k]);
            // A disc of the ball's radius and of the patch's own thickness. From the cosine, the sine of a small angle would
            // be 0.
            let [own, whole] = [&p.cone, &cone].map(|cone| cone.axis_and_half_angle().0);
            let sin = own.cross(whole).length() as f32 + ROUNDING;
            dot(offset, cone.axis).abs() + p.radius.min(p.thickness + p.radius * sin)
        };
        let thickness = patches.iter().map(thickness).fold(0.0, f32::max) * 1.000_01 + ROUNDING;
        Self { center, radius, thickness, cone }
    }

    /// A patch of one triangle with the corners in the unit frame.
    pub fn of_triangle([a, b, c]: [Vec3; 3], cone: NormalCone) -> Self {
        let center = (a + b + c) / 3.0;
        let farthest = |measure: &dyn Fn(Vec3) -> f64| {
            let [a, b, c] = [a, b, c].map(|corner| measure(corner - center));
            a.max(b).max(c) as f32 * 1.000_01 + ROUNDING
        };
        let axis = cone.axis_and_half_angle().0;
        let (radius, thickness) = (farthest(&Vec3::length), farthest(&|offset| offset.dot(axis).abs()));
        Self { center: narrow(center), radius, thickness, cone }
    }

    /// False if no point of this patch and of one of the other mesh can be nearest to each other in their neighbourhoods
    /// and no farther apart than the limit.
    ///
    /// The direction between them would lie in both cones, so the way from centre to centre would be, up to what the
    /// patches extend there, between 0 (of a cone of every direction: minus the limit) and the limit along the axis of each;
    /// and across the axis of the narrower cone, of the half-angle θ, up to the limit times sin θ.
    #[inline(always)]
    pub fn may_face(&self, other: &Self, pair: &FacingTest) -> bool {
        let other_axis = rotated(&pair.rows, other.cone.axis);
        if !self.cone.may_face(&other.cone, other_axis) {
            return false;
        }
        let center = rotated(&pair.scaled_rows, other.center);
        let way: [f32; 3] = std::array::from_fn(|k| center[k] + pair.shift[k] - self.center[k]);
        let other_radius = other.radius * pair.scale + pair.error;
        let other_thickness = other.thickness * pair.scale + pair.error;
        let along = (dot(way, self.cone.axis), -dot(way, other_axis));
        let is_between = |along: f32, cone: &NormalCone, reach: f32| {
            let least = if cone.cos < 0.0 { -pair.limit } else { 0.0 };
            along >= least - reach && along <= pair.limit + reach
        };
        if !is_between(along.0, &self.cone, self.thickness + other_radius)
            || !is_between(along.1, &other.cone, self.radius + other_thickness)
        {
            return false;
        }
        let (along, narrower) =
            if self.cone.half_angle <= other.cone.half_angle { (along.0, &self.cone) } else { (along.1, &other.cone) };
        let widest = self.radius + other_radius + pair.limit * narrower.sin;
        narrower.cos < 0.0 || dot(way, way) * (1.0 - SQUARE_ERROR) <= along * along + widest * widest
    }
}

/// What the test of two patches needs of the placement of the meshes, in units of A.
pub(super) struct FacingTest {
    pub rows: [[f32; 3]; 3],
    pub scaled_rows: [[f32; 3]; 3],
    pub shift: [f32; 3],
    pub scale: f32,
    /// Added to every radius: errors of f32.
    pub error: f32,
    /// Largest distance of two points.
    pub limit: f32,
}

impl FacingTest {
    pub fn new(placement: &RelativePlacement, limit: f64) -> Self {
        let AffineF32 { r, m, t, scale, .. } = placement.b_in_a;
        let error = 4.0 * placement.f32_error as f32;
        Self { rows: r, scaled_rows: m, shift: t, scale: scale * 1.000_01, error, limit: limit as f32 * 1.000_01 }
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn rotated(rows: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    [dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)]
}
