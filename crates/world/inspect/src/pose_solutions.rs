//! Inverse kinematics as a question to a model: all joint values with which a link is at a pose.

use std::fmt;

use elbowroom_kinematics::inverse::{IkMethod, IkOptions, IkSolver};
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Pose;
use serde::Serialize;

use crate::text::shortened;

/// The joint values with which a link is at a pose.
#[derive(Debug, Clone, Serialize)]
pub struct PoseSolutions {
    /// The link.
    pub link: String,
    /// The wanted pose of its frame in the root link: x, y, z (m), roll, pitch, yaw (rad).
    pub pose: [f64; 6],
    /// `closed_form` for six axes with a spherical wrist: `solutions` has every branch within the limits. `numeric`
    /// otherwise: those that a search from 100 starts found, at most 16.
    pub method: &'static str,
    /// The independent joints of the chain, in the order of the values.
    pub joints: Vec<String>,
    /// The solutions within the joint limits, the one nearest to rest first; every joint that could turn on by full turns is
    /// as near to rest as its limits allow.
    pub solutions: Vec<PoseSolution>,
    /// Why there are none.
    pub why_none: Option<String>,
    #[serde(skip)]
    is_turned: Vec<bool>,
}

/// One of these.
#[derive(Debug, Clone, Serialize)]
pub struct PoseSolution {
    /// Values of the independent joints, rad or m.
    pub q: Vec<f64>,
    /// Shoulder, elbow and wrist, such as `front up no_flip`; null without a spherical wrist.
    pub configuration: Option<String>,
    /// Distance of the link from the pose, m.
    pub position_error_m: f64,
    /// Angle between them, rad.
    pub angle_error_rad: f64,
}

impl PoseSolutions {
    pub(crate) fn of(chain: &Chain, link: LinkId, pose: [f64; 6]) -> Self {
        let [x, y, z, roll, pitch, yaw] = pose;
        let target = Pose::from_xyz_rpy([x, y, z], [roll, pitch, yaw]);
        let mut solver = IkSolver::new(chain, link, Pose::IDENTITY, IkOptions::default());
        let mut state = ChainState::at_rest(chain);
        let rest = state.q.clone();
        let mut found = solver.solve_all(&target, &rest);
        let mut why_none = None;
        if found.is_empty() {
            match solver.solve(&target, &rest) {
                Ok(solution) => found.push(solution.q),
                Err(e) => why_none = Some(e),
            }
        }
        let solutions = found.into_iter().map(|q| {
            state.q.copy_from_slice(&q);
            chain.forward(&mut state);
            let there = state.link_in_root(link);
            PoseSolution {
                configuration: solver.configuration(&q).map(|c| c.to_string()),
                position_error_m: there.translation.distance(target.translation),
                angle_error_rad: (there.rotation.inverse() * target.rotation).angle(),
                q,
            }
        });
        let solutions = solutions.collect();
        let joints = || chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
        Self {
            link: chain.links()[link.0].clone(),
            pose,
            method: match solver.method() {
                IkMethod::SphericalWrist => "closed_form",
                IkMethod::Numeric => "numeric",
            },
            joints: joints().map(|j| j.name.clone()).collect(),
            solutions,
            why_none: why_none.map(|e| e.to_string()),
            is_turned: joints().map(|j| j.kind.turns()).collect(),
        }
    }
}

impl fmt::Display for PoseSolutions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z, roll, pitch, yaw] = self.pose;
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
        let count = self.solutions.len();
        let kind = match (self.method, count) {
            (_, 0) => String::new(),
            ("closed_form", _) => ", all branches within the limits".to_owned(),
            _ => ", found by search; there may be more".to_owned(),
        };
        let plural = if count == 1 { "" } else { "s" };
        writeln!(
            f,
            "{} at {x:.4}, {y:.4}, {z:.4} m, roll {roll:.2}, pitch {pitch:.2}, yaw {yaw:.2} deg: {count} solution{plural}{kind}",
            self.link
        )?;
        if let Some(why) = &self.why_none {
            return writeln!(f, "  {why}");
        }
        write!(f, "\n{:22}", "Configuration (deg, m)")?;
        self.joints.iter().try_for_each(|joint| write!(f, " {:>10}", shortened(joint, 10)))?;
        writeln!(f, "   off (m, rad)")?;
        for solution in &self.solutions {
            write!(f, "{:22}", solution.configuration.as_deref().unwrap_or("-"))?;
            for (value, turns) in solution.q.iter().zip(&self.is_turned) {
                // Adding 0 removes the sign of -0.000.
                let value = if *turns { value.to_degrees() } else { *value };
                write!(f, " {:>10.3}", (value * 1000.0).round() / 1000.0 + 0.0)?;
            }
            writeln!(f, "   {:.0e} {:.0e}", solution.position_error_m, solution.angle_error_rad)?;
        }
        Ok(())
    }
}
