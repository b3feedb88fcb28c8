//! The simulation: frames are rendered and sent, ticks move the arm, the ground truth is checked.

use std::path::Path;
use std::time::Instant;

use elbowroom::kinematics::ChainState;
use elbowroom::perception::{
    ExecutorState, ExecutorStep, FrameEntry, GroundTruth, ObstacleUpdate, PerceptionLog, TickEntry,
};
use elbowroom::scene::Scene;
use elbowroom::spatial::Pose;
use elbowroom::vision::render::{RenderConditions, Renderer};
use elbowroom::vision::{ArmPart, Channels, Frame, Point2, encode_png};

use crate::ground_truth::GroundTruthChecker;
use crate::obstacles::MovingBox;
use crate::report_images::ReportImages;
use crate::station::{Failure, LATENCY_S, PERIOD_S, STATIONS, Station, TICK_S, radians};

/// Result of a run.
pub struct RunResult {
    pub log: PerceptionLog,
    /// Collisions: time and names.
    pub hits: Vec<(f64, String)>,
    pub arrivals: usize,
    pub coverage: Coverage,
}

/// How often the prisms contained the true obstacles.
#[derive(Debug, Default)]
pub struct Coverage {
    /// Obstacles fully in view, summed over the frames.
    pub visible: usize,
    /// Those of them that a prism contained until the next frame had been processed.
    pub contained: usize,
}

/// The frame as the camera sends it, with simulated faults: a lost connection, a truncated image.
fn encode_frame(t: f64, frame: &Frame) -> Result<Option<Vec<u8>>, Failure> {
    if (6.6..7.1).contains(&t) {
        return Ok(None); // connection lost
    }
    let mut bytes = encode_png(frame)?;
    if (t - 14.0).abs() < 1e-6 {
        bytes.truncate(bytes.len() / 2);
    }
    Ok(Some(bytes))
}

/// Runs the cell; images go to `images`.
pub fn run(
    station: &mut Station,
    obstacles: &[MovingBox],
    end_s: f64,
    images: &mut ReportImages,
) -> Result<RunResult, Failure> {
    let mut builder = Scene::builder();
    builder.robot("kr125", station.arm.robot.clone(), Pose::IDENTITY);
    for obstacle in obstacles {
        builder.object(obstacle.object());
    }
    let scene = builder.build()?;
    let mut q = radians(STATIONS[0]);
    let mut ground_truth = GroundTruthChecker::new(&scene, &q)?;
    let mut camera = CameraRenderer::new(station);
    let mut record = RunResult { log: log(obstacles), hits: vec![], arrivals: 0, coverage: Coverage::default() };
    let learning_s = f64::from(station.pipeline.tracker().settings().learning_frames) * PERIOD_S;
    let period_ticks = (PERIOD_S / TICK_S).round() as usize;
    let latency_ticks = (LATENCY_S / TICK_S).round() as usize;
    let mut sent: Option<SentFrame> = None;
    let mut next = 1;
    for tick in 0..(end_s / TICK_S) as usize {
        let t = tick as f64 * TICK_S;
        if tick.is_multiple_of(period_ticks) {
            sent = camera.render(station, obstacles, t, &q)?;
        }
        if tick % period_ticks == latency_ticks
            && let Some(sent) = sent.take()
        {
            let entry = process(station, &sent);
            if let Ok((update, result)) = &entry.result {
                count_contained(update, obstacles, &mut record.coverage);
                images.save(station, &sent.bytes, update, result)?;
            }
            record.log.frames.push(entry);
        }
        let step = if t < learning_s {
            learning_motion(t / learning_s)
        } else {
            if t < learning_s + TICK_S {
                station.executor.set_goal(&radians(STATIONS[next]))?;
            }
            station.executor.tick(t + TICK_S, TICK_S)
        };
        if t > learning_s + TICK_S && step.state == ExecutorState::Arrived && is_at(&step.q, STATIONS[next]) {
            (next, record.arrivals) = (1 - next, record.arrivals + 1);
            station.executor.set_goal(&radians(STATIONS[next]))?;
        }
        let poses: Vec<[Pose; 2]> = obstacles.iter().map(|x| [x.in_world(t), x.in_world(t + TICK_S)]).collect();
        let distance_m = Some(ground_truth.advance(t + TICK_S, &step.q, &poses)?);
        q.clone_from(&step.q);
        for (truth, pose) in record.log.ground_truth.iter_mut().zip(&poses) {
            truth.poses.push(pose[1]);
        }
        record.log.ticks.push(TickEntry { t_s: t + TICK_S, step, distance_m });
    }
    record.hits = ground_truth.hits;
    Ok(record)
}

