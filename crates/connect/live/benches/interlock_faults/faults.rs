//! Random faults of random processes.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::{Duration, Instant};

use elbowroom_testkit::random::{split_mix, unit};

use crate::processes::Process;
use crate::requests::Requests;

/// Shortest and longest duration of a fault, s.
const LENGTH_S: [f64; 2] = [0.01, 10.0];
/// Resolution of the begin and end of faults.
const POLL: Duration = Duration::from_millis(1);
/// Every Nth fault is of the arbiter.
const ARBITER_EVERY: u64 = 8;

/// A fault of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    /// Killed, and started again later.
    Killed,
    /// Killed, and started again at once.
    Restarted,
    /// Paused: neither running nor dead.
    Paused,
    /// Cut off from the network; messages from and to it arrive afterwards.
    CutOff,
}

/// Injects faults until the time is over.
pub struct Faults {
    /// The nodes, then the arbiter.
    processes: Vec<Process>,
    present: Vec<Option<(Fault, Instant)>>,
    random: u64,
    counts: BTreeMap<String, u64>,
}

impl Faults {
    pub fn new(processes: Vec<Process>, seed: u64) -> Self {
        let present = vec![None; processes.len()];
        Self { processes, present, random: seed, counts: BTreeMap::new() }
    }

    /// Injects one fault every `every`; returns the number of faults of each kind.
    pub fn run(
        mut self,
        every: Duration,
        time: Duration,
        requests: &Requests,
    ) -> Result<BTreeMap<String, u64>, Box<dyn Error>> {
        let began = Instant::now();
        let mut next = began + every;
        while began.elapsed() < time {
            let now = Instant::now();
            self.end_those_over(now, requests)?;
            if now >= next {
                self.check_that_all_run()?;
                self.begin_one(now, requests)?;
                next += every;
            }
            std::thread::sleep(POLL);
        }
        Ok(self.counts)
    }

    fn end_those_over(&mut self, now: Instant, requests: &Requests) -> Result<(), Box<dyn Error>> {
        for (process, present) in self.present.iter_mut().enumerate() {
            let Some((fault, _)) = present.take_if(|(_, until)| now >= *until) else { continue };
            match fault {
                Fault::Killed | Fault::Restarted => self.processes[process].restart()?,
                Fault::Paused => self.processes[process].pause(false)?,
                Fault::CutOff => self.processes[process].cut(false),
            }
            requests.fault_ended(process, matches!(fault, Fault::Killed | Fault::Restarted));
        }
        Ok(())
    }

    /// Returns an error if a process has ended without being killed.
    fn check_that_all_run(&mut self) -> Result<(), Box<dyn Error>> {
        let is_killed =
            |present: &Option<(Fault, Instant)>| matches!(present, Some((Fault::Killed | Fault::Restarted, _)));
        let running = self.processes.iter_mut().zip(&self.present).enumerate().filter(|(_, (_, p))| !is_killed(p));
        for (i, (process, _)) in running {
            if let Some(how) = process.has_ended() {
                return Err(format!("process {} has ended by itself: {how}", i + 1).into());
            }
        }
        Ok(())
    }

    fn begin_one(&mut self, now: Instant, requests: &Requests) -> Result<(), Box<dyn Error>> {
        let arbiter = self.processes.len() - 1;
        let is_arbiter = split_mix(&mut self.random).is_multiple_of(ARBITER_EVERY);
        let node = split_mix(&mut self.random) as usize % arbiter;
        let process = if is_arbiter { arbiter } else { node };
        if self.present[process].is_some() {
            return Ok(());
        }
        let kinds = [Fault::Killed, Fault::Restarted, Fault::Paused, Fault::CutOff];
        let fault = kinds[split_mix(&mut self.random) as usize % kinds.len()];
        let [shortest, longest] = LENGTH_S;
        let length_s = match fault {
            Fault::Restarted => 0.0,
            _ => shortest * (longest / shortest).powf(unit(split_mix(&mut self.random))),
        };
        requests.fault_began(process);
        match fault {
            Fault::Killed | Fault::Restarted => self.processes[process].kill(),
            Fault::Paused => self.processes[process].pause(true)?,
            Fault::CutOff => self.processes[process].cut(true),
        }
        self.present[process] = Some((fault, now + Duration::from_secs_f64(length_s)));
        let whose = if is_arbiter { "arbiter" } else { "node" };
        *self.counts.entry(format!("{whose} {fault:?}")).or_default() += 1;
        Ok(())
    }
}
