//! One guard and one arbiter, message by message: messages that they must not believe.

use elbowroom_interlock::{
    Arbiter, ArbiterEvent, ArbiterSettings, Boot, Guard, Ignored, Micros, Occupancy, RobotSettings, RobotSlot, SlotId,
    StateMessage,
};

const SLOT: SlotId = SlotId(0);
const CHECKSUM: u64 = 7;

fn ms(milliseconds: u64) -> Micros {
    Micros(1000 * milliseconds)
}

fn settings() -> ArbiterSettings {
    let robots = ["a", "b"].map(|name| RobotSettings::new(name, [SLOT])).to_vec();
    ArbiterSettings { checksum: CHECKSUM, ..ArbiterSettings::new(robots, 1) }
}

fn arbiter() -> Arbiter {
    Arbiter::new(settings(), Boot(1))
}

/// The guard of the cell's robot with this number, with this checksum of the cell file.
fn guard(robot: usize, checksum: u64) -> Guard {
    Guard::new(RobotSlot(robot), 1, checksum, Boot(1))
}

/// Sends a message to the arbiter, and all its answers to this guard; returns the events. Robot 0 is in its warning
/// zone, the other robot outside.
fn exchange(guard: &mut Guard, arbiter: &mut Arbiter, now: Micros) -> Vec<ArbiterEvent> {
    let occupancy = if guard.robot() == RobotSlot(0) { Occupancy::Warning } else { Occupancy::Outside };
    report(guard, occupancy, arbiter, now)
}

/// As [`exchange`], for a robot that was found there.
fn report(guard: &mut Guard, occupancy: Occupancy, arbiter: &mut Arbiter, now: Micros) -> Vec<ArbiterEvent> {
    guard.observe(SLOT, occupancy);
    let outputs = arbiter.receive(&guard.state(now), now);
    let robot = guard.robot();
    for reply in outputs.replies.iter().filter(|reply| reply.robot == robot) {
        match guard.receive(reply) {
            Ok(()) => {}
            Err(ignored) => assert_eq!(ignored, Ignored::OtherConfiguration),
        }
    }
    outputs.events
}

/// A guard learns of the arbiter with the first answer, and is trusted with its second message.
fn until_heard(guards: &mut [Guard], arbiter: &mut Arbiter, from: u64, to: u64) -> Vec<ArbiterEvent> {
    let times = (from..to).step_by(10).map(ms);
    times.flat_map(|now| guards.iter_mut().flat_map(|g| exchange(g, arbiter, now)).collect::<Vec<_>>()).collect()
}

/// A robot with another cell file cannot report about the regions of this one, not even that it is outside them, and
/// it is granted none of them.
#[test]
fn a_robot_with_another_configuration_is_neither_granted_nor_believed() {
    for (checksums, expected) in [([CHECKSUM, CHECKSUM], true), ([CHECKSUM, 8], false), ([8, CHECKSUM], false)] {
        let mut arbiter = arbiter();
        let mut guards = [guard(0, checksums[0]), guard(1, checksums[1])];
        let events = until_heard(&mut guards, &mut arbiter, 0, 2000);
        let other = (0..2).find(|r| checksums[*r] != CHECKSUM).map(RobotSlot);
        let said = |e: &ArbiterEvent| matches!(e, ArbiterEvent::OtherConfiguration(r) if Some(*r) == other);
        assert_eq!(events.iter().filter(|e| said(e)).count(), usize::from(other.is_some()), "said once: {events:?}");
        assert_eq!(guards[0].may_enter(SLOT, ms(2000)), expected, "{checksums:?}");
        assert_eq!(arbiter.holder(SLOT).is_some(), expected, "{checksums:?}");
        assert!(!guards[1].may_enter(SLOT, ms(2000)));
        for robot in [0, 1] {
            assert_eq!(arbiter.is_known(RobotSlot(robot), ms(2000)), checksums[robot] == CHECKSUM);
        }
    }
}

