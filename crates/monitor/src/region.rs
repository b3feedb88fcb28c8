//! Interference regions: what they are, not how they are checked.

use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Cylinder, HalfSpace, Shape, ShapeError, Sphere, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::SlotId;
use crate::teach::{self, TeachError};

/// Index of a region in its [`Configuration`](crate::Configuration).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RegionId(pub usize);

/// Index of a source of motion (encoder, pose sensor, frame of another robot) in its configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(pub usize);

/// What happens at a region (S1.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The override reaches 0 at the surface.
    Forbidden,
    /// Outputs are raised; nothing is slowed, unless `slow_to` makes it a speed zone.
    Monitored {
        /// Largest override inside, 0..1, ramped through the warning zone.
        slow_to: Option<f64>,
    },
    /// Forbidden to all but the robot that holds the slot (S1.8).
    Exchange {
        /// The lock that guards it on the shared [`Board`](crate::Board).
        slot: SlotId,
    },
}

impl Kind {
    /// `forbidden`, `monitored` or `exchange`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forbidden => "forbidden",
            Self::Monitored { .. } => "monitored",
            Self::Exchange { .. } => "exchange",
        }
    }
}

/// Who may switch a region (S1.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Life {
    /// Always active; only the integrator class edits it.
    Permanent,
    /// Switched by programs; starts inactive.
    Temporary,
}

impl Life {
    /// `permanent` or `temporary`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Permanent => "permanent",
            Self::Temporary => "temporary",
        }
    }
}

/// Which parts of the robot count for a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guards {
    /// The tool centre point alone.
    pub tcp: bool,
    /// The tool's volume.
    pub tool: bool,
    /// The links, with tool and load.
    pub arm: bool,
}

impl Guards {
    /// The tool centre point.
    pub const TCP: Self = Self { tcp: true, tool: false, arm: false };
    /// The tool's volume.
    pub const TOOL: Self = Self { tcp: false, tool: true, arm: false };
    /// The links with tool and load: the default.
    pub const ARM: Self = Self { tcp: false, tool: false, arm: true };
}

impl Default for Guards {
    fn default() -> Self {
        Self::ARM
    }
}

/// A solid with a warning zone around it.
///
/// `anchor` is the frame of the region's characteristic point (S1.6: sphere: centre; cylinder: centre of the bottom
/// base; plane: origin; parallelepiped: centre of the bottom base). A region that follows a source rides on it: its
/// anchor is then given in the source's frame.
#[derive(Debug, Clone)]
pub struct Region {
    /// Unique in the configuration.
    pub name: String,
    /// The solid.
    pub shape: Shape,
    /// Characteristic frame, in the world or in the source that the region follows.
    pub anchor: Pose,
    /// Where the shape's own frame stands in the characteristic frame.
    pub shape_in_anchor: Pose,
    /// What happens there.
    pub kind: Kind,
    /// Who may switch it.
    pub life: Life,
    /// Thickness δ of the warning zone, metres; 0 for none.
    pub warning_m: f64,
    /// Whose distance counts.
    pub guards: Guards,
    /// What carries it, where it moves.
    pub follow: Option<SourceId>,
    /// How far (m) beyond a boundary the robot must be before an output falls again.
    pub hysteresis_m: f64,
    /// Digital output (0..63) raised while the robot is inside.
    pub output: Option<u8>,
    /// Digital output (0..63) raised while the robot is inside or in the warning zone.
    pub warning_output: Option<u8>,
}

impl Region {
    /// Any solid at a pose that is also its characteristic frame.
    pub fn solid(name: impl Into<String>, shape: Shape, anchor: Pose) -> Self {
        Self {
            name: name.into(),
            shape,
            anchor,
            shape_in_anchor: Pose::IDENTITY,
            kind: Kind::Forbidden,
            life: Life::Permanent,
            warning_m: 0.0,
            guards: Guards::default(),
            follow: None,
            hysteresis_m: 0.001,
            output: None,
            warning_output: None,
        }
    }

    /// A sphere around `center` (m).
    pub fn sphere(name: impl Into<String>, center: Vec3, radius: f64) -> Self {
        Self::solid(name, Shape::Sphere(Sphere { radius }), Pose::from_translation(center))
    }

