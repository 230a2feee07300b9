//! Arguments made from a table of settings, so that no setting is described twice.

use std::marker::PhantomData;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

/// One setting as the command line shows it.
#[derive(Debug, Clone)]
pub struct Row {
    /// Name with `-` between words.
    pub name: String,
    /// Unit or form of the value.
    pub value: String,
    /// Meaning and range.
    pub help: String,
    /// Default value as text.
    pub default: String,
}

/// A table of settings that can become arguments.
pub trait SettingTable: Send + Sync + 'static {
    /// Heading in the help text.
    const HEADING: &'static str;

    /// The settings, in the order of the help text.
    fn rows() -> Vec<Row>;
}

/// The settings of `T` that the command line gives, by name.
pub struct Chosen<T> {
    values: Vec<(String, String)>,
    table: PhantomData<T>,
}

impl<T> Chosen<T> {
    /// Name and text of each given value, in the table's order.
    pub fn values(&self) -> impl Iterator<Item = (&str, &str)> {
        self.values.iter().map(|(n, v)| (n.as_str(), v.as_str()))
    }
}

impl<T> std::fmt::Debug for Chosen<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_map().entries(self.values()).finish()
    }
}

impl<T> Clone for Chosen<T> {
    fn clone(&self) -> Self {
        Self {
            values: self.values.clone(),
            table: PhantomData,
        }
    }
}

impl<T> Default for Chosen<T> {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            table: PhantomData,
        }
    }
}

/// Arguments of other origin may have the same name as a field: settings have their own prefix.
fn id<T: SettingTable>(name: &str) -> String {
    format!("{}.{name}", T::HEADING)
}

impl<T: SettingTable> Args for Chosen<T> {
    fn augment_args(command: Command) -> Command {
        T::rows().into_iter().fold(command, |command, row| {
            command.arg(
                Arg::new(id::<T>(&row.name))
                    .long(row.name)
                    .value_name(row.value)
                    .help(format!("{} [default: {}]", row.help, row.default))
                    .help_heading(T::HEADING)
                    .hide_short_help(true)
                    // Sun and camera angles may be below zero.
                    .allow_hyphen_values(true),
            )
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<T: SettingTable> FromArgMatches for Chosen<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut chosen = Self::default();
        chosen.update_from_arg_matches(matches)?;
        Ok(chosen)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for row in T::rows() {
            if let Some(value) = matches.get_one::<String>(&id::<T>(&row.name)) {
                self.values.push((row.name, value.clone()));
            }
        }
        Ok(())
    }
}
