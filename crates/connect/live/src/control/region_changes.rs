//! Changes of regions while the cell runs: move, add, remove.

use std::sync::Arc;

use elbowroom_cell::access::{AccessToken, Change, ControlLog, Controlled};
use elbowroom_cell::{EditedRegions, RegionEdit, table_changes};
use elbowroom_formats::Diagnostic;
use elbowroom_monitor::{Life, RegionKind};
use elbowroom_status::SPARE_REGIONS;

use super::refusal::Refusal;
use super::request_handler::{ControlParts, Done, RequestHandler, find, is_present, note, revision};
use super::requests::{Add, Move, Remove};
use crate::cell_versions::NoVersion;
use crate::configuration_number::configuration_digits;
use crate::region_keeper::PresentRegions;

/// Longest name of an added region, bytes.
const MAX_NAME: usize = 100;
/// Limit of the keys of all changed regions together, bytes: the table of regions is sent ten times a second.
const MAX_EDITS: usize = 64 * 1024;
/// Suffix of a moved region's name at its new place: the region is at both places until all nodes have the new one.
const AT_NEW_PLACE: &str = " (new place)";

/// A requested change, before it is made.
struct RegionChange<'a> {
    action: &'static str,
    region: &'a str,
    before: &'a PresentRegions,
    after: PresentRegions,
    /// The keys of the region before and after.
    tables: [Option<String>; 2],
    /// Whether the region is on after the change; false for a removed region.
    is_on: bool,
    note: Option<&'a str>,
}

impl RequestHandler {
    /// Moves a region to another place.
    pub(crate) fn move_region(&self, who: &AccessToken, at: &str, request: &Move) -> Result<Done, Refusal> {
        let mut log = self.log();
        let (before, name) = (self.parts.keeper.present(), request.region.as_str());
        let is_on = self.changeable(who, &before, name, "move")?;
        is_present(&log, at)?;
        let edited = self.parts.versions.edited().map_err(refused)?;
        let table = table_of(edited, &before, name)?;
        let moved = edited.moved(name, &table, &request.toml).map_err(wrong)?;
        let after = self.with(&before, name, Some(&moved))?;
        let (action, note) = ("move", note(request.note.as_deref())?);
        let tables = [Some(table), Some(moved)];
        self.carry_out(
            &mut log,
            who,
            &RegionChange { action, region: name, before: &before, after, tables, is_on, note },
        )
    }

    /// Adds a region.
    pub(crate) fn add(&self, who: &AccessToken, at: &str, request: &Add) -> Result<Done, Refusal> {
        let name = request.region.as_str();
        self.require(who, Life::Temporary.needed_class(), &format!("add region `{name}`"))?;
        if name.is_empty()
            || name.len() > MAX_NAME
            || name.chars().any(char::is_control)
            || name.ends_with(AT_NEW_PLACE)
        {
            return Err(Refusal::new(400, "this is not a valid name for a region")
                .help(format!("at most {MAX_NAME} bytes, on one line")));
        }
        let mut log = self.log();
        is_present(&log, at)?;
        let before = self.parts.keeper.present();
        if before.cell.regions.iter().any(|r| r.region.name == name) {
            let error = format!("there is a region `{name}` already");
            return Err(Refusal::new(409, error).help("another name; or move that one, or remove it before"));
        }
        let edited = self.parts.versions.edited().map_err(refused)?;
        let table = edited.table_of(name, &request.toml).map_err(wrong)?;
        let after = self.with(&before, name, Some(&table))?;
        let (_, added) = find(&after.cell, name)?;
        self.require(who, added.region.life.needed_class(), &format!("add permanent region `{name}`"))?;
        let is_on = added.region.life == Life::Permanent || request.active.unwrap_or(true);
        let (action, note, tables) = ("add", note(request.note.as_deref())?, [None, Some(table)]);
        self.carry_out(
            &mut log,
            who,
            &RegionChange { action, region: name, before: &before, after, tables, is_on, note },
        )
    }