/// A guard with another configuration ignores the arbiter; the arbiter does not rely on that.
#[test]
fn a_robot_whose_cell_file_changes_is_not_believed_although_it_knows_the_arbiter() {
    let mut arbiter = arbiter();
    let mut guards = [guard(0, CHECKSUM), guard(1, CHECKSUM)];
    until_heard(&mut guards, &mut arbiter, 0, 2000);
    assert!(arbiter.is_known(RobotSlot(0), ms(2000)));
    let changed = StateMessage { checksum: 8, ..guards[0].state(ms(2010)) };
    let outputs = arbiter.receive(&changed, ms(2010));
    assert!(outputs.events.contains(&ArbiterEvent::OtherConfiguration(RobotSlot(0))), "{:?}", outputs.events);
    assert!(!arbiter.is_known(RobotSlot(0), ms(2010)));
}

/// The age of an answer is the age of the message that it answers, not of the last message sent.
#[test]
fn a_late_answer_confirms_a_grant_for_the_rest_of_its_validity_only() {
    let mut arbiter = arbiter();
    let mut guards = [guard(0, CHECKSUM), guard(1, CHECKSUM)];
    until_heard(&mut guards, &mut arbiter, 0, 200);
    let [guard, _] = &mut guards;
    assert!(guard.may_enter(SLOT, ms(200)) && !guard.may_enter(SLOT, ms(260)));
    let question: StateMessage = guard.state(ms(300));
    let answer = arbiter.receive(&question, ms(330)).replies.into_iter().find(|r| r.robot == RobotSlot(0)).unwrap();
    // Later messages are under way when the answer arrives.
    for now in [310, 320, 330, 340] {
        guard.state(ms(now));
    }
    guard.receive(&answer).unwrap();
    assert!(guard.may_enter(SLOT, ms(345)) && guard.may_enter(SLOT, ms(350)));
    assert!(!guard.may_enter(SLOT, ms(351)), "50 ms after the message that was answered, not after the last one");
}

/// A robot may be cleared at one arbiter while it obeys another one, which still confirms its grant: then two robots
/// may enter. So a person who clears a robot makes sure that only one arbiter runs.
#[test]
fn a_clear_does_not_reach_a_robot_that_obeys_another_arbiter() {
    let (mut first, mut second) = (arbiter(), Arbiter::new(settings(), Boot(2)));
    let mut guards = [guard(0, CHECKSUM), guard(1, CHECKSUM)];
    until_heard(&mut guards, &mut first, 0, 100);
    let [mut near, mut other] = guards;
    assert!(near.may_enter(SLOT, ms(100)));
    // The second arbiter reaches only the other robot, and the first one only the robot that is near.
    until_heard(std::slice::from_mut(&mut other), &mut second, 100, 2000);
    until_heard(std::slice::from_mut(&mut near), &mut first, 100, 2000);
    second.clear(RobotSlot(0), ms(2000)).expect("it was silent for long enough");
    other.observe(SLOT, Occupancy::Warning);
    for reply in second.receive(&other.state(ms(2000)), ms(2000)).replies {
        other.receive(&reply).expect("it is the last one");
    }
    assert!(near.may_enter(SLOT, ms(2000)) && other.may_enter(SLOT, ms(2000)));
}

/// A robot at rest just before the border is committed, as it may not stop outside once it moves. An arbiter that has
/// started again must not let it in before it knows where the other robots are: one of them may be inside.
#[test]
fn a_committed_robot_without_a_grant_does_not_enter_before_all_others_are_known() {
    for (other, may_enter) in [(Occupancy::Outside, true), (Occupancy::Inside, false)] {
        let mut arbiter = arbiter();
        let mut guards = [guard(0, CHECKSUM), guard(1, CHECKSUM)];
        let mut committed = |arbiter: &mut Arbiter, from: u64, to: u64| {
            for now in (from..to).step_by(10).map(ms) {
                report(&mut guards[0], Occupancy::Committed, arbiter, now);
                assert!(from > 0 || !guards[0].may_enter(SLOT, now), "the other robot is unknown");
                if from > 0 {
                    report(&mut guards[1], other, arbiter, now);
                }
            }
            guards[0].may_enter(SLOT, ms(to))
        };
        committed(&mut arbiter, 0, 500);
        assert_eq!(arbiter.holder(SLOT), Some(RobotSlot(0)), "nobody else gets the slot");
        assert_eq!(committed(&mut arbiter, 500, 1000), may_enter, "{other:?}");
        // One of them may come to rest inside beside the other: a person leads one of them out.
        assert_eq!(guards.map(|guard| guard.must_halt(SLOT)), [!may_enter; 2], "{other:?}");
    }
}
