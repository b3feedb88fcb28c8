//! Smaller cells, each with one thing less.

use elbowroom_robot::RobotId;

use crate::fuzz_cells::spec::{
    CellSpec, Extras, FollowSpec, GuidanceSpec, Model, MotionSpec, ObjectSpec, ProgramSpec, RecordingSpec, RobotSpec,
    SensorSpec, StepSpec, Turns,
};

/// Least number of rows of a recording.
const LEAST_ROWS: usize = 2;

/// Collects candidates: the cell with one change each.
struct Candidates<'s> {
    spec: &'s CellSpec,
    list: Vec<CellSpec>,
}

impl Candidates<'_> {
    fn push(&mut self, change: impl Fn(&mut CellSpec)) {
        let mut changed = self.spec.clone();
        change(&mut changed);
        self.list.push(changed);
    }
}

/// Returns every cell that has one thing less, the largest things first.
pub fn candidates(spec: &CellSpec) -> Vec<CellSpec> {
    let mut list = Candidates { spec, list: Vec::new() };
    fewer_extras(&mut list, &spec.extras);
    // The first robot is the one that is guided; all of them carry a bar.
    let least = spec.guidance.as_ref().map_or(0, |g| if g.virtual_robot.is_empty() { 1 } else { spec.robots.len() });
    for i in (least..spec.robots.len()).rev().filter(|_| spec.robots.len() > 1) {
        list.push(|c| remove_robot(c, i));
    }
    for i in 0..spec.regions.len() {
        list.push(|c| remove_region(c, i));
    }
    for i in 0..spec.grids.len() {
        list.push(|c| drop(c.grids.remove(i)));
    }
    simpler_sensors(&mut list, &spec.extras.sensors);
    for (i, object) in spec.objects.iter().enumerate() {
        without_object(&mut list, i, object);
    }
    if let Some(guidance) = &spec.guidance {
        shorter_guidance(&mut list, guidance);
    }
    for i in 0..spec.faults.len() {
        list.push(|c| c.faults.retain(|f| *f != spec.faults[i]));
    }
    if spec.repeat > 1 {
        list.push(|c| c.repeat = 1);
    }
    for (r, robot) in spec.robots.iter().enumerate() {
        shorter_program(&mut list, r, &robot.program);
        emptier_robot(&mut list, r, robot);
    }
    if spec.direction_aware {
        list.push(|c| c.direction_aware = false);
    }
    if spec.reaction_ms > 0.0 {
        list.push(|c| c.reaction_ms = 0.0);
    }
    list.list
}

/// Adds the cell without each of its extras. The head comes first: it may have the checksum of the larger cell.
fn fewer_extras(list: &mut Candidates<'_>, extras: &Extras) {
    for i in 0..extras.head.len() {
        list.push(|c| drop(c.extras.head.remove(i)));
    }
    for i in 0..extras.scenes.len() {
        list.push(|c| drop(c.extras.scenes.remove(i)));
    }
    for i in 0..extras.tables.len() {
        list.push(|c| drop(c.extras.tables.remove(i)));
    }
    for i in 0..extras.keys.len() {
        list.push(|c| drop(c.extras.keys.remove(i)));
    }
    if extras.turns != Turns::Rpy {
        list.push(|c| c.extras.turns = Turns::Rpy);
    }
}

/// Adds the cell without each of its sensors, or with less of one.
fn simpler_sensors(list: &mut Candidates<'_>, sensors: &[SensorSpec]) {
    for (i, sensor) in sensors.iter().enumerate() {
        list.push(|c| drop(c.extras.sensors.remove(i)));
        for b in 0..sensor.boxes.len() {
            list.push(|c| {
                c.extras.sensors[i].boxes.remove(b);
            });
        }
        for line in 0..sensor.lines.len() {
            list.push(|c| drop(c.extras.sensors[i].lines.remove(line)));
        }
        if !sensor.pictures.unusable.is_empty() {
            list.push(|c| c.extras.sensors[i].pictures.unusable.clear());
        }
        if sensor.joints.is_some() {
            list.push(|c| c.extras.sensors[i].joints = None);
        }
    }
}

