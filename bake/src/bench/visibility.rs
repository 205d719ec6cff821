//! `bake bench --visibility`: the table of how much each gene is seen.

use anyhow::Result;
use genescape_schema::{Kinds, Space};

use crate::phenotype::visibility::Visibility;
use crate::say;

/// Measures it for the space and the kinds that ship, and prints it.
pub fn visibility(pool: &rayon::ThreadPool) -> Result<()> {
    let space = Space::builtin();
    let (kinds, _) = Kinds::shipped(&space);
    let measured = pool.install(|| Visibility::measure(&space, &kinds))?;
    say!("{}", serde_json::to_string_pretty(&measured)?);
    Ok(())
}
