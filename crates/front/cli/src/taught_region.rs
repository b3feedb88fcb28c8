//! A region from taught points, as text of a cell file.

use std::fmt::Write;
use std::path::Path;

use clap::ValueEnum as _;
use elbowroom::Diagnostic;
use elbowroom::cell::{Cell, Units};
use elbowroom::monitor::Region;
use elbowroom::monitor::teach::{self as taught, HeightDirection};
use elbowroom::proximity::Shape;
use elbowroom::spatial::Vec3;

use crate::output::Failure;
use crate::taught_shape::{TaughtShape, TaughtShapeArgs};

/// What the taught points determine.
pub(crate) struct TaughtRegion<'a> {
    pub(crate) name: &'a str,
    pub(crate) shape: &'a TaughtShapeArgs,
    pub(crate) units: Units,
    pub(crate) is_temporary: bool,
}

impl TaughtRegion<'_> {
    /// The region, or why the points do not determine it.
    pub(crate) fn region(&self, points: &[Vec3]) -> Result<Region, String> {
        let name = self.name;
        let result = match (self.shape.shape, points, self.height_m()) {
            (TaughtShape::Sphere, [center, surface], None) => taught::sphere_from_center(name, *center, *surface),
            (TaughtShape::Sphere4, [a, b, c, d], None) => taught::sphere_from_points(name, [*a, *b, *c, *d]),
            (TaughtShape::Cylinder, [base, rim, top], None) => taught::cylinder(name, *base, *rim, *top),
            (TaughtShape::Plane, [origin, x, xy], None) => taught::plane(name, *origin, *x, *xy),
            (TaughtShape::Box, [from, to], None) => taught::cuboid_from_corners(name, *from, *to),
            (TaughtShape::Box3, [corner, along, across], Some(height)) => {
                taught::cuboid_from_base(name, *corner, *along, *across, height)
            }
            (shape, ..) => {
                let needs = format!("{} states and {}", points_of(shape).len(), height_of(shape));
                return Err(format!("{} states; --shape {} needs {needs}", points.len(), word(shape)));
            }
        };
        result.map_err(|e| e.to_string())
    }

    /// Refuses a height that does not fit the shape, and a name or a warning zone that no cell file takes: before anybody
    /// moves a robot.
    pub(crate) fn check_arguments(&self) -> Result<(), Failure> {
        let shape = self.shape.shape;
        let fits = match self.shape.height {
            Some(height) => shape == TaughtShape::Box3 && height.is_finite() && height != 0.0,
            None => shape != TaughtShape::Box3,
        };
        if !fits {
            let what = format!("--shape {} needs {}", word(shape), height_of(shape));
            return Err(Failure::Wrong(format!(
                "{what}\n  write: --shape box3 --height 300, or another shape without --height"
            )));
        }
        let any = Region::sphere(self.name, Vec3::ZERO, 1.0);
        self.check(&self.toml(&any), Path::new("the arguments"))
    }

    /// In words, how a box of three corners and a height was built; empty for other shapes.
    pub(crate) fn built(&self, region: &Region, points: &[Vec3]) -> Result<Vec<String>, String> {
        let ([corner, along, across], Some(height)) = (points, self.height_m()) else { return Ok(Vec::new()) };
        let direction = taught::height_direction(*corner, *along, *across, height).map_err(|e| e.to_string())?;
        Ok(box_built(region, &direction, self.units))
    }

    /// The table of the cell file.
    pub(crate) fn toml(&self, region: &Region) -> String {
        let mut text = format!("[region.{}]\n{}kind = \"forbidden\"\n", key(self.name), toml(region, self.units));
        if self.shape.inside {
            text.push_str("keep = \"inside\"\n");
        }
        if self.is_temporary {
            text.push_str("life = \"temporary\"\n");
        }
        let _ = writeln!(text, "warning = {}", self.shape.warning);
        text
    }

    /// Rejects a region that the parser of the cell file would reject.
    pub(crate) fn check(&self, text: &str, from: &Path) -> Result<(), Failure> {
        let (length, angle) = (self.units.length.symbol(), self.units.angle.symbol());
        let head = format!("version = 1\nunits = {{ length = \"{length}\", angle = \"{angle}\" }}\n");
        let Err(e) = Cell::parse(from, &(head + text)) else { return Ok(()) };
        Err(Diagnostic { line: None, message: format!("the region taught: {}", e.message), ..e }.into())
    }

    fn height_m(&self) -> Option<f64> {
        self.shape.height.map(|h| self.units.length.to_metres(h))
    }
}

/// The points that determine a shape, in their order.
pub(crate) fn points_of(shape: TaughtShape) -> &'static [&'static str] {
    match shape {
        TaughtShape::Sphere => &["the centre", "a point on the surface"],
        TaughtShape::Sphere4 => &["a point on the surface"; 4],
        TaughtShape::Cylinder => {
            &["the centre of the base", "a point on the rim of the base", "a point at the height of the top"]
        }
        TaughtShape::Plane => &["the origin", "a point on x", "a point in the xy plane (the region lies below)"],
        TaughtShape::Box => &["a corner", "the opposite corner"],
        TaughtShape::Box3 => {
            &["a corner of the base", "the corner along the first edge", "the corner along the second edge"]
        }
    }
}

fn height_of(shape: TaughtShape) -> &'static str {
    if shape == TaughtShape::Box3 { "--height" } else { "no --height" }
}

/// The word of a shape on the command line.
fn word(shape: TaughtShape) -> String {
    shape.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// Describes the box built from three corners and a height, with the side that it extends to.
fn box_built(region: &Region, height: &HeightDirection, units: Units) -> Vec<String> {
    let unit = units.length.symbol();
    let number = |metres: f64| shown(metres / units.length.to_metres(1.0));
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

/// The keys of shape and place in cell-file syntax.
fn toml(region: &Region, units: Units) -> String {
    let length = |metres: f64| metres / units.length.to_metres(1.0);
    let angle = |radians: f64| radians / units.angle.to_radians(1.0);
    let mut text = String::new();
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
    text
}

/// Formats a TOML key, bare if possible.
fn key(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { name.to_owned() } else { serde_json::Value::from(name).to_string() }
}
