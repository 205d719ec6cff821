//! Kinds of trees, lands and skies: those that ship, and a person's own in the world's folder `kinds/`.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use genescape_schema::{Category, Kind, Kinds, Report, SHIPPED, Space};

use crate::folder::{list, read};
use crate::{World, WorldError, atomic_write, names};

/// The kinds of a world.
#[derive(Debug, Default)]
pub struct WorldKinds {
    pub kinds: Kinds,
    /// Files that are wrong or cannot be read. They are left out; where one stands for a kind that ships, this one is used.
    pub faults: Vec<WorldError>,
}

impl World {
    /// The kinds that ship and those in the world's folders; a file of the same name takes the place of one that ships.
    pub fn kinds(&self, space: &Space) -> WorldKinds {
        self.kinds_beside(Kinds::shipped(space), space)
    }

    /// The same for those who have read the ones that ship before, by [`Kinds::shipped`] with that space.
    pub fn kinds_beside(&self, shipped: (Kinds, Vec<Report>), space: &Space) -> WorldKinds {
        let (kinds, faults) = shipped;
        let mut found = WorldKinds { kinds, faults: faults.into_iter().map(WorldError::from).collect() };
        for category in Category::ALL {
            let folder = self.root().join(names::KINDS).join(category.name());
            let files = list(&folder, |name| name.strip_suffix(".ron").map(str::to_owned));
            let mut ids = files.unwrap_or_else(|error| {
                found.faults.push(error);
                Vec::new()
            });
            ids.sort_unstable();
            for id in ids.iter().filter(|id| !id.starts_with('.')) {
                match self.kind(space, category, id) {
                    Ok(kind) => found.kinds.insert(kind),
                    Err(error) => found.faults.push(error),
                }
            }
        }
        found
    }

    fn kind(&self, space: &Space, category: Category, id: &str) -> Result<Kind, WorldError> {
        let path = self.kind_path(category, id);
        Ok(Kind::load(space, category, id, &path.display().to_string(), &read(&path)?)?)
    }

    /// The file of a kind of one's own; it need not exist.
    pub fn kind_path(&self, category: Category, id: &str) -> PathBuf {
        self.root().join(names::kind(category, id))
    }

    /// The text of a kind's file: the world's own, or the one that ships.
    ///
    /// # Errors
    /// A file that cannot be read, a kind that there is not.
    pub fn kind_text(&self, category: Category, id: &str) -> Result<String, WorldError> {
        let path = self.kind_path(category, id);
        let ships = || SHIPPED.iter().find(|kind| kind.category == category && kind.id == id);
        match read(&path) {
            Err(WorldError::Read { error, .. }) if error.kind() == ErrorKind::NotFound => {
                ships().map(|kind| kind.text.to_owned()).ok_or(WorldError::NoFile(path))
            }
            result => result,
        }
    }

    /// Writes the file of a kind for a person to change, and says where.
    ///
    /// # Errors
    /// A file that is there already, or a folder that cannot be written to.
    pub fn create_kind(&self, category: Category, id: &str, text: &str) -> Result<PathBuf, WorldError> {
        let path = self.kind_path(category, id);
        let folder = path.parent().map(fs::create_dir_all).transpose();
        match folder.and_then(|_| atomic_write::create(&path, text)) {
            Ok(()) => Ok(path),
            Err(error) => Err(WorldError::Write { path, error }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The downs without a gene that has no default, with a fault, or as they should be.
    const DOWNS: &str = r#"Kind(name: "on downs", source: "a test", mixes: ["hills"], genes: (
        relief_m: (50, 90, 140), wavelength_m: 900, hurst: 1.1, lacunarity: 2, ridged: 0, offset: 0.5,
        stream_power_steps: (0, 6), droplets: 9000, talus_angle_deg: 32))"#;

    fn world() -> (tempfile::TempDir, World) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let world = World::new(folder.path());
        (folder, world)
    }

    #[test]
    fn a_persons_own_kinds_stand_beside_those_that_ship() {
        let ((_folder, world), space) = (world(), Space::builtin());
        let before = world.kinds(&space);
        assert!(before.faults.is_empty(), "{:?}", before.faults);
        let path = world.create_kind(Category::Terrain, "my_downs", DOWNS).expect("written");
        assert_eq!(path, world.root().join("kinds/terrain/my_downs.ron"));
        assert!(world.create_kind(Category::Terrain, "my_downs", DOWNS).is_err(), "nothing is overwritten");
        let own = world.kinds(&space);
        assert!(own.faults.is_empty(), "{:?}", own.faults);
        assert_eq!(own.kinds.iter().count(), before.kinds.iter().count() + 1);
        assert_eq!(
            own.kinds.called("my downs").map(|kind| kind.name.as_str()).collect::<Vec<_>>(),
            ["on downs"]
        );
        assert_eq!(world.kind_text(Category::Terrain, "my_downs").expect("there"), DOWNS);
    }

    #[test]
    fn a_broken_file_is_told_and_left_out() {
        let ((_folder, world), space) = (world(), Space::builtin());
        let before = world.kinds(&space).kinds;
        let broken = DOWNS.replace("relief_m: (50, 90, 140)", "relief_m: (50, 90, 1400)");
        world.create_kind(Category::Terrain, "downs", &broken).expect("written");
        let folder = world.kind_path(Category::Sky, "folder");
        fs::create_dir_all(&folder).expect("made");
        fs::write(folder.with_extension("ron~"), "an editor's").expect("written");
        let found = world.kinds(&space);
        let told: Vec<String> = found.faults.iter().map(ToString::to_string).collect();
        assert_eq!(found.kinds, before);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].contains("terrain/downs.ron:2:28: relief_m: 1400 is outside 15 … 420 m"), "{told:?}");
        assert!(told[1].contains("folder.ron"), "{told:?}");
    }

    #[test]
    fn a_persons_file_takes_the_place_of_one_that_ships() {
        let ((_folder, world), space) = (world(), Space::builtin());
        let Some(shipped) = SHIPPED.first() else { return };
        let text = world.kind_text(shipped.category, shipped.id).expect("it ships");
        let name = world.kinds(&space).kinds.iter().next().expect("it ships").name.clone();
        let mine = text.replacen(&format!("{name:?}"), "\"Mine\"", 1);
        world.create_kind(shipped.category, shipped.id, &mine).expect("written");
        let kinds = world.kinds(&space).kinds;
        assert_eq!(kinds.iter().filter(|kind| kind.name == "Mine").count(), 1);
        assert_eq!(kinds.iter().count(), SHIPPED.len());
    }
}
