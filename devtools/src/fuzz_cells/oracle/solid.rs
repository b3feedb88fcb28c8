//! Independent distances of the oracle: GJK between convex pieces, and a tree of pieces for meshes.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;

use super::frame::Frame;
use super::simplex;

/// A convex piece: the points within a radius of a core.
#[derive(Debug, Clone)]
struct Piece {
    core: Core,
    radius: f64,
}

#[derive(Debug, Clone)]
enum Core {
    Points(Vec<Vec3>),
    Box(Vec3),
    /// Half length and radius, along z.
    Cylinder(f64, f64),
}

/// A solid as pieces in a tree of boxes; or the half-space below a height along z.
#[derive(Debug, Clone)]
pub enum OracleSolid {
    Pieces(Tree),
    Below(f64),
}

/// A binary tree of axis-aligned boxes over pieces.
#[derive(Debug, Clone)]
pub struct Tree {
    nodes: Vec<Node>,
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone)]
struct Node {
    center: Vec3,
    half: Vec3,
    /// Children, or the piece.
    below: Below,
}

#[derive(Debug, Clone, Copy)]
enum Below {
    Nodes(usize, usize),
    Piece(usize),
}

/// Proven bounds of a distance, m: `upper` is the distance of two points of the solids; no two points are nearer than
/// `lower`.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    pub lower: f64,
    pub upper: f64,
}

impl OracleSolid {
    /// Creates a shape whose surface is moved inward by `by` (m), if that is simple; otherwise the shape itself.
    pub fn eroded(shape: &Shape, by: f64) -> Self {
        let round =
            |points: Vec<Vec3>, radius: f64| Piece { core: Core::Points(points), radius: (radius - by).max(0.0) };
        let pieces = match shape {
            Shape::HalfSpace(_) => return Self::Below(-by),
            Shape::Sphere(s) => vec![round(vec![Vec3::ZERO], s.radius)],
            Shape::Capsule(c) => vec![round(vec![Vec3::Z * c.half_length, Vec3::Z * -c.half_length], c.radius)],
            Shape::Cuboid(c) => {
                let half = (c.half_extents - Vec3::splat(by)).max(Vec3::ZERO);
                vec![Piece { core: Core::Box(half), radius: 0.0 }]
            }
            Shape::Cylinder(c) => {
                let core = Core::Cylinder((c.half_length - by).max(0.0), (c.radius - by).max(0.0));
                vec![Piece { core, radius: 0.0 }]
            }
            Shape::Hull(h) => vec![Piece { core: Core::Points(h.vertices().to_vec()), radius: 0.0 }],
            Shape::Mesh(m) => {
                let corner = |i: &u32| m.vertices()[*i as usize];
                let triangle = |t: &[u32; 3]| Piece { core: Core::Points(t.iter().map(corner).collect()), radius: 0.0 };
                m.triangles().iter().map(triangle).collect()
            }
        };
        Self::Pieces(Tree::new(pieces))
    }

    pub fn point() -> Self {
        Self::Pieces(Tree::new(vec![Piece { core: Core::Points(vec![Vec3::ZERO]), radius: 0.0 }]))
    }

    /// Whether the straight line between two points comes nearer to its surface, or to a solid piece, than `within` (m).
    pub fn is_crossed(&self, at: &Frame, ends: [Vec3; 2], within: f64) -> bool {
        let ends = ends.map(|end| at.vector_back(end - at.at));
        match self {
            Self::Pieces(tree) => {
                let line = Piece { core: Core::Points(ends.to_vec()), radius: 0.0 };
                tree.is_crossed(0, ends, &line, within)
            }
            Self::Below(height) => ends.iter().any(|end| end.z <= *height),
        }
    }

    /// A point of it: the origin of a mesh may be outside of it.
    pub fn any_point(&self) -> Vec3 {
        match self {
            Self::Pieces(tree) => match &tree.pieces[0].core {
                Core::Points(points) => points[0],
                Core::Box(_) | Core::Cylinder(..) => Vec3::ZERO,
            },
            Self::Below(height) => Vec3::Z * *height,
        }
    }

