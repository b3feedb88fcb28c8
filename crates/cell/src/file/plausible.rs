//! Are these numbers in the unit that the file states? A millimetre read as a metre puts a region a thousand times too far.

use elbowroom_formats::Warning;
use elbowroom_kinematics::{ChainState, JointKind, LinkId};
use elbowroom_proximity::{Shape, Sphere, separation, within};
use elbowroom_scene::Body;
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};

use super::read::Table;
use crate::run::frames::Frames;
use crate::{Cell, CellRegion, CellRobot, Follow};

type Result<T> = std::result::Result<T, elbowroom_formats::FormatError>;

/// What is thinner than this (m) is no solid thing in a robot cell.
const THIN_M: f64 = 1e-3;
/// What is larger than this (m) is no thing in a robot cell.
const LARGE_M: f64 = 100.0;
/// Solid objects out of reach are walls and fences; farther than so many reaches away they are a mistake.
const FAR_OBJECT: f64 = 5.0;
/// What moves is looked at where it is in this time (s), at so many instants.
const LOOK_S: f64 = 120.0;
const LOOKS: usize = 240;

/// Warns of every region, object and tool that no robot can reach, that is thinner than a millimetre or larger than 100 m,
/// with the unit in which it would make sense.
pub(super) fn check(root: &Table<'_>, cell: &Cell, warnings: &mut Vec<Warning>) -> Result<()> {
    let plausible = Plausible { cell, reaches: cell.robots.iter().map(|r| Reach::of(r, true)).collect() };
    for (robot, (_, t)) in cell.robots.iter().zip(root.named("robot")?) {
        plausible.tool(&t, robot, warnings);
    }
    for (index, (_, t)) in root.named("object")?.iter().enumerate() {
        plausible.object(t, index, warnings);
    }
    for (region, (_, t)) in cell.regions.iter().zip(root.named("region")?) {
        plausible.region(&t, region, warnings);
    }
    Ok(())
}

/// A ball that holds every guarded or solid point of a robot, whatever its joint values.
#[derive(Debug, Clone, Copy)]
struct Reach {
    base: Vec3,
    radius_m: f64,
}

impl Reach {
    /// Offsets, strokes and solids, added up along the chain; with or without what the flange carries.
    fn of(robot: &CellRobot, with_tool: bool) -> Self {
        let chain = &robot.robot.chain;
        let bare = robot.bare();
        let bodies = if with_tool { &robot.robot.bodies } else { &bare.bodies };
        let along = |link: LinkId| {
            let joint = |j: &elbowroom_kinematics::JointId| {
                let joint = &chain.joints()[j.0];
                let slides = joint.kind == JointKind::Prismatic;
                let stroke = if slides { joint.limits.lower.abs().max(joint.limits.upper.abs()) } else { 0.0 };
                joint.origin.translation.length() + stroke
            };
            chain.path(link).iter().map(joint).sum::<f64>()
        };
        let radius = |b: &Body| {
            let boxed = b.shape.aabb(&b.in_link);
            boxed.min.abs().max(boxed.max.abs()).length()
        };
        let link = |(i, bodies): (usize, &Vec<Body>)| along(LinkId(i)) + bodies.iter().map(radius).fold(0.0, f64::max);
        let tcp = if with_tool { robot.tcp_in_flange.translation.length() } else { 0.0 };
        let solids = bodies.iter().enumerate().map(link).fold(0.0, f64::max);
        Self { base: robot.base_in_world.translation, radius_m: solids.max(along(robot.flange) + tcp) }
    }

    /// Distance (m) of a solid from the base.
    fn distance_m(&self, shape: &Shape, in_world: &Pose) -> f64 {
        separation(&POINT, &Pose::from_translation(self.base), shape, in_world).distance
    }

