//! Invalid input (files, sizes, order, illumination) and its messages.

use crate::synthetic;
use std::path::Path;

use crate::synthetic::SyntheticScene;
use elbowroom_spatial::Vec3;
use elbowroom_vision::render::RenderedSolid;
use elbowroom_vision::{
    Calibration, Camera, CameraTracker, CameraTrackerSettings, Channels, FloorHomography, Frame, FrameSource,
    FrameStatus, ImageFiles, Intrinsics, ObstacleChange, PixelMask, Point2, RawLayout, RejectReason, TrackSettings,
    VisionError, decode, encode_png,
};
use proptest::prelude::*;

fn message(result: Result<(), VisionError>) -> String {
    result.expect_err("must be refused").to_string()
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let pixels: Vec<u8> = (0..width * height).map(|i| (i * 7 % 251) as u8).collect();
    let frame = Frame::new("", width as usize, height as usize, Channels::Grey, pixels).unwrap();
    encode_png(&frame).unwrap()
}

#[test]
fn a_missing_calibration_is_refused_with_a_hint() {
    let error = CameraTracker::new(Calibration::Missing, CameraTrackerSettings::default()).unwrap_err();
    assert_eq!(error, VisionError::NotCalibrated);
    assert!(error.to_string().contains("FloorHomography::from_points"));
}

#[test]
fn a_camera_with_a_visible_horizon_is_refused() {
    let lens = Intrinsics::pinhole(64, 48, 1.2);
    let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 2.0), Vec3::new(5.0, 0.0, 1.9), Vec3::Z).unwrap();
    let error = CameraTracker::new(camera.into(), CameraTrackerSettings::default()).unwrap_err();
    assert!(error.to_string().contains("tilt the camera down"), "{error}");
}

#[test]
fn every_image_format_is_read_and_truncated_files_are_refused() {
    let mut frame = Frame::default();
    let whole = png(20, 10);
    decode(&whole, Path::new("a.png"), None, &mut frame).unwrap();
    assert_eq!((frame.width(), frame.height(), frame.channels(), frame.row(0)[1]), (20, 10, Channels::Grey, 7));
    for length in 0..whole.len() - 12 {
        let text = message(decode(&whole[..length], Path::new("a.png"), None, &mut frame));
        assert!(text.starts_with("a.png: ") && text.contains("write: "), "{length}: {text}");
        assert_eq!(frame.width(), 0, "{length}: half a picture must not pass for one");
    }
    for text in ["P2\n# by hand\n3 1\n255\n1 2 3\n", "P5\n3 1\n255\n\x01\x02\x03"] {
        decode(text.as_bytes(), Path::new("a.pgm"), None, &mut frame).unwrap();
        assert_eq!(frame.pixels(), [1, 2, 3]);
    }
    decode(b"P6\n1 1\n255\n\x01\x02\x03", Path::new("a.ppm"), None, &mut frame).unwrap();
    assert_eq!((frame.channels(), frame.pixels()), (Channels::Rgb, &[1, 2, 3][..]));
    for bad in
        ["P5\n3 1\n255\n\x01\x02", "P5\n0 1\n255\n", "P5\n99999 99999\n255\n\x01", "P5\n16000 16000\n255\n\x01", "P5"]
    {
        let text = message(decode(bad.as_bytes(), Path::new("a.pgm"), None, &mut frame));
        assert!(text.starts_with("a.pgm: "), "{text}");
    }
}

#[test]
fn raw_bytes_need_a_layout_that_fits() {
    let mut frame = Frame::default();
    let raw = |width, height| Some(RawLayout { width, height, channels: Channels::Grey });
    decode(&[1, 2, 3, 4, 5, 6], Path::new("a.raw"), raw(3, 2), &mut frame).unwrap();
    assert_eq!(frame.row(1), [4, 5, 6]);
    let text = message(decode(&[1; 6], Path::new("a.raw"), None, &mut frame));
    assert!(text.contains("width, height and channels"), "{text}");
    let text = message(decode(&[1; 6], Path::new("a.raw"), raw(4, 2), &mut frame));
    assert_eq!(text, "a.raw: 4 x 2 pixels of 1 byte(s) need 8 bytes, but there are 6");
    assert!(message(decode(&[1; 6], Path::new("a.raw"), raw(usize::MAX, 2), &mut frame)).contains("bytes"));
    assert!(message(decode(&[1; 6], Path::new("a.raw"), raw(0, 2), &mut frame)).contains("empty"));
    assert!(message(decode(b"GIF89a", Path::new("a.gif"), None, &mut frame)).contains("PNG, PGM, PPM or raw"));
    assert!(message(decode(b"", Path::new("a.png"), None, &mut frame)).contains("is empty"));
}

