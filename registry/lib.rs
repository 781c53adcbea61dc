//! Tables of built-in rows to which programs can add their own.
//!
//! A program registers its generators, rocks and targets before it reads recipes; from then on they are found by name wherever
//! the built-in ones are. Rows live as long as the program and are never removed, so a name keeps its meaning.
//!
//! ```
//! use plume_registry::{Named, Registry};
//!
//! struct Row(&'static str);
//!
//! impl Named for Row {
//!     fn name(&self) -> &'static str {
//!         self.0
//!     }
//! }
//!
//! static ROWS: Registry<Row> = Registry::new(&[Row("limestone"), Row("basalt")]);
//!
//! ROWS.register(Row("salt"))?;
//! assert_eq!(ROWS.iter().map(Row::name).collect::<Vec<_>>(), ["limestone", "basalt", "salt"]);
//! assert!(ROWS.register(Row("salt")).is_err());
//! # Ok::<(), plume_registry::RegisterError>(())
//! ```

use std::sync::{PoisonError, RwLock};

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};

/// The JSON schema of the settings of a row. It contains no references, so that it can be a part of another.
pub fn settings_schema<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<T>()
}

/// What rows are found by.
pub trait Named {
    /// The name in recipes and on the command line: lower case, words joined by hyphens.
    fn name(&self) -> &'static str;
}

/// Built-in rows, the default first, and those that the program has added.
#[derive(Debug)]
pub struct Registry<R: 'static> {
    built_in: &'static [R],
    added: RwLock<Vec<&'static R>>,
}

impl<R: Named> Registry<R> {
    /// A registry of built-in rows; there is at least one.
    pub const fn new(built_in: &'static [R]) -> Self {
        assert!(!built_in.is_empty());
        Self { built_in, added: RwLock::new(Vec::new()) }
    }

    /// All rows: the built-in ones, then the added ones in the order in which they were registered.
    pub fn iter(&self) -> impl Iterator<Item = &'static R> + Clone + use<R> {
        let added = self.added.read().unwrap_or_else(PoisonError::into_inner).clone();
        self.built_in.iter().chain(added)
    }

    /// The names to tell about where `name` is asked for. One that is there gets the built-in ones and itself, so that what is
    /// written of it does not depend on what else a program has registered; one that is not gets all.
    pub fn names_for(&self, name: &str) -> Vec<&'static str> {
        let known = self.find(name).is_some();
        let is_told =
            |row: &&R| !known || row.name() == name || self.built_in.iter().any(|own| own.name() == row.name());
        self.iter().filter(is_told).map(R::name).collect()
    }

    /// The row that is taken when none is named.
    pub fn default_row(&self) -> &'static R {
        &self.built_in[0]
    }

    /// The row called `name`.
    pub fn find(&self, name: &str) -> Option<&'static R> {
        self.iter().find(|row| row.name() == name)
    }

    /// Adds a row for as long as the program runs.
    ///
    /// # Errors
    /// When the name is taken, or is not made of lower-case letters, digits and hyphens.
    pub fn register(&self, row: R) -> Result<(), RegisterError> {
        let name = row.name();
        let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(RegisterError::Name(name));
        }
        let mut added = self.added.write().unwrap_or_else(PoisonError::into_inner);
        if self.built_in.iter().chain(added.iter().copied()).any(|other| other.name() == name) {
            return Err(RegisterError::Taken(name));
        }
        added.push(Box::leak(Box::new(row)));
        Ok(())
    }
}

/// A row could not be registered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RegisterError {
    /// Another row has its name.
    #[error("the name {0:?} is already taken")]
    Taken(&'static str),
    /// Its name cannot be written in recipes.
    #[error("{0:?} is not a name: use lower-case letters, digits and hyphens")]
    Name(&'static str),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    struct Row(&'static str);

    impl Named for Row {
        fn name(&self) -> &'static str {
            self.0
        }
    }

    #[test]
    fn rows_are_found_by_names_that_are_unique() {
        let rows = Registry::new(const { &[Row("mine"), Row("karst")] });
        assert_eq!(rows.register(Row("maze-2")), Ok(()));
        assert_eq!(rows.register(Row("karst")), Err(RegisterError::Taken("karst")));
        assert_eq!(rows.register(Row("maze-2")), Err(RegisterError::Taken("maze-2")));
        for name in ["", "Maze", "a b", "a_b", "a:b"] {
            assert_eq!(rows.register(Row(name)), Err(RegisterError::Name(name)));
        }
        assert_eq!(rows.iter().collect::<Vec<_>>(), [&Row("mine"), &Row("karst"), &Row("maze-2")]);
        assert_eq!((rows.find("maze-2"), rows.find("maze")), (Some(&Row("maze-2")), None));
        assert_eq!(rows.default_row(), &Row("mine"));
        assert_eq!(rows.register(Row("shaft")), Ok(()));
        assert_eq!(rows.names_for("karst"), ["mine", "karst"]);
        assert_eq!(rows.names_for("shaft"), ["mine", "karst", "shaft"]);
        assert_eq!(rows.names_for("maze"), ["mine", "karst", "maze-2", "shaft"]);
    }
}
