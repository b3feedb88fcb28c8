//! The zones of one region, and what they lack.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_monitor::Life;

use super::zone::Zone;
use crate::{CellRegion, CellRegionId};

/// The zones of one region.
#[derive(Debug, Clone)]
pub(super) struct RegionZones<'c> {
    pub id: CellRegionId,
    pub region: &'c CellRegion,
    /// The zones that express it.
    pub zones: Vec<Zone>,
    /// Names of the zones that a language has written.
    pub written: Vec<String>,
    pub missing: Vec<Diagnostic>,
    file: &'c Path,
}

impl<'c> RegionZones<'c> {
    pub fn new(id: CellRegionId, region: &'c CellRegion, file: &'c Path) -> Self {
        Self { id, region, zones: Vec::new(), written: Vec::new(), missing: Vec::new(), file }
    }

    /// Its name.
    pub fn name(&self) -> &'c str {
        &self.region.region.name
    }

    /// Whether programs switch it.
    pub fn is_temporary(&self) -> bool {
        self.region.region.life == Life::Temporary
    }

    /// Notes what is not expressed, of the whole region or of a part of it, and what to do instead.
    pub fn miss(&mut self, part: &str, reason: &str, hint: Option<&str>) {
        let of = if part.is_empty() { String::new() } else { format!(", {part}") };
        let what = format!("region \"{}\"{of}: {reason}", self.name());
        let missing = Diagnostic::new(self.file, self.region.line, what);
        self.missing.push(match hint {
            Some(hint) => missing.hint(hint),
            None => missing,
        });
    }
}
