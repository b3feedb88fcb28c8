//! Plots of a perception run.

use elbowroom_perception::{ExecutorState, PerceptionLog};
use elbowroom_sim::Recording;
use serde_json::json;

use super::figure::{Figure, bars, plain, round};
use super::figure12::top_view;
use super::joints;
use super::plot::{Plot, axis, layout, line, markers, stroke, with};
use crate::downsample::{MAX_POINTS, every, pick};
use crate::palette;
use crate::scene::ReportScene;

/// All plots, in the order of the page.
pub fn all(scene: &ReportScene, log: &PerceptionLog, recording: &Recording) -> Vec<Figure> {
    let mut figures = vec![from_above(log, recording), distance(log), state(log), times(log), blocked(log)];
    figures.extend(joints::chart(scene, &[("", recording)], 0));
    figures
}

fn figure(title: &str, note: &str, over_time: bool, wide: bool, height: usize, plot: Plot) -> Figure {
    Figure { title: title.into(), note: note.into(), over_time, run: None, height, wide, drawing: plot.into() }
}

fn from_above(log: &PerceptionLog, recording: &Recording) -> Figure {
    let mut plot = Plot::new(top_view());
    for (i, truth) in log.ground_truth.iter().enumerate() {
        let kept = every(truth.poses.len(), 300);
        let xs = kept.iter().map(|&n| round(truth.poses[n].translation.x)).collect();
        let ys = kept.iter().map(|&n| round(truth.poses[n].translation.y)).collect();
        let name = plain(&format!("{}, ground truth", truth.name));
        plot.add(with(line(xs, ys, &name, stroke(palette::of_region(i), 6.0)), json!({ "opacity": 0.35 })));
    }
    let prisms = || log.frames.iter().filter_map(|f| f.result.as_ref().ok()).flat_map(|(s, _)| &s.prisms);
    let mut ids: Vec<_> = prisms().map(|p| p.id).collect();
    ids.sort_unstable();
    ids.dedup();
    for (i, id) in ids.into_iter().enumerate() {
        let matching = || prisms().filter(move |p| p.id == id);
        let kind = matching().filter_map(|p| p.kind.as_deref()).next_back().unwrap_or("unknown");
        let (xs, ys) =
            (matching().map(|p| round(p.centre_m.x)).collect(), matching().map(|p| round(p.centre_m.y)).collect());
        let name = plain(&format!("{id}, observed ({kind})"));
        plot.add(markers(xs, ys, &name, json!({ "color": palette::of_index(i), "size": 4 })));
    }
    if let Some(robot) = recording.robots.first() {
        let samples = &robot.samples;
        let at = |i: usize| samples[i].tcp.y;
        let kept = pick(samples.len(), MAX_POINTS, &[&at]);
        let xs = kept.iter().map(|&i| round(samples[i].tcp.x)).collect();
        let ys = kept.iter().map(|&i| round(samples[i].tcp.y)).collect();
        plot.add(line(xs, ys, "flange", stroke(palette::of_run(0, true), 1.2)));
    }
    let note = "Top view: true paths of the obstacles, their estimated centres, the path of the flange. An obstacle of unknown height \
                covers more floor than its footprint, so its estimated centre is shifted outwards.";
    figure("Tracks", note, false, false, 520, plot)
}

fn distance(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new(layout(axis("time (s)"), axis("distance (m)")));
    let ticks = &log.ticks;
    let at = |i: usize| ticks[i].distance_m.unwrap_or(f64::NAN);
    let kept = pick(ticks.len(), MAX_POINTS, &[&at]);
    let xs = kept.iter().map(|&i| round(ticks[i].t_s)).collect();
    let ys = kept.iter().map(|&i| round(at(i))).collect();
    plot.add(line(xs, ys, "nearest obstacle", stroke(palette::of_index(0), 1.8)));
    if let Some((least, t)) = log.least_distance() {
        let style = json!({ "color": palette::OBSTACLE, "size": 9 });
        let name = format!("least: {:.0} mm", least * 1e3);
        plot.add(markers(vec![round(t)], vec![round(least)], &name, style));
    }
    let note = "Distance between the arm and the nearest obstacle at its true pose, at every control tick.";
    figure("True distance", note, true, false, 520, plot)
}

/// Selects the ticks that a row of the chart marks.
type StatePredicate = fn(&ExecutorState) -> bool;

