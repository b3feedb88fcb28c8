//! Templates: known types of objects whose footprint gives their height.

use std::sync::Arc;

use elbowroom_spatial::Vec3;

use crate::{Point2, polygon};

/// A known type of object with upright sides.
///
/// ```
/// use elbowroom_vision::Template;
/// let pallet = Template::new("pallet", 1.2, 0.8, 0.15);
/// assert!(pallet.fits(1.21, 0.79) && !pallet.fits(0.8, 0.8));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Template {
    /// Name of obstacles of this type.
    pub name: Arc<str>,
    /// The longer side of the rectangle around the footprint, metres (the diameter of a cylinder).
    pub length_m: f64,
    /// The shorter side, metres.
    pub width_m: f64,
    /// Height, metres.
    pub height_m: f64,
    /// Whether the object is a cylinder, whose footprint fills π/4 of the rectangle around it.
    pub is_round: bool,
    /// Tolerance of each observed side, metres.
    pub tolerance_m: f64,
    /// Tolerance of the height, metres: obstacles are higher by this amount.
    pub height_tolerance_m: f64,
}

impl Template {
    /// Creates a cuboid with tolerances of 5 cm for the sides and 1 cm for the height.
    pub fn new(name: &str, length_m: f64, width_m: f64, height_m: f64) -> Self {
        Self {
            name: name.into(),
            length_m: length_m.max(width_m),
            width_m: length_m.min(width_m),
            height_m,
            is_round: false,
            tolerance_m: 0.05,
            height_tolerance_m: 0.01,
        }
    }

    /// Creates an upright cylinder with the same tolerances.
    pub fn cylinder(name: &str, diameter_m: f64, height_m: f64) -> Self {
        Self { is_round: true, ..Self::new(name, diameter_m, diameter_m, height_m) }
    }

    /// Whether a convex footprint has this size and shape: the sides of the rectangle around it and its area are within
    /// the tolerance.
    fn fits_footprint(&self, footprint_m: &[Point2]) -> bool {
        let (length, width) = polygon::min_area_rectangle(footprint_m);
        let fill_ratio = if self.is_round { std::f64::consts::FRAC_PI_4 } else { 1.0 };
        let area = |by: f64| fill_ratio * (self.length_m + by).max(0.0) * (self.width_m + by).max(0.0);
        let tolerance = self.tolerance_m;
        self.fits(length, width) && (area(-tolerance)..=area(tolerance)).contains(&polygon::area(footprint_m))
    }

    /// Whether a rectangle has these sides within the tolerance, longer side first.
    pub fn fits(&self, length_m: f64, width_m: f64) -> bool {
        (length_m - self.length_m).abs() <= self.tolerance_m && (width_m - self.width_m).abs() <= self.tolerance_m
    }

    /// Upper bound of the height, metres.
    pub fn max_height_m(&self) -> f64 {
        self.height_m + self.height_tolerance_m
    }

    /// Whether lengths are positive and finite, and tolerances 0 or more.
    pub(crate) fn is_usable(&self) -> bool {
        let sizes = [self.length_m, self.width_m, self.height_m];
        let tolerances = [self.tolerance_m, self.height_tolerance_m];
        sizes.iter().all(|s| s.is_finite() && *s > 0.0) && tolerances.iter().all(|t| t.is_finite() && *t >= 0.0)
    }
}

/// Matches outlines to templates; memory is reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct TemplateMatcher {
    bound_m: Vec<Point2>,
    clipped_m: Vec<Point2>,
    scaled_m: Vec<Point2>,
    workspace: Vec<Point2>,
    candidate_m: Vec<Point2>,
}

impl TemplateMatcher {
    /// Finds the template that matches an outline on the floor; among several, the highest one, which is safe.
    /// `footprint_m` is set to the footprint: the outline without the projection of the sides.
    pub(crate) fn best_match(
        &mut self,
        templates: &[Template],
        outline_m: &[Point2],
        eye_above_floor_m: Option<Vec3>,
        footprint_m: &mut Vec<Point2>,
    ) -> Option<usize> {
        let mut best: Option<usize> = None;
        for (i, template) in templates.iter().enumerate() {
            self.bound_footprint(outline_m, template, eye_above_floor_m);
            let is_higher = best.is_none_or(|b| templates[b].max_height_m() < template.max_height_m());
            if is_higher && template.fits_footprint(&self.candidate_m) {
                best = Some(i);
                std::mem::swap(footprint_m, &mut self.candidate_m);
            }
        }
        best
    }

    /// Bounds the footprint of an object with upright sides of height h. On the floor the object covers its footprint F
    /// and the projection of its top, which is F scaled from the nadir by s = H / (H − h); H is the height of the
    /// camera. Therefore F is within the outline and within the outline scaled by 1 / s. Because h is known only within
    /// a tolerance, the second bound is the hull of the two extreme scalings.
    fn bound_footprint(&mut self, outline_m: &[Point2], template: &Template, eye_above_floor_m: Option<Vec3>) {
        self.candidate_m.clear();
        self.candidate_m.extend_from_slice(outline_m);
        let Some(eye) = eye_above_floor_m else { return };
        let min_height_m = (template.height_m - template.height_tolerance_m).max(0.0);
        if template.max_height_m() >= eye.z {
            return;
        }
        let nadir = Point2::new(eye.x, eye.y);
        let scaled = |height: f64| outline_m.iter().map(move |&p| nadir + (p - nadir) * (1.0 - height / eye.z));
        self.scaled_m.clear();
        self.scaled_m.extend(scaled(min_height_m).chain(scaled(template.max_height_m())));
        polygon::convex_hull(&mut self.scaled_m, &mut self.bound_m);
        polygon::intersection(outline_m, &self.bound_m, &mut self.clipped_m, &mut self.workspace);
        if self.clipped_m.len() > 2 {
            std::mem::swap(&mut self.clipped_m, &mut self.candidate_m);
        }
    }
}
