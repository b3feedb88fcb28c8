//! The arm of the joint map: two capsules and a sphere in a plane that rotates about the base axis.

use elbowroom_spatial::Vec3;

/// An arm with a base axis (z, through the origin), a shoulder and an elbow. Upper arm and forearm are capsules; wrist,
/// tool and workpiece are one sphere (the joint-space paper, section II).
///
/// In the plane of θ1, with `r` the distance from the base axis:
///
/// - shoulder `(r, z) = (offset_m, height_m)`;
/// - elbow = shoulder + `upper_length_m` · (sin θ2, cos θ2): θ2 is measured from the vertical, positive forward;
/// - wrist = elbow + `fore_length_m` · (cos(θ2 + θ3), −sin(θ2 + θ3)): at θ3 = 0 the forearm is perpendicular to the upper
///   arm.
///
/// An arm that is bent backwards has negative `r`.
///
/// ```
/// use elbowroom_cspace::PlanarArm;
/// let arm = PlanarArm::KR125_SIZED;
/// let [shoulder, elbow, wrist] = arm.joints_in_base([0.0, 0.0, 0.0]);
/// assert_eq!((shoulder.x, shoulder.z), (0.35, 0.675));
/// assert!((elbow.z - (0.675 + 1.15)).abs() < 1e-12 && (wrist.x - (0.35 + 1.2)).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarArm {
    /// Distance of the shoulder from the base axis, metres.
    pub offset_m: f64,
    /// Height of the shoulder above the base frame, metres.
    pub height_m: f64,
    /// Length of the upper arm, metres.
    pub upper_length_m: f64,
    /// Radius of the upper arm, metres.
    pub upper_radius_m: f64,
    /// Length of the forearm, metres.
    pub fore_length_m: f64,
    /// Radius of the forearm, metres.
    pub fore_radius_m: f64,
    /// Radius of the sphere around wrist, tool and workpiece, metres.
    pub wrist_radius_m: f64,
}

/// A dimension of the arm is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the arm's {dimension} is {value_m} m: it must be a finite number, {}", .dimension.range())]
pub struct ArmError {
    /// The dimension.
    pub dimension: ArmDimension,
    /// Value of the dimension, metres.
    pub value_m: f64,
}

/// A dimension of a [`PlanarArm`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmDimension {
    /// [`PlanarArm::offset_m`].
    ShoulderOffset,
    /// [`PlanarArm::height_m`].
    ShoulderHeight,
    /// [`PlanarArm::upper_length_m`].
    UpperArmLength,
    /// [`PlanarArm::fore_length_m`].
    ForearmLength,
    /// [`PlanarArm::upper_radius_m`].
    UpperArmRadius,
    /// [`PlanarArm::fore_radius_m`].
    ForearmRadius,
    /// [`PlanarArm::wrist_radius_m`].
    WristRadius,
}

impl ArmDimension {
    fn allows(self, value_m: f64) -> bool {
        value_m.is_finite()
            && match self {
                Self::ShoulderOffset | Self::ShoulderHeight => true,
                Self::UpperArmLength | Self::ForearmLength => value_m > 0.0,
                Self::UpperArmRadius | Self::ForearmRadius | Self::WristRadius => value_m >= 0.0,
            }
    }

    /// Valid range of the dimension in words.
    fn range(self) -> &'static str {
        match self {
            Self::ShoulderOffset | Self::ShoulderHeight => "of either sign",
            Self::UpperArmLength | Self::ForearmLength => "above 0",
            Self::UpperArmRadius | Self::ForearmRadius | Self::WristRadius => "0 or more",
        }
    }
}

impl std::fmt::Display for ArmDimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ShoulderOffset => "shoulder offset",
            Self::ShoulderHeight => "shoulder height",
            Self::UpperArmLength => "upper arm length",
            Self::ForearmLength => "forearm length",
            Self::UpperArmRadius => "upper arm radius",
            Self::ForearmRadius => "forearm radius",
            Self::WristRadius => "wrist radius",
        })
    }
}

