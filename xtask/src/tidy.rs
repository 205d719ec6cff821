//! What ARCHITECTURE.md says of the code as a whole, checked: which files may touch the disk and the clock, which crates
//! know of which, and that modules form no cycles.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Kind, Source, sources};

/// Words that code may only contain in some places. Files are named by the beginnings of their paths.
struct Rule {
    words: &'static [&'static str],
    why: &'static str,
    inside: &'static [&'static str],
    except: &'static [&'static str],
}

const EVERYWHERE: &[&str] = &[""];

const RULES: &[Rule] = &[
    Rule {
        words: &["std::fs", "tempfile"],
        why: "touches the disk",
        inside: EVERYWHERE,
        except: &[
            "cache/",
            "world-folder/",
            "schema/build.rs",
            "xtask/",
            "bake/src/bench/",
            "bake/src/cache_commands.rs",
            "bake/src/commands.rs",
            "bake/src/export/receipts.rs",
            "bake/src/export/source.rs",
            "bake/src/lod_command.rs",
            "bake/src/manual.rs",
            "viewer/src/app/",
            "viewer/src/load/",
            "viewer/src/bench/",
            "viewer/src/lab/",
            "viewer/src/measure/machine.rs",
            "viewer/src/image_file.rs",
            "viewer/src/manual.rs",
            "viewer/src/settings.rs",
            "viewer/src/study/",
            "viewer/src/passes/shaders.rs",
        ],
    },
    Rule {
        words: &["Instant", "SystemTime"],
        why: "reads the clock",
        inside: EVERYWHERE,
        except: &[
            "cache/",
            "world-folder/",
            "xtask/",
            "bake/src/bench/",
            "bake/src/run.rs",
            "bake/src/session.rs",
            "viewer/src/app/",
            "viewer/src/baker.rs",
            "viewer/src/bench/",
            "viewer/src/measure/",
        ],
    },
    Rule {
        words: &["genescape_bake"],
        why: "knows the bake",
        inside: &["viewer/", "cache/", "schema/", "world-folder/"],
        except: &["viewer/src/baker"],
    },
    Rule {
        words: &["wgpu", "egui", "winit"],
        why: "knows the window",
        inside: &["bake/", "cache/", "schema/", "world-folder/"],
        except: &[],
    },
    Rule {
        words: &["HashMap", "HashSet"],
        why: "has an order that changes from run to run",
        inside: &["bake/src/stages/", "bake/src/gltf/", "schema/"],
        // Asked, never iterated.
        except: &["bake/src/stages/lod/topology.rs"],
    },
    Rule {
        words: &["LEAST_", "MOST_", "GREATEST_"],
        why: "is called MIN or MAX elsewhere",
        inside: EVERYWHERE,
        except: &["xtask/src/tidy.rs"],
    },
];

/// What stages may use of their crate; the files that bind them to the graph may use anything.
const STAGES: &str = "bake/src/stages/";
const OF_STAGES: [&str; 6] = ["math", "model", "noise", "raster", "seed", "silhouette"];
const BINDINGS: [&str; 4] = ["/stage.rs", "/levelled.rs", "/scene.rs", "/start.rs"];

