//! Who may use which address: each address that the server has, by each credential that there is
//! and some that there are not, over a server that listens.

use crate::common::{How, Served};
use serde_json::{Map, Value, json};
use server::{Access, NewToken, Role, Tokens, addresses};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

const DAY: Duration = Duration::from_hours(24);
/// The token that expires is used before, and waited for.
const SHORT: Duration = Duration::from_secs(3);
/// A server has looked at its file of tokens since.
const SEEN: Duration = Duration::from_millis(2500);

/// What a client sends of itself.
type Headers = Vec<(&'static str, String)>;

/// How who sends it is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A token of this role.
    Token(Role),
    /// A session of a token of this role.
    Session(Role),
    /// Nothing that is known or valid.
    Nobody,
}

/// A server with tokens, and everyone who asks.
struct Shop {
    served: Served,
    clients: Vec<(&'static str, Headers, Kind)>,
    file: PathBuf,
    _folder: TempDir,
}

fn bearer(token: &str) -> Headers {
    vec![("authorization", format!("Bearer {token}"))]
}

fn session(secret: &str) -> Headers {
    vec![("x-leadscrew-session", secret.to_owned())]
}

fn add(file: &Path, name: &str, role: Role, valid: Duration) -> NewToken {
    Tokens::add(file, name, role, valid).unwrap()
}

fn opened(served: &Served, name: &str, token: &str) -> String {
    let (status, answer) = served.post("/session", &json!({ "name": name, "token": token }));
    assert_eq!(status, 200, "{answer}");
    answer["session"].as_str().unwrap().to_owned()
}

impl Shop {
    fn open() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens.toml");
        let operator = add(&file, "operator", Role::Operator, DAY).token;
        let viewer = add(&file, "wall", Role::Viewer, DAY).token;
        let revoked = add(&file, "left", Role::Operator, DAY).token;
        let expires = add(&file, "short", Role::Operator, SHORT).token;
        let served = Served::of(How { token_file: Some(file.clone()), ..How::default() });
        // each has been used rightfully before
        for token in [&operator, &viewer, &revoked, &expires] {
            let authorization = [("authorization", &*format!("Bearer {token}"))];
            assert_eq!(served.get_with("/status", &authorization).0, 200);
        }
        let of_operator = opened(&served, "desk", &operator);
        let of_viewer = opened(&served, "panel", &viewer);
        let of_revoked = opened(&served, "gone", &revoked);
        let of_expired = opened(&served, "late", &expires);
        Tokens::revoke(&file, "left").unwrap();
        std::thread::sleep(SHORT.max(SEEN));
        let others = [bearer(&viewer), session(&of_operator)].concat();
        let swapped = [session(&of_viewer), bearer(&operator)].concat();
        let two = [session(&of_viewer), session(&of_operator)].concat();
        let mut clients = vec![
            ("no token", vec![], Kind::Nobody),
            ("a viewer's token", bearer(&viewer), Kind::Token(Role::Viewer)),
            ("an operator's token", bearer(&operator), Kind::Token(Role::Operator)),
            ("a viewer's session", session(&of_viewer), Kind::Session(Role::Viewer)),
            ("an operator's session", session(&of_operator), Kind::Session(Role::Operator)),
            ("an expired token", bearer(&expires), Kind::Nobody),
            ("an expired session", session(&of_expired), Kind::Nobody),
            ("a revoked token", bearer(&revoked), Kind::Nobody),
            ("a revoked session", session(&of_revoked), Kind::Nobody),
            ("the operator's session with a viewer's token", others, Kind::Token(Role::Viewer)),
            ("a viewer's session with the operator's token", swapped, Kind::Token(Role::Operator)),
            ("two sessions", two, Kind::Nobody),
            ("half a token", bearer(&operator[..32]), Kind::Nobody),
        ];
        for forged in [
            "of operator",
            "of wall",
            "operator",
            "wall",
            "desk",
            "local",
            "of local",
            "0",
            "1",
            "0123456789abcdef0123456789abcdef",
        ] {
            clients.push((forged, session(forged), Kind::Nobody));
        }
        clients.push(("names of proxies", proxied(), Kind::Nobody));
        Self { served, clients, file, _folder: folder }
    }
}

