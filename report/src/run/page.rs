//! The page of a report. In: a [`Run`]. Out: HTML with everything in it.

use maud::{Markup, html};
use rig::observe::{FaultReport, Outcome, PassReport, ProgramWarning, Summary};

use super::Run;
use super::cutting;
use super::gauge;
use super::passes;
use super::real_time;
use super::references;
use super::signals;
use super::taps;
use super::traces;
use super::verdict::{self, um};
use crate::page::{document, pictures};
use crate::table::Table;

/// Lines of the program that are shown.
const PROGRAM_LINES: usize = 400;

/// The whole page.
pub(super) fn html(run: &Run) -> String {
    let (summary, drawn) = (&run.summary, &run.drawn);
    let content = html! {
        (head(summary))
        @if let Some(note) = &drawn.note { p.note { (note) } }
        @if let Some(part) = &drawn.part { (pictures(std::slice::from_ref(part), 1)) }
        @if let Some(solid) = &drawn.solid { (solid) }
        @if let Some(table) = taps::table(summary) { (section(&table)) }
        @if summary.turned().next().is_some() { (passes::tables(summary)) }
        @for gauge in summary.gauged() { (gauge::table(gauge)) }
        @if cutting::cuts(summary) { (cutting::table(summary)) }
        @if traces::any(summary) { (traces::table(summary)) }
        @for table in &drawn.tables { (section(table)) }
        @if let Some(table) = references::table(summary) { (section(&table)) }
        @if let Some(table) = signals::table(summary) { (section(&table)) }
        @for table in real_time::tables(summary) { (section(&table)) }
        @if !summary.moves.circles.is_empty() { (circles(summary)) }
        (pictures(&drawn.figures, 1 + usize::from(drawn.part.is_some())))
        (details(summary))
        @if let Some(program) = &run.program { (listing(program)) }
    };
    document(&summary.program, &content, drawn.part.is_some() || !drawn.figures.is_empty())
}

fn head(summary: &Summary) -> Markup {
    let verdict = verdict::of(summary);
    let worst = |of: fn(&PassReport) -> f64| summary.turned().map(of).fold(0.0, f64::max);
    html! {
        header {
            p.product { "pitchlock · report of a run" }
            h1 { (summary.program) }
            div class={ "verdict " (verdict.grade.class()) } {
                p.grade { (verdict.grade.label()) }
                p { (verdict.sentences.join(" ")) }
            }
            dl.key {
                div { dt { "Time on the machine" } dd { (format!("{:.2} s", summary.simulated_s)) } }
                div { dt { "Timed moves" } dd { (summary.moves.count) } }
                @if summary.moves.contour_max_um > 0.0 {
                    div { dt { "Farthest from the path" } dd { (um(summary.moves.contour_max_um)) } }
                }
                @if traces::any(summary) {
                    div { dt { "True tool or beam off its trace" } dd { (um(traces::worst_um(summary))) } }
                }
                @if let Some(off) = taps::worst_um(summary) {
                    div { dt { "Taps" } dd { (summary.taps().count()) } }
                    div { dt { "Tap, farthest from the helix" } dd { (um(off)) } }
                }
                @if summary.turned().next().is_some() {
                    @let passes = summary.last_attempts().filter(|pass| pass.tap.is_none()).count();
                    div { dt { "Thread passes" } dd { (passes) } }
                    @let [helix, passes, depth, _] = summary.at_the_tool();
                    div { dt { "Farthest from the helix, at the tool" } dd { (um(helix)) } }
                    div { dt { "Pass to pass, at the tool" } dd { (um(passes)) } }
                    div { dt { "Off in depth, at the tool" } dd { (um(depth)) } }
                    div { dt { "X in the thread, servo error" } dd { (um(worst(|pass| pass.x.thread_max_abs_um))) } }
                    div { dt { "Z in the thread, servo error" } dd { (um(worst(|pass| pass.z.thread_max_abs_um))) } }
                }
            }
        }
    }
}

fn section(table: &Table) -> Markup {
    html! { section { h2 { (table.title) } (table.markup()) p.caption { (table.caption) } } }
}

