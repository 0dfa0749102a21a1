//! The stream of bytes to a broker: TCP, and TLS over it where the address asks for it.
use super::address::BrokerAddress;
use std::fmt;
use std::io;
use std::path::Path;
use std::sync::Arc;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName};
use tokio_rustls::rustls::{self, ClientConfig, RootCertStore};

/// Bytes to and from a broker.
pub(super) trait Bytes: AsyncRead + AsyncWrite + Send + Sync + Unpin {}

impl<T: AsyncRead + AsyncWrite + Send + Sync + Unpin> Bytes for T {}

/// Largest file of certificates: all authorities of a system are half of it.
const LARGEST_PEM: u64 = 1 << 20;

/// How a broker is reached.
#[derive(Clone)]
pub(super) struct Link {
    pub(super) address: BrokerAddress,
    tls: Option<(TlsConnector, ServerName<'static>)>,
}

impl Link {
    /// Of an address; the broker's certificate is vouched for by those of a file, or by those that
    /// this computer trusts.
    pub(super) fn of(address: BrokerAddress, authorities: Option<&Path>) -> Result<Self, String> {
        if !address.is_tls {
            return match authorities {
                None => Ok(Self { address, tls: None }),
                Some(_) => Err(format!(
                    "--mqtt-ca is for TLS, and {address} has none: its address begins with mqtts://"
                )),
            };
        }
        let name = ServerName::try_from(address.host.clone())
            .map_err(|_| format!("\"{}\" is no name of a certificate", address.host))?;
        let mut roots = RootCertStore::empty();
        if let Some(path) = authorities {
            let cannot = |why: &dyn fmt::Display| {
                format!("cannot read certificates of {}: {why}", path.display())
            };
            let what = "a file of certificates";
            let text = store::read_bytes(path, what, LARGEST_PEM).map_err(|e| cannot(&e))?;
            for certificate in CertificateDer::pem_slice_iter(&text) {
                let certificate = certificate.map_err(|e| cannot(&e))?;
                roots.add(certificate).map_err(|e| cannot(&e))?;
            }
            if roots.is_empty() {
                return Err(cannot(&"there is none in it (PEM)"));
            }
        } else {
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
            if roots.is_empty() {
                return Err(format!(
                    "this computer trusts no authority that could vouch for {address}: name its certificate with --mqtt-ca FILE"
                ));
            }
        }
        let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .map_err(|e| format!("TLS cannot be set up: {e}"))?
            .with_root_certificates(roots)
            .with_no_client_auth();
        Ok(Self { address, tls: Some((TlsConnector::from(Arc::new(config)), name)) })
    }

    /// Open it; an error is a sentence.
    pub(super) async fn open(&self) -> io::Result<Box<dyn Bytes>> {
        let BrokerAddress { host, port, .. } = &self.address;
        let stream = TcpStream::connect((host.as_str(), *port)).await.map_err(io::Error::other)?;
        let _ = stream.set_nodelay(true); // it is only slower without
        match &self.tls {
            None => Ok(Box::new(stream)),
            Some((tls, name)) => {
                let agreed = tls.connect(name.clone(), stream).await;
                Ok(Box::new(agreed.map_err(|e| io::Error::other(tls_sentence(&e)))?))
            }
        }
    }
}

/// Why TLS was not agreed on.
fn tls_sentence(error: &io::Error) -> String {
    use rustls::CertificateError::{
        BadSignature, NotValidForName, NotValidForNameContext, UnknownIssuer,
    };
    let inner = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    match inner {
        // a bad signature: one of another key has the name of one that is trusted
        Some(rustls::Error::InvalidCertificate(UnknownIssuer | BadSignature)) => {
            "its certificate is vouched for by none that is trusted here: name the one that vouches for it with --mqtt-ca FILE"
                .to_owned()
        }
        Some(rustls::Error::InvalidCertificate(NotValidForName | NotValidForNameContext { .. })) => {
            "its certificate is one of another name".to_owned()
        }
        Some(rustls::Error::InvalidMessage(_)) => "it does not speak TLS there".to_owned(),
        _ if error.to_string().contains("CaUsedAsEndEntity") => {
            "its certificate is that of an authority, and none of a server: make one with basicConstraints CA:FALSE"
                .to_owned()
        }
        _ => format!("TLS: {error}"),
    }
}
