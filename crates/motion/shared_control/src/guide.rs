//! Guides: the hand moves the tool along a line, in a plane, in a cone or in a tube, or through a point of entry.

use elbowroom_spatial::{Pose, Vec3};

use crate::{NavigatorError, RemoteCenter};

/// Share of the tolerance by which the line may leave a straight motion. A tool that always moves towards a point ahead on a
/// circle goes on an inner circle, four times as far away as that.
const STRAIGHT: f64 = 0.25;
/// Length of the line on both sides of the tool, in tolerances, where the hand is looked for first: it may have passed a
/// sharp corner already.
const SEARCHED: f64 = 20.0;
/// Most corners that a step looks ahead.
const LOOK_AHEAD: usize = 64;
/// Halvings in the search for the farthest point in a straight line.
const HALVINGS: usize = 30;

/// A set of places in which a desired point is kept, or of poses with the shaft of the tool at a point of entry.
///
/// A line or tube may bend. Its nearest point is looked for along it, from the tool on, not on another branch that passes
/// near by; and it is never farther ahead than a straight motion of the tool stays within the tolerance, so the tool
/// slows down at corners instead of cutting them.
///
/// A guide never overrules a surface: the tool glides along what is in its way.
///
/// ```
/// use elbowroom_shared_control::Guide;
/// use elbowroom_spatial::{Pose, Vec3};
/// let mut seam = Guide::path(vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y], 0.0, 0.0005)?;
/// let tool = Pose::from_translation(Vec3::new(0.4, 0.0, 0.0));
/// let mut toward = |hand: Vec3| seam.toward(&tool, &Pose::from_translation(hand)).translation;
/// assert_eq!(toward(Vec3::new(0.6, 0.2, 0.1)), Vec3::new(0.6, 0.0, 0.0));
/// // Round the corner only once the tool is there.
/// assert!(toward(Vec3::new(1.2, 0.8, 0.0)).distance(Vec3::X) < 0.001);
/// # Ok::<(), elbowroom_shared_control::NavigatorError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    shape: GuideShape,
    /// Distance of the tool from a curved line, metres; at sharp corners up to twice as much.
    tolerance_m: f64,
    /// Segment of the line at which the tool is, and the place on it, 0 to 1.
    tool: (usize, f64),
}

#[derive(Debug, Clone, PartialEq)]
enum GuideShape {
    /// The line through these points, and everything within `radius_m` of it.
    Path { points: Vec<Vec3>, radius_m: f64 },
    /// A plane through `at`.
    Plane { at: Vec3, normal: Vec3 },
    /// Everything within an angle of a half-line from `apex` along `axis`.
    Cone { apex: Vec3, axis: Vec3, half_angle: (f64, f64) },
    /// All poses with the shaft at a point.
    Entry(RemoteCenter),
}

impl Guide {
    /// The line through these points (world, metres), or the tube of this radius around it; 0 is a line.
    ///
    /// # Errors
    /// Fewer than two points, two successive equal ones, a negative radius, or a tolerance that is not positive.
    pub fn path(points: Vec<Vec3>, radius_m: f64, tolerance_m: f64) -> Result<Self, NavigatorError> {
        let are_apart = points.windows(2).all(|w| (w[1] - w[0]).try_normalize().is_some());
        if points.len() < 2 || !are_apart {
            return Err(NavigatorError::GuideLine);
        }
        NavigatorError::check_not_negative(&[("the radius of a guide", radius_m)])?;
        NavigatorError::check_positive(&[("the tolerance of a guide", tolerance_m)])?;
        Ok(Self { shape: GuideShape::Path { points, radius_m }, tolerance_m, tool: (0, f64::NAN) })
    }

    /// The plane through a point (world, metres).
    ///
    /// # Errors
    /// A normal without length, or a point that is not finite.
    pub fn plane(at: Vec3, normal: Vec3) -> Result<Self, NavigatorError> {
        let normal = direction(at, normal)?;
        Ok(Self { shape: GuideShape::Plane { at, normal }, tolerance_m: 0.0, tool: (0, 0.0) })
    }

    /// The inside of a cone with this half angle (rad) around an axis from its apex (world, metres).
    ///
    /// # Errors
    /// An axis without length, a point that is not finite, or an angle outside 0 to 90°.
    pub fn cone(apex: Vec3, axis: Vec3, half_angle_rad: f64) -> Result<Self, NavigatorError> {
        let axis = direction(apex, axis)?;
        if !(0.0..std::f64::consts::FRAC_PI_2).contains(&half_angle_rad) {
            let (name, wanted) = ("the half angle of a guide", "0 to 90°, in rad");
            return Err(NavigatorError::Setting { name, value: half_angle_rad, wanted });
        }
        let shape = GuideShape::Cone { apex, axis, half_angle: half_angle_rad.sin_cos() };
        Ok(Self { shape, tolerance_m: 0.0, tool: (0, 0.0) })
    }

