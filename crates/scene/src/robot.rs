//! A robot: a chain whose links have solids.

use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// One solid of a link.
#[derive(Debug, Clone)]
pub struct Body {
    /// The solid's name in its file, or the mesh file's stem; may repeat.
    pub name: String,
    /// The solid.
    pub shape: Shape,
    /// Where the shape's frame stands in the link's.
    pub in_link: Pose,
}

/// A chain with the solids of its links.
///
/// `bodies[i]` and `visuals[i]` belong to link `i` of the chain.
#[derive(Debug, Clone)]
pub struct Robot {
    /// The joints and links.
    pub chain: Chain,
    /// Solids that count for collision, per link.
    pub bodies: Vec<Vec<Body>>,
    /// Solids that are only looked at, per link; where a link has none, its bodies are shown.
    pub visuals: Vec<Vec<Body>>,
    /// Link pairs that the SRDF disables, each with its reason.
    pub disabled_pairs: Vec<(LinkId, LinkId, String)>,
}

impl Robot {
    /// A robot with no solids yet.
    pub fn new(chain: Chain) -> Self {
        let links = chain.links().len();
        Self { chain, bodies: vec![Vec::new(); links], visuals: vec![Vec::new(); links], disabled_pairs: Vec::new() }
    }
}
