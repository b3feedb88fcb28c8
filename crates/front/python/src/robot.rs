//! Robots.

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom::formats::robot::{self as files, LoadOptions};
use elbowroom::formats::suggest;
use elbowroom::kinematics::inverse::{IkOptions, IkSolver};
use elbowroom::kinematics::{Chain, ChainState, LinkId};
use elbowroom::robot::Robot as Model;
use elbowroom::spatial::units::LengthUnit;
use elbowroom::spatial::{Pose, Rotation, Vec3};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::arrays::{Rows, vector};
use crate::error::Fault;
use crate::matrix::values;
use crate::mesh::{self, Drawn};
use crate::page;
use crate::rows::{map_rows, shaped};

/// A robot: links, joints and solids of a file.
///
/// Joint values are `(N, dof)` arrays of float64 in the order of `joints`, radians or metres; a row is a state. Joints that
/// follow another one have no value. The root link is the world.
///
/// Examples
/// --------
/// >>> import numpy as np, elbowroom as er
/// >>> robot = er.Robot.load("examples/models/rx60b/rx60b.urdf")
/// >>> robot.dof, robot.tip
/// (6, 'tool0')
/// >>> robot.fk(np.zeros((1, 6)))[0, :3, 3].round(3).tolist()
/// [0.0, 0.049, 1.006]
#[pyclass(module = "elbowroom", frozen, weakref)]
pub struct Robot {
    pub(crate) model: Arc<Model>,
    path: PathBuf,
    files: Files,
    warnings: Vec<String>,
    joint_names: Vec<String>,
}

/// The files of a robot from the root of the file system: when it is pickled the present folder may be another.
struct Files {
    model: PathBuf,
    srdf: Option<PathBuf>,
    unit: Option<String>,
    joints: Option<PathBuf>,
}

impl Robot {
    fn chain(&self) -> &Chain {
        &self.model.chain
    }

    /// The file, for messages.
    pub(crate) fn path(&self) -> &PathBuf {
        &self.path
    }

    fn link(&self, name: Option<&str>) -> Result<LinkId, Fault> {
        let Some(name) = name else { return Ok(self.chain().tip()) };
        self.chain().link(name).ok_or_else(|| {
            let known = self.chain().links().iter().map(String::as_str);
            Fault::Argument(format!("the robot has no link \"{name}\"\n  write: {}", suggest::hint(name, known)))
        })
    }
}

/// The names of the joints that have a value, in their order.
pub fn joint_names(chain: &Chain) -> Vec<String> {
    chain.active_joints().iter().map(|id| chain.joints()[id.0].name.clone()).collect()
}

/// Reads a file of `path`, and its options.
fn read(path: PathBuf, srdf: Option<PathBuf>, unit: Option<String>, joints: Option<PathBuf>) -> Result<Robot, Fault> {
    let known = unit.as_deref().map(|symbol| {
        LengthUnit::parse(symbol)
            .ok_or_else(|| Fault::Argument(format!("`{symbol}` is no unit of length\n  write: m, cm, mm or in")))
    });
    let options =
        LoadOptions { srdf: srdf.clone(), unit: known.transpose()?, joints: joints.clone(), ..LoadOptions::default() };
    let loaded = files::load(&path, &options)?;
    let absolute = |file: &PathBuf| std::path::absolute(file).unwrap_or_else(|_| file.clone());
    let files = Files {
        model: absolute(&path),
        srdf: srdf.as_ref().map(absolute),
        unit,
        joints: joints.as_ref().map(absolute),
    };
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    let joint_names = joint_names(&loaded.robot.chain);
    Ok(Robot { model: Arc::new(loaded.robot), path, files, warnings, joint_names })
}

