//! A configuration is checked when it is built, and each class may edit what is its own and nothing else.

mod common;

use common::{gantry, parts};
use elbowroom_monitor::{
    AccessClass, ConfigError, Configuration, ConfigurationParts, Edit, EditError, Laws, Life, Region,
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

/// Every kind of edit, and the least class that may do it.
fn edits() -> Vec<(Edit, AccessClass)> {
    use AccessClass::{Integrator, Programmer};
    use Life::{Permanent, Temporary};
    vec![
        (Edit::Add(larger("new", Permanent)), Integrator),
        (Edit::Add(larger("new", Temporary)), Programmer),
        (Edit::Change(larger("wall", Permanent)), Integrator),
        (Edit::Change(larger("cart", Temporary)), Programmer),
        // Neither may a programmer make a permanent region temporary, nor a temporary one permanent.
        (Edit::Change(larger("wall", Temporary)), Integrator),
        (Edit::Change(larger("cart", Permanent)), Integrator),
        (Edit::Remove("wall".into()), Integrator),
        (Edit::Remove("cart".into()), Programmer),
        (Edit::Laws(Laws { direction_aware: true, ..Laws::default() }), Integrator),
    ]
}

#[test]
fn every_class_and_every_edit() {
    for who in CLASSES {
        for (edit, least) in edits() {
            let mut configuration = Configuration::new(both()).unwrap();
            let before = configuration.checksum();
            let done = configuration.edit(who, edit.clone());
            let context = format!("{who:?} {edit:?}: {done:?}");
            if who >= least {
                assert!(done.is_ok() && configuration.checksum() != before, "{context}");
            } else {
                assert!(matches!(done, Err(EditError::Class { needed, .. }) if needed == least), "{context}");
                assert_eq!(configuration.checksum(), before, "{context}");
            }
        }
    }
}

#[test]
fn an_edit_that_could_not_be_monitored_changes_nothing() {
    let mut configuration = Configuration::new(both()).unwrap();
    let before = configuration.checksum();
    let mut edit = |edit| configuration.edit(AccessClass::Integrator, edit).unwrap_err();
    assert_eq!(edit(Edit::Remove("door".into())), EditError::Unknown("door".into()));
    assert_eq!(edit(Edit::Change(larger("door", Life::Permanent))), EditError::Unknown("door".into()));
    assert_eq!(edit(Edit::Add(larger("wall", Life::Permanent))), EditError::Exists("wall".into()));
    let inverted = Box::new(Region::sphere("inverted", Vec3::X, 0.2).warning(-0.1));
    assert!(matches!(edit(Edit::Add(inverted)), EditError::Config(ConfigError::Region { .. })));
    let never = Laws { stale_s: f64::INFINITY, ..Laws::default() };
    assert!(matches!(edit(Edit::Laws(never)), EditError::Config(ConfigError::Laws(_))));
    assert_eq!(configuration.checksum(), before);
}

#[test]
fn parts_that_could_not_be_monitored_are_not_built() {
    let twice = vec![region("wall", Life::Permanent), region("wall", Life::Temporary)];
    let refused = Configuration::new(parts(gantry(), vec![], twice)).unwrap_err();
    assert_eq!(refused, ConfigError::DuplicateRegion("wall".into()));
    let laws = Laws { recovery: 2.0, ..Laws::default() };
    assert!(matches!(Configuration::new(ConfigurationParts { laws, ..both() }), Err(ConfigError::Laws(_))));
}
