//! What is near, from the exact scene.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_scene::{Checker, Distance, Member, Scene, SceneState, Selection};
use elbowroom_spatial::{Motion, Pose, Vec3};

use crate::levers::Levers;
use crate::reflex::MOST_THREATS;
use crate::{AvoidanceError, Other, Threat};

/// An object that moves, or that nobody planned for, as seen at this moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Index of the object in the scene.
    pub object: usize,
    /// Where it is.
    pub in_world: Pose,
    /// How it moves; [`Motion::REST`] where it stands.
    pub motion: Motion,
    /// True where the path was made with it in mind: it is kept clear of and not fled from.
    pub known: bool,
}

/// Another robot of the scene, as it reports itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour<'a> {
    /// Index of the robot in the scene.
    pub robot: usize,
    /// Its joint values, rad or m.
    pub q: &'a [f64],
    /// Their velocities, rad/s or m/s.
    pub qd: &'a [f64],
    /// True where the path was made with it in mind: it is kept clear of and not fled from.
    pub known: bool,
}

/// All that moves beside the robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Around<'a> {
    /// Objects. Those that were never named stand where the scene has them, and are fixed; those that no longer are stand
    /// where they were seen last, and may move.
    pub objects: &'a [Seen],
    /// Robots. Those that are not named stand where they were named last, or where the scene has them.
    pub robots: &'a [Neighbour<'a>],
}

/// Nearest points of pairs that are closer than this are meaningless as a direction, m.
const TOUCHING_M: f64 = 1e-7;

/// The robot's senses: the scene with everything where it is now, and the list of what is near.
#[derive(Debug)]
pub struct Senses<'s> {
    pub scene: &'s Scene,
    pub robot: usize,
    pub checker: Checker<'s>,
    pub state: SceneState,
    /// Per robot, for velocities.
    pub chains: Vec<ChainState>,
    /// Radius of a ball around each object's origin.
    pub radii: Vec<f64>,
    /// Per robot: how far its joints move it at most.
    pub levers: Vec<Levers>,
    /// The nearest pair that is not on the list for want of room: of what comes, and of what stands.
    pub left_off: [Option<Threat>; 2],
    /// Per object: how it moves, where it was seen at any time.
    loose: Vec<Option<(Motion, bool)>>,
    /// Per robot: whether it is known.
    known: Vec<bool>,
    pub threats: Vec<Threat>,
    /// Who they are, in the same order.
    pub members: Vec<(Member, Member)>,
    found: Vec<(Threat, Member, Member)>,
    /// All that is not fixed, and how near it matters, m.
    others: Vec<(Member, f64)>,
}

impl<'s> Senses<'s> {
    pub fn new(scene: &'s Scene, robot: usize) -> Self {
        let radii = scene.objects().iter().map(|o| farthest(&o.shape.aabb(&Pose::IDENTITY))).collect();
        Self {
            scene,
            robot,
            checker: Checker::new(scene, elbowroom_scene::Options::default()),
            state: SceneState::new(scene),
            chains: scene.robots().iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            radii,
            levers: scene.robots().iter().map(|r| Levers::new(&r.robot)).collect(),
            left_off: [None; 2],
            loose: vec![None; scene.objects().len()],
            known: vec![false; scene.robots().len()],
            threats: Vec::with_capacity(MOST_THREATS),
            members: Vec::with_capacity(MOST_THREATS),
            found: Vec::with_capacity(64),
            others: Vec::with_capacity(scene.objects().len() + scene.robots().len()),
        }
    }