impl PlanarArm {
    /// An arm with the main dimensions of a large welding robot (shoulder 350 mm from the axis, links of about 1.2 m).
    pub const KR125_SIZED: Self = Self {
        offset_m: 0.35,
        height_m: 0.675,
        upper_length_m: 1.15,
        upper_radius_m: 0.16,
        fore_length_m: 1.2,
        fore_radius_m: 0.13,
        wrist_radius_m: 0.22,
    };

    /// The small arm of the joint-space paper: links of 225 mm and 165 mm, radius of the upper arm 85 mm. Its limits
    /// are θ2 ≥ −30° above the horizontal and 90° ≤ the angle between the links, which [`PlanarArm::from_paper`]
    /// translates.
    pub const PAPER: Self = Self {
        offset_m: 0.0,
        height_m: 0.0,
        upper_length_m: 0.225,
        upper_radius_m: 0.085,
        fore_length_m: 0.165,
        fore_radius_m: 0.08,
        wrist_radius_m: 0.08,
    };

    /// Converts joint values (rad) of the joint-space paper to joint values of this crate. The paper measures θ2 up
    /// from the horizontal and θ3 as the angle between the links (π if the arm is stretched).
    ///
    /// ```
    /// use elbowroom_cspace::PlanarArm;
    /// use std::f64::consts::PI;
    /// let [_, theta2, theta3] = PlanarArm::from_paper([0.0, 0.0, PI]); // stretched forward
    /// let wrist = PlanarArm::PAPER.joints_in_base([0.0, theta2, theta3])[2];
    /// assert!((wrist.x - 0.39).abs() < 1e-12 && wrist.z.abs() < 1e-12);
    /// ```
    pub fn from_paper([base, shoulder, between]: [f64; 3]) -> [f64; 3] {
        use std::f64::consts::{FRAC_PI_2, PI};
        [base, FRAC_PI_2 - shoulder, PI - between - FRAC_PI_2]
    }

    /// Shoulder, elbow and wrist in the base frame at joint values in radians.
    pub fn joints_in_base(&self, q: [f64; 3]) -> [Vec3; 3] {
        let (sin1, cos1) = q[0].sin_cos();
        let at = |[r, z]: [f64; 2]| Vec3::new(r * cos1, r * sin1, z);
        self.joints_in_plane(q[1], q[2]).map(at)
    }

    /// Shoulder, elbow and wrist in the plane of θ1: `[r, z]`.
    fn joints_in_plane(&self, theta2: f64, theta3: f64) -> [[f64; 2]; 3] {
        let shoulder = [self.offset_m, self.height_m];
        let (sin2, cos2) = theta2.sin_cos();
        let elbow = [shoulder[0] + self.upper_length_m * sin2, shoulder[1] + self.upper_length_m * cos2];
        let (sin23, cos23) = (theta2 + theta3).sin_cos();
        let wrist = [elbow[0] + self.fore_length_m * cos23, elbow[1] - self.fore_length_m * sin23];
        [shoulder, elbow, wrist]
    }

    /// Checks the dimensions.
    ///
    /// # Errors
    /// A dimension is not finite or negative (the shoulder's coordinates may be negative), or a link has length 0.
    pub fn validate(&self) -> Result<(), ArmError> {
        let dimensions = [
            (ArmDimension::ShoulderOffset, self.offset_m),
            (ArmDimension::ShoulderHeight, self.height_m),
            (ArmDimension::UpperArmLength, self.upper_length_m),
            (ArmDimension::ForearmLength, self.fore_length_m),
            (ArmDimension::UpperArmRadius, self.upper_radius_m),
            (ArmDimension::ForearmRadius, self.fore_radius_m),
            (ArmDimension::WristRadius, self.wrist_radius_m),
        ];
        let invalid = dimensions.into_iter().find(|(dimension, value_m)| !dimension.allows(*value_m));
        invalid.map_or(Ok(()), |(dimension, value_m)| Err(ArmError { dimension, value_m }))
    }

    /// The largest radius of the three links, metres.
    pub(crate) fn max_radius_m(&self) -> f64 {
        self.upper_radius_m.max(self.fore_radius_m).max(self.wrist_radius_m)
    }

    /// Upper bound of the distance of any point of the arm from the base frame's origin, metres.
    pub fn reach_m(&self) -> f64 {
        self.offset_m.hypot(self.height_m) + self.upper_length_m + self.fore_length_m + self.max_radius_m()
    }
}
