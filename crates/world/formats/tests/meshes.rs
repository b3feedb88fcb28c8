//! Numbers, units, axes and transforms of mesh files, alone and in robots.

use std::path::Path;
use std::sync::Arc;

use elbowroom_formats::mesh::{self, UpAxis};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_formats::{LoadedMeshes, MeshData, stl};
use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;

fn parse(name: &str, bytes: &[u8], up: UpAxis) -> LoadedMeshes {
    mesh::parse(bytes, Path::new(name), None, up).unwrap_or_else(|e| panic!("{e}"))
}

/// Volume by the divergence theorem: negative if a closed mesh is inside out.
fn volume(mesh: &MeshData) -> f64 {
    let v = |i: u32| mesh.vertices[i as usize];
    mesh.triangles.iter().map(|t| v(t[0]).dot(v(t[1]).cross(v(t[2]))) / 6.0).sum()
}

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-6
}

/// A closed box from 0 to (1, 2, 3), with its faces oriented outwards.
fn brick() -> MeshData {
    let vertices = (0..8).map(|i| Vec3::new(f64::from(i & 1), f64::from(i & 2), f64::from(i & 4) * 0.75)).collect();
    let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    MeshData { name: "brick".into(), vertices, triangles }
}

fn brick_stl() -> Vec<u8> {
    let mut bytes = Vec::new();
    stl::write_binary(&mut bytes, &[brick()]).unwrap();
    bytes
}

fn brick_dae(unit: &str, up: &str, node: &str) -> String {
    let b = brick();
    let numbers: Vec<String> = b.vertices.iter().map(|v| format!("{} {} {}", v.x, v.y, v.z)).collect();
    let corners: Vec<String> = b.triangles.iter().flatten().map(u32::to_string).collect();
    format!(
        "<COLLADA><asset>{unit}{up}</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array count=\"24\">{}\
         </float_array></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles>\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles></mesh></geometry></library_geometries>\
         <library_visual_scenes><visual_scene>{node}</visual_scene></library_visual_scenes></COLLADA>",
        numbers.join(" "),
        corners.join(" ")
    )
}

#[test]
fn a_brick_is_one_cubic_metre_times_six() {
    let loaded = parse("a.stl", &brick_stl(), UpAxis::ToZ);
    assert!((volume(&loaded.meshes[0]) - 6.0).abs() < 1e-6);
    assert_eq!(loaded.meshes[0].vertices.len(), 8);
    assert!(close(loaded.aabb().max, Vec3::new(1.0, 2.0, 3.0)));
}

#[test]
fn binary_stl_may_begin_with_solid() {
    let mut bytes = brick_stl();
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(parse("a.stl", &bytes, UpAxis::ToZ).meshes[0].triangles.len(), 12);
    // With bytes after its end, the file does not have the exact size, but is not text either.
    bytes.extend([0; 7]);
    bytes[10] = 0;
    let loaded = parse("a.stl", &bytes, UpAxis::ToZ);
    assert_eq!((loaded.meshes[0].triangles.len(), loaded.warnings.len()), (12, 1));
    let short = mesh::parse(&bytes[..300], Path::new("a.stl"), None, UpAxis::ToZ).unwrap_err();
    assert!(short.message.contains("12 triangles") && short.message.contains("has 4"), "{short}");
}

#[test]
fn units_apply_where_the_format_has_none() {
    let in_mm = mesh::parse(&brick_stl(), Path::new("a.stl"), Some(LengthUnit::Millimetre), UpAxis::ToZ).unwrap();
    assert!(close(in_mm.aabb().max, Vec3::new(0.001, 0.002, 0.003)));
    let dae =
        brick_dae("<unit meter=\"0.5\"/>", "<up_axis>Z_UP</up_axis>", "<node><instance_geometry url=\"#g\"/></node>");
    let stated = mesh::parse(dae.as_bytes(), Path::new("a.dae"), Some(LengthUnit::Millimetre), UpAxis::ToZ).unwrap();
    assert!(close(stated.aabb().max, Vec3::new(0.5, 1.0, 1.5)));
    assert_eq!(stated.warnings.len(), 1);
}