    /// Puts everything where it is.
    pub fn place(&mut self, q: &[f64], around: &Around<'_>) -> Result<(), AvoidanceError> {
        self.state.set_q(self.scene, self.robot, q)?;
        self.chains[self.robot].q.copy_from_slice(q);
        self.scene.robots()[self.robot].robot.chain.forward(&mut self.chains[self.robot]);
        // Who says nothing stands.
        for (_, chain) in self.chains.iter_mut().enumerate().filter(|(i, _)| *i != self.robot) {
            chain.qd.fill(0.0);
        }
        for neighbour in around.robots.iter().filter(|n| n.robot != self.robot) {
            self.state.set_q(self.scene, neighbour.robot, neighbour.q)?;
            self.known[neighbour.robot] = neighbour.known;
            let chain = &mut self.chains[neighbour.robot];
            chain.q.copy_from_slice(neighbour.q);
            if neighbour.qd.len() != chain.qd.len() || neighbour.qd.iter().any(|v| !v.is_finite()) {
                let (robot, joints) = (self.scene.robots()[neighbour.robot].name.clone(), chain.qd.len());
                return Err(AvoidanceError::Neighbour { robot, given: neighbour.qd.len(), joints });
            }
            chain.qd.copy_from_slice(neighbour.qd);
            self.scene.robots()[neighbour.robot].robot.chain.forward_motion(chain);
        }
        // What is no longer seen may still be there.
        self.loose.iter_mut().flatten().for_each(|(motion, _)| *motion = Motion::REST);
        for seen in around.objects {
            self.state.place(self.scene, seen.object, seen.in_world)?;
            if !seen.motion.is_finite() {
                return Err(AvoidanceError::Motion { object: self.scene.objects()[seen.object].name.clone() });
            }
            self.loose[seen.object] = Some((seen.motion, seen.known));
        }
        Ok(())
    }

    /// How far any point of a member can come by itself, m.
    pub fn coming(&self, member: Member, around: &Around<'_>, seconds: f64) -> f64 {
        let far = |s: &Seen| s.motion.velocity.length() + s.motion.angular_velocity.length() * self.radii[s.object];
        match member {
            Member::Object(o) => {
                around.objects.iter().filter(|s| s.object == o).map(|s| far(s) * seconds).fold(0.0, f64::max)
            }
            Member::Link { robot, .. } => {
                let others = around.robots.iter().filter(|n| n.robot == robot && robot != self.robot);
                others.map(|n| self.levers[robot].farthest(n.qd, seconds)).fold(0.0, f64::max)
            }
        }
    }

    /// Finds what is nearer than `fixed_reach_m`, and what can come that near within `ahead_s` seconds or is nearer than
    /// `reach_m`, if it is not fixed; the nearest first.
    pub fn look(&mut self, around: &Around<'_>, reach_m: f64, fixed_reach_m: f64, ahead_s: f64) {
        let mut others = std::mem::take(&mut self.others);
        others.clear();
        let objects = (0..self.loose.len()).filter(|o| self.loose[*o].is_some()).map(Member::Object);
        // One link of a robot stands for all.
        let links = (0..self.chains.len()).filter(|r| *r != self.robot);
        let links = links.map(|robot| Member::Link { robot, link: LinkId(0) });
        let reach = |m: Member| reach_m.max(fixed_reach_m + self.coming(m, around, ahead_s));
        others.extend(objects.chain(links).map(|m| (m, reach(m))));
        self.others = others;
        let Self { scene, robot, checker, state, chains, radii, loose, known, found, others, .. } = self;
        let base = scene.robots()[*robot].base_in_world;
        let view = View {
            scene,
            robot: *robot,
            root_in_world: base,
            world_in_root: base.inverse(),
            chains,
            radii,
            loose,
            known,
            state,
        };
        found.clear();
        let own = Selection::Robot(*robot);
        for (other, reach_m) in others.iter() {
            let other = match other {
                Member::Object(o) => Selection::Object(*o),
                Member::Link { robot, .. } => Selection::Robot(*robot),
            };
            checker.between(own, other).near(state, *reach_m, |d| {
                found.extend(view.threat(&d).map(|t| (t, d.a, d.b)));
            });
        }
        checker.between(own, Selection::All).near(state, fixed_reach_m, |d| {
            let told = |t: &Threat| matches!(t.other, Other::Loose { .. } | Other::Moving { .. });
            found.extend(view.threat(&d).filter(|t| !told(t)).map(|t| (t, d.a, d.b)));
        });
        // What comes is never left off for what stands.
        let comes = |t: &Threat| matches!(t.other, Other::Loose { .. } | Other::Moving { .. });
        let near = |a: &Threat, b: &Threat| a.distance_m.total_cmp(&b.distance_m);
        found.sort_unstable_by(|a, b| comes(&b.0).cmp(&comes(&a.0)).then(near(&a.0, &b.0)));
        let beyond = found.get(MOST_THREATS..).unwrap_or_default();
        self.left_off = [true, false].map(|c| beyond.iter().map(|f| f.0).find(|t| comes(t) == c));
        found.truncate(MOST_THREATS);
        found.sort_unstable_by(|a, b| near(&a.0, &b.0));
        self.threats.clear();
        self.members.clear();
        for (threat, a, b) in found.iter() {
            self.threats.push(*threat);
            self.members.push((*a, *b));
        }
    }
}

