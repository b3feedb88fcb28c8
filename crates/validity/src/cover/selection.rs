//! Selection of the outer spheres: greedily, then without those that are not needed, then as small as possible.

use elbowroom_spatial::Vec3;

use super::ball::{Ball, ROUNDING_M, farthest_squared};
use super::placement::PlacedShapes;
use super::surface_voxels::SurfaceVoxel;
use super::voxel_grid::{Voxel, VoxelGrid};

/// Voxels on which candidates are compared.
const SAMPLES: usize = 3000;
/// Candidate centres between the surface and the centre of the largest ball within, as shares of the way.
const SHARES: [f64; 7] = [0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0];
/// Iterations of the shrinking ball.
const SHRINKINGS: usize = 8;

/// The outer spheres of a solid while they are chosen.
pub(super) struct CoverSelection<'g, 's> {
    placed: &'g PlacedShapes<'s>,
    grid: &'g VoxelGrid,
    slack_m: f64,
    balls: Vec<Ball>,
    /// How many balls contain the content of each surface voxel.
    surface_counts: Vec<u16>,
}

impl<'g, 's> CoverSelection<'g, 's> {
    pub fn new(placed: &'g PlacedShapes<'s>, grid: &'g VoxelGrid, slack_m: f64) -> Self {
        let slack_m = (slack_m - placed.chord_error_m - 2.0 * ROUNDING_M).max(ROUNDING_M);
        let surface_counts = vec![0; grid.surface.len()];
        Self { placed, grid, slack_m, balls: Vec::new(), surface_counts }
    }

    /// The balls.
    pub fn run(mut self) -> Vec<Ball> {
        self.cover_surface();
        self.trim();
        self.cover_inside();
        let chord_error_m = self.placed.chord_error_m;
        self.balls.into_iter().map(|b| Ball { radius: b.radius + chord_error_m, ..b }.rounded_up()).collect()
    }

    fn cover_surface(&mut self) {
        let grid = self.grid;
        loop {
            let open: Vec<usize> = (0..grid.surface.len()).filter(|&i| self.surface_counts[i] == 0).collect();
            if open.is_empty() {
                return;
            }
            let mut samples = spread(&open, SAMPLES);
            while let Some(&seed) = samples.first() {
                let voxel = &grid.surface[seed];
                let ball = self.best_ball(voxel, &samples);
                self.count(&ball);
                self.balls.push(ball);
                samples.retain(|&i| self.surface_counts[i] == 0);
            }
        }
    }

    /// Of the candidates that contain a voxel, the one that contains most samples.
    fn best_ball(&self, voxel: &SurfaceVoxel, samples: &[usize]) -> Ball {
        let (centre, half) = (voxel.centre(), voxel.half());
        let smallest = Ball { centre, radius: half.length() + 2.0 * ROUNDING_M };
        let mut best = (0, self.largest_ball(centre).filter(|b| b.radius > smallest.radius).unwrap_or(smallest));
        for ball in self.candidates(voxel) {
            if !ball.contains_box(centre, half) {
                continue;
            }
            let limit = (ball.radius - ROUNDING_M).powi(2);
            let covers = |&&i: &&usize| {
                let v = &self.grid.surface[i];
                farthest_squared(ball.centre, v.centre(), v.half()) <= limit
            };
            let gain = samples.iter().filter(covers).count();
            if gain > best.0 {
                best = (gain, ball);
            }
        }
        best.1
    }

    /// Balls with centres between the surface in a voxel and the medial axis.
    fn candidates(&self, voxel: &SurfaceVoxel) -> Vec<Ball> {
        let [a, b, c] = self.placed.triangles[voxel.triangle as usize];
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
        let Some(near) = self.placed.nearest_surface(voxel.centre()) else { return Vec::new() };
        let mut balls = Vec::new();
        for inward in [normal, -normal] {
            let Some(depth) = self.medial_depth(near.point, inward) else { continue };
            balls.extend(SHARES.iter().filter_map(|share| self.largest_ball(near.point + inward * (share * depth))));
        }
        balls
    }

