//! A chain whose links have collision and visual shapes.

use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

/// One shape of a link.
#[derive(Debug, Clone)]
pub struct Collider {
    /// Name in the model file, or the stem of the mesh file. Need not be unique.
    pub name: String,
    /// The shape, in its own frame.
    pub shape: Shape,
    /// Pose of the shape's frame in the frame of the link.
    pub in_link: Pose,
}

/// A chain with the shapes of its links.
///
/// `colliders[i]` and `visuals[i]` belong to link `i` of the chain.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Joints and links.
    pub chain: Chain,
    /// Collision geometry per link.
    pub colliders: Vec<Vec<Collider>>,
    /// Geometry for display only, per link. A link without visuals is drawn with its colliders.
    pub visuals: Vec<Vec<Collider>>,
    /// Link pairs that the SRDF disables, each with the SRDF's reason.
    pub disabled_pairs: Vec<(LinkId, LinkId, String)>,
}

impl Robot {
    /// A robot without colliders, visuals and disabled pairs.
    pub fn new(chain: Chain) -> Self {
        let links = chain.links().len();
        Self { chain, colliders: vec![Vec::new(); links], visuals: vec![Vec::new(); links], disabled_pairs: Vec::new() }
    }

    /// The links that have a collider, in the order of the chain.
    pub fn links_with_colliders(&self) -> impl Iterator<Item = LinkId> + '_ {
        (0..self.colliders.len()).filter(|l| !self.colliders[*l].is_empty()).map(LinkId)
    }

    /// Upper bound (m) of the distance between the link's origin and any point of its colliders; 0 without colliders.
    /// Infinite or NaN if a collider is unbounded.
    pub fn link_radius(&self, link: LinkId) -> f64 {
        self.colliders[link.0].iter().map(|c| c.shape.aabb(&c.in_link).max_distance(Vec3::ZERO)).fold(0.0, f64::max)
    }
}
