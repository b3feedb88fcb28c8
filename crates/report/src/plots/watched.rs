//! Plots of a perception run.

use elbowroom_perception::{ExecutorState, PerceptionLog};
use elbowroom_sim::RecordedRegionKind;
use elbowroom_sim::Recording;
use plotly::Plot;
use plotly::common::{DashType, Line, Marker, Mode};

use super::figure::{Figure, axis, bars, layout, line, plain, round};
use super::joints;
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
    Figure { title: title.into(), note: note.into(), over_time, run: None, height, wide, plot }
}

fn from_above(log: &PerceptionLog, recording: &Recording) -> Figure {
    let mut plot = Plot::new();
    for (i, truth) in log.ground_truth.iter().enumerate() {
        let kept = every(truth.poses.len(), 300);
        let xs = kept.iter().map(|&n| round(truth.poses[n].translation.x)).collect();
        let ys = kept.iter().map(|&n| round(truth.poses[n].translation.y)).collect();
        let style = Line::new().color(palette::of_index(i)).width(6.0);
        plot.add_trace(line(xs, ys, &plain(&format!("{}, ground truth", truth.name)), style).opacity(0.35));
    }
    let prisms = || log.frames.iter().filter_map(|f| f.result.as_ref().ok()).flat_map(|(s, _)| &s.prisms);
    let mut ids: Vec<_> = prisms().map(|p| p.id).collect();
    ids.sort_unstable();
    ids.dedup();
    for (i, id) in ids.into_iter().enumerate() {
        let mine = || prisms().filter(move |p| p.id == id);
        let kind = mine().filter_map(|p| p.kind.as_deref()).next_back().unwrap_or("unknown");
        let (xs, ys) = (mine().map(|p| round(p.centre_m.x)).collect(), mine().map(|p| round(p.centre_m.y)).collect());
        let marker = Marker::new().color(palette::of_index(i)).size(4);
        let name = plain(&format!("{id}, observed ({kind})"));
        plot.add_trace(line(xs, ys, &name, Line::new()).mode(Mode::Markers).marker(marker));
    }
    if let Some(robot) = recording.robots.first() {
        let samples = &robot.samples;
        let at = |i: usize| samples[i].tcp.y;
        let kept = pick(samples.len(), MAX_POINTS, &[&at]);
        let xs = kept.iter().map(|&i| round(samples[i].tcp.x)).collect();
        let ys = kept.iter().map(|&i| round(samples[i].tcp.y)).collect();
        plot.add_trace(line(xs, ys, "flange", Line::new().color(palette::of_run(0, true)).width(1.2)));
    }
    plot.set_layout(layout().x_axis(axis("x (m)")).y_axis(axis("y (m)").scale_anchor("x").scale_ratio(1.0)));
    let note = "Top view: true paths of the obstacles, their estimated centres, the path of the flange. An obstacle of unknown height \
                covers more floor than its footprint, so its estimated centre predicate shifted outwards.";
    figure("Tracks", note, false, false, 520, plot)
}

fn distance(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new();
    let ticks = &log.ticks;
    let at = |i: usize| ticks[i].distance_m.unwrap_or(f64::NAN);
    let kept = pick(ticks.len(), MAX_POINTS, &[&at]);
    let xs = kept.iter().map(|&i| round(ticks[i].t_s)).collect();
    let ys = kept.iter().map(|&i| round(at(i))).collect();
    plot.add_trace(line(xs, ys, "nearest obstacle", Line::new().color(palette::of_index(0)).width(1.8)));
    if let Some((least, t)) = log.least_distance() {
        let marker = Marker::new().color(palette::of_kind(RecordedRegionKind::Obstacle)).size(9);
        let name = format!("least: {:.0} mm", least * 1e3);
        plot.add_trace(line(vec![round(t)], vec![round(least)], &name, Line::new()).mode(Mode::Markers).marker(marker));
    }
    plot.set_layout(layout().x_axis(axis("time (s)")).y_axis(axis("distance (m)")));
    let note = "Distance between the arm and the nearest obstacle at its true pose, at every control tick.";
    figure("True distance", note, true, false, 520, plot)
}

/// Predicate of a row of the chart.
type StatePredicate = fn(&ExecutorState) -> bool;

