//! Mesh simplification by edge collapse in the order of quadric error.
//!
//! Planes across boundary edges preserve these edges. Source: Garland and Heckbert, "Surface simplification using quadric
//! error metrics", 1997.
//!
//! [`crate::deviation`] bounds the deviation of the result afterwards, so the order of collapses affects only the
//! quality.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;

use crate::quadric::Quadric;

/// A simplified mesh, and the target vertex of each original vertex.
#[derive(Debug, Clone)]
pub(super) struct Simplified {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Per original vertex: the vertex to which it collapsed.
    pub collapsed_to: Vec<u32>,
}

/// Collapses edges until at most `middle` triangles are left, then at most `coarse`, or until no collapse is possible.
pub(super) fn middle_and_coarse(mesh: &TriMesh, middle: usize, coarse: usize) -> (Simplified, Simplified) {
    let mut work = EdgeCollapse::new(mesh);
    let mut heap: BinaryHeap<Candidate> = work.edges().iter().filter_map(|&(a, b)| work.candidate(a, b)).collect();
    work.collapse_to(middle, &mut heap);
    let first = work.result();
    work.collapse_to(coarse, &mut heap);
    (first, work.result())
}

impl EdgeCollapse {
    fn collapse_to(&mut self, target: usize, heap: &mut BinaryHeap<Candidate>) {
        while self.alive > target {
            let Some(next) = heap.pop() else { break };
            // A vertex that has changed since then has newer candidates.
            let now = self.version[next.a as usize] + self.version[next.b as usize];
            if now == next.version && self.may_collapse(&next) {
                self.collapse(&next);
                heap.extend(self.neighbours(next.a).into_iter().filter_map(|n| self.candidate(next.a, n)));
            }
        }
    }
}

/// An edge collapse and its target position.
struct Candidate {
    cost: f64,
    a: u32,
    b: u32,
    at: Vec3,
    version: u32,
}

impl Candidate {
    /// Sort key: lowest cost first. The ends break ties, so that the result is deterministic.
    fn key(&self) -> Reverse<(u64, u32, u32)> {
        // The bits of non-negative floats are in the order of their values.
        Reverse((self.cost.max(0.0).to_bits(), self.a, self.b))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key().cmp(&other.key())
    }
}

struct EdgeCollapse {
    at: Vec<Vec3>,
    quadrics: Vec<Quadric>,
    /// Corners of each face; `None` for a removed face.
    faces: Vec<Option<[u32; 3]>>,
    /// Faces of each vertex, including removed ones.
    of_vertex: Vec<Vec<u32>>,
    version: Vec<u32>,
    collapsed_to: Vec<u32>,
    alive: usize,
}

