//! What holds for every text: reading never fails, and printing loses nothing.

#![allow(clippy::format_collect)] // clear beats quick in a test

use gcode::{Block, Grammar, Page, Parser};
use proptest::prelude::*;

fn blocks(program: &[u8]) -> (Vec<Block>, Vec<diag::Diagnostic>) {
    let (mut parser, mut block) = (Parser::new(program, 0), Block::new());
    let mut blocks = Vec::new();
    while parser.next(&mut block) {
        blocks.push(block.clone());
    }
    (blocks, parser.take_diagnostics())
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        (-99_999i64..99_999).prop_map(|n| n.to_string()),
        (-9_999i64..9_999, 0u32..99_999).prop_map(|(a, b)| format!("{a}.{b}")),
        any::<f64>().prop_filter("finite", |n| n.is_finite()).prop_map(|n| format!("{n}")),
        "[+-]?\\.[0-9]{1,20}",
    ]
}

fn value() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        number(),
        (1u32..5000).prop_map(|n| format!("#{n}")),
        "#<_?[a-zA-Z ]{0,4}[a-z_0-9]>",
        "exists\\[#<[a-z]{1,3}>\\]",
    ];
    leaf.prop_recursive(4, 24, 3, |inner| {
        let operator = prop::sample::select(vec![
            "**", "*", "/", "+", "-", " MOD ", " eq ", "NE", "gt", "GE", "lt", "LE", " and ", "or",
            " xor ",
        ]);
        let function = prop::sample::select(vec![
            "abs", "ACOS", "asin", "COS", "exp", "FIX", "fup", "LN", "round", "SIN", "sqrt", "tan",
        ]);
        let chain = (inner.clone(), prop::collection::vec((operator, inner.clone()), 0..4))
            .prop_map(|(first, rest)| {
                let rest: String = rest.into_iter().map(|(o, v)| format!("{o}{v}")).collect();
                format!("[{first}{rest}]")
            });
        prop_oneof![
            3 => chain.clone(),
            1 => inner.clone().prop_map(|v| format!("-{v}")),
            1 => chain.clone().prop_map(|v| format!("#{v}")),
            1 => (function, chain.clone()).prop_map(|(f, v)| format!("{f}{v}")),
            1 => (chain.clone(), chain).prop_map(|(y, x)| format!("atan{y}/{x}")),
        ]
    })
}

fn line() -> impl Strategy<Value = String> {
    let letters = prop::sample::subsequence(b"ABCDFHIJKPQRSXYZ@^$".to_vec(), 0..6);
    let words = (letters, prop::collection::vec(value(), 6)).prop_map(|(letters, values)| {
        let words = letters.iter().zip(values).map(|(l, v)| format!("{}{v} ", *l as char));
        words.collect::<String>()
    });
    let setting = (1u32..99, value()).prop_map(|(n, v)| format!("#{n}={v} "));
    let comment = "\\((MSG,|debug,|PY,|)[ a-z;#é]{0,6}\\)";
    let end = "(;[ a-z(),é]{0,8})?";
    let keyword = prop::sample::select(vec!["call", "return", "if", "while", "repeat", "endsub"]);
    let o_word =
        (value(), keyword, value()).prop_map(|(label, k, v)| format!("O[{label}] {k} [{v}]"));
    let start = "(/[0-9]?)?( N[0-9]{1,5}(\\.5)?)? ?";
    let body = prop_oneof![
        4 => (words, setting, comment).prop_map(|(w, s, c)| format!("{w}{s}{c}")),
        1 => o_word,
    ];
    (start, body, end).prop_map(|(start, body, end)| format!("{start}{body}{end}\n"))
}

/// The blocks of a text and what is found in it, read in pages of so many lines, each of them moved by what comes before.
fn by_pages(program: &[u8], grammar: Grammar, lines: u32, before: &str) -> String {
    let text = [before.as_bytes(), program].concat();
    let (mut parser, mut own) =
        (Parser::with_grammar(&text, 0, grammar), Parser::with_grammar(program, 0, grammar));
    own.seek(0, 1);
    let moved = (before.len() as u32, before.matches('\n').count() as u32);
    let (mut block, mut all) = (Block::new(), String::new());
    loop {
        let from = own.position();
        let page = Page::read(program, grammar, from, u32::MAX, lines);
        if page.blocks() == 0 {
            return all + &format!("{:?}", parser.take_diagnostics());
        }
        let here = (from.0 + moved.0, from.1 + moved.1);
        for i in 0..page.blocks() {
            let [begin, mut end] = [i, i + 1].map(|i| page.begin(i));
            assert_eq!(page.at(begin.0), Some(i));
            if !page.load(i, here, &mut block) {
                parser.seek(here.0 + begin.0, here.1 + begin.1);
                assert!(parser.next(&mut block));
                let (byte, line) = parser.position();
                end = (byte - here.0, line - here.1);
            }
            all += &format!("{block:?}\n");
            own.seek(from.0 + end.0, from.1 + end.1);
            if end != page.begin(i + 1) {
                break; // whether a text is one at all is asked once
            }
        }
    }
}

