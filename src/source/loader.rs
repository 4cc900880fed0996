//! Reading inputs: the main file, files imported by relative paths inside the project root, and the standard
//! library. No other module opens an input.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::root::normalise;
use super::{FileId, InputError, Root, SourceMap, input, root};

/// Largest input file, bytes.
pub const SIZE_LIMIT: u64 = 8 * 1024 * 1024;

/// The embedded standard library: module name and text.
pub const STDLIB: &[(&str, &str)] = &[
    ("carts", include_str!("../../stdlib/carts.lss")),
    ("drives", include_str!("../../stdlib/drives.lss")),
    ("equipment", include_str!("../../stdlib/equipment.lss")),
    ("joints", include_str!("../../stdlib/joints.lss")),
    ("sensors", include_str!("../../stdlib/sensors.lss")),
    ("take_ups", include_str!("../../stdlib/take_ups.lss")),
    ("tracks", include_str!("../../stdlib/tracks.lss")),
    ("wheels", include_str!("../../stdlib/wheels.lss")),
];

/// Largest drawing, bytes.
pub const DRAWING_LIMIT: u64 = 64 * 1024 * 1024;

/// Why a file could not become a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadError {
    /// Not there, not a regular file, or unreadable; the system's reason.
    Unreadable(String),
    /// Its path leads out of the project root (as messages show it), directly or through a symbolic link.
    OutsideRoot(String),
    /// Larger than [`SIZE_LIMIT`] or, a drawing, than [`DRAWING_LIMIT`]; bytes.
    TooLarge(u64),
    /// Not UTF-8 from this byte on. The text up to there is in the source map, for messages.
    NotUtf8 { file: FileId, byte: usize },
}

impl From<InputError> for LoadError {
    fn from(why: InputError) -> Self {
        match why {
            InputError::OutsideRoot(root) => LoadError::OutsideRoot(root),
            InputError::TooLarge { bytes, .. } => LoadError::TooLarge(bytes),
            other => LoadError::Unreadable(other.to_string()),
        }
    }
}

/// Texts that stand in for files of the disk, by their canonical places: what an editor has open, saved or not. A place
/// need not exist yet.
pub type Overlay = BTreeMap<PathBuf, String>;

/// Where files come from.
#[derive(Clone, Debug)]
enum Origin {
    Disk { root: Root, overlay: Arc<Overlay> },
    Memory { files: BTreeMap<String, Vec<u8>>, label: String },
}

/// Reads files into a [`SourceMap`], each once.
#[derive(Clone, Debug)]
pub struct Loader {
    origin: Origin,
    /// Canonical place of each file that was read, and its id.
    read: BTreeMap<PathBuf, FileId>,
    /// The same the other way round; a file without a place imports nothing from its folder.
    places: BTreeMap<FileId, PathBuf>,
    standard: BTreeMap<&'static str, FileId>,
}

impl Loader {
    /// Reads the main file, which the command line names, from the disk. The project root is [`Root::of_layout`] of its
    /// folder.
    pub fn open(sources: &mut SourceMap, path: &Path) -> Result<(Loader, FileId), LoadError> {
        Loader::open_over(sources, path, Arc::default())
    }

    /// The same, with texts that stand in for files. A main file of the overlay that is not on the disk imports no files
    /// unless its folder is there.
    pub fn open_over(
        sources: &mut SourceMap,
        path: &Path,
        overlay: Arc<Overlay>,
    ) -> Result<(Loader, FileId), LoadError> {
        let place = if overlay.contains_key(path) { path.to_owned() } else { root::given(path)? };
        let root = match place.parent().filter(|folder| folder.is_absolute() && folder.is_dir()) {
            Some(folder) => Root::of_layout(folder),
            None => Root::default(),
        };
        let mut loader = Loader::new(Origin::Disk { root, overlay });
        let main = loader.read(sources, place, path.to_string_lossy().into_owned())?;
        Ok((loader, main))
    }

    /// Where a file was read from: its canonical place. `None` of the standard library, and of what was no text.
    pub fn place(&self, file: FileId) -> Option<&Path> {
        self.places.get(&file).map(PathBuf::as_path)
    }

