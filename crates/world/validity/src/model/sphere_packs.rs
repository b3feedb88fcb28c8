//! The sphere trees of links for one configuration at a time: lanes are spheres, up to sixteen children of a node.

use super::body::{InnerSphere, SphereNode};
use crate::lanes::{LANES, PointRow, Row};

/// Up to sixteen spheres of one link.
#[derive(Debug, Clone)]
pub(crate) struct SpherePack {
    /// Centres in the frame of the link's joint, m.
    pub centres: PointRow,
    /// Radii, rounding errors included, m.
    pub radii: Row,
    /// Index of the frame that moves the spheres.
    pub frame: u32,
    /// Per sphere: the pack of the spheres below it; `None` for leaves.
    pub below: [Option<u32>; LANES],
    /// One bit per sphere.
    pub used: u32,
    /// One bit per leaf.
    pub leaves: u32,
}

/// A single sphere outside packs: the root of a link's tree, or a node of the broad phase.
#[derive(Debug, Clone)]
pub(crate) struct RootSphere {
    /// Index of the covered link.
    pub body: u32,
    pub centre: [f32; 3],
    pub radius: f32,
    pub frame: u32,
    /// The pack of the spheres below it; for a leaf, the pack of the leaf itself.
    pub pack: u32,
    pub is_leaf: bool,
}

/// The packs of all links.
#[derive(Debug, Clone, Default)]
pub(crate) struct SpherePacks {
    pub packs: Vec<SpherePack>,
    /// Per covered link: its root; `None` if it has no spheres.
    pub links: Vec<Option<RootSphere>>,
    /// The broad-phase nodes of links that joints move, the farthest from the base first.
    pub broad_phase: Vec<RootSphere>,
    /// Per covered link: the packs of its inner spheres.
    pub inner: Vec<std::ops::Range<usize>>,
}

impl SpherePacks {
    /// Appends a link, moved by `frame`.
    pub fn push_link(
        &mut self,
        nodes: &[SphereNode],
        tree: &std::ops::Range<u32>,
        broad_phase: &[u32],
        inner: &[InnerSphere],
        frame: usize,
    ) {
        let body = self.links.len() as u32;
        let root = (!tree.is_empty()).then(|| self.root(nodes, tree.start, body));
        self.links.push(root);
        if frame != 0 {
            let roots: Vec<_> = broad_phase.iter().map(|&node| self.root(nodes, node, body)).collect();
            self.broad_phase.splice(0..0, roots);
        }
        let first = self.packs.len();
        for part in inner.chunks(LANES) {
            let spheres = part.iter().map(|s| (s.centre, s.radius, None));
            self.packs.push(SpherePack::new(spheres, frame as u32));
        }
        self.inner.push(first..self.packs.len());
    }

    fn root(&mut self, nodes: &[SphereNode], node: u32, body: u32) -> RootSphere {
        let SphereNode { centre, radius, frame, .. } = nodes[node as usize];
        let is_leaf = is_leaf(nodes, node);
        let members = if is_leaf { vec![node] } else { members(nodes, node) };
        RootSphere { body, centre, radius, frame, pack: self.push(nodes, &members), is_leaf }
    }

    /// Appends a pack of nodes, and the packs below them.
    fn push(&mut self, nodes: &[SphereNode], members_of_pack: &[u32]) -> u32 {
        let mut spheres = Vec::new();
        for &node in members_of_pack {
            let below = (!is_leaf(nodes, node)).then(|| self.push(nodes, &members(nodes, node)));
            let SphereNode { centre, radius, .. } = nodes[node as usize];
            spheres.push((centre, radius, below));
        }
        let frame = members_of_pack.first().map_or(0, |&node| nodes[node as usize].frame);
        self.packs.push(SpherePack::new(spheres.into_iter(), frame));
        (self.packs.len() - 1) as u32
    }
}

impl SpherePack {
    fn new(spheres: impl Iterator<Item = ([f32; 3], f32, Option<u32>)>, frame: u32) -> Self {
        let (centres, radii) = (PointRow::ZERO, Row::ZERO);
        let mut pack = Self { centres, radii, frame, below: [None; LANES], used: 0, leaves: 0 };
        for (lane, (centre, radius, below)) in spheres.enumerate() {
            (0..3).for_each(|k| pack.centres.0[k].0[lane] = centre[k]);
            pack.radii.0[lane] = radius;
            pack.below[lane] = below;
            pack.used |= 1 << lane;
            pack.leaves |= u32::from(below.is_none()) << lane;
        }
        pack
    }
}

fn is_leaf(nodes: &[SphereNode], node: u32) -> bool {
    nodes[node as usize].end == node + 1
}

fn children(nodes: &[SphereNode], node: u32) -> Vec<u32> {
    let mut children = Vec::new();
    let mut child = node + 1;
    while child < nodes[node as usize].end {
        children.push(child);
        child = nodes[child as usize].end;
    }
    children
}

/// Up to sixteen nodes that together enclose all leaves below a node. The largest nodes are divided first.
fn members(nodes: &[SphereNode], node: u32) -> Vec<u32> {
    let mut members = children(nodes, node);
    loop {
        let inner = (0..members.len()).filter(|&i| !is_leaf(nodes, members[i]));
        let radius = |i: usize| nodes[members[i] as usize].radius;
        let Some(largest) = inner.max_by(|&i, &j| radius(i).total_cmp(&radius(j))) else { return members };
        let parts = children(nodes, members[largest]);
        if members.len() + parts.len() > LANES + 1 {
            return members;
        }
        members.splice(largest..=largest, parts);
    }
}