/// What a proxy, or who passes for one, says of who asks.
fn proxied() -> Headers {
    [
        "x-forwarded-for",
        "x-forwarded-user",
        "x-real-ip",
        "forwarded",
        "x-remote-user",
        "remote-user",
    ]
    .map(|name| (name, "127.0.0.1".to_owned()))
    .into()
}

/// An address that can be asked for.
fn example(path: &str) -> String {
    let programs = path.contains("/programs/");
    let rest = if programs { "plate.ngc" } else { "current" };
    path.replace("{*path}", rest).replace("{id}", "1")
}

/// What is to be answered: the status that refuses; `None`: it is admitted.
fn refusal(access: Access, kind: Kind, is_both: bool) -> Option<u16> {
    let by_session = match kind {
        // a token beside a session of another one
        Kind::Token(_) if is_both && matches!(access, Access::Viewer | Access::Operator) => {
            return Some(401);
        }
        Kind::Token(role) => Some((role, true)),
        Kind::Session(role) => Some((role, false)),
        Kind::Nobody => None,
    };
    match (access, by_session) {
        (Access::Anyone, _) => None,
        (_, None) | (Access::Watcher, Some((_, false))) => Some(401),
        (Access::Watcher | Access::Viewer, _) | (_, Some((Role::Operator, _))) => None,
        (Access::Operator, Some((Role::Viewer, _))) => Some(403),
    }
}

#[test]
fn each_address_is_for_whom_the_table_says_and_for_nobody_else() {
    let shop = Shop::open();
    let table = addresses();
    assert!(table.len() > 25, "{table:?}");
    let open = table.iter().filter(|address| address.access == Access::Anyone);
    let open: Vec<_> = open.map(|address| (address.method, &*address.path)).collect();
    assert_eq!(open, [("post", "/api/v1/session"), ("get", "/api/v1/openapi.json")]);
    let mut asked = 0;
    for address in &table {
        let methods: &[&str] = match address.method {
            "any" => &["GET", "POST", "PUT", "DELETE"],
            "get" => &["GET", "HEAD"],
            "put" => &["PUT"],
            _ => &["POST"],
        };
        let path = example(&address.path);
        for method in methods {
            for (who, headers, kind) in &shop.clients {
                let sent: Vec<_> = headers.iter().map(|(name, value)| (*name, &**value)).collect();
                let (status, answer) = shop.served.raw(method, &path, &sent);
                asked += 1;
                let told = format!("{method} {path} by {who}: {status} {answer}");
                if path.ends_with("/session") {
                    // it opens one with a token in its body or its header, and there is no body
                    assert!(matches!(status, 400 | 401), "{told}");
                    continue;
                }
                let is_both = headers.len() == 2;
                match refusal(address.access, *kind, is_both) {
                    // two sessions are no request at all
                    Some(401) => assert!(matches!(status, 401) || who.starts_with("two"), "{told}"),
                    Some(refused) => assert_eq!(status, refused, "{told}"),
                    None => assert!(!matches!(status, 401 | 403), "{told}"),
                }
                assert!(status < 500, "{told}");
            }
        }
    }
    println!("{} addresses, {} clients, {asked} requests", table.len(), shop.clients.len());
    assert_eq!(status_of(&shop)["power"], "OFF");
}

fn status_of(shop: &Shop) -> Value {
    let (_, headers, _) = &shop.clients[2];
    let sent: Vec<_> = headers.iter().map(|(name, value)| (*name, &**value)).collect();
    shop.served.get_with("/status", &sent).1
}

/// What a session says of itself in the address, where a browser can say it nowhere else.
#[test]
fn a_session_in_an_address_is_held_to_the_same_and_is_read_nowhere_else() {
    let shop = Shop::open();
    let in_address = ["/ws", "/lsp", "/runs/1/report", "/runs/1/certificate"];
    for address in addresses().iter().filter(|address| address.method == "get") {
        let Some(path) = address.path.strip_prefix("/api/v1") else { continue };
        let takes = in_address.contains(&&*example(path));
        for (who, headers, kind) in &shop.clients {
            let [("x-leadscrew-session", secret)] = headers.as_slice() else { continue };
            let secret = secret.replace(' ', "%20");
            let (status, answer) = shop.served.raw(
                "GET",
                &format!("{}?session={secret}", example(&address.path)),
                &[],
            );
            let is_let_in = address.access == Access::Anyone || (takes && *kind != Kind::Nobody);
            assert_eq!(status != 401, is_let_in, "{path} by {who}: {status} {answer}");
        }
    }
}

