//! An open `scene.gltf`: its JSON, and how to come by what it names.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use genescape_schema::scene::Resource;
use genescape_world::NamedFiles;
use gltf::json::validation::Checked;
use gltf::mesh::Semantic;
use serde::de::DeserializeOwned;

use super::{LoadError, Result, Store, accessor};

/// A scene file with the folder it names others from.
pub(super) struct Document<'a> {
    path: PathBuf,
    pub gltf: gltf::Document,
    pub store: &'a Store,
    files: NamedFiles,
    /// The file's own binary part, if it is a single .glb.
    embedded: Option<Arc<Vec<u8>>>,
    /// Buffers that were asked for so far: most are never needed when a template is known already.
    buffers: Vec<OnceLock<Arc<Vec<u8>>>>,
}

impl<'a> Document<'a> {
    /// Parses a file, whose bytes these are.
    pub fn of(path: &Path, bytes: &[u8], store: &'a Store) -> Result<Self> {
        let no_gltf = |reason| LoadError::NoGltf { path: path.to_owned(), reason: Box::new(reason) };
        let parsed = gltf::Gltf::from_slice_without_validation(bytes).map_err(no_gltf)?;
        let json = parsed.document.into_json();
        check_positions(&json).map_err(|what| LoadError::foreign(path, what))?;
        let gltf = gltf::Document::from_json(json).map_err(no_gltf)?;
        let buffers = gltf.buffers().map(|_| OnceLock::new()).collect();
        let embedded = parsed.blob.map(Arc::new);
        let (path, files) = (path.to_owned(), NamedFiles::of(path));
        let document = Self { path, gltf, store, files, embedded, buffers };
        document.check_images()?;
        Ok(document)
    }

    /// The gltf crate panics over an image that comes from nowhere, or from a buffer without saying what it is.
    fn check_images(&self) -> Result<()> {
        for (index, image) in self.gltf.as_json().images.iter().enumerate() {
            let is_sound = match image.buffer_view {
                Some(_) => image.mime_type.is_some(),
                None => image.uri.is_some(),
            };
            if !is_sound {
                return Err(self.wrong(format!("image {index} names neither a file nor a part of a buffer")));
            }
        }
        Ok(())
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

    /// The bytes of a file that the scene names.
    fn named(&self, uri: &str) -> Result<Arc<Vec<u8>>> {
        self.store.bytes(&self.files, uri, &self.file(uri))
    }

    /// A name by which the same content is known in every scene.
    pub fn name_of(&self, resource: &Resource) -> String {
        match (&resource.uri, resource.buffer_view) {
            (Some(uri), _) => self.file(uri).file_name().unwrap_or_default().to_string_lossy().into_owned(),
            (None, view) => self.name_of_view(view.unwrap_or(usize::MAX)),
        }
    }

    /// Where a part of a blob lies in it; the blob's name vouches for what it holds, that of a scene does not.
    fn name_of_view(&self, index: usize) -> String {
        let view = self.gltf.views().nth(index);
        match view.as_ref().map(|view| (view.buffer().source(), view.offset())) {
            Some((gltf::buffer::Source::Uri(uri), offset)) => {
                format!("{}#{offset}", self.name_of(&Resource::file(uri, "")))
            }
            _ => format!("{}#{index}", self.path.display()),
        }
    }

    /// What a resource holds.
    pub fn bytes(&self, resource: &Resource) -> Result<Arc<Vec<u8>>> {
        match (&resource.uri, resource.buffer_view) {
            (Some(uri), _) => self.named(uri),
            (None, Some(view)) => Ok(self.view(view)?.into()),
            (None, None) => Err(self.wrong("a resource has neither a uri nor a bufferView")),
        }
    }

    /// A buffer view's bytes.
    pub fn view(&self, index: usize) -> Result<Vec<u8>> {
        let view = self.gltf.views().nth(index);
        let view = view.ok_or_else(|| self.wrong(format!("it has no bufferView {index}")))?;
        let buffer = self.buffer(view.buffer().index())?;
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| buffer.get(view.offset()..end));
        Ok(bytes.ok_or_else(|| self.wrong(format!("bufferView {index} ends beyond its buffer")))?.to_vec())
    }

