//! The guided arm of an operator.

use std::sync::Arc;

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::contact::triangle_surface;
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::{Collider, ObjectId};
use elbowroom_scene::{Scene, SceneState, Selection};
use elbowroom_shared_control::force::{
    ArmField, ArmForces, BodySettings, FieldPair, ImpedancePort, ImpedanceSettings, Response, VirtualBody,
};
use elbowroom_shared_control::{GuidedArm, NavigatorError, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

use crate::operated_arm::{FixturesOn, SurfaceOwner};
use crate::{
    Cell, CellFixture, CellForce, CellGuide, CellOperator, FixtureRef, FixtureTool, ForceOther, ForceResponse,
    OperatedArm,
};

/// Chord error of curved surfaces and tools, metres.
pub(crate) const CHORD_M: f64 = 1e-4;
/// Distance from a guide at the start that is told, metres.
const FAR_FROM_GUIDE_M: f64 = 2e-3;

impl CellOperator {
    /// The arm that this operator guides, at its start in the scene of the cell.
    ///
    /// Its tool glides along all objects that stand still and are closed, and along the shields of the fixtures that are
    /// on for it, instead of the objects that they protect. Everything else stops it: planes, open meshes and objects that
    /// move are named in `notes`.
    ///
    /// # Errors
    /// [`Diagnostic`] at the line of the operator, or of a fixture: a start that is too near to a surface, or a shield that
    /// cannot be made.
    pub fn arm<'s>(
        &self,
        cell: &Cell,
        scene: &'s Scene,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<OperatedArm<'s>, Diagnostic> {
        let robot = &cell.robots[self.robot.0];
        let refused = |what: String| Diagnostic::new(&cell.file, self.line, what);
        let Some((_, tcp_in_link)) = self.tool.solid(cell) else {
            return Err(refused(format!("the tool of \"{}\" has no solid", robot.name)));
        };
        let link = self.tool.link(cell);
        let tool =
            self.tool_surface(cell).ok_or_else(|| refused(format!("the tool of \"{}\" has no surface", robot.name)))?;
        let mut chain_state = ChainState::new(&robot.robot.chain);
        chain_state.q.copy_from_slice(&robot.start);
        robot.robot.chain.forward(&mut chain_state);
        let tool_in_world = robot.base_in_world * chain_state.link_in_root(link) * tcp_in_link;
        let on = FixturesOn::at_start(cell, self);
        let (surfaces, owners) = self.surfaces(cell, &on, notes)?;
        let navigator = SurfaceNavigator::new(tool, surfaces, tool_in_world, self.settings)
            .map_err(|e| refused(format!("operator \"{}\": {}", self.name, in_words(e, cell))))?;
        let solver = IkSolver::new(&robot.robot.chain, link, tcp_in_link, IkOptions::default());
        let mut state = SceneState::new(scene);
        for (index, r) in cell.robots.iter().enumerate() {
            let set = state.set_q(scene, elbowroom_robot::RobotId(index), &r.start);
            set.map_err(|e| refused(e.to_string()))?;
        }
        let speeds = robot.limits.iter().map(|limits| limits.velocity).collect();
        let mut arm = GuidedArm::new(navigator, solver, (scene, self.robot), state, speeds)
            .map_err(|_| refused(format!("\"{}\" cannot hold its tool point at its start", robot.name)))?;
        let guide = on.guide().map(|index| &cell.guidance.guides[index]);
        notes.extend(guide.and_then(|g| far_start(cell, g, &tool_in_world)));
        arm.set_guide(guide.map(|g| g.guide.clone()));
        let forces = self.forces(cell, scene, &owners, (link, tcp_in_link.translation));
        if let Some(forces) = forces.map_err(|e| refused(e.to_string()))? {
            arm.set_forces(forces);
        }
        let refused = vec![false; cell.guidance.fixtures.len()];
        Ok(OperatedArm { arm, surfaces: owners, wanted: on.clone(), on, refused })
    }

    /// The surface of the tool in the frame of its point. If a shield may let its link into an object, everything on that
    /// link belongs to it.
    fn tool_surface(&self, cell: &Cell) -> Option<Arc<TriMesh>> {
        let is_let_in = cell.guidance.fixtures.iter().enumerate().any(|(index, f)| self.may_open(index, f));
        if is_let_in {
            self.tool.surface_of_link(cell)
        } else {
            surface_of(&[self.tool.solid(cell)?.0], self.tool, cell)
        }
    }

    /// The forces of the tool, which glides along the surfaces of `owners`; `None` without.
    fn forces<'s>(
        &self,
        cell: &Cell,
        scene: &'s Scene,
        owners: &[SurfaceOwner],
        tool: (LinkId, Vec3),
    ) -> Result<Option<ArmForces<'s>>, NavigatorError> {
        let own: Vec<&CellForce> = cell.guidance.forces.iter().filter(|f| f.tool == self.tool).collect();
        if own.is_empty() {
            return Ok(None);
        }
        let robot = self.robot;
        let colliders = &cell.robots[robot.0].robot.colliders;
        let links = (0..colliders.len()).map(LinkId).filter(|link| !colliders[link.0].is_empty());
        let pairs = |force: &CellForce| -> Vec<FieldPair> {
            match force.other {
                // A field per link: the nearest point of a whole arm jumps from link to link.
                ForceOther::Object(object) => links
                    .clone()
                    .filter(|link| force.whole_arm || *link == tool.0)
                    .map(|link| FieldPair::Scene(Selection::Link { robot, link }, Selection::Object(object)))
                    .collect(),
                ForceOther::Shield(index) => {
                    let surface = owners.iter().position(|owner| *owner == SurfaceOwner::Shield(index));
                    surface.map(FieldPair::Surface).into_iter().collect()
                }
            }
        };
        let laws = own.iter().filter_map(|force| Some((force.field?, pairs(force))));
        let fields = laws.flat_map(|(law, pairs)| pairs.into_iter().map(move |pair| ArmField::new(law, pair)));
        let fields = fields.collect::<Result<Vec<_>, _>>()?;
        let response = own.iter().find_map(|force| match force.response {
            ForceResponse::Field => None,
            ForceResponse::Admittance(settings) => Some(VirtualBody::new(settings).map(Response::Admittance)),
            ForceResponse::Impedance(settings) => {
                let fastest = self.stream.largest_speed_m_s(ArmForces::REGRIP_M, cell.timing.tick_s);
                let hand_speed_m_s = settings.hand_speed_m_s.max(fastest);
                let settings = ImpedanceSettings { hand_speed_m_s, ..settings };
                Some(ImpedancePort::new(settings).map(Response::Impedance))
            }
        });
        let response =
            response.unwrap_or_else(|| VirtualBody::new(BodySettings::default()).map(Response::Admittance))?;
        Ok(Some(ArmForces::new(response, fields, (scene, robot), tool)))
    }

    /// Whether a fixture, by its index, is on for the tool at some time.
    pub(crate) fn may_open(&self, index: usize, fixture: &CellFixture) -> bool {
        fixture.tool == Some(self.tool) && self.switches.is_ever_on(FixtureRef::Shield(index), fixture.active)
    }

    /// The surfaces along which the tool glides, objects first, and what each belongs to.
    fn surfaces(
        &self,
        cell: &Cell,
        on: &FixturesOn,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<(Vec<ProtectedSurface>, Vec<SurfaceOwner>), Diagnostic> {
        let (mut surfaces, mut owners) = (Vec::new(), Vec::new());
        let mut add = |surface: ProtectedSurface, owner: SurfaceOwner| {
            surfaces.push(surface.switched(on.keep_off(cell, owner)));
            owners.push(owner);
        };
        let fixtures = || cell.guidance.fixtures.iter().enumerate().filter(|(index, f)| self.may_open(*index, f));
        let is_always_on =
            |(index, f): &(usize, &CellFixture)| !self.switches.is_ever_off(FixtureRef::Shield(*index), f.active);
        for (index, object) in cell.objects.iter().enumerate() {
            let id = ObjectId(index);
            let is_replaced = fixtures().filter(is_always_on).any(|(_, f)| f.protects == id);
            if is_replaced || cell.moving_objects.iter().any(|m| m.object == id) {
                continue;
            }
            let surface = surface_around(&object.shape);
            let protected = surface.map(|mesh| ProtectedSurface::new(mesh, object.in_world));
            match protected {
                Some(Ok(surface)) => add(surface, SurfaceOwner::Object(id)),
                Some(Err(e)) => {
                    let what = format!(
                        "\"{}\" stops the tool of operator \"{}\", which cannot glide along it: {e}",
                        object.name, self.name
                    );
                    notes.push(Diagnostic::new(&cell.file, self.line, what));
                }
                None => {}
            }
        }
        for (index, fixture) in fixtures() {
            add(fixture.protected_surface(cell)?.clone(), SurfaceOwner::Shield(index));
        }
        Ok((surfaces, owners))
    }
}

