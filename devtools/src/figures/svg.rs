//! Line plot as SVG: a few curves, two axes, a legend. Without clock or random numbers: equal plots have equal bytes.
//!
//! The background is transparent and every colour is of middle lightness, so that a figure is readable on white and on
//! dark. Curves differ in dashes as well as in colour.

use std::fmt::Write as _;

/// Size of the picture, px.
const SIZE: (f64, f64) = (760.0, 360.0);
/// Left, right, top, bottom edge of the plot area, px.
const AREA: [f64; 4] = [68.0, 510.0, 44.0, 300.0];
/// Colour of text and axes.
const GREY: &str = "#7d848c";
const COLOURS: [&str; 5] = ["#2f81f7", "#d9622b", "#2c9c4b", "#a268e8", "#c04a8a"];
const DASHES: [&str; 3] = ["", "7 4", "2 3"];

/// One axis, linear.
pub struct Axis {
    /// Quantity, with its unit.
    pub title: &'static str,
    /// Value at its beginning.
    pub from: f64,
    /// Value at its end.
    pub to: f64,
    /// Distance of its ticks.
    pub step: f64,
}

/// Line style of a curve.
#[derive(Clone, Copy)]
pub enum Dash {
    /// Without gaps.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// One line of the plot.
pub struct Curve {
    /// Its line in the legend.
    pub label: String,
    /// Index of its colour; curves of one colour belong together.
    pub colour: usize,
    /// Line style.
    pub dash: Dash,
    /// Points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

/// A figure.
pub struct Plot {
    /// Title.
    pub title: &'static str,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Its lines, in the order of the legend.
    pub curves: Vec<Curve>,
}

impl Plot {
    /// Returns the text of the file.
    pub fn svg(&self) -> String {
        let mut out = String::new();
        let (w, h) = SIZE;
        let [left, right, top, bottom] = AREA;
        line(
            &mut out,
            format_args!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img" font-family="sans-serif" font-size="13" fill="{GREY}">"#
            ),
        );
        line(&mut out, format_args!("<title>{}</title>", escaped(self.title)));
        let (width, height) = (right - left, bottom - top);
        line(
            &mut out,
            format_args!(
                r#"<clipPath id="area"><rect x="{left}" y="{}" width="{width}" height="{}"/></clipPath>"#,
                top - 2.0,
                height + 4.0
            ),
        );
        text(&mut out, (left, top - 18.0), "start", r#" font-size="15""#, self.title);
        self.draw_x_axis(&mut out);
        self.draw_y_axis(&mut out);
        for (i, curve) in self.curves.iter().enumerate() {
            self.draw_curve(&mut out, curve);
            draw_legend_line(&mut out, curve, top + 10.0 + 22.0 * i as f64);
        }
        out.push_str("</svg>\n");
        out
    }

    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let [left, right, top, bottom] = AREA;
        let share = |v: f64, axis: &Axis| (v - axis.from) / (axis.to - axis.from);
        (left + share(x, &self.x) * (right - left), bottom - share(y, &self.y) * (bottom - top))
    }

    fn draw_x_axis(&self, out: &mut String) {
        let [left, right, top, bottom] = AREA;
        for value in self.x.ticks() {
            let x = self.place((value, self.y.from)).0;
            rule(out, (x, top), (x, bottom), "0.25");
            text(out, (x, bottom + 18.0), "middle", "", &self.x.label(value));
        }
        rule(out, (left, bottom), (right, bottom), "1");
        text(out, (f64::midpoint(left, right), bottom + 42.0), "middle", "", self.x.title);
    }

