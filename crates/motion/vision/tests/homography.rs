//! A camera calibrated by a homography of the floor.

use crate::synthetic;
use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{
    CameraTracker, CameraTrackerSettings, Channels, FloorHomography, Frame, PixelMask, Point2, Template,
};

/// The error of the crate's position with a calibration by four points of the floor and, optionally, the camera's
/// position; and whether its template matched.
fn reported_position(with_eye: bool) -> (Point2, bool) {
    let camera = synthetic::camera(640, 480);
    let seen = [(20.0, 20.0), (620.0, 30.0), (610.0, 450.0), (30.0, 460.0)].map(|(x, y)| Point2::new(x, y));
    let at = seen.map(|p| camera.pixel_to_plane(p, 0.0).unwrap());
    let floor = FloorHomography::from_points(640, 480, &seen, &at).unwrap();
    let floor = if with_eye { floor.with_eye(camera.eye_in_world()) } else { floor };
    let templates = vec![Template::new("crate", 0.6, 0.4, 0.3)];
    let mut tracker =
        CameraTracker::new(floor.into(), CameraTrackerSettings { templates, ..CameraTrackerSettings::default() })
            .unwrap();
    let mut renderer = Renderer::new(camera, Channels::Grey, 3);
    let (mut frame, mut arm) = (Frame::default(), PixelMask::new(640, 480));
    arm.mask_polygon(&[Point2::new(0.0, 0.0), Point2::new(40.0, 0.0), Point2::new(0.0, 40.0)], 3.0);
    let crate_here = RenderedSolid::cuboid(Point2::new(0.9, 0.4), Vec3::new(0.6, 0.4, 0.3), 0.3, 220);
    for i in 0..40_u32 {
        let solids = if i < 30 { &[][..] } else { std::slice::from_ref(&crate_here) };
        let conditions = RenderConditions { seed: u64::from(i) + 1, ..RenderConditions::default() };
        renderer.render(solids, &[], &conditions, &mut frame).unwrap();
        frame.stamp_s = f64::from(i);
        tracker.process(&frame, Some(&arm)).unwrap();
    }
    let reported = &tracker.report().obstacles[0];
    assert!(synthetic::covers(reported, &crate_here));
    (reported.centre_m - Point2::new(0.9, 0.4), reported.kind.is_some())
}

#[test]
fn templates_need_the_position_of_the_camera() {
    let (error, is_known) = reported_position(true);
    assert!(is_known && error.length() < 0.01, "{error:?}");
    // Without the position, the projected outline is used: larger, displaced, and safe.
    let (error, _) = reported_position(false);
    assert!(error.length() > 0.02, "{error:?}");
}
