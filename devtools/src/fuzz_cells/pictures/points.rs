//! Clouds of the points on the surfaces of boxes.

use elbowroom_spatial::Vec3;

use crate::fuzz_cells::spec::{SeenBox, SensorSpec, Vector};

/// Points in the frame of the sensor, m.
pub struct Cloud(Vec<Vec3>);

/// The points of the picture with this index; one that cannot be used has none that are numbers.
pub fn cloud(sensor: &SensorSpec, index: usize, spacing: f64, is_usable: bool) -> Cloud {
    if !is_usable {
        return Cloud(vec![Vec3::splat(f64::NAN); 3]);
    }
    let in_world = sensor.pose();
    // A point of the floor: a cloud of the empty cell is not empty.
    let floor = Vec3::new(sensor.at[0], sensor.at[1], sensor.floor);
    let on_boxes = sensor.shown(index).flat_map(|(one, at)| surface(one, at, spacing));
    Cloud(std::iter::once(floor).chain(on_boxes).map(|p| in_world.inverse_transform_point(p)).collect())
}

/// Points of the sides and the top of a box, no farther apart than the spacing along each edge, with its corners.
fn surface(one: &SeenBox, at: Vector, spacing: f64) -> Vec<Vec3> {
    let steps = one.size.map(|side| (side / spacing).ceil().max(1.0) as usize);
    let place = |i: [usize; 3]| {
        let [x, y, z]: Vector = std::array::from_fn(|k| one.size[k] * i[k] as f64 / steps[k] as f64);
        one.to_world(at, Vec3::new(x - 0.5 * one.size[0], y - 0.5 * one.size[1], z))
    };
    let mut points = Vec::new();
    for i in 0..=steps[0] {
        for j in 0..=steps[1] {
            let is_side = i == 0 || i == steps[0] || j == 0 || j == steps[1];
            let from = if is_side { 0 } else { steps[2] };
            points.extend((from..=steps[2]).map(|k| place([i, j, k])));
        }
    }
    points
}

impl Cloud {
    /// The extension of its file, and the bytes.
    pub fn file(&self, is_ply: bool) -> (&'static str, Vec<u8>) {
        let count = self.0.len();
        let (extension, head) = if is_ply {
            let properties = "property float x\nproperty float y\nproperty float z\n";
            let form = "format binary_little_endian 1.0";
            ("ply", format!("ply\n{form}\nelement vertex {count}\n{properties}end_header\n"))
        } else {
            let fields = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";
            ("pcd", format!("{fields}\nWIDTH {count}\nHEIGHT 1\nPOINTS {count}\nDATA binary\n"))
        };
        let numbers = self.0.iter().flat_map(|p| p.to_array()).flat_map(|number| (number as f32).to_le_bytes());
        (extension, head.into_bytes().into_iter().chain(numbers).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_of_a_box_are_on_it_and_near_to_each_other() {
        let one = SeenBox {
            at: [1.0, 2.0, 0.5],
            size: [0.4, 0.2, 0.3],
            yaw: 0.7,
            from_s: 0.0,
            to_s: 1.0,
            velocity: [0.5, 0.0],
            is_learnt: false,
        };
        let at = one.at_time(0.5).unwrap();
        assert!(at == [1.25, 2.0, 0.5] && one.at_time(1.5).is_none() && !one.stands());
        let points = surface(&one, at, 0.05);
        for p in &points {
            let d = *p - Vec3::new(at[0], at[1], at[2]);
            let own = one.to_own(d);
            let (x, y) = (0.2 - own.x.abs(), 0.1 - own.y.abs());
            assert!(x > -1e-9 && y > -1e-9 && (-1e-9..0.3 + 1e-9).contains(&own.z), "{own:?}");
            assert!(x < 1e-9 || y < 1e-9 || own.z > 0.3 - 1e-9, "{own:?}");
            let nearest = points.iter().map(|q| q.distance(*p)).filter(|d| *d > 1e-9).fold(1.0, f64::min);
            assert!(nearest <= 0.05 + 1e-9, "{nearest}");
        }
        assert!(Cloud(points).file(true).1.starts_with(b"ply\n"));
    }
}
