//! The part of `XPath` that clients use to name components and data items.
//!
//! ```text
//!   path  = way { "|" way }
//!   way   = step { step }                     from the root of the Devices document
//!   step  = ( "/" | "//" ) ( name | "*" ) { "[" test { "and" | "or" test } "]" }
//!   test  = "@" attribute "=" quoted          `and` binds as it does in XPath: before `or`
//! ```
//!
//! What is chosen of a component is all that is below it. A prefix of a name (`m:Device`) is passed
//! over: there is one namespace.
use crate::element::Element;
use crate::query::{ErrorCode, QueryError};

/// Steps of a path, with their tests.
const MOST_PARTS: usize = 16;

/// Which components and data items.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    text: String,
    ways: Vec<Vec<PathStep>>,
}

#[derive(Clone, Debug, PartialEq)]
struct PathStep {
    /// At any depth.
    is_deep: bool,
    /// `None`: any.
    name: Option<String>,
    tests: Vec<Test>,
}

/// One of these, of which all: what stands between brackets.
type Test = Vec<Vec<(String, String)>>;

struct PathReader<'a> {
    text: &'a str,
    at: usize,
    parts: usize,
}

fn invalid(text: impl Into<String>) -> QueryError {
    QueryError::new(ErrorCode::InvalidPath, text)
}

impl Path {
    /// Of its text.
    pub(crate) fn parse(text: &str) -> Result<Self, QueryError> {
        let mut reader = PathReader { text, at: 0, parts: 0 };
        let mut ways = vec![reader.way()?];
        while reader.takes("|") {
            ways.push(reader.way()?);
        }
        reader.blanks();
        match reader.rest().chars().next() {
            None => Ok(Self { text: text.to_owned(), ways }),
            Some(c) => Err(invalid(format!(
                "\"{c}\" at character {} of the path is not understood: expected / // [ or |",
                reader.column()
            ))),
        }
    }

    /// Ids of the data items that it chooses of a device, in the order of the document.
    pub(crate) fn choose<'a>(&self, devices: &'a Element) -> Result<Vec<&'a str>, QueryError> {
        let mut chosen: Vec<&Element> = Vec::new();
        for way in &self.ways {
            let mut context = vec![devices];
            for (number, step) in way.iter().enumerate() {
                context = step.of(&context, number == 0);
            }
            chosen.extend(context);
        }
        let mut ids = Vec::new();
        for element in chosen {
            collect(element, &mut ids);
        }
        if ids.is_empty() {
            return Err(invalid(format!("no data item is at {}", self.text)));
        }
        Ok(ids)
    }
}

/// Ids of an element's data items.
fn collect<'a>(element: &'a Element, ids: &mut Vec<&'a str>) {
    if element.name == "DataItem" {
        if let Some(id) = element.attribute("id").filter(|id| !ids.contains(id)) {
            ids.push(id);
        }
        return;
    }
    for child in &element.children {
        collect(child, ids);
    }
}

impl PathStep {
    fn of<'a>(&self, context: &[&'a Element], is_first: bool) -> Vec<&'a Element> {
        let mut found = Vec::new();
        for element in context {
            if is_first {
                self.look(element, &mut found);
            } else {
                for child in &element.children {
                    self.look(child, &mut found);
                }
            }
        }
        found
    }

    fn look<'a>(&self, element: &'a Element, found: &mut Vec<&'a Element>) {
        let is_named = self.name.as_deref().is_none_or(|name| element.name == name);
        let is_new = !found.iter().any(|before| std::ptr::eq(*before, element));
        if is_named && is_new && self.tests.iter().all(|test| passes(element, test)) {
            found.push(element);
        }
        if self.is_deep {
            for child in &element.children {
                self.look(child, found);
            }
        }
    }
}

fn passes(element: &Element, test: &Test) -> bool {
    let is_so = |(name, value): &(String, String)| element.attribute(name) == Some(value);
    test.iter().any(|all| all.iter().all(is_so))
}

