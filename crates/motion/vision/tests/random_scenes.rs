//! Random objects on random paths in random light: every object is covered, and every obstacle is near an object.

use crate::synthetic;
use crate::synthetic::{SyntheticScene, cover_together};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::Xorshift;
use elbowroom_vision::render::RenderedSolid;
use elbowroom_vision::{CameraTrackerSettings, ObstacleChange, Point2, ShadowSettings};

/// A moving object.
struct Mover {
    from: Point2,
    step: Point2,
    size: Vec3,
    turn: f64,
    grey: u8,
    is_round: bool,
}

impl Mover {
    fn random(random: &mut Xorshift) -> Self {
        Self {
            from: Point2::new(random.between(-0.8, 1.2), random.between(-0.9, 0.4)),
            step: Point2::new(random.between(-0.02, 0.02), random.between(-0.02, 0.02)),
            size: Vec3::new(random.between(0.2, 0.7), random.between(0.2, 0.5), random.between(0.05, 0.9)),
            turn: random.between(-0.06, 0.06),
            // Clearly different from the grey of the floor: camouflage is not tested here.
            grey: if random.between(0.0, 1.0) < 0.5 { 20 } else { 235 },
            is_round: random.between(0.0, 1.0) < 0.4,
        }
    }

    fn at(&self, frame: u32) -> RenderedSolid {
        let t = f64::from(frame);
        let middle = self.from + self.step * t;
        if self.is_round {
            return RenderedSolid::cylinder(middle, self.size.x / 2.0, self.size.z, self.grey);
        }
        RenderedSolid::cuboid(middle, self.size, self.turn * t, self.grey)
    }
}

#[test]
fn objects_are_covered_and_obstacles_are_near_objects() {
    let (mut frames, mut objects, mut reported) = (0, 0, 0);
    for case in 0..24_u64 {
        let mut random = Xorshift(case * 7919 + 12_345);
        let shadows = (case % 2 == 1).then(ShadowSettings::default);
        let mut scene =
            SyntheticScene::new(320, 240, CameraTrackerSettings { shadows, ..CameraTrackerSettings::default() });
        scene.conditions.light = shadows.map(|_| Vec3::new(random.between(-0.5, 0.5), random.between(-0.5, 0.5), -1.0));
        scene.conditions.noise = random.between(1.0, 4.0);
        let drift = random.between(-0.01, 0.01);
        let movers: Vec<Mover> = (0..=case % 4).map(|_| Mover::random(&mut random)).collect();
        for frame in 0..25 {
            scene.conditions.gain += drift;
            let solids: Vec<RenderedSolid> = movers.iter().map(|mover| mover.at(frame)).collect();
            let report = scene.step(&solids);
            frames += 1;
            for solid in &solids {
                objects += 1;
                let is_covered = cover_together(&report.obstacles, solid);
                assert!(is_covered, "case {case}, frame {frame}: {solid:?}\n{:#?}", report.obstacles);
            }
            for obstacle in report.obstacles.iter().filter(|o| o.change != ObstacleChange::Left) {
                reported += 1;
                // The projection of an object is between the object and the floor point behind its top.
                let reach = |solid: &RenderedSolid| solid.z_to_m * 0.9 + 0.5;
                let is_near = solids.iter().any(|s| (synthetic::middle(s) - obstacle.centre_m).length() < reach(s));
                assert!(is_near, "case {case}, frame {frame}: nothing is at {:?}", obstacle.centre_m);
            }
        }
    }
    println!("{frames} frames, {objects} objects all covered, {reported} obstacles reported");
    assert!(reported > frames);
}