fn state(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new();
    let ticks = &log.ticks;
    let at = |i: usize| ticks[i].step.rate;
    let kept = pick(ticks.len(), MAX_POINTS, &[&at]);
    let xs = kept.iter().map(|&i| round(ticks[i].t_s)).collect();
    let ys = kept.iter().map(|&i| round(at(i))).collect();
    let style = Line::new().color(palette::of_index(0)).width(1.6);
    plot.add_trace(line(xs, ys, "share of the planned speed", style));
    let rows: [(&str, &str, &'static str, StatePredicate); 3] = [
        ("slowing", "slowing", palette::WARNING, |d| matches!(d, ExecutorState::Slowing(_))),
        ("waiting", "waiting", palette::of_kind(RecordedRegionKind::Obstacle), |d| {
            matches!(d, ExecutorState::Waiting(_))
        }),
        ("no image", "no accepted image", palette::of_index(9), |d| {
            matches!(d.reason(), Some(elbowroom_perception::HoldReason::NoRecentImage { .. }))
        }),
    ];
    for (n, (name, text, color, predicate)) in rows.into_iter().enumerate() {
        plot.add_trace(bars(&spans(log, predicate), -0.1 - 0.1 * n as f64, 9.0, name, color, text));
    }
    let changes = |in_motion: bool| {
        let mine = log.frames.iter().filter(move |f| {
            f.result.as_ref().is_ok_and(|(_, o)| {
                o.in_motion == in_motion && o.kind.is_some_and(|kind| kind != elbowroom_planner::ReplanKind::Kept)
            })
        });
        mine.map(|f| round(f.t_s)).collect::<Vec<_>>()
    };
    for (in_motion, name, color) in
        [(true, "path changed in motion", "#2ca02c"), (false, "new path from rest", "#7f7f7f")]
    {
        let xs = changes(in_motion);
        let ys = xs.iter().map(|_| Some(1.05)).collect();
        let marker = Marker::new().color(color).size(7);
        plot.add_trace(line(xs, ys, name, Line::new()).mode(Mode::Markers).marker(marker));
    }
    plot.set_layout(layout().x_axis(axis("time (s)")).y_axis(axis("rate").range(vec![-0.4, 1.15])));
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
    let mut plot = Plot::new();
    let clear = || log.frames.iter().filter(|f| f.result.as_ref().is_ok_and(|(s, _)| s.is_accepted()));
    let xs: Vec<_> = clear().map(|f| round(f.t_s)).collect();
    let ms = |seconds: f64| round(seconds * 1e3);
    let all = clear().map(|f| ms(f.elapsed.as_secs_f64())).collect();
    let seeing =
        clear().filter_map(|f| f.result.as_ref().ok()).map(|(s, _)| ms(s.times.total().as_secs_f64())).collect();
    let planning =
        clear().filter_map(|f| f.result.as_ref().ok()).map(|(_, o)| ms(o.times.total().as_secs_f64())).collect();
    plot.add_trace(line(xs.clone(), all, "frame to motion", Line::new().color(palette::of_index(0)).width(1.6)));
    plot.add_trace(line(
        xs.clone(),
        seeing,
        "frame to blocked cells",
        Line::new().color(palette::of_index(2)).width(1.0),
    ));
    plot.add_trace(line(xs, planning, "blocked cells to motion", Line::new().color(palette::of_index(1)).width(1.0)));
    let ends = [log.ticks.first(), log.ticks.last()].map(|t| t.map_or(0.0, |t| t.t_s));
    let goal = Line::new().color("#999999").width(1.0).dash(DashType::Dash);
    plot.add_trace(line(ends.map(round).to_vec(), vec![Some(10.0); 2], "10 ms", goal));
    plot.set_layout(layout().x_axis(axis("time (s)")).y_axis(axis("ms")));
    figure("Time per frame", "Wall-clock time on the machine that generated this page.", true, false, 340, plot)
}

fn blocked(log: &PerceptionLog) -> Figure {
    let mut plot = Plot::new();
    let xs = log.frames.iter().map(|f| round(f.t_s)).collect();
    let ys = log.frames.iter().map(|f| round(f.blocked as f64)).collect();
    plot.add_trace(line(
        xs,
        ys,
        "blocked",
        Line::new().color(palette::of_kind(RecordedRegionKind::Obstacle)).width(1.6),
    ));
    plot.set_layout(layout().x_axis(axis("time (s)")).y_axis(axis("cells")));
    figure("Blocked cells", "Blocked cells of the joint-space map after each frame.", true, false, 340, plot)
}