    /// A cylinder on the base circle around `base` (m), its axis along z of `rotation`.
    pub fn cylinder(name: impl Into<String>, base: Vec3, radius: f64, height: f64, rotation: Rotation) -> Self {
        let half_length = height / 2.0;
        Self {
            shape_in_anchor: Pose::from_translation(Vec3::Z * half_length),
            ..Self::solid(name, Shape::Cylinder(Cylinder { half_length, radius }), Pose::new(rotation, base))
        }
    }

    /// The half-space below the plane through `origin`, `on_x` and `in_xy` (m); its z axis is the normal.
    ///
    /// # Errors
    /// [`TeachError`] where the three points lie on a line.
    pub fn plane(name: impl Into<String>, origin: Vec3, on_x: Vec3, in_xy: Vec3) -> Result<Self, TeachError> {
        let rotation = teach::plane_rotation(origin, on_x, in_xy)?;
        Ok(Self::solid(name, Shape::HalfSpace(HalfSpace), Pose::new(rotation, origin)))
    }

    /// A box from its lower-left base corner to its upper-right top corner, parallel to the axes (m).
    pub fn cuboid_from_corners(name: impl Into<String>, from: Vec3, to: Vec3) -> Self {
        let (low, high) = (from.min(to), from.max(to));
        let middle = (low + high) * 0.5;
        Self::cuboid(name, Vec3::new(middle.x, middle.y, low.z), high - low, Rotation::IDENTITY)
    }

    /// A box on the centre of its bottom (m), turned by `rotation` about it.
    pub fn cuboid(name: impl Into<String>, base_center: Vec3, size: Vec3, rotation: Rotation) -> Self {
        let half_extents = size * 0.5;
        Self {
            shape_in_anchor: Pose::from_translation(Vec3::Z * half_extents.z),
            ..Self::solid(name, Shape::Cuboid(Cuboid { half_extents }), Pose::new(rotation, base_center))
        }
    }

    /// A closed mesh, in the frame of its file.
    pub fn mesh(name: impl Into<String>, mesh: Arc<TriMesh>, anchor: Pose) -> Self {
        Self::solid(name, Shape::Mesh(mesh), anchor)
    }

    /// With a warning zone of this thickness (m).
    #[must_use]
    pub fn warning(self, warning_m: f64) -> Self {
        Self { warning_m, ..self }
    }

    /// Of another kind than forbidden.
    #[must_use]
    pub fn kind(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }

    /// Monitored, with nothing slowed.
    #[must_use]
    pub fn monitored(self) -> Self {
        self.kind(Kind::Monitored { slow_to: None })
    }

    /// Of another life than permanent.
    #[must_use]
    pub fn life(self, life: Life) -> Self {
        Self { life, ..self }
    }

    /// Guarding other parts than the arm.
    #[must_use]
    pub fn guards(self, guards: Guards) -> Self {
        Self { guards, ..self }
    }

    /// Riding on a source.
    #[must_use]
    pub fn follow(self, source: SourceId) -> Self {
        Self { follow: Some(source), ..self }
    }

    /// Beyond this distance (m) the region asks nothing of the robot.
    pub(crate) fn reach(&self) -> f64 {
        self.warning_m + self.hysteresis_m
    }

    /// Why the region cannot be used, where it cannot.
    pub(crate) fn fault(&self) -> Option<String> {
        let positive = |v: f64| v.is_finite() && v >= 0.0;
        if let Err(e) = self.shape.validate() {
            return Some(shape_fault(&e));
        }
        if !self.anchor.is_finite() || !self.shape_in_anchor.is_finite() {
            return Some("its position is not a finite number".into());
        }
        if !positive(self.warning_m) {
            return Some(format!("warning must be 0 or more, not {}", self.warning_m));
        }
        if !positive(self.hysteresis_m) {
            return Some(format!("hysteresis must be 0 or more, not {}", self.hysteresis_m));
        }
        if let Kind::Monitored { slow_to: Some(s) } = self.kind
            && !(0.0..=1.0).contains(&s)
        {
            return Some(format!("slow_to must lie between 0 and 1, not {s}"));
        }
        let channel = [self.output, self.warning_output].into_iter().flatten().find(|c| *c > 63);
        channel.map(|c| format!("output {c} does not exist; channels are 0 to 63"))
    }
}

fn shape_fault(e: &ShapeError) -> String {
    e.to_string()
}
