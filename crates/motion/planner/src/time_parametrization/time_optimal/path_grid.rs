//! Path grids: the path positions at which constraints are evaluated, finer near corners and rests.

use super::super::limits::in_direction;
use super::blended_path::PathSection;
use super::path_element::PathElement;
use elbowroom_kinematics::JointLimits;

/// Ratio of neighbouring spacings on a straight segment.
const GROWTH: f64 = 1.5;
/// Smallest fraction of the section, and largest fraction of the segment, that the first interval after a rest has.
const REST_SHARE: [f64; 2] = [1e-7, 0.05];

/// Numbers of intervals per element.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridDensity {
    pub per_blend: usize,
    /// Least and largest number of intervals on a straight segment if all had the widest spacing.
    pub per_straight: [f64; 2],
}

/// The grid of a section of a path.
#[derive(Debug, Clone)]
pub(super) struct PathGrid {
    /// Path positions from 0 to the length; interval n is from `nodes[n]` to `nodes[n + 1]`.
    pub nodes: Vec<f64>,
    /// Index of the element of each interval.
    pub elements: Vec<u32>,
}

/// Spacings at the beginning or end of a straight segment.
#[derive(Debug, Clone, Copy)]
struct EndSpacing {
    /// Length of the interval beside a rest; 0 beside a blend.
    rest: f64,
    next: f64,
}

impl PathGrid {
    pub fn new(section: &PathSection, limits: &[JointLimits], density: GridDensity) -> Self {
        let per_blend = density.per_blend;
        let mut grid = Self { nodes: vec![0.0], elements: Vec::new() };
        let mut spacings = Vec::new();
        for (n, element) in section.elements.iter().enumerate() {
            spacings.clear();
            if element.is_straight() {
                let neighbour = |index: usize| section.elements.get(index);
                let left = end_spacing(n.checked_sub(1).and_then(neighbour), element, section, limits, per_blend);
                let right = end_spacing(neighbour(n + 1), element, section, limits, per_blend);
                let widest = widest_spacing(element, section, limits, density);
                straight_spacings(element.length, left, right, widest, &mut spacings);
            } else {
                spacings.resize(per_blend, element.length / per_blend as f64);
            }
            grid.push(n, element, &spacings);
        }
        grid
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.elements.len()
    }

    /// Length of an interval.
    pub fn spacing(&self, interval: usize) -> f64 {
        self.nodes[interval + 1] - self.nodes[interval]
    }

    fn push(&mut self, index: usize, element: &PathElement, spacings: &[f64]) {
        let mut position = element.begin;
        for spacing in &spacings[..spacings.len() - 1] {
            position += spacing;
            self.nodes.push(position);
        }
        self.nodes.push(element.begin + element.length);
        self.elements.resize(self.nodes.len() - 1, index as u32);
    }
}

/// Spacings at one end of a straight segment: beside a blend as in the blend, beside a rest a small fraction of the
/// stretch on which acceleration rises.
fn end_spacing(
    neighbour: Option<&PathElement>,
    straight: &PathElement,
    section: &PathSection,
    limits: &[JointLimits],
    per_blend: usize,
) -> EndSpacing {
    if let Some(blend) = neighbour {
        return EndSpacing { rest: 0.0, next: blend.length / per_blend as f64 };
    }
    let limits = in_direction(limits, &straight.direction);
    let rise = (limits.acceleration / limits.jerk).min((limits.velocity / limits.jerk).sqrt());
    let rest = limits.jerk * (0.25 * rise).powi(3) / 6.0;
    let rest = rest.max(REST_SHARE[0] * section.length).min(REST_SHARE[1] * straight.length);
    EndSpacing { rest, next: 0.5 * rest }
}

/// Half of the distance covered while acceleration rises, within bounds.
fn widest_spacing(straight: &PathElement, section: &PathSection, limits: &[JointLimits], density: GridDensity) -> f64 {
    let limits = in_direction(limits, &straight.direction);
    let speed = limits.velocity.min((limits.acceleration * section.length).sqrt());
    let [least, most] = density.per_straight;
    (0.5 * speed * limits.acceleration / limits.jerk).max(straight.length / most).min(straight.length / least)
}

/// Appends spacings that grow from both ends up to the widest.
fn straight_spacings(length: f64, left: EndSpacing, right: EndSpacing, widest: f64, spacings: &mut Vec<f64>) {
    let mut from_right = Vec::new();
    let mut rest = length - left.rest - right.rest;
    spacings.extend((left.rest > 0.0).then_some(left.rest));
    from_right.extend((right.rest > 0.0).then_some(right.rest));
    let [mut l, mut r] = [left.next, right.next].map(|next| next.min(widest));
    loop {
        let step = l.min(r);
        if rest <= 1.7 * step {
            spacings.push(rest);
            break;
        }
        rest -= step;
        if l <= r {
            spacings.push(step);
            l = (GROWTH * l).min(widest);
        } else {
            from_right.push(step);
            r = (GROWTH * r).min(widest);
        }
    }
    spacings.extend(from_right.into_iter().rev());
}
