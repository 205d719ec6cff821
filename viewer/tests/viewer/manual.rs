//! What comes with the program for shells and for `man`.

use std::process::{Command, Output};

fn viewer(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_viewer")).args(words).output().expect("the viewer runs")
}

#[test]
fn bash_completes_commands() {
    let script = String::from_utf8(viewer(&["completions", "bash"]).stdout).expect("text");
    let script = format!(
        "{script}\nCOMP_WORDS=(viewer ben)\nCOMP_CWORD=1\n_viewer viewer ben viewer\necho $COMPREPLY"
    );
    let Ok(output) = Command::new("bash").arg("-c").arg(script).output() else {
        return eprintln!("left out, for want of bash");
    };
    assert_eq!(String::from_utf8_lossy(&output.stdout), "bench\n");
}

#[test]
fn man_pages_are_printed_or_written() {
    let printed = String::from_utf8(viewer(&["man"]).stdout).expect("text");
    assert!(printed.contains(".TH viewer 1") && printed.contains("screenshot"), "{printed}");
    let folder = tempfile::tempdir().expect("a folder");
    assert!(viewer(&["man", folder.path().to_str().expect("text")]).status.success());
    assert!(folder.path().join("viewer-bench.1").is_file());
}
