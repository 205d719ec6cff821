//! `viewer lab trees`: a tree's levels of detail at equal size on the screen, with what each covers, how far it is from the
//! full tree, and what it costs; beside meshoptimizer's at as many triangles.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::Args;
use image::ImageFormat;

use super::chain::{MAX_COVERAGE_ERROR, MAX_HALF_ERROR, Shown, chain};
use super::page::{Block, Finding, Page, Picture, Section, Table, rounded};
use super::report;
use crate::baker::laboratory;
use crate::headless::Headless;
use crate::measure::Machine;
use crate::passes::Shaders;
use crate::say;

/// What `viewer lab trees` can be asked for.
#[derive(Clone, Debug, Args)]
pub struct TreesArgs {
    /// Population files, or presets of trees: of each landscape the first template is shown
    #[arg(value_name = "GENOME.ron", required = true)]
    pub genomes: Vec<PathBuf>,

    /// The folder for the page and what is baked
    #[arg(long, value_name = "DIR", default_value = "laboratory-trees")]
    pub out: PathBuf,
}

/// Draws all chains, and writes `trees.html` and `trees.md`.
///
/// # Errors
/// Genomes that are wrong, a folder that cannot be written to, or nothing that can draw.
pub fn run(args: &TreesArgs) -> Result<()> {
    let scenes = laboratory::bake_genomes(&args.out.join("world"), &args.genomes)?;
    let headless = Headless::open(&Shaders::from(None), 4)?;
    let machine = Machine::of(&headless.gpu);
    let mut sections = Vec::new();
    for path in &scenes {
        sections.push(section(&headless, path, sections.len())?);
    }
    let facts = vec![("Machine".to_owned(), machine.told()), ("Driver".to_owned(), machine.driver)];
    let title = "Levels of detail of trees, at equal size".to_owned();
    report::keep(&args.out, "trees", &Page { title, facts, sections })?;
    say!("wrote {}", args.out.join("trees.html").display());
    Ok(())
}

fn section(headless: &Headless, path: &Path, number: usize) -> Result<Section> {
    let scene = headless.read(path)?;
    let tree = scene.trees.instances.first().copied();
    let tree = tree.with_context(|| format!("{} has no trees", scene.name))?;
    let template = Arc::clone(&scene.trees.templates[tree.template as usize]);
    ensure!(!template.levels.is_empty(), "{} has a tree without levels", scene.name);
    let ours = chain(headless, &scene, tree, &template)?;
    let peer = super::meshoptimizer::alike(&template);
    let peer = peer.map(|template| chain(headless, &scene, tree, &template)).transpose()?;
    let picture = |whose: &str, level: usize, shown: &Shown| -> Result<Picture> {
        let caption = format!(
            "{whose}, D{level}\n{} triangles\ncoverage {}\nFLIP {}",
            rounded(f64::from(shown.triangles)),
            rounded(shown.coverage),
            rounded(shown.flip)
        );
        let mut png = Cursor::new(Vec::new());
        shown.picture.write_to(&mut png, ImageFormat::Png)?;
        let name = format!("tree-{number}-{}-{level}", whose.to_lowercase());
        Ok(Picture { name, png: png.into_inner(), caption })
    };
    let pictures = |whose: &str, all: &[Shown]| -> Result<Block> {
        let all = all.iter().enumerate().map(|(level, shown)| picture(whose, level, shown));
        Ok(Block::Pictures(all.collect::<Result<_>>()?))
    };
    let mut blocks = vec![pictures("Ours", &ours)?];
    if let Some(peer) = &peer {
        blocks.push(pictures("Meshoptimizer", peer)?);
    }
    blocks.push(Block::Table(table(&ours, peer.as_deref())));
    let said = "Each level as large as the full tree, without a picture of it taking over. Coverage is what a level covers over \
                what the full tree does; FLIP is from the full tree, over the whole picture."
        .to_owned();
    Ok(Section { title: scene.name, said, blocks, findings: findings(&ours, peer.as_deref()) })
}

fn table(ours: &[Shown], peer: Option<&[Shown]>) -> Table {
    let mut head =
        ["Level", "Triangles", "Vertices", "Error, m", "Coverage", "FLIP"].map(str::to_owned).to_vec();
    if peer.is_some() {
        let more = ["Meshoptimizer: triangles", "its coverage", "its FLIP"];
        head.extend(more.map(str::to_owned));
    }
    let row = |(level, shown): (usize, &Shown)| {
        let mut row = vec![
            format!("D{level}"),
            rounded(f64::from(shown.triangles)),
            rounded(f64::from(shown.vertices)),
            rounded(f64::from(shown.error_m)),
            rounded(shown.coverage),
            rounded(shown.flip),
        ];
        if let Some(other) = peer.and_then(|peer| peer.get(level)) {
            row.extend([f64::from(other.triangles), other.coverage, other.flip].map(rounded));
        }
        row
    };
    Table { head, rows: ours.iter().enumerate().map(row).collect(), ..Table::default() }
}

fn findings(ours: &[Shown], peer: Option<&[Shown]>) -> Vec<Finding> {
    let kept = ours.iter().filter(|shown| (shown.coverage - 1.0).abs() <= MAX_COVERAGE_ERROR).count();
    let is_half = |pair: &&[Shown]| {
        (f64::from(pair[1].vertices) / f64::from(pair[0].vertices.max(1)) - 0.5).abs() <= 0.5 * MAX_HALF_ERROR
    };
    let (halves, pairs) = (ours.windows(2).filter(is_half).count(), ours.len().saturating_sub(1));
    let mut findings = vec![
        Finding::new(
            kept == ours.len(),
            "Coverage within 1 ± 0.02 at every level",
            format!("{kept} of {} levels keep it.", ours.len()),
        ),
        Finding::new(
            halves == pairs,
            "Each level half of the vertices before, to 1 %",
            format!("{halves} of {pairs} levels are."),
        ),
    ];
    if let Some(peer) = peer {
        let pairs: Vec<(f64, f64)> = ours.iter().zip(peer).skip(1).map(|(a, b)| (a.flip, b.flip)).collect();
        let nearer = pairs.iter().filter(|(ours, peer)| ours <= peer).count();
        findings.push(Finding::new(
            nearer == pairs.len(),
            "FLIP at most that of meshoptimizer at as many triangles, at every level",
            format!("{nearer} of {} levels are as near to the full tree or nearer.", pairs.len()),
        ));
    }
    findings
}

#[cfg(test)]
mod tests {
    use image::RgbaImage;

    use super::*;

    #[test]
    fn findings_count_levels() {
        let shown = |vertices: u32, coverage: f64, flip: f64| Shown {
            triangles: vertices,
            vertices,
            error_m: 0.1,
            coverage,
            flip,
            picture: RgbaImage::new(1, 1),
        };
        let ours = [shown(1000, 1.0, 0.0), shown(502, 1.01, 0.1), shown(300, 0.9, 0.3)];
        let peer = [shown(1000, 1.0, 0.0), shown(502, 0.8, 0.2), shown(300, 0.7, 0.2)];
        let told: Vec<String> = findings(&ours, Some(&peer)).into_iter().map(|one| one.sentence).collect();
        assert_eq!(
            told,
            [
                "2 of 3 levels keep it.",
                "1 of 2 levels are.",
                "1 of 2 levels are as near to the full tree or nearer."
            ]
        );
    }
}
