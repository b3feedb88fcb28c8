//! The four plots of the paper's figure 12.

use elbowroom_robot::RobotId;
use elbowroom_sim::{Recording, RegionPoses, RegionTrack, RobotTrack, Sample};
use elbowroom_spatial::{Pose, Vec3};
use serde_json::{Value, json};

use super::figure::{Figure, curve_name, plain, round, tracks};
use super::plot::{Plot, axis, layout, line, markers, stroke, with};
use crate::downsample::{MAX_POINTS, pick};
use crate::scene::ReportScene;
use crate::{palette, region_surface};

pub fn all(scene: &ReportScene, runs: &[(&str, &Recording)]) -> Vec<Figure> {
    let mut figures = vec![path(runs)];
    let base = |robot: RobotId| scene.robots.get(robot.0).map_or(Vec3::ZERO, |r| r.base_in_world.translation);
    let norm = over_time("‖p‖ (m)", runs, |robot, s| s.tcp.distance(base(robot)));
    let note = "Distance of the tool centre point from the robot's base.";
    figures.push(figure("Norm of position over time", note, 460, norm));
    let y = over_time("y (m)", runs, |_, s| s.tcp.y);
    figures.push(figure("Y over time", "Tool centre point in the world.", 320, y));
    figures.push(speed(runs));
    figures
}

/// The tick of the cross-sections: the closest approach of a governing point to its region.
fn closest_moment(runs: &[(&str, &Recording)]) -> Option<(usize, f64)> {
    let samples = runs.iter().flat_map(|(_, rec)| &rec.robots).flat_map(|r| r.samples.iter().enumerate());
    let near = samples.clone().filter_map(|(i, s)| s.distance_m.map(|d| (d, i, s.tcp.z)));
    let nearest = near.filter(|(d, ..)| d.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, i, z)| (i, z)).or_else(|| samples.map(|(i, s)| (i, s.tcp.z)).next())
}

/// Seen from above, with one scale for both axes.
fn top_view() -> Value {
    layout(axis("x (m)"), with(axis("y (m)"), json!({ "scaleanchor": "x", "scaleratio": 1.0 })))
}

fn path(runs: &[(&str, &Recording)]) -> Figure {
    let mut plot = Plot::new(top_view());
    let mut note = String::from("Tool centre point seen from above.");
    if let (Some((tick, height)), Some((_, recording))) = (closest_moment(runs), runs.first()) {
        note =
            format!("Tool centre point seen from above. Regions are cut at its closest approach, z = {height:.3} m.");
        for (index, region) in recording.regions.iter().enumerate() {
            add_region(&mut plot, region, palette::of_region(index), tick, height);
        }
    }
    for (label, recording, robot, track) in tracks(runs) {
        let name = curve_name(label, recording, track);
        add_path(&mut plot, &name, palette::of_run(robot, recording.monitored), track);
    }
    let (title, drawing) = ("Path in the X-Y plane".into(), plot.into());
    Figure { title, note, over_time: false, run: None, height: 460, wide: false, drawing }
}

fn add_region(plot: &mut Plot, region: &RegionTrack, color: &str, tick: usize, height: f64) {
    let pose = match &region.poses {
        RegionPoses::Fixed(pose) => *pose,
        RegionPoses::Moving(poses) => poses.get(tick).or(poses.last()).copied().unwrap_or(Pose::IDENTITY),
    };
    let name = plain(&region.name);
    if let Some(shell) = region_surface::warning(&region.shape, region.warning_m) {
        let section = region_surface::section(&shell, &pose, height);
        add_section(plot, &section, &format!("warning zone of {name}"), color, 0.15);
    }
    let solid = region_surface::section(&region_surface::solid(&region.shape), &pose, height);
    add_section(plot, &solid, &format!("{name} ({})", region.kind.name()), color, 0.45);
}

