//! tmp
use elbowroom_cspace::*;
use elbowroom_spatial::Vec3;
use std::time::{Duration, Instant};
#[cfg(unix)]
fn processor_time() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}
fn main() {
    for step in [2.0, 1.0] {
        let axis = |n: &str, a: f64, b: f64| Axis::from_degrees(n, a, b, step).unwrap();
        let grid = Grid::new([axis("a", -170.0, 170.0), axis("b", -90.0, 90.0), axis("c", -120.0, 150.0)]).unwrap();
        let mut f = Filler::new(PlanarArm::KR125_SIZED, &grid).unwrap();
        for o in [
            Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25).unwrap(),
            Obstacle::cuboid(
                elbowroom_spatial::Pose::from_xyz_rpy([1.3, 0.4, 0.9], [0.0, 0.0, 30f64.to_radians()]),
                Vec3::new(0.25, 0.2, 0.3),
            )
            .unwrap(),
            Obstacle::cuboid(
                elbowroom_spatial::Pose::from_xyz_rpy([1.3, 0.4, 0.9], [0.4, 0.7, 30f64.to_radians()]),
                Vec3::new(0.25, 0.2, 0.3),
            )
            .unwrap(),
        ] {
            let mut l = Layer::new();
            let mut t = Table::new(grid.shape());
            let (mut b1, mut b2) = (Duration::MAX, Duration::MAX);
            for _ in 0..200 {
                let t0 = processor_time();
                f.fill(&o, &mut l);
                let t1 = processor_time();
                t.clear();
                t.add(&l);
                let t2 = processor_time();
                b1 = b1.min(t1 - t0);
                b2 = b2.min(t2 - t1);
            }
            println!("{step} fill {b1:?} mark {b2:?} blocked {} spans {}", t.blocked(), l.spans().len());
        }
    }
    let _ = Instant::now();
}