fn at_once(program: &[u8], grammar: Grammar, before: &str) -> String {
    let text = [before.as_bytes(), program].concat();
    let mut parser = Parser::with_grammar(&text, 0, grammar);
    parser.seek(before.len() as u32, 1 + before.matches('\n').count() as u32);
    let (mut block, mut all) = (Block::new(), String::new());
    while parser.next(&mut block) {
        all += &format!("{block:?}\n");
    }
    all + &format!("{:?}", parser.take_diagnostics())
}

const GRAMMARS: [Grammar; 2] = [Grammar::Rs274, Grammar::Fanuc];

proptest! {
    #[test]
    fn a_page_has_the_blocks_that_reading_gives(
        program in prop::collection::vec(prop_oneof![line(), "[ -~]{0,20}\r?\n", "N[1-9] X1(a;b);? *;Y#2\n",
            "(IF|WHILE)\\[#1 GT 2\\](GOTO|DO)1\n", "DPRNT\\[A#1\\[53\\]\\]\n"], 0..12)
            .prop_map(|lines| lines.concat()),
        lines in 1u32..6,
        before in "(G0\n){0,3}",
    ) {
        for grammar in GRAMMARS {
            let anew = at_once(program.as_bytes(), grammar, &before);
            prop_assert_eq!(by_pages(program.as_bytes(), grammar, lines, &before), anew);
        }
    }

    #[test]
    fn any_bytes_are_the_same_in_pages(program in prop::collection::vec(any::<u8>(), 0..200)) {
        for grammar in GRAMMARS {
            prop_assert_eq!(by_pages(&program, grammar, 2, ""), at_once(&program, grammar, ""));
        }
    }

    #[test]
    fn any_bytes_are_read_without_a_panic(program in prop::collection::vec(any::<u8>(), 0..400)) {
        let (blocks, found) = blocks(&program);
        prop_assert!(found.len() <= blocks.len());
    }

    #[test]
    fn text_made_of_the_languages_own_pieces_is_read_without_a_panic(
        program in "([GXYNOo#<>\\[\\]()/;%=*+. \n0-9-]|sin|sub|while|MOD|exists|\u{e9}){0,60}"
    ) {
        let (blocks, _) = blocks(program.as_bytes());
        for block in blocks {
            let _ = block.to_string();
        }
    }

    #[test]
    fn a_printed_program_read_again_is_the_same(lines in prop::collection::vec(line(), 1..5)) {
        let program = lines.concat();
        let (first, found) = blocks(program.as_bytes());
        prop_assert_eq!(found, [], "in {:?}", program);
        let printed: String = first.iter().map(|b| format!("{b}\n")).collect();
        let (second, found) = blocks(printed.as_bytes());
        prop_assert_eq!(found, [], "in {:?}", printed);
        prop_assert_eq!(first.len(), second.len());
        for (a, b) in first.iter().zip(&second) {
            prop_assert!(a.says_the_same(b), "{} against {}", a, b);
            prop_assert_eq!(a.to_string(), b.to_string());
        }
    }

    #[test]
    fn a_number_read_by_hand_is_the_number_the_standard_library_reads(
        text in "-?[0-9]{1,12}\\.[0-9]{1,9}"
    ) {
        let (blocks, _) = blocks(format!("X{text}").as_bytes());
        let expected: f64 = text.parse().expect("a number");
        let gcode::Value::Number(number) = blocks[0].words[0].value else { panic!("a number") };
        prop_assert_eq!(number.to_bits(), expected.to_bits());
    }

    #[test]
    fn every_span_lies_in_its_line(program in "([GXY#\\[\\] ()0-9.=\n-]|sin|é){0,60}") {
        let (blocks, found) = blocks(program.as_bytes());
        for block in &blocks {
            for word in &block.words {
                prop_assert!(word.span.start >= block.span.start && word.span.end <= block.span.end);
            }
        }
        for d in found {
            prop_assert!(d.span.start <= d.span.end && d.span.end as usize <= program.len());
        }
    }
}