fn add_section(plot: &mut Plot, curves: &[Vec<[f64; 2]>], name: &str, color: &str, alpha: f64) {
    if curves.is_empty() {
        return;
    }
    let corners = |k: usize| -> Vec<Option<f64>> {
        curves.iter().flat_map(|c| c.iter().map(move |p| round(p[k])).chain([None])).collect()
    };
    let value = u32::from_str_radix(color.trim_start_matches('#'), 16).unwrap_or(0);
    let [_, r, g, b] = value.to_be_bytes();
    let fill = json!({ "fill": "toself", "fillcolor": format!("rgba({r},{g},{b},{alpha})"), "hoverinfo": "name" });
    plot.add(with(line(corners(0), corners(1), name, stroke(color, 1.5)), fill));
}

fn add_path(plot: &mut Plot, name: &str, color: &str, track: &RobotTrack) {
    let samples = &track.samples;
    let (x, y) = (|i: usize| samples[i].tcp.x, |i: usize| samples[i].tcp.y);
    let kept = pick(samples.len(), MAX_POINTS, &[&x, &y]);
    let column = |f: &dyn Fn(usize) -> f64| kept.iter().map(|&i| round(f(i))).collect::<Vec<_>>();
    let curve = line(column(&x), column(&y), name, stroke(color, 2.5));
    plot.add(with(curve, json!({ "legendgroup": name })));
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return };
    let (end, symbol) = if track.finished { ("end", "square") } else { ("stopped", "x") };
    for (sample, text, symbol, position) in
        [(first, "start", "circle", "bottom right"), (last, end, symbol, "top left")]
    {
        let style = json!({ "color": color, "size": 10, "symbol": symbol });
        let point = markers(vec![round(sample.tcp.x)], vec![round(sample.tcp.y)], name, style);
        let label = json!({ "mode": "markers+text", "text": [text], "textposition": position });
        plot.add(with(with(point, label), json!({ "legendgroup": name, "showlegend": false })));
    }
}

fn figure(title: &str, note: &str, height: usize, plot: Plot) -> Figure {
    let drawing = plot.into();
    Figure { title: title.into(), note: note.into(), over_time: true, run: None, height, wide: false, drawing }
}

fn over_time(unit: &str, runs: &[(&str, &Recording)], value: impl Fn(RobotId, &Sample) -> f64) -> Plot {
    let mut plot = Plot::new(with(layout(axis("time (s)"), axis(unit)), json!({ "hovermode": "x" })));
    for (label, recording, robot, track) in tracks(runs) {
        let at = |i: usize| value(RobotId(robot), &track.samples[i]);
        let kept = pick(track.samples.len(), MAX_POINTS, &[&at]);
        let t = kept.iter().map(|&i| round(track.samples[i].t_s)).collect();
        let y = kept.iter().map(|&i| round(at(i))).collect();
        let style = stroke(palette::of_run(robot, recording.monitored), 2.0);
        plot.add(line(t, y, &curve_name(label, recording, track), style));
    }
    plot
}

fn speed(runs: &[(&str, &Recording)]) -> Figure {
    let mut plot = over_time("‖v‖ (m/s)", runs, |_, s| s.tcp_speed);
    for (label, recording, robot, track) in tracks(runs).filter(|(_, rec, ..)| rec.monitored) {
        let at = |i: usize| track.samples[i].programmed_speed * track.samples[i].speed_override;
        let kept = pick(track.samples.len(), MAX_POINTS, &[&at]);
        let t = kept.iter().map(|&i| round(track.samples[i].t_s)).collect();
        let y = kept.iter().map(|&i| round(at(i))).collect();
        let style = with(stroke(palette::of_run(robot, recording.monitored), 1.2), json!({ "dash": "dash" }));
        let name = format!("{}: programmed × override", curve_name(label, recording, track));
        plot.add(line(t, y, &name, style));
    }
    let note = "Tool centre point. Dashed: programmed speed times the override.";
    figure("Norm of speed over time", note, 320, plot)
}
