//! Regions and their warning zones as markers.

use elbowroom_cell::Cell;
use elbowroom_monitor::RegionKind;
use elbowroom_proximity::surroundings::cavity;
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_status::{CellStatus, RegionStatus};

use super::frames;
use crate::msgs::builtin_interfaces::Time;
use crate::msgs::geometry_msgs::Point;
use crate::msgs::std_msgs::{ColorRGBA, Header};
use crate::msgs::visualization_msgs::{Marker, MarkerArray};

/// Largest chord error of curved surfaces, m.
const CHORD_ERROR_M: f64 = 1e-3;
/// Half width of the plate that shows a half-space, m; `PLATE_DEPTH_M` is its thickness.
const PLATE_M: f64 = 2.0;
const PLATE_DEPTH_M: f64 = 0.05;

/// Markers of all regions, in the frames of the regions.
#[derive(Debug, Clone)]
pub(super) struct RegionMarkers {
    regions: Vec<RegionMarker>,
}

#[derive(Debug, Clone)]
struct RegionMarker {
    name: String,
    kind: RegionKind,
    solid: Vec<Marker>,
    warning: Vec<Marker>,
}

/// Look of a region, from the least to the most important: several robots may have the same region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    Inactive,
    Clear,
    Warned,
    Inside,
}

impl Look {
    fn of(region: &RegionStatus) -> Self {
        match region {
            RegionStatus { active: false, .. } => Self::Inactive,
            RegionStatus { inside: true, .. } => Self::Inside,
            RegionStatus { warned: true, .. } => Self::Warned,
            _ => Self::Clear,
        }
    }
}

impl RegionMarkers {
    pub(super) fn of_cell(cell: &Cell) -> Self {
        let marker = |region: &elbowroom_cell::CellRegion| {
            let region = &region.region;
            RegionMarker {
                name: region.name.clone(),
                kind: region.kind,
                solid: solid_markers(&region.shape),
                warning: warning_shape(&region.shape, region.warning_m)
                    .map(|(shape, pose)| shape_markers(&shape, &pose))
                    .unwrap_or_default(),
            }
        };
        Self { regions: cell.regions.iter().map(marker).collect() }
    }

    /// Returns the look of each region.
    pub(super) fn state(&self, status: &CellStatus) -> Vec<u8> {
        self.regions.iter().map(|region| look(&region.name, status) as u8).collect()
    }

    pub(super) fn markers(&self, status: &CellStatus, stamp: &Time) -> MarkerArray {
        let mut markers = Vec::new();
        for region in &self.regions {
            let look = look(&region.name, status);
            let header = Header { stamp: stamp.clone(), frame_id: frames::region(&region.name) };
            let layers =
                [("region", &region.solid, color(region.kind, look)), ("warning", &region.warning, zone(look))];
            for (layer, parts, color) in layers {
                for (id, part) in (0..).zip(parts) {
                    markers.push(Marker {
                        header: header.clone(),
                        ns: format!("{layer}/{}", region.name),
                        id,
                        color: color.clone(),
                        frame_locked: true,
                        ..part.clone()
                    });
                }
            }
        }
        MarkerArray { markers }
    }
}

/// Returns the most important look that a robot gives a region.
fn look(name: &str, status: &CellStatus) -> Look {
    let of_robots = status.robots.iter().flat_map(|r| &r.regions).filter(|r| r.name == name);
    of_robots.map(Look::of).max().unwrap_or(Look::Inactive)
}

fn color(kind: RegionKind, look: Look) -> ColorRGBA {
    let [r, g, b] = match (kind, look) {
        (_, Look::Inactive) => [0.6, 0.6, 0.6],
        (_, Look::Inside) => [0.95, 0.1, 0.1],
        (RegionKind::Forbidden, _) => [0.85, 0.35, 0.1],
        (RegionKind::Monitored { .. }, _) => [0.2, 0.5, 0.8],
        (RegionKind::Exchange { .. }, _) => [0.55, 0.35, 0.8],
    };
    ColorRGBA { r, g, b, a: if look == Look::Inactive { 0.15 } else { 0.5 } }
}

