//! Shields around boxes, with openings of all kinds, or from files.

use std::fmt::Write as _;

use elbowroom_spatial::{Rotation, Vec3};

use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellFile, ObjectSpec, list};

/// The faces of a box by its corners, of which the lowest bits are x, then y, then z; counted from 1.
const FACES: &str =
    "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";

/// A side of a box.
pub struct Side<'o> {
    object: &'o ObjectSpec,
    rotation: Rotation,
    centre: Vec3,
    half: Vec3,
    /// Index of the axis through the side, and its sense.
    axis: usize,
    sign: f64,
}

impl<'o> Side<'o> {
    /// A random side of an object that is a box.
    pub fn any(object: &'o ObjectSpec, random: &mut Random) -> Option<Self> {
        let size: Vec<f64> =
            object.shape.split(['[', ']']).nth(1)?.split(',').filter_map(|v| v.trim().parse().ok()).collect();
        let [x, y, z] = size[..] else { return None };
        let [roll, pitch, yaw] = object.rpy;
        Some(Self {
            object,
            rotation: Rotation::from_rpy(roll, pitch, yaw),
            centre: Vec3::new(object.at[0], object.at[1], object.at[2]),
            half: Vec3::new(x, y, z) * 0.5,
            axis: random.whole(0, 2),
            sign: random.one(&[-1.0, 1.0]),
        })
    }

    /// The point of the side at these shares of its half sides.
    fn point(&self, u: f64, v: f64) -> String {
        let mut p = [0.0; 3];
        p[self.axis] = self.sign * self.half[self.axis];
        p[(self.axis + 1) % 3] = u * self.half[(self.axis + 1) % 3];
        p[(self.axis + 2) % 3] = v * self.half[(self.axis + 2) % 3];
        list(&(self.centre + self.rotation * Vec3::new(p[0], p[1], p[2])).to_array())
    }

    /// The smaller one of the half sides, m.
    fn narrow_m(&self) -> f64 {
        self.half[(self.axis + 1) % 3].min(self.half[(self.axis + 2) % 3])
    }

    /// Makes the table `[fixture.shield]`, and the file that it names.
    pub fn shield(&self, random: &mut Random) -> (String, Option<CellFile>) {
        let head = format!("[fixture.shield]\nprotects = \"{}\"\ntool = \"r0\"\n", self.object.name);
        let mut target = match random.in_turn(5) {
            0 => format!("drill = {{ {} }}", self.drill(random)),
            1 => {
                let points: Vec<String> = (0..random.whole(2, 4)).map(|_| self.anywhere(random)).collect();
                format!("line = [{}]", points.join(", "))
            }
            2 => {
                let [low, high] = [random.between(-0.4, -0.1), random.between(0.1, 0.4)];
                let corners = [(low, low), (high, low), (high, high), (low, high)].map(|(u, v)| self.point(u, v));
                format!("area = [{}]", corners.join(", "))
            }
            3 => {
                let radius = random.between(0.1, 0.4) * self.narrow_m();
                format!("faces_within = {{ at = {}, radius = {radius} }}", self.point(0.0, 0.0))
            }
            _ => return self.read(&head, random),
        };
        // An opening near an edge would lean.
        let is_drill = target.starts_with("drill");
        let width =
            if is_drill { random.between(0.02, 0.06) } else { rounded(random.between(0.1, 0.4) * self.narrow_m()) };
        let longest = self.half.x.max(self.half.y).max(self.half.z) * 2.0;
        let tolerance = rounded(longest / 60.0).max(0.002);
        target = format!("target = {{ {target} }}\nwidth = {}\ntolerance = {tolerance}\n", width.max(0.004));
        let (offset, flare) = (random.between(0.002, 0.02), random.between(0.0, 0.6));
        _ = writeln!(target, "offset = {offset}\nflare = {flare}");
        if !is_drill && random.first_or_percent(60) {
            _ = writeln!(target, "depth = {}", random.between(0.0, 0.5) * self.half[self.axis]);
        }
        (head + &target, None)
    }

    fn anywhere(&self, random: &mut Random) -> String {
        let (u, v) = (random.between(-0.4, 0.4), random.between(-0.4, 0.4));
        self.point(u, v)
    }

    /// A hole in the middle of the side.
    fn drill(&self, random: &mut Random) -> String {
        let mut out = [0.0; 3];
        out[self.axis] = self.sign;
        let out = self.rotation * Vec3::new(out[0], out[1], out[2]);
        let depth = random.between(0.0, self.half[self.axis]);
        format!("at = {}, axis = {}, depth = {depth}", self.point(0.0, 0.0), list(&(-out).to_array()))
    }

    /// A shield from a file: the box, a little larger.
    fn read(&self, head: &str, random: &mut Random) -> (String, Option<CellFile>) {
        let (name, unit_m) = random.one(&[("m", 1.0), ("mm", 1e-3), ("in", 0.0254)]);
        let larger = self.half + Vec3::splat(random.between(0.0005, 0.003));
        let mut text = String::new();
        for corner in 0..8_u32 {
            let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
            let p = Vec3::new(sign(1) * larger.x, sign(2) * larger.y, sign(4) * larger.z);
            let [x, y, z] = ((self.centre + self.rotation * p) * (1.0 / unit_m)).to_array();
            _ = writeln!(text, "v {x} {y} {z}");
        }
        let file = CellFile::new("shield", "obj", text + FACES);
        (format!("{head}mesh = \"{}\"\nmesh_unit = \"{name}\"\n", file.name), Some(file))
    }
}