impl FixtureTool {
    /// The surface of everything on the link that carries the tool, in the frame of its point.
    pub(crate) fn surface_of_link(self, cell: &Cell) -> Option<Arc<TriMesh>> {
        let on_link = &cell.robots[self.robot.0].robot.colliders[self.link(cell).0];
        surface_of(&on_link.iter().collect::<Vec<_>>(), self, cell)
    }
}

/// Triangles around a shape. Triangles between points on a round surface would be inside it, and the tool nearer to the
/// true surface than half of the gap: such a shape is made larger by the depth of its deepest triangle.
fn surface_around(shape: &Shape) -> Option<Arc<TriMesh>> {
    let mesh = triangle_surface(shape, CHORD_M)?;
    let mut around = shape.clone();
    let radius = match &mut around {
        Shape::Sphere(sphere) => &mut sphere.radius,
        Shape::Capsule(capsule) => &mut capsule.radius,
        Shape::Cylinder(cylinder) => &mut cylinder.radius,
        Shape::Cuboid(_) | Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => return Some(mesh),
    };
    // The larger surface has deeper triangles, and the middle of a triangle may not be its deepest point.
    *radius += 1.1 * deepest_m(shape, &mesh);
    triangle_surface(&around, CHORD_M)
}

/// How deep edges and middles of triangles are under the round surface of a shape, m; the ends of a cylinder are flat.
fn deepest_m(shape: &Shape, mesh: &TriMesh) -> f64 {
    let depth = |p: Vec3| match shape {
        Shape::Sphere(sphere) => sphere.radius - p.length(),
        Shape::Capsule(capsule) => capsule.radius - p.distance(capsule.axis_point(p)),
        Shape::Cylinder(cylinder) => cylinder.radius - p.x.hypot(p.y),
        _ => 0.0,
    };
    let of_triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.vertices()[corner as usize]);
        if matches!(shape, Shape::Cylinder(_)) && a.z == b.z && b.z == c.z {
            return 0.0;
        }
        [a + b, b + c, c + a].map(|sum| sum * 0.5).into_iter().chain([(a + b + c) / 3.0]).map(depth).fold(0.0, f64::max)
    };
    mesh.triangles().iter().map(of_triangle).fold(0.0, f64::max)
}

