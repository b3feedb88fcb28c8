//! VRML 2: a file for every kind of node.

use std::path::Path;

use elbowroom_formats::{Diagnostic, LoadedMeshes, MeshData, NodeTree, vrml};
use elbowroom_proximity::TriMesh;
use elbowroom_spatial::{Rotation, Vec3};
use proptest::prelude::*;

pub const HEADER: &str = "#VRML V2.0 utf8\n";
/// A triangle in the plane z = 0.
pub const FACE: &str =
    "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 ] } }";

pub fn parse(body: &str) -> Result<LoadedMeshes, Diagnostic> {
    vrml::parse(format!("{HEADER}{body}").as_bytes(), Path::new("a.wrl"))
}

fn tree(body: &str) -> NodeTree {
    vrml::parse_tree(format!("{HEADER}{body}").as_bytes(), Path::new("a.wrl")).unwrap_or_else(|e| panic!("{e}"))
}

fn meshes(body: &str) -> Vec<MeshData> {
    parse(body).unwrap_or_else(|e| panic!("{e}")).meshes
}

fn only(body: &str) -> MeshData {
    let mut all = meshes(body);
    assert_eq!(all.len(), 1);
    all.remove(0)
}

pub fn refused(body: &str) -> String {
    parse(body).map(|l| l.meshes.len()).expect_err(body).to_string()
}

pub fn geometry(text: &str) -> MeshData {
    only(&format!("Shape {{ geometry {text} }}"))
}

/// Volume by the divergence theorem: negative if a closed mesh is inside out.
fn volume(mesh: &MeshData) -> f64 {
    let v = |i: u32| mesh.vertices[i as usize];
    mesh.triangles.iter().map(|t| v(t[0]).dot(v(t[1]).cross(v(t[2]))) / 6.0).sum()
}

fn assert_closed(mesh: &MeshData) {
    let report = TriMesh::new(mesh.vertices.clone(), mesh.triangles.clone()).unwrap();
    assert!(report.report().closed && !report.report().inside_out && volume(mesh) > 0.0);
}

fn normal(mesh: &MeshData, triangle: usize) -> Vec3 {
    let [a, b, c] = mesh.triangles[triangle].map(|i| mesh.vertices[i as usize]);
    (b - a).cross(c - a).try_normalize().unwrap()
}

#[test]
fn a_face_set_has_its_polygons_as_triangles() {
    let coordinates = "coord Coordinate { point [ 9 9 9, 0 0 0, 2 0 0, 2 1 0, 1 0.25 0, 0 1 0 ] }";
    // A concave polygon of five corners and a triangle, after a point that nothing uses.
    let set =
        |more: &str| geometry(&format!("IndexedFaceSet {{ {coordinates} coordIndex [ 1,2,3,4,5,-1 1 2 4 ] {more} }}"));
    let mesh = set("convex FALSE solid FALSE creaseAngle 0.5");
    assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (4, 5));
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
        (b - a).cross(c - a).z / 2.0
    };
    assert!((mesh.triangles[..3].iter().map(area).sum::<f64>() - 1.25).abs() < 1e-12);
    assert_eq!(normal(&mesh, 0), Vec3::Z);
    assert_eq!(normal(&set("ccw FALSE"), 0), -Vec3::Z);
}

