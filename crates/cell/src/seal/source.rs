//! What carries a region: it decides where the region is, and so is sealed with it.

use elbowroom_monitor::{Region, SourceLimits};
use sha2::{Digest, Sha256};

use super::hex;
use super::state::{key, text};
use crate::file::node::{Data, Entry, Node};
use crate::{Cell, CellFile, CellRegion, Drive, Follow, Mover};

/// What a region follows.
pub(super) struct Source<'a> {
    /// Its kind and name: `encoder belt`.
    name: String,
    /// Its table, where it is an object: objects that no region follows are not sealed.
    pub object: Option<&'a Entry>,
    /// Names of the files that it was read from, as the cell file has them.
    pub files: Vec<&'a Node>,
    /// SHA-256 (hex) of all that decides where it is, files read.
    pub checksum: String,
}

impl<'a> Source<'a> {
    /// `None` for a region that stands.
    pub fn of(file: &'a CellFile, cell: &Cell, region: &CellRegion) -> Option<Self> {
        let follow = region.follow?;
        let find = |path: &[&str]| find(&file.entries, path);
        let value = |path: &[&str]| find(path).map(|e| &e.node);
        let encoder_file = |name: &str| value(&["encoder", name, "file"]);
        let (name, object, files) = match follow {
            Follow::Robot { robot, .. } => (format!("robot {}", key(&cell.robots[robot].name)), None, [None, None]),
            Follow::Encoder(i) => {
                let name = &cell.encoders[i].name;
                (format!("encoder {}", key(name)), None, [encoder_file(name), None])
            }
            Follow::Object(i) => {
                let name = &cell.objects[i].name;
                let belt = mover(cell, i).and_then(|m| match &m.drive {
                    Drive::Belt(encoder) => encoder_file(&encoder.name),
                    Drive::Way(_) => None,
                });
                let files = [value(&["object", name, "mesh"]), belt];
                (format!("object {}", key(name)), find(&["object", name]), files)
            }
            Follow::Poses(_) => {
                let poses = value(&["region", &region.region.name, "follow", "poses"]);
                ("poses".to_owned(), None, [poses, None])
            }
        };
        let checksum = checksum(cell, follow, &region.source_limits);
        Some(Self { name, object, files: files.into_iter().flatten().collect(), checksum })
    }

    /// Its name and its files: `encoder belt from "belt.csv"`.
    pub fn title(&self) -> String {
        let files: Vec<String> = self.files.iter().map(|f| text(f)).collect();
        if files.is_empty() { self.name.clone() } else { format!("{} from {}", self.name, files.join(" and ")) }
    }
}

/// The entry under these keys, one in the other.
fn find<'a>(entries: &'a [Entry], path: &[&str]) -> Option<&'a Entry> {
    let (first, rest) = path.split_first()?;
    let entry = entries.iter().find(|e| e.key == *first)?;
    match &entry.node.data {
        _ if rest.is_empty() => Some(entry),
        Data::Table(entries) => find(entries, rest),
        _ => None,
    }
}

fn mover(cell: &Cell, object: usize) -> Option<&Mover> {
    cell.movers.iter().find(|m| m.object == object)
}

/// Of the source as it was read, not of the text of its files: what was read is what is run. Every kind and every field is
/// named, so that a new one cannot be forgotten.
fn checksum(cell: &Cell, follow: Follow, limits: &SourceLimits) -> String {
    let mut hash = Sha256::new();
    // -0 and 0 are one number.
    let mut number = |v: f64| hash.update((v + 0.0).to_bits().to_le_bytes());
    let SourceLimits { speed_m_s, turn_rad_s, wrap_m } = limits;
    [*speed_m_s, *turn_rad_s].into_iter().chain(wrap_m.unwrap_or_default().to_array()).for_each(&mut number);
    match follow {
        // The robot has a checksum of its own.
        Follow::Robot { robot: _, link, in_link } => {
            number(link.0 as f64);
            in_link.to_rows().into_iter().flatten().for_each(&mut number);
        }
        Follow::Encoder(i) => cell.encoders[i].numbers(&mut number),
        Follow::Poses(i) => cell.pose_tracks[i].numbers(&mut number),
        Follow::Object(i) => {
            let at_rest = object(cell, i, &mut number);
            hash.update(at_rest);
        }
    }
    hex::encode(&hash.finalize())
}

/// The numbers of an object's motion; returned is the checksum of its shape where it rests.
fn object(cell: &Cell, index: usize, number: &mut dyn FnMut(f64)) -> String {
    let object = &cell.objects[index];
    let rest_in_world = match mover(cell, index) {
        None => {
            number(0.0);
            object.in_world
        }
        Some(Mover { object: _, rest_in_world, drive }) => {
            match drive {
                Drive::Belt(encoder) => {
                    number(1.0);
                    encoder.numbers(number);
                }
                Drive::Way(way) => {
                    number(2.0);
                    way.numbers(number);
                }
            }
            *rest_in_world
        }
    };
    Region::solid(&object.name, object.shape.clone(), rest_in_world).checksum()
}
