//! The light of today against the light in which the background was learnt: one gain and one offset per plane.
//!
//! Lamps, sun and the camera's own exposure change the whole picture at once. A line `seen = gain · learnt + offset` is
//! fitted to a grid of pixels; those that something stands on are outvoted: the candidate line with the most pixels near
//! it wins and is then refined by least squares over those.

use crate::background::Plane;

/// Pixels between samples, both ways.
const GRID: usize = 8;
/// Distance from the line, in grey levels, up to which a sample agrees.
const NEAR: f32 = 8.0;
/// Weight of the candidate's gain against the samples', in squared grey levels: an even floor tells no gain.
const STIFFNESS: f32 = 25.0;

/// `seen = gain · learnt + offset`, offset in grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Ratio of brightness to that of the learnt background.
    pub gain: f64,
    /// What is added, grey levels.
    pub offset: f64,
    /// Share of the samples that agree, 0 to 1.
    pub agreeing: f64,
}

impl Default for Light {
    fn default() -> Self {
        Self { gain: 1.0, offset: 0.0, agreeing: 1.0 }
    }
}

/// Scratch of the estimate.
#[derive(Debug, Clone, Default)]
pub(crate) struct Estimator {
    samples: Vec<(f32, f32)>,
    sorted: Vec<f32>,
}

impl Estimator {
    /// The light of a plane of a picture that is `width` wide; pixels with `held` other than 0 are left out. The line
    /// of the frame before, `last`, is one of the candidates. `None` where too little of the floor is in sight.
    pub(crate) fn estimate(
        &mut self,
        plane: &Plane,
        pixels: &[u8],
        held: &[u8],
        width: usize,
        last: &Light,
    ) -> Option<Light> {
        self.sample(plane, pixels, held, width);
        if self.samples.len() < 16 {
            return None;
        }
        let ratio = self.median(|(b, f)| f / b.max(1.0));
        let shift = self.median(|(b, f)| f - b);
        let candidates = [(last.gain as f32, last.offset as f32), (1.0, 0.0), (ratio, 0.0), (1.0, shift)];
        let best = candidates.into_iter().fold((0, candidates[0]), |best, line| {
            let votes = self.agreeing(line);
            if votes > best.0 { (votes, line) } else { best }
        });
        let line = self.refined(self.refined(best.1));
        let agreeing = self.agreeing(line) as f64 / self.samples.len() as f64;
        Some(Light { gain: f64::from(line.0), offset: f64::from(line.1), agreeing })
    }

    fn sample(&mut self, plane: &Plane, pixels: &[u8], held: &[u8], width: usize) {
        self.samples.clear();
        let starts = (GRID / 2 * width..pixels.len()).step_by(GRID * width);
        for i in starts.flat_map(|start| (start + GRID / 2..(start + width).min(pixels.len())).step_by(GRID)) {
            // Black and white are where sensors end, not what the light makes.
            if held[i] == 0 && pixels[i] > 2 && pixels[i] < 253 {
                self.samples.push((plane.mean(i), f32::from(pixels[i])));
            }
        }
    }

    fn median(&mut self, value: impl Fn((f32, f32)) -> f32) -> f32 {
        self.sorted.clear();
        self.sorted.extend(self.samples.iter().map(|&s| value(s)));
        let middle = self.sorted.len() / 2;
        *self.sorted.select_nth_unstable_by(middle, f32::total_cmp).1
    }

    fn agreeing(&self, (gain, offset): (f32, f32)) -> usize {
        self.samples.iter().filter(|(b, f)| (f - gain * b - offset).abs() < NEAR).count()
    }

    fn refined(&self, (gain, offset): (f32, f32)) -> (f32, f32) {
        let near = || self.samples.iter().filter(|(b, f)| (f - gain * b - offset).abs() < NEAR);
        let n = near().count() as f32;
        if n < 8.0 {
            return (gain, offset);
        }
        let (sum_b, sum_f) = near().fold((0.0, 0.0), |s, (b, f)| (s.0 + b, s.1 + f));
        let (mean_b, mean_f) = (sum_b / n, sum_f / n);
        let (cross, square) = near().fold((0.0, 0.0), |s, (b, f)| {
            let (b, f) = (b - mean_b, f - mean_f);
            (s.0 + b * f, s.1 + b * b)
        });
        let refined = (cross / n + STIFFNESS * gain) / (square / n + STIFFNESS);
        (refined, mean_f - refined * mean_b)
    }
}