#[test]
fn a_folder_is_read_in_the_order_of_names_and_continues_after_a_bad_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("frame_010.png", &png(4, 4));
    write("frame_002.pgm", b"P5\n2 1\n255\n\x01\x02");
    write("frame_005.png", &png(4, 4)[..30]);
    write("notes.txt", b"nothing");
    let mut files = ImageFiles::folder(folder.path(), 0.1).unwrap();
    let mut frame = Frame::default();
    assert!(files.next_frame(&mut frame).unwrap() && frame.width() == 2);
    assert!(files.next_frame(&mut frame).unwrap_err().to_string().contains("frame_005.png"));
    assert!(files.next_frame(&mut frame).unwrap() && frame.width() == 4 && (frame.stamp_s - 0.2).abs() < 1e-12);
    assert!(!files.next_frame(&mut frame).unwrap());
    let empty = tempfile::tempdir().unwrap();
    assert!(ImageFiles::folder(empty.path(), 0.1).unwrap_err().to_string().contains("holds no picture"));
    assert!(ImageFiles::folder(Path::new("no/such/folder"), 0.1).is_err());
}

#[test]
fn frames_of_the_wrong_size_channels_or_time_are_refused_and_obstacles_stay() {
    let mut scene =
        SyntheticScene::new(64, 48, CameraTrackerSettings { learning_frames: 4, ..CameraTrackerSettings::default() });
    let object = RenderedSolid::cuboid(Point2::new(0.0, 0.0), Vec3::new(1.0, 1.0, 0.3), 0.0, 230);
    assert_eq!(scene.step(std::slice::from_ref(&object)).obstacles.len(), 1);
    let refuse = |tracker: &mut CameraTracker, frame: Frame| tracker.process(&frame, None).unwrap_err().to_string();
    let grey =
        |w: usize, h: usize, t: f64| Frame::new("f.png", w, h, Channels::Grey, vec![9; w * h]).unwrap().with_stamp(t);
    let tracker = &mut scene.tracker;
    assert!(refuse(tracker, grey(64, 47, 9.0)).contains("f.png: the frame has 64 x 47 pixels"));
    assert!(refuse(tracker, Frame::default()).contains("empty"));
    assert!(refuse(tracker, grey(64, 48, 0.0)).contains("send frames in order"));
    assert!(refuse(tracker, grey(64, 48, f64::NAN)).contains("in order"));
    // A camera that repeats its last image does not observe the cell.
    let last_s = scene.frame.stamp_s;
    assert!(refuse(tracker, grey(64, 48, last_s)).contains("in order"));
    let rgb = Frame::new("f.png", 64, 48, Channels::Rgb, vec![9; 3 * 64 * 48]).unwrap().with_stamp(9.0);
    assert!(refuse(tracker, rgb).contains("the frame is RGB, but those before it were grey"));
    let mask = PixelMask::new(64, 40);
    assert!(tracker.process(&grey(64, 48, 9.0), Some(&mask)).unwrap_err().to_string().contains("mask of the arm"));
    assert_eq!(tracker.report().obstacles.len(), 1);
    assert_eq!(scene.step(&[object]).obstacles[0].change, ObstacleChange::Unchanged);
}

#[test]
fn a_rejected_frame_changes_no_obstacle() {
    let object = RenderedSolid::cuboid(Point2::new(0.2, -0.3), Vec3::new(0.6, 0.4, 0.3), 0.0, 230);
    let spoil: [fn(&mut Frame); 4] = [
        |frame| frame.pixels_mut().fill(0),
        |frame| frame.pixels_mut().fill(255),
        |frame| frame.pixels_mut().fill(120),
        |frame| frame.pixels_mut().reverse(),
    ];
    for (i, spoil) in spoil.into_iter().enumerate() {
        let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings::default());
        let before = scene.step(std::slice::from_ref(&object)).obstacles.clone();
        let mut frame = scene.frame.clone();
        spoil(&mut frame);
        frame.stamp_s += 0.01;
        let report = scene.tracker.process(&frame, None).unwrap();
        let is_rejected = matches!(report.status, FrameStatus::Rejected(_));
        assert!(is_rejected || !report.obstacles.is_empty(), "{i}: {:?}", report.status);
        if is_rejected {
            assert_eq!(report.obstacles[0].footprint_m, before[0].footprint_m, "{i}");
            assert!(report.obstacles[0].is_unobserved && report.obstacles[0].change == ObstacleChange::Unchanged);
        }
        assert_eq!(i < 2, is_rejected && i < 2, "{i}: {:?}", report.status);
    }
}

