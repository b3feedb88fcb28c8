//! Denavit-Hartenberg tables of every robot of the data, out of its model: their product is the model's forward
//! kinematics (S4.3).
#![allow(clippy::print_stdout)]

mod common;

use elbowroom_formats::robot;
use elbowroom_kinematics::dh::{DirectTable, ModifiedTable, Table};
use elbowroom_kinematics::frames::Frames;
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Pose;

const STATES: usize = 200;

/// Joint values of an additive recurrence, within a turn.
fn spread(chain: &Chain, index: usize) -> Vec<f64> {
    let at = |i: usize| (0.5 + 0.618_033_988_75 * index as f64 + 0.137 * (i * (index + 1)) as f64).fract();
    (0..chain.dof()).map(|i| std::f64::consts::TAU * (at(i) - 0.5)).collect()
}

fn difference(a: &Pose, b: &Pose) -> f64 {
    let pairs = a.to_rows().into_iter().flatten().zip(b.to_rows().into_iter().flatten());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, |w, d| if d > w || d.is_nan() { d } else { w })
}

/// Largest difference from forward kinematics at the link: generalized, direct, modified, frames.
fn worst(chain: &Chain, tip: LinkId) -> [f64; 4] {
    let (generalized, direct) = (Table::extract(chain, tip), DirectTable::extract(chain, tip));
    let (modified, frames) = (ModifiedTable::extract(chain, tip), Frames::extract(chain, tip));
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
    let Some(data) = common::data() else { return };
    let mut robots = 0;
    for directory in ["urdf", "cell"] {
        for path in common::files_below(&data.join(directory)) {
            if path.extension().is_none_or(|e| e != "urdf") || path.to_string_lossy().ends_with(".package.urdf") {
                continue;
            }
            // Some name meshes that are not there: only the joints count here.
            let Ok(model) = elbowroom_formats::urdf::parse(&std::fs::read(&path).unwrap(), &path) else { continue };
            let chain = robot::chain(&model, &path).unwrap();
            check(&path.strip_prefix(&data).unwrap().display().to_string(), &chain);
            robots += 1;
        }
    }
    assert!(robots >= 35, "{robots}");
}
