//! `leadscrew explain`: what the code of a finding or the number of an alarm means.
use crate::args::ExplainArgs;
use crate::say;
use control::Refused;
use kernel::FaultKind;

/// Say what each code means; without one, the page of all findings.
pub(crate) fn command(args: &ExplainArgs) -> Result<(), Refused> {
    if args.codes.is_empty() {
        return say::out(&interp::explanations());
    }
    let mut wrong = Vec::new();
    let mut said = Vec::new();
    for code in &args.codes {
        match explained(code) {
            Some(text) => said.push(text),
            None => wrong.push(code.as_str()),
        }
    }
    if !wrong.is_empty() {
        return Err(Refused::because(format!(
            "no such code: {}; a finding has a letter and four digits, as in I0501, an alarm three digits, as in 105; \
             leadscrew explain without a code lists the findings",
            wrong.join(", ")
        )));
    }
    say::out(&said.join("\n"))
}

fn explained(code: &str) -> Option<String> {
    if let Ok(number) = code.parse::<u16>() {
        let kind = FaultKind::ALL.into_iter().find(|kind| kind.number() == number)?;
        return Some(format!(
            "### Alarm {number}\n\n{}.\n\nCause: {}\n\nRemedy: {}\n",
            kind.sentence(),
            kind.cause(),
            kind.remedy()
        ));
    }
    interp::explanation(&code.to_ascii_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_and_alarms_are_explained_in_any_case_and_nothing_else_is() {
        let starts =
            |code: &str| explained(code).map(|text| text.lines().next().map(str::to_owned));
        assert_eq!(starts("i0101"), Some(Some("### I0101".into())));
        assert_eq!(starts("M0360"), Some(Some("### M0360".into())));
        assert_eq!(starts("101"), Some(Some("### Alarm 101".into())));
        for wrong in ["", "7", "I9999", "0x65", "99999999"] {
            assert_eq!(explained(wrong), None, "{wrong}");
        }
    }
}
