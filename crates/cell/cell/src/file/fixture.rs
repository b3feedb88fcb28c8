//! `[fixture.NAME]`: a shield that protects an object and is opened along a target.

use std::sync::{Arc, OnceLock};

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_proximity::contact::triangle_surface;
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::ObjectId;
use elbowroom_scene::Object;
use elbowroom_shared_control::{ProtectedSurface, ShieldSettings, ShieldTarget};
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;

use super::fixture_tool::tool;
use super::models;

use super::schema::{FIXTURE, FIXTURE_DRILL, FIXTURE_FACES, FIXTURE_TARGET, names};
use crate::area_border::{AROUND, crossing_edges, crossing_text};
use crate::fixture::{CellFixture, ShieldSource};
use crate::{Cell, Units};

/// Chord error of round solids whose corners are looked for in a shield, m.
const CHORD_M: f64 = 1e-3;

type Result<T> = std::result::Result<T, Diagnostic>;

const TARGET: &str = "target = { line = [[0, 0, 100], [50, 0, 100]] }   (or area, drill, faces_within)";

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("fixture")? {
        if cell.regions.iter().any(|r| r.region.name == name) {
            let what = format!("`{}` has the name of a region, and events name both", t.name);
            return Err(t.error(what).hint("another name"));
        }
        if t.get("guide").is_some() {
            let guide = super::guide::read(name, &t, cell)?;
            cell.guidance.guides.push(guide);
        } else {
            let fixture = fixture(name, &t, cell)?;
            cell.guidance.fixtures.push(fixture);
        }
    }
    Ok(())
}

/// A shield around an object.
fn fixture(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellFixture> {
    t.only(&names(&[FIXTURE]))?;
    let protects = object(&t.need("protects", "protects = \"bone\"   (an object)")?, cell)?;
    let object = &cell.objects[protects.0];
    let shield = match t.get("mesh") {
        Some(file) => ShieldSource::Mesh(shield_of_file(&file, t, object)?),
        None => generated(t, cell.units, object)?,
    };
    Ok(CellFixture {
        name: name.to_owned(),
        line: t.line,
        protects,
        shield,
        tool: t.get("tool").map(|v| tool(&v, cell)).transpose()?,
        active: t.flag_or("active", true)?,
        made: OnceLock::new(),
        placed: OnceLock::new(),
    })
}

fn generated(t: &Table<'_>, units: Units, object: &Object) -> Result<ShieldSource> {
    let (target, depth_m) = target(&t.need("target", TARGET)?, units, object)?;
    let length = |key: &str, default_m: f64| t.get(key).map_or(Ok(default_m), |v| units.not_negative_length(&v));
    let depth = t.get("depth");
    if let (Some(depth), Some(_)) = (&depth, depth_m) {
        return Err(depth.error("contradicts the depth of `drill`").hint("the depth in `drill` alone"));
    }
    if let Some(unit) = t.get("mesh_unit") {
        return Err(unit.error("is of a `mesh`, which this fixture does not have").hint("no `mesh_unit`"));
    }
    let flare = |v: Value<'_>| {
        let flare_rad = units.angle.to_radians(v.not_negative()?);
        let is_usable = flare_rad.to_degrees() <= 80.0;
        if is_usable { Ok(flare_rad) } else { Err(v.error("is more than 80°").hint("flare = 15   (degrees)")) }
    };
    let flare_rad = t.get("flare").map(flare).transpose()?;
    let width_m = units.positive_length(&t.need("width", "width = 8   (of the opening)")?)?;
    let default = ShieldSettings::with_width(width_m);
    let settings = ShieldSettings {
        offset_m: length("offset", default.offset_m)?,
        width_m,
        depth_m: depth_m.map_or_else(|| length("depth", default.depth_m), Ok)?,
        flare_rad: flare_rad.unwrap_or(default.flare_rad),
        tolerance_m: t.get("tolerance").map_or(Ok(default.tolerance_m), |v| units.positive_length(&v))?,
    };
    Ok(ShieldSource::Generated { target, settings })
}

/// A shield from a file in the world, in the frame of the object.
fn shield_of_file(file: &Value<'_>, t: &Table<'_>, object: &Object) -> Result<Arc<TriMesh>> {
    for key in ["target", "width", "offset", "depth", "flare", "tolerance"] {
        if let Some(v) = t.get(key) {
            return Err(v.error("is of a generated shield, and this one is read").hint("either `mesh` or `target`"));
        }
    }
    let unit = t.get("mesh_unit").map_or(Ok(LengthUnit::Metre), |v| models::mesh_unit(&v))?;
    let Shape::Mesh(mesh) = models::mesh(file, unit)? else {
        return Err(file.error("holds no mesh").hint("an STL, OBJ or PLY file"));
    };
    let vertices = mesh.vertices().iter().map(|p| object.in_world.inverse_transform_point(*p)).collect();
    let mesh =
        TriMesh::new(vertices, mesh.triangles().to_vec()).map(Arc::new).map_err(|e| file.error(e.to_string()))?;
    ProtectedSurface::new(mesh.clone(), object.in_world).map_err(|e| file.error(e.to_string()))?;
    encloses(&mesh, object, file)?;
    Ok(mesh)
}

