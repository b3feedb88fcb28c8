//! Shields of the fixtures of a cell, and how their tools pass.

use std::sync::Arc;

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::LinkId;
use elbowroom_proximity::contact::triangle_surface;
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::{Collider, GeometryId, ObjectId};
use elbowroom_scene::{Object, PairEdit, PairRule, PairRules, Scene, Selection};
use elbowroom_shared_control::{
    NavigatorError, Passage, ProtectedSurface, Shield, ShieldError, ShieldSettings, generate_shield, line_on_surface,
};
use elbowroom_spatial::{Pose, Vec3};

use crate::area_border::{AROUND, crossing_edges, crossing_text};
use crate::{
    Cell, CellFixture, CellOperator, CellRobot, CellTool, FixtureTool, OutOfReachProofs, QueryModel, ShieldSource,
    Units,
};

impl FixtureTool {
    /// The link that carries its solid.
    pub fn link(self, cell: &Cell) -> LinkId {
        let robot = &cell.robots[self.robot.0];
        self.named.map_or(robot.flange, |index| robot.payload.tools[index].link)
    }

    /// The solid of the tool, and the frame of its tool point in the solid's link.
    pub fn solid(self, cell: &Cell) -> Option<(&Collider, Pose)> {
        let CellRobot { payload, tcp_in_flange, .. } = &cell.robots[self.robot.0];
        match self.named.map(|index| &payload.tools[index]) {
            Some(CellTool { collider, tcp_in_link, .. }) => Some((collider.as_ref()?, *tcp_in_link)),
            None => Some((payload.tool.as_ref()?, *tcp_in_flange)),
        }
    }
}

impl Cell {
    /// The line of a target along the surface of an object, with points in the world: the given points, and points between
    /// them. A closed line is the border of an area.
    ///
    /// # Errors
    /// [`Diagnostic`] if the object has no surface of triangles, or the line leaves it.
    pub fn line_on_object(
        &self,
        object: ObjectId,
        points: &[Vec3],
        is_closed: bool,
        settings: &ShieldSettings,
    ) -> Result<Vec<Vec3>, Diagnostic> {
        let object = &self.objects[object.0];
        let refused = |what: String| Diagnostic::new(&self.file, None, what);
        if is_closed && let Some(crossing) = crossing_edges(object, points) {
            return Err(refused(crossing_text(crossing)).hint(AROUND));
        }
        let mesh = surface(object, settings, refused)?;
        let local: Vec<Vec3> = points.iter().map(|p| object.in_world.inverse_transform_point(*p)).collect();
        let line = line_on_surface(&mesh, &local, is_closed, settings);
        let line = line.map_err(|e| refused(in_words(e, object, self.units)))?;
        Ok(line.iter().map(|p| object.in_world.transform_point(*p)).collect())
    }

    /// Rules of a run: a guided tool may touch what the shield of its fixture opens.
    pub fn opened_pairs(&self) -> PairRules {
        let opened = |(index, fixture): (usize, &CellFixture)| {
            let is_on = |o: &&CellOperator| o.may_open(index, fixture);
            let operator = self.guidance.operators.iter().find(is_on)?;
            let link = GeometryId::Link { robot: operator.robot, link: operator.tool.link(self) };
            let edit = PairEdit::Skip(format!("the shield of {} guards it", fixture.name));
            Some(PairRule { a: link.into(), b: Selection::Object(fixture.protects), edit })
        };
        self.guidance.fixtures.iter().enumerate().filter_map(opened).collect()
    }

    /// The scene in which persons guide arms: their tools may enter the openings of their shields.
    ///
    /// # Errors
    /// As for [`QueryModel::scene`].
    pub fn scene_of_guidance(&self) -> Result<Scene, Diagnostic> {
        let mut model = QueryModel::of_cell(self);
        model.add_rules(self.opened_pairs());
        model.scene(OutOfReachProofs::Omit)
    }
}

impl CellFixture {
    /// The shield in the frame of the protected object: the one that was read, or a generated one, which is made once.
    ///
    /// # Errors
    /// [`Diagnostic`] at the line of the table: an object that bounds no solid, or a target off its surface.
    pub fn shield(&self, cell: &Cell) -> Result<&Shield, Diagnostic> {
        if let Some(made) = self.made.get() {
            return Ok(made);
        }
        let shield = self.make_shield(cell)?;
        Ok(self.made.get_or_init(|| shield))
    }

