//! Programs that are begun at a line: every line of programs, lathes and mills, both dialects. Beside them
//! stands the whole program, read by itself: what follows a line has to be its very items, what is in force
//! is what its items before the line say last, and the way leads over nothing but them.

use std::path::Path;

use interpreter::{Interpreter, Language, NoEntry, open};
use machine::{Kinematics, Machine};
use protocol::{Axis, Code, Feed, Item, PerAxis, Position};

use crate::project;

const MILL: &str = "G21 G17 G90 G94 G64 P0.02 Q0\n#1 = 4\nT1 M6\nM3 S3000\nG0 X10 Y10\nG0 Z5\nG1 Z-5 F300\nG1 X30\nG2 X30 Y30 J10\nG0 Z20\n\
    G55\nG81 X[10 + #1] Y20 Z-6 R2 F200\nX20\nG80\nG0 Z30\nM5\nM2\n";
/// A subroutine at the top, a loop, an if, a call, a chain and a thread that ends in its groove.
const FLOW: &str = "o<turn> sub\n  G0 Z1\n  G1 Z-20 F120\n  G0 X22\no<turn> endsub\nG18 G21 G90 G8\nM3 S400\nG0 X18 Z5\no<turn> call\n\
    #2 = 0\no100 while [#2 LT 3]\n  G0 X[20 - #2] Z2\n  #2 = [#2 + 1]\n  G1 Z-5 F100\n  G0 X22\no100 endwhile\no200 if [#2 EQ 7]\n  G0 X30\n\
    o200 endif\nG0 X12 Z8\nG33 Z-10 K2\nG33 Z-20 K2\nG0 X22\nG0 X15 Z8\nG33 Z-20 K2\n(in its groove)\nG0 X22 Z8\nG0 X30\nM2\n";
/// A compensated contour.
const AROUND: &str = "G18 G21 G90 G8\nT1 M6\nG0 X30 Z5\nG42.1 D0.8 L2 G1 X20 Z2 F200\nG1 Z-10\nG1 X25\nG40 G0 X30\nG0 Z5\nM2\n";

/// Every item of a program that is read as a whole.
fn whole(path: &Path, machine: &Machine) -> Vec<Item> {
    let program = open(path, &Language::default(), machine).expect("it is there");
    Interpreter::new(program, machine).map(|item| item.expect("the program is right")).collect()
}

/// Where the axes are behind items, and the last place of each kind, by the items alone.
fn behind(items: &[Item], machine: &Machine) -> PerAxis<Position> {
    items.iter().fold(machine.home(), |at, item| match &item.code {
        Code::Pass(pass) => pass.axes.map(|law| law.end),
        code => code.target().copied().unwrap_or(at),
    })
}

fn mm(place: &PerAxis<Position>) -> [f64; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|axis| place[axis.index()].mm())
}

fn beside_mm([from, to]: [[f64; 3]; 2], place: [f64; 3]) -> f64 {
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (way, seen) = (minus(to, from), minus(place, from));
    let share = if dot(way, way) > 0.0 { (dot(way, seen) / dot(way, way)).clamp(0.0, 1.0) } else { 0.0 };
    let off = minus(seen, way.map(|mm| mm * share));
    dot(off, off).sqrt()
}

/// Every line that items lead a tool over, as straight lines: arcs by their chord are told apart, and of a
/// thread the way beside it.
fn led_over(items: &[Item], machine: &Machine) -> Vec<[[f64; 3]; 2]> {
    let (mut at, mut lines) = (machine.home(), Vec::new());
    for item in items {
        match &item.code {
            Code::Pass(pass) => {
                let [start, end] = [pass.axes.map(|law| law.start), pass.axes.map(|law| law.end)];
                let across = pass.out.axis as usize;
                let mut beside = end;
                beside[across] = start[across];
                lines.extend([[mm(&start), mm(&beside)], [mm(&beside), mm(&end)]]);
                let mut out = start;
                out[across] = end[across];
                lines.extend([[mm(&start), mm(&out)], [mm(&out), mm(&end)]]);
                at = end;
            }
            code => {
                let to = code.target().copied().unwrap_or(at);
                lines.push([mm(&at), mm(&to)]);
                at = to;
            }
        }
    }
    lines
}

