//! Robots, their hands and programs.

use std::fmt::Write as _;

use super::recording::RecordingSpec;
use super::text::{Vector, list};

#[derive(Debug, Clone)]
pub struct RobotSpec {
    pub model: Model,
    pub at: Vector,
    pub rpy: Vector,
    pub start: Vec<f64>,
    pub hand: HandSpec,
    pub volumes: &'static str,
    pub stop_time: f64,
    /// Acceleration of all joints, for models without their own.
    pub acceleration: Option<f64>,
    /// Tolerated overshoot of the joint limits, if it is stated.
    pub overshoot: Option<f64>,
    pub program: ProgramSpec,
    /// Names of the objects that it evades; empty for a robot without avoidance.
    pub evades: Vec<String>,
    pub is_mechanism: bool,
    /// Further lines of its table.
    pub keys: Vec<String>,
    /// Whether it starts in a state that has a name.
    pub starts_at_home: bool,
}

/// Parts at the flange: one tool and a load, or several tools.
#[derive(Debug, Clone, Default)]
pub struct HandSpec {
    pub tcp: Option<Vector>,
    /// Centre and size.
    pub tool_box: Option<(Vector, Vector)>,
    /// Place and turn of the mesh of a corner, in place of the box.
    pub tool_mesh: Option<(Vector, Vector)>,
    pub load: Option<SolidSpec>,
    pub tools: Vec<ToolSpec>,
}

/// A named tool.
#[derive(Debug, Clone)]
pub struct ToolSpec {
    pub name: String,
    pub tcp: Vector,
    /// Centre and size.
    pub solid: Option<(Vector, Vector)>,
    pub mounted: bool,
    /// The link that carries it, if it is not the robot's flange.
    pub flange: Option<String>,
}

/// Steps, or a recording.
#[derive(Debug, Clone)]
pub struct ProgramSpec {
    pub override_percent: f64,
    pub repeat: u32,
    pub steps: Vec<StepSpec>,
    /// Recording that replaces the steps.
    pub recording: Option<RecordingSpec>,
}

#[derive(Debug, Clone)]
pub enum Model {
    Dh {
        rows: Vec<DhRow>,
        links: Vec<Vec<SolidSpec>>,
        /// Whether its joints have names of their own.
        has_names: bool,
    },
    /// Lines of the robot's table that name the model.
    File(String),
}

#[derive(Debug, Clone, Copy)]
pub struct DhRow {
    pub slides: bool,
    pub a: f64,
    pub alpha: f64,
    pub d: f64,
    pub theta: f64,
    pub min: f64,
    pub max: f64,
    pub speed: f64,
    pub acceleration: f64,
}

#[derive(Debug, Clone, Copy)]
pub enum SolidSpec {
    Sphere {
        at: Vector,
        radius: f64,
    },
    Box {
        at: Vector,
        rpy: Vector,
        size: Vector,
    },
    Capsule {
        from: Vector,
        to: Vector,
        radius: f64,
    },
    Cylinder {
        from: Vector,
        to: Vector,
        radius: f64,
    },
    /// The mesh of a corner, whose numbers are in this unit.
    Mesh {
        at: Vector,
        rpy: Vector,
        unit: &'static str,
    },
}

/// An axis of the tool that keeps its direction.
#[derive(Debug, Clone, Copy)]
pub struct KeepSpec {
    pub axis: Vector,
    pub within: f64,
}

/// A pose of the tool centre point in the world.
#[derive(Debug, Clone)]
pub struct GoalSpec {
    pub at: Vector,
    pub rpy: Vector,
    /// Further keys, such as `near = […]`.
    pub choice: String,
}

#[derive(Debug, Clone)]
pub enum StepSpec {
    Joint {
        to: Vec<f64>,
        percent: f64,
    },
    Linear {
        to: Vec<f64>,
        speed: f64,
    },
    /// A move to a pose of the tool centre point, which it has at these joint values.
    Pose {
        to: Vec<f64>,
        goal: GoalSpec,
    },
    Planned {
        to: Vec<f64>,
        percent: f64,
        on_map: bool,
        keep: Option<KeepSpec>,
    },
    Wait(f64),
    Override(f64),
    Switch {
        region: String,
        active: bool,
    },
    Tool(String),
    Grip(String),
    Release(String),
}

