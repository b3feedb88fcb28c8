//! Meshes that were exported in another frame than their link's: they load, and stand beside the robot.

use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_scene::Robot;
use elbowroom_spatial::{Aabb, Vec3};

/// A link that moves about an axis farther from its solids than this share of their size is doubtful.
const FAR: f64 = 0.5;

/// One sentence for each link whose solids lie far from the joint that moves it.
pub(super) fn doubts(robot: &Robot) -> Vec<String> {
    let links = robot.bodies.iter().enumerate().filter(|(_, bodies)| !bodies.is_empty());
    links.filter_map(|(link, bodies)| {
        let boxes = bodies.iter().filter(|b| matches!(b.shape, Shape::Mesh(_))).map(|b| b.shape.aabb(&b.in_link));
        let solid = boxes.fold(Aabb::EMPTY, |all, b| all.union(&b));
        let gap = gap_to_joint(&robot.chain, LinkId(link), &solid)?;
        (gap > FAR * solid.extent().max_element()).then(|| {
            let name = &robot.chain.links()[link];
            format!(
                "the meshes of `{name}` lie {:.0} mm from the joint that moves it: were they exported in another frame? \
                 They count where the file puts them",
                gap * 1000.0
            )
        })
    }).collect()
}

/// Distance between a link's solids and the axis of the joint that moves it; the joint's frame is the link's.
fn gap_to_joint(chain: &Chain, link: LinkId, solid: &Aabb) -> Option<f64> {
    let joint = &chain.joints()[chain.parent_joint(link)?.0];
    if !joint.kind.turns() || solid.is_empty() {
        return None;
    }
    // The axis is sampled where it passes the solids.
    let reach = solid.center().length() + solid.extent().length();
    let on_axis = |i: i32| joint.axis * (reach * f64::from(i) / 100.0);
    let distance = |p: Vec3| solid.distance(&Aabb { min: p, max: p });
    (-100..=100).map(|i| distance(on_axis(i))).min_by(f64::total_cmp)
}
