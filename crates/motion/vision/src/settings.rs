//! Settings of the camera tracker.

use crate::track_settings::{TrackRules, TrackSettings};
use crate::{Template, VisionError};

/// Conditions under which a darker pixel is a shadow. All of them must hold; see [`CameraTrackerSettings::shadows`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowSettings {
    /// Brightness of the darkest shadow relative to the lit floor.
    pub min_ratio: f64,
    /// Brightness of the faintest shadow relative to the lit floor; fainter shadows are mostly within the noise.
    pub max_ratio: f64,
    /// Largest mean difference of the dimmed floor from its texture, grey levels.
    pub max_texture_error: f64,
    /// Largest difference of the ratios of the three colours.
    pub max_tint: f64,
}

impl Default for ShadowSettings {
    fn default() -> Self {
        Self { min_ratio: 0.5, max_ratio: 0.97, max_texture_error: 5.0, max_tint: 0.1 }
    }
}

/// Settings of a [`CameraTracker`](crate::CameraTracker). Lengths are metres, world frame; times are counted in frames.
///
/// ```
/// use elbowroom_vision::{CameraTrackerSettings, Point2, ShadowSettings, Template, TrackSettings};
/// let area_m = [(-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
/// let settings = CameraTrackerSettings {
///     track: TrackSettings { area_m, ..TrackSettings::default() },
///     shadows: Some(ShadowSettings::default()),
///     templates: vec![Template::new("crate", 0.6, 0.4, 0.32)],
///     ..CameraTrackerSettings::default()
/// };
/// assert!(settings.check().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CameraTrackerSettings {
    /// What trackers of all sensors have.
    pub track: TrackSettings,
    /// Height above the floor of objects without a matching template, metres: must be above everything that an arm can
    /// reach.
    pub unbounded_height_m: f64,
    /// Known types of objects. Objects without a matching template are `unbounded_height_m` high.
    pub templates: Vec<Template>,
    /// Number of frames in a row in which an object must match a template before the template is accepted. A single
    /// view cannot distinguish a high, narrow object from a lower, longer one.
    pub template_frames: u32,
    /// Smallest difference of a foreground pixel from the background, grey levels.
    pub min_difference: f64,
    /// Smallest difference of a foreground pixel, in mean deviations of the pixel (1.25 mean deviations are one
    /// standard deviation of normal noise).
    pub deviation_factor: f64,
    /// Shadow detection. `None`: shadows are obstacles, which is safe. With shadow detection, an evenly coloured object
    /// on an evenly coloured floor is not detected if it is not darker than a shadow.
    pub shadows: Option<ShadowSettings>,
    /// Radius of the morphological opening: areas narrower than 2·n + 1 pixels are noise.
    pub opening_radius_px: usize,
    /// Radius of the morphological closing: gaps narrower than 2·n + 1 pixels are filled.
    pub closing_radius_px: usize,
    /// Smallest area of a blob, pixels; smaller blobs are noise.
    pub min_area_px: usize,
    /// Number of frames of the empty cell from which the background is learnt.
    pub learning_frames: u32,
    /// Number of frames in which the background follows a change of illumination by about two thirds.
    pub adaptation_frames: u32,
    /// Largest fraction of the image that may be foreground; frames with more are rejected.
    pub max_foreground: f64,
}

impl Default for CameraTrackerSettings {
    fn default() -> Self {
        Self {
            track: TrackSettings::default(),
            unbounded_height_m: 10.0,
            templates: Vec::new(),
            template_frames: 5,
            min_difference: 14.0,
            deviation_factor: 6.0,
            shadows: None,
            opening_radius_px: 1,
            closing_radius_px: 1,
            min_area_px: 30,
            learning_frames: 30,
            adaptation_frames: 128,
            max_foreground: 0.5,
        }
    }
}

impl CameraTrackerSettings {
    /// Checks that every setting is in its range.
    ///
    /// # Errors
    /// The first setting that is out of range, with its range.
    pub fn check(&self) -> Result<(), VisionError> {
        self.track.check()?;
        let shadows = self.shadows.unwrap_or_default();
        let ranges = [
            ("unbounded_height_m", self.unbounded_height_m, 1e-3..=1e4, "0.001 to 10000 metres"),
            ("min_difference", self.min_difference, 1.0..=200.0, "1 to 200 grey levels"),
            ("deviation_factor", self.deviation_factor, 1.0..=15.0, "1 to 15 mean deviations"),
            ("shadows.min_ratio", shadows.min_ratio, 0.0..=shadows.max_ratio, "from 0 to max_ratio"),
            ("shadows.max_ratio", shadows.max_ratio, 0.0..=1.0, "up to 1, the brightness of the lit floor"),
            ("shadows.max_texture_error", shadows.max_texture_error, 0.0..=255.0, "0 to 255 grey levels"),
            ("shadows.max_tint", shadows.max_tint, 0.0..=1.0, "0 to 1"),
            ("opening_radius_px", self.opening_radius_px as f64, 0.0..=50.0, "0 to 50 pixels"),
            ("closing_radius_px", self.closing_radius_px as f64, 0.0..=50.0, "0 to 50 pixels"),
            ("learning_frames", f64::from(self.learning_frames), 2.0..=10_000.0, "2 to 10000 frames of the empty cell"),
            ("adaptation_frames", f64::from(self.adaptation_frames), 8.0..=4096.0, "8 to 4096 frames"),
            ("max_foreground", self.max_foreground, 1e-3..=1.0, "a fraction above 0 and up to 1"),
        ];
        for (name, value, range, expected) in ranges {
            if !range.contains(&value) {
                return Err(VisionError::Setting { name, value, expected });
            }
        }
        match self.templates.iter().find(|template| !template.is_usable()) {
            Some(template) => {
                let expected = "positive, finite lengths, and tolerances of 0 or more";
                Err(VisionError::Setting { name: "templates", value: template.height_m, expected })
            }
            None => Ok(()),
        }
    }

    pub(crate) fn track_rules(&self) -> TrackRules<'_> {
        TrackRules { track: &self.track, templates: &self.templates, template_frames: self.template_frames }
    }
}
