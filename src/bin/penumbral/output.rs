//! Writing files whole or not at all, lines to standard output and standard error, and progress.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::Failure;

/// Writes a file by way of another beside it: whoever interrupts this finds the old file or the new one, never half.
pub(crate) fn write(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let describe = |error: io::Error| format!("{}: {error}", path.display());
    let name = path
        .file_name()
        .ok_or_else(|| format!("{}: give a file", path.display()))?;
    let mut unfinished = name.to_owned();
    unfinished.push(format!(".{}.part", std::process::id()));
    let unfinished = path.with_file_name(unfinished);
    let written = fs::write(&unfinished, contents).and_then(|()| fs::rename(&unfinished, path));
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
