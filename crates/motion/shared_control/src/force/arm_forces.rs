//! The fields around a tool and its whole arm.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, PairDistance, Scene, SceneState, Selection};
use elbowroom_spatial::Vec3;
use elbowroom_spatial::linalg::solve_spd;

use super::field::FieldSample;
use super::impedance_port::ImpedancePort;
use super::law::ForceLaw;
use super::virtual_body::VirtualBody;
use crate::{NavigatorError, SurfaceNavigator};

/// Damping of the map from joint torques to the tool near singularities, relative to a reach of a metre.
const SINGULAR: f64 = 1e-6;

/// Which bodies a field is between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldPair {
    /// The tool and a protected surface: its index in the navigator.
    Surface(usize),
    /// Links of the arm, and something else in the scene; the pair rules of the scene apply.
    Scene(Selection, Selection),
}

/// A field between two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmField {
    law: ForceLaw,
    pair: FieldPair,
    /// The range now: it changes only while the bodies are farther apart, where it stores nothing.
    range_m: f64,
    /// Distance at the last evaluation; infinite if it was out of range.
    last_m: f64,
}

impl ArmField {
    /// A field between two bodies.
    ///
    /// # Errors
    /// A constant of the law that is not usable.
    pub fn new(law: ForceLaw, pair: FieldPair) -> Result<Self, NavigatorError> {
        law.check()?;
        Ok(Self { law, pair, range_m: law.range_m, last_m: f64::INFINITY })
    }

    /// Lets the range follow the speed of the approach, unless the bodies are within it.
    fn adapt_range(&mut self, distance_m: f64, approach_m_s: f64) {
        if distance_m >= self.range_m {
            self.range_m = self.law.range_at(approach_m_s).min(distance_m);
        }
    }
}

/// How a tool answers to its hand and to fields.
#[derive(Debug, Clone)]
pub enum Response {
    /// Force in, motion out: the tool is a mass.
    Admittance(VirtualBody),
    /// Motion in, force out: the tool follows the hand, which feels a spring.
    Impedance(ImpedancePort),
}

/// The fields around a guided tool and its arm, and what they do.
#[derive(Debug)]
pub struct ArmForces<'s> {
    response: Response,
    fields: Vec<ArmField>,
    checker: Checker<'s>,
    chain_state: ChainState,
    /// Link of the tool, and its point there.
    tool: (LinkId, Vec3),
    /// Jacobians of the tool point and of a point of the arm, a column per joint.
    tool_columns: Vec<[f64; 6]>,
    point_columns: Vec<[f64; 6]>,
    /// Change of the last distance per motion of each joint, m/rad or m/m.
    rates: Vec<f64>,
    /// Torques of the fields, N·m or N.
    torques: Vec<f64>,
    sample: FieldSample,
    force_on_hand: Vec3,
    /// Where the hand was in the last step of [`Response::Impedance`].
    hand: Option<Vec3>,
}

/// The arm at which forces are evaluated.
pub(crate) struct ArmPlace<'a> {
    pub scene: &'a Scene,
    pub state: &'a SceneState,
    pub robot: RobotId,
    pub navigator: &'a mut SurfaceNavigator,
}

impl<'s> ArmForces<'s> {
    /// A hand that is farther away after one step was let go and took the tool elsewhere, metres: no energy passes. The
    /// speed of smaller motions is that of [`ImpedanceSettings::hand_speed_m_s`].
    ///
    /// [`ImpedanceSettings::hand_speed_m_s`]: super::ImpedanceSettings::hand_speed_m_s
    pub const REGRIP_M: f64 = 0.1;

