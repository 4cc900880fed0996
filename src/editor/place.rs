//! From a client's URIs to places on the disk and back.

use lsp_types::Uri;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The place of a document: canonical if it, or its folder, is there. Of a scheme other than `file` there is only a name.
pub fn of_uri(uri: &Uri) -> PathBuf {
    let decoded = uri.path().as_estr().decode().into_string_lossy().into_owned();
    if uri.scheme().is_none_or(|scheme| !scheme.as_str().eq_ignore_ascii_case("file")) {
        // A relative path: it lies in no folder.
        return PathBuf::from(decoded.trim_start_matches('/'));
    }
    let drive = cfg!(windows) && decoded.as_bytes().get(2) == Some(&b':');
    let path = PathBuf::from(if drive { &decoded[1..] } else { decoded.as_str() });
    canonical(&path)
}

/// The canonical place of a file that need not exist yet.
pub fn canonical(path: &Path) -> PathBuf {
    let beside = || Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_owned())
}

/// The URI of a place on the disk.
pub fn to_uri(place: &Path) -> Option<Uri> {
    let text = place.to_string_lossy();
    let text = text.strip_prefix(r"\\?\").unwrap_or(&text).replace('\\', if cfg!(windows) { "/" } else { "\\" });
    let mut out = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => out.push(char::from(byte)),
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    Uri::from_str(&out).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_come_back() {
        let at = tempfile::tempdir().unwrap();
        for name in ["a.lss", "mit leer #1 ä%20.lss"] {
            let path = at.path().canonicalize().unwrap().join(name);
            assert_eq!(of_uri(&to_uri(&path).unwrap()), path);
        }
        assert_eq!(of_uri(&Uri::from_str("untitled:Untitled-1").unwrap()), PathBuf::from("Untitled-1"));
    }
}
