//! What is said of parts, and what cannot be.

use super::*;

fn comment(text: &str) -> Part {
    Part::from_comment(text, 1.0).unwrap_or_else(|error| panic!("{text}: {error}")).expect(text)
}

fn file(text: &str) -> Part {
    Part::from_toml(text).unwrap_or_else(|error| panic!("{text}: {error}")).expect(text)
}

#[test]
fn a_comment_and_a_file_say_the_same() {
    for (words, keys) in [
        ("part, bar D40 L60", "stock = \"bar\"\ndiameter_mm = 40\nlength_mm = 60"),
        (
            " PART ,tube d40 i20 l60 z1.5 c-50",
            "stock = \"tube\"\ndiameter_mm = 40\ninner_mm = 20\nlength_mm = 60\nface_mm = 1.5\nchuck_mm = -50",
        ),
        (
            "part, profile Z0 D20 Z-30 D20 Z-30 D40 Z-60 D40",
            "stock = \"profile\"\nprofile_mm = [[-60, 40], [-30, 40], [-30, 20], [0, 20]]",
        ),
        (
            "part, block X0 Y0 Z-20 X100 Y60 Z0",
            "stock = \"block\"\nfrom_mm = [100, 0, 0]\nto_mm = [0, 60, -20]",
        ),
    ] {
        assert_eq!(comment(words), file(&format!("[part]\n{keys}\n")), "{words}");
    }
}

#[test]
fn a_comment_is_in_the_units_of_its_program() {
    let inch = Part::from_comment("part, bar D2 L4 Z1", 25.4).expect("a part").expect("a part");
    assert_eq!(inch, comment("part, bar D50.8 L101.6 Z25.4"));
}

#[test]
fn a_block_is_for_a_mill_and_nothing_else_is() {
    let block = comment("part, block X0 Y60 Z0 X100 Y0 Z-20");
    let corners = Corners { low_mm: [0.0, 0.0, -20.0], high_mm: [100.0, 60.0, 0.0] };
    assert_eq!(block.block(), Some(corners));
    assert_eq!(block.clone().moved([5.0, -60.0]).block(), Some(corners.moved([5.0, -60.0])));
    assert_eq!(block.clone().fits(Kinematics::Lathe), Err(PartError::OnLathe));
    assert_eq!(block.clone().fits(Kinematics::Mill), Ok(block));
    let bar = comment("part, bar D40 L60");
    assert_eq!(bar.clone().fits(Kinematics::Mill), Err(PartError::OnMill));
    assert_eq!(bar.clone().fits(Kinematics::Lathe), Ok(bar));
}

#[test]
fn points_lie_in_the_stock_or_beside_it() {
    let part = comment("part, tube D40 I20 L60 Z1");
    for (x, z, inside) in [
        (15.0, 0.0, true),
        (-15.0, 1.0, true),
        (9.9, 0.0, false),
        (20.1, 0.0, false),
        (15.0, 1.1, false),
        (15.0, -59.1, false),
    ] {
        assert_eq!(part.holds(x, z), inside, "{x} {z}");
    }
    let shaft = comment("part, profile Z0 D10 Z-20 D20 Z-20 D40 Z-60 D40 C-40");
    assert_eq!((shaft.ends_mm(), shaft.widest_mm(), shaft.chuck_mm()), ([-60.0, 0.0], 20.0, Some(-40.0)));
    assert_eq!(shaft.radii_mm(-10.0), Some([0.0, 7.5]));
    assert_eq!(shaft.radii_mm(-20.0), Some([0.0, 20.0]), "a step belongs to the wider side");
}

#[test]
fn remarks_and_files_of_another_kind_are_no_parts() {
    for remark in ["part 7 of 9", "PART NO 4711", "parts, bar D40", "a part, bar D40 L60", "partition", ""] {
        assert_eq!(Part::from_comment(remark, 1.0), Ok(None), "{remark}");
    }
    for other in [
        "kind = \"surface\"",
        "[[event]]\nat = { cycle = 0 }",
        "[machine]\nname = \"a\"",
        "dialect = \"fanuc\"",
    ] {
        assert_eq!(Part::from_toml(other), Ok(None), "{other}");
    }
}

#[test]
fn what_is_wrong_is_said_with_its_remedy() {
    for (text, words) in [
        ("part bar D40 L60", "a comma is missing"),
        ("part, bra D40 L60", "cannot be \"bra\""),
        ("part,", "cannot be \"\""),
        ("part, bar D40", "length of the stock is missing"),
        ("part, bar L60", "diameter of the stock is missing"),
        ("part, tube D40 L60", "inner diameter of the stock is missing"),
        ("part, tube D40 I40 L60", "cannot be 40: less than the outer one"),
        ("part, bar D40 L60 I20", "\"inner_mm\" says nothing"),
        ("part, bar D40 L60 Q1", "\"Q1\" says nothing"),
        ("part, bar D40 L6o", "\"L6o\" says nothing"),
        ("part, bar D40 L60 D30", "D is said twice"),
        ("part, bar D-40 L60", "cannot be -40"),
        ("part, bar D40 L60 Cnan", "cannot be NaN"),
        ("part, profile", "profile of the stock is missing"),
        ("part, profile Z0 D20", "2 to 256 rows"),
        ("part, profile Z0 D20 Z-5 D20 Z-3 D20", "one direction"),
        ("part, profile Z0 Z-5 D20", "Z is said twice"),
        ("part, profile Z0 D20 Z-5 D20 Z-9", "behind the last Z"),
        ("part, profile D20", "before a diameter"),
        ("part, block X0 Y0 Z-20 X100 Y60", "second X, Y or Z of the stock is missing"),
        ("part, block X0 Y0 Z0 X100 Y60 Z0", "it has no thickness there"),
        ("part, block X0 Y0 Z-20 X100 Y60 Z0 X5", "\"X5\" says nothing"),
        ("part, block X0 Y0 Z-20 X100 Y60 D5", "\"D5\" says nothing"),
        ("part, block X0 Y0 Z-20 Xnan Y60 Z0", "cannot be NaN"),
    ] {
        let error = Part::from_comment(text, 1.0).expect_err(text);
        assert!(error.to_string().contains(words), "{text}: {error}");
        assert!(error.help().contains("(part, bar D40 L60)"));
    }
    for (text, words) in [
        ("[prat]\nstock = \"bar\"", "there is no [part] in it"),
        ("[part]\nstock = \"bar\"\ndiameter_mm = 40\nlenght_mm = 60", "unknown field `lenght_mm`"),
        ("[part]\nstock = \"block\"\nfrom_mm = [0, 0, 0]", "corner to_mm of the stock is missing"),
        ("[part]\nstock = \"block\"\ndiameter_mm = 4", "\"what is round\" says nothing"),
        ("[part]\nstock = \"bar\"\nfrom_mm = [0, 0, 0]", "says nothing of this stock"),
        ("[part]\nstock = \"bra\"", "unknown variant `bra`"),
        ("[part]\nstock = \"bar\"\ndiameter_mm = 4e4\nlength_mm = 60", "cannot be 40000"),
        ("[part", "line 1"),
    ] {
        let error = Part::from_toml(text).expect_err(text);
        assert!(error.to_string().contains(words), "{text}: {error}");
    }
}
