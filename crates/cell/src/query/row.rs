//! One answer, and how it is written.

use elbowroom_scene::{Level, Member};
use elbowroom_spatial::Vec3;
use serde::Serialize;

use super::Subject;

/// The answer about one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Of the state, from 0.
    pub index: usize,
    /// Contact; with a tolerance, a distance of at most that.
    pub collides: bool,
    /// Metres, where it was asked for or is known: 0 on contact.
    pub distance_m: Option<f64>,
    /// The pair in contact, or the nearest.
    pub pair: Option<(Member, Member)>,
    /// Points on the surfaces of the pair, in the world.
    pub witness: Option<(Vec3, Vec3)>,
    /// The finest level that was needed.
    pub level: Level,
}

/// A row as it stands in CSV and JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Written {
    /// Of the state, from 0.
    pub index: usize,
    /// 0 or 1.
    pub collides: u8,
    /// Metres.
    pub distance_m: Option<f64>,
    /// One of the pair.
    pub a: Option<String>,
    /// The other.
    pub b: Option<String>,
    /// Point on `a`, world, m.
    pub ax: Option<f64>,
    /// Its y.
    pub ay: Option<f64>,
    /// Its z.
    pub az: Option<f64>,
    /// Point on `b`, world, m.
    pub bx: Option<f64>,
    /// Its y.
    pub by: Option<f64>,
    /// Its z.
    pub bz: Option<f64>,
    /// `L1`, `L2`, `capsule`, `hull` or `L3`.
    pub level: String,
}

impl Written {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level";

    /// A row with names.
    pub fn of(row: &Row, subject: &Subject) -> Self {
        let number = |v: f64| v.is_finite().then_some(v);
        let on =
            |side: fn(&(Vec3, Vec3)) -> Vec3, axis: usize| row.witness.as_ref().and_then(|w| number(side(w)[axis]));
        let (a, b) = (|w: &(Vec3, Vec3)| w.0, |w: &(Vec3, Vec3)| w.1);
        Self {
            index: row.index,
            collides: u8::from(row.collides),
            distance_m: row.distance_m.and_then(number),
            a: row.pair.map(|p| subject.member_name(p.0)),
            b: row.pair.map(|p| subject.member_name(p.1)),
            ax: on(a, 0),
            ay: on(a, 1),
            az: on(a, 2),
            bx: on(b, 0),
            by: on(b, 1),
            bz: on(b, 2),
            level: row.level.to_string(),
        }
    }

    /// The line of a CSV file, without its end; what is not known is empty.
    pub fn csv(&self) -> String {
        // As Debug, so that 6e-17 does not become twenty digits.
        let number = |v: Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let name = |n: &Option<String>| n.as_deref().map_or_else(String::new, quoted);
        let [ax, ay, az] = [self.ax, self.ay, self.az].map(number);
        let [bx, by, bz] = [self.bx, self.by, self.bz].map(number);
        let (distance, a, b) = (number(self.distance_m), name(&self.a), name(&self.b));
        format!("{},{},{distance},{a},{b},{ax},{ay},{az},{bx},{by},{bz},{}", self.index, self.collides, self.level)
    }
}

/// In quotation marks where it would break the line apart (RFC 4180).
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
