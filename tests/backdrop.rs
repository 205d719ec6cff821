//! Trees before a black sky and before a white one: how much of the sky they hide, and the light that comes from them, each
//! pixel by its share (A. R. Smith and J. F. Blinn, "Blue Screen Matting", SIGGRAPH 1996).

use std::path::Path;

use genescape_viewer::camera::Camera;
use genescape_viewer::headless::Headless;
use genescape_viewer::options::FrameInput;
use genescape_viewer::passes::Shaders;
use genescape_viewer::scene::Scene;
use genescape_viewer::view::View;
use tempfile::TempDir;

/// Pictures hold roots of radiance up to this, which can be added again, instead of what a film makes of it.
const BRIGHTEST: f64 = 5.0;
/// What a pixel of the white sky holds, of 255: so there is room for a tree's light above it.
const WHITE: f64 = 160.0;

/// Samples a pixel: as screenshots have, and windows on a graphics card.
const SAMPLES: u32 = 4;

/// A device for each sky.
pub struct Backdrops {
    black: Headless,
    white: Headless,
    _shaders: [TempDir; 2],
}

/// A landscape before both.
pub struct Stage {
    black: View,
    white: View,
}

/// What trees are in a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Matte {
    /// The pixels that they hide, a pixel in part as a part.
    pub pixels: f64,
    /// The sum of their radiance over these, exposed, in red, green and blue.
    pub light: [f64; 3],
    /// Of neighbours that are all tree: the sum of what they differ by, in all channels together.
    pub differ: f64,
    /// And of what they have together.
    pub together: f64,
}

impl Matte {
    /// By how much neighbours within a tree differ in light, as a part of their mean.
    pub fn contrast(&self) -> f64 {
        2.0 * self.differ / self.together.max(1e-9)
    }

    pub fn radiance(&self) -> [f64; 3] {
        self.light.map(|sum| sum / self.pixels)
    }

    /// The root of radiance, in which the eye sees evenly.
    pub fn brightness(&self) -> f64 {
        self.radiance().iter().sum::<f64>().sqrt()
    }
}

impl std::ops::AddAssign for Matte {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.differ += other.differ;
        self.together += other.together;
        self.light.iter_mut().zip(other.light).for_each(|(sum, one)| *sum += one);
    }
}

impl Backdrops {
    pub fn open() -> Self {
        let folders = [0, 1].map(|_| tempfile::tempdir().expect("a temporary folder"));
        let [black, white] = [(0.0, &folders[0]), (radiance(WHITE), &folders[1])]
            .map(|(sky, folder)| Headless::open(&shaders(folder.path(), sky), SAMPLES).expect("a device"));
        Self { black, white, _shaders: folders }
    }

    /// Any of the devices, to read scenes with.
    pub fn studio(&self) -> &Headless {
        &self.black
    }

    pub fn stage(&self, scene: &Scene, size_px: [u32; 2]) -> Stage {
        let [black, white] = [&self.black, &self.white]
            .map(|studio| studio.view(studio.upload(scene).expect("uploaded"), size_px));
        Stage { black, white }
    }

    pub fn resize(&self, stage: &mut Stage, size_px: [u32; 2]) {
        stage.black.resize(&self.black.passes, size_px);
        stage.white.resize(&self.white.passes, size_px);
    }

    /// What `frame` draws before the sky.
    pub fn look(&self, stage: &mut Stage, frame: &FrameInput, camera: &Camera) -> Matte {
        let before =
            |studio: &Headless, view: &mut View| studio.shoot(view, frame, camera, camera).expect("drawn");
        let (black, white) = (before(&self.black, &mut stage.black), before(&self.white, &mut stage.white));
        let mut matte = Matte::default();
        let width = black.width() as usize;
        let mut beside: Option<f64> = None;
        for (n, (black, white)) in black.pixels().zip(white.pixels()).enumerate() {
            let [black, white] = [black, white].map(|pixel| [0, 1, 2].map(|c| radiance(pixel.0[c].into())));
            let passes: f64 = (0..3).map(|c| white[c] - black[c]).sum::<f64>() / 3.0 / radiance(WHITE);
            matte += Matte { pixels: 1.0 - passes, light: black, ..Matte::default() };
            let whole = (passes < 0.01).then(|| black.iter().sum::<f64>());
            if n % width > 0
                && let (Some(left), Some(right)) = (beside, whole)
            {
                matte.differ += (left - right).abs();
                matte.together += left + right;
            }
            beside = whole;
        }
        matte
    }
}

/// What a channel's value stands for.
fn radiance(value: f64) -> f64 {
    BRIGHTEST * (value / 255.0) * (value / 255.0)
}

fn shaders(folder: &Path, sky: f64) -> Shaders {
    let replace = |name: &str, shader: &str, old: &str, new: &str| {
        assert!(shader.contains(old), "{name} draws otherwise");
        std::fs::write(folder.join(name), shader.replace(old, new)).expect("written");
    };
    let film = "film(linear) + grain(pixel.xy) / 255.0";
    let root = format!("sqrt(linear / {BRIGHTEST:?}) + 0.0 * ({film})");
    replace("tone.wgsl", include_str!("../viewer/src/passes/tone.wgsl"), film, &root);
    let even = format!("return vec4f(vec3f({sky:?} / view.exposure) + 0.0 * radiance, 1.0);");
    let own = "return vec4f(radiance, 1.0);";
    replace("sky.wgsl", include_str!("../viewer/src/passes/sky.wgsl"), own, &even);
    Shaders::from(Some(folder.to_owned()))
}
