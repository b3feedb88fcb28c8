//! Files that the server serves; all are compiled into the program.

use std::io::{self, Write as _};

use axum::body::Bytes;
use elbowroom_report::shared_assets;
use flate2::Compression;
use flate2::write::GzEncoder;

const PAGE: &str = include_str!("../../assets/page.html");
const STYLE: &str = include_str!("../../assets/view.css");
/// The scripts in order: each uses scripts before it.
const SCRIPTS: [&str; 17] = [
    shared_assets::DOM,
    shared_assets::PACKING,
    include_str!("../../assets/link.js"),
    include_str!("../../assets/data.js"),
    shared_assets::KINEMATICS,
    shared_assets::STAGE,
    include_str!("../../assets/units.js"),
    include_str!("../../assets/instant.js"),
    include_str!("../../assets/scene.js"),
    include_str!("../../assets/history.js"),
    include_str!("../../assets/tables.js"),
    include_str!("../../assets/jog.js"),
    include_str!("../../assets/drag.js"),
    include_str!("../../assets/draw_scene.js"),
    include_str!("../../assets/draw.js"),
    include_str!("../../assets/theme.js"),
    include_str!("../../assets/player.js"),
];

/// A file, compressed as gzip.
#[derive(Debug, Clone)]
pub(crate) struct Asset {
    pub(crate) path: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) gzip: Bytes,
}

/// Returns the files that need no token: they contain nothing about the cell.
pub(crate) fn assets() -> io::Result<Vec<Asset>> {
    let script = format!("(async () => {{\n'use strict';\n{}\n}})();\n", SCRIPTS.join("\n"));
    let javascript = "text/javascript; charset=utf-8";
    let asset = |path, kind, text: &str| -> io::Result<Asset> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::new(6));
        encoder.write_all(text.as_bytes())?;
        Ok(Asset { path, kind, gzip: encoder.finish()?.into() })
    };
    Ok(vec![
        asset("/", "text/html; charset=utf-8", PAGE)?,
        asset("/view.css", "text/css; charset=utf-8", STYLE)?,
        asset("/three.js", javascript, shared_assets::THREE)?,
        asset("/view.js", javascript, &script)?,
    ])
}
