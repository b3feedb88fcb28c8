//! The same problems solved by damped least squares with Pinocchio.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use elbowroom_kinematics::Chain;
use elbowroom_spatial::Vec3;

use crate::problem::IkProblem;

/// Prints one line of results, or the reason of a failure.
pub fn run(urdf: &Path, chain: &Chain, problems: &[IkProblem]) {
    let python = std::env::var("ELBOWROOM_PYTHON").unwrap_or_else(|_| "python3".into());
    match ask(&python, urdf, chain, problems) {
        Ok(text) => print!("{text}"),
        Err(e) => println!("  pinocchio: skipped, {python}: {e}"),
    }
}

fn ask(python: &str, urdf: &Path, chain: &Chain, problems: &[IkProblem]) -> std::io::Result<String> {
    let Some(first) = problems.first() else { return Ok(String::new()) };
    let names: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/any_point/pin_dls.py");
    let mut child = Command::new(python)
        .arg(script)
        .arg(urdf)
        .args([names.join(","), chain.links()[first.link.0].clone()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let text = lines(problems);
    let input = child.stdin.take();
    let writer = std::thread::spawn(move || input.map_or(Ok(()), |mut input| input.write_all(text.as_bytes())));
    let output = child.wait_with_output()?;
    let _ = writer.join();
    if !output.status.success() {
        return Err(std::io::Error::other(format!("pin_dls.py ended with {}", output.status)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// One line per problem: point and normal on the link, target point, target normal (or zeros), start.
fn lines(problems: &[IkProblem]) -> String {
    let mut text = String::new();
    for q in problems {
        let wanted = q.target.normal_in_root.map_or([0.0; 3], Vec3::to_array);
        let vectors =
            [q.point_in_link.to_array(), q.normal_in_link.to_array(), q.target.point_in_root.to_array(), wanted];
        for v in vectors.iter().flatten().chain(&q.start) {
            let _ = write!(text, "{v:?} ");
        }
        text.push('\n');
    }
    text
}
