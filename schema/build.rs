//! `configs/kinds/{tree,terrain,sky}/*.ron` → a constant with their texts, so that programs carry them along.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../configs/kinds");
    // A folder is watched with all that is in it: a new file is a new kind.
    println!("cargo:rerun-if-changed={}", root.display());
    let mut table = String::from("/// The kinds that ship.\npub const SHIPPED: &[ShippedKind] = &[\n");
    for (folder, category) in [("tree", "Tree"), ("terrain", "Terrain"), ("sky", "Sky")] {
        for path in kinds(&root.join(folder))? {
            let id = path.file_stem().unwrap_or_default().to_string_lossy();
            let _ = writeln!(
                table,
                "    ShippedKind {{ category: Category::{category}, id: {id:?}, text: include_str!({path:?}) }},"
            );
        }
    }
    table.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("shipped_kinds.rs"), table)
}

/// The files of a folder that are kinds, sorted.
fn kinds(folder: &Path) -> io::Result<Vec<PathBuf>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    let mut files: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "ron"));
    files.sort();
    Ok(files)
}
