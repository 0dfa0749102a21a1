//! Formatting changes the spacing of a program and nothing else: what its blocks say, by which
//! numbers its programs are called, and the order in which its operators bind are the same before
//! and after, in both grammars.
use crate::common;
use gcode::{Block, Grammar, Parser, format};
use proptest::prelude::*;
use std::path::Path;
use test_support::size;

const GRAMMARS: [Grammar; 3] = [Grammar::Rs274, Grammar::Grbl, Grammar::Fanuc];

fn blocks(text: &[u8], grammar: Grammar) -> Vec<Block> {
    let (mut parser, mut block) = (Parser::with_grammar(text, 0, grammar), Block::new());
    let mut blocks = Vec::new();
    let mut tape = 0;
    while tape < 2 && parser.next(&mut block) {
        tape += u8::from(block.percent);
        blocks.push(block.clone());
    }
    blocks
}

/// O1000, :1000, M98 P0012 and T0101 as they are to be written: letter and digits, blanks apart.
fn names(text: &[u8], grammar: Grammar, formatted: bool) -> Vec<String> {
    let written = |from: u32, to: u32| -> String {
        let bytes = text.get(from as usize..to as usize).unwrap_or_default();
        bytes.iter().filter(|b| !b.is_ascii_whitespace()).map(|b| char::from(*b)).collect()
    };
    let mut names = Vec::new();
    for block in blocks(text, grammar).iter().filter(|block| !block.faulty) {
        if let Some(o) = block.o {
            let head = written(o.span.start, o.span.end);
            let begins_a_program = o.keyword == gcode::Keyword::Program;
            let letter = match (&head[..1], begins_a_program) {
                (letter, _) if formatted => letter,
                (":", _) => ":",
                (_, true) => "O",
                (_, false) => "o",
            };
            let digits = head[1..].chars().take_while(char::is_ascii_digit);
            names.push(letter.to_owned() + &digits.collect::<String>());
        }
        let calls = block.words.iter().any(|word| {
            let codes = [(b'M', 98.0), (b'M', 198.0), (b'G', 65.0), (b'G', 66.0)];
            codes.iter().any(|(letter, number)| {
                (word.letter, word.value) == (*letter, gcode::Value::Number(*number))
            })
        });
        for word in block.words.iter().filter(|w| w.letter == b'T' || w.letter == b'P' && calls) {
            names.push(written(word.span.start + 1, word.span.end));
        }
    }
    names
}

/// What is wrong with a text's formatting, if anything.
fn difference(text: &[u8], grammar: Grammar) -> Option<String> {
    let anew = format(text, grammar);
    let (before, after) = (blocks(text, grammar), blocks(&anew, grammar));
    if before.len() != after.len() {
        return Some(format!("{} blocks became {}", before.len(), after.len()));
    }
    if let Some((a, b)) =
        before.iter().zip(&after).find(|(a, b)| common::content(a) != common::content(b))
    {
        return Some(format!("line {}: {a} became {b}", a.span.line));
    }
    let (before, after) = (names(text, grammar, false), names(&anew, grammar, true));
    if before != after {
        let pair = before.iter().zip(&after).find(|(a, b)| a != b);
        return Some(format!("program numbers: {pair:?}"));
    }
    (format(&anew, grammar) != anew).then(|| "formatting it again changes it again".to_owned())
}

fn line() -> impl Strategy<Value = String> {
    let number = "[0-9]{1,6}";
    let head =
        (prop::sample::select(vec!["O", "o", ":", "O "]), number, "( ?\\([A-Z a-z]{0,6}\\))?")
            .prop_map(|(letter, number, comment)| format!("{letter}{number}{comment}"));
    let pair =
        (number, prop::sample::select(vec!["sub", "ENDSUB", " call [#1]", "if[1]", "endif"]))
            .prop_map(|(number, keyword)| format!("O{number}{keyword}"));
    let call = (prop::sample::select(vec!["m98p", "M98 P", "G65 P", "g66p", "M198P"]), number)
        .prop_map(|(code, number)| format!("{code}{number}"));
    let tool = number.prop_map(|number| format!("t{number}m6"));
    let leaf = prop_oneof!["#[1-9]", "[1-9]\\.?", "-[1-9]", "-#[1-9]"];
    let value = leaf.prop_recursive(4, 20, 3, |inner| {
        let operator = prop::sample::select(vec![
            "*", "/", "+", "-", " MOD ", " EQ ", "NE", "gt", " AND ", "or", " xor ",
        ]);
        (inner.clone(), prop::collection::vec((operator, inner), 0..4)).prop_map(|(first, rest)| {
            let rest: Vec<_> = rest.into_iter().map(|(o, v)| format!("{o}{v}")).collect();
            format!("[{first}{}]", rest.concat())
        })
    });
    let setting = (1u32..99, value.clone()).prop_map(|(n, v)| format!("#{n}={v}"));
    let moves = ("[xXyZ]", value).prop_map(|(letter, v)| format!("g01{letter}{v}f100."));
    let steers = prop::sample::select(vec![
        "IF[#1gt5]GOTO20",
        "n0020",
        "while[#1le3]DO1",
        "END1",
        "%",
        "G1 X1.,R2.",
        "N10 x10 y.5",
        "",
    ]);
    prop_oneof![head, pair, call, tool, setting, moves, steers.prop_map(str::to_owned)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(400, 4000), ..ProptestConfig::default() })]

    #[test]
    fn a_formatted_program_says_the_same_and_has_the_same_numbers(
        lines in prop::collection::vec(line(), 1..8),
        end in prop::sample::select(vec!["\n", "\r\n"]),
    ) {
        let text = lines.join(end) + end;
        for grammar in GRAMMARS {
            prop_assert_eq!(difference(text.as_bytes(), grammar), None, "{:?}: {:?}", grammar, text);
        }
    }
}

/// The shipped programs, and those that are compared with LinuxCNC's interpreter.
#[test]
fn every_program_at_hand_says_the_same_when_it_is_formatted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut checked = 0;
    for folder in ["programs", "crates/interp/tests/parity/good", "crates/interp/tests/parity/bad"]
    {
        for entry in std::fs::read_dir(root.join(folder)).expect("the folder is there") {
            let path = entry.expect("it is read").path();
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
            if !["ngc", "nc", "tap", "cnc"].contains(&ending) {
                continue;
            }
            let text = std::fs::read(&path).expect("it is read");
            for grammar in GRAMMARS {
                assert_eq!(difference(&text, grammar), None, "{} {grammar:?}", path.display());
            }
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked} programs");
}

#[test]
fn a_setting_before_a_word_says_the_same_as_behind_it() {
    let read = |text: &str| {
        let (mut parser, mut block) = (Parser::new(text.as_bytes(), 0), Block::new());
        assert!(parser.next(&mut block), "{text}");
        block
    };
    let before = read("#<unit>=[#<a>+1] G0 X[#<back>*2] (a \"note\")");
    let behind = read("G0 X[#<back>*2] #<unit>=[#<a>+1] (a \"note\")");
    assert_eq!(common::content(&before), common::content(&behind));
    let other = read("G0 X[#<back>*2] #<unit>=[#<b>+1] (a \"note\")");
    assert_ne!(common::content(&before), common::content(&other));
}
