//! Triangle mesh, and the proof that it is closed.

use std::collections::BTreeMap;

use elbowroom_spatial::{Pose, Vec3};

/// One part, or several overlapping ones; each part is closed by itself.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Corners, m.
    pub vertices: Vec<Vec3>,
    /// Indices of three corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Creates an empty mesh.
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

    /// Enclosed volume in m³ by the divergence theorem; if parts overlap, their common volume counts for each.
    pub fn volume(&self) -> f64 {
        let six_volumes = self.corners().map(|[a, b, c]| a.dot(b.cross(c)));
        six_volumes.sum::<f64>() / 6.0
    }

    /// Returns three corner points per triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.triangles.iter().map(|corners| corners.map(|corner| self.vertices[corner as usize]))
    }

    /// Proves that the surface is closed and faces outward after equal points (1 µm) are merged: every directed edge occurs
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

/// Rounds to whole micrometres: sine and cosine differ in their last bits between C libraries; files must not.
fn rounded(p: Vec3) -> Vec3 {
    let [x, y, z] = micrometres(p).map(|v| v as f64 / 1e6);
    Vec3::new(x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{along_x, along_y, extrude, lathe, outline, ring, upright};

    fn placed(pose: &Pose, part: &Mesh) -> Mesh {
        let mut mesh = Mesh::new();
        mesh.add(pose, part);
        mesh
    }

    #[test]
    fn volumes_are_those_of_the_textbook() {
        let sides = 64;
        // A regular polygon instead of the circle.
        let disc = |r: f64| 0.5 * f64::from(sides) * r * r * (std::f64::consts::TAU / f64::from(sides)).sin();
        let can = lathe(&[[0.1, 0.0], [0.1, 0.3]], sides as usize);
        let pipe = ring(&[[0.1, 0.0], [0.1, 0.3], [0.05, 0.3], [0.05, 0.0]], sides as usize);
        let plate = extrude(&outline::rounded_rectangle(0.4, 0.2, 0.05, 16), 0.0, 0.1, 0.0);
        let plate_area = 0.4 * 0.2 - 0.1 * 0.1 + disc(0.05);
        let cases = [(can, disc(0.1) * 0.3), (pipe, (disc(0.1) - disc(0.05)) * 0.3), (plate, plate_area * 0.1)];
        for (part, volume) in cases {
            for pose in [upright([0.1, 0.2, 0.3]), along_x([0.0; 3]), along_y([0.5, 0.0, 0.0])] {
                let mesh = placed(&pose, &part);
                mesh.check().unwrap();
                assert!((mesh.volume() - volume).abs() < 1e-6, "{} instead of {volume}", mesh.volume());
            }
        }
    }

    #[test]
    fn a_rounded_rim_takes_material_away() {
        let outline = outline::tapered_slot(0.13, 0.10, 0.7, 0.02, 16);
        let [sharp, round] = [0.0, 0.02].map(|rim| placed(&Pose::IDENTITY, &extrude(&outline, 0.0, 0.1, rim)));
        round.check().unwrap();
        assert!(round.volume() < sharp.volume() && round.volume() > 0.9 * sharp.volume());
    }

    #[test]
    fn holes_inside_out_and_shared_faces_are_found() {
        let can = placed(&Pose::IDENTITY, &lathe(&[[0.1, 0.0], [0.1, 0.3]], 12));
        let mut open = can.clone();
        open.triangles.pop();
        assert!(open.check().unwrap_err().contains("open"));
        let mut turned = can.clone();
        turned.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        assert!(turned.check().unwrap_err().contains("inside out"));
        let mut twice = can.clone();
        twice.add(&Pose::IDENTITY, &can);
        assert!(twice.check().unwrap_err().contains("shared"));
        let mut flat = can;
        flat.triangles.push([0, 0, 1]);
        assert!(flat.check().unwrap_err().contains("degenerate"));
    }
}