impl<'a> PathReader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn column(&self) -> usize {
        self.text[..self.at].chars().count() + 1
    }

    fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    fn takes(&mut self, mark: &str) -> bool {
        self.blanks();
        let is_there = self.rest().starts_with(mark);
        self.at += if is_there { mark.len() } else { 0 };
        is_there
    }

    fn expect(&mut self, mark: &str) -> Result<(), QueryError> {
        if self.takes(mark) {
            return Ok(());
        }
        Err(invalid(format!("{mark} is expected at character {} of the path", self.column())))
    }

    fn name(&mut self) -> Result<String, QueryError> {
        self.blanks();
        let rest = self.rest();
        let is_of_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ':');
        let length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
        if length == 0 {
            let text = format!("a name is expected at character {} of the path", self.column());
            return Err(invalid(text));
        }
        self.at += length;
        let name = &rest[..length];
        if self.rest().starts_with('(') || name.contains("::") {
            let text = format!(
                "{name} is not understood: a path here has / // * | and [@name=\"value\"] with and, or"
            );
            return Err(QueryError::new(ErrorCode::Unsupported, text));
        }
        Ok(name.to_owned())
    }

    fn part(&mut self) -> Result<(), QueryError> {
        self.parts += 1;
        if self.parts > MOST_PARTS {
            return Err(invalid(format!("the path has more than {MOST_PARTS} parts")));
        }
        Ok(())
    }

    fn way(&mut self) -> Result<Vec<PathStep>, QueryError> {
        let mut steps = Vec::new();
        loop {
            let is_deep = self.takes("//");
            if !is_deep && !self.takes("/") {
                break;
            }
            self.part()?;
            let name = if self.takes("*") { None } else { Some(self.name()?) };
            let name = name.map(|name| match name.rsplit_once(':') {
                Some((_, local)) => local.to_owned(),
                None => name,
            });
            let mut tests = Vec::new();
            while self.takes("[") {
                tests.push(self.test()?);
            }
            steps.push(PathStep { is_deep, name, tests });
        }
        if steps.is_empty() {
            return Err(invalid(format!(
                "/ or // is expected at character {} of the path",
                self.column()
            )));
        }
        Ok(steps)
    }

    /// What stands between brackets, with the closing one.
    fn test(&mut self) -> Result<Test, QueryError> {
        let mut any = vec![Vec::new()];
        loop {
            self.part()?;
            self.expect("@")?;
            let name = self.name()?;
            self.expect("=")?;
            let value = self.quoted()?;
            if let Some(all) = any.last_mut() {
                all.push((name, value));
            }
            if self.takes("]") {
                return Ok(any);
            }
            if self.takes("or ") {
                any.push(Vec::new());
            } else if !self.takes("and ") {
                let text = format!("] is expected at character {} of the path", self.column());
                return Err(invalid(text));
            }
        }
    }

    fn quoted(&mut self) -> Result<String, QueryError> {
        self.blanks();
        let rest = self.rest();
        let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''));
        let quoted = quote.and_then(|quote| rest[1..].split_once(quote));
        let Some((value, _)) = quoted else {
            let text = format!("\"value\" is expected at character {} of the path", self.column());
            return Err(invalid(text));
        };
        self.at += value.len() + 2;
        Ok(value.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn item(id: &'static str, kind: &'static str) -> Element {
        Element::new("DataItem").with("id", id).with("type", kind)
    }

    fn axis(name: &'static str, items: [Element; 2]) -> Element {
        Element::new("Linear")
            .with("name", name)
            .containing([Element::new("DataItems").containing(items)])
    }

    fn devices() -> Element {
        let axes = [
            axis("X", [item("xp", "POSITION"), item("xl", "LOAD")]),
            axis("Y", [item("yp", "POSITION"), item("yl", "LOAD")]),
        ];
        let axes = Element::new("Axes").containing([Element::new("Components").containing(axes)]);
        Element::new("MTConnectDevices").containing([Element::new("Devices").containing([
            Element::new("Device").with("name", "mill").containing([
                Element::new("DataItems").containing([item("avail", "AVAILABILITY")]),
                Element::new("Components").containing([axes]),
            ]),
        ])])
    }

    fn chosen(path: &str) -> String {
        let devices = devices();
        match Path::parse(path).and_then(|path| path.choose(&devices).map(|ids| ids.join(" "))) {
            Ok(ids) => ids,
            Err(error) => error.code.name().to_owned(),
        }
    }

    #[test]
    fn components_and_data_items_are_named_as_clients_do() {
        assert_eq!(chosen("//DataItem[@type=\"POSITION\"]"), "xp yp");
        assert_eq!(chosen("//Axes//Linear[@name='X']"), "xp xl");
        assert_eq!(chosen("//Linear[@name=\"Y\"]//DataItem[@type=\"LOAD\"]"), "yl");
        assert_eq!(chosen("//DataItem[@type=\"LOAD\" or @id=\"avail\"]"), "avail xl yl");
        assert_eq!(chosen("//DataItem[@type=\"LOAD\" and @id=\"xl\"]"), "xl");
        assert_eq!(chosen("//Linear[@name=\"Y\"] | //DataItem[@id=\"xp\"]"), "yp yl xp");
        assert_eq!(chosen("/MTConnectDevices/Devices/m:Device/DataItems/*"), "avail");
        assert_eq!(chosen("//Device"), "avail xp xl yp yl");
    }

    #[test]
    fn what_is_no_path_names_nothing_or_is_not_done_here_says_so() {
        for path in ["", "Axes", "//", "//DataItem[", "//DataItem[@type]", "//DataItem[@type=X]"] {
            assert_eq!(chosen(path), "INVALID_PATH", "{path}");
        }
        assert_eq!(chosen("//DataItem[@type=\"PRESSURE\"]"), "INVALID_PATH");
        assert_eq!(chosen("//DataItem[@type=\"LOAD\"]x"), "INVALID_PATH");
        assert_eq!(chosen("//Linear/descendant::DataItem"), "UNSUPPORTED");
        assert_eq!(chosen("//text()"), "UNSUPPORTED");
        assert_eq!(chosen(&"/a".repeat(17)), "INVALID_PATH");
    }

    proptest! {
        #[test]
        fn any_text_is_a_path_or_an_error(text in "[/\\[\\]@='\"|* a-zAé():]{0,60}") {
            let devices = devices();
            if let Ok(path) = Path::parse(&text) {
                let _ = path.choose(&devices);
            }
        }
    }
}
