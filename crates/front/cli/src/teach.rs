//! `elbowroom teach`: a region from taught points.

use std::fmt::Write;

use elbowroom::Diagnostic;
use elbowroom::cell::{Cell, CellRobot, QueryModel};
use elbowroom::kinematics::ChainState;
use elbowroom::monitor::Region;
use elbowroom::monitor::teach::{self as taught, HeightDirection};
use elbowroom::proximity::Shape;
use elbowroom::spatial::Vec3;

use crate::args::{TaughtShape, TeachArgs};
use crate::output::{ExitStatus, Failure, note, print};

pub(crate) fn teach(args: &TeachArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    let robot = robot(&cell, args)?;
    let points = points(&cell, robot, args)?;
    if cell.regions.iter().any(|r| r.region.name == args.name) {
        return Err(Failure::Wrong(format!("{}: there is a region `{}` already", args.cell.display(), args.name)));
    }
    let length = |metres: f64| metres / cell.units.length.to_metres(1.0);
    let angle = |radians: f64| radians / cell.units.angle.to_radians(1.0);
    let height = args.height.map(|h| cell.units.length.to_metres(h));
    let region = region(args, &points, height)?;
    let built = match (&points[..], height) {
        ([corner, along, across], Some(height)) => {
            box_built(&region, &height_direction(*corner, *along, *across, height, args)?, &cell)
        }
        _ => Vec::new(),
    };
    let comments = built.iter().map(|line| format!("# {line}\n")).collect::<Vec<_>>().concat();
    let text = format!("\n{comments}{}", toml(&region, args.warning, &length, &angle));
    accepted(&text, &cell, args)?;
    built.iter().for_each(note);
    print(&text)?;
    Ok(ExitStatus::Success)
}

fn robot<'a>(cell: &'a Cell, args: &TeachArgs) -> Result<&'a CellRobot, Failure> {
    let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
    let wrong = |what: String| {
        Failure::Wrong(format!("{}: {what}\n  write: --robot with one of {}", args.cell.display(), names.join(", ")))
    };
    match (&args.robot, cell.robots.as_slice()) {
        (Some(name), robots) => {
            robots.iter().find(|r| r.name == *name).ok_or_else(|| wrong(format!("there is no robot `{name}`")))
        }
        (None, [only]) => Ok(only),
        (None, _) => Err(wrong("has several robots".into())),
    }
}

/// Computes the position of the TCP (or of the flange) in each state.
fn points(cell: &Cell, robot: &CellRobot, args: &TeachArgs) -> Result<Vec<Vec3>, Failure> {
    let chain = &robot.robot.chain;
    let mut state = ChainState::new(chain);
    let states = crate::states::read(&args.states, &QueryModel::of_robot_in_cell(cell, robot))?;
    // A robot cannot be taught beyond its limits: such values are in another unit, or of another robot.
    if let Some(beyond) = states.warnings.first() {
        let write = "states in radians, and metres for joints that slide, as the robot has taken them";
        return Err(Failure::Wrong(format!("{beyond}\n  write: {write}")));
    }
    let point = |index: usize| {
        states.of(index).for_each(|(_, q)| state.q.copy_from_slice(q));
        chain.forward(&mut state);
        let flange_in_world = robot.base_in_world * state.link_in_root(robot.flange);
        if args.flange { flange_in_world.translation } else { (flange_in_world * robot.tcp_in_flange).translation }
    };
    Ok((0..states.len()).map(point).collect())
}

fn region(args: &TeachArgs, points: &[Vec3], height: Option<f64>) -> Result<Region, Failure> {
    let name = args.name.as_str();
    let result = match (args.shape, points, height) {
        (TaughtShape::Sphere, [center, surface], None) => taught::sphere_from_center(name, *center, *surface),
        (TaughtShape::Sphere4, [a, b, c, d], None) => taught::sphere_from_points(name, [*a, *b, *c, *d]),
        (TaughtShape::Cylinder, [base, rim, top], None) => taught::cylinder(name, *base, *rim, *top),
        (TaughtShape::Plane, [origin, x, xy], None) => taught::plane(name, *origin, *x, *xy),
        (TaughtShape::Box, [from, to], None) => taught::cuboid_from_corners(name, *from, *to),
        (TaughtShape::Box3, [corner, along, across], Some(height)) => {
            taught::cuboid_from_base(name, *corner, *along, *across, height)
        }
        (shape, ..) => {
            let needs = match shape {
                TaughtShape::Sphere4 => "4 states and no --height",
                TaughtShape::Cylinder | TaughtShape::Plane => "3 states and no --height",
                TaughtShape::Sphere | TaughtShape::Box => "2 states and no --height",
                TaughtShape::Box3 => "3 states and --height",
            };
            let message = format!("{}: {} states; {shape:?} needs {needs}", args.states.display(), points.len());
            return Err(Failure::Wrong(message));
        }
    };
    result.map_err(|e| Failure::Wrong(format!("{}: {e}", args.states.display())))
}

