//! Requests of people and programs in a schedule, and what their answers promise.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use super::cell::{APART_M, CARRIAGE_M, EXCHANGE_AT_M, EXCHANGE_M, RAIL_M, name, sharing, sphere};
use super::judge::Zone;
use super::process::{ArbiterParts, controller_host, node_host};
use super::process_clock::true_us;
use super::world::{Ended, World};
use crate::control::{Add, Clear, Done, Move, Refusal, Remove, Switch};
use crate::keys::Keys;
use crate::network::Urgency;
use crate::region_keeper::SwitchRequest;

/// Index of a token in the cell's list.
const PROGRAMMER: usize = 1;
const INTEGRATOR: usize = 2;

/// A sphere near a rail.
#[derive(Debug, Clone)]
struct Place {
    x: f64,
    z: f64,
    radius: f64,
}

impl World {
    fn place(&self) -> Place {
        let mut random = self.random.borrow_mut();
        let rail = random.below(self.cell.rails);
        // Half of them are where the carriage goes.
        let (q, target) = (self.places()[rail], self.targets()[rail]);
        let ahead = q + (target - q).signum() * (0.1 + 0.5 * random.unit());
        Place {
            x: APART_M * rail as f64 + 0.2 * (random.unit() - 0.5),
            z: if random.below(2) == 0 { RAIL_M * random.unit() } else { ahead },
            radius: 0.02 + 0.1 * random.unit(),
        }
    }

    /// A person or a program asks for something.
    pub(super) fn ask(&self) {
        // A fault that comes with a request is the one that matters.
        let fault = self.plan().beside_a_request(self.cell.rails, &mut self.random.borrow_mut());
        if let Some(fault) = fault {
            self.apply(fault);
        }
        let draw = self.random.borrow_mut().below(10);
        let edited: Vec<String> = self.judge.borrow().zones.iter().map(|zone| zone.name.clone()).collect();
        match draw {
            3..=5 if !edited.is_empty() => self.move_one(&edited),
            6 if !edited.is_empty() => self.remove(&edited),
            7 | 8 => self.switch(),
            9 => self.clear(),
            _ => self.add(),
        }
    }

    fn add(&self) {
        let place = self.place();
        let name = format!("z{}", true_us());
        let toml = sphere(place.x, place.z, place.radius) + "warning = 0.2\nlife = \"temporary\"\n";
        let request = Add { region: name.clone(), toml, active: None, note: None };
        let answer = self.send("add", |parts, at| parts.handler.add(&self.cell.tokens[PROGRAMMER], at, &request));
        if let Some(Ok(done)) = answer {
            self.promise(&done, name, place);
        }
    }

    fn move_one(&self, edited: &[String]) {
        let name = edited[self.random.borrow_mut().below(edited.len())].clone();
        let Some(radius) = self.judge.borrow().zones.iter().find(|zone| zone.name == name).map(|zone| zone.radius)
        else {
            return;
        };
        let returns = self.random.borrow_mut().below(3) == 0;
        let former = self.judge.borrow().former(&name).filter(|_| returns);
        let place = former.map_or_else(|| self.place(), |(x, z)| Place { x, z, radius });
        let place = Place { radius, ..place };
        let toml = format!("centre = [{}, 0, {}]", place.x, place.z);
        let request = Move { region: name.clone(), toml, note: None };
        self.judge.borrow_mut().begin_change(&name);
        let answer =
            self.send("move", |parts, at| parts.handler.move_region(&self.cell.tokens[PROGRAMMER], at, &request));
        self.judge.borrow_mut().end_change(matches!(answer, Some(Err(_))));
        match answer {
            Some(Ok(done)) => self.promise(&done, name, place),
            // The region is still where it was.
            Some(Err(_)) => {}
            None => self.judge.borrow_mut().no_longer(&name),
        }
    }

    fn remove(&self, edited: &[String]) {
        let name = edited[self.random.borrow_mut().below(edited.len())].clone();
        let request = Remove { region: name.clone(), note: None };
        self.judge.borrow_mut().begin_change(&name);
        let answer = self.send("remove", |parts, at| parts.handler.remove(&self.cell.tokens[PROGRAMMER], at, &request));
        self.judge.borrow_mut().end_change(matches!(answer, Some(Err(_))));
        if !matches!(answer, Some(Err(_))) {
            self.judge.borrow_mut().no_longer(&name);
        }
    }

