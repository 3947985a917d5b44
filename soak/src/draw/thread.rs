//! Random threads on a lathe. In: a seed, what Z and X can do. Out: a [`Thread`] and its blocks; the face of
//! the part is Z 0, the axis of the spindle X 0.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, F | 1/min, mm | speed, lead |
//! | V = F S/60 | mm/s | speed of Z |
//! | r | mm | way in which Z reaches V and leaves it, with some to spare |

use core::fmt::Write as _;

use testing::Seed;

/// One thread, in mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thread {
    pub(super) s_rpm: f64,
    pub(super) lead: f64,
    /// +1 out of the part (external), −1 inside.
    pub(super) outward: f64,
    /// Towards which the tool cuts, ±1: −1 towards the chuck.
    pub(super) towards: f64,
    pub(super) crest: f64,
    pub(super) height: f64,
    pub(super) clearance: f64,
    pub(super) start: f64,
    pub(super) length: f64,
    pub(super) reverse: bool,
}

/// Longest cut of one pass, s.
const LONGEST_PASS_S: f64 = 0.5;

impl Thread {
    pub(super) fn draw(seed: &mut Seed) -> Thread {
        let s_rpm = seed.scale(50.0, 2500.0).round();
        let fastest = 45.0;
        let lead = (100.0 * seed.scale(0.3, 6.0).min(fastest * 60.0 / s_rpm)).round() / 100.0;
        let v = lead * s_rpm / 60.0;
        let run = v * (v / 1000.0 + 0.06);
        let turns = seed.between(1.0, 8.0).min(LONGEST_PASS_S * s_rpm / 60.0).max(1.0);
        let height = 0.62 * lead;
        Thread {
            s_rpm,
            lead,
            outward: if seed.chance(0.7) { 1.0 } else { -1.0 },
            towards: if seed.chance(0.75) { -1.0 } else { 1.0 },
            crest: round(seed.between(10.0, 20.0)),
            height: round(height),
            clearance: round(seed.between(0.5, 2.0)),
            start: round(run + seed.between(0.3, 2.0)),
            length: round((turns * lead).max(1.4 * run)),
            reverse: seed.chance(0.3),
        }
    }

    pub(super) fn drive_line(&self) -> f64 {
        self.crest + self.outward * self.clearance
    }

    /// Z before the thread.
    pub(super) fn before(&self) -> f64 {
        -self.towards * self.start
    }

    pub(super) fn end(&self) -> f64 {
        self.towards * self.length
    }

    /// The blocks of its passes, and what it is.
    pub(super) fn blocks(&self, seed: &mut Seed) -> (Vec<String>, &'static str) {
        let inside = self.outward < 0.0;
        match seed.below(6) {
            0 => (self.singles(seed, 0.0, 1, true), if inside { "g33-internal" } else { "g33-external" }),
            1 => {
                let slope = round_fine(seed.between(-0.12, 0.12));
                (self.singles(seed, slope, 1, true), "g33-taper")
            }
            2 => {
                let starts = 2 + seed.below(2);
                (self.singles(seed, 0.0, starts, true), "g33-multi-start")
            }
            3 => (self.singles(seed, 0.0, 1, false), "g33-no-retract"),
            _ => (vec![self.cycle(seed)], if inside { "g76-internal" } else { "g76-external" }),
        }
    }

    /// G33, pass by pass, start by start.
    fn singles(&self, seed: &mut Seed, slope: f64, starts: usize, retract: bool) -> Vec<String> {
        let lead = self.lead;
        let passes = if starts > 1 { 1 } else { 1 + seed.below(2) };
        let mut blocks = Vec::new();
        for pass in 1..=passes {
            let depth = self.height * libm::sqrt(pass as f64 / passes as f64);
            for start in 0..starts {
                let shift = lead * start as f64 / starts as f64;
                let (from, to) = (self.before() - self.towards * (lead - shift), self.end());
                let groove = self.crest - self.outward * depth;
                let end = groove + slope * (to - from);
                let mut text = String::new();
                let _ = writeln!(text, "G0 X{:.4}\nG0 Z{from:.4}\nG0 X{groove:.4}", self.drive_line());
                let _ = match slope == 0.0 {
                    true => writeln!(text, "G33 Z{to:.4} K{lead:.4}"),
                    false => writeln!(text, "G33 X{end:.4} Z{to:.4} K{lead:.4}"),
                };
                let out = if slope * self.outward * (to - from) > 0.0 { end - groove } else { 0.0 };
                let clear = self.drive_line() + out;
                let _ = match retract {
                    true => writeln!(text, "G0 X{clear:.4}\nG0 Z{from:.4}"),
                    // The tool runs out into a relief; there it stands before it goes out.
                    false => writeln!(text, "G4 P0.01\nG0 X{clear:.4}\nG0 Z{from:.4}"),
                };
                blocks.push(text);
            }
        }
        blocks
    }

    fn cycle(&self, seed: &mut Seed) -> String {
        let (lead, to) = (self.lead, self.end());
        let full = self.height;
        let wanted = 1.0 + seed.between(0.0, 2.0);
        let degression = if seed.chance(0.5) { 2.0 } else { 1.0 };
        let first = round_fine(full / libm::pow(wanted, 1.0 / degression)).min(full - 0.01);
        let mut text = String::new();
        let _ = writeln!(text, "G0 X{:.4}\nG0 Z{:.4}", self.drive_line(), self.before());
        let i = -self.outward * self.clearance;
        let _ = write!(text, "G76 P{lead:.4} Z{to:.4} I{i:.4} J{first:.4} K{full:.4} R{degression}");
        if seed.chance(0.5) {
            let _ = write!(text, " Q{}", [29.5, 27.0, 14.0][seed.below(3)]);
        }
        if seed.chance(0.2) {
            let _ = write!(text, " H1");
        }
        if seed.chance(0.4) {
            let taper = round_fine(seed.between(0.5, 1.2) * lead);
            let _ = write!(text, " E{taper} L{}", 1 + seed.below(3));
        }
        let _ = writeln!(text, "\nG0 Z{:.4}", self.before());
        text
    }
}

pub(super) fn round(mm: f64) -> f64 {
    (100.0 * mm).round() / 100.0
}

fn round_fine(mm: f64) -> f64 {
    (1e4 * mm).round() / 1e4
}
