//! Shaders are valid, and what they call a structure, an attribute or a constant is what Rust calls it: by name, place
//! and size. Nothing is drawn.

use std::mem::{offset_of, size_of};

use genescape_viewer::lod::block::Block;
use genescape_viewer::passes::Shaders;
use genescape_viewer::passes::{CullUniform, SHADERS, ViewUniform, grass, plants, terrain, trees};
use genescape_viewer::scene::TreeVertex;
use genescape_viewer::upload::{
    DrawCommand, ImpostorData, Lamp, MaterialUniform, PlantVertex, RingVertex, StudioUniform, TemplateData,
    TreeData,
};
use naga::{ScalarKind, TypeInner};

fn module(name: &str) -> naga::Module {
    Shaders::builtin().check(name).unwrap_or_else(|error| panic!("{error}")).0
}

fn struct_named<'a>(module: &'a naga::Module, name: &str) -> (&'a [naga::StructMember], u32) {
    let found = module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            Some((&members[..], *span))
        }
        _ => None,
    });
    found.unwrap_or_else(|| panic!("there is no structure {name}"))
}

/// The shader's structure has exactly these members at these places, and this size.
fn agree(shader: &str, name: &str, size: usize, fields: &[(&str, usize)]) {
    let module = module(shader);
    let (members, span) = struct_named(&module, name);
    let told: Vec<(&str, usize)> =
        members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
    assert_eq!(told, fields, "{name} of {shader}.wgsl");
    assert_eq!(span as usize, size, "size of {name} of {shader}.wgsl");
}

macro_rules! same {
    ($shaders:expr, $name:literal, $rust:ty { $($field:ident),* $(,)? }) => {
        // Naming every field: one that is added to Rust alone no longer fits the size, one that is added to the shader
        // alone no longer fits the list.
        for shader in $shaders {
            agree(shader, $name, size_of::<$rust>(), &[$((stringify!($field), offset_of!($rust, $field))),*]);
        }
    };
}

#[test]
fn every_shader_is_valid_and_one_that_is_not_is_told_with_its_line() {
    let shaders = Shaders::builtin();
    for name in Shaders::names() {
        shaders.check(name).unwrap_or_else(|error| panic!("{error}"));
    }
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("sky.wgsl"), "\n\nfn broken() -> f32 { return 1u; }\n")
        .expect("written");
    let told = || {
        let shaders = Shaders::from(Some(folder.path().to_owned()));
        shaders.check("sky").expect_err("it is wrong").to_string()
    };
    assert!(
        told().contains("sky.wgsl:3:") && told().contains("1u") && !told().contains("common"),
        "{}",
        told()
    );
    std::fs::write(folder.path().join("sky.wgsl"), "\n\n").expect("written");
    std::fs::write(folder.path().join("common.wgsl"), "\nfn broken() -> f32 { return 1u; }\n")
        .expect("written");
    assert!(told().contains("line 2 of common.wgsl"), "{}", told());
}

#[test]
fn uniforms_are_laid_out_alike() {
    same!(
        Shaders::names(),
        "View",
        ViewUniform {
            clip_from_world,
            ray_from_clip,
            shadow_from_world,
            eye,
            time_s,
            sun_direction,
            sun_angular_radius,
            sun_irradiance,
            exposure,
            sky_irradiance,
            haze_extinction,
            water_level,
            sea,
            focal_px,
            tint_levels,
            other_clouds,
            lod_pixels,
            noise,
            mip_bias,
            clouds,
            drift,
            lod_eye,
            lod_above,
            field,
            shade,
            ground_kinds,
            ground_albedo,
            turf_m,
            lod_top,
            part,
            lod_unit,
            unused,
        }
    );
    same!(
        ["cull"],
        "Cull",
        CullUniform {
            planes,
            eye,
            error_per_m,
            instances,
            templates,
            levels,
            mesh_draws,
            lod_mode,
            fixed_error_m,
            planes_used,
            first,
            field,
            focal_px,
            unused,
        }
    );
    same!(["asset"], "Studio", StudioUniform { lights, room, radius, cell, middle, lamps });
    same!(["asset"], "Lamp", Lamp { towards, right });
    same!(["trees", "shadow"], "Material", MaterialUniform { factor, alpha_cutoff, has_normal, unused });
}

#[test]
fn elements_of_buffers_are_laid_out_alike() {
    same!(
        ["cull", "trees", "impostors", "shadow"],
        "Tree",
        TreeData { rows, template_and_sun, scale, crown }
    );
    same!(
        ["cull"],
        "Template",
        TemplateData {
            center,
            radius,
            errors,
            levels,
            first,
            capacity,
            simple_error,
            picture_error,
            clusters,
            pad
        }
    );
    same!(
        ["impostors"],
        "Frame",
        ImpostorData { axis, size, crown_middle, low, crown_half, leaf_m, middles }
    );
    same!(["cull"], "Command", DrawCommand { indices, instances, first_index, base_vertex, first_instance });
    // What one pass writes as `Visible` the next reads as attributes.
    agree("cull", "Visible", 12, &[("tree", 0), ("lambda", 4), ("shown", 8)]);
    assert_eq!(trees::VISIBLE.map(|attribute| attribute.offset), [0, 4, 8]);
}