#[test]
fn collada_axes_are_converted_only_on_request() {
    let node = "<node><instance_geometry url=\"#g\"/></node>";
    let load = |axis: &str, up| parse("a.dae", brick_dae("", axis, node).as_bytes(), up);
    let kept = load("<up_axis>Y_UP</up_axis>", UpAxis::Ignore).aabb();
    assert!(close(kept.max, Vec3::new(1.0, 2.0, 3.0)));
    // In the file, up is y and the viewer's direction z: they become z and -y.
    for axis in ["<up_axis>Y_UP</up_axis>", ""] {
        let turned = load(axis, UpAxis::ToZ);
        assert!(
            close(turned.aabb().min, Vec3::new(0.0, -3.0, 0.0)) && close(turned.aabb().max, Vec3::new(1.0, 0.0, 2.0))
        );
        assert!((volume(&turned.meshes[0]) - 6.0).abs() < 1e-9);
    }
    // In the file, up is x, right is -y, and the viewer's direction z.
    let turned = load("<up_axis>X_UP</up_axis>", UpAxis::ToZ);
    assert!(close(turned.aabb().min, Vec3::new(-2.0, -3.0, 0.0)) && close(turned.aabb().max, Vec3::new(0.0, 0.0, 1.0)));
    assert!((volume(&turned.meshes[0]) - 6.0).abs() < 1e-9);
}

#[test]
fn collada_nodes_nest_in_the_written_order() {
    let node = "<node name=\"outer\"><translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>\
                <node name=\"inner\"><matrix>1 0 0 1 0 1 0 0 0 0 -1 0 0 0 0 1</matrix><instance_geometry url=\"#g\"/></node></node>";
    let loaded = parse("a.dae", brick_dae("", "<up_axis>Z_UP</up_axis>", node).as_bytes(), UpAxis::ToZ);
    // (x, y, z) → (x+1, y, -z) → (2x+2, y, -z) → (-y, 2x+2, -z) → (10-y, 2x+2, -z).
    let bounds = loaded.aabb();
    assert!(close(bounds.min, Vec3::new(8.0, 2.0, -3.0)) && close(bounds.max, Vec3::new(10.0, 4.0, 0.0)), "{bounds:?}");
    assert_eq!(loaded.meshes[0].name, "inner");
    assert!((volume(&loaded.meshes[0]) - 12.0).abs() < 1e-9, "a mirror image keeps its outside");
}

#[test]
fn ply_is_the_same_in_all_three_encodings() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement face 1\nproperty list uchar ushort vertex_index\nproperty uchar red\n\
                 element vertex 4\nproperty double x\nproperty uchar skip\nproperty float y\nproperty short z\nend_header\n"
        )
    };
    let corners = [[0.0f32, 0.0, 0.0], [1.5, 0.0, 0.0], [1.5, 2.0, 1.0], [0.0, 2.0, 1.0]];
    let mut little = header("binary_little_endian").into_bytes();
    let mut big = header("binary_big_endian").into_bytes();
    let mut ascii = header("ascii") + "4 0 1 2 3 255\n";
    little.push(4);
    big.push(4);
    for i in 0..4u16 {
        little.extend(i.to_le_bytes());
        big.extend(i.to_be_bytes());
    }
    little.push(255);
    big.push(255);
    for [x, y, z] in corners {
        little.extend(
            f64::from(x).to_le_bytes().into_iter().chain([7]).chain(y.to_le_bytes()).chain((z as i16).to_le_bytes()),
        );
        big.extend(
            f64::from(x).to_be_bytes().into_iter().chain([7]).chain(y.to_be_bytes()).chain((z as i16).to_be_bytes()),
        );
        ascii.push_str(&[x.to_string(), " 7 ".into(), y.to_string(), " ".into(), z.to_string(), "\n".into()].concat());
    }
    let [a, b, c] = [ascii.into_bytes(), little, big].map(|bytes| parse("a.ply", &bytes, UpAxis::ToZ).meshes);
    assert_eq!(a[0].triangles.len(), 2);
    assert_eq!(a[0].vertices.len(), 4);
    assert!(a == b && b == c);
}

