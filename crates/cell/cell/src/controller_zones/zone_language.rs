//! The languages of zones.

/// A language in which a robot controller defines zones. `docs/references.md` names its manuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZoneLanguage {
    /// ABB RAPID with World Zones: boxes and cylinders parallel to the axes of the world, spheres.
    Rapid,
    /// KUKA KRL: up to eight Cartesian workspaces, which are boxes in any orientation.
    Krl,
}

impl ZoneLanguage {
    /// `rapid` or `krl`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Krl => "krl",
        }
    }
}