fn log(obstacles: &[MovingBox]) -> PerceptionLog {
    let truth = |obstacle: &MovingBox| {
        let object = obstacle.object();
        GroundTruth { name: object.name, shape: object.shape, poses: Vec::new() }
    };
    PerceptionLog {
        title: "A KR125, a camera, and dynamic obstacles".into(),
        tick_s: TICK_S,
        ground_truth: obstacles.iter().map(truth).collect(),
        ..PerceptionLog::default()
    }
}

fn is_at(q: &[f64], station: [f64; 6]) -> bool {
    q.iter().zip(&radians(station)).all(|(a, b)| (a - b).abs() < 1e-6)
}

/// A frame in transmission.
struct SentFrame {
    t_s: f64,
    q: Vec<f64>,
    bytes: Vec<u8>,
}

/// Renders the images of the camera.
struct CameraRenderer {
    renderer: Renderer,
    chain: ChainState,
    parts: Vec<ArmPart>,
    frame: Frame,
}

impl CameraRenderer {
    fn new(station: &Station) -> Self {
        Self {
            renderer: Renderer::new(station.camera.clone(), Channels::Grey, 4),
            chain: ChainState::new(&station.arm.robot.chain),
            parts: Vec::new(),
            frame: Frame::default(),
        }
    }

    fn render(
        &mut self,
        station: &Station,
        obstacles: &[MovingBox],
        t: f64,
        q: &[f64],
    ) -> Result<Option<SentFrame>, Failure> {
        station.arm.parts_in_world(&mut self.chain, q, &mut self.parts);
        let solids: Vec<_> = obstacles.iter().map(|obstacle| obstacle.solid(t)).collect();
        let painted: Vec<_> = self.parts.iter().map(|part| (part.clone(), 235)).collect();
        let conditions = RenderConditions { seed: (t / TICK_S) as u64 + 1, ..RenderConditions::default() };
        self.frame.name = format!("frame at {t:.2} s");
        self.renderer.render(&solids, &painted, &conditions, &mut self.frame)?;
        Ok(encode_frame(t, &self.frame)?.map(|bytes| SentFrame { t_s: t, q: q.to_vec(), bytes }))
    }
}

fn process(station: &mut Station, sent: &SentFrame) -> FrameEntry {
    let began = Instant::now();
    let processed = station.pipeline.process_image(&sent.bytes, Path::new("camera.png"), sent.t_s, &sent.q);
    let result = processed.map(|update| {
        let result = station.executor.update(&update);
        (update, result)
    });
    let elapsed = began.elapsed();
    let blocked = station.pipeline.map().occupancy().blocked();
    FrameEntry { t_s: sent.t_s, result: result.map_err(|error| error.to_string()), elapsed, blocked }
}

/// Counts prisms that contain the true obstacles from the frame until the next one has been processed.
fn count_contained(update: &ObstacleUpdate, obstacles: &[MovingBox], coverage: &mut Coverage) {
    let t = update.stamp_s;
    let is_visible = |p: &Point2| (-1.3..4.5).contains(&p.x) && (-2.2..2.2).contains(&p.y);
    for obstacle in obstacles {
        let [now, then] = [obstacle.solid(t).footprint_m, obstacle.solid(t + PERIOD_S + LATENCY_S).footprint_m];
        if update.is_accepted() && now.iter().chain(&then).all(is_visible) {
            coverage.visible += 1;
            coverage.contained += usize::from(update.prisms.iter().any(|p| p.contains(&now) && p.contains(&then)));
        }
    }
}

/// Motion while the empty cell is learned: to the other station and back, so that every part of the floor is visible at
/// some time.
fn learning_motion(share: f64) -> ExecutorStep {
    let [a, b] = [radians(STATIONS[0]), radians(STATIONS[1])];
    let t = 0.5 - 0.5 * (share * std::f64::consts::TAU).cos();
    let q = a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect();
    ExecutorStep { q, qd: [0.0; 3], rate: 1.0, state: ExecutorState::Arrived }
}
