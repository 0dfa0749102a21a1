//! What is said about lines that cannot be read: one sentence each, with its code and place.

use gcode::{Block, MAX_DIAGNOSTICS, MAX_LINE_BYTES, Parser};

fn findings(program: &[u8]) -> Vec<String> {
    let (mut parser, mut block) = (Parser::new(program, 0), Block::new());
    while parser.next(&mut block) {}
    let show = |d: diag::Diagnostic| {
        let marked = program.get(d.span.start as usize..d.span.end as usize).unwrap_or_default();
        let marked: String = String::from_utf8_lossy(marked).chars().take(20).collect();
        format!("{} line {} {marked:?}: {}", d.code, d.span.line, d.message)
    };
    parser.take_diagnostics().into_iter().map(show).collect()
}

#[test]
fn each_mistake_has_a_sentence() {
    let mistakes = "\
X Y2
G1 X1.2.3
X.
M P1
G0 X1 X2
G0 X1 N10
G0 X1 o100 sub
G0 /X1
//G0
G0 %
%foo
(a
(a (b) c)
a)
G0 ) X1
G0 X1 ?
X1 é
X[1+]
X[]
X[1,2]
X[1 2 FOO 3]
X[1
Xsin 30
X[foo[3]]
Xatan[1]
Xexists[5]
#1 5
#1
#<a=5
#<>=1
#<a(b>=1
O
O-1 sub
O100.5 sub
O100 foo
O100 G1 X1
O1 if 1
O1 while
O1 if [1] [2]
O1 endif [1]
N G0
N-5 G0
G1 X1\u{7}
G1 X1\rG1 X2
";
    insta::assert_snapshot!(findings(mistakes.as_bytes()).join("\n"));
}

#[test]
fn a_line_with_a_mistake_is_marked_and_the_next_is_read() {
    let (mut parser, mut block) = (Parser::new(b"G0 X\nG0 X1\n", 0), Block::new());
    assert!(parser.next(&mut block) && block.faulty);
    assert!(parser.next(&mut block) && !block.faulty);
    assert_eq!(block.to_string(), "G0 X1");
}

#[test]
fn nesting_has_a_limit() {
    let nested = |levels: usize| format!("X{}1{}", "[".repeat(levels), "]".repeat(levels));
    assert_eq!(findings(nested(64).as_bytes()), [""; 0]);
    assert!(findings(nested(65).as_bytes())[0].contains("at most 64 levels of nesting"));
    for deep in ["X[", "X-", "X#", "Xsin[", "X[1+", "X#[", "Xatan[1]/["] {
        let line = format!("X{}", deep[1..].repeat(MAX_LINE_BYTES / deep.len() - 1));
        assert!(findings(line.as_bytes())[0].starts_with("P0126"), "{deep}");
    }
}

#[test]
fn operations_have_a_limit() {
    let sum = |operations: usize| format!("X[1{}]", "+1".repeat(operations));
    assert_eq!(findings(sum(256).as_bytes()), [""; 0]);
    assert!(findings(sum(257).as_bytes())[0].contains("at most 256 operations"));
}

#[test]
fn a_line_of_a_hundred_million_bytes_is_one_finding() {
    let mut program = vec![b'1'; 100_000_000];
    program.extend_from_slice(b"\nG0 X1\n");
    let found = findings(&program);
    assert_eq!(found.len(), 1);
    assert!(found[0].contains("at most 65536 bytes"), "{found:?}");
}

#[test]
fn a_number_beyond_all_bounds_is_refused() {
    let digits = "9".repeat(400);
    assert!(findings(format!("G0 X{digits}").as_bytes())[0].starts_with("P0103"));
}

#[test]
fn binary_data_is_one_finding_and_ends_the_reading() {
    let elf = [b"\x7fELF\x02\x01\n".repeat(1000), vec![0; 1000], b"G0 X\n".repeat(10)].concat();
    let utf16: Vec<u8> = "G0 X1\nG0 X2\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for program in [elf, utf16, b"G0 X1 (a\0b)\n".repeat(50)] {
        let found = findings(&program);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("this is binary data"), "{found:?}");
    }
}

#[test]
fn text_that_is_not_utf8_is_a_note_in_comments_and_one_error_elsewhere() {
    let notes = findings(&b"G0 (\xE9)\nG1 (\xE9)\n".repeat(100));
    assert_eq!(notes.len(), 1);
    assert!(notes[0].contains("this comment is not UTF-8"), "{notes:?}");
    let errors = findings(&b"G0 X1 \xE9\n".repeat(200));
    assert_eq!(errors.len(), 2);
    assert!(
        errors[0].contains("found byte 0xE9") && errors[1].contains("and 199 more"),
        "{errors:?}"
    );
}

#[test]
fn a_million_mistakes_are_counted_and_a_hundred_shown() {
    let found = findings(&b"G0 X\n".repeat(1_000_000));
    assert_eq!(found.len(), MAX_DIAGNOSTICS + 1);
    let last = found.last().expect("a closing line");
    assert!(last.contains("and 999900 more, like these"), "{last}");
}

#[test]
fn a_line_read_again_in_a_loop_is_reported_once() {
    let (mut parser, mut block) = (Parser::new(b"G0 X\n", 0), Block::new());
    for _ in 0..1000 {
        parser.seek(0, 1);
        parser.next(&mut block);
    }
    assert_eq!(parser.take_diagnostics().len(), 1);
}

#[test]
fn a_misspelled_function_or_o_word_gets_the_one_that_was_meant() {
    let help = |program: &str| {
        let (mut parser, mut block) = (Parser::new(program.as_bytes(), 0), Block::new());
        while parser.next(&mut block) {}
        parser.take_diagnostics().remove(0).help
    };
    assert_eq!(help("G0 X[SINE[30]]\n").as_deref(), Some("did you mean SIN?"));
    assert_eq!(help("G0 X[SQR[30]]\n").as_deref(), Some("did you mean SQRT?"));
    assert_eq!(help("o1 endwile\n").as_deref(), Some("did you mean endwhile?"));
    assert_eq!(help("o1 foo\n"), None);
}