impl RobotSpec {
    /// Names of the joints of a robot that is written in rows; other models have them in their files.
    pub fn joint_names(&self) -> Vec<String> {
        let Model::Dh { rows, has_names, .. } = &self.model else { return Vec::new() };
        let name = |j: usize| if *has_names { format!("axis {j}") } else { format!("joint_{}", j + 1) };
        (0..rows.len()).map(name).collect()
    }

    pub(super) fn write(&self, t: &mut String, index: usize) {
        let _ = writeln!(t, "[robot.r{index}]\nbase = {{ at = {}, rpy = {} }}", list(&self.at), list(&self.rpy));
        match &self.model {
            Model::File(lines) => t.push_str(lines),
            Model::Dh { rows, links, has_names } => {
                t.push_str("dh = [\n");
                for (i, r) in rows.iter().enumerate() {
                    let name = if *has_names { format!("name = \"axis {i}\", ") } else { String::new() };
                    r.write(t, &name);
                }
                t.push_str("]\nlinks = [\n");
                for solids in links {
                    let solids: Vec<String> = solids.iter().map(SolidSpec::text).collect();
                    let _ = writeln!(t, "  [{}],", solids.join(", "));
                }
                t.push_str("]\n");
            }
        }
        // A recording begins at its first row.
        if self.program.recording.is_none() {
            let start = list(&self.start);
            let _ = if self.starts_at_home {
                writeln!(t, "states = {{ home = {start} }}\nstart = \"home\"")
            } else {
                writeln!(t, "start = {start}")
            };
        }
        self.keys.iter().for_each(|key| t.extend([key, "\n"]));
        if self.is_mechanism {
            t.push_str("kind = \"mechanism\"\n\n");
            return;
        }
        let _ = writeln!(t, "stop_time = {}\nvolumes = \"{}\"", self.stop_time, self.volumes);
        if let Some(a) = self.acceleration {
            let _ = writeln!(t, "acceleration = {a}");
        }
        if let Some(overshoot) = self.overshoot {
            let _ = writeln!(t, "overshoot = {overshoot}");
        }
        self.hand.write(t, index);
        t.push('\n');
    }
}

impl HandSpec {
    fn write(&self, t: &mut String, index: usize) {
        if let Some(load) = &self.load {
            let _ = writeln!(t, "load = {}", load.text());
        }
        if self.tcp.is_some() || self.tool_box.is_some() || self.tool_mesh.is_some() {
            let _ = writeln!(t, "[robot.r{index}.tool]");
        }
        if let Some(tcp) = &self.tcp {
            let _ = writeln!(t, "tcp = {{ at = {}, rpy = [0, 0, 0] }}", list(tcp));
        }
        if let Some((at, size)) = &self.tool_box {
            let _ = writeln!(t, "box = {{ at = {}, size = {} }}", list(at), list(size));
        } else if let Some((at, rpy)) = &self.tool_mesh {
            let place = format!("at = {}\nrpy = {}", list(at), list(rpy));
            let _ = writeln!(t, "mesh = \"corner.obj\"\nmesh_unit = \"m\"\n{place}");
        }
        for tool in &self.tools {
            let _ = writeln!(t, "[robot.r{index}.tools.{}]\ntcp = {{ at = {} }}", tool.name, list(&tool.tcp));
            if let Some((at, size)) = &tool.solid {
                let _ = writeln!(t, "box = {{ at = {}, size = {} }}", list(at), list(size));
            }
            if !tool.mounted {
                t.push_str("mounted = false\n");
            }
            if let Some(flange) = &tool.flange {
                let _ = writeln!(t, "flange = \"{flange}\"");
            }
        }
    }
}

impl ProgramSpec {
    /// Creates a program of steps that run once.
    pub fn of_steps(override_percent: f64, steps: Vec<StepSpec>) -> Self {
        Self { override_percent, repeat: 1, steps, recording: None }
    }

