//! Tool tables, parameter files, machine descriptions.

use std::path::{Path, PathBuf};

use gcode::canon::Units;
use gcode::files::{Changes, FileError, MachineFile, ParameterFile, Tool, ToolTable};
use gcode::{Options, Program, Severity};

/// One file changed alone.
fn change_parameters(path: &Path, values: &[(u32, f64)], fresh: &ParameterFile) -> Result<(), FileError> {
    let mut changes = Changes::default();
    changes.parameters(path, values, fresh)?;
    changes.put()
}

fn change_tools(path: &Path, words: &[(i32, char, f64)]) -> Result<(), FileError> {
    let mut changes = Changes::default();
    changes.tools(path, words)?;
    changes.put()
}

#[test]
fn a_tool_table_is_read_and_written_back() {
    let text = "; the tools of the small lathe\n\nT11 p3 X-12.4Z-35.6 D1.6 I95 J155 q2 ;turning tool, tip radius 0.8\n  t 2 P2 Z+0.5 U1\n";
    let table = ToolTable::parse("tool.tbl", text).unwrap();
    let tool = table.find(11).unwrap();
    assert_eq!((tool.index, tool.pocket, tool.orientation), (1, 3, 2));
    assert_eq!((tool.offset, tool.diameter), ([-12.4, 0.0, -35.6, 0.0, 0.0, 0.0], 1.6));
    assert_eq!((tool.front_angle, tool.back_angle), (95.0, 155.0));
    assert_eq!(tool.comment, "turning tool, tip radius 0.8");
    assert_eq!(table.find(2).unwrap().uvw, [1.0, 0.0, 0.0]);
    assert_eq!(table.find(3), None);
    assert_eq!(
        table.to_text(),
        "T11 P3 X-12.4 Z-35.6 D1.6 I95 J155 Q2 ;turning tool, tip radius 0.8\nT2 P2 Z0.5 U1\n"
    );
    assert_eq!(ToolTable::parse("again", &table.to_text()).unwrap(), table);
}

#[test]
fn a_tool_keeps_its_place_in_the_table() {
    let mut table = ToolTable::parse("tool.tbl", "T5 P1\nT1 P2 D3\n").unwrap();
    table.set(Tool { number: 5, diameter: 8.0, ..Tool::default() });
    table.set(Tool { number: 9, ..Tool::default() });
    let order: Vec<_> = table.iter().map(|tool| (tool.index, tool.number, tool.diameter)).collect();
    assert_eq!(order, [(1, 5, 8.0), (2, 1, 3.0), (3, 9, 0.0)]);
}

#[test]
fn a_wrong_line_of_a_tool_table_is_named_with_its_word() {
    for (text, line, column, word) in [
        ("T1 P1\nT2 P2 Z1.2.3\n", 2, 7, "Z1.2.3"),
        ("T1.5 P1\n", 1, 1, "T1.5"),
        ("T1 P1 K3\n", 1, 7, "K"),
        ("T1 P1 Q10", 1, 7, "Q10"),
        ("T1 P1 ?", 1, 7, "?"),
        ("T1 P1 X", 1, 7, "X"),
        ("T1 P1 Xnan", 1, 7, "X"),
        ("T1\nT1\n", 2, 3, ""),
        ("P1 Z3", 1, 6, ""),
        ("T1 \u{b5}3", 1, 4, "\u{b5}"),
    ] {
        let error = ToolTable::parse("my.tbl", text).unwrap_err();
        let at = (error.line, error.column, &error.text[error.span.clone()]);
        assert_eq!(at, (line, column, word), "{text}: {}", error.message);
        assert!(error.headline().starts_with(&format!("my.tbl:{line}:{column}: error[bad-file]: ")));
        assert!(!error.help.is_empty());
    }
}

#[test]
fn a_tool_table_is_replaced_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tool.tbl");
    ToolTable::parse("", "T1 P1 Z5 ;drill").unwrap().write(&path).unwrap();
    assert_eq!(ToolTable::read(&path).unwrap().find(1).unwrap().offset[2], 5.0);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside the table");
    let nowhere = folder.path().join("missing/tool.tbl");
    assert!(matches!(ToolTable::default().write(&nowhere), Err(FileError::Write { .. })));
    assert!(ToolTable::read(&nowhere).unwrap_err().to_string().contains("missing/tool.tbl: cannot be read"));
}