#[test]
fn appearances_colours_and_normals_change_nothing() {
    let plain = only(FACE);
    let text = "Shape {
        appearance DEF look Appearance { material Material { diffuseColor 1 0 0 } texture ImageTexture { url \"a.png\" } }
        geometry IndexedFaceSet {
          coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 ]
          color Color { color [ 1 0 0, 0 1 0 ] } normal Normal { vector [ 0 0 1 ] } colorIndex [ 0 1 1 -1 ]
          texCoord TextureCoordinate { point [ 0 0 ] } texCoordIndex [ 0 0 0 ] colorPerVertex FALSE } }
      PointLight { location 1 2 3 } NavigationInfo { type [\"EXAMINE\", \"ANY\"] } Background { skyColor [ 0 0 1 ] }";
    let loaded = parse(text).unwrap();
    assert_eq!(loaded.meshes[0].triangles, plain.triangles);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

/// The order of the standard, against a matrix product written out.
#[test]
fn a_transform_applies_its_parts_in_the_order_of_the_standard() {
    let text = "Transform { translation 1 2 3 rotation 1 2 2 0.7 scale 2 3 0.5 scaleOrientation 0 0.6 0.8 -0.4
        center 0.1 -0.2 0.3 children Shape { geometry IndexedFaceSet {
        coord Coordinate { point [ 0.5 0 0 0 0.7 0 0.2 0.3 0.9 ] } coordIndex [ 0 1 2 ] } } }";
    let mesh = only(text);
    let turn = Rotation::from_axis_angle(Vec3::new(1.0, 2.0, 2.0) * (1.0 / 3.0), 0.7);
    let tilt = Rotation::from_axis_angle(Vec3::new(0.0, 0.6, 0.8), -0.4);
    let center = Vec3::new(0.1, -0.2, 0.3);
    let expected = [[0.5, 0.0, 0.0], [0.0, 0.7, 0.0], [0.2, 0.3, 0.9]].map(|v| {
        let scaled = tilt * (tilt.inverse() * (Vec3::from(v) - center)).scale(Vec3::new(2.0, 3.0, 0.5));
        turn * scaled + center + Vec3::new(1.0, 2.0, 3.0)
    });
    let off = mesh.vertices.iter().zip(expected).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    assert!(off < 1e-14, "{off}");
    let upside = only(&format!("Transform {{ scale 1 1 -1 children [ {FACE} ] }}"));
    assert_eq!(normal(&upside, 0), -Vec3::Z, "a mirror image keeps its outside");
}

#[test]
fn frames_have_the_names_of_def_and_shapes_belong_to_the_nearest() {
    let text = format!(
        "{FACE} DEF base Transform {{ children [ {FACE} DEF skin {FACE}
           Group {{ children Transform {{ translation 0 0 1 children [ DEF hand Group {{ children {FACE} }} ] }} }} ] }}"
    );
    let tree = tree(&text);
    let names: Vec<_> = tree.nodes.iter().map(|n| (n.name.as_str(), n.parent, n.meshes.len())).collect();
    assert_eq!(names, [("a", None, 1), ("base", None, 1), ("node_2", Some(1), 0), ("hand", Some(2), 1)]);
    assert_eq!(tree.nodes[1].meshes[0].triangles.len(), 2);
    assert_eq!(tree.in_world()[3].translation, Vec3::Z);
}

#[test]
fn scale_goes_into_the_meshes_so_that_frames_are_rigid() {
    let text = format!(
        "DEF a Transform {{ scale 0.001 0.001 0.001 children DEF b Transform {{ translation 500 0 0 children {FACE} }} }}"
    );
    let tree = tree(&text);
    assert!(tree.in_world()[1].translation.distance(Vec3::X * 0.5) < 1e-15);
    assert!((tree.nodes[1].meshes[0].vertices[1].x - 0.001).abs() < 1e-15);
}

#[test]
fn used_nodes_are_read_where_they_are_used() {
    let text = format!(
        "DEF one Transform {{ children {FACE} }} Transform {{ translation 5 0 0 children [ USE one ] }}
         Shape {{ geometry IndexedFaceSet {{ coord DEF c Coordinate {{ point [ 0 0 7 1 0 7 0 1 7 ] }} coordIndex [ 0 1 2 ] }} }}
         Shape {{ geometry DEF g IndexedFaceSet {{ coord USE c coordIndex [ 2 1 0 -1 ] }} }} Shape {{ geometry USE g }}"
    );
    let all = meshes(&text);
    assert_eq!(all.iter().map(|m| m.triangles.len()).collect::<Vec<_>>(), [1, 1, 3]);
    assert_eq!(all[1].vertices[0], Vec3::X * 5.0);
    // The last definition before the use counts.
    let twice = format!("DEF a Group {{ }} DEF a Group {{ children [ {FACE} USE a ] }} USE a");
    assert_eq!(meshes(&twice).len(), 2);
    let message = refused("Group {\n children [\n DEF a Group { children USE a } ] }");
    assert!(message.starts_with("a.wrl:4: USE a: there is no complete node"), "{message}");
}

