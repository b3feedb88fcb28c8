//! Background subtraction: compares a frame with the learnt image of the empty cell and finds the pixels that differ.

use crate::background::{BackgroundPlane, FOREGROUND, PixelClassifier, RowSubset, Thresholds};
use crate::illumination_estimator::IlluminationEstimator;
use crate::morphology::Morphology;
use crate::report::RejectReason;
use crate::shadow;
use crate::{CameraTrackerSettings, Channels, Frame, Illumination, PixelMask};

/// Every Nth row is adapted per frame, round-robin.
const ROW_STRIDE: usize = 4;
/// Accepted gains. Frames with a gain outside this range are rejected, and frames whose floor is brighter or darker by
/// a factor outside it, unless the difference is only a few grey levels.
const GAINS: std::ops::RangeInclusive<f64> = 0.4..=2.5;
const SMALL_CHANGE: f64 = 60.0;
/// Smallest fraction of the samples that follow the line of the illumination; other frames show something else and are
/// rejected.
const MIN_INLIER_RATIO: f64 = 0.5;

/// Finds the pixels of a frame that do not belong to the background.
#[derive(Debug, Clone)]
pub(crate) struct BackgroundSubtractor {
    pub width: usize,
    pub height: usize,
    frames_learnt: u32,
    planes: Vec<BackgroundPlane>,
    /// The planes of the present frame, one after the other; empty for grey frames.
    colour_planes: Vec<u8>,
    class: Vec<u8>,
    /// The result: 1 in pixels of objects.
    pub foreground: Vec<u8>,
    /// Pixels in which the background does not adapt.
    pub frozen: Vec<u8>,
    /// Number of images of the empty cell in which each pixel was not masked.
    pub learning_counts: Vec<u16>,
    /// Whether some pixels were always masked: they are unknown and therefore not free.
    has_unlearnt_pixels: bool,
    estimator: IlluminationEstimator,
    morphology: Morphology,
}