    /// Distance along a normal from a surface point to the centre of the largest ball that touches the surface there (Ma, Bae,
    /// Choi: *3D medial axis point approximation using nearest neighbors and the normal field*, 2012).
    fn medial_depth(&self, surface: Vec3, inward: Vec3) -> Option<f64> {
        let step = self.grid.lattice.step_m;
        if self.grid.at(surface + inward * (1.5 * step)) == Voxel::Outside {
            return None;
        }
        let mut radius = 0.5 * self.grid.counts.iter().map(|&n| n as f64 * step).fold(f64::INFINITY, f64::min);
        for _ in 0..SHRINKINGS {
            let centre = surface + inward * radius;
            let near = self.placed.nearest_surface(centre)?;
            let is_outside = self.grid.at(centre) == Voxel::Outside;
            if near.distance_m >= radius - 0.1 * step && !is_outside {
                break;
            }
            // The ball through the surface point and the nearest point, with its centre on the normal.
            let to = near.point - surface;
            let along = to.dot(inward);
            let touching = if along > 0.0 { to.length_squared() / (2.0 * along) } else { 0.5 * radius };
            radius = if is_outside { touching.min(0.5 * radius) } else { touching.min(0.98 * radius) };
        }
        Some(radius.max(0.0))
    }

    /// The largest ball about a point that keeps the slack; `None` outside.
    fn largest_ball(&self, centre: Vec3) -> Option<Ball> {
        let depth = self.placed.nearest_surface(centre)?.distance_m;
        if self.grid.at(centre) == Voxel::Outside {
            return None;
        }
        // In a voxel of the surface the centre may be just outside.
        let depth =
            if self.grid.at(centre) == Voxel::Surface && self.placed.depth_m(centre) <= 0.0 { -depth } else { depth };
        let radius = depth + self.slack_m;
        (radius > 0.0).then_some(Ball { centre, radius })
    }

    /// Adds balls for voxels inside that no ball contains.
    fn cover_inside(&mut self) {
        let [nx, ny, nz] = self.grid.counts;
        let half = Vec3::splat(0.5 * self.grid.lattice.step_m);
        let mut is_covered = vec![false; self.grid.len()];
        for ball in &self.balls {
            mark_columns(self.grid, ball, &mut is_covered);
        }
        for index in 0..nx * ny * nz {
            if is_covered[index] || self.grid.state(index) != Voxel::Inside {
                continue;
            }
            let centre = self.grid.centre([index % nx, index / nx % ny, index / (nx * ny)]);
            let smallest = Ball { centre, radius: half.length() + 2.0 * ROUNDING_M };
            let ball = self.largest_ball(centre).filter(|b| b.contains_box(centre, half)).unwrap_or(smallest);
            mark_columns(self.grid, &ball, &mut is_covered);
            self.balls.push(ball);
        }
    }

    /// Shrinks each ball to the surface voxels that no other contains, the smallest ball first, and removes it where there are
    /// none.
    fn trim(&mut self) {
        let mut order: Vec<usize> = (0..self.balls.len()).collect();
        order.sort_by(|&i, &j| self.balls[i].radius.total_cmp(&self.balls[j].radius));
        for i in order {
            let ball = self.balls[i];
            let needed = self.needed_radius(&ball).map_or(0.0, |needed| needed + 3.0 * ROUNDING_M);
            let smaller = Ball { radius: ball.radius.min(needed), ..ball };
            self.release(&ball, &smaller);
            self.balls[i] = smaller;
        }
        self.balls.retain(|b| b.radius > 0.0);
    }

    /// Radius that a ball needs for the surface voxels that it alone contains; `None` where there are none.
    fn needed_radius(&self, ball: &Ball) -> Option<f64> {
        let mut needed: Option<f64> = None;
        for_each_row(self.grid, ball, |row| {
            for i in row.surface {
                let v = &self.grid.surface[i];
                if self.surface_counts[i] == 1 && ball.contains_box(v.centre(), v.half()) {
                    let radius = farthest_squared(ball.centre, v.centre(), v.half()).sqrt();
                    needed = Some(needed.map_or(radius, |n| n.max(radius)));
                }
            }
        });
        needed
    }

