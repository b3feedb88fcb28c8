//! Surfaces of links and objects as triangles.

use elbowroom::cell::Cell;
use elbowroom::kinematics::LinkId;
use elbowroom::proximity::tessellate::tessellate;
use elbowroom::report::{ReportRobot, ReportScene};
use elbowroom::robot::Robot;
use elbowroom::spatial::{Pose, Vec3};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::Fault;
use crate::rows::shaped;

/// Largest distance of a curved surface of an object from its triangles, m.
const CHORD_ERROR_M: f64 = 1e-3;

/// Which of the surfaces of a robot.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// What is drawn, the collision geometry where a link has nothing else.
    Visual,
    /// What is tested.
    Collision,
}

impl Drawn {
    pub fn parse(kind: &str) -> Result<Self, Fault> {
        match kind {
            "visual" => Ok(Self::Visual),
            "collision" => Ok(Self::Collision),
            other => Err(Fault::Argument(format!("`kind` is \"{other}\"\n  write: \"visual\" or \"collision\""))),
        }
    }
}

/// Triangles in one frame.
#[derive(Default)]
struct Triangles {
    vertices: Vec<f64>,
    faces: Vec<u32>,
}

impl Triangles {
    fn add(&mut self, vertices: &[Vec3], faces: &[[u32; 3]], pose: &Pose) {
        let before = u32::try_from(self.vertices.len() / 3).unwrap_or(u32::MAX);
        self.vertices.extend(vertices.iter().flat_map(|v| pose.transform_point(*v).to_array()));
        self.faces.extend(faces.as_flattened().iter().map(|corner| corner + before));
    }

    /// A `Mesh` of the package; none of no triangles.
    fn told(self, py: Python<'_>) -> PyResult<Option<Bound<'_, PyAny>>> {
        if self.faces.is_empty() {
            return Ok(None);
        }
        let (points, corners) = (self.vertices.len() / 3, self.faces.len() / 3);
        let vertices = shaped(&PyArray1::from_vec(py, self.vertices), [points, 3])?;
        let faces = PyArray1::from_vec(py, self.faces).call_method1("reshape", (corners, 3))?;
        Ok(Some(py.import("elbowroom.results")?.getattr("Mesh")?.call1((vertices, faces))?))
    }
}

/// The surfaces of the links of a robot, each in the frame of its link.
pub fn of_links<'py>(py: Python<'py>, robot: &Robot, drawn: Drawn) -> PyResult<Bound<'py, PyDict>> {
    let mut robot = robot.clone();
    if drawn == Drawn::Collision {
        robot.visuals.clear();
    }
    let tip = robot.chain.tip();
    let scene = py.detach(|| ReportScene::new().robot("", &robot, Pose::IDENTITY, tip, Pose::IDENTITY, &[]));
    let meshes = PyDict::new(py);
    for robot in &scene.robots {
        add_links(robot, "", &meshes)?;
    }
    Ok(meshes)
}

/// Adds the links of a robot, with its tool.
fn add_links(robot: &ReportRobot, prefix: &str, meshes: &Bound<'_, PyDict>) -> PyResult<()> {
    for (index, (name, link)) in robot.chain.links().iter().zip(&robot.link_meshes).enumerate() {
        let tool = if robot.flange == LinkId(index) { &robot.tool[..] } else { &[] };
        let mut triangles = Triangles::default();
        for part in link.iter().chain(tool) {
            triangles.add(&part.vertices, &part.triangles, &part.in_link);
        }
        if let Some(mesh) = triangles.told(meshes.py())? {
            meshes.set_item(format!("{prefix}{name}"), mesh)?;
        }
    }
    Ok(())
}

/// What the pages of a cell show: links with tools and loads as `robot/link`, in the frame of the link, and objects in their own.
pub fn of_cell<'py>(py: Python<'py>, cell: &Cell) -> PyResult<Bound<'py, PyDict>> {
    let scene = py.detach(|| ReportScene::of_cell(cell));
    let meshes = PyDict::new(py);
    for robot in &scene.robots {
        add_links(robot, &format!("{}/", robot.name), &meshes)?;
    }
    for object in &scene.objects {
        let (vertices, faces) = tessellate(&object.shape, CHORD_ERROR_M);
        let mut triangles = Triangles::default();
        triangles.add(&vertices, &faces, &Pose::IDENTITY);
        if let Some(mesh) = triangles.told(py)? {
            meshes.set_item(&object.name, mesh)?;
        }
    }
    Ok(meshes)
}
