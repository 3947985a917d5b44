//! Speed variation in threads as the program says it, in comments: `(speed_variation, sine, 30, 4)`,
//! `(speed_variation, off)`. It stays until it is said otherwise; what the program does not say, the machine
//! file says. In: the text of a comment; a pass as it is laid out. Out: the variation of the passes that
//! follow; what the pass becomes by it, or a problem that names what would do instead.

use gcode::Problem;
use gcode::problem::{Blame, short};
use machine::{Machine, NotVaried, Varied};
use protocol::{ThreadPass, Variation, VariationShape};

/// What is said of the speed.
const WORD: &str = "speed_variation";

/// What the program has said so far: nothing, that it is off, or how.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Said(Option<Option<Variation>>);

impl Said {
    /// Takes a comment; most of them say nothing of the speed.
    ///
    /// # Errors
    /// It begins with the word, and what follows is no variation.
    pub(crate) fn comment(&mut self, text: &str) -> Result<(), Box<Problem>> {
        let text = text.trim();
        let ends = |c: char| !(c.is_alphanumeric() || c == '_');
        let (word, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        if word.eq_ignore_ascii_case(WORD) {
            self.0 = Some(read(rest)?);
            return Ok(());
        }
        match nearly(text) {
            Some(word) => wrong(format!("{word:?} is no word that changes the speed")),
            None => Ok(()),
        }
    }

    /// The variation in force.
    pub(crate) fn variation(self, machine: &Machine) -> Option<Variation> {
        self.0.unwrap_or_else(|| machine.threading.variation.variation())
    }
}

/// Highest speed under a variation, as a multiple of the one without.
pub(crate) fn top_share(variation: Option<Variation>) -> f64 {
    1.0 + variation.map_or(0.0, |variation| variation.share)
}

fn wrong<T>(message: String) -> Result<T, Box<Problem>> {
    let help = "write (speed_variation, sine, 20, 4): shape (sine, triangle, random), per cent of the speed to \
                either side, period in revolutions; or (speed_variation, off)";
    Err(Problem::error("bad-value", Blame::Block, message, help))
}

/// What is meant for the word but is not it: `speed variation`, `Speed-Variations` in front of a comma, a
/// colon, an equals sign, or of what it may be. A remark that mentions the two words is none.
fn nearly(text: &str) -> Option<&str> {
    let joins = |c: char| c == ' ' || c == '_' || c == '-' || c == '\t';
    let (first, behind) = text.split_at_checked("speed".len())?;
    let second = behind.trim_start_matches(joins);
    let (second, rest) = second.split_at_checked("variation".len())?;
    if !first.eq_ignore_ascii_case("speed") || !second.eq_ignore_ascii_case("variation") {
        return None;
    }
    let rest = rest.strip_prefix(['s', 'S']).unwrap_or(rest);
    let word = &text[..text.len() - rest.len()];
    let next = rest.trim_start_matches(joins);
    let next = &next[..next.find(|c: char| !c.is_alphanumeric()).unwrap_or(next.len())];
    let is_value = |name: &str| next.eq_ignore_ascii_case(name);
    let says = is_value("off") || VariationShape::ALL.into_iter().any(|shape| is_value(shape.name()));
    (says || rest.trim_start().starts_with([',', ':', '='])).then_some(word)
}

/// What stands behind the word: a comma, and a shape with its two numbers, or `off`.
fn read(rest: &str) -> Result<Option<Variation>, Box<Problem>> {
    let Some(told) = rest.trim().strip_prefix(',') else {
        return wrong(match rest.trim() {
            "" => format!("{WORD} does not say what it wants"),
            _ => format!("a comma is missing behind {WORD}"),
        });
    };
    let parts: Vec<&str> = told.split(',').map(str::trim).collect();
    let (name, numbers) = match &parts[..] {
        [off] if off.eq_ignore_ascii_case("off") => return Ok(None),
        [name, numbers @ ..] => (*name, numbers),
        [] => ("", &[][..]),
    };
    let Some(shape) = VariationShape::ALL.into_iter().find(|shape| name.eq_ignore_ascii_case(shape.name()))
    else {
        return wrong(format!("{WORD} cannot be {name:?}"));
    };
    let [percent, revolutions] = numbers else {
        return wrong(format!("{WORD} takes two numbers behind its shape, and has {}", numbers.len()));
    };
    let most = 100.0 * Variation::MOST_SHARE;
    let [shortest, longest] = Variation::REVOLUTIONS;
    let share = match percent.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= most => value / 100.0,
        _ => return wrong(format!("the per cent of {WORD} cannot be {percent:?}: above 0, up to {most}")),
    };
    let revolutions = match revolutions.parse::<f64>() {
        Ok(value) if (shortest..=longest).contains(&value) => value,
        _ => {
            let message = format!("the period of {WORD} cannot be {revolutions:?}: {shortest} to {longest}");
            return wrong(message);
        }
    };
    Ok(Some(Variation { shape, share, revolutions }))
}

