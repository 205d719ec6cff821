//! What `viewer --screenshot` does: landscapes → one PNG file.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use genescape_world::{Source, output};
use glam::{Vec2, Vec3};

use crate::camera::Camera;
use crate::cli::Cli;
use crate::headless::{Headless, scene_files};
use crate::image_file;
use crate::options::FrameInput;
use crate::passes::Shaders;
use crate::say;
use crate::walk::{Anchor, Land, Rig, start_pose};

const DEFAULT_SIZE_PX: [u32; 2] = [1280, 800];

/// Draws what the command line asks for.
pub fn take(cli: &Cli, source: &Source, out: &Path) -> Result<()> {
    // Scenes have other endings: none can be written over.
    output::check(out, "png", &[])?;
    image_file::make_folder(out)?;
    let paths = chosen(cli, scene_files(source)?)?;
    let options = cli.drawing;
    let headless = Headless::open(&Shaders::from(cli.shaders.clone()), options.samples)?;
    let [width, height] = cli.size.unwrap_or(DEFAULT_SIZE_PX);
    image_file::check_size(&headless.gpu, [width, height])?;
    let loaded = paths.iter().map(|path| headless.load(path)).collect::<Result<Vec<_>>>()?;
    for asset in loaded.iter().filter_map(|loaded| loaded.exhibit.asset()) {
        asset.facts.notes.iter().for_each(|note| say!("{}: {note}", asset.name));
    }
    let lands: Vec<&Land> = loaded.iter().map(|loaded| &*loaded.land).collect();
    let rig = Rig::new(start_pose(&lands), &lands);

    let columns = if loaded.len() > 1 { 2 } else { 1 };
    let rows = loaded.len().div_ceil(columns) as u32;
    let size = [(width / columns as u32).max(1), (height / rows).max(1)];
    let frame = FrameInput { options, time_s: cli.time, ..FrameInput::default() };
    let mut pictures = Vec::new();
    for one in &loaded {
        let mut view = headless.view(one.exhibit.clone(), size);
        let walker = camera(cli, &rig, &one.land, options.fov_y_deg.to_radians());
        let camera = if options.overhead { one.land.overhead(walker.fov_y_rad) } else { walker };
        pictures.push(headless.shoot_still(&mut view, &frame, [&camera, &walker])?);
    }
    let sheet = image_file::contact_sheet(&pictures, columns);
    let sheet = sheet.ok_or_else(|| anyhow!("there is nothing to draw"))?;
    image_file::write_png(out, &sheet)?;
    let (width, height) = sheet.dimensions();
    say!("wrote {} ({width} × {height}), drawn by {}", out.display(), headless.gpu.name);
    Ok(())
}

/// The scenes to draw: the one asked for, all, or the first.
fn chosen(cli: &Cli, mut paths: Vec<PathBuf>) -> Result<Vec<PathBuf>> {
    let count = paths.len();
    match cli.landscape.map(usize::from) {
        Some(landscape) if landscape > count => {
            Err(anyhow!("there is no landscape {landscape}: there are {count}"))
        }
        Some(landscape) => Ok(vec![paths.swap_remove(landscape - 1)]),
        None => {
            paths.truncate(if cli.all { count } else { 1 });
            Ok(paths)
        }
    }
}

fn camera(cli: &Cli, rig: &Rig, land: &Land, fov_y_rad: f32) -> Camera {
    let Some(place) = cli.camera else { return rig.camera(land, fov_y_rad) };
    let land = Land { anchor: Anchor::default(), ..land.clone() };
    // Of anyone's file, in the file's metres.
    let scale = land.subject.map_or(1.0, |subject| subject.scale);
    let place_m = Vec2::new(place.x_m, place.z_m) * scale;
    let height_m = (land.ground_m(place_m) + place.height_m * scale).max(land.floor_m(place_m));
    Camera {
        position_m: Vec3::new(place_m.x, height_m, place_m.y),
        yaw_rad: place.yaw_deg.to_radians(),
        pitch_rad: place.pitch_deg.to_radians(),
        fov_y_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[test]
    fn landscapes_are_counted_from_one() {
        let chosen = |words: &[&str]| {
            let cli = Cli::try_parse_from([&["viewer"], words].concat()).map_err(anyhow::Error::from)?;
            chosen(&cli, vec!["a".into(), "b".into(), "c".into()])
        };
        assert_eq!(chosen(&["--landscape", "2"]).expect("there"), [PathBuf::from("b")]);
        assert_eq!(chosen(&[]).expect("there"), [PathBuf::from("a")]);
        assert_eq!(chosen(&["--all"]).expect("there").len(), 3);
        for wrong in ["0", "4", "5"] {
            assert!(chosen(&["--landscape", wrong]).is_err(), "{wrong}");
        }
    }
}
