//! The keys of a region in the syntax of a cell file.

use std::fmt::Write as _;

use elbowroom::cell::Units;
use elbowroom::monitor::Region;
use elbowroom::proximity::Shape;
use elbowroom::spatial::Vec3;

/// Formats a number with at most four digits after the decimal point.
pub(crate) fn shown(v: f64) -> String {
    format!("{}", (v * 1e4).round() / 1e4 + 0.0)
}

/// The keys of shape and place in cell-file syntax.
pub(crate) fn keys(region: &Region, units: Units) -> String {
    let angle = |radians: f64| radians / units.angle.to_radians(1.0);
    let mut text = String::new();
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    let number = |metres: f64| length_text(metres, units);
    let point = |p: Vec3| format!("[{}]", p.to_array().map(number).join(", "));
    // Seven digits of an angle.
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
        Shape::Capsule(c) => {
            line("shape", "\"capsule\"".into());
            line("at", point(at));
            line("radius", number(c.radius));
            line("height", number(2.0 * c.half_length));
            line("rpy", rpy(rotation.to_rpy()));
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

/// Formats a length in a unit of the cell file, rounded to 0.1 µm.
pub(crate) fn length_text(metres: f64, units: Units) -> String {
    let length = |metres: f64| metres / units.length.to_metres(1.0);
    rounded(length(metres), (1e7 / length(1.0)).round())
}

fn rounded(v: f64, per_unit: f64) -> String {
    format!("{}", (v * per_unit).round() / per_unit + 0.0)
}

/// Formats a TOML key, bare if possible.
pub(crate) fn table_key(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { name.to_owned() } else { serde_json::Value::from(name).to_string() }
}