    /// Largest distance of its points from a point, m; infinite if it is unbounded.
    pub fn reach_from(&self, point: Vec3) -> f64 {
        let Self::Pieces(tree) = self else { return f64::INFINITY };
        let root = &tree.nodes[0];
        (root.center - point).length() + root.half.length()
    }

    /// Distance of two solids, not computed beyond `limit` (m). At most one may be unbounded.
    pub fn distance(&self, at: &Frame, other: &Self, other_at: &Frame, limit: f64) -> Bounds {
        match (self, other) {
            (Self::Pieces(a), Self::Pieces(b)) => {
                let mut found = Bounds { lower: limit, upper: f64::INFINITY };
                a.search(at, 0, b, other_at, 0, &mut found);
                found
            }
            (Self::Pieces(a), Self::Below(height)) => a.height_above(at, other_at, *height),
            (Self::Below(height), Self::Pieces(b)) => b.height_above(other_at, at, *height),
            (Self::Below(_), Self::Below(_)) => Bounds { lower: 0.0, upper: 0.0 },
        }
    }
}

impl Tree {
    fn is_crossed(&self, node: usize, ends: [Vec3; 2], line: &Piece, within: f64) -> bool {
        let n = &self.nodes[node];
        let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
        for k in 0..3 {
            let (from, along) = (ends[0][k] - n.center[k], ends[1][k] - ends[0][k]);
            let half = n.half[k] + within;
            if along.abs() < 1e-12 {
                leaves = if from.abs() > half { -1.0 } else { leaves };
                continue;
            }
            let (s, t) = ((-half - from) / along, (half - from) / along);
            (enters, leaves) = (enters.max(s.min(t)), leaves.min(s.max(t)));
        }
        enters <= leaves
            && match n.below {
                Below::Nodes(a, b) => self.is_crossed(a, ends, line, within) || self.is_crossed(b, ends, line, within),
                Below::Piece(i) => gjk(&self.pieces[i], &Frame::IDENTITY, line, &Frame::IDENTITY).upper < within,
            }
    }

    fn new(pieces: Vec<Piece>) -> Self {
        let boxes: Vec<(Vec3, Vec3)> = pieces.iter().map(Piece::corners).collect();
        let mut tree = Self { nodes: Vec::new(), pieces };
        let mut all: Vec<usize> = (0..boxes.len()).collect();
        tree.build(&mut all, &boxes);
        tree
    }

    fn build(&mut self, list: &mut [usize], boxes: &[(Vec3, Vec3)]) -> usize {
        let infinite = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
        let (low, high) = list.iter().fold(infinite, |(l, h), i| (l.min(boxes[*i].0), h.max(boxes[*i].1)));
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let index = self.nodes.len();
        self.nodes.push(Node { center, half, below: Below::Piece(list[0]) });
        if list.len() > 1 {
            let axis = if half.x >= half.y && half.x >= half.z { 0 } else { 1 + usize::from(half.z > half.y) };
            let key = |i: &usize| (boxes[*i].0 + boxes[*i].1)[axis];
            list.sort_by(|a, b| key(a).total_cmp(&key(b)));
            let (left, right) = list.split_at_mut(list.len() / 2);
            let children = (self.build(left, boxes), self.build(right, boxes));
            self.nodes[index].below = Below::Nodes(children.0, children.1);
        }
        index
    }

    /// Searches by branch and bound: pairs that cannot be below the least upper bound, or the limit, are skipped.
    fn search(&self, at: &Frame, node: usize, other: &Self, other_at: &Frame, other_node: usize, found: &mut Bounds) {
        let (a, b) = (&self.nodes[node], &other.nodes[other_node]);
        if found.upper <= 0.0 || apart(a, at, b, other_at) >= found.lower.min(found.upper) {
            return;
        }
        match (a.below, b.below) {
            (Below::Piece(i), Below::Piece(j)) => {
                let pair = gjk(&self.pieces[i], at, &other.pieces[j], other_at);
                found.lower = found.lower.min(pair.lower);
                found.upper = found.upper.min(pair.upper);
            }
            (Below::Nodes(l, r), Below::Piece(_)) => {
                self.search(at, l, other, other_at, other_node, found);
                self.search(at, r, other, other_at, other_node, found);
            }
            (Below::Nodes(l, r), Below::Nodes(..)) if a.half.length() >= b.half.length() => {
                self.search(at, l, other, other_at, other_node, found);
                self.search(at, r, other, other_at, other_node, found);
            }
            (_, Below::Nodes(l, r)) => {
                self.search(at, node, other, other_at, l, found);
                self.search(at, node, other, other_at, r, found);
            }
        }
    }

