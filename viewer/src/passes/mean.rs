//! Accumulation: radiance of one picture after the other → their mean.
//!
//! The pictures show the same, but each has its pixels' middles a little beside, and other numbers where something covers a pixel
//! by chance. So their mean has smooth edges, and what dissolves is half transparent (Haeberli & Akeley, "The accumulation
//! buffer", 1990).

use super::shaders::ShaderError;
use super::{Compiler, PipelineDesc, Shader, Target};

pub const SHADER: Shader = Shader { name: "mean", source: include_str!("mean.wgsl"), constants: &[] };

/// Of how many pictures a still one is the mean in the end.
pub const fn pictures(samples: u32) -> u32 {
    if samples > 1 { 8 } else { 16 }
}

/// Factors whose multiples, without their whole parts, spread evenly in a square (Roberts, "The unreasonable effectiveness of
/// quasirandom sequences", 2018).
const SPREAD: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// What makes one of the pictures another than those before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// How far the middles of pixels are moved, in pixels to the right and up, each below a half.
    pub middle_px: [f32; 2],
    /// What numbers by chance are moved by, in [0, 1).
    pub noise: f32,
    /// What is added to the mip levels of textures: the mean of all pictures averages what one has between its pixels' middles.
    pub mip_bias: f32,
}

impl Shift {
    /// Of the picture before which so many have been drawn; that of the first is none. Samples that are several a pixel are
    /// spread already and move by less.
    pub fn of(accumulated: u32, samples: u32) -> Self {
        let reach = 1.0 / f64::from(samples).sqrt();
        let beside = |factor: f64| {
            let place = (f64::from(accumulated) * factor + 0.5).rem_euclid(1.0);
            (reach * (place - 0.5)) as f32
        };
        // Van der Corput's sequence: halves, quarters, eighths.
        let noise = f64::from(accumulated.reverse_bits()) / (1_u64 << u32::BITS) as f64;
        let mip_bias = if accumulated == 0 { 0.0 } else { -0.5 * libm::log2f(pictures(samples) as f32) };
        Self { middle_px: SPREAD.map(beside), noise: noise as f32, mip_bias }
    }
}

#[derive(Debug)]
pub struct Mean {
    pipeline: wgpu::RenderPipeline,
}

impl Mean {
    pub const NAME: &str = SHADER.name;

    pub(super) fn new(compiler: &Compiler<'_>) -> Result<Self, ShaderError> {
        let module = compiler.module(&SHADER)?;
        let by_constant = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = Some(wgpu::BlendState { color: by_constant, alpha: by_constant });
        let groups = [&compiler.layouts.camera, &compiler.layouts.radiance];
        let usual = PipelineDesc::new(&module, &groups);
        Ok(Self { pipeline: compiler.pipeline(&PipelineDesc { target: Target::Mean, blend, ..usual }) })
    }

    /// One draw: into what is the mean of `accumulated` pictures another one. Group 0 is set; `radiance` is group 1.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, radiance: &wgpu::BindGroup, accumulated: u32) {
        let share = 1.0 / f64::from(accumulated + 1);
        pass.set_pipeline(&self.pipeline);
        pass.set_blend_constant(wgpu::Color { r: share, g: share, b: share, a: share });
        pass.set_bind_group(1, radiance, &[]);
        pass.draw(0..3, 0..1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_picture_is_as_it_always_was_and_all_together_have_their_middles_all_over_the_pixel() {
        assert_eq!(Shift::of(0, 1), Shift::default());
        for (samples, reach) in [(1, 1.0), (4, 0.5)] {
            let count = pictures(samples);
            let shifts: Vec<Shift> = (0..count).map(|n| Shift::of(n, samples)).collect();
            for quarter in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0f32]] {
                let is_there = |shift: &&Shift| {
                    let [x, y] = shift.middle_px;
                    x * quarter[0] >= 0.0 && y * quarter[1] >= 0.0
                };
                let there = shifts.iter().filter(is_there).count() as u32;
                assert!((count / 5..=count / 2).contains(&there), "{there} of {count} in {quarter:?}");
            }
            let all = shifts.iter().flat_map(|shift| shift.middle_px);
            assert!(all.clone().all(|t| t.abs() <= 0.5 * reach) && all.fold(0.0, f32::max) > 0.4 * reach);
            assert!(shifts[1..].iter().all(|shift| shift.mip_bias < 0.0));
            let mut noise: Vec<f32> = shifts.iter().map(|shift| shift.noise).collect();
            noise.sort_by(f32::total_cmp);
            assert!(
                (0..count).map(|n| n as f32 / count as f32).eq(noise),
                "each number by chance comes as often"
            );
        }
    }
}