impl BackgroundSubtractor {
    /// Creates a subtractor without a background.
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            frames_learnt: 0,
            planes: Vec::new(),
            colour_planes: Vec::new(),
            class: vec![0; pixels],
            foreground: vec![0; pixels],
            frozen: vec![0; pixels],
            learning_counts: vec![0; pixels],
            has_unlearnt_pixels: false,
            estimator: IlluminationEstimator::default(),
            morphology: Morphology::default(),
        }
    }

    /// Discards the background.
    pub fn relearn(&mut self) {
        self.frames_learnt = 0;
    }

    /// Number of missing frames of the empty cell.
    pub fn frames_to_learn(&self, settings: &CameraTrackerSettings) -> u32 {
        settings.learning_frames.saturating_sub(self.frames_learnt)
    }

    /// The planes of the present frame, one after the other.
    pub fn planes_of<'a>(&'a self, frame: &'a Frame) -> &'a [u8] {
        planes_of(frame, &self.colour_planes)
    }

    /// Begins a frame: separates its colours into planes.
    pub fn begin(&mut self, frame: &Frame) {
        self.planes.resize_with(frame.channels().count(), BackgroundPlane::default);
        if frame.channels() == Channels::Rgb {
            let pixels = self.width * self.height;
            self.colour_planes.resize(3 * pixels, 0);
            let (red, rest) = self.colour_planes.split_at_mut(pixels);
            let (green, blue) = rest.split_at_mut(pixels);
            let (triples, _) = frame.pixels().as_chunks::<3>();
            for (i, &[r, g, b]) in triples.iter().enumerate().take(pixels) {
                (red[i], green[i], blue[i]) = (r, g, b);
            }
        }
    }

    /// Learns a frame of the empty cell.
    pub fn learn(&mut self, frame: &Frame, mask: &PixelMask, illumination: &mut [Illumination]) {
        let pixels = self.width * self.height;
        if self.frames_learnt == 0 {
            self.planes.iter_mut().for_each(|plane| plane.reset(pixels));
            illumination.fill(Illumination::default());
            self.learning_counts.fill(0);
        }
        self.frames_learnt += 1;
        for (count, &masked) in self.learning_counts.iter_mut().zip(mask.plane()) {
            *count += u16::from(masked == 0);
        }
        let planes = planes_of(frame, &self.colour_planes);
        for (plane, pixels) in self.planes.iter_mut().zip(planes.chunks_exact(pixels)) {
            plane.learn(pixels, &self.learning_counts, mask.plane());
        }
        self.has_unlearnt_pixels = self.learning_counts.contains(&0);
        for (frozen, &count) in self.frozen.iter_mut().zip(&self.learning_counts) {
            *frozen = u8::from(count == 0);
        }
    }

    /// Estimates the gain and offset of each plane against the background.
    pub fn estimate_illumination(
        &mut self,
        frame: &Frame,
        illumination: &mut [Illumination],
    ) -> Result<(), RejectReason> {
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(self.width * self.height);
        for ((plane, pixels), illumination) in self.planes.iter().zip(planes).zip(illumination) {
            let estimate = self.estimator.estimate(plane, pixels, &self.frozen, self.width, illumination);
            let (estimate, learnt_level) = estimate.ok_or(RejectReason::Unrecognized { inlier_ratio: 0.0 })?;
            if estimate.inlier_ratio < MIN_INLIER_RATIO {
                return Err(RejectReason::Unrecognized { inlier_ratio: estimate.inlier_ratio });
            }
            // On a floor without contrast, gain and offset are not determined separately, but the resulting level of
            // the floor is.
            let level = estimate.gain * learnt_level + estimate.offset;
            let is_as_bright = (level - learnt_level).abs() <= SMALL_CHANGE || GAINS.contains(&(level / learnt_level));
            if !GAINS.contains(&estimate.gain) || !is_as_bright {
                return Err(RejectReason::Illumination(estimate));
            }
            *illumination = estimate;
        }
        Ok(())
    }

    /// Compares each pixel with the background under the present illumination.
    pub fn classify(
        &mut self,
        frame: &Frame,
        mask: &PixelMask,
        settings: &CameraTrackerSettings,
        illumination: &[Illumination],
    ) {
        let thresholds = thresholds(settings);
        self.class.fill(0);
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(self.width * self.height);
        for ((plane, pixels), illumination) in self.planes.iter().zip(planes).zip(illumination) {
            plane.classify(&PixelClassifier::new(illumination, &thresholds), pixels, &mut self.class);
        }
        if self.has_unlearnt_pixels {
            for (class, &count) in self.class.iter_mut().zip(&self.learning_counts) {
                *class |= if count == 0 { FOREGROUND } else { 0 };
            }
        }
        clear_masked(&mut self.class, mask);
    }

    /// Decides which of the differing pixels are shadows.
    pub fn resolve_shadows(&mut self, frame: &Frame, settings: &CameraTrackerSettings, illumination: &[Illumination]) {
        let input = shadow::ShadowInput {
            pixels: planes_of(frame, &self.colour_planes),
            planes: &self.planes,
            illumination,
            width: self.width,
            height: self.height,
        };
        shadow::resolve(&input, &self.class, settings.shadows.as_ref(), &mut self.foreground);
    }

    /// Opens and closes the foreground; returns the fraction of the image that it covers.
    pub fn apply_morphology(&mut self, mask: &PixelMask, settings: &CameraTrackerSettings) -> f64 {
        self.morphology.open_and_restore(&mut self.foreground, self.width, settings.opening_radius_px);
        self.morphology.close(&mut self.foreground, self.width, settings.closing_radius_px);
        clear_masked(&mut self.foreground, mask);
        let covered: usize = self.foreground.chunks(255).map(|c| usize::from(c.iter().sum::<u8>())).sum();
        covered as f64 / self.foreground.len() as f64
    }

    /// Adapts the rows of the background that are next in turn to the frame.
    pub fn adapt(
        &mut self,
        frame: &Frame,
        number: u64,
        settings: &CameraTrackerSettings,
        illumination: &[Illumination],
    ) {
        let thresholds = thresholds(settings);
        let (width, height) = (self.width, self.height);
        let first = (number % ROW_STRIDE as u64) as usize;
        let rows = RowSubset { width, height, first, stride: ROW_STRIDE };
        let shift = (f64::from(settings.adaptation_frames) / ROW_STRIDE as f64).log2().round().clamp(1.0, 10.0);
        let planes = planes_of(frame, &self.colour_planes).chunks_exact(width * height);
        for ((plane, pixels), illumination) in self.planes.iter_mut().zip(planes).zip(illumination) {
            let classifier = PixelClassifier::new(illumination, &thresholds);
            plane.adapt(&classifier, pixels, &self.frozen, rows, shift as u32);
        }
    }
}

fn thresholds(settings: &CameraTrackerSettings) -> Thresholds {
    let shadow_range = settings.shadows.map_or((2.0, 1.0), |s| (s.min_ratio, s.max_ratio));
    let (min_difference, deviation_factor) = (settings.min_difference, settings.deviation_factor);
    Thresholds { min_difference, deviation_factor, shadow_range }
}

fn planes_of<'a>(frame: &'a Frame, colour_planes: &'a [u8]) -> &'a [u8] {
    if frame.channels() == Channels::Grey { frame.pixels() } else { colour_planes }
}

fn clear_masked(plane: &mut [u8], mask: &PixelMask) {
    if !mask.is_empty() {
        for (pixel, &masked) in plane.iter_mut().zip(mask.plane()) {
            *pixel &= masked.wrapping_sub(1);
        }
    }
}