/// The way of a lathe lies on what was led over before, but for the way to where its tool was put in; that
/// of a mill goes up, over and straight down.
fn way_is_free(way: &[Item], [before, ahead]: [&[Item]; 2], machine: &Machine, said: &str) {
    let mut at = machine.home();
    let mut over = led_over(before, machine);
    // There is room for a change of the tool where it is changed, in from outside.
    let changes = |items: &[Item]| items.iter().rposition(|item| matches!(item.code, Code::Tool { .. }));
    let changed = if changes(ahead).is_some() { Some(before.len()) } else { changes(before) };
    let put_in = mm(&behind(&before[..changed.unwrap_or(0)], machine));
    over.push([[at[0].mm(), put_in[1], put_in[2]], put_in]);
    let outside = over.iter().flatten().map(|place| place[0]).fold(0.0, f64::max);
    // As high as the tool has been, and at home: above all that it went over.
    let highest = |top: f64, [_, _, z]: [f64; 3]| top.max(z);
    let top = led_over(before, machine).into_iter().flatten().fold(mm(&machine.home())[2], highest);
    for item in way {
        let to = *item.code.target().expect("a way is moves");
        let ends = [mm(&at), mm(&to)];
        if machine.general.kinematics == Kinematics::Mill {
            let high = ends.iter().all(|end| end[2] >= top);
            let upright = ends[0][..2] == ends[1][..2];
            assert!(high || upright, "{said}: {ends:?}");
        } else if let Code::Line { feed, .. } = item.code {
            for step in 0..=20 {
                let place: [f64; 3] =
                    std::array::from_fn(|i| ends[0][i] + f64::from(step) / 20.0 * (ends[1][i] - ends[0][i]));
                let near = |line: &&[[f64; 3]; 2]| beside_mm(**line, place) < 1e-5;
                let led = over.iter().any(|line| near(&line));
                assert!(led || (place[0] >= outside && feed == Feed::Rapid), "{said}: {place:?} of {ends:?}");
            }
        }
        at = to;
    }
    assert_eq!(at, behind(before, machine), "{said}");
}

/// Begins a program at every line; how many begin, and the refusals by line.
fn every_line(path: &Path, machine: &Machine) -> (usize, Vec<(u32, NoEntry)>) {
    let text = std::fs::read_to_string(path).expect("it is there");
    let items = whole(path, machine);
    let (mut begun, mut refused) = (0, Vec::new());
    for line in 1..=text.lines().count() as u32 {
        let said = format!("{}:{line}", path.display());
        let program = open(path, &Language::default(), machine).expect("it is there");
        let mut from = match Interpreter::new(program, machine).from_line(line, machine) {
            Ok(from) => from,
            Err(why) => {
                refused.push((line, why));
                continue;
            }
        };
        begun += 1;
        let entry = from.entry.clone();
        let executed: Vec<Item> = from.by_ref().map(|item| item.expect("it is right")).collect();
        let passed = entry.modal.items as usize;
        let (before, rest) = items.split_at(passed);
        // The very items of the whole program follow, and the first of them is the first of the line.
        assert_eq!(&executed[..entry.before.len()], &entry.before[..], "{said}");
        assert_eq!(&executed[entry.before.len()..], rest, "{said}");
        let first = rest.iter().find(|item| item.is_move() || matches!(item.code, Code::Pass(_)));
        assert_eq!(first.map(|item| item.line), Some(entry.moves), "{said}");
        assert!(before.iter().all(|item| item.line != line), "{said}: an item of the line is left out");
        // What is in force: what was said last, by the items themselves.
        let last = |is: fn(&Code) -> bool, of: &[Item]| of.iter().rev().map(|item| item.code).find(is);
        let kinds: [fn(&Code) -> bool; 3] = [
            |code| matches!(code, Code::Spindle { .. }),
            |code| matches!(code, Code::Coolant { .. }),
            |code| matches!(code, Code::Variation(_)),
        ];
        for is in kinds {
            assert_eq!(last(is, &entry.before), last(is, before), "{said}");
        }
        let tool = |of: &[Item]| last(|code| matches!(code, Code::Tool { .. }), of);
        let ahead = rest.iter().take_while(|item| !item.is_move() && !matches!(item.code, Code::Pass(_)));
        let ahead: Vec<Item> = ahead.copied().collect();
        assert_eq!(tool(&entry.before), tool(&ahead).or(tool(before)), "{said}");
        let path_mode = |of: &[Item]| last(|code| matches!(code, Code::PathMode(_)), of);
        if let Some(mode) = path_mode(before) {
            assert_eq!(path_mode(&entry.before), Some(mode), "{said}");
        }
        way_is_free(&entry.way, [before, &ahead], machine, &said);
    }
    (begun, refused)
}

/// A machine by the name of its file.
fn machine(name: &str) -> Machine {
    let text = std::fs::read_to_string(project().join("examples/machines").join(name)).expect("it is there");
    Machine::from_toml(&text).expect("it is a machine")
}

