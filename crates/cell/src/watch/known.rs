//! What is in the map, and how it follows what vision tells.

use std::sync::Arc;

use elbowroom_cspace::{JointMap, Obstacle};
use elbowroom_proximity::{ConvexHull, HullError};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::{self as vision, Change, ObstacleId, Point2, polygon};

use super::{Prism, Sighting, WatchError};

/// How an obstacle becomes a solid of the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    pub world_in_base: Pose,
    /// It also blocks where it will be so long after the frame, seconds.
    pub ahead_s: f64,
    /// Less is no change, metres.
    pub slack_m: f64,
}

/// The obstacles that are in the map, as they are in it.
#[derive(Debug, Default)]
pub(super) struct Known {
    prisms: Vec<Prism>,
}

impl Known {
    pub fn prisms(&self) -> &Vec<Prism> {
        &self.prisms
    }

    /// Puts what entered and moved into the map, takes out what left.
    ///
    /// # Errors
    /// The first obstacle that is no solid of this world; it stays as it was in the map, and is tried again with the next
    /// frame. All others are followed nonetheless: vision tells each change once.
    pub fn follow(
        &mut self,
        told: &[vision::Obstacle],
        sweep: &Sweep,
        map: &mut JointMap,
        sighting: &mut Sighting,
    ) -> Result<(), WatchError> {
        let mut all = Ok(());
        for seen in told {
            let one = if seen.change == Change::Left {
                self.forget(seen.id, map, sighting);
                Ok(())
            } else {
                self.follow_one(seen, sweep, map, sighting)
            };
            all = all.and(one);
        }
        all
    }

    fn forget(&mut self, id: ObstacleId, map: &mut JointMap, sighting: &mut Sighting) {
        self.prisms.retain(|p| p.id != id);
        sighting.left.push(id);
        if let Some(changes) = map.remove(&name_of(id)) {
            sighting.freed += changes.freed();
        }
    }

    fn follow_one(
        &mut self,
        seen: &vision::Obstacle,
        sweep: &Sweep,
        map: &mut JointMap,
        sighting: &mut Sighting,
    ) -> Result<(), WatchError> {
        let known = self.prisms.iter().position(|p| p.id == seen.id);
        if known.is_none() {
            sighting.entered.push(seen.id);
        }
        let mut prism = prism(seen, sweep.ahead_s);
        if let Some(old) = known.map(|at| &mut self.prisms[at]) {
            let drift_m = (prism.velocity_mps - old.velocity_mps).length() * sweep.ahead_s;
            if seen.change == Change::Still && is_same_solid(&prism, old) && drift_m <= sweep.slack_m {
                // Noise of the velocity alone moves nothing.
                (prism.swept_m, prism.velocity_mps) = (std::mem::take(&mut old.swept_m), old.velocity_mps);
                *old = prism;
                return Ok(());
            }
        }
        let hull = hull(&prism.swept_m, [prism.z_from_m, prism.z_to_m])?;
        let changes = map.set(&name_of(seen.id), &Obstacle::hull(sweep.world_in_base, Arc::new(hull))?);
        sighting.blocked += changes.blocked();
        sighting.freed += changes.freed();
        match known {
            Some(at) => self.prisms[at] = prism,
            None => self.prisms.push(prism),
        }
        Ok(())
    }
}

/// Vision's "still" means as told last; that need not be what is in the map, where a frame could not be used.
fn is_same_solid(told: &Prism, known: &Prism) -> bool {
    told.footprint_m == known.footprint_m && [told.z_from_m, told.z_to_m] == [known.z_from_m, known.z_to_m]
}

fn name_of(id: ObstacleId) -> String {
    id.to_string()
}

fn prism(seen: &vision::Obstacle, ahead_s: f64) -> Prism {
    let way = seen.velocity_mps * ahead_s;
    let mut points: Vec<Point2> = seen.footprint_m.iter().flat_map(|&p| [p, p + way]).collect();
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
        is_remembered: seen.is_remembered,
    }
}

/// An upright prism as a solid.
pub(super) fn hull(footprint_m: &[Point2], heights_m: [f64; 2]) -> Result<ConvexHull, HullError> {
    let at = |z: f64| footprint_m.iter().map(move |p| Vec3::new(p.x, p.y, z));
    let points: Vec<Vec3> = heights_m.into_iter().flat_map(at).collect();
    ConvexHull::from_points(&points)
}

#[cfg(test)]
mod tests {
    use elbowroom_cspace::{Axis, Grid, PlanarArm};
    use elbowroom_vision::Sight;

