//! Plausibility of sizes and positions: a length in millimetres that is read in metres is a thousand times too large.

use std::ops::Range;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::Table;
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::Shape;
use elbowroom_robot::ObjectId;
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};

use super::region;
use crate::frames::Frames;
use crate::reach::Reach;
use crate::{Cell, CellRegion, CellRobot, Follow, RegionSolid};

type Result<T> = std::result::Result<T, elbowroom_formats::Diagnostic>;

/// Solid objects thinner than this (m) are implausible.
const THIN_M: f64 = 1e-3;
/// Objects larger than this (m) are implausible.
const LARGE_M: f64 = 100.0;
/// Multiple of the reach beyond which an object is implausible. A nearer object that is out of reach may be a wall or a
/// fence.
const FAR_OBJECT: f64 = 5.0;
/// Moving objects are sampled over this time (s), at this number of instants.
const SAMPLED_S: f64 = 120.0;
const SAMPLES: usize = 240;

/// Warns of every region, object and tool that no robot can reach, or that is thinner than 1 mm or larger than 100 m.
///
/// The warning contains the unit in which it would be plausible. Per planning scene (`scenes`, per table), only the
/// first implausible object is reported.
pub(super) fn check(
    root: &Table<'_>,
    cell: &Cell,
    scenes: &[Range<usize>],
    warnings: &mut Vec<Diagnostic>,
) -> Result<()> {
    let plausible = PlausibilityCheck { cell, reaches: cell.robots.iter().map(|r| Reach::of(r, true)).collect() };
    for (robot, (_, t)) in cell.robots.iter().zip(root.named("robot")?) {
        plausible.tool(&t, robot, warnings);
    }
    for (index, (_, t)) in root.named("object")?.iter().enumerate() {
        plausible.object(t, ObjectId(index), warnings);
    }
    for (objects, (_, t)) in scenes.iter().zip(root.named("scene")?) {
        let before = warnings.len();
        for index in objects.clone() {
            plausible.object(&t, ObjectId(index), warnings);
            if warnings.len() > before {
                break;
            }
        }
    }
    for (region, t) in cell.regions.iter().zip(region::tables(root)?) {
        plausible.surroundings(&t.table, region)?;
        plausible.region(&t.table, region, warnings);
    }
    Ok(())
}

/// An implausible solid.
enum Implausibility {
    /// Out of reach: its distance from the nearest base, and the reach of that robot, m.
    Far { distance_m: f64, reach_m: f64 },
    /// Its smallest extent, m.
    Thin(f64),
    /// Its largest extent, m.
    Large(f64),
}

struct PlausibilityCheck<'a> {
    cell: &'a Cell,
    /// Per robot.
    reaches: Vec<Reach>,
}