/// An object of a schema: what has to be there.
fn sample(schema: &Value) -> Value {
    let properties = schema["properties"].as_object().cloned().unwrap_or_default();
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let value = |name: &Value| {
        let of = &properties[name.as_str().unwrap()];
        let value = match (&of["enum"][0], of["type"].as_str()) {
            (Value::String(one), _) => json!(one),
            (_, Some("boolean")) => json!(true),
            (_, Some("integer" | "number")) => json!(1),
            (_, Some("string")) => json!("X"),
            _ => json!("length"),
        };
        (name.as_str().unwrap().to_owned(), value)
    };
    Value::Object(required.iter().map(value).collect::<Map<_, _>>())
}

#[test]
fn over_a_socket_a_viewer_commands_nothing_whatever_it_asks_for() {
    let shop = Shop::open();
    let (_, headers, _) = &shop.clients[3];
    let viewer = &headers[0].1;
    let mut socket = shop.served.socket(&format!("?session={viewer}"));
    let document = server::openapi();
    let requests = document["components"]["schemas"]["RequestBody"]["oneOf"].as_array().unwrap();
    assert!(requests.len() > 30);
    for request in requests {
        let body = sample(request);
        socket.send(&json!({ "type": "request", "id": 1, "request": body }));
        let answer = socket.next("answer");
        assert_eq!(answer["accepted"], false, "{body}: {answer}");
        assert_eq!(answer["reason"], "a viewer may not command the machine", "{body}");
    }
}

#[test]
fn what_was_opened_with_a_token_ends_when_it_is_taken_out_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tokens.toml");
    let token = add(&file, "operator", Role::Operator, DAY).token;
    add(&file, "stays", Role::Viewer, DAY);
    let served = Served::of(How { token_file: Some(file.clone()), ..How::default() });
    let secret = opened(&served, "desk", &token);
    let sockets = ["/ws", "/lsp"].map(|at| served.socket_at(at, &format!("?session={secret}")));
    let bearer = format!("Bearer {token}");
    let stream = std::thread::scope(|scope| {
        let reads = scope.spawn(|| {
            let stream = "/mtconnect/sample?interval=100&heartbeat=60000";
            served.raw("GET", stream, &[("authorization", &bearer)])
        });
        std::thread::sleep(SEEN);
        Tokens::revoke(&file, "operator").unwrap();
        for mut socket in sockets {
            while socket.socket.read().is_ok() {}
        }
        reads.join().unwrap()
    });
    assert_eq!(stream.0, 200, "it was admitted, and has ended");
    for header in [("authorization", &*bearer), ("x-leadscrew-session", &*secret)] {
        assert_eq!(served.get_with("/status", &[header]).0, 401, "{header:?}");
    }
}

/// Without a file of tokens who is on this computer is the operator; nobody is by a name.
#[test]
fn on_this_computer_a_session_that_was_not_opened_is_none() {
    let served = Served::at_pace(1.0);
    assert_eq!(served.get("/status").0, 200);
    for forged in ["local", "of local", "0", "desk-1"] {
        let sent = [("x-leadscrew-session", forged)];
        assert_eq!(served.get_with("/status", &sent).0, 401, "{forged}");
    }
    let open = |name: &str| served.post("/session", &json!({ "name": name })).1["name"].clone();
    assert_eq!(open("desk"), "desk");
    assert_eq!(open("desk"), "desk 2", "a name is one session's");
    assert_eq!(open("local"), "local 2", "and one is taken");
}

/// The file of tokens is gone or broken: nobody is let in, and nothing is forgotten.
#[test]
fn while_the_file_of_tokens_cannot_be_read_nobody_is_admitted() {
    let shop = Shop::open();
    let whole = std::fs::read(&shop.file).unwrap();
    let (_, headers, _) = &shop.clients[4];
    let sent: Vec<_> = headers.iter().map(|(name, value)| (*name, &**value)).collect();
    let status = || shop.served.get_with("/status", &sent).0;
    assert_eq!(status(), 200);
    std::fs::write(&shop.file, "[[token]]\nname = ").unwrap();
    std::thread::sleep(SEEN);
    assert_eq!(status(), 401);
    std::fs::write(&shop.file, whole).unwrap();
    std::thread::sleep(SEEN);
    assert_eq!(status(), 200, "it is there again");
}
