#![allow(missing_docs)]
use elbowroom_proximity::*;
use elbowroom_spatial::*;
fn main() {
    let a = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.07, 0.045, 0.17) });
    let b = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.75, 0.05, 0.75) });
    let pa = Pose::new(Rotation::from_rpy(0.1, 0.2, 0.3), Vec3::new(0.1, 0.03, 0.5));
    let pb = Pose::new(Rotation::from_rpy(0.0, 0.0, 0.1745), Vec3::new(0.0, 0.8, 0.75));
    println!("{:?}", separation(&a, &pa, &b, &pb));
    println!("{:?}", separation_within(&a, &pa, &b, &pb, 0.3));
    println!("{:?}", separation_within(&a, &pa, &b, &pb, 2.0));
    println!("{:?}", separation(&b, &pb, &a, &pa));
}