    /// A buffer's bytes.
    pub fn buffer(&self, index: usize) -> Result<Arc<Vec<u8>>> {
        let known = self.buffers.get(index).ok_or_else(|| self.wrong(format!("it has no buffer {index}")))?;
        if let Some(known) = known.get() {
            return Ok(known.clone());
        }
        let buffer = self.gltf.buffers().nth(index);
        let buffer = buffer.ok_or_else(|| self.wrong(format!("it has no buffer {index}")))?;
        let bytes = match buffer.source() {
            gltf::buffer::Source::Uri(uri) => self.named(uri)?,
            gltf::buffer::Source::Bin => {
                self.embedded.clone().ok_or_else(|| self.wrong("its binary part is missing"))?
            }
        };
        if bytes.len() < buffer.length() {
            return Err(self.wrong(format!("buffer {index} is shorter than it should be")));
        }
        Ok(known.get_or_init(|| bytes).clone())
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
        let length_of = |index: usize| self.buffers[index].get().map_or(0, |bytes| bytes.len());
        if !accessor::fits(&accessor, length_of) {
            return Err(self.wrong(format!("accessor {index} reaches beyond its buffer")));
        }
        let get = |buffer: gltf::Buffer<'_>| Some(self.buffers[buffer.index()].get()?.as_slice());
        let values = gltf::accessor::Iter::<T>::new(accessor, get);
        Ok(values.ok_or_else(|| self.wrong(format!("accessor {index} reaches beyond its buffer")))?.collect())
    }

    /// An accessor by number.
    pub fn accessor(&self, index: usize) -> Result<gltf::Accessor<'_>> {
        self.gltf.accessors().nth(index).ok_or_else(|| self.wrong(format!("it has no accessor {index}")))
    }

    /// A primitive's indices, of any width, into its `count` vertices.
    pub fn indices(&self, primitive: &gltf::Primitive<'_>, count: usize) -> Result<Vec<u32>> {
        self.index_list(primitive.indices().ok_or_else(|| self.wrong("a mesh has no indices"))?, count)
    }

    /// An accessor's indices, of any width, into `count` vertices.
    pub fn index_list(&self, accessor: gltf::Accessor<'_>, count: usize) -> Result<Vec<u32>> {
        use gltf::accessor::DataType;
        let indices = match accessor.data_type() {
            DataType::U16 => self.values::<u16>(accessor)?.into_iter().map(u32::from).collect(),
            DataType::U32 => self.values::<u32>(accessor)?,
            DataType::U8 => self.values::<u8>(accessor)?.into_iter().map(u32::from).collect(),
            other => return Err(self.wrong(format!("indices are of type {other:?}"))),
        };
        match indices.iter().find(|&&index| index as usize >= count) {
            Some(index) => Err(self.wrong(format!("a mesh has no vertex {index}"))),
            None => Ok(indices),
        }
    }
}

