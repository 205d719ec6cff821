//! Meshes of a .glb → meshes of a scene that has the .glb for a buffer: only tables are copied, never vertices.

use genescape_schema::scene::{
    GSC_IMPOSTOR, GSC_PROGRESSIVE_MESH, ImpostorExtension, ProgressiveMeshExtension,
};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::ExportError;
use super::document::{Document, push};
use super::glb::{GlbDocument, read_glb};
use super::scene_parts::GlbBlob;

/// A .glb that a scene uses.
pub struct GlbImport {
    uri: String,
    glb: GlbDocument,
    buffer: usize,
}

/// A material of the file.
pub struct FileMaterial<'a> {
    pub index: usize,
    pub name: &'a str,
}

impl GlbImport {
    /// Adds the file to the scene's buffers.
    pub fn open(document: &mut Document, blob: &GlbBlob<'_>) -> Result<Self, ExportError> {
        let glb = read_glb(&blob.uri, blob.bytes)?;
        let buffer = push(&mut document.buffers, json!({ "uri": blob.uri, "byteLength": blob.bytes.len() }));
        Ok(Self { uri: blob.uri.clone(), glb, buffer })
    }

    fn list(&self, key: &str) -> &[Value] {
        self.glb.json[key].as_array().map_or(&[], Vec::as_slice)
    }

    fn item(&self, key: &str, index: &Value) -> Result<&Value, ExportError> {
        let found = index.as_u64().and_then(|i| self.list(key).get(i as usize));
        found.ok_or_else(|| ExportError::NotGltf(self.uri.clone(), format!("it has no {key} {index}")))
    }

    /// Names of its meshes, in order.
    pub fn mesh_names(&self) -> Vec<String> {
        self.list("meshes").iter().map(|m| m["name"].as_str().unwrap_or_default().into()).collect()
    }

    /// Names of its materials, in order.
    pub fn material_names(&self) -> impl Iterator<Item = &str> {
        self.list("materials").iter().map(|material| material["name"].as_str().unwrap_or_default())
    }

    /// A material of the file as it is.
    pub fn material_json(&self, index: usize) -> Option<Value> {
        self.list("materials").get(index).cloned()
    }

    /// Numbers of the materials that its primitives have.
    pub fn materials_in_use(&self) -> Vec<usize> {
        let primitives =
            self.list("meshes").iter().filter_map(|mesh| mesh["primitives"].as_array()).flatten();
        primitives.filter_map(|p| p["material"].as_u64()).map(|m| m as usize).collect()
    }