    fn draw_y_axis(&self, out: &mut String) {
        let [left, right, top, bottom] = AREA;
        for value in self.y.ticks() {
            let y = self.place((self.x.from, value)).1;
            rule(out, (left, y), (right, y), "0.25");
            text(out, (left - 8.0, y + 4.5), "end", "", &self.y.label(value));
        }
        rule(out, (left, top), (left, bottom), "1");
        let middle = number(f64::midpoint(top, bottom));
        text(
            out,
            (18.0, f64::midpoint(top, bottom)),
            "middle",
            &format!(r#" transform="rotate(-90 18 {middle})""#),
            self.y.title,
        );
    }

    fn draw_curve(&self, out: &mut String, curve: &Curve) {
        let points: Vec<String> = curve
            .points
            .iter()
            .map(|point| self.place(*point))
            .map(|(x, y)| format!("{},{}", number(x), number(y)))
            .collect();
        line(
            out,
            format_args!(r#"<polyline clip-path="url(#area)" points="{}" {}/>"#, points.join(" "), curve.stroke()),
        );
    }
}

impl Axis {
    fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        let count = ((self.to - self.from) / self.step + 1e-9).floor() as usize;
        (0..=count).map(|i| self.from + self.step * i as f64)
    }

    /// Formats a tick's value with as many decimals as the step has.
    fn label(&self, value: f64) -> String {
        let is_whole = |digits: &u8| {
            let scaled = self.step * 10_f64.powi(i32::from(*digits));
            (scaled - scaled.round()).abs() < 1e-6
        };
        let digits = usize::from((0..6).find(is_whole).unwrap_or(6));
        let value = if value.abs() < self.step * 1e-6 { 0.0 } else { value };
        format!("{value:.digits$}").replace('-', "−")
    }
}

impl Curve {
    fn stroke(&self) -> String {
        let dashes = DASHES[self.dash as usize];
        let colour = COLOURS[self.colour % COLOURS.len()];
        let pattern = if dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dashes}""#) };
        format!(r#"fill="none" stroke="{colour}" stroke-width="2" stroke-linejoin="round"{pattern}"#)
    }
}

fn draw_legend_line(out: &mut String, curve: &Curve, y: f64) {
    let x = AREA[1] + 16.0;
    line(out, format_args!(r#"<path d="M{x} {y}h28" {}/>"#, curve.stroke()));
    text(out, (x + 36.0, y + 4.5), "start", "", &curve.label);
}

fn rule(out: &mut String, from: (f64, f64), to: (f64, f64), opacity: &str) {
    let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(number);
    line(
        out,
        format_args!(r#"<path d="M{x1} {y1}L{x2} {y2}" stroke="{GREY}" stroke-width="1" stroke-opacity="{opacity}"/>"#),
    );
}

fn text(out: &mut String, at: (f64, f64), anchor: &str, more: &str, words: &str) {
    let (x, y) = (number(at.0), number(at.1));
    line(out, format_args!(r#"<text x="{x}" y="{y}" text-anchor="{anchor}"{more}>{}</text>"#, escaped(words)));
}

fn line(out: &mut String, what: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{what}");
}

/// Formats a number to hundredths of a pixel: coarse enough that the last bit of a computation never shows.
fn number(v: f64) -> String {
    let rounded = (v * 100.0).round() / 100.0;
    // Adding 0 avoids "-0".
    format!("{}", rounded + 0.0)
}

fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        Plot {
            title: "a < b & c",
            x: Axis { title: "x (m)", from: -0.1, to: 0.1, step: 0.05 },
            y: Axis { title: "y (1)", from: 0.0, to: 1.0, step: 0.5 },
            curves: vec![Curve {
                label: "one".into(),
                colour: 0,
                dash: Dash::Dashed,
                points: vec![(-0.1, 0.0), (0.0, 0.5), (0.1, 1.0)],
            }],
        }
    }

    #[test]
    fn the_corners_of_the_axes_are_the_corners_of_the_area() {
        let svg = plot().svg();
        assert!(svg.contains(r#"points="68,300 289,172 510,44""#), "{svg}");
    }

    #[test]
    fn labels_have_the_decimals_of_their_step_and_no_negative_zero() {
        let labels: Vec<String> = plot().x.ticks().map(|v| plot().x.label(v)).collect();
        assert_eq!(labels, ["−0.10", "−0.05", "0.00", "0.05", "0.10"]);
        assert_eq!(number(-0.001), "0");
    }

    #[test]
    fn words_are_escaped_and_dashes_drawn() {
        let svg = plot().svg();
        assert!(svg.contains("a &lt; b &amp; c") && !svg.contains("a < b"));
        assert_eq!(svg.matches(r#"stroke-dasharray="7 4""#).count(), 2, "in the plot and in the legend");
    }
}
