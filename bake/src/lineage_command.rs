//! `bake lineage`: a world → its family tree as a page, or as JSON.

use std::io::ErrorKind;
use std::path::Path;

use anyhow::{Context, Result};
use genescape_world::{World, atomic_write, output, regular_file};

use crate::bad_input::BadInput;
use crate::cli::RunArgs;
use crate::lineage::{Family, page};
use crate::say;

/// In the world's folder, where no other name is given.
const DEFAULT: &str = "lineage.html";
/// A page that is larger is none of ours.
const MAX_PAGE_BYTES: u64 = 1 << 30;

/// Writes the page; for programs, prints a line of JSON for each generation instead.
pub fn run(out: Option<&Path>, args: &RunArgs) -> Result<()> {
    let world = World::open(&args.world)?;
    let (space, _) = world.space()?;
    let family = Family::read(&world, &space)?;
    family.skipped.iter().for_each(|fault| say::warn(format_args!("left out: {fault}")));
    if args.json {
        family.generations.iter().for_each(|generation| say!("{}", generation.to_json()));
        return Ok(());
    }
    let path = out.map_or_else(|| world.root().join(DEFAULT), Path::to_owned);
    output::check(&path, "html", &[])?;
    check_replaceable(&path)?;
    let written = atomic_write::replace(&path, page::page(&family));
    written.with_context(|| format!("cannot write {}", path.display()))?;
    say!("wrote {}: {} generations; open it in a browser", path.display(), family.generations.len());
    Ok(())
}

/// Whether nobody else's file is there.
fn check_replaceable(path: &Path) -> Result<(), BadInput> {
    match regular_file::read(path, MAX_PAGE_BYTES) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(bytes) if bytes.starts_with(page::BEGINNING.as_bytes()) => Ok(()),
        _ => {
            let text = format!("{} is there, and no page of bake lineage: give another name", path.display());
            Err(BadInput(text))
        }
    }
}
