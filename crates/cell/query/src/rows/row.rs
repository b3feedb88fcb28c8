//! One result row, and its CSV and JSON form.

use elbowroom_cell::QueryModel;
use elbowroom_robot::GeometryId;
use elbowroom_scene::{Level, SurfaceContact};
use elbowroom_spatial::Vec3;
use serde::Serialize;

/// The result for one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QueryRow {
    /// Index of the state, from 0.
    pub index: usize,
    /// True on contact; with a tolerance, if the distance is at most the tolerance.
    pub collides: bool,
    /// Distance in metres, if it was queried or is known; 0 on contact.
    pub distance_m: Option<f64>,
    /// The pair in contact, or the nearest pair.
    pub pair: Option<(GeometryId, GeometryId)>,
    /// Witness points on the surfaces of the pair, in the world.
    pub witness: Option<(Vec3, Vec3)>,
    /// With [`QueryKind::Point`](crate::QueryKind::Point) the witness point of the first in its own frame, m.
    pub point_in_a: Option<Vec3>,
    /// The finest resolution level used.
    pub level: Level,
}

/// The columns of a pair; without one all are empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PairColumns {
    /// First of the pair.
    pub a: Option<String>,
    /// Second of the pair.
    pub b: Option<String>,
    /// Witness point on `a`, world, m.
    pub ax: Option<f64>,
    /// y of that point.
    pub ay: Option<f64>,
    /// z of that point.
    pub az: Option<f64>,
    /// Witness point on `b`, world, m.
    pub bx: Option<f64>,
    /// y of that point.
    pub by: Option<f64>,
    /// z of that point.
    pub bz: Option<f64>,
}

impl PairColumns {
    pub(super) fn of(
        pair: Option<(GeometryId, GeometryId)>,
        witness: Option<(Vec3, Vec3)>,
        model: &QueryModel,
    ) -> Self {
        let point = |side: fn((Vec3, Vec3)) -> Vec3| {
            let at = witness.map(side);
            [0, 1, 2].map(|axis| at.map(|at| at[axis]).filter(|v| v.is_finite()))
        };
        let ([ax, ay, az], [bx, by, bz]) = (point(|w| w.0), point(|w| w.1));
        let [a, b] = [pair.map(|p| p.0), pair.map(|p| p.1)].map(|id| id.map(|id| model.geometry_name(id)));
        Self { a, b, ax, ay, az, bx, by, bz }
    }

    /// The columns in order; unknown values are empty.
    pub(super) fn csv(&self) -> String {
        // Debug format, so that 6e-17 stays short.
        let number = |v: &Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let name = |n: &Option<String>| n.as_deref().map_or_else(String::new, quoted);
        let points = [&self.ax, &self.ay, &self.az, &self.bx, &self.by, &self.bz].map(number).join(",");
        format!("{},{},{points}", name(&self.a), name(&self.b))
    }
}

/// A row in CSV and JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QueryRecord {
    /// Index of the state, from 0.
    pub index: usize,
    /// 0 or 1.
    pub collides: u8,
    /// Distance in metres.
    pub distance_m: Option<f64>,
    /// The pair, and its witness points.
    #[serde(flatten)]
    pub pair: PairColumns,
    /// Of a collision point: its place in the frame of `a`, m; only in JSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point_in_a_m: Option<[f64; 3]>,
    /// `L1`, `L2`, `capsule`, `hull` or `L3`.
    pub level: String,
}

impl QueryRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level";

    /// The record of a row, with names.
    pub fn of(row: &QueryRow, model: &QueryModel) -> Self {
        let number = |v: f64| v.is_finite().then_some(v);
        Self {
            index: row.index,
            collides: u8::from(row.collides),
            distance_m: row.distance_m.and_then(number),
            pair: PairColumns::of(row.pair, row.witness, model),
            point_in_a_m: row.point_in_a.filter(|p| p.is_finite()).map(Vec3::to_array),
            level: row.level.to_string(),
        }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        let distance = self.distance_m.map_or_else(String::new, |v| format!("{v:?}"));
        format!("{},{},{distance},{},{}", self.index, self.collides, self.pair.csv(), self.level)
    }
}

/// Two triangles that touch in a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRow {
    /// Index of the state, from 0.
    pub index: usize,
    /// The pair in contact.
    pub pair: (GeometryId, GeometryId),
    /// Its colliders and triangles, and where they touch.
    pub contact: SurfaceContact,
}

/// A contact in CSV and JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactRecord {
    /// Index of the state, from 0.
    pub index: usize,
    /// First of the pair.
    pub a: String,
    /// Second of the pair.
    pub b: String,
    /// Index of the collider of `a`, from 0.
    pub collider_a: usize,
    /// Index of the collider of `b`.
    pub collider_b: usize,
    /// Index of the triangle of that collider, from 0; `None` if the colliders are in contact without touching
    /// triangles.
    pub triangle_a: Option<u32>,
    /// Index of the triangle of the other collider.
    pub triangle_b: Option<u32>,
    /// One end of the segment in which the triangles cross, world, m.
    pub px: Option<f64>,
    /// y of that point.
    pub py: Option<f64>,
    /// z of that point.
    pub pz: Option<f64>,
    /// The other end.
    pub qx: Option<f64>,
    /// y of that point.
    pub qy: Option<f64>,
    /// z of that point.
    pub qz: Option<f64>,
}

impl ContactRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,a,b,collider_a,collider_b,triangle_a,triangle_b,px,py,pz,qx,qy,qz";

    /// The record of a row, with names.
    pub fn of(row: &ContactRow, model: &QueryModel) -> Self {
        let [p, q] = row.contact.points;
        let [px, py, pz, qx, qy, qz] = [p.x, p.y, p.z, q.x, q.y, q.z].map(|v| v.is_finite().then_some(v));
        let [collider_a, collider_b] = row.contact.colliders;
        let triangle = |side: usize| row.contact.triangles.map(|t| t[side]);
        let (a, b) = (model.geometry_name(row.pair.0), model.geometry_name(row.pair.1));
        let (triangle_a, triangle_b) = (triangle(0), triangle(1));
        Self { index: row.index, a, b, collider_a, collider_b, triangle_a, triangle_b, px, py, pz, qx, qy, qz }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        let number = |v: &Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let triangle = |v: Option<u32>| v.map_or_else(String::new, |v| v.to_string());
        let points = [&self.px, &self.py, &self.pz, &self.qx, &self.qy, &self.qz].map(number).join(",");
        let (a, b) = (quoted(&self.a), quoted(&self.b));
        let [x, y] = [self.triangle_a, self.triangle_b].map(triangle);
        format!("{},{a},{b},{},{},{x},{y},{points}", self.index, self.collider_a, self.collider_b)
    }
}

/// Quoted where necessary (RFC 4180).
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_would_break_a_line_are_quoted() {
        assert_eq!(quoted("arm/link_1"), "arm/link_1");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
