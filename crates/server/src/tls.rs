//! TLS: a certificate of files, or one that is made at the start and whose fingerprint is said.
use crate::secret;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer};

/// Largest file with certificates or a key.
const LARGEST_PEM: u64 = 1 << 20;

/// What the server shows of itself.
#[derive(Clone, Debug)]
pub enum Certificate {
    /// PEM files: the certificate with those that vouch for it, and its key.
    Files(PathBuf, PathBuf),
    /// A self-signed one: a client compares its fingerprint once.
    SelfSigned,
}

/// TLS that is set up.
pub(crate) struct Tls {
    pub(crate) acceptor: TlsAcceptor,
    /// SHA-256 of the certificate, as browsers show it.
    pub(crate) fingerprint: String,
}

impl Tls {
    /// Of a certificate; a self-signed one is made for these names.
    pub(crate) fn of(certificate: &Certificate, names: &[String]) -> Result<Self, String> {
        let (chain, key) = match certificate {
            Certificate::Files(chain, key) => (chain_of(chain)?, key_of(key)?),
            Certificate::SelfSigned => self_signed(names)?,
        };
        let first = chain.first().ok_or("there is no certificate in the file")?;
        let digest = Sha256::digest(first.as_ref());
        let digits: Vec<_> = digest.iter().map(|byte| format!("{byte:02X}")).collect();
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .and_then(|builder| builder.with_no_client_auth().with_single_cert(chain, key))
            .map_err(|e| format!("the certificate cannot be used: {e}"))?;
        Ok(Self { acceptor: TlsAcceptor::from(Arc::new(config)), fingerprint: digits.join(":") })
    }
}

type Pair = (Vec<CertificateDer<'static>>, PrivateKeyDer<'static>);

fn chain_of(path: &Path) -> Result<Vec<CertificateDer<'static>>, String> {
    let wrong =
        |e: &dyn core::fmt::Display| format!("cannot read the certificate {}: {e}", path.display());
    let text = store::read_bytes(path, "a certificate", LARGEST_PEM).map_err(|e| wrong(&e))?;
    let all: Result<_, _> = CertificateDer::pem_slice_iter(&text).collect();
    all.map_err(|e| wrong(&e))
}

fn key_of(path: &Path) -> Result<PrivateKeyDer<'static>, String> {
    let wrong = |e: &dyn core::fmt::Display| format!("cannot read the key {}: {e}", path.display());
    secret::check(path, "the key")?;
    let text = store::read_bytes(path, "a key", LARGEST_PEM).map_err(|e| wrong(&e))?;
    PrivateKeyDer::from_pem_slice(&text).map_err(|e| wrong(&e))
}

fn self_signed(names: &[String]) -> Result<Pair, String> {
    let made = rcgen::generate_simple_self_signed(names.to_vec())
        .map_err(|e| format!("cannot make a certificate: {e}"))?;
    let key = PrivatePkcs8KeyDer::from(made.signing_key.serialize_der());
    Ok((vec![made.cert.der().clone()], key.into()))
}
