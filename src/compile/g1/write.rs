//! Lines of RS274/NGC. In: points in mm and degrees of the machine. Out: lines with only those words that
//! changed.

use machine::Kinematics;
use protocol::{Axis, Feed, PathMode, PerAxis, Position, Set, SpindleMode, SpindleSpeed, Until};

use super::Size;
use super::chords::{Chords, Piece};

/// Digits behind the point of speeds, times and offsets.
const DIGITS: usize = 6;

/// Lines on their way out, and what is in force behind the last of them.
pub(super) struct Lines<'a> {
    pub(super) size: Size,
    line: &'a mut dyn FnMut(&str),
    /// Machine position of the zero of the program.
    zero: PerAxis<f64>,
    /// The axes there are.
    axes: Vec<Axis>,
    /// Digits behind the point of coordinates.
    decimals: usize,
    /// The words of the last point.
    words: PerAxis<String>,
    motion: &'static str,
    /// What F is per, and F.
    per: &'static str,
    speed: String,
    mode: String,
    /// Blocks have the time they take (G93).
    timed: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(zero: PerAxis<Position>, axes: Vec<Axis>, line: &'a mut dyn FnMut(&str)) -> Lines<'a> {
        Lines {
            size: Size::default(),
            line,
            zero: zero.map(Position::mm),
            axes,
            decimals: 4,
            words: Default::default(),
            motion: "",
            per: "G94",
            speed: String::new(),
            mode: String::new(),
            timed: false,
        }
    }

    /// What a program begins with.
    pub(super) fn begin(&mut self, kinematics: Kinematics, mode: PathMode) {
        self.put(if kinematics == Kinematics::Lathe { "G18 G8" } else { "G17" });
        self.put("G21 G90 G94 G40 G49 G80 G54");
        let zero = |axis: &Axis| format!(" {axis}{}", number(self.zero[axis.index()], DIGITS));
        let zeros: String = self.axes.iter().map(zero).collect();
        self.put(&format!("G10 L2 P1{zeros}"));
        self.mode(mode);
    }

    /// A line.
    pub(super) fn put(&mut self, text: &str) {
        (self.line)(text);
        self.size.blocks += 1;
        self.size.bytes += text.len() as u64 + 1;
    }

    /// Coordinates from now on may be rounded by so many mm in space.
    pub(super) fn decimals(&mut self, mm: f64) {
        let worst = |decimals: i32| 0.5 * libm::sqrt(3.0) * libm::pow(10.0, f64::from(-decimals));
        self.decimals =
            (3..=9).find(|decimals| worst(*decimals) <= mm).map_or(9, |decimals| decimals as usize);
    }

    /// Path mode.
    pub(super) fn mode(&mut self, mode: PathMode) {
        let text = match mode {
            PathMode::ExactStop => "G61.1".into(),
            PathMode::ExactPath => "G61".into(),
            PathMode::Blend { tolerance_mm, merge_mm } => {
                format!("G64 P{} Q{}", number(tolerance_mm, DIGITS), number(merge_mm, DIGITS))
            }
        };
        if self.mode != text {
            self.put(&text);
            self.mode = text;
        }
    }

    /// Whether blocks that follow have the time they take.
    pub(super) fn timed(&mut self, timed: bool) {
        self.timed = timed;
    }

    /// Spindle.
    pub(super) fn spindle(&mut self, mode: SpindleMode, speed: SpindleSpeed) {
        let code = match mode {
            SpindleMode::Stop => return self.put("M5"),
            SpindleMode::Clockwise => "M3",
            SpindleMode::Counterclockwise => "M4",
        };
        match speed {
            SpindleSpeed::Rpm(rpm) => self.put(&format!("G97 S{} {code}", number(rpm, DIGITS))),
            SpindleSpeed::Surface { mm_s, max_rpm, .. } => {
                let metres = number(mm_s * 0.06, DIGITS);
                self.put(&format!("G96 D{} S{metres} {code}", number(max_rpm, DIGITS)));
            }
        }
    }

    /// Coolant.
    pub(super) fn coolant(&mut self, mist: bool, flood: bool) {
        match (mist, flood) {
            (false, false) => self.put("M9"),
            (true, false) => self.put("M7"),
            (false, true) => self.put("M8"),
            (true, true) => {
                self.put("M7");
                self.put("M8");
            }
        }
    }

    /// An output.
    pub(super) fn output(&mut self, index: u8, set: Set, in_step: bool) {
        self.put(&match (set, in_step) {
            (Set::Digital(true), true) => format!("M62 P{index}"),
            (Set::Digital(false), true) => format!("M63 P{index}"),
            (Set::Digital(true), false) => format!("M64 P{index}"),
            (Set::Digital(false), false) => format!("M65 P{index}"),
            (Set::Analog(value), true) => format!("M67 E{index} Q{value}"),
            (Set::Analog(value), false) => format!("M68 E{index} Q{value}"),
        });
    }

    /// A wait for an input.
    pub(super) fn wait(&mut self, input: u8, until: Until, within_s: f64) {
        let l = match until {
            Until::Rise => 1,
            Until::Fall => 2,
            Until::High => 3,
            Until::Low => 4,
        };
        self.put(&format!("M66 P{input} L{l} Q{within_s}"));
    }

    /// The first move of a program, if it is rapid, begins with this axis alone.
    pub(super) fn first(&mut self, axis: Axis, at: Position, feed: Feed) {
        if self.motion.is_empty() && feed == Feed::Rapid && self.axes.contains(&axis) {
            let word = number(at.mm() - self.zero[axis.index()], self.decimals);
            self.put(&format!("G0 {axis}{word}"));
            self.words[axis.index()] = word;
            self.motion = "G0";
        }
    }

    /// A piece of a way; its chords as far as they are certain.
    pub(super) fn follow(&mut self, chords: &mut Chords, piece: Piece, feed: Feed) {
        chords.push(piece, &mut |at, length| self.point(at, length, feed));
    }

    /// The rest of a way.
    pub(super) fn finish(&mut self, chords: &mut Chords, feed: Feed) {
        chords.finish(&mut |at, length| self.point(at, length, feed));
    }

    /// The line to a point, over `length` mm.
    fn point(&mut self, at: &PerAxis<f64>, length: f64, feed: Feed) {
        let mut text = String::new();
        for axis in &self.axes {
            let i = axis.index();
            // A degree moves what is within half a metre by less than 10 mm.
            let decimals = self.decimals + usize::from(axis.is_rotary());
            let word = number(at[i] - self.zero[i], decimals);
            if self.words[i] != word {
                text.push_str(&format!(" {axis}{word}"));
                self.words[i] = word;
            }
        }
        // What is less than the last decimal is nothing.
        if text.is_empty() {
            return;
        }
        let (motion, per, speed) = match feed {
            Feed::Rapid => ("G0", None, None),
            Feed::PerMinute(mm) if self.timed => ("G1", Some("G93"), Some(digits(mm / length))),
            Feed::PerMinute(mm) => ("G1", Some("G94"), Some(number(mm, DIGITS))),
            Feed::PerRevolution(mm) => ("G1", Some("G95"), Some(number(mm, DIGITS))),
        };
        let mut before = String::new();
        if let Some(per) = per
            && std::mem::replace(&mut self.per, per) != per
        {
            self.put(per);
            self.speed.clear();
        }
        if std::mem::replace(&mut self.motion, motion) != motion {
            before.push_str(motion);
        }
        if let Some(speed) = speed
            && (self.timed || self.speed != speed)
        {
            text.push_str(&format!(" F{speed}"));
            self.speed = speed;
        }
        before.push_str(&text);
        self.put(before.trim_start());
    }
}

/// A number without zeros at its end.
fn number(value: f64, decimals: usize) -> String {
    let mut text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" { "0".into() } else { text }
}

/// A number of four digits, rounded.
fn digits(value: f64) -> String {
    let whole = libm::floor(libm::log10(value)).clamp(-6.0, 6.0) as i32;
    number(value, usize::try_from(3 - whole).unwrap_or(0))
}
