//! `elbowroom fixture`: the shield of a virtual fixture.

use std::fmt::Write;

use elbowroom::Diagnostic;
use elbowroom::cell::{Cell, CellFixture, ShieldReport};
use elbowroom::formats::{MeshData, stl};
use elbowroom::proximity::TriMesh;
use elbowroom::spatial::Pose;

use crate::args::FixtureArgs;
use crate::output::{ExitStatus, Failure, note, print, print_json};
use crate::output_file::write_bytes;

pub(crate) fn fixture(args: &FixtureArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    let fixture = named(&cell, args)?;
    let shield = fixture.shield(&cell)?;
    let object = &cell.objects[fixture.protects.0];
    if let Some(path) = &args.out {
        let mut bytes = Vec::new();
        stl::write_binary(&mut bytes, &[in_world(&shield.mesh, &object.in_world, &fixture.name)])
            .map_err(|e| Failure::Wrong(e.to_string()))?;
        write_bytes(path, bytes)?;
    }
    let answer = fixture.report(&cell)?;
    if args.json {
        print_json(&answer)?;
    } else {
        print(&text(&answer, &cell))?;
    }
    if let Some(path) = args.out.as_ref().filter(|_| !args.json) {
        note(format!("The shield is in {}, in metres and in the world.", path.display()));
    }
    Ok(if answer.reachable == Some(false) { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

fn named<'a>(cell: &'a Cell, args: &FixtureArgs) -> Result<&'a CellFixture, Failure> {
    let names: Vec<&str> = cell.guidance.fixtures.iter().map(|f| f.name.as_str()).collect();
    let guides: Vec<&str> = cell.guidance.guides.iter().map(|g| g.name.as_str()).collect();
    let wrong = |what: String, hint: String| Err(Diagnostic::new(&args.cell, None, what).hint(hint).into());
    match (&args.name, cell.guidance.fixtures.as_slice()) {
        (_, []) if guides.is_empty() => {
            wrong("has no fixture with a shield".into(), "a table [fixture.NAME]: docs/fixtures.md".into())
        }
        (None, []) => wrong("has guides only, which have no shield".into(), "a fixture with `protects`".into()),
        (None, [only]) => Ok(only),
        (None, _) => wrong("has several fixtures".into(), format!("--name with one of {}", names.join(", "))),
        (Some(name), all) => match all.iter().find(|f| f.name == *name) {
            Some(fixture) => Ok(fixture),
            None if guides.contains(&name.as_str()) => {
                wrong(format!("has the guide \"{name}\", which has no shield"), "run".into())
            }
            None => wrong(format!("has no fixture \"{name}\""), format!("--name with one of {}", names.join(", "))),
        },
    }
}

fn in_world(mesh: &TriMesh, in_world: &Pose, name: &str) -> MeshData {
    let vertices = mesh.vertices().iter().map(|p| in_world.transform_point(*p)).collect();
    MeshData { name: name.to_owned(), vertices, triangles: mesh.triangles().to_vec() }
}

fn text(answer: &ShieldReport, cell: &Cell) -> String {
    // To a hundredth of a millimetre.
    let length = |metres: f64| cell.units.show_length((metres * 1e5).round() / 1e5);
    let mut text = format!("{}: a shield around {}, {} triangles", answer.name, answer.protects, answer.triangles);
    if answer.components > 1 {
        _ = write!(text, ", {} separate parts", answer.components);
    }
    if let Some(narrowest_m) = answer.narrowest_m {
        _ = write!(text, "\n  opening  at least {} wide above the surface", length(narrowest_m));
    }
    match (answer.tool_width_m, answer.reachable) {
        (Some(width), Some(true)) => _ = write!(text, "\n  tool     {} wide: it reaches the target", length(width)),
        (Some(width), _) => {
            let at = answer.blocked_at_m.unwrap_or_default().map(length).join(", ");
            _ = write!(text, "\n  tool     {} wide: it does not reach the target at [{at}]", length(width));
            _ = write!(text, "\n  write    a larger `width` or `flare`, or a narrower tool");
        }
        _ if answer.narrowest_m.is_none() => {
            _ = write!(text, "\n  read from a file: what it leaves open is not examined");
        }
        _ => _ = write!(text, "\n  tool     none: add `tool` to see whether it passes"),
    }
    text + "\n"
}
