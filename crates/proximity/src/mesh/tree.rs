//! The tree of wide nodes: what is stored, and how it is filled from the ordered triangles.

use elbowroom_spatial::{Aabb, Vec3};

use super::order::{in_chunks, order};

/// Children of a node at most: the lanes of one test.
pub(super) const FAN: usize = 16;
/// Triangles of a leaf at most.
pub(super) const LEAF: usize = 8;

/// The mesh's own origin and unit, in which all coordinates lie in [-1, 1].
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub center: Vec3,
    /// Metres per unit, a power of two.
    pub unit: f64,
    pub inverse: f64,
}

impl Frame {
    fn of(bounds: &Aabb) -> Self {
        let half = bounds.extent().max_element() * 0.5;
        // The power of two above the half extent, with room for the rounding of the centre; never less than a micrometre,
        // so that ratios of distances to units stay numbers.
        let exponent = if half > 0.0 { (half * 1.000_001).log2().floor() + 1.0 } else { 0.0 };
        let unit = exponent.clamp(-20.0, 1000.0).exp2();
        Self { center: bounds.center(), unit, inverse: 1.0 / unit }
    }

    pub fn in_metres(self, p: [f32; 3]) -> Vec3 {
        Vec3::from(p.map(f64::from)) * self.unit + self.center
    }

    #[inline]
    pub fn to_units(self, p: Vec3) -> Vec3 {
        (p - self.center) * self.inverse
    }
}

/// Up to sixteen children, structure of arrays, in units of the mesh's [`Frame`].
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub center: [[f32; FAN]; 3],
    /// Half extents, rounded outwards.
    pub half: [[f32; FAN]; 3],
    /// A direction no longer than 1 and the interval of the child along it, rounded outwards.
    pub normal: [[f32; FAN]; 3],
    pub low: [f32; FAN],
    pub high: [f32; FAN],
    /// A point of the surface near the middle of the box: a landmark.
    pub mark: [[f32; FAN]; 3],
}

impl Node {
    pub const EMPTY: Self = Self {
        center: [[0.0; FAN]; 3],
        half: [[0.0; FAN]; 3],
        normal: [[0.0; FAN]; 3],
        low: [0.0; FAN],
        high: [0.0; FAN],
        mark: [[0.0; FAN]; 3],
    };
}

/// Eight triangles: `corner[k][axis][lane]`, in units of the mesh's [`Frame`], rounded to nearest.
#[derive(Debug, Clone)]
#[repr(C, align(32))]
pub(super) struct Leaf {
    pub corner: [[[f32; LEAF]; 3]; 3],
}

/// A tree without pointers: child `i` of node `m` at height `h` is number `16 m + i` at height `h - 1`; height 0 are
/// the leaves. Above the root lies one more node, whose only child it is.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    pub(super) frame: Frame,
    /// Farthest vertex from the centre, metres, rounded up.
    pub(super) radius: f64,
    pub(super) order: Vec<u32>,
    pub(super) leaves: Vec<Leaf>,
    /// `levels[h - 1]` holds the nodes of height `h`.
    pub(super) levels: Vec<Vec<Node>>,
}

impl Tree {
    /// Centre, in the mesh's coordinates, and radius (m) of a ball around all vertices.
    pub fn ball(&self) -> (Vec3, f64) {
        (self.frame.center, self.radius)
    }

    pub fn build(vertices: &[Vec3], triangles: &[[u32; 3]], threads: usize) -> Self {
        let bounds = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize]));
        let frame = Frame::of(&bounds);
        let order = order(vertices, triangles, &frame, threads);
        let blank = Leaf { corner: [[[0.0; LEAF]; 3]; 3] };
        let mut leaves = vec![blank; order.len().div_ceil(LEAF)];
        in_chunks(&mut leaves, threads, |first, chunk| {
            for (i, leaf) in chunk.iter_mut().enumerate() {
                fill_leaf(leaf, first + i, &order, |t| triangles[t].map(|v| frame.to_units(vertices[v as usize])));
            }
        });
        let mut levels = Vec::new();
        let mut children = leaves.len();
        let mut span = 1;
        loop {
            let mut level = vec![Node::EMPTY; children.div_ceil(FAN)];
            in_chunks(&mut level, threads.min(1 + leaves.len() / 512), |first, chunk| {
                for (i, node) in chunk.iter_mut().enumerate() {
                    fill_node(node, first + i, span, &leaves);
                }
            });
            levels.push(level);
            if children == 1 {
                break;
            }
            children = children.div_ceil(FAN);
            span *= FAN;
        }
        let radius = triangles.iter().flatten().map(|&v| vertices[v as usize].distance(frame.center));
        let radius = radius.fold(0.0, f64::max) * (1.0 + 1e-12);
        Self { frame, radius, order, leaves, levels }
    }

    /// Height of the root: 0 where it is a leaf.
    #[inline]
    pub(super) fn height(&self) -> usize {
        self.levels.len() - 1
    }

    /// Bit `i` is set where node `m` at height `h` has a child `i`.
    #[inline]
    pub(super) fn children(&self, height: usize, m: usize) -> u32 {
        let below = if height == 1 { self.leaves.len() } else { self.levels[height - 2].len() };
        let count = (below - m * FAN).min(FAN);
        (1u32 << count) - 1
    }

    /// Triangle number in a slot.
    #[inline]
    pub(super) fn triangle(&self, slot: u32) -> usize {
        self.order[slot as usize] as usize
    }

    /// Bytes held, beside the vertices and indices of the mesh.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.levels.iter().map(Vec::len).sum();
        nodes * size_of::<Node>() + self.leaves.len() * size_of::<Leaf>() + self.order.len() * size_of::<u32>()
    }
}

