//! What comes with the program for shells and for `man`, tried with the programs that read it.

use std::path::Path;
use std::process::Command;

fn bake(words: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_bake")).args(words).output().expect("bake runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Whether a program can be started; if not, says what is left out for want of it.
fn has(program: &str) -> bool {
    let is_there =
        Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !is_there {
        eprintln!("left out, for want of {program}");
    }
    is_there
}

/// What bash offers where the person presses Tab behind these words.
fn offered(words: &[&str]) -> String {
    let last = words.len() - 1;
    let script = format!(
        "{}\nCOMP_WORDS=({words})\nCOMP_CWORD={last}\n_bake bake '{}' '{}'\necho \"${{COMPREPLY[@]}}\"",
        bake(&["completions", "bash"]),
        words[last],
        words[last - 1],
        words = words.join(" "),
    );
    let output = Command::new("bash").arg("-c").arg(script).output().expect("bash runs");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

#[test]
fn bash_completes_commands_options_and_values() {
    if !has("bash") {
        return;
    }
    for (words, expected) in [
        (&["bake", "exp"][..], "export"),
        (&["bake", "--wo"], "--world"),
        (&["bake", "cache", "ver"], "verify"),
        (&["bake", "export", "--for", "bl"], "blender"),
        (&["bake", "completions", "zs"], "zsh"),
    ] {
        let offered = offered(words);
        assert!(offered.split(' ').any(|word| word == expected), "{words:?}: {offered}");
    }
}

#[test]
fn every_shell_gets_a_script_that_knows_the_commands() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = bake(&["completions", shell]);
        assert!(script.contains("export") && script.contains("verify"), "{shell}");
    }
}

#[test]
fn man_pages_render_without_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("share/man/man1");
    bake(&["man", pages.to_str().expect("text")]);
    for name in ["bake", "bake-export", "bake-cache-gc"] {
        assert!(pages.join(name).with_extension("1").is_file(), "{name}");
    }
    std::fs::write(folder.path().join("printed.1"), bake(&["man"])).expect("written");
    if !has("groff") {
        return;
    }
    for page in files(&pages).chain(files(folder.path()).filter(|path| path.is_file())) {
        let mut groff = Command::new("groff");
        // All warnings, a terminal's width, no bold letters.
        groff.args(["-man", "-Tutf8", "-ww", "-rLL=78n", "-P-cbou"]).arg(&page);
        let output = groff.output().expect("groff runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.is_empty(), "{}: {said}", page.display());
        let text = String::from_utf8(output.stdout).expect("text");
        assert!(text.contains("SYNOPSIS"), "{}", page.display());
    }
}

fn files(folder: &Path) -> impl Iterator<Item = std::path::PathBuf> {
    std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path())
}
