//! COLLADA 1.4 and 1.5: the triangles of the scene in world coordinates, in metres.
//!
//! The result has one entry per node with geometry.
//! - Read: units, up axis, `matrix translate rotate scale` of nested and instanced nodes, `triangles polylist polygons
//!   tristrips trifans`, skins in their bind shape.
//! - Ignored: materials, lights, cameras, animations, lines.
//! - Refused: `skew`, `lookat`, references into other files.

mod geometry;
mod scene;
mod source;

use std::path::Path;

use roxmltree::Node;

use crate::affine::Affine;
use crate::mesh_data::{LoadedMeshes, UpAxis};
use crate::tokens::show;
use crate::warning_list::WarningList;
use crate::{Diagnostic, input, xml};

/// Parses a COLLADA file and applies its unit. A file that states no unit is in metres.
///
/// # Errors
/// [`Diagnostic`] for invalid XML, references to missing elements, missing vertices, invalid numbers, or nodes in a
/// cycle.
pub fn parse(bytes: &[u8], file: &Path, up: UpAxis) -> Result<LoadedMeshes, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        let what = format!("the root element is <{}>, not <COLLADA>", show(root.tag_name().name().as_bytes()));
        return Err(Diagnostic::new(file, xml::line(root), what).hint("a COLLADA file, exported as .dae"));
    }
    let mut warnings = WarningList::default();
    let asset = xml::child(root, "asset");
    let metres = unit_in_metres(asset, file)?;
    let upright = match up {
        UpAxis::ToZ => upright(asset, file, &mut warnings),
        UpAxis::Ignore => Affine::IDENTITY,
    };
    let to_metres = upright.after(&Affine::scale([metres; 3]));
    let meshes = scene::meshes(root, &to_metres, file, &mut warnings)?;
    Ok(LoadedMeshes { meshes, warnings: warnings.finish(file) })
}

fn unit_in_metres(asset: Option<Node<'_, '_>>, file: &Path) -> Result<f64, Diagnostic> {
    let Some(unit) = asset.and_then(|a| xml::child(a, "unit")) else { return Ok(1.0) };
    let Some(meter) = unit.attribute("meter") else { return Ok(1.0) };
    let metres = meter.trim().parse().ok().filter(|m: &f64| m.is_finite() && *m > 0.0);
    metres.ok_or_else(|| {
        let what = format!("the unit `{}` is not a length in metres", show(meter.as_bytes()));
        Diagnostic::new(file, xml::line(unit), what).hint("<unit name=\"millimeter\" meter=\"0.001\"/>")
    })
}

/// The rotation of the stated up axis to +z (COLLADA 1.4.1, `up_axis`).
fn upright(asset: Option<Node<'_, '_>>, file: &Path, warnings: &mut WarningList) -> Affine {
    let Some(node) = asset.and_then(|a| xml::child(a, "up_axis")) else {
        // Y_UP is the default of the specification.
        return Affine::rotation(Y_UP);
    };
    match node.text().unwrap_or_default().trim() {
        "Z_UP" => Affine::IDENTITY,
        "X_UP" => Affine::rotation([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
        "Y_UP" => Affine::rotation(Y_UP),
        other => {
            let what = format!("the up axis `{}` is unknown; Y_UP, the default, is taken", show(other.as_bytes()));
            warnings.push(Diagnostic::new(file, xml::line(node), what).hint("<up_axis>Z_UP</up_axis>"));
            Affine::rotation(Y_UP)
        }
    }
}

const Y_UP: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
