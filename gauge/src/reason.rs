//! Why a part is refused, in words with numbers. In: a check, a cause, measures in mm. Out: text.

use metrology::Side;

use crate::nominal::Nominal;

/// Which check refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Grooves beside each other: their distance, their number, the hand.
    Grooves,
    /// GO: the counterpart does not fit.
    Go,
    /// NO-GO: it fits too loosely.
    NoGo,
    /// The root of the groove.
    Root,
    /// The crest beside the groove.
    Crest,
    /// Where its ridge begins.
    Start,
}

/// What weighs most in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Cut too shallow or too deep.
    Size,
    /// The lead is long or short.
    Lead,
    /// The helix is uneven within a turn.
    Drunken,
    /// The starts are not evenly spread.
    Starts,
    /// The pitch diameter changes along the thread.
    Taper,
    /// The pitch diameter changes with the angle.
    Runout,
    /// The flanks have other angles.
    Flanks,
    /// The groove is too narrow at its root.
    Root,
    /// Passes did not lie in one groove.
    Apart,
    /// The grooves leave no ridge between them.
    Ridge,
    /// The thread winds the other way.
    Hand,
    /// The stock was not of the right size.
    Stock,
}

/// Why a part is refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Reason {
    /// Which check refuses.
    pub check: Check,
    /// What weighs most in it.
    pub cause: Cause,
    /// The same for people, with numbers.
    pub text: String,
}

/// The measures that a cause is told with; mm, degrees.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Told {
    /// How large the cause is, in its own measure.
    pub(crate) amount: f64,
    /// Length over which it is that large.
    pub(crate) length: f64,
    /// Angles of the flanks.
    pub(crate) flank_deg: [f64; 2],
}

/// What a cause comes to.
pub(crate) fn cause(nominal: &Nominal, cause: Cause, told: Told) -> String {
    let (um, length) = (1e3 * told.amount.abs(), told.length);
    let [f1, f2] = told.flank_deg;
    let [n1, n2] = nominal.flank_deg;
    match cause {
        Cause::Size if told.amount > 0.0 => format!("cut {um:.1} µm too shallow"),
        Cause::Size => format!("cut {um:.1} µm too deep"),
        Cause::Lead => {
            format!(
                "lead {um:.1} µm {} over {length:.2} mm",
                if told.amount > 0.0 { "long" } else { "short" }
            )
        }
        Cause::Drunken => format!("helix uneven by {um:.1} µm"),
        Cause::Starts => format!("starts {um:.1} µm from where they belong"),
        Cause::Taper => format!("tapered by {um:.1} µm over {length:.2} mm"),
        Cause::Runout => format!("runs out by {um:.1} µm"),
        Cause::Flanks => format!("flanks of {f1:.2}° and {f2:.2}° instead of {n1}° and {n2}°"),
        Cause::Root => format!("the root {um:.1} µm too narrow"),
        Cause::Apart => format!("passes {um:.1} µm apart"),
        Cause::Ridge => "no ridge between the grooves".into(),
        Cause::Hand => "wound the other way".into(),
        Cause::Stock => "stock of another size".into(),
    }
}

/// A diameter beyond a limit: `a pitch diameter 18.7 mm, at most 18.663`.
pub(crate) fn beyond(what: &str, diameter: f64, limit: f64) -> String {
    let side = if diameter > limit { "at most" } else { "at least" };
    format!("{what} {diameter:.4} mm, {side} {limit:.4}")
}

/// GO or NO-GO refuses at a diameter.
pub(crate) fn pitch(nominal: &Nominal, check: Check, diameter: f64, cause: Cause, why: &str) -> Reason {
    let way = if nominal.side == Side::External { "on" } else { "in" };
    let (says, what, limit) = match check {
        Check::Go => (format!("GO does not go {way}"), "virtual pitch diameter", nominal.go_mm()),
        _ => (format!("NO-GO goes {way}"), "pitch diameter", nominal.no_go_mm()),
    };
    Reason { check, cause, text: format!("{says}: {} ({why})", beyond(what, diameter, limit)) }
}

/// The root or the crest is beyond a limit.
pub(crate) fn diameter(
    nominal: &Nominal,
    check: Check,
    cause: Cause,
    (diameter, limit): (f64, f64),
) -> Reason {
    let is_major = (check == Check::Crest) == (nominal.side == Side::External);
    let what = if is_major { "major diameter" } else { "minor diameter" };
    let of = if check == Check::Crest { "crest" } else { "root" };
    Reason { check, cause, text: format!("{of}: {}", beyond(what, diameter, limit)) }
}