/// Adds the cell without an object that nothing follows or evades, or with a simpler motion of it.
fn without_object(list: &mut Candidates<'_>, i: usize, object: &ObjectSpec) {
    let follows = |f: &Option<FollowSpec>| matches!(f, Some(FollowSpec::Object(name)) if *name == object.name);
    let is_needed = list.spec.regions.iter().any(|r| follows(&r.follow))
        || list.spec.robots.iter().any(|r| r.evades.contains(&object.name) || grips(&r.program, &object.name))
        || list
            .spec
            .guidance
            .iter()
            .flat_map(|g| g.tables.iter().chain([&g.virtual_robot]))
            .any(|t| t.contains(&format!("\"{}\"", object.name)));
    if !is_needed {
        list.push(|c| drop(c.objects.remove(i)));
        return;
    }
    let Some(motion) = &object.motion else { return };
    let (turns, travels) = (motion.turn != [0.0; 3], !motion.via.is_empty());
    let mut simplify = |change: fn(&mut MotionSpec)| list.push(|c| c.objects[i].motion.iter_mut().for_each(change));
    if turns && travels {
        simplify(|m| m.via.clear());
        simplify(|m| m.turn = [0.0; 3]);
    }
    if motion.start > 0.0 {
        simplify(|m| m.start = 0.0);
    }
    if object.rpy != [0.0; 3] {
        list.push(|c| c.objects[i].rpy = [0.0; 3]);
    }
    if !object.shape.contains("\"sphere\"") {
        list.push(|c| c.objects[i].shape = "shape = \"sphere\"\nradius = 0.01\n".into());
    }
}

/// Whether a program grips or puts down an object.
fn grips(program: &ProgramSpec, object: &str) -> bool {
    program.steps.iter().any(|s| matches!(s, StepSpec::Grip(name) | StepSpec::Release(name) if name == object))
}

fn shorter_program(list: &mut Candidates<'_>, r: usize, program: &ProgramSpec) {
    if program.repeat > 1 {
        list.push(|c| c.robots[r].program.repeat = 1);
    }
    for i in (0..program.steps.len()).rev() {
        list.push(|c| drop(c.robots[r].program.steps.remove(i)));
    }
    if let Some(recording) = &program.recording {
        let rows = recording.rows.len();
        let changes: [fn(&mut RecordingSpec); 3] = [
            |recording| recording.rows.truncate(recording.rows.len() / 2),
            |recording| drop(recording.rows.drain(..recording.rows.len() / 2)),
            every_other_row,
        ];
        // Rows of a file without times have their distances.
        let has_times = recording.layout.as_ref().is_none_or(|layout| layout.period_ms.is_none());
        let changes = changes.into_iter().take(if has_times { 3 } else { 2 });
        for change in changes.filter(|_| rows / 2 >= LEAST_ROWS) {
            list.push(|c| c.robots[r].program.recording.iter_mut().for_each(change));
        }
    }
}

fn shorter_guidance(list: &mut Candidates<'_>, guidance: &GuidanceSpec) {
    // The tables of a virtual robot have its grasps and its camera.
    let tables = if guidance.virtual_robot.is_empty() { guidance.tables.len() } else { 0 };
    for i in 0..tables {
        list.push(|c| c.guidance.iter_mut().for_each(|g| drop(g.tables.remove(i))));
    }
    if guidance.rows.len() / 2 >= LEAST_ROWS {
        list.push(|c| c.guidance.iter_mut().for_each(|g| g.rows.truncate(g.rows.len() / 2)));
        list.push(|c| c.guidance.iter_mut().for_each(|g| drop(g.rows.drain(..g.rows.len() / 2))));
    }
}

