//! Global illumination change: one gain and one offset per plane between the background model and the present frame.
//!
//! Lamps, sun and the camera's exposure change the whole image at the same time. A line `observed = gain · learnt +
//! offset` is fitted to a grid of pixels. Among some candidate lines, the one with the most inliers is chosen and
//! refined by least squares over its inliers, so that pixels of obstacles do not affect it. On a floor without
//! contrast, the gain stays at 1.

use crate::background::BackgroundPlane;
use crate::illumination::Illumination;

/// Spacing of the samples in both directions, pixels.
const SAMPLE_STEP_PX: usize = 8;
/// Largest distance of an inlier from the line: in grey levels; then as a multiple of the mean deviation of the floor's
/// pixels.
const INLIER_LEVELS: f32 = 8.0;
const INLIER_DEVIATIONS: f32 = 2.5;
/// Deviation above which a difference does not count as noise, grey levels.
const MAX_INLIER_LEVELS: f32 = 24.0;
/// Weight of the gain 1 in the least squares, squared grey levels. A uniform floor does not determine the gain: then
/// only the offset follows the lamp. With the gain of the previous frame instead of 1, the gain would shrink from frame
/// to frame, because the noise of the learnt levels lowers each estimate slightly.
const GAIN_PRIOR_WEIGHT: f32 = 25.0;

/// Smallest number of samples for an estimate, and of inliers for a fit: with fewer, the noise of the pixels dominates.
const MIN_SAMPLES: usize = 16;
const MIN_INLIERS: f32 = 8.0;
/// Grey levels of pixels that are not saturated: saturated pixels do not follow the line.
const UNSATURATED: std::ops::Range<u8> = 3..253;

/// The line `observed = gain · learnt + offset`, offset in grey levels.
#[derive(Debug, Clone, Copy)]
struct Line {
    gain: f32,
    offset: f32,
}

/// Workspace of the estimate.
#[derive(Debug, Clone, Default)]
pub(crate) struct IlluminationEstimator {
    /// Learnt and observed grey levels.
    samples: Vec<(f32, f32)>,
    sorted: Vec<f32>,
    /// Largest distance of an inlier from the line in the present image.
    inlier_levels: f32,
}

impl IlluminationEstimator {
    /// Estimates the illumination of a plane of an image that is `width` wide; skips `frozen` pixels. The line of the
    /// previous frame, `previous`, is one of the candidates. Also returns the mean learnt level (grey levels) of the
    /// pixels that follow the line. `None` if there are too few samples.
    pub(crate) fn estimate(
        &mut self,
        plane: &BackgroundPlane,
        pixels: &[u8],
        frozen: &[u8],
        width: usize,
        previous: &Illumination,
    ) -> Option<(Illumination, f64)> {
        self.sample(plane, pixels, frozen, width);
        if self.samples.len() < MIN_SAMPLES {
            return None;
        }
        let ratio = self.median(|(learnt, observed)| observed / learnt.max(1.0));
        let offset = self.median(|(learnt, observed)| observed - learnt);
        let candidates = [
            Line { gain: previous.gain as f32, offset: previous.offset as f32 },
            Line { gain: 1.0, offset: 0.0 },
            Line { gain: ratio, offset: 0.0 },
            Line { gain: 1.0, offset },
        ];
        let best = candidates.into_iter().fold((0, candidates[0]), |best, line| {
            let inliers = self.inliers(line).count();
            if inliers > best.0 { (inliers, line) } else { best }
        });
        let line = self.refined(self.refined(best.1));
        let count = self.inliers(line).count();
        let level = self.inliers(line).map(|(learnt, _)| f64::from(*learnt)).sum::<f64>() / count.max(1) as f64;
        let inlier_ratio = count as f64 / self.samples.len() as f64;
        Some((Illumination { gain: f64::from(line.gain), offset: f64::from(line.offset), inlier_ratio }, level))
    }

    fn sample(&mut self, plane: &BackgroundPlane, pixels: &[u8], frozen: &[u8], width: usize) {
        const STEP: usize = SAMPLE_STEP_PX;
        self.samples.clear();
        self.sorted.clear();
        let starts = (STEP / 2 * width..pixels.len()).step_by(STEP * width);
        for i in starts.flat_map(|start| (start + STEP / 2..(start + width).min(pixels.len())).step_by(STEP)) {
            if frozen[i] == 0 && UNSATURATED.contains(&pixels[i]) {
                self.samples.push((plane.mean(i), f32::from(pixels[i])));
                self.sorted.push(plane.deviation(i));
            }
        }
        let noise = if self.sorted.is_empty() { 0.0 } else { middle(&mut self.sorted) };
        self.inlier_levels = (INLIER_DEVIATIONS * noise).clamp(INLIER_LEVELS, MAX_INLIER_LEVELS);
    }

    fn median(&mut self, value: impl Fn((f32, f32)) -> f32) -> f32 {
        self.sorted.clear();
        self.sorted.extend(self.samples.iter().map(|&s| value(s)));
        middle(&mut self.sorted)
    }

    fn inliers(&self, Line { gain, offset }: Line) -> impl Iterator<Item = &(f32, f32)> {
        self.samples.iter().filter(move |(b, f)| (f - gain * b - offset).abs() < self.inlier_levels)
    }

    /// Least squares over the inliers of a line.
    fn refined(&self, line: Line) -> Line {
        let inliers = || self.inliers(line);
        let n = inliers().count() as f32;
        if n < MIN_INLIERS {
            return line;
        }
        let (sum_b, sum_f) = inliers().fold((0.0, 0.0), |s, (b, f)| (s.0 + b, s.1 + f));
        let (mean_b, mean_f) = (sum_b / n, sum_f / n);
        let (cross, square) = inliers().fold((0.0, 0.0), |s, (b, f)| {
            let (b, f) = (b - mean_b, f - mean_f);
            (s.0 + b * f, s.1 + b * b)
        });
        let gain = (cross / n + GAIN_PRIOR_WEIGHT) / (square / n + GAIN_PRIOR_WEIGHT);
        Line { gain, offset: mean_f - gain * mean_b }
    }
}

/// The median of at least one value.
fn middle(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
