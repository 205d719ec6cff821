//! Landscapes as people name them: by number, generation or file.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use genescape_schema::{INDIVIDUALS, Individual, Space};
use genescape_world::{PopulationFile, World, WorldError};

/// One of the four landscapes, which people count from 1; files and arrays count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Landscape(usize);

impl Landscape {
    /// All four, in order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..INDIVIDUALS).map(Self)
    }

    /// From 0.
    pub fn index(self) -> usize {
        self.0
    }
}

impl fmt::Display for Landscape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0 + 1)
    }
}

impl FromStr for Landscape {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.parse::<usize>().ok().filter(|number| (1..=INDIVIDUALS).contains(number));
        number
            .map(|number| Self(number - 1))
            .ok_or_else(|| format!("there are landscapes 1 to {INDIVIDUALS}"))
    }
}

/// A landscape of the current generation, or any baked one by its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneArg {
    Current(Landscape),
    File(PathBuf),
}

impl FromStr for SceneArg {
    type Err = String;

    /// Whatever looks like a number is meant as one.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<i64>() {
            Ok(_) => text.parse().map(Self::Current),
            Err(_) => Ok(Self::File(text.into())),
        }
    }
}

/// A landscape of any generation, whether or not it was baked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reference {
    /// `3`: of the generation that was baked last.
    Current(Landscape),
    /// `2.3`: landscape 3 of generation 2.
    Of(u32, Landscape),
    /// `old.ron:3`: landscape 3 of a population file.
    File(PathBuf, Landscape),
}

impl Reference {
    /// Reads the landscape, and says which generation it is of; none for a file that is not the world's.
    ///
    /// # Errors
    /// Faults of its population file.
    pub fn find(&self, world: &World, space: &Space) -> Result<(Option<u32>, Individual), WorldError> {
        let (file, landscape) = match self {
            Self::Current(landscape) => (world.population(space, current(world)?)?, landscape),
            Self::Of(generation, landscape) => (world.population(space, *generation)?, landscape),
            Self::File(path, landscape) => (World::read_population(space, path)?, landscape),
        };
        let PopulationFile { population, .. } = file;
        let is_of_world = !matches!(self, Self::File(..));
        let individual = population.individuals[landscape.index()].clone();
        Ok((is_of_world.then_some(population.generation), individual))
    }
}

/// A parent that a person names: a landscape, or a kind of which a member is drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParentArg {
    Landscape(Reference),
    Kind(String),
}

impl FromStr for ParentArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_word = text.starts_with(|c: char| c.is_alphabetic()) && !text.contains(['.', ':', '/', '\\']);
        match text.parse() {
            Ok(reference) => Ok(Self::Landscape(reference)),
            Err(_) if is_word => Ok(Self::Kind(text.to_owned())),
            Err(error) => Err(format!("{error}; or it is a kind, as oak")),
        }
    }
}

/// The generation that was baked last or, where that is gone or nothing was baked, the newest.
///
/// # Errors
/// A folder that cannot be read, a world without landscapes.
pub fn current(world: &World) -> Result<u32, WorldError> {
    let generations = world.generations()?;
    let current = world.current()?.map(|current| current.generation);
    let known = current.filter(|current| generations.contains(current));
    known.or(generations.last().copied()).ok_or_else(|| WorldError::NoPopulation(world.root().to_owned()))
}

impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Current(landscape) => write!(f, "{landscape}"),
            Self::Of(generation, landscape) => write!(f, "{generation}.{landscape}"),
            Self::File(path, landscape) => write!(f, "{}:{landscape}", path.display()),
        }
    }
}

impl FromStr for Reference {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_number = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
        if text.parse::<i64>().is_ok() {
            return text.parse().map(Self::Current);
        }
        if let Some((path, landscape)) =
            text.rsplit_once(':').filter(|(path, n)| !path.is_empty() && is_number(n))
        {
            return Ok(Self::File(path.into(), landscape.parse()?));
        }
        match text.split_once('.') {
            Some((generation, landscape)) if is_number(generation) && is_number(landscape) => {
                let number =
                    generation.parse().map_err(|_| format!("there is no generation {generation}"))?;
                Ok(Self::Of(number, landscape.parse()?))
            }
            _ if text.ends_with(".ron") => Err(format!("say which of its four landscapes, as {text}:1")),
            _ => Err("a landscape is 3, or 2.3 of generation 2, or old.ron:3 of a population file".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_reference_is_read_as_it_is_written(
            generation in any::<u32>(), landscape in 0usize..4, path in "[a-z/.:]{0,9}[a-z][.]ron"
        ) {
            let landscape = Landscape(landscape);
            for reference in [
                Reference::Current(landscape),
                Reference::Of(generation, landscape),
                Reference::File(path.into(), landscape),
            ] {
                prop_assert_eq!(reference.to_string().parse(), Ok(reference));
            }
        }

        #[test]
        fn no_text_upsets_it(text in any::<String>()) {
            let _ = text.parse::<Reference>();
        }
    }

    #[test]
    fn a_word_is_a_kind() {
        assert_eq!("fjord".parse(), Ok(ParentArg::Kind("fjord".into())));
        assert_eq!("2.3".parse(), "2.3".parse().map(ParentArg::Landscape));
        for wrong in ["7", "a.b", "old.ron", "c:\\old.ron", "", "-x"] {
            assert!(wrong.parse::<ParentArg>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_no_landscape_is_told_with_what_would_be() {
        for (wrong, told) in [
            ("0", "1 to 4"),
            ("5", "1 to 4"),
            ("-1", "1 to 4"),
            ("2.5", "1 to 4"),
            ("old.ron", "old.ron:1"),
            ("old.ron:7", "1 to 4"),
            ("99999999999.1", "no generation"),
            ("oak", "2.3"),
            ("", "2.3"),
        ] {
            let error = wrong.parse::<Reference>().expect_err(wrong);
            assert!(error.contains(told), "{wrong}: {error}");
        }
    }

    #[test]
    fn landscapes_are_counted_from_one() {
        assert_eq!("1".parse().map(Landscape::index), Ok(0));
        assert!(Landscape::all().all(|landscape| landscape.to_string().parse() == Ok(landscape)));
        for wrong in ["0", "5", "-1", "99999999999999999999", "one", ""] {
            assert_eq!(wrong.parse::<Landscape>(), Err("there are landscapes 1 to 4".into()), "{wrong}");
        }
        assert_eq!("4".parse(), Ok(SceneArg::Current(Landscape(3))));
        assert_eq!("0".parse::<SceneArg>(), Err("there are landscapes 1 to 4".into()));
        assert_eq!("a/scene.gltf".parse(), Ok(SceneArg::File("a/scene.gltf".into())));
    }
}
