//! Edits of a configuration by users of an access class.

use crate::{AccessClass, Configuration, Region};

/// An edit of a configuration.
#[derive(Debug, Clone)]
pub enum ConfigurationEdit {
    /// Adds a region.
    Add(Box<Region>),
    /// Replaces the region with the same name.
    Change(Box<Region>),
    /// Removes the region with this name.
    Remove(String),
    /// Replaces the laws.
    Laws(crate::Laws),
}

/// Why an edit was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The access class is too low.
    #[error("{what} needs the {needed:?} class, not {who:?}")]
    Class {
        /// The change.
        what: String,
        /// The class of the caller.
        who: AccessClass,
        /// The lowest class that is allowed.
        needed: AccessClass,
    },
    /// No region has this name.
    #[error("there is no region `{0}`")]
    Unknown(String),
    /// A region with this name exists already.
    #[error("there is a region `{0}` already")]
    Exists(String),
    /// The edited configuration would be invalid.
    #[error(transparent)]
    Config(#[from] crate::ConfigError),
}

impl Configuration {
    /// Applies an edit on behalf of an access class. A refused edit changes nothing.
    ///
    /// # Errors
    /// [`EditError`] states the reason.
    pub fn edit(&mut self, who: AccessClass, edit: ConfigurationEdit) -> Result<(), EditError> {
        let mut changed = self.clone();
        match edit {
            ConfigurationEdit::Add(region) => {
                require(
                    who,
                    region.life.needed_class(),
                    format!("adding {} region `{}`", region.life.name(), region.name),
                )?;
                if changed.region(&region.name).is_some() {
                    return Err(EditError::Exists(region.name));
                }
                changed.regions.push(*region);
            }
            ConfigurationEdit::Change(region) => {
                let at = changed.index_of(&region.name)?;
                let (from, to) = (changed.regions[at].life, region.life);
                let what = if from == to {
                    format!("changing {} region `{}`", from.name(), region.name)
                } else {
                    format!("making {} region `{}` {}", from.name(), region.name, to.name())
                };
                require(who, from.needed_class().max(to.needed_class()), what)?;
                changed.regions[at] = *region;
            }
            ConfigurationEdit::Remove(name) => {
                let at = changed.index_of(&name)?;
                let life = changed.regions[at].life;
                require(who, life.needed_class(), format!("removing {} region `{name}`", life.name()))?;
                changed.regions.remove(at);
            }
            ConfigurationEdit::Laws(laws) => {
                require(who, AccessClass::Integrator, "changing the laws".into())?;
                changed.laws = laws;
            }
        }
        changed.validate()?;
        *self = changed;
        Ok(())
    }

    fn index_of(&self, name: &str) -> Result<usize, EditError> {
        self.region(name).map(|id| id.0).ok_or_else(|| EditError::Unknown(name.into()))
    }
}

fn require(who: AccessClass, needed: AccessClass, what: String) -> Result<(), EditError> {
    if who >= needed { Ok(()) } else { Err(EditError::Class { what, who, needed }) }
}