#[pymethods]
impl Robot {
    /// Load a robot.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     A URDF, 3DS, GLB, glTF or VRML file.
    /// srdf
    ///     An SRDF: pairs of links that it disables are not tested.
    /// unit
    ///     `"m"`, `"cm"`, `"mm"` or `"in"`: of a 3DS model, and of meshes whose format states none.
    /// joints
    ///     The file with the joints of a 3DS, glTF or VRML model; default: `MODEL.joints.toml` beside it.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With file, line, and what to write instead.
    #[staticmethod]
    #[pyo3(signature = (path, srdf=None, *, unit=None, joints=None))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        srdf: Option<PathBuf>,
        unit: Option<String>,
        joints: Option<PathBuf>,
    ) -> PyResult<Self> {
        Ok(py.detach(|| read(path, srdf, unit, joints))?)
    }

    /// Return the robot of another package.
    ///
    /// It is written to a folder of temporary files, which exists as long as the robot does; a pickle does not outlast it. A scene that
    /// is saved has a copy.
    ///
    /// Parameters
    /// ----------
    /// model
    ///     A `yourdfpy.URDF`; a `pinocchio.Model` with joints that turn or slide, whose order they keep; or a `pinocchio.RobotWrapper`.
    ///     Bodies become links, other frames do not; `tip` is the end of the longest chain.
    /// geometry
    ///     The `pinocchio.GeometryModel` with the solids of a `pinocchio.Model`, which are tested and drawn. Pairs that it does not
    ///     compare are not tested; without any pair all are tested. Neighbours, with at most one joint between them, are never a pair
    ///     here, so it is an error if they are compared.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     If the model is of another class, or has a joint or a solid that this package does not know.
    #[staticmethod]
    #[pyo3(signature = (model, geometry=None))]
    fn of<'py>(model: &Bound<'py, PyAny>, geometry: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        model.py().import("elbowroom.interop")?.getattr("robot_of")?.call1((model, geometry))
    }

    /// The name of the robot in its file.
    #[getter]
    fn name(&self) -> &str {
        self.chain().name()
    }

    /// The names of the joints that have a value, in their order.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.joint_names.clone()
    }

    /// The names of all links.
    #[getter]
    fn links(&self) -> Vec<String> {
        self.chain().links().to_vec()
    }

    /// The link at the end of the longest chain.
    #[getter]
    fn tip(&self) -> &str {
        &self.chain().links()[self.chain().tip().0]
    }

    /// The number of joint values.
    #[getter]
    fn dof(&self) -> usize {
        self.chain().dof()
    }

    /// Remarks about the files.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The limits of the joints, `(dof, 2)`: lower and upper, rad or m; infinite without a limit.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let each = self.chain().lower().into_iter().zip(self.chain().upper());
        let values: Vec<f64> = each.flat_map(|(lower, upper)| [lower, upper]).collect();
        shaped(&PyArray1::from_vec(py, values), [self.chain().dof(), 2])
    }

    /// Compute the pose of a link.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values.
    /// link
    ///     The link; default: `tip`.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(N, 4, 4)`: the frame of the link in the root link, metres.
    #[pyo3(signature = (q, link=None))]
    fn fk<'py>(&self, q: &Bound<'py, PyAny>, link: Option<&str>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (rows, link) = (Rows::of(q, "q", &self.joint_names)?, self.link(link)?);
        let chain = self.chain();
        let poses = map_rows(
            q.py(),
            &rows,
            16,
            || ChainState::new(chain),
            |state, q, out| {
                state.q.copy_from_slice(q);
                chain.forward(state);
                out.copy_from_slice(&values(&state.link_in_root(link)));
            },
        )?;
        shaped(&poses, [rows.len(), 4, 4])
    }

    /// Compute the geometric Jacobian of a point.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values.
    /// link
    ///     The link; default: `tip`.
    /// point
    ///     The point in the frame of the link, metres; default: its origin.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(N, 6, dof)`: velocity of the point (three rows, m) and angular velocity of the link (three rows, rad) per unit of joint
    ///     velocity, in the root link.
    #[pyo3(signature = (q, link=None, point=None))]
    fn jacobian<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        link: Option<&str>,
        point: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (rows, link) = (Rows::of(q, "q", &self.joint_names)?, self.link(link)?);
        let axes = || ["x", "y", "z"].map(String::from);
        let point = point.map_or(Ok(vec![0.0; 3]), |point| vector(point, "point", &axes()))?;
        let (chain, point) = (self.chain(), Vec3::new(point[0], point[1], point[2]));
        let dof = chain.dof();
        let worker = || (ChainState::new(chain), vec![[0.0; 6]; dof]);
        let values = map_rows(q.py(), &rows, 6 * dof, worker, |(state, columns), q, out| {
            state.q.copy_from_slice(q);
            chain.forward(state);
            chain.jacobian(state, link, point, columns);
            for (joint, column) in columns.iter().enumerate() {
                for (row, value) in column.iter().enumerate() {
                    out[row * dof + joint] = *value;
                }
            }
        })?;
        shaped(&values, [rows.len(), 6, dof])
    }

    /// Compute all joint values with which a link is at a pose.
    ///
    /// Parameters
    /// ----------
    /// pose
    ///     The frame of the link in the root link, metres: a 4x4 array, `(xyz, quaternion xyzw)`, or `(xyz, rotation)` with a
    ///     `scipy.spatial.transform.Rotation`.
    /// link
    ///     The link; default: `tip`.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(K, dof)`: with six axes and a spherical wrist every branch within the limits; otherwise those that a search from 100
    ///     starts finds, at most 16. Empty if there is none.
    #[pyo3(signature = (pose, link=None))]
    fn ik<'py>(&self, pose: &Bound<'py, PyAny>, link: Option<&str>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = pose.py();
        let (target, link) = (pose_of(pose)?, self.link(link)?);
        let solutions = py.detach(|| {
            let mut solver = IkSolver::new(self.chain(), link, Pose::IDENTITY, IkOptions::default());
            solver.solve_all(&target, &ChainState::at_rest(self.chain()).q)
        });
        let flat: Vec<f64> = solutions.iter().flatten().copied().collect();
        let shape = [solutions.len(), self.chain().dof()];
        shaped(&PyArray1::from_vec(py, flat), shape)
    }

    /// The surfaces of the links.
    ///
    /// Parameters
    /// ----------
    /// kind
    ///     `"visual"`: what is drawn, the collision geometry where a link has nothing else; or `"collision"`. Curved surfaces are
    ///     triangles within 1 mm.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Per link that has a surface its `Mesh`, in the frame of the link.
    #[pyo3(signature = (kind="visual"))]
    fn meshes<'py>(&self, py: Python<'py>, kind: &str) -> PyResult<Bound<'py, PyAny>> {
        Ok(mesh::of_links(py, &self.model, Drawn::parse(kind)?)?.into_any())
    }

    /// Return the robot as a `trimesh.Scene`, with a node per link.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(dof,)` joint values; default: zeros, or the nearest values within the limits.
    /// kind
    ///     As for `meshes`.
    #[pyo3(signature = (q=None, kind="visual"))]
    fn to_trimesh<'py>(
        slf: &Bound<'py, Self>,
        q: Option<&Bound<'py, PyAny>>,
        kind: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("elbowroom.interop")?.getattr("trimesh_of_robot")?.call1((slf, q, kind))
    }

    /// The robot as an HTML page that needs no network: in 3-D, with a slider per joint and the boxes of its resolution levels.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| page::of_robot(&self.model))?)
    }

    fn _repr_html_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("elbowroom.pages")?.getattr("frame")?.call1((self.page(py)?,))
    }

    fn __repr__(&self) -> String {
        let (name, joints, links) = (self.name(), self.dof(), self.chain().links().len());
        format!("Robot({name:?}: {joints} joints, {links} links)")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Files { model, srdf, unit, joints } = &self.files;
        let files = (model, srdf, unit, joints);
        py.import("elbowroom.pickles")?.getattr("reduced_robot")?.call1((files,))
    }
}

/// A pose from a 4×4 array, `(xyz, quaternion xyzw)`, or an object with `as_matrix`; the package checks it.
pub fn pose_of(pose: &Bound<'_, PyAny>) -> Result<Pose, Fault> {
    let rows: [[f64; 4]; 4] = pose.py().import("elbowroom.poses")?.getattr("matrix")?.call1((pose,))?.extract()?;
    let column = |i: usize| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
    let rotation = Rotation::from_columns(column(0), column(1), column(2));
    let rotation = rotation
        .ok_or_else(|| Fault::Array("`pose` is not a rigid motion\n  write: a rotation and a translation".into()))?;
    Ok(Pose::new(rotation, column(3)))
}
