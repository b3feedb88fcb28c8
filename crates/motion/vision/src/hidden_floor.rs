//! The floor that was hidden while the empty cell was learnt.

use crate::{Calibration, CameraTrackerSettings, Point2, polygon};

/// Floor that no image of the empty cell showed: it is unknown, so it counts as an obstacle as soon as it can be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HiddenFloor {
    /// Smallest world x and y of the floor, m.
    pub min_m: Point2,
    /// Largest world x and y of the floor, m.
    pub max_m: Point2,
    /// Area of the floor, m².
    pub area_m2: f64,
}

impl HiddenFloor {
    /// Computes the floor of the pixels that were never seen, with `width` pixels per row. `None` if fewer pixels are
    /// within the area than an obstacle has.
    pub(crate) fn of(
        seen: &[u16],
        width: usize,
        calibration: &Calibration,
        settings: &CameraTrackerSettings,
    ) -> Option<Self> {
        let corner =
            |x: usize, y: usize| calibration.pixel_to_floor(Point2::new(x as f64, y as f64), settings.track.floor_z_m);
        let (mut pixels, mut hidden) = (0, None::<Self>);
        for (i, _) in seen.iter().enumerate().filter(|(_, count)| **count == 0) {
            let (x, y) = (i % width, i / width);
            let corners = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            let [Some(a), Some(b), Some(c), Some(d)] = corners else { continue };
            let middle = (a + c) * 0.5;
            if !settings.track.area_m.is_empty() && !polygon::contains(&settings.track.area_m, middle) {
                continue;
            }
            pixels += 1;
            let pixel = Self { min_m: middle, max_m: middle, area_m2: polygon::area(&[a, b, c, d]).abs() };
            hidden = Some(hidden.map_or(pixel, |h| h.with(&pixel)));
        }
        hidden.filter(|_| pixels >= settings.min_area_px)
    }

    fn with(&self, other: &Self) -> Self {
        let (a, b) = (self, other);
        Self {
            min_m: Point2::new(a.min_m.x.min(b.min_m.x), a.min_m.y.min(b.min_m.y)),
            max_m: Point2::new(a.max_m.x.max(b.max_m.x), a.max_m.y.max(b.max_m.y)),
            area_m2: a.area_m2 + b.area_m2,
        }
    }
}
