//! Only the owner may read a store's files: they hold films and names of readers. SQLite gives the files beside a store the
//! permissions of the store.

use std::fs::OpenOptions;
use std::path::Path;

/// Options of a new file that other users of the machine can never read.
pub(crate) fn owner_only(options: &mut OpenOptions) -> &mut OpenOptions {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(options, 0o600);
    options
}

/// Permissions of a store that other users can read or write, such as `0644`; `None` if they cannot, and on systems without
/// such permissions.
#[must_use]
pub fn wider_permissions(path: &Path) -> Option<String> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(path).ok()?.permissions().mode() & 0o7777;
        (mode & 0o077 != 0).then(|| format!("{mode:04o}"))
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        None
    }
}
