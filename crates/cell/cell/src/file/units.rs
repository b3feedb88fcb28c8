//! Units of the cell file, and values with units: lengths, angles, poses, solids.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::models;
use super::schema::{POSE, UNITS, names};
use crate::Units;

type Result<T> = std::result::Result<T, Diagnostic>;

impl Units {
    /// Reads the required key `units`.
    pub(super) fn read(root: &Table<'_>) -> Result<Self> {
        const EXAMPLE: &str = "units = { length = \"mm\", angle = \"deg\" }";
        let table = root.need("units", EXAMPLE)?.table(EXAMPLE)?;
        table.only(&names(&[UNITS]))?;
        let length = table.need("length", "length = \"mm\"   (or \"m\")")?;
        let angle = table.need("angle", "angle = \"deg\"   (or \"rad\")")?;
        Ok(Self {
            length: length.word(&[("mm", LengthUnit::Millimetre), ("m", LengthUnit::Metre)])?,
            angle: angle.word(&[("deg", AngleUnit::Degree), ("rad", AngleUnit::Radian)])?,
        })
    }

    /// A joint value in the file's unit, for messages.
    pub fn show_joint(self, prismatic: bool, value: f64) -> String {
        if prismatic { self.show_length(value) } else { format!("{} {}", trim(self.angle(value)), self.angle.symbol()) }
    }

    /// A length in the file's unit, for messages.
    pub fn show_length(self, metres: f64) -> String {
        format!("{} {}", self.in_file_units(metres), self.length.symbol())
    }

    /// A length as the number in the file.
    pub fn in_file_units(self, metres: f64) -> String {
        trim(metres / self.length.to_metres(1.0))
    }

    fn angle(self, radians: f64) -> f64 {
        radians / self.angle.to_radians(1.0)
    }

    /// A joint value from the file's unit.
    pub(crate) fn joint(self, prismatic: bool, v: f64) -> f64 {
        if prismatic { self.length.to_metres(v) } else { self.angle.to_radians(v) }
    }

    pub(super) fn length_of(self, v: &Value<'_>) -> Result<f64> {
        v.number().map(|x| self.length.to_metres(x))
    }

    pub(super) fn positive_length(self, v: &Value<'_>) -> Result<f64> {
        v.positive().map(|x| self.length.to_metres(x))
    }

    pub(super) fn not_negative_length(self, v: &Value<'_>) -> Result<f64> {
        v.not_negative().map(|x| self.length.to_metres(x))
    }

    pub(super) fn point(self, v: &Value<'_>) -> Result<Vec3> {
        let p = v.three()?;
        Ok(Vec3::new(self.length.to_metres(p.x), self.length.to_metres(p.y), self.length.to_metres(p.z)))
    }

    /// Edge lengths, all above 0.
    pub(super) fn size(self, v: &Value<'_>) -> Result<Vec3> {
        let size = self.point(v)?;
        if size.min_element() > 0.0 {
            return Ok(size);
        }
        Err(v.error("must be three lengths above 0").hint("size = [600, 400, 700]"))
    }

    /// Rotation from `rpy`, or from the quaternion x, y, z, w of `quaternion`; no rotation if both are missing.
    pub(super) fn rotation(self, t: &Table<'_>) -> Result<Rotation> {
        const EXAMPLE: &str = "quaternion = [0, 0, 0, 1]   (x, y, z, w)";
        match (t.get("rpy"), t.get("quaternion")) {
            (None, None) => Ok(Rotation::IDENTITY),
            (Some(v), None) => {
                let angles = v.three()?;
                let rad = |x| self.angle.to_radians(x);
                Ok(Rotation::from_rpy(rad(angles.x), rad(angles.y), rad(angles.z)))
            }
            (None, Some(v)) => {
                let numbers = v.numbers(EXAMPLE)?;
                let four = <[f64; 4]>::try_from(&numbers[..]);
                let four =
                    four.map_err(|_| v.error(format!("needs 4 numbers, not {}", numbers.len())).hint(EXAMPLE))?;
                let length = four.iter().map(|x| x * x).sum::<f64>().sqrt();
                if (length - 1.0).abs() > QUATERNION_TOLERANCE {
                    return Err(v.error(format!("has the length {length}, and a rotation has 1")).hint(EXAMPLE));
                }
                Rotation::from_quaternion_xyzw(four).ok_or_else(|| v.error("is no rotation").hint(EXAMPLE))
            }
            (Some(_), Some(v)) => Err(v.error("contradicts `rpy`").hint("one of the two: rpy or quaternion")),
        }
    }