#[test]
fn a_parameter_file_keeps_its_entries_and_gets_those_it_must_have() {
    let file = ParameterFile::parse("a.var", "31\t1.5\n# a remark\n5161 2\n5221\t-3.25\n").unwrap();
    assert_eq!(file.values, [(31, 1.5), (5161, 2.0), (5221, -3.25)]);
    let updated = file.updated(f64::from);
    let numbers: Vec<u32> = updated.values.iter().map(|(number, _)| *number).collect();
    assert!(numbers.is_sorted());
    assert_eq!(numbers.len(), 1 + 9 + 9 + 10 + 1 + 9 * 10);
    assert_eq!((numbers[0], *numbers.last().unwrap()), (31, 5390));
    assert!(updated.to_text().starts_with("31\t31.000000\n5161\t5161.000000\n"));
    assert_eq!(ParameterFile::parse("b.var", &updated.to_text()).unwrap(), updated);
}

#[test]
fn a_wrong_parameter_file_is_refused() {
    for (text, line, message) in [
        ("5602 1\n", 1, "there is no parameter #5602"),
        ("0 1\n", 1, "there is no parameter #0"),
        ("-3 1\n", 1, "there is no parameter #-3"),
        ("10 1\n\n  9 1\n", 3, "#9 stands after #10"),
        ("10 1\n10 1\n", 2, "#10 stands after #10"),
    ] {
        let error = ParameterFile::parse("my.var", text).unwrap_err();
        assert_eq!((error.line, error.message.as_str()), (line, message));
    }
}

#[test]
fn writing_parameters_leaves_the_old_file_as_a_backup() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lathe.var");
    assert_eq!(ParameterFile::read(&path).unwrap(), ParameterFile::default());
    ParameterFile::default().updated(|_| 1.0).write(&path).unwrap();
    let first = std::fs::read_to_string(&path).unwrap();
    ParameterFile::default().updated(|_| 2.0).write(&path).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("lathe.var.bak")).unwrap(), first);
    assert_eq!(ParameterFile::read(&path).unwrap().values[0], (5161, 2.0));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_machine_description_gives_what_programs_depend_on() {
    let text = "[EMC]\nMACHINE = lathe\n[TRAJ]\n# units\nLINEAR_UNITS = inch\n[RS274NGC]\nG73_PECK_CLEARANCE=0.01\n\
                G83_PECK_CLEARANCE = 0.02\nPARAMETER_FILE = lathe.var\nSUBROUTINE_PATH = subs:/opt/library\nREMAP = M400 modalgroup=10\n\
                RETAIN_G43 = 0\nDISABLE_G92_PERSISTENCE = 1\n[EMCIO]\nTOOL_TABLE = tool.tbl\n[DISPLAY]\nPROGRAM_PREFIX = programs\nLINEAR_UNITS = nonsense\n";
    let machine = MachineFile::parse("lathe.ini", text, Path::new("/etc/lathe")).unwrap();
    assert_eq!(machine.units, Some(Units::Inch));
    assert_eq!((machine.g73_clearance, machine.g83_clearance), (Some(0.01), Some(0.02)));
    assert!(machine.forgets_g92 && !machine.no_fanuc_subs);
    assert_eq!(machine.parameter_file, Some(PathBuf::from("/etc/lathe/lathe.var")));
    assert_eq!(machine.tool_table, Some(PathBuf::from("/etc/lathe/tool.tbl")));
    let folders = ["/etc/lathe/programs", "/etc/lathe/subs", "/opt/library"].map(PathBuf::from);
    assert_eq!(machine.subroutine_folders, folders);
    let [warning] = &machine.warnings[..] else { panic!("{:?}", machine.warnings) };
    assert_eq!((warning.line, warning.severity), (11, Severity::Warning));
    assert!(warning.message.contains("[RS274NGC]REMAP"));
}

#[test]
fn numbers_of_a_machine_description_have_names_for_programs() {
    let text = "[VARS]\nDEPTH = 2.5\nNAME = lathe\nDEPTH = 3\n[RS274NGC]\nORIENT_OFFSET = -30\n";
    let machine = MachineFile::parse("my.ini", text, Path::new("")).unwrap();
    let named = [("_ini[vars]depth", 2.5), ("_ini[rs274ngc]orient_offset", -30.0)];
    assert_eq!(machine.named, named.map(|(name, value)| (name.to_owned(), value)));
    assert_eq!(machine.orient_offset, -30.0);
    let hidden = MachineFile::parse("my.ini", &format!("{text}INI_VARS = 0\n"), Path::new("")).unwrap();
    assert!(hidden.named.is_empty());
}

