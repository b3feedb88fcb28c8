//! Keeps the obstacles of the map in step with the reports of vision.

use std::sync::Arc;

use elbowroom_cspace::{ConvexObstacle, JointMap};
use elbowroom_proximity::{ConvexHull, HullError};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::{self as vision, ObstacleChange, ObstacleId, Point2, polygon};

use crate::error::PerceptionError;
use crate::update::{ObstacleUpdate, Prism};

/// How a reported obstacle becomes a prism of the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrismSettings {
    pub world_in_base: Pose,
    /// Prediction horizon: it also blocks its predicted positions until so long after the frame, seconds.
    pub prediction_s: f64,
    /// Smaller changes are ignored, metres.
    pub slack_m: f64,
}

/// The obstacles in the map, as they were last put there.
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
    /// The first obstacle without a valid hull; it keeps its place in the map and is tried again with the next frame.
    /// All others are updated nonetheless: vision reports each change once.
    pub fn follow(
        &mut self,
        reported: &[vision::Obstacle],
        sweep: &PrismSettings,
        map: &mut JointMap,
        update: &mut ObstacleUpdate,
    ) -> Result<(), PerceptionError> {
        let mut all = Ok(());
        for seen in reported {
            let one = if seen.change == ObstacleChange::Left {
                self.forget(seen.id, map, update);
                Ok(())
            } else {
                self.follow_one(seen, sweep, map, update)
            };
            all = all.and(one);
        }
        all
    }

    fn forget(&mut self, id: ObstacleId, map: &mut JointMap, update: &mut ObstacleUpdate) {
        self.prisms.retain(|p| p.id != id);
        update.left.push(id);
        if let Some(changes) = map.remove(&name_of(id)) {
            update.freed += changes.freed();
        }
    }

    fn follow_one(
        &mut self,
        seen: &vision::Obstacle,
        sweep: &PrismSettings,
        map: &mut JointMap,
        update: &mut ObstacleUpdate,
    ) -> Result<(), PerceptionError> {
        let known = self.prisms.iter().position(|p| p.id == seen.id);
        if known.is_none() {
            update.entered.push(seen.id);
        }
        let mut prism = prism(seen, sweep.prediction_s);
        if let Some(old) = known.map(|at| &mut self.prisms[at]) {
            let drift_m = (prism.velocity_mps - old.velocity_mps).length() * sweep.prediction_s;
            if seen.change == ObstacleChange::Unchanged && is_same_solid(&prism, old) && drift_m <= sweep.slack_m {
                // Noise of the velocity alone changes nothing.
                (prism.swept_m, prism.velocity_mps) = (std::mem::take(&mut old.swept_m), old.velocity_mps);
                *old = prism;
                return Ok(());
            }
        }
        let hull = hull(&prism.swept_m, [prism.z_from_m, prism.z_to_m])?;
        let changes = map.set(&name_of(seen.id), &ConvexObstacle::hull(sweep.world_in_base, Arc::new(hull))?);
        update.blocked += changes.blocked();
        update.freed += changes.freed();
        match known {
            Some(at) => self.prisms[at] = prism,
            None => self.prisms.push(prism),
        }
        Ok(())
    }
}

/// Vision reports an obstacle as stationary relative to its last report, which may never have reached the map.
fn is_same_solid(reported: &Prism, known: &Prism) -> bool {
    reported.footprint_m == known.footprint_m && [reported.z_from_m, reported.z_to_m] == [known.z_from_m, known.z_to_m]
}

fn name_of(id: ObstacleId) -> String {
    id.to_string()
}

fn prism(seen: &vision::Obstacle, prediction_s: f64) -> Prism {
    let displacement = seen.velocity_mps * prediction_s;
    let mut points: Vec<Point2> = seen.footprint_m.iter().flat_map(|&p| [p, p + displacement]).collect();
    let mut swept_m = Vec::new();
    polygon::convex_hull(&mut points, &mut swept_m);
    Prism {
        id: seen.id,
        kind: seen.kind.as_deref().map(str::to_owned),
        footprint_m: seen.footprint_m.clone(),
        swept_m,
        z_from_m: seen.z_from_m,
        z_to_m: seen.z_to_m,
        centre_m: seen.centre_m,
        velocity_mps: seen.velocity_mps,
        is_unobserved: seen.is_unobserved,
    }
}

/// The convex hull of an upright prism.
pub(super) fn hull(footprint_m: &[Point2], heights_m: [f64; 2]) -> Result<ConvexHull, HullError> {
    let at = |z: f64| footprint_m.iter().map(move |p| Vec3::new(p.x, p.y, z));
    let points: Vec<Vec3> = heights_m.into_iter().flat_map(at).collect();
    ConvexHull::from_points(&points)
}

#[cfg(test)]
mod tests {
    use elbowroom_cspace::{Grid, GridAxis, PlanarArm};
    use elbowroom_vision::FrameStatus;

