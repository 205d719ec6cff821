//! The laboratory: a tiny run, taken up again, compared with itself. What it says is not looked at, only that it says it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn lab(folder: &Path, words: &[&str]) -> Output {
    let mut viewer = Command::new(env!("CARGO_BIN_EXE_viewer"));
    viewer.arg("lab").args(words).current_dir(folder).output().expect("the viewer runs")
}

/// What it printed, if all was well.
fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_run_is_written_as_it_goes_taken_up_and_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let tiny = ["out", "--size", "40x30", "--steps", "2", "--frames", "2", "--scenes", "1"];
    let first = printed(&lab(here, &tiny));
    assert_eq!(first.matches(" rows in ").count(), 20, "{first}");

    let series = here.join("out/series");
    let popping = fs::read_to_string(series.join("popping-trees-many.csv")).expect("measured");
    for scheme in ["discrete", "continuous", "simple"] {
        assert!(popping.contains(scheme), "{popping}");
    }
    let walk = fs::read_to_string(series.join("walk-land-big-hills.csv")).expect("measured");
    assert!(walk.starts_with("scheme,frame,") && walk.lines().count() == 1 + 4 * 4, "{walk}");
    let page = fs::read_to_string(here.join("out/report.html")).expect("a report");
    for figure in 21..=28 {
        assert!(page.contains(&format!("Figure {figure}")), "figure {figure}");
    }
    assert!(!page.contains("NaN"), "every number is one");
    let text = fs::read_to_string(here.join("out/report.md")).expect("a report");
    let plots = text.split("](plots/").skip(1).filter_map(|rest| rest.split(')').next());
    for plot in plots {
        assert!(here.join("out/plots").join(plot).is_file(), "{plot}");
    }

    fs::remove_file(series.join("popping-trees-many.csv")).expect("there");
    let again = printed(&lab(here, &tiny));
    assert_eq!(again.matches(" rows in ").count(), 1, "only what is missing: {again}");

    let other = lab(here, &["out", "--quick"]);
    assert!(!other.status.success());
    let told = String::from_utf8_lossy(&other.stderr).into_owned();
    assert!(told.contains("name another folder"), "{told}");

    printed(&lab(here, &["compare", "out", "out"]));
    let compared = fs::read_to_string(here.join("laboratory-compared/compare.md")).expect("a page");
    assert!(compared.contains("| 1.00 | no |") && !compared.contains("| yes |"), "{compared}");
    let nothing = lab(here, &["compare", "out", "."]);
    assert!(String::from_utf8_lossy(&nothing.stderr).contains("is no laboratory's folder"));
}

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn a_tree_is_shown_level_by_level() {
    let folder = tempfile::tempdir().expect("a folder");
    let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/presets/birch.ron");
    let wrong = lab(folder.path(), &["trees", "none.ron"]);
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("none.ron"));
    printed(&lab(folder.path(), &["trees", preset.to_str().expect("text"), "--out", "out"]));
    let text = fs::read_to_string(folder.path().join("out/trees.md")).expect("a page");
    // Each level has fewer triangles than the one before, in the table and so in the pictures.
    let rows = text.lines().filter_map(|line| line.strip_prefix("| D"));
    let triangles: Vec<u32> =
        rows.filter_map(|row| row.split('|').nth(1)?.trim().replace(',', "").parse().ok()).collect();
    assert!(triangles.len() > 3 && triangles.windows(2).all(|pair| pair[1] < pair[0]), "{text}");
    assert!(text.contains("| 1.00 | 0 |"), "the full tree is as the full tree: {text}");
}
