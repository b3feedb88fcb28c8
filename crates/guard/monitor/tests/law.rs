//! Comparison of the override law with an oracle that has the case distinctions of Romanelli 2011 (eqs. 1-4).

use crate::common::{RandomGeometry, XorshiftStar, configuration, gantry};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{Guards, Monitor, Region, Snapshot, Volume};
use elbowroom_spatial::{Rotation, Vec3};
use elbowroom_testkit::extent::amount;

/// Number of regions per monitor: building a monitor costs more than a tick.
const PER_MONITOR: usize = 100;

/// Number of points per shape: a million with `ELBOWROOM_LONG=1`.
fn points() -> usize {
    amount(200_000, 1_000_000)
}

/// Builds a region and the oracle's distance function for a point.
type Sample = fn(&mut XorshiftStar, Rotation) -> (Region, Box<dyn Fn(Vec3) -> f64>);

fn sphere(r: &mut XorshiftStar, _: Rotation) -> (Region, Box<dyn Fn(Vec3) -> f64>) {
    let (center, radius) = (r.vec3(1.0), r.between(0.0, 1.0));
    // Eq. 1: d is the distance to the centre.
    (Region::sphere("s", center, radius), Box::new(move |p| p.distance(center) - radius))
}

fn cylinder(r: &mut XorshiftStar, rotation: Rotation) -> (Region, Box<dyn Fn(Vec3) -> f64>) {
    let (base, radius, h) = (r.vec3(1.0), r.between(0.0, 1.0), r.between(0.0, 2.0));
    let oracle = move |p: Vec3| {
        let local = rotation.inverse() * (p - base);
        let d1 = (local.x * local.x + local.y * local.y).sqrt();
        let d2 = if local.z > h { local.z - h } else { -local.z };
        // Eq. 2: beside, above or below, and towards the rim.
        match (d1 <= radius, (0.0..=h).contains(&local.z)) {
            (true, true) => 0.0,
            (false, true) => d1 - radius,
            (true, false) => d2,
            (false, false) => ((d1 - radius).powi(2) + d2 * d2).sqrt(),
        }
    };
    (Region::cylinder("c", base, radius, h, rotation), Box::new(oracle))
}

fn plane(r: &mut XorshiftStar, rotation: Rotation) -> (Region, Box<dyn Fn(Vec3) -> f64>) {
    let origin = r.vec3(1.0);
    let (x, y) = (rotation * Vec3::X, rotation * Vec3::Y);
    let normal = x.cross(y);
    // Eq. 3: the distance to the surface; the region is below it.
    let oracle = move |p: Vec3| normal.x * (p.x - origin.x) + normal.y * (p.y - origin.y) + normal.z * (p.z - origin.z);
    (Region::plane("p", origin, origin + x * 0.7, origin + x * 0.2 + y * 1.3).unwrap(), Box::new(oracle))
}

fn cuboid(r: &mut XorshiftStar, rotation: Rotation) -> (Region, Box<dyn Fn(Vec3) -> f64>) {
    let (base, size) = (r.vec3(1.0), r.vec3(1.0).abs());
    let oracle = move |p: Vec3| {
        let local = rotation.inverse() * (p - base);
        let low = Vec3::new(-size.x / 2.0, -size.y / 2.0, 0.0);
        let high = Vec3::new(size.x / 2.0, size.y / 2.0, size.z);
        // 27 sectors: inside, 6 slabs, 12 quarter cylinders, 8 sphere octants.
        let out = |i: usize| if local[i] < low[i] { low[i] - local[i] } else { (local[i] - high[i]).max(0.0) };
        match [out(0), out(1), out(2)] {
            [a, 0.0, 0.0] | [0.0, a, 0.0] | [0.0, 0.0, a] => a,
            [a, b, 0.0] | [a, 0.0, b] | [0.0, a, b] => (a * a + b * b).sqrt(),
            [a, b, c] => (a * a + b * b + c * c).sqrt(),
        }
    };
    (Region::cuboid("b", base, size, rotation), Box::new(oracle))
}

/// The largest deviation of the override over random regions, points and programmed overrides.
fn worst_deviation(sample: Sample, turned: bool, seed: u64) -> (f64, usize) {
    let mut r = XorshiftStar(seed);
    let (mut worst, mut warned) = (0.0_f64, 0);
    for _ in 0..points() / PER_MONITOR {
        let rotation =
            if turned { Rotation::from_axis_angle(r.direction(), r.between(-3.1, 3.1)) } else { Rotation::IDENTITY };
        let (region, oracle) = sample(&mut r, rotation);
        let warning = r.between(0.05, 2.0);
        let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
        let config = configuration(gantry(), volumes, vec![region.warning(warning).guards(Guards::TCP)]);
        let mut monitor = Monitor::new(config, None).unwrap();
        for i in 0..PER_MONITOR {
            let p = r.vec3(2.5);
            let v0 = r.unit();
            let q = [p.x, p.y, p.z, 0.0, 0.0, 0.0];
            let now_s = 10.0 * i as f64;
            let report = monitor.tick(&Snapshot { programmed_override: v0, ..Snapshot::stationary(now_s, &q) });
            let expected = v0 * (oracle(p) / warning).clamp(0.0, 1.0);
            worst = worst.max((report.speed_override - expected).abs());
            warned += usize::from(expected > 0.0 && expected < v0);
        }
    }
    (worst, warned)
}

#[test]
fn the_override_is_the_law_of_s1_for_every_shape_and_pose() {
    let shapes: [(&str, Sample); 4] =
        [("sphere", sphere), ("cylinder", cylinder), ("plane", plane), ("parallelepiped", cuboid)];
    for (seed, (name, sample)) in shapes.into_iter().enumerate() {
        for turned in [false, true] {
            let (worst, warned) = worst_deviation(sample, turned, 1 + seed as u64);
            println!(
                "{name:15} turned {turned:5}: {} points, {warned} in warning zones, worst deviation {worst:.1e}",
                points()
            );
            assert!(worst < 1e-12 && warned > points() / 20, "{name} {turned}: {worst}");
        }
    }
}

#[test]
fn many_regions_combine_by_the_minimum() {
    let mut r = XorshiftStar(77);
    for _ in 0..200 {
        let mut oracles = vec![];
        let mut regions = vec![];
        for i in 0..30 {
            let shapes: [Sample; 3] = [sphere, cylinder, cuboid];
            let rotation = Rotation::from_axis_angle(r.direction(), r.between(-3.1, 3.1));
            // One plane is sufficient: it forbids half of all points.
            let sample = if i == 0 { plane } else { shapes[(r.bits() % 3) as usize] };
            let (mut region, oracle) = sample(&mut r, rotation);
            region.name = format!("{i}");
            let warning = r.between(0.05, 1.0);
            regions.push(region.warning(warning).guards(Guards::TCP));
            oracles.push(move |p: Vec3| (oracle(p) / warning).clamp(0.0, 1.0));
        }
        let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
        let mut monitor = Monitor::new(configuration(gantry(), volumes, regions), None).unwrap();
        for i in 0..50 {
            let p = r.vec3(2.5);
            let report = monitor.tick(&Snapshot::stationary(10.0 * f64::from(i), &[p.x, p.y, p.z, 0.0, 0.0, 0.0]));
            let factors: Vec<f64> = oracles.iter().map(|o| o(p)).collect();
            let expected = factors.iter().fold(1.0_f64, |a, b| a.min(*b));
            assert!((report.speed_override - expected).abs() < 1e-12);
            if let Some(region) = report.reason.region() {
                assert!((factors[region.0] - expected).abs() < 1e-12);
            }
        }
    }
}
