//! Objects as tables of a cell file.

use std::fmt::Write;

use elbowroom_formats::MeshData;
use elbowroom_proximity::{Shape, tessellate};
use elbowroom_scene::Object;

use crate::seal::value::key;

/// A cell file without robots, and its meshes by their names relative to it.
#[derive(Debug, Clone, Default)]
pub struct ObjectTables {
    /// The text, in metres and degrees: `version`, `units`, and a table per object.
    pub toml: String,
    /// Mesh files.
    pub meshes: Vec<(String, MeshData)>,
}

/// Writes objects as tables of a cell file, with all digits of their numbers. `folder` holds the mesh files.
///
/// ```
/// use elbowroom_cell::{Cell, object_tables};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_scene::Object;
/// use elbowroom_spatial::{Pose, Vec3};
/// let in_world = Pose::from_translation(Vec3::new(0.1, 0.2, 1.0 / 3.0));
/// let ball = Object { name: "red ball".into(), shape: Shape::Sphere(Sphere { radius: 0.05 }), in_world };
/// let text = object_tables(&[ball], "meshes").toml;
/// assert!(text.contains("[object.\"red ball\"]\nshape = \"sphere\""));
/// assert_eq!(Cell::parse("cell.toml", &text)?.objects[0].in_world, in_world);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn object_tables(objects: &[Object], folder: &str) -> ObjectTables {
    let mut tables = ObjectTables::default();
    tables.toml.push_str("version = 1\nunits = { length = \"m\", angle = \"deg\" }\n");
    for object in objects {
        // Writing to a String cannot fail.
        let _ = table(object, folder, &mut tables);
    }
    tables
}

fn table(object: &Object, folder: &str, tables: &mut ObjectTables) -> std::fmt::Result {
    let ObjectTables { toml, meshes } = tables;
    write!(toml, "\n[object.{}]\nshape = ", key(&object.name))?;
    match &object.shape {
        Shape::Cuboid(c) => writeln!(toml, "\"box\"\nsize = {:?}", (c.half_extents * 2.0).to_array())?,
        Shape::Sphere(s) => writeln!(toml, "\"sphere\"\nradius = {:?}", s.radius)?,
        Shape::Cylinder(c) => {
            writeln!(toml, "\"cylinder\"\nradius = {:?}\nheight = {:?}", c.radius, 2.0 * c.half_length)?;
        }
        Shape::Capsule(c) => {
            writeln!(toml, "\"capsule\"\nradius = {:?}\nheight = {:?}", c.radius, 2.0 * c.half_length)?;
        }
        Shape::HalfSpace(_) => writeln!(toml, "\"plane\"")?,
        Shape::Hull(_) | Shape::Mesh(_) => {
            let (vertices, triangles) = tessellate::tessellate(&object.shape, 0.0);
            let file = format!("{folder}/{}.stl", meshes.len() + 1);
            writeln!(toml, "\"mesh\"\nmesh = {file:?}")?;
            meshes.push((file, MeshData { name: object.name.clone(), vertices, triangles }));
        }
    }
    let pose = object.in_world;
    writeln!(toml, "at = {:?}", pose.translation.to_array())?;
    let quaternion = pose.rotation.to_quaternion_xyzw();
    if quaternion != [0.0, 0.0, 0.0, 1.0] {
        writeln!(toml, "quaternion = {quaternion:?}")?;
    }
    Ok(())
}
