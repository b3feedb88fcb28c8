//! Interference regions as data.

use elbowroom_proximity::{Cuboid, Cylinder, HalfSpace, Shape, Sphere};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::taught_points::{TeachError, plane_rotation};
use crate::{AccessClass, SlotId, SourceState};

/// Index of a region in the [`Configuration`](crate::Configuration).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RegionId(pub usize);

/// Index of a guarded volume in the configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VolumeId(pub usize);

/// Index of a source of motion (encoder, pose sensor, frame of another robot) in the configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(pub usize);

/// How a region affects the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RegionKind {
    /// The override falls to 0 at the surface.
    Forbidden,
    /// Outputs are switched on; the override is not reduced unless `slow_to` makes the region a speed zone.
    Monitored {
        /// Largest override inside, 0..1, with a linear ramp in the warning zone.
        slow_to: Option<f64>,
    },
    /// Forbidden to all robots except the holder of the slot.
    Exchange {
        /// The lock of the region in the shared [`ZoneArbiter`](crate::ZoneArbiter).
        slot: SlotId,
    },
}

impl RegionKind {
    /// `forbidden`, `monitored` or `exchange`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forbidden => "forbidden",
            Self::Monitored { .. } => "monitored",
            Self::Exchange { .. } => "exchange",
        }
    }
}

/// Who may switch a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Life {
    /// Always active; only the integrator class may edit it.
    Permanent,
    /// Switched by programs; inactive at first.
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

    /// The lowest class that may edit or switch a region with this life.
    pub fn needed_class(self) -> AccessClass {
        match self {
            Self::Permanent => AccessClass::Integrator,
            Self::Temporary => AccessClass::Programmer,
        }
    }
}

/// The parts of the robot that a region guards against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guards {
    /// The tool centre point.
    pub tcp: bool,
    /// The tool's volume.
    pub tool: bool,
    /// The links with tool and load.
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

/// A solid with a warning zone.
///
/// `anchor` is the frame of the region's characteristic point (sphere: centre; cylinder: centre of the bottom base;
/// plane: origin; parallelepiped: centre of the bottom base). For a dynamic region, which follows a source, `anchor`
/// is given in the source's frame.
#[derive(Debug, Clone)]
pub struct Region {
    /// Name, unique in the configuration.
    pub name: String,
    /// The solid.
    pub shape: Shape,
    /// Characteristic frame, in the world or in the source that the region follows.
    pub anchor: Pose,
    /// Pose of the shape's frame in the characteristic frame.
    pub shape_in_anchor: Pose,
    /// Effect on the robot.
    pub kind: RegionKind,
    /// Who may switch the region.
    pub life: Life,
    /// Thickness δ of the warning zone, metres; 0 for none.
    pub warning_m: f64,
    /// The parts of the robot that the region guards against.
    pub guards: Guards,
    /// The source of motion that the region follows; `None` for a static region.
    pub follow: Option<SourceId>,
    /// Distance (m) beyond a boundary at which the outputs are switched off again.
    pub hysteresis_m: f64,
    /// Digital output (0..63) that is on while the robot is inside.
    pub output: Option<u8>,
    /// Digital output (0..63) that is on while the robot is inside or in the warning zone.
    pub warning_output: Option<u8>,
}

impl Region {
    /// A region with any solid; `anchor` is both the pose of the shape and its characteristic frame.
    pub fn solid(name: impl Into<String>, shape: Shape, anchor: Pose) -> Self {
        Self {
            name: name.into(),
            shape,
            anchor,
            shape_in_anchor: Pose::IDENTITY,
            kind: RegionKind::Forbidden,
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

    /// A cylinder whose base circle is centred at `base` (m), with its axis along z of `rotation`.
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
    /// [`TeachError`] if the three points lie on a line.
    pub fn plane(name: impl Into<String>, origin: Vec3, on_x: Vec3, in_xy: Vec3) -> Result<Self, TeachError> {
        let rotation = plane_rotation(origin, on_x, in_xy)?;
        Ok(Self::solid(name, Shape::HalfSpace(HalfSpace), Pose::new(rotation, origin)))
    }

    /// A box parallel to the axes, from two opposite corners (m).
    pub fn cuboid_from_corners(name: impl Into<String>, from: Vec3, to: Vec3) -> Self {
        let (low, high) = (from.min(to), from.max(to));
        let center = (low + high) * 0.5;
        Self::cuboid(name, Vec3::new(center.x, center.y, low.z), high - low, Rotation::IDENTITY)
    }

    /// A box with the centre of its bottom at `base_center` (m), rotated about it.
    pub fn cuboid(name: impl Into<String>, base_center: Vec3, size: Vec3, rotation: Rotation) -> Self {
        let half_extents = size * 0.5;
        Self {
            shape_in_anchor: Pose::from_translation(Vec3::Z * half_extents.z),
            ..Self::solid(name, Shape::Cuboid(Cuboid { half_extents }), Pose::new(rotation, base_center))
        }
    }

    /// Sets the thickness of the warning zone (m).
    #[must_use]
    pub fn warning(self, warning_m: f64) -> Self {
        Self { warning_m, ..self }
    }

    /// Sets the kind; the default is forbidden.
    #[must_use]
    pub fn kind(self, kind: RegionKind) -> Self {
        Self { kind, ..self }
    }

    /// Makes the region monitored, without a speed limit.
    #[must_use]
    pub fn monitored(self) -> Self {
        self.kind(RegionKind::Monitored { slow_to: None })
    }

    /// Sets the life; the default is permanent.
    #[must_use]
    pub fn life(self, life: Life) -> Self {
        Self { life, ..self }
    }

    /// Sets the guarded parts; the default is the arm.
    #[must_use]
    pub fn guards(self, guards: Guards) -> Self {
        Self { guards, ..self }
    }

    /// Makes the region follow a source of motion.
    #[must_use]
    pub fn follow(self, source: SourceId) -> Self {
        Self { follow: Some(source), ..self }
    }

    /// State of the source that the region follows.
    pub(crate) fn source_state<'a>(&self, sources: &'a [SourceState]) -> Option<&'a SourceState> {
        self.follow.and_then(|source| sources.get(source.0))
    }

    /// Distance (m) beyond which the region has no effect.
    pub(crate) fn reach(&self) -> f64 {
        self.warning_m + self.hysteresis_m
    }

    /// Why the region is invalid, if it is.
    pub(crate) fn problem(&self) -> Option<String> {
        let positive = |v: f64| v.is_finite() && v >= 0.0;
        if let Err(e) = self.shape.validate() {
            return Some(e.to_string());
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
        if let RegionKind::Monitored { slow_to: Some(s) } = self.kind
            && !(0.0..=1.0).contains(&s)
        {
            return Some(format!("slow_to must lie between 0 and 1, not {s}"));
        }
        let channel = [self.output, self.warning_output].into_iter().flatten().find(|c| *c > 63);
        channel.map(|c| format!("output {c} does not exist; channels are 0 to 63"))
    }
}
