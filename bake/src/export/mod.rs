//! A baked scene → files for other programs: a self-contained .glb, the sky, the trees, and what Blender needs besides.
//!
//! [`plan`] says which files there will be; each is made when its turn comes, so that only one is in memory.

mod blender;
mod instancing;
mod look;
mod names;
mod receipts;
mod sky_preview;
#[cfg(test)]
pub(crate) use sky_preview::film;
mod source;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::ValueEnum;
use genescape_schema::scene::Resource;
use genescape_world::{atomic_write, output};
use serde_json::Value;
use thiserror::Error;

use crate::events::{Event, Listener};
use crate::gltf;

use names::Names;
use receipts::Receipts;
use source::SceneFile;

/// Whom an export is to please.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Audience {
    /// Viewers of glTF files: three.js, Babylon.js, F3D.
    #[default]
    Viewers,
    Blender,
}

/// How a scene is exported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    pub audience: Audience,
    /// With the land beyond the field, to the horizon.
    pub apron: bool,
    /// Trees by `EXT_mesh_gpu_instancing`.
    pub instancing: bool,
}

/// What became of an export.
#[derive(Clone, Debug, Default)]
pub struct Exported {
    /// The files in the order in which they were written, with their lengths.
    pub files: Vec<(PathBuf, u64)>,
    /// The greatest distance in metres by which `instancing` moved any corner of a tree's box.
    pub shear_lost_m: Option<f64>,
}

/// A file in the way that no export wrote, or that was changed since.
#[derive(Debug, Error)]
#[error("{} is there already, and is not what an earlier export of this landscape wrote; move it, or export elsewhere", .0.display())]
pub struct InTheWay(pub PathBuf);

/// One file of an export.
#[derive(Clone, Debug, PartialEq)]
struct File {
    /// Relative to the folder, with `/` between folders.
    name: String,
    content: Content,
}

#[derive(Clone, Debug, PartialEq)]
enum Content {
    /// The scene as one .glb.
    Scene,
    /// A blob as it is.
    Blob(Resource),
    /// The sky as one sees it.
    SkyPreview,
    /// What Blender runs.
    BlenderScript,
}

/// What names of a scene's files begin with: "oak-valley-in-june".
///
/// # Errors
/// A scene that cannot be read.
pub fn stem(scene: &Path) -> Result<String> {
    Ok(names::stem(&SceneFile::open(scene)?.json))
}

/// Writes a scene, its sky and its trees into a folder, which is made if it isn't there.
///
/// # Errors
/// [`InTheWay`], before anything is written; a scene that cannot be read; a folder that cannot be written to.
pub fn to_folder(scene: &Path, folder: &Path, options: Options, listener: &dyn Listener) -> Result<Exported> {
    let scene = SceneFile::open(scene)?;
    let names = Names::of(&scene);
    output::check(&folder.join(names.scene()), "glb", &[])?;
    let files = plan(&scene.json, &names, options)?;
    write(&scene, &names, folder, &files, options, listener)
}

/// Writes a scene as one .glb; for Blender with sky and script beside it.
///
/// # Errors
/// As [`to_folder`].
pub fn to_file(scene: &Path, file: &Path, options: Options, listener: &dyn Listener) -> Result<Exported> {
    output::check(file, "glb", &[scene.to_owned()])?;
    let scene = SceneFile::open(scene)?;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let names = Names { stem, ..Names::of(&scene) };
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut files = plan(&scene.json, &names, options)?;
    let for_blender = options.audience == Audience::Blender;
    files.retain(|file| match &file.content {
        Content::Scene => true,
        Content::Blob(_) => for_blender && file.name == names.sky(),
        Content::SkyPreview => false,
        Content::BlenderScript => for_blender,
    });
    if let (Some(scene), Some(name)) = (files.first_mut(), file.file_name()) {
        scene.name = name.to_string_lossy().into_owned();
    }
    write(&scene, &names, folder, &files, options, listener)
}

/// Which files there will be, the scene first.
fn plan(scene: &Value, names: &Names, options: Options) -> Result<Vec<File>> {
    let mut files = vec![
        File { name: names.scene(), content: Content::Scene },
        File { name: names.sky(), content: Content::Blob(source::sky(scene)?.images.equirect) },
        File { name: names.sky_preview(), content: Content::SkyPreview },
    ];
    for (index, tree) in source::tree_files(scene)?.into_iter().enumerate() {
        files.push(File { name: names.tree(index), content: Content::Blob(tree) });
    }
    if options.audience == Audience::Blender {
        files.push(File { name: names.script(), content: Content::BlenderScript });
    }
    Ok(files)
}

fn write(
    scene: &SceneFile,
    names: &Names,
    folder: &Path,
    files: &[File],
    options: Options,
    listener: &dyn Listener,
) -> Result<Exported> {
    let mut receipts = Receipts::open(&scene.baked(), &names::stem(&scene.json))?;
    for file in files {
        receipts.allow(&folder.join(&file.name), &file.name)?;
    }
    listener.tell(&Event::Exporting { files: files.len() });
    let mut exported = Exported::default();
    for file in files {
        let path = folder.join(&file.name);
        let bytes = match &file.content {
            Content::Scene => {
                let (glb, shear_lost_m) = single_file(scene, names, options)?;
                exported.shear_lost_m = shear_lost_m;
                glb
            }
            Content::Blob(resource) => scene.resource(resource)?,
            Content::SkyPreview => {
                let sky = source::sky(&scene.json)?;
                sky_preview::jpeg(&scene.resource(&sky.images.equirect)?, sky.light.exposure)?
            }
            Content::BlenderScript => blender::script(&scene.json, names)?.into_bytes(),
        };
        // Before the file, so that one which is half of an export that was cut off is known as well.
        receipts.note(&bytes, &file.name)?;
        atomic_write::replace(&path, &bytes).with_context(|| format!("cannot write {}", path.display()))?;
        let length = bytes.len() as u64;
        listener.tell(&Event::Written { path: path.display().to_string(), bytes: length });
        exported.files.push((path, length));
    }
    Ok(exported)
}

/// The scene as one .glb, changed to what its audience shows well; and what instancing lost in metres.
fn single_file(scene: &SceneFile, names: &Names, options: Options) -> Result<(Vec<u8>, Option<f64>)> {
    let mut root = scene.json.clone();
    if !options.apron {
        look::remove_apron(&mut root);
    }
    match options.audience {
        Audience::Viewers => look::add_sky_glow(&mut root, &|accessor| scene.accessor_bytes(accessor))?,
        Audience::Blender => {
            look::sun_in_lux(&mut root);
            blender::prepare(&mut root, names)?;
        }
    }
    let mut instances = instancing::Instanced::default();
    if options.instancing {
        let far = if options.apron { scene.far_instances()? } else { Vec::new() };
        instances = instancing::instance(&mut root, [&scene.instances()?, &far], &scene.tree_sizes_m()?)?;
    }
    let resolve = |uri: &str| match uri {
        instancing::BUFFER => Ok(instances.bytes.clone()),
        _ => scene.read(uri).map_err(|error| format!("{error:#}")),
    };
    let glb = gltf::single_glb(root, resolve).with_context(|| {
        format!("{}: cannot be made one file; bake again if blobs are missing", scene.path.display())
    })?;
    Ok((glb, options.instancing.then_some(instances.lost_m)))
}
