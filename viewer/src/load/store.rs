//! What has been read from blobs and is still in use, by the blob's name.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, Weak};

use genescape_cache::Digest;

use super::LoadError;
use crate::scene::{HdrPicture, Picture, Template, TerrainLod};

/// Read results by name. Nothing in it is kept alive by it.
#[derive(Debug, Default)]
pub struct Store {
    bytes: Shelf<[u8]>,
    pictures: Shelf<Picture>,
    hdr_pictures: Shelf<HdrPicture>,
    fields: Shelf<TerrainLod>,
    templates: Shelf<Template>,
}

/// Weak references by name.
type Shelf<T> = Mutex<HashMap<String, Weak<T>>>;

fn find<T: ?Sized>(shelf: &Shelf<T>, name: &str) -> Option<Arc<T>> {
    shelf.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).get(name)?.upgrade()
}

fn keep<T: ?Sized>(shelf: &Shelf<T>, name: &str, value: &Arc<T>) {
    let mut shelf = shelf.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    shelf.retain(|_, kept| kept.strong_count() > 0);
    shelf.insert(name.to_owned(), Arc::downgrade(value));
}

/// One kind of thing that a store keeps.
pub(super) trait Kept: Send + Sync + 'static {
    fn shelf(store: &Store) -> &Shelf<Self>;
}

impl Kept for TerrainLod {
    fn shelf(store: &Store) -> &Shelf<Self> {
        &store.fields
    }
}

impl Kept for Template {
    fn shelf(store: &Store) -> &Shelf<Self> {
        &store.templates
    }
}

impl Kept for Picture {
    fn shelf(store: &Store) -> &Shelf<Self> {
        &store.pictures
    }
}

impl Kept for HdrPicture {
    fn shelf(store: &Store) -> &Shelf<Self> {
        &store.hdr_pictures
    }
}

impl Store {
    /// The thing of that name, made if nobody has it.
    pub(super) fn get<T: Kept>(
        &self,
        name: &str,
        make: impl FnOnce() -> Result<T, LoadError>,
    ) -> Result<Arc<T>, LoadError> {
        if let Some(kept) = find(T::shelf(self), name) {
            return Ok(kept);
        }
        let made = Arc::new(make()?);
        keep(T::shelf(self), name, &made);
        Ok(made)
    }

    /// A blob's bytes, verified against its name if that is a digest (a person's own files have other names).
    pub(super) fn blob(&self, path: &Path) -> Result<Arc<[u8]>, LoadError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(kept) = find(&self.bytes, &name) {
            return Ok(kept);
        }
        let bytes =
            std::fs::read(path).map_err(|source| LoadError::Unreadable { path: path.to_owned(), source })?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if stem.parse::<Digest>().is_ok_and(|promised| promised != Digest::of(&bytes)) {
            return Err(LoadError::Damaged { path: path.to_owned() });
        }
        let bytes: Arc<[u8]> = bytes.into();
        keep(&self.bytes, &name, &bytes);
        Ok(bytes)
    }
}