#[test]
fn attributes_start_where_fields_do() {
    let offsets = |attributes: &[wgpu::VertexAttribute]| {
        let last = attributes.last().map_or(0, |last| last.offset + last.format.size());
        (attributes.iter().map(|a| a.offset as usize).collect::<Vec<_>>(), last as usize)
    };
    macro_rules! fields {
        ($rust:ty { $($field:ident),* }) => { (vec![$(offset_of!($rust, $field)),*], size_of::<$rust>()) };
    }
    assert_eq!(offsets(&grass::CLUMP), fields!(grass::Clump { cell, number }));
    let instance = fields!(plants::PlantInstance { place, turn, root, tip });
    assert_eq!(offsets(&plants::INSTANCE), instance);
    assert_eq!(offsets(&plants::VERTEX), fields!(PlantVertex { position, normal, tint }));
    let (block, size) = fields!(Block { i, level });
    assert_eq!((offsets(&terrain::BLOCK), offset_of!(Block, j)), ((block, size), 4));
    assert_eq!(offsets(&terrain::RING), fields!(RingVertex { position_m, normal, color_and_sun, weights }));
    let tree = fields!(TreeVertex {
        position_m,
        color,
        position_delta_m,
        normal_oct,
        uv,
        uv_delta,
        normal_end_oct,
        tangent_oct
    });
    assert_eq!(offsets(&trees::VERTEX), tree);
}

/// (location, kind of scalar, number of scalars) of what a vertex entry point reads.
fn inputs(shader: &str, entry: &str) -> Vec<(u32, ScalarKind, u8)> {
    let module = module(shader);
    let point = module.entry_points.iter().find(|point| point.name == entry).expect("an entry point");
    let leaf = |ty: naga::Handle<naga::Type>, binding: &Option<naga::Binding>| {
        let Some(naga::Binding::Location { location, .. }) = binding else { return None };
        match module.types[ty].inner {
            TypeInner::Scalar(scalar) => Some((*location, scalar.kind, 1)),
            TypeInner::Vector { size, scalar } => Some((*location, scalar.kind, size as u8)),
            _ => None,
        }
    };
    let mut found = Vec::new();
    for argument in &point.function.arguments {
        match &module.types[argument.ty].inner {
            TypeInner::Struct { members, .. } => {
                found.extend(members.iter().filter_map(|member| leaf(member.ty, &member.binding)));
            }
            _ => found.extend(leaf(argument.ty, &argument.binding)),
        }
    }
    found.sort_by_key(|(location, ..)| *location);
    found
}

#[test]
fn shaders_read_the_attributes_as_they_are_written() {
    let written = |sets: &[&[wgpu::VertexAttribute]]| -> Vec<(u32, ScalarKind, u8)> {
        let one = |attribute: &wgpu::VertexAttribute| {
            use wgpu::VertexFormat as F;
            let (kind, count) = match attribute.format {
                F::Float32 => (ScalarKind::Float, 1),
                F::Float32x2 | F::Snorm16x2 | F::Unorm16x2 => (ScalarKind::Float, 2),
                F::Float32x3 => (ScalarKind::Float, 3),
                F::Unorm8x4 | F::Unorm10_10_10_2 | F::Float16x4 => (ScalarKind::Float, 4),
                F::Uint32 => (ScalarKind::Uint, 1),
                F::Uint32x2 => (ScalarKind::Uint, 2),
                F::Sint32x2 => (ScalarKind::Sint, 2),
                other => panic!("{other:?} is new: say what a shader sees of it"),
            };
            (attribute.shader_location, kind, count)
        };
        sets.concat().iter().map(one).collect()
    };
    assert_eq!(inputs("trees", "vertex"), written(&[&trees::VERTEX, &trees::VISIBLE]));
    let known = written(&[&trees::VERTEX, &trees::VISIBLE]);
    for (shader, entry) in [("shadow", "tree"), ("impostors", "vertex")] {
        let read = inputs(shader, entry);
        assert!(read.iter().all(|input| known.contains(input)), "{shader}: {read:?}");
    }
    assert_eq!(inputs("terrain", "block_vertex"), written(&[&terrain::BLOCK]));
    assert_eq!(inputs("terrain", "ring_vertex"), written(&[&terrain::RING]));
    assert_eq!(inputs("grass", "vertex"), written(&[&grass::CLUMP]));
    assert_eq!(inputs("plants", "vertex"), written(&[&plants::INSTANCE, &plants::VERTEX]));
}

#[test]
fn rust_tells_each_shader_all_its_overrides_and_no_others() {
    for shader in SHADERS {
        let module = module(shader.name);
        let mut declared: Vec<&str> =
            module.overrides.iter().filter_map(|(_, o)| o.name.as_deref()).collect();
        let mut told: Vec<&str> = shader.constants.iter().map(|(name, _)| *name).collect();
        declared.sort_unstable();
        told.sort_unstable();
        assert_eq!(declared, told, "{}.wgsl", shader.name);
    }
}
