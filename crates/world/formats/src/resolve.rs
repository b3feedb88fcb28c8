//! Resolution of the `filename` of a URDF to a file.

use std::fmt;
use std::path::{Path, PathBuf};

/// Largest number of searched directories above the file, and of entries of each that are searched for a `package.xml`.
const MAX_LEVELS: usize = 24;
const MAX_ENTRIES: usize = 2000;

/// Why a reference refers to no file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Unresolved {
    /// The package is there, but it has no such file.
    NotInPackage { path: String, package: PathBuf },
    /// No package of this name is in a folder or above it.
    NoPackage { name: String, folder: PathBuf },
    /// The file does not exist.
    NoFile(PathBuf),
    /// References with this scheme are not followed.
    Scheme(String),
    /// The reference was not among those that were loaded.
    NotLoaded,
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotInPackage { path, package } => write!(f, "there is no {path} in {}", package.display()),
            Self::NoPackage { name, folder } => {
                write!(f, "no directory called `{name}`, and none with that name in its package.xml, in ")?;
                if folder.as_os_str().is_empty() {
                    f.write_str("the current folder or above")
                } else {
                    write!(f, "{} or above", folder.display())
                }
            }
            Self::NoFile(file) => write!(f, "there is no file {}", file.display()),
            Self::Scheme(scheme) => write!(f, "`{scheme}://` is not followed"),
            Self::NotLoaded => f.write_str("it was not loaded"),
        }
    }
}

/// Returns the file to which a reference refers.
///
/// `package://NAME/PATH` (and `model://`) is searched in every directory from `base` upward: in a directory named NAME,
/// or with a `package.xml` of that name, in this directory or directly below. `file://` is absolute; all other references
/// are relative to `base`. The case of the last component of the path may differ.
pub(crate) fn resolve(reference: &str, base: &Path) -> Result<PathBuf, Unresolved> {
    let reference = reference.trim();
    let try_both =
        |make: &dyn Fn(&str) -> Option<PathBuf>| make(reference).or_else(|| make(&percent_decode(reference)));
    let found = try_both(&|text| {
        let text = text.replace('\\', "/");
        match text.split_once("://") {
            Some(("package" | "model", rest)) => in_package(rest, base),
            Some(("file", rest)) => existing_file(Path::new(rest)),
            Some(_) => None,
            None => existing_file(&base.join(&text)),
        }
    });
    found.ok_or_else(|| why_unresolved(reference, base))
}

fn why_unresolved(reference: &str, base: &Path) -> Unresolved {
    match reference.split_once("://") {
        Some(("package" | "model", rest)) => {
            let (name, path) = rest.split_once('/').unwrap_or((rest, ""));
            match package_directories(name, base).next() {
                Some(package) => Unresolved::NotInPackage { path: path.to_owned(), package },
                None => Unresolved::NoPackage { name: name.to_owned(), folder: base.to_owned() },
            }
        }
        Some(("file", path)) => Unresolved::NoFile(path.into()),
        Some((scheme, _)) => Unresolved::Scheme(scheme.to_owned()),
        None => Unresolved::NoFile(base.join(reference)),
    }
}

fn in_package(rest: &str, base: &Path) -> Option<PathBuf> {
    let (name, path) = rest.split_once('/')?;
    package_directories(name, base).find_map(|directory| existing_file(&directory.join(path.trim_start_matches('/'))))
}

fn package_directories<'a>(name: &'a str, base: &Path) -> impl Iterator<Item = PathBuf> + 'a {
    let start = std::path::absolute(base).unwrap_or_else(|_| base.to_owned());
    let levels: Vec<PathBuf> = start.ancestors().take(MAX_LEVELS).map(Path::to_owned).collect();
    let by_directory = levels.clone().into_iter().flat_map(move |level| {
        let is_itself = level.file_name().is_some_and(|n| n == name) || package_name(&level).as_deref() == Some(name);
        let below = level.join(name);
        [is_itself.then_some(level), below.is_dir().then_some(below)].into_iter().flatten()
    });
    // Reading the package.xml of every subdirectory is slow, so it comes last.
    by_directory.chain(levels.into_iter().flat_map(move |level| subdirectories_named(name, &level)))
}

