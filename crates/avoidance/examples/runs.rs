//! Many runs of a KR150 with a box that crosses its way, with avoidance and without; the exact scene judges by sweeps.
#![allow(clippy::print_stdout)]

use std::f64::consts::PI;

use elbowroom_avoidance::{Around, Avoider, AvoiderSettings, JointLimit, PathKind, Reference, Rules, Seen, Doing};
use elbowroom_proximity::impact::Steady;
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_scene::{Checker, Move, Object, Options, Scene, SceneState, Selection, SweepOptions};
use elbowroom_spatial::{Motion, Pose, Rotation, Vec3};

struct Random(u64);
impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn range(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }
}

const DT: f64 = 0.004;

struct PathPtp {
    a: Vec<f64>,
    b: Vec<f64>,
    seconds: f64,
}
impl PathPtp {
    fn at(&self, t: f64) -> (Vec<f64>, Vec<f64>) {
        let s = (t / self.seconds).clamp(0.0, 1.0);
        let f = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let d = 30.0 * s * s * (1.0 - s) * (1.0 - s) / self.seconds;
        let q = self.a.iter().zip(&self.b).map(|(a, b)| a + (b - a) * f).collect();
        let qd = self.a.iter().zip(&self.b).map(|(a, b)| (b - a) * d).collect();
        (q, qd)
    }
}

struct Outcome { hit: Option<f64>, t: f64, done: bool, min: f64, doing: Vec<(f64, Doing)>, travel: f64, overrun: f64, over_speed: f64, limit: f64, flips: u32, times: Vec<[f64; 4]>, braked: u32, what: String }