/// The gltf crate panics while it validates positions for which there is no accessor; what is wrong then.
fn check_positions(root: &gltf::json::Root) -> Result<(), String> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let positions = primitives.filter_map(|one| one.attributes.get(&Checked::Valid(Semantic::Positions)));
    match positions.map(|index| index.value()).find(|&index| index >= root.accessors.len()) {
        Some(index) => Err(format!("there is no accessor {index}, which a mesh names")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::load::images;

    /// A file with one accessor of three points in `points.bin`, and one image.
    fn scene(accessor: &str, image: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{{"componentType":5126,"type":"VEC3",{accessor}}}],
            "images":[{image}],"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteLength":4}}],
            "buffers":[{{"byteLength":36,"uri":"points.bin"}}]}}"#
        )
    }

    /// What `look` sees in such a file.
    fn look<T>(accessor: &str, image: &str, look: impl FnOnce(Result<Document<'_>>) -> T) -> T {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = folder.path().join("model");
        fs::create_dir(&model).expect("made");
        fs::write(folder.path().join("secret.bin"), [1; 36]).expect("written");
        fs::write(model.join("points.bin"), [0; 36]).expect("written");
        fs::write(model.join("huge.png"), huge_png()).expect("written");
        look(Document::of(&model.join("scene.gltf"), scene(accessor, image).as_bytes(), &Store::default()))
    }

    /// A PNG whose header says 100,000 x 65,535 pixels, and which holds next to nothing.
    fn huge_png() -> Vec<u8> {
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x01\x86\xa0\0\0\xff\xff\x08\x06\0\0\0".to_vec();
        png.extend([0xe0, 0xd0, 0x24, 0x8c]);
        png.extend(b"\0\0\0\x04IDAT\x78\x9c\x63\0");
        png
    }

    const IMAGE: &str = r#"{"uri":"huge.png"}"#;

    #[test]
    fn only_numbers_that_are_there_are_read() {
        let read = |accessor: &str| {
            look(accessor, IMAGE, |document| {
                let document = document.expect("glTF");
                let accessor = document.accessor(0).expect("there");
                document.values::<[f32; 3]>(accessor).map(|values| values.len())
            })
        };
        let sparse = |count: &str, base: &str, indices: u32| {
            format!(
                r#""count":{base},"sparse":{{"count":{count},"indices":{{"bufferView":{indices},"componentType":5125}},
                "values":{{"bufferView":0}}}}"#
            )
        };
        assert_eq!(read(r#""bufferView":0,"count":3"#).ok(), Some(3));
        assert_eq!(read(&sparse("1", "5", 1)).ok(), Some(5));
        for wrong in [
            r#""bufferView":0,"count":4"#.to_owned(),
            r#""bufferView":0,"count":3,"byteOffset":1"#.to_owned(),
            r#""bufferView":0,"count":4294967296"#.to_owned(),
            r#""bufferView":0,"count":1,"byteOffset":9223372036854775807"#.to_owned(),
            sparse("4294967296", "5", 1),
            sparse("4294967296", "4294967296", 1),
            sparse("1", "4294967296", 1),
            sparse("2", "5", 1),
            sparse("4", "5", 0),
        ] {
            let error = read(&wrong).expect_err(&wrong).to_string();
            assert!(error.contains("reaches beyond its buffer"), "{wrong}: {error}");
        }
    }

    #[test]
    fn a_picture_that_says_it_is_huge_is_refused() {
        let told = look(r#""bufferView":0,"count":3"#, IMAGE, |document| {
            let document = document.expect("glTF");
            images::png(&document, &Resource::file("huge.png", "image/png")).expect_err("26 GB").to_string()
        });
        assert!(told.contains("huge.png") && told.contains("imit"), "{told}");
    }

    #[test]
    fn positions_without_an_accessor_are_refused() {
        let text = r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":7}}]}]}"#;
        let told = Document::of(Path::new("scene.gltf"), text.as_bytes(), &Store::default()).err();
        let told = told.map(|error| error.to_string()).unwrap_or_default();
        assert!(told.contains("no accessor 7"), "{told}");
    }

    #[test]
    fn an_image_from_nowhere_is_refused() {
        for image in [r#"{"name":"x"}"#, r#"{"bufferView":0}"#] {
            let told = look(r#""bufferView":0,"count":3"#, image, |document| {
                document.err().map(|error| error.to_string()).unwrap_or_default()
            });
            assert!(told.contains("image 0"), "{image}: {told}");
        }
    }

    #[test]
    fn nothing_outside_the_folder_is_read() {
        for uri in ["../secret.bin", "..%2fsecret.bin", "/dev/zero", "/etc/hostname"] {
            let told = look(r#""bufferView":0,"count":3"#, IMAGE, |document| {
                let document = document.expect("glTF");
                document.bytes(&Resource::file(uri, "")).expect_err(uri).to_string()
            });
            assert!(told.contains("outside the folder"), "{uri}: {told}");
        }
    }
}
