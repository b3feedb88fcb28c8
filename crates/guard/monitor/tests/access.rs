//! Configurations are validated when they are built, and each access class may make only its allowed edits.

use crate::common::{gantry, parts};
use elbowroom_monitor::{
    AccessClass, ConfigError, Configuration, ConfigurationEdit, ConfigurationParts, EditError, Laws, Life, Region,
};
use elbowroom_spatial::Vec3;

const CLASSES: [AccessClass; 3] = [AccessClass::Operator, AccessClass::Programmer, AccessClass::Integrator];

fn region(name: &str, life: Life) -> Region {
    Region::sphere(name, Vec3::X, 0.2).life(life)
}

fn both() -> ConfigurationParts {
    parts(gantry(), vec![], vec![region("wall", Life::Permanent), region("cart", Life::Temporary)])
}

fn larger(name: &str, life: Life) -> Box<Region> {
    Box::new(Region::sphere(name, Vec3::X, 0.3).life(life))
}

/// Every kind of edit, with the lowest class that may make it.
fn edits() -> Vec<(ConfigurationEdit, AccessClass)> {
    use AccessClass::{Integrator, Programmer};
    use Life::{Permanent, Temporary};
    vec![
        (ConfigurationEdit::Add(larger("new", Permanent)), Integrator),
        (ConfigurationEdit::Add(larger("new", Temporary)), Programmer),
        (ConfigurationEdit::Change(larger("wall", Permanent)), Integrator),
        (ConfigurationEdit::Change(larger("cart", Temporary)), Programmer),
        // A programmer may not make a permanent region temporary, or a temporary region permanent.
        (ConfigurationEdit::Change(larger("wall", Temporary)), Integrator),
        (ConfigurationEdit::Change(larger("cart", Permanent)), Integrator),
        (ConfigurationEdit::Remove("wall".into()), Integrator),
        (ConfigurationEdit::Remove("cart".into()), Programmer),
        (ConfigurationEdit::Laws(Laws { direction_aware: true, ..Laws::default() }), Integrator),
    ]
}

#[test]
fn every_class_and_every_edit() {
    for who in CLASSES {
        for (edit, lowest) in edits() {
            let mut configuration = Configuration::new(both()).unwrap();
            let before = configuration.checksum();
            let done = configuration.edit(who, edit.clone());
            let context = format!("{who:?} {edit:?}: {done:?}");
            if who >= lowest {
                assert!(done.is_ok() && configuration.checksum() != before, "{context}");
            } else {
                assert!(matches!(done, Err(EditError::Class { needed, .. }) if needed == lowest), "{context}");
                assert_eq!(configuration.checksum(), before, "{context}");
            }
        }
    }
}

#[test]
fn an_edit_to_an_invalid_configuration_changes_nothing() {
    let mut configuration = Configuration::new(both()).unwrap();
    let before = configuration.checksum();
    let mut edit = |edit| configuration.edit(AccessClass::Integrator, edit).unwrap_err();
    assert_eq!(edit(ConfigurationEdit::Remove("door".into())), EditError::Unknown("door".into()));
    assert_eq!(edit(ConfigurationEdit::Change(larger("door", Life::Permanent))), EditError::Unknown("door".into()));
    assert_eq!(edit(ConfigurationEdit::Add(larger("wall", Life::Permanent))), EditError::Exists("wall".into()));
    let inverted = Box::new(Region::sphere("inverted", Vec3::X, 0.2).warning(-0.1));
    assert!(matches!(edit(ConfigurationEdit::Add(inverted)), EditError::Config(ConfigError::Region { .. })));
    let never = Laws { stale_s: f64::INFINITY, ..Laws::default() };
    assert!(matches!(edit(ConfigurationEdit::Laws(never)), EditError::Config(ConfigError::Laws(_))));
    assert_eq!(configuration.checksum(), before);
}

#[test]
fn invalid_parts_are_refused() {
    let twice = vec![region("wall", Life::Permanent), region("wall", Life::Temporary)];
    let refused = Configuration::new(parts(gantry(), vec![], twice)).unwrap_err();
    assert_eq!(refused, ConfigError::DuplicateRegion("wall".into()));
    let laws = Laws { recovery: 2.0, ..Laws::default() };
    assert!(matches!(Configuration::new(ConfigurationParts { laws, ..both() }), Err(ConfigError::Laws(_))));
}
