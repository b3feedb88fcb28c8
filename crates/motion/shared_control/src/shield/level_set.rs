//! The surface on which a field has a given value, as triangles: marching tetrahedra in the cubes that it may cross.
//!
//! Each cube is divided into six tetrahedra around its main diagonal (Kuhn), which divide the faces of neighbouring cubes
//! alike. Every triangle lies in its own tetrahedron, so the surface is closed and does not cross itself.

use std::collections::HashMap;

use elbowroom_spatial::{Aabb, Vec3};

/// A corner of the grid, in edges from its origin.
type Corner = [i32; 3];

/// A field whose value changes by at most 1 per metre.
pub(super) trait Field {
    /// Its value at a point.
    fn value(&self, p: Vec3) -> f64;
}

/// The surface on which the field equals `level`, inside `bounds`: vertices (m) and triangles that face to larger values.
///
/// `edge_m` is the edge of the cubes. The surface is closed if the field is above the level outside the bounds.
pub(super) fn level_set(field: &impl Field, level: f64, bounds: &Aabb, edge_m: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut surface = LevelSet {
        field,
        level,
        origin: bounds.min - Vec3::splat(edge_m),
        edge_m,
        heights: HashMap::new(),
        cut_edges: HashMap::new(),
        vertices: Vec::new(),
        triangles: Vec::new(),
    };
    let cubes = (bounds.extent().max_element() / edge_m).ceil() + 2.0;
    let mut size = 1;
    while f64::from(size) < cubes {
        size *= 2;
    }
    surface.divide([0; 3], size);
    (surface.vertices, surface.triangles)
}

struct LevelSet<'a, F> {
    field: &'a F,
    level: f64,
    origin: Vec3,
    edge_m: f64,
    /// The field minus the level, at corners.
    heights: HashMap<Corner, f64>,
    /// Vertices by the edge that they cut: the corner inside and the one outside.
    cut_edges: HashMap<(Corner, Corner), u32>,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// Share of an edge that a vertex keeps from its ends, so that no vertices of different edges coincide.
const LEAST_SHARE: f64 = 1.0 / 64.0;
/// The paths from corner 0 to the opposite corner of a cube: the axes in the order in which they are followed.
const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

impl<F: Field> LevelSet<'_, F> {
    fn position(&self, corner: [f64; 3]) -> Vec3 {
        self.origin + Vec3::from(corner) * self.edge_m
    }

    /// Visits the cubes of one edge in a cube of `size` edges. A cube in which the field cannot reach the level is left
    /// out.
    fn divide(&mut self, first: Corner, size: i32) {
        let half = f64::from(size) * 0.5;
        let center = self.position(first.map(|x| f64::from(x) + half));
        let half_diagonal = half * self.edge_m * 3.0_f64.sqrt();
        if (self.field.value(center) - self.level).abs() > half_diagonal * (1.0 + 1e-9) {
            return;
        }
        if size == 1 {
            self.march(first);
            return;
        }
        for child in 0..8 {
            let offset = |axis: usize| first[axis] + (child >> axis & 1) * size / 2;
            self.divide([offset(0), offset(1), offset(2)], size / 2);
        }
    }

    fn march(&mut self, first: Corner) {
        for path in PATHS {
            let mut tetrahedron = [first; 4];
            for (k, &axis) in path.iter().enumerate() {
                tetrahedron[k + 1] = tetrahedron[k];
                tetrahedron[k + 1][axis] += 1;
            }
            self.cut(&tetrahedron);
        }
    }

    fn height(&mut self, corner: Corner) -> f64 {
        let (field, level, at) = (self.field, self.level, self.position(corner.map(f64::from)));
        *self.heights.entry(corner).or_insert_with(|| field.value(at) - level)
    }

    /// Adds the triangles of a tetrahedron. A corner on the level counts as outside.
    fn cut(&mut self, corners: &[Corner; 4]) {
        let heights = corners.map(|c| self.height(c));
        let (mut inside, mut outside) = (Vec::with_capacity(4), Vec::with_capacity(4));
        for (corner, height) in corners.iter().zip(heights) {
            if height < 0.0 { inside.push((*corner, height)) } else { outside.push((*corner, height)) }
        }
        match (inside.len(), outside.len()) {
            (1, 3) => {
                let positive = is_positive(inside[0].0, outside[0].0, outside[1].0, outside[2].0);
                let t = [0, 1, 2].map(|k| self.vertex(inside[0], outside[k]));
                self.push(t, positive);
            }
            (3, 1) => {
                let positive = is_positive(outside[0].0, inside[0].0, inside[1].0, inside[2].0);
                let t = [0, 1, 2].map(|k| self.vertex(inside[k], outside[0]));
                self.push(t, !positive);
            }
            (2, 2) => {
                let positive = is_positive(inside[0].0, inside[1].0, outside[0].0, outside[1].0);
                let [ac, ad] = [0, 1].map(|k| self.vertex(inside[0], outside[k]));
                let [bc, bd] = [0, 1].map(|k| self.vertex(inside[1], outside[k]));
                self.push([ac, ad, bd], positive);
                self.push([ac, bd, bc], positive);
            }
            _ => {}
        }
    }

    fn push(&mut self, [a, b, c]: [u32; 3], positive: bool) {
        self.triangles.push(if positive { [a, b, c] } else { [a, c, b] });
    }

    /// The vertex at which the edge between a corner inside and one outside crosses the level.
    fn vertex(&mut self, inside: (Corner, f64), outside: (Corner, f64)) -> u32 {
        if let Some(&known) = self.cut_edges.get(&(inside.0, outside.0)) {
            return known;
        }
        let share = (inside.1 / (inside.1 - outside.1)).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
        let (from, to) = (self.position(inside.0.map(f64::from)), self.position(outside.0.map(f64::from)));
        let number = self.vertices.len() as u32;
        self.vertices.push(from.lerp(to, share));
        self.cut_edges.insert((inside.0, outside.0), number);
        number
    }
}

/// True if `b`, `c`, `d` run counterclockwise seen from outside when `a` is behind them.
fn is_positive(a: Corner, b: Corner, c: Corner, d: Corner) -> bool {
    let from = |p: Corner| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let ([bx, by, bz], [cx, cy, cz], [dx, dy, dz]) = (from(b), from(c), from(d));
    dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx) > 0
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::TriMesh;

    use super::*;

    struct Ball;

    impl Field for Ball {
        fn value(&self, p: Vec3) -> f64 {
            p.length() - 0.05
        }
    }

    #[test]
    fn a_ball_is_closed_faces_outwards_and_has_its_volume() {
        let bounds = Aabb { min: Vec3::splat(-0.06), max: Vec3::splat(0.06) };
        let (vertices, triangles) = level_set(&Ball, 0.0, &bounds, 0.004);
        assert!(vertices.iter().all(|v| (v.length() - 0.05).abs() < 0.0005));
        let mesh = TriMesh::new(vertices, triangles).unwrap();
        let report = mesh.report();
        assert!(report.closed && !report.inside_out && report.degenerate == 0, "{report:?}");
        let expected = 4.0 / 3.0 * std::f64::consts::PI * 0.05_f64.powi(3);
        assert!((report.volume / expected - 1.0).abs() < 0.02, "{}", report.volume / expected);
        assert_eq!(mesh.component_vertices().len(), 1);
    }
}
