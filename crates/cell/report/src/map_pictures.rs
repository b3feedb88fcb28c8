//! Images of slices of a map.

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use elbowroom_cspace::GridAxis;
use elbowroom_formats::WholeFile;
use elbowroom_query::map::CellMap;

use crate::tables::escape;
use crate::{palette, png};

/// Smallest number of pixels along the shorter side.
const SMALLEST: usize = 180;
const FREE: [u8; 3] = [246, 246, 242];
/// Largest number of images; of more slices, only some get an image.
const MAX_IMAGES: usize = 200;

/// Writes images of slices and a page with them, `index.html`, to a folder; returns the number of images.
///
/// There is one image per cell of the first axis. The last axis points to the right, the one before it upwards; any
/// others are at the middle of their ranges.
///
/// # Errors
/// Errors of the file system.
pub fn write(map: &CellMap, folder: &Path) -> io::Result<usize> {
    fs::create_dir_all(folder)?;
    let axes = &map.axes;
    let (right, up) = (axes.len() - 1, axes.len().checked_sub(2));
    let planes = if axes.len() > 2 { axes[0].count() } else { 1 };
    let every = planes.div_ceil(MAX_IMAGES);
    let mut figures = String::new();
    let mut count = 0;
    for plane in (0..planes).step_by(every) {
        let mut cell: Vec<u16> = axes.iter().map(|a| (a.count() / 2) as u16).collect();
        if axes.len() > 2 {
            cell[0] = plane as u16;
        }
        let (width, height) = (axes[right].count(), up.map_or(1, |u| axes[u].count()));
        let scale = SMALLEST.div_ceil(width.min(height.max(width / 8))).clamp(1, 16);
        let rgb = draw(map, &mut cell, [right, up.unwrap_or(right)], width, height, scale);
        let name = format!("slice_{plane:03}.png");
        WholeFile::write(&folder.join(&name), |out| png::write(out, width * scale, height * scale, &rgb))?;
        let title = if axes.len() > 2 { value(map, 0, axes[0].center(plane)) } else { String::new() };
        let image = format!("<img src=\"{name}\" alt=\"{title}\">");
        let _ = writeln!(figures, "<figure>{image}<figcaption>{title}</figcaption></figure>");
        count += 1;
    }
    WholeFile::write(&folder.join("index.html"), |out| out.write_all(page(map, &figures).as_bytes()))?;
    Ok(count)
}

/// Rows of RGB pixels, the largest value of the upward axis first.
fn draw(
    map: &CellMap,
    cell: &mut [u16],
    [right, up]: [usize; 2],
    width: usize,
    height: usize,
    scale: usize,
) -> Vec<u8> {
    let mut rgb = vec![0; 3 * width * height * scale * scale];
    for y in 0..height {
        for x in 0..width {
            if height > 1 {
                cell[up] = (height - 1 - y) as u16;
            }
            cell[right] = x as u16;
            let color = map.obstacles.iter().position(|o| o.blocks.is_blocked_cell(cell)).map_or(FREE, color);
            for row in y * scale..(y + 1) * scale {
                let start = 3 * (row * width * scale + x * scale);
                rgb[start..start + 3 * scale].chunks_exact_mut(3).for_each(|pixel| pixel.copy_from_slice(&color));
            }
        }
    }
    rgb
}

/// Colour of an obstacle.
fn color(index: usize) -> [u8; 3] {
    let hex = palette::of_index(index).trim_start_matches('#');
    let part = |i: usize| hex.get(i..i + 2).and_then(|h| u8::from_str_radix(h, 16).ok()).unwrap_or(0);
    [part(0), part(2), part(4)]
}

fn value(map: &CellMap, axis: usize, value: f64) -> String {
    let name = escape(map.axes[axis].joint());
    if map.is_angle[axis] { format!("{name} {:.1}°", value.to_degrees()) } else { format!("{name} {value:.3} m") }
}

fn page(map: &CellMap, figures: &str) -> String {
    let range = |i: usize, a: &GridAxis| format!("{} to {}", value(map, i, a.min()), value(map, i, a.max()));
    let last = map.axes.len() - 1;
    let mut text = format!("right: {}", range(last, &map.axes[last]));
    if let Some(up) = last.checked_sub(1) {
        let _ = write!(text, "; up: {}", range(up, &map.axes[up]));
    }
    for i in 1..last.saturating_sub(1) {
        let axis = &map.axes[i];
        let _ = write!(text, "; {}", value(map, i, axis.center(axis.count() / 2)));
    }
    let mut legend = String::new();
    for (i, o) in map.obstacles.iter().enumerate() {
        let _ = write!(legend, "<b style=\"color:{}\">■</b> {} ", palette::of_index(i), escape(&o.name));
    }
    let name = escape(&map.robot);
    format!(
        "<!DOCTYPE html><meta charset=\"utf-8\"><title>map of {name}</title>\
         <style>body{{font:15px sans-serif;margin:1em}}figure{{display:inline-block;margin:4px}}\
         figcaption{{text-align:center}}img{{border:1px solid #888;image-rendering:pixelated;max-width:24em}}</style>\
         <h1>map of {name}</h1><p>{text}</p><p>{legend}</p>{figures}"
    )
}
