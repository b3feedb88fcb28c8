//! The regions of a robot as zones of its controller, in the controller's own language.
//!
//! A zone guards the tool centre point at the border of a region: a second guard, which works without the monitor.
//! [`export_zones`] writes each region that a language can express, in the frame that is the world of the controller, and
//! names everything that it cannot express.

mod krl;
mod outward;
mod rapid;
mod region_zones;
mod requested_zones;
mod zone;
mod zone_frame;
mod zone_language;
mod zone_text;

use elbowroom_formats::Diagnostic;
use elbowroom_robot::RobotId;

use crate::{Cell, CellRegionId};
use region_zones::RegionZones;
pub use zone_frame::ZoneFrame;
pub use zone_language::ZoneLanguage;

/// The zones of a robot's regions as text for its controller.
#[derive(Debug, Clone)]
pub struct ZoneExport {
    /// The text, in ASCII; comments say where it belongs and what it lacks.
    pub text: String,
    /// Every region that guards against the robot, in the order of the cell.
    pub regions: Vec<ExportedRegion>,
}

/// What became of a region.
#[derive(Debug, Clone)]
pub struct ExportedRegion {
    /// The region.
    pub region: CellRegionId,
    /// Names of its zones in the text; empty if it is not written.
    pub zones: Vec<String>,
    /// What of it the text does not express, at the line of the region.
    pub missing: Vec<Diagnostic>,
}

impl ZoneExport {
    /// Whether the text expresses all of the regions.
    pub fn is_complete(&self) -> bool {
        self.regions.iter().all(|region| region.missing.is_empty())
    }
}

/// Writes the regions that guard against a robot as zones for its controller.
///
/// Zones enclose their regions: they are never smaller, and larger by at most 0.01 mm; by 0.1 mm in RAPID if the region is
/// turned against the axes by 0.05 mm or less, as a right angle in radians with four digits is. The warning zone of a box or a
/// cylinder has sharp edges, and so is larger there. A plane becomes a box that covers all that the robot reaches of it.
///
/// ```
/// use elbowroom_cell::{Cell, ZoneFrame, ZoneLanguage, export_zones};
/// use elbowroom_robot::RobotId;
/// let cell = Cell::parse("rail.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.rail]
/// base = { at = [1000, 0, 0], rpy = [0, 0, 0] }
/// dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
/// [region.lamp]
/// shape = "sphere"
/// centre = [1000, 0, 2500]
/// radius = 100
/// warning = 100
/// guards = ["tcp"]
/// "#)?;
/// let frame = ZoneFrame::new(&cell, RobotId(0), None)?;
/// let zones = export_zones(&cell, RobotId(0), &frame, ZoneLanguage::Rapid);
/// assert!(zones.text.contains(r"WZSphDef \Inside, shape, [0.000,0.000,2500.000], 100.005;"));
/// assert!(zones.text.contains(r"WZLimSup \Stat, wz1_lamp, shape;") && zones.is_complete());
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn export_zones(cell: &Cell, robot: RobotId, frame: &ZoneFrame, language: ZoneLanguage) -> ZoneExport {
    let mut regions = requested_zones::requested_zones(cell, robot, frame);
    let text = match language {
        ZoneLanguage::Rapid => rapid::text(cell, robot, frame, &mut regions),
        ZoneLanguage::Krl => krl::text(cell, robot, frame, &mut regions),
    };
    let exported = |r: RegionZones<'_>| ExportedRegion { region: r.id, zones: r.written, missing: r.missing };
    ZoneExport { text, regions: regions.into_iter().map(exported).collect() }
}