    /// A fixed point of entry (world, metres): the shaft, which has this direction in the frame of the tool point, always
    /// passes within `radius_m` of it. Its length beyond the point stays within `depth_m` (least and most, metres; may be
    /// infinite) once it is there; before, the tool may be withdrawn, but not moved deeper than the most.
    ///
    /// The tool must be turned as well: [`SurfaceNavigator::set_remote_center`] does that in every step, and
    /// [`GuidedArm::set_guide`] calls it.
    ///
    /// [`SurfaceNavigator::set_remote_center`]: crate::SurfaceNavigator::set_remote_center
    /// [`GuidedArm::set_guide`]: crate::GuidedArm::set_guide
    ///
    /// # Errors
    /// An axis without length, a point that is not finite, a negative radius, or an empty range of depths.
    pub fn entry(at: Vec3, axis_in_tool: Vec3, radius_m: f64, depth_m: (f64, f64)) -> Result<Self, NavigatorError> {
        let center = RemoteCenter::new(at, axis_in_tool, radius_m, depth_m)?;
        Ok(Self { shape: GuideShape::Entry(center), tolerance_m: 0.0, tool: (0, 0.0) })
    }

    /// The point of entry, if the guide is one.
    pub fn remote_center(&self) -> Option<&RemoteCenter> {
        if let GuideShape::Entry(center) = &self.shape { Some(center) } else { None }
    }

    /// The pose to which a tool moves while the hand is at `desired` (poses of the tool point, in the world). Only a point of
    /// entry changes the orientation.
    pub fn toward(&mut self, tool: &Pose, desired: &Pose) -> Pose {
        if let GuideShape::Entry(center) = &self.shape {
            return center.toward(tool, desired);
        }
        Pose::new(desired.rotation, self.place_toward(tool.translation, desired.translation))
    }

    fn place_toward(&mut self, tool: Vec3, desired: Vec3) -> Vec3 {
        match &self.shape {
            GuideShape::Entry(_) => desired,
            GuideShape::Plane { at, normal } => desired - *normal * normal.dot(desired - *at),
            GuideShape::Cone { apex, axis, half_angle } => nearest_in_cone(*apex, *axis, *half_angle, desired),
            GuideShape::Path { points, radius_m } => {
                let reach_m = SEARCHED * self.tolerance_m;
                self.tool = match self.tool {
                    (_, share) if share.is_nan() => nearest_of_all(points, tool),
                    last => descend(points, nearest_around(points, last, reach_m, tool), tool),
                };
                let wanted = descend(points, nearest_around(points, self.tool, reach_m, desired), desired);
                let ahead = within_tolerance(points, self.tool, wanted, STRAIGHT * self.tolerance_m);
                let axis = on_path(points, ahead);
                let aside = desired - axis;
                axis + aside * (radius_m / aside.length()).min(1.0)
            }
        }
    }

    /// Distance of a tool point from the guide, metres; 0 inside. Of a line or tube, its nearest part counts; of a point of
    /// entry, the distance at which the shaft passes.
    pub fn distance_m(&self, tool: &Pose) -> f64 {
        let point = tool.translation;
        match &self.shape {
            GuideShape::Entry(center) => (center.offset_m(tool) - center.radius_m()).max(0.0),
            GuideShape::Plane { at, normal } => normal.dot(point - *at).abs(),
            GuideShape::Cone { apex, axis, half_angle } => {
                nearest_in_cone(*apex, *axis, *half_angle, point).distance(point)
            }
            GuideShape::Path { points, radius_m } => {
                (on_path(points, nearest_of_all(points, point)).distance(point) - radius_m).max(0.0)
            }
        }
    }
}

fn direction(at: Vec3, direction: Vec3) -> Result<Vec3, NavigatorError> {
    let usable = direction.try_normalize().filter(|_| at.is_finite());
    usable.ok_or(NavigatorError::GuideDirection)
}

fn nearest_in_cone(apex: Vec3, axis: Vec3, (sin, cos): (f64, f64), point: Vec3) -> Vec3 {
    let out = point - apex;
    let along = axis.dot(out);
    let radial = out - axis * along;
    if radial.length() * cos <= along * sin {
        return point;
    }
    // On the line of the cone that is nearest to the point.
    let generatrix = radial.try_normalize().map_or(axis, |aside| axis * cos + aside * sin);
    apex + generatrix * generatrix.dot(out).max(0.0)
}

