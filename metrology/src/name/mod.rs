//! Names of threads: one grammar for all standards. In: text as a drawing or a person writes it. Out: a
//! thread, or where the text is wrong and what would be right.
//!
//! ```text
//! name   = thread [hand] [member]
//! thread = M d [x pitch] [- class] | MJ … | Tr d x pitch [- class] | size - n series [- class]
//!        | G size [class] | R size | NPT size [- n] | BSW size - n | Rd d x 1/n | module worm m… z1=… d…
//! pitch  = P | lead P pitch;   hand = LH;   member = external | internal
//! ```
//!
//! Letters are read in capitals or not, but for tolerance classes of metric threads, where they tell the
//! screw from the nut; in a name without small letters that ends in EXTERNAL they are those of a screw.
//! Spaces may stand between parts, and a comma for a point.

mod cursor;
mod inch;
mod metric;
mod size;

pub use cursor::Misread;
pub(crate) use size::InchSize;

use crate::{
    basic::{Round, Worm},
    limits::Side,
    pipe::{self, Joint, Jointing, Parallel},
    thread::{Form, Thread},
};
use cursor::Cursor;

/// What is understood, one form of a name a line.
pub const UNDERSTOOD: &str =
    "M20, M20x2, M20x2-6g/6H, M6-4g6g, M16xPh3P1.5, LH behind any      ISO 965 metric
MJ6x1-4h6h/4H5H                                                    ISO 5855, ASME B1.21M
Tr40x7-7e/7H, Tr40x14P7-8e                                         ISO 2903 trapezoidal
1/4-20 UNC-2A/2B, #10-32 UNF-3A, 1.125-7 UNC, 1 1/8-8 UNR-2A       ASME B1.1 unified
1/4-28 UNJF-3A, #10-32 UNJF-3B                                     ASME B1.15 unified, large root radius
1/2-10 ACME-2G, 3/4-6 ACME internal                                ASME B1.5 Acme, general purpose
2-4 BUTT-2A/2B, 2-4 PUSH-BUTT-3A                                   ASME B1.9 buttress
1/2-14 NPT, NPT 1/2-14                                             ASME B1.20.1 tapered pipe
G1/2-A, G1 1/4 B                                                   ISO 228 parallel pipe
R1/2, Rp1/2, Rc1/2                                                 ISO 7 pipe
BSW 3/16-24, Rd105 x 1/4, module worm m3 z1=2 d44                  basic sizes only
worm DP8 z1=2 d44                                                  basic sizes only";

/// What names begin with.
const KNOWN: &str =
    "write a name as in M20x2-6g, MJ6x1, Tr40x7, 1/4-20 UNC-2A, 1/2-10 ACME-2G, 1/2-14 NPT, G1/2-A, R1/2";

/// Letters that names of other threads begin with, and what to know of them.
const ELSEWHERE: [(&str, &str); 7] = [
    ("UN", "the size comes first, as in 1/4-20 UNC-2A"),
    ("ACME", "the size comes first, as in 1/2-10 ACME-2G"),
    ("EG", "threads for inserts (DIN 8140) are not known here"),
    ("PG", "conduit threads (DIN 40430) are not known here"),
    ("BSP", "write G1/2-A for a parallel one, R1/2 for a tapered one"),
    ("BUTT", "the size comes first, as in 2-4 BUTT-2A"),
    ("S", "metric buttress threads (DIN 513) are not known here; BUTT, Tr and ACME are"),
];

/// Reads a whole name.
pub(crate) fn read(text: &str) -> Result<Thread, Misread> {
    let read = read_as_it_is(text);
    let upper = !text.contains(|c: char| c.is_ascii_lowercase());
    match (read, text.split_once('-')) {
        // A control that has capitals only writes the class of a screw as that of a nut.
        (Err(misread), Some((sizes, class))) if upper && text.trim_end().ends_with("EXTERNAL") => {
            read_as_it_is(&format!("{sizes}-{}", class.to_ascii_lowercase())).map_err(|_| misread)
        }
        (read, _) => read,
    }
}

/// The same of a name whose letters are what they are.
fn read_as_it_is(text: &str) -> Result<Thread, Misread> {
    let mut cursor = Cursor::new(text);
    if !cursor.spaces() {
        return Err(cursor.wrong(0, "there is no name", KNOWN));
    }
    let (form, mut left_hand) = thread(&mut cursor)?;
    let mut only = None;
    while cursor.spaces() {
        let from = cursor.at();
        let dashed = cursor.one_of("-").is_some();
        cursor.spaces();
        match () {
            () if !left_hand && cursor.word("LH") => left_hand = true,
            () if only.is_none() && !dashed && cursor.word("external") => only = Some(Side::External),
            () if only.is_none() && !dashed && cursor.word("internal") => only = Some(Side::Internal),
            () => {
                let help = "behind a thread and its class may stand LH, external or internal";
                return Err(Misread {
                    span: from..text.len(),
                    message: format!("{:?} is not understood", &text[from..]),
                    help: help.into(),
                });
            }
        }
    }
    let named = Thread { form, left_hand, only };
    let empty = named.limits().members().next().is_none();
    if empty {
        let help = "leave external or internal out, or name a class of that member";
        return Err(cursor.wrong(0, "the class is that of the other member", help));
    }
    Ok(named)
}

