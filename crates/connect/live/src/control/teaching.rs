//! What teaching at a robot asks for: how far it is from the region that is being taught.

use elbowroom_cell::{CellRegion, cell_with_only};
use elbowroom_robot::RobotId;
use serde::Serialize;

use super::clearance::ClearanceQuery;
use super::refusal::Refusal;
use super::region_changes::wrong;
use super::request_handler::RequestHandler;
use super::requests::Taught;
use super::taught_regions::TaughtRegion;

/// The distance of a robot from a region.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Distance {
    pub(crate) robot: String,
    /// Distance of what the region guards, 0 inside, m; `None` if the robot is not heard.
    pub(crate) distance_m: Option<f64>,
}

impl RequestHandler {
    /// The distance of a robot from a region that the cell does not have yet.
    ///
    /// A panel asks several times a second for the same region: its monitor is built at the first question, without the
    /// rest of the cell.
    pub(crate) fn distance(&self, request: &Taught) -> Result<Distance, Refusal> {
        let cell = self.parts.keeper.present().cell;
        let robot = cell.robots.iter().position(|r| r.name == request.robot).map(RobotId).ok_or_else(|| {
            let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
            Refusal::new(404, format!("there is no robot `{}`", request.robot))
                .help(format!("one of {}", names.join(", ")))
        })?;
        let key = TaughtRegion { robot, region: request.region.clone(), toml: request.toml.clone() };
        let mut taught = self.taught();
        let query = taught.query(key, || {
            let alone = cell_with_only(&cell, &request.region, &request.toml).map_err(wrong)?;
            let region = &alone.regions[0];
            let region = CellRegion { robots: vec![robot], ..region.clone() };
            Ok::<_, Refusal>(ClearanceQuery::new(&alone, &region)?)
        })?;
        let found = query.clearances(&self.parts.places(), self.parts.clock.seconds());
        let distance_m = found.first().and_then(|clearance| clearance.distance_m);
        Ok(Distance { robot: request.robot.clone(), distance_m })
    }
}
