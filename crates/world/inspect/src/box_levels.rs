//! The boxes that queries compare, level by level, and how far they protrude.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, Robot, RobotId};
use elbowroom_scene::{Level, Scene, SceneError, SceneState};
use elbowroom_spatial::{Obb, Pose};
use rayon::prelude::*;

use crate::protrusion;

/// The boxes of one resolution level around a robot.
#[derive(Debug, Clone)]
pub struct BoxLevel {
    /// `L1`, `L2` or a depth of the box trees.
    pub level: Level,
    /// The boxes of each link with a bounded shape, in the link's frame. For L1: one box in the root link's frame, with
    /// the root link.
    pub boxes: Vec<(LinkId, Vec<Obb>)>,
    /// Upper bound on the distance of any point of a box from the solids in it, m.
    ///
    /// Proven, and at most 2 % or 0.02 mm too large for all but the largest meshes. For L1: at rest.
    pub protrusion_m: f64,
}

impl BoxLevel {
    /// Number of boxes.
    pub fn count(&self) -> usize {
        self.boxes.iter().map(|(_, boxes)| boxes.len()).sum()
    }
}

/// A link, its solids and its boxes.
type BoxedLink = (LinkId, Vec<(Shape, Pose)>, Vec<Obb>);

/// The boxes of `query --level` L1, L2 and every depth below L2, coarse first, for a robot alone at rest.
///
/// Levels end where no deeper level has more boxes. Empty if no link has a bounded shape.
///
/// ```
/// use elbowroom_inspect::box_levels;
/// use elbowroom_scene::Level;
/// let levels = box_levels(&elbowroom_robot::example::arm()?)?;
/// // Every link is one capsule, so that depths below L2 add nothing.
/// assert_eq!(levels.iter().map(|l| l.level).collect::<Vec<_>>(), [Level::L1, Level::L2]);
/// assert!(levels[0].protrusion_m > levels[1].protrusion_m);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SceneError`] if the robot makes no scene.
pub fn box_levels(robot: &Robot) -> Result<Vec<BoxLevel>, SceneError> {
    let mut builder = Scene::builder();
    builder.robot("robot", robot.clone(), Pose::IDENTITY);
    let scene = builder.build()?;
    let links: Vec<(LinkId, GeometryId)> = (0..robot.chain.links().len())
        .map(|link| (LinkId(link), GeometryId::Link { robot: RobotId(0), link: LinkId(link) }))
        .filter(|(_, id)| !scene.boxes(*id, 0).is_empty())
        .collect();
    let mut levels: Vec<BoxLevel> = whole_robot(&scene, &links)?.into_iter().collect();
    for depth in 0..=Level::MAX_DEPTH {
        let boxed: Vec<BoxedLink> = links
            .par_iter()
            .with_max_len(1)
            .map(|(link, id)| (*link, solids(&scene, *id, Pose::IDENTITY), scene.boxes(*id, depth)))
            .collect();
        let next = of_links(Level::boxes(depth), boxed);
        let adds = levels.last().is_none_or(|last| last.level == Level::L1 || next.count() > last.count());
        if next.count() == 0 || !adds {
            break;
        }
        levels.push(next);
    }
    Ok(levels)
}

fn of_links(level: Level, boxed: Vec<BoxedLink>) -> BoxLevel {
    let each = boxed.par_iter().with_max_len(1).map(|(_, solids, boxes)| protrusion::bound(boxes, solids));
    let protrusion_m = each.reduce(|| 0.0, f64::max);
    BoxLevel { level, boxes: boxed.into_iter().map(|(link, _, boxes)| (link, boxes)).collect(), protrusion_m }
}

/// L1 of the robot at rest; `None` without a bounded shape.
fn whole_robot(scene: &Scene, links: &[(LinkId, GeometryId)]) -> Result<Option<BoxLevel>, SceneError> {
    let robot = &scene.robots()[0].robot;
    let mut state = SceneState::new(scene);
    state.set_q(scene, RobotId(0), &ChainState::at_rest(&robot.chain).q)?;
    let Some(around) = state.robot_box(scene, RobotId(0)) else { return Ok(None) };
    let solids: Vec<(Shape, Pose)> =
        links.iter().flat_map(|(_, id)| solids(scene, *id, state.pose(scene, *id).unwrap_or(Pose::IDENTITY))).collect();
    let obb = Obb { pose: Pose::from_translation(around.center()), half_extents: around.extent() * 0.5 };
    Ok(Some(of_links(Level::L1, vec![(robot.chain.root(), solids, vec![obb])])))
}

/// The shapes of a link, placed.
fn solids(scene: &Scene, id: GeometryId, in_frame: Pose) -> Vec<(Shape, Pose)> {
    scene.shapes(id).map(|(shape, in_geometry)| (shape.clone(), in_frame * in_geometry)).collect()
}