#[test]
fn a_wrong_value_of_a_machine_description_is_named() {
    for (text, column) in [
        ("[TRAJ]\nLINEAR_UNITS = furlong", 16),
        ("[RS274NGC]\nG73_PECK_CLEARANCE = -1  ", 22),
        ("[RS274NGC]\nG83_PECK_CLEARANCE =", 21),
        ("[RS274NGC]\nORIENT_OFFSET = north", 17),
    ] {
        let error = MachineFile::parse("my.ini", text, Path::new("")).unwrap_err();
        assert_eq!((error.line, error.column), (2, column), "{}", error.headline());
    }
}

/// What lies at the name of the new file is not followed, waited for or replaced; of two changes at once none
/// is lost.
#[test]
fn a_change_touches_no_other_file_and_waits_for_none() {
    let folder = tempfile::tempdir().unwrap();
    let none = ParameterFile::default();
    let (path, victim) = (folder.path().join("lathe.var"), folder.path().join("victim"));
    std::fs::write(&path, "5161 0\n").unwrap();
    std::fs::write(&victim, "mine").unwrap();
    let fresh = folder.path().join(format!("lathe.var.{}.new", std::process::id()));
    std::os::unix::fs::symlink(&victim, &fresh).unwrap();
    change_parameters(&path, &[(5223, 1.0)], &none).unwrap_err();
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "mine");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "5161 0\n");
    std::fs::remove_file(&fresh).unwrap();
    let other = std::fs::File::open(folder.path()).unwrap();
    other.lock().unwrap();
    let busy = change_parameters(&path, &[(5223, 1.0)], &none).unwrap_err();
    assert!(busy.to_string().contains("try again"), "{busy}");
    drop(other);
    change_parameters(&path, &[(5223, 1.0)], &none).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "5161 0\n5223\t1.000000\n");
}

/// Of two files both are changed or none, and what was prepared is gone.
#[test]
fn two_files_are_changed_together_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let (var, table) = (folder.path().join("lathe.var"), folder.path().join("tool.tbl"));
    std::fs::write(&var, "5161 0\n").unwrap();
    std::fs::write(&table, "T1 P1 Z1\n").unwrap();
    let mut changes = Changes::default();
    changes.tools(&table, &[(1, 'Z', 2.5)]).unwrap();
    std::fs::write(&var, "5161 abc\n").unwrap();
    changes.parameters(&var, &[(5223, 1.0)], &ParameterFile::default()).unwrap_err();
    drop(changes);
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "T1 P1 Z1\n");
    std::fs::write(&var, "5161 0\n").unwrap();
    let mut changes = Changes::default();
    changes.tools(&table, &[(1, 'Z', 2.5)]).unwrap();
    changes.parameters(&var, &[(5223, 1.0)], &ParameterFile::default()).unwrap();
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "T1 P1 Z1\n", "not before all are ready");
    changes.put().unwrap();
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "T1 P1 Z2.5\n");
    assert_eq!(std::fs::read_to_string(&var).unwrap(), "5161 0\n5223\t1.000000\n");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is left beside them");
}

/// What would be passed over would be an offset of 0.
#[test]
fn what_is_no_parameter_is_refused() {
    for line in [
        "5223 -112,4",
        "5223=-112.4",
        "5223 -112.4mm",
        "#5223 -112.4",
        "5221 nan",
        "5221",
        "T1 P1 Z2",
        "G0 X1",
    ] {
        let error = ParameterFile::parse("my.var", &format!("5161 0\n  {line}\n")).unwrap_err();
        assert_eq!((error.line, error.column, error.code), (2, 3, "bad-file"), "{line}");
    }
    let remarks = "; zero\n# zero of the chuck\n(face)\n\n5223 -112.4 of the chuck\n";
    assert_eq!(ParameterFile::parse("my.var", remarks).unwrap().values, [(5223, -112.4)]);
}