    fn meets(&self, shape: &Shape, in_world: &Pose, more_m: f64) -> bool {
        let limit = self.radius_m + more_m;
        // What is endless is within everybody's reach.
        !limit.is_finite() || within(&POINT, &Pose::from_translation(self.base), shape, in_world, limit)
    }
}

const POINT: Shape = Shape::Sphere(Sphere { radius: 0.0 });

/// What is odd about a solid.
enum Odd {
    /// Nobody reaches it: how far it is from the nearest base, and how far that robot reaches, m.
    Far { distance_m: f64, reach_m: f64 },
    /// Its smallest extent, m.
    Thin(f64),
    /// Its largest extent, m.
    Large(f64),
}

struct Plausible<'a> {
    cell: &'a Cell,
    /// Per robot.
    reaches: Vec<Reach>,
}

impl Plausible<'_> {
    fn region(&self, t: &Table<'_>, r: &CellRegion, warnings: &mut Vec<Warning>) {
        let region = &r.region;
        let odd = size(&region.shape).or_else(|| {
            let in_source = region.anchor * region.shape_in_anchor;
            let more_m = region.warning_m;
            match r.follow {
                Some(Follow::Robot { robot, .. }) => {
                    let at_frame = Reach { base: Vec3::ZERO, ..self.reaches[robot] };
                    beyond(&[at_frame], &region.shape, &[in_source], more_m)
                }
                follow => {
                    let concerned: Vec<Reach> = r.robots.iter().map(|i| self.reaches[*i]).collect();
                    beyond(&concerned, &region.shape, &self.places(follow, in_source), more_m)
                }
            }
        });
        let what = format!("region \"{}\"", region.name);
        self.warn(t, &what, odd, warnings);
    }

    fn object(&self, t: &Table<'_>, index: usize, warnings: &mut Vec<Warning>) {
        let object = &self.cell.objects[index];
        let odd = size(&object.shape).or_else(|| {
            let mover = self.cell.movers.iter().find(|m| m.object == index);
            let places: Vec<Pose> = match mover {
                Some(mover) => instants(self.cell).map(|t_s| mover.pose(t_s)).collect(),
                None => vec![object.in_world],
            };
            let far = |r: &Reach| Reach { radius_m: r.radius_m * FAR_OBJECT, ..*r };
            beyond(&self.reaches.iter().map(far).collect::<Vec<_>>(), &object.shape, &places, 0.0)?;
            beyond(&self.reaches, &object.shape, &places, 0.0)
        });
        let what = format!("object \"{}\"", object.name);
        self.warn(t, &what, odd, warnings);
    }

    /// The TCP, tool and load: seen from the flange they are no farther than the arm is long.
    fn tool(&self, t: &Table<'_>, robot: &CellRobot, warnings: &mut Vec<Warning>) {
        let arm = Reach { base: Vec3::ZERO, ..Reach::of(robot, false) };
        // A carriage of no length may carry a tool of any that fits into a cell.
        let arm = Reach { radius_m: arm.radius_m.max(1.0), ..arm };
        for (key, body) in [("tool", &robot.tool), ("load", &robot.load)] {
            let Some(body) = body else { continue };
            let odd = size(&body.shape).or_else(|| beyond(&[arm], &body.shape, &[body.in_link], 0.0));
            let what = format!("the {key} of robot \"{}\"", robot.name);
            self.warn(&at(t, key), &what, odd, warnings);
        }
        let length_m = robot.tcp_in_flange.translation.length();
        let odd = if length_m > arm.radius_m {
            Some(Odd::Far { distance_m: length_m, reach_m: arm.radius_m })
        } else if length_m > 1e-9 && length_m < THIN_M {
            Some(Odd::Thin(length_m))
        } else {
            None
        };
        self.warn(&at(t, "tool"), &format!("the tool centre point of robot \"{}\"", robot.name), odd, warnings);
    }

    /// Where a region is while its source moves.
    fn places(&self, follow: Option<Follow>, in_source: Pose) -> Vec<Pose> {
        let Some(follow) = follow else { return vec![in_source] };
        let frames = Frames::new(self.cell);
        let states: Vec<ChainState> = self.cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        instants(self.cell).map(|t_s| frames.source(&follow, &states, t_s).pose * in_source).collect()
    }

    fn warn(&self, t: &Table<'_>, what: &str, odd: Option<Odd>, warnings: &mut Vec<Warning>) {
        let Some(odd) = odd else { return };
        let units = self.cell.units;
        let show = |m: f64| units.show_length(short(m));
        let text = match odd {
            Odd::Far { distance_m, reach_m } => {
                format!("is beyond reach: {} away, where {} can be reached", show(distance_m), show(reach_m))
            }
            Odd::Thin(m) => format!("is only {} thick or long", show(m)),
            Odd::Large(m) => format!("is {} large", show(m)),
        };
        let other = if units.length == LengthUnit::Metre { LengthUnit::Millimetre } else { LengthUnit::Metre };
        let factor = other.to_metres(1.0) / units.length.to_metres(1.0);
        let (value, sensible) = match odd {
            Odd::Far { distance_m, reach_m } => (distance_m, distance_m * factor <= FAR_OBJECT * reach_m),
            Odd::Thin(m) | Odd::Large(m) => (m, (THIN_M..=LARGE_M).contains(&(m * factor))),
        };
        let (unit, angle) = (other.symbol(), units.angle.symbol());
        let warning = if sensible {
            let meant = short(value * factor);
            Warning::new(t.file, t.line, format!("{what} {text}; were its numbers in {unit}, it would be {meant} m"))
                .hint(format!(
                    "units = {{ length = \"{unit}\", angle = \"{angle}\" }}, or these numbers in {}",
                    units.length.symbol()
                ))
        } else {
            let hint = "a place within reach and a size from 1 mm to 100 m, or nothing where it is meant so";
            Warning::new(t.file, t.line, format!("{what} {text}")).hint(hint)
        };
        warnings.push(warning);
    }
}

