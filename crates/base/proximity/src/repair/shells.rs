//! Shells: faces connected over edges of two faces each, and their orientation.

use elbowroom_spatial::{Aabb, Vec3};

use crate::shape::topology::{Edges, first_of_equal, is_proper};

/// Index that means no shell or no neighbour.
const NONE: u32 = u32::MAX;

/// A surface connected over edges of exactly two faces.
#[derive(Debug, Clone)]
pub(crate) struct Shell {
    /// Faces of the shell, in breadth-first order.
    pub faces: Vec<u32>,
    /// True if all faces have the same orientation as given.
    pub consistent: bool,
    /// True if the faces can be oriented consistently, unlike those of a Möbius strip.
    pub orientable: bool,
    /// True if this shell uses every edge of its faces an even number of times.
    pub closed: bool,
    /// Signed volume, m³, with all faces oriented like the first; `None` if the shell is open, or the volume too small
    /// for a sign.
    pub volume: Option<f64>,
    pub bounds: Aabb,
}

/// All shells, and for each triangle whether its orientation is opposite to that of the first face of its shell.
pub(crate) struct Shells {
    pub list: Vec<Shell>,
    pub reversed: Vec<bool>,
}

impl Shells {
    pub fn of(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let first = first_of_equal(vertices);
        let faces: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| first[i as usize])).collect();
        let edges = Edges::new(vertices.len(), &faces, |triangle, _| triangle as u32);
        let neighbours = neighbours(&faces, &edges);
        let (shell_of, reversed) = (vec![NONE; faces.len()], vec![false; faces.len()]);
        let mut search = BreadthFirst { faces: &faces, neighbours, shell_of, reversed };
        let mut list = Vec::new();
        for start in 0..faces.len() {
            if search.shell_of[start] == NONE && is_proper(&faces[start]) {
                list.push(search.shell_from(start as u32, list.len() as u32));
            }
        }
        edges.for_each(|_, _, uses| open_odd(uses, &search.shell_of, &mut list));
        for shell in &mut list {
            measure(shell, vertices, triangles, &search.reversed);
        }
        Self { list, reversed: search.reversed }
    }
}

/// The neighbour of each face over the edge from each corner to the next, if that edge has two faces.
fn neighbours(faces: &[[u32; 3]], edges: &Edges) -> Vec<[u32; 3]> {
    let mut neighbour = vec![[NONE; 3]; faces.len()];
    edges.for_each(|low, high, uses| {
        let [s, t] = uses else { return };
        let (s, t) = (*s as u32, *t as u32);
        let corner =
            |f: [u32; 3]| (0..3).find(|&k| (f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])) == (low, high));
        for (from, to) in [(s, t), (t, s)] {
            if let Some(k) = corner(faces[from as usize]) {
                neighbour[from as usize][k] = to;
            }
        }
    });
    neighbour
}

struct BreadthFirst<'a> {
    faces: &'a [[u32; 3]],
    neighbours: Vec<[u32; 3]>,
    shell_of: Vec<u32>,
    reversed: Vec<bool>,
}

impl BreadthFirst<'_> {
    fn shell_from(&mut self, start: u32, number: u32) -> Shell {
        let (mut consistent, mut orientable) = (true, true);
        let mut visited = vec![start];
        self.shell_of[start as usize] = number;
        let mut next = 0;
        while next < visited.len() {
            let f = visited[next] as usize;
            next += 1;
            for k in 0..3 {
                let g = self.neighbours[f][k];
                if g == NONE {
                    continue;
                }
                let agrees = !has_directed(self.faces[g as usize], self.faces[f][k], self.faces[f][(k + 1) % 3]);
                let reversed = self.reversed[f] == agrees;
                consistent &= agrees;
                if self.shell_of[g as usize] == NONE {
                    self.shell_of[g as usize] = number;
                    self.reversed[g as usize] = reversed;
                    visited.push(g);
                } else {
                    orientable &= self.reversed[g as usize] == reversed;
                }
            }
        }
        Shell { faces: visited, consistent, orientable, closed: true, volume: None, bounds: Aabb::EMPTY }
    }
}

/// True if the face has the directed edge from `a` to `b`.
fn has_directed(f: [u32; 3], a: u32, b: u32) -> bool {
    (0..3).any(|k| f[k] == a && f[(k + 1) % 3] == b)
}

/// Marks shells open that use an edge an odd number of times.
fn open_odd(uses: &[u64], shell_of: &[u32], list: &mut [Shell]) {
    let mut shells: Vec<u32> = uses.iter().map(|&u| shell_of[u as u32 as usize]).collect();
    shells.sort_unstable();
    for same in shells.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1) {
        list[same[0] as usize].closed = false;
    }
}

fn measure(shell: &mut Shell, vertices: &[Vec3], triangles: &[[u32; 3]], reversed: &[bool]) {
    let corners = |&f: &u32| triangles[f as usize].map(|i| vertices[i as usize]);
    shell.bounds = Aabb::from_points(shell.faces.iter().flat_map(corners));
    if !(shell.closed && shell.orientable) {
        return;
    }
    let origin = shell.bounds.center();
    let (mut six_fold, mut size) = (0.0, 0.0);
    for f in &shell.faces {
        let [a, b, c] = corners(f).map(|p| p - origin);
        let product = a.dot(b.cross(c));
        six_fold += if reversed[*f as usize] { -product } else { product };
        size += a.length() * b.length() * c.length();
    }
    let volume: f64 = six_fold / 6.0;
    shell.volume = (volume.abs() > 1e-13 * size).then_some(volume);
}

impl Shells {
    /// True if all closed shells are consistent and have the same sign. Then the solid is their union, and the sign
    /// gives the orientation of each.
    pub fn agree(&self) -> bool {
        let mut signs = self.closed().map(|s| s.volume.filter(|_| s.consistent).map(f64::signum));
        let first = signs.next().flatten();
        first.is_some() && signs.all(|sign| sign == first)
    }

    /// True if the bounds of all other closed shells are apart from its bounds: then it is a separate solid, not a cavity.
    pub fn is_alone(&self, number: usize) -> bool {
        let bounds = &self.list[number].bounds;
        let mut others = self.list.iter().enumerate().filter(|&(n, s)| n != number && s.closed);
        others.all(|(_, s)| !s.bounds.overlaps(bounds))
    }

    fn closed(&self) -> impl Iterator<Item = &Shell> {
        self.list.iter().filter(|s| s.closed)
    }
}
