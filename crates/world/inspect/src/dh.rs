//! Denavit-Hartenberg tables by convention: generalized, classical, modified (Craig), one row per frame.

use std::fmt;

use elbowroom_kinematics::dh::{DirectTable, GeneralizedRow, GeneralizedTable, ModifiedTable};
use elbowroom_kinematics::{Chain, LinkId};
use serde::Serialize;

use crate::text::shortened;

/// Share of all lengths of a table below which a length of the classical table counts as 0.
const PRECISION: f64 = 1e-6;

/// A convention for Denavit-Hartenberg tables.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DhConvention {
    /// `Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)` along the axes; exists for every chain.
    #[default]
    Generalized,
    /// `Rz(θ)·Tz(d)·Tx(a)·Rx(α)`; exists if every b of the generalized table is 0.
    Classical,
    /// `Rx(α)·Tx(a)·Rz(θ)·Tz(d)`, after Craig.
    Modified,
    /// The generalized rows, one per frame of the model.
    Direct,
}

/// A row of the generalized DH table.
#[derive(Debug, Clone, Serialize)]
pub struct DhRow {
    /// The joint whose value is added to θ (revolute) or d (prismatic); null in fixed and auxiliary rows.
    pub joint: Option<String>,
    /// Rotation about z, rad.
    pub theta: f64,
    /// Translation along x, m.
    pub a: f64,
    /// Translation along y, m.
    pub b: f64,
    /// Translation along z, m.
    pub d: f64,
    /// Rotation about x, rad.
    pub alpha: f64,
}

/// A row with four parameters: classical or modified.
#[derive(Debug, Clone, Serialize)]
pub struct DhRow4 {
    /// The joint whose value is added to θ (revolute) or d (prismatic); null in fixed and auxiliary rows.
    pub joint: Option<String>,
    /// Rotation about z, rad.
    pub theta: f64,
    /// Translation along x, m.
    pub a: f64,
    /// Translation along z, m.
    pub d: f64,
    /// Rotation about x, rad.
    pub alpha: f64,
}

/// A row of the table with one row per frame.
#[derive(Debug, Clone, Serialize)]
pub struct DirectRow {
    /// Name of the frame: a joint, or a link for a fixed joint.
    ///
    /// A `*` marks an auxiliary row before the frame of that name.
    pub frame: String,
    /// Parameters of the row.
    #[serde(flatten)]
    pub row: DhRow,
}

/// The classical table, or the reason for its absence.
#[derive(Debug, Clone, Serialize)]
pub struct ClassicalDh {
    /// `Rz(θ)·Tz(d)·Tx(a)·Rx(α)`, joint axes along z of the previous frame; empty if the table does not exist.
    pub rows: Vec<DhRow4>,
    /// Largest difference between the product of the rows and forward kinematics; null if the table does not exist.
    pub residual: Option<f64>,
    /// Lengths below this count as 0, m: a millionth of all lengths together.
    pub zero_below_m: f64,
    /// Rows that need b, and why; null if the table exists.
    pub why_not: Option<String>,
}

/// The modified table.
#[derive(Debug, Clone, Serialize)]
pub struct ModifiedDh {
    /// `Rx(α)·Tx(a)·Rz(θ)·Tz(d)`, joint axes along z of the next frame.
    pub rows: Vec<DhRow4>,
    /// Largest difference between the product of the rows and forward kinematics.
    pub residual: f64,
}

/// The table with one row per frame of the model.
#[derive(Debug, Clone, Serialize)]
pub struct DirectDh {
    /// `Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`, joint axes along z of the previous frame.
    pub rows: Vec<DirectRow>,
    /// Largest difference between the product of the rows and forward kinematics.
    pub residual: f64,
}

pub(super) fn generalized(table: &GeneralizedTable) -> Vec<DhRow> {
    table.rows.iter().map(row).collect()
}

fn row(row: &GeneralizedRow) -> DhRow {
    DhRow { joint: row.joint.clone(), theta: row.theta, a: row.a, b: row.b, d: row.d, alpha: row.alpha }
}

impl ClassicalDh {
    /// Lengths below a millionth of all lengths together are below the precision of most files, and count as 0.
    pub(super) fn of(exact: &GeneralizedTable, chain: &Chain, tip: LinkId) -> Self {
        let least_m = PRECISION * exact.length_m();
        let table = exact.rounded(chain, tip, least_m);
        let with_b = table.rows.iter().enumerate().filter(|(_, r)| r.b != 0.0);
        let name = |(i, r): (usize, &GeneralizedRow)| {
            let joint = r.joint.as_ref().map_or("no joint".to_owned(), |j| format!("`{j}`"));
            let why = if i + 1 == table.rows.len() {
                "x of the last frame does not meet z of the previous frame"
            } else {
                "the axes are nearly parallel, and their common normal is far away"
            };
            format!("row {} ({joint}) has b = {} m: {why}", i + 1, r.b)
        };
        let reasons: Vec<String> = with_b.map(name).collect();
        if !reasons.is_empty() {
            return Self { rows: Vec::new(), residual: None, zero_below_m: least_m, why_not: Some(reasons.join("; ")) };
        }
        let four =
            |r: &GeneralizedRow| DhRow4 { joint: r.joint.clone(), theta: r.theta, a: r.a, d: r.d, alpha: r.alpha };
        let rows = table.rows.iter().map(four).collect();
        Self { rows, residual: Some(table.residual), zero_below_m: least_m, why_not: None }
    }
}