    /// Removes a region.
    pub(crate) fn remove(&self, who: &AccessToken, at: &str, request: &Remove) -> Result<Done, Refusal> {
        let mut log = self.log();
        let (before, name) = (self.parts.keeper.present(), request.region.as_str());
        self.changeable(who, &before, name, "remove")?;
        is_present(&log, at)?;
        let edited = self.parts.versions.edited().map_err(refused)?;
        let table = table_of(edited, &before, name)?;
        let after = self.with(&before, name, None)?;
        let (action, note) = ("remove", note(request.note.as_deref())?);
        let tables = [Some(table), None];
        let change = RegionChange { action, region: name, before: &before, after, tables, is_on: false, note };
        self.carry_out(&mut log, who, &change)
    }

    /// Returns whether the region is on, if this token may move or remove it while the cell runs; else the refusal.
    fn changeable(&self, who: &AccessToken, present: &PresentRegions, name: &str, what: &str) -> Result<bool, Refusal> {
        let (id, region) = find(&present.cell, name)?;
        let life = region.region.life;
        self.require(who, life.needed_class(), &format!("{what} {} region `{name}`", life.name()))?;
        let in_the_file = "elbowroom region change, or an editor (docs/roles.md), and start the processes again";
        if matches!(region.region.kind, RegionKind::Exchange { .. }) {
            let error = format!(
                "region `{name}` is an exchange region{}: such regions stay as they are while the cell runs",
                self.holder(name)
            );
            return Err(Refusal::new(409, error).help(in_the_file));
        }
        if life == Life::Permanent && self.parts.versions.base().regions.iter().any(|r| r.region.name == name) {
            let error =
                format!("region `{name}` is permanent and in the cell file: it stays as it is while the cell runs");
            return Err(Refusal::new(409, error).help(in_the_file));
        }
        Ok(self.parts.keeper.active()[id.0])
    }

    /// Names the holder of an exchange region in words; empty without a holder.
    fn holder(&self, name: &str) -> String {
        let slots = self.parts.arbiter.as_ref().map(|a| a.slots()).unwrap_or_default();
        let of = slots.into_iter().find(|slot| slot.regions.iter().any(|r| r == name));
        of.and_then(|slot| slot.holder).map_or_else(String::new, |holder| format!(", which robot `{holder}` holds"))
    }

    /// Returns the regions with the keys of one region replaced, or without that region if `table` is `None`.
    pub(super) fn with(
        &self,
        before: &PresentRegions,
        name: &str,
        table: Option<&str>,
    ) -> Result<PresentRegions, Refusal> {
        let versions = &self.parts.versions;
        let edit = RegionEdit { name: name.into(), table: table.map(Into::into) };
        let edits = versions.edited().map_err(refused)?.with(&before.edits, edit);
        let bytes: usize = edits.iter().map(|e| e.name.len() + e.table.as_ref().map_or(0, String::len)).sum();
        // During a move the region is in the cell twice.
        let most = versions.base().regions.len() + SPARE_REGIONS - 1;
        let cell = versions.cell(&edits).map_err(refused)?;
        if cell.regions.len() > most || bytes > MAX_EDITS {
            let error = format!("{} regions, of which {bytes} bytes were changed, are too many", cell.regions.len());
            let help = format!("{most} regions and {MAX_EDITS} bytes at most; put lasting ones into the cell file");
            return Err(Refusal::new(409, error).help(help));
        }
        Ok(PresentRegions { cell, edits })
    }

    /// Makes and logs an allowed change, unless a robot is inside the region or cannot stop outside it.
    fn carry_out(&self, log: &mut ControlLog, who: &AccessToken, change: &RegionChange<'_>) -> Result<Done, Refusal> {
        let RegionChange { action, region, before, after, is_on, .. } = change;
        let not_heard = self.in_the_way(change)?;
        let both = self.at_both_places(change)?;
        let action = format!("{action} region.{region}");
        let entry = log.append(controlled(who, action.clone(), change, false))?;
        if let Some(both) = &both {
            self.go_to(both, true);
        } else {
            self.go_to(after, *is_on);
        }
        // From here on the region is in force at its new place: a robot that has entered it since the first check
        // stops, and the change is undone.
        if let Err(refusal) = self.in_the_way(change) {
            self.go_to(before, false);
            let undone = format!("{action}: not done, a robot came in the way");
            log.append(controlled(who, undone, change, true))?;
            return Err(refusal);
        }
        let stopped = self.go_to(after, *is_on);
        self.report(&format!("{region}: {} by {} ({})", done_word(change.action), who.name, who.class.name()));
        Ok(Done { entry, revision: revision(log), not_heard, stopped })
    }

