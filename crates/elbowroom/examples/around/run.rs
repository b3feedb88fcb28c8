//! The clock: frames are rendered and sent, ticks move the arm, the judge looks on.

use std::path::Path;
use std::time::{Duration, Instant};

use elbowroom::cell::watch::{Doing, Outlook, Sighting, Step};
use elbowroom::kinematics::ChainState;
use elbowroom::scene::Scene;
use elbowroom::spatial::Pose;
use elbowroom::vision::render::{Conditions, Renderer};
use elbowroom::vision::{ArmPart, Channels, Frame, encode_png};

use crate::judge::Judge;
use crate::station::{Failure, LATENCY_S, PERIOD_S, STATIONS, Station, TICK_S, radians};
use crate::things::Thing;

/// What happened at a frame.
pub struct FrameRow {
    pub t_s: f64,
    pub q: Vec<f64>,
    pub sighting: Option<Sighting>,
    pub outlook: Option<Outlook>,
    pub error: Option<String>,
    /// From bytes to a motion, measured.
    pub took: Duration,
}

/// What happened at a tick.
pub struct TickRow {
    pub t_s: f64,
    pub step: Step,
    /// From the arm to the nearest thing, really, metres.
    pub distance_m: f64,
}

pub struct Record {
    pub frames: Vec<FrameRow>,
    pub ticks: Vec<TickRow>,
    pub hits: Vec<(f64, String)>,
    pub least: (f64, f64),
    pub arrivals: usize,
}

/// What goes wrong with frames, and when.
fn bytes_at(t: f64, frame: &Frame) -> Result<Option<Vec<u8>>, Failure> {
    if (6.6..7.1).contains(&t) {
        return Ok(None); // the cable is loose
    }
    let mut bytes = encode_png(frame)?;
    if (t - 14.0).abs() < 1e-6 {
        bytes.truncate(bytes.len() / 2);
    }
    Ok(Some(bytes))
}

pub fn run(station: &mut Station, things: &[Thing], end_s: f64) -> Result<Record, Failure> {
    let mut builder = Scene::builder();
    builder.robot("kr125", station.arm.robot.clone(), Pose::IDENTITY);
    things.iter().for_each(|thing| _ = builder.object(thing.object()));
    let scene = builder.build()?;
    let mut q = radians(STATIONS[0]);
    let mut judge = Judge::new(&scene, &q)?;
    let mut renderer = Renderer::new(station.camera.clone(), Channels::Grey, 4);
    let mut chain = ChainState::new(&station.arm.robot.chain);
    let (mut parts, mut frame): (Vec<ArmPart>, _) = (Vec::new(), Frame::default());
    let mut record = Record { frames: vec![], ticks: vec![], hits: vec![], least: (0.0, 0.0), arrivals: 0 };
    let learning_s = f64::from(station.watch.vision().settings().learning_frames) * PERIOD_S;
    let every = (PERIOD_S / TICK_S).round() as usize;
    let late = (LATENCY_S / TICK_S).round() as usize;
    let mut sent: Option<(f64, Vec<f64>, Vec<u8>)> = None;
    let mut next = 1;
    for tick in 0..(end_s / TICK_S) as usize {
        let t = tick as f64 * TICK_S;
        if tick % every == 0 {
            station.arm.parts_in_world(&mut chain, &q, &mut parts);
            let solids: Vec<_> = things.iter().map(|thing| thing.solid(t)).collect();
            let painted: Vec<_> = parts.iter().map(|part| (part.clone(), 235)).collect();
            let conditions = Conditions { seed: tick as u64 + 1, ..Conditions::default() };
            frame.name = format!("frame {tick}");
            renderer.render(&solids, &painted, &conditions, &mut frame)?;
            sent = bytes_at(t, &frame)?.map(|bytes| (t, q.clone(), bytes));
        }
        if tick % every == late
            && let Some((stamp, then, bytes)) = sent.take()
        {
            record.frames.push(see(station, stamp, then, &bytes));
        }
        let step = if t < learning_s {
            wave(t / learning_s)
        } else {
            if t < learning_s + TICK_S {
                station.guide.go_to(&radians(STATIONS[next]))?;
            }
            station.guide.tick(t + TICK_S, TICK_S)
        };
        if step.doing == Doing::Arrived && t > learning_s + 1.0 {
            let there = radians(STATIONS[next]);
            if step.q.iter().zip(&there).all(|(a, b)| (a - b).abs() < 1e-6) {
                (next, record.arrivals) = (1 - next, record.arrivals + 1);
                station.guide.go_to(&radians(STATIONS[next]))?;
            }
        }
        let ways: Vec<[Pose; 2]> = things.iter().map(|x| [x.in_world(t), x.in_world(t + TICK_S)]).collect();
        let distance_m = judge.go(t + TICK_S, &step.q, &ways)?;
        q.clone_from(&step.q);
        record.ticks.push(TickRow { t_s: t + TICK_S, step, distance_m });
    }
    (record.hits, record.least) = (judge.hits, judge.least);
    Ok(record)
}

fn see(station: &mut Station, t_s: f64, q: Vec<f64>, bytes: &[u8]) -> FrameRow {
    let began = Instant::now();
    let seen = station.watch.see(bytes, Path::new("camera.png"), t_s, &q);
    match seen {
        Ok(sighting) => {
            let outlook = station.guide.look(&sighting);
            let took = began.elapsed();
            FrameRow { t_s, q, sighting: Some(sighting), outlook: Some(outlook), error: None, took }
        }
        Err(error) => {
            let took = began.elapsed();
            FrameRow { t_s, q, sighting: None, outlook: None, error: Some(error.to_string()), took }
        }
    }
}

/// While the empty cell is learnt the arm goes to the other station and back, so that all of the floor is in sight once.
fn wave(share: f64) -> Step {
    let [a, b] = [radians(STATIONS[0]), radians(STATIONS[1])];
    let t = 0.5 - 0.5 * (share * std::f64::consts::TAU).cos();
    let q = a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect();
    Step { q, qd: [0.0; 3], rate: 1.0, doing: Doing::Arrived }
}