impl ModifiedDh {
    pub(super) fn of(chain: &Chain, tip: LinkId) -> Self {
        let ModifiedTable { rows, residual } = ModifiedTable::extract(chain, tip);
        let four = rows.into_iter().map(|r| DhRow4 { joint: r.joint, theta: r.theta, a: r.a, d: r.d, alpha: r.alpha });
        Self { rows: four.collect(), residual }
    }
}

impl DirectDh {
    pub(super) fn of(chain: &Chain, tip: LinkId) -> Self {
        let DirectTable { frames, table } = DirectTable::extract(chain, tip);
        let rows = frames.into_iter().zip(&table.rows).map(|(frame, r)| DirectRow { frame, row: row(r) });
        Self { rows: rows.collect(), residual: table.residual }
    }
}

/// Writes the table as text, in degrees and metres.
pub(super) fn fmt_generalized(f: &mut fmt::Formatter<'_>, tip: &str, rows: &[DhRow], residual: f64) -> fmt::Result {
    writeln!(f, "\nGeneralized DH to {tip} (deg, m), residual {residual:.1e}")?;
    writeln!(f, "{:24} {:>9} {:>9} {:>9} {:>9} {:>9}", "joint", "theta", "a", "b", "d", "alpha")?;
    rows.iter().try_for_each(|row| writeln!(f, "{:24} {}", joint(row.joint.as_deref()), five(row)))
}

pub(super) fn fmt_classical(f: &mut fmt::Formatter<'_>, tip: &str, table: &ClassicalDh) -> fmt::Result {
    if let Some(why_not) = &table.why_not {
        return writeln!(f, "\nNo classical DH to {tip}: {why_not}");
    }
    let (residual, least_m) = (table.residual.unwrap_or(f64::NAN), table.zero_below_m);
    writeln!(f, "\nClassical DH to {tip} (deg, m), residual {residual:.1e}, lengths below {least_m:.0e} as 0")?;
    writeln!(f, "{:24} {:>9} {:>9} {:>9} {:>9}", "joint", "theta", "d", "a", "alpha")?;
    table.rows.iter().try_for_each(|r| {
        let (theta, alpha) = (degrees(r.theta), degrees(r.alpha));
        writeln!(f, "{:24} {theta} {} {} {alpha}", joint(r.joint.as_deref()), metres(r.d), metres(r.a))
    })
}

pub(super) fn fmt_modified(f: &mut fmt::Formatter<'_>, tip: &str, table: &ModifiedDh) -> fmt::Result {
    writeln!(f, "\nModified DH (Craig) to {tip} (deg, m), residual {:.1e}", table.residual)?;
    writeln!(f, "{:24} {:>9} {:>9} {:>9} {:>9}", "joint", "alpha", "a", "theta", "d")?;
    table.rows.iter().try_for_each(|r| {
        let (theta, alpha) = (degrees(r.theta), degrees(r.alpha));
        writeln!(f, "{:24} {alpha} {} {theta} {}", joint(r.joint.as_deref()), metres(r.a), metres(r.d))
    })
}

pub(super) fn fmt_direct(f: &mut fmt::Formatter<'_>, tip: &str, table: &DirectDh) -> fmt::Result {
    writeln!(f, "\nDH of each frame to {tip} (deg, m), residual {:.1e}", table.residual)?;
    let heads = ["theta", "a", "b", "d", "alpha"].map(|h| format!("{h:>9}")).join(" ");
    writeln!(f, "{:24} {:24} {heads}", "frame", "joint")?;
    table.rows.iter().try_for_each(|r| {
        let (frame, joint) = (shortened(&r.frame, 24), joint(r.row.joint.as_deref()));
        writeln!(f, "{frame:24} {joint:24} {}", five(&r.row))
    })
}

fn joint(name: Option<&str>) -> String {
    shortened(name.unwrap_or("-"), 24)
}

fn five(row: &DhRow) -> String {
    [degrees(row.theta), metres(row.a), metres(row.b), metres(row.d), degrees(row.alpha)].join(" ")
}

fn degrees(v: f64) -> String {
    format!("{:>9.3}", v.to_degrees())
}

fn metres(v: f64) -> String {
    format!("{v:>9.4}")
}
