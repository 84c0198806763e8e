//! Writing files whole or not at all, and showing progress.

use std::fs;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::Failure;

/// Writes a file by way of another beside it: whoever interrupts this finds the old file or the new one, never half.
pub(crate) fn write(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let describe = |error: std::io::Error| format!("{}: {error}", path.display());
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

/// A bar on standard error, shown on terminals only.
pub(crate) fn progress(steps: usize, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(steps as u64).with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    bar
}
