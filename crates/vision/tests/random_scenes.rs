//! Random things on random ways in random light: whatever happens, what is there is covered, and nothing else is told.

mod stage;

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::Solid;
use elbowroom_vision::{Change, Point2, Settings, Shadows};
use stage::{Stage, cover_together};

struct Random(u64);

impl Random {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        from + (to - from) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// A thing and how it goes: place, velocity, size, heading, turning, grey.
struct Mover {
    from: Point2,
    step: Point2,
    size: Vec3,
    turn: f64,
    grey: u8,
    is_round: bool,
}

impl Mover {
    fn random(random: &mut Random) -> Self {
        Self {
            from: Point2::new(random.between(-0.8, 1.2), random.between(-0.9, 0.4)),
            step: Point2::new(random.between(-0.02, 0.02), random.between(-0.02, 0.02)),
            size: Vec3::new(random.between(0.2, 0.7), random.between(0.2, 0.5), random.between(0.05, 0.9)),
            turn: random.between(-0.06, 0.06),
            // Far from the floor's own grey: camouflage is not what is tested here.
            grey: if random.between(0.0, 1.0) < 0.5 { 20 } else { 235 },
            is_round: random.between(0.0, 1.0) < 0.4,
        }
    }

    fn at(&self, frame: u32) -> Solid {
        let t = f64::from(frame);
        let middle = self.from + self.step * t;
        if self.is_round {
            return Solid::cylinder(middle, self.size.x / 2.0, self.size.z, self.grey);
        }
        Solid::cuboid(middle, self.size, self.turn * t, self.grey)
    }
}

#[test]
fn what_is_there_is_covered_and_what_is_told_is_there() {
    let (mut frames, mut things, mut told) = (0, 0, 0);
    for scene in 0..24_u64 {
        let mut random = Random(scene * 7919 + 12_345);
        let shadows = (scene % 2 == 1).then(Shadows::default);
        let mut stage = Stage::new(320, 240, Settings { shadows, ..Settings::default() });
        stage.conditions.light = shadows.map(|_| Vec3::new(random.between(-0.5, 0.5), random.between(-0.5, 0.5), -1.0));
        stage.conditions.noise = random.between(1.0, 4.0);
        let drift = random.between(-0.01, 0.01);
        let movers: Vec<Mover> = (0..=scene % 4).map(|_| Mover::random(&mut random)).collect();
        for frame in 0..25 {
            stage.conditions.gain += drift;
            let solids: Vec<Solid> = movers.iter().map(|mover| mover.at(frame)).collect();
            let report = stage.step(&solids);
            frames += 1;
            for solid in &solids {
                things += 1;
                let is_covered = cover_together(&report.obstacles, solid);
                assert!(is_covered, "scene {scene}, frame {frame}: {solid:?}\n{:#?}", report.obstacles);
            }
            for obstacle in report.obstacles.iter().filter(|o| o.change != Change::Left) {
                told += 1;
                // What is seen of a thing lies between it and where the ray over its top meets the floor.
                let reach = |solid: &Solid| solid.z_to_m * 0.9 + 0.5;
                let is_near = solids.iter().any(|s| (stage::middle(s) - obstacle.centre_m).length() < reach(s));
                assert!(is_near, "scene {scene}, frame {frame}: nothing is at {:?}", obstacle.centre_m);
            }
        }
    }
    println!("{frames} frames, {things} things all covered, {told} obstacles told");
    assert!(told > frames);
}
