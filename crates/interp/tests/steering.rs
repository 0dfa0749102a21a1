//! Which block comes next: branches, loops and subprograms, their limits, and errors that all come
//! at once.

use crate::shop::{ends, near, ops_of, refused, shop};
use interp::{Setup, Subprogram};

#[test]
fn all_errors_come_at_once_each_with_its_line() {
    let found = interp::check(b"G1 X1\nG2 X1\nQ5\nG12\nG1 X[1/0] F1\nX#<nothing>\nM2\n", &shop());
    let lines: Vec<_> = found.iter().map(|d| (d.span.line, d.code)).collect();
    assert_eq!(
        lines,
        [(1, "I0408"), (2, "I0411"), (3, "I0110"), (4, "I0102"), (5, "I0203"), (6, "I0207")]
    );
}

#[test]
fn a_program_that_is_cut_off_is_refused() {
    let found = interp::check(b"G0 X1\nG0 X2", &shop());
    assert_eq!(found.iter().map(|d| (d.code, d.span.line)).collect::<Vec<_>>(), [("I0301", 2)]);
}

#[test]
fn an_endless_loop_is_stopped_by_a_stated_limit() {
    let mut setup = shop();
    setup.limits.blocks = 1000;
    let fault = refused(&setup, "o1 while [1]\n#1=[#1+1]\no1 endwhile", "I0803");
    assert_eq!(fault.message, "stopped after 1000 blocks: does this loop end?");
}

#[test]
fn a_subprogram_that_calls_itself_for_ever_is_stopped() {
    let fault = refused(&shop(), "o1 sub\no1 call\no1 endsub\no1 call", "I0801");
    assert_eq!(fault.message, "subprograms call each other more than 64 levels deep");
}

#[test]
fn subprograms_take_arguments_give_values_back_and_keep_their_own_parameters() {
    let program = "#1=7 #<mine>=3\no<twice> sub\n#<mine>=1\no<twice> endsub [#1*2]\no<twice> call [21]\nG0 X#<_value> Y#1 Z#<mine>";
    near(&ends(&ops_of(&shop(), program)), &[[42.0, 7.0, 3.0]]);
}

#[test]
fn loops_and_branches_go_where_they_should() {
    let program = "o1 repeat [3]\n#5=[#5+1]\no2 if [#5 EQ 2]\no1 continue\no2 elseif [#5 EQ 3]\nG0 Y#5\no2 else\nG0 X#5\no2 endif\no1 endrepeat\n\
                   o3 do\n#5=[#5+1]\no4 if [#5 GT 5]\no3 break\no4 endif\no3 while [1]\nG0 Z#5";
    near(&ends(&ops_of(&shop(), program)), &[[1.0, 0.0, 0.0], [1.0, 3.0, 0.0], [1.0, 3.0, 6.0]]);
}

#[test]
fn o_words_that_do_not_match_are_all_reported_before_any_is_executed() {
    let found = interp::check(b"o1 if [1]\no2 endif\no3 while [1]\nM2\n", &shop());
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), ["I0305", "I0308", "I0305"]);
}

#[test]
fn m98_calls_a_program_as_often_as_l_says() {
    near(
        &ends(&ops_of(&shop(), "G91\nM98 P100 L3\nM2\nO100\nG0 X1\nM99")),
        &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
    );
}

#[test]
fn a_subprogram_may_be_a_file_of_its_own() {
    let mut setup = shop();
    setup.subprograms.push(Subprogram {
        name: "go".into(),
        source: b"o<go> sub\nG0 X#1\no<go> endsub\nM2\n".to_vec(),
    });
    let program = "o<go> call [4]\nG0 Y1";
    near(&ends(&ops_of(&setup, program)), &[[4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]);
    assert_eq!(interp::called_files(program.as_bytes(), gcode::Grammar::Rs274), ["go"]);
}

#[test]
fn a_loop_whose_counting_fails_does_not_run_for_ever() {
    let found = interp::check(b"o1 while [#1 LT 5]\n#1=[#1+1/0]\no1 endwhile\nM2\n", &shop());
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), ["I0203"]);
}

#[test]
fn block_delete_leaves_out_what_begins_with_a_stroke() {
    let program = "/G0 X1\nG0 X2";
    near(&ends(&ops_of(&shop(), program)), &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    near(&ends(&ops_of(&Setup { block_delete: true, ..shop() }, program)), &[[2.0, 0.0, 0.0]]);
}
