//! Every command that a page or a help text shows is one that the programs take, and the two reference pages name every
//! command and option there is.

use std::collections::BTreeSet;

use clap::error::ErrorKind;
use clap::{Command, CommandFactory, Parser};

use crate::docs::pages::{Page, Part};

type Bake = genescape_bake::cli::Cli;
type Viewer = genescape_viewer::cli::Cli;

/// How the programs are started without being installed.
const BY_CARGO: [(&str, &str); 4] = [
    ("cargo run --release -p genescape-viewer", "viewer"),
    ("cargo run --release --", "bake"),
    ("cargo run --release", "bake"),
    ("cargo viewer", "viewer"),
];

/// What is wrong with a line of code, if it starts one of our programs.
fn fault(line: &str, is_mention: bool) -> Option<String> {
    let line =
        [" #", " | ", " > ", " && "].iter().fold(line, |line, end| line.split(end).next().unwrap_or(line));
    let line = line.trim();
    let by_cargo =
        BY_CARGO.iter().find_map(|(start, program)| Some(format!("{program}{}", line.strip_prefix(start)?)));
    let line = by_cargo.as_deref().unwrap_or(line);
    let words: Vec<&str> = line.split_whitespace().collect();
    let parsed = match words.first() {
        Some(&"bake") => Bake::try_parse_from(&words).map(|cli| cli.population),
        Some(&"viewer") => Viewer::try_parse_from(&words).map(|_| None),
        _ => return None,
    };
    match parsed {
        // What is no command is taken for a file.
        Ok(Some(file)) if file.extension().is_none_or(|ending| ending != "ron") => {
            Some(format!("{line}: no command"))
        }
        Ok(_) => None,
        Err(error) => (!is_tolerable(error.kind(), is_mention)).then(|| format!("{line}\n{error}")),
    }
}

/// Within a sentence a command may stand without what it needs.
fn is_tolerable(error: ErrorKind, is_mention: bool) -> bool {
    use ErrorKind::*;
    match error {
        DisplayHelp | DisplayVersion => true,
        MissingRequiredArgument | MissingSubcommand | DisplayHelpOnMissingArgumentOrSubcommand => is_mention,
        _ => false,
    }
}

#[test]
fn every_command_in_the_pages_can_be_given() {
    let mut faults = Vec::new();
    let mut blocks = 0;
    // The changelog tells of commands as they were.
    let is_current =
        |page: &Page| page.path.file_stem().is_some_and(|name| !name.eq_ignore_ascii_case("changelog"));
    for page in Page::all().into_iter().filter(is_current) {
        let mut check = |line: &str, is_mention| {
            faults.extend(fault(line, is_mention).map(|fault| format!("{}: {fault}", page.path.display())));
        };
        for part in &page.parts {
            match part {
                Part::Code(code) => check(code, true),
                Part::Block(lines) => {
                    blocks += 1;
                    lines.lines().for_each(|line| check(line, false));
                }
                _ => {}
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    assert!(blocks > 20, "blocks of code are read");
}

#[test]
fn what_is_no_command_is_found() {
    for wrong in
        ["bake exprot 1 x.glb", "bake export 1 x.glb --fro blender", "viewer --al", "cargo viewer --wrld x"]
    {
        assert!(fault(wrong, true).is_some(), "{wrong}");
    }
    assert!(fault("bake export", true).is_none() && fault("bake export", false).is_some());
    assert!(fault("bake export 2 x.glb --for blender   # a comment", false).is_none());
}

#[test]
fn examples_in_the_help_can_be_given() {
    let mut examples = 0;
    for command in commands(&Bake::command()).iter().chain(&commands(&Viewer::command())) {
        let text = command.get_after_help().map(|text| text.to_string()).unwrap_or_default();
        for line in text.lines().filter_map(|line| line.strip_prefix("  ")) {
            let line = line.split("  ").next().unwrap_or_default();
            assert_eq!(fault(line, false), None);
            examples += 1;
        }
    }
    assert!(examples > 15, "{examples} examples");
}

/// A command, and all below it but `help`.
fn commands(command: &Command) -> Vec<Command> {
    let below = command.get_subcommands().filter(|command| command.get_name() != "help");
    below.fold(vec![command.clone()], |all, command| [all, commands(command)].concat())
}

#[test]
fn reference_pages_name_every_command_and_option() {
    complete("docs/command-line.md", Bake::command());
    complete("docs/viewer.md", Viewer::command());
}

fn complete(page: &str, mut program: Command) {
    program.build();
    let name = program.get_name().to_owned();
    let page = Page::read(page);
    let parts = page.parts.iter().filter_map(|part| match part {
        Part::Code(text) | Part::Block(text) => Some(text),
        _ => None,
    });
    let ours = |line: &&str| line.starts_with("--") || line.starts_with(&name);
    let words = parts.flat_map(|text| text.lines().filter(ours)).flat_map(|line| line.split([' ', '=']));
    let named: BTreeSet<String> = words.filter(|word| word.starts_with("--")).map(str::to_owned).collect();
    let mut known = BTreeSet::new();
    for command in commands(&program) {
        let path = command.get_bin_name().unwrap_or(&name);
        let is_named =
            page.parts.iter().any(|part| matches!(part, Part::Heading(text) if text.contains(path)));
        assert!(is_named, "{}: no heading for {path}", page.path.display());
        known.extend(command.get_arguments().filter_map(|option| Some(format!("--{}", option.get_long()?))));
    }
    assert_eq!(named, known, "{}", page.path.display());
}
