//! What faults do to the world.

use std::fs;
use std::path::{Path, PathBuf};

use super::faults::Fault;
use super::network::Host;
use super::process::{ARBITER, BELT, controller_host, journal, log_head, node_host};
use super::process_clock::true_us;
use super::world::World;
use crate::locked::locked;

impl World {
    /// Makes a fault happen.
    pub(super) fn apply(&self, fault: Fault) {
        match fault {
            Fault::Kill { host, down_us, has_other_file } => {
                self.note("killed", &[host], down_us);
                self.end(host);
                self.later(down_us, Fault::Start { host, has_other_file });
            }
            Fault::Start { host, has_other_file } => self.start_again(host, has_other_file),
            Fault::Twin { rail } => {
                self.note("second nodes", &[node_host(rail)], 1_000_000);
                self.start_node(rail, false);
                self.later(700_000, Fault::Kill { host: node_host(rail), down_us: 50_000, has_other_file: false });
            }
            Fault::Pause { host, for_us } => {
                self.note("paused", &[host], for_us);
                self.pause(host, true_us() + for_us);
            }
            Fault::Cut { from, to, for_us } => {
                self.note("cut", &[from, to], for_us);
                locked(&self.wires).link(from, to).cut_until = true_us() + for_us;
            }
            Fault::Late { from, to, for_us, late_us } => {
                self.note("late", &[from, to], for_us + late_us);
                let mut wires = locked(&self.wires);
                let link = wires.link(from, to);
                (link.late_until, link.lateness) = (true_us() + for_us, late_us);
            }
            Fault::RestartController { rail } => {
                self.note("controllers restarted", &[controller_host(rail)], 0);
                self.restart_controller(rail);
            }
            Fault::RestartBelt => {
                self.note("belts restarted", &[BELT], 0);
                self.start_belt();
            }
            Fault::FillDisk { of_log } => self.fill_disk(of_log),
            Fault::FreeDisk { of_log } => protect(&self.file(of_log), false),
        }
    }

    fn start_again(&self, host: Host, has_other_file: bool) {
        // Another fault has started it meanwhile.
        if self.is_running(host) {
            return;
        }
        if host == ARBITER {
            self.restart_arbiter();
            return;
        }
        self.start_node(host - node_host(0), has_other_file);
        if has_other_file {
            self.note("with the other file", &[host], 1_000_000);
            self.later(800_000, Fault::Kill { host, down_us: 50_000, has_other_file: false });
        }
    }

    fn note(&self, what: &'static str, hosts: &[Host], for_us: u64) {
        let mut faults = self.plan();
        *faults.counts.entry(what).or_default() += 1;
        for host in hosts {
            faults.disturb(*host, for_us);
        }
    }

    fn later(&self, after_us: u64, fault: Fault) {
        self.plan().later(true_us() + after_us, fault);
    }

    /// A file that must not be replaced stands for a disk that takes nothing more.
    fn fill_disk(&self, of_log: bool) {
        if self.file(of_log).is_file() {
            self.note("full disks", &[], 0);
            self.plan().has_lost_journal |= !of_log;
        }
        protect(&self.file(of_log), true);
        self.later(900_000, Fault::FreeDisk { of_log });
    }

    fn file(&self, of_log: bool) -> PathBuf {
        if of_log { log_head(&self.folder) } else { journal(&self.folder) }
    }
}

/// Makes a file read-only, or not; it may not exist.
fn protect(file: &Path, is_protected: bool) {
    let Ok(found) = fs::metadata(file) else { return };
    let mut permissions = found.permissions();
    permissions.set_readonly(is_protected);
    // It may have been removed meanwhile.
    let _ = fs::set_permissions(file, permissions);
}
