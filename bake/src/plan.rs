//! Population → stage graph: the one place where to read which stages there are and what feeds what.
//!
//! ```text
//!  terrain genes ─► landform ─┬─► terrain (mesh, levels of detail, 16-bit heights)
//!                             │                        ground textures (shared by scenes)
//!  tree genes ─┬─► tree textures ─► tree 0…4 (template, levels, progressive mesh, file)
//!              └──────────────┬─► placement ◄── landform, trees
//!  placement, landform, terrain, trees ─► far trees
//!  landform, placement, trees ─► ground maps (with what grows and lies on the ground)
//!  landform, trees, placement, sky light ─► start ─► foreground ◄── terrain, ground maps
//!  sky genes ─► sky light ─┬─► sky pictures
//!                          └─► light map ◄── landform, placement, trees
//!                                                           all of them ─► scene
//! ```
//!
//! Nodes that do the same job on the same inputs are one node: children that share a chromosome with a parent, or
//! scenes that share one with each other, share the work.

use std::fmt;
use std::str::FromStr;

use genescape_schema::{Genome, GenomeError, Population, Space};

use crate::graph::{Graph, Node, NodeId};
use crate::stages::ground::{
    ForegroundStage, GroundMapsFiles, GroundMapsStage, GroundParams, GroundTextureStage, LitterParams, Loose,
    Season, WoodsInput,
};
use crate::stages::land::LandStage;
use crate::stages::light::LightMapStage;
use crate::stages::placement::{FarTreesStage, PlacementFiles, PlacementStage};
use crate::stages::scene::SceneStage;
use crate::stages::sky::{SkyImagesStage, SkyLightStage, SkyParams};
use crate::stages::start::{StartFiles, StartStage};
use crate::stages::terrain_lod::{TerrainFiles, TerrainStage};
use crate::stages::tree::{TreeFiles, TreeParams, TreeStage, TreeTexturesStage};

/// Tree templates in a scene.
pub const TEMPLATES: u32 = 5;

/// How finely a scene is sampled; everything follows from the side of the heightfield.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// 513 samples, 2 m apart.
impl Default for Resolution {
    fn default() -> Self {
        Self::of_cells(512)
    }
}

impl Resolution {
    /// The resolution for a heightfield of `side` samples; an error text unless it is 2^k+1 in 65 … 2049.
    pub fn of_side(side: u32) -> Result<Self, String> {
        if !(65..=2049).contains(&side) || !(side - 1).is_power_of_two() {
            return Err(
                "a heightfield has 65, 129, 257, 513 (default), 1025 or 2049 samples a side".to_owned()
            );
        }
        Ok(Self::of_cells(side - 1))
    }

    fn of_cells(cells: u32) -> Self {
        // The clouds are drawn in 1088 directions around: finer pictures would only hold larger files.
        let face_px = (3 * cells / 4).min(512);
        Self {
            side: cells + 1,
            map_px: (2 * cells).clamp(128, 2048).min(cells.max(1024)),
            face_px,
            equirect_px: 4 * face_px,
        }
    }
}

/// As a person writes it: samples a side of the heightfield.
impl FromStr for Resolution {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::of_side(text.parse().map_err(|_| "a whole number is needed".to_owned())?)
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.side.fmt(f)
    }
}

/// The stages of all landscapes of a population.
#[derive(Default)]
pub struct Plan {
    /// In an order in which inputs come first.
    pub nodes: Vec<Node>,
    /// For each individual of the population, the node that makes its scene.
    pub scenes: Vec<NodeId>,
}

impl Plan {
    /// The graph for all individuals of `population`.
    ///
    /// # Errors
    /// A stage reads a gene that `space` does not declare.
    pub fn new(space: &Space, population: &Population, resolution: Resolution) -> Result<Self, GenomeError> {
        let mut graph = Graph::default();
        let scenes = population.individuals.iter().enumerate().map(|(scene, individual)| {
            add_scene(&mut graph, scene, space, &individual.name, &individual.genome, resolution)
        });
        let scenes = scenes.collect::<Result<_, _>>()?;
        Ok(Self { nodes: graph.nodes, scenes })
    }
}

