//! Objects and nodes of a 3DS file, before they are assembled.

use std::path::Path;

use super::chunk;
use super::keyframer::{self, FileNode};
use super::object::{self, Object};
use crate::Diagnostic;
use crate::warning_list::WarningList;

/// The content of a 3DS file.
pub(super) struct TdsFile {
    pub(super) objects: Vec<Object>,
    pub(super) nodes: Vec<FileNode>,
    pub(super) master_scale: f64,
}

/// Reads the chunks of objects and nodes.
pub(super) fn read(bytes: &[u8], file: &Path, warnings: &mut WarningList) -> Result<TdsFile, Diagnostic> {
    let mut content = TdsFile { objects: Vec::new(), nodes: Vec::new(), master_scale: 1.0 };
    let main = chunk::main(bytes, file)?;
    for section in main.children(file) {
        let section = section?;
        match section.id {
            0x3d3d => {
                for child in section.children(file) {
                    let child = child?;
                    match child.id {
                        0x4000 => content.objects.extend(object::read(&child, file)?),
                        0x0100 => content.master_scale = f64::from(child.cursor(file).f32()?),
                        _ => {}
                    }
                }
            }
            0xb000 => {
                for child in section.children(file) {
                    content.nodes.extend(keyframer::read(&child?, file, warnings)?);
                }
            }
            _ => {}
        }
    }
    Ok(content)
}
