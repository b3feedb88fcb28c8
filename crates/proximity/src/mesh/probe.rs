//! One mesh against one simple thing: the descent, and what bounds the things from below.

use elbowroom_spatial::{Aabb, Pose, Vec3};
use fearless_simd::{Simd, dispatch, prelude::*};

use super::lanes::{V3, W8, W16, abs16, load_corners, load16, splat16};
use super::scratch::detected_level;
use super::tree::{FAN, LEAF, Leaf, Node, Tree};

/// A lower bound for sixteen boxes at once. What is bounded is up to the probe; the smaller, the sooner visited.
pub(crate) trait Probe {
    /// For the children of a node, in units of the tree's frame.
    fn bounds(&self, node: &Node) -> [f32; FAN];
}

/// A subtree still to be visited.
#[derive(Clone, Copy)]
struct Waiting {
    bound: f32,
    number: u32,
    height: u8,
}

/// Each step down leaves at most 15 siblings behind; trees are 8 high.
const DEPTH: usize = 16 * 10;

impl Tree {
    /// Calls `leaf` with the number of every triangle that is not bounded away beyond `limit`, most promising first;
    /// it returns the limit that holds from then on.
    pub(crate) fn visit(&self, probe: &dyn Probe, mut limit: f32, leaf: &mut dyn FnMut(usize) -> f32) {
        let mut stack = [Waiting { bound: 0.0, number: 0, height: 0 }; DEPTH];
        stack[0] = Waiting { bound: f32::NEG_INFINITY, number: 0, height: self.height() as u8 };
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let Waiting { bound, number, height } = stack[len];
            // A NaN is visited: what is not known is not left out.
            if bound > limit {
                continue;
            }
            let number = number as usize;
            if height == 0 {
                limit = self.visit_leaf(probe, number, limit, leaf);
                continue;
            }
            let bounds = probe.bounds(&self.levels[height as usize - 1][number]);
            let mut left = self.children(height as usize, number);
            let first = len;
            while let Some(lane) = smallest(&bounds, &mut left, limit) {
                let number = (number * FAN + lane) as u32;
                stack[len] = Waiting { bound: bounds[lane], number, height: height - 1 };
                len += 1;
            }
            stack[first..len].reverse();
        }
    }

    fn visit_leaf(&self, probe: &dyn Probe, number: usize, limit: f32, leaf: &mut dyn FnMut(usize) -> f32) -> f32 {
        let first = number * LEAF;
        let node = dispatch!(detected_level(), simd => of_triangles(simd, &self.leaves[number]));
        let bounds = probe.bounds(&node);
        let mut left = (1u32 << (self.order.len() - first).min(LEAF)) - 1;
        let mut limit = limit;
        while let Some(lane) = smallest(&bounds, &mut left, limit) {
            limit = leaf(self.triangle((first + lane) as u32));
        }
        limit
    }
}

/// Takes the lane of the smallest bound out of `left`; `None` where all that are left are beyond the limit.
#[inline(always)]
fn smallest(bounds: &[f32; FAN], left: &mut u32, limit: f32) -> Option<usize> {
    let mut best: Option<usize> = None;
    let mut rest = *left;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        if bounds[lane] > limit {
            *left &= !(1 << lane);
        } else if best.is_none_or(|b| bounds[lane] < bounds[b]) {
            best = Some(lane);
        }
    }
    if let Some(lane) = best {
        *left &= !(1 << lane);
    }
    best
}

/// The triangles of a leaf as if they were children of a node.
#[inline(always)]
fn of_triangles<S: Simd>(simd: S, leaf: &Leaf) -> Node {
    let [p, q, r] = load_corners(simd, &leaf.corner);
    let n = q.minus(p).cross(r.minus(p));
    let length = n.dot(n).max(1e-30).sqrt();
    let n = n.times(W8::splat(simd, 0.999_999) / length);
    let (hp, hq, hr) = (n.dot(p), n.dot(q), n.dot(r));
    let low = V3(p.0.min(q.0).min(r.0), p.1.min(q.1).min(r.1), p.2.min(q.2).min(r.2));
    let high = V3(p.0.max(q.0).max(r.0), p.1.max(q.1).max(r.1), p.2.max(q.2).max(r.2));
    let mut node = Node::EMPTY;
    let middle = W8::splat(simd, 0.5);
    let (center, half) = (low.plus(high).times(middle), high.minus(low).times(middle));
    for (to, from) in [(&mut node.center, center), (&mut node.half, half), (&mut node.normal, n)] {
        from.0.store_slice(&mut to[0][..LEAF]);
        from.1.store_slice(&mut to[1][..LEAF]);
        from.2.store_slice(&mut to[2][..LEAF]);
    }
    hp.min(hq).min(hr).store_slice(&mut node.low[..LEAF]);
    hp.max(hq).max(hr).store_slice(&mut node.high[..LEAF]);
    node
}

/// Distance from a box in its own frame.
pub(crate) struct Box {
    /// Middle in the mesh's frame.
    center: [f32; 3],
    /// Rows: the box's axes in the mesh's frame.
    axes: [[f32; 3]; 3],
    half: [f32; 3],
    /// Half extents of the box around it, along the mesh's axes.
    around: [f32; 3],
    /// No bound is off by more.
    doubt: f32,
}

