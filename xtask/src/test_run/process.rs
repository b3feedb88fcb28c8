//! Process of a test unit: started, read, and stopped if it takes too long.

use std::io::Read;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::programs::Program;
use super::units::Unit;

/// Limits of a process.
#[derive(Debug, Clone, Copy)]
pub struct Limit<'a> {
    /// Longest time; a process that takes longer hangs.
    pub longest: Duration,
    /// Set by another thread when the result is no longer needed.
    pub cancelled: Option<&'a AtomicBool>,
}

/// Result of a unit: whether it succeeded, whether it was stopped because it took too long, and its output.
pub struct Ended {
    pub ok: bool,
    pub is_late: bool,
    pub output: String,
}

/// Runs one unit on one thread.
pub fn run_unit(program: &Program, unit: &Unit, env: &[(&str, &str)], limit: Limit) -> Ended {
    let mut command = Command::new(&program.executable);
    if !unit.tests.is_empty() {
        command.args(["--exact", "--show-output", "--test-threads", "1"]).args(&unit.tests);
    }
    command.current_dir(&program.folder).env("CARGO_MANIFEST_DIR", &program.folder).envs(env.iter().copied());
    start(command, limit)
}

fn start(mut command: Command, limit: Limit) -> Ended {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.process_group(0);
    match command.spawn() {
        Ok(child) => wait(child, limit),
        Err(e) => {
            let output = format!("{}: {e}", command.get_program().to_string_lossy());
            Ended { ok: false, is_late: false, output }
        }
    }
}

fn wait(mut child: Child, limit: Limit) -> Ended {
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    std::thread::scope(|scope| {
        let printed = scope.spawn(|| read(stdout));
        let complaints = scope.spawn(|| read(stderr));
        let deadline = Instant::now() + limit.longest;
        let mut is_late = false;
        let ended = loop {
            match child.try_wait() {
                Ok(Some(status)) => break Ok(status.success()),
                Ok(None) if Instant::now() > deadline => {
                    is_late = true;
                    stop(&mut child);
                    break Err(format!("stopped after {} s", limit.longest.as_secs()));
                }
                Ok(None) if limit.cancelled.is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) => {
                    stop(&mut child);
                    break Err("stopped: another unit has failed".into());
                }
                Ok(None) => std::thread::sleep(Duration::from_millis(5)),
                Err(e) => {
                    stop(&mut child);
                    break Err(e.to_string());
                }
            }
        };
        let mut output = printed.join().unwrap_or_default() + &complaints.join().unwrap_or_default();
        if let Err(reason) = &ended {
            output += reason;
        }
        Ended { ok: ended.unwrap_or(false), is_late, output }
    })
}

/// Kills the process and its group: processes that it has started would otherwise hold its output open. Each process
/// leads a group, so Ctrl-C does not reach it.
fn stop(child: &mut Child) {
    // Without `kill`, the process alone is stopped.
    let _ = Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status();
    let _ = child.kill();
    let _ = child.wait();
}

fn read(stream: Option<impl Read>) -> String {
    let mut bytes = Vec::new();
    if let Some(mut stream) = stream {
        // The text read until the stream broke is still worth showing.
        let _ = stream.read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(script: &str, limit: Limit) -> Ended {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]);
        start(shell, limit)
    }

    #[test]
    fn what_a_program_prints_is_kept() {
        let ended = run("echo out; echo err >&2; exit 3", Limit { longest: Duration::from_mins(1), cancelled: None });
        assert!(!ended.ok && !ended.is_late && ended.output.contains("out") && ended.output.contains("err"));
    }

    #[test]
    fn a_program_that_hangs_is_stopped_with_what_it_started() {
        let limit = Limit { longest: Duration::from_millis(300), cancelled: None };
        let started = Instant::now();
        // The child process holds the output open, so the whole group must be killed.
        let ended = run("sleep 60 & wait", limit);
        assert!(!ended.ok && ended.is_late && started.elapsed() < Duration::from_secs(30));
    }

    #[test]
    fn a_program_is_stopped_when_its_result_is_no_longer_of_interest() {
        let cancelled = AtomicBool::new(true);
        let ended = run("sleep 60", Limit { longest: Duration::from_mins(1), cancelled: Some(&cancelled) });
        assert!(!ended.ok && !ended.is_late);
    }
}
