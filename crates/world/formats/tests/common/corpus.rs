//! Small valid files of every format, a function that damages them, and one function for all readers.

#[path = "waving.rs"]
pub mod waving;

use std::path::Path;

use elbowroom_formats::mesh::{self, UpAxis};
use elbowroom_formats::nodetree::{Node, NodeTree};
use elbowroom_formats::planning_scene::{self, PlanningScene};
use elbowroom_formats::{Diagnostic, LoadedMeshes, dae, gltf, obj, off, ply, robot, srdf, stl, tds, urdf, vrml};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;
pub use elbowroom_testkit::random::Xorshift;
/// All readers; `mesh` detects the format.
pub const PARSERS: [&str; 13] =
    ["stl", "obj", "dae", "gltf", "ply", "off", "3ds", "wrl", "urdf", "srdf", "scene", "yaml", "mesh"];

/// Runs a reader and returns the approximate size of its result, bytes.
pub fn run(parser: &str, bytes: &[u8]) -> Result<usize, Diagnostic> {
    let file = Path::new("fuzz").with_extension(parser);
    let size = |loaded: LoadedMeshes| {
        for m in &loaded.meshes {
            assert!(m.vertices.iter().all(|v| v.is_finite()) || parser != "mesh", "a vertex is not finite");
            assert!(m.triangles.iter().flatten().all(|&i| (i as usize) < m.vertices.len()), "a corner does not exist");
        }
        loaded.meshes.iter().map(|m| m.vertices.len() * 24 + m.triangles.len() * 12).sum()
    };
    match parser {
        "stl" => stl::parse(bytes, &file).map(size),
        "obj" => obj::parse(bytes, &file).map(size),
        "dae" => dae::parse(bytes, &file, UpAxis::ToZ).map(size),
        "gltf" => {
            let tree = gltf::parse_tree(bytes, &file).map(|t| tree_size(&t));
            let meshes = gltf::parse(bytes, &file).map(size);
            tree.and_then(|tree| Ok(tree.max(meshes?)))
        }
        "ply" => ply::parse(bytes, &file).map(size),
        "off" => off::parse(bytes, &file).map(size),
        "3ds" => tds::parse(bytes, &file).map(|t| tree_size(&t)),
        "wrl" => {
            let tree = vrml::parse_tree(bytes, &file).map(|t| tree_size(&t));
            let meshes = vrml::parse(bytes, &file).map(size);
            tree.and_then(|tree| Ok(tree.max(meshes?)))
        }
        "urdf" => urdf::parse(bytes, &file).and_then(|m| robot::chain(&m, &file)).map(|c| c.links().len() * 200),
        "srdf" => srdf::parse(bytes, &file).map(|s| s.disabled.len() * 100),
        "scene" | "yaml" => planning_scene::parse(&file, bytes).map(|s| scene_size(&s)),
        _ => mesh::parse(bytes, &file, None, UpAxis::Ignore).map(size),
    }
}

fn scene_size(scene: &PlanningScene) -> usize {
    let solid = |(shape, pose): &(Shape, Pose)| {
        assert!(shape.validate().is_ok() && pose.is_finite(), "a solid is not valid");
        let mesh =
            if let Shape::Mesh(mesh) = shape { mesh.vertices().len() * 24 + mesh.triangles().len() * 12 } else { 0 };
        100 + mesh
    };
    scene.objects.iter().map(|o| 100 + o.solids.iter().map(solid).sum::<usize>()).sum()
}

fn tree_size(tree: &NodeTree) -> usize {
    for (i, node) in tree.nodes.iter().enumerate() {
        assert!(node.parent.is_none_or(|p| p < i), "a parent behind its child");
        for m in &node.meshes {
            assert!(m.vertices.iter().all(|v| v.is_finite()), "a vertex is not finite");
            assert!(m.triangles.iter().flatten().all(|&i| (i as usize) < m.vertices.len()), "a corner does not exist");
        }
    }
    assert!(tree.in_world().iter().all(Pose::is_finite), "a frame is not finite");
    let of = |n: &Node| {
        200 + n.track.len() * 104
            + n.meshes.iter().map(|m| m.vertices.len() * 24 + m.triangles.len() * 12).sum::<usize>()
    };
    tree.nodes.iter().map(of).sum()
}

/// Valid files for a reader.
pub fn samples(parser: &str) -> Vec<Vec<u8>> {
    let of = |texts: &[&str]| texts.iter().map(|t| t.as_bytes().to_vec()).collect::<Vec<_>>();
    match parser {
        "stl" => {
            let mut list = of(&[STL]);
            list.push(binary_stl());
            list
        }
        "obj" => of(&[OBJ]),
        "dae" => of(&[DAE]),
        "gltf" => of(&[GLTF]),
        "ply" => {
            let mut list = of(&[PLY]);
            list.push(binary_ply());
            list
        }
        "off" => of(&[OFF]),
        "3ds" => vec![tds::write(&waving::waving(), Path::new("a.3ds")).unwrap()],
        "wrl" => of(&[VRML]),
        "urdf" => of(&[URDF]),
        "srdf" => of(&[SRDF]),
        "scene" => of(&[SCENE, OLD_SCENE]),
        "yaml" => of(&[SCENE_YAML]),
        _ => PARSERS[..8].iter().flat_map(|p| samples(p)).collect(),
    }
}

