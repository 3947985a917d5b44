//! Faults: what can go wrong while the machine runs, in one table. Who finds it and how, how long that takes,
//! what the machine does, what the operator reads, where to look. `docs/faults.md` is written from it.

mod table;
mod within;

pub use table::FAULTS;
pub use within::{Span, Within};

/// Why a module latched a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
#[allow(missing_docs)] // the table says it
pub enum Fault {
    FollowingError = 1,
    ThreadError = 2,
    StreamStarved = 3,
    DriveFault = 4,
    Stopped = 5,
    SpindleNotAtSpeed = 6,
    AxisNotInPosition = 7,
    AxisFault = 8,
    PassCalledOff = 9,
    PassNotFeasible = 10,
    BadMachineCode = 11,
    IndexNotSeen = 12,
    TravelLimit = 13,
    MeasurementGap = 14,
    EncoderPlausibility = 15,
    PlanRejected = 16,
    EncoderPulsesLost = 17,
    EncoderPulsesGained = 18,
    EncoderGlitch = 19,
    EncoderIndexMissing = 20,
    EmergencyStop = 21,
    PowerLost = 22,
    RegulatorSilent = 23,
    SpindleReversed = 24,
    SpindleRunaway = 25,
    SpindleDoesNotStop = 26,
    EncoderStands = 27,
    AxisJump = 28,
    OtherAxis = 29,
    InterpolatorSilent = 30,
    ForceTooHigh = 31,
    InputTimedOut = 32,
    LateAnswers = 33,
    NotReferenced = 34,
    SwitchNotFound = 35,
    SwitchNotReleased = 36,
    IndexNotFound = 37,
    IndexTooNear = 38,
}

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultRow {
    /// Which.
    pub fault: Fault,
    /// The stable name, as `summary.json` and traces print it.
    pub code: &'static str,
    /// Who finds it.
    pub source: &'static str,
    /// How it is found.
    pub found: &'static str,
    /// How long that takes at most, in each of its cases.
    pub within: &'static [Within],
    /// What the machine does.
    pub reaction: &'static str,
    /// What the operator reads: what happened.
    pub text: &'static str,
    /// What to look at before the machine is started again.
    pub remedy: &'static str,
}

impl Fault {
    /// Every fault in the order of its code, which starts at 1.
    pub const ALL: [Fault; 38] = {
        let mut all = [Fault::FollowingError; 38];
        let mut i = 0;
        while i < all.len() {
            all[i] = FAULTS[i].fault;
            i += 1;
        }
        all
    };

    /// The fault of a code; `None` for 0 and for what this version does not know.
    pub fn from_code(code: u32) -> Option<Fault> {
        Fault::ALL.get((code as usize).checked_sub(1)?).copied()
    }

    /// Its row of the table.
    pub fn row(self) -> &'static FaultRow {
        &FAULTS[self as usize - 1]
    }

    /// Whether a regulator can latch it: what it finds itself, and what it sees of the panel.
    pub fn is_of_regulator(self) -> bool {
        let source = self.row().source;
        source.contains("regulator") || source.contains("panel")
    }

    /// The stable name, as `summary.json` and traces print it.
    pub fn code(self) -> &'static str {
        self.row().code
    }

    /// What happened and what to look at.
    pub fn text(self) -> &'static str {
        self.row().text
    }
}
