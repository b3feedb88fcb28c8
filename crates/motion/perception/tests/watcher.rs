//! A camera above a KR125: rejected input, and that rejected input never frees a cell.

use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_perception::{ObstacleWatcher, PerceptionError, PerceptionSettings, WatchedRobot};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{
    Calibration, Camera, CameraTrackerSettings, Channels, FloorHomography, Frame, FrameStatus, Intrinsics, Point2,
    TrackSettings,
};

const PERIOD_S: f64 = 0.04;
const LEARNING: u32 = 30;
const A: [f64; 6] = [60.0, -31.1, 76.6, 0.0, 44.5, 0.0];

fn radians(degrees: [f64; 6]) -> Vec<f64> {
    degrees.iter().map(|d| d.to_radians()).collect()
}

fn robot() -> WatchedRobot {
    let urdf = elbowroom_testkit::folder::model("kr125");
    WatchedRobot { robot: load(&urdf, &LoadOptions::default()).unwrap().robot, base_in_world: Pose::IDENTITY }
}

fn camera() -> Camera {
    let lens = Intrinsics::pinhole(320, 240, 0.92);
    Camera::look_at(lens, Vec3::new(1.7, 0.0, 6.5), Vec3::new(1.7, 0.0, 0.0), Vec3::Y).unwrap()
}

fn new(camera: Calibration, settings: PerceptionSettings) -> Result<ObstacleWatcher, PerceptionError> {
    let WatchedRobot { robot, base_in_world } = robot();
    let axes = [0, 1, 2].map(|i| {
        let joint = &robot.chain.joints()[robot.chain.active_joints()[i].0];
        GridAxis::new(joint.name.clone(), joint.limits.lower, joint.limits.upper, 6.0_f64.to_radians()).unwrap()
    });
    let (grid, of_map) = (Grid::new(axes).unwrap(), CoverMapSettings::default());
    let builder =
        CoverMapBuilder::new(&robot, base_in_world, &grid, [0, 1, 2], RemainingJoints::Swept, of_map).unwrap();
    let area_m = [(0.75, -3.0), (4.8, -3.0), (4.8, 3.0), (0.75, 3.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
    let tracker = CameraTrackerSettings {
        track: TrackSettings { area_m, uncertainty_m: 0.06, ..TrackSettings::default() },
        learning_frames: LEARNING,
        ..CameraTrackerSettings::default()
    };
    ObstacleWatcher::new(vec![WatchedRobot { robot, base_in_world }], builder, camera, tracker, settings)
}

/// A watcher that has learnt the empty floor, below an arm that swings, and the rendered frames.
struct WatchedCell {
    watcher: ObstacleWatcher,
    robot: WatchedRobot,
    renderer: Renderer,
    pictures: u32,
}

impl WatchedCell {
    fn new() -> Self {
        let watcher = new(camera().into(), PerceptionSettings::default()).unwrap();
        let mut cell =
            Self { watcher, robot: robot(), renderer: Renderer::new(camera(), Channels::Grey, 9), pictures: 0 };
        for n in 0..LEARNING {
            let share = (f64::from(n) / f64::from(LEARNING - 1) * std::f64::consts::TAU).cos();
            let q = radians([60.0 * share, A[1], A[2], A[3], A[4], A[5]]);
            let frame = cell.picture(&[], &q);
            let update = cell.watcher.process_frame(&frame, &[&q]).unwrap();
            assert!(matches!(update.status, FrameStatus::Learning { .. }));
        }
        cell
    }

    /// Renders the next frame.
    fn picture(&mut self, solids: &[RenderedSolid], q: &[f64]) -> Frame {
        let painted: Vec<_> = self.robot.parts(q).into_iter().map(|part| (part, 235)).collect();
        let conditions = RenderConditions { seed: self.pictures.into(), ..RenderConditions::default() };
        let mut frame = Frame::default();
        self.renderer.render(solids, &painted, &conditions, &mut frame).unwrap();
        frame.stamp_s = f64::from(self.pictures) * PERIOD_S;
        self.pictures += 1;
        frame
    }
}

#[test]
fn rejected_frames_have_a_reason_and_free_no_cells() {
    let (mut cell, q) = (WatchedCell::new(), radians(A));
    let trolley = RenderedSolid::cuboid(Point2::new(1.9, 0.0), Vec3::new(0.5, 0.5, 1.5), 0.0, 215);
    let picture = cell.picture(std::slice::from_ref(&trolley), &q);
    let update = cell.watcher.process_frame(&picture, &[&q]).unwrap();
    let blocked = cell.watcher.map().occupancy().blocked();
    assert!(update.is_accepted() && update.entered.len() == 1 && blocked > 0);
    let empty = cell.picture(&[], &q);
    let mut small = Frame::default();
    small.fill(8, 6, Channels::Grey, |bytes| bytes.resize(48, 7)).unwrap();
    small.stamp_s = 10.0;
    let stamped = |stamp_s: f64| {
        let mut frame = empty.clone();
        frame.stamp_s = stamp_s;
        frame
    };
    let mut refuse = |frame: &Frame, q: &[f64]| {
        let error = cell.watcher.process_frame(frame, &[q]).unwrap_err().to_string();
        assert_eq!(cell.watcher.map().occupancy().blocked(), blocked, "{error}");
        error
    };
    assert!(refuse(&small, &q).contains("320"));
    assert!(refuse(&stamped(0.1), &q).contains("0.1"));
    assert!(refuse(&stamped(f64::NAN), &q).contains("NaN"));
    assert!(refuse(&empty, &q[..5]).contains("5 joint values"));
    assert!(refuse(&empty, &[f64::NAN; 6]).contains("finite"));
    // A white frame does not show the cell: it is rejected, and its status states the reason.
    let mut white = stamped(empty.stamp_s);
    white.pixels_mut().fill(255);
    let update = cell.watcher.process_frame(&white, &[&q]).unwrap();
    assert!(matches!(update.status, FrameStatus::Rejected(_)) && update.prisms.len() == 1);
    assert_eq!(cell.watcher.map().occupancy().blocked(), blocked);
    // A valid frame afterwards is accepted.
    let next = cell.picture(std::slice::from_ref(&trolley), &q);
    assert!(cell.watcher.process_frame(&next, &[&q]).unwrap().is_accepted());
}

#[test]
fn cameras_without_lens_and_settings_out_of_range_are_refused() {
    let settings = PerceptionSettings::default();
    assert!(new(Calibration::Missing, settings).unwrap_err().to_string().contains("calibrat"));
    let corners = [(-1.5, -2.4), (4.9, -2.4), (4.9, 2.4), (-1.5, 2.4)].map(|(x, y)| Point2::new(x, y));
    let pixels = [(0.0, 240.0), (320.0, 240.0), (320.0, 0.0), (0.0, 0.0)].map(|(x, y)| Point2::new(x, y));
    let floor = FloorHomography::from_points(320, 240, &pixels, &corners).unwrap();
    assert!(new(floor.into(), settings).unwrap_err().to_string().contains("Camera::new"));
    let bad = PerceptionSettings { prediction_s: f64::NAN, ..settings };
    assert!(matches!(new(camera().into(), bad), Err(PerceptionError::Setting { name: "prediction_s", .. })));
}