fn state(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new(layout(axis("time (s)"), with(axis("rate"), json!({ "range": [-0.4, 1.15] }))));
    let ticks = &log.ticks;
    let at = |i: usize| ticks[i].step.rate;
    let kept = pick(ticks.len(), MAX_POINTS, &[&at]);
    let xs = kept.iter().map(|&i| round(ticks[i].t_s)).collect();
    let ys = kept.iter().map(|&i| round(at(i))).collect();
    plot.add(line(xs, ys, "share of the planned speed", stroke(palette::of_index(0), 1.6)));
    let rows: [(&str, &str, &'static str, StatePredicate); 3] = [
        ("slowing", "slowing", palette::WARNING, |d| matches!(d, ExecutorState::Slowing(_))),
        ("waiting", "waiting", palette::OBSTACLE, |d| matches!(d, ExecutorState::Waiting(_))),
        ("no image", "no accepted image", palette::of_index(9), |d| {
            matches!(d.reason(), Some(elbowroom_perception::HoldReason::NoRecentImage { .. }))
        }),
    ];
    for (n, (name, text, color, predicate)) in rows.into_iter().enumerate() {
        plot.add(bars(&spans(log, predicate), -0.1 - 0.1 * n as f64, 9.0, name, color, text));
    }
    let changes = |in_motion: bool| {
        let matching = log.frames.iter().filter(move |f| {
            f.result.as_ref().is_ok_and(|(_, o)| {
                o.in_motion == in_motion && o.kind.is_some_and(|kind| kind != elbowroom_planner::ReplanKind::Kept)
            })
        });
        matching.map(|f| round(f.t_s)).collect::<Vec<_>>()
    };
    for (in_motion, name, color) in
        [(true, "path changed in motion", "#2ca02c"), (false, "new path from rest", "#7f7f7f")]
    {
        let xs = changes(in_motion);
        let ys = xs.iter().map(|_| Some(1.05)).collect();
        plot.add(markers(xs, ys, name, json!({ "color": color, "size": 7 })));
    }
    figure(
        "Executor state",
        "Time scaling rate of the planned trajectory, and the cause of slow-downs.",
        true,
        true,
        340,
        plot,
    )
}

fn spans(log: &PerceptionLog, predicate: StatePredicate) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for tick in log.ticks.iter().filter(|tick| predicate(&tick.step.state)) {
        let from = tick.t_s - log.tick_s;
        match found.last_mut() {
            Some(last) if from - last.1 < 0.5 * log.tick_s => last.1 = tick.t_s,
            _ => found.push((from, tick.t_s)),
        }
    }
    found
}

fn times(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new(layout(axis("time (s)"), axis("ms")));
    let accepted = || log.frames.iter().filter(|f| f.result.as_ref().is_ok_and(|(s, _)| s.is_accepted()));
    let xs: Vec<_> = accepted().map(|f| round(f.t_s)).collect();
    let ms = |seconds: f64| round(seconds * 1e3);
    let all = accepted().map(|f| ms(f.elapsed.as_secs_f64())).collect();
    let perception =
        accepted().filter_map(|f| f.result.as_ref().ok()).map(|(s, _)| ms(s.times.total().as_secs_f64())).collect();
    let planning =
        accepted().filter_map(|f| f.result.as_ref().ok()).map(|(_, o)| ms(o.times.total().as_secs_f64())).collect();
    plot.add(line(xs.clone(), all, "frame to motion", stroke(palette::of_index(0), 1.6)));
    plot.add(line(xs.clone(), perception, "frame to blocked cells", stroke(palette::of_index(2), 1.0)));
    plot.add(line(xs, planning, "blocked cells to motion", stroke(palette::of_index(1), 1.0)));
    let ends = [log.ticks.first(), log.ticks.last()].map(|t| t.map_or(0.0, |t| t.t_s));
    let limit = with(stroke("#999999", 1.0), json!({ "dash": "dash" }));
    plot.add(line(ends.map(round).to_vec(), vec![Some(10.0); 2], "10 ms", limit));
    figure("Time per frame", "Wall-clock time on the machine that generated this page.", true, false, 340, plot)
}

fn blocked(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new(layout(axis("time (s)"), axis("cells")));
    let xs = log.frames.iter().map(|f| round(f.t_s)).collect();
    let ys = log.frames.iter().map(|f| round(f.blocked as f64)).collect();
    plot.add(line(xs, ys, "blocked", stroke(palette::OBSTACLE, 1.6)));
    figure("Blocked cells", "Blocked cells of the joint-space map after each frame.", true, false, 340, plot)
}
