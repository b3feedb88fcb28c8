//! Binary STL, with the same bytes on every machine.

use elbowroom_spatial::Vec3;

use super::Mesh;

/// Returns the bytes of the file; lengths in metres, as URDF expects.
pub fn binary_stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    let title = b"elbowroom generated solid, metres";
    bytes[..title.len()].copy_from_slice(title);
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for [a, b, c] in mesh.corners() {
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::ZERO);
        for point in [normal, a, b, c] {
            // Adding zero turns −0 into 0: the sign of a rounded zero must not depend on the machine.
            let coordinates = [point.x, point.y, point.z].map(|v| (v as f32 + 0.0).to_le_bytes());
            bytes.extend(coordinates.as_flattened());
        }
        bytes.extend([0, 0]);
    }
    bytes
}