fn zone(look: Look) -> ColorRGBA {
    match look {
        Look::Inactive => ColorRGBA { r: 0.6, g: 0.6, b: 0.6, a: 0.05 },
        Look::Clear => ColorRGBA { r: 0.95, g: 0.8, b: 0.2, a: 0.12 },
        Look::Warned | Look::Inside => ColorRGBA { r: 0.95, g: 0.7, b: 0.0, a: 0.3 },
    }
}

fn solid_markers(shape: &Shape) -> Vec<Marker> {
    match shape {
        Shape::HalfSpace(_) => {
            let (plate, pose) = plate(-PLATE_DEPTH_M, 0.0);
            shape_markers(&plate, &pose)
        }
        _ => shape_markers(shape, &Pose::IDENTITY),
    }
}

/// Returns the shape of the warning zone; for a cylinder or box with sharp edges, which makes the zone a little too
/// large there. `None` for hulls and meshes, whose zones are not drawn.
fn warning_shape(shape: &Shape, warning_m: f64) -> Option<(Shape, Pose)> {
    if !(warning_m > 0.0 && warning_m.is_finite()) {
        return None;
    }
    let shape = match shape {
        Shape::Sphere(s) => Shape::Sphere(Sphere { radius: s.radius + warning_m }),
        Shape::Capsule(s) => Shape::Capsule(Capsule { radius: s.radius + warning_m, ..*s }),
        Shape::Cylinder(s) => {
            Shape::Cylinder(Cylinder { radius: s.radius + warning_m, half_length: s.half_length + warning_m })
        }
        Shape::Cuboid(s) => {
            Shape::Cuboid(Cuboid { half_extents: s.half_extents + Vec3::new(warning_m, warning_m, warning_m) })
        }
        Shape::HalfSpace(_) => return Some(plate(0.0, warning_m)),
        Shape::Hull(_) | Shape::Mesh(_) => return None,
    };
    Some((shape, Pose::IDENTITY))
}

/// Returns a plate that shows a layer between two heights.
fn plate(from_z: f64, to_z: f64) -> (Shape, Pose) {
    let half_extents = Vec3::new(PLATE_M, PLATE_M, 0.5 * (to_z - from_z));
    (Shape::Cuboid(Cuboid { half_extents }), Pose::from_translation(Vec3::Z * (0.5 * (from_z + to_z))))
}

fn shape_markers(shape: &Shape, pose: &Pose) -> Vec<Marker> {
    let primitive = |kind: i32, scale: [f64; 3], pose: &Pose| Marker {
        r#type: kind,
        pose: pose.into(),
        scale: scale.into(),
        ..Marker::default()
    };
    match shape {
        Shape::Sphere(s) => vec![primitive(Marker::SPHERE, [2.0 * s.radius; 3], pose)],
        Shape::Cylinder(s) => {
            vec![primitive(Marker::CYLINDER, [2.0 * s.radius, 2.0 * s.radius, 2.0 * s.half_length], pose)]
        }
        Shape::Cuboid(s) => vec![primitive(Marker::CUBE, (s.half_extents * 2.0).to_array(), pose)],
        Shape::Capsule(s) => {
            let at = |z: f64| *pose * Pose::from_translation(Vec3::Z * z);
            vec![
                primitive(Marker::CYLINDER, [2.0 * s.radius, 2.0 * s.radius, 2.0 * s.half_length], pose),
                primitive(Marker::SPHERE, [2.0 * s.radius; 3], &at(s.half_length)),
                primitive(Marker::SPHERE, [2.0 * s.radius; 3], &at(-s.half_length)),
            ]
        }
        Shape::HalfSpace(_) => Vec::new(),
        Shape::Hull(_) | Shape::Mesh(_) => vec![triangles(shape, pose)],
    }
}

fn triangles(shape: &Shape, pose: &Pose) -> Marker {
    let inner = match shape {
        Shape::Mesh(mesh) => cavity(mesh),
        _ => None,
    };
    let (vertices, triangles) = inner.unwrap_or_else(|| tessellate(shape, CHORD_ERROR_M));
    let points = triangles.iter().flatten().map(|i| Point::from(vertices[*i as usize])).collect();
    Marker { r#type: Marker::TRIANGLE_LIST, pose: pose.into(), scale: [1.0; 3].into(), points, ..Marker::default() }
}