fn main() {
    let n: usize = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(100);
    let only: Option<usize> = std::env::args().nth(2).and_then(|s| s.parse().ok());
    let file = std::env::var("KR150").unwrap_or("/work/shared/data/urdf/kuka_kr150_2/kuka_kr150_2.urdf".into());
    let loaded = elbowroom_formats::robot::load(file.as_ref(), &Default::default()).unwrap();
    let mut builder = Scene::builder();
    builder.robot("kr150", loaded.robot, Pose::IDENTITY);
    builder.object(Object { name: "floor".into(), shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(4.0, 4.0, 0.05) }), in_world: Pose::from_translation(Vec3::new(0.0, 0.0, -0.06)) });
    builder.object(Object { name: "pallet".into(), shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.6, 0.4, 0.15) }), in_world: Pose::from_translation(Vec3::new(0.3, 2.1, 0.15)) });
    builder.object(Object { name: "belt".into(), shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.4, 1.0, 0.3) }), in_world: Pose::from_translation(Vec3::new(2.1, -0.9, 0.3)) });
    let cart = builder.object(Object { name: "cart".into(), shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.15, 0.15, 0.2) }), in_world: Pose::from_translation(Vec3::new(50.0, 0.0, 0.0)) });
    let scene = builder.build().unwrap();
    let chain = &scene.robots()[0].robot.chain;
    let limits = JointLimit::of(chain, 0.25, 0.1, 2.0);
    let mut random = Random(12345);
    let a = vec![-0.6, -0.9, 1.2, 0.0, 1.0, 0.0];
    let b = vec![1.3, -1.0, 1.3, 0.0, 1.0, 0.5];
    for q in [&a, &b] {
        let mut s = SceneState::new(&scene);
        s.set_q(&scene, 0, q).unwrap();
        println!("start distance {:?}", Checker::new(&scene, Options::default()).distance(&s).map(|d| (d.metres, scene.name(d.a), scene.name(d.b))));
    }
    {
        let mut s = SceneState::new(&scene);
        s.set_q(&scene, 0, &a).unwrap();
        println!("path hits {:?}", Checker::new(&scene, Options::default()).sweep(&s, &[Move::Robot { robot: 0, to: &b }], &SweepOptions::default()).unwrap().map(|h| (h.time, scene.name(h.a), scene.name(h.b))));
    }
    let mut on = Vec::new();
    let (mut off_hits, mut on_hits, mut tried) = (0, 0, 0);
    let mut run = 0;
    while tried < n {
        run += 1;
        // through a point near the arm's way
        let speed = random.range(0.1, 1.2);
        let angle = random.range(-PI, PI);
        let climb = random.range(-0.3, 0.3);
        let dir = Vec3::new(angle.cos() * f64::cos(climb), angle.sin() * f64::cos(climb), f64::sin(climb));
        let az = random.range(-0.8, 1.6);
        let r = random.range(0.9, 2.2);
        let through = Vec3::new(r * az.cos(), r * az.sin(), random.range(0.5, 2.2));
        let when = random.range(0.5, 3.5);
        let start = through - dir * (speed * when);
        let turn = Rotation::from_rpy(0.0, 0.0, random.range(-PI, PI));
        // never through the pedestal's cylinder
        let flat = Vec3::new(dir.x, dir.y, 0.0).try_normalize().unwrap();
        let miss = through - flat * through.dot(flat);
        if Vec3::new(miss.x, miss.y, 0.0).length() < 0.9 { continue; }
        let mover = |t: f64| Seen { object: cart, in_world: Pose::new(turn, start + dir * (speed * t)), motion: Motion { velocity: dir * speed, ..Motion::REST } };
        // does not start within the arm
        let mut s = SceneState::new(&scene);
        s.set_q(&scene, 0, &a).unwrap();
        s.place(&scene, cart, mover(0.0).in_world).unwrap();
        if Checker::new(&scene, Options::default()).between(Selection::Robot(0), Selection::Object(cart)).within(&s, 0.5).is_some() { continue; }
        tried += 1;
        if only.is_some_and(|o| o != run) { continue; }
        let off = simulate(&scene, &limits, &a, &b, cart, &mover, false, false);
        let with = simulate(&scene, &limits, &a, &b, cart, &mover, true, only.is_some());
        off_hits += usize::from(off.hit.is_some());
        on_hits += usize::from(with.hit.is_some());
        if with.hit.is_some() || !with.done || with.flips > 0 {
            println!("run {run}: speed {speed:.2} off {:?} on {:?} done {} t {:.2} travel {:.1}/{:.1} min {:.3} overrun {:.2} flips {} braked {} {} dir {dir:?} doing {:?}", off.hit, with.hit, with.done, with.t, with.travel, off.travel, with.min, with.overrun, with.flips, with.braked, with.what, &with.doing[with.doing.len().saturating_sub(6)..]);
        }
        on.push((off, with));
    }
    let hitters: Vec<_> = on.iter().filter(|o| o.0.hit.is_some()).collect();
    let resolved = hitters.iter().filter(|o| o.1.hit.is_none()).count();
    let free: Vec<_> = on.iter().filter(|o| o.1.hit.is_none() && o.1.done).collect();
    let mean = |f: &dyn Fn(&&(Outcome, Outcome)) -> f64| free.iter().map(|o| f(o)).sum::<f64>() / free.len() as f64;
    println!("{tried} runs: off {off_hits} hits, on {on_hits} hits; of those that hit {resolved}/{} resolved", hitters.len());
    println!("extra time {:.3} s, travel {:.3}x, not done {}", mean(&|o| o.1.t - o.0.t), mean(&|o| o.1.travel / o.0.travel), on.iter().filter(|o| !o.1.done).count());
    println!("over speed {:.2e}, over limit {:.2e}, flips {}", on.iter().map(|o| o.1.over_speed).fold(0.0, f64::max), on.iter().map(|o| o.1.limit).fold(0.0, f64::max), on.iter().map(|o| o.1.flips).sum::<u32>());
    for k in 0..4 {
        let mut times: Vec<f64> = on.iter().flat_map(|o| o.1.times.iter().map(|t| t[k])).collect();
        times.sort_by(f64::total_cmp);
        if !times.is_empty() { println!("{k} tick us median {:.1} p99 {:.1} max {:.1}", times[times.len() / 2], times[times.len() * 99 / 100], times[times.len() - 1]); }
    }
}

