//! Known kinds of things: a footprint of a certain size tells the height.

use std::sync::Arc;

use elbowroom_spatial::Vec3;

use crate::{Point2, polygon};

/// A known kind of thing, with upright sides.
///
/// ```
/// use elbowroom_vision::Template;
/// let pallet = Template::new("pallet", 1.2, 0.8, 0.15);
/// assert!(pallet.fits(1.21, 0.79) && !pallet.fits(0.8, 0.8));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Template {
    /// What obstacles of this kind are called.
    pub name: Arc<str>,
    /// The longer side of the rectangle around its footprint, metres (the diameter of a round thing).
    pub length_m: f64,
    /// The shorter side, metres.
    pub width_m: f64,
    /// Its height, metres.
    pub height_m: f64,
    /// Round (a cylinder) or square-cornered: a round footprint fills π/4 of its rectangle.
    pub is_round: bool,
    /// How far each side as seen may be off, metres.
    pub tolerance_m: f64,
    /// How far the height of a single thing may be off, metres: obstacles are that much higher.
    pub height_tolerance_m: f64,
}

impl Template {
    /// A kind of thing with tolerances of 5 cm for the sides and 1 cm for the height.
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

    /// An upright cylinder, with the same tolerances.
    pub fn round(name: &str, diameter_m: f64, height_m: f64) -> Self {
        Self { is_round: true, ..Self::new(name, diameter_m, diameter_m, height_m) }
    }

    /// Whether a convex footprint has this size and shape: the sides of the rectangle around it within the tolerance, and
    /// its area within what that tolerance makes of it.
    fn fits_footprint(&self, footprint_m: &[Point2]) -> bool {
        let (length, width) = polygon::rectangle(footprint_m);
        let share = if self.is_round { std::f64::consts::FRAC_PI_4 } else { 1.0 };
        let area = |by: f64| share * (self.length_m + by).max(0.0) * (self.width_m + by).max(0.0);
        let tolerance = self.tolerance_m;
        self.fits(length, width) && (area(-tolerance)..=area(tolerance)).contains(&polygon::area(footprint_m))
    }

    /// Whether a rectangle with these sides, the longer one first, is this kind of thing.
    pub fn fits(&self, length_m: f64, width_m: f64) -> bool {
        (length_m - self.length_m).abs() <= self.tolerance_m && (width_m - self.width_m).abs() <= self.tolerance_m
    }

    /// Height of the top above the floor that is not exceeded, metres.
    pub fn top_m(&self) -> f64 {
        self.height_m + self.height_tolerance_m
    }

    fn is_usable(&self) -> bool {
        let sizes = [self.length_m, self.width_m, self.height_m];
        let tolerances = [self.tolerance_m, self.height_tolerance_m];
        sizes.iter().all(|s| s.is_finite() && *s > 0.0) && tolerances.iter().all(|t| t.is_finite() && *t >= 0.0)
    }

    pub(crate) fn problem(&self) -> Option<(&'static str, f64)> {
        (!self.is_usable()).then_some(("templates", self.height_m))
    }
}

/// Scratch of [`Footprints::find`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Footprints {
    low: Vec<Point2>,
    high: Vec<Point2>,
    both: Vec<Point2>,
    spare: Vec<Point2>,
    candidate: Vec<Point2>,
}

impl Footprints {
    /// The template that an outline on the floor belongs to; of several the highest, which is safe. `footprint` becomes
    /// what it stands on: the outline without what only its height adds.
    pub(crate) fn find(
        &mut self,
        templates: &[Template],
        outline_m: &[Point2],
        eye_above_floor: Option<Vec3>,
        footprint: &mut Vec<Point2>,
    ) -> Option<usize> {
        let mut best: Option<usize> = None;
        for (i, template) in templates.iter().enumerate() {
            self.refine(outline_m, template, eye_above_floor);
            let is_higher = best.is_none_or(|b| templates[b].top_m() < template.top_m());
            if is_higher && template.fits_footprint(&self.candidate) {
                best = Some(i);
                std::mem::swap(footprint, &mut self.candidate);
            }
        }
        best
    }

    /// A solid with upright sides of height h covers on the floor its footprint F and its top, which is F scaled from
    /// the nadir by s = H / (H − h), H the eye's height. So F lies in the outline, and in the outline scaled by 1 / s. As h
    /// is known within a tolerance only, the second is the hull of the two extreme scalings.
    fn refine(&mut self, outline_m: &[Point2], template: &Template, eye_above_floor: Option<Vec3>) {
        self.candidate.clear();
        self.candidate.extend_from_slice(outline_m);
        let Some(eye) = eye_above_floor else { return };
        let low = (template.height_m - template.height_tolerance_m).max(0.0);
        if template.top_m() >= eye.z {
            return;
        }
        let nadir = Point2::new(eye.x, eye.y);
        let scaled = |height: f64| outline_m.iter().map(move |&p| nadir + (p - nadir) * (1.0 - height / eye.z));
        self.both.clear();
        self.both.extend(scaled(low).chain(scaled(template.top_m())));
        polygon::convex_hull(&mut self.both, &mut self.low);
        polygon::intersection(outline_m, &self.low, &mut self.high, &mut self.spare);
        if self.high.len() > 2 {
            std::mem::swap(&mut self.high, &mut self.candidate);
        }
    }
}
