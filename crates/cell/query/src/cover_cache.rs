//! A cache of sphere covers of links, in files.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use elbowroom_formats::WholeFile;
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_validity::{Ball, CoverSource, SphereCover, describe_cover};
use sha2::{Digest, Sha256};

/// Environment variable that names the directory, or switches the cache off.
const VARIABLE: &str = "ELBOWROOM_CACHE";
/// First bytes of a file.
const FORMAT: &[u8; 16] = b"elbowroom cover\x01";
/// Build time below which a cover is not kept.
const WORTH_KEEPING: Duration = Duration::from_millis(10);
const HASH_BYTES: usize = 32;
/// Size of a sphere, bytes: centre and radius.
const BALL_BYTES: usize = 32;

/// Cache of sphere covers in files, each named by the hash of the cover's input.
///
/// A damaged, foreign or missing file is written again; a file that cannot be written is omitted. The covers are the
/// same with and without the cache, and deleting it is safe.
///
/// A file contains the name and version of the format, the hash of the shapes, the numbers of outer and inner spheres,
/// the spheres, and a hash of everything before.
#[derive(Debug, Clone)]
pub struct CoverCache {
    /// Directory of the files; `None`: every cover is built.
    directory: Option<PathBuf>,
}

impl CoverCache {
    /// Creates a cache in a directory, which is created when the first cover is kept.
    pub fn in_directory(directory: &Path) -> Self {
        Self { directory: Some(directory.to_owned()) }
    }

    /// The cache of the user: `$ELBOWROOM_CACHE`, or `elbowroom` in `$XDG_CACHE_HOME`, `~/.cache` or `%LOCALAPPDATA%`.
    ///
    /// It is off if `ELBOWROOM_CACHE=off`, or if the user has none of these directories.
    pub fn of_user() -> Self {
        Self { directory: user_directory(|name| std::env::var_os(name)).map(|directory| directory.join("covers")) }
    }

    fn load(&self, hash: [u8; HASH_BYTES]) -> Option<SphereCover> {
        decode(&fs::read(self.file(hash)?).ok()?, hash)
    }

    fn save(&self, hash: [u8; HASH_BYTES], cover: &SphereCover) {
        let Some(file) = self.file(hash) else { return };
        let Some(directory) = file.parent() else { return };
        // A failed write costs only time: the next run builds the cover again.
        let _ = fs::create_dir_all(directory)
            .and_then(|()| WholeFile::write(&file, |out| out.write_all(&encode(cover, hash))));
    }

    fn file(&self, hash: [u8; HASH_BYTES]) -> Option<PathBuf> {
        let digit = |half: u8| char::from_digit(half.into(), 16).unwrap_or('0');
        let name: String = hash.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect();
        Some(self.directory.as_ref()?.join(name).with_extension("cover"))
    }
}

