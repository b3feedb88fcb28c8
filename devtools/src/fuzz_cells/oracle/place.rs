//! Where a region is, and how far it can come between two instants.

use elbowroom_cell::{Cell, Encoder, Follow, Travel};
use elbowroom_monitor::{Guards, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::TOLERANCE_M;
use super::frame::Frame;
use super::solid::OracleSolid;

/// A region as the oracle knows it.
#[derive(Debug)]
pub struct Place {
    /// Taken back by the tolerance.
    pub solid: OracleSolid,
    pub guards: Guards,
    pub robots: Vec<usize>,
    pub kind: RegionKind,
    /// In the world, or in what carries it.
    at: Frame,
    carrier: Carrier,
    /// For containment: the shape itself.
    shape: Shape,
}

#[derive(Debug)]
enum Carrier {
    Nothing,
    Belt(Encoder),
    Robot { robot: usize, link: usize, in_link: Frame, lever_arms: Vec<f64> },
}

impl Place {
    /// # Errors
    /// Where the region follows what the oracle does not know.
    pub fn new(cell: &Cell, region: usize, arms: &[Arm]) -> Result<Self, String> {
        let r = &cell.regions[region];
        let at = Frame::of(&r.region.anchor).then(&Frame::of(&r.region.shape_in_anchor));
        let solid = OracleSolid::eroded(&r.region.shape, TOLERANCE_M);
        let carrier = match &r.follow {
            None => Carrier::Nothing,
            Some(Follow::Object(_) | Follow::Poses(_)) => {
                let what = "follows an object or a file of poses: the oracle knows belts and robots only";
                return Err(format!("region {} {what}", r.region.name));
            }
            Some(Follow::Encoder(e)) => Carrier::Belt(cell.encoders[*e].clone()),
            Some(Follow::Robot { robot, link, in_link }) => {
                let in_link = Frame::of(in_link);
                let radius = in_link.then(&at).at.length() + solid.reach_from(Vec3::ZERO);
                Carrier::Robot {
                    robot: robot.0,
                    link: link.0,
                    in_link,
                    lever_arms: arms[robot.0].lever_arms(link.0, radius),
                }
            }
        };
        Ok(Self {
            solid,
            guards: r.region.guards,
            robots: r.robots.iter().map(|robot| robot.0).collect(),
            kind: r.region.kind,
            at,
            carrier,
            shape: r.region.shape.clone(),
        })
    }

    /// Distance (m) from another region, neither of which moves; 0 where one does.
    pub fn distance(&self, other: &Self) -> f64 {
        let is_fixed = [self, other].iter().all(|p| matches!(p.carrier, Carrier::Nothing));
        if is_fixed { self.solid.distance(&self.at, &other.solid, &other.at, f64::INFINITY).lower } else { 0.0 }
    }

    pub fn is_carried(&self) -> bool {
        matches!(self.carrier, Carrier::Robot { .. })
    }

    /// True where its belt starts, stops or changes its speed between two times.
    pub fn changes_speed(&self, from_s: f64, to_s: f64) -> bool {
        let Carrier::Belt(encoder) = &self.carrier else { return false };
        let within = |t: f64| from_s <= t && t <= to_s;
        match &encoder.travel {
            Travel::Constant { start_s, end_s, .. } => (*start_s > 0.0 && within(*start_s)) || within(*end_s),
            Travel::Table(rows) => rows.iter().any(|r| within(r.0)),
        }
    }

    /// Travel of its belt at a time (m), and whether it has begun again at 0 how often.
    pub fn travel_at(&self, t_s: f64) -> (f64, f64) {
        let Carrier::Belt(encoder) = &self.carrier else { return (0.0, 0.0) };
        let travel = match &encoder.travel {
            Travel::Constant { at_m, speed, start_s, end_s } => at_m + speed * (t_s.min(*end_s) - start_s).max(0.0),
            Travel::Table(rows) => interpolated(rows, t_s),
        };
        encoder.wrap_m.map_or((travel, 0.0), |wrap| (travel.rem_euclid(wrap), (travel / wrap).floor()))
    }

    /// Its frame in the world at this travel of the belt, with all robots' links in the world.
    pub fn at(&self, travel: f64, frames: &[Vec<Frame>]) -> Frame {
        match &self.carrier {
            Carrier::Nothing => self.at,
            Carrier::Belt(encoder) => Frame::shift(encoder.direction * travel).then(&self.at),
            Carrier::Robot { robot, link, in_link, .. } => frames[*robot][*link].then(in_link).then(&self.at),
        }
    }

    /// The robot that carries it, and how far (m) any of its points goes while that one's joints go from one place to the
    /// other.
    pub fn carried(&self, from: &[Vec<f64>], to: &[Vec<f64>]) -> f64 {
        let Carrier::Robot { robot, lever_arms, .. } = &self.carrier else { return 0.0 };
        lever_arms.iter().zip(&from[*robot]).zip(&to[*robot]).map(|((l, a), b)| l * (b - a).abs()).sum()
    }

    /// True where a point is inside; for meshes by the winding number.
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

fn interpolated(rows: &[(f64, f64)], t_s: f64) -> f64 {
    let after = rows.partition_point(|r| r.0 <= t_s);
    match (after.checked_sub(1).map(|i| rows[i]), rows.get(after)) {
        (Some((t0, a)), Some((t1, b))) => a + (b - a) * (t_s - t0) / (t1 - t0),
        (Some((_, a)), None) => a,
        (None, Some((_, b))) => *b,
        (None, None) => 0.0,
    }
}
