//! A world's population files → its family: every generation with its landscapes, votes and parents, as one page for
//! people ([`page`]) or as JSON for programs.

pub mod page;

use genescape_schema::{Category, INDIVIDUALS, Individual, Population, Space, Votes};
use genescape_world::{World, WorldError, names};
use serde_json::{Value, json};

/// All generations of a world.
pub struct Family {
    /// What the world is called: its folder.
    pub name: String,
    /// In rising order.
    pub generations: Vec<Generation>,
    /// For people: which files could not be read, and why.
    pub skipped: Vec<String>,
}

/// One of them.
pub struct Generation {
    pub population: Population,
    /// JPEG files, of landscapes that were looked at.
    pub thumbnails: [Option<Vec<u8>>; INDIVIDUALS],
}

impl Family {
    /// Reads all population files of a world. Those that are wrong are left out and named.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn read(world: &World, space: &Space) -> Result<Self, WorldError> {
        let (mut generations, mut skipped) = (Vec::new(), Vec::new());
        for number in world.generations()? {
            match world.population(space, number) {
                Ok(file) => {
                    let thumbnails = std::array::from_fn(|landscape| world.thumbnail(number, landscape));
                    generations.push(Generation { population: file.population, thumbnails });
                }
                Err(error) => skipped.push(format!("{}: {error}", names::population(number))),
            }
        }
        let root = std::path::absolute(world.root()).unwrap_or_else(|_| world.root().to_owned());
        let name = root.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self { name, generations, skipped })
    }
}

impl Generation {
    /// As JSON: landscapes count from 1, as people do.
    pub fn to_json(&self) -> Value {
        let Population { generation, seed, parent, strategy, bred_from, individuals, votes, .. } =
            &self.population;
        let landscape = |one: &Individual| {
            let from = one.parents();
            let from = Category::ALL.map(|category| (category.name(), from[category as usize].clone()));
            let from: serde_json::Map<String, Value> =
                from.into_iter().map(|(name, parents)| (name.to_owned(), json!(parents))).collect();
            json!({ "name": one.name, "descent": one.descent, "parents": from })
        };
        json!({
            "generation": generation,
            "seed": seed,
            "parent": parent.map(|parent| json!({
                "generation": parent.generation, "votes": votes_json(&parent.votes),
            })),
            "strategy": strategy.name(),
            "bred_from": bred_from,
            "votes": votes.as_ref().map(votes_json),
            "landscapes": individuals.iter().map(landscape).collect::<Vec<_>>(),
        })
    }
}

fn votes_json(votes: &Votes) -> Value {
    let of = |category: Category| votes.favourite(category).map(|vote| vote + 1);
    json!({ "tree": of(Category::Tree), "terrain": of(Category::Terrain), "sky": of(Category::Sky) })
}
