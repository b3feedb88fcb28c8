//! Robots of one model share its meshes, unless their tables ask for other models.

use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::Robot;
use elbowroom_testkit::folder::examples;

fn meshes(robot: &Robot) -> Vec<&Arc<TriMesh>> {
    let colliders = robot.colliders.iter().flatten();
    colliders.filter_map(|c| if let Shape::Mesh(mesh) = &c.shape { Some(mesh) } else { None }).collect()
}

#[test]
fn robots_of_one_model_share_its_meshes_and_no_table_changes_another_robot() {
    let model = "model = \"models/ns16/ns16.urdf\"";
    let tables = ["", "srdf = \"models/ns16/ns16.srdf\"", "unit = \"mm\"", "ignore = [[\"base_link\", \"link_3\"]]"];
    let tables = tables
        .iter()
        .enumerate()
        .map(|(k, keys)| format!("[robot.r{k}]\n{model}\n{keys}\nbase = {{ at = [{}, 0, 0] }}\n", 3 * k));
    let text = format!("version = 1\nunits = {{ length = \"m\", angle = \"deg\" }}\n{}", tables.collect::<String>());
    let cell = Cell::parse(examples().join("cell.toml"), &text).unwrap();
    let [first, with_srdf, in_mm, ignoring] = [0, 1, 2, 3].map(|k| &cell.robots[k].robot);
    let is_shared = |other: &Robot| meshes(first).iter().zip(meshes(other)).all(|(a, b)| Arc::ptr_eq(a, b));
    assert!(!meshes(first).is_empty() && is_shared(ignoring) && !is_shared(with_srdf) && !is_shared(in_mm));
    assert!(
        first.disabled_pairs.is_empty() && !with_srdf.disabled_pairs.is_empty() && ignoring.disabled_pairs.len() == 1
    );
    let size = |robot: &Robot| meshes(robot)[0].aabb().extent().x;
    assert!((size(first) - 1e3 * size(in_mm)).abs() < 1e-9 * size(first), "{} {}", size(first), size(in_mm));
}