/// Lanes without a triangle repeat the last one; they are masked where it matters.
fn fill_leaf(leaf: &mut Leaf, number: usize, order: &[u32], corners: impl Fn(usize) -> [Vec3; 3]) {
    for lane in 0..LEAF {
        let slot = (number * LEAF + lane).min(order.len() - 1);
        for (k, p) in corners(order[slot] as usize).into_iter().enumerate() {
            for axis in 0..3 {
                leaf.corner[k][axis][lane] = p[axis] as f32;
            }
        }
    }
}

fn fill_node(node: &mut Node, number: usize, span: usize, leaves: &[Leaf]) {
    for lane in 0..FAN {
        let first = (number * FAN + lane) * span;
        if first >= leaves.len() {
            break;
        }
        let below = &leaves[first..(first + span).min(leaves.len())];
        let (low, high) = box_of(below);
        let n = mean_normal(below);
        let (near, far) = interval(below, n);
        let mark = most_central(below, std::array::from_fn(|k| 0.5 * (low[k] + high[k])));
        for k in 0..3 {
            let middle = 0.5 * (low[k] + high[k]);
            node.center[k][lane] = middle;
            // Corners are off by 2⁻²⁵ at most, the middle and the differences by as much each.
            node.half[k][lane] = (high[k] - middle).max(middle - low[k]) + OUTWARD_BOX;
            node.normal[k][lane] = n[k];
            node.mark[k][lane] = mark[k];
        }
        node.low[lane] = near - OUTWARD_SLAB;
        node.high[lane] = far + OUTWARD_SLAB;
    }
}

/// 2⁻²²: four half-units of rounding of a number in [-1, 1], twice as much as can occur.
const OUTWARD_BOX: f32 = 1.0 / 4_194_304.0;
/// 2⁻²⁰: a dot product of a unit vector with a rounded point of [-1, 1]³ is off by less than 10·2⁻²⁴.
const OUTWARD_SLAB: f32 = 1.0 / 1_048_576.0;

pub(super) fn box_of(leaves: &[Leaf]) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = ([[f32::INFINITY; LEAF]; 3], [[f32::NEG_INFINITY; LEAF]; 3]);
    for leaf in leaves {
        for corner in &leaf.corner {
            for k in 0..3 {
                for lane in 0..LEAF {
                    low[k][lane] = if corner[k][lane] < low[k][lane] { corner[k][lane] } else { low[k][lane] };
                    high[k][lane] = if corner[k][lane] > high[k][lane] { corner[k][lane] } else { high[k][lane] };
                }
            }
        }
    }
    let least = |x: [f32; LEAF]| x.into_iter().fold(f32::INFINITY, f32::min);
    let most = |x: [f32; LEAF]| x.into_iter().fold(f32::NEG_INFINITY, f32::max);
    (low.map(least), high.map(most))
}

/// The middle of a triangle that is nearest to `center`.
pub(super) fn most_central(leaves: &[Leaf], center: [f32; 3]) -> [f32; 3] {
    let (mut nearest, mut mark) = ([f32::INFINITY; LEAF], [center; LEAF]);
    for Leaf { corner: [p, q, r] } in leaves {
        for lane in 0..LEAF {
            let middle: [f32; 3] = std::array::from_fn(|k| (p[k][lane] + q[k][lane] + r[k][lane]) * (1.0 / 3.0));
            let [x, y, z]: [f32; 3] = std::array::from_fn(|k| middle[k] - center[k]);
            let square = x * x + y * y + z * z;
            if square < nearest[lane] {
                (nearest[lane], mark[lane]) = (square, middle);
            }
        }
    }
    let best = (0..LEAF).min_by(|&i, &j| nearest[i].total_cmp(&nearest[j])).unwrap_or(0);
    mark[best]
}

/// Area-weighted mean normal, a hair shorter than 1; zero where the triangles have none.
fn mean_normal(leaves: &[Leaf]) -> [f32; 3] {
    let mut sum = [[0.0f32; LEAF]; 3];
    for leaf in leaves {
        let [a, b, c] = &leaf.corner;
        for lane in 0..LEAF {
            let u: [f32; 3] = std::array::from_fn(|k| b[k][lane] - a[k][lane]);
            let v: [f32; 3] = std::array::from_fn(|k| c[k][lane] - a[k][lane]);
            sum[0][lane] += u[1] * v[2] - u[2] * v[1];
            sum[1][lane] += u[2] * v[0] - u[0] * v[2];
            sum[2][lane] += u[0] * v[1] - u[1] * v[0];
        }
    }
    let total = sum.map(|lanes| lanes.iter().map(|&x| f64::from(x)).sum::<f64>());
    let n = Vec3::from(total).try_normalize().map_or(Vec3::ZERO, |n| n * (1.0 - 1e-6));
    n.to_array().map(|x| x as f32)
}

fn interval(leaves: &[Leaf], n: [f32; 3]) -> (f32, f32) {
    let (mut low, mut high) = ([f32::INFINITY; LEAF], [f32::NEG_INFINITY; LEAF]);
    for leaf in leaves {
        for [x, y, z] in &leaf.corner {
            for lane in 0..LEAF {
                let p = n[0] * x[lane] + n[1] * y[lane] + n[2] * z[lane];
                low[lane] = if p < low[lane] { p } else { low[lane] };
                high[lane] = if p > high[lane] { p } else { high[lane] };
            }
        }
    }
    (low.into_iter().fold(f32::INFINITY, f32::min), high.into_iter().fold(f32::NEG_INFINITY, f32::max))
}
