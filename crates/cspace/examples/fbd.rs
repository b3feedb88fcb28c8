//! Throw-away.
#![allow(missing_docs, clippy::all, clippy::pedantic)]
use elbowroom_cspace::*;
use elbowroom_spatial::{Pose, Vec3};
fn main() {
    let axis = |name: &str, lo, hi| Axis::from_degrees(name, lo, hi, 2.0).unwrap();
    let grid = Grid::new([axis("base", -170.0, 170.0), axis("shoulder", -90.0, 90.0), axis("elbow", -120.0, 150.0)]).unwrap();
    let a: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let o = Obstacle::cuboid(Pose::from_xyz_rpy([a[0], a[1], a[2]], [a[3], a[4], a[5]]), Vec3::new(a[6], a[7], a[8])).unwrap();
    let mut f = Filler::new(PlanarArm::KR125_SIZED, &grid).unwrap();
    let mut l = Layer::new();
    f.fill(&o, &mut l); if std::env::var("ST").is_ok() { f.fill(&o, &mut l); }
    for s in l.spans() { println!("{} {} {} {}", s.row / 90, s.row % 90, s.first, s.last); }
}
