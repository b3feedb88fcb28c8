//! The generated parts of the documents: keys of cell files, verbs and their options. They are written, or compared
//! with the committed documents.

mod commands;
mod parts;

use std::path::Path;

use parts::Part;

/// Path and text of a document.
type Document = (&'static str, String);

/// Writes the generated parts into the documents.
pub fn write(root: &Path) -> Result<(), String> {
    for (name, text) in documents(root)? {
        std::fs::write(root.join(name), text).map_err(|e| format!("{name}: {e}"))?;
        println!("{name}");
    }
    Ok(())
}

/// Compares the documents with the generated parts.
pub fn check(root: &Path) -> Result<(), String> {
    let documents = documents(root)?;
    let differs = |(name, text): &&Document| read(root, name).is_ok_and(|there| there != *text);
    let wrong: Vec<&str> = documents.iter().filter(differs).map(|(name, _)| *name).collect();
    if wrong.is_empty() {
        println!("reference: {} documents have the keys, verbs and options of the code", documents.len());
        return Ok(());
    }
    Err(format!("not the keys, verbs or options of the code; run `cargo xtask reference`\n  {}", wrong.join("\n  ")))
}

/// The documents with their generated parts as the code has them now.
fn documents(root: &Path) -> Result<Vec<Document>, String> {
    let keys = elbowroom_cell::key_reference();
    let commands = commands::Commands::read(root)?;
    let all = [
        ("docs/cell-file.md", keys),
        ("docs/commands.md", vec![("verbs", commands.table()?)]),
        ("docs/options.md", vec![("options", commands.options())]),
    ];
    let fill = |(name, parts): (&'static str, Vec<Part>)| -> Result<Document, String> {
        let text = parts::filled(&read(root, name)?, &parts).map_err(|e| format!("{name}: {e}"))?;
        Ok((name, text))
    };
    all.into_iter().map(fill).collect()
}

fn read(root: &Path, name: &str) -> Result<String, String> {
    std::fs::read_to_string(root.join(name)).map_err(|e| format!("{name}: {e}"))
}
