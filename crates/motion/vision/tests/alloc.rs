//! Frames allocate nothing once lists have grown. Runs without the test harness, whose threads also allocate: the
//! counter counts the whole process.

use std::sync::Arc;

use elbowroom_proximity::{Shape, Sphere, TriMesh, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{
    ArmPart, Camera, CameraTracker, CameraTrackerSettings, Channels, Frame, Intrinsics, PixelMask, Point2,
    ShadowSettings, Template, Visibility,
};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let lens = Intrinsics { radial: [-0.1, 0.0, 0.0], ..Intrinsics::pinhole(160, 120, 1.1) };
    let camera = Camera::look_at(lens, Vec3::new(0.0, -0.2, 4.0), Vec3::ZERO, Vec3::Y).unwrap();
    let templates = vec![Template::new("crate", 0.6, 0.4, 0.3)];
    let settings = CameraTrackerSettings {
        templates,
        shadows: Some(ShadowSettings::default()),
        learning_frames: 5,
        ..CameraTrackerSettings::default()
    };
    let mut tracker = CameraTracker::new(camera.clone().into(), settings).unwrap();
    let mut renderer = Renderer::new(camera, Channels::Rgb, 1);
    let (mut frame, mut mask) = (Frame::default(), PixelMask::new(160, 120));
    let (mut measured, mut reported) = (0, 0);
    // The same frames are repeated; in the first rounds the lists grow.
    for i in 0..325_u32 {
        let t = f64::from(i.saturating_sub(5) % 80) / 80.0;
        let solids = [
            RenderedSolid::cuboid(Point2::new(-1.0 + 2.0 * t, 0.1), Vec3::new(0.6, 0.4, 0.3), t, 220),
            RenderedSolid::cuboid(Point2::new(1.0 - 2.0 * t, -0.3), Vec3::new(0.4, 0.4, 0.3), t, 20),
        ];
        let arm = [ArmPart::Capsule { from: Vec3::new(0.0, 1.5, 1.0), to: Vec3::new(t, 0.0, 1.0), radius_m: 0.1 }];
        let conditions =
            RenderConditions { seed: 9 + u64::from(i.saturating_sub(5) % 80), ..RenderConditions::default() };
        let painted = [(arm[0].clone(), 230)];
        renderer.render(if i < 5 { &[] } else { &solids }, &painted, &conditions, &mut frame).unwrap();
        frame.stamp_s = f64::from(i) * 0.04;
        let counter = AllocationCounter::start();
        mask.clear();
        mask.mask_arm(tracker.calibration(), &arm, 0.02).unwrap();
        reported += tracker.process(&frame, Some(&mask)).unwrap().obstacles.len();
        let allocations = counter.allocations();
        if i >= 245 {
            measured += allocations;
        }
    }
    assert!(reported > 200, "{reported}");
    assert_eq!(measured, 0);
    what_a_camera_sees();
}

/// What parts hide of a solid is found without allocation, from the first time on.
fn what_a_camera_sees() {
    let camera = Camera::look_at(Intrinsics::pinhole(160, 120, 1.1), Vec3::Z * 2.0, Vec3::ZERO, Vec3::Y).unwrap();
    let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius: 0.2 }), 1e-3);
    let ball = Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()));
    let mut seen = Visibility::new(camera, &ball);
    let (mut hidden, counter) = (0, AllocationCounter::start());
    for k in 0..100 {
        let part = Pose::from_translation(Vec3::new(-0.5 + 0.01 * f64::from(k), 0.0, 0.5));
        hidden += usize::from(seen.hidden_share(&Pose::IDENTITY, [(&ball, part)]).unwrap() > 0.3);
        hidden += usize::from(seen.hides_more_than(0.3, &Pose::IDENTITY, [(&ball, part)]));
    }
    let allocations = counter.allocations();
    assert!((20..180).contains(&hidden), "{hidden}");
    assert_eq!(allocations, 0);
}
