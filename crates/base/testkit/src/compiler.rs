//! The compilers of C and C++ that some tests use, and how they link a library of the workspace.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Sanitizers that tests switch on where the compiler has them: bad addresses, leaks, undefined behaviour.
const SANITIZERS: [&str; 2] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

const C: &str = "-std=c99";
const CPP: &str = "-std=c++17";

/// The C compiler that `CC` names (default `cc`), for C99 with all warnings as errors. If it is missing, prints one
/// line on standard error and returns `None`.
pub fn c() -> Option<Command> {
    compiler("CC", "cc", C, "C")
}

/// The C++ compiler that `CXX` names (default `c++`), for C++17; otherwise like [`c`].
pub fn cpp() -> Option<Command> {
    compiler("CXX", "c++", CPP, "C++")
}

fn compiler(variable: &str, usual: &str, standard: &str, language: &str) -> Option<Command> {
    let program = std::env::var_os(variable).unwrap_or_else(|| usual.into());
    let is_there = Command::new(&program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !is_there.is_ok_and(|status| status.success()) {
        eprintln!("skipped: no {language} compiler {}", program.display());
        return None;
    }
    let mut command = Command::new(program);
    command.args([standard, "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2"]);
    Some(command)
}

/// The compiler with sanitizers, if programs that it makes so run. Otherwise prints one line and returns `None`.
///
/// `folder` gets a small program to try.
pub fn with_sanitizers(mut compiler: Command, folder: &Path) -> Option<Command> {
    let ending = if compiler.get_args().any(|argument| argument == CPP) { "cpp" } else { "c" };
    let (source, program) = (folder.join("sanitizers").with_extension(ending), folder.join("sanitizers"));
    std::fs::write(&source, "int main(void) { return 0; }\n").ok()?;
    compiler.args(SANITIZERS);
    let mut attempt = Command::new(compiler.get_program());
    attempt.args(compiler.get_args()).arg(&source).arg("-o").arg(&program);
    let is_made = attempt.stderr(Stdio::null()).status().is_ok_and(|status| status.success());
    if is_made && Command::new(&program).status().is_ok_and(|status| status.success()) {
        return Some(compiler);
    }
    eprintln!("skipped: programs of {} do not run with sanitizers", compiler.get_program().display());
    None
}

/// Compiles a program from a source, with further arguments of the linker after it.
///
/// # Panics
/// If the compiler refuses it; the message has the compiler's.
pub fn compile(mut compiler: Command, source: &Path, program: &Path, links: &[OsString]) {
    let output = compiler.arg(source).arg("-o").arg(program).args(links).output().expect("the compiler runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Arguments that link a shared library of the workspace, such as `elbowroom_capi`, which cargo has compiled beside the test
/// that calls this.
///
/// # Panics
/// If the library is not there.
pub fn linked(library: &str) -> Vec<OsString> {
    let folder = library_folder(library);
    let search_path = |option: &str| {
        let mut argument = OsString::from(option);
        argument.push(&folder);
        argument
    };
    vec![search_path("-L"), search_path("-Wl,-rpath,"), format!("-l{library}").into(), "-lm".into(), "-pthread".into()]
}

/// The folder of a shared library of the workspace, which cargo has compiled beside the test that calls this.
///
/// # Panics
/// If the library is not there.
pub fn library_folder(library: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test is a program");
    let folder = test.parent().expect("a program is in a folder").to_owned();
    let file = format!("{}{library}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    assert!(folder.join(&file).is_file(), "there is no {file} in {}", folder.display());
    folder
}
