//! Makes a failing cell smaller while it goes on failing in the same way.

use elbowroom_robot::RobotId;

use super::oracle::Finding;
use super::spec::{CellSpec, FollowSpec, Model, StepSpec};

/// Runs that shrinking may take.
const RUNS: usize = 120;

/// The smallest cell found, and what the oracle says of it.
pub fn smallest(
    spec: &CellSpec,
    finding: &Finding,
    fails: &dyn Fn(&CellSpec) -> Option<Finding>,
) -> (CellSpec, Finding) {
    let (mut best, mut why) = (spec.clone(), finding.clone());
    let mut runs = 0;
    loop {
        let mut shrunk = false;
        for candidate in candidates(&best) {
            if runs >= RUNS {
                return (best, why);
            }
            runs += 1;
            if let Some(found) = fails(&candidate) {
                (best, why, shrunk) = (candidate, found, true);
                break;
            }
        }
        if !shrunk {
            return (best, why);
        }
    }
}

/// Every cell that has one thing less, the largest things first.
fn candidates(spec: &CellSpec) -> Vec<CellSpec> {
    let mut list = Vec::new();
    let mut push = |change: &dyn Fn(&mut CellSpec)| {
        let mut c = spec.clone();
        change(&mut c);
        list.push(c);
    };
    for i in (0..spec.robots.len()).rev().filter(|_| spec.robots.len() > 1) {
        push(&|c| remove_robot(c, i));
    }
    for i in 0..spec.regions.len() {
        push(&|c| remove_region(c, i));
    }
    for i in 0..spec.faults.len() {
        push(&|c| c.faults.retain(|f| *f != spec.faults[i]));
    }
    for (r, robot) in spec.robots.iter().enumerate() {
        for i in (0..robot.steps.len()).rev() {
            push(&|c| drop(c.robots[r].steps.remove(i)));
        }
        if let Model::Dh { links, .. } = &robot.model {
            for (l, solids) in links.iter().enumerate() {
                for i in 0..solids.len() {
                    push(&|c| remove_solid(c, r, l, i));
                }
            }
        }
        if robot.load.is_some() {
            push(&|c| c.robots[r].load = None);
        }
        if robot.tool_box.is_some() {
            push(&|c| c.robots[r].tool_box = None);
        }
        if robot.tcp.is_some() {
            push(&|c| c.robots[r].tcp = None);
        }
    }
    if spec.direction_aware {
        push(&|c| c.direction_aware = false);
    }
    if spec.reaction_ms > 0.0 {
        push(&|c| c.reaction_ms = 0.0);
    }
    list
}

fn remove_solid(c: &mut CellSpec, robot: usize, link: usize, solid: usize) {
    if let Model::Dh { links, .. } = &mut c.robots[robot].model {
        links[link].remove(solid);
    }
}

fn remove_region(c: &mut CellSpec, i: usize) {
    let name = c.regions.remove(i).name;
    for robot in &mut c.robots {
        robot.steps.retain(|s| !matches!(s, StepSpec::Switch { region, .. } if *region == name));
    }
}

/// Robots are named by their place, so all that names one moves up.
fn remove_robot(c: &mut CellSpec, i: usize) {
    c.robots.remove(i);
    let moved = |r: usize| if r > i { r - 1 } else { r };
    c.faults.retain(|f| f.robot != RobotId(i));
    c.faults.iter_mut().for_each(|f| f.robot.0 = moved(f.robot.0));
    c.regions.retain(|r| r.robots != [i] && !matches!(r.follow, Some(FollowSpec::Robot(f)) if f == i));
    for region in &mut c.regions {
        region.robots.retain(|r| *r != i);
        region.robots.iter_mut().for_each(|r| *r = moved(*r));
        if let Some(FollowSpec::Robot(f)) = &mut region.follow {
            *f = moved(*f);
        }
    }
    let names: Vec<String> = c.regions.iter().map(|r| r.name.clone()).collect();
    for robot in &mut c.robots {
        robot.steps.retain(|s| !matches!(s, StepSpec::Switch { region, .. } if !names.contains(region)));
    }
}
