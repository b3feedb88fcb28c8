//! The source that moves a region. It determines the region's pose, so it is sealed with the region.

use elbowroom_access::hex;
use elbowroom_formats::toml_tables::{Data, Entry, Node};
use elbowroom_monitor::{Region, SourceLimits};
use elbowroom_robot::ObjectId;
use sha2::{Digest, Sha256};

use super::value::{key, text};
use crate::{Cell, CellFile, CellRegion, Drive, Follow, Frames, MovingObject};

/// The source that a region follows.
pub(super) struct SealedSource<'a> {
    /// Its kind and name: `encoder belt`.
    name: String,
    /// Its table, if it is an object. Objects that no region follows are not sealed.
    pub object: Option<&'a Entry>,
    /// Names of its files, as in the cell file.
    pub files: Vec<&'a Node>,
    /// SHA-256 (hex) of all data that defines its pose, files included.
    pub checksum: String,
}

impl<'a> SealedSource<'a> {
    /// The source of a region; `None` for a fixed region.
    pub fn of(file: &'a CellFile, cell: &Cell, region: &CellRegion) -> Option<Self> {
        let follow = region.follow?;
        let find = |path: &[&str]| find(&file.entries, path);
        let value = |path: &[&str]| find(path).map(|e| &e.node);
        let encoder_file = |name: &str| value(&["encoder", name, "file"]);
        let (name, object, files) = match follow {
            Follow::Robot { robot, .. } => (format!("robot {}", key(&cell.robots[robot.0].name)), None, [None, None]),
            Follow::Encoder(i) => {
                let name = &cell.frame_sources.encoders[i].name;
                (format!("encoder {}", key(name)), None, [encoder_file(name), None])
            }
            Follow::Object(i) => {
                let name = &cell.objects[i.0].name;
                let belt = moving_object(cell, i).and_then(|m| match &m.drive {
                    Drive::Belt(encoder) => encoder_file(&encoder.name),
                    Drive::Path(_) => None,
                });
                let files = [value(&["object", name, "mesh"]), belt];
                (format!("object {}", key(name)), find(&["object", name]), files)
            }
            Follow::Poses(_) => {
                let poses = value(&["region", &region.region.name, "follow", "poses"]);
                ("poses".to_owned(), None, [poses, None])
            }
        };
        let checksum = source_checksum(cell, follow, &region.source_limits);
        Some(Self { name, object, files: files.into_iter().flatten().collect(), checksum })
    }

    /// Its name and its files: `encoder belt from "belt.csv"`.
    pub fn title(&self) -> String {
        let files: Vec<String> = self.files.iter().map(|f| text(f)).collect();
        if files.is_empty() { self.name.clone() } else { format!("{} from {}", self.name, files.join(" and ")) }
    }
}

/// The entry under nested keys.
fn find<'a>(entries: &'a [Entry], path: &[&str]) -> Option<&'a Entry> {
    let (first, rest) = path.split_first()?;
    let entry = entries.iter().find(|e| e.key == *first)?;
    match &entry.node.data {
        _ if rest.is_empty() => Some(entry),
        Data::Table(entries) => find(entries, rest),
        _ => None,
    }
}

fn moving_object(cell: &Cell, object: ObjectId) -> Option<&MovingObject> {
    cell.moving_objects.iter().find(|m| m.object == object)
}

/// Checksum of the source as it was read, not of the text of its files.
///
/// Every variant and every field is named, so that a new one cannot be forgotten.
pub(crate) fn source_checksum(cell: &Cell, follow: Follow, limits: &SourceLimits) -> String {
    let mut hash = Sha256::new();
    // -0 and 0 have the same checksum.
    let mut number = |v: f64| hash.update((v + 0.0).to_bits().to_le_bytes());
    let SourceLimits { speed_m_s, turn_rad_s, wrap_m } = limits;
    [*speed_m_s, *turn_rad_s].into_iter().chain(wrap_m.unwrap_or_default().to_array()).for_each(&mut number);
    match follow {
        // The robot has its own checksum.
        Follow::Robot { robot: _, link, in_link } => {
            number(link.0 as f64);
            in_link.to_rows().into_iter().flatten().for_each(&mut number);
        }
        Follow::Encoder(i) => cell.frame_sources.encoders[i].numbers(&mut number),
        Follow::Poses(i) => cell.frame_sources.pose_tracks[i].numbers(&mut number),
        Follow::Object(i) => {
            let at_rest = object(cell, i, &mut number);
            hash.update(at_rest);
        }
    }
    if Frames::new(cell).measured_source(&follow).is_some() {
        hash.update(b"measured");
    }
    hex::encode(&hash.finalize())
}

/// Passes the numbers of an object's motion; returns the checksum of its shape at its initial pose.
fn object(cell: &Cell, id: ObjectId, number: &mut dyn FnMut(f64)) -> String {
    let object = &cell.objects[id.0];
    let rest_in_world = match moving_object(cell, id) {
        None => {
            number(0.0);
            object.in_world
        }
        Some(MovingObject { object: _, rest_in_world, drive }) => {
            match drive {
                Drive::Belt(encoder) => {
                    number(1.0);
                    encoder.numbers(number);
                }
                Drive::Path(path) => {
                    number(2.0);
                    path.numbers(number);
                }
            }
            *rest_in_world
        }
    };
    Region::solid(&object.name, object.shape.clone(), rest_in_world).checksum()
}
