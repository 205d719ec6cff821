//! Population → stage graph: the one place where to read which stages there are and what feeds what.
//!
//! ```text
//!  terrain genes ─► landform ─┬─► terrain files (mesh, levels of detail, 16-bit heights)
//!                             ├─► ground maps          ground textures (shared by every scene)
//!  tree genes ─┬─► tree textures ─► tree 0…4 (template, levels, progressive mesh, file)
//!              └──────────────┬─► placement ◄── landform, trees
//!  landform, placement, sky light ─► start ─► foreground ◄── terrain files
//!  sky genes ─► sky light ─┬─► sky pictures
//!                          └─► light map ◄── landform, placement, trees
//!                                                           all of them ─► scene
//! ```
//!
//! Nodes that do the same job on the same inputs are one node: children that share a chromosome with a parent, or
//! scenes that share one with each other, share the work.

use genescape_schema::{Genome, GenomeError, Population, Space};
use serde::Serialize;

use crate::stages::ground::GroundParams;
use crate::stages::land::LandParams;
use crate::stages::placement::PlacementParams;
use crate::stages::sky::SkyParams;
use crate::stages::tree::{TreeParams, TreeTextureParams};

/// Tree templates in a scene.
pub const TEMPLATES: u32 = 5;

/// How finely a scene is sampled; everything follows from the side of the heightfield.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Resolution {
    /// Samples a side of the heightfield, 2^k+1.
    pub side: u32,
    /// Pixels a side of ground maps and light map.
    pub map_px: u32,
    /// Pixels a side of a face of the sky cube.
    pub face_px: u32,
    /// Columns of the equirectangular sky.
    pub equirect_px: u32,
}

impl Resolution {
    /// The default: 513 samples, 2 m apart.
    pub const DEFAULT_SIDE: u32 = 513;

    /// The resolution for a heightfield of `side` samples; an error text unless it is 2^k+1 in 65 … 2049.
    pub fn of_side(side: u32) -> Result<Self, String> {
        if !(65..=2049).contains(&side) || !(side - 1).is_power_of_two() {
            return Err(format!(
                "--size {side}: a heightfield has 65, 129, 257, 513 (default), 1025 or 2049 samples a side"
            ));
        }
        let cells = side - 1;
        // The clouds are drawn in 1088 directions around: finer pictures would only hold larger files.
        let face_px = (3 * cells / 4).min(512);
        Ok(Self {
            side,
            map_px: (2 * cells).clamp(128, 2048).min(cells.max(1024)),
            face_px,
            equirect_px: 4 * face_px,
        })
    }
}

/// A stage with the parameters it reads. Serialised, it is the parameter part of the action key, and field by field
/// what `bake explain` compares.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Job {
    /// Terrain genes → [`crate::model::Landform`].
    Landform {
        /// Genes.
        params: LandParams,
        /// Samples a side.
        side: u32,
    },
    /// Landform → mesh for any viewer, data for the levels of detail, 16-bit heights.
    Terrain {
        /// Genes of the colours of the land beyond the field.
        params: GroundParams,
    },
    /// Landform, placement, sun → where a person first stands.
    Start,
    /// Landform, near mesh, start → the ground around the start in finer triangles.
    Foreground {
        /// Genes of the colours.
        params: GroundParams,
        /// Pixels a side of the ground map, whose look it continues.
        map_px: u32,
    },
    /// Landform → albedo and blend weights.
    GroundMaps {
        /// Genes.
        params: GroundParams,
        /// Pixels a side.
        side_px: u32,
    },
    /// Nothing → the tiling textures that every scene shares.
    GroundTextures,
    /// Tree genes → bark, leaf and blossom.
    TreeTextures {
        /// Genes.
        params: TreeTextureParams,
    },
    /// Tree genes and textures → one template with all its levels, as a file.
    Tree {
        /// Genes.
        params: TreeParams,
        /// Which of the templates.
        index: u32,
    },
    /// Sky genes → sun and ambient light.
    SkyLight {
        /// Genes.
        params: SkyParams,
    },
    /// Sky genes and light → cube, panorama, cloud sheets.
    SkyPictures {
        /// Genes.
        params: SkyParams,
        /// Pixels a side of a face.
        face_px: u32,
        /// Columns of the panorama.
        equirect_px: u32,
    },
    /// Placement genes, landform, trees → where trees stand.
    Placement {
        /// Genes.
        params: PlacementParams,
    },
    /// Sun, landform, placement, trees → light on the ground.
    LightMap {
        /// Pixels a side.
        side_px: u32,
    },
    /// Everything → `scene.gltf`.
    Scene {
        /// The individual's name.
        name: String,
        /// All genes by name with their values, for the scene's `extras`.
        genes: Vec<(String, f32)>,
    },
}

impl Job {
    /// The stage's name and version. Whoever changes what a stage computes raises its version.
    pub fn stage(&self) -> (&'static str, u32) {
        match self {
            Job::Landform { .. } => ("landform", 1),
            Job::Terrain { .. } => ("terrain", 2),
            Job::Start => ("start", 1),
            Job::Foreground { .. } => ("foreground", 1),
            Job::GroundMaps { .. } => ("ground maps", 1),
            Job::GroundTextures => ("ground textures", 2),
            Job::TreeTextures { .. } => ("tree textures", 1),
            Job::Tree { .. } => ("tree", 1),
            Job::SkyLight { .. } => ("sky light", 1),
            Job::SkyPictures { .. } => ("sky pictures", 1),
            Job::Placement { .. } => ("placement", 1),
            Job::LightMap { .. } => ("light map", 1),
            Job::Scene { .. } => ("scene", 2),
        }
    }
}

