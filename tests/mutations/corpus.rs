//! FANUC programs that use what the examples lack; what else the examples have not.

/// Of lathes.
pub(crate) const FANUC: &[&str] = &[
    "O1\nG50 S2000\nT0202\nG96 S150 M03\nG00 X60. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.3\nN10 G00 X20.\nG01 Z-20. F0.1\n\
     X40. ,R2.\nG03 X50. Z-30. R10.\nN20 X60.\nG70 P10 Q20\nG28 U0 W0\nM30\n",
    "O2\nG00 X50. Z5.\nG72 W2. R0.5\nG72 P1 Q2 U0.4 W0.1 F0.3\nN1 G00 Z-20.\nG01 X40. F0.1\nN2 Z2.\nG73 U5. W2. R3\n\
     G73 P1 Q2 U0.4 W0.1\nG74 R1.\nG74 X20. Z-30. P2000 Q5000 F0.1\nG75 R1.\nG75 X10. Z-20. P2000 Q3000\nM30\n",
    "O3\nG97 S500 M03\nG00 X30. Z5.\nG76 P020060 Q100 R0.05\nG76 X26. Z-20. R-1. P1840 Q400 F1.5\nG92 X29. Z-20. F1.5\nX28.\n\
     G90 X20. Z-10. R-1. F0.2\nX18.\nG94 X10. Z-2.\nG32 Z-20. F2. Q90000\nG34 Z-40. F2. K0.1\nM30\n",
    "O4\nG65 P5 A1. B2. L2\nM98 P20006\nG42 G01 X20. Z0 F.2 T0303\nG02 X30. Z-5. R5.\nG40 G00 X50.\n#1=0\nWHILE [#1 LT 3] DO 1\n\
     #1=#1+1\nIF [#1 EQ 2] GOTO 10\nG01 U-1. W[-#1]\nN10 END 1\nG10 P1 X.1 Z.1\nM30\nO5\n#100=#1+#2\nG01 X#100\nM99\nO6\nG04 P500\n\
     M99 P10\n",
];

/// Of mills.
pub(crate) const FANUC_MILL: &[&str] = &[
    "%\nO1000 (PLATE)\nG21 G17 G40 G49 G80 G90\nG54 G94 F200.\nT1 M06\nS3000 M03\nM31\nG43 H1 Z50. M08\nG00 X0. Y0.\n\
     G41 D2 G01 X10. F300.\nY20.\nG02 X20. Y30. I10. J0.\nG03 X30. Y20. R10.\nG01 X0. A30.\nG40 Y-10.\nM32\nG91 G28 Z0.\nM05\nM30\n%\n",
    "O2\nG54.1 P3\nT2 M06\nG43 H2 G00 Z20.\nS900 M03\nG98 G81 X10. Y10. Z-8. R2. F80.\nX20. K2\nG99 G83 Y20. Z-12. R2. Q3.\n\
     G73 X0. Q2. Z-9. R1.\nG82 X5. Z-3. R1. P500\nG85 X6. Z-4. R1.\nG89 X7. Z-4. R1. P200\nG91 G81 X3. L3 Z-2. R-1.\nG90 G80\n\
     G84 X1. Z-5. R3. F1.\nG86 X2. Z-4. R1.\nG88 Y2. Z-2. R1.\nG154 P2\nM01\nM30\n",
    "O3\nG20 G90\nG10 L2 P1 X1. Y2. Z3.\nG10 L20 P4 X1.\nG10 L10 P1 R5.\nG10 L12 P2 R.25\nG52 X1. Y1.\nG68 X10. Y0. R60.\n\
     G91 G68 R30. X0. Y0.\nG90 G01 X2. Y2. F10.\nG69\nG92 X0. Y0.\nG53 Z0.\nG93 G01 X1. F4.\nG94\nG95 F.1\nX2.\nG30 Z0.\n\
     G44 H3 Z1.\nG49\nG61 X3.\nG64\nG187 P2\nG15 G50\nG09 G01 X4.\nG04 P1500\nG04 X1.5\nM97 P100 L2\nM30\nN100 G00 X1.\nM99\n",
    "O4\n#1=10.\nG65 P5 A1. B2. I3. J4. I5. L2\nG66 P5 D3. E4.\nG00 X#1 Y[#1*2.]\nX5.\nG67\nWHILE [#1 GT 0] DO 1\n#1=#1-1.\n\
     IF [#1 EQ 5] GOTO 10\nG01 X#1 F[100.+#1]\nN10 END 1\nM98 P6 L3\nM98 P20007\nG00 X400 Y-1500 Z2\nM30\nO5\nG91 G01 X#1 Y#2 F50.\n\
     G90\nM99\nO6\nG01 Z-1. F30.\nM99\nO7\nG02 X1. Y1. Z-1. I1. J0. K1.\nG18 G03 X2. Z2. R3.\nG19 G02 Y1. Z1. R9.\nG17\nM99\n",
];