/// The value of a key as something that has a line; the table itself where the key is not there.
fn at<'a>(t: &Table<'a>, key: &str) -> Table<'a> {
    let line = t.get(key).map_or(t.line, |v| v.line);
    t.clone().at_line(line)
}

fn instants(cell: &Cell) -> impl Iterator<Item = f64> {
    let end_s = cell.max_s.min(LOOK_S);
    (0..=LOOKS).map(move |i| end_s * i as f64 / LOOKS as f64)
}

/// Far, where the solid is beyond all of these at all of these places; never where there are none.
fn beyond(reaches: &[Reach], shape: &Shape, places: &[Pose], more_m: f64) -> Option<Odd> {
    if reaches.iter().any(|r| places.iter().any(|p| r.meets(shape, p, more_m))) {
        return None;
    }
    let place = places.first()?;
    let distances = reaches.iter().map(|r| (r.distance_m(shape, place), r.radius_m));
    let (distance_m, reach_m) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Odd::Far { distance_m, reach_m })
}

/// Thin or large; planes are neither, and a mesh may be flat.
fn size(shape: &Shape) -> Option<Odd> {
    if matches!(shape, Shape::HalfSpace(_)) {
        return None;
    }
    let extent = shape.aabb(&Pose::IDENTITY).extent();
    let least = match shape {
        Shape::Mesh(_) | Shape::Hull(_) => extent.max_element(),
        _ => extent.min_element(),
    };
    if extent.max_element() > LARGE_M {
        return Some(Odd::Large(extent.max_element()));
    }
    (least < THIN_M).then_some(Odd::Thin(least))
}

/// To four digits.
fn short(v: f64) -> f64 {
    if v == 0.0 || !v.is_finite() {
        return v;
    }
    let scale = 10_f64.powi(3 - v.abs().log10().floor() as i32);
    (v * scale).round() / scale
}