/// Index of a node in [`Plan::nodes`].
pub type NodeId = usize;

/// One job and the nodes whose outputs it reads, by the name it knows them by.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What to do.
    pub job: Job,
    /// What it reads: always earlier nodes.
    pub inputs: Vec<(String, NodeId)>,
    /// For people: "tree 3".
    pub label: String,
    /// The scenes that use it.
    pub scenes: Vec<usize>,
}

/// The graph, in an order in which inputs come first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The nodes.
    pub nodes: Vec<Node>,
    /// For each individual of the population, the node that makes its scene.
    pub scenes: Vec<NodeId>,
}

impl Plan {
    /// The graph for all individuals of `population`. An error means that a stage reads a gene which `space` does not
    /// declare.
    pub fn new(space: &Space, population: &Population, resolution: Resolution) -> Result<Self, GenomeError> {
        let mut plan = Self::default();
        for (scene, individual) in population.individuals.iter().enumerate() {
            let node = plan.add_scene(space, scene, &individual.name, &individual.genome, resolution)?;
            plan.scenes.push(node);
        }
        Ok(plan)
    }

    fn add_scene(
        &mut self,
        space: &Space,
        scene: usize,
        name: &str,
        genome: &Genome,
        resolution: Resolution,
    ) -> Result<NodeId, GenomeError> {
        let Resolution { side, map_px, face_px, equirect_px } = resolution;
        let ground: GroundParams = genome.read(space)?;

        let landform = self.add(scene, Job::Landform { params: genome.read(space)?, side }, &[]);
        let tree_textures = self.add(scene, Job::TreeTextures { params: genome.read(space)? }, &[]);
        let tree_params: TreeParams = genome.read(space)?;
        let trees: Vec<NodeId> = (0..TEMPLATES)
            .map(|index| {
                let job = Job::Tree { params: tree_params.clone(), index };
                self.add(scene, job, &[("textures", tree_textures)])
            })
            .collect();
        let sky: SkyParams = genome.read(space)?;
        let sky_light = self.add(scene, Job::SkyLight { params: sky.clone() }, &[]);
        let sky_pictures = self.add(
            scene,
            Job::SkyPictures { params: sky, face_px, equirect_px },
            &[("sky light", sky_light)],
        );
        let terrain = self.add(scene, Job::Terrain { params: ground.clone() }, &[("landform", landform)]);
        let ground_maps = self.add(
            scene,
            Job::GroundMaps { params: ground.clone(), side_px: map_px },
            &[("landform", landform)],
        );
        let ground_textures = self.add(scene, Job::GroundTextures, &[]);

        let mut inputs = vec![("landform".to_owned(), landform)];
        inputs.extend(trees.iter().enumerate().map(|(i, &tree)| (format!("tree {i}"), tree)));
        let placement = self.insert(scene, Job::Placement { params: genome.read(space)? }, inputs.clone());

        inputs.push(("placement".to_owned(), placement));
        inputs.push(("sky light".to_owned(), sky_light));
        let start = self.add(
            scene,
            Job::Start,
            &[("landform", landform), ("placement", placement), ("sky light", sky_light)],
        );
        let foreground = self.add(
            scene,
            Job::Foreground { params: ground, map_px },
            &[("landform", landform), ("terrain", terrain), ("start", start)],
        );
        let light_map = self.insert(scene, Job::LightMap { side_px: map_px }, inputs.clone());

        inputs.extend(
            [
                ("light map", light_map),
                ("start", start),
                ("foreground", foreground),
                ("terrain", terrain),
                ("ground maps", ground_maps),
                ("ground textures", ground_textures),
                ("tree textures", tree_textures),
                ("sky pictures", sky_pictures),
            ]
            .map(|(name, node)| (name.to_owned(), node)),
        );
        let genes = space.parameters().iter();
        let genes = genes.filter_map(|p| Some((p.name.clone(), genome.value(space, &p.name)?))).collect();
        Ok(self.insert(scene, Job::Scene { name: name.to_owned(), genes }, inputs))
    }

    fn add(&mut self, scene: usize, job: Job, inputs: &[(&str, NodeId)]) -> NodeId {
        self.insert(scene, job, inputs.iter().map(|&(name, node)| (name.to_owned(), node)).collect())
    }

    /// The node that does `job` on `inputs`: an existing one if there is one.
    fn insert(&mut self, scene: usize, job: Job, inputs: Vec<(String, NodeId)>) -> NodeId {
        if let Some(found) = self.nodes.iter().position(|node| node.job == job && node.inputs == inputs) {
            if !self.nodes[found].scenes.contains(&scene) {
                self.nodes[found].scenes.push(scene);
            }
            return found;
        }
        let label = match &job {
            Job::Tree { index, .. } => format!("tree {index}"),
            other => other.stage().0.to_owned(),
        };
        self.nodes.push(Node { job, inputs, label, scenes: vec![scene] });
        self.nodes.len() - 1
    }
}
