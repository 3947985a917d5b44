//! The gauge that a command is asked for: `--gauge NAME`. In: the name of a thread, or its numbers. Out: what
//! the gauge asks, and that in words.

use clap::Args;
use gauge::{Nominal, Side};
use interpreter::GaugedThread;
use rig::observe::{GaugeAsked, GrooveAsked, Observer};

use crate::{error::CliError, program::Program, thread};

/// Which gauge judges the thread.
#[derive(Clone, Debug, Args)]
pub(crate) struct GaugeArgs {
    /// Hold the thread against GO and NO-GO of this thread, whatever `(thread, NAME)` in the program says: a
    /// name with a class as in M20x2-6g, or numbers as in 'P2 D2 18.503..18.663 A60'.
    #[arg(long, value_name = "NAME")]
    pub(crate) gauge: Option<String>,
}

impl GaugeArgs {
    /// What is asked.
    ///
    /// # Errors
    /// The name is not understood, or there is no gauge for it.
    pub(crate) fn read(&self) -> Result<Option<Nominal>, CliError> {
        let read = |name: &String| name.parse().map_err(|misread| thread::refused(name, &misread));
        self.gauge.as_ref().map(read).transpose()
    }
}

/// An observer with the gauges for the threads of a program and the drawing of its groove, if there are such.
pub(crate) fn holds(program: &Program, observer: Observer) -> Observer {
    let origins_mm = || {
        let passes = program.check.iter().flat_map(|check| &check.passes);
        passes.map(|note| (note.pass, note.origin_mm)).collect()
    };
    let mut observer = match program.check.as_ref().and_then(|check| check.groove.clone()) {
        Some(drawn) => observer.with_groove(GrooveAsked { drawn, origins_mm: origins_mm() }),
        None => observer,
    };
    for GaugedThread { nominal, from_mm } in program.gauges.clone() {
        // Machine code tells no thread: the one that is asked for is that of all passes.
        let passes = program.check.as_ref().map(|_| from_mm);
        observer = observer.with_gauge(GaugeAsked { nominal, origins_mm: origins_mm(), passes });
    }
    observer
}

/// What a gauge asks, for people.
pub(crate) fn told(nominal: &Nominal) -> String {
    let [least, most] = nominal.pitch_diameter_mm;
    let (what, go, no_go) = match nominal.side {
        Side::External => ("screw", most, least),
        Side::Internal => ("nut", least, most),
    };
    let crest = match nominal.crest_mm {
        [None, None] => String::new(),
        [Some(least), Some(most)] => format!(", crest {least:.3} to {most:.3}"),
        [Some(least), None] => format!(", crest at least {least:.3}"),
        [None, Some(most)] => format!(", crest at most {most:.3}"),
    };
    let plane = match nominal.taper {
        0.0 => String::new(),
        _ => format!(", at Z {:.3} of the program", nominal.plane_mm),
    };
    format!("{}, a {what}: GO {go:.3} mm, NO-GO {no_go:.3}{crest}{plane}", nominal.name)
}