/// What is needed to see a pair as a threat.
struct View<'a> {
    scene: &'a Scene,
    robot: usize,
    root_in_world: Pose,
    world_in_root: Pose,
    chains: &'a [ChainState],
    radii: &'a [f64],
    loose: &'a [Option<(Motion, bool)>],
    known: &'a [bool],
    state: &'a SceneState,
}

impl View<'_> {
    /// `None` for a pair that the robot's joints do not change.
    fn threat(&self, d: &Distance) -> Option<Threat> {
        let mine = |m: Member| match m {
            Member::Link { robot, link } if robot == self.robot => Some(link),
            _ => None,
        };
        let (link, on_link, other, on_other) = match (mine(d.a), mine(d.b)) {
            (Some(link), _) => (link, d.on_a, d.b, d.on_b),
            (None, Some(link)) => (link, d.on_b, d.a, d.on_a),
            (None, None) => return None,
        };
        let seen_as = match mine(other) {
            Some(own) => Other::Own(own),
            None => self.loose(other, on_other),
        };
        let away_in_world = self.away(on_link, on_other, d.metres, link, other)?;
        Some(Threat {
            link,
            on_link: self.world_in_root.transform_point(on_link),
            away: self.world_in_root.rotation * away_in_world,
            distance_m: d.metres,
            on_other: self.world_in_root.transform_point(on_other),
            other: seen_as,
        })
    }

    /// On contact the nearest points say nothing: away from the middle of the other.
    fn away(
        &self,
        on_link: Vec3,
        on_other: Vec3,
        metres: f64,
        link: elbowroom_kinematics::LinkId,
        other: Member,
    ) -> Option<Vec3> {
        let apart = on_link - on_other;
        if metres > TOUCHING_M && apart.length() > TOUCHING_M {
            return apart.try_normalize();
        }
        let middle = self.state.pose(self.scene, other)?.translation;
        let own = self.root_in_world * self.chains[self.robot].link_in_root(link);
        (on_link - middle).try_normalize().or_else(|| (own.translation - middle).try_normalize()).or(Some(Vec3::Z))
    }

    fn loose(&self, other: Member, on_other: Vec3) -> Other {
        match other {
            Member::Object(o) => {
                let Some((motion, known)) = self.loose[o] else { return Other::Fixed };
                let Some(pose) = self.state.pose(self.scene, other) else { return Other::Fixed };
                let velocity = motion.velocity_at(on_other - pose.translation);
                if known {
                    return Other::Moving { velocity: self.world_in_root.rotation * velocity };
                }
                self.as_loose(velocity, pose.translation, self.radii[o], o)
            }
            Member::Link { robot, link } => {
                let base = self.scene.robots()[robot].base_in_world;
                let chain = &self.chains[robot];
                let in_root = base.inverse().transform_point(on_other);
                let velocity = chain.link_motion(link).velocity_at(in_root - chain.link_in_root(link).translation);
                if self.known[robot] {
                    return Other::Moving { velocity: self.world_in_root.rotation * (base.rotation * velocity) };
                }
                let before = self.scene.robots()[..robot].iter().map(|r| r.robot.chain.links().len());
                let key = self.radii.len() + before.sum::<usize>() + link.0;
                self.as_loose(base.rotation * velocity, on_other, 0.0, key)
            }
        }
    }

    fn as_loose(&self, velocity: Vec3, centre: Vec3, radius_m: f64, key: usize) -> Other {
        Other::Loose {
            velocity: self.world_in_root.rotation * velocity,
            centre: self.world_in_root.transform_point(centre),
            radius_m,
            key,
        }
    }
}

/// Farthest corner of the box from the origin, m.
fn farthest(aabb: &elbowroom_spatial::Aabb) -> f64 {
    aabb.min.abs().max(aabb.max.abs()).length()
}