#[test]
fn groups_of_all_kinds_give_their_children() {
    for group in [
        "Group { children [ FACE ] }",
        "Anchor { url \"http://example.org\" description \"a\" children FACE }",
        "Billboard { axisOfRotation 0 1 0 children [ FACE ] }",
        "Collision { collide FALSE children FACE proxy Shape { geometry Box { } } }",
        "Collision { proxy FACE }",
        "Switch { whichChoice 1 choice [ Group { } FACE ] }",
        "LOD { center 0 0 0 range [ 1, 5 ] level [ FACE Shape { geometry Box { } } ] }",
        "Group { bboxCenter 0 0 0 bboxSize 1 1 1 children [ Group { children FACE } ] }",
    ] {
        let loaded = parse(&group.replace("FACE", FACE)).unwrap_or_else(|e| panic!("{group}: {e}"));
        assert_eq!((loaded.meshes.len(), loaded.meshes[0].triangles.len()), (1, 1), "{group}");
        assert!(loaded.warnings.is_empty(), "{group}: {:?}", loaded.warnings);
    }
}

#[test]
fn boxes_are_exact() {
    let mesh = geometry("Box { size 1 2 3 }");
    assert_eq!((mesh.aabb().min, mesh.aabb().max), (Vec3::new(-0.5, -1.0, -1.5), Vec3::new(0.5, 1.0, 1.5)));
    assert!((volume(&mesh) - 6.0).abs() < 1e-12);
    assert_closed(&mesh);
    assert_eq!(geometry("Box { }").aabb().extent(), Vec3::splat(2.0));
}

/// Nearest and farthest distance of a mesh's surface from the axis y, at one height.
fn around_y(mesh: &MeshData, height: f64) -> (f64, f64) {
    let ring: Vec<Vec3> =
        mesh.vertices.iter().filter(|v| (v.y - height).abs() < 1e-12 && v.x.hypot(v.z) > 0.0).copied().collect();
    let middle = |i: usize| (ring[i] + ring[(i + 1) % ring.len()]) * 0.5;
    let near = (0..ring.len()).map(|i| middle(i).x.hypot(middle(i).z)).fold(f64::INFINITY, f64::min);
    (near, ring.iter().map(|v| v.x.hypot(v.z)).fold(0.0, f64::max))
}

proptest! {
    /// The triangles enclose the solid and exceed it by no more than is documented.
    #[test]
    fn round_solids_are_enclosed_closely(radius in 1e-4..10.0f64, height in 1e-3..10.0f64, scale in 0.01..100.0f64) {
        let solid = |text: &str| {
            let text = format!("Transform {{ scale {scale} {scale} {scale} children Shape {{ geometry {text} }} }}");
            let mut mesh = only(&text);
            mesh.scale(Vec3::splat(1.0 / scale));
            mesh
        };
        let allowed = (1e-4 / scale).max(1e-3 * radius) * (1.0 + 1e-9);
        let cylinder = solid(&format!("Cylinder {{ radius {radius} height {height} }}"));
        let cone = solid(&format!("Cone {{ bottomRadius {radius} height {height} }}"));
        let sphere = solid(&format!("Sphere {{ radius {radius} }}"));
        for (mesh, at) in [(&cylinder, -0.5), (&cylinder, 0.5), (&cone, -0.5)] {
            let ring: Vec<Vec3> = mesh.vertices.iter().filter(|v| (v.y - at * height).abs() < 1e-9 * height).copied().collect();
            let far = ring.iter().map(|v| v.x.hypot(v.z)).fold(0.0, f64::max);
            prop_assert!(far >= radius && far - radius <= allowed, "{far} {radius} {allowed}");
        }
        let apart = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| sphere.vertices[i as usize]);
            (b - a).cross(c - a).try_normalize().map_or(f64::INFINITY, |n| n.dot(a))
        };
        let nearest = sphere.triangles.iter().map(apart).fold(f64::INFINITY, f64::min);
        let farthest = sphere.vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        prop_assert!(nearest >= radius * (1.0 - 1e-9) && farthest - radius <= allowed, "{nearest} {farthest} {radius}");
        for mesh in [&cylinder, &cone, &sphere] {
            assert_closed(mesh);
        }
        prop_assert!(volume(&cylinder) >= std::f64::consts::PI * radius * radius * height * (1.0 - 1e-9));
        prop_assert!(volume(&cone) >= std::f64::consts::PI * radius * radius * height / 3.0 * (1.0 - 1e-9));
    }
}

