//! A camera of which only the floor is known.

mod stage;

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{Conditions, Renderer, Solid};
use elbowroom_vision::{Channels, FloorHomography, Frame, PixelMask, Point2, Settings, Template, Vision};

/// The crate's place told by a watcher that knows four points of the floor, and maybe where the camera hangs.
fn place_told(knows_eye: bool) -> (Point2, bool) {
    let camera = stage::camera(640, 480);
    let seen = [(20.0, 20.0), (620.0, 30.0), (610.0, 450.0), (30.0, 460.0)].map(|(x, y)| Point2::new(x, y));
    let at = seen.map(|p| camera.pixel_to_plane(p, 0.0).unwrap());
    let floor = FloorHomography::from_points(640, 480, &seen, &at).unwrap();
    let floor = if knows_eye { floor.seen_from(camera.eye_in_world()) } else { floor };
    let templates = vec![Template::new("crate", 0.6, 0.4, 0.3)];
    let mut vision = Vision::new(floor.into(), Settings { templates, ..Settings::default() }).unwrap();
    let mut renderer = Renderer::new(camera, Channels::Grey, 3);
    let (mut frame, mut arm) = (Frame::default(), PixelMask::new(640, 480));
    arm.hide_polygon(&[Point2::new(0.0, 0.0), Point2::new(40.0, 0.0), Point2::new(0.0, 40.0)], 3.0);
    let crate_here = Solid::cuboid(Point2::new(0.9, 0.4), Vec3::new(0.6, 0.4, 0.3), 0.3, 220);
    for i in 0..40_u32 {
        let solids = if i < 30 { &[][..] } else { std::slice::from_ref(&crate_here) };
        let conditions = Conditions { seed: u64::from(i) + 1, ..Conditions::default() };
        renderer.render(solids, &[], &conditions, &mut frame).unwrap();
        frame.stamp_s = f64::from(i);
        vision.process(&frame, Some(&arm)).unwrap();
    }
    let told = &vision.report().obstacles[0];
    assert!(stage::covers(told, &crate_here));
    (told.centre_m - Point2::new(0.9, 0.4), told.kind.is_some())
}

#[test]
fn the_camera_s_place_makes_heights_known() {
    let (error, is_known) = place_told(true);
    assert!(is_known && error.length() < 0.01, "{error:?}");
    // Without it the outline is taken as it is: larger, off, and safe.
    let (error, _) = place_told(false);
    assert!(error.length() > 0.02, "{error:?}");
}
