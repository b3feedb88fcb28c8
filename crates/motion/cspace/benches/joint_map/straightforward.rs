//! A straightforward implementation: forward kinematics per row, distances cell by cell, one byte per cell.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the dispatched loop is compiled without its instructions"
)]
#![allow(clippy::needless_bitwise_bool, reason = "branches would keep the loop from being vectorized")]

use elbowroom_cspace::{Grid, GridAxis, PlanarArm};
use elbowroom_spatial::Vec3;
use elbowroom_validity::lanes::simd::{Level as SimdLevel, dispatch};

type V = [f32; 3];

/// A box with rounded edges; a ball is a box of size 0.
pub struct RoundedBox {
    center: V,
    axes: [V; 3],
    half: V,
    round: f32,
}

impl RoundedBox {
    pub fn ball(center: Vec3, radius: f64) -> Self {
        Self { round: radius as f32, ..Self::cuboid(center, 0.0, Vec3::ZERO) }
    }

    pub fn cuboid(center: Vec3, yaw: f64, half: Vec3) -> Self {
        let (sin, cos) = (yaw.sin() as f32, yaw.cos() as f32);
        let list = |v: Vec3| v.to_array().map(|x| x as f32);
        let axes = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        Self { center: list(center), axes, half: list(half), round: 0.0 }
    }

    fn around(&self) -> f32 {
        dot(self.half, self.half).sqrt() + self.round
    }

    /// The solid in the frame of the plane of θ1.
    fn turned(&self, [sin, cos]: [f32; 2]) -> Self {
        let turn = |v: V| [v[0] * cos + v[1] * sin, v[1] * cos - v[0] * sin, v[2]];
        Self { center: turn(self.center), axes: self.axes.map(turn), ..*self }
    }

    #[inline(always)]
    fn local(&self, [x, z]: [f32; 2]) -> V {
        let from = [x - self.center[0], -self.center[1], z - self.center[2]];
        [dot(from, self.axes[0]), dot(from, self.axes[1]), dot(from, self.axes[2])]
    }

    #[inline(always)]
    fn local_vector(&self, [x, z]: [f32; 2]) -> V {
        let part = |a: V| x * a[0] + z * a[2];
        [part(self.axes[0]), part(self.axes[1]), part(self.axes[2])]
    }

    /// Squared distance of a point to the box.
    #[inline(always)]
    fn square(&self, p: V) -> f32 {
        let beyond = |i: usize| (p[i].abs() - self.half[i]).max(0.0);
        beyond(0) * beyond(0) + beyond(1) * beyond(1) + beyond(2) * beyond(2)
    }

    /// Computes one row of a ball: in the plane, in closed form.
    #[inline(always)]
    fn ball_row(&self, elbow: [f32; 2], [x, z]: [&[f32]; 2], [r2, r3]: [f32; 2], row: &mut [u8]) {
        let (u, w) = (self.center[0] - elbow[0], self.center[2] - elbow[1]);
        let across = self.center[1] * self.center[1];
        let over = 1.0 / (x[0] * x[0] + z[0] * z[0]);
        for k in 0..row.len() {
            let t = ((u * x[k] + w * z[k]) * over).clamp(0.0, 1.0);
            let (a, b) = (u - t * x[k], w - t * z[k]);
            let (c, d) = (u - x[k], w - z[k]);
            row[k] = u8::from((a * a + b * b + across < r2 * r2) | (c * c + d * d + across < r3 * r3));
        }
    }

    /// Squared distance of a segment to the box. The distance along the segment is convex, so a golden-section search
    /// finds the least; the middle of a ball has a closed form.
    #[inline(always)]
    fn segment(&self, p: V, d: V) -> f32 {
        let at = |t: f32| self.square([p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]]);
        if self.half == [0.0; 3] {
            return at((-dot(p, d) / dot(d, d)).clamp(0.0, 1.0));
        }
        let (mut lo, mut hi) = (0f32, 1f32);
        for _ in 0..10 {
            let (a, b) = (lo + (hi - lo) * 0.382, lo + (hi - lo) * 0.618);
            if at(a) < at(b) { hi = b } else { lo = a }
        }
        at(0.5 * (lo + hi))
    }
}

#[inline(always)]
fn dot(a: V, b: V) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sines and cosines at the centres of all cells, and the forearm for every pair of θ2 and θ3.
pub struct Planar {
    arm: PlanarArm,
    base: Vec<[f32; 2]>,
    shoulder: Vec<[f32; 2]>,
    row: usize,
    fore_x: Vec<f32>,
    fore_z: Vec<f32>,
    simd_level: SimdLevel,
}

