//! A thread, as its name says. Its standard is one of [`Form`]; what all have in common is here.

use std::{fmt, str::FromStr};

use crate::{
    acme::Acme,
    basic::{Round, Whitworth, Worm},
    buttress::Buttress,
    iso_m::Metric,
    limits::{Limits, Side},
    name::{self, Misread},
    pipe::{Jointing, Parallel, Taper},
    profile::Profile,
    trapezoidal::Trapezoidal,
    unified::Unified,
};

/// What a thread of any standard can tell. `Display` writes the name without hand and member.
pub(crate) trait Described: fmt::Display {
    /// The standard, with the letters of the thread.
    fn standard(&self) -> &'static str;
    /// The limits of both members, as far as the name has them.
    fn limits(&self) -> Limits;
    /// The nominal profile, right-hand.
    fn profile(&self) -> Profile;
    /// What a reader of the limits has to know.
    fn note(&self) -> &'static str;
}

/// A thread of a standard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Form {
    Metric(Metric),
    Trapezoidal(Trapezoidal),
    Unified(Unified),
    Acme(Acme),
    Buttress(Buttress),
    Taper(Taper),
    Parallel(Parallel),
    Jointing(Jointing),
    Round(Round),
    Whitworth(Whitworth),
    Worm(Worm),
}

impl Form {
    fn described(&self) -> &dyn Described {
        match self {
            Form::Metric(form) => form,
            Form::Trapezoidal(form) => form,
            Form::Unified(form) => form,
            Form::Acme(form) => form,
            Form::Buttress(form) => form,
            Form::Taper(form) => form,
            Form::Parallel(form) => form,
            Form::Jointing(form) => form,
            Form::Round(form) => form,
            Form::Whitworth(form) => form,
            Form::Worm(form) => form,
        }
    }
}

/// A standard thread. Whatever could be read has limits and a profile.
///
/// Its text is a name that reads as the same thread, complete: `M20` is `M20x2.5-6g/6H`.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    pub(crate) form: Form,
    pub(crate) left_hand: bool,
    /// The member that was asked for; both without.
    pub(crate) only: Option<Side>,
}

impl Thread {
    /// The standard, with the letters of the thread, as in `ISO 965 M`.
    #[must_use]
    pub fn standard(&self) -> &'static str {
        self.form.described().standard()
    }

    /// The limits of its members.
    #[must_use]
    pub fn limits(&self) -> Limits {
        let Limits { unit, external, internal } = self.form.described().limits();
        Limits {
            unit,
            external: external.filter(|_| self.only != Some(Side::Internal)),
            internal: internal.filter(|_| self.only != Some(Side::External)),
        }
    }

    /// The member that its name speaks of, if that is one: by a word, by its class, or as there is no other.
    #[must_use]
    pub fn side(&self) -> Option<Side> {
        let limits = self.limits();
        match (&limits.external, &limits.internal) {
            (Some(_), None) => Some(Side::External),
            (None, Some(_)) => Some(Side::Internal),
            // Classes of G are those of the screw; a nut has none.
            _ => match &self.form {
                Form::Parallel(Parallel { class: Some(_), .. }) => Some(Side::External),
                _ => None,
            },
        }
    }

    /// The nominal profile.
    #[must_use]
    pub fn profile(&self) -> Profile {
        Profile { left_hand: self.left_hand, ..self.form.described().profile() }
    }

    /// What a reader of its limits has to know, in a sentence or two.
    #[must_use]
    pub fn note(&self) -> &'static str {
        self.form.described().note()
    }
}

impl FromStr for Thread {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Thread, Misread> {
        name::read(text)
    }
}

impl fmt::Display for Thread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.form.described())?;
        if self.left_hand {
            f.write_str(" LH")?;
        }
        f.write_str(match self.only {
            None => "",
            Some(Side::External) => " external",
            Some(Side::Internal) => " internal",
        })
    }
}
