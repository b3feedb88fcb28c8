//! Denavit-Hartenberg tables of every robot of the data set, from URDF, 3DS and glTF models.
//!
//! The product of each table is the model's forward kinematics. The 3DS and glTF models have no tracks; the test writes a
//! joints file from the URDF.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};

use elbowroom_formats::joints;
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::dh::{DirectTable, GeneralizedTable, ModifiedTable};
use elbowroom_kinematics::frames::FrameChain;
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Pose;
use elbowroom_testkit::folder;

const STATES: usize = 200;

/// Joint values of an additive recurrence, within one turn.
fn spread(chain: &Chain, index: usize) -> Vec<f64> {
    let at = |i: usize| (0.5 + 0.618_033_988_75 * index as f64 + 0.137 * (i * (index + 1)) as f64).fract();
    (0..chain.dof()).map(|i| std::f64::consts::TAU * (at(i) - 0.5)).collect()
}

fn difference(a: &Pose, b: &Pose) -> f64 {
    let pairs = a.to_rows().into_iter().flatten().zip(b.to_rows().into_iter().flatten());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, |w, d| if d > w || d.is_nan() { d } else { w })
}

/// Largest difference from forward kinematics at the link, per table: generalized, direct, modified, frames.
fn worst(chain: &Chain, tip: LinkId) -> [f64; 4] {
    let (generalized, direct) = (GeneralizedTable::extract(chain, tip), DirectTable::extract(chain, tip));
    let (modified, frames) = (ModifiedTable::extract(chain, tip), FrameChain::extract(chain, tip));
    let mut state = ChainState::new(chain);
    let mut worst = [0.0_f64; 4];
    for index in 0..STATES {
        state.q.copy_from_slice(&spread(chain, index));
        chain.forward(&mut state);
        let value = |name: &str| chain.joint_value(chain.joint(name).unwrap(), &state.q);
        let expected = state.link_in_root(tip);
        let products = [
            generalized.tip_in_root(value),
            direct.table.tip_in_root(value),
            modified.tip_in_root(value),
            frames.tip_in_root(value),
        ];
        for (w, product) in worst.iter_mut().zip(products) {
            let d = difference(&product, &expected);
            *w = if d.is_nan() { d } else { w.max(d) };
        }
    }
    worst
}

fn check(name: &str, chain: &Chain) {
    let mut largest = [0.0_f64; 4];
    for tip in chain.leaves() {
        let worst = worst(chain, tip);
        assert!(worst[..3].iter().all(|w| *w < 1e-9) && worst[3] < 1e-12, "{name}: {worst:?}");
        for (l, w) in largest.iter_mut().zip(worst) {
            *l = l.max(w);
        }
    }
    let [g, d, m, f] = largest;
    println!("{name}: generalized {g:.1e}, direct {d:.1e}, modified {m:.1e}, frames {f:.1e}");
}

#[test]
fn every_urdf_has_its_tables() {
    let Some(data) = folder::data() else { return };
    let mut robots = 0;
    for directory in ["urdf", "cell"] {
        for path in folder::files_below(&data.join(directory)) {
            if path.extension().is_none_or(|e| e != "urdf") || path.to_string_lossy().ends_with(".package.urdf") {
                continue;
            }
            // Some models refer to missing meshes; only the joints are needed here.
            let Ok(model) = elbowroom_formats::urdf::parse(&std::fs::read(&path).unwrap(), &path) else { continue };
            let chain = robot::chain(&model, &path).unwrap();
            check(&path.strip_prefix(&data).unwrap().display().to_string(), &chain);
            robots += 1;
        }
    }
    assert!(robots >= 35, "{robots}");
}

#[test]
fn derived_3ds_and_glb_models_have_the_tables_of_their_urdf() {
    let Some(data) = folder::data() else { return };
    for name in ["comau_ns16arc", "staubli_rx160"] {
        let urdf = chain_of(&data.join(format!("urdf/{name}/{name}.urdf")), None);
        let side = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(side.path(), joints::to_toml(&urdf)).unwrap();
        for kind in ["3ds", "glb"] {
            let path = data.join(format!("mesh/derived_{name}/{name}.{kind}"));
            let chain = chain_of(&path, Some(side.path().to_owned()));
            assert_eq!(chain.dof(), 6, "{}", path.display());
            check(&format!("{name}.{kind}"), &chain);
            same_robot(&urdf, &chain);
        }
    }
}

fn chain_of(path: &Path, joints: Option<PathBuf>) -> Chain {
    robot::load(path, &LoadOptions { joints, ..LoadOptions::default() }).unwrap().robot.chain
}

/// Checks the pose of the last joint's link by the model's table against the URDF, within the single precision of the
/// files.
fn same_robot(urdf: &Chain, model: &Chain) {
    let last = urdf.joints()[urdf.active_joints()[5].0].child;
    let name = &urdf.links()[last.0];
    let table = GeneralizedTable::extract(model, model.link(name).unwrap());
    let mut state = ChainState::new(urdf);
    for index in 0..STATES {
        state.q.copy_from_slice(&spread(urdf, index));
        urdf.forward(&mut state);
        // Joints in the order of the path, whatever their names.
        let way: Vec<&str> = table.rows.iter().filter_map(|r| r.joint.as_deref()).collect();
        let value = |joint: &str| state.q[way.iter().position(|w| *w == joint).unwrap()];
        assert!(difference(&table.tip_in_root(value), &state.link_in_root(last)) < 1e-5);
    }
}

/// The KR150 of the examples, a 3DS file, unchanged and after writing and reading: its seven local frames (base and six
/// joints) are seven rows of the form of table 1 of Reichenbach and Kovačić 2003.
#[test]
fn the_kr150_of_the_examples_has_the_published_geometry() {
    let path = folder::examples().join("models/kr150/kr150.3ds");
    let loaded = robot::load(&path, &LoadOptions::default()).unwrap().robot;
    let dir = tempfile::tempdir().unwrap();
    let tds = dir.path().join("kr150.3ds");
    std::fs::write(&tds, elbowroom_formats::tds::write(&robot::to_tree(&loaded), &tds).unwrap()).unwrap();
    std::fs::write(joints::default_path(&tds), joints::to_toml(&loaded.chain)).unwrap();
    for (kind, chain) in [("as it is", loaded.chain.clone()), ("written again", chain_of(&tds, None))] {
        let last = loaded.chain.joints()[loaded.chain.active_joints()[5].0].child;
        let tip = chain.link(&loaded.chain.links()[last.0]).unwrap();
        let direct = DirectTable::extract(&chain, tip);
        println!("{kind}, residual {:.1e}\n{direct}\n", direct.table.residual);
        assert!(direct.table.residual < 1e-9);
        let joints: Vec<&str> = direct.table.rows.iter().filter_map(|r| r.joint.as_deref()).collect();
        assert_eq!(joints.len(), 6);
        assert_eq!(direct.frames[1..7], joints, "base, then a row for every joint");
        // The lengths of the KUKA KR150, each in any row.
        for length in [0.75, 0.35, 1.25, 0.055, 1.1] {
            let found = direct.table.rows.iter().flat_map(|r| [r.a, r.b, r.d]);
            assert!(found.into_iter().any(|v| (v.abs() - length).abs() < 1e-6), "{length} is not in the table");
        }
    }
}