/// Removes every other row; the first and last rows stay.
fn every_other_row(recording: &mut RecordingSpec) {
    let last = recording.rows.len() - 1;
    let mut row = 0..;
    recording.rows.retain(|_| row.next().is_some_and(|i| i % 2 == 0 || i == last));
}

fn emptier_robot(list: &mut Candidates<'_>, r: usize, robot: &RobotSpec) {
    if let Model::Dh { links, .. } = &robot.model {
        for (l, solids) in links.iter().enumerate() {
            for i in 0..solids.len() {
                list.push(|c| remove_solid(c, r, l, i));
            }
        }
    }
    for i in 0..robot.keys.len() {
        list.push(|c| drop(c.robots[r].keys.remove(i)));
    }
    if robot.starts_at_home {
        list.push(|c| c.robots[r].starts_at_home = false);
    }
    let hand = &robot.hand;
    if hand.load.is_some() {
        list.push(|c| c.robots[r].hand.load = None);
    }
    if hand.tool_box.is_some() {
        list.push(|c| c.robots[r].hand.tool_box = None);
    }
    if hand.tool_mesh.is_some() {
        list.push(|c| c.robots[r].hand.tool_mesh = None);
    }
    if hand.tcp.is_some() {
        list.push(|c| c.robots[r].hand.tcp = None);
    }
    for i in 0..hand.tools.len() {
        list.push(|c| remove_tool(c, r, i));
    }
    if robot.is_mechanism {
        list.push(|c| c.robots[r].is_mechanism = false);
    }
    if robot.overshoot.is_some() {
        list.push(|c| c.robots[r].overshoot = None);
    }
    if !robot.evades.is_empty() {
        list.push(|c| c.robots[r].evades.clear());
    }
}

fn remove_solid(c: &mut CellSpec, robot: usize, link: usize, solid: usize) {
    if let Model::Dh { links, .. } = &mut c.robots[robot].model {
        links[link].remove(solid);
    }
}

fn remove_tool(c: &mut CellSpec, robot: usize, tool: usize) {
    let robot = &mut c.robots[robot];
    let name = robot.hand.tools.remove(tool).name;
    robot.program.steps.retain(|s| !matches!(s, StepSpec::Tool(tool) if *tool == name));
}

fn remove_region(c: &mut CellSpec, i: usize) {
    let name = c.regions.remove(i).name;
    for robot in &mut c.robots {
        robot.program.steps.retain(|s| !matches!(s, StepSpec::Switch { region, .. } if *region == name));
    }
}

/// Removes a robot. Robots are named by their index, so higher indices decrease.
fn remove_robot(c: &mut CellSpec, i: usize) {
    c.robots.remove(i);
    let moved = |r: usize| if r > i { r - 1 } else { r };
    c.faults.retain(|f| f.robot != RobotId(i));
    c.faults.iter_mut().for_each(|f| f.robot.0 = moved(f.robot.0));
    c.regions.retain(|r| r.robots != [i] && !matches!(r.follow, Some(FollowSpec::Robot { robot, .. }) if robot == i));
    for region in &mut c.regions {
        region.robots.retain(|r| *r != i);
        region.robots.iter_mut().for_each(|r| *r = moved(*r));
        if let Some(FollowSpec::Robot { robot, .. }) = &mut region.follow {
            *robot = moved(*robot);
        }
    }
    c.extras.sensors.retain(|s| s.mapped != i && s.avoiding != [i]);
    for sensor in &mut c.extras.sensors {
        sensor.mapped = moved(sensor.mapped);
        sensor.avoiding.retain(|r| *r != i);
        sensor.avoiding.iter_mut().for_each(|r| *r = moved(*r));
    }
    c.grids.retain(|g| g.robot != i);
    c.grids.iter_mut().for_each(|g| g.robot = moved(g.robot));
    let names: Vec<String> = c.regions.iter().map(|r| r.name.clone()).collect();
    for robot in &mut c.robots {
        robot.program.steps.retain(|s| !matches!(s, StepSpec::Switch { region, .. } if !names.contains(region)));
    }
}
