//! What went wrong while reading a file, as the one line a user sees.

use std::fmt;
use std::path::Path;

/// A file that cannot become a scene: where, what, and what to do about it.
///
/// Displays as one line, `file:line: message`, or `file: message` where no line can be named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportError {
    /// The file as it was named by the user or by the file that mentions it.
    pub file: String,
    /// Counted from 1.
    pub line: Option<u32>,
    /// What is wrong and what to do.
    pub message: String,
}

impl ImportError {
    pub(super) fn new(file: &Path, message: impl Into<String>) -> Self {
        Self {
            file: file.display().to_string(),
            line: None,
            message: message.into(),
        }
    }

    pub(super) fn at(file: &Path, line: u32, message: impl Into<String>) -> Self {
        Self {
            line: Some(line),
            ..Self::new(file, message)
        }
    }

    /// A file that could not be opened or read.
    pub(super) fn io(file: &Path, error: &std::io::Error) -> Self {
        let advice = match error.kind() {
            std::io::ErrorKind::NotFound => "no such file; check the name".to_string(),
            std::io::ErrorKind::PermissionDenied => {
                "not allowed to read it; check its permissions".to_string()
            }
            std::io::ErrorKind::InvalidData => "not UTF-8 text; save it as UTF-8".to_string(),
            _ => format!("cannot be read ({error})"),
        };
        Self::new(file, advice)
    }
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let message = self.message.split_whitespace().collect::<Vec<_>>().join(" ");
        match self.line {
            Some(line) => write!(f, "{}:{line}: {message}", self.file),
            None => write!(f, "{}: {message}", self.file),
        }
    }
}

impl std::error::Error for ImportError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line() {
        let error = ImportError::at(Path::new("a.xml"), 14, "two\n  lines; do this");
        assert_eq!(error.to_string(), "a.xml:14: two lines; do this");
    }
}
