//! What measurements of pictures have in common, for `viewer bench` and the laboratory: what work takes ([`Cost`], and on the
//! device [`Counters`]), where cameras stand ([`camera_path`]), how unlike two pictures are ([`l2`], [`flip()`]), and figures
//! over many values.

mod cost;
mod counters;
mod flip;
mod machine;
mod path;
mod statistics;
mod timed;

pub use cost::Cost;
pub use counters::{Counted, Counters};
pub use flip::flip;
pub use machine::{Machine, load_average};
pub use path::{camera_path, fly_out_path, forest};
pub use statistics::{TTest, deviation, mean, median, quantile, spearman, t_test};
pub use timed::timed;

use anyhow::Result;

use crate::gpu::Gpu;
use crate::image_file::read_buffer;
use crate::view::View;

/// Mean square difference of colours, of 8-bit values taken as [0, 1]; transparency counts not.
pub fn square_error(a: &[u8], b: &[u8]) -> f64 {
    let colors = |rgba: &[u8]| [rgba[0], rgba[1], rgba[2]].map(|value| f64::from(value) / 255.0);
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    let count = 3.0 * pixels.len() as f64;
    let of_pixel =
        |(a, b): (&[u8], &[u8])| colors(a).iter().zip(colors(b)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    pixels.map(of_pixel).sum::<f64>() / count.max(1.0)
}

/// Triangles of the trees in a view's last picture.
///
/// # Errors
/// A device that was lost.
pub fn tree_triangles(gpu: &Gpu, view: &View) -> Result<u64> {
    let Some((set, counts)) = view.tree_counts() else { return Ok(0) };
    let trees: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, counts)?);
    Ok(trees.iter().zip(&set.triangles).map(|(trees, each)| u64::from(trees * each)).sum())
}

/// The root of [`square_error`]: the thesis's measure of quality and of popping (section 7).
pub fn l2(a: &[u8], b: &[u8]) -> f64 {
    square_error(a, b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_black_for_white_is_one_and_transparency_counts_not() {
        let (black, white) = ([0, 0, 0, 9].repeat(50), [255, 255, 255, 200].repeat(50));
        assert_eq!(square_error(&black, &white), 1.0);
        assert_eq!(square_error(&white, &[255, 255, 255, 0].repeat(50)), 0.0);
        let one_channel = [255, 0, 0, 0].repeat(50);
        assert!((square_error(&black, &one_channel) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!(l2(&black, &one_channel), (1.0_f64 / 3.0).sqrt());
    }
}
