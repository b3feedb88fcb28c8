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