fn simulate(scene: &Scene, limits: &[JointLimit], a: &[f64], b: &[f64], cart: usize, mover: &dyn Fn(f64) -> Seen, on: bool, talk: bool) -> Outcome {
    let path = PathPtp { a: a.to_vec(), b: b.to_vec(), seconds: 2.5 };
    let mut avoider = Avoider::new(scene, 0, a, limits, Rules::default(), AvoiderSettings::default()).unwrap();
    let mut judge = Checker::new(scene, Options::default());
    let mut state = SceneState::new(scene);
    let (mut tau, mut t, mut rate) = (0.0, 0.0, 1.0);
    let mut q = a.to_vec();
    let mut out = Outcome { hit: None, t: 0.0, done: false, min: f64::INFINITY, doing: Vec::new(), travel: 0.0, overrun: 0.0, over_speed: 0.0, limit: 0.0, flips: 0, times: Vec::new(), braked: 0, what: String::new() };
    let mut sign = [0.0_f64; 6];
    let mut since = [9.0_f64; 6];
    while t < 15.0 {
        let seen = mover(t);
        tau = (tau + rate * DT).min(path.seconds);
        let (q_ref, qd_ref) = path.at(tau);
        let next: Vec<f64>;
        if on {
            let around = [seen];
            let advice = avoider.tick(DT, &Reference { q: &q_ref, qd: &qd_ref, path: PathKind::PointToPoint }, &Around { objects: &around, robots: &[] }, 1.0).unwrap();
            next = avoider.q().to_vec();
            let us = |d: std::time::Duration| d.as_secs_f64() * 1e6;
            out.times.push([us(advice.times.sense), us(advice.times.correct), us(advice.times.check), us(advice.times.total())]);
            // path rate under acceleration limits
            rate = advice.rate.clamp(rate - DT / 0.1, rate + DT / 0.25).clamp(0.0, 1.0);
            out.overrun = out.overrun.max(advice.reaction.overrun_m_s);
            out.braked += u32::from(advice.braked);
            if out.doing.last().map(|d| d.1) != Some(advice.doing) { out.doing.push((t, advice.doing)); }
            if talk && (t / DT).round() as usize % 10 == 0 {
                println!("{t:.2} tau {tau:.2} {:?} near {:.3} size {:.2} rate {rate:.2} astray {:.3} overrun {:.2} stuck {} q {:.2?} qd {:.2?}", advice.doing, advice.nearest_m, advice.reaction.size, advice.astray_s, advice.reaction.overrun_m_s, advice.stuck, next, avoider.qd());
            }
            for j in 0..6 {
                let v = avoider.qd()[j];
                out.over_speed = out.over_speed.max(v.abs() / limits[j].speed - 1.0);
                out.limit = out.limit.max(next[j] - limits[j].upper).max(limits[j].lower - next[j]);
                since[j] += DT;
                if v.abs() > 1e-4 * limits[j].speed {
                    if sign[j] * v < 0.0 { if since[j] < 0.249 { out.flips += 1; } since[j] = 0.0; }
                    sign[j] = v.signum();
                }
            }
        } else { next = q_ref.clone(); }
        out.travel += next.iter().zip(&q).map(|(a, b)| (a - b).abs()).sum::<f64>();
        state.set_q(scene, 0, &q).unwrap();
        let steady = Steady::from_motion(seen.in_world, &seen.motion, DT);
        let hit = judge.between(Selection::Robot(0), Selection::All).sweep(&state, &[Move::Robot { robot: 0, to: &next }, Move::Object { object: cart, path: &steady }], &SweepOptions::default()).unwrap();
        if let Some(h) = hit {
            let n = (scene.name(h.a), scene.name(h.b));
            if !n.0.contains("base_link") && !n.1.contains("base_link") || !on { out.hit = Some(t); out.what = format!("{} {}", n.0, n.1); break; }
        }
        state.place(scene, cart, seen.in_world).unwrap();
        if (t / DT).round() as usize % 5 == 0 {
            if let Some(d) = judge.between(Selection::Robot(0), Selection::Object(cart)).distance(&state) { out.min = out.min.min(d.metres); }
        }
        q = next;
        t += DT;
        if q.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6) && tau >= path.seconds { out.done = true; break; }
    }
    out.t = t;
    out
}
