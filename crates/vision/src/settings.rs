//! What a user of the camera decides.

use crate::{Point2, Template, VisionError};

/// What a shadow may look like. All three conditions must hold; see [`Settings::shadows`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shadows {
    /// The darkest shadow: brightness as a share of the lit floor's.
    pub darkest: f64,
    /// The faintest: the same; fainter ones are mostly within the noise.
    pub faintest: f64,
    /// How far, on average, the dimmed floor may be from its own pattern, grey levels.
    pub texture: f64,
    /// How far the ratios of the three colours may differ.
    pub tint: f64,
}

impl Default for Shadows {
    fn default() -> Self {
        Self { darkest: 0.5, faintest: 0.97, texture: 5.0, tint: 0.1 }
    }
}

/// What [`Vision`](crate::Vision) goes by. Lengths are metres, world frame; times are counted in frames.
///
/// ```
/// use elbowroom_vision::{Point2, Settings, Shadows, Template};
/// let settings = Settings {
///     cell: [(-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
///     shadows: Some(Shadows::default()),
///     templates: vec![Template::new("crate", 0.6, 0.4, 0.32)],
///     ..Settings::default()
/// };
/// assert!(settings.check().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The cell on the floor, world x and y, metres: a simple polygon. What stands wholly outside is disregarded. Empty:
    /// all that is seen counts.
    pub cell: Vec<Point2>,
    /// Height of the floor, world z, metres.
    pub floor_z_m: f64,
    /// Height above the floor of what fits no template, metres: above everything an arm can reach.
    pub unbounded_height_m: f64,
    /// By how much footprints are grown, metres: errors of the calibration, of the outline (a pixel or two) and the way
    /// that a thing goes until the next frame.
    pub uncertainty_m: f64,
    /// Obstacles are told this much larger still, so that noise and small steps do not make them move, metres. About a
    /// pixel's size on the floor.
    pub slack_m: f64,
    /// Most corners of a footprint; simplified outward.
    pub most_corners: usize,
    /// Known kinds of things. What fits none is `unbounded_height_m` high.
    pub templates: Vec<Template>,
    /// Frames in a row in which a thing must fit a template before it is believed. One camera cannot tell a high, slim
    /// thing from a lower, longer one at a single place.
    pub frames_to_fit: u32,
    /// Least difference from the background that counts, grey levels.
    pub least_difference: f64,
    /// Difference that counts, in mean deviations of the pixel (1.25 of them are a standard deviation of normal noise).
    pub deviations: f64,
    /// What is taken for a shadow. `None`: shadows are obstacles, which is safe. With it, an evenly coloured thing on an
    /// evenly coloured floor that is not darker than a shadow is not seen.
    pub shadows: Option<Shadows>,
    /// What is narrower than 2·n + 1 pixels is noise.
    pub open_px: usize,
    /// Gaps narrower than 2·n + 1 pixels are filled.
    pub close_px: usize,
    /// Smaller blobs are noise, pixels.
    pub least_area_px: usize,
    /// Frames of the empty cell from which the background is learnt.
    pub learning_frames: u32,
    /// Frames in which the background follows a change of light by about two thirds.
    pub adaptation_frames: u32,
    /// Share of the picture covered by things beyond which it is not believed.
    pub most_foreground: f64,
    /// Fastest thing, metres per second.
    pub most_speed_mps: f64,
    /// Frames in a row in which a thing must be seen before it is told.
    pub frames_to_enter: u32,
    /// Frames in a row in which a thing in plain sight must not be seen before it has left.
    pub frames_to_leave: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cell: Vec::new(),
            floor_z_m: 0.0,
            unbounded_height_m: 10.0,
            uncertainty_m: 0.03,
            slack_m: 0.01,
            most_corners: 12,
            templates: Vec::new(),
            frames_to_fit: 5,
            least_difference: 14.0,
            deviations: 6.0,
            shadows: None,
            open_px: 1,
            close_px: 1,
            least_area_px: 30,
            learning_frames: 30,
            adaptation_frames: 128,
            most_foreground: 0.5,
            most_speed_mps: 4.0,
            frames_to_enter: 1,
            frames_to_leave: 3,
        }
    }
}

impl Settings {
    /// Whether the settings make sense.
    ///
    /// # Errors
    /// The first setting that is out of its range, and its range.
    pub fn check(&self) -> Result<(), VisionError> {
        let shadows = self.shadows.unwrap_or_default();
        let ranges = [
            ("floor_z_m", self.floor_z_m, f64::MIN..=f64::MAX, "a finite number of metres"),
            ("unbounded_height_m", self.unbounded_height_m, 1e-3..=1e4, "0.001 to 10000 metres"),
            ("uncertainty_m", self.uncertainty_m, 0.0..=10.0, "0 to 10 metres"),
            ("slack_m", self.slack_m, 0.0..=10.0, "0 to 10 metres"),
            ("most_corners", self.most_corners as f64, 4.0..=1e3, "4 corners or more"),
            ("least_difference", self.least_difference, 1.0..=200.0, "1 to 200 grey levels"),
            ("deviations", self.deviations, 1.0..=15.0, "1 to 15 mean deviations"),
            ("shadows.darkest", shadows.darkest, 0.0..=shadows.faintest, "from 0 up to the faintest shadow"),
            ("shadows.faintest", shadows.faintest, 0.0..=1.0, "up to 1, the brightness of the lit floor"),
            ("shadows.texture", shadows.texture, 0.0..=255.0, "0 to 255 grey levels"),
            ("shadows.tint", shadows.tint, 0.0..=1.0, "0 to 1"),
            ("open_px", self.open_px as f64, 0.0..=50.0, "0 to 50 pixels"),
            ("close_px", self.close_px as f64, 0.0..=50.0, "0 to 50 pixels"),
            ("learning_frames", f64::from(self.learning_frames), 2.0..=10_000.0, "2 to 10000 frames of the empty cell"),
            ("adaptation_frames", f64::from(self.adaptation_frames), 8.0..=4096.0, "8 to 4096 frames"),
            ("most_foreground", self.most_foreground, 1e-3..=1.0, "a share above 0 and up to 1"),
            ("most_speed_mps", self.most_speed_mps, 1e-3..=1e3, "0.001 to 1000 metres per second"),
        ];
        for (name, value, range, expected) in ranges {
            if !range.contains(&value) {
                return Err(VisionError::Setting { name, value, expected });
            }
        }
        self.check_lists()
    }

    fn check_lists(&self) -> Result<(), VisionError> {
        if !self.cell.is_empty() && (self.cell.len() < 3 || self.cell.iter().any(|p| !p.is_finite())) {
            let (name, value) = ("cell", self.cell.len() as f64);
            return Err(VisionError::Setting { name, value, expected: "none, or three or more finite corners" });
        }
        match self.templates.iter().find_map(Template::problem) {
            Some((name, value)) => {
                let expected = "positive, finite lengths, and tolerances of 0 or more";
                Err(VisionError::Setting { name, value, expected })
            }
            None => Ok(()),
        }
    }
}
