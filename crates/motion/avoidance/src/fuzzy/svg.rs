//! A control surface as an SVG drawing.

use std::fmt::Write;

use super::Surface;

/// Width of the drawing, pixels.
const WIDTH: f64 = 620.0;
/// Height of the drawing, pixels.
const HEIGHT: f64 = 460.0;
/// Centre of the base plane, pixels.
const CENTER: [f64; 2] = [300.0, 285.0];
/// Axis of the first input, pixels.
const X_AXIS: [f64; 2] = [200.0, 75.0];
/// Axis of the second input, pixels.
const Y_AXIS: [f64; 2] = [200.0, -75.0];
/// Height of the output axis, pixels.
const Z_AXIS: f64 = 190.0;
/// Dark blue to green to yellow: also readable in grey.
const COLOURS: [[f64; 3]; 4] = [[68.0, 1.0, 84.0], [49.0, 104.0, 142.0], [53.0, 183.0, 121.0], [253.0, 231.0, 37.0]];

impl Surface {
    /// Draws the surface as an SVG document.
    ///
    /// ```
    /// use elbowroom_avoidance::{Rules, fuzzy::Surface};
    /// let size = Surface::of(Rules::default().controller(), 0, 25).unwrap();
    /// let svg = size.with_units(["m", "m/s", ""]).to_svg();
    /// assert!(svg.starts_with("<svg") && svg.matches("<polygon").count() == 24 * 24);
    /// ```
    pub fn to_svg(&self) -> String {
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self::base_plane(&mut svg);
        // From the far corner to the near corner: later patches hide earlier patches.
        for i in 0..self.x.len().saturating_sub(1) {
            for j in (0..self.y.len().saturating_sub(1)).rev() {
                self.patch(&mut svg, i, j);
            }
        }
        self.labels(&mut svg);
        svg + "</svg>\n"
    }

    /// Projection of a point; its coordinates are fractions of the ranges of the inputs and the output.
    fn project(x: f64, y: f64, z: f64) -> [f64; 2] {
        let (a, b) = (x - 0.5, y - 0.5);
        [CENTER[0] + X_AXIS[0] * a + Y_AXIS[0] * b, CENTER[1] + X_AXIS[1] * a + Y_AXIS[1] * b - Z_AXIS * z]
    }

    fn fraction(&self, z: f64) -> f64 {
        ((z - self.z_range[0]) / (self.z_range[1] - self.z_range[0])).clamp(0.0, 1.0)
    }

    fn base_plane(svg: &mut String) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Self::project(x, y, 0.0));
        let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        _ = writeln!(svg, "<path d=\"M{}Z\" fill=\"#f2f2f2\" stroke=\"#999\"/>", points.join("L"));
        let ([x0, y0], [x1, y1]) = (Self::project(0.0, 0.0, 0.0), Self::project(0.0, 0.0, 1.0));
        _ = writeln!(svg, "<line x1=\"{x0:.1}\" y1=\"{y0:.1}\" x2=\"{x1:.1}\" y2=\"{y1:.1}\" stroke=\"#999\"/>");
    }

    fn patch(&self, svg: &mut String, i: usize, j: usize) {
        let steps = [(self.x.len() - 1) as f64, (self.y.len() - 1) as f64];
        let corner =
            |i: usize, j: usize| Self::project(i as f64 / steps[0], j as f64 / steps[1], self.fraction(self.z[j][i]));
        let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let mean = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            .map(|(i, j)| self.fraction(self.z[j][i]))
            .iter()
            .sum::<f64>();
        let fill = colour(mean / 4.0);
        _ = writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"{fill}\" stroke=\"#fff\" stroke-width=\"0.3\"/>",
            points.join(" ")
        );
    }

    fn labels(&self, svg: &mut String) {
        let [x, y, z] = self.units;
        let title = |name: &str, unit: &str| {
            let name = escaped(name);
            if unit.is_empty() { name } else { format!("{name} ({unit})") }
        };
        let ends = |v: &[f64]| [v.first().copied().unwrap_or(0.0), v.last().copied().unwrap_or(0.0)];
        let mut text = |[px, py]: [f64; 2], anchor: &str, what: &str| {
            _ = writeln!(svg, "<text x=\"{px:.1}\" y=\"{py:.1}\" text-anchor=\"{anchor}\">{what}</text>");
        };
        let below = |[x, y]: [f64; 2]| [x, y + 18.0];
        for (fraction, value) in [0.0, 1.0].into_iter().zip(ends(&self.x)) {
            text(below(Self::project(fraction, -0.04, 0.0)), "middle", &format!("{value}"));
        }
        for (fraction, value) in [0.0, 1.0].into_iter().zip(ends(&self.y)) {
            text(below(Self::project(1.04, fraction, 0.0)), "start", &format!("{value}"));
        }
        text(below(Self::project(0.5, -0.12, 0.0)), "end", &title(&self.x_name, x));
        text(below(Self::project(1.12, 0.5, 0.0)), "start", &title(&self.y_name, y));
        for (fraction, value) in [0.0, 1.0].into_iter().zip(self.z_range) {
            let [px, py] = Self::project(0.0, 0.0, fraction);
            text([px - 8.0, py + 4.0], "end", &format!("{value}"));
        }
        text([24.0, 28.0], "start", &title(&self.z_name, z));
    }
}

/// A name as text of an XML document.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn colour(fraction: f64) -> String {
    let at = fraction.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let low = (at as usize).min(COLOURS.len() - 2);
    let weight = at - low as f64;
    let mixed: Vec<u8> =
        (0..3).map(|c| (COLOURS[low][c] * (1.0 - weight) + COLOURS[low + 1][c] * weight).round() as u8).collect();
    format!("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2])
}
