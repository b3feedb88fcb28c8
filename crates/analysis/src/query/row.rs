//! One result row, and its CSV and JSON form.

use elbowroom_cell::QueryModel;
use elbowroom_robot::GeometryId;
use elbowroom_scene::Level;
use elbowroom_spatial::Vec3;
use serde::Serialize;

/// The result for one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QueryRow {
    /// Index of the state, from 0.
    pub index: usize,
    /// True on contact; with a tolerance, at a distance of at most that.
    pub collides: bool,
    /// Distance in metres, where it was queried or is known: 0 on contact.
    pub distance_m: Option<f64>,
    /// The pair in contact, or the nearest pair.
    pub pair: Option<(GeometryId, GeometryId)>,
    /// Witness points on the surfaces of the pair, in the world.
    pub witness: Option<(Vec3, Vec3)>,
    /// The finest resolution level used.
    pub level: Level,
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
    /// `L1`, `L2`, `capsule`, `hull` or `L3`.
    pub level: String,
}

impl QueryRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level";

    /// The record of a row, with names.
    pub fn of(row: &QueryRow, model: &QueryModel) -> Self {
        let number = |v: f64| v.is_finite().then_some(v);
        let on =
            |side: fn(&(Vec3, Vec3)) -> Vec3, axis: usize| row.witness.as_ref().and_then(|w| number(side(w)[axis]));
        let (a, b) = (|w: &(Vec3, Vec3)| w.0, |w: &(Vec3, Vec3)| w.1);
        Self {
            index: row.index,
            collides: u8::from(row.collides),
            distance_m: row.distance_m.and_then(number),
            a: row.pair.map(|p| model.geometry_name(p.0)),
            b: row.pair.map(|p| model.geometry_name(p.1)),
            ax: on(a, 0),
            ay: on(a, 1),
            az: on(a, 2),
            bx: on(b, 0),
            by: on(b, 1),
            bz: on(b, 2),
            level: row.level.to_string(),
        }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        // Debug format, so that 6e-17 stays short.
        let number = |v: Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let name = |n: &Option<String>| n.as_deref().map_or_else(String::new, quoted);
        let [ax, ay, az] = [self.ax, self.ay, self.az].map(number);
        let [bx, by, bz] = [self.bx, self.by, self.bz].map(number);
        let (distance, a, b) = (number(self.distance_m), name(&self.a), name(&self.b));
        format!("{},{},{distance},{a},{b},{ax},{ay},{az},{bx},{by},{bz},{}", self.index, self.collides, self.level)
    }
}

/// Quoted where necessary (RFC 4180).
fn quoted(name: &str) -> String {
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
