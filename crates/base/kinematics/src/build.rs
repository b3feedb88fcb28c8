//! Construction of a checked chain from links and joints.

use std::collections::HashMap;

use crate::forward_step::ForwardStep;
use crate::{Chain, ChainError, Joint, JointCoupling, JointEnd, JointId, JointKind, LinkId};

impl Chain {
    /// Checks links and joints and builds a chain from them.
    ///
    /// Joints may be in any order. Axes are normalized, position limits of continuous joints are removed, and a mimic of
    /// a mimic is resolved to the independent joint.
    ///
    /// # Errors
    /// [`ChainError`] names the link or joint. Causes: no root or several roots, cycles, a link with two parents,
    /// unknown links, duplicate names, an axis without direction, limits out of order, mimics of unknown or fixed joints
    /// or of each other, and numbers that are not finite.
    pub fn new(name: impl Into<String>, links: Vec<String>, mut joints: Vec<Joint>) -> Result<Self, ChainError> {
        let link_by_name = index_names(&links, |name| ChainError::DuplicateLink { name })?;
        let joint_names = joints.iter().map(|j| &j.name);
        let joint_by_name = index_names(joint_names, |name| ChainError::DuplicateJoint { name })?;
        for joint in &mut joints {
            check_joint(joint, links.len())?;
        }
        let parent_joint = parents(&links, &joints)?;
        let root = single_root(&links, &parent_joint)?;
        let order = outwards(&links, &joints, root)?;
        let active: Vec<JointId> =
            (0..joints.len()).filter(|&i| joints[i].kind.moves() && joints[i].mimic.is_none()).map(JointId).collect();
        let couplings = (0..joints.len()).map(|i| coupling(&joints, &active, i)).collect::<Result<Vec<_>, _>>()?;
        let steps = order.iter().map(|&j| ForwardStep::new(&joints[j.0], couplings[j.0])).collect();
        Ok(Self {
            name: name.into(),
            link_by_name: link_by_name.into_iter().map(|(n, i)| (n, LinkId(i))).collect(),
            joint_by_name: joint_by_name.into_iter().map(|(n, i)| (n, JointId(i))).collect(),
            links,
            joints,
            root,
            parent_joint,
            order,
            active,
            couplings,
            steps,
        })
    }
}

fn index_names<'a>(
    names: impl IntoIterator<Item = &'a String>,
    duplicate: impl FnOnce(String) -> ChainError,
) -> Result<HashMap<String, usize>, ChainError> {
    let mut index = HashMap::new();
    for (i, name) in names.into_iter().enumerate() {
        if index.insert(name.clone(), i).is_some() {
            return Err(duplicate(name.clone()));
        }
    }
    Ok(index)
}

fn check_joint(joint: &mut Joint, links: usize) -> Result<(), ChainError> {
    for (end, link) in [(JointEnd::Parent, joint.parent), (JointEnd::Child, joint.child)] {
        if link.0 >= links {
            return Err(ChainError::UnknownLink { joint: joint.name.clone(), link: link.0, end, count: links });
        }
    }
    if !(joint.origin.translation.is_finite() && joint.origin.rotation.is_finite()) {
        return Err(ChainError::BadOrigin { joint: joint.name.clone() });
    }
    if joint.kind == JointKind::Fixed {
        joint.mimic = None;
        return Ok(());
    }
    let [x, y, z] = joint.axis.to_array();
    // An axis of length 1 within rounding stays as it is: a chain built from the joints of a chain is the same, bit by
    // bit.
    if !((joint.axis.length_squared() - 1.0).abs() <= 4.0 * f64::EPSILON) {
        joint.axis =
            joint.axis.try_normalize().ok_or_else(|| ChainError::BadAxis { joint: joint.name.clone(), x, y, z })?;
    }
    if joint.kind == JointKind::Continuous {
        joint.limits.lower = f64::NEG_INFINITY;
        joint.limits.upper = f64::INFINITY;
    }
    let (lower, upper) = (joint.limits.lower, joint.limits.upper);
    // A range of a single infinity contains no number.
    if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
        return Err(ChainError::BadLimits { joint: joint.name.clone(), lower, upper });
    }
    if let Some(tolerance) = joint.limits.overshoot_tolerance.filter(|t| !(t.is_finite() && *t >= 0.0)) {
        return Err(ChainError::BadOvershoot { joint: joint.name.clone(), tolerance });
    }
    match joint.mimic {
        Some(m) if !(m.multiplier.is_finite() && m.offset.is_finite()) => {
            Err(ChainError::BadMimic { joint: joint.name.clone(), multiplier: m.multiplier, offset: m.offset })
        }
        _ => Ok(()),
    }
}

