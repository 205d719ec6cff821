//! x
/// x
#[derive(Clone, Debug, clap::Args)]
pub struct BenchArgs {}
/// x
///
/// # Errors
/// x
pub fn run(_: &BenchArgs) -> anyhow::Result<()> {
    Ok(())
}
