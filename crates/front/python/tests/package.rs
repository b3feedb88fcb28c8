//! The package, put together from its sources and the extension module that cargo has compiled beside these tests.

use std::path::{Path, PathBuf};
use std::process::Command;

use elbowroom_testkit::compiler::library_folder;
use elbowroom_testkit::folder::workspace;
use elbowroom_testkit::python::with_modules;
use tempfile::TempDir;

/// A folder with the package, and the interpreter.
pub struct Package {
    python: String,
    folder: TempDir,
}

impl Package {
    pub fn new() -> Option<Self> {
        let python = with_modules("numpy, pytest, hypothesis, mypy", "numpy, pytest, hypothesis and mypy")?;
        let folder = tempfile::tempdir().expect("a folder");
        copy(&workspace().join("python/elbowroom"), &folder.path().join("elbowroom"));
        let library = library_folder("_elbowroom").join("lib_elbowroom.so");
        std::fs::copy(library, folder.path().join("elbowroom/_elbowroom.abi3.so")).expect("the extension module");
        Some(Self { python, folder })
    }

    /// Runs a module of Python in the workspace, with the package and the command.
    pub fn run(&self, words: &[&str]) {
        let mut run = Command::new(&self.python);
        run.arg("-m").args(words).current_dir(workspace()).env("PYTHONPATH", self.folder.path());
        run.env("PYTHONDONTWRITEBYTECODE", "1").env("MYPYPATH", self.folder.path());
        if let Some(command) = command() {
            run.env("ELBOWROOM_COMMAND", command);
        }
        let output = run.output().expect("Python starts");
        let text = [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).join("\n");
        assert!(output.status.success(), "{words:?}: {}\n{text}", output.status);
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("the sources").flatten() {
        if entry.path().is_dir() {
            copy(&entry.path(), &to.join(entry.file_name()));
        }
        let is_source =
            entry.path().extension().is_some_and(|e| ["py", "pyi", "typed"].iter().any(|known| e == *known));
        if is_source {
            std::fs::copy(entry.path(), to.join(entry.file_name())).expect("a file");
        }
    }
}

/// The command, if it is compiled.
fn command() -> Option<PathBuf> {
    let command = library_folder("_elbowroom").with_file_name("elbowroom");
    command.is_file().then_some(command)
}

#[test]
fn the_tests_in_python_pass() {
    let Some(package) = Package::new() else { return };
    package.run(&["pytest", "-q", "-p", "no:cacheprovider", "--ignore", "python/tests/test_sweep.py", "python/tests"]);
}

#[test]
fn the_examples_of_the_documentation_print_what_they_say() {
    let Some(package) = Package::new() else { return };
    let script = package.path().join("doctests.py");
    std::fs::write(
        &script,
        "import doctest, elbowroom, numpy\n\
         from elbowroom import poses\n\
         parse, runner = doctest.DocTestParser().get_doctest, doctest.DocTestRunner()\n\
         classes = [shown for shown in vars(elbowroom).values() if isinstance(shown, type) and '>>>' in (shown.__doc__ or '')]\n\
         for shown in (elbowroom, *classes, poses.matrix, poses.row):\n    \
             runner.run(parse(shown.__doc__, {'elbowroom': elbowroom, 'np': numpy, **vars(poses)}, shown.__name__, None, 0))\n\
         assert len(classes) == 11 and runner.tries > 30 and runner.failures == 0, (runner.tries, runner.failures)\n",
    )
    .expect("a script");
    package.run(&["doctests"]);
}

#[test]
fn types_are_strict_and_the_stubs_are_those_of_the_module() {
    let Some(package) = Package::new() else { return };
    let folder = package.path().join("elbowroom").display().to_string();
    // The types of NumPy are read once; mypy notices changes.
    let cache = library_folder("_elbowroom").with_file_name("mypy").display().to_string();
    package.run(&["mypy", "--strict", "--cache-dir", &cache, &folder]);
    package.run(&["mypy.stubtest", "elbowroom._elbowroom"]);
}