    use super::*;
    use crate::times::PerceptionTimes;

    const SWEEP: PrismSettings = PrismSettings { world_in_base: Pose::IDENTITY, prediction_s: 0.5, slack_m: 0.02 };

    fn map() -> JointMap {
        let axis = |min: f64, max: f64| GridAxis::new("joint", min, max, 0.1).unwrap();
        let grid = Grid::new([axis(-3.0, 3.0), axis(-2.0, 0.2), axis(-1.0, 2.5)]).unwrap();
        JointMap::new(PlanarArm::KR125, &grid).unwrap()
    }

    fn seen(id: u64, change: ObstacleChange, at: [f64; 2]) -> vision::Obstacle {
        let corner = |x: f64, y: f64| Point2::new(at[0] + x, at[1] + y);
        vision::Obstacle {
            id: ObstacleId(id),
            change,
            footprint_m: vec![corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)],
            z_to_m: 1.5,
            ..vision::Obstacle::default()
        }
    }

    fn follow(
        known: &mut MapUpdater,
        map: &mut JointMap,
        reported: &[vision::Obstacle],
    ) -> Result<(), PerceptionError> {
        let mut update = ObstacleUpdate {
            stamp_s: 0.0,
            status: FrameStatus::Valid,
            prisms: Vec::new(),
            entered: Vec::new(),
            left: Vec::new(),
            blocked: 0,
            freed: 0,
            times: PerceptionTimes::default(),
        };
        known.follow(reported, &SWEEP, map, &mut update)
    }

    /// A map with exactly these obstacles.
    fn table_of(reported: &[vision::Obstacle]) -> JointMap {
        let mut map = map();
        follow(&mut MapUpdater::default(), &mut map, reported).unwrap();
        map
    }

    fn is_same(a: &JointMap, b: &JointMap) -> bool {
        let planes = a.grid().shape()[0];
        (0..planes).all(|n| a.occupancy().plane(n) == b.occupancy().plane(n))
    }

    #[test]
    fn an_obstacle_without_a_solid_does_not_hinder_the_others() {
        let (mut map, mut known) = (map(), MapUpdater::default());
        let first = [1, 2, 3].map(|id| seen(id, ObstacleChange::Entered, [1.8, id as f64 - 2.0]));
        follow(&mut known, &mut map, &first).unwrap();
        let flat = vision::Obstacle { z_to_m: 0.0, ..seen(1, ObstacleChange::Moved, [1.8, -1.0]) };
        let also_flat = vision::Obstacle { footprint_m: Vec::new(), ..seen(5, ObstacleChange::Entered, [0.0; 2]) };
        let second =
            [flat, seen(2, ObstacleChange::Moved, [1.4, 0.3]), seen(3, ObstacleChange::Left, [1.8, 1.0]), also_flat];
        let error = follow(&mut known, &mut map, &second).unwrap_err();
        assert!(error.to_string().contains("plane"), "the first error is returned: {error}");
        // The rejected obstacle keeps its place.
        let expected =
            table_of(&[seen(1, ObstacleChange::Entered, [1.8, -1.0]), seen(2, ObstacleChange::Entered, [1.4, 0.3])]);
        assert!(is_same(&map, &expected));
        assert_eq!(known.prisms().iter().map(|p| p.id.0).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn an_obstacle_reported_as_stationary_is_compared_with_the_map() {
        let (mut map, mut known) = (map(), MapUpdater::default());
        follow(&mut known, &mut map, &[seen(1, ObstacleChange::Entered, [1.8, 0.0])]).unwrap();
        // It moved in a frame that was rejected, and is stationary since.
        let flat = vision::Obstacle { z_to_m: 0.0, ..seen(1, ObstacleChange::Moved, [1.4, 0.6]) };
        follow(&mut known, &mut map, std::slice::from_ref(&flat)).unwrap_err();
        follow(&mut known, &mut map, &[vision::Obstacle { change: ObstacleChange::Unchanged, ..flat }]).unwrap_err();
        assert!(is_same(&map, &table_of(&[seen(1, ObstacleChange::Entered, [1.8, 0.0])])));
        for there in [[1.4, 0.6], [1.8, -0.4]] {
            follow(&mut known, &mut map, &[seen(1, ObstacleChange::Unchanged, there)]).unwrap();
            let expected = table_of(&[seen(1, ObstacleChange::Entered, there)]);
            assert!(expected.occupancy().blocked() > 0 && is_same(&map, &expected));
        }
        // A different height is a change, too.
        let high = vision::Obstacle { z_to_m: 2.5, ..seen(1, ObstacleChange::Unchanged, [1.8, -0.4]) };
        follow(&mut known, &mut map, std::slice::from_ref(&high)).unwrap();
        assert!(is_same(&map, &table_of(&[high])));
    }
}
