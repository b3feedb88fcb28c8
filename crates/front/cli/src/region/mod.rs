//! `elbowroom region`: signed edits of a sealed cell, its edit log, and its regions in the language of a controller.

pub(crate) mod args;
mod export;
mod log;

use std::io::Read;
use std::path::{Path, PathBuf};

use elbowroom::cell::access::{LogEntry, PrivateKey};
use elbowroom::cell::seal::{self, CellEdit, Signer};
use elbowroom::monitor::AccessClass;

use crate::output::{ExitStatus, Failure, cannot_read, cannot_write, note, print};
use args::{AddArgs, KeygenArgs, RegionCommand, SignArgs};

pub(crate) fn region(command: &RegionCommand) -> Result<ExitStatus, Failure> {
    match command {
        RegionCommand::Add(args) => add(args),
        RegionCommand::Change(args) => {
            let (set, unset) = (args.keys.set.clone(), args.keys.unset.clone());
            edit(&args.cell, &CellEdit::Change { region: args.region.clone(), set, unset }, &args.sign)
        }
        RegionCommand::Remove(args) => edit(&args.cell, &CellEdit::Remove { region: args.region.clone() }, &args.sign),
        RegionCommand::Laws(args) => {
            let (set, unset) = (args.keys.set.clone(), args.keys.unset.clone());
            edit(&args.cell, &CellEdit::Laws { set, unset }, &args.sign)
        }
        RegionCommand::Seal(args) => signed(&args.cell, &args.sign, |signer| seal::seal(&args.cell, signer)),
        RegionCommand::Log(args) => log::log(args),
        RegionCommand::Keygen(args) => keygen(args),
        RegionCommand::Export(args) => export::export(args),
    }
}

fn add(args: &AddArgs) -> Result<ExitStatus, Failure> {
    let from = &args.regions;
    let unreadable = cannot_read(from);
    let (toml, from) = if from == Path::new("-") {
        let mut text = String::new();
        std::io::stdin().lock().read_to_string(&mut text).map_err(unreadable)?;
        (text, PathBuf::from("standard input"))
    } else {
        (std::fs::read_to_string(from).map_err(unreadable)?, from.clone())
    };
    edit(&args.cell, &CellEdit::Add { toml, from }, &args.sign)
}

fn edit(cell: &Path, edit: &CellEdit, sign: &SignArgs) -> Result<ExitStatus, Failure> {
    signed(cell, sign, |signer| seal::edit(cell, signer, edit))
}

/// Performs a signed edit and prints its log entry.
fn signed(
    cell: &Path,
    sign: &SignArgs,
    act: impl FnOnce(&Signer<'_>) -> Result<LogEntry, elbowroom::Diagnostic>,
) -> Result<ExitStatus, Failure> {
    let class = AccessClass::from(sign.class);
    if class == AccessClass::Operator {
        let what = format!("{}: an operator changes no regions and no laws", cell.display());
        return Err(Failure::Wrong(format!(
            "{what}\n  write: --as programmer or --as integrator, with a key of that class"
        )));
    }
    let key = private_key(sign, class)?;
    let entry = act(&Signer { class, key: &key, note: sign.note.as_deref() })?;
    print(&log::entry(&entry, key.name()))?;
    Ok(ExitStatus::Success)
}

fn private_key(sign: &SignArgs, class: AccessClass) -> Result<PrivateKey, Failure> {
    let named = || std::env::var_os("ELBOWROOM_KEY").filter(|v| !v.is_empty()).map(PathBuf::from);
    let file = sign.key.clone().or_else(named).ok_or_else(|| {
        Failure::Wrong(format!(
            "to act as {0} takes the key of an {0}\n  write: --key FILE, or ELBOWROOM_KEY=FILE in the environment",
            class.name()
        ))
    })?;
    Ok(PrivateKey::read(&file)?)
}

fn keygen(args: &KeygenArgs) -> Result<ExitStatus, Failure> {
    let class = AccessClass::from(args.class);
    if class == AccessClass::Operator {
        let what = "operators change nothing, so there is no key for them";
        return Err(Failure::Wrong(format!("{what}\n  write: --as programmer or --as integrator")));
    }
    let wrong = cannot_write(&args.out);
    let key = PrivateKey::generate(class, &args.name).map_err(&wrong)?;
    key.write(&args.out).map_err(&wrong)?;
    note(format_args!(
        "{}: the private key; keep it to yourself. The public one, for trusted-keys.toml, is on standard output.",
        args.out.display()
    ));
    print(&format!(
        "\n[[key]]   # {}\nclass = \"{}\"\nname = {}\npublic = \"{}\"\n",
        key.public().id(),
        class.name(),
        serde_json::Value::from(args.name.as_str()),
        key.public().to_hex()
    ))?;
    Ok(ExitStatus::Success)
}
