//! What all plots share.

use plotly::common::{Anchor, HoverInfo, Line, Mode, Orientation};
use plotly::layout::{Axis, HoverMode, Legend, Margin};
use plotly::{Layout, Scatter};

/// A micrometre (or a millionth) is finer than a pixel; shorter numbers make a smaller file.
pub fn round(v: f64) -> Option<f64> {
    v.is_finite().then(|| (v * 1e6).round() / 1e6)
}

pub type Trace = Box<Scatter<Option<f64>, Option<f64>>>;

/// A curve.
pub fn line(x: Vec<Option<f64>>, y: Vec<Option<f64>>, name: &str, style: Line) -> Trace {
    Scatter::new(x, y).name(name).mode(Mode::Lines).line(style).connect_gaps(false)
}

/// Horizontal bars at `row`, one per span, with a text each.
pub fn bars(spans: &[(f64, f64)], row: f64, width: f64, name: &str, color: &'static str, text: &str) -> Trace {
    let x = spans.iter().flat_map(|&(from, to)| [round(from), round(to), None]).collect();
    let y = spans.iter().flat_map(|_| [Some(row), Some(row), None]).collect();
    Scatter::new(x, y)
        .name(name)
        .mode(Mode::Lines)
        .line(Line::new().color(color).width(width))
        .connect_gaps(false)
        .hover_info(HoverInfo::All)
        .hover_template(format!("{text}<br>t = %{{x:.3f}} s<extra></extra>"))
}

pub fn axis(title: &str) -> Axis {
    Axis::new().title(title).auto_margin(true).zero_line(false)
}

/// Legend above, transparent, hover on the nearest point.
pub fn layout() -> Layout {
    Layout::new()
        .margin(Margin::new().left(60).right(16).top(40).bottom(48))
        .hover_mode(HoverMode::Closest)
        .legend(Legend::new().orientation(Orientation::Horizontal).x(0.0).y(1.02).y_anchor(Anchor::Bottom))
}
