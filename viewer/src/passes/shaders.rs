//! WGSL sources: built in, or from a folder while one works on them. Each is a pass's own, whose lines so keep their
//! numbers, followed by `common.wgsl`; checked by naga so that errors are reported with file and line before the driver
//! sees anything.

use std::path::PathBuf;

use thiserror::Error;

use super::SHADERS;

/// What every pass's shader ends with.
const COMMON: &str = include_str!("common.wgsl");

/// Where sources come from.
#[derive(Clone, Debug, Default)]
pub struct Shaders {
    folder: Option<PathBuf>,
}

/// A shader that cannot be used.
#[derive(Debug, Error)]
pub enum ShaderError {
    /// naga refuses it.
    #[error("{name}.wgsl is wrong:\n{text}")]
    Wrong { name: String, text: String },
    /// A pipeline cannot be made from it.
    #[error("a shader does not fit its pipeline: {text}")]
    Refused { text: String },
    #[error("cannot read {path}: {reason}")]
    Unreadable { path: PathBuf, reason: std::io::Error },
}

/// From a folder, if there is one; any shader that is not in it is taken from the built-in ones.
impl From<Option<PathBuf>> for Shaders {
    fn from(folder: Option<PathBuf>) -> Self {
        Self { folder }
    }
}

impl Shaders {
    /// Those that were built in.
    pub fn builtin() -> Self {
        Self::default()
    }

    /// Names of all shaders, without "common".
    pub fn names() -> impl Iterator<Item = &'static str> {
        SHADERS.iter().map(|shader| shader.name)
    }

    fn source(&self, name: &str, builtin: &str) -> Result<String, ShaderError> {
        let Some(folder) = &self.folder else { return Ok(builtin.to_owned()) };
        let path = folder.join(name).with_extension("wgsl");
        match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(builtin.to_owned()),
            read => read.map_err(|reason| ShaderError::Unreadable { path, reason }),
        }
    }

    /// The whole text of a shader: its own, then the common part.
    pub fn text(&self, name: &str) -> Result<String, ShaderError> {
        Ok(self.own_text(name)? + &self.source("common", COMMON)?)
    }

    fn own_text(&self, name: &str) -> Result<String, ShaderError> {
        let builtin = SHADERS.iter().find(|shader| shader.name == name).map_or("", |shader| shader.source);
        Ok(self.source(name, builtin)? + "\n")
    }

    /// Parses and checks a shader.
    pub fn check(&self, name: &str) -> Result<(naga::Module, naga::valid::ModuleInfo), ShaderError> {
        let (own_lines, text) = (self.own_text(name)?.lines().count(), self.text(name)?);
        let wrong = |mut text: String, place: Option<naga::SourceLocation>| {
            let line = place.and_then(|place| (place.line_number as usize).checked_sub(own_lines));
            if let Some(line @ 1..) = line {
                text += &format!("(that is line {line} of common.wgsl)");
            }
            ShaderError::Wrong { name: name.to_owned(), text }
        };
        let path = format!("{name}.wgsl");
        let module = naga::front::wgsl::parse_str(&text)
            .map_err(|error| wrong(error.emit_to_string_with_path(&text, &path), error.location(&text)))?;
        let flags = naga::valid::ValidationFlags::all();
        let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::all())
            .validate(&module)
            .map_err(|error| wrong(error.emit_to_string_with_path(&text, &path), error.location(&text)))?;
        Ok((module, info))
    }

    /// Compiles a shader.
    pub fn module(&self, device: &wgpu::Device, name: &str) -> Result<wgpu::ShaderModule, ShaderError> {
        self.check(name)?;
        let source = wgpu::ShaderSource::Wgsl(self.text(name)?.into());
        Ok(device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source }))
    }
}