    /// Counts a new ball for all surface voxels whose content it contains.
    fn count(&mut self, ball: &Ball) {
        let (grid, counts) = (self.grid, &mut self.surface_counts);
        for_each_row(grid, ball, |row| {
            for i in row.surface {
                let v = &grid.surface[i];
                counts[i] = counts[i].saturating_add(u16::from(ball.contains_box(v.centre(), v.half())));
            }
        });
    }

    /// Counts a ball no longer for the surface voxels that a smaller one does not contain.
    fn release(&mut self, ball: &Ball, smaller: &Ball) {
        let (grid, counts) = (self.grid, &mut self.surface_counts);
        for_each_row(grid, ball, |row| {
            for i in row.surface {
                let v = &grid.surface[i];
                let is_released =
                    ball.contains_box(v.centre(), v.half()) && !smaller.contains_box(v.centre(), v.half());
                counts[i] = counts[i].saturating_sub(u16::from(is_released));
            }
        });
    }
}

/// Marks the voxels that a ball contains.
fn mark_columns(grid: &VoxelGrid, ball: &Ball, marks: &mut [bool]) {
    for_each_row(grid, ball, |row| {
        let first = (row.z * grid.counts[1] + row.y) * grid.counts[0];
        marks[first + row.columns.start..first + row.columns.end].fill(true);
    });
}

/// Calls `visit` with every row that a ball touches, the columns of the row whose voxels it contains, and the surface voxels of
/// the row that it may contain.
fn for_each_row(grid: &VoxelGrid, ball: &Ball, mut visit: impl FnMut(RowInBall)) {
    let step = grid.lattice.step_m;
    let range = |axis: usize| {
        let low = (ball.centre[axis] - ball.radius - grid.lattice.origin[axis]) / step;
        let high = (ball.centre[axis] + ball.radius - grid.lattice.origin[axis]) / step;
        (low.floor().max(0.0) as usize)..((high.floor().max(-1.0) + 1.0) as usize).min(grid.counts[axis])
    };
    let reach = (ball.radius - 2.0 * ROUNDING_M).max(0.0);
    for z in range(2) {
        for y in range(1) {
            let centre = grid.centre([0, y, z]);
            let across = |axis: usize| (ball.centre[axis] - centre[axis]).abs();
            // Square of half of the chord through the row at the given distance from its middle.
            let chord = |beside: f64| {
                let part = |axis: usize| (across(axis) + beside).max(0.0).powi(2);
                ball.radius.powi(2) - part(1) - part(2)
            };
            let longest = chord(-0.5 * step);
            if longest <= 0.0 {
                continue;
            }
            let inside = chord(0.5 * step) - (ball.radius.powi(2) - reach * reach);
            let columns = if inside > 0.0 { columns(grid, ball.centre.x, inside.sqrt()) } else { 0..0 };
            let surface = grid.row_within(y, z, ball.centre.x, longest.sqrt());
            visit(RowInBall { y, z, columns, surface });
        }
    }
}

/// The part of a row along x in a ball.
struct RowInBall {
    y: usize,
    z: usize,
    /// Voxels that the ball contains.
    columns: std::ops::Range<usize>,
    /// Indices of the surface voxels that it may contain.
    surface: std::ops::Range<usize>,
}

/// Columns that lie within a distance of a coordinate along x.
fn columns(grid: &VoxelGrid, x: f64, distance_m: f64) -> std::ops::Range<usize> {
    let step = grid.lattice.step_m;
    let low = ((x - distance_m + ROUNDING_M - grid.lattice.origin.x) / step).ceil().max(0.0) as usize;
    let high = ((x + distance_m - ROUNDING_M - grid.lattice.origin.x) / step).floor().max(0.0) as usize;
    let high = high.min(grid.counts[0]);
    low.min(high)..high
}

/// At most `most` entries, in a scattered order that is always the same.
fn spread(entries: &[usize], most: usize) -> Vec<usize> {
    let n = entries.len();
    // A multiplier near the golden section that shares no factor with the length visits every entry once.
    let mut stride = ((n as f64) * 0.618_033_988_75) as usize | 1;
    while greatest_common_divisor(stride, n) != 1 {
        stride += 2;
    }
    (0..n.min(most)).map(|i| entries[(i * stride) % n]).collect()
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
