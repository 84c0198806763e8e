//! Pieces of a file's text: what is read from them, and where in the file it is when it is wrong.

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::error::{Error, Result};

/// A piece of a file's text.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    text: &'a str,
    part: &'a str,
}

impl<'a> Part<'a> {
    /// All of a file.
    pub(super) fn whole(text: &'a str) -> Self {
        Self { text, part: text }
    }

    /// The piece of it that a raw value was read from.
    pub(super) fn within(&self, raw: &RawValue) -> Self {
        let offset = raw.get().as_ptr() as usize - self.text.as_ptr() as usize;
        Self {
            text: self.text,
            part: &self.text[offset..offset + raw.get().len()],
        }
    }

    /// Whether an object begins here.
    pub(super) fn is_object(&self) -> bool {
        self.part.trim_start().starts_with('{')
    }

    /// An error at the part's beginning.
    pub(super) fn refuse(&self, field: &str, reason: &dyn core::fmt::Display) -> Error {
        self.refuse_at(0, field.to_owned(), reason.to_string())
    }

    fn refuse_at(&self, offset: usize, field: String, reason: String) -> Error {
        let place = self.part.as_ptr() as usize - self.text.as_ptr() as usize + offset;
        let before = &self.text.as_bytes()[..place];
        let line_start = before
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |newline| newline + 1);
        // serde_json counts bytes, and may stop within a character.
        let line = self.text[line_start..].char_indices();
        let passed = line.take_while(|(at, char)| line_start + at + char.len_utf8() <= place);
        Error::Scene {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: passed.count() + 1,
            field,
            reason,
        }
    }

    /// Reads an object: a list of values without their names would be taken for one.
    pub(super) fn read_object<T: Deserialize<'a>>(&self, field: &str) -> Result<T> {
        if self.part.trim_start().starts_with('[') {
            return Err(self.refuse(field, &"give an object with named fields, not a list"));
        }
        self.read(field)
    }

    /// Reads one of some names.
    pub(super) fn read_name<T: Copy>(&self, field: &str, names: &[(&str, T)]) -> Result<T> {
        let value: String = self.read(field)?;
        let known = names.iter().find(|(name, _)| *name == value);
        known.map(|(_, meant)| *meant).ok_or_else(|| {
            let list: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
            let reason = format!("{value:?} is unknown: give {}", list.join(" or "));
            self.refuse(field, &reason)
        })
    }

    pub(super) fn read<T: Deserialize<'a>>(&self, field: &str) -> Result<T> {
        let mut reader = serde_json::Deserializer::from_str(self.part);
        let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
            let path = error.path().to_string();
            // What was read of a field without a name as yet has a question mark for one.
            let field = match path.trim_end_matches(['?', '.']) {
                "" => field.to_owned(),
                path => format!("{field}.{path}"),
            };
            self.json_error(error.inner(), field)
        })?;
        reader
            .end()
            .map_err(|error| self.json_error(&error, field.to_owned()))?;
        Ok(value)
    }

    fn json_error(&self, error: &serde_json::Error, field: String) -> Error {
        // serde_json counts lines from 1 and columns in bytes, and ends its message with both.
        let lines = self.part.split_inclusive('\n');
        let line_start: usize = lines
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum();
        let offset = (line_start + error.column().saturating_sub(1)).min(self.part.len());
        let message = error.to_string();
        let reason = message
            .rsplit_once(" at line ")
            .map_or(message.as_str(), |(reason, _)| reason);
        let reason = match reason {
            "trailing characters" => "more follows: remove it".to_owned(),
            _ => reason.replace("EOF while parsing", "the text ends within"),
        };
        // Types have names that no file shows.
        let reason = match reason.rsplit_once(", expected ") {
            Some((before, expected)) => {
                let kind = match expected {
                    "f32" | "f64" => "a number",
                    "u32" => "a whole number not below 0",
                    _ if expected.starts_with("struct ") => "an object",
                    other => other,
                };
                format!("{before}, expected {kind}")
            }
            None => reason,
        };
        self.refuse_at(offset, field, reason)
    }
}
