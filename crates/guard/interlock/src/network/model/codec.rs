//! Numbers, times and grants as bytes.

use crate::{Boot, Micros, Occupancy, RobotSlot, SlotReport, Token};

/// All times are multiples of this.
const UNIT: u64 = 50;

/// Writes the fields of a state, or reads them, in the same order.
#[derive(Debug, Default)]
pub(crate) struct Codec {
    bytes: Vec<u8>,
    /// The next byte to read; `None` while writing.
    at: Option<usize>,
}

impl Codec {
    pub(crate) fn number(&mut self, number: &mut u64) {
        if let Some(at) = &mut self.at {
            *number = u64::from(self.bytes[*at]);
            *at += 1;
        } else {
            self.bytes.push(u8::try_from(*number).expect("numbers of canonical states are small"));
        }
    }

    pub(crate) fn index(&mut self, index: &mut usize) {
        let mut number = *index as u64;
        self.number(&mut number);
        *index = number as usize;
    }

    pub(crate) fn boot(&mut self, boot: &mut Boot) {
        self.number(&mut boot.0);
    }

    pub(crate) fn flag(&mut self, flag: &mut bool) {
        let mut number = u64::from(*flag);
        self.number(&mut number);
        *flag = number == 1;
    }

    pub(crate) fn time(&mut self, time: &mut Micros) {
        let mut units = time.0 / UNIT;
        self.number(&mut units);
        *time = Micros(units * UNIT);
    }

    pub(crate) fn occupancy(&mut self, occupancy: &mut Occupancy) {
        let mut number = *occupancy as u64;
        self.number(&mut number);
        *occupancy = Occupancy::from_u8(number as u8);
    }

    pub(crate) fn option<T: Copy>(&mut self, value: &mut Option<T>, some: T, code: impl FnOnce(&mut Self, &mut T)) {
        let mut is_some = value.is_some();
        self.flag(&mut is_some);
        if is_some {
            code(self, value.get_or_insert(some));
        } else {
            *value = None;
        }
    }

    pub(crate) fn token(&mut self, token: &mut Option<Token>) {
        self.option(token, Token { boot: Boot::NONE, number: 0 }, |codec, token| {
            codec.boot(&mut token.boot);
            codec.number(&mut token.number);
        });
    }

    pub(crate) fn list<T>(&mut self, list: &mut Vec<T>, new: impl Fn() -> T, code: impl Fn(&mut Self, &mut T)) {
        let mut length = list.len();
        self.index(&mut length);
        list.resize_with(length, new);
        for element in list {
            code(self, element);
        }
    }

    pub(crate) fn robots(&mut self, robots: &mut Vec<RobotSlot>) {
        self.list(robots, || RobotSlot(0), |codec, robot| codec.index(&mut robot.0));
    }

    /// Begins to write.
    pub(crate) fn write(&mut self) {
        self.bytes.clear();
        self.at = None;
    }

    pub(crate) fn written(&self) -> &[u8] {
        &self.bytes
    }

    /// Begins to read these bytes.
    pub(crate) fn read(&mut self, bytes: &[u8]) {
        self.bytes.clear();
        self.bytes.extend_from_slice(bytes);
        self.at = Some(0);
    }

    pub(crate) fn report(&mut self, report: &mut SlotReport) {
        self.occupancy(&mut report.occupancy);
        self.flag(&mut report.wants);
        self.token(&mut report.token);
        self.token(&mut report.released);
    }
}