    /// Pose from the keys `at` and `rpy` (or `quaternion`), zero if missing.
    pub(super) fn place(self, t: &Table<'_>) -> Result<Pose> {
        let at = t.get("at").map_or(Ok(Vec3::ZERO), |v| self.point(&v))?;
        Ok(Pose::new(self.rotation(t)?, at))
    }

    /// `{ at = […], rpy = […] }`.
    pub(super) fn pose(self, v: &Value<'_>) -> Result<Pose> {
        let t = v.table("{ at = [0, 0, 0], rpy = [0, 0, 0] }")?;
        t.only(&names(&[POSE]))?;
        self.place(&t)
    }

    /// The frame and length of a solid along z, optionally given by `from` and `to`.
    fn along(self, t: &Table<'_>) -> Result<(Pose, f64)> {
        if t.get("from").is_none() && t.get("to").is_none() {
            let height =
                self.positive_length(&t.need("height", "height = 400   (or: from = [0, 0, 0], to = [0, 0, 400])")?)?;
            return Ok((self.place(t)?, height));
        }
        let from = self.point(&t.need("from", "from = [0, 0, 0]")?)?;
        let to = self.point(&t.need("to", "to = [0, 0, 400]")?)?;
        if let Some(extra) = ["at", "rpy", "quaternion", "height"].iter().find_map(|k| t.get(k)) {
            return Err(extra.error("contradicts `from` and `to`").hint("either from and to, or at, rpy and height"));
        }
        let axis = to - from;
        let rotation = axis.try_normalize().map_or(Rotation::IDENTITY, Rotation::from_z);
        Ok((Pose::new(rotation, (from + to) * 0.5), axis.length()))
    }

    /// `{ at, rpy, size }`.
    pub(super) fn cuboid(self, t: &Table<'_>) -> Result<(Shape, Pose)> {
        let size = self.size(&t.need("size", "size = [600, 400, 700]")?)?;
        Ok((Shape::Cuboid(Cuboid { half_extents: size * 0.5 }), self.place(t)?))
    }

    pub(super) fn sphere(self, t: &Table<'_>) -> Result<(Shape, Pose)> {
        let radius = self.radius(t)?;
        Ok((Shape::Sphere(Sphere { radius }), self.place(t)?))
    }

    pub(super) fn capsule(self, t: &Table<'_>) -> Result<(Shape, Pose)> {
        let radius = self.radius(t)?;
        let (pose, length) = self.along(t)?;
        Ok((Shape::Capsule(Capsule { half_length: length / 2.0, radius }), pose))
    }

    pub(super) fn cylinder(self, t: &Table<'_>) -> Result<(Shape, Pose)> {
        let radius = self.radius(t)?;
        let (pose, length) = self.along(t)?;
        if length <= 0.0 {
            return Err(t.error(format!("`{}` has no length: `from` and `to` are one point", t.name)));
        }
        Ok((Shape::Cylinder(Cylinder { half_length: length / 2.0, radius }), pose))
    }

    pub(super) fn mesh(self, t: &Table<'_>, key: &str) -> Result<(Shape, Pose)> {
        let file = t.need(key, &format!("{key} = \"part.stl\""))?;
        let unit = t.get("mesh_unit").map_or(Ok(LengthUnit::Metre), |v| models::mesh_unit(&v))?;
        Ok((models::mesh(&file, unit)?, self.place(t)?))
    }

    fn radius(self, t: &Table<'_>) -> Result<f64> {
        self.positive_length(&t.need("radius", "radius = 150")?)
    }
}

/// Tolerance for the length of a quaternion, which may differ from 1 because files contain few decimals.
pub const QUATERNION_TOLERANCE: f64 = 1e-3;

/// Up to six decimals, without trailing zeros.
fn trim(v: f64) -> String {
    let text = format!("{v:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}