impl Planar {
    pub fn new(arm: &PlanarArm, grid: &Grid) -> Self {
        let turns = |axis: &GridAxis| -> Vec<[f32; 2]> {
            (0..axis.count()).map(|i| axis.center(i).sin_cos()).map(|(s, c)| [s as f32, c as f32]).collect()
        };
        let [base, shoulder, elbow] = grid.axes();
        let (mut fore_x, mut fore_z) = (Vec::new(), Vec::new());
        for i in 0..shoulder.count() {
            for j in 0..elbow.count() {
                let (sin, cos) = (shoulder.center(i) + elbow.center(j)).sin_cos();
                fore_x.push((arm.fore_length_m * cos) as f32);
                fore_z.push((-arm.fore_length_m * sin) as f32);
            }
        }
        let (base, shoulder) = (turns(base), turns(shoulder));
        Self { arm: *arm, base, shoulder, row: elbow.count(), fore_x, fore_z, simd_level: SimdLevel::new() }
    }

    fn joints(&self, [sin, cos]: [f32; 2]) -> ([f32; 2], [f32; 2]) {
        let (upper, at) = (self.arm.upper_length_m as f32, [self.arm.offset_m as f32, self.arm.height_m as f32]);
        (at, [at[0] + upper * sin, at[1] + upper * cos])
    }

    /// Skips planes out of reach, rows whose elbow is too far, and rows that the upper arm blocks.
    pub fn pruned(&self, solid: &RoundedBox, cells: &mut [u8]) {
        dispatch!(self.simd_level, _simd => self.pruned_lanes(solid, cells));
    }

    #[inline(always)]
    fn pruned_lanes(&self, solid: &RoundedBox, cells: &mut [u8]) {
        let arm = &self.arm;
        let [r1, r2, r3] = [arm.upper_radius_m, arm.fore_radius_m, arm.wrist_radius_m].map(|r| r as f32 + solid.round);
        let around = solid.around();
        let wrist = arm.wrist_radius_m as f32;
        let reach = arm.fore_length_m as f32 + wrist + around;
        cells.fill(0);
        for (i, &turn) in self.base.iter().enumerate() {
            let here = solid.turned(turn);
            if here.center[1].abs() > wrist + around {
                continue;
            }
            for (j, &lean) in self.shoulder.iter().enumerate() {
                let row = &mut cells[(i * self.shoulder.len() + j) * self.row..][..self.row];
                let (shoulder, elbow) = self.joints(lean);
                let along = [elbow[0] - shoulder[0], elbow[1] - shoulder[1]];
                if here.segment(here.local(shoulder), here.local_vector(along)) < r1 * r1 {
                    row.fill(1);
                    continue;
                }
                let from = here.local(elbow);
                if dot(from, from) > reach * reach {
                    continue;
                }
                let (x, z) = (&self.fore_x[j * self.row..][..self.row], &self.fore_z[j * self.row..][..self.row]);
                if here.half == [0.0; 3] {
                    here.ball_row(elbow, [x, z], [r2, r3], row);
                    continue;
                }
                for k in 0..row.len() {
                    let d = here.local_vector([x[k], z[k]]);
                    let end = [from[0] + d[0], from[1] + d[1], from[2] + d[2]];
                    row[k] = u8::from((here.segment(from, d) < r2 * r2) | (here.square(end) < r3 * r3));
                }
            }
        }
    }

    /// Tests every cell with the links as overlapping spheres that cover them.
    pub fn spheres(&self, solid: &RoundedBox, cells: &mut [u8]) {
        dispatch!(self.simd_level, _simd => self.spheres_lanes(solid, cells));
    }

    #[inline(always)]
    fn spheres_lanes(&self, solid: &RoundedBox, cells: &mut [u8]) {
        let arm = &self.arm;
        let cover = |radius: f64, length: f64| (radius.hypot(length / 16.0)) as f32 + solid.round;
        let upper = cover(arm.upper_radius_m, arm.upper_length_m);
        let fore = cover(arm.fore_radius_m, arm.fore_length_m);
        let wrist = arm.wrist_radius_m as f32 + solid.round;
        let mut flags = vec![0u32; self.row];
        for (i, &turn) in self.base.iter().enumerate() {
            let here = solid.turned(turn);
            for (j, &lean) in self.shoulder.iter().enumerate() {
                let row = &mut cells[(i * self.shoulder.len() + j) * self.row..][..self.row];
                let (shoulder, elbow) = self.joints(lean);
                let along = [elbow[0] - shoulder[0], elbow[1] - shoulder[1]];
                let on_upper = |t: f32| here.local([shoulder[0] + along[0] * t, shoulder[1] + along[1] * t]);
                if (0..9).any(|k| here.square(on_upper(k as f32 / 8.0)) < upper * upper) {
                    row.fill(1);
                    continue;
                }
                let from = here.local(elbow);
                let (x, z) = (&self.fore_x[j * self.row..][..self.row], &self.fore_z[j * self.row..][..self.row]);
                flags.fill(0);
                for sphere in 0..10 {
                    let (t, radius) = if sphere < 9 { (sphere as f32 / 8.0, fore) } else { (1.0, wrist) };
                    for k in 0..row.len() {
                        let d = here.local_vector([x[k] * t, z[k] * t]);
                        let p = [from[0] + d[0], from[1] + d[1], from[2] + d[2]];
                        flags[k] |= u32::from(here.square(p) < radius * radius);
                    }
                }
                row.iter_mut().zip(&flags).for_each(|(cell, &flag)| *cell = flag as u8);
            }
        }
    }
}
