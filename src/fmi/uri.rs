//! Conversion of `fmuResourceLocation` to a folder.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

/// A resource location that names no folder of this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UriError {
    /// The URI is empty.
    #[error("the resource location is empty; expected a URI such as `file:///path/to/resources`")]
    Empty,
    /// The URI has another scheme than `file`.
    #[error("the resource location `{uri}` is not a `file:` URI")]
    Scheme {
        /// The URI.
        uri: String,
    },
    /// The URI has a drive in place of a machine.
    #[error("the resource location `{uri}` names the host `{drive}`; a drive follows `file:///`")]
    Drive {
        /// The URI.
        uri: String,
        /// The drive.
        drive: String,
    },
    /// The URI names another machine, on a system whose paths do not.
    #[error("the resource location `{uri}` is on another host, `{host}`")]
    Host {
        /// The URI.
        uri: String,
        /// The host in it.
        host: String,
    },
    /// The percent-decoded path is not UTF-8, on a system whose paths are text.
    #[error("the resource location `{uri}` does not decode to UTF-8")]
    Encoding {
        /// The URI.
        uri: String,
    },
}

/// Returns the folder of a resource location: `file:///x`, `file:/x` or `file://localhost/x`, on
/// Windows `file://server/share/x` as well, percent-encoded, with or without a trailing slash (FMI
/// 2.0, 2.1.5, and RFC 8089).
///
/// Accepts a plain absolute path as well, which some hosts pass.
///
/// # Errors
///
/// See [`UriError`].
pub fn resource_path(uri: &str) -> Result<PathBuf, UriError> {
    if uri.is_empty() {
        return Err(UriError::Empty);
    }
    let Some((scheme, rest)) = uri.split_once(':') else {
        return plain_path(uri);
    };
    if !scheme.eq_ignore_ascii_case("file") {
        return plain_path(uri);
    }
    let path = match rest.strip_prefix("//") {
        None => rest,
        Some(after) => {
            let (host, path) = after.split_at(after.find('/').unwrap_or(after.len()));
            if host.ends_with(':') {
                return Err(UriError::Drive {
                    uri: uri.to_owned(),
                    drive: host.to_owned(),
                });
            }
            if !(host.is_empty() || host.eq_ignore_ascii_case("localhost")) {
                // Windows has paths on other machines.
                if cfg!(windows) && !path.is_empty() {
                    return share(host, path).ok_or_else(|| UriError::Encoding {
                        uri: uri.to_owned(),
                    });
                }
                return Err(UriError::Host {
                    uri: uri.to_owned(),
                    host: host.to_owned(),
                });
            }
            path
        }
    };
    if path.is_empty() {
        return Err(UriError::Empty);
    }
    decode(path).ok_or_else(|| UriError::Encoding {
        uri: uri.to_owned(),
    })
}

fn plain_path(path: &str) -> Result<PathBuf, UriError> {
    let path_buf = PathBuf::from(path);
    if path_buf.is_absolute() {
        Ok(path_buf)
    } else {
        Err(UriError::Scheme {
            uri: path.to_owned(),
        })
    }
}

/// Returns the path `\\server\share\…` of a percent-encoded path on a host (RFC 8089, E.3.1).
fn share(host: &str, path: &str) -> Option<PathBuf> {
    let path = percent_decode_str(path).decode_utf8().ok()?;
    Some(format!("//{host}{path}").replace('/', "\\").into())
}

#[cfg(unix)]
fn decode(path: &str) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    let bytes: Vec<u8> = percent_decode_str(path).collect();
    Some(std::ffi::OsString::from_vec(bytes).into())
}

#[cfg(not(unix))]
fn decode(path: &str) -> Option<PathBuf> {
    let path = percent_decode_str(path).decode_utf8().ok()?;
    // The path of `file:///C:/x` is `/C:/x`.
    let drive = path
        .strip_prefix('/')
        .filter(|p| p[..].get(1..2) == Some(":"));
    Some(drive.unwrap_or(&path).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_spellings() {
        for uri in [
            "file:///tmp/a%20b/%C3%BC%23%25",
            "file:/tmp/a%20b/%C3%BC%23%25",
            "file://localhost/tmp/a%20b/%c3%bc%23%25",
            "FILE:///tmp/a%20b/%C3%BC%23%25",
            "file:///tmp/a b/ü#%",
            "/tmp/a b/ü#%",
        ] {
            assert_eq!(
                resource_path(uri),
                Ok(PathBuf::from("/tmp/a b/ü#%")),
                "{uri}"
            );
        }
        assert_eq!(
            resource_path("file:///tmp/resources/").map(|path| path.join("x")),
            Ok(PathBuf::from("/tmp/resources/x"))
        );
    }

    #[test]
    fn a_share_of_windows_is_a_path() {
        assert_eq!(
            share("server", "/share/a%20b/%C3%BC/resources"),
            Some(PathBuf::from(r"\\server\share\a b\ü\resources"))
        );
        assert_eq!(share("server", "/share/%FF"), None);
    }

    #[test]
    fn others_are_refused() {
        assert_eq!(resource_path(""), Err(UriError::Empty));
        assert_eq!(resource_path("file://"), Err(UriError::Empty));
        for uri in ["https://example.org/x", "resources", "ftp:/x"] {
            assert!(
                matches!(resource_path(uri), Err(UriError::Scheme { .. })),
                "{uri}"
            );
        }
        // RFC 3986, 3.2: what follows two slashes is a host.
        assert!(matches!(
            resource_path("file://C:/resources"),
            Err(UriError::Drive { drive, .. }) if drive == "C:"
        ));
        let share = resource_path("file://server/share/x");
        if cfg!(windows) {
            assert_eq!(share, Ok(PathBuf::from(r"\\server\share\x")));
        } else {
            assert!(matches!(share, Err(UriError::Host { host, .. }) if host == "server"));
        }
    }
}
