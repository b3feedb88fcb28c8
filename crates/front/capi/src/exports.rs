//! The functions that C calls. `include/elbowroom.h` documents them; a test compares it with this file.
#![allow(unsafe_code, reason = "names for C are exported by an unsafe attribute, and texts and arrays are pointers")]
#![allow(clippy::missing_safety_doc, reason = "what C must keep is said once, at the top of the header")]

use std::ffi::{CString, c_char, c_int};
use std::mem::MaybeUninit;

use elbowroom::formats::robot::LoadOptions;
use elbowroom::query::QueryKind;

use crate::checker::{StateChecker, metres};
use crate::failure::{Failure, Status, VERSION, guarded, last_error};
use crate::model::{ModelHandle, RobotSource, at, unit};
use crate::raw::{optional_text, places, text, values};
use crate::records::{Answer, LevelCode, PoseRecord, RobotFile};

/// A place for a result; `None` is NULL.
type Out<'p, T> = Option<&'p mut MaybeUninit<T>>;

fn write<T>(place: Out<'_, T>, name: &str, value: T) -> Result<(), Failure> {
    place.ok_or_else(|| Failure::null(name))?.write(value);
    Ok(())
}

/// Makes a handle; on an error the place of the handle is NULL.
fn make<T>(place: Out<'_, Option<Box<T>>>, name: &str, load: impl FnOnce() -> Result<T, Failure>) -> Status {
    guarded(|| {
        let place = place.ok_or_else(|| Failure::null(name))?;
        let handle = place.write(None);
        *handle = Some(Box::new(load()?));
        Ok(())
    })
}

fn known(model: Option<&ModelHandle>) -> Result<&crate::model::Model, Failure> {
    Ok(&model.ok_or_else(|| Failure::null("model"))?.0)
}

fn write_name(place: Out<'_, *const c_char>, name: &CString) -> Result<(), Failure> {
    write(place, "name", name.as_ptr())
}

/// Asks a checker; on an error the answer says "collides".
fn ask(
    checker: Option<&mut StateChecker>,
    answer: Out<'_, Answer>,
    kind: impl FnOnce() -> Result<QueryKind, Failure>,
) -> Status {
    guarded(|| {
        let answer = answer.ok_or_else(|| Failure::null("answer"))?.write(Answer::UNKNOWN);
        StateChecker::call(checker, |checker| {
            *answer = checker.answer(kind()?);
            Ok(())
        })
    })
}

/// The version of the library.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_version() -> *const c_char {
    VERSION.as_ptr()
}

/// The text of the last call that failed on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_last_error() -> *const c_char {
    last_error()
}

/// Loads a cell file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_load_cell(
    path: *const c_char,
    regions: *const c_char,
    model: Out<'_, Option<Box<ModelHandle>>>,
) -> Status {
    make(model, "model", || {
        // SAFETY: texts of the caller, by the rules of the header.
        let (path, regions) = unsafe { (text(path, "path")?, optional_text(regions, "regions")?) };
        ModelHandle::load_cell(path, regions)
    })
}

/// Loads one robot at the origin of the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_load_robot(
    path: *const c_char,
    srdf: *const c_char,
    pairs: *const c_char,
    model: Out<'_, Option<Box<ModelHandle>>>,
) -> Status {
    make(model, "model", || {
        // SAFETY: texts of the caller, by the rules of the header.
        let (path, pairs) = unsafe { (text(path, "path")?, optional_text(pairs, "pairs")?) };
        // SAFETY: as above.
        let srdf = unsafe { optional_text(srdf, "srdf") }?.map(Into::into);
        ModelHandle::load_robot(path, &LoadOptions { srdf, ..LoadOptions::default() }, pairs)
    })
}

/// Loads several robots.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_load_robots(
    robots: *const RobotFile,
    count: usize,
    pairs: *const c_char,
    model: Out<'_, Option<Box<ModelHandle>>>,
) -> Status {
    make(model, "model", || {
        // SAFETY: array and text of the caller, by the rules of the header.
        let (files, pairs) = unsafe { (values(robots, count, "robots")?, optional_text(pairs, "pairs")?) };
        // SAFETY: the texts of the array, by the same rules.
        let sources: Result<Vec<_>, _> = files.iter().map(|file| unsafe { source(file) }).collect();
        ModelHandle::load_robots(&sources?, pairs)
    })
}

