//! What is needed and what there is, as tables and sentences. In: what was asked, answers. Out: text for the
//! screen, tables for the page.

use adviser::tolerance::Grade;

use super::{
    Asked, Source,
    needs::AxisNeeds,
    unseen::{self, Unseen},
    verdict::Verdict,
};
use report::table::{Place, Table, six, three};

/// What is said below the first table.
const BY_DIFFERENCES: &str = "D of speed, acceleration and jerk is for a control that makes them by differences of counts; whether this one does,
and is fine enough, is said below.";

/// Everything for the screen.
pub(super) fn text(asked: &Asked, verdicts: &[Verdict]) -> String {
    let lines = |lines: Vec<String>| lines.into_iter().map(|line| line + "\n").collect::<String>();
    let tables = [needed(asked), differences(asked), answers(verdicts)].map(|table| table.text());
    let [needed, differences, answers] = tables;
    let unseen =
        behind(asked).map_or(String::new(), |table| format!("\nwhat encoders do not see\n{}", table.text()));
    format!(
        "{}\n{needed}\n{BY_DIFFERENCES}\n\nwhat differences of counts err by\n{differences}\n{answers}{unseen}\n{}",
        lines(head(asked)),
        lines(sentences(asked, verdicts))
    )
}

/// What was asked for, in words.
pub(super) fn head(asked: &Asked) -> Vec<String> {
    let cycle_hz = asked.axes.first().map_or(0.0, |needs| needs.demand.cycle_hz);
    let um = three(asked.parts.um);
    let parts = match asked.parts.grade {
        Some((grade, size_mm)) => format!("parts of {size_mm} mm in {grade}: {um} µm"),
        None => format!("parts within {um} µm"),
    };
    let counts = match &asked.source {
        Source::Given => asked
            .axes
            .first()
            .map_or(String::new(), |needs| format!(", counts of {} mm", three(needs.encoder.increment_mm()))),
        Source::Machine { .. } => String::new(),
    };
    let mut lines = vec![format!("{}, {parts}; {} Hz{counts}", asked.name(), six(cycle_hz))];
    if let Some(radius_mm) = asked.parts.radius_mm {
        let degrees = three(1e-3 * super::needs::turned(asked.parts.um, radius_mm));
        lines.push(format!("on a radius of {radius_mm} mm, for the axes that turn, that is {degrees} deg"));
    }
    if asked.axes.iter().any(|needs| asked.is_diameter(needs)) {
        let um = three(asked.parts.um / 2.0);
        lines.push(format!("for X, which makes diameters and moves by half of them, that is {um} µm"));
    }
    lines
}

fn columns<const N: usize>(columns: [[&str; 2]; N]) -> Vec<[String; 2]> {
    columns.map(|column| column.map(str::to_owned)).to_vec()
}

/// The steps that are needed.
pub(super) fn needed(asked: &Asked) -> Table {
    let rows = asked.groups().into_iter().flat_map(|(needs, names)| {
        needs.quantities(&asked.steps).map(|quantity| {
            vec![
                names.clone(),
                quantity.name.into(),
                format!("{} {}", six(quantity.highest), quantity.unit),
                six(quantity.divided),
                format!("{} {}", three(quantity.step), quantity.step_unit),
                format!("1e{}", quantity.order()),
                quantity.internal.map_or("–".into(), three),
                three(quantity.discrepancy),
            ]
        })
    });
    Table {
        title: "What is needed".into(),
        caption: "Tolerance or highest value, divided into K steps, is the coarsest step that will do (M30–M33). Its order \
                  is the decimal power that is not coarser (M35). V_T, a_T, J_T: the highest value in counts of the \
                  encoder (M29). D: how many times a count is coarser than the step (M34); above 1 the quantity must not \
                  be made by differences of counts."
            .into(),
        head: columns([
            ["axis", ""],
            ["quantity", ""],
            ["highest", ""],
            ["K", ""],
            ["step needed", ""],
            ["order", ""],
            ["internal", "counts/cycleⁿ"],
            ["D", "of a count"],
        ]),
        rows: rows.collect(),
        place: Place::Everywhere,
    }
}

/// What differences of counts err by.
pub(super) fn differences(asked: &Asked) -> Table {
    let rows = asked.groups().into_iter().flat_map(|(needs, names)| {
        needs.differences().map(|difference| {
            vec![
                names.clone(),
                difference.of.into(),
                six(difference.counts),
                format!("{} {}", three(difference.largest), difference.unit),
                format!("{} {}", three(difference.rms), difference.unit),
                three(difference.of_limit_pct),
            ]
        })
    });
    Table {
        title: "What differences of counts err by".into(),
        caption: "The n-th difference of rounded positions errs by up to 2ⁿ⁻¹ counts per cycleⁿ (M28). Setpoints are not made \
                  so here: speed and acceleration come from the law. What the drive measures by a difference of its encoder \
                  has the error of the first line."
            .into(),
        head: columns([
            ["axis", ""],
            ["made by differences", ""],
            ["counts", "at most"],
            ["error", "at most"],
            ["error", "rms"],
            ["of the limit", "%"],
        ]),
        rows: rows.collect(),
        place: Place::Everywhere,
    }
}