    /// The shield in the world, for a tool that glides along it. Made once: a cell is checked before it runs.
    ///
    /// # Errors
    /// As for [`CellFixture::shield`], and a shield that bounds no solid.
    pub(crate) fn protected_surface(&self, cell: &Cell) -> Result<&ProtectedSurface, Diagnostic> {
        if let Some(placed) = self.placed.get() {
            return Ok(placed);
        }
        let in_world = cell.objects[self.protects.0].in_world;
        let refused =
            |e: NavigatorError| Diagnostic::new(&cell.file, self.line, format!("the shield is not usable: {e}"));
        let placed = ProtectedSurface::new(self.shield(cell)?.mesh.clone(), in_world).map_err(refused)?;
        Ok(self.placed.get_or_init(|| placed))
    }

    fn make_shield(&self, cell: &Cell) -> Result<Shield, Diagnostic> {
        let (target, settings) = match &self.shield {
            ShieldSource::Mesh(mesh) => return Ok(Shield { mesh: mesh.clone(), passage: Vec::new() }),
            ShieldSource::Generated { target, settings } => (target, settings),
        };
        let object = &cell.objects[self.protects.0];
        let refused = |what: String| Diagnostic::new(&cell.file, self.line, what);
        let mesh = surface(object, settings, refused)?;
        generate_shield(&mesh, target, settings).map_err(|e| refused(in_words(e, object, cell.units)))
    }

    /// Dimensions of a generated shield; `None` for one that was read.
    pub fn settings(&self) -> Option<&ShieldSettings> {
        if let ShieldSource::Generated { settings, .. } = &self.shield { Some(settings) } else { None }
    }

    /// How the tool of the fixture, with everything on its link, passes the opening of its shield; `None` without a tool that has a solid, or a shield
    /// that was read: nothing says what the tool is to reach.
    pub fn passage(&self, shield: &Shield, cell: &Cell) -> Option<Passage> {
        let tool = Shape::Mesh(self.tool?.surface_of_link(cell)?);
        Some(shield.passage_of(&tool, &Pose::IDENTITY, self.settings()?))
    }
}

/// The triangles that a shield protects, in the frame of the object.
fn surface(
    object: &Object,
    settings: &ShieldSettings,
    refused: impl Fn(String) -> Diagnostic,
) -> Result<Arc<TriMesh>, Diagnostic> {
    triangle_surface(&object.shape, 0.25 * settings.tolerance_m)
        .ok_or_else(|| refused(format!("\"{}\" has no surface of triangles, so it cannot be protected", object.name)))
}

/// An error in the units of the file, with places in the world.
fn in_words(e: ShieldError, object: &Object, units: Units) -> String {
    let place = |p| {
        let p = object.in_world.transform_point(p).to_array().map(|x| units.show_length(x));
        format!("[{}, {}, {}]", p[0], p[1], p[2])
    };
    let surface = match &object.shape {
        Shape::Mesh(_) => format!("the mesh of \"{}\"", object.name),
        _ => format!("\"{}\"", object.name),
    };
    match e {
        ShieldError::OffSurface { number, point, distance_m, tolerance_m } => format!(
            "point {number} of the target, {}, is {} off the surface of {surface}; `tolerance` allows {}",
            place(point),
            units.show_length(distance_m),
            units.show_length(tolerance_m)
        ),
        ShieldError::LeavesSurface { number, place: at } => format!(
            "the target leaves the surface of {surface} at {}, between its points {number} and {}; add points where \
             it turns",
            place(at),
            number + 1
        ),
        ShieldError::TooFine { tolerance_m, triangles } => format!(
            "a `tolerance` of {} needs about {triangles} triangles, at most {} are allowed; choose a larger one",
            units.show_length(tolerance_m),
            ShieldError::MOST_TRIANGLES
        ),
        ShieldError::Surface(why) => format!("{surface} cannot be protected: {why}"),
        other => other.to_string(),
    }
}