#[test]
fn a_much_darker_frame_is_rejected_and_a_little_darker_one_is_not() {
    for (gain, is_rejected) in [(0.3, true), (0.5, false), (1.9, false)] {
        let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings::default());
        scene.conditions.gain = gain;
        let status = scene.step(&[]).status;
        assert_eq!(
            matches!(status, FrameStatus::Rejected(RejectReason::Illumination(_))),
            is_rejected,
            "{gain}: {status:?}"
        );
        assert!(is_rejected || status == FrameStatus::Accepted, "{gain}: {status:?}");
    }
}

#[test]
fn an_object_that_covers_the_lens_rejects_the_frame() {
    let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings::default());
    let sheet = RenderedSolid::cuboid(Point2::new(0.6, -0.3), Vec3::new(3.6, 6.0, 0.2), 0.0, 250);
    let status = scene.step(&[sheet]).status;
    assert!(matches!(status, FrameStatus::Rejected(_)), "{status:?}");
}

#[test]
fn settings_out_of_range_are_named() {
    let camera: Calibration = synthetic::camera(64, 48).into();
    let refuse = |settings| CameraTracker::new(camera.clone(), settings).unwrap_err().to_string();
    let base = CameraTrackerSettings::default;
    let tracking = |track| CameraTrackerSettings { track, ..base() };
    assert!(
        refuse(tracking(TrackSettings { uncertainty_m: f64::NAN, ..base().track })).contains("`uncertainty_m` is NaN")
    );
    assert!(refuse(CameraTrackerSettings { learning_frames: 0, ..base() }).contains("learning_frames"));
    assert!(
        refuse(tracking(TrackSettings { area_m: vec![Point2::default(); 2], ..base().track }))
            .contains("three or more")
    );
    assert!(refuse(tracking(TrackSettings { floor_z_m: f64::INFINITY, ..base().track })).contains("floor_z_m"));
    let flat = elbowroom_vision::Template::new("sheet", 1.0, 1.0, 0.0);
    assert!(refuse(CameraTrackerSettings { templates: vec![flat], ..base() }).contains("templates"));
}

#[test]
fn folding_distortion_and_invalid_poses_are_refused() {
    let lens = Intrinsics::pinhole(640, 480, 1.2);
    let eye = Vec3::new(0.0, 0.0, 3.0);
    let refuse = |lens| Camera::look_at(lens, eye, Vec3::ZERO, Vec3::Y).unwrap_err().to_string();
    assert!(refuse(Intrinsics { radial: [-0.9, 0.0, 0.0], ..lens }).contains("folds"));
    assert!(refuse(Intrinsics { fx: 0.0, ..lens }).contains("positive"));
    assert!(refuse(Intrinsics { cx: f64::NAN, ..lens }).contains("finite"));
    assert!(refuse(Intrinsics { width: 0, ..lens }).contains("empty"));
    assert!(Camera::look_at(lens, eye, eye, Vec3::Y).is_err());
    assert!(Camera::look_at(lens, eye, Vec3::ZERO, Vec3::Z).is_err());
}

#[test]
fn a_homography_does_not_determine_the_silhouette_of_the_arm() {
    let corners = [(0.0, 0.0), (64.0, 0.0), (64.0, 48.0), (0.0, 48.0)].map(|(x, y)| Point2::new(x, y));
    let floor = FloorHomography::from_points(64, 48, &corners, &corners).unwrap();
    let error = PixelMask::new(64, 48).mask_arm(&floor.into(), &[], 0.0).unwrap_err();
    assert_eq!(error, VisionError::NeedsCamera);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Damaged files are rejected or read; they never cause a panic.
    #[test]
    fn damaged_images_never_panic(at in 0_usize..200, to in any::<u8>(), is_png in any::<bool>()) {
        let mut bytes = if is_png { png(12, 9) } else { b"P2\n3 2\n255\n1 2 3 4 5 6\n".to_vec() };
        let n = bytes.len();
        bytes[at % n] = to;
        let mut frame = Frame::default();
        if decode(&bytes, Path::new("damaged"), None, &mut frame).is_err() {
            prop_assert_eq!(frame.width(), 0);
        }
    }
}
