//! What a view can show: a landscape of ours, or anyone's file.

use std::sync::{Arc, Weak};

use super::{AssetBuffers, SceneBuffers};

#[derive(Clone, Debug)]
pub enum Exhibit {
    Landscape(Arc<SceneBuffers>),
    Asset(Arc<AssetBuffers>),
}

/// Knows it again, and does not keep it.
#[derive(Clone, Debug)]
pub enum WeakExhibit {
    Landscape(Weak<SceneBuffers>),
    Asset(Weak<AssetBuffers>),
}

impl Exhibit {
    /// The landscape's or the file's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Landscape(scene) => &scene.name,
            Self::Asset(asset) => &asset.name,
        }
    }

    pub fn landscape(&self) -> Option<&Arc<SceneBuffers>> {
        if let Self::Landscape(scene) = self { Some(scene) } else { None }
    }

    pub fn asset(&self) -> Option<&Arc<AssetBuffers>> {
        if let Self::Asset(asset) = self { Some(asset) } else { None }
    }

    pub fn downgrade(&self) -> WeakExhibit {
        match self {
            Self::Landscape(scene) => WeakExhibit::Landscape(Arc::downgrade(scene)),
            Self::Asset(asset) => WeakExhibit::Asset(Arc::downgrade(asset)),
        }
    }
}

impl WeakExhibit {
    /// Whether it is this very one.
    pub fn is(&self, exhibit: &Exhibit) -> bool {
        match (self, exhibit) {
            (Self::Landscape(known), Exhibit::Landscape(scene)) => known.as_ptr() == Arc::as_ptr(scene),
            (Self::Asset(known), Exhibit::Asset(asset)) => known.as_ptr() == Arc::as_ptr(asset),
            _ => false,
        }
    }
}

impl From<Arc<SceneBuffers>> for Exhibit {
    fn from(scene: Arc<SceneBuffers>) -> Self {
        Self::Landscape(scene)
    }
}

impl From<Arc<AssetBuffers>> for Exhibit {
    fn from(asset: Arc<AssetBuffers>) -> Self {
        Self::Asset(asset)
    }
}
