//! What a person wants of an export: for whom, in which form, where. Kept in the settings.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExportChoice {
    pub audience: Audience,
    pub form: Form,
    /// With the land beyond the field, to the horizon.
    pub apron: bool,
    /// The folder to write to; empty for `exports` beside the world.
    pub folder: String,
}

/// The program that files are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Audience {
    /// Any viewer of glTF files.
    #[default]
    Viewers,
    Blender,
}

/// What is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// The landscape as one self-contained file; for Blender, with sky and script beside it.
    #[default]
    File,
    /// A folder with the landscape, its sky and its trees.
    Folder,
}

impl ExportChoice {
    /// The same for another program, with or without the land around as that program takes it best.
    pub fn made_for(self, audience: Audience) -> Self {
        Self { audience, apron: audience == Audience::Blender, ..self }
    }
}
