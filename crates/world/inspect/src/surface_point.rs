//! The chain that ends in a point of a surface (Reichenbach and Kovačić, 2003): table, Jacobian, reach.

use std::fmt;

use elbowroom_kinematics::surface_ik::{PointChain, SurfaceIkOptions};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId};
use elbowroom_proximity::project_point;
use elbowroom_robot::{Collider, RSequence, Robot};
use elbowroom_spatial::{Pose, Vec3};
use serde::Serialize;

use crate::dh::DhConvention;
use crate::dh_tables::DhTables;
use crate::text::shortened;

/// States in which the reach is measured.
const REACH_SAMPLES: u64 = 20_000;
/// Distance from the surface above which the text names the nearest point of it, m.
const ON_SURFACE_M: f64 = 1e-4;

/// A point fixed on a link, as the end of a chain.
#[derive(Debug, Clone, Serialize)]
pub struct SurfacePoint {
    /// The link.
    pub link: String,
    /// The point in the link's frame, m.
    pub point_m: [f64; 3],
    /// The nearest point of the link's surface, in the same frame; null if the link has none.
    pub nearest_m: Option<[f64; 3]>,
    /// Outward normal there.
    pub normal: Option<[f64; 3]>,
    /// Distance from the surface, m; negative inside.
    pub off_surface_m: Option<f64>,
    /// The independent joints that move the point.
    pub moved_by: Vec<String>,
    /// The point in the root link at rest (every joint at 0 or at the limit nearest to it), m.
    pub at_rest_m: [f64; 3],
    /// Velocity of the point in the root link at rest, m/s, per rad/s or m/s of each independent joint of the chain.
    pub jacobian: Vec<[f64; 3]>,
    /// The independent joints of the chain, in the order of the columns.
    pub joints: Vec<String>,
    /// Least and largest distance of the point from the origin of the root link in 20,000 states spread over the joint
    /// ranges, m.
    pub reach_m: [f64; 2],
    /// The tables of the chain that ends in the point, with the axes of the link.
    #[serde(flatten)]
    pub dh: DhTables,
    #[serde(skip)]
    chain: PointChain,
}

impl SurfacePoint {
    /// The chain to a point of a link; the text shows tables of these conventions.
    ///
    /// # Errors
    /// A point that is not finite.
    pub(crate) fn of(robot: &Robot, link: LinkId, point: Vec3, dh: &[DhConvention]) -> Result<Self, String> {
        let chain = &robot.chain;
        let options = SurfaceIkOptions::default();
        let mut to_point = PointChain::new(chain, link, point, None, options).map_err(|e| e.to_string())?;
        let (extended, end) = extended(chain, link, point)?;
        let rest = ChainState::at_rest(chain).q;
        let mut jacobian = vec![[0.0; 3]; chain.dof()];
        to_point.jacobian(&rest, &mut jacobian);
        let nearest = nearest(&robot.colliders[link.0], point);
        let name = |joint: &JointId| chain.joints()[joint.0].name.clone();
        Ok(Self {
            link: chain.links()[link.0].clone(),
            point_m: point.to_array(),
            nearest_m: nearest.map(|(at, ..)| at.to_array()),
            normal: nearest.map(|(_, normal, _)| normal.to_array()),
            off_surface_m: nearest.map(|(.., distance)| distance),
            moved_by: to_point.joints().iter().map(name).collect(),
            at_rest_m: to_point.place(&rest).point_in_root.to_array(),
            jacobian,
            joints: chain.active_joints().iter().map(name).collect(),
            reach_m: reach(chain, &mut to_point),
            dh: DhTables::of(&extended, end, dh),
            chain: to_point,
        })
    }

    /// The point in the root link (m) at joint values (all independent joints of the chain, rad or m).
    pub fn place(&mut self, q: &[f64]) -> Vec3 {
        self.chain.place(q).point_in_root
    }
}

/// The chain with one more link, whose origin is the point.
fn extended(chain: &Chain, link: LinkId, point: Vec3) -> Result<(Chain, LinkId), String> {
    let [x, y, z] = point.to_array();
    let name = format!("{} at {x}, {y}, {z}", chain.links()[link.0]);
    let end = LinkId(chain.links().len());
    let mut links = chain.links().to_vec();
    links.push(name.clone());
    let mut joints = chain.joints().to_vec();
    joints.push(Joint {
        name,
        kind: JointKind::Fixed,
        parent: link,
        child: end,
        origin: Pose::from_translation(point),
        axis: Vec3::Z,
        limits: Limits::UNLIMITED,
        mimic: None,
    });
    let extended = Chain::new(chain.name(), links, joints).map_err(|e| e.to_string())?;
    Ok((extended, end))
}

/// The nearest point of the surface of a link, its normal, and the distance, negative inside.
fn nearest(colliders: &[Collider], point: Vec3) -> Option<(Vec3, Vec3, f64)> {
    let projected = colliders.iter().map(|c| project_point(&c.shape, &c.in_link, point));
    let nearest = projected.min_by(|a, b| a.signed_distance.abs().total_cmp(&b.signed_distance.abs()))?;
    Some((nearest.on_surface, nearest.outward, nearest.signed_distance))
}

fn reach(chain: &Chain, point: &mut PointChain) -> [f64; 2] {
    let (sequence, mut state) = (RSequence::new(chain.dof()), ChainState::new(chain));
    (0..REACH_SAMPLES).fold([f64::INFINITY, 0.0], |[least, most], index| {
        sequence.set_state(chain, &mut state, index, 0);
        let distance = point.place(&state.q).point_in_root.length();
        [distance.min(least), distance.max(most)]
    })
}

impl fmt::Display for SurfacePoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |p: [f64; 3]| p.map(|v| format!("{:.4}", (v * 1e4).round() / 1e4 + 0.0)).join(", ");
        writeln!(f, "{} at {} m", self.link, list(self.point_m))?;
        match (self.off_surface_m, self.nearest_m) {
            (Some(off), Some(nearest)) if off.abs() > ON_SURFACE_M => {
                let side = if off < 0.0 { "inside" } else { "outside" };
                writeln!(f, "  surface  the point is {:.2} mm {side}; nearest {}", 1e3 * off.abs(), list(nearest))?;
            }
            (Some(_), _) => writeln!(f, "  surface  on it")?,
            _ => writeln!(f, "  surface  the link has none")?,
        }
        let moved_by = if self.moved_by.is_empty() { "no joint".to_owned() } else { self.moved_by.join(", ") };
        writeln!(f, "  moved by {moved_by}")?;
        let [least, most] = self.reach_m;
        writeln!(
            f,
            "  at rest  {} m in the root link; in sampled states {least:.3} to {most:.3} m from its origin",
            list(self.at_rest_m)
        )?;
        write!(f, "{}", self.dh)?;
        writeln!(f, "\n{:24} {:>9} {:>9} {:>9}", "Jacobian at rest, of", "x", "y", "z")?;
        self.joints.iter().zip(&self.jacobian).try_for_each(|(joint, column)| {
            let [x, y, z] = column.map(|v| (v * 1e4).round() / 1e4 + 0.0);
            writeln!(f, "{:24} {x:>9.4} {y:>9.4} {z:>9.4}", shortened(joint, 24))
        })
    }
}
