//! The numbers of a cell file, in metres and radians.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;
use toml::{Table, Value};

use super::compare::{Off, ROUNDING};
use crate::fuzz_cells::oracle::frame::Frame;

/// Extent of the mesh of a corner along each axis, in its unit.
const CORNER: f64 = 0.3;

/// The text of a cell file, with its units.
pub struct Written {
    file: Table,
    /// Size of the unit of lengths, m.
    length: f64,
    /// Size of the unit of angles, rad.
    angle: f64,
}

impl Written {
    pub fn new(file: Table) -> Option<Self> {
        let units = file.get("units")?.as_table()?;
        let length = if units.get("length")?.as_str()? == "mm" { 1e-3 } else { 1.0 };
        let angle = if units.get("angle")?.as_str()? == "deg" { std::f64::consts::PI / 180.0 } else { 1.0 };
        Some(Self { file, length, angle })
    }

    /// The tables `[WORD.NAME]`, with their names.
    pub fn tables<'s>(&'s self, word: &str) -> impl Iterator<Item = (&'s String, &'s Table)> {
        let all = self.file.get(word).and_then(Value::as_table).into_iter().flatten();
        all.filter_map(|(name, value)| Some((name, value.as_table()?)))
    }

    /// A length of the text, m.
    pub fn metres(&self, length: f64) -> f64 {
        length * self.length
    }

    /// A length; 0 without its key.
    pub fn length(&self, t: &Table, key: &str) -> f64 {
        t.get(key).and_then(number).unwrap_or(0.0) * self.length
    }

    /// An angle; 0 without its key.
    pub fn angle(&self, t: &Table, key: &str) -> f64 {
        t.get(key).and_then(number).unwrap_or(0.0) * self.angle
    }

    /// A joint value, or a speed of a joint.
    pub fn joint(&self, slides: bool, value: f64) -> f64 {
        value * if slides { self.length } else { self.angle }
    }

    /// A point; zero without its key.
    pub fn point(&self, t: &Table, key: &str) -> Vec3 {
        three(t, key).map_or(Vec3::ZERO, |[x, y, z]| Vec3::new(x, y, z) * self.length)
    }

    pub fn pose(&self, t: &Table) -> Frame {
        Frame::shift(self.point(t, "at")).then(&self.turn(t))
    }

    /// The turn of a table: `rpy`, `quaternion`, or none.
    pub fn turn(&self, t: &Table) -> Frame {
        let quaternion: Option<[f64; 4]> = t.get("quaternion").and_then(numbers).and_then(|list| list.try_into().ok());
        if let Some([x, y, z, w]) = quaternion {
            let axis: Vec3 = Vec3::new(x, y, z);
            let angle = 2.0 * axis.length().atan2(w);
            return axis.try_normalize().map_or(Frame::IDENTITY, |unit| Frame::turn(unit, angle));
        }
        let [roll, pitch, yaw] = three(t, "rpy").unwrap_or_default().map(|angle| angle * self.angle);
        Frame::turn(Vec3::Z, yaw).then(&Frame::turn(Vec3::Y, pitch)).then(&Frame::turn(Vec3::X, roll))
    }

    /// Compares the size of a solid with that of the text; a region that keeps robots inside is another solid.
    pub fn compare_size(&self, what: &str, word: &str, t: &Table, read: &Shape, off: &mut Off) {
        let length = |key: &str| self.length(t, key);
        let bar = || {
            let ends = self.point(t, "from").distance(self.point(t, "to"));
            vec![length("radius"), if t.contains_key("from") { ends } else { length("height").max(length("length")) }]
        };
        let (written, read) = match (word, read) {
            ("box", Shape::Cuboid(c)) if t.contains_key("size") => {
                (self.point(t, "size").to_array().to_vec(), (c.half_extents * 2.0).to_array().to_vec())
            }
            ("box", Shape::Cuboid(c)) => (
                (self.point(t, "to") - self.point(t, "from")).abs().to_array().to_vec(),
                (c.half_extents * 2.0).to_array().to_vec(),
            ),
            ("sphere", Shape::Sphere(s)) => (vec![length("radius")], vec![s.radius]),
            ("cylinder", Shape::Cylinder(c)) => (bar(), vec![c.radius, c.half_length * 2.0]),
            ("capsule", Shape::Capsule(c)) => (bar(), vec![c.radius, c.half_length * 2.0]),
            ("mesh", Shape::Mesh(mesh)) if is_corner(t) => {
                let unit = t.get("mesh_unit").and_then(Value::as_str).unwrap_or("m");
                let unit_m = [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254)].iter().find(|(name, _)| *name == unit);
                let most = mesh.vertices().iter().fold(Vec3::ZERO, |most, v| most.max(*v));
                (vec![CORNER * unit_m.map_or(1.0, |u| u.1); 3], most.to_array().to_vec())
            }
            _ => return,
        };
        let by = written.iter().zip(&read).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if !(by <= ROUNDING) {
            off.push((format!("{what}: {word}"), by));
        }
    }
}

/// Whether the mesh of a table is that of the corner, and not turned inside out.
fn is_corner(t: &Table) -> bool {
    let is_named = |key: &str| t.get(key).and_then(Value::as_str) == Some("corner.obj");
    (is_named("mesh") || is_named("file")) && !t.contains_key("keep")
}

pub fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

pub fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(number).collect()
}

fn three(t: &Table, key: &str) -> Option<[f64; 3]> {
    numbers(t.get(key)?)?.try_into().ok()
}

/// Whether a table states a turn.
pub fn is_turned(t: &Table) -> bool {
    t.contains_key("rpy") || t.contains_key("quaternion")
}
