//! Child processes that end in time.

use std::{
    io::Read,
    process::{Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};

pub struct Finished {
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

/// Runs `command` to its end and collects what it prints; kills it after `limit`.
///
/// With `pass_errors` its standard error goes to ours as it comes, and the collected one stays empty.
pub fn run(command: &mut Command, limit: Duration, pass_errors: bool) -> Result<Finished> {
    let name = command.get_program().to_string_lossy().into_owned();
    let start = Instant::now();
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(if pass_errors {
            Stdio::inherit()
        } else {
            Stdio::piped()
        })
        .spawn()
        .with_context(|| {
            format!("{name} does not start; `cargo xtask setup` installs what the emulators need")
        })?;

    let stdout = collect(child.stdout.take());
    let stderr = collect(child.stderr.take());
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            bail!(
                "{name} was still running after {} s and was stopped",
                limit.as_secs()
            );
        }
        thread::sleep(Duration::from_millis(5));
    };
    let text = |reader: thread::JoinHandle<String>| reader.join().expect("the reader does not panic");
    Ok(Finished {
        status,
        stdout: text(stdout),
        stderr: text(stderr),
    })
}

/// Reads a pipe beside the child, so that a full one does not stop it.
fn collect(pipe: Option<impl Read + Send + 'static>) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            // A pipe that breaks ends the text; the exit status tells the rest.
            let _ = pipe.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_what_does_not_end() {
        let start = Instant::now();
        let result = run(Command::new("sleep").arg("60"), Duration::from_millis(50), false);
        assert!(result.is_err());
        assert!(start.elapsed() < Duration::from_secs(20));
    }

    #[test]
    fn collects_more_than_a_pipe_holds() {
        let finished = run(Command::new("seq").arg("100000"), Duration::from_secs(20), false).unwrap();
        assert!(finished.status.success());
        assert_eq!(finished.stdout.lines().count(), 100_000);
    }
}