#[test]
fn every_line_of_the_examples_begins_with_what_the_whole_program_has_there() {
    let (lathe, mill) = (machine("small-lathe.toml"), machine("small-mill.toml"));
    for (name, machine, begins) in [
        ("m20x2.ngc", &lathe, 31),
        ("scroll.ngc", &lathe, 24),
        ("tap-m8.ngc", &lathe, 12),
        ("shaft.ngc", &lathe, 23),
        ("fanuc/two-starts.nc", &lathe, 16),
        ("fanuc/shaft-m24.nc", &lathe, 33),
        ("fanuc/taper-g32.nc", &lathe, 20),
        ("mill/circle.ngc", &mill, 14),
        ("mill/contour.ngc", &mill, 25),
    ] {
        let (begun, refused) = every_line(&project().join("examples").join(name), machine);
        assert_eq!(begun, begins, "{name}: {refused:?}");
        for (line, why) in refused {
            let by_name = match (name, line) {
                // The contour that its cycle cuts; its subprogram.
                ("fanuc/shaft-m24.nc", 15..=24) => NoEntry::PassedOver { line, next: 25 },
                ("fanuc/taper-g32.nc", 26..=32) => NoEntry::Subprogram { line, caller: 17 },
                // The % above the program.
                (_, 1) => NoEntry::PassedOver { line, next: 2 },
                _ if matches!(why, NoEntry::BehindEnd { .. }) => NoEntry::BehindEnd { line },
                _ => NoEntry::NothingMoves { line },
            };
            assert_eq!(why, by_name, "{name}");
        }
    }
}

fn written(name: &str, text: &str) -> std::path::PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("room");
    path
}

#[test]
fn what_belongs_together_is_refused_by_name() {
    let (lathe, mill) = (machine("small-lathe.toml"), machine("small-mill.toml"));
    let (begun, refused) = every_line(&written("flow.ngc", FLOW), &lathe);
    let of_turn = (2..=5).map(|line| (line, NoEntry::Subprogram { line, caller: 9 }));
    let others = [
        (18, NoEntry::PassedOver { line: 18, next: 19 }),
        (22, NoEntry::Chain { line: 22, begins: 21 }),
        (26, NoEntry::InGroove { line: 26, thread: 25 }),
        (27, NoEntry::InGroove { line: 27, thread: 25 }),
        (29, NoEntry::NothingMoves { line: 29 }),
    ];
    assert_eq!((begun, refused), (20, of_turn.chain(others).collect()));
    let (begun, refused) = every_line(&written("around.ngc", AROUND), &lathe);
    let contour = (5..=7).map(|line| (line, NoEntry::Contour { line }));
    assert_eq!((begun, refused), (5, contour.chain([(9, NoEntry::NothingMoves { line: 9 })]).collect()));
    let (begun, refused) = every_line(&written("mill.ngc", MILL), &mill);
    let idle = [16, 17].map(|line| (line, NoEntry::NothingMoves { line }));
    assert_eq!((begun, refused), (15, idle.to_vec()));
    // Home is among the parts: the way goes as high as the program has been.
    let mut low = mill;
    low.axis.get_mut(&Axis::Z).expect("a mill has Z").home_mm = -20.0;
    let text = "G21 G90\nG0 Z40\nG0 X50 Y0\nG0 Z2\nG1 Z-5 F300\nG1 X60\nG1 X70\nG0 Z40\nM2\n";
    assert_eq!(every_line(&written("low.ngc", text), &low).0, 8);
}

#[test]
fn what_is_in_force_is_what_the_program_made_of_it() {
    let program = "G18 G20 G91 G8 G95\nG10 L2 P2 X0.5 Z-1\n#7 = [2 * 3]\n#<_depth> = 0.25\nG55\nT2 M6\nM4 S300\nM8\n\
        o1 repeat [2]\n  G0 X-0.1\n  G1 Z-0.5 F0.01\no1 endrepeat\nG0 X1\nM2\n";
    let lathe = machine("small-lathe.toml");
    let begun = |line| {
        let program =
            open(&written("force.ngc", program), &Language::default(), &lathe).expect("it is there");
        Interpreter::new(program, &lathe).from_line(line, &lathe).expect("it begins").entry
    };
    let entry = begun(11);
    assert_eq!(entry.words, "G0 G18 G20 G91 G95 G8 G55 F0 S300");
    assert_eq!((entry.system, entry.in_loop, entry.modal.tool), (2, true, Some(2)));
    let of = |name: &str| entry.variables.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
    assert_eq!((of("#7"), of("#<_depth>")), (Some(6.0), Some(0.25)));
    assert_eq!(mm(&entry.zero), [12.7, 0.0, -25.4]);
    assert!(entry.before.iter().any(|item| matches!(item.code, Code::Coolant { flood: true, .. })));
    let entry = begun(13);
    assert_eq!((entry.words.as_str(), entry.in_loop), ("G1 G18 G20 G91 G95 G8 G55 F0.01 S300", false));
    // Two turns of 0.1 and 0.5 inch from home.
    let home = mm(&lathe.home());
    let at = mm(&entry.modal.at);
    assert!((at[0] - home[0] + 5.08).abs() < 1e-9 && (at[2] - home[2] + 25.4).abs() < 1e-9, "{at:?}");
}
