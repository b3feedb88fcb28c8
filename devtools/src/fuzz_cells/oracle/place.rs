//! Places of regions.

use elbowroom_cell::Cell;
use elbowroom_monitor::{Guards, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_sim::Recording;
use elbowroom_spatial::Vec3;

use super::carrier::Carrier;
use super::findings::TOLERANCE_M;
use super::frame::Frame;
use super::solid::OracleSolid;

/// A region in the form that the oracle uses.
#[derive(Debug)]
pub struct Place {
    /// Its solid, shrunk by the tolerance.
    pub solid: OracleSolid,
    pub guards: Guards,
    pub robots: Vec<usize>,
    pub kind: RegionKind,
    /// Its frame in the world, or in the frame of its carrier.
    at: Frame,
    pub carrier: Carrier,
    /// Largest distance of its points from the origin of its carrier, m; infinite for a half-space.
    pub radius_m: f64,
    /// The shape itself, for containment.
    shape: Shape,
}

impl Place {
    /// Creates the place of a region. Without a recording objects are at their start.
    pub fn new(cell: &Cell, region: usize, recording: Option<&Recording>) -> Self {
        let r = &cell.regions[region];
        let at = Frame::of(&r.region.anchor).then(&Frame::of(&r.region.shape_in_anchor));
        let solid = OracleSolid::eroded(&r.region.shape, TOLERANCE_M);
        Self {
            radius_m: at.at.length() + solid.reach_from(Vec3::ZERO),
            solid,
            guards: r.region.guards,
            robots: r.robots.iter().map(|robot| robot.0).collect(),
            kind: r.region.kind,
            at,
            carrier: Carrier::new(cell, r, recording),
            shape: r.region.shape.clone(),
        }
    }

    /// Returns the distance (m) from another region if both are fixed; 0 if one moves.
    pub fn distance(&self, other: &Self) -> f64 {
        if self.is_fixed() && other.is_fixed() {
            self.solid.distance(&self.at, &other.solid, &other.at, f64::INFINITY).lower
        } else {
            0.0
        }
    }

    pub fn is_fixed(&self) -> bool {
        matches!(self.carrier, Carrier::Nothing)
    }

    /// Returns its frame in the world at a time; `frames` are the frames of all robots' links in the world.
    pub fn at(&self, t_s: f64, frames: &[Vec<Frame>]) -> Frame {
        self.carrier.at(t_s, frames).then(&self.at)
    }

    /// Whether a point is inside; for meshes by the winding number.
    pub fn contains(&self, at: &Frame, point: Vec3) -> bool {
        let p = at.vector_back(point - at.at);
        match &self.shape {
            Shape::Mesh(m) => {
                let v = m.vertices();
                let turned: f64 = m.triangles().iter().map(|t| solid_angle(t.map(|i| v[i as usize] - p))).sum();
                turned.abs() > 2.0 * std::f64::consts::PI
            }
            _ => {
                self.solid.distance(&Frame::IDENTITY, &OracleSolid::point(), &Frame::shift(p), f64::INFINITY).upper
                    <= 0.0
            }
        }
    }
}

/// Signed solid angle of a triangle seen from the origin (van Oosterom and Strackee, 1983).
fn solid_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let over = a.dot(b.cross(c));
    let under = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * over.atan2(under)
}
