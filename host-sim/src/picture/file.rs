//! Files that are written whole or not at all, and known to be writable before the work begins.

use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file that cannot be read or written: one line, `file: what is wrong; what to do`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError(String);

impl FileError {
    pub fn new(path: &Path, message: impl fmt::Display) -> FileError {
        let line = format!("{}: {message}", path.display());
        FileError(line.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    pub fn io(path: &Path, error: &io::Error) -> FileError {
        FileError::new(
            path,
            match error.kind() {
                io::ErrorKind::NotFound => "no such file; check the name".to_string(),
                io::ErrorKind::PermissionDenied => {
                    "not allowed; check the permissions or choose another place".to_string()
                }
                io::ErrorKind::StorageFull => {
                    "no space left on the disk; free some or choose another place".to_string()
                }
                _ => format!("{error}; choose another file"),
            },
        )
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FileError {}

/// A place that can be written to, as far as can be known beforehand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    path: PathBuf,
}

impl Target {
    /// Looks whether the folder is there and lets itself be written to, and whether the file would be replaceable.
    pub fn check(path: &Path) -> Result<Target, FileError> {
        let target = Target {
            path: path.to_path_buf(),
        };
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                return Err(FileError::new(path, "is a directory; name a file in it"));
            }
            Ok(found) if !found.is_file() => {
                return Err(FileError::new(path, "is not a regular file; name another"));
            }
            Ok(found) if found.permissions().readonly() => {
                return Err(FileError::new(
                    path,
                    "exists and is read-only; make it writable or choose another name",
                ));
            }
            _ => {}
        }
        let folder = target.folder();
        if !folder.is_dir() {
            return Err(FileError::new(
                path,
                format!("no directory {}; create it first", folder.display()),
            ));
        }
        target.beside().map_err(|error| FileError::io(&folder, &error))?;
        Ok(target)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes beside the target, then renames, so that a reader sees the old file or the new one and nothing between.
    pub fn write(&self, bytes: &[u8]) -> Result<(), FileError> {
        let write = || -> io::Result<()> {
            let mut file = self.beside()?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            // A link stays a link: what it points at is replaced.
            let place = fs::canonicalize(&self.path).unwrap_or_else(|_| self.path.clone());
            file.persist(place).map_err(|error| error.error)?;
            Ok(())
        };
        write().map_err(|error| FileError::io(&self.path, &error))
    }

    /// A new, empty file in the folder of the target; gone when dropped.
    fn beside(&self) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".host-sim-").suffix(".part");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask, as any new file
        builder.tempfile_in(self.folder())
    }

    fn folder(&self) -> PathBuf {
        let path = fs::canonicalize(&self.path).unwrap_or_else(|_| self.path.clone());
        match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
            _ => PathBuf::from("."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let target = Target::check(&path).unwrap();
        assert!(!path.exists(), "checking leaves nothing behind");
        for text in ["first, and longer", "second"] {
            target.write(text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_written_is_known_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let told = |name: &str| Target::check(&folder.path().join(name)).unwrap_err().to_string();
        assert!(told("missing/a.png").ends_with("missing; create it first"));
        assert!(told(".").ends_with("is a directory; name a file in it"));
        let path = folder.path().join("kept.png");
        fs::write(&path, "").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert!(told("kept.png").contains("read-only"));
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(told("file/a.png").ends_with("file; create it first"));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_are_those_of_any_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [plain, link, real] = ["plain", "link", "real"].map(|name| folder.path().join(name));
        fs::write(&plain, "").unwrap();
        fs::write(&real, "").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        Target::check(&link).unwrap().write(b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&real), mode(&plain));
    }
}