    fn height_above(&self, at: &Frame, plane: &Frame, height: f64) -> Bounds {
        let up = plane.vector(Vec3::Z);
        let down = at.vector_back(-up);
        let lowest = |p: &Piece| up.dot(at.point(p.support(down)) - plane.at) - p.radius - height;
        let least = self.pieces.iter().map(lowest).fold(f64::INFINITY, f64::min);
        Bounds { lower: least, upper: least }
    }
}

/// Lower bound of the distance of two boxes, by their axis-aligned boxes in the frame of the first.
fn apart(a: &Node, at: &Frame, b: &Node, other_at: &Frame) -> f64 {
    let center = at.vector_back(other_at.point(b.center) - at.point(a.center));
    let half = a.half + other_at.seen_from(at).extents(b.half);
    (center.abs() - half).max(Vec3::ZERO).length()
}

impl Piece {
    fn support(&self, d: Vec3) -> Vec3 {
        match &self.core {
            Core::Points(points) => {
                let (mut best, mut most) = (points[0], points[0].dot(d));
                for point in &points[1..] {
                    let along = point.dot(d);
                    if along > most {
                        (best, most) = (*point, along);
                    }
                }
                best
            }
            Core::Box(h) => Vec3::new(h.x.copysign(d.x), h.y.copysign(d.y), h.z.copysign(d.z)),
            Core::Cylinder(half, radius) => {
                let flat = d.x.hypot(d.y);
                let scale = if flat > 0.0 { radius / flat } else { 0.0 };
                Vec3::new(d.x * scale, d.y * scale, half.copysign(d.z))
            }
        }
    }

    fn corners(&self) -> (Vec3, Vec3) {
        let most = |d: Vec3| self.support(d).dot(d).abs() + self.radius;
        if let Core::Points(points) = &self.core {
            let r = Vec3::splat(self.radius);
            let (low, high) = points.iter().fold((points[0], points[0]), |(l, h), p| (l.min(*p), h.max(*p)));
            (low - r, high + r)
        } else {
            let half = Vec3::new(most(Vec3::X), most(Vec3::Y), most(Vec3::Z));
            (-half, half)
        }
    }
}

/// Computes the distance by the algorithm of Gilbert, Johnson and Keerthi (1988), with the lower bound that every
/// support point proves.
fn gjk(a: &Piece, at: &Frame, b: &Piece, other_at: &Frame) -> Bounds {
    let radii = a.radius + b.radius;
    let support =
        |d: Vec3| at.point(a.support(at.vector_back(d))) - other_at.point(b.support(other_at.vector_back(-d)));
    let mut nearest = support(at.at - other_at.at + Vec3::X * 1e-9);
    let mut face = vec![nearest];
    let mut lower: f64 = 0.0;
    for _ in 0..100 {
        let length = nearest.length();
        if length < 1e-13 {
            break;
        }
        let corner = support(-nearest);
        lower = lower.max(nearest.dot(corner) / length);
        let known = face.iter().any(|p| (*p - corner).length_squared() < 1e-28);
        if known || length - lower < 1e-11 {
            break;
        }
        face.push(corner);
        let (point, of) = simplex::nearest(&face);
        if point.length() >= length * (1.0 + 1e-12) || of.len() == 4 {
            if of.len() == 4 {
                nearest = Vec3::ZERO;
            }
            break;
        }
        (nearest, face) = (point, of);
    }
    Bounds { lower: lower - radii, upper: nearest.length() - radii }
}