    /// Forces of an arm in a scene; `tool` is the link of its tool, and the tool point in the frame of that link (m).
    pub fn new(
        response: Response,
        fields: Vec<ArmField>,
        (scene, robot): (&'s Scene, RobotId),
        tool: (LinkId, Vec3),
    ) -> Self {
        let chain = &scene.robots()[robot.0].robot.chain;
        Self {
            response,
            fields,
            checker: Checker::new(scene, CheckerOptions::default()),
            chain_state: ChainState::new(chain),
            tool,
            tool_columns: vec![[0.0; 6]; chain.dof()],
            point_columns: vec![[0.0; 6]; chain.dof()],
            rates: vec![0.0; chain.dof()],
            torques: vec![0.0; chain.dof()],
            sample: FieldSample::default(),
            force_on_hand: Vec3::ZERO,
            hand: None,
        }
    }

    /// The fields at the start of the last step, or after it for [`Response::Impedance`].
    pub fn sample(&self) -> &FieldSample {
        &self.sample
    }

    /// Force that the hand feels since the last step, N, world axes.
    pub fn force_on_hand(&self) -> Vec3 {
        self.force_on_hand
    }

    /// Energy that the hand and surroundings put in and that is neither stored nor given back, J. It never falls; that of
    /// [`Response::Impedance`] includes what is stored, and falls no lower than its tank allows.
    pub fn energy_j(&self) -> f64 {
        match &self.response {
            Response::Admittance(body) => body.dissipated_j(),
            Response::Impedance(port) => port.energy_j(),
        }
    }

    /// Whether the tool moves as a mass.
    pub(crate) fn is_admittance(&self) -> bool {
        matches!(self.response, Response::Admittance(_))
    }

    /// Begins a step of the virtual mass: the velocity with which the tool would move. The step takes `dt_s` seconds, of
    /// which a share goes by for the mass.
    pub(crate) fn begin(&mut self, mut place: ArmPlace<'_>, hand: Option<Vec3>, dt_s: f64, share: f64) -> Vec3 {
        let at = place.navigator.tool_in_world().translation;
        let Response::Admittance(body) = &self.response else { return Vec3::ZERO };
        let velocity = body.velocity();
        let field = self.evaluate(&mut place, velocity, dt_s);
        let Response::Admittance(body) = &mut self.response else { return Vec3::ZERO };
        body.begin(at, hand, &field, dt_s * share)
    }

    /// The velocity of a step that is not made.
    pub(crate) fn wanted_velocity(&self, place: &ArmPlace<'_>, hand: Option<Vec3>, dt_s: f64) -> Vec3 {
        // A question changes nothing: neither the mass nor the ranges.
        let Response::Admittance(body) = &self.response else { return Vec3::ZERO };
        let mut body = body.clone();
        body.begin(place.navigator.tool_in_world().translation, hand, &self.sample, dt_s)
    }

    /// Ends a step where the arm is now; false if the fields would store more energy than there is.
    pub(crate) fn end(&mut self, mut place: ArmPlace<'_>, velocity: Vec3) -> bool {
        let at = place.navigator.tool_in_world().translation;
        let potential_j = self.potential_j(&mut place);
        let Response::Admittance(body) = &mut self.response else { return true };
        let is_possible = body.end(at, velocity, potential_j);
        if is_possible {
            self.force_on_hand = body.force_on_hand(at);
        }
        is_possible
    }

    /// Ends a step of the virtual mass without motion.
    pub(crate) fn stand(&mut self) {
        if let Response::Admittance(body) = &mut self.response {
            self.force_on_hand = body.stand();
        }
    }

    /// The hand turned the tool; false if there is not the energy for it.
    pub(crate) fn turned(&mut self, mut place: ArmPlace<'_>) -> bool {
        let at = place.navigator.tool_in_world().translation;
        let potential_j = self.potential_j(&mut place);
        let Response::Admittance(body) = &mut self.response else { return true };
        body.turned(at, potential_j)
    }

    /// Stops the virtual mass.
    pub(crate) fn halt(&mut self) {
        if let Response::Admittance(body) = &mut self.response {
            body.halt();
        }
    }

    /// What the hand feels after a step in which the tool followed it as far as surfaces and the arm allow.
    pub(crate) fn feel(&mut self, mut place: ArmPlace<'_>, hand: Option<Vec3>, velocity: Vec3, dt_s: f64) {
        let at = place.navigator.tool_in_world().translation;
        let field = self.evaluate(&mut place, velocity, dt_s);
        if let Response::Impedance(port) = &mut self.response {
            if self.hand.zip(hand).is_none_or(|(before, now)| now.distance(before) > Self::REGRIP_M) {
                port.release();
            }
            self.force_on_hand =
                hand.map_or(Vec3::ZERO, |hand| port.step(at, hand, field.damped_force_n(velocity), dt_s));
            self.hand = hand;
        }
    }

    /// Evaluates the fields where the arm is, and adapts their ranges to the approach in the last `dt_s` seconds.
    fn evaluate(&mut self, place: &mut ArmPlace<'_>, velocity: Vec3, dt_s: f64) -> FieldSample {
        let chain = &place.scene.robots()[place.robot.0].robot.chain;
        self.chain_state.q.copy_from_slice(place.state.q(place.robot));
        chain.forward(&mut self.chain_state);
        chain.jacobian(&self.chain_state, self.tool.0, self.tool.1, &mut self.tool_columns);
        self.torques.fill(0.0);
        let mut sum = FieldSample::default();
        for index in 0..self.fields.len() {
            let field = self.fields[index];
            // A body that comes nearer by itself is seen as early as one twice as fast as the tool at its fastest.
            let margin_m = field.range_m.max(field.law.range_at(2.0 * place.navigator.settings().speed_m_s));
            let found = match field.pair {
                FieldPair::Surface(surface) => place.navigator.separation_from(surface, margin_m).map(|near| {
                    let away = (near.on_a - near.on_b).try_normalize().unwrap_or(Vec3::ZERO);
                    self.rates.fill(0.0);
                    self.add_rates(place, self.tool.0, near.on_a, away);
                    (near.distance, away)
                }),
                FieldPair::Scene(one, other) => nearest(&mut self.checker, place.state, (one, other), margin_m)
                    .map(|pair| (pair.metres, self.gradient(place, &pair))),
            };
            let field = &mut self.fields[index];
            let Some((distance_m, gradient)) = found else {
                (field.range_m, field.last_m) = (field.law.range_m, f64::INFINITY);
                continue;
            };
            let measured =
                if dt_s > 0.0 && field.last_m.is_finite() { (field.last_m - distance_m) / dt_s } else { 0.0 };
            field.adapt_range(distance_m, measured.max(-gradient.dot(velocity)));
            field.last_m = distance_m;
            sum.add(&field.law, field.range_m, distance_m, gradient, velocity);
            let force_n = field.law.force_n(distance_m, field.range_m);
            for (torque, rate) in self.torques.iter_mut().zip(&self.rates) {
                *torque += force_n * rate;
            }
        }
        self.sample = sum;
        sum
    }

    /// Energy of the fields where the arm is, J.
    fn potential_j(&mut self, place: &mut ArmPlace<'_>) -> f64 {
        let checker = &mut self.checker;
        let mut sum = 0.0;
        for field in &self.fields {
            let distance_m = match field.pair {
                FieldPair::Surface(surface) => {
                    place.navigator.separation_from(surface, field.range_m).map(|near| near.distance)
                }
                FieldPair::Scene(one, other) => {
                    nearest(checker, place.state, (one, other), field.range_m).map(|pair| pair.metres)
                }
            };
            sum += distance_m.map_or(0.0, |d| field.law.potential_j(d, field.range_m));
        }
        sum
    }

    /// Joint torques (N·m, or N) of the fields of the last evaluation, without dampers: each force at the nearest point of
    /// the arm, through the Jacobian there.
    pub fn joint_torques(&self) -> &[f64] {
        &self.torques
    }

    /// The change of a distance per motion of the tool point, in the world: what the arm does at the nearest point while
    /// the tool moves and keeps its orientation, by the pseudoinverse of the Jacobian.
    fn gradient(&mut self, place: &ArmPlace<'_>, pair: &PairDistance) -> Vec3 {
        self.rates.fill(0.0);
        for (geometry, own, other) in [(pair.a, pair.on_a, pair.on_b), (pair.b, pair.on_b, pair.on_a)] {
            let GeometryId::Link { robot, link } = geometry else { continue };
            if let Some(away) = (own - other).try_normalize().filter(|_| robot == place.robot) {
                self.add_rates(place, link, own, away);
            }
        }
        let base = place.scene.robots()[place.robot.0].base_in_world;
        base.transform_vector(along_tool(&self.tool_columns, &self.rates))
    }

    /// Adds the motion of a point of a link (world) along a direction, per motion of each joint.
    fn add_rates(&mut self, place: &ArmPlace<'_>, link: LinkId, point: Vec3, away: Vec3) {
        let robot = &place.scene.robots()[place.robot.0];
        let in_root = robot.base_in_world.inverse_transform_point(point);
        let in_link = self.chain_state.link_in_root(link).inverse_transform_point(in_root);
        robot.robot.chain.jacobian(&self.chain_state, link, in_link, &mut self.point_columns);
        let away = robot.base_in_world.inverse_transform_vector(away);
        for (rate, c) in self.rates.iter_mut().zip(&self.point_columns) {
            *rate += c[0] * away.x + c[1] * away.y + c[2] * away.z;
        }
    }
}

/// The nearest pair of a selection within a margin.
fn nearest(
    checker: &mut Checker<'_>,
    state: &SceneState,
    (one, other): (Selection, Selection),
    margin_m: f64,
) -> Option<PairDistance> {
    let mut nearest: Option<PairDistance> = None;
    checker.between(one, other).distances_within(state, margin_m, |pair| {
        if nearest.is_none_or(|n| pair.metres < n.metres) {
            nearest = Some(pair);
        }
    });
    nearest
}

/// The rate per motion of the tool point of what changes at `rates` per motion of the joints: the linear part of
/// (J Jᵀ)⁻¹ J · rates.
fn along_tool(columns: &[[f64; 6]], rates: &[f64]) -> Vec3 {
    let (mut matrix, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
    for (column, rate) in columns.iter().zip(rates) {
        for i in 0..6 {
            right[i] += column[i] * rate;
            for j in 0..=i {
                matrix[i][j] += column[i] * column[j];
            }
        }
    }
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] += SINGULAR;
    }
    solve_spd(matrix, right, 6).map_or(Vec3::ZERO, |x| Vec3::new(x[0], x[1], x[2]))
}