fn subdirectories_named(name: &str, level: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(level) else { return Vec::new() };
    let directories = entries.flatten().take(MAX_ENTRIES).map(|e| e.path());
    let mut found: Vec<PathBuf> = directories.filter(|d| package_name(d).as_deref() == Some(name)).collect();
    found.sort();
    found
}

/// The `<name>` of a directory's `package.xml`.
fn package_name(directory: &Path) -> Option<String> {
    let manifest = directory.join("package.xml");
    let size = std::fs::metadata(&manifest).ok().filter(std::fs::Metadata::is_file)?.len();
    if size > 1 << 20 {
        return None;
    }
    let text = std::fs::read_to_string(&manifest).ok()?;
    let document = roxmltree::Document::parse(&text).ok()?;
    Some(crate::xml::child(document.root_element(), "name")?.text()?.trim().to_owned())
}

/// The path if it is a file, or the only file in the directory whose name differs only in case.
fn existing_file(path: &Path) -> Option<PathBuf> {
    if path.is_file() {
        return Some(path.to_owned());
    }
    let wanted = path.file_name()?;
    let entries = std::fs::read_dir(path.parent()?).ok()?;
    let mut same =
        entries.flatten().take(MAX_ENTRIES).filter(|e| e.file_name().eq_ignore_ascii_case(wanted)).map(|e| e.path());
    match (same.next(), same.next()) {
        (Some(only), None) if only.is_file() => Some(only),
        _ => None,
    }
}

/// Decodes `%20` and similar sequences; other text stays unchanged.
pub(crate) fn percent_decode(text: &str) -> String {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..2).filter(|d| first == b'%' && d.iter().all(u8::is_ascii_hexdigit));
        let byte = digits.and_then(|d| std::str::from_utf8(d).ok()).and_then(|d| u8::from_str_radix(d, 16).ok());
        out.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_found_beside_and_above() {
        let root = tempfile::tempdir().unwrap();
        let make = |path: &str, text: &str| {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        make("arm_support/meshes/Link.STL", "");
        make("cloned-repository/package.xml", "<package><name>gripper</name></package>");
        make("cloned-repository/finger a.stl", "");
        make("arm_support/urdf/deep/arm.urdf", "");
        let base = root.path().join("arm_support/urdf/deep");
        let ends = |reference: &str| resolve(reference, &base).map(|p| p.strip_prefix(root.path()).unwrap().to_owned());
        assert_eq!(ends("package://arm_support/meshes/Link.STL").unwrap(), Path::new("arm_support/meshes/Link.STL"));
        assert_eq!(ends("package://arm_support/meshes/link.stl").unwrap(), Path::new("arm_support/meshes/Link.STL"));
        assert_eq!(ends("package://gripper/finger%20a.stl").unwrap(), Path::new("cloned-repository/finger a.stl"));
        assert_eq!(ends("../../meshes/Link.stl").unwrap().file_name().unwrap(), "Link.STL");
        assert!(ends("package://nobody/a.stl").unwrap_err().to_string().contains("nobody"));
        assert_eq!(ends("http://example.org/a.stl").unwrap_err(), Unresolved::Scheme("http".into()));
    }

    #[test]
    fn the_search_from_the_current_folder_is_said() {
        let why = resolve("package://nobody/a.stl", Path::new("")).unwrap_err().to_string();
        assert!(why.ends_with("in the current folder or above"), "{why}");
    }

    #[test]
    fn percent_codes_decode_and_others_stay() {
        assert_eq!(percent_decode("a%20b%2fc%zz%"), "a b/c%zz%");
    }
}
