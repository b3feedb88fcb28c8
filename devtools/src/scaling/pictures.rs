//! The plots of the tables, with logarithmic axes; the legend has the exponent of each curve.

use super::table::{PowerLaw, Table};
use crate::figures::svg::{Axis, Curve, Dash, Plot};

/// A plot.
pub struct Picture {
    pub file: &'static str,
    title: &'static str,
    x: &'static str,
    y: &'static str,
    curves: &'static [Column],
}

/// A curve: title of the table, column, its name in the legend, colour, line style.
type Column = (&'static str, &'static str, &'static str, usize, Dash);

const HALL: &str = "obstacles of a larger hall";
const PARTS: &str = "obstacles that are parts of one cell";
const FAR_REGIONS: &str = "regions of a larger hall";
const NEAR_REGIONS: &str = "regions of a crowded cell";
const CHECKS: &str = "obstacles of validity checks";
const NODES: &str = "nodes of the planner's trees";
const MICROSECONDS: &str = "microseconds, power of ten";
const MILLISECONDS: &str = "milliseconds, power of ten";
const OBSTACLES: &str = "obstacles, power of ten";

pub const PICTURES: [Picture; 8] = [
    Picture {
        file: "scaling-build.svg",
        title: "Time to set up",
        x: "triangles, obstacles or regions, power of ten",
        y: MILLISECONDS,
        curves: &[
            ("triangles", "build ms", "mesh", 0, Dash::Solid),
            (HALL, "scene with proofs ms", "scene, hall", 1, Dash::Solid),
            (PARTS, "scene with proofs ms", "scene, parts", 1, Dash::Dashed),
            (FAR_REGIONS, "set-up ms", "monitor", 2, Dash::Solid),
            (CHECKS, "set-up ms", "validity checker", 3, Dash::Solid),
        ],
    },
    Picture {
        file: "scaling-query.svg",
        title: "Query of two meshes",
        x: "triangles of each, power of ten",
        y: MICROSECONDS,
        curves: &[
            ("triangles", "collide near µs", "collide, near", 0, Dash::Solid),
            ("triangles", "collide touching µs", "collide, touching", 1, Dash::Solid),
            ("triangles", "within 5 % µs", "within 5 %", 2, Dash::Solid),
            ("triangles", "distance µs", "distance", 3, Dash::Solid),
        ],
    },
    rows_picture("scaling-hall.svg", "Row of a query, a larger hall", OBSTACLES, &ROWS_OF_HALL),
    rows_picture("scaling-parts.svg", "Row of a query, a cell in more parts", OBSTACLES, &ROWS_OF_PARTS),
    rows_picture("scaling-robots.svg", "Row of a query, more robots", "robots, power of ten", &ROWS_OF_ROBOTS),
    Picture {
        file: "scaling-regions.svg",
        title: "Tick of the monitor",
        x: "regions, power of ten",
        y: MICROSECONDS,
        curves: &[
            (FAR_REGIONS, "median µs", "hall, median", 0, Dash::Solid),
            (FAR_REGIONS, "p99.9 µs", "hall, p99.9", 0, Dash::Dashed),
            (NEAR_REGIONS, "median µs", "crowded, median", 1, Dash::Solid),
            (NEAR_REGIONS, "p99.9 µs", "crowded, p99.9", 1, Dash::Dashed),
        ],
    },
    Picture {
        file: "scaling-validity.svg",
        title: "Validity check of the planner",
        x: OBSTACLES,
        y: "nanoseconds, power of ten",
        curves: &[
            (CHECKS, "state ns", "state", 0, Dash::Solid),
            (CHECKS, "edge of 1 rad ns", "edge of 1 rad", 1, Dash::Solid),
        ],
    },
    Picture {
        file: "scaling-planner.svg",
        title: "Search of RRT-Connect, exact scene",
        x: "nodes, power of ten",
        y: MICROSECONDS,
        curves: &[(NODES, "µs/node", "time per node", 0, Dash::Solid)],
    },
];

const ROWS_OF_HALL: [Column; 4] = rows(HALL);
const ROWS_OF_PARTS: [Column; 4] = rows(PARTS);
const ROWS_OF_ROBOTS: [Column; 4] = rows("robots");

const fn rows(table: &'static str) -> [Column; 4] {
    [
        (table, "collision µs", "collision", 0, Dash::Solid),
        (table, "tolerance µs", "tolerance", 2, Dash::Solid),
        (table, "distance µs", "distance", 3, Dash::Solid),
        (table, "copied checker µs", "copied checker", 4, Dash::Dotted),
    ]
}

const fn rows_picture(file: &'static str, title: &'static str, x: &'static str, curves: &'static [Column]) -> Picture {
    Picture { file, title, x, y: MICROSECONDS, curves }
}

impl Picture {
    /// Draws columns of the tables.
    pub fn plot(&self, tables: &[Table]) -> Result<Plot, String> {
        let curves = self.curves.iter().map(|column| curve(tables, column)).collect::<Result<Vec<_>, _>>()?;
        let points = || curves.iter().flat_map(|curve| &curve.points);
        let x = axis(self.x, points().map(|p| p.0));
        let y = axis(self.y, points().map(|p| p.1));
        Ok(Plot { title: self.title, x, y, curves })
    }
}

fn curve(tables: &[Table], &(title, column, name, colour, dash): &Column) -> Result<Curve, String> {
    let table = tables.iter().find(|t| t.title == title).ok_or_else(|| format!("no bench printed `{title}`"))?;
    let points = table.points(column)?;
    let exponent = PowerLaw::fit(&points).map_or_else(String::new, |law| format!(": n^{:.2}", law.exponent));
    let label = format!("{name}{}", exponent.replace('-', "−"));
    let points = points.into_iter().filter(|p| p.1 > 0.0).map(|(x, y)| (x.log10(), y.log10())).collect();
    Ok(Curve { label, colour, dash, points })
}

/// An axis that contains all values, with ticks at halves, or at whole numbers if there are many.
fn axis(title: &'static str, values: impl Iterator<Item = f64>) -> Axis {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let step = if most - least > 4.0 { 1.0 } else { 0.5 };
    // A point that is above a tick by its rounding needs no further tick.
    Axis { title, from: ((least + 0.02) / step).floor() * step, to: ((most - 0.02) / step).ceil() * step, step }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_has_its_exponent_in_the_legend() {
        let text = "# triangles\ntriangles  build ms\n10  1\n1000  10\n";
        let tables = Table::parse_all(text).unwrap();
        let curve = curve(&tables, &("triangles", "build ms", "mesh", 0, Dash::Solid)).unwrap();
        assert_eq!((curve.label.as_str(), curve.points.len()), ("mesh: n^0.50", 2));
        assert!(PICTURES[0].plot(&tables).is_err_and(|e| e.contains(HALL)));
    }

    #[test]
    fn axes_contain_all_values_but_for_half_the_width_of_a_line() {
        let axis_of = |from: f64, to: f64| axis("x", [from, to].into_iter());
        let (wide, narrow) = (axis_of(2.9, 7.01), axis_of(2.99, 6.4));
        assert_eq!((wide.from, wide.to, wide.step), (2.0, 7.0, 1.0));
        assert_eq!((narrow.from, narrow.to, narrow.step), (3.0, 6.5, 0.5));
    }
}
