//! A cell as the fuzzer thinks of it: small enough to be made smaller, written as the TOML that users write.

use std::fmt::Write as _;

use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind};

pub type Vector = [f64; 3];

/// A whole cell; metres, radians, seconds.
#[derive(Debug, Clone, Default)]
pub struct CellSpec {
    pub tick_ms: f64,
    pub max_s: f64,
    pub stopping_distance: bool,
    pub reaction_ms: f64,
    pub direction_aware: bool,
    pub recovery_percent: f64,
    pub robots: Vec<RobotSpec>,
    pub belts: Vec<BeltSpec>,
    pub regions: Vec<RegionSpec>,
    pub faults: Vec<InputFault>,
}

#[derive(Debug, Clone)]
pub struct RobotSpec {
    pub model: Model,
    pub at: Vector,
    pub rpy: Vector,
    pub start: Vec<f64>,
    pub tcp: Option<Vector>,
    /// Centre and size.
    pub tool_box: Option<(Vector, Vector)>,
    pub load: Option<SolidSpec>,
    pub volumes: &'static str,
    pub stop_time: f64,
    /// Of all joints alike; for models without their own.
    pub acceleration: Option<f64>,
    pub override_percent: f64,
    pub steps: Vec<StepSpec>,
}

#[derive(Debug, Clone)]
pub enum Model {
    Dh {
        rows: Vec<DhRow>,
        links: Vec<Vec<SolidSpec>>,
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
    Sphere { at: Vector, radius: f64 },
    Box { at: Vector, rpy: Vector, size: Vector },
    Capsule { from: Vector, to: Vector, radius: f64 },
    Cylinder { from: Vector, to: Vector, radius: f64 },
}

#[derive(Debug, Clone)]
pub enum StepSpec {
    Joint { to: Vec<f64>, percent: f64 },
    Linear { to: Vec<f64>, speed: f64 },
    Wait(f64),
    Override(f64),
    Switch { region: String, active: bool },
}

#[derive(Debug, Clone)]
pub struct BeltSpec {
    pub name: String,
    pub direction: Vector,
    pub speed: f64,
    pub start: f64,
}

#[derive(Debug, Clone)]
pub struct RegionSpec {
    pub name: String,
    /// The lines of shape and place.
    pub shape: String,
    pub kind: &'static str,
    pub warning: f64,
    pub guards: Vec<&'static str>,
    /// Indices of robots; empty for all.
    pub robots: Vec<usize>,
    pub temporary: bool,
    pub follow: Option<FollowSpec>,
}

#[derive(Debug, Clone)]
pub enum FollowSpec {
    Belt(String),
    Robot(usize),
}

impl CellSpec {
    /// The cell file. Faults of the input stand in comments: no cell file has them.
    pub fn to_toml(&self) -> String {
        let mut t = String::from("version = 1\nunits = { length = \"m\", angle = \"rad\" }\n");
        let _ = writeln!(t, "tick_ms = {}\nmax_s = {}\n", self.tick_ms, self.max_s);
        let _ = writeln!(
            t,
            "[monitor]\nstopping_distance = {}\nreaction_ms = {}\ndirection_aware = {}\nrecovery = {}\n",
            self.stopping_distance, self.reaction_ms, self.direction_aware, self.recovery_percent
        );
        for (i, robot) in self.robots.iter().enumerate() {
            robot.write(&mut t, i);
        }
        for b in &self.belts {
            let _ = writeln!(
                t,
                "[encoder.{}]\ndirection = {}\nspeed = {}\nstart = {}\n",
                b.name,
                list(&b.direction),
                b.speed,
                b.start
            );
        }
        for region in &self.regions {
            region.write(&mut t);
        }
        for (i, robot) in self.robots.iter().enumerate().filter(|(_, r)| !r.steps.is_empty()) {
            let _ = writeln!(t, "[program.r{i}]\noverride = {}\nsteps = [", robot.override_percent);
            robot.steps.iter().for_each(|s| s.write(&mut t));
            t.push_str("]\n\n");
        }
        self.faults.iter().for_each(|f| write_fault(&mut t, f));
        t
    }
}

impl RobotSpec {
    fn write(&self, t: &mut String, index: usize) {
        let _ = writeln!(t, "[robot.r{index}]\nbase = {{ at = {}, rpy = {} }}", list(&self.at), list(&self.rpy));
        match &self.model {
            Model::File(lines) => t.push_str(lines),
            Model::Dh { rows, links } => {
                t.push_str("dh = [\n");
                for r in rows {
                    r.write(t);
                }
                t.push_str("]\nlinks = [\n");
                for solids in links {
                    let solids: Vec<String> = solids.iter().map(SolidSpec::text).collect();
                    let _ = writeln!(t, "  [{}],", solids.join(", "));
                }
                t.push_str("]\n");
            }
        }
        let _ = writeln!(
            t,
            "start = {}\nstop_time = {}\nvolumes = \"{}\"",
            list(&self.start),
            self.stop_time,
            self.volumes
        );
        if let Some(a) = self.acceleration {
            let _ = writeln!(t, "acceleration = {a}");
        }
        if let Some(load) = &self.load {
            let _ = writeln!(t, "load = {}", load.text());
        }
        if self.tcp.is_some() || self.tool_box.is_some() {
            let _ = writeln!(t, "[robot.r{index}.tool]");
        }
        if let Some(tcp) = &self.tcp {
            let _ = writeln!(t, "tcp = {{ at = {}, rpy = [0, 0, 0] }}", list(tcp));
        }
        if let Some((at, size)) = &self.tool_box {
            let _ = writeln!(t, "box = {{ at = {}, size = {} }}", list(at), list(size));
        }
        t.push('\n');
    }
}

impl DhRow {
    fn write(&self, t: &mut String) {
        let kind = if self.slides { "prismatic" } else { "revolute" };
        let _ = writeln!(
            t,
            "  {{ kind = \"{kind}\", a = {}, alpha = {}, d = {}, theta = {}, min = {}, max = {}, speed = {}, acceleration = {} }},",
            self.a, self.alpha, self.d, self.theta, self.min, self.max, self.speed, self.acceleration
        );
    }
}

impl SolidSpec {
    fn text(&self) -> String {
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
        }
    }
}