    /// The module of the standard library that a file is.
    pub fn standard_module(&self, file: FileId) -> Option<&'static str> {
        self.standard.iter().find(|(_, id)| **id == file).map(|(module, _)| *module)
    }

    /// Takes files from memory, by their paths relative to a root. The first one is the main file.
    pub fn memory(sources: &mut SourceMap, files: &[(&str, &[u8])]) -> Result<(Loader, FileId), LoadError> {
        Loader::labelled(sources, files, "")
    }

    /// The same, with what their names begin with in messages: `main:` of a revision.
    pub fn labelled(
        sources: &mut SourceMap,
        files: &[(&str, &[u8])],
        label: &str,
    ) -> Result<(Loader, FileId), LoadError> {
        let main = files.first().map_or("main.lss", |(name, _)| *name);
        let files = files.iter().map(|(name, bytes)| (name.to_string(), bytes.to_vec())).collect();
        let mut loader = Loader::new(Origin::Memory { files, label: label.to_owned() });
        let id = loader.read(sources, PathBuf::from(main), format!("{label}{main}"))?;
        Ok((loader, id))
    }

    fn new(origin: Origin) -> Self {
        Loader { origin, read: BTreeMap::new(), places: BTreeMap::new(), standard: BTreeMap::new() }
    }

    /// Reads the file that `importer` names with a relative path.
    pub fn import(&mut self, sources: &mut SourceMap, importer: FileId, path: &str) -> Result<FileId, LoadError> {
        let Some(from) = self.places.get(&importer) else {
            return Err(LoadError::Unreadable("the standard library imports no files".into()));
        };
        let folder = from.parent().unwrap_or(Path::new(""));
        let wanted = normalise(&folder.join(path)).filter(|_| !Path::new(path).is_absolute());
        let place = match &self.origin {
            Origin::Memory { .. } => wanted.ok_or_else(|| LoadError::OutsideRoot("the project".into()))?,
            Origin::Disk { root, overlay } => match wanted.filter(|wanted| root.holds(wanted)) {
                Some(wanted) => match root.place(&wanted) {
                    // Not saved yet. Its folder may be a link; where that leads is held to the root, too.
                    Err(InputError::Missing(why)) => {
                        let folder = wanted.parent().and_then(|folder| root.place(folder).ok());
                        let unsaved = folder.zip(wanted.file_name()).map(|(folder, name)| folder.join(name));
                        unsaved.filter(|place| overlay.contains_key(place)).ok_or(InputError::Missing(why))?
                    }
                    place => place?,
                },
                None => return Err(root.outside().into()),
            },
        };
        let beside = Path::new(&sources.file(importer).name).parent().map(|f| f.join(path));
        let beside = beside.map_or_else(|| path.to_string(), |p| shorten(&p).to_string_lossy().into_owned());
        let name = match &self.origin {
            Origin::Memory { label, .. } if !label.is_empty() => format!("{label}{}", place.to_string_lossy()),
            _ => beside,
        };
        self.read(sources, place, name)
    }

    /// A module of the standard library, shown as `std/tracks.lss`.
    pub fn standard(&mut self, sources: &mut SourceMap, module: &str) -> Option<FileId> {
        let (name, text) = STDLIB.iter().find(|(name, _)| *name == module)?;
        Some(*self.standard.entry(name).or_insert_with(|| sources.add(format!("std/{name}.lss"), *text)))
    }

    fn read(&mut self, sources: &mut SourceMap, place: PathBuf, name: String) -> Result<FileId, LoadError> {
        if let Some(id) = self.read.get(&place) {
            return Ok(*id);
        }
        let bytes = match &self.origin {
            Origin::Disk { overlay, .. } => match overlay.get(&place) {
                Some(text) if text.len() as u64 <= SIZE_LIMIT => text.clone().into_bytes(),
                Some(text) => return Err(LoadError::TooLarge(text.len() as u64)),
                None => input::read(&place, SIZE_LIMIT)?,
            },
            Origin::Memory { files, .. } => files
                .get(place.to_string_lossy().as_ref())
                .cloned()
                .ok_or_else(|| LoadError::Unreadable("no such file".into()))?,
        };
        if bytes.len() as u64 > SIZE_LIMIT {
            return Err(LoadError::TooLarge(bytes.len() as u64));
        }
        match String::from_utf8(bytes) {
            Ok(text) => {
                let id = sources.add(name, text);
                self.read.insert(place.clone(), id);
                self.places.insert(id, place);
                Ok(id)
            }
            Err(error) => {
                let byte = error.utf8_error().valid_up_to();
                let file = sources.add(name, String::from_utf8_lossy(error.as_bytes()));
                Err(LoadError::NotUtf8 { file, byte })
            }
        }
    }
}

/// Reads a drawing from the disk. Programs write them in many encodings: what is not UTF-8 is taken for Latin-1, in
/// which every byte is a character.
pub fn drawing(sources: &mut SourceMap, path: &Path) -> Result<FileId, LoadError> {
    let bytes = root::read_given(path, DRAWING_LIMIT)?;
    let text = String::from_utf8(bytes)
        .unwrap_or_else(|error| error.as_bytes().iter().map(|byte| char::from(*byte)).collect());
    Ok(sources.add(path.to_string_lossy(), text))
}

