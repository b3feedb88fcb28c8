//! Triangles, and the proof that they close.

use std::collections::BTreeMap;

use elbowroom_spatial::{Pose, Vec3};

/// One part, or several that overlap; each part is closed by itself.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Corners, metres.
    pub vertices: Vec<Vec3>,
    /// Indices of three corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part given in the frame `part_in_self`.
    pub fn add(&mut self, part_in_self: &Pose, part: &Self) -> &mut Self {
        let first = self.vertices.len() as u32;
        self.vertices.extend(part.vertices.iter().map(|&p| rounded(part_in_self.transform_point(p))));
        self.triangles.extend(part.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        self
    }

    /// Enclosed volume in m³ by the divergence theorem; where parts overlap, the common volume counts for each.
    pub fn volume(&self) -> f64 {
        let six_volumes = self.corners().map(|[a, b, c]| a.dot(b.cross(c)));
        six_volumes.sum::<f64>() / 6.0
    }

    /// Three corner points per triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.triangles.iter().map(|corners| corners.map(|corner| self.vertices[corner as usize]))
    }

    /// Proves that the surface is closed and faces outward once equal points (1 µm) are one: every directed edge occurs
    /// exactly once, so does its reverse, no triangle is degenerate, and the volume is positive.
    pub fn check(&self) -> Result<(), String> {
        let mut edges: BTreeMap<([i64; 3], [i64; 3]), usize> = BTreeMap::new();
        for [a, b, c] in self.corners() {
            if (b - a).cross(c - a).length() < 1e-12 {
                return Err(format!("degenerate triangle {a:?} {b:?} {c:?}"));
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((micrometres(from), micrometres(to))).or_default() += 1;
            }
        }
        for (&(from, to), &count) in &edges {
            if count != 1 || edges.get(&(to, from)) != Some(&1) {
                return Err(format!("the edge from {from:?} to {to:?} (µm) is open or shared by several parts"));
            }
        }
        if self.volume() > 0.0 { Ok(()) } else { Err(format!("the volume is {} m³: inside out", self.volume())) }
    }
}

fn micrometres(p: Vec3) -> [i64; 3] {
    [p.x, p.y, p.z].map(|v| (v * 1e6).round() as i64)
}

/// To whole micrometres: sine and cosine differ in their last bits from one C library to the next, files must not.
fn rounded(p: Vec3) -> Vec3 {
    let [x, y, z] = micrometres(p).map(|v| v as f64 / 1e6);
    Vec3::new(x, y, z)
}
