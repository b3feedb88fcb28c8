//! A region from taught points, as text of a cell file.

use std::fmt::Write as _;
use std::path::Path;

use clap::ValueEnum as _;
use elbowroom::Diagnostic;
use elbowroom::cell::{Cell, Units};
use elbowroom::monitor::Region;
use elbowroom::monitor::teach::{self as taught, HeightDirection};
use elbowroom::proximity::Shape;
use elbowroom::spatial::Vec3;

use crate::output::Failure;
use crate::region_keys::{keys, shown, table_key};
use crate::taught_fence::{FEWEST_CORNERS, TaughtFence};
use crate::taught_shape::{TaughtShape, TaughtShapeArgs};

/// What the taught points determine.
pub(crate) struct TaughtRegion<'a> {
    pub(crate) name: &'a str,
    pub(crate) shape: &'a TaughtShapeArgs,
    pub(crate) units: Units,
    pub(crate) is_temporary: bool,
}

/// The solid that the points determine.
#[derive(Debug, Clone)]
pub(crate) enum TaughtSolid {
    /// One shape.
    Shape(Box<Region>),
    /// The walls of a fence.
    Fence(TaughtFence),
}

impl TaughtRegion<'_> {
    /// The region, or why the points do not determine it.
    pub(crate) fn solid(&self, points: &[Vec3]) -> Result<TaughtSolid, String> {
        match (self.shape.shape, self.height_m()) {
            (TaughtShape::Fence, Some(height_m)) if points.len() >= FEWEST_CORNERS => {
                let fence = TaughtSolid::Fence(TaughtFence::new(points, height_m));
                let problem = self.problem(&self.toml(&fence), Path::new(""));
                problem.map_or(Ok(fence), |e| Err(told(&e)))
            }
            _ => self.region(points).map(|region| TaughtSolid::Shape(Box::new(region))),
        }
    }

    fn region(&self, points: &[Vec3]) -> Result<Region, String> {
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
                let needs = format!("{} states and {}", count_of(shape), height_of(shape));
                return Err(format!("{} states; --shape {} needs {needs}", points.len(), word(shape)));
            }
        };
        result.map_err(|e| e.to_string())
    }

    /// Refuses a height that does not fit the shape, and a name or a warning zone that no cell file takes: before anybody
    /// moves a robot.
    pub(crate) fn check_arguments(&self) -> Result<(), Failure> {
        let shape = self.shape.shape;
        let fits = match (shape, self.shape.height) {
            (TaughtShape::Box3, Some(height)) => height.is_finite() && height != 0.0,
            (TaughtShape::Fence, Some(height)) => height.is_finite() && height > 0.0,
            (TaughtShape::Box3 | TaughtShape::Fence, None) | (_, Some(_)) => false,
            (_, None) => true,
        };
        if !fits {
            let what = format!("--shape {} needs {}", word(shape), height_of(shape));
            let help = "--shape box3 --height 300, --shape fence --height 2000, or another shape without --height";
            return Err(Failure::Wrong(format!("{what}\n  write: {help}")));
        }
        if shape == TaughtShape::Fence && self.shape.inside {
            let what = "--shape fence has no --inside: what is within a fence is free";
            return Err(Failure::Wrong(format!("{what}\n  write: --shape fence without --inside")));
        }
        let any = Box::new(Region::sphere(self.name, Vec3::ZERO, 1.0));
        self.check(&self.toml(&TaughtSolid::Shape(any)), Path::new("the arguments"))
    }

    /// In words, how a fence, or a box of three corners and a height, was built; empty for other shapes.
    pub(crate) fn built(&self, solid: &TaughtSolid, points: &[Vec3]) -> Result<Vec<String>, String> {
        let region = match solid {
            TaughtSolid::Fence(fence) => return Ok(fence.built(self.units)),
            TaughtSolid::Shape(region) => region,
        };
        let ([corner, along, across], Some(height)) = (points, self.height_m()) else { return Ok(Vec::new()) };
        let direction = taught::height_direction(*corner, *along, *across, height).map_err(|e| e.to_string())?;
        Ok(box_built(region, &direction, self.units))
    }

    /// The table of the cell file.
    pub(crate) fn toml(&self, solid: &TaughtSolid) -> String {
        let mut text = self.table(solid);
        text.push_str("kind = \"forbidden\"\n");
        if self.shape.inside {
            text.push_str("keep = \"inside\"\n");
        }
        if self.is_temporary {
            text.push_str("life = \"temporary\"\n");
        }
        let _ = writeln!(text, "warning = {}", self.shape.warning);
        text
    }

    /// The table with the keys of shape and place only.
    pub(crate) fn table(&self, solid: &TaughtSolid) -> String {
        match solid {
            TaughtSolid::Shape(region) => format!("[region.{}]\n{}", table_key(self.name), keys(region, self.units)),
            TaughtSolid::Fence(fence) => self.fence_table(&fence.keys(self.units)),
        }
    }

    /// The table of a fence with these keys.
    pub(crate) fn fence_table(&self, keys: &str) -> String {
        format!("[fence.{}]\n{keys}", table_key(self.name))
    }

    /// Rejects a region that the parser of the cell file would reject.
    pub(crate) fn check(&self, text: &str, from: &Path) -> Result<(), Failure> {
        let Some(e) = self.problem(text, from) else { return Ok(()) };
        Err(Diagnostic { line: None, message: format!("the region taught: {}", e.message), ..e }.into())
    }

    /// The error of the parser of the cell file for this table.
    pub(crate) fn problem(&self, text: &str, from: &Path) -> Option<Diagnostic> {
        let (length, angle) = (self.units.length.symbol(), self.units.angle.symbol());
        let head = format!("version = 1\nunits = {{ length = \"{length}\", angle = \"{angle}\" }}\n");
        Cell::parse(from, &(head + text)).err()
    }

    /// The height that the arguments state, m.
    pub(crate) fn height_m(&self) -> Option<f64> {
        self.shape.height.map(|h| self.units.length.to_metres(h))
    }
}

/// An error without its file and line, which whoever teaches does not have.
fn told(e: &Diagnostic) -> String {
    let hint = e.hint.as_ref().map(|hint| format!("\n  write: {hint}")).unwrap_or_default();
    format!("the region taught: {}{hint}", e.message)
}

/// The points that determine a shape, in their order; of a fence the corner that is repeated.
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
        TaughtShape::Fence => &["the next corner of the fence on the floor"],
    }
}

/// How many points a shape needs, in words.
fn count_of(shape: TaughtShape) -> String {
    match shape {
        TaughtShape::Fence => format!("{FEWEST_CORNERS} or more"),
        _ => points_of(shape).len().to_string(),
    }
}

fn height_of(shape: TaughtShape) -> &'static str {
    match shape {
        TaughtShape::Box3 => "--height",
        TaughtShape::Fence => "--height above 0",
        _ => "no --height",
    }
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
