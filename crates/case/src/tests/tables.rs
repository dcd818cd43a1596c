//! Tables: their use in formulas, and their errors.

use super::*;

/// A square whose boundary moves along x by a table.
const TABLE: &str = "[mesh]\norder = 2\ngenerate.box = { lower = [0, 0], upper = [1, 1], cells = [1, 1] }\n\
                     [time]\norder = 2\nend = 4\nslabs = 4\n[motion]\nboundary.others.displacement = [\"2*way(t)\", 0]\n[tables.way]\n";

fn with(lines: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{TABLE}{lines}"), &[])
}

/// The displacement of the boundary along x, and its rate.
fn moved(case: Result<AnyCase, Box<CaseError>>, t: f64) -> [f64; 2] {
    let Ok(AnyCase::Plane(case)) = case else { panic!("{case:?}") };
    let Some(Motion::Elastic { boundary, .. }) = case.motion else { panic!("elastic") };
    let Some(BoundaryMotion::Formulas(vector)) = &boundary[0] else { panic!("by formulas") };
    [vector.value(&[0.0; 2], t)[0], vector.rate(&[0.0; 2], t)[0]]
}

#[test]
fn a_table_is_a_function_in_formulas() {
    // The cubic t (t - 4)^2 / 4 and its rate are reproduced exactly.
    let exact = |t: f64| [t * (t - 4.0).powi(2) / 2.0, (t - 4.0) * (3.0 * t - 4.0) / 2.0];
    for t in [0.0, 0.4, 1.7, 3.2, 4.0] {
        let found = moved(with("t = [0, 1, 2, 3, 4]\nvalues = [0, 2.25, 2, 0.75, 0]"), t);
        assert!((0..2).all(|i| (found[i] - exact(t)[i]).abs() < 1e-13), "{found:?} at {t}");
    }
    let periodic = "t = [0, 0.25, 0.5, 0.75, 1]\nvalues = [0, 1, 0, -1, 0]\nends = \"periodic\"";
    let [now, later] = [0.3, 3.3].map(|t| moved(with(periodic), t));
    assert!((0..2).all(|i| (now[i] - later[i]).abs() < 1e-12), "{now:?} {later:?}");
    assert_eq!(moved(with("t = [0, 1]\nvalues = [0, 1]\nends = \"at_rest\""), 3.0), [2.0, 0.0]);
}

