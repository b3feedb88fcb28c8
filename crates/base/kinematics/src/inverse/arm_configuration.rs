//! Branches of inverse kinematics of six axes with a spherical wrist: shoulder, elbow, wrist.

use std::fmt;

/// The side of axis 1 on which the wrist centre is. The front is the side of axis 2; if axis 2 meets axis 1, it is
/// the direction `axis 2 × axis 1` of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shoulder {
    /// In front of axis 1.
    Front,
    /// Behind axis 1: the arm reaches over itself.
    Back,
}

/// The side of the line from axis 2 to the wrist centre on which axis 3 is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Elbow {
    /// Above the line, away from the base, if the wrist is in front and level. The name is kept when the arm turns over
    /// to the back.
    Up,
    /// Below the line.
    Down,
}

/// The side of its straight position to which axis 5 is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrist {
    /// To positive joint values. The straight position is the one nearest the middle of the joint's range.
    NoFlip,
    /// To negative joint values.
    Flip,
}

/// The branch of inverse kinematics that joint values belong to: one of eight, which meet at the singularities of
/// the arm.
///
/// ```
/// use elbowroom_kinematics::inverse::{ArmConfiguration, Elbow, Shoulder, Wrist};
/// let configuration = ArmConfiguration { shoulder: Shoulder::Front, elbow: Elbow::Up, wrist: Wrist::NoFlip };
/// assert_eq!(configuration.to_string(), "front up no_flip");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ArmConfiguration {
    /// Front or back.
    pub shoulder: Shoulder,
    /// Up or down.
    pub elbow: Elbow,
    /// Flip or not.
    pub wrist: Wrist,
}

impl fmt::Display for ArmConfiguration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shoulder = match self.shoulder {
            Shoulder::Front => "front",
            Shoulder::Back => "back",
        };
        let elbow = match self.elbow {
            Elbow::Up => "up",
            Elbow::Down => "down",
        };
        let wrist = match self.wrist {
            Wrist::NoFlip => "no_flip",
            Wrist::Flip => "flip",
        };
        write!(f, "{shoulder} {elbow} {wrist}")
    }
}

/// The wanted branches; `None` accepts either side.
///
/// ```
/// use elbowroom_kinematics::inverse::{ConfigurationChoice, Elbow, Wrist};
/// let choice = ConfigurationChoice::from_words(["up", "flip"])?;
/// assert_eq!((choice.shoulder, choice.elbow, choice.wrist), (None, Some(Elbow::Up), Some(Wrist::Flip)));
/// assert_eq!(choice.to_string(), "up flip");
/// assert!(ConfigurationChoice::from_words(["up", "down"]).is_err());
/// # Ok::<(), elbowroom_kinematics::inverse::ConfigurationWordError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ConfigurationChoice {
    /// The side of the wrist centre.
    pub shoulder: Option<Shoulder>,
    /// The side of axis 3.
    pub elbow: Option<Elbow>,
    /// The bend of axis 5.
    pub wrist: Option<Wrist>,
}

/// Why words do not name a configuration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigurationWordError {
    /// The word is unknown.
    #[error("\"{0}\" is no word of a configuration: front or back, up or down, no_flip or flip")]
    Unknown(String),
    /// The word is the second one for the same part.
    #[error(
        "\"{0}\" contradicts or repeats another word: one of front and back, one of up and down, one of no_flip and flip"
    )]
    Twice(String),
}

impl ConfigurationChoice {
    /// All words of a configuration.
    pub const WORDS: [&str; 6] = ["front", "back", "up", "down", "no_flip", "flip"];

    /// Builds a choice from words of [`Self::WORDS`], at most one for each part.
    ///
    /// # Errors
    /// [`ConfigurationWordError`] for an unknown word, or a second word for a part.
    pub fn from_words<'w>(words: impl IntoIterator<Item = &'w str>) -> Result<Self, ConfigurationWordError> {
        let mut choice = Self::default();
        for word in words {
            let is_new = match word {
                "front" => choice.shoulder.replace(Shoulder::Front).is_none(),
                "back" => choice.shoulder.replace(Shoulder::Back).is_none(),
                "up" => choice.elbow.replace(Elbow::Up).is_none(),
                "down" => choice.elbow.replace(Elbow::Down).is_none(),
                "no_flip" => choice.wrist.replace(Wrist::NoFlip).is_none(),
                "flip" => choice.wrist.replace(Wrist::Flip).is_none(),
                _ => return Err(ConfigurationWordError::Unknown(word.to_owned())),
            };
            if !is_new {
                return Err(ConfigurationWordError::Twice(word.to_owned()));
            }
        }
        Ok(choice)
    }

    /// True if nothing is chosen.
    pub fn is_open(&self) -> bool {
        *self == Self::default()
    }

    /// True if the configuration matches everything that is chosen.
    pub fn admits(&self, configuration: &ArmConfiguration) -> bool {
        self.shoulder.is_none_or(|s| s == configuration.shoulder)
            && self.elbow.is_none_or(|e| e == configuration.elbow)
            && self.wrist.is_none_or(|w| w == configuration.wrist)
    }
}

impl fmt::Display for ConfigurationChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let any = ArmConfiguration { shoulder: Shoulder::Front, elbow: Elbow::Up, wrist: Wrist::NoFlip };
        let named = ArmConfiguration {
            shoulder: self.shoulder.unwrap_or(any.shoulder),
            elbow: self.elbow.unwrap_or(any.elbow),
            wrist: self.wrist.unwrap_or(any.wrist),
        };
        let chosen = [self.shoulder.is_some(), self.elbow.is_some(), self.wrist.is_some()];
        let text = named.to_string();
        let words: Vec<&str> = text.split(' ').zip(chosen).filter_map(|(word, is)| is.then_some(word)).collect();
        f.write_str(&words.join(" "))
    }
}