/// The surface of parts of a tool's link, in the frame of its point.
fn surface_of(parts: &[&Collider], tool: FixtureTool, cell: &Cell) -> Option<Arc<TriMesh>> {
    let (_, tcp_in_link) = tool.solid(cell)?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let mesh = surface_around(&part.shape)?;
        let (first, in_tcp) = (vertices.len() as u32, tcp_in_link.inverse() * part.in_link);
        vertices.extend(mesh.vertices().iter().map(|p| in_tcp.transform_point(*p)));
        triangles.extend(mesh.triangles().iter().map(|corners| corners.map(|corner| corner + first)));
    }
    TriMesh::new(vertices, triangles).ok().map(Arc::new)
}

/// A note on a tool that starts far from its guide.
fn far_start(cell: &Cell, g: &CellGuide, tool_in_world: &Pose) -> Option<Diagnostic> {
    let distance_m = g.guide.distance_m(tool_in_world);
    if distance_m <= FAR_FROM_GUIDE_M {
        return None;
    }
    let (distance, name) = (cell.units.show_length(distance_m), &g.name);
    let (what, hint) = if g.guide.remote_center().is_some() {
        let what =
            format!("the shaft starts {distance} from the point of \"{name}\", and turns there before the tool moves");
        (what, "a start with the shaft through the point")
    } else {
        let what = format!("the tool starts {distance} from the guide \"{name}\", and moves there at once");
        (what, "a guide through the tool point at its start")
    };
    Some(Diagnostic::new(&cell.file, g.line, what).hint(hint))
}

fn in_words(e: NavigatorError, cell: &Cell) -> String {
    let length = |metres: f64| cell.units.show_length(metres);
    match e {
        NavigatorError::TooNear { gap_m, least_gap_m } => format!(
            "the tool starts {} from a surface; `start` of the robot must keep at least {} (half of `gap`)",
            length(gap_m),
            length(least_gap_m)
        ),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::Sphere;

    use super::*;

    /// With a gap of 0.2 mm, triangles inside a sphere let the tool come nearer to it than half of that.
    #[test]
    fn triangles_are_around_a_round_shape() {
        for radius in [0.003, 0.26, 2.0] {
            let mesh = surface_around(&Shape::Sphere(Sphere { radius })).unwrap();
            for corners in mesh.triangles() {
                let [a, b, c] = corners.map(|corner| mesh.vertices()[corner as usize]);
                let normal = (b - a).cross(c - a).try_normalize().unwrap();
                let from_centre = normal.dot(a).abs();
                assert!(
                    from_centre >= radius && a.length() < 1.0002 * radius + 1.2 * CHORD_M,
                    "{radius}: {from_centre}"
                );
            }
        }
    }
}