    use super::*;
    use crate::watch::SeeTimes;

    const SWEEP: Sweep = Sweep { world_in_base: Pose::IDENTITY, ahead_s: 0.5, slack_m: 0.02 };

    fn map() -> JointMap {
        let axis = |min: f64, max: f64| Axis::new("joint", min, max, 0.1).unwrap();
        let grid = Grid::new([axis(-3.0, 3.0), axis(-2.0, 0.2), axis(-1.0, 2.5)]).unwrap();
        JointMap::new(PlanarArm::KR125, &grid).unwrap()
    }

    fn seen(id: u64, change: Change, at: [f64; 2]) -> vision::Obstacle {
        let corner = |x: f64, y: f64| Point2::new(at[0] + x, at[1] + y);
        vision::Obstacle {
            id: ObstacleId(id),
            change,
            footprint_m: vec![corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)],
            z_to_m: 1.5,
            ..vision::Obstacle::default()
        }
    }

    fn follow(known: &mut Known, map: &mut JointMap, told: &[vision::Obstacle]) -> Result<(), WatchError> {
        let mut sighting = Sighting {
            stamp_s: 0.0,
            sight: Sight::Clear,
            prisms: Vec::new(),
            entered: Vec::new(),
            left: Vec::new(),
            blocked: 0,
            freed: 0,
            times: SeeTimes::default(),
        };
        known.follow(told, &SWEEP, map, &mut sighting)
    }

    /// The table that has just these in it.
    fn table_of(told: &[vision::Obstacle]) -> JointMap {
        let mut map = map();
        follow(&mut Known::default(), &mut map, told).unwrap();
        map
    }

    fn is_same(a: &JointMap, b: &JointMap) -> bool {
        let planes = a.grid().shape()[0];
        (0..planes).all(|n| a.table().plane(n) == b.table().plane(n))
    }

    #[test]
    fn one_that_is_no_solid_keeps_none_of_the_others_from_the_map() {
        let (mut map, mut known) = (map(), Known::default());
        let first = [1, 2, 3].map(|id| seen(id, Change::Entered, [1.8, id as f64 - 2.0]));
        follow(&mut known, &mut map, &first).unwrap();
        let flat = vision::Obstacle { z_to_m: 0.0, ..seen(1, Change::Moved, [1.8, -1.0]) };
        let also_flat = vision::Obstacle { footprint_m: Vec::new(), ..seen(5, Change::Entered, [0.0; 2]) };
        let second = [flat, seen(2, Change::Moved, [1.4, 0.3]), seen(3, Change::Left, [1.8, 1.0]), also_flat];
        let error = follow(&mut known, &mut map, &second).unwrap_err();
        assert!(error.to_string().contains("plane"), "the first one is told: {error}");
        // What could not be put in stays where it was.
        let wanted = table_of(&[seen(1, Change::Entered, [1.8, -1.0]), seen(2, Change::Entered, [1.4, 0.3])]);
        assert!(is_same(&map, &wanted));
        assert_eq!(known.prisms().iter().map(|p| p.id.0).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn what_is_told_as_still_is_compared_with_what_is_in_the_map() {
        let (mut map, mut known) = (map(), Known::default());
        follow(&mut known, &mut map, &[seen(1, Change::Entered, [1.8, 0.0])]).unwrap();
        // It moved in a frame that could not be used, and stands since.
        let flat = vision::Obstacle { z_to_m: 0.0, ..seen(1, Change::Moved, [1.4, 0.6]) };
        follow(&mut known, &mut map, std::slice::from_ref(&flat)).unwrap_err();
        follow(&mut known, &mut map, &[vision::Obstacle { change: Change::Still, ..flat }]).unwrap_err();
        assert!(is_same(&map, &table_of(&[seen(1, Change::Entered, [1.8, 0.0])])));
        for there in [[1.4, 0.6], [1.8, -0.4]] {
            follow(&mut known, &mut map, &[seen(1, Change::Still, there)]).unwrap();
            let wanted = table_of(&[seen(1, Change::Entered, there)]);
            assert!(wanted.table().blocked() > 0 && is_same(&map, &wanted));
        }
        // Another height counts too.
        let high = vision::Obstacle { z_to_m: 2.5, ..seen(1, Change::Still, [1.8, -0.4]) };
        follow(&mut known, &mut map, std::slice::from_ref(&high)).unwrap();
        assert!(is_same(&map, &table_of(&[high])));
    }
}