fn add_scene(
    graph: &mut Graph,
    scene: usize,
    space: &Space,
    name: &str,
    genome: &Genome,
    resolution: Resolution,
) -> Result<NodeId, GenomeError> {
    let Resolution { side, map_px, face_px, equirect_px } = resolution;
    let sky: SkyParams = genome.read(space)?;
    let ground: GroundParams = genome.read(space)?;
    let tree: TreeParams = genome.read(space)?;

    let landform = graph.add(scene, LandStage { params: genome.read(space)?, side });
    let tree_textures = graph.add(scene, TreeTexturesStage::new(genome.read(space)?));
    let embedded = graph.part(tree_textures, TreeTexturesStage::without_mip_levels);
    let trees = [0, 1, 2, 3, 4]
        .map(|index| graph.add(scene, TreeStage { params: tree.clone(), index, textures: embedded }));
    let light = graph.add(scene, SkyLightStage { params: sky.clone() });
    let sky = graph.add(scene, SkyImagesStage { params: sky, face_px, equirect_px, light });
    let shed: LitterParams = genome.read(space)?;
    let season = Season::of(&shed);
    let terrain = graph.add(scene, TerrainStage { params: ground.clone(), season, landform });
    let loose = Loose::of(&ground);
    let ground_textures =
        [0, 1, 2, 3, 4].map(|kind| graph.add(scene, GroundTextureStage::new(kind, loose))).to_vec();

    let footprints = trees.map(|tree| graph.part(tree, |tree: &TreeFiles| tree.footprint)).to_vec();
    let placed = graph
        .add(scene, PlacementStage { params: genome.read(space)?, landform, footprints: footprints.clone() });
    let standing = graph.part(placed, |placed: &PlacementFiles| placed.placement.instances.clone());
    let start =
        graph.add(scene, StartStage { landform, footprints: footprints.clone(), trees: standing, light });
    let view = graph.part(start, |start: &StartFiles| start.view);
    let near = graph.part(terrain, |terrain: &TerrainFiles| terrain.near.clone());
    let far_trees = FarTreesStage {
        params: genome.read(space)?,
        landform,
        ring: graph.part(terrain, |terrain: &TerrainFiles| terrain.ring.clone()),
        footprints: footprints.clone(),
        per_m2: graph.part(placed, |placed: &PlacementFiles| placed.placement.per_m2),
    };
    let far_trees = graph.add(scene, far_trees);

    let woods = WoodsInput { params: shed, trees: standing, footprints };
    let painted = GroundMapsStage { params: ground.clone(), side_px: map_px, landform, woods: woods.clone() };
    let painted = graph.add(scene, painted);
    let ground_maps = graph.part(painted, |made: &GroundMapsFiles| made.maps.clone());
    let plants = graph.part(painted, |made: &GroundMapsFiles| made.plants.clone());
    let foreground = ForegroundStage { params: ground, landform, woods, plants, near, start: view };
    let foreground = graph.add(scene, foreground);

    let casters = trees.map(|tree| graph.part(tree, |tree: &TreeFiles| tree.caster.clone())).to_vec();
    let light_map =
        graph.add(scene, LightMapStage { side_px: map_px, landform, casters, trees: standing, light });

    let genes = space.parameters().iter();
    let genes = genes.filter_map(|p| Some((p.name.clone(), genome.value(space, &p.name)?))).collect();
    let trees = trees.map(|tree| graph.part(tree, |tree: &TreeFiles| tree.glb.clone())).to_vec();
    let stage = SceneStage {
        name: name.to_owned(),
        genes,
        landform,
        terrain,
        foreground,
        start,
        ground_maps,
        ground_textures,
        light_map,
        trees,
        tree_textures,
        placed,
        far_trees,
        light,
        sky,
    };
    Ok(graph.add(scene, stage).node())
}