fn binary_stl() -> Vec<u8> {
    let mesh = stl::parse(STL.as_bytes(), Path::new("a.stl")).unwrap().meshes;
    let mut bytes = Vec::new();
    stl::write_binary(&mut bytes, &mesh).unwrap();
    bytes
}

fn binary_ply() -> Vec<u8> {
    let mut bytes =
        PLY.split_inclusive("end_header\n").next().unwrap().replace("ascii", "binary_big_endian").into_bytes();
    for x in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(x.to_be_bytes());
    }
    bytes.push(4);
    for i in 0..4i32 {
        bytes.extend(i.to_be_bytes());
    }
    bytes
}

const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
endsolid a\nsolid b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1\nendloop\nendfacet\nendsolid b\n";
const OBJ: &str =
    "# c\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nusemtl m\nf 1//1 2//1 3//1 \\\n 4//1\no b\nf -1 -2 -3\n";
const OFF: &str = "OFF\n# c\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 255 0 0\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
const DAE: &str = r##"<?xml version="1.0"?><COLLADA><asset><unit meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
<triangles><input semantic="VERTEX" source="#v" offset="1"/><p>9 0 9 1 9 2</p></triangles>
<tristrips><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p></tristrips>
<trifans><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p></trifans>
<polygons><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p><ph><p>0 1 2</p><h>1 2 3</h></ph></polygons>
</mesh></geometry></library_geometries>
<library_nodes><node id="n"><scale>1 -1 1</scale><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node><rotate>0 0 1 90</rotate><translate>1 2 3</translate>
<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_node url="#n"/><node><instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"children":[1],"translation":[1,2,3]},{"mesh":0,"name":"n","rotation":[0,0,0.70710678,0.70710678],"scale":[1,-1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":2},"mode":5}]}],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},
{"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0],
"sparse":{"count":3,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}},
{"bufferView":0,"componentType":5126,"count":2,"byteOffset":8,"type":"SCALAR"}],
"animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
"samplers":[{"input":3,"output":0,"interpolation":"LINEAR"}]}]}"#;
const VRML: &str = r#"#VRML V2.0 utf8
PROTO Lamp [ exposedField SFColor color 1 1 1 eventIn SFBool on ] { Material { diffuseColor IS color } }
EXTERNPROTO Far [ field SFNode a ] [ "urn:a" "far.wrl" ]
WorldInfo { title "a \"b\" {" info [ "x", "y" ] }
DEF base Transform { translation 1 2,3 rotation 0 0 1 1.5 scale 1 -1 0.5 scaleOrientation 1 0 0 0.25 center 0 0.5 0
 children [ DEF face Shape { appearance Appearance { material Lamp { color 1 0 0 } }
 geometry DEF f IndexedFaceSet { coord DEF c Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } solid FALSE ccw FALSE
 coordIndex [ 0, 1, 2, 3, -1, 0 1 2 ] } } # comment
 DEF arm Transform { children Shape { geometry IndexedFaceSet { coord USE c coordIndex [ 2 1 0 -1 ] } } } ] }
Switch { whichChoice 1 choice [ Group { } DEF part Group { children USE face } ] }
LOD { range [ 5 ] level [ Shape { geometry ElevationGrid { xDimension 2 zDimension 2 xSpacing 0.5 height [ 0 1 2 3 ] } } ] }
Collision { collide TRUE proxy NULL children Billboard { children Anchor { url "a.html" children [
 Shape { geometry Box { size 0.1 0.2 0.3 } } Shape { geometry Cylinder { radius 0.001 top FALSE } }
 Shape { geometry Cone { bottomRadius 0.001 } } Shape { geometry Sphere { radius 0.001 } } ] } } }