/// A place on a line: a segment, and the share of it.
type Place = (usize, f64);

fn on_path(points: &[Vec3], (segment, share): Place) -> Vec3 {
    points[segment] + (points[segment + 1] - points[segment]) * share
}

fn on_segment(points: &[Vec3], segment: usize, p: Vec3) -> Place {
    let (from, way) = (points[segment], points[segment + 1] - points[segment]);
    (segment, (way.dot(p - from) / way.length_squared()).clamp(0.0, 1.0))
}

fn nearest_of_all(points: &[Vec3], p: Vec3) -> Place {
    let places = (0..points.len() - 1).map(|k| on_segment(points, k, p));
    places
        .min_by(|a, b| on_path(points, *a).distance(p).total_cmp(&on_path(points, *b).distance(p)))
        .unwrap_or((0, 0.0))
}

/// The place nearest to `p` of those at most `reach_m` along the line from a place.
fn nearest_around(points: &[Vec3], from: Place, reach_m: f64, p: Vec3) -> Place {
    let mut best = from;
    let length = |k: usize| points[k + 1].distance(points[k]);
    let mut consider = |segment: usize, least: f64, most: f64| {
        let place = (segment, on_segment(points, segment, p).1.clamp(least, most));
        if on_path(points, place).distance(p) < on_path(points, best).distance(p) {
            best = place;
        }
    };
    let mut left_m = reach_m;
    for segment in from.0..points.len() - 1 {
        let least = if segment == from.0 { from.1 } else { 0.0 };
        let most = (least + left_m / length(segment)).min(1.0);
        consider(segment, least, most);
        left_m -= (most - least) * length(segment);
        if most < 1.0 {
            break;
        }
    }
    left_m = reach_m;
    for segment in (0..=from.0).rev() {
        let most = if segment == from.0 { from.1 } else { 1.0 };
        let least = (most - left_m / length(segment)).max(0.0);
        consider(segment, least, most);
        left_m -= (most - least) * length(segment);
        if least > 0.0 {
            break;
        }
    }
    best
}

/// The local minimum of the distance to `p` that is reached from a place by going along the line.
fn descend(points: &[Vec3], from: Place, p: Vec3) -> Place {
    let mut at = on_segment(points, from.0, p);
    loop {
        let next = match at {
            (k, 1.0) if k + 2 < points.len() => on_segment(points, k + 1, p),
            (k, 0.0) if k > 0 => on_segment(points, k - 1, p),
            _ => return at,
        };
        if !(on_path(points, next).distance(p) < on_path(points, at).distance(p)) {
            return at;
        }
        at = next;
    }
}

/// The place farthest towards `to` up to which a straight motion stays within a tolerance of the line.
fn within_tolerance(points: &[Vec3], from: Place, to: Place, tolerance_m: f64) -> Place {
    let is_forward = to > from;
    // The corners between the two places, from the first one on.
    let corner = |k: usize| if is_forward { from.0 + 1 + k } else { from.0 - k };
    let corners = from.0.abs_diff(to.0).min(LOOK_AHEAD);
    let start = on_path(points, from);
    let is_straight = |passed: usize, end: Vec3| {
        (0..passed).all(|k| distance_from_segment(points[corner(k)], start, end) <= tolerance_m)
    };
    let mut passed = 0;
    while passed < corners {
        // To the end of the segment that follows the next corner, or to the wanted place on it.
        let end = if passed + 1 == from.0.abs_diff(to.0) { to } else { end_of_segment(corner(passed), is_forward) };
        if is_straight(passed + 1, on_path(points, end)) {
            passed += 1;
            if passed == corners {
                return end;
            }
            continue;
        }
        let begin = begin_of_segment(end.0, is_forward);
        let (mut free, mut bent) = (begin.1, end.1);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (free + bent);
            if is_straight(passed + 1, on_path(points, (end.0, middle))) { free = middle } else { bent = middle }
        }
        return (end.0, free);
    }
    to
}

/// The far end of the segment behind a corner.
fn end_of_segment(corner: usize, is_forward: bool) -> Place {
    if is_forward { (corner, 1.0) } else { (corner - 1, 0.0) }
}

fn begin_of_segment(segment: usize, is_forward: bool) -> Place {
    (segment, if is_forward { 0.0 } else { 1.0 })
}

fn distance_from_segment(p: Vec3, from: Vec3, to: Vec3) -> f64 {
    let way = to - from;
    let share =
        if way.length_squared() > 0.0 { (way.dot(p - from) / way.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
    (from + way * share).distance(p)
}
