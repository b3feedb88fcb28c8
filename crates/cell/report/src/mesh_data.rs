//! One mesh for the scripts of a page.

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Pose;
use serde_json::json;

use crate::packing::ArrayPacker;
use crate::page_meshes::{MeshUse, PageMeshes};
use crate::scene_data::PageData;

/// Data of a mesh that is drawn, in the world: `mesh` of the document refers to its vertices and triangles.
pub fn mesh_data(mesh: &TriMesh, in_world: &Pose) -> PageData {
    let vertices = mesh.vertices().iter().map(|p| in_world.transform_point(*p)).collect();
    let (mut packer, mut meshes) = (ArrayPacker::default(), PageMeshes::default());
    meshes.add(&mut packer, &(vertices, mesh.triangles().to_vec()), MeshUse::Drawn);
    let mesh = meshes.entries().pop();
    PageData { json: json!({ "mesh": mesh }), arrays: packer.bytes().to_vec() }
}