/// # Safety
/// The texts are NULL, or texts with a NUL at their end that nobody changes while the file is borrowed.
unsafe fn source(file: &RobotFile) -> Result<RobotSource<'_>, Failure> {
    // SAFETY: the caller's promise.
    let (name, path) = unsafe { (text(file.name, "name")?, text(file.path, "path")?) };
    // SAFETY: the caller's promise.
    let [srdf, joints, symbol] = unsafe {
        [optional_text(file.srdf, "srdf")?, optional_text(file.joints, "joints")?, optional_text(file.unit, "unit")?]
    };
    let options = LoadOptions {
        srdf: srdf.map(Into::into),
        joints: joints.map(Into::into),
        unit: symbol.map(unit).transpose()?,
        ..LoadOptions::default()
    };
    Ok(RobotSource { name, path, options, base_in_world: file.base_in_world.pose(name)? })
}

/// Frees a model.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_free(model: Option<Box<ModelHandle>>) {
    guarded(|| {
        drop(model);
        Ok(())
    });
}

/// Number of warnings of the files.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_warning_count(model: Option<&ModelHandle>, count: Out<'_, usize>) -> Status {
    guarded(|| write(count, "count", known(model)?.warnings.len()))
}

/// The text of a warning.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_warning(
    model: Option<&ModelHandle>,
    warning: usize,
    text: Out<'_, *const c_char>,
) -> Status {
    guarded(|| write(text, "text", at("warning", &known(model)?.warnings, warning)?.as_ptr()))
}

/// Number of robots.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_robot_count(model: Option<&ModelHandle>, count: Out<'_, usize>) -> Status {
    guarded(|| write(count, "count", known(model)?.names.robots.len()))
}

/// The name of a robot.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_robot_name(
    model: Option<&ModelHandle>,
    robot: usize,
    name: Out<'_, *const c_char>,
) -> Status {
    guarded(|| write_name(name, &known(model)?.robot(robot)?.name))
}

/// Index of the robot with a name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_find_robot(
    model: Option<&ModelHandle>,
    name: *const c_char,
    robot: Out<'_, usize>,
) -> Status {
    // SAFETY: a text of the caller, by the rules of the header.
    guarded(|| write(robot, "robot", known(model)?.find_robot(unsafe { text(name, "name") }?)?))
}

/// Number of independent joints of a robot.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_joint_count(
    model: Option<&ModelHandle>,
    robot: usize,
    count: Out<'_, usize>,
) -> Status {
    guarded(|| write(count, "count", known(model)?.robot(robot)?.joints.len()))
}

/// The name of a joint.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_joint_name(
    model: Option<&ModelHandle>,
    robot: usize,
    joint: usize,
    name: Out<'_, *const c_char>,
) -> Status {
    guarded(|| write_name(name, at("joint", &known(model)?.robot(robot)?.joints, joint)?))
}

/// The limits of all joints of a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_joint_limits(
    model: Option<&ModelHandle>,
    robot: usize,
    lower: *mut f64,
    upper: *mut f64,
    count: usize,
) -> Status {
    guarded(|| {
        let (lower_q, upper_q) = known(model)?.limits(robot)?;
        // SAFETY: arrays of the caller, by the rules of the header.
        unsafe {
            copy(&lower_q, lower, count, "lower")?;
            copy(&upper_q, upper, count, "upper")
        }
    })
}

/// The joint values of a robot at its start.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_start(
    model: Option<&ModelHandle>,
    robot: usize,
    q: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: an array of the caller, by the rules of the header.
    guarded(|| unsafe { copy(known(model)?.start(robot)?, q, count, "q") })
}

/// # Safety
/// `first` is NULL, or the first of `count` places that nobody else uses.
unsafe fn copy(from: &[f64], first: *mut f64, count: usize, name: &str) -> Result<(), Failure> {
    if count != from.len() {
        let expected = from.len();
        return Err(Failure::invalid(format!("`{name}` has {count} places\n  write: {expected}, one for each joint")));
    }
    // SAFETY: the caller's promise.
    let places = unsafe { places(first, count, name) }?;
    places.iter_mut().zip(from).for_each(|(place, value)| _ = place.write(*value));
    Ok(())
}

