//! Vulkan's validation layer has nothing to say of what is drawn.

use std::collections::BTreeSet;
use std::process::Command;

/// naga 30 declares the mask of samples as a number instead of an array (wgpu issue 7311). It also tells that the layer is there.
const KNOWN: &str = "VUID-SampleMask-SampleMask-04359";

/// What draws a landscape in all ways there are, and files of others.
const TESTS: [&str; 3] = [
    "golden::pictures_are_as_they_were",
    "asset_drawn::alpha_means_what_its_mode_says",
    "asset_drawn::levels_follow_the_distance_and_the_controls",
];

#[test]
#[ignore = "needs a Vulkan driver: `cargo xtask test` runs it"]
fn vulkans_validation_layer_objects_to_nothing_new() {
    let output = Command::new(std::env::current_exe().expect("a program"))
        .args(["--ignored", "--exact", "--nocapture"])
        .args(TESTS)
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        // The layer is to print, not to tell wgpu, which asks it in debug builds and passes on to a log.
        .envs([("WGPU_VALIDATION", "0"), ("WGPU_DEBUG", "0")])
        .output()
        .expect("it runs");
    let printed =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(output.status.success(), "{printed}");
    let words = printed.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
    let said: BTreeSet<&str> = words.filter(|word| word.starts_with("VUID-")).collect();
    assert!(
        said.contains(KNOWN),
        "the layer is missing (Debian: vulkan-validationlayers), or wgpu has mended its fault: {said:?}"
    );
    assert_eq!(said, BTreeSet::from([KNOWN]), "{printed}");
}
