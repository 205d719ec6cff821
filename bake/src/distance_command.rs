//! `bake distance`: how different two landscapes look, and in what most.

use anyhow::Result;
use genescape_schema::Category;
use genescape_world::World;
use serde_json::{Map, Value, json};

use crate::cli::RunArgs;
use crate::landscape::Reference;
use crate::phenotype::Phenotype;
use crate::say;

/// Traits that are told of each category, at most; what differs by less than this is not told.
const TOLD: usize = 4;
const MIN_TOLD: f32 = 0.3;

/// Compares two landscapes.
pub fn run(references: [&Reference; 2], args: &RunArgs) -> Result<()> {
    let world = World::new(&args.world);
    let (space, _) = world.space()?;
    let [a, b] = references.map(|reference| -> Result<_> {
        let (_, individual) = reference.find(&world, &space)?;
        Ok((Phenotype::of(&space, &individual.genome)?, individual.name))
    });
    let [(a, a_name), (b, b_name)] = [a?, b?];
    if args.json {
        say!("{}", object(&a, &b));
        return Ok(());
    }
    say!("{} ({a_name}) and {} ({b_name}):", references[0], references[1]);
    for category in Category::ALL {
        let mut differences = a.differences(&b, category);
        differences.sort_by(|a, b| b.1.total_cmp(&a.1));
        let told = differences.into_iter().filter(|(_, one)| *one >= MIN_TOLD).take(TOLD);
        let told: Vec<String> = told.map(|(name, one)| format!("{name} {one:.1}")).collect();
        let line =
            format!("  {:<8} {:.2}   {}", category.name(), a.distance_in(&b, category), told.join(", "));
        say!("{}", line.trim_end());
    }
    say!("  overall  {:.2}", a.distance(&b));
    say!("0 is alike; 1 is what two landscapes differ by that are drawn by chance.");
    Ok(())
}

fn object(a: &Phenotype, b: &Phenotype) -> Value {
    let of = |category: Category| {
        let traits = a
            .differences(b, category)
            .into_iter()
            .map(|(name, one)| (name.to_owned(), json!(say::rounded(one))));
        let traits: Map<String, Value> = traits.collect();
        json!({ "distance": say::rounded(a.distance_in(b, category)), "traits": traits })
    };
    let mut object: Map<String, Value> =
        Category::ALL.into_iter().map(|category| (category.name().to_owned(), of(category))).collect();
    object.insert("overall".to_owned(), json!(say::rounded(a.distance(b))));
    Value::Object(object)
}