fn circles(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { "Circles" }
            div.scroll tabindex="0" role="region" aria-label="Table of circles" {
                table {
                    thead { tr {
                        th scope="col" { "Line" }
                        th scope="col" { "Radius" small { "mm" } }
                        th scope="col" { "Feed" small { "mm/min" } }
                        th scope="col" { "Around" small { "degrees" } }
                        th scope="col" { "Deviation" small { "largest; mean, µm" } }
                        th scope="col" { "Quadrants" small { "glitch at 0, 90, 180, 270°, µm" } }
                    } }
                    tbody { @for circle in &summary.moves.circles { tr {
                        td { (circle.line) }
                        td { (format!("{:.3}", circle.radius_mm)) }
                        td { (format!("{:.0}", circle.feed_mm_min)) }
                        td { (format!("{:.0}", circle.swept_deg)) }
                        td { (format!("{:.2}; {:+.2}", circle.round_max_um, circle.mean_um)) }
                        td { (circle.quadrants_um.map(|glitch| format!("{glitch:+.2}")).join(", ")) }
                    } } }
                }
            }
            p.caption {
                "Deviation: distance of the true position (at the motors) from the centre, minus the radius. A glitch is \
                 the deviation farthest from the mean near the quadrant, less the mean."
            }
        }
    }
}

fn details(summary: &Summary) -> Markup {
    let outcome = match summary.outcome {
        Outcome::Completed => "completed",
        Outcome::Faulted => "faulted",
        Outcome::Stopped => "stopped",
    };
    html! {
        section.details {
            h2 { "The run" }
            dl.facts {
                dt { "Outcome" } dd { (outcome) }
                dt { "Clock" } dd { (summary.clock) }
                dt { "Control cycles" } dd { (summary.cycles) " of " (format!("{:.3} ms", 1e3 * summary.cycle_s)) }
                @if summary.wall_s > 0.0 { dt { "Took" } dd { (format!("{:.1} s", summary.wall_s)) } }
                dt { "Trace hash" } dd { code { (summary.trace_hash) } }
            }
            (told("Faults", &summary.faults, summary.cycle_s))
            (told("Warnings", &summary.warnings, summary.cycle_s))
            (checked(&summary.program_warnings))
            @if !summary.passes.is_empty() { (economy(summary)) }
            @if !summary.channels.is_empty() { (channels(summary)) }
        }
    }
}

/// Faults or warnings, if there are any.
fn told(title: &str, reports: &[FaultReport], cycle_s: f64) -> Markup {
    html! {
        @if !reports.is_empty() {
            h3 { (title) }
            ol.faults { @for report in reports {
                li {
                    (format!("{:.4} s, ", report.cycle as f64 * cycle_s)) (report.source) ": "
                    b { (report.code) } " — " (report.text)
                }
            } }
        }
    }
}

/// What the check of the program warned of.
fn checked(warnings: &[ProgramWarning]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            h3 { "Warnings of the check" }
            ol.faults { @for ProgramWarning { file, line, code, text, help } in warnings {
                li { (file) ", line " (line) ": " b { (code) } " — " (text) "; " (help) }
            } }
        }
    }
}

fn economy(summary: &Summary) -> Markup {
    let bytes: u64 = summary.passes.iter().map(|pass| pass.packet_bytes).sum();
    let saved: u64 = summary.passes.iter().map(|pass| pass.setpoints_saved).sum();
    html! {
        p { (format!("{bytes} bytes told the axes of all passes; a stream would have taken {saved} setpoints.")) }
    }
}

fn channels(summary: &Summary) -> Markup {
    html! {
        h3 { "Channels between the processes" }
        div.scroll tabindex="0" role="region" aria-label="Table of channels" {
            table.plain {
                thead { tr {
                    th scope="col" { "Channel" } th scope="col" { "Sent" } th scope="col" { "Received" }
                    th scope="col" { "Lost" } th scope="col" { "Bytes" }
                } }
                tbody { @for channel in &summary.channels { tr {
                    td { (channel.name) } td { (channel.sent) } td { (channel.received) }
                    td { (channel.lost) } td { (channel.bytes) }
                } } }
            }
        }
    }
}

fn listing(program: &str) -> Markup {
    let lines = program.lines().count();
    html! {
        section {
            h2 { "The program" }
            ol.program { @for (line, text) in (1..).zip(program.lines().take(PROGRAM_LINES)) {
                li data-line=(line) { code { (text) } }
            } }
            @if lines > PROGRAM_LINES { p.caption { "… and " (lines - PROGRAM_LINES) " more lines." } }
        }
    }
}