/// Number of links of a robot.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_link_count(
    model: Option<&ModelHandle>,
    robot: usize,
    count: Out<'_, usize>,
) -> Status {
    guarded(|| write(count, "count", known(model)?.robot(robot)?.links.len()))
}

/// The name of a link.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_link_name(
    model: Option<&ModelHandle>,
    robot: usize,
    link: usize,
    name: Out<'_, *const c_char>,
) -> Status {
    guarded(|| write_name(name, at("link", &known(model)?.robot(robot)?.links, link)?))
}

/// Index of the link with a name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_model_find_link(
    model: Option<&ModelHandle>,
    robot: usize,
    name: *const c_char,
    link: Out<'_, usize>,
) -> Status {
    // SAFETY: a text of the caller, by the rules of the header.
    guarded(|| write(link, "link", known(model)?.find_link(robot, unsafe { text(name, "name") }?)?))
}

/// Number of objects.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_object_count(model: Option<&ModelHandle>, count: Out<'_, usize>) -> Status {
    guarded(|| write(count, "count", known(model)?.names.objects.len()))
}

/// The name of an object.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_model_object_name(
    model: Option<&ModelHandle>,
    object: usize,
    name: Out<'_, *const c_char>,
) -> Status {
    guarded(|| write_name(name, at("object", &known(model)?.names.objects, object)?))
}

/// Creates a checker.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_checker_new(
    model: Option<&ModelHandle>,
    level: c_int,
    between: *const c_char,
    checker: Out<'_, Option<Box<StateChecker>>>,
) -> Status {
    make(checker, "checker", || {
        let model = model.ok_or_else(|| Failure::null("model"))?;
        // SAFETY: a text of the caller, by the rules of the header.
        let between = unsafe { optional_text(between, "between") }?;
        StateChecker::new(model, LevelCode::level(level)?, between)
    })
}

/// Frees a checker.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_free(checker: Option<Box<StateChecker>>) {
    guarded(|| {
        drop(checker);
        Ok(())
    });
}

/// Forgets what earlier answers taught.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_restart(checker: Option<&mut StateChecker>) -> Status {
    guarded(|| {
        StateChecker::call(checker, |checker| {
            checker.restart();
            Ok(())
        })
    })
}

/// Moves a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_checker_set_q(
    checker: Option<&mut StateChecker>,
    robot: usize,
    q: *const f64,
    count: usize,
) -> Status {
    // SAFETY: an array of the caller, by the rules of the header.
    guarded(|| StateChecker::call(checker, |checker| checker.set_q(robot, unsafe { values(q, count, "q") }?)))
}

/// The pose of a link in the world.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_link_pose(
    checker: Option<&mut StateChecker>,
    robot: usize,
    link: usize,
    pose: Out<'_, PoseRecord>,
) -> Status {
    guarded(|| StateChecker::call(checker, |checker| write(pose, "pose", checker.link_pose(robot, link)?)))
}

/// Whether a pair is in contact.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_collision(checker: Option<&mut StateChecker>, answer: Out<'_, Answer>) -> Status {
    ask(checker, answer, || Ok(QueryKind::Collision))
}

/// The nearest pair.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_distance(checker: Option<&mut StateChecker>, answer: Out<'_, Answer>) -> Status {
    ask(checker, answer, || Ok(QueryKind::Distance))
}

/// Whether a pair is within a tolerance.
#[unsafe(no_mangle)]
pub extern "C" fn elbowroom_checker_within(
    checker: Option<&mut StateChecker>,
    tolerance_m: f64,
    answer: Out<'_, Answer>,
) -> Status {
    ask(checker, answer, || Ok(QueryKind::Tolerance(metres(tolerance_m, "tolerance_m")?)))
}

/// All pairs within a margin.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn elbowroom_checker_all_pairs(
    checker: Option<&mut StateChecker>,
    margin_m: f64,
    answers: *mut Answer,
    capacity: usize,
    count: Out<'_, usize>,
) -> Status {
    guarded(|| {
        StateChecker::call(checker, |checker| {
            let count = count.ok_or_else(|| Failure::null("count"))?;
            // SAFETY: an array of the caller, by the rules of the header.
            let places = unsafe { places(answers, capacity, "answers") }?;
            checker.answers_within(metres(margin_m, "margin_m")?, places, count)
        })
    })
}
