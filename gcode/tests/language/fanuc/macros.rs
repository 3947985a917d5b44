//! Custom macro B: variables, expressions, arguments.

use super::recorded::{errors, moves, value};

#[test]
fn functions_and_ranks() {
    assert_eq!(value("2+3*4-10/4"), 11.5);
    assert_eq!(value("SIN[30]+COS[60]*TAN[45]"), 1.0);
    assert_eq!(value("ATAN[1]/[-1]"), 135.0);
    assert_eq!(value("ATAN[-1]/[0]"), 270.0);
    assert_eq!(value("ATAN[1]*2"), 90.0);
    assert_eq!(value("ATAN[1,1]+ASIN[1]+ACOS[0]"), 225.0);
    assert_eq!(value("SQRT[16]+ABS[-2]+ROUND[2.5]+FIX[-2.7]+FUP[2.1]"), 10.0);
    assert_eq!(value("LN[EXP[2]]+POW[2,10]"), 1026.0);
    assert_eq!(value("BIN[BCD[39]]"), 39.0);
    assert_eq!(value("BCD[39]"), 57.0);
    assert_eq!(value("7 MOD 3 + -7 MOD 3"), 0.0);
    assert_eq!(value("12 AND 10"), 8.0);
    assert_eq!(value("12 OR 3 XOR 1"), 14.0);
    assert_eq!(value("[1 LT 2] + [2 GE 2] + [1 NE 1]"), 2.0);
}

#[test]
fn vacant_is_not_zero_but_counts_as_zero() {
    assert_eq!(moves("IF [#1 EQ #0] THEN #100=1\nIF [#1 EQ 0] THEN #101=1\nG04 U[#100*2+#101]"), ["dwell 2"]);
    assert_eq!(moves("#2=0\nIF [#2 NE #0] THEN #100=3\nG04 U#100"), ["dwell 3"]);
    assert_eq!(moves("G00 X10. Z1.\nG00 X#5 Z2."), ["G0 5 1", "G0 5 2"]);
    assert_eq!(value("#7+5"), 5.0);
}

#[test]
fn variables_by_computed_numbers() {
    assert_eq!(moves("#101=7\n#1=100\nG04 U#[#1+1]\n#[#1+2]=4\nG04 U#102"), ["dwell 7", "dwell 4"]);
}

#[test]
fn arguments_by_letter() {
    let text = "G65 P9010 A1. B2. C3. D4. E5. F6. H7. I8. J9. K10. M11. Q12. R13. S14. T15. U16. V17. W18. X19. Y20. Z21.\n\
                M30\nO9010\nG04 U[#1+#2*10]\nG04 U[#7+#8*10+#9*100]\nG04 U#11\nG04 U[#4+#5+#6]\nG04 U[#13+#17+#18]\n\
                G04 U[#19+#20+#21+#22+#23]\nG04 U[#24+#25+#26]\nM99";
    assert_eq!(
        moves(text),
        ["dwell 21", "dwell 654", "dwell 7", "dwell 27", "dwell 36", "dwell 80", "dwell 60"]
    );
}

#[test]
fn arguments_by_repeated_i_j_k() {
    let text = "G65 P9010 A1. B2. C3. I4. J5. K6. I7. K9. J11.\nM30\nO9010\n\
                G04 U[#4+#5+#6]\nG04 U#7\nG04 U#9\nG04 U#11\nM99";
    assert_eq!(moves(text), ["dwell 15", "dwell 7", "dwell 9", "dwell 11"]);
}

#[test]
fn locals_belong_to_a_macro_and_shared_ones_to_all() {
    let text = "#1=5\n#100=1\nG65 P9010 A2. L2\nG04 U#1\nG04 U#100\nM30\n\
                O9010\nG04 U#1\n#1=#1+1\n#100=#100+1\nM99";
    assert_eq!(moves(text), ["dwell 2", "dwell 2", "dwell 5", "dwell 3"]);
    // M98 keeps the locals
    assert_eq!(moves("#1=5\nM98 P9010\nG04 U#1\nM30\nO9010\n#1=#1+1\nM99"), ["dwell 6"]);
}

#[test]
fn the_control_tells_where_it_is() {
    assert_eq!(moves("G00 X40. Z-3.\nG04 U#5001\nG04 U[-#5042]"), ["G0 20 -3", "dwell 40", "dwell 3"]);
}

#[test]
fn alarms_and_messages() {
    assert_eq!(errors("IF [#1 NE #0] GOTO 10\n#3000=7 (NO DEPTH GIVEN)\nN10 G00 X1."), [(2, "alarm")]);
    assert_eq!(moves("#3006=1 (TURN THE PART)"), ["M0"]);
}

#[test]
fn what_cannot_be_computed_is_refused() {
    assert_eq!(errors("#1=1/0"), [(1, "arithmetic")]);
    assert_eq!(errors("#1=SQRT[-1]"), [(1, "arithmetic")]);
    assert_eq!(errors("#50=1"), [(1, "bad-parameter")]);
    assert_eq!(errors("#1=#2001"), [(1, "not-available")]);
    assert_eq!(errors("#5001=3"), [(1, "bad-parameter")]);
    assert_eq!(errors("#0=3"), [(1, "bad-parameter")]);
    assert_eq!(errors(&format!("#1={}1{}", "[".repeat(90), "]".repeat(90))), [(1, "expression-too-deep")]);
}