#[test]
fn words_stand_where_they_may() {
    let sources = sources().expect("readable");
    let starts = |path: &str, beginnings: &[&str]| beginnings.iter().any(|start| path.starts_with(start));
    let mut faults = Vec::new();
    for Rule { words, why, inside, except } in RULES {
        for source in sources.iter().filter(|s| starts(&s.path, inside) && !starts(&s.path, except)) {
            for (line, text) in code(source) {
                let found = words.iter().filter(|word| contains_word(text, word));
                faults.extend(found.map(|word| format!("{}:{line}: {word} {why}", source.path)));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Lines of code, numbered from 1.
fn code(source: &Source) -> impl Iterator<Item = (usize, &str)> {
    let lines = (1..).zip(&source.lines).filter(|(_, (kind, _))| *kind == Kind::Code);
    lines.map(|(number, (_, line))| (number, line.as_str()))
}

/// Whether a word begins there: `MOST_` is no part of `ALMOST_`.
fn contains_word(text: &str, word: &str) -> bool {
    let is_inside_another = |at: usize| text[..at].ends_with(|c: char| c.is_alphanumeric());
    text.match_indices(word).any(|(at, _)| !is_inside_another(at))
}

#[test]
fn stages_use_nothing_but_plain_values() {
    let sources = sources().expect("readable");
    let is_stage =
        |s: &&Source| s.path.starts_with(STAGES) && !BINDINGS.iter().any(|end| s.path.ends_with(end));
    let mut faults = Vec::new();
    for source in sources.iter().filter(is_stage) {
        let own = module(source)[1..].first().cloned();
        for path in references(source) {
            let allowed = match &path[..] {
                [first, second, ..] if first == "stages" => own.is_none() || Some(second) == own.as_ref(),
                [first, ..] => OF_STAGES.contains(&first.as_str()),
                [] => true,
            };
            if !allowed {
                faults.push(format!("{}: crate::{}", source.path, path.join("::")));
            }
        }
    }
    assert!(faults.is_empty(), "a stage reads no other's code:\n{}", faults.join("\n"));
}

#[test]
fn modules_form_no_cycles() {
    let sources = sources().expect("readable");
    let in_library = |s: &&Source| s.path.contains("/src/") && !s.path.ends_with("/main.rs");
    let modules: BTreeSet<(&str, Vec<String>)> =
        sources.iter().filter(in_library).map(|s| (s.package(), module(s))).collect();
    // Package and parent → module → the siblings that it uses, with a file that does.
    let mut graphs = BTreeMap::<_, BTreeMap<String, BTreeMap<String, &str>>>::new();
    for source in sources.iter().filter(in_library) {
        let from = module(source);
        for to in references(source) {
            let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
            let (Some(a), Some(b)) = (from.get(common), to.get(common)) else { continue };
            if modules.contains(&(source.package(), to[..=common].to_vec())) {
                let parent = (source.package(), from[..common].to_vec());
                graphs
                    .entry(parent)
                    .or_default()
                    .entry(a.clone())
                    .or_default()
                    .insert(b.clone(), &source.path);
            }
        }
    }
    let mut faults = Vec::new();
    for ((package, parent), graph) in &graphs {
        for (a, uses) in graph {
            let in_cycle = uses.iter().filter(|(b, _)| reaches(graph, b, a, &mut BTreeSet::new()));
            faults.extend(
                in_cycle.map(|(b, file)| format!("{package} {}: {a} → {b} ({file})", parent.join("::"))),
            );
        }
    }
    assert!(faults.is_empty(), "cycles:\n{}", faults.join("\n"));
}

fn reaches<'a>(
    graph: &'a BTreeMap<String, BTreeMap<String, &str>>,
    from: &'a str,
    to: &str,
    seen: &mut BTreeSet<&'a str>,
) -> bool {
    let mut next = graph.get(from).into_iter().flat_map(BTreeMap::keys);
    from == to || seen.insert(from) && next.any(|next| reaches(graph, next, to, seen))
}

/// Where a file stands in its crate: `bake/src/stages/land/mod.rs` is `stages::land`.
fn module(source: &Source) -> Vec<String> {
    let (_, inside) = source.path.split_once("/src/").unwrap_or(("", &source.path));
    let parts = inside.trim_end_matches(".rs").split('/');
    parts.filter(|part| !["mod", "lib", "main"].contains(part)).map(str::to_owned).collect()
}

/// All paths from the crate's root that a file's code names, after `crate::` or `super::`.
fn references(source: &Source) -> Vec<Vec<String>> {
    let lines = code(source).map(|(_, line)| line.split(" //").next().unwrap_or_default());
    let code: String = lines.collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::").chain(code.match_indices("super::")) {
        let is_beginning = !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        if is_beginning {
            names(&code[at..], &mut Vec::new(), &mut found);
        }
    }
    let here = module(source);
    found.into_iter().map(|path| absolute(&here, path)).collect()
}

/// The paths of a tree of names such as `a::{b, c::d}`, of which `prefix` was read already; the length of its text.
fn names(text: &str, prefix: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> usize {
    if let Some(group) = text.strip_prefix('{') {
        let mut at = 0;
        loop {
            at += group[at..].len()
                - group[at..].trim_start_matches(|c: char| c == ',' || c.is_whitespace()).len();
            if at == group.len() || group[at..].starts_with('}') {
                return at + 2;
            }
            at += names(&group[at..], &mut prefix.clone(), found).max(1);
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    prefix.push(text[..end].to_owned());
    if let Some(rest) = text[end..].strip_prefix("::") {
        return end + 2 + names(rest, prefix, found);
    }
    found.push(prefix.clone());
    end
}

fn absolute(here: &[String], path: Vec<String>) -> Vec<String> {
    let ups = path.iter().take_while(|name| *name == "super").count();
    let from_root = path.first().is_some_and(|name| name == "crate");
    let base = if from_root { &[] } else { &here[..here.len().saturating_sub(ups)] };
    base.iter().chain(&path[ups + usize::from(from_root)..]).cloned().collect()
}

#[test]
fn paths_are_read_as_rust_reads_them() {
    let path = "bake/src/stages/land/shape.rs".to_owned();
    let text = "use crate::{model::{self, Mesh}, noise};\nuse super::streams::Streams; // crate::no\n\
        fn f() -> super::super::sky::Light { $crate::say!(); crate::stages::land::mend() }\n";
    let lines = text.lines().map(|line| (Kind::Code, line.to_owned())).collect();
    let mut found: Vec<String> =
        references(&Source { path, lines }).iter().map(|path| path.join("::")).collect();
    found.sort();
    assert_eq!(
        found,
        [
            "model::Mesh",
            "model::self",
            "noise",
            "say",
            "stages::land::mend",
            "stages::land::streams::Streams",
            "stages::sky::Light",
        ]
    );
    assert!(contains_word("const MOST_M: f32", "MOST_") && !contains_word("ALMOST_M", "MOST_"));
}