/// Refuses a shield that lies elsewhere: the tool keeps off the shield in place of the object. An opening leaves a part of the
/// surface out, so more than half of its corners must be in the shield.
fn encloses(shield: &TriMesh, object: &Object, file: &Value<'_>) -> Result<()> {
    let Some(surface) = triangle_surface(&object.shape, CHORD_M) else { return Ok(()) };
    let corners = surface.vertices();
    let inside = corners.iter().filter(|p| shield.contains(**p)).count();
    if 2 * inside > corners.len() {
        return Ok(());
    }
    let what =
        format!("has {inside} of {} corners of \"{}\" in it, and would not protect it", corners.len(), object.name);
    Err(file.error(what).hint("a shield around the object, in the world; for an STL in mm: mesh_unit = \"mm\""))
}

fn object(v: &Value<'_>, cell: &Cell) -> Result<ObjectId> {
    let name = v.text()?;
    let known = || cell.objects.iter().map(|o| o.name.as_str());
    let index = known().position(|n| n == name).ok_or_else(|| {
        v.error(format!("names the object \"{name}\", which is not in this cell")).hint(suggest::hint(name, known()))
    })?;
    if matches!(cell.objects[index].shape, Shape::HalfSpace(_)) {
        return Err(v.error("is a plane, which has no inside to open").hint("a box, or a mesh that is closed"));
    }
    Ok(ObjectId(index))
}

/// The target in the frame of the object, and the depth of a drill.
fn target(v: &Value<'_>, units: Units, object: &Object) -> Result<(ShieldTarget, Option<f64>)> {
    let t = v.table(TARGET)?;
    t.only(&names(&[FIXTURE_TARGET]))?;
    let given: Vec<&str> = FIXTURE_TARGET.iter().map(|k| k.name).filter(|k| t.get(k).is_some()).collect();
    let [kind] = given[..] else {
        return Err(v.error(format!("has {} of line, area, drill and faces_within", given.len())).hint(TARGET));
    };
    let local = |p: Vec3| object.in_world.inverse_transform_point(p);
    let points = |key: &str, least: usize| -> Result<Vec<Vec3>> {
        let value = t.need(key, TARGET)?;
        let list = value.list(TARGET)?;
        if list.len() < least {
            return Err(value.error(format!("needs at least {least} points")).hint(TARGET));
        }
        list.iter().map(|v| units.point(v).map(local)).collect()
    };
    match kind {
        "line" => Ok((ShieldTarget::Line(points("line", 2)?), None)),
        "area" => {
            let area = points("area", 3)?;
            let in_world: Vec<Vec3> = area.iter().map(|p| object.in_world.transform_point(*p)).collect();
            if let Some(crossing) = crossing_edges(object, &in_world) {
                let what = format!("does not bound an area: {}", crossing_text(crossing));
                return Err(t.need("area", TARGET)?.error(what).hint(AROUND));
            }
            Ok((ShieldTarget::Area(area), None))
        }
        "drill" => {
            const EXAMPLE: &str = "drill = { at = [0, 0, 100], axis = [0, 0, -1], depth = 20 }";
            let drill = t.need("drill", TARGET)?.table(EXAMPLE)?;
            drill.only(&names(&[FIXTURE_DRILL]))?;
            let at = local(units.point(&drill.need("at", EXAMPLE)?)?);
            let given = drill.need("axis", EXAMPLE)?;
            let axis = object.in_world.inverse_transform_vector(given.three()?);
            if axis.try_normalize().is_none() {
                return Err(given.error("has no length").hint(EXAMPLE));
            }
            let depth_m = units.not_negative_length(&drill.need("depth", EXAMPLE)?)?;
            Ok((ShieldTarget::Drill { at, axis }, Some(depth_m)))
        }
        _ => {
            const EXAMPLE: &str = "faces_within = { at = [0, 0, 100], radius = 10 }";
            let faces = t.need("faces_within", TARGET)?.table(EXAMPLE)?;
            faces.only(&names(&[FIXTURE_FACES]))?;
            let at = local(units.point(&faces.need("at", EXAMPLE)?)?);
            let radius_m = units.positive_length(&faces.need("radius", EXAMPLE)?)?;
            Ok((ShieldTarget::FacesWithin { at, radius_m }, None))
        }
    }
}
