//! The mailbox of a device: what it is asked, and what it says unasked.
use super::Device;
use crate::al::AlState;
use crate::coe::{COE, Context, Service, error_reply, finish, inform, parse};
use crate::registers as reg;

/// Most mails that wait to be read; a device that is asked for more leaves the newest out.
const MOST_MAILS: usize = 64;
/// Mailbox error: kind of mail that is not supported.
const UNSUPPORTED_PROTOCOL: u16 = 0x0002;
/// Mailbox error: its header does not fit.
const INVALID_HEADER: u16 = 0x0004;

impl Device {
    pub(super) fn repeat_mail(&mut self) {
        let wanted = u8::from(self.controller.sync_managers[1].repeat);
        let status = reg::SYNC_MANAGER + 8 + 7;
        self.controller.memory.set(status, &[wanted << 1]);
        if !self.last_mail.is_empty() {
            self.controller.sync_managers[1].is_full = false;
            self.controller.put_mail(1, &self.last_mail);
        }
    }

    pub(super) fn answer_mail(&mut self) {
        let mut mail = std::mem::take(&mut self.mail);
        self.controller.take_mail(0, &mut mail);
        let mut reply = Vec::new();
        match parse(&mail) {
            None => error_reply(&mut reply, INVALID_HEADER),
            Some(mail) if mail.kind != COE => error_reply(&mut reply, UNSUPPORTED_PROTOCOL),
            Some(mail) => self.answer_coe(mail.body, &mut reply),
        }
        self.mail = mail;
        if !reply.is_empty() {
            self.post(reply);
        }
    }

    pub(super) fn answer_coe(&mut self, body: &[u8], reply: &mut Vec<u8>) {
        let Some((header, request)) = body.split_at_checked(2) else {
            return error_reply(reply, INVALID_HEADER);
        };
        let service = header[1] >> 4;
        let mailbox = usize::from(self.controller.sync_managers[1].length);
        let quirks = &self.blueprint.quirks;
        if service == Service::SdoRequest as u8 {
            let dictionary = &mut self.dictionary;
            let mut context = Context { dictionary, state: self.state, quirks, mailbox };
            if !self.server.answer(request, &mut context, reply) {
                reply.clear();
            }
        } else if service == Service::SdoInformation as u8 && !quirks.no_sdo_information {
            for mail in inform(request, &self.dictionary, mailbox) {
                self.post(mail);
            }
        } else {
            error_reply(reply, UNSUPPORTED_PROTOCOL);
        }
    }

    pub(super) fn post(&mut self, mut mail: Vec<u8>) {
        if self.outbox.len() >= MOST_MAILS || self.blueprint.mailboxes.is_none() {
            return;
        }
        self.counter = self.counter % 7 + 1;
        finish(&mut mail, self.counter);
        self.outbox.push_back(mail);
        self.deliver();
    }

    /// Puts the next mail into the mailbox, if that is empty.
    pub(super) fn deliver(&mut self) {
        if self.state == AlState::Init || self.blueprint.mailboxes.is_none() {
            return;
        }
        if let Some(mail) = self.outbox.front()
            && self.controller.put_mail(1, mail)
            && let Some(mail) = self.outbox.pop_front()
        {
            self.last_mail = mail;
        }
    }
}
