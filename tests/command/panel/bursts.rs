//! The panel in a terminal where things go wrong: keys that come in a burst, a panel that cannot begin.

use super::{
    client::Panel,
    terminal::{Pseudo, text},
};
use crate::shop::{Place, example, until};

/// Keys that come all at once, as when a connection was slow: the hold behind them is taken.
#[test]
fn a_hold_behind_many_keys_is_taken() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let panel =
        Panel::start(&place, &["run", &program, "--panel", "--trace", "none", "--json", "--pace", "1"]);
    let command =
        format!("PITCHLOCK_PANEL='http://{}/#{}' pitchlock panel --join", panel.address, panel.token);
    let Some(mut pseudo) = Pseudo::run(&place, &command) else { return };
    until("it is drawn", || text(&place, "picture").contains("live"));
    pseudo.types("k");
    until("the seat is taken", || panel.state()["seat"].is_string());
    pseudo.types(&("b".repeat(60) + " "));
    until("it is held", || panel.state()["held"] == true);
    pseudo.types("q");
    until("it is left", || !text(&place, "behind").is_empty());
}

/// A panel that cannot begin says why in the terminal, with the status that it has elsewhere.
#[test]
fn what_cannot_begin_in_a_terminal_is_told() {
    for (arguments, part) in [("nosuch.ngc", "nosuch.ngc"), ("--machine nosuch.toml", "nosuch.toml")] {
        for _ in 0..3 {
            let place = Place::new();
            let Some(_pseudo) = Pseudo::run(&place, &format!("pitchlock panel --terminal {arguments}"))
            else {
                return;
            };
            until("it has ended", || !text(&place, "behind").is_empty());
            assert_eq!(text(&place, "status").trim(), "2", "{arguments}");
            // script(1) writes it down when it comes to it.
            until("it is told", || text(&place, "picture").contains(part));
        }
    }
}
