//! TLS: who trusts the certificate is answered, and what is not TLS is not.
#![allow(clippy::unwrap_used)] // a test may panic
mod common;

use common::Served;
use server::Certificate;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::ServerName;
use tokio_rustls::rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

#[test]
fn over_tls_the_same_is_answered_as_without() {
    let dir = tempfile::tempdir().unwrap();
    let made = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let der = made.cert.der().clone();
    let (certificate, key) = (dir.path().join("c.pem"), dir.path().join("k.pem"));
    std::fs::write(&certificate, pem("CERTIFICATE", &der)).unwrap();
    std::fs::write(&key, pem("PRIVATE KEY", &made.signing_key.serialize_der())).unwrap();
    let served = Served::secured(Certificate::Files(certificate, key));
    assert!(served.server.url().starts_with("https://"));
    assert_eq!(served.server.fingerprint().unwrap().len(), 32 * 3 - 1);

    let mut roots = RootCertStore::empty();
    roots.add(der).unwrap();
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let name = ServerName::try_from("localhost").unwrap();
    let connection = ClientConnection::new(Arc::new(config), name).unwrap();
    let stream = TcpStream::connect(served.server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut tls = StreamOwned::new(connection, stream);
    let port = served.server.address().port();
    write!(
        tls,
        "GET /api/v1/status HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\n\r\n"
    )
    .unwrap();
    let mut answer = String::new();
    let _ = tls.read_to_string(&mut answer); // the end without a farewell is none of ours
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("emergency_stop"), "{answer}");

    let mut plain = TcpStream::connect(served.server.address()).unwrap();
    plain.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    // it may be closed before all of it is sent
    let _ = write!(plain, "GET /api/v1/status HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n");
    let mut answer = Vec::new();
    let _ = plain.read_to_end(&mut answer); // it is closed
    assert!(!answer.starts_with(b"HTTP/1.1 200"));
}

/// As files have it.
fn pem(what: &str, der: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in der.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte))
            << (8 * (3 - three.len()));
        for digit in 0..4 {
            let is_there = digit <= three.len();
            let digit = DIGITS[(bits >> (18 - 6 * digit)) as usize & 63];
            text.push(if is_there { char::from(digit) } else { '=' });
        }
    }
    let lines: Vec<_> =
        text.as_bytes().chunks(64).map(|line| std::str::from_utf8(line).unwrap()).collect();
    format!("-----BEGIN {what}-----\n{}\n-----END {what}-----\n", lines.join("\n"))
}