/// What a pass becomes by a variation.
pub(crate) fn varied(
    pass: &ThreadPass,
    variation: Option<Variation>,
    machine: &Machine,
) -> Result<Option<(Variation, Varied)>, Box<Problem>> {
    let Some(variation) = variation else { return Ok(None) };
    match machine.varied(pass, &variation) {
        Ok(varied) => Ok(Some((variation, varied))),
        Err(why) => Err(refused(why, pass, &variation, machine)),
    }
}

fn refused(why: NotVaried, pass: &ThreadPass, variation: &Variation, machine: &Machine) -> Box<Problem> {
    let Variation { shape, share, revolutions } = variation;
    let asked = format!(
        "{} of ±{} % over {} revolutions at S{}",
        shape.name(),
        short(100.0 * share),
        short(*revolutions),
        short(pass.s_rpm)
    );
    let message = match why {
        NotVaried::Axes { needs, limit } => {
            format!("{asked} goes up to S{needs:.1}, and the axes can follow the thread up to S{limit:.1}")
        }
        NotVaried::Spindle { needs, limit } => {
            format!("{asked} goes up to S{needs:.1}, and spindle.max_rpm is {}", short(limit))
        }
        NotVaried::Watch { needs, limit } => format!(
            "{asked} goes up to S{needs:.1}, and beyond S{limit:.1} the axes take the spindle for one that runs away"
        ),
        NotVaried::Ramp { needs, limit } => format!(
            "{asked} changes the speed by up to {needs:.0} 1/min per s, and the drive may use {limit:.0} of \
             spindle.ramp_rpm_s"
        ),
        NotVaried::Error { needs, limit } => format!(
            "{asked} may put the thread off by {needs:.2} µm, and threading.variation.error_um allows {}",
            short(limit)
        ),
    };
    let percent = machine.largest_share(pass, variation);
    let percent = percent.map(|share| format!("±{} % over this period", short(100.0 * share)));
    let period = machine.shortest_period(pass, variation);
    let period = period.map(|turns| format!("this per cent over {} revolutions", short(turns)));
    let help = match (percent, period) {
        (None, None) => {
            "no variation would do here; a slower spindle or a smaller lead would help".to_owned()
        }
        (percent, period) => {
            let ways: Vec<String> = percent.into_iter().chain(period).collect();
            format!("{} would do; so may a slower spindle", ways.join(", or "))
        }
    };
    Problem::error("variation-not-feasible", Blame::Block, message, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stays_until_it_is_said_otherwise_and_the_machine_speaks_before() {
        let (mut said, mut machine) = (Said::default(), Machine::plain());
        assert_eq!(said.variation(&machine), None);
        machine.threading.variation.shape = Some(VariationShape::Sine);
        let default = Variation { shape: VariationShape::Sine, share: 0.1, revolutions: 4.0 };
        assert_eq!(said.variation(&machine), Some(default));
        for (text, shape, share, revolutions) in [
            ("speed_variation, triangle, 30, 4", VariationShape::Triangle, 0.3, 4.0),
            ("a remark on speed_variation, off", VariationShape::Triangle, 0.3, 4.0),
            ("speed variation is for chatter, off by default", VariationShape::Triangle, 0.3, 4.0),
            ("speed variations of the old lathe", VariationShape::Triangle, 0.3, 4.0),
            ("speed", VariationShape::Triangle, 0.3, 4.0),
            (" SPEED_VARIATION , Random, 12.5 ,10", VariationShape::Random, 0.125, 10.0),
        ] {
            said.comment(text).expect("it is a variation, or a remark");
            assert_eq!(said.variation(&machine), Some(Variation { shape, share, revolutions }), "{text}");
        }
        said.comment("speed_variation, off").expect("it is off");
        assert_eq!(said.variation(&machine), None);
    }

    #[test]
    fn what_is_misspelt_is_said_with_its_remedy_and_changes_nothing() {
        let mut said = Said::default();
        for text in [
            "speed_variation",
            "speed_variation sine, 30, 4",
            "speed_variation, square, 30, 4",
            "speed_variation, sine, 30",
            "speed_variation, sine, 30, 4, 5",
            "speed_variation, off, 4",
            "speed_variation, sine, 0, 4",
            "speed_variation, sine, 51, 4",
            "speed_variation, sine, NaN, 4",
            "speed_variation, sine, 30, 0.2",
            "speed_variation, sine, 30, inf",
            "speed_variation,",
            "speed variation, sine, 30, 4",
            "Speed-Variation: sine, 30, 4",
            "speedvariation off",
            "speed_variations, off",
            "speed  variation triangle 30 4",
        ] {
            let problem = said.comment(text).expect_err(text);
            assert!(problem.help.starts_with("write (speed_variation, sine"), "{problem:?}");
        }
        assert_eq!(said, Said::default());
    }
}