impl PlausibilityCheck<'_> {
    fn region(&self, t: &Table<'_>, r: &CellRegion, warnings: &mut Vec<Diagnostic>) {
        let region = &r.region;
        // The surroundings of a solid are as large as no cell.
        let implausibility = size(kept_in(r).unwrap_or(&region.shape)).or_else(|| {
            let in_source = region.anchor * region.shape_in_anchor;
            let more_m = region.warning_m;
            match r.follow {
                Some(Follow::Robot { robot, .. }) => {
                    let at_frame = Reach { base: Vec3::ZERO, ..self.reaches[robot.0] };
                    beyond(&[at_frame], &region.shape, &[in_source], more_m)
                }
                follow => {
                    let concerned: Vec<Reach> = r.robots.iter().map(|robot| self.reaches[robot.0]).collect();
                    beyond(&concerned, &region.shape, &self.poses(follow, in_source), more_m)
                }
            }
        });
        let what = format!("region \"{}\"", region.name);
        self.warn(t, &what, implausibility, warnings);
    }

    /// Refuses a robot that could get beyond the surroundings of the solid in which a region keeps it.
    fn surroundings(&self, t: &Table<'_>, r: &CellRegion) -> Result<()> {
        if kept_in(r).is_none() {
            return Ok(());
        }
        let bounds = r.region.shape.aabb(&(r.region.anchor * r.region.shape_in_anchor));
        for robot in &r.robots {
            let Reach { base, radius_m } = self.reaches[robot.0];
            let room = (base - bounds.min).min(bounds.max - base).min_element();
            if !(radius_m < room) {
                let name = &self.cell.robots[robot.0].name;
                let what = format!(
                    "region \"{}\" keeps robots inside of it by a wall of {}, and robot \"{name}\" may be beyond it",
                    r.region.name,
                    self.cell.units.show_length(region::SURROUNDINGS_M)
                );
                let hint = "limits for sliding joints, or `robots` without the robots that are elsewhere";
                return Err(t.error(what).hint(hint));
            }
        }
        Ok(())
    }

    fn object(&self, t: &Table<'_>, id: ObjectId, warnings: &mut Vec<Diagnostic>) {
        let object = &self.cell.objects[id.0];
        let implausibility = size(&object.shape).or_else(|| {
            let moving_object = self.cell.moving_objects.iter().find(|m| m.object == id);
            let poses: Vec<Pose> = match moving_object {
                Some(moving_object) => sample_times(self.cell).map(|t_s| moving_object.pose(t_s)).collect(),
                None => vec![object.in_world],
            };
            let far = |r: &Reach| Reach { radius_m: r.radius_m * FAR_OBJECT, ..*r };
            beyond(&self.reaches.iter().map(far).collect::<Vec<_>>(), &object.shape, &poses, 0.0)?;
            beyond(&self.reaches, &object.shape, &poses, 0.0)
        });
        let what = format!("object \"{}\"", object.name);
        self.warn(t, &what, implausibility, warnings);
    }

    /// Checks that TCP, tool and load are no farther from the flange than the arm is long.
    fn tool(&self, t: &Table<'_>, robot: &CellRobot, warnings: &mut Vec<Diagnostic>) {
        let arm = Reach { base: Vec3::ZERO, ..Reach::of(robot, false) };
        // A chain without length may carry a tool of any plausible size.
        let arm = Reach { radius_m: arm.radius_m.max(1.0), ..arm };
        for (key, collider) in [("tool", &robot.payload.tool), ("load", &robot.payload.load)] {
            let Some(collider) = collider else { continue };
            let implausibility =
                size(&collider.shape).or_else(|| beyond(&[arm], &collider.shape, &[collider.in_link], 0.0));
            let what = format!("the {key} of robot \"{}\"", robot.name);
            self.warn(&at(t, key), &what, implausibility, warnings);
        }
        let length_m = robot.tcp_in_flange.translation.length();
        let implausibility = if length_m > arm.radius_m {
            Some(Implausibility::Far { distance_m: length_m, reach_m: arm.radius_m })
        } else if length_m > 1e-9 && length_m < THIN_M {
            Some(Implausibility::Thin(length_m))
        } else {
            None
        };
        self.warn(
            &at(t, "tool"),
            &format!("the tool centre point of robot \"{}\"", robot.name),
            implausibility,
            warnings,
        );
    }

    /// Poses of a region while its source moves.
    fn poses(&self, follow: Option<Follow>, in_source: Pose) -> Vec<Pose> {
        let Some(follow) = follow else { return vec![in_source] };
        let frames = Frames::new(self.cell);
        let states: Vec<ChainState> = self.cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        sample_times(self.cell).map(|t_s| frames.source(&follow, &states, t_s).pose * in_source).collect()
    }

    fn warn(&self, t: &Table<'_>, what: &str, implausibility: Option<Implausibility>, warnings: &mut Vec<Diagnostic>) {
        let Some(implausibility) = implausibility else { return };
        let units = self.cell.units;
        let show = |m: f64| units.show_length(round_to_four_digits(m));
        let text = match implausibility {
            Implausibility::Far { distance_m, reach_m } => {
                format!("is beyond reach: {} away, where {} can be reached", show(distance_m), show(reach_m))
            }
            Implausibility::Thin(m) => format!("is only {} thick or long", show(m)),
            Implausibility::Large(m) => format!("is {} large", show(m)),
        };
        let other = if units.length == LengthUnit::Metre { LengthUnit::Millimetre } else { LengthUnit::Metre };
        let factor = other.to_metres(1.0) / units.length.to_metres(1.0);
        let (value, sensible) = match implausibility {
            Implausibility::Far { distance_m, reach_m } => (distance_m, distance_m * factor <= FAR_OBJECT * reach_m),
            Implausibility::Thin(m) | Implausibility::Large(m) => (m, (THIN_M..=LARGE_M).contains(&(m * factor))),
        };
        let (unit, angle) = (other.symbol(), units.angle.symbol());
        let warning = if sensible {
            let meant = round_to_four_digits(value * factor);
            Diagnostic::new(t.file, t.line, format!("{what} {text}; were its numbers in {unit}, it would be {meant} m"))
                .hint(format!(
                    "units = {{ length = \"{unit}\", angle = \"{angle}\" }}, or these numbers in {}",
                    units.length.symbol()
                ))
        } else {
            let hint = "a place within reach and a size from 1 mm to 100 m; no change if it is intended";
            Diagnostic::new(t.file, t.line, format!("{what} {text}")).hint(hint)
        };
        warnings.push(warning);
    }
}

/// The solid in which a region with `keep = "inside"` keeps robots.
fn kept_in(r: &CellRegion) -> Option<&Shape> {
    match &r.solid {
        RegionSolid::AllBut(shape) => Some(shape),
        RegionSolid::Shape | RegionSolid::Walls(_) => None,
    }
}

/// The table at the line of a key, or at its own line if the key is missing.
fn at<'a>(t: &Table<'a>, key: &str) -> Table<'a> {
    let line = t.get(key).map_or(t.line, |v| v.line);
    t.clone().at_line(line)
}

fn sample_times(cell: &Cell) -> impl Iterator<Item = f64> {
    let end_s = cell.timing.max_s.min(SAMPLED_S);
    (0..=SAMPLES).map(move |i| end_s * i as f64 / SAMPLES as f64)
}

/// `Far` if the solid is out of reach of all robots at all poses; never without robots.
fn beyond(reaches: &[Reach], shape: &Shape, poses: &[Pose], more_m: f64) -> Option<Implausibility> {
    if reaches.iter().any(|r| poses.iter().any(|p| r.meets(shape, p, more_m))) {
        return None;
    }
    let pose = poses.first()?;
    let distances = reaches.iter().map(|r| (r.distance_m(shape, pose), r.radius_m));
    let (distance_m, reach_m) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Implausibility::Far { distance_m, reach_m })
}

/// `Thin` or `Large`; never for planes. A mesh may be flat.
fn size(shape: &Shape) -> Option<Implausibility> {
    if matches!(shape, Shape::HalfSpace(_)) {
        return None;
    }
    let extent = shape.aabb(&Pose::IDENTITY).extent();
    let least = match shape {
        Shape::Mesh(_) | Shape::Hull(_) => extent.max_element(),
        _ => extent.min_element(),
    };
    if extent.max_element() > LARGE_M {
        return Some(Implausibility::Large(extent.max_element()));
    }
    (least < THIN_M).then_some(Implausibility::Thin(least))
}

/// Rounded to four digits.
fn round_to_four_digits(v: f64) -> f64 {
    if v == 0.0 || !v.is_finite() {
        return v;
    }
    let scale = 10_f64.powi(3 - v.abs().log10().floor() as i32);
    (v * scale).round() / scale
}
