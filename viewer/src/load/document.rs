//! An open `scene.gltf`: its JSON, and how to come by what it names.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use genescape_cache::verified;
use genescape_schema::scene::Resource;
use serde::de::DeserializeOwned;

use super::{LoadError, Result, Store};

/// A scene file with the folder it names others from.
pub(super) struct Document<'a> {
    path: PathBuf,
    pub gltf: gltf::Document,
    pub store: &'a Store,
    /// The file's own binary part, if it is a single .glb.
    embedded: Option<Arc<Vec<u8>>>,
    /// Buffers that were asked for so far: most are never needed when a template is known already.
    buffers: RefCell<Vec<Option<Arc<Vec<u8>>>>>,
}

impl<'a> Document<'a> {
    pub fn open(path: &Path, store: &'a Store) -> Result<Self> {
        let bytes =
            std::fs::read(path).map_err(|source| LoadError::Unreadable { path: path.to_owned(), source })?;
        let bytes = verified(path, bytes).map_err(|_| LoadError::Damaged { path: path.to_owned() })?;
        let parsed = gltf::Gltf::from_slice(&bytes)
            .map_err(|source| LoadError::NoGltf { path: path.to_owned(), source: Box::new(source) })?;
        let buffers = RefCell::new(vec![None; parsed.document.buffers().len()]);
        let embedded = parsed.blob.map(Arc::new);
        Ok(Self { path: path.to_owned(), gltf: parsed.document, store, embedded, buffers })
    }

    /// An error about this file.
    pub fn wrong(&self, what: impl Into<String>) -> LoadError {
        LoadError::foreign(&self.path, what)
    }

    pub fn scene(&self) -> Result<gltf::Scene<'_>> {
        self.gltf.default_scene().ok_or_else(|| self.wrong("it names no scene to show"))
    }

    /// The node of that name.
    pub fn node(&self, name: &str) -> Option<gltf::Node<'_>> {
        self.gltf.nodes().find(|node| node.name() == Some(name))
    }

    /// An extension's object, read as `T`.
    pub fn extension<T: DeserializeOwned>(&self, value: Option<&serde_json::Value>, name: &str) -> Result<T> {
        let value = value.ok_or_else(|| self.wrong(format!("it has no {name}")))?;
        serde_json::from_value(value.clone())
            .map_err(|error| self.wrong(format!("its {name} is wrong: {error}")))
    }

    fn file(&self, uri: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).join(uri)
    }

    /// A name by which the same content is known in every scene.
    pub fn name_of(&self, resource: &Resource) -> String {
        match (&resource.uri, resource.buffer_view) {
            (Some(uri), _) => self.file(uri).file_name().unwrap_or_default().to_string_lossy().into_owned(),
            (None, view) => format!("{}#{}", self.path.display(), view.unwrap_or(usize::MAX)),
        }
    }

    /// What a resource holds.
    pub fn bytes(&self, resource: &Resource) -> Result<Arc<Vec<u8>>> {
        match (&resource.uri, resource.buffer_view) {
            (Some(uri), _) => self.store.blob(&self.file(uri)),
            (None, Some(view)) => Ok(self.view(view)?.into()),
            (None, None) => Err(self.wrong("a resource has neither a uri nor a bufferView")),
        }
    }

    /// A buffer view's bytes.
    pub fn view(&self, index: usize) -> Result<Vec<u8>> {
        let view = self.gltf.views().nth(index);
        let view = view.ok_or_else(|| self.wrong(format!("it has no bufferView {index}")))?;
        let buffer = self.buffer(view.buffer().index())?;
        let bytes = buffer.get(view.offset()..view.offset() + view.length());
        Ok(bytes.ok_or_else(|| self.wrong(format!("bufferView {index} ends beyond its buffer")))?.to_vec())
    }

    /// A buffer's bytes.
    pub fn buffer(&self, index: usize) -> Result<Arc<Vec<u8>>> {
        if let Some(Some(known)) = self.buffers.borrow().get(index) {
            return Ok(known.clone());
        }
        let buffer = self.gltf.buffers().nth(index);
        let buffer = buffer.ok_or_else(|| self.wrong(format!("it has no buffer {index}")))?;
        let bytes = match buffer.source() {
            gltf::buffer::Source::Uri(uri) => self.store.blob(&self.file(uri))?,
            gltf::buffer::Source::Bin => {
                self.embedded.clone().ok_or_else(|| self.wrong("its binary part is missing"))?
            }
        };
        if bytes.len() < buffer.length() {
            return Err(self.wrong(format!("buffer {index} is shorter than it should be")));
        }
        self.buffers.borrow_mut()[index] = Some(bytes.clone());
        Ok(bytes)
    }

    /// All buffers that an accessor needs, in memory.
    pub fn fetch(&self, accessor: &gltf::Accessor<'_>) -> Result<()> {
        if let Some(view) = accessor.view() {
            self.buffer(view.buffer().index())?;
        }
        if let Some(sparse) = accessor.sparse() {
            self.buffer(sparse.indices().view().buffer().index())?;
            self.buffer(sparse.values().view().buffer().index())?;
        }
        Ok(())
    }

    /// An accessor's values, `T` being what glTF says of its type.
    pub fn values<T: gltf::accessor::Item + Copy>(&self, accessor: gltf::Accessor<'_>) -> Result<Vec<T>> {
        self.fetch(&accessor)?;
        let index = accessor.index();
        if accessor.size() != size_of::<T>() {
            return Err(self.wrong(format!("accessor {index} has another type than expected")));
        }
        let buffers = self.buffers.borrow();
        let get = |buffer: gltf::Buffer<'_>| buffers[buffer.index()].as_deref().map(Vec::as_slice);
        let values = gltf::accessor::Iter::<T>::new(accessor, get);
        Ok(values.ok_or_else(|| self.wrong(format!("accessor {index} reaches beyond its buffer")))?.collect())
    }

    /// An accessor by number.
    pub fn accessor(&self, index: usize) -> Result<gltf::Accessor<'_>> {
        self.gltf.accessors().nth(index).ok_or_else(|| self.wrong(format!("it has no accessor {index}")))
    }

    /// Indices of any width.
    pub fn indices(&self, primitive: &gltf::Primitive<'_>) -> Result<Vec<u32>> {
        use gltf::accessor::DataType;
        let accessor = primitive.indices().ok_or_else(|| self.wrong("a mesh has no indices"))?;
        Ok(match accessor.data_type() {
            DataType::U16 => self.values::<u16>(accessor)?.into_iter().map(u32::from).collect(),
            DataType::U32 => self.values::<u32>(accessor)?,
            DataType::U8 => self.values::<u8>(accessor)?.into_iter().map(u32::from).collect(),
            other => return Err(self.wrong(format!("indices are of type {other:?}"))),
        })
    }
}