/// A value of a parameter file is changed, and nothing else: remarks, blanks, lines that say nothing stay.
#[test]
fn a_changed_parameter_changes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lathe.var");
    let change =
        |path: &Path, values: &[(u32, f64)]| change_parameters(path, values, &ParameterFile::default());
    let old = "# zero of the chuck\r\n5161\t0.000000\r\n 5221   1.5  (face)\n\n5223\t-3.25";
    std::fs::write(&path, old).unwrap();
    change(&path, &[(5221, 1.500_000_1), (5161, 0.0), (5241, 0.0)]).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), old, "nothing is other than it was");
    change(&path, &[(5241, 7.0), (5222, -2.0), (5221, 112.4)]).unwrap();
    let expected = "# zero of the chuck\r\n5161\t0.000000\r\n 5221   112.400000  (face)\n\n5222\t-2.000000\n5223\t-3.25\n5241\t7.000000\n";
    assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    let wrong = "5221 1\n5161 2\n";
    std::fs::write(&path, wrong).unwrap();
    change(&path, &[(5221, 3.0)]).unwrap_err();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), wrong);
    let fresh = folder.path().join("new.var");
    change_parameters(&fresh, &[(5223, -5.5)], &ParameterFile::fresh(&[(5161, 9.0)])).unwrap();
    let fresh = ParameterFile::read(&fresh).unwrap();
    let filled: Vec<_> = fresh.values.iter().filter(|(_, value)| *value != 0.0).collect();
    assert_eq!((fresh.values.len(), filled), (119, vec![&(5161, 9.0), &(5220, 1.0), &(5223, -5.5)]));
}

#[test]
fn a_changed_word_of_a_tool_changes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tool.tbl");
    let old = "; turning\nT1  P2   Z 25.5 D.8 ;rough, X and Z are set\nt12 p3 X1Z2";
    assert_eq!(ToolTable::parse("", "T1.0 P1 Q2.0").unwrap().find(1).unwrap().orientation, 2);
    // An umlaut of Latin-1 stays one, too.
    std::fs::write(&path, b"T1 Z1 ;\xfc\n").unwrap();
    change_tools(&path, &[(1, 'Z', 2.5)]).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"T1 Z2.5 ;\xfc\n");
    std::fs::write(&path, old).unwrap();
    change_tools(&path, &[(1, 'D', 0.8), (12, 'Q', 0.0)]).unwrap();
    assert_eq!(ToolTable::read(&path).unwrap().find(1).unwrap().diameter, 0.8);
    change_tools(&path, &[(1, 'X', -0.02), (1, 'Z', 25.25), (12, 'X', 3.0), (7, 'Q', 2.0), (7, 'Z', 1.5)])
        .unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let expected =
        "; turning\nT1  P2   Z 25.25 D0.8 X-0.02 ;rough, X and Z are set\nt12 p3 X3Z2\nT7 P7 Q2 Z1.5\n";
    assert_eq!(text, expected);
    let before = ToolTable::parse("", old).unwrap();
    let changes = ToolTable::parse("", &text).unwrap().changes_since(&before);
    let expected = [(1, 'X', -0.02), (1, 'Z', 25.25), (12, 'X', 3.0), (7, 'Z', 1.5), (7, 'Q', 2.0)];
    assert_eq!(changes, expected);
    change_tools(&path, &[(1, 'Q', 12.0)]).unwrap_err();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "a word that no table has changes nothing");
}

/// DISABLE_FANUC_STYLE_SUB: M98 and M99 are refused, o100 call is not.
#[test]
fn subroutines_of_fanuc_can_be_switched_off() {
    let text = "[RS274NGC]\nDISABLE_FANUC_STYLE_SUB = 1\n";
    let machine = MachineFile::parse("lathe.ini", text, Path::new("/etc/lathe")).unwrap();
    assert!(machine.no_fanuc_subs && machine.warnings.is_empty());
    let errors = |text: &str| {
        let options = Options { no_fanuc_subs: machine.no_fanuc_subs, ..Options::default() };
        let outcome = crate::driven::driven(Program::from_text("part.ngc", text, &options), Nothing);
        outcome.errors.iter().map(|error| (error.line, error.code)).collect::<Vec<_>>()
    };
    assert_eq!(errors("M98 P100\nM2\no100\nG0 X5\nM99\n"), [(1, "not-available")]);
    assert_eq!(errors("o100 sub\nG0 X5\no100 endsub\no100 call\nM2\n"), []);
}

struct Nothing;

impl gcode::Sink for Nothing {
    fn call(&mut self, _: gcode::Place, _: gcode::Call<'_>) -> Result<(), Box<gcode::Problem>> {
        Ok(())
    }
}
