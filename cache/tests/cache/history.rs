//! Explanations: what changed since the scope's last run, in words.

use genescape_cache::{ActionKey, Cache, Digest, How, KeyFields};

fn tree(height_m: f32, version: u32, input: &str) -> ActionKey {
    ActionKey::new(KeyFields {
        stage: "tree".to_owned(),
        version,
        parameters: height_m.to_le_bytes().to_vec(),
        named: vec![("height_m".to_owned(), height_m.to_string()), ("levels".to_owned(), "3".to_owned())],
        inputs: vec![("textures".to_owned(), Digest::of(input.as_bytes()))],
    })
}

#[test]
fn says_which_field_changed() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let mut history = cache.history("g0003/scene-0").expect("read");
    assert_eq!(history.note("tree/0", &tree(7.29, 1, "a"), How::Built).to_string(), "first build");
    cache.save_history(&history).expect("saved");

    let history = cache.history("g0003/scene-0").expect("read");
    let says = |key: ActionKey, how| history.clone().note("tree/0", &key, how).to_string();
    assert_eq!(says(tree(7.29, 1, "a"), How::Reused), "reused");
    assert_eq!(says(tree(7.29, 1, "a"), How::Built), "rebuilt because the result was missing or damaged");
    assert_eq!(
        says(tree(8.14, 1, "a"), How::Built),
        "rebuilt because parameters changed: height_m: 7.29 → 8.14"
    );
    assert_eq!(says(tree(7.29, 1, "b"), How::Built), "rebuilt because input textures changed");
    assert_eq!(
        says(tree(8.14, 2, "b"), How::Built),
        "rebuilt because parameters changed: height_m: 7.29 → 8.14; stage version 1 → 2; input textures changed"
    );
    assert_eq!(
        says(tree(8.14, 1, "a"), How::Reused),
        "reused: built before elsewhere (parameters changed: height_m: 7.29 → 8.14)"
    );
    let fields = tree(7.29, 1, "a").fields().clone();
    let unnamed = KeyFields { parameters: vec![1], named: vec![], ..fields };
    assert_eq!(
        says(ActionKey::new(unnamed), How::Built),
        "rebuilt because parameters changed: height_m: no longer read, levels: no longer read"
    );
}

#[test]
fn a_child_scope_is_compared_with_its_parent() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let mut parent = cache.history("g0000/scene-2").expect("read");
    parent.note("tree/0", &tree(7.29, 1, "a"), How::Built);
    cache.save_history(&parent).expect("saved");

    let mut child = cache.history("g0001/scene-0").expect("read");
    child.inherit(&cache.history("g0000/scene-2").expect("read"));
    let explanation = child.note("tree/0", &tree(8.0, 1, "a"), How::Built);
    assert_eq!(explanation.to_string(), "rebuilt because parameters changed: height_m: 7.29 → 8");
    cache.save_history(&child).expect("saved");
    let again = cache.history("g0001/scene-0").expect("read");
    assert_eq!(again.last().collect::<Vec<_>>(), [("tree/0", &explanation)]);
}

#[test]
fn is_written_only_if_it_changed_and_forgiven_if_damaged() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path()).expect("opens");
    let file = world.path().join("history/s.keys");
    let mut history = cache.history("s").expect("read");
    history.note("tree/0", &tree(1.0, 1, "a"), How::Reused);
    cache.save_history(&history).expect("saved");
    let mut history = cache.history("s").expect("read");
    std::fs::write(&file, "spoilt").expect("written");
    history.retain(|_| true);
    cache.save_history(&history).expect("nothing to do");
    assert_eq!(std::fs::read_to_string(&file).expect("read"), "spoilt");

    assert_eq!(cache.history("s").expect("read").last().count(), 0);
    assert_eq!(cache.take_notices().len(), 1);
    assert!(!file.exists());
}

#[test]
fn scopes_cannot_leave_their_folder() {
    let world = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::open(world.path().join("baked")).expect("opens");
    for scope in ["../../x", "/etc/x", "a b/ü#1", ""] {
        let mut history = cache.history(scope).expect("read");
        history.note("i", &tree(1.0, 1, "a"), How::Built);
        cache.save_history(&history).expect("saved");
        assert_eq!(cache.history(scope).expect("read").last().count(), 1, "{scope}");
    }
    assert_eq!(std::fs::read_dir(world.path()).expect("a folder").count(), 1);
}
