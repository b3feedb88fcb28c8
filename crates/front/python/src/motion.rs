//! Trajectories, which are objects of `elbowroom.trajectory`.

use elbowroom::cell::Cell;
use elbowroom::kinematics::{JointLimits, JointTrajectory, TrajectoryRow};
use elbowroom::planner::BlendedPath;
use elbowroom::robot::RobotId;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::arrays::{Rows, vector};
use crate::error::Fault;
use crate::places::robot_named;
use crate::rows::shaped;

/// The motions of robots: a mapping from their names.
pub fn motions_of(cell: &Cell, motions: &Bound<'_, PyAny>) -> Result<Vec<(RobotId, JointTrajectory)>, Fault> {
    let Ok(motions) = motions.cast::<PyMapping>() else {
        let class = motions.get_type().name().map(|n| n.to_string()).unwrap_or_default();
        return Err(Fault::Argument(format!("`motions` is a {class}\n  write: {{\"robot\": trajectory}}")));
    };
    let motion = |item: Bound<'_, PyAny>| {
        let (name, trajectory): (String, Bound<'_, PyAny>) = item.extract()?;
        let id = robot_named(cell, &name)?;
        let joints = cell.robots[id.0].joint_names();
        let Ok(ordered) = trajectory.getattr("ordered") else {
            let class = trajectory.get_type().name().map(|n| n.to_string()).unwrap_or_default();
            return Err(Fault::Argument(format!("the motion of \"{name}\" is a {class}\n  write: a Trajectory")));
        };
        let trajectory = ordered.call1((joints.clone(),))?;
        let times_s: Vec<f64> = trajectory.getattr("times_s")?.extract()?;
        let q = Rows::of(&trajectory.getattr("q")?, "q", &joints)?.all()?;
        let rows = times_s.iter().zip(q.chunks_exact(joints.len().max(1)));
        let rows = rows.map(|(t_s, q)| TrajectoryRow { t_s: *t_s, q: q.to_vec() });
        Ok((id, JointTrajectory::new(rows.collect())))
    };
    motions.items()?.iter().map(motion).collect()
}

/// Find the fastest motion along a path.
///
/// Returns
/// -------
/// tuple
///     The times, and the states at them, `(N, dof)`.
#[pyfunction]
pub fn time_optimal<'py>(
    waypoints: &Bound<'py, PyAny>,
    joints: Vec<String>,
    limits: [Bound<'py, PyAny>; 3],
    blend: f64,
    period_s: f64,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let py = waypoints.py();
    let values = Rows::of(waypoints, "waypoints", &joints)?.all()?;
    let waypoints: Vec<Vec<f64>> = values.chunks_exact(joints.len().max(1)).map(<[f64]>::to_vec).collect();
    let [velocity, acceleration, jerk] = &limits;
    let rates = [(velocity, "velocity"), (acceleration, "acceleration"), (jerk, "jerk")];
    let [velocity, acceleration, jerk] = rates.map(|(value, name)| vector(value, name, &joints));
    let rates = velocity?.into_iter().zip(acceleration?).zip(jerk?);
    let limits: Vec<JointLimits> = rates.map(|((v, a), j)| JointLimits::new(v, a, j)).collect();
    let rows = py.detach(|| {
        let path = BlendedPath::new(&waypoints, |corner| corner.distance() <= blend)?;
        path.time_optimal(&limits)?.aligned_to_ticks(period_s)?.samples(period_s)
    });
    let rows = rows.map_err(|e| Fault::Argument(format!("the motion: {e}")))?;
    let rows = rows.rows();
    let times = PyArray1::from_vec(py, rows.iter().map(|row| row.t_s).collect());
    let q = PyArray1::from_vec(py, rows.iter().flat_map(|row| row.q.iter().copied()).collect());
    Ok((times.into_any(), shaped(&q, [rows.len(), joints.len()])?.into_any()))
}
