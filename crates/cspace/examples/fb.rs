//! Throw-away measuring.
#![allow(missing_docs, clippy::all, clippy::pedantic)]
use std::hint::black_box;
use elbowroom_cspace::{Axis, Filler, Grid, JointMap, Layer, Obstacle, PlanarArm, Table};
use elbowroom_spatial::{Pose, Vec3};
use rustix::time::{ClockId, clock_gettime};
fn now() -> f64 { let t = clock_gettime(ClockId::ThreadCPUTime); t.tv_sec as f64 * 1e6 + t.tv_nsec as f64 * 1e-3 }
fn best(n: usize, mut f: impl FnMut()) -> [f64; 2] {
    let mut v: Vec<f64> = (0..n).map(|_| { let t = now(); f(); now() - t }).collect();
    v.sort_by(f64::total_cmp);
    [v[0], v[n / 2]]
}
fn grid(step: f64) -> Grid {
    let axis = |name: &str, lo, hi| Axis::from_degrees(name, lo, hi, step).unwrap();
    Grid::new([axis("base", -170.0, 170.0), axis("shoulder", -90.0, 90.0), axis("elbow", -120.0, 150.0)]).unwrap()
}
fn main() {
    let reps: usize = std::env::args().nth(1).map_or(400, |a| a.parse().unwrap());
    let only = std::env::args().nth(2);
    let ball = |x: f64| Obstacle::sphere(Vec3::new(x, 0.4, 0.9), 0.25).unwrap();
    let bx = |x: f64, rpy: [f64; 3]| Obstacle::cuboid(Pose::from_xyz_rpy([x, 0.4, 0.9], rpy), Vec3::new(0.25, 0.2, 0.3)).unwrap();
    let yaw = 30f64.to_radians();
    let list = [
        ("sphere", ball(1.3), ball(1.31)),
        ("box", bx(1.3, [0.0, 0.0, yaw]), bx(1.31, [0.0, 0.0, yaw])),
        ("tilted", bx(1.3, [0.4, 0.7, 0.5]), bx(1.31, [0.4, 0.7, 0.5])),
        ("near axis", bx(0.2, [0.4, 0.7, 0.5]), bx(0.21, [0.4, 0.7, 0.5])),
    ];
    for step in [2.0, 1.0] {
        let grid = grid(step);
        for (name, a, b) in &list {
            let key = format!("{name}{step}");
            if only.as_ref().is_some_and(|o| *o != key) { continue; }
            let mut filler = Filler::new(PlanarArm::KR125_SIZED, &grid).unwrap();
            let (mut layer, mut table) = (Layer::new(), Table::new(grid.shape()));
            let fill = best(reps, || filler.fill(a, &mut layer));
            let whole = best(reps, || { filler.fill(a, &mut layer); table.clear(); table.add(&layer); });
            let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid).unwrap();
            map.set("it", a);
            map.set("it", b);
            let mv = best(reps, || { black_box(map.set("it", a)); black_box(map.set("it", b)); });
            println!("{key:12} fill {:7.2} {:7.2}  whole {:7.2} {:7.2}  move {:7.2} {:7.2} ({:.0} %) spans {} blocked {}", fill[0], fill[1], whole[0], whole[1], mv[0] / 2.0, mv[1] / 2.0, mv[1] / whole[1] * 50.0, layer.spans().len(), table.blocked());
        }
    }
}
