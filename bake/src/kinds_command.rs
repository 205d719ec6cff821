//! `bake kinds …`: which kinds there are, what is wrong with a person's own, and a file to start one from.

use genescape_schema::{Category, Demand, Kind, Kinds, Space};
use genescape_world::{World, WorldKinds};
use serde_json::{Map, json};

use anyhow::Result;

use crate::bad_input::BadInput;
use crate::cli::{KindsCommand, RunArgs};
use crate::kinds::called;
use crate::say;

/// Carries out the command.
pub fn run(action: Option<&KindsCommand>, args: &RunArgs) -> Result<()> {
    let world = World::new(&args.world);
    let (space, _) = world.space()?;
    let found = world.kinds(&space);
    match action {
        None => list(&space, &found, args.json),
        Some(KindsCommand::Show { kind }) => {
            let kind = only(&found.kinds, kind)?;
            say!("{}", world.kind_text(kind.category, &kind.id)?.trim_end());
            Ok(())
        }
        Some(KindsCommand::Copy { kind, name }) => {
            copy(&args.world, only(&found.kinds, kind)?, name.as_deref())
        }
    }
}

fn only<'a>(kinds: &'a Kinds, word: &str) -> Result<&'a Kind, BadInput> {
    match called(kinds, &[word.to_owned()])?[..] {
        [one] => Ok(one),
        ref several => {
            let ids: Vec<String> =
                several.iter().map(|kind| format!("{}/{}", kind.category, kind.id)).collect();
            Err(BadInput(format!("{word} may be {}", ids.join(", "))))
        }
    }
}

fn list(space: &Space, found: &WorldKinds, json: bool) -> Result<()> {
    let WorldKinds { kinds, faults } = found;
    if json {
        kinds.iter().for_each(|kind| say!("{}", object(space, kind)));
    } else {
        Category::ALL.into_iter().for_each(|category| table(space, kinds, category));
    }
    match faults.len() {
        0 => Ok(()),
        count => {
            let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
            let files = if count == 1 { "1 file is".to_owned() } else { format!("{count} files are") };
            Err(BadInput(format!("{files} wrong and left out:\n{}", told.join("\n"))).into())
        }
    }
}

fn table(space: &Space, kinds: &Kinds, category: Category) {
    let all: Vec<&Kind> = kinds.of(category).collect();
    let width = |of: &dyn Fn(&Kind) -> usize| all.iter().map(|kind| of(kind)).max().unwrap_or(0);
    let [ids, names, groups] = [
        width(&|kind| kind.id.chars().count()),
        width(&|kind| kind.name.chars().count()),
        width(&|kind| kind.mixes.join(" ").chars().count()),
    ];
    say!("{category}: {} kinds\n", all.len());
    for kind in all {
        let goes_with: Vec<String> = kind.goes_with.iter().map(|demand| demand_text(space, demand)).collect();
        let own = if kind.ships { "" } else { "  (your own)" };
        let (id, name, mixes, goes_with) = (&kind.id, &kind.name, kind.mixes.join(" "), goes_with.join(", "));
        let line = format!("  {id:ids$}  {name:names$}  {mixes:groups$}  {goes_with}{own}");
        say!("{}", line.trim_end());
    }
    say!("");
}

/// "temperature_c 4 … 16 °C"
fn demand_text(space: &Space, Demand { gene, codes, .. }: &Demand) -> String {
    let Some(parameter) = space.find(gene) else { return String::new() };
    format!("{gene} {} … {}", parameter.text(*codes.start()), parameter.value_text(*codes.end()))
}

fn object(space: &Space, kind: &Kind) -> serde_json::Value {
    let range = |demand: &Demand| {
        let gene = space.find(&demand.gene)?;
        let ends = json!([gene.value(*demand.codes.start()), gene.value(*demand.codes.end())]);
        Some((gene.name.clone(), ends))
    };
    let Kind { id, category, ships, name, source, mixes, goes_with, .. } = kind;
    let goes_with: Map<String, serde_json::Value> = goes_with.iter().filter_map(range).collect();
    json!({
        "category": category.name(), "kind": id, "name": name, "source": source, "mixes": mixes,
        "goes_with": goes_with, "own": !ships,
    })
}

fn copy(root: &std::path::Path, kind: &Kind, name: Option<&str>) -> Result<()> {
    let world = World::open(root)?;
    let name = name.unwrap_or(&kind.id);
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_') {
        let text =
            format!("a kind's name is made of lower-case letters, digits and underscores, not {name:?}");
        return Err(BadInput(text).into());
    }
    let text = world.kind_text(kind.category, &kind.id)?;
    say!("made {}", world.create_kind(kind.category, name, &text)?.display());
    Ok(())
}
