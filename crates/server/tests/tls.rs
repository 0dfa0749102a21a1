//! TLS: who trusts the certificate is answered, and what is not TLS is not.

use crate::common::{Served, write_secret};
use server::Certificate;
use sha2::{Digest as _, Sha256};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;
use tokio_rustls::rustls::client::danger::{
    HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier,
};
use tokio_rustls::rustls::crypto::{
    WebPkiSupportedAlgorithms, ring, verify_tls12_signature, verify_tls13_signature,
};
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use tokio_rustls::rustls::{
    ClientConfig, ClientConnection, DigitallySignedStruct, Error, RootCertStore, SignatureScheme,
    StreamOwned,
};

#[test]
fn over_tls_the_same_is_answered_as_without() {
    let dir = tempfile::tempdir().unwrap();
    let made = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let der = made.cert.der().clone();
    let (certificate, key) = (dir.path().join("c.pem"), dir.path().join("k.pem"));
    std::fs::write(&certificate, pem("CERTIFICATE", &der)).unwrap();
    write_secret(&key, pem("PRIVATE KEY", &made.signing_key.serialize_der()).as_bytes());
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

/// A client that knows the fingerprint that the server has printed, and trusts nothing else.
#[derive(Debug)]
struct Pinned {
    fingerprint: String,
    algorithms: WebPkiSupportedAlgorithms,
}

impl ServerCertVerifier for Pinned {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        _: &[CertificateDer<'_>],
        _: &ServerName<'_>,
        _: &[u8],
        _: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        let digest = fingerprint_of(certificate.as_ref());
        if digest == self.fingerprint {
            Ok(ServerCertVerified::assertion())
        } else {
            Err(Error::General(format!("the certificate is {digest}")))
        }
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls12_signature(message, certificate, signed, &self.algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls13_signature(message, certificate, signed, &self.algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.algorithms.supported_schemes()
    }
}

/// SHA-256 as people compare it.
fn fingerprint_of(der: &[u8]) -> String {
    let digest = Sha256::digest(der);
    digest.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":")
}

/// What a client that pins a fingerprint is answered, or why it does not talk.
fn pinned(served: &Served, fingerprint: &str) -> Result<String, std::io::Error> {
    let provider = Arc::new(ring::default_provider());
    let algorithms = provider.signature_verification_algorithms;
    let verifier = Pinned { fingerprint: fingerprint.to_owned(), algorithms };
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .unwrap()
        .dangerous()
        .with_custom_certificate_verifier(Arc::new(verifier))
        .with_no_client_auth();
    let name = ServerName::try_from("localhost").unwrap();
    let connection = ClientConnection::new(Arc::new(config), name).unwrap();
    let stream = TcpStream::connect(served.server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut tls = StreamOwned::new(connection, stream);
    let host = format!("localhost:{}", served.server.address().port());
    write!(tls, "GET /api/v1/status HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n")?;
    let mut answer = String::new();
    let _ = tls.read_to_string(&mut answer); // the end without a farewell is none of ours
    Ok(answer)
}

#[test]
fn a_self_signed_certificate_is_known_by_the_fingerprint_that_is_printed_and_by_no_other() {
    let served = Served::secured(Certificate::SelfSigned);
    let printed = served.server.fingerprint().unwrap().to_owned();
    let answer = pinned(&served, &printed).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("emergency_stop"), "{answer}");
    let another = Served::secured(Certificate::SelfSigned);
    let refused = pinned(&another, &printed).expect_err("it is another certificate");
    assert!(refused.to_string().contains(another.server.fingerprint().unwrap()), "{refused}");
    assert!(pinned(&another, another.server.fingerprint().unwrap()).is_ok());
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
