//! The plants the generator knows.

use super::parameters::Parameters;
use super::tables;
use crate::{Error, Result};

/// A kind of plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Species {
    /// A full-crowned broad-leaved tree between oak and beech.
    Broadleaf,
    /// A young lime with an egg-shaped crown.
    Lime,
    /// A spruce.
    Conifer,
    /// A shrub of many stems.
    Shrub,
}

impl Species {
    /// All species, in the order they are listed.
    pub const ALL: [Self; 4] = [Self::Broadleaf, Self::Lime, Self::Conifer, Self::Shrub];

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Broadleaf => "broadleaf",
            Self::Lime => "lime",
            Self::Conifer => "conifer",
            Self::Shrub => "shrub",
        }
    }

    /// One line for a list.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Broadleaf => "a full-crowned broad-leaved tree between oak and beech, about 12 m",
            Self::Lime => {
                "a young lime with an egg-shaped crown and heart-shaped leaves, about 8 m"
            }
            Self::Conifer => {
                "a spruce with whorled, drooping boughs and sprays of needles, about 13 m"
            }
            Self::Shrub => "a shrub of many stems with small elliptic leaves, about 2 m",
        }
    }

    /// The species of that name.
    ///
    /// # Errors
    /// An unknown name; the message lists the known ones.
    pub fn parse(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|s| s.name().eq_ignore_ascii_case(name))
            .ok_or_else(|| {
                let known: Vec<&str> = Self::ALL.iter().map(|s| s.name()).collect();
                Error::usage(format!(
                    "unknown species `{name}`; known: {}",
                    known.join(", ")
                ))
            })
    }

    /// Its table.
    #[must_use]
    pub fn parameters(self) -> Parameters {
        match self {
            Self::Broadleaf => tables::BROADLEAF,
            Self::Lime => tables::LIME,
            Self::Conifer => tables::CONIFER,
            Self::Shrub => tables::SHRUB,
        }
    }

    /// Height of the plant, smallest and largest, metres, leaves included.
    #[must_use]
    pub fn height(self) -> [f64; 2] {
        match self {
            Self::Broadleaf => [9.0, 14.5],
            Self::Lime => [6.0, 9.8],
            Self::Conifer => [11.0, 15.5],
            Self::Shrub => [1.3, 2.8],
        }
    }

    /// Width of the crown, smallest and largest, metres, leaves included.
    #[must_use]
    pub fn width(self) -> [f64; 2] {
        match self {
            Self::Broadleaf => [6.5, 14.0],
            Self::Lime => [3.0, 7.0],
            Self::Conifer => [3.5, 8.5],
            Self::Shrub => [1.5, 4.0],
        }
    }
}

impl std::fmt::Display for Species {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Species {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::parse(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_parse_and_tables_are_in_range() {
        for species in Species::ALL {
            assert_eq!(Species::parse(species.name()).unwrap(), species);
            species.parameters().check().unwrap();
        }
        let message = Species::parse("oak").unwrap_err().to_string();
        assert!(
            message.contains("oak") && message.contains("conifer"),
            "{message}"
        );
    }
}