    fn switch(&self) {
        let active = self.random.borrow_mut().below(2) == 0;
        if self.programs_switch {
            self.count("requests of programs");
            let start = self.start(controller_host(0));
            let key = Keys::new(&self.cell.cell.name).switch();
            let request = SwitchRequest { robot: name(0), region: "cart".into(), active };
            let bytes = serde_json::to_vec(&request).expect("JSON");
            start.network.publisher(&key, Urgency::Display).expect("a key").publish(&bytes);
            return;
        }
        let request = Switch { region: "cart".into(), active, note: None };
        let answer = self.send("switch", |parts, at| parts.handler.switch(&self.cell.tokens[PROGRAMMER], at, &request));
        if matches!(answer, Some(Ok(_))) {
            self.judge.borrow_mut().switched(active);
        }
    }

    /// Clears a robot whose node does not run, if it rests outside its exchange regions.
    fn clear(&self) {
        let (places, velocities) = (self.places(), self.velocities());
        let regions = |rail: usize| (0..self.cell.rails - 1).filter(move |region| sharing(*region).contains(&rail));
        let is_outside = |rail: usize| {
            let x = 0.5 * APART_M;
            regions(rail).all(|region| x.hypot(EXCHANGE_AT_M[region] - places[rail]) > EXCHANGE_M + CARRIAGE_M)
        };
        let may_be = |rail: &usize| !self.is_running(node_host(*rail)) && velocities[*rail] == 0.0 && is_outside(*rail);
        let Some(rail) = (0..self.cell.rails).find(may_be) else { return };
        let request = Clear {
            robot: name(rail),
            regions: regions(rail).map(|region| format!("shared{region}")).collect(),
            repeat_robot: name(rail),
            note: None,
        };
        self.send("clear", |parts, at| parts.handler.clear(&self.cell.tokens[INTEGRATOR], at, &request));
    }

    /// Sends a request to the arbiter; `None` if it does not run, or has ended before it answered.
    fn send(
        &self,
        what: &'static str,
        request: impl FnOnce(&ArbiterParts, &str) -> Result<Done, Refusal>,
    ) -> Option<Result<Done, Refusal>> {
        let Some(parts) = self.arbiter() else {
            self.count("requests without an arbiter");
            return Some(Err(Refusal::new(503, "nobody listens")));
        };
        let changed_us = std::mem::replace(&mut self.waits.borrow_mut().changed_us, u64::MAX);
        let at = parts.handler.overview().revision;
        let answer = catch_unwind(AssertUnwindSafe(|| request(&parts, &at)));
        // Nodes may have stopped while they had no regions; refused requests and switches stop none.
        let has_changed = !matches!(answer, Ok(Err(_))) && what != "switch";
        self.waits.borrow_mut().changed_us = if has_changed { true_us() } else { changed_us };
        match answer {
            Ok(answer) => {
                self.count(if answer.is_ok() { what } else { "requests refused" });
                if let Err(Refusal { status: 400 | 404 | 422, error, .. }) = &answer {
                    panic!("{what}: {error}");
                }
                Some(answer)
            }
            Err(payload) if payload.is::<Ended>() => {
                self.count("requests that the arbiter did not survive");
                None
            }
            Err(payload) => resume_unwind(payload),
        }
    }

    /// The answer says that the region is in force, except for the robots that it names.
    fn promise(&self, done: &Done, name: String, Place { x, z, radius }: Place) {
        let is_named = |rail: &usize| {
            let robot = super::cell::name(*rail);
            done.not_heard.contains(&robot) || done.stopped.contains(&robot)
        };
        let named: Vec<usize> = (0..self.cell.rails).filter(is_named).collect();
        if !named.is_empty() && !self.plan().has_faults() {
            self.judge.borrow_mut().wrong(&format!("the answer about {name} names {named:?} without a fault"));
        }
        let zone = Zone { name, x, z, radius, named, since_us: true_us() };
        self.judge.borrow_mut().in_force(zone, &self.places());
    }

    pub(super) fn count(&self, what: &'static str) {
        *self.plan().counts.entry(what).or_default() += 1;
    }
}
