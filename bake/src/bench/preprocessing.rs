//! What a bake takes before anything is drawn, over scenes bred as in the thesis's section 8.1: its tables 1 and 2.

use std::time::Instant;

use anyhow::Result;
use genescape_cache::Cache;
use genescape_schema::{Genome, Kinds, Parent, Population, Space, Strategy, Votes};

use super::{Stages, bake};
use crate::breed::Breeder;
use crate::gltf::{self, Picture, TreePictures};
use crate::plan::{Resolution, TEMPLATES};
use crate::stages::lod::Step;
use crate::stages::tree;

/// Milliseconds on one core that one task took once.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Whether it belongs to one tree template; else to a landscape.
    pub of_template: bool,
    /// "progressive mesh", or a stage's name.
    pub task: String,
    /// Which landscape of all, from 0.
    pub scene: u32,
    pub ms: f64,
}

/// Breeds `scenes` landscapes, four at a time and always from the first of the four, and bakes each four into a folder of
/// their own. The first four, which nobody bred, are left out. `tell` hears how many are done.
///
/// # Errors
/// A folder that cannot be written to, or starters that are wrong.
pub fn preprocessing(scenes: u32, resolution: Resolution, mut tell: impl FnMut(u32)) -> Result<Vec<Sample>> {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut past = Vec::new();
    let mut parents =
        Population::load(&space, "configs/starter.ron", genescape_world::STARTER_RON)?.population;
    let mut samples = Vec::new();
    let mut done = 0;
    while done < scenes {
        let votes = Votes { tree: Some(0), terrain: Some(0), sky: Some(0) };
        parents.votes = Some(votes);
        let next = parents.generation + 1;
        let mut children =
            Breeder::new(&space, &kinds, Strategy::Learned, &past, &parents)?.bred(next, parents.seed);
        children.parent = Some(Parent { generation: parents.generation, votes, variety: None });
        past.push(std::mem::replace(&mut parents, children));

        let folder = tempfile::tempdir()?;
        for (scene, one) in (done..scenes).zip(&parents.individuals) {
            // Alone, so that nothing is shared with the others.
            let alone = Population { individuals: std::array::from_fn(|_| one.clone()), ..parents.clone() };
            let cache = Cache::open(folder.path().join(scene.to_string()))?;
            let clock = Stages::default();
            bake(&space, &alone, resolution, &cache, &pool, &clock)?;
            let sample = |of_template: bool, task: &str, ms: f64| Sample {
                of_template,
                task: task.to_owned(),
                scene,
                ms,
            };
            samples.extend(clock.times().iter().map(|(stage, ms)| sample(false, stage, *ms)));
            let templates = pool.install(|| template_steps(&space, &one.genome))?;
            samples.extend(templates.steps.iter().map(|(task, ms)| sample(true, task, *ms)));
        }
        done = scenes.min(done + parents.individuals.len() as u32);
        tell(done);
    }
    Ok(samples)
}

/// What becomes of each template of one landscape.
pub(super) struct Templates {
    /// In their order, for one template after the other, with milliseconds.
    pub steps: Vec<(&'static str, f64)>,
    /// Of all together.
    pub triangles: usize,
}

/// Makes all templates of one landscape, step by step, on this thread and those of its pool.
pub(super) fn template_steps(space: &Space, genome: &Genome) -> Result<Templates> {
    let params: tree::TreeParams = genome.read(space)?;
    let textures = tree::textures(&genome.read(space)?);
    let (mut steps, mut triangles) = (Vec::new(), 0);
    for index in 0..TEMPLATES {
        let mut start = Instant::now();
        let mut ended = |task: &'static str| {
            steps.push((task, start.elapsed().as_secs_f64() * 1e3));
            start = Instant::now();
        };
        let template = tree::template(&params, index);
        ended("generating the tree");
        triangles += template.mesh.triangle_count();
        let made = tree::levelled(&template.mesh, &textures, &mut |step| {
            ended(match step {
                Step::DataStructures => "data structures",
                Step::ProgressiveMesh => "progressive mesh",
                Step::Morphs => "morphs",
                Step::Strips => "triangle strips",
                Step::Finish => "clusters and errors of pictures",
                Step::Records => "records",
            });
        });
        let impostor = tree::impostor(tree::drawn_from_afar(&made.mesh.levels, &textures), &textures);
        ended("pictures from four sides");
        // The textures are made once a scene, and timed there.
        let pictures = textures.map(|_| Picture::Embedded { bytes: &[], mime_type: "image/png" });
        let of_tree = TreePictures { impostor: Some(&impostor), clusters: made.clusters.as_ref() };
        gltf::tree_glb("tree", &made.mesh, &pictures, &of_tree)?;
        ended("writing the file");
    }
    Ok(Templates { steps, triangles })
}

/// The stages of [`Sample::task`] that make what the thesis's table 2 has: the terrain's data and light.
pub const OF_TERRAIN: [&str; 3] = ["landform", "terrain", "light map"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_and_stage_of_every_scene_has_its_time() {
        let resolution = Resolution::of_side(65).expect("a side");
        let mut told = Vec::new();
        let samples = preprocessing(5, resolution, |done| told.push(done)).expect("baked");
        assert_eq!(told, [4, 5]);
        for scene in 0..5 {
            let count =
                |of: &dyn Fn(&Sample) -> bool| samples.iter().filter(|s| s.scene == scene && of(s)).count();
            assert_eq!(count(&|s| s.of_template && s.task == "progressive mesh"), TEMPLATES as usize);
            assert_eq!(count(&|s| !s.of_template && s.task == "tree (one template)"), TEMPLATES as usize);
            for stage in OF_TERRAIN {
                assert_eq!(count(&|s| s.task == stage), 1, "{stage} in {scene}");
            }
        }
        assert!(samples.iter().all(|sample| sample.ms >= 0.0));
    }
}