#[test]
fn gltf_nodes_are_transformed_mirrored_and_merged() {
    // Three points, three indices; one primitive as triangles, one as a strip; a mirrored node under a moved one.
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],
        "nodes":[{"children":[1],"translation":[1,2,3]},{"mesh":0,"name":"flag","scale":[-1,2,1]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":0},"mode":5}]}],
        "buffers":[{"byteLength":42,"uri":"flag.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]}"#;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flag.gltf");
    std::fs::write(&path, json).unwrap();
    let missing = mesh::load(&path, None).unwrap_err();
    assert!(missing.message.contains("flag.bin"), "{missing}");
    let points = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes = points.iter().flat_map(|x| x.to_le_bytes()).chain([0u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    std::fs::write(directory.path().join("flag.bin"), bytes.collect::<Vec<u8>>()).unwrap();
    let loaded = mesh::load(&path, None).unwrap();
    let flag = &loaded.meshes[0];
    assert_eq!((loaded.meshes.len(), flag.name.as_str(), flag.triangles.len()), (1, "flag", 2));
    assert!(close(loaded.aabb().min, Vec3::new(0.0, 2.0, 3.0)) && close(loaded.aabb().max, Vec3::new(1.0, 4.0, 3.0)));
    for t in &flag.triangles {
        let [a, b, c] = t.map(|i| flag.vertices[i as usize]);
        assert!((b - a).cross(c - a).z > 0.0, "a mirror image keeps its outside");
    }
    std::fs::write(&path, json.replace("flag.bin", "../flag.bin")).unwrap();
    assert!(mesh::load(&path, None).unwrap_err().message.contains("not followed"));
}

#[test]
fn robots_scale_share_and_mirror_their_meshes() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(directory.path().join(name), bytes).unwrap();
    std::fs::create_dir(directory.path().join("arm")).unwrap();
    write("arm/brick.STL", &brick_stl());
    let dae =
        brick_dae("<unit meter=\"0.01\"/>", "<up_axis>Y_UP</up_axis>", "<node><instance_geometry url=\"#g\"/></node>");
    write("brick.dae", dae.as_bytes());
    let collision = |mesh: &str| format!("<collision><geometry><mesh filename={mesh}/></geometry></collision>");
    let urdf = format!(
        "<robot name=\"r\"><link name=\"a\">{}{}{}{}\n<visual><geometry><mesh filename=\"nowhere.stl\"/></geometry></visual></link></robot>",
        collision("\"package://arm/brick.stl\""),
        collision("\"arm/brick.STL\" scale=\"1 1 1\""),
        collision("\"arm/brick.STL\" scale=\"-0.1 0.1 0.2\""),
        collision("\"brick.dae\"")
    );
    write("r.urdf", urdf.as_bytes());
    write("r.srdf", b"<robot name=\"r\">\n<disable_collisions link1=\"a\" link2=\"ghost\"/></robot>");
    let path = directory.path().join("r.urdf");
    let options =
        LoadOptions { load_visuals: true, srdf: Some(directory.path().join("r.srdf")), ..LoadOptions::default() };
    let loaded = robot::load(&path, &options).unwrap();
    let meshes: Vec<_> = loaded.robot.colliders[0]
        .iter()
        .map(|b| if let Shape::Mesh(m) = &b.shape { Arc::clone(m) } else { panic!("{}", b.name) })
        .collect();
    assert!(Arc::ptr_eq(&meshes[0], &meshes[1]), "the file is read once");
    assert!((meshes[2].report().volume - 6.0 * 0.002).abs() < 1e-6 && !meshes[2].report().inside_out);
    assert!(close(meshes[3].aabb().max, Vec3::new(0.01, 0.02, 0.03)), "the unit applies, the up axis does not");
    let lines: Vec<_> = loaded.warnings.iter().map(|w| (w.line, w.message.as_str())).collect();
    assert!(lines.iter().any(|(line, what)| *line == Some(2) && what.contains("nowhere.stl")), "{lines:?}");
    assert!(lines.iter().any(|(line, what)| *line == Some(2) && what.contains("ghost")), "{lines:?}");
    assert!(loaded.robot.disabled_pairs.is_empty());
    write("r.urdf", urdf.replace("brick.dae", "brick.obj").as_bytes());
    let error = robot::load(&path, &options).unwrap_err();
    assert!(error.message.contains("brick.obj") && error.line == Some(1), "{error}");
}
