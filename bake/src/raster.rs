//! Grids and images filled row by row, rows in parallel.

use bytemuck::Zeroable;
use rayon::prelude::*;

use crate::model::Image8;

/// `width` × `height` values, row by row: `row(j)` prepares row j and gives its values by column.
pub fn raster<T, R>(width: usize, height: usize, row: impl Fn(usize) -> R + Sync) -> Vec<T>
where
    T: Zeroable + Copy + Send,
    R: FnMut(usize) -> T,
{
    let mut values = vec![T::zeroed(); width * height];
    values.par_chunks_exact_mut(width).enumerate().for_each(|(j, values)| {
        let mut value = row(j);
        values.iter_mut().enumerate().for_each(|(i, out)| *out = value(i));
    });
    values
}

/// `side`² values, row by row: `value(i, j)` gives that of column i and row j.
pub fn square<T: Zeroable + Copy + Send>(side: usize, value: impl Fn(usize, usize) -> T + Sync) -> Vec<T> {
    raster(side, side, |j| {
        let value = &value;
        move |i| value(i, j)
    })
}

/// A square image of N channels, `side` pixels wide, filled as by [`raster`].
pub fn square_image<const N: usize, R>(side: usize, row: impl Fn(usize) -> R + Sync) -> Image8
where
    R: FnMut(usize) -> [u8; N],
{
    let data = raster(side, side, row).into_flattened();
    Image8 { width: side as u32, height: side as u32, channels: N as u8, data }
}
