//! The DH tables of a robot.

use std::fmt;

use elbowroom_kinematics::dh::GeneralizedTable;
use elbowroom_kinematics::{Chain, LinkId};
use serde::Serialize;

use crate::dh::{self, ClassicalDh, DhConvention, DhRow, DirectDh, ModifiedDh};

/// The chain to one link as DH tables in all conventions; null and empty for a mesh.
#[derive(Debug, Clone, Default, Serialize)]
pub struct DhTables {
    /// The last link of the tables; null for a mesh.
    #[serde(rename = "dh_tip")]
    pub tip: Option<String>,
    /// The generalized DH table `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`.
    #[serde(rename = "dh")]
    pub rows: Vec<DhRow>,
    /// Largest difference between the product of the rows and forward kinematics; null for a mesh.
    #[serde(rename = "dh_residual")]
    pub residual: Option<f64>,
    /// The classical DH table, which exists if every b is 0 to the precision of files; null for a mesh.
    #[serde(rename = "dh_classical")]
    pub classical: Option<ClassicalDh>,
    /// The modified DH table (Craig); null for a mesh.
    #[serde(rename = "dh_modified")]
    pub modified: Option<ModifiedDh>,
    /// The DH table with one row per frame of the model; null for a mesh.
    #[serde(rename = "dh_direct")]
    pub direct: Option<DirectDh>,
    /// The tables that the text shows.
    #[serde(skip)]
    pub(crate) shown: Vec<DhConvention>,
}

impl DhTables {
    /// The tables of the chain to a link. The text shows these conventions; the generalized table if none are given.
    pub(crate) fn of(chain: &Chain, tip: LinkId, shown: &[DhConvention]) -> Self {
        let table = GeneralizedTable::extract(chain, tip);
        Self {
            tip: Some(chain.links()[tip.0].clone()),
            rows: dh::generalized(&table),
            residual: Some(table.residual),
            classical: Some(ClassicalDh::of(&table, chain, tip)),
            modified: Some(ModifiedDh::of(chain, tip)),
            direct: Some(DirectDh::of(chain, tip)),
            shown: if shown.is_empty() { vec![DhConvention::Generalized] } else { shown.to_vec() },
        }
    }
}

impl fmt::Display for DhTables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tip: Some(tip), rows, residual: Some(residual), classical, modified, direct, shown } = self else {
            return Ok(());
        };
        for convention in shown {
            match convention {
                DhConvention::Generalized => dh::fmt_generalized(f, tip, rows, *residual)?,
                DhConvention::Classical => classical.iter().try_for_each(|t| dh::fmt_classical(f, tip, t))?,
                DhConvention::Modified => modified.iter().try_for_each(|t| dh::fmt_modified(f, tip, t))?,
                DhConvention::Direct => direct.iter().try_for_each(|t| dh::fmt_direct(f, tip, t))?,
            }
        }
        Ok(())
    }
}