Script { url "javascript: function f() { }" directOutput TRUE eventIn SFTime t field SFNode n USE arm }
DEF clock TimeSensor { cycleInterval 2 } ROUTE clock.fraction_changed TO base . set_translation
Shape { geometry PointSet { coord USE c } }
"#;
const URDF: &str = r#"<?xml version="1.0"?><robot name="r" xmlns:drake="http://drake.mit.edu">
<link name="a"><collision name="c"><origin xyz="0 0 1" rpy="0 1.5 0"/><geometry><box size="1 2 3"/></geometry></collision>
<visual><geometry><mesh filename="package://p/a.stl" scale="1 1 -1"/></geometry></visual></link>
<link name="b"><collision><geometry><cylinder radius="1" length="2"/></geometry></collision></link>
<link name="c"><collision><geometry><sphere radius="1"/></geometry></collision></link>
<link name="d"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="2" drake:acceleration="3"/></joint>
<joint name="k" type="prismatic"><parent link="b"/><child link="c"/><limit lower="0" upper="1" velocity="0"/><mimic joint="j" multiplier="2" offset="0.5"/></joint>
<joint name="l" type="fixed"><origin xyz="0 1 0"/><parent link="c"/><child link="d"/><axis xyz="0 0 0"/></joint>
<transmission/><drake:collision_filter_group name="g"/></robot>"#;
const SRDF: &str = r#"<robot name="r"><group name="g"><chain base_link="a" tip_link="c"/></group>
<disable_collisions link1="a" link2="b" reason="Adjacent"/><disable_collisions link1="b" link2="c"/></robot>"#;

const SCENE: &str = "(noname)+\n* Box_0\n-0.32 0.02 0\n0 0 0 1\n2\nbox\n0.2 0.6 0.8\n0 0 0.1\n0 0 0.7 0.7\n1 0 0 1\ncone\n0.1 0.3\n0 0 0\n0 0 0 1\n\
0 0 0 0\n1\ntip\n0 0 1\n0 0 0 1\n* my floor\n0 0 0\n0 0 0 1\n1\nplane\n0 0 1 0.5\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n";
const OLD_SCENE: &str = "cell\n* wedge\n2\nmesh\n4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 2 1\n0 1 3\n1 2 3\n0 3 2\n0 0 0\n0 0 0 1\n0 0 0 0\n\
cylinder\n0.05 0.8\n1 0 0\n0 0 0 1\n0 0 0 0\n* ball\n1\nsphere\n0.1\n0 0 1\n0 0 0 1\n0 0 0 0\n.\n";
const SCENE_YAML: &str = r"name: shelf
fixed_frame_transforms:
  - child_frame_id: base
    transform: {translation: [0, 0, 1], rotation: {x: 0, y: 0, z: 0, w: 1}}
world:
  collision_objects:
    - id: Can1
      header: {frame_id: base}
      primitives:
        - {type: cylinder, dimensions: [0.14, 0.03]}
        - type: 1
          dimensions: &size [0.1, 0.2, 0.3]
      primitive_poses:
        - position: [0.8, 0, 0.55]
          orientation: [0, 0, 0, 1]
        - {position: *size}
    - id: 'wedge'
      operation: !!binary AA==
      meshes:
        - vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0., 0, 1.0]]
          triangles: [[0, 2, 1], [0, 1, 3], {vertex_indices: [1, 2, 3]}, [0, 3, 2]]
      mesh_poses: [{position: {x: 0, y: 0, z: 0}}]
allowed_collision_matrix:
  entry_names: [base, Can1]
  entry_values:
    - enabled: [false, true]
    - enabled: [true, false]
robot_state:
  joint_state: {name: [a], position: [0.5]}
";

const EXTREMES: [&str; 16] = [
    "0",
    "-1",
    "1",
    "4294967295",
    "4294967296",
    "2147483647",
    "-2147483648",
    "18446744073709551615",
    "1e308",
    "-1e999",
    "nan",
    "inf",
    "1e-320",
    "0.0001",
    "99999999999999999999",
    "",
];

/// Damages a file several times: bits, cuts, copies, pieces of another file, extreme numbers.
pub fn mutate(random: &mut Xorshift, bytes: &mut Vec<u8>, other: &[u8]) {
    for _ in 0..=random.below(6) {
        let n = bytes.len();
        let (at, length) = (random.below(n + 1), random.below(64));
        let end = (at + length).min(n);
        match random.below(9) {
            0 if n > 0 => bytes[at.min(n - 1)] ^= 1 << random.below(8),
            1 if n > 0 => bytes[at.min(n - 1)] = random.bits() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            5 => {
                let from = random.below(other.len() + 1);
                let piece = other[from..(from + 4 * length).min(other.len())].to_vec();
                bytes.splice(at..end, piece);
            }
            6 => extreme_bytes(random, bytes, at),
            _ => extreme_number(random, bytes, at),
        }
    }
}

fn extreme_bytes(random: &mut Xorshift, bytes: &mut [u8], at: usize) {
    let value =
        [0u32, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x7f80_0000, 0x7fc0_0000, 0x00ff_ffff][random.below(8)];
    for (slot, byte) in bytes.iter_mut().skip(at).zip(value.to_le_bytes()) {
        *slot = byte;
    }
}

/// Replaces the next number after an offset.
fn extreme_number(random: &mut Xorshift, bytes: &mut Vec<u8>, at: usize) {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let Some(begin) = bytes[at..].iter().position(u8::is_ascii_digit).map(|i| i + at) else { return };
    let end = bytes[begin..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |i| i + begin);
    let value = EXTREMES[random.below(EXTREMES.len())];
    bytes.splice(begin..end, value.bytes());
}