impl Box {
    /// `bounds` in the frame that `in_mesh` places, metres.
    pub fn new(tree: &Tree, bounds: &Aabb, in_mesh: &Pose) -> Self {
        let unit = tree.frame.unit;
        let middle = tree.frame.to_units(in_mesh.transform_point(bounds.center()));
        let half = bounds.extent() * (0.5 / unit);
        let axes = [in_mesh.rotation.x_axis(), in_mesh.rotation.y_axis(), in_mesh.rotation.z_axis()];
        let around = axes[0].abs() * half.x + axes[1].abs() * half.y + axes[2].abs() * half.z;
        let extent = 1.0 + middle.abs().max_element() + half.x + half.y + half.z;
        Self {
            center: narrow(middle),
            axes: [narrow(axes[0]), narrow(axes[1]), narrow(axes[2])],
            half: narrow(half),
            around: narrow(around),
            doubt: (extent * DOUBT) as f32,
        }
    }

    /// A length in metres as a limit for this probe.
    pub fn limit(tree: &Tree, metres: f64) -> f32 {
        (metres * tree.frame.inverse * (1.0 + 1e-6)) as f32
    }
}

/// 2⁻¹⁷ per unit of extent, as for pairs of meshes.
const DOUBT: f64 = 1.0 / 131_072.0;

impl Probe for Box {
    fn bounds(&self, node: &Node) -> [f32; FAN] {
        dispatch!(detected_level(), simd => stored(self.lanes(simd, node)))
    }
}

impl Box {
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let zero = W16::splat(simd, 0.0);
        let c = load16(simd, &node.center).minus(splat16(simd, self.center));
        let h = load16(simd, &node.half);
        let [a, b, d] = self.around;
        let in_mesh =
            V3((c.0.abs() - (h.0 + a)).max(zero), (c.1.abs() - (h.1 + b)).max(zero), (c.2.abs() - (h.2 + d)).max(zero));
        let own = V3(
            along(simd, c, h, self.axes[0], self.half[0]).max(zero),
            along(simd, c, h, self.axes[1], self.half[1]).max(zero),
            along(simd, c, h, self.axes[2], self.half[2]).max(zero),
        );
        let slab = self.slab(simd, node);
        in_mesh.dot(in_mesh).max(own.dot(own)).sqrt().max(slab) - self.doubt
    }
}

impl Box {
    /// Gap along each child's own direction.
    #[inline(always)]
    fn slab<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let n = load16(simd, &node.normal);
        let p = n.dot(splat16(simd, self.center));
        let spread = V3(
            n.dot(splat16(simd, self.axes[0])),
            n.dot(splat16(simd, self.axes[1])),
            n.dot(splat16(simd, self.axes[2])),
        );
        let reach = abs16(spread).dot(splat16(simd, self.half));
        let (low, high) = (W16::load_array_ref(simd, &node.low), W16::load_array_ref(simd, &node.high));
        (p - high).max(low - p) - reach
    }
}

/// Gap of boxes and an interval along an axis.
#[inline(always)]
fn along<S: Simd>(simd: S, c: V3<W16<S>>, h: V3<W16<S>>, axis: [f32; 3], half: f32) -> W16<S> {
    let [x, y, z] = axis;
    c.dot(splat16(simd, axis)).abs() - (h.dot(splat16(simd, [x.abs(), y.abs(), z.abs()])) + half)
}

/// Least height along a direction.
pub(crate) struct Height {
    up: [f32; 3],
}

impl Height {
    /// `up` is a unit vector in the mesh's frame.
    pub fn new(up: Vec3) -> Self {
        Self { up: narrow(up) }
    }

    /// A height of a point of the mesh as a limit for this probe.
    pub fn limit(tree: &Tree, up: Vec3, p: Vec3) -> f32 {
        (tree.frame.to_units(p).dot(up) + 2.0 * DOUBT) as f32
    }
}

impl Probe for Height {
    fn bounds(&self, node: &Node) -> [f32; FAN] {
        dispatch!(detected_level(), simd => stored(self.lanes(simd, node)))
    }
}

impl Height {
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let [x, y, z] = self.up;
        let reach = load16(simd, &node.half).dot(splat16(simd, [x.abs(), y.abs(), z.abs()]));
        load16(simd, &node.center).dot(splat16(simd, self.up)) - reach
    }
}

/// A ray: boxes that it passes are below 0, others above.
pub(crate) struct Ray {
    from: [f32; 3],
    inverse: [f32; 3],
}

impl Ray {
    /// From a point of the mesh's box along a direction without a zero among its coordinates.
    pub fn new(tree: &Tree, from: Vec3, direction: Vec3) -> Self {
        let inverse = Vec3::new(1.0 / direction.x, 1.0 / direction.y, 1.0 / direction.z);
        Self { from: narrow(tree.frame.to_units(from)), inverse: narrow(inverse) }
    }
}

impl Probe for Ray {
    fn bounds(&self, node: &Node) -> [f32; FAN] {
        dispatch!(detected_level(), simd => stored(self.lanes(simd, node)))
    }
}

impl Ray {
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let c = load16(simd, &node.center).minus(splat16(simd, self.from));
        let h = load16(simd, &node.half).plus(splat16(simd, [(8.0 * DOUBT) as f32; 3]));
        let [x, y, z] = self.inverse;
        let (near, far) = (c.minus(h), c.plus(h));
        let (nx, fx) = ((near.0 * x).min(far.0 * x), (near.0 * x).max(far.0 * x));
        let (ny, fy) = ((near.1 * y).min(far.1 * y), (near.1 * y).max(far.1 * y));
        let (nz, fz) = ((near.2 * z).min(far.2 * z), (near.2 * z).max(far.2 * z));
        let enters = nx.max(ny).max(nz).max(0.0);
        // Inflated by far more than these few roundings are worth.
        enters - fx.min(fy).min(fz)
    }
}

#[inline(always)]
fn stored<S: Simd>(x: W16<S>) -> [f32; FAN] {
    let mut out = [0.0; FAN];
    x.store_slice(&mut out);
    out
}

#[inline]
fn narrow(v: Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