/// Passes over LH behind the sizes of a metric thread.
fn hand(cursor: &mut Cursor<'_>) -> bool {
    let mut ahead = cursor.clone();
    ahead.spaces();
    ahead.one_of("-");
    ahead.spaces();
    let found = ahead.word("LH");
    if found {
        *cursor = ahead;
    }
    found
}

/// The thread, and whether it is left-hand as far as read.
fn thread(cursor: &mut Cursor<'_>) -> Result<(Form, bool), Misread> {
    let begins = cursor.peek().is_some_and(|first| first.is_ascii_digit() || ".#".contains(first));
    let right = |form: Form| (form, false);
    if begins || cursor.rest().get(..2).is_some_and(|no| no.eq_ignore_ascii_case("No")) {
        return inch::read(cursor).map(right);
    }
    let start = cursor.clone();
    let letters = cursor.letters().to_ascii_uppercase();
    match letters.as_str() {
        "M" => metric::read(cursor, false),
        "MJ" => metric::read(cursor, true),
        "TR" => metric::read_trapezoidal(cursor),
        "NPT" => inch::taper_first(cursor).map(right),
        "BSW" => inch::whitworth_first(cursor).map(right),
        "G" => parallel(cursor).map(right),
        "R" => jointing(cursor, Joint::Screw).map(right),
        "RP" => jointing(cursor, Joint::ParallelNut).map(right),
        "RC" => jointing(cursor, Joint::TaperedNut).map(right),
        "RD" => round(cursor).map(right),
        "MODULE" | "WORM" => {
            *cursor = start;
            worm(cursor).map(right)
        }
        _ => {
            let elsewhere = ELSEWHERE.iter().find(|(of, _)| letters.starts_with(of));
            let help = elsewhere.map_or(KNOWN, |(_, help)| *help);
            Err(cursor.wrong(start.at(), "no thread that is known here begins like this", help))
        }
    }
}

fn parallel(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    let size = inch::pipe_size(cursor, "G", &pipe::parallel_sizes())?;
    let mut ahead = cursor.clone();
    ahead.spaces();
    ahead.one_of("-");
    ahead.spaces();
    let class = ahead.one_of("AaBb");
    if class.is_some() {
        *cursor = ahead;
    }
    Ok(Form::Parallel(Parallel { size, class: class.map(|class| class.to_ascii_uppercase()) }))
}

fn jointing(cursor: &mut Cursor<'_>, joint: Joint) -> Result<Form, Misread> {
    let size = inch::pipe_size(cursor, "ISO 7-1", &pipe::jointing_sizes())?;
    Ok(Form::Jointing(Jointing { size, joint }))
}

fn round(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    cursor.spaces();
    let from = cursor.at();
    let d = cursor.number().filter(|d| (8.0..=300.0).contains(d));
    cursor.spaces();
    let times = cursor.one_of("xX×*").is_some();
    cursor.spaces();
    let fraction = times && cursor.word("1") && cursor.word("/");
    let tpi = if fraction { cursor.number() } else { None };
    let tpi = tpi.filter(|tpi| [4.0, 6.0, 8.0, 10.0].contains(tpi));
    let found = d.zip(tpi).filter(|(d, tpi)| d * tpi >= 2.5 * 25.4);
    found.map(|(d, tpi)| Form::Round(Round { d, tpi })).ok_or_else(|| {
        let help = "as in Rd105 x 1/4: a diameter from 8 to 300 mm and 10, 8, 6 or 4 threads per inch";
        cursor.wrong(from, "this is not a round thread of DIN 405", help)
    })
}

fn worm(cursor: &mut Cursor<'_>) -> Result<Form, Misread> {
    let from = cursor.at();
    let mut value = |letters: &[&str]| {
        cursor.spaces();
        let found = letters.iter().any(|word| cursor.word(word));
        if found { cursor.number() } else { None }
    };
    value(&["module "]);
    value(&["worm "]);
    let diametral = value(&["dp"]);
    let module = diametral.map(|pitch| 25.4 / pitch).or_else(|| value(&["m"]));
    let module = module.filter(|module| (0.1..=100.0).contains(module));
    let starts =
        value(&["z1=", "z1 =", "z="]).filter(|starts| starts.fract() == 0.0 && (1.0..=16.0).contains(starts));
    let d = value(&["d"]).filter(|d| *d <= 1e4);
    let (Some(module), Some(starts), Some(d)) = (module, starts, d) else {
        let help = "as in module worm m3 z1=2 d44 or worm DP8 z1=2 d44: axial module or diametral pitch, 1 to 16 threads, \
             reference diameter in mm";
        return Err(cursor.wrong(from, "this is not a worm", help));
    };
    if d < 4.0 * module {
        let help = "its reference diameter is at least four modules";
        return Err(cursor.wrong(
            from,
            format!("a worm of {d} mm is too thin for a module of {module} mm"),
            help,
        ));
    }
    Ok(Form::Worm(Worm { module, diametral, starts: starts as u32, d }))
}
