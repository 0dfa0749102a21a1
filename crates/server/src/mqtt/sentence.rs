//! Why there is no connection to a broker, in a sentence.
use super::address::BrokerAddress;
use rumqttc::mqttbytes::Error as Unreadable;
use rumqttc::mqttbytes::v5::ConnectReturnCode as Refusal;
use rumqttc::{ConnectionError, PublishNoticeError, StateError};
use std::io::ErrorKind;

/// Of what a connection has ended.
#[derive(Clone, Copy)]
pub(super) struct Of<'a> {
    pub address: &'a BrokerAddress,
    pub has_login: bool,
    /// The broker had accepted the connection: it speaks MQTT 5.
    pub was_accepted: bool,
}

/// Why a connection has ended, or does not begin.
pub(super) fn of(connection: Of<'_>, error: &ConnectionError) -> String {
    let Of { address, has_login, was_accepted } = connection;
    match error {
        ConnectionError::ConnectionRefused(refusal) => refused(address, *refusal, has_login),
        ConnectionError::MqttState(StateError::ConnFail { reason }) => {
            refused(address, *reason, has_login)
        }
        ConnectionError::Timeout(_) => format!("{address} does not answer within 5 s"),
        ConnectionError::Io(error) => format!("cannot reach {address}: {error}"),
        ConnectionError::MqttState(StateError::ConnectionAborted | StateError::Io(_)) => {
            format!("the connection to {address} has broken off")
        }
        // before what is no MQTT: the library has what the operating system says, and an end amid a
        // packet (Other), among what it cannot read
        ConnectionError::MqttState(StateError::Deserialization(Unreadable::Io(error)))
            if was_accepted || error.kind() != ErrorKind::Other =>
        {
            format!("the connection to {address} has broken off")
        }
        ConnectionError::NotConnAck(_)
        | ConnectionError::MqttState(
            StateError::Deserialization(_) | StateError::ProtocolViolation(_),
        ) => format!("what answers at {address} does not speak MQTT 5"),
        ConnectionError::MqttState(StateError::ServerDisconnect { reason_code, reason_string }) => {
            let said = reason_string.as_ref().map(|said| format!(" ({said})")).unwrap_or_default();
            format!("{address} has ended the connection: {reason_code:?}{said}")
        }
        ConnectionError::MqttState(StateError::AwaitPingResp) => {
            format!("{address} does not answer any more")
        }
        error => format!("{address}: {error}"),
    }
}

fn refused(address: &BrokerAddress, refusal: Refusal, has_login: bool) -> String {
    match refusal {
        Refusal::BadUserNamePassword | Refusal::NotAuthorized if has_login => {
            format!("{address} refuses this user with this password")
        }
        Refusal::BadUserNamePassword | Refusal::NotAuthorized => {
            format!("{address} wants a user and a password: --mqtt-login FILE")
        }
        Refusal::RefusedProtocolVersion | Refusal::UnsupportedProtocolVersion => {
            format!("{address} does not know MQTT 5")
        }
        Refusal::RetainNotSupported => {
            format!("{address} keeps no messages (retain), and what is true now is kept that way")
        }
        refusal => format!("{address} refuses the connection: {refusal:?}"),
    }
}

/// Why a message is not taken.
pub(super) fn not_taken(address: &BrokerAddress, error: &PublishNoticeError) -> String {
    match error {
        PublishNoticeError::V5PubAck(reason) => {
            format!("{address} does not take what is published: {reason:?}")
        }
        error => format!("{address} does not take what is published: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    fn sentence(was_accepted: bool, error: StateError) -> String {
        let address = &BrokerAddress::parse("mqtt://127.0.0.1:1883").unwrap();
        let connection = Of { address, has_login: false, was_accepted };
        of(connection, &ConnectionError::MqttState(error))
    }

    #[test]
    fn what_the_operating_system_ends_has_broken_off_and_is_no_other_protocol() {
        for kind in [io::ErrorKind::ConnectionReset, io::ErrorKind::BrokenPipe] {
            for was_accepted in [false, true] {
                for error in [
                    StateError::Io(kind.into()),
                    StateError::Deserialization(Unreadable::Io(kind.into())),
                ] {
                    let says = sentence(was_accepted, error);
                    assert_eq!(says, "the connection to mqtt://127.0.0.1:1883 has broken off");
                }
            }
        }
        let says = sentence(true, StateError::Deserialization(Unreadable::InvalidPacketType(0)));
        assert_eq!(says, "what answers at mqtt://127.0.0.1:1883 does not speak MQTT 5");
    }

    #[test]
    fn an_end_amid_a_packet_is_another_protocol_unless_the_broker_had_accepted() {
        let amid = || StateError::Deserialization(Unreadable::Io(io::Error::other("bytes remain")));
        for (was_accepted, says) in [
            (false, "what answers at mqtt://127.0.0.1:1883 does not speak MQTT 5"),
            (true, "the connection to mqtt://127.0.0.1:1883 has broken off"),
        ] {
            assert_eq!(sentence(was_accepted, amid()), says);
        }
    }
}
