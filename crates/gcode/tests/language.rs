//! The language, rule by rule. Where LinuxCNC 2.9's `rs274` prints a number for a line, the number
//! here is the one it printed.

use gcode::CommentKind::{Debug, LogClose, Message, Plain, Print, Python};
use gcode::{Block, Expr, Function, Keyword, Operator, Parser, Value};

/// The blocks of a program that must be free of mistakes.
fn read(program: &str) -> Vec<Block> {
    let (mut parser, mut block) = (Parser::new(program.as_bytes(), 0), Block::new());
    let mut blocks = Vec::new();
    while parser.next(&mut block) {
        blocks.push(block.clone());
    }
    assert_eq!(parser.take_diagnostics(), [], "in {program:?}");
    blocks
}

/// A line, written the canonical way.
fn canonical(line: &str) -> String {
    read(line).first().map(ToString::to_string).unwrap_or_default()
}

/// What the X word of a line comes to; parameter n holds n + 1.
fn x(line: &str) -> f64 {
    let block = &read(line)[0];
    value(block, block.word(b'X').expect("an X word").value)
}

fn value(block: &Block, v: Value) -> f64 {
    let truth = |b: bool| f64::from(u8::from(b));
    let Value::Expression(id) = v else {
        let Value::Number(number) = v else { unreachable!() };
        return number;
    };
    match block.expr(id) {
        Expr::Parameter(gcode::Parameter::Numbered(index)) => value(block, index) + 1.0,
        Expr::Negate(v) => -value(block, v),
        Expr::Function { function: Function::Abs, argument } => value(block, argument).abs(),
        Expr::Function { function: Function::Sin, argument } => {
            value(block, argument).to_radians().sin()
        }
        Expr::Atan { y, x } => value(block, y).atan2(value(block, x)).to_degrees(),
        Expr::Binary { operator, left, right } => {
            let (a, b) = (value(block, left), value(block, right));
            match operator {
                Operator::Power => a.powf(b),
                Operator::Times => a * b,
                Operator::Divide => a / b,
                Operator::Modulo => a.rem_euclid(b),
                Operator::Plus => a + b,
                Operator::Minus => a - b,
                Operator::Equal => truth(a == b),
                Operator::NotEqual => truth(a != b),
                Operator::Greater => truth(a > b),
                Operator::GreaterOrEqual => truth(a >= b),
                Operator::Less => truth(a < b),
                Operator::LessOrEqual => truth(a <= b),
                Operator::And => truth(a != 0.0 && b != 0.0),
                Operator::Or => truth(a != 0.0 || b != 0.0),
                Operator::Xor => truth((a != 0.0) != (b != 0.0)),
            }
        }
        other => panic!("not needed here: {other:?}"),
    }
}

#[test]
fn blanks_and_case_mean_nothing_outside_comments() {
    assert_eq!(canonical("g 1 x 1 . 5\tf100"), "G1 X1.5 F100");
    assert_eq!(canonical("G1 X1 2"), "G1 X12");
    assert_eq!(canonical("G1X-.5Y+.25Z3."), "G1 X-0.5 Y0.25 Z3");
    assert_eq!(canonical("o100 W h I l e [1 g T 0]"), "o100 while [1 GT 0]");
    assert_eq!(canonical("#< _My Depth > = 3"), "#<_mydepth>=3");
    assert_eq!(canonical("(Two  Blanks)"), "(Two  Blanks)");
}

#[test]
fn every_letter_and_the_three_signs_are_words() {
    let line = "A1 B2 C3 D4 E5 F6 G7 H8 I9 J10 K11 L12 M13 P14 Q15 R16 S17 T18 U19 V20 W21 X22 Y23 \
                Z24 @25 ^26 $27";
    assert_eq!(canonical(line), line.replace("  ", " "));
    assert_eq!(read(line)[0].words.len(), 27);
}

#[test]
fn g_and_m_may_occur_several_times() {
    assert_eq!(canonical("G90 G1 M3 M8 G94 X1"), "G90 G1 M3 M8 G94 X1");
}

