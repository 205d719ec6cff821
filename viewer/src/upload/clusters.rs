//! Pictures of clusters of leaves: those of all templates, one below the other, as one texture of one material.

use std::sync::Arc;

use super::Uploader;
use super::texture::ImageUse;
use crate::scene::{Image, Material, Template, TreeVertex};

/// The most pixels a side of a texture that every device has.
const MAX_PX: u32 = 8192;
/// Mip levels: a picture of a cluster has 16 pixels a side, and of the last 4. Smaller ones run into each other.
const MIPS: u32 = 3;

/// The pictures of all templates.
pub(super) struct ClusterSheet {
    pub material: Material,
    /// Of each template what turns its texture coordinates into those of the sheet: factors and what is added.
    places: Vec<[[f32; 2]; 2]>,
}

impl ClusterSheet {
    /// `None` where no template has clusters, or all together too many.
    pub fn of(templates: &[Arc<Template>]) -> Option<Self> {
        let material = templates.iter().find_map(|template| of_clusters(template))?;
        let pictures = |of: fn(&Material) -> Option<&Image>| -> Vec<Option<&Image>> {
            templates.iter().map(|template| of(of_clusters(template)?)).collect()
        };
        let colors = pictures(|material| material.color.as_ref());
        let sizes: Vec<[u32; 2]> = colors.iter().map(size_px).collect();
        let width_px = sizes.iter().map(|size| size[0]).max()?;
        let height_px = sizes.iter().map(|size| size[1]).sum::<u32>();
        if width_px == 0 || width_px.max(height_px) > MAX_PX {
            return None;
        }
        let normals = pictures(|material| material.normal.as_ref());
        // Of pictures that do not fit the colours there is no use.
        let normals: Vec<_> =
            normals.into_iter().zip(&sizes).filter(|(image, size)| size_px(image) == **size).collect();
        let normals = (normals.len() == sizes.len())
            .then(|| normals.into_iter().map(|(image, _)| image).collect::<Vec<_>>());
        let tops = sizes.iter().scan(0, |top, size| Some(std::mem::replace(top, *top + size[1])));
        let place = |(size, top): (&[u32; 2], u32)| {
            let over = |px: u32, all: u32| px as f32 / all as f32;
            [[over(size[0], width_px), over(size[1], height_px)], [0.0, over(top, height_px)]]
        };
        let places = sizes.iter().zip(tops).map(place).collect();
        let sheet = |images: &[Option<&Image>]| one_below_the_other(images, width_px, height_px);
        let normal = normals.map(|normals| sheet(&normals));
        Some(Self { material: Material { color: Some(sheet(&colors)), normal, ..material.clone() }, places })
    }

    /// The vertices of a template, with texture coordinates of the sheet where they are those of clusters.
    pub fn moved(&self, number: usize, template: &Template) -> Vec<TreeVertex> {
        let mut vertices = template.vertices.clone();
        let [factors, added] = self.places[number];
        for level in &template.levels {
            let parts =
                level.ranges.iter().zip(&template.materials).filter(|(_, material)| material.clusters);
            for (range, _) in parts {
                let mut used = template.indices[range.first as usize..][..range.count as usize].to_vec();
                used.sort_unstable();
                used.dedup();
                for vertex in used {
                    let uv = &mut vertices[(level.base_vertex + vertex) as usize].uv;
                    *uv = [0, 1].map(|axis| uv[axis] * factors[axis] + added[axis]);
                }
            }
        }
        vertices
    }
}

fn size_px(image: &Option<&Image>) -> [u32; 2] {
    image.map_or([0; 2], |image| [image.width_px, image.height_px])
}

fn one_below_the_other(images: &[Option<&Image>], width_px: u32, height_px: u32) -> Image {
    let mut pixels = Vec::with_capacity(4 * width_px as usize * height_px as usize);
    for image in images.iter().flatten() {
        let rows = image.levels.iter().take(1).flat_map(|all| all.chunks_exact(4 * image.width_px as usize));
        for row in rows {
            pixels.extend_from_slice(row);
            pixels.resize(pixels.len() + 4 * (width_px - image.width_px) as usize, 0);
        }
    }
    let names: Vec<&str> = images.iter().flatten().map(|image| image.name.as_str()).collect();
    let name = format!("clusters {}", names.join(" "));
    Image { name, width_px, height_px, levels: vec![pixels.into()] }
}

fn of_clusters(template: &Template) -> Option<&Material> {
    template.materials.iter().find(|material| material.clusters)
}

/// The same without levels that have clusters.
pub(super) fn without(template: &Template) -> Template {
    let mut template = template.clone();
    template.levels.truncate(template.clusters.map_or(usize::MAX, |first| first as usize));
    template.clusters = None;
    template
}

impl Uploader {
    /// A sheet as a texture.
    pub(super) fn sheet(&self, image: &Image, kind: ImageUse) -> Arc<wgpu::Texture> {
        self.strips(&[image], kind, image.width_px.max(image.height_px) >> (MIPS - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Level, Range};

    /// A template with one level of one cluster card, whose picture has this height.
    fn template(height_px: u32) -> Arc<Template> {
        let color = Image {
            name: format!("{height_px}"),
            width_px: 2,
            height_px,
            levels: vec![vec![height_px as u8; 8 * height_px as usize].into()],
        };
        let material = Material {
            name: "clusters".into(),
            color: Some(color),
            color_factor: [1.0; 4],
            normal: None,
            alpha_cutoff: Some(0.5),
            thin: false,
            clusters: true,
        };
        let corner = |uv| TreeVertex { uv, ..TreeVertex::default() };
        Arc::new(Template {
            vertices: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(corner).to_vec(),
            indices: vec![0, 1, 2],
            levels: vec![Level {
                error_m: 0.1,
                base_vertex: 0,
                ranges: vec![Range { first: 0, count: 3 }],
                strips: Vec::new(),
            }],
            materials: vec![material],
            clusters: Some(0),
            ..Template::default()
        })
    }

    #[test]
    fn each_template_finds_its_pictures_in_the_sheet() {
        let templates = [template(3), Arc::default(), template(5)];
        let sheet = ClusterSheet::of(&templates).expect("clusters");
        let image = sheet.material.color.as_ref().expect("a picture");
        assert_eq!((image.width_px, image.height_px), (2, 8));
        for (number, height) in [(0, 3), (2, 5)] {
            for vertex in sheet.moved(number, &templates[number]) {
                let y = (vertex.uv[1] * 8.0).clamp(0.5, 7.5);
                // Within the picture, not on its edge.
                let y = if number == 0 { y.min(2.5) } else { y.max(3.5) };
                assert_eq!(image.levels[0][y as usize * 8], height);
            }
        }
        assert!(ClusterSheet::of(&[Arc::default()]).is_none());
    }

    #[test]
    fn more_clusters_than_a_texture_holds_are_left_out() {
        let tall = template(MAX_PX);
        assert!(ClusterSheet::of(&[tall.clone(), tall.clone()]).is_none());
        let plain = without(&tall);
        assert!(plain.levels.is_empty() && plain.clusters.is_none());
    }
}
