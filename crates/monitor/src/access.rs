//! Who may do what (S1.12).

use crate::{Configuration, Life, Region};

/// Classes of users, each may do what those before it may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AccessClass {
    /// Looks; switches nothing.
    Operator,
    /// Switches temporary regions, and adds, changes and removes them. User programs are of this class.
    Programmer,
    /// May edit everything, permanent regions and laws included.
    Integrator,
}

impl AccessClass {
    /// From its word: `operator`, `programmer`, `integrator`.
    pub fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "operator" => Self::Operator,
            "programmer" => Self::Programmer,
            "integrator" => Self::Integrator,
            _ => return None,
        })
    }

    /// Its word, as [`parse`](Self::parse) reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Operator => "operator",
            Self::Programmer => "programmer",
            Self::Integrator => "integrator",
        }
    }

    /// The class that an edit of a region of this life needs.
    pub fn needed_for(life: Life) -> Self {
        match life {
            Life::Permanent => Self::Integrator,
            Life::Temporary => Self::Programmer,
        }
    }
}

/// Why a switch was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SwitchError {
    /// Permanent regions are always active.
    #[error("region `{0}` is permanent: no program can switch it; make it `life = \"temporary\"` to switch it")]
    Permanent(String),
    /// The class may not.
    #[error("region `{region}` can be switched by a {needed:?} or above, not by an {who:?}")]
    Class {
        /// The region.
        region: String,
        /// Who asked.
        who: AccessClass,
        /// The least class.
        needed: AccessClass,
    },
}

/// A change of a configuration.
#[derive(Debug, Clone)]
pub enum Edit {
    /// Adds a region.
    Add(Box<Region>),
    /// Replaces the region of the same name.
    Change(Box<Region>),
    /// Removes the region of this name.
    Remove(String),
    /// Replaces the laws.
    Laws(crate::Laws),
}

/// Why an edit was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The class may not.
    #[error("{what} needs the {needed:?} class, not {who:?}")]
    Class {
        /// The change.
        what: String,
        /// Who asked.
        who: AccessClass,
        /// The least class.
        needed: AccessClass,
    },
    /// There is no such region.
    #[error("there is no region `{0}`")]
    Unknown(String),
    /// There is one already.
    #[error("there is a region `{0}` already")]
    Exists(String),
    /// The result could not be monitored.
    #[error(transparent)]
    Config(#[from] crate::ConfigError),
}

impl Configuration {
    /// Applies an edit on behalf of a class. Nothing changes where it is refused.
    ///
    /// # Errors
    /// [`EditError`] says why.
    pub fn edit(&mut self, who: AccessClass, edit: Edit) -> Result<(), EditError> {
        let mut changed = self.clone();
        match edit {
            Edit::Add(region) => {
                allow(
                    who,
                    AccessClass::needed_for(region.life),
                    format!("adding {} region `{}`", region.life.name(), region.name),
                )?;
                if changed.region(&region.name).is_some() {
                    return Err(EditError::Exists(region.name));
                }
                changed.regions.push(*region);
            }
            Edit::Change(region) => {
                let at = changed.known(&region.name)?;
                let (from, to) = (changed.regions[at].life, region.life);
                let what = if from == to {
                    format!("changing {} region `{}`", from.name(), region.name)
                } else {
                    format!("making {} region `{}` {}", from.name(), region.name, to.name())
                };
                allow(who, AccessClass::needed_for(from).max(AccessClass::needed_for(to)), what)?;
                changed.regions[at] = *region;
            }
            Edit::Remove(name) => {
                let at = changed.known(&name)?;
                let life = changed.regions[at].life;
                allow(who, AccessClass::needed_for(life), format!("removing {} region `{name}`", life.name()))?;
                changed.regions.remove(at);
            }
            Edit::Laws(laws) => {
                allow(who, AccessClass::Integrator, "changing the laws".into())?;
                changed.laws = laws;
            }
        }
        changed.validate()?;
        *self = changed;
        Ok(())
    }

    fn known(&self, name: &str) -> Result<usize, EditError> {
        self.region(name).map(|id| id.0).ok_or_else(|| EditError::Unknown(name.into()))
    }
}

fn allow(who: AccessClass, needed: AccessClass, what: String) -> Result<(), EditError> {
    if who >= needed { Ok(()) } else { Err(EditError::Class { what, who, needed }) }
}
