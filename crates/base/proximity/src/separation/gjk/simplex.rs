//! The point of a simplex nearest to the origin.

use elbowroom_spatial::Vec3;

/// A vertex of the difference `A - B` and the two points whose difference it is, all in B's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub w: Vec3,
    pub on_a: Vec3,
    pub on_b: Vec3,
}

/// Up to four vertices with the weights of the nearest point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Simplex {
    pub vertices: [Vertex; 4],
    pub weights: [f64; 4],
    pub len: usize,
}

/// Vertices by index and their weights.
#[derive(Clone, Copy)]
struct Face {
    index: [usize; 3],
    weights: [f64; 3],
    len: usize,
    squared: f64,
}

impl Simplex {
    pub fn new(v: Vertex) -> Self {
        Self { vertices: [v; 4], weights: [1.0, 0.0, 0.0, 0.0], len: 1 }
    }

    pub fn push(&mut self, v: Vertex) {
        self.vertices[self.len] = v;
        self.len += 1;
    }

    pub fn contains(&self, w: Vec3) -> bool {
        self.vertices[..self.len].iter().any(|v| v.w == w)
    }

    /// The weighted sum of the vectors that `of` selects.
    pub fn blend(&self, of: impl Fn(&Vertex) -> Vec3) -> Vec3 {
        (0..self.len).fold(Vec3::ZERO, |sum, i| sum + of(&self.vertices[i]) * self.weights[i])
    }

    /// Keeps the smallest face that contains the point nearest to the origin. Returns false if a tetrahedron contains
    /// the origin. If the origin is known to be `apart`, all faces are tested, without relying on the signs of flat
    /// tetrahedra.
    pub fn reduce(&mut self, apart: bool) -> bool {
        let best = match self.len {
            1 => return true,
            2 => self.segment(0, 1),
            3 => self.triangle(0, 1, 2),
            _ => match self.tetrahedron(apart) {
                Some(face) => face,
                None => return false,
            },
        };
        let old = self.vertices;
        for k in 0..best.len {
            self.vertices[k] = old[best.index[k]];
            self.weights[k] = best.weights[k];
        }
        self.len = best.len;
        true
    }

    /// Sets the weights to the barycentric coordinates of the origin in a tetrahedron; false if it is flat.
    pub fn set_weights_of_origin(&mut self) -> bool {
        let [a, b, c, d] = self.vertices.map(|v| v.w);
        let product = |p: Vec3, q: Vec3, r: Vec3| p.dot(q.cross(r));
        let volume = product(b - a, c - a, d - a);
        let weights =
            [product(b, c, d), -product(a, c, d), product(a, b, d), -product(a, b, c)].map(|v| (v / volume).max(0.0));
        let sum: f64 = weights.iter().sum();
        self.weights = weights.map(|w| w / sum);
        sum.is_finite() && sum > 0.0
    }

    fn w(&self, i: usize) -> Vec3 {
        self.vertices[i].w
    }

    fn face(&self, index: [usize; 3], weights: [f64; 3], len: usize) -> Face {
        let p = (0..len).fold(Vec3::ZERO, |sum, k| sum + self.w(index[k]) * weights[k]);
        Face { index, weights, len, squared: p.length_squared() }
    }

    fn segment(&self, i: usize, j: usize) -> Face {
        let (a, ab) = (self.w(i), self.w(j) - self.w(i));
        let t = -a.dot(ab) / ab.length_squared();
        if t >= 1.0 {
            self.face([j, 0, 0], [1.0, 0.0, 0.0], 1)
        } else if t > 0.0 {
            self.face([i, j, 0], [1.0 - t, t, 0.0], 2)
        } else {
            self.face([i, 0, 0], [1.0, 0.0, 0.0], 1)
        }
    }

    /// The nearest face of a triangle. Sub-areas are computed from differences of nearby vertices, so that small
    /// triangles on curved surfaces keep their digits.
    fn triangle(&self, i: usize, j: usize, k: usize) -> Face {
        let (a, b, c) = (self.w(i), self.w(j), self.w(k));
        let n = (b - a).cross(c - a);
        let (wa, wb, wc) = (n.dot(b.cross(c - b)), n.dot(c.cross(a - c)), n.dot(a.cross(b - a)));
        if wa > 0.0 && wb > 0.0 && wc > 0.0 {
            let sum = wa + wb + wc;
            return self.face([i, j, k], [wa / sum, wb / sum, wc / sum], 3);
        }
        let edges = [self.segment(i, j), self.segment(j, k), self.segment(k, i)];
        let first = if edges[1].squared < edges[0].squared { edges[1] } else { edges[0] };
        if edges[2].squared < first.squared { edges[2] } else { first }
    }

    /// The nearest of the faces with the origin on their outer side; `None` if the origin is inside all of them.
    fn tetrahedron(&self, apart: bool) -> Option<Face> {
        let mut best: Option<Face> = None;
        for [i, j, k, opposite] in [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]] {
            let a = self.w(i);
            let n = (self.w(j) - a).cross(self.w(k) - a);
            let (origin, inner) = (-a.dot(n), (self.w(opposite) - a).dot(n));
            let flat = inner.abs() <= 1e-14 * n.length() * (self.w(opposite) - a).length();
            if apart || flat || !(origin * inner > 0.0) {
                let face = self.triangle(i, j, k);
                if best.is_none_or(|b| face.squared < b.squared) {
                    best = Some(face);
                }
            }
        }
        best
    }
}
