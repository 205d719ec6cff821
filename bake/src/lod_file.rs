//! t
pub fn convert(_: &std::path::Path, _: &std::path::Path, _: f32) -> anyhow::Result<()> { anyhow::bail!("later") }