    fn material(&self, index: &Value) -> Option<FileMaterial<'_>> {
        let index = index.as_u64()? as usize;
        Some(FileMaterial { index, name: self.material_names().nth(index)? })
    }

    /// Adds all meshes, in their order, so that mesh i becomes the returned number + i. `material_of` gives the
    /// scene's material for one of the file's.
    pub fn import_meshes(
        &self,
        document: &mut Document,
        material_of: &dyn Fn(FileMaterial<'_>) -> Option<usize>,
    ) -> Result<usize, ExportError> {
        let first = document.meshes.len();
        for mesh in self.list("meshes") {
            let mut mesh = mesh.clone();
            for primitive in mesh["primitives"].as_array_mut().into_iter().flatten() {
                self.import_primitive(document, primitive, material_of)?;
            }
            if let Some(extension) = mesh.pointer_mut(&format!("/extensions/{GSC_PROGRESSIVE_MESH}")) {
                *extension = self.import_progressive(document, extension, first)?;
                document.extensions_used.insert(GSC_PROGRESSIVE_MESH.into());
            }
            if let Some(extension) = mesh.pointer_mut(&format!("/extensions/{GSC_IMPOSTOR}")) {
                *extension = self.import_impostor(document, extension, first)?;
                document.extensions_used.insert(GSC_IMPOSTOR.into());
            }
            document.meshes.push(mesh);
        }
        Ok(first)
    }

    fn import_primitive(
        &self,
        document: &mut Document,
        primitive: &mut Value,
        material_of: &dyn Fn(FileMaterial<'_>) -> Option<usize>,
    ) -> Result<(), ExportError> {
        let material = primitive.get("material").and_then(|index| self.material(index)).and_then(material_of);
        if let Some(material) = material {
            primitive["material"] = material.into();
        }
        self.import_attributes(document, &mut primitive["attributes"])?;
        primitive["indices"] = self.import_accessor(document, &primitive["indices"])?.into();
        for target in primitive.get_mut("targets").and_then(Value::as_array_mut).into_iter().flatten() {
            self.import_attributes(document, target)?;
        }
        Ok(())
    }

    fn import_attributes(&self, document: &mut Document, attributes: &mut Value) -> Result<(), ExportError> {
        for accessor in attributes.as_object_mut().into_iter().flat_map(|object| object.values_mut()) {
            *accessor = self.import_accessor(document, accessor)?.into();
        }
        Ok(())
    }

    fn import_progressive(
        &self,
        document: &mut Document,
        extension: &Value,
        first_mesh: usize,
    ) -> Result<Value, ExportError> {
        let mut typed: ProgressiveMeshExtension = self.typed(extension)?;
        typed.buffer_view = self.import_view(document, &typed.buffer_view.into())?;
        for level in &mut typed.levels {
            level.mesh += first_mesh;
            for accessor in level.strips.iter_mut().chain(&mut level.texcoord_deltas) {
                *accessor = self.import_accessor(document, &(*accessor).into())?;
            }
        }
        Ok(json!(typed))
    }

    fn import_impostor(
        &self,
        document: &mut Document,
        extension: &Value,
        first_mesh: usize,
    ) -> Result<Value, ExportError> {
        let mut typed: ImpostorExtension = self.typed(extension)?;
        typed.mesh += first_mesh;
        if let Some(view) = &mut typed.relief.buffer_view {
            *view = self.import_view(document, &(*view).into())?;
        }
        Ok(json!(typed))
    }

    fn typed<T: DeserializeOwned>(&self, extension: &Value) -> Result<T, ExportError> {
        let typed = serde_json::from_value(extension.clone());
        typed.map_err(|e| ExportError::NotGltf(self.uri.clone(), e.to_string()))
    }

    /// Adds the view of the embedded image of that name, if the file has one.
    pub fn import_image(&self, document: &mut Document, name: &str) -> Result<Option<usize>, ExportError> {
        let image = self.list("images").iter().find(|image| image["name"] == name);
        image.map(|image| self.import_view(document, &image["bufferView"])).transpose()
    }

    /// Adds the last accessor and its view in place of an accessor and the view that only it uses.
    pub fn replace_accessor(&self, document: &mut Document, index: usize) -> Result<(), ExportError> {
        let last = self.list("accessors").len().wrapping_sub(1);
        let mut accessor = self.item("accessors", &last.into())?.clone();
        let mut view = self.item("bufferViews", &accessor["bufferView"])?.clone();
        view["buffer"] = self.buffer.into();
        view["byteOffset"] = (view["byteOffset"].as_u64().unwrap_or(0) as usize + self.glb.bin_offset).into();
        let place = document.accessors[index]["bufferView"].as_u64().unwrap_or(0) as usize;
        accessor["bufferView"] = place.into();
        document.buffer_views[place] = view;
        document.accessors[index] = accessor;
        Ok(())
    }

    fn import_accessor(&self, document: &mut Document, index: &Value) -> Result<usize, ExportError> {
        let mut accessor = self.item("accessors", index)?.clone();
        for place in ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"] {
            if let Some(view) = accessor.pointer_mut(place) {
                *view = self.import_view(document, view)?.into();
            }
        }
        Ok(push(&mut document.accessors, accessor))
    }

    /// Views are few and found by place, since several accessors share the interleaved ones.
    fn import_view(&self, document: &mut Document, index: &Value) -> Result<usize, ExportError> {
        let mut view = self.item("bufferViews", index)?.clone();
        let offset = view["byteOffset"].as_u64().unwrap_or(0) as usize + self.glb.bin_offset;
        view["buffer"] = self.buffer.into();
        view["byteOffset"] = offset.into();
        // The views of this file are the last in the list, its interleaved vertices just before.
        let known = document.buffer_views.iter().rev().take(64).position(|other| *other == view);
        Ok(match known {
            Some(back) => document.buffer_views.len() - 1 - back,
            None => push(&mut document.buffer_views, view),
        })
    }
}
