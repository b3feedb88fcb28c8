//! Why a navigator refuses its tool, its surfaces or its settings.

/// Why a navigator was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NavigatorError {
    /// A surface has a border, so it has no inside to protect.
    #[error("the protected mesh is open; close it: an open surface has no inside to protect")]
    Open,
    /// The triangles of a surface face inwards.
    #[error("the protected mesh is inside out; reverse its triangles, so that their normals point away from the solid")]
    InsideOut,
    /// Neighbouring triangles of a surface face to opposite sides.
    #[error("the triangles of the protected mesh face to different sides; orient them all outwards")]
    Unoriented,
    /// The pose of a surface or of the tool is not finite.
    #[error("the pose of {0} has a number that is not finite")]
    PoseNotFinite(&'static str),
    /// The tool starts too near to a surface, or inside it.
    #[error("the tool starts {:.3} mm from a protected surface; move it away to at least {:.3} mm", gap_m * 1e3, least_gap_m * 1e3)]
    TooNear {
        /// Distance at the start, metres; 0 inside.
        gap_m: f64,
        /// The least distance, metres.
        least_gap_m: f64,
    },
    /// The arm does not hold its tool at the pose of the navigator, so nothing would be proven.
    #[error("the arm does not hold its tool at the pose of the navigator; make both of one configuration")]
    NotAtTool,
    /// A guide along a line has too few points.
    #[error("a guide along a line needs two points or more, all finite, and no two successive equal ones")]
    GuideLine,
    /// The axis of a guide has no length.
    #[error("the axis or normal of a guide must be a direction, and its point finite")]
    GuideDirection,
    /// The range of depths of a point of entry is empty.
    #[error("the depth of a guide is from {:.3} mm to {:.3} mm; the second must be larger", least_m * 1e3, most_m * 1e3)]
    GuideDepth {
        /// Least length of the shaft beyond the point, metres.
        least_m: f64,
        /// Largest length, metres.
        most_m: f64,
    },
    /// A setting is not usable.
    #[error("{name} is {value}; it must be {wanted}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
}

impl NavigatorError {
    /// Refuses the first setting that is not a positive number.
    pub(crate) fn check_positive(settings: &[(&'static str, f64)]) -> Result<(), Self> {
        first(settings, |x| x.is_finite() && x > 0.0, "a positive number")
    }

    /// Refuses the first setting that is not a number, or negative.
    pub(crate) fn check_not_negative(settings: &[(&'static str, f64)]) -> Result<(), Self> {
        first(settings, |x| x.is_finite() && x >= 0.0, "a number that is not negative")
    }
}

/// The first setting that is not as it must be.
fn first(
    settings: &[(&'static str, f64)],
    is_usable: impl Fn(f64) -> bool,
    wanted: &'static str,
) -> Result<(), NavigatorError> {
    match settings.iter().find(|(_, value)| !is_usable(*value)) {
        Some(&(name, value)) => Err(NavigatorError::Setting { name, value, wanted }),
        None => Ok(()),
    }
}
