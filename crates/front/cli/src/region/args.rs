//! Arguments of `elbowroom region`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use elbowroom::cell::ZoneLanguage;
use elbowroom::monitor::AccessClass;

/// Commands for sealed cells (docs/roles.md), and for the regions of any cell (docs/controllers.md).
#[derive(Debug, Subcommand)]
pub(crate) enum RegionCommand {
    /// Add regions: tables [region.NAME] from a file, or from standard input
    Add(AddArgs),
    /// Set or remove keys of a region
    Change(ChangeArgs),
    /// Remove a region
    Remove(RemoveArgs),
    /// Set or remove keys of the table `[monitor]`
    Laws(LawsArgs),
    /// Seal the present contents of a cell file
    Seal(SealArgs),
    /// Verify the seal and list all edits with time, author and changes
    Log(LogArgs),
    /// Generate a key pair: the private key goes to a file, the public key to standard output
    Keygen(KeygenArgs),
    /// Write the regions of a robot as zones of its controller
    Export(ExportArgs),
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Class {
    /// Read only
    Operator,
    /// May change temporary regions
    Programmer,
    /// May change everything
    Integrator,
}

impl From<Class> for AccessClass {
    fn from(class: Class) -> Self {
        match class {
            Class::Operator => Self::Operator,
            Class::Programmer => Self::Programmer,
            Class::Integrator => Self::Integrator,
        }
    }
}

/// The signer of an edit.
#[derive(Debug, Args)]
pub(crate) struct SignArgs {
    /// The access class of the edit
    #[arg(long = "as", value_name = "CLASS", value_enum)]
    pub(crate) class: Class,
    /// The private key of that class; default: the file named by the environment variable `ELBOWROOM_KEY`
    #[arg(long, value_name = "FILE")]
    pub(crate) key: Option<PathBuf>,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom region add cell.toml new.toml --as programmer --key p.key
  elbowroom teach cell.toml ... | elbowroom region add cell.toml - --as integrator --key i.key")]
pub(crate) struct AddArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The file with the tables; - reads standard input
    pub(crate) regions: PathBuf,
    #[command(flatten)]
    pub(crate) sign: SignArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom region change cell.toml cart radius=200 warning=300 --as programmer --key p.key
  elbowroom region change cell.toml cart 'base=[900, 0, 0]' --unset slow_to \\
    --as programmer --key p.key")]
pub(crate) struct ChangeArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The region
    pub(crate) region: String,
    #[command(flatten)]
    pub(crate) keys: KeysArgs,
    #[command(flatten)]
    pub(crate) sign: SignArgs,
}

/// Keys to set and to remove.
#[derive(Debug, Args)]
#[group(required = true, multiple = true)]
pub(crate) struct KeysArgs {
    /// Keys and values in cell-file syntax
    #[arg(value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) set: Vec<(String, String)>,
    /// A key to remove; may be repeated
    #[arg(long, value_name = "KEY")]
    pub(crate) unset: Vec<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  elbowroom region remove cell.toml cart --as programmer --key p.key --note 'no cart any more'")]
pub(crate) struct RemoveArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The region
    pub(crate) region: String,
    #[command(flatten)]
    pub(crate) sign: SignArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  elbowroom region laws cell.toml stopping_distance=true reaction_ms=8 \\
    --as integrator --key i.key")]
pub(crate) struct LawsArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    #[command(flatten)]
    pub(crate) keys: KeysArgs,
    #[command(flatten)]
    pub(crate) sign: SignArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  elbowroom region seal cell.toml --as integrator --key i.key --note 'after commissioning'")]
pub(crate) struct SealArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    #[command(flatten)]
    pub(crate) sign: SignArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 if the cell is as sealed; 1 if it differs;
2 if the log does not match its signatures.")]
pub(crate) struct LogArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  elbowroom region keygen --as integrator --name 'integration, line 4' \\
    --out integrator.key >> trusted-keys.toml")]
pub(crate) struct KeygenArgs {
    /// The access class of the key
    #[arg(long = "as", value_name = "CLASS", value_enum)]
    pub(crate) class: Class,
    /// The owner of the key
    #[arg(long, value_name = "NAME")]
    pub(crate) name: String,
    /// The new file for the private key
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Language {
    /// ABB RAPID: World Zones, as a module
    Rapid,
    /// KUKA KRL: Cartesian workspaces, as lines of $custom.dat and $machine.dat
    Krl,
}

impl From<Language> for ZoneLanguage {
    fn from(language: Language) -> Self {
        match language {
            Language::Rapid => Self::Rapid,
            Language::Krl => Self::Krl,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom region export cell.toml --robot r1 --to rapid --out zones.mod
  elbowroom region export cell.toml --robot r2 --to krl --frame world
  elbowroom region export cell.toml --to rapid --json | jq '.regions[].missing'

Exit status: 0 if the text expresses all regions of the robot; 1 if something is missing, which is
named on standard error and in a comment.")]
pub(crate) struct ExportArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The robot; default: the only one
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// The language of the controller
    #[arg(long, value_enum)]
    pub(crate) to: Language,
    /// The frame that is the controller's world: a link that no joint moves, or world, that of the cell; default: the
    /// root link
    #[arg(long, value_name = "LINK")]
    pub(crate) frame: Option<String>,
    /// Write the text to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Print one JSON document, which contains the text
    #[arg(long)]
    pub(crate) json: bool,
}

fn key_value(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("write KEY=VALUE, as radius=150")?;
    Ok((key.trim().to_owned(), value.trim().to_owned()))
}
