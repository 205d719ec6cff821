//! PNG, JPEG and WebP of a stranger → images in memory, of bounded size. What cannot be read is left out with a note.

use std::io::Cursor;
use std::sync::Arc;

use gltf::json::{self, Index};
use image::{ImageFormat, ImageReader, Limits};

use super::file::AssetFile;
use super::notes::{Notes, quoted};
use crate::load::bounds::MAX_PICTURE_PX;
use crate::scene::Image;

/// Decoded pixels of all pictures together, in bytes.
const MAX_BYTES: usize = 1 << 31;

/// The pictures of a file, decoded when they are first asked for.
pub(super) struct Pictures<'a> {
    file: &'a AssetFile,
    known: Vec<Option<Option<Arc<Image>>>>,
    left: usize,
}

impl<'a> Pictures<'a> {
    pub fn of(file: &'a AssetFile) -> Self {
        Self { file, known: vec![None; file.root.images.len()], left: MAX_BYTES }
    }

    /// The picture of that number.
    pub fn get(&mut self, index: Index<json::Image>, notes: &mut Notes) -> Option<Arc<Image>> {
        let known = self.known.get(index.value())?;
        if let Some(known) = known {
            return known.clone();
        }
        let image = match self.read(index) {
            Ok(image) => {
                self.left -= image.levels.iter().map(|level| level.len()).sum::<usize>();
                Some(Arc::new(image))
            }
            Err(what) => {
                notes.add(format!("Picture {} is left out: {what}", self.name(index)));
                None
            }
        };
        self.known[index.value()] = Some(image.clone());
        image
    }

    fn name(&self, index: Index<json::Image>) -> String {
        let image = &self.file.root.images[index.value()];
        let uri = image.uri.as_ref().filter(|uri| !uri.starts_with("data:"));
        image.name.as_ref().or(uri).map_or(index.value().to_string(), |name| quoted(name))
    }

    fn read(&self, index: Index<json::Image>) -> Result<Image, String> {
        let image = &self.file.root.images[index.value()];
        let mut finest = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => self.decode(&self.file.bytes_of_uri(uri)?)?,
            (None, Some(view)) => {
                self.decode(self.file.view(view).ok_or("its part of the buffer is not there")?)?
            }
            (None, None) => return Err("it says not where it is".to_owned()),
        };
        finest.levels.extend(self.mipmaps(image, &finest));
        Ok(finest)
    }

    fn decode(&self, bytes: &[u8]) -> Result<Image, String> {
        let kind =
            image::guess_format(bytes).map_err(|_| "it is neither PNG nor JPEG nor WebP".to_owned())?;
        if ![ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP].contains(&kind) {
            return Err(format!("it is {kind:?}, and not PNG, JPEG or WebP"));
        }
        let mut reader = ImageReader::with_format(Cursor::new(bytes), kind);
        let mut limits = Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(MAX_PICTURE_PX), Some(MAX_PICTURE_PX));
        reader.limits(limits);
        let rgba = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
        let (width_px, height_px) = rgba.dimensions();
        if width_px == 0 || height_px == 0 || rgba.len() > self.left {
            return Err("all pictures together are too large".to_owned());
        }
        // Named by its content: a file that is saved anew may hold another under the old name.
        let name = format!("{width_px}x{height_px} {}", genescape_cache::Digest::of(&rgba));
        Ok(Image { name, width_px, height_px, levels: vec![rgba.into_raw().into()] })
    }

    /// Coarser versions that a file of ours brings, by which leaves keep their coverage; none if they do not fit.
    fn mipmaps(&self, image: &json::Image, finest: &Image) -> Vec<Arc<[u8]>> {
        #[derive(Default, serde::Deserialize)]
        #[serde(default)]
        struct Extras {
            mipmaps: Vec<genescape_schema::scene::Resource>,
        }
        let extras = image.extras.as_ref().and_then(|raw| serde_json::from_str::<Extras>(raw.get()).ok());
        let mut levels = Vec::new();
        for (level, resource) in (1..16).zip(extras.unwrap_or_default().mipmaps) {
            let bytes = match (&resource.uri, resource.buffer_view) {
                (Some(uri), _) => self.file.bytes_of_uri(uri).ok(),
                (None, Some(view)) => self.file.view(Index::new(view as u32)).map(<[u8]>::to_vec),
                (None, None) => None,
            };
            let Some(coarser) = bytes.and_then(|bytes| self.decode(&bytes).ok()) else { return Vec::new() };
            let size = [finest.width_px, finest.height_px].map(|side| (side >> level).max(1));
            if size != [coarser.width_px, coarser.height_px] {
                return Vec::new();
            }
            levels.extend(coarser.levels);
        }
        levels
    }
}
