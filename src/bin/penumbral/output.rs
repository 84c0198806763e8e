//! Writing files whole or not at all, lines to standard output and standard error, and progress.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use crate::Failure;

/// Where a path leads: links are followed, even to where nothing is yet.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    // Systems give up after about so many, where links lead round in a circle.
    for _ in 0..40 {
        match (fs::read_link(&path), path.parent()) {
            (Ok(target), Some(folder)) => path = folder.join(target),
            _ => break,
        }
    }
    path
}

/// Writes a file by way of another beside it: whoever interrupts this finds the old file or the new one, never half. A link to it
/// stays, and so do the old file's permissions.
pub(crate) fn write(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let describe = |error: io::Error| format!("{}: {error}", path.display());
    let target = followed(path);
    let earlier = match fs::metadata(&target) {
        Ok(earlier) => Some(earlier),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(describe(error)),
    };
    if earlier.as_ref().is_some_and(|earlier| !earlier.is_file()) {
        // Nothing takes the place of a device or a pipe.
        return fs::write(&target, contents).map_err(describe);
    }
    let name = target
        .file_name()
        .ok_or_else(|| format!("{}: give a file", path.display()))?;
    let mut unfinished = name.to_owned();
    unfinished.push(format!(".{}.part", std::process::id()));
    let unfinished = target.with_file_name(unfinished);
    let written = fs::write(&unfinished, contents)
        .and_then(|()| match earlier {
            Some(earlier) => fs::set_permissions(&unfinished, earlier.permissions()),
            None => Ok(()),
        })
        .and_then(|()| fs::rename(&unfinished, &target));
    if written.is_err() {
        // Nothing more can be done about a leftover than to try.
        let _ = fs::remove_file(&unfinished);
    }
    written.map_err(describe)
}

/// Writes text to standard output. Who closes it early has read enough: that is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// Writes one line to standard error, whatever the message holds of its input.
pub(crate) fn complain(message: &str) {
    let mut line = String::from("penumbral: ");
    for c in message.chars() {
        if c.is_control() {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line.push('\n');
    // There is nowhere left to say that this did not work.
    let _ = io::stderr().write_all(line.as_bytes());
}

/// A bar on standard error, shown on terminals only.
pub(crate) fn progress(steps: usize, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(steps as u64).with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    bar
}
