//! Updates of the obstacles in the joint-space map from the reports of a tracker.

use elbowroom_vision::{self as vision, ObstacleChange, ObstacleId, Point2, polygon};

use crate::error::PerceptionError;
use crate::obstacle_update::{ObstacleUpdate, Prism};
use crate::robot_prisms::RobotPrisms;

/// Settings of the conversion of a reported obstacle to a prism.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrismSettings {
    /// Prediction horizon: an obstacle also blocks its predicted positions until this time after the frame, seconds.
    pub prediction_s: f64,
    /// Largest change of a predicted position that is ignored, metres.
    pub slack_m: f64,
}

/// The obstacles in the map, as they were last inserted.
#[derive(Debug, Default)]
pub(super) struct MapUpdater {
    prisms: Vec<Prism>,
}

impl MapUpdater {
    pub fn prisms(&self) -> &Vec<Prism> {
        &self.prisms
    }

    /// Adds and updates reported obstacles in the map, and removes those that left.
    ///
    /// # Errors
    /// The first obstacle without a valid hull. Its cells in the map do not change, and it is tried again with the next
    /// frame. All other obstacles are updated, because the tracker reports each change only once.
    pub fn update(
        &mut self,
        reported: &[vision::Obstacle],
        settings: &PrismSettings,
        map: &mut RobotPrisms,
        update: &mut ObstacleUpdate,
    ) -> Result<(), PerceptionError> {
        let mut result = Ok(());
        for observed in reported {
            let updated = if observed.change == ObstacleChange::Left {
                self.remove(observed.id, map, update);
                Ok(())
            } else {
                self.update_one(observed, settings, map, update)
            };
            result = result.and(updated);
        }
        result
    }

    fn remove(&mut self, id: ObstacleId, map: &mut RobotPrisms, update: &mut ObstacleUpdate) {
        self.prisms.retain(|p| p.id != id);
        update.left.push(id);
        if let Some(changed) = map.remove(id) {
            update.freed += changed.freed;
        }
    }

    fn update_one(
        &mut self,
        observed: &vision::Obstacle,
        settings: &PrismSettings,
        map: &mut RobotPrisms,
        update: &mut ObstacleUpdate,
    ) -> Result<(), PerceptionError> {
        let index = self.prisms.iter().position(|p| p.id == observed.id);
        if index.is_none() {
            update.entered.push(observed.id);
        }
        let mut prism = prism(observed, settings.prediction_s);
        if let Some(old) = index.map(|i| &mut self.prisms[i]) {
            let drift_m = (prism.velocity_mps - old.velocity_mps).length() * settings.prediction_s;
            if observed.change == ObstacleChange::Unchanged && is_same_solid(&prism, old) && drift_m <= settings.slack_m
            {
                // Noise of the velocity alone does not change the map.
                (prism.swept_m, prism.velocity_mps) = (std::mem::take(&mut old.swept_m), old.velocity_mps);
                *old = prism;
                return Ok(());
            }
        }
        let changed = map.set(observed.id, &prism.swept_m, [prism.z_from_m, prism.z_to_m])?;
        update.blocked += changed.blocked;
        update.freed += changed.freed;
        match index {
            Some(i) => self.prisms[i] = prism,
            None => self.prisms.push(prism),
        }
        Ok(())
    }
}

/// Whether two prisms are equal. The tracker reports an obstacle as unchanged relative to its last report, which may
/// never have reached the map.
fn is_same_solid(a: &Prism, b: &Prism) -> bool {
    a.footprint_m == b.footprint_m && [a.z_from_m, a.z_to_m] == [b.z_from_m, b.z_to_m]
}