fn height_direction(
    corner: Vec3,
    along: Vec3,
    across: Vec3,
    height: f64,
    args: &TeachArgs,
) -> Result<HeightDirection, Failure> {
    let found = taught::height_direction(corner, along, across, height);
    found.map_err(|e| Failure::Wrong(format!("{}: {e}", args.states.display())))
}

/// Describes the box built from three corners and a height, with the side that it extends to.
fn box_built(region: &Region, height: &HeightDirection, cell: &Cell) -> Vec<String> {
    let unit = cell.units.length.symbol();
    let number = |metres: f64| shown(metres / cell.units.length.to_metres(1.0));
    let list = |v: Vec3| format!("[{}]", v.to_array().map(number).join(", "));
    let box_in_world = region.anchor * region.shape_in_anchor;
    let size = match &region.shape {
        Shape::Cuboid(c) => c.half_extents * 2.0,
        _ => Vec3::ZERO,
    };
    let direction = height.direction;
    let lean = direction.z.abs().min(1.0).acos().to_degrees();
    let vector = format!("[{}]", direction.to_array().map(shown).join(", "));
    let tilted = if lean < 0.05 { String::new() } else { format!(", {lean:.1} deg from the vertical") };
    let goes = match (height.upright_base, direction.z > 0.0) {
        (true, _) => format!("to the side, towards {vector} in the world"),
        (false, true) => format!("upwards (against gravity{tilted})"),
        (false, false) => format!("downwards (with gravity{tilted})"),
    };
    let all = region.shape.aabb(&box_in_world);
    let mut lines = vec![
        format!("built {goes}, {} {unit} high on the taught corners", number(size.z)),
        format!(
            "centre {} {unit}, size {} {unit} (first edge, second edge, height), z from {} to {} {unit}",
            list(box_in_world.translation),
            list(size),
            number(all.min.z),
            number(all.max.z)
        ),
    ];
    if height.upright_base {
        lines.push(
            "the taught base stands upright and has no upper side: the side is that of first edge x second edge; for the \
             other one, --height with the other sign"
                .to_owned(),
        );
    }
    lines
}

/// Formats a number with at most four digits after the decimal point.
fn shown(v: f64) -> String {
    format!("{}", (v * 1e4).round() / 1e4 + 0.0)
}

/// Rejects a region that the parser of the cell file would reject.
fn accepted(text: &str, cell: &Cell, args: &TeachArgs) -> Result<(), Failure> {
    let (length, angle) = (cell.units.length.symbol(), cell.units.angle.symbol());
    let head = format!("version = 1\nunits = {{ length = \"{length}\", angle = \"{angle}\" }}\n");
    let Err(e) = Cell::parse(&args.states, &(head + text)) else { return Ok(()) };
    Err(Diagnostic { line: None, message: format!("the region taught: {}", e.message), ..e }.into())
}

/// Formats the region in cell-file syntax.
fn toml(region: &Region, warning: f64, length: &dyn Fn(f64) -> f64, angle: &dyn Fn(f64) -> f64) -> String {
    let mut text = format!("[region.{}]\n", key(&region.name));
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    // Rounded to 0.1 µm and to seven digits of an angle.
    let rounded = |v: f64, per_unit: f64| format!("{}", (v * per_unit).round() / per_unit + 0.0);
    let number = |metres: f64| rounded(length(metres), (1e7 / length(1.0)).round());
    let point = |p: Vec3| format!("[{}]", p.to_array().map(number).join(", "));
    let rpy = |r: [f64; 3]| format!("[{}]", r.map(|v| rounded(angle(v), 1e7)).join(", "));
    let at = region.anchor.translation;
    let rotation = region.anchor.rotation;
    match &region.shape {
        Shape::Sphere(s) => {
            line("shape", "\"sphere\"".into());
            line("centre", point(at));
            line("radius", number(s.radius));
        }
        Shape::Cylinder(c) => {
            line("shape", "\"cylinder\"".into());
            line("base", point(at));
            line("radius", number(c.radius));
            line("height", number(2.0 * c.half_length));
        }
        Shape::Cuboid(c) => {
            line("shape", "\"box\"".into());
            line("base", point(at));
            line("size", point(c.half_extents * 2.0));
            if rotation.angle() > 0.0 {
                line("rpy", rpy(rotation.to_rpy()));
            }
        }
        _ => {
            line("shape", "\"plane\"".into());
            line("origin", point(at));
            line("x", point(at + rotation.x_axis()));
            line("y", point(at + rotation.y_axis()));
        }
    }
    line("kind", "\"forbidden\"".into());
    line("warning", warning.to_string());
    text
}

/// Formats a TOML key, bare if possible.
fn key(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { name.to_owned() } else { format!("{name:?}") }
}
