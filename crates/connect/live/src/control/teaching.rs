//! What teaching at a robot asks for: how far it is from the region that is being taught.

use elbowroom_cell::CellRegion;
use elbowroom_robot::RobotId;
use serde::Serialize;

use super::clearance::clearances;
use super::refusal::Refusal;
use super::region_changes::{refused, wrong};
use super::request_handler::{RequestHandler, find};
use super::requests::Taught;

/// The distance of a robot from a region.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Distance {
    pub(crate) robot: String,
    /// Distance of what the region guards, 0 inside, m; `None` if the robot is not heard.
    pub(crate) distance_m: Option<f64>,
}

impl RequestHandler {
    /// The distance of a robot from a region that the cell does not have yet.
    pub(crate) fn distance(&self, request: &Taught) -> Result<Distance, Refusal> {
        let present = self.parts.keeper.present();
        let robots = &present.cell.robots;
        let robot = robots.iter().position(|r| r.name == request.robot).map(RobotId).ok_or_else(|| {
            let names: Vec<&str> = robots.iter().map(|r| r.name.as_str()).collect();
            Refusal::new(404, format!("there is no robot `{}`", request.robot))
                .help(format!("one of {}", names.join(", ")))
        })?;
        let edited = self.parts.versions.edited().map_err(refused)?;
        let table = edited.table_of(&request.region, &request.toml).map_err(wrong)?;
        let with = self.with(&present, &request.region, Some(&table))?;
        let (_, region) = find(&with.cell, &request.region)?;
        let region = CellRegion { robots: vec![robot], ..region.clone() };
        let found = clearances(&with.cell, &region, &self.parts.joints.states(), self.parts.clock.seconds())?;
        let distance_m = found.first().and_then(|clearance| clearance.distance_m);
        Ok(Distance { robot: request.robot.clone(), distance_m })
    }
}