fn prism(observed: &vision::Obstacle, prediction_s: f64) -> Prism {
    let displacement = observed.velocity_mps * prediction_s;
    let mut points: Vec<Point2> = observed.footprint_m.iter().flat_map(|&p| [p, p + displacement]).collect();
    let mut swept_m = Vec::new();
    polygon::convex_hull(&mut points, &mut swept_m);
    Prism {
        id: observed.id,
        kind: observed.kind.as_deref().map(str::to_owned),
        footprint_m: observed.footprint_m.clone(),
        swept_m,
        z_from_m: observed.z_from_m,
        z_to_m: observed.z_to_m,
        centre_m: observed.centre_m,
        velocity_mps: observed.velocity_mps,
        is_unobserved: observed.is_unobserved,
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
    use elbowroom_robot::example;
    use elbowroom_spatial::Pose;
    use elbowroom_vision::FrameStatus;

    use super::*;
    use crate::times::PerceptionTimes;

    const SETTINGS: PrismSettings = PrismSettings { prediction_s: 0.5, slack_m: 0.02 };

    fn map() -> RobotPrisms {
        let grid =
            Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 6.0).unwrap())).unwrap();
        let (robot, settings) = (example::arm().unwrap(), CoverMapSettings::default());
        let builder =
            CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], RemainingJoints::Swept, settings).unwrap();
        RobotPrisms::new(builder)
    }

    fn obstacle(id: u64, change: ObstacleChange, at: [f64; 2]) -> vision::Obstacle {
        let corner = |x: f64, y: f64| Point2::new(at[0] + x, at[1] + y);
        vision::Obstacle {
            id: ObstacleId(id),
            change,
            footprint_m: vec![corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)],
            z_to_m: 1.5,
            ..vision::Obstacle::default()
        }
    }

    fn apply(
        updater: &mut MapUpdater,
        map: &mut RobotPrisms,
        reported: &[vision::Obstacle],
    ) -> Result<(), PerceptionError> {
        let mut update = ObstacleUpdate {
            stamp_s: 0.0,
            status: FrameStatus::Accepted,
            prisms: Vec::new(),
            entered: Vec::new(),
            left: Vec::new(),
            blocked: 0,
            freed: 0,
            times: PerceptionTimes::default(),
        };
        updater.update(reported, &SETTINGS, map, &mut update)
    }

    /// A map with exactly these obstacles.
    fn map_of(reported: &[vision::Obstacle]) -> RobotPrisms {
        let mut map = map();
        apply(&mut MapUpdater::default(), &mut map, reported).unwrap();
        map
    }

    fn is_equal(a: &RobotPrisms, b: &RobotPrisms) -> bool {
        a.map().occupancy().iter().eq(b.map().occupancy().iter())
    }

    #[test]
    fn an_obstacle_without_a_valid_hull_does_not_prevent_updates_of_the_others() {
        let (mut map, mut updater) = (map(), MapUpdater::default());
        let first = [1, 2, 3].map(|id| obstacle(id, ObstacleChange::Entered, [0.8, id as f64 - 2.0]));
        apply(&mut updater, &mut map, &first).unwrap();
        let flat = vision::Obstacle { z_to_m: 0.0, ..obstacle(1, ObstacleChange::Moved, [0.8, -1.0]) };
        let also_flat = vision::Obstacle { footprint_m: Vec::new(), ..obstacle(5, ObstacleChange::Entered, [0.0; 2]) };
        let second = [
            flat,
            obstacle(2, ObstacleChange::Moved, [0.6, 0.3]),
            obstacle(3, ObstacleChange::Left, [0.8, 1.0]),
            also_flat,
        ];
        let error = apply(&mut updater, &mut map, &second).unwrap_err();
        assert!(error.to_string().contains("volume"), "the first error is returned: {error}");
        // The cells of the rejected obstacle are unchanged.
        let expected = map_of(&[
            obstacle(1, ObstacleChange::Entered, [0.8, -1.0]),
            obstacle(2, ObstacleChange::Entered, [0.6, 0.3]),
        ]);
        assert!(is_equal(&map, &expected));
        assert_eq!(updater.prisms().iter().map(|p| p.id.0).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn an_obstacle_reported_as_stationary_is_compared_with_the_map() {
        let (mut map, mut updater) = (map(), MapUpdater::default());
        apply(&mut updater, &mut map, &[obstacle(1, ObstacleChange::Entered, [0.8, 0.0])]).unwrap();
        // The obstacle moved in a frame that was rejected, and has been stationary since.
        let flat = vision::Obstacle { z_to_m: 0.0, ..obstacle(1, ObstacleChange::Moved, [0.6, 0.6]) };
        apply(&mut updater, &mut map, std::slice::from_ref(&flat)).unwrap_err();
        apply(&mut updater, &mut map, &[vision::Obstacle { change: ObstacleChange::Unchanged, ..flat }]).unwrap_err();
        assert!(is_equal(&map, &map_of(&[obstacle(1, ObstacleChange::Entered, [0.8, 0.0])])));
        for position in [[0.6, 0.6], [0.8, -0.4]] {
            apply(&mut updater, &mut map, &[obstacle(1, ObstacleChange::Unchanged, position)]).unwrap();
            let expected = map_of(&[obstacle(1, ObstacleChange::Entered, position)]);
            assert!(expected.map().occupancy().blocked() > 0 && is_equal(&map, &expected));
        }
        // A different height is a change, too.
        let high = vision::Obstacle { z_to_m: 2.5, ..obstacle(1, ObstacleChange::Unchanged, [0.8, -0.4]) };
        apply(&mut updater, &mut map, std::slice::from_ref(&high)).unwrap();
        assert!(is_equal(&map, &map_of(&[high])));
    }
}
