//! The part of a box that a sensor is sure to see.

use elbowroom_cell::{Cell, CellSensor, SensorKind};
use elbowroom_spatial::Vec3;
use elbowroom_vision::{CameraTrackerSettings, Point2};

use super::arm::Arm;
use super::guarded::Guarded;
use super::seen_box::{corners, solid};
use super::start::start;
use crate::fuzz_cells::spec::{LensSpec, SeenBox, SensorSpec, SensorView};

/// An outline in pixels is right up to so many of them.
const PIXELS: f64 = 1.5;
/// Rounding of the numbers of a file of points, and of heights in whole steps of depth, m.
const ROUNDING_M: f64 = 0.003;
/// Where something is nearer to a line of sight than this, m, what is behind it may not have been seen.
const HIDES_M: f64 = 0.2;

/// A box without the borders that the sensor may not see, if it sees the box at all.
pub fn seen_part(sensor: &SensorSpec, read: &CellSensor, cell: &Cell, one: &SeenBox) -> Option<SeenBox> {
    let (bottom, mut top) = (one.at[2], one.at[2] + one.size[2]);
    let (track, border) = match (&read.kind, &sensor.view) {
        (SensorKind::Cloud { settings, .. }, view) => {
            let is_above_floor = bottom >= sensor.floor + settings.floor_thickness_m;
            if !is_above_floor || top > sensor.floor + settings.ceiling_m {
                return None;
            }
            let border = match view {
                // A lower side is not measured, and what is behind another box is hidden.
                SensorView::Depths { lens, .. } => {
                    let is_whole = settings.extend_to_floor && is_in_view(sensor, lens, one);
                    if !is_whole || sensor.boxes.iter().any(|other| may_hide(sensor, other, one)) {
                        return None;
                    }
                    PIXELS * (sensor.at[2] - top) / lens.focal
                }
                // A cube at an edge may have a single point.
                _ if settings.min_points > 1 => settings.voxel_m,
                _ => 0.0,
            };
            (&settings.track, border)
        }
        (SensorKind::Camera { settings, .. }, SensorView::Camera { lens }) => {
            // Other boxes that hide a part are one obstacle with it, but for those that were learnt.
            let mut learnt = sensor.boxes.iter().filter(|other| other.is_learnt);
            let is_hidden = is_hidden(sensor, cell, one) || learnt.any(|other| may_hide(sensor, other, one));
            if !is_in_view(sensor, lens, one) || is_hidden {
                return None;
            }
            top = top.min(sensor.floor + least_height_m(settings));
            (&settings.track, PIXELS * (sensor.at[2] - sensor.floor) / lens.focal)
        }
        (SensorKind::Camera { .. }, _) => return None,
    };
    if !is_in_area(one, &track.area_m) {
        return None;
    }
    let border = (border - track.uncertainty_m).max(0.0) + ROUNDING_M;
    let size = [one.size[0] - 2.0 * border, one.size[1] - 2.0 * border, top - bottom - 2.0 * ROUNDING_M];
    let at = [one.at[0], one.at[1], bottom + ROUNDING_M];
    size.iter().all(|side| *side > 0.0).then(|| SeenBox { at, size, ..one.clone() })
}

/// The least height that a camera takes a thing for: a footprint decides which template it is.
fn least_height_m(settings: &CameraTrackerSettings) -> f64 {
    settings.templates.iter().map(|template| template.height_m).fold(f64::INFINITY, f64::min)
}

/// Whether a box is over an area, a rectangle along the axes of the world; an area without corners is everywhere.
fn is_in_area(one: &SeenBox, area: &[Point2]) -> bool {
    let range = |of: fn(&Point2) -> f64| {
        area.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((x0, x1), (y0, y1)) = (range(|p| p.x), range(|p| p.y));
    area.is_empty() || corners(one).all(|c| c.x > x0 && c.x < x1 && c.y > y0 && c.y < y1)
}

/// Whether the whole of a box is in a picture, away from its border.
fn is_in_view(sensor: &SensorSpec, lens: &LensSpec, one: &SeenBox) -> bool {
    let [x, y, z] = sensor.at;
    let least = lens.columns.min(lens.rows) as f64 * 0.45;
    corners(one).all(|c| c.z < z && (c.x - x).hypot(c.y - y) / (z - c.z) * lens.focal < least)
}

/// Whether another box may hide a part of a box at some time.
fn may_hide(sensor: &SensorSpec, other: &SeenBox, one: &SeenBox) -> bool {
    let [x, y, z] = sensor.at;
    let (solid, at) = solid(other);
    let crosses = |to: Vec3| solid.is_crossed(&at, [Vec3::new(x, y, z), to], HIDES_M);
    other.at != one.at && (other.velocity != [0.0; 2] || corners(one).any(crosses))
}

/// Whether a robot may hide a part of a box from a camera at the start.
fn is_hidden(sensor: &SensorSpec, cell: &Cell, one: &SeenBox) -> bool {
    let [x, y, z] = sensor.at;
    cell.robots.iter().enumerate().any(|(index, robot)| {
        let frames = Arm::new(robot).frames(start(cell, index));
        let parts = Guarded::all(robot);
        let crosses = |to: Vec3| parts.iter().any(|part| part.is_crossed(&frames, [Vec3::new(x, y, z), to], HIDES_M));
        corners(one).any(crosses)
    })
}