impl CoverSource for CoverCache {
    fn cover(&self, shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<SphereCover> {
        if self.directory.is_none() {
            return SphereCover::new(shapes, slack_m);
        }
        let mut hash = Sha256::new();
        describe_cover(shapes, slack_m, &mut |number| hash.update(number));
        let hash = hash.finalize().into();
        if let Some(cover) = self.load(hash) {
            return Some(cover);
        }
        let begin = Instant::now();
        let cover = SphereCover::new(shapes, slack_m)?;
        if begin.elapsed() >= WORTH_KEEPING {
            self.save(hash, &cover);
        }
        Some(cover)
    }
}

/// The directory for all caches, from the environment variables.
///
/// Relative paths count only in `ELBOWROOM_CACHE` (XDG Base Directory Specification).
fn user_directory(variable: impl Fn(&str) -> Option<std::ffi::OsString>) -> Option<PathBuf> {
    let path = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    match variable(VARIABLE) {
        Some(named) if !named.is_empty() => Some(PathBuf::from(named)).filter(|path| path.as_os_str() != "off"),
        _ => path("XDG_CACHE_HOME")
            .or_else(|| path("HOME").map(|home| home.join(".cache")))
            .or_else(|| path("LOCALAPPDATA"))
            .map(|caches| caches.join("elbowroom")),
    }
}

fn encode(cover: &SphereCover, hash: [u8; HASH_BYTES]) -> Vec<u8> {
    let mut bytes = [FORMAT.as_slice(), &hash].concat();
    for balls in [&cover.outer, &cover.inner] {
        bytes.extend((balls.len() as u64).to_le_bytes());
    }
    for ball in cover.outer.iter().chain(&cover.inner) {
        let Vec3 { x, y, z } = ball.centre;
        bytes.extend([x, y, z, ball.radius].iter().flat_map(|v| v.to_le_bytes()));
    }
    let content = Sha256::digest(&bytes);
    bytes.extend(content);
    bytes
}

/// Decodes the bytes of [`encode`] for these shapes; `None` for other bytes.
fn decode(bytes: &[u8], hash: [u8; HASH_BYTES]) -> Option<SphereCover> {
    let (content, of_content) = bytes.split_last_chunk::<HASH_BYTES>()?;
    if Sha256::digest(content).as_slice() != of_content {
        return None;
    }
    let rest = content.strip_prefix(FORMAT)?.strip_prefix(&hash)?;
    let (outer, rest) = rest.split_first_chunk().map(|(n, rest)| (u64::from_le_bytes(*n), rest))?;
    let (inner, rest) = rest.split_first_chunk().map(|(n, rest)| (u64::from_le_bytes(*n), rest))?;
    let (balls, []) = rest.as_chunks::<BALL_BYTES>() else { return None };
    if outer.checked_add(inner)? != balls.len() as u64 {
        return None;
    }
    let number = |ball: &[u8; BALL_BYTES], i: usize| {
        let bytes = ball[8 * i..].first_chunk().copied().unwrap_or_default();
        f64::from_le_bytes(bytes)
    };
    let ball = |b: &[u8; BALL_BYTES]| Ball {
        centre: Vec3::new(number(b, 0), number(b, 1), number(b, 2)),
        radius: number(b, 3),
    };
    let (outer, inner) = balls.split_at(usize::try_from(outer).ok()?);
    Some(SphereCover { outer: outer.iter().map(ball).collect(), inner: inner.iter().map(ball).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cover() -> SphereCover {
        let ball = |i: i32| Ball { centre: Vec3::new(f64::from(i), 0.1, -0.0), radius: 0.5 };
        SphereCover { outer: (0..7).map(ball).collect(), inner: (7..9).map(ball).collect() }
    }

    #[test]
    fn a_damaged_file_gives_no_cover() {
        let (hash, cover) = ([7; HASH_BYTES], cover());
        let bytes = encode(&cover, hash);
        assert_eq!(decode(&bytes, hash), Some(cover));
        assert_eq!(decode(&bytes, [8; HASH_BYTES]), None, "a file of other shapes");
        for length in 0..bytes.len() {
            assert_eq!(decode(&bytes[..length], hash), None, "cut to {length} bytes");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << (at % 8);
            assert_eq!(decode(&damaged, hash), None, "byte {at}");
        }
        assert_eq!(decode(&[bytes.as_slice(), &[0]].concat(), hash), None, "longer");
    }

    #[test]
    fn directories_of_users() {
        let directory = |variables: &[(&str, &str)]| {
            user_directory(|name| variables.iter().find(|(n, _)| *n == name).map(|(_, value)| value.into()))
        };
        let root = if cfg!(windows) { "C:\\" } else { "/" };
        let path = |rest: &str| Some(Path::new(root).join(rest));
        let under = |rest: &str| format!("{root}{rest}");
        assert_eq!(directory(&[("HOME", &under("h"))]), path("h/.cache/elbowroom"));
        let both = [("HOME", under("h")), ("XDG_CACHE_HOME", under("x"))];
        assert_eq!(directory(&both.each_ref().map(|(n, v)| (*n, v.as_str()))), path("x/elbowroom"));
        assert_eq!(directory(&[("HOME", &under("h")), ("XDG_CACHE_HOME", "x")]), path("h/.cache/elbowroom"));
        assert_eq!(directory(&[("HOME", &under("h")), (VARIABLE, "off")]), None);
        assert_eq!(directory(&[("HOME", &under("h")), (VARIABLE, "mine")]), Some("mine".into()));
        assert_eq!(directory(&[]), None);
    }
}
