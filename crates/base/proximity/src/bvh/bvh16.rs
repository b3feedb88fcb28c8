//! The bounding volume hierarchy over the triangles of a mesh: its layout, and its construction from ordered triangles.

use elbowroom_spatial::{Aabb, Vec3};

use super::leaf_bounds::{box_of, interval, mean_normal, most_central};
use super::node::{ARITY, LEAF_SIZE, Leaf, Node};
use super::triangle_order::{fill, order_triangles};
use super::unit_frame::UnitFrame;

/// A tree without pointers: child `i` of node `m` at height `h` has the number `16 m + i` at height `h - 1`; height
/// 0 has the leaves. The root is the only child of one additional node at the last level.
#[derive(Debug, Clone)]
pub(crate) struct Bvh16 {
    pub frame: UnitFrame,
    /// Largest distance of a vertex from the centre, metres, rounded up.
    pub radius: f64,
    /// Triangle index per slot; leaf `m` has the slots from `8 m` on.
    pub order: Vec<u32>,
    pub leaves: Vec<Leaf>,
    /// Nodes by height: the children of the nodes in `levels[h]` are at height `h`.
    pub levels: Vec<Vec<Node>>,
}

impl Bvh16 {
    /// Centre, in the mesh's coordinates, and radius (m) of a sphere around all vertices.
    pub fn bounding_sphere(&self) -> (Vec3, f64) {
        (self.frame.center, self.radius)
    }

    pub fn build(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let bounds = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize]));
        let frame = UnitFrame::of(&bounds);
        let order = order_triangles(vertices, triangles, &frame);
        let blank = Leaf { corner: [[[0.0; LEAF_SIZE]; 3]; 3] };
        let mut leaves = vec![blank; order.len().div_ceil(LEAF_SIZE)];
        fill(&mut leaves, |i, leaf| {
            fill_leaf(leaf, i, &order, |t| triangles[t].map(|v| frame.to_units(vertices[v as usize])));
        });
        let mut levels = Vec::new();
        let mut children = leaves.len();
        let mut span = 1;
        loop {
            let mut level = vec![Node::EMPTY; children.div_ceil(ARITY)];
            fill(&mut level, |i, node| fill_node(node, i, span, &leaves));
            levels.push(level);
            if children == 1 {
                break;
            }
            children = children.div_ceil(ARITY);
            span *= ARITY;
        }
        let radius = triangles.iter().flatten().map(|&v| vertices[v as usize].distance(frame.center));
        let radius = radius.fold(0.0, f64::max) * (1.0 + 1e-12);
        Self { frame, radius, order, leaves, levels }
    }

    /// Height of the root: 0 if it is a leaf.
    #[inline]
    pub fn height(&self) -> usize {
        self.levels.len() - 1
    }

    /// Bit mask of children: bit `i` is set if node `m` at height `h` has a child `i`.
    #[inline]
    pub fn children(&self, height: usize, m: usize) -> u32 {
        let below = if height == 1 { self.leaves.len() } else { self.levels[height - 2].len() };
        let count = (below - m * ARITY).min(ARITY);
        (1u32 << count) - 1
    }

    /// The node with the children of node `m` at height `h`, where `h` is at least 1.
    #[inline(always)]
    pub fn node(&self, height: usize, m: usize) -> &Node {
        &self.levels[height - 1][m]
    }

    /// The parent of node or leaf `m` at height `h`, and the lane of the parent that holds its bounds.
    #[inline(always)]
    pub fn parent(&self, height: usize, m: usize) -> (&Node, usize) {
        (&self.levels[height][m / ARITY], m % ARITY)
    }

    /// Triangle index in a slot.
    #[inline]
    pub fn triangle(&self, slot: u32) -> usize {
        self.order[slot as usize] as usize
    }

    /// Number of triangles in a leaf.
    #[inline(always)]
    pub fn leaf_len(&self, leaf: usize) -> usize {
        (self.order.len() - leaf * LEAF_SIZE).min(LEAF_SIZE)
    }

    /// Bytes used in addition to the vertices and indices of the mesh.
    pub fn bytes(&self) -> usize {
        let nodes: usize = self.levels.iter().map(Vec::len).sum();
        nodes * size_of::<Node>() + self.leaves.len() * size_of::<Leaf>() + self.order.len() * size_of::<u32>()
    }
}

/// Fills a leaf. Lanes without a triangle repeat the last one; queries mask them if it matters.
fn fill_leaf(leaf: &mut Leaf, number: usize, order: &[u32], corners: impl Fn(usize) -> [Vec3; 3]) {
    for lane in 0..LEAF_SIZE {
        let slot = (number * LEAF_SIZE + lane).min(order.len() - 1);
        for (k, p) in corners(order[slot] as usize).into_iter().enumerate() {
            for axis in 0..3 {
                leaf.corner[k][axis][lane] = p[axis] as f32;
            }
        }
    }
}

fn fill_node(node: &mut Node, number: usize, span: usize, leaves: &[Leaf]) {
    for lane in 0..ARITY {
        let first = (number * ARITY + lane) * span;
        if first >= leaves.len() {
            break;
        }
        let below = &leaves[first..(first + span).min(leaves.len())];
        let (low, high) = box_of(below);
        let n = mean_normal(below);
        let (near, far) = interval(below, n);
        let landmark = most_central(below, std::array::from_fn(|k| 0.5 * (low[k] + high[k])));
        for k in 0..3 {
            let middle = 0.5 * (low[k] + high[k]);
            node.center[k][lane] = middle;
            // Corners are off by at most 2⁻²⁵, the middle and each difference by as much.
            node.half[k][lane] = (high[k] - middle).max(middle - low[k]) + BOX_MARGIN;
            node.normal[k][lane] = n[k];
            node.landmark[k][lane] = landmark[k];
        }
        node.low[lane] = near - SLAB_MARGIN;
        node.high[lane] = far + SLAB_MARGIN;
    }
}

/// 2⁻²²: four half-units of rounding for a number in [-1, 1], twice as much as can occur.
const BOX_MARGIN: f32 = 1.0 / 4_194_304.0;
/// 2⁻²⁰: the dot product of a unit vector and a rounded point of [-1, 1]³ is off by less than 10·2⁻²⁴.
const SLAB_MARGIN: f32 = 1.0 / 1_048_576.0;