#[test]
fn a_word_and_a_line_know_where_they_stand() {
    let blocks = read("G0\r\n\n  X 1 . 5 (c) #2 = [1 + 2]\n");
    let at = |s: diag::Span| (s.line, s.start, s.end);
    assert_eq!(at(blocks[0].span), (1, 0, 2));
    assert_eq!(at(blocks[1].span), (2, 4, 4));
    assert_eq!(at(blocks[2].span), (3, 5, 31));
    assert_eq!(at(blocks[2].words[0].span), (3, 7, 14));
    assert_eq!(at(blocks[2].comments[0].span), (3, 15, 18));
    assert_eq!(at(blocks[2].assignments[0].span), (3, 19, 31));
    let Value::Expression(sum) = blocks[2].assignments[0].value else { panic!("a sum") };
    assert_eq!(at(blocks[2].expr_span(sum)), (3, 25, 30));
}

#[test]
fn signs_may_be_repeated() {
    assert_eq!(x("X--5"), 5.0);
    assert_eq!(x("X+-5"), -5.0);
    assert_eq!(x("X-+-5"), 5.0);
}

#[test]
fn a_sign_binds_more_strongly_than_a_power() {
    assert_eq!(x("X[-2**2]"), 4.0);
    assert_eq!(x("X[-#1**2]"), 4.0);
    assert_eq!(x("X[2*-3]"), -6.0);
}

#[test]
fn equal_operators_associate_to_the_left() {
    assert_eq!(x("X[2**3**2]"), 64.0);
    assert_eq!(x("X[8/4/2]"), 1.0);
    assert_eq!(x("X[1-2-3]"), -4.0);
}

#[test]
fn products_before_sums_before_comparisons_before_logic() {
    assert_eq!(x("X[1+2*3 - 4 / 2]"), 5.0);
    assert_eq!(x("X[1 EQ 1 AND 2 GT 1]"), 1.0);
    assert_eq!(x("X[1 + 1 EQ 2]"), 1.0);
    assert_eq!(x("X[0 AND 0 OR 1]"), 1.0);
    assert_eq!(x("X[7 MOD 4 + 1]"), 4.0);
}

#[test]
fn a_function_may_follow_an_operator_without_a_blank() {
    assert_eq!(x("X[2MODABS[-3]]"), 2.0);
    assert_eq!(canonical("X[1ANDABS[2]]"), "X[1 AND ABS[2]]");
}

#[test]
fn functions_need_no_brackets_around_them() {
    assert!((x("Xsin[30]") - 0.5).abs() < 1e-15);
    assert!((x("X-sin[30]") + 0.5).abs() < 1e-15);
    assert_eq!(x("Xatan[1]/[1]"), 45.0);
    assert_eq!(x("X[atan[1]/[1]/5]"), 9.0);
}

#[test]
fn parameters_may_be_reached_through_parameters() {
    assert_eq!(x("X#1"), 2.0);
    assert_eq!(x("X##1"), 3.0);
    assert_eq!(x("X#[1+1]"), 3.0);
    assert_eq!(x("X-##1"), -3.0);
    assert_eq!(canonical("X#<_hal[axis.0]>"), "X#<_hal[axis.0]>");
    assert_eq!(canonical("X exists [ # <a> ]"), "XEXISTS[#<a>]");
}

#[test]
fn a_block_holds_several_settings_among_its_words() {
    let block = &read("#1=1 G0 #2=[#1+5] X#1 #<_g>=-#2 (c)")[0];
    assert_eq!(block.assignments.len(), 3);
    assert_eq!(block.words.len(), 2);
    assert_eq!(block.to_string(), "G0 X#1 #1=1 #2=[#1+5] #<_g>=-#2 (c)");
}

#[test]
fn brackets_that_change_nothing_are_not_kept() {
    assert_eq!(canonical("X[[[5]]] Y[[1*2]+3] Z[1*[2+3]]"), "X5 Y[1*2+3] Z[1*[2+3]]");
    assert_eq!(canonical("X-[5] Y-[-5] Z[1-[2-3]]"), "X-[5] Y--5 Z[1-[2-3]]");
}

#[test]
fn block_delete_has_a_level_and_n_any_number() {
    assert_eq!(read("/G0")[0].delete, Some(1));
    assert_eq!(read("/3 G0")[0].delete, Some(3));
    assert_eq!(read("G0")[0].delete, None);
    assert_eq!(read("N10.5 G0")[0].number, Some(10.5));
    assert_eq!(canonical("/N99999999 G0"), "/N99999999 G0");
}