fn parents(links: &[String], joints: &[Joint]) -> Result<Vec<Option<JointId>>, ChainError> {
    let mut parent_joint: Vec<Option<JointId>> = vec![None; links.len()];
    for (i, joint) in joints.iter().enumerate() {
        if let Some(first) = parent_joint[joint.child.0] {
            return Err(ChainError::TwoParents {
                link: links[joint.child.0].clone(),
                first: joints[first.0].name.clone(),
                second: joint.name.clone(),
            });
        }
        parent_joint[joint.child.0] = Some(JointId(i));
    }
    Ok(parent_joint)
}

fn single_root(links: &[String], parent_joint: &[Option<JointId>]) -> Result<LinkId, ChainError> {
    let roots: Vec<usize> = (0..links.len()).filter(|&i| parent_joint[i].is_none()).collect();
    match (roots.as_slice(), links) {
        ([root], _) => Ok(LinkId(*root)),
        ([], []) => Err(ChainError::NoLinks),
        ([], [first, ..]) => Err(ChainError::Cycle { link: first.clone() }),
        _ => Err(ChainError::ManyRoots { roots: roots.into_iter().map(|i| links[i].clone()).collect() }),
    }
}

/// Joints in breadth-first order from the root. With one parent per link, a link that is not visited lies on a cycle
/// or behind one.
fn outwards(links: &[String], joints: &[Joint], root: LinkId) -> Result<Vec<JointId>, ChainError> {
    let mut children: Vec<Vec<JointId>> = vec![Vec::new(); links.len()];
    for (i, joint) in joints.iter().enumerate() {
        children[joint.parent.0].push(JointId(i));
    }
    let mut visited = vec![false; links.len()];
    visited[root.0] = true;
    let mut order = children[root.0].clone();
    let mut next = 0;
    while let Some(&joint) = order.get(next) {
        let child = joints[joint.0].child;
        visited[child.0] = true;
        order.extend_from_slice(&children[child.0]);
        next += 1;
    }
    match visited.iter().position(|m| !m) {
        Some(unreached) => Err(ChainError::Cycle { link: links[unreached].clone() }),
        None => Ok(order),
    }
}

/// Resolves mimics to the independent joint: `q = m₁(m₂·q₀ + o₂) + o₁`.
fn coupling(joints: &[Joint], active: &[JointId], start: usize) -> Result<Option<JointCoupling>, ChainError> {
    if !joints[start].kind.moves() {
        return Ok(None);
    }
    let (mut at, mut multiplier, mut offset) = (start, 1.0, 0.0);
    // More steps than joints would visit one of them twice.
    for _ in 0..=joints.len() {
        let Some(mimic) = joints[at].mimic else {
            let index = active.iter().position(|j| j.0 == at).unwrap_or(0);
            return Ok(Some(JointCoupling { index, multiplier, offset }));
        };
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        let source = joints
            .get(mimic.joint.0)
            .ok_or_else(|| ChainError::UnknownMimic { joint: joints[at].name.clone(), source_joint: mimic.joint.0 })?;
        if !source.kind.moves() {
            return Err(ChainError::MimicOfFixed { joint: joints[at].name.clone(), source_joint: source.name.clone() });
        }
        at = mimic.joint.0;
    }
    Err(ChainError::MimicCycle { joint: joints[start].name.clone() })
}