impl EdgeCollapse {
    fn new(mesh: &TriMesh) -> Self {
        let at = mesh.vertices().to_vec();
        let collapsed_to = mesh.welded_vertices();
        let faces: Vec<Option<[u32; 3]>> = mesh
            .triangles()
            .iter()
            .map(|t| t.map(|i| collapsed_to[i as usize]))
            .map(|f| (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]).then_some(f))
            .collect();
        let mut work = Self {
            quadrics: vec![Quadric::default(); at.len()],
            of_vertex: vec![Vec::new(); at.len()],
            version: vec![0; at.len()],
            alive: faces.iter().flatten().count(),
            at,
            faces,
            collapsed_to,
        };
        work.weigh();
        work
    }

    /// Accumulates the quadrics of faces and boundary edges.
    fn weigh(&mut self) {
        let mut uses: HashMap<(u32, u32), (u32, u32)> = HashMap::new();
        for (i, f) in self.faces.iter().enumerate() {
            let Some(f) = f else { continue };
            let [p, q, r] = f.map(|v| self.at[v as usize]);
            let normal = (q - p).cross(r - p);
            let quadric = Quadric::plane(normal, p, 1.0);
            for (k, &v) in f.iter().enumerate() {
                self.quadrics[v as usize].add(&quadric);
                self.of_vertex[v as usize].push(i as u32);
                let w = f[(k + 1) % 3];
                uses.entry((v.min(w), v.max(w))).or_insert((0, i as u32)).0 += 1;
            }
        }
        let mut rims: Vec<_> = uses.into_iter().filter(|(_, (count, _))| *count == 1).collect();
        rims.sort_unstable();
        for ((a, b), (_, face)) in rims {
            let Some(f) = self.faces[face as usize] else { continue };
            let [p, q, r] = f.map(|v| self.at[v as usize]);
            let edge = self.at[b as usize] - self.at[a as usize];
            let across = edge.cross((q - p).cross(r - p));
            let quadric = Quadric::plane(across, self.at[a as usize], 4.0);
            self.quadrics[a as usize].add(&quadric);
            self.quadrics[b as usize].add(&quadric);
        }
    }

    fn edges(&self) -> Vec<(u32, u32)> {
        let of = |f: &[u32; 3]| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])].map(|(a, b)| (a.min(b), a.max(b)));
        let mut edges: Vec<_> = self.faces.iter().flatten().flat_map(of).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    fn faces_of(&self, v: u32) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        self.of_vertex[v as usize].iter().filter_map(|&f| Some((f, self.faces[f as usize]?)))
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut list: Vec<u32> = self.faces_of(v).flat_map(|(_, f)| f).filter(|&w| w != v).collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    fn candidate(&self, a: u32, b: u32) -> Option<Candidate> {
        let (p, q) = (self.at[a as usize], self.at[b as usize]);
        let quadric = self.quadrics[a as usize].sum(&self.quadrics[b as usize]);
        let best = quadric.lowest().filter(|x| x.distance(p).max(x.distance(q)) <= 2.0 * p.distance(q));
        let tried = [best, Some(p.lerp(q, 0.5)), Some(p), Some(q)];
        let (cost, at) = tried
            .into_iter()
            .flatten()
            // The length breaks ties: flat areas lose their shortest edges first.
            .map(|x| (quadric.at(x).max(0.0) + 1e-9 * (p - q).length_squared(), x))
            .min_by(|x, y| x.0.total_cmp(&y.0))?;
        let version = self.version[a as usize] + self.version[b as usize];
        (cost.is_finite() && at.is_finite()).then_some(Candidate { cost, a, b, at, version })
    }

    /// True if the collapse folds no face, keeps the topology, and leaves a face at every corner.
    fn may_collapse(&self, c: &Candidate) -> bool {
        let has = |f: &[u32; 3], v: u32| f.contains(&v);
        let shared: Vec<[u32; 3]> = self.faces_of(c.a).map(|f| f.1).filter(|f| has(f, c.b)).collect();
        let (of_a, of_b) = (self.neighbours(c.a), self.neighbours(c.b));
        let common = of_a.iter().filter(|v| of_b.binary_search(v).is_ok()).count();
        if shared.is_empty() || common != shared.len() {
            return false;
        }
        let opposite = shared.iter().flat_map(|f| f.iter().copied().filter(|v| *v != c.a && *v != c.b));
        let remains = |v: u32| self.faces_of(v).any(|(_, f)| !(has(&f, c.a) && has(&f, c.b)));
        if !opposite.chain([c.a, c.b]).all(|v| v == c.a || v == c.b || remains(v)) {
            return false;
        }
        let mut rest = self
            .faces_of(c.a)
            .chain(self.faces_of(c.b))
            .map(|f| f.1)
            .filter(|f| !(has(f, c.a) && has(f, c.b)))
            .peekable();
        rest.peek().is_some() && rest.all(|f| !self.folds(&f, c))
    }

    fn folds(&self, face: &[u32; 3], c: &Candidate) -> bool {
        let normal = |at: [Vec3; 3]| (at[1] - at[0]).cross(at[2] - at[0]);
        let before = normal(face.map(|v| self.at[v as usize]));
        let after = normal(face.map(|v| if v == c.a || v == c.b { c.at } else { self.at[v as usize] }));
        before.dot(after) < 0.2 * before.length() * after.length()
    }

    fn collapse(&mut self, c: &Candidate) {
        let moved = std::mem::take(&mut self.of_vertex[c.b as usize]);
        for f in moved {
            let Some(face) = &mut self.faces[f as usize] else { continue };
            if face.contains(&c.a) {
                self.faces[f as usize] = None;
                self.alive -= 1;
            } else {
                face.iter_mut().filter(|v| **v == c.b).for_each(|v| *v = c.a);
                self.of_vertex[c.a as usize].push(f);
            }
        }
        let faces = &self.faces;
        self.of_vertex[c.a as usize].retain(|f| faces[*f as usize].is_some());
        let other = self.quadrics[c.b as usize];
        self.quadrics[c.a as usize].add(&other);
        self.at[c.a as usize] = c.at;
        self.collapsed_to[c.b as usize] = c.a;
        // Larger than both versions, so that all candidates of either vertex become invalid.
        self.version[c.a as usize] += self.version[c.b as usize] + 1;
        self.version[c.b as usize] = u32::MAX / 2;
    }

    fn result(&mut self) -> Simplified {
        let mut place = vec![u32::MAX; self.at.len()];
        let mut vertices = Vec::new();
        let mut triangles = Vec::with_capacity(self.alive);
        for f in self.faces.iter().flatten() {
            triangles.push(f.map(|v| {
                let slot = &mut place[v as usize];
                if *slot == u32::MAX {
                    *slot = vertices.len() as u32;
                    vertices.push(self.at[v as usize]);
                }
                *slot
            }));
        }
        for v in 0..self.collapsed_to.len() {
            let mut end = v as u32;
            while self.collapsed_to[end as usize] != end {
                self.collapsed_to[end as usize] = self.collapsed_to[self.collapsed_to[end as usize] as usize];
                end = self.collapsed_to[end as usize];
            }
            self.collapsed_to[v] = end;
        }
        // Vertices that only degenerate faces use have no target.
        let collapsed_to = self.collapsed_to.iter().map(|v| place[*v as usize]).collect();
        Simplified { vertices, triangles, collapsed_to }
    }
}
