//! Installs other people's programs: npm packages (the Khronos validator, three.js, ez-tree) and a Python environment with
//! Blender as a module and F3D. What is there already is left as it is.

use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::tools::{interop, is_installed, program, python, run, script};

/// Libraries that the wheels of bpy and f3d open but do not bring.
const LIBRARIES: [(&str, &str); 10] = [
    ("libx11-6", "libX11.so.6"),
    ("libxrender1", "libXrender.so.1"),
    ("libxfixes3", "libXfixes.so.3"),
    ("libxi6", "libXi.so.6"),
    ("libxkbcommon0", "libxkbcommon.so.0"),
    ("libsm6", "libSM.so.6"),
    ("libice6", "libICE.so.6"),
    ("libgl1", "libGL.so.1"),
    ("libegl1", "libEGL.so.1"),
    ("libgomp1", "libgomp.so.1"),
];

/// What a window without a screen needs: a Vulkan driver that draws on the processor, a layer that objects to what is not
/// valid, an X server, and what winit opens when it meets one.
const WINDOW: [(&str, &str); 10] = [
    ("mesa-vulkan-drivers", "libvulkan_lvp.so"),
    ("libvulkan1", "libvulkan.so.1"),
    ("vulkan-validationlayers", "libVkLayer_khronos_validation.so"),
    ("xvfb", "Xvfb"),
    ("libx11-6", "libX11.so.6"),
    ("libx11-xcb1", "libX11-xcb.so.1"),
    ("libxcursor1", "libXcursor.so.1"),
    ("libxi6", "libXi.so.6"),
    ("libxkbcommon0", "libxkbcommon.so.0"),
    ("libxkbcommon-x11-0", "libxkbcommon-x11.so.0"),
];

/// Everything.
pub fn all() -> Result<()> {
    node()?;
    blender()
}

/// The validator, three.js with what steers Chromium, and ez-tree.
pub fn node() -> Result<()> {
    let folder = interop();
    if ["gltf-validator", "three", "puppeteer-core", "@dgreenheck/ez-tree"]
        .iter()
        .all(|name| folder.join("node_modules").join(name).is_dir())
    {
        return Ok(());
    }
    if !is_installed("npm") || !is_installed("node") {
        bail!("node and npm are missing: install Node.js 20 or later (https://nodejs.org), then run again");
    }
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    std::fs::copy(script("package.json"), folder.join("package.json")).context("cannot copy package.json")?;
    run(program("npm").args(["install", "--no-audit", "--no-fund", "--silent"]).current_dir(&folder))
}

/// Blender as a Python module, and F3D.
pub fn blender() -> Result<()> {
    packages(&LIBRARIES)?;
    let has = "import importlib.util as u, sys; sys.exit(not all(map(u.find_spec, ('bpy', 'f3d'))))";
    if python().is_file() && Command::new(python()).args(["-c", has]).status()?.success() {
        return Ok(());
    }
    if !is_installed("python3.11") {
        bail!("bpy 4.5 needs Python 3.11: install it as python3.11 (with venv), then run again");
    }
    println!("installing Blender (bpy) and F3D into {}: about 1 GB", interop().display());
    std::fs::create_dir_all(interop())?;
    run(program("python3.11").args(["-m", "venv"]).arg(interop().join("venv")))?;
    run(program(python())
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"])
        .arg(script("requirements.txt")))
}

/// What the viewer's tests need.
pub fn window() -> Result<()> {
    packages(&WINDOW)
}

/// Installs missing packages, each known by a library or a program of it, where that is possible without asking; else
/// says how.
fn packages(needed: &[(&'static str, &str)]) -> Result<()> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let cache = Command::new("ldconfig").arg("-p").output().or_else(|_| {
        Command::new("/sbin/ldconfig").arg("-p").output() // not on everyone's path
    });
    let Ok(cache) = cache else { return Ok(()) };
    let known = String::from_utf8_lossy(&cache.stdout).into_owned();
    let is_there = |file: &str| known.contains(file) || is_installed(file);
    let missing: Vec<&str> =
        needed.iter().filter(|(_, file)| !is_there(file)).map(|(package, _)| *package).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let user = Command::new("id").arg("-u").output().context("cannot ask who we are")?;
    let root = user.stdout.trim_ascii() == b"0";
    if !root || !is_installed("apt-get") {
        bail!("packages are missing; on Debian or Ubuntu: sudo apt-get install {}", missing.join(" "));
    }
    println!("installing {}", missing.join(" "));
    run(program("apt-get").args(["update", "-qq"]))?;
    run(program("apt-get")
        .args(["install", "-y", "-qq", "--no-install-recommends"])
        .args(&missing)
        .env("DEBIAN_FRONTEND", "noninteractive"))
}