/// Arrivals of a run.
pub(crate) const ARRIVALS: &str = "pitchlock arrivals 1\nmachine processes\nuntil 12345\n5004 drive-command/x 5003\n\
                5005 drive-command/x due\n7000 operator 6\n7100 axis-status/interpolator/z nothing\n";

/// Documents of somebody at the panel.
pub(crate) const PRESSES: [&str; 7] = [
    r#"{"id": 1, "do": "hold", "as": "me"}"#,
    r#"{"id": "a", "do": "spindle-override", "value": 62.5, "as": "browser-1"}"#,
    r#"{"id": 2, "do": "single-block", "value": true, "as": "x"}"#,
    r#"{"id": 3, "do": "take-seat", "as": "x"}"#,
    r#"{"id": 4, "do": "jog", "value": 1, "as": "x"}"#,
    r#"{"scope": {"signals": ["pass"], "x": "turn", "mode": "stand", "from": 10, "span": 99, "points": 100}}"#,
    r#"{"scope": {"signals": ["cycle"], "x": "time", "mode": "normal", "span": 0.1, "points": 50, "pre": 0.5,
        "trigger": {"signal": "cycle", "level": 5e2, "edge": "either"}}}"#,
];

/// A contour of each side, and a surface of each pattern, with a tool that is small beside it: what it
/// touches is looked at place by place.
pub(crate) const SMALL_JOBS: [&str; 5] = [
    "[job]\nname = \"edge\"\nkind = \"contour\"\norigin_mm = [-5, 0, 0]\ntool_number = 2\nspindle_rpm = 6000\n\
     coolant = \"flood\"\ny = \"2*sin(x/16) + x/10\"\nx = [0, 4]\ndepth_z_mm = -4\n\
     tool = { diameter_mm = 10, side = \"left\" }\nfeed_mm_min = 1200\nchord_mm = 0.02\n",
    "[job]\nkind = \"contour\"\norigin_mm = [0, 0, 0]\ny = \"sqrt(1 + x^2)\"\nx = [-1, 1]\ndepth_z_mm = -1\n\
     tool = { diameter_mm = 0.5, side = \"right\" }\nfeed_mm_min = 600\nclearance_mm = 2\n",
    "[job]\nkind = \"surface\"\norigin_mm = [0, 0, -100]\ntool_number = 3\ncoolant = \"mist\"\nz = \"x/10 + y/20\"\n\
     x = [0, 20]\ny = [0, 20]\ntool = { kind = \"ball\", diameter_mm = 2 }\n\
     path = { pattern = \"lines\", along = \"x\", step_mm = 1.9 }\nfeed_mm_min = 3000\n",
    "[job]\nkind = \"surface\"\norigin_mm = [0, 0, -100]\nz = \"x/5\"\nx = [0, 20]\ny = [0, 20]\n\
     tool = { kind = \"bull\", diameter_mm = 2, corner_mm = 0.5 }\npath = { pattern = \"rings\", step_mm = 1.2 }\n\
     feed_mm_min = 900\nclearance_mm = 2\n",
    "[job]\nkind = \"surface\"\norigin_mm = [0, 0, -100]\nz = \"x*y/90\"\nx = [0, 20]\ny = [0, 20]\n\
     tool = { kind = \"ball\", diameter_mm = 2 }\n\
     path = { pattern = \"curve\", x = \"4 + 3*cos(t)\", y = \"4 + 3*sin(t)\", t = [0, 2] }\nfeed_mm_min = 900\n",
];