/// What there is, and whether it is fine enough.
pub(super) fn answers(verdicts: &[Verdict]) -> Table {
    let widest = verdicts.iter().map(|verdict| verdict.what.chars().count()).max().unwrap_or(0);
    let row = |verdict: &Verdict| {
        vec![
            format!("{:widest$}", verdict.what),
            format!("{} {}", three(verdict.has), verdict.unit),
            format!("{} {}", three(verdict.needs), verdict.unit),
            three(verdict.has / verdict.needs),
            if verdict.is_fine() { "fine" } else { "TOO COARSE" }.into(),
        ]
    };
    Table {
        title: "Verdict".into(),
        caption: "D: how many times the step there is coarser than the one that is needed.".into(),
        head: columns([["what counts", ""], ["has", ""], ["needs", ""], ["D", ""], ["verdict", ""]]),
        rows: verdicts.iter().map(row).collect(),
        place: Place::Everywhere,
    }
}

/// What encoders do not see; none where nothing is told of it.
pub(super) fn behind(asked: &Asked) -> Option<Table> {
    let row = |unseen: &Unseen| {
        let unit = unseen.needs.unit();
        vec![
            unseen.needs.name(),
            unseen.cause.name().into(),
            format!("{} {unit}", three(unseen.size)),
            three(unseen.size / unseen.needs.encoder.increment_mm()),
            format!("{} {unit}", three(unseen.within())),
        ]
    };
    let rows: Vec<_> = unseen::of(asked).iter().map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "What encoders do not see".into(),
        caption: "Lost motion and error of the screw lie behind the encoder. As far as the machine file is right about \
                  them they are taken off (M68): a part gets what it is wrong by, which may be a step of position (M30)."
            .into(),
        head: columns([
            ["axis", ""],
            ["what", ""],
            ["is, by the machine file", ""],
            ["counts", ""],
            ["to be known within", ""],
        ]),
        rows,
        place: Place::Everywhere,
    })
}

/// The verdict in words: what to change, or how much finer it might be.
pub(super) fn sentences(asked: &Asked, verdicts: &[Verdict]) -> Vec<String> {
    let coarse: Vec<_> = verdicts.iter().filter(|verdict| !verdict.is_fine()).collect();
    let mut lines: Vec<_> = coarse
        .iter()
        .map(|verdict| {
            let times = three(verdict.has / verdict.needs);
            format!("{}: {times} times too coarse; {}", verdict.what, verdict.remedy)
        })
        .collect();
    let unseen = unseen::of(asked);
    let counts_alone = !unseen.iter().any(Unseen::limits);
    if coarse.is_empty() {
        let all = if counts_alone { "everything" } else { "every count" };
        lines.push(format!("{all} is fine enough"));
    }
    lines.extend(finest(asked, counts_alone));
    lines.extend(unseen::sentences(asked, &unseen));
    lines
}

/// The finest grade that the coarsest measured position resolves; `counts_alone`: nothing else limits it.
fn finest(asked: &Asked, counts_alone: bool) -> Option<String> {
    let (_, size_mm) = asked.parts.grade?;
    let um = |needs: &AxisNeeds| {
        let count = needs.position_step();
        let radius_mm = asked.parts.radius_mm.filter(|_| needs.unit() == "deg");
        let way = radius_mm.map_or(count, |radius| count.to_radians() * radius);
        1e3 * asked.steps.tolerance * if asked.is_diameter(needs) { 2.0 * way } else { way }
    };
    let axes = asked.axes.iter();
    let coarsest = axes.reduce(|worst, one| if um(one) > um(worst) { one } else { worst })?;
    let needed = three(um(coarsest));
    let positions =
        coarsest.axis.as_ref().map_or("positions".into(), |(axis, _)| format!("positions of {axis}"));
    let counts = if counts_alone { "" } else { "by counts alone " };
    let fit = format!("{counts}{positions} do for tolerances of {needed} µm and more");
    Some(match Grade::not_finer_than(um(coarsest), size_mm) {
        Some(grade) => format!("{fit}, {grade} at {size_mm} mm"),
        None => format!("{fit}, which is more than any grade at {size_mm} mm"),
    })
}
