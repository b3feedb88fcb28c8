//! The clock: frames are rendered and sent, ticks move the arm, the judge looks on.

use std::path::Path;
use std::time::Instant;

use elbowroom::cell::watch::{Doing, FrameEntry, Sighting, Step, TickEntry, Truth, WatchLog};
use elbowroom::kinematics::ChainState;
use elbowroom::scene::Scene;
use elbowroom::spatial::Pose;
use elbowroom::vision::render::{Conditions, Renderer};
use elbowroom::vision::{ArmPart, Channels, Frame, Point2, encode_png};

use crate::album::Album;
use crate::judge::Judge;
use crate::station::{Failure, LATENCY_S, PERIOD_S, STATIONS, Station, TICK_S, radians};
use crate::things::Thing;

/// What is kept of a run.
pub struct Record {
    pub log: WatchLog,
    /// What was really hit, and when.
    pub hits: Vec<(f64, String)>,
    pub arrivals: usize,
    /// Frames in which a thing was wholly in sight, and in how many of them its prism held it until the next frame's.
    pub held: (usize, usize),
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

/// Runs the cell; frames and pictures go to `album`.
pub fn run(station: &mut Station, things: &[Thing], end_s: f64, album: &mut Album) -> Result<Record, Failure> {
    let mut builder = Scene::builder();
    builder.robot("kr125", station.arm.robot.clone(), Pose::IDENTITY);
    for thing in things {
        builder.object(thing.object());
    }
    let scene = builder.build()?;
    let mut q = radians(STATIONS[0]);
    let mut judge = Judge::new(&scene, &q)?;
    let mut stage = Stage::new(station);
    let mut record = Record { log: log(things), hits: vec![], arrivals: 0, held: (0, 0) };
    let learning_s = f64::from(station.watch.vision().settings().learning_frames) * PERIOD_S;
    let every = (PERIOD_S / TICK_S).round() as usize;
    let late = (LATENCY_S / TICK_S).round() as usize;
    let mut sent: Option<Sent> = None;
    let mut next = 1;
    for tick in 0..(end_s / TICK_S) as usize {
        let t = tick as f64 * TICK_S;
        if tick.is_multiple_of(every) {
            sent = stage.shoot(station, things, t, &q)?;
        }
        if tick % every == late
            && let Some(sent) = sent.take()
        {
            let entry = see(station, &sent);
            if let Ok((sighting, outlook)) = &entry.told {
                hold(sighting, things, &mut record.held);
                album.keep(station, &sent.bytes, sighting, outlook)?;
            }
            record.log.frames.push(entry);
        }
        let step = if t < learning_s {
            wave(t / learning_s)
        } else {
            if t < learning_s + TICK_S {
                station.guide.go_to(&radians(STATIONS[next]))?;
            }
            station.guide.tick(t + TICK_S, TICK_S)
        };
        if t > learning_s + TICK_S && step.doing == Doing::Arrived && is_at(&step.q, STATIONS[next]) {
            (next, record.arrivals) = (1 - next, record.arrivals + 1);
            station.guide.go_to(&radians(STATIONS[next]))?;
        }
        let ways: Vec<[Pose; 2]> = things.iter().map(|x| [x.in_world(t), x.in_world(t + TICK_S)]).collect();
        let distance_m = Some(judge.go(t + TICK_S, &step.q, &ways)?);
        q.clone_from(&step.q);
        for (truth, way) in record.log.truth.iter_mut().zip(&ways) {
            truth.poses.push(way[1]);
        }
        record.log.ticks.push(TickEntry { t_s: t + TICK_S, step, distance_m });
    }
    record.hits = judge.hits;
    Ok(record)
}

fn log(things: &[Thing]) -> WatchLog {
    let truth = |thing: &Thing| {
        let object = thing.object();
        Truth { name: object.name, shape: object.shape, poses: Vec::new() }
    };
    WatchLog {
        title: "A KR125, a camera, and what comes between".into(),
        tick_s: TICK_S,
        truth: things.iter().map(truth).collect(),
        ..WatchLog::default()
    }
}

fn is_at(q: &[f64], station: [f64; 6]) -> bool {
    q.iter().zip(&radians(station)).all(|(a, b)| (a - b).abs() < 1e-6)
}

/// A frame on its way.
struct Sent {
    t_s: f64,
    q: Vec<f64>,
    bytes: Vec<u8>,
}

/// Renders what the camera would send.
struct Stage {
    renderer: Renderer,
    chain: ChainState,
    parts: Vec<ArmPart>,
    frame: Frame,
}

impl Stage {
    fn new(station: &Station) -> Self {
        Self {
            renderer: Renderer::new(station.camera.clone(), Channels::Grey, 4),
            chain: ChainState::new(&station.arm.robot.chain),
            parts: Vec::new(),
            frame: Frame::default(),
        }
    }

    fn shoot(&mut self, station: &Station, things: &[Thing], t: f64, q: &[f64]) -> Result<Option<Sent>, Failure> {
        station.arm.parts_in_world(&mut self.chain, q, &mut self.parts);
        let solids: Vec<_> = things.iter().map(|thing| thing.solid(t)).collect();
        let painted: Vec<_> = self.parts.iter().map(|part| (part.clone(), 235)).collect();
        let conditions = Conditions { seed: (t / TICK_S) as u64 + 1, ..Conditions::default() };
        self.frame.name = format!("frame at {t:.2} s");
        self.renderer.render(&solids, &painted, &conditions, &mut self.frame)?;
        Ok(bytes_at(t, &self.frame)?.map(|bytes| Sent { t_s: t, q: q.to_vec(), bytes }))
    }
}

fn see(station: &mut Station, sent: &Sent) -> FrameEntry {
    let began = Instant::now();
    let seen = station.watch.see(&sent.bytes, Path::new("camera.png"), sent.t_s, &sent.q);
    let told = seen.map(|sighting| {
        let outlook = station.guide.look(&sighting);
        (sighting, outlook)
    });
    let took = began.elapsed();
    let blocked = station.watch.map().table().blocked();
    FrameEntry { t_s: sent.t_s, told: told.map_err(|error| error.to_string()), took, blocked }
}

/// Whether the prisms hold what is really there, from the frame until the next one has been worked up.
fn hold(sighting: &Sighting, things: &[Thing], held: &mut (usize, usize)) {
    let t = sighting.stamp_s;
    let in_sight = |p: &Point2| (-1.3..4.5).contains(&p.x) && (-2.2..2.2).contains(&p.y);
    for thing in things {
        let [now, then] = [thing.solid(t).footprint_m, thing.solid(t + PERIOD_S + LATENCY_S).footprint_m];
        if sighting.is_clear() && now.iter().chain(&then).all(in_sight) {
            held.0 += 1;
            held.1 += usize::from(sighting.prisms.iter().any(|p| p.contains(&now) && p.contains(&then)));
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