impl StepSpec {
    fn write(&self, t: &mut String) {
        let _ = match self {
            Self::Joint { to, percent } => {
                writeln!(t, "  {{ move = \"joint\", to = {}, speed = {percent} }},", list(to))
            }
            Self::Linear { to, speed } => writeln!(t, "  {{ move = \"linear\", to = {}, speed = {speed} }},", list(to)),
            Self::Wait(s) => writeln!(t, "  {{ wait = {s} }},"),
            Self::Override(percent) => writeln!(t, "  {{ override = {percent} }},"),
            Self::Switch { region, active } => writeln!(t, "  {{ region = \"{region}\", active = {active} }},"),
        };
    }
}

impl RegionSpec {
    fn write(&self, t: &mut String) {
        let _ = writeln!(t, "[region.{}]\n{}", self.name, self.shape.trim_end());
        let guards: Vec<String> = self.guards.iter().map(|g| format!("\"{g}\"")).collect();
        let _ = writeln!(t, "kind = \"{}\"\nwarning = {}\nguards = [{}]", self.kind, self.warning, guards.join(", "));
        if self.temporary {
            t.push_str("life = \"temporary\"\n");
        }
        if !self.robots.is_empty() {
            let names: Vec<String> = self.robots.iter().map(|r| format!("\"r{r}\"")).collect();
            let _ = writeln!(t, "robots = [{}]", names.join(", "));
        }
        match &self.follow {
            Some(FollowSpec::Belt(name)) => drop(writeln!(t, "follow = {{ encoder = \"{name}\" }}")),
            Some(FollowSpec::Robot(robot)) => drop(writeln!(t, "follow = {{ robot = \"r{robot}\" }}")),
            None => {}
        }
        t.push('\n');
    }
}

/// What marks the lines of a cell file that `--replay` reads as faults.
const FAULT: &str = "# fault:";

fn write_fault(t: &mut String, f: &InputFault) {
    let InputFault { robot: RobotId(robot), from_s, to_s, kind } = f;
    let kind = match kind {
        InputFaultKind::Delayed { by_s } => format!("late {by_s}"),
        InputFaultKind::Lost { timeout_s } => format!("lost {timeout_s}"),
        InputFaultKind::Frozen => "frozen".to_owned(),
        InputFaultKind::Jump { joint, by } => format!("jump {joint} {by}"),
        InputFaultKind::NotANumber => "not_a_number".to_owned(),
    };
    let _ = writeln!(t, "{FAULT} {robot} {from_s} {to_s} {kind}");
}

/// The faults that stand in the comments of a cell file.
pub fn read_faults(text: &str) -> Result<Vec<InputFault>, String> {
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix(FAULT));
    lines
        .map(|line| read_fault(line).ok_or_else(|| format!("`{FAULT}{line}`: write `{FAULT} ROBOT FROM TO KIND …`")))
        .collect()
}

fn read_fault(line: &str) -> Option<InputFault> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words.get(i)?.parse::<f64>().ok();
    let kind = match *words.get(3)? {
        "late" => InputFaultKind::Delayed { by_s: number(4)? },
        "lost" => InputFaultKind::Lost { timeout_s: number(4)? },
        "frozen" => InputFaultKind::Frozen,
        "jump" => InputFaultKind::Jump { joint: words.get(4)?.parse().ok()?, by: number(5)? },
        "not_a_number" => InputFaultKind::NotANumber,
        _ => return None,
    };
    let robot = RobotId(words.first()?.parse().ok()?);
    Some(InputFault { robot, from_s: number(1)?, to_s: number(2)?, kind })
}

/// `[1, 2, 3]`.
pub fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    format!("[{}]", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_written_and_read() {
        let kinds = [
            InputFaultKind::Delayed { by_s: 0.01 },
            InputFaultKind::Lost { timeout_s: 0.0 },
            InputFaultKind::Frozen,
            InputFaultKind::Jump { joint: 2, by: -0.3 },
            InputFaultKind::NotANumber,
        ];
        let faults = kinds.map(|kind| InputFault { robot: RobotId(1), from_s: 0.5, to_s: 0.75, kind }).to_vec();
        let spec = CellSpec { faults: faults.clone(), ..CellSpec::default() };
        assert_eq!(read_faults(&spec.to_toml()).unwrap(), faults);
        assert!(read_faults("# fault: 0 1").is_err());
    }
}
