//! An obstacle at its place, seen from sixteen values of the axis in lanes.

use elbowroom_spatial::Pose;
use elbowroom_validity::lanes::{LANES, PointRow};

use super::axis_roles::AxisRoles;
use super::block_level::single;
use super::cover_class::CoverClass;
use super::obstacle::{CoverObstacle, Element};
use super::solid_core::SolidCore;
use super::step_chain::Step;
use crate::Grid;

/// Rounding errors of coordinates and distances in single precision, per metre that coordinates reach: six rotations and
/// translations, each rounded (3·10⁻⁷), and the products and sums of three of them.
const ROUNDING_SHARE: f64 = 5e-6;

/// Pose of the first joint's frame in that of the obstacle.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellPose {
    pub columns: [[f32; 3]; 3],
    pub origin: [f32; 3],
}

/// Poses of the first joint's frame in that of the obstacle, one per lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseLanes {
    pub columns: [PointRow; 3],
    pub origin: PointRow,
}

impl PoseLanes {
    /// The pose of one lane.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn pose(&self, lane: usize) -> CellPose {
        let [x, y, z] = &self.columns;
        CellPose { columns: [of_lane(x, lane), of_lane(y, lane), of_lane(z, lane)], origin: of_lane(&self.origin, lane) }
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a kernel")]
pub(super) fn of_lane(row: &PointRow, lane: usize) -> [f32; 3] {
    [row.0[0].0[lane], row.0[1].0[lane], row.0[2].0[lane]]
}

/// What proves a contact: every point of a cover's sphere is within its slack of the link.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactCore {
    pub core: SolidCore,
    /// m.
    pub radius: f32,
}

/// An obstacle at its place.
#[derive(Debug)]
pub(super) struct ObstacleLanes<'a> {
    pub elements: &'a [Element],
    /// Per element, what proves a contact with a sphere of a cover; none for inner nodes.
    pub contacts: Vec<Option<ContactCore>>,
    /// Per level, sixteen boxes of the axis in lanes after the other.
    pub poses: Vec<Vec<PoseLanes>>,
    /// Rounding errors of a distance, m.
    pub rounding: f32,
    /// Counted contacts are those of the solids; otherwise those of the covers.
    pub is_exact: bool,
}

impl<'a> ObstacleLanes<'a> {
    /// `first` is the joint of the axis in lanes. `slack_m` is that of the covers, in an exact map; `None` where contacts of
    /// the covers count.
    pub fn new(
        obstacle: &'a CoverObstacle,
        in_world: &Pose,
        first: &Step,
        classes: &[CoverClass],
        grid: &Grid,
        roles: &AxisRoles,
        slack_m: Option<f64>,
    ) -> Self {
        let at_zero = (*in_world * obstacle.frame).inverse() * first.at_zero;
        let reach = classes.iter().map(|class| class.reach_m).fold(0.0, f64::max);
        let rounding = ROUNDING_SHARE * (1.0 + at_zero.translation.length() + 2.0 * reach + obstacle.reach_m);
        let levels = classes.iter().map(|class| class.levels.len()).max().unwrap_or(0);
        let axis = &grid.axes()[roles.lanes];
        let poses = |level: usize| {
            let size = 1usize << level;
            let boxes = roles.lane_count().div_ceil(size);
            let value = |at: usize| axis.border(at * size) + 0.5 * size as f64 * axis.step();
            let pose = |at: usize| at_zero * first.moved(value(at) * first.multiplier);
            (0..boxes.div_ceil(LANES)).map(|group| pose_lanes(group * LANES, pose)).collect()
        };
        Self {
            elements: &obstacle.elements,
            contacts: obstacle.elements.iter().map(|element| contact(element, obstacle, slack_m)).collect(),
            poses: (0..levels).map(poses).collect(),
            rounding: rounding as f32,
            is_exact: slack_m.is_some(),
        }
    }
}

fn pose_lanes(first: usize, pose: impl Fn(usize) -> Pose) -> PoseLanes {
    let mut rows = PoseLanes { columns: [PointRow::ZERO; 3], origin: PointRow::ZERO };
    for lane in 0..LANES {
        let pose = pose(first + lane);
        let columns = [pose.rotation.x_axis(), pose.rotation.y_axis(), pose.rotation.z_axis()].map(single);
        let origin = single(pose.translation);
        for k in 0..3 {
            for (row, column) in rows.columns.iter_mut().zip(&columns) {
                row.0[k].0[lane] = column[k];
            }
            rows.origin.0[k].0[lane] = origin[k];
        }
    }
    rows
}

fn contact(element: &Element, obstacle: &CoverObstacle, slack_m: Option<f64>) -> Option<ContactCore> {
    if !element.is_leaf {
        return None;
    }
    let Some(slack_m) = slack_m else {
        return Some(ContactCore { core: element.core, radius: element.radius });
    };
    if !obstacle.is_exact {
        return None;
    }
    let slack = slack_m as f32;
    if element.radius >= slack {
        return Some(ContactCore { core: element.core, radius: element.radius - slack });
    }
    let core = element.core.eroded(slack - element.radius)?;
    let radius = if core == SolidCore::HalfSpace { element.radius - slack } else { 0.0 };
    Some(ContactCore { core, radius })
}