#[test]
fn a_table_may_be_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let case = |file: &str, lines: &str| {
        std::fs::write(directory.path().join("way.csv"), file).unwrap();
        let text = format!("{TABLE}file = \"way.csv\"\nends = \"at_rest\"\n{lines}");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    let header = "# a motion\nt, pitch, heave\n0, 5, 0\n1, 6, 1\n\n2, 7, 3 # the last\n";
    assert_eq!(moved(case(header, "column = \"heave\""), 4.0), [6.0, 0.0]);
    assert_eq!(moved(case("0 0 5\n1 2 6\n", ""), 4.0), [4.0, 0.0], "the second column, without names");
    for (file, lines, expected) in [
        (header, "column = \"heav\"", ["unknown column `heav`", "did you mean `heave`"]),
        (header, "", ["the displacement at the start", "`[tables]`"]),
        (
            "t lift force heave\n0 5 0\n1 5 0\n",
            "column = \"heave\"",
            ["way.csv:2: 3 entries in `0 5 0`, but 4 in line 1", ""],
        ),
        ("0, 0\n1, x\n", "", ["way.csv:2: no numbers in columns 1 and 2 of `1, x`", "separated by semicolons"]),
        ("0, 0\n\n1, 2, 3\n", "", ["way.csv:3: 3 entries in `1, 2, 3`, but 2 in line 1", "the same number"]),
        ("0, 0\n", "", ["1 points", "needs 2"]),
        ("1, 0\n0, 0\n", "", ["times must increase", "0 follows 1"]),
    ] {
        let message = case(file, lines).unwrap_err().to_string();
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// Files of spreadsheets: semicolons, decimal commas, tabs, units, a line of units; a column by its number.
#[test]
fn tables_of_spreadsheets_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let heave = |file: &str, column: &str| {
        std::fs::write(directory.path().join("way.csv"), file).unwrap();
        let text = format!("{TABLE}file = \"way.csv\"\nends = \"at_rest\"\n{column}");
        let document = Document::parse(&directory.path().join("case.toml"), text, &[]);
        moved(document.and_then(|document| AnyCase::check(&document)), 4.0)[0]
    };
    for (file, column) in [
        ("t [s]; pitch [deg]; heave [m]\n0;5;0\n1;6;1\n2;7;3\n", "column = \"heave\""),
        ("t [s]; pitch [deg]; heave [m]\n0;5;0\n1;6;1\n2;7;3\n", "column = 3"),
        ("\"t\",\"pitch\",\"heave (m)\"\n0,5,0\n1,6,1\n2,7,3\n", "column = \"heave (m)\""),
        ("t,\"lift, drag\",heave,pitch\n0,5,0,1\n1,5,1,1\n2,5,3,1\n", "column = \"heave\""),
        ("\"t\" \"the pitch\" heave\n0 5 0\n1 5 1\n2 5 3\n", "column = \"heave\""),
        ("t,\"run #3\",heave # of 5\n0,5,0\n1,5,1\n2,5,3\n", "column = \"heave\""),
        ("t,width 12\",heave,\n0,5,0\n1,5,1\n2,5,3\n", "column = \"heave\""),
        ("t;pitch;heave/m\ns;deg;m\n0,0;5,5;0,0\n1,0;6,5;1,0\n2,0;7,5;3,0\n", "column = \"heave\""),
        ("t\tthe pitch\theave\n0,0\t5,5\t0\n1,0\t6,5\t1\n2,0\t7,5\t3,0\n", "column = \"heave\""),
        ("  0   5   0\n  1   6   1\n  2   7   3\n", "column = 3"),
        ("t pitch heave\n0 5 0\n1,0 5,5 1,0\n2,0 5,5 3\n", "column = \"heave\""),
        // As NumPy writes them: the last comment above the numbers holds the names.
        ("# a motion\n# t pitch heave\n0 5 0\n1 5 1\n# half-way\n2 5 3\n", "column = \"heave\""),
    ] {
        assert_eq!(heave(file, column), 6.0, "{file}");
    }
    let message = with("file = \"none.csv\"\ncolumn = -1").unwrap_err().to_string();
    assert!(message.contains("`tables.way.column = -1`") && message.contains("a whole number from 1"), "{message}");
    let message = with("t = [0, 1]\nvalues = [0, 1]\ncolumn = 0").unwrap_err().to_string();
    assert!(message.contains("`column` is that of a file"), "{message}");
}

/// The first of two columns of one name was taken without a word; entries were shown as they had been read, not as they stand.
#[test]
fn columns_of_one_name_and_lines_that_cannot_be_read_are_told() {
    let directory = tempfile::tempdir().unwrap();
    let refused = |file: &str| {
        std::fs::write(directory.path().join("way.csv"), file).unwrap();
        let text = format!("{TABLE}file = \"way.csv\"\ncolumn = \"heave\"\nends = \"at_rest\"");
        let document = Document::parse(&directory.path().join("case.toml"), text, &[]);
        document.and_then(|document| AnyCase::check(&document)).unwrap_err().to_string()
    };
    let message = refused("t,heave,heave\n0,0,0\n1,1,2\n");
    assert!(message.contains("columns 2 and 3 are called \"heave\"") && message.contains("the number"), "{message}");
    let message = refused("t;heave\n0;0\n1; one\n");
    assert!(message.contains("`1; one`"), "{message}");
}

#[test]
fn what_is_wrong_with_a_table_is_named_by_its_key() {
    for (lines, expected) in [
        ("", ["`tables.way`", "the table is empty", "`t` and `values`, or `file`"]),
        ("t = [0, 1]", ["`tables.way`", "half of the table is missing", "`file`"]),
        ("t = [0]\nfile = \"a\"", ["`tables.way`", "given twice", "`file`"]),
        ("t = [0, 1]\nvalues = [0]", ["`tables.way.values = [0]`", "2 times, but 1 values", "12 |"]),
        ("t = [0, 1]\nvalues = [0, 0]\ncolumn = \"a\"", ["`tables.way.column", "is that of a file", "`file` instead"]),
        ("file = \"none.csv\"", ["`tables.way.file", "cannot read dir/none.csv", "No such file"]),
        (
            "t = [0, 1, 2, 3]\nvalues = [0, 1, 2, 3]",
            ["others.displacement", "`way` reaches from 0 to 3", "\"at_rest\""],
        ),
        ("t = [0, 4]\nvalues = [1, 2]\nends = \"at_rest\"", ["displacement at the start", "t = 0, is 2e0", "zero"]),
        ("t = [1, 2, 3, 4]\nvalues = [0, 1, 2, 2]", ["has no value at", "t = 0;", "`way` reaches from 1 to 4"]),
        ("t = [0, 4]\nvalues = [0, 2]\nends = \"rest\"", ["ends = \"rest\"`", "`at_rest`", "`periodic`"]),
    ] {
        let message = with(lines).unwrap_err().to_string();
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let message = check_text(
        &TABLE
            .replace("way(t)", "way")
            .replace("[tables.way]", "[tables.way]\nt = [0, 4]\nvalues = [0, 1]\nends = \"at_rest\""),
        &[],
    )
    .unwrap_err()
    .to_string();
    assert!(message.contains("`way` is a table: write `way(t)`"), "{message}");
    let message =
        check_text(&TABLE.replace("tables.way", "tables.sin"), &["tables.sin={t=[0,4],values=[0,0],ends=\"at_rest\"}"])
            .unwrap_err()
            .to_string();
    assert!(message.contains("a table cannot be called `sin`"), "{message}");
}