    /// Checks that no robot is inside the region at its new place, or unable to stop outside it. Returns the robots
    /// that are not heard.
    fn in_the_way(&self, change: &RegionChange<'_>) -> Result<Vec<String>, Refusal> {
        if !change.is_on {
            return Ok(Vec::new());
        }
        let (_, region) = find(&change.after.cell, change.region)?;
        self.refuse_inside(&change.after.cell, region)
    }

    /// Returns the regions with the moved region at both places; `None` unless a region is moved and is on.
    fn at_both_places(&self, change: &RegionChange<'_>) -> Result<Option<PresentRegions>, Refusal> {
        let [Some(_), Some(moved)] = &change.tables else { return Ok(None) };
        if !change.is_on {
            return Ok(None);
        }
        self.with(change.before, &format!("{}{AT_NEW_PLACE}", change.region), Some(moved)).map(Some)
    }

    /// Switches all running nodes to these regions: first they prepare; then nodes that have not prepared stop. Returns
    /// the robots of those nodes, and of nodes that are not heard although the controller of the robot is: they may continue
    /// with the former regions until their last table is too old.
    fn go_to(&self, regions: &PresentRegions, new_are_on: bool) -> Vec<String> {
        let ControlParts { keeper, nodes, versions, joints, .. } = &self.parts;
        let is_base = Arc::ptr_eq(&regions.cell, versions.base());
        let number = if is_base { String::new() } else { configuration_digits(&regions.cell) };
        let table = keeper.set(regions, new_are_on, false);
        let missing = nodes.wait_for(&number, table);
        keeper.set(regions, new_are_on, true);
        let heard = joints.states();
        let moves = |robot: &usize| heard[*robot].is_some() && !regions.cell.robots[*robot].is_mechanism();
        missing.into_iter().filter(moves).map(|robot| regions.cell.robots[robot].name.clone()).collect()
    }
}

/// The table of a region that may be changed; a fence has another one.
fn table_of(edited: &EditedRegions, present: &PresentRegions, name: &str) -> Result<String, Refusal> {
    edited.table(&present.edits, name).ok_or_else(|| {
        Refusal::new(409, format!("region `{name}` is a fence: it stays as it is while the cell runs"))
            .help("the cell file in an editor, and start the processes again")
    })
}

/// Makes the log entry of a change; `is_undone` if the change was made and reverted.
fn controlled<'a>(
    who: &'a AccessToken,
    action: String,
    change: &'a RegionChange<'_>,
    is_undone: bool,
) -> Controlled<'a> {
    let item = format!("region.{}", change.region);
    let [mut before, mut after] = change.tables.each_ref().map(Option::as_deref);
    let mut checksums = [change.before, &change.after].map(|regions| regions.cell.approval.checksum.as_str());
    if is_undone {
        std::mem::swap(&mut before, &mut after);
        checksums.reverse();
    }
    let of_key = |(field, before, after)| Change { item: item.clone(), field, before, after };
    let mut changes: Vec<Change> = table_changes(before, after).into_iter().map(of_key).collect();
    if change.tables[0].is_none() && !is_undone {
        let (before, after) = (None, Some(change.is_on.to_string()));
        changes.push(Change { item, field: "active".into(), before, after });
    }
    let note = change.note.filter(|_| !is_undone);
    Controlled { class: who.class, name: &who.name, action, note, changes, checksums }
}

fn done_word(action: &str) -> &'static str {
    match action {
        "move" => "moved",
        "add" => "added",
        _ => "removed",
    }
}

/// Refuses the keys of a region, with the error that the cell file's parser reports.
pub(super) fn wrong(error: Diagnostic) -> Refusal {
    let what = error.line.map_or_else(|| error.message.clone(), |line| format!("line {line}: {}", error.message));
    let refusal = Refusal::new(400, what);
    match error.hint {
        Some(help) => refusal.help(help),
        None => refusal,
    }
}

pub(super) fn refused(why: NoVersion) -> Refusal {
    match why {
        NoVersion::Wrong(error) => wrong(error),
        NoVersion::NotContinued(why) => {
            Refusal::new(409, why).help("change the cell file (docs/roles.md), and start the processes again")
        }
    }
}