    pub(super) fn write(&self, t: &mut String, index: usize) {
        if self.steps.is_empty() && self.recording.is_none() {
            return;
        }
        let _ = writeln!(t, "[program.r{index}]\noverride = {}", self.override_percent);
        if self.repeat > 1 {
            let _ = writeln!(t, "repeat = {}", self.repeat);
        }
        if let Some(recording) = &self.recording {
            let _ = writeln!(t, "trajectory = {}\n", recording.value());
            return;
        }
        t.push_str("steps = [\n");
        self.steps.iter().for_each(|s| s.write(t));
        t.push_str("]\n\n");
    }
}

impl DhRow {
    fn write(&self, t: &mut String, name: &str) {
        let kind = if self.slides { "prismatic" } else { "revolute" };
        let _ = writeln!(
            t,
            "  {{ {name}kind = \"{kind}\", a = {}, alpha = {}, d = {}, theta = {}, min = {}, max = {}, speed = {}, acceleration = {} }},",
            self.a, self.alpha, self.d, self.theta, self.min, self.max, self.speed, self.acceleration
        );
    }
}

impl SolidSpec {
    /// The solid as a table in one line.
    pub fn text(&self) -> String {
        match self {
            Self::Sphere { at, radius } => format!("{{ sphere = {{ at = {}, radius = {radius} }} }}", list(at)),
            Self::Box { at, rpy, size } => {
                format!("{{ box = {{ at = {}, rpy = {}, size = {} }} }}", list(at), list(rpy), list(size))
            }
            Self::Capsule { from, to, radius } => {
                format!("{{ capsule = {{ from = {}, to = {}, radius = {radius} }} }}", list(from), list(to))
            }
            Self::Cylinder { from, to, radius } => {
                format!("{{ cylinder = {{ from = {}, to = {}, radius = {radius} }} }}", list(from), list(to))
            }
            Self::Mesh { at, rpy, unit } => {
                let place = format!("at = {}, rpy = {}", list(at), list(rpy));
                format!("{{ mesh = {{ file = \"corner.obj\", {place}, mesh_unit = \"{unit}\" }} }}")
            }
        }
    }
}

impl StepSpec {
    /// The joint values at the end of a move.
    pub fn target(&self) -> Option<&Vec<f64>> {
        match self {
            Self::Joint { to, .. } | Self::Linear { to, .. } | Self::Planned { to, .. } | Self::Pose { to, .. } => {
                Some(to)
            }
            _ => None,
        }
    }

    fn write(&self, t: &mut String) {
        let _ = match self {
            Self::Joint { to, percent } => {
                writeln!(t, "  {{ move = \"joint\", to = {}, speed = {percent} }},", list(to))
            }
            Self::Linear { to, speed } => writeln!(t, "  {{ move = \"linear\", to = {}, speed = {speed} }},", list(to)),
            Self::Pose { goal: GoalSpec { at, rpy, choice }, .. } => {
                let place = format!("at = {}, rpy = {}", list(at), list(rpy));
                writeln!(t, "  {{ move = \"joint\", to = {{ {place}{choice} }} }},")
            }
            Self::Planned { to, percent, on_map, keep } => {
                let planner = if *on_map { "grid" } else { "rrt-connect" };
                let to = list(to);
                let keep = keep.map(|KeepSpec { axis, within }| {
                    format!(", keep = {{ axis = {}, within = {within} }}", list(&axis))
                });
                let keep = keep.unwrap_or_default();
                writeln!(t, "  {{ move = \"planned\", to = {to}, speed = {percent}, planner = \"{planner}\"{keep} }},")
            }
            Self::Wait(s) => writeln!(t, "  {{ wait = {s} }},"),
            Self::Override(percent) => writeln!(t, "  {{ override = {percent} }},"),
            Self::Tool(name) => writeln!(t, "  {{ tool = \"{name}\" }},"),
            Self::Grip(name) => writeln!(t, "  {{ grip = \"{name}\" }},"),
            Self::Release(name) => writeln!(t, "  {{ release = \"{name}\" }},"),
            Self::Switch { region, active } => writeln!(t, "  {{ region = \"{region}\", active = {active} }},"),
        };
    }
}