/// `a/../b.lss` as `b.lss`; leading `..` stay.
fn shorten(path: &Path) -> PathBuf {
    let mut out: Vec<Component> = Vec::new();
    for part in path.components() {
        match (part, out.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                out.pop();
            }
            _ => out.push(part),
        }
    }
    out.iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn write(path: PathBuf, text: impl AsRef<[u8]>) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn root_is_the_nearest_marked_folder() {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path().join("lss.toml"), "");
        write(dir.path().join("layouts/west/a.lss"), "");
        write(dir.path().join("shared/carts.lss"), "// carts");
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::open(&mut sources, &dir.path().join("layouts/west/a.lss")).unwrap();
        let id = loader.import(&mut sources, main, "../../shared/carts.lss").unwrap();
        assert_eq!(sources.file(id).text, "// carts");
        assert!(sources.file(id).name.ends_with("/shared/carts.lss") && !sources.file(id).name.contains(".."));
        assert_eq!(loader.import(&mut sources, main, "../.././shared/carts.lss"), Ok(id), "read once");
    }

    #[test]
    fn an_overlay_stands_in_for_files_and_leads_nowhere_else() {
        let dir = tempfile::tempdir().unwrap();
        let at = dir.path().canonicalize().unwrap();
        write(at.join("p/lss.toml"), "");
        write(at.join("p/main.lss"), "// saved");
        write(at.join("p/carts.lss"), "// saved");
        write(at.join("other.lss"), "// outside");
        let places = ["p/main.lss", "p/carts.lss", "p/new.lss", "other.lss", "p/none/new.lss"];
        let overlay: Overlay = places.iter().map(|name| (at.join(name), format!("// open {name}"))).collect();
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::open_over(&mut sources, &at.join("p/main.lss"), Arc::new(overlay)).unwrap();
        assert_eq!(sources.file(main).text, "// open p/main.lss");
        for name in ["carts.lss", "new.lss"] {
            let id = loader.import(&mut sources, main, name).unwrap();
            assert_eq!(sources.file(id).text, format!("// open p/{name}"));
            assert_eq!(loader.place(id), Some(at.join("p").join(name).as_path()));
        }
        assert!(matches!(loader.import(&mut sources, main, "../other.lss"), Err(LoadError::OutsideRoot(_))));
        assert!(matches!(loader.import(&mut sources, main, "gone.lss"), Err(LoadError::Unreadable(_))));
        // A text that belongs to no folder of the disk imports nothing.
        let untitled = PathBuf::from("Untitled-1");
        let overlay = Arc::new(Overlay::from([(untitled.clone(), "// new".to_owned())]));
        let (mut loader, main) = Loader::open_over(&mut sources, &untitled, overlay).unwrap();
        assert!(matches!(loader.import(&mut sources, main, "other.lss"), Err(LoadError::OutsideRoot(_))));
    }

    #[test]
    fn without_a_marker_the_own_folder_is_the_root() {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path().join("a/main.lss"), "");
        write(dir.path().join("b.lss"), "");
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::open(&mut sources, &dir.path().join("a/main.lss")).unwrap();
        // Whether the file exists must not matter: that would tell what lies outside.
        for path in ["../b.lss", "../missing.lss", "/etc/hostname"] {
            assert!(matches!(loader.import(&mut sources, main, path), Err(LoadError::OutsideRoot(_))), "{path}");
        }
        assert!(matches!(loader.import(&mut sources, main, "missing.lss"), Err(LoadError::Unreadable(_))));
        assert!(matches!(loader.import(&mut sources, main, "."), Err(LoadError::Unreadable(_))));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_does_not_lead_out() {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path().join("project/main.lss"), "");
        write(dir.path().join("secret.lss"), "");
        std::os::unix::fs::symlink(dir.path().join("secret.lss"), dir.path().join("project/link.lss")).unwrap();
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::open(&mut sources, &dir.path().join("project/main.lss")).unwrap();
        assert!(matches!(loader.import(&mut sources, main, "link.lss"), Err(LoadError::OutsideRoot(_))));
    }

    #[test]
    fn memory_has_the_same_rules() {
        let mut sources = SourceMap::default();
        let files: &[(&str, &[u8])] =
            &[("a/main.lss", b""), ("b.lss", b"// b"), ("c.lss", b"ok \xff"), ("big.lss", &[b' '; 9 << 20])];
        let (mut loader, main) = Loader::memory(&mut sources, files).unwrap();
        assert!(loader.import(&mut sources, main, "../b.lss").is_ok());
        assert!(matches!(loader.import(&mut sources, main, "../../b.lss"), Err(LoadError::OutsideRoot(_))));
        assert!(matches!(loader.import(&mut sources, main, "../c.lss"), Err(LoadError::NotUtf8 { byte: 3, .. })));
        assert_eq!(loader.import(&mut sources, main, "../big.lss"), Err(LoadError::TooLarge(9 << 20)));
    }
}
