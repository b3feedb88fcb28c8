//! Median and 99th percentile of each stage of [`CameraTracker`] on rendered frames of 640 × 480 pixels: four crossing
//! objects, two of which touch, an arm over them, noise and changing light.
//!
//! `cargo bench -p elbowroom-vision --bench frame_times -- [FRAMES [rgb]]`

#![expect(clippy::print_stdout, reason = "a program for people")]

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{
    ArmPart, Camera, CameraTracker, CameraTrackerSettings, Channels, Frame, Intrinsics, PixelMask, Point2,
    ShadowSettings, Template, VisionError,
};

fn main() -> Result<(), VisionError> {
    let mut arguments = elbowroom_testkit::bench::arguments();
    let frames = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(600);
    let channels = if arguments.next().as_deref() == Some("rgb") { Channels::Rgb } else { Channels::Grey };
    let lens = Intrinsics { radial: [-0.12, 0.02, 0.0], ..Intrinsics::pinhole(640, 480, 1.1) };
    let camera = Camera::look_at(lens, Vec3::new(0.3, -0.6, 4.0), Vec3::ZERO, Vec3::Y)?;
    let settings = CameraTrackerSettings {
        shadows: Some(ShadowSettings::default()),
        templates: vec![Template::new("crate", 0.6, 0.4, 0.3), Template::cylinder("drum", 0.5, 0.5)],
        ..CameraTrackerSettings::default()
    };
    let learning = settings.learning_frames;
    let mut tracker = CameraTracker::new(camera.clone().into(), settings)?;
    let mut renderer = Renderer::new(camera, channels, 1);
    let mut arm_mask = PixelMask::new(640, 480);
    let mut frame = Frame::default();
    let mut rows: Vec<Vec<Duration>> = Vec::new();
    let mut most = 0;
    for i in 0..learning + frames {
        let t = f64::from(i) * 0.033;
        let solids = if i < learning { Vec::new() } else { objects(t) };
        let arm = ArmPart::Capsule {
            from: Vec3::new(0.0, 1.6, 1.2),
            to: Vec3::new(1.5 * (t / 3.0).sin(), 0.3, 1.0),
            radius_m: 0.12,
        };
        let conditions = RenderConditions {
            gain: 1.0 + 0.1 * (t / 5.0).sin(),
            light: Some(Vec3::new(0.3, 0.2, -1.0)),
            seed: u64::from(i) + 1,
            ..RenderConditions::default()
        };
        frame.stamp_s = t;
        renderer.render(&solids, &[(arm.clone(), 220)], &conditions, &mut frame)?;
        let began = Instant::now();
        arm_mask.clear();
        arm_mask.mask_arm(tracker.calibration(), &[arm], 0.03)?;
        let masked = began.elapsed();
        let report = tracker.process(&frame, Some(&arm_mask))?;
        if i >= learning {
            let mut row = vec![masked];
            row.extend(report.timings.stages().map(|(_, time)| time));
            row.push(masked + report.timings.total());
            rows.push(row);
            most = most.max(report.obstacles.len());
        }
    }
    let stages = tracker.report().timings.stages();
    let names = std::iter::once("arm mask").chain(stages.iter().map(|(name, _)| *name)).chain(["total"]);
    println!("{frames} frames of 640 x 480, {channels}; up to {most} obstacles; milliseconds");
    println!("{:10} {:>8} {:>8}", "stage", "median", "p99");
    for (stage, name) in names.enumerate() {
        let mut times: Vec<Duration> = rows.iter().map(|row| row[stage]).collect();
        times.sort();
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
        println!("{name:10} {:8.3} {:8.3}", at(0.5), at(0.99));
    }
    Ok(())
}

/// Two crates that touch and separate, a drum on a circle, and an object without a template.
fn objects(t: f64) -> Vec<RenderedSolid> {
    let crate_size = Vec3::new(0.6, 0.4, 0.3);
    let gap = 0.75 + 0.5 * (t * TAU / 6.0).cos();
    vec![
        RenderedSolid::cuboid(Point2::new(-gap / 2.0, -0.6), crate_size, 0.0, 200),
        RenderedSolid::cuboid(Point2::new(gap / 2.0, -0.6), crate_size, 0.0, 25),
        RenderedSolid::cylinder(Point2::new(0.9 * (t / 2.0).cos(), 0.4 + 0.4 * (t / 2.0).sin()), 0.25, 0.5, 230),
        RenderedSolid::cuboid(Point2::new(-1.2, 0.6), Vec3::new(0.3, 0.7, 1.2), t / 4.0, 12),
    ]
}