#[test]
fn comments_say_what_they_ask_for() {
    let kinds = |line: &str| {
        let block = read(line).remove(0);
        block.comments.iter().map(|c| (c.kind, block.text(c.text).to_owned())).collect::<Vec<_>>()
    };
    assert_eq!(kinds("( msg, Load #3)"), [(Message, " Load #3".into())]);
    assert_eq!(
        kinds("(debug,#1)(PRINT,x)(LogClose)"),
        [(Debug, "#1".into()), (Print, "x".into()), (LogClose, String::new())]
    );
    assert_eq!(kinds("(DEBUG , z)"), [(Plain, "DEBUG , z".into())]);
    assert_eq!(kinds("(logclosely)"), [(Plain, "logclosely".into())]);
    assert_eq!(kinds("G0 ;msg, (not) shown"), [(Plain, "msg, (not) shown".into())]);
    assert_eq!(kinds(";py,x=1"), [(Python, "x=1".into())]);
    assert_eq!(kinds("(a ; b) Y2 ; c"), [(Plain, "a ; b".into()), (Plain, " c".into())]);
}

#[test]
fn o_words_come_with_numbers_names_and_expressions() {
    let forms = [
        "o100",
        "o100 sub",
        "o<a> endsub",
        "o100 endsub [#1]",
        "o1 return [1+2]",
        "o1 return",
        "o<probe_z> call [1] [#2] [SIN[30]]",
        "o[#101+2] call",
        "o#1 if [#2 GT 0]",
        "o1 elseif [1]",
        "o1 else",
        "o1 endif",
        "o1 while [#1 LT 5]",
        "o1 endwhile",
        "o1 do",
        "o1 repeat [5]",
        "o1 endrepeat",
        "o1 break",
        "o1 continue",
    ];
    for form in forms {
        assert_eq!(canonical(form), form);
        assert_eq!(canonical(&form.replace(' ', "")), form);
    }
    let call = &read("N10 O<Tap Hole> CALL [1][2] (c)")[0];
    let o = call.o.expect("an O-word");
    assert_eq!((o.keyword, call.arguments.len(), call.number), (Keyword::Call, 2, Some(10.0)));
}

#[test]
fn a_percent_sign_stands_alone() {
    let blocks = read(" % \nG0\n%\r\n");
    assert_eq!(blocks.iter().map(|b| b.percent).collect::<Vec<_>>(), [true, false, true]);
}

#[test]
fn a_byte_order_mark_and_crlf_are_no_mistakes() {
    let blocks = read("\u{feff}G0 X1\r\nG1\r\n");
    assert_eq!(blocks.iter().map(ToString::to_string).collect::<Vec<_>>(), ["G0 X1", "G1"]);
}

#[test]
fn numbers_are_the_nearest_that_exist() {
    for text in [
        "0.1",
        "123456.789012",
        "999999999999999",
        "0.30000000000000004",
        "1.7976931348623157",
        "123456789012345678901234567890",
        "0.000000000000000000000000000001",
        "4.35",
        "0.000001",
    ] {
        assert_eq!(x(&format!("X{text}")), text.parse::<f64>().expect("a number"));
    }
    assert_eq!(x("X-0").to_bits(), (-0.0f64).to_bits());
}

#[test]
fn reading_can_go_on_at_any_block() {
    let program = b"G0 X1\nG0 X2\nG0 X3\n";
    let (mut parser, mut block) = (Parser::new(program, 7), Block::new());
    assert!(parser.next(&mut block) && parser.next(&mut block));
    let (second, third) = (block.span, parser.position());
    assert!(parser.next(&mut block));
    assert!(!parser.next(&mut block));
    parser.seek(second.start, second.line);
    assert!(parser.next(&mut block));
    assert_eq!((block.to_string(), block.span), ("G0 X2".to_owned(), second));
    assert_eq!((parser.position(), second.file), (third, 7));
}

#[test]
fn the_next_o_word_is_found_without_reading_what_lies_between() {
    let program = b"G0 X1\n(for you)\no100 sub\nG1 foo\n/N5 O100 endsub\nM2";
    let (mut parser, mut block) = (Parser::new(program, 0), Block::new());
    let mut found = Vec::new();
    while parser.next_o_word(&mut block) {
        found.push((block.span.line, block.to_string()));
    }
    assert_eq!(found, [(3, "o100 sub".to_owned()), (5, "/N5 o100 endsub".to_owned())]);
    assert_eq!(parser.take_diagnostics(), []);
}