#[test]
fn cylinders_and_cones_stand_on_y_and_may_lack_parts() {
    let whole = geometry("Cylinder { radius 0.5 height 3 }");
    assert_eq!((whole.aabb().min.y, whole.aabb().max.y), (-1.5, 1.5));
    let (near, far) = around_y(&whole, -1.5);
    assert!((0.5 - 1e-12..0.5006).contains(&near) && far < 0.5006, "{near} {far}");
    let count = |text: &str| geometry(text).triangles.len();
    let around = whole.triangles.len() / 4;
    assert_eq!(count("Cylinder { radius 0.5 height 3 top FALSE }"), 3 * around);
    assert_eq!(count("Cylinder { radius 0.5 height 3 top FALSE bottom FALSE }"), 2 * around);
    assert_eq!(count("Cylinder { radius 0.5 height 3 side FALSE }"), 2 * around);
    let cone = geometry("Cone { bottomRadius 0.5 height 3 }");
    assert!(cone.vertices.contains(&Vec3::new(0.0, 1.5, 0.0)));
    assert_eq!((cone.aabb().min.y, cone.triangles.len()), (-1.5, 2 * around));
    assert_eq!(count("Cone { bottomRadius 0.5 height 3 bottom FALSE }"), around);
    let bottom = geometry("Cone { side FALSE }");
    assert_eq!(normal(&bottom, 0), -Vec3::Y);
}

#[test]
fn an_elevation_grid_rises_along_y() {
    let text = "ElevationGrid { xDimension 3 zDimension 2 xSpacing 0.5 zSpacing 2 height [ 0 1 2, 3 4 5 ] }";
    let mesh = geometry(text);
    assert_eq!(mesh.vertices[5], Vec3::new(1.0, 5.0, 2.0));
    assert_eq!(mesh.triangles.len(), 4);
    assert!((0..4).all(|t| normal(&mesh, t).y > 0.0));
    assert!(normal(&geometry(&text.replace("height", "ccw FALSE height")), 0).y < 0.0);
    for (from, to, part) in [
        ("xDimension 3", "xDimension 4", "has 6 heights for xDimension 4 and zDimension 2"),
        ("xDimension 3", "xDimension 99999999999", "xDimension is 99999999999"),
        ("xDimension 3", "xDimension -3", "xDimension is -3"),
        ("zSpacing 2", "zSpacing 0", "zSpacing of ElevationGrid is 0"),
    ] {
        let message = refused(&format!("Shape {{ geometry {} }}", text.replace(from, to)));
        assert!(message.contains(part), "{message}");
    }
}

proptest! {
    /// Numbers written in full are read to the last bit.
    #[test]
    fn coordinates_are_read_exactly(points in prop::collection::vec(prop::array::uniform3(-1e3..1e3f64), 3..30)) {
        let list: Vec<String> = points.iter().map(|[x, y, z]| format!("{x:?} {y:?},{z:?}")).collect();
        let index: Vec<String> = (0..points.len()).map(|i| i.to_string()).collect();
        let (list, index) = (list.join("\n"), index.join(" "));
        let mesh = geometry(&format!("IndexedFaceSet {{ coord Coordinate {{ point [ {list} ] }} coordIndex [ {index} ] }}"));
        let mut read: Vec<[f64; 3]> = mesh.vertices.iter().map(|v| v.to_array()).collect();
        let mut written = points;
        read.sort_by(|a, b| a.partial_cmp(b).unwrap());
        written.sort_by(|a, b| a.partial_cmp(b).unwrap());
        prop_assert_eq!(read, written);
    }
}
