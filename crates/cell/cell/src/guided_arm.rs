//! The guided arm of an operator.

use std::sync::Arc;

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::TriMesh;
use elbowroom_proximity::contact::triangle_surface;
use elbowroom_robot::ObjectId;
use elbowroom_scene::{Scene, SceneState, Selection};
use elbowroom_shared_control::force::{
    ArmField, ArmForces, BodySettings, FieldPair, ImpedancePort, ImpedanceSettings, Response, VirtualBody,
};
use elbowroom_shared_control::{GuidedArm, NavigatorError, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

use crate::{Cell, CellFixture, CellForce, CellOperator, ForceOther, ForceResponse};

/// Chord error of curved surfaces and tools, metres.
const CHORD_M: f64 = 1e-4;
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
    ) -> Result<GuidedArm<'s>, Diagnostic> {
        let robot = &cell.robots[self.robot.0];
        let refused = |what: String| Diagnostic::new(&cell.file, self.line, what);
        let Some((collider, tcp_in_link)) = self.tool.solid(cell) else {
            return Err(refused(format!("the tool of \"{}\" has no solid", robot.name)));
        };
        let link = self.tool.link(cell);
        let tool = placed(&collider.shape, &(tcp_in_link.inverse() * collider.in_link));
        let tool = tool.ok_or_else(|| refused(format!("the tool of \"{}\" has no surface", robot.name)))?;
        let mut chain_state = ChainState::new(&robot.robot.chain);
        chain_state.q.copy_from_slice(&robot.start);
        robot.robot.chain.forward(&mut chain_state);
        let tool_in_world = robot.base_in_world * chain_state.link_in_root(link) * tcp_in_link;
        let (surfaces, shields_from) = self.surfaces(cell, notes)?;
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
        let guide = cell.guidance.guides.iter().find(|g| g.active && g.tool == self.tool);
        if let Some(g) = guide
            && g.guide.distance_m(tool_in_world.translation) > FAR_FROM_GUIDE_M
        {
            let distance = cell.units.show_length(g.guide.distance_m(tool_in_world.translation));
            let what = format!("the tool starts {distance} from the guide \"{}\", and moves there at once", g.name);
            notes.push(Diagnostic::new(&cell.file, g.line, what).hint("a guide through the tool point at its start"));
        }
        arm.set_guide(guide.map(|g| g.guide.clone()));
        let forces = self.forces(cell, scene, shields_from, (link, tcp_in_link.translation));
        if let Some(forces) = forces.map_err(|e| refused(e.to_string()))? {
            arm.set_forces(forces);
        }
        Ok(arm)
    }

    /// The forces of the tool; `None` without. `shields_from` is the index of its first shield among the surfaces.
    fn forces<'s>(
        &self,
        cell: &Cell,
        scene: &'s Scene,
        shields_from: usize,
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
                    let before = cell.guidance.fixtures[..index].iter().filter(|f| self.is_shielded_by(f)).count();
                    vec![FieldPair::Surface(shields_from + before)]
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
                // A row holds until the next one, and then the hand moves within one tick.
                let fastest = self.stream.largest_step_m(ArmForces::REGRIP_M) / cell.timing.tick_s;
                let hand_speed_m_s = settings.hand_speed_m_s.max(fastest);
                let settings = ImpedanceSettings { hand_speed_m_s, ..settings };
                Some(ImpedancePort::new(settings).map(Response::Impedance))
            }
        });
        let response =
            response.unwrap_or_else(|| VirtualBody::new(BodySettings::default()).map(Response::Admittance))?;
        Ok(Some(ArmForces::new(response, fields, (scene, robot), tool)))
    }

    /// Whether the shield of a fixture guards the tool.
    fn is_shielded_by(&self, fixture: &CellFixture) -> bool {
        fixture.active && fixture.tool == Some(self.tool)
    }

    /// The surfaces along which the tool glides, and the index of the first one that is a shield.
    fn surfaces(&self, cell: &Cell, notes: &mut Vec<Diagnostic>) -> Result<(Vec<ProtectedSurface>, usize), Diagnostic> {
        let mut surfaces = Vec::new();
        let shields: Vec<_> = cell.guidance.fixtures.iter().filter(|f| self.is_shielded_by(f)).collect();
        for (index, object) in cell.objects.iter().enumerate() {
            let id = ObjectId(index);
            if cell.moving_objects.iter().any(|m| m.object == id) || shields.iter().any(|f| f.protects == id) {
                continue;
            }
            let surface = triangle_surface(&object.shape, CHORD_M);
            let protected = surface.map(|mesh| ProtectedSurface::new(mesh, object.in_world));
            match protected {
                Some(Ok(surface)) => surfaces.push(surface),
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
        let shields_from = surfaces.len();
        for fixture in shields {
            let in_world = cell.objects[fixture.protects.0].in_world;
            let shield = ProtectedSurface::new(fixture.shield(cell)?.mesh, in_world);
            let refused =
                |e: NavigatorError| Diagnostic::new(&cell.file, fixture.line, format!("the shield is not usable: {e}"));
            surfaces.push(shield.map_err(refused)?);
        }
        Ok((surfaces, shields_from))
    }
}

/// The surface of a solid in another frame.
fn placed(shape: &elbowroom_proximity::Shape, in_frame: &Pose) -> Option<Arc<TriMesh>> {
    let mesh = triangle_surface(shape, CHORD_M)?;
    let vertices = mesh.vertices().iter().map(|p| in_frame.transform_point(*p)).collect();
    TriMesh::new(vertices, mesh.triangles().to_vec()).ok().map(Arc::new)
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
