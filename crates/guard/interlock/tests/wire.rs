//! Encoding and decoding of messages, and bytes that are not valid messages.

use elbowroom_interlock::frame::MessageError;
use elbowroom_interlock::wire::{Message, decode, encode};
use elbowroom_interlock::{Boot, GrantsMessage, Occupancy, RobotSlot, SlotAnswer, SlotReport, StateMessage, Token};
use proptest::prelude::*;

fn token() -> impl Strategy<Value = Option<Token>> {
    proptest::option::of((1_u64.., any::<u64>()).prop_map(|(boot, number)| Token { boot: Boot(boot), number }))
}

fn report() -> impl Strategy<Value = SlotReport> {
    use Occupancy::{Committed, Inside, Outside, Unknown, Warning};
    let occupancy = prop_oneof![Just(Unknown), Just(Outside), Just(Warning), Just(Committed), Just(Inside)];
    (occupancy, any::<bool>(), token(), token()).prop_map(|(occupancy, wants, token, released)| SlotReport {
        occupancy,
        wants,
        token,
        released,
    })
}

fn answer() -> impl Strategy<Value = SlotAnswer> {
    (token(), any::<bool>(), any::<bool>()).prop_map(|(granted, release_requested, halt)| SlotAnswer {
        granted,
        release_requested,
        halt,
    })
}

fn message() -> impl Strategy<Value = Message> {
    let words = || any::<[u64; 5]>();
    let robot = || (0_usize..65_536).prop_map(RobotSlot);
    prop_oneof![
        (robot(), words(), proptest::collection::vec(report(), 0..20)).prop_map(|(robot, [a, b, c, d, _], slots)| {
            Message::State(StateMessage { robot, boot: Boot(a), sequence: b, checksum: c, arbiter: Boot(d), slots })
        }),
        (robot(), words(), proptest::collection::vec(answer(), 0..20)).prop_map(|(robot, [a, b, c, d, e], slots)| {
            let (arbiter, robot_boot) = (Boot(b), Boot(d));
            Message::Grants(GrantsMessage { checksum: a, arbiter, serial: c, robot, robot_boot, echo: e, slots })
        }),
    ]
}

proptest! {
    #[test]
    fn a_message_survives_its_bytes(message in message()) {
        let bytes = encode(&message).unwrap();
        prop_assert_eq!(decode(&bytes).unwrap(), message);
    }

    #[test]
    fn no_damaged_message_is_taken(message in message(), at in any::<prop::sample::Index>(), flip in 1_u8..) {
        let mut bytes = encode(&message).unwrap();
        let at = at.index(bytes.len());
        bytes[at] ^= flip;
        prop_assert!(decode(&bytes).is_err());
        prop_assert!(decode(&bytes[..at]).is_err());
    }

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(decode(&bytes).is_err());
    }
}

#[test]
fn other_versions_are_named() {
    let state = StateMessage {
        robot: RobotSlot(1),
        boot: Boot(2),
        sequence: 3,
        checksum: 4,
        arbiter: Boot(5),
        slots: vec![SlotReport::UNKNOWN],
    };
    let mut bytes = encode(&Message::State(state)).unwrap();
    bytes[2] = 9;
    assert_eq!(decode(&bytes), Err(MessageError::Version { found: 9, here: 2 }));
    bytes[0] = b'X';
    assert_eq!(decode(&bytes), Err(MessageError::Protocol));
}
